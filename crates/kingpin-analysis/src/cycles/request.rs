//! What branches of limit cycles are asked for by, and how they are followed.

use super::followed::{Followed, FollowedBranch, from_hopf_points};
use super::result::CyclesResult;
use crate::along::along;
use crate::error::Error;
use crate::hopf::course::course_of;
use crate::hopf::search::{same_value, search};
use crate::monitors::on_cycles;
use crate::seen_from_above::SeenFromAbove;
use crate::start::{LabelledPoint, LabelledSolution};
use crate::wheel_request::WheelRequest;
use arclength::continuation::Settings;
use arclength::cycle::{Branching, CyclePoint, CycleStart, Orbit};
use arclength::equilibrium::equilibrium_settings;
use arclength_analysis::labels::kind;
use arclength_analysis::{
    Control, CycleSource, Disk, Files, FoundPoint, Interval, Mesh, Monitored, PointReference, Steps,
    read_orbit,
};
use kingpin::branches::{Along, CycleOptions, MotionOptions};
use kingpin::{Key, KingpinError, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Limit cycles along a parameter, from the Hopf points of the interval, from a labelled point of an earlier result or from samples
/// of an orbit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CyclesRequest {
    /// Which wheel; at a labelled point the parameters that are set replace those of the point.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Parameter and its interval; r may reach infinity.
    pub along: Interval,
    /// Values of the parameter at which cycles are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// Labelled point of an earlier result, with its wheel, or samples of an orbit of the wheel.
    #[serde(default)]
    pub from: Option<CycleSource>,
    /// Whether at a period doubling or a branch point the branch of the point itself is followed, not the one that leaves
    /// there.
    #[serde(default)]
    pub stay: bool,
    /// What is recorded along the branches, with values at which cycles are wanted or a branch ends.
    #[serde(default)]
    pub monitors: Vec<Monitored>,
    /// How steps are taken.
    #[serde(flatten)]
    pub steps: Steps,
    /// How finely cycles are resolved.
    #[serde(flatten)]
    pub mesh: Mesh,
}

/// A request that makes sense, with what it starts from.
#[derive(Clone, Debug)]
pub struct CyclesAnalysis {
    wheel: Wheel,
    along: Along,
    start: Start,
    stay: bool,
    steps: Steps,
    options: CycleOptions,
}

/// What the branches start from.
#[derive(Clone, Debug)]
enum Start {
    /// All Hopf points of the interval.
    HopfPoints,
    /// The Hopf point with this label, at the wheel's own value of the parameter.
    HopfPoint { label: String },
    /// A cycle, or the branch that leaves there.
    Cycle { origin: String, start: CycleStart },
}

impl CyclesRequest {
    /// A request for the paper's wheel with the default of everything else.
    pub fn new(along: Interval) -> Self {
        Self {
            wheel: WheelRequest::default(),
            along,
            at: Vec::new(),
            from: None,
            stay: false,
            monitors: Vec::new(),
            steps: Steps::default(),
            mesh: Mesh::default(),
        }
    }

    /// Reads the wheel, the labelled point or the samples and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel, the point, the samples or a field.
    pub fn validate(&self) -> Result<CyclesAnalysis, Error> {
        self.validate_among(&Disk)
    }

    /// The same with other files than those of this machine, of which samples of an orbit are still read.
    ///
    /// # Errors
    /// Those of [`validate`](Self::validate).
    pub fn validate_among(&self, files: &dyn Files) -> Result<CyclesAnalysis, Error> {
        self.steps.check()?;
        self.mesh.check()?;
        let along = along(&self.along)?;
        self.along.check_values(&self.at)?;
        let (wheel, start) = match &self.from {
            None => (self.wheel.read()?, Start::HopfPoints),
            Some(CycleSource::Point(reference)) => self.start(reference, along, files)?,
            Some(CycleSource::Samples { samples }) => self.start_at_samples(samples, along)?,
        };
        let mut options = CycleOptions::default()
            .at(&self.at)
            .resolution(self.mesh.resolution())
            .settings(self.steps.settings(Settings::default()));
        for asked in &self.monitors {
            options = options.monitor(on_cycles(asked, &wheel)?);
        }
        Ok(CyclesAnalysis { wheel, along, start, stay: self.stay, steps: self.steps, options })
    }

    /// What starts at a labelled point.
    fn start(
        &self,
        reference: &PointReference,
        along: Along,
        files: &dyn Files,
    ) -> Result<(Wheel, Start), Error> {
        if let Some(file) = &self.wheel.wheel {
            let given = file.display().to_string();
            let problem = "the labelled point has its own wheel";
            return Err(Error::invalid(&["wheel", "from"], given, problem, "one of them"));
        }
        let LabelledPoint { wheel, solution } = LabelledPoint::read(reference, files)?;
        let wheel = self.wheel.change(wheel)?;
        check_within(&wheel, along)?;
        let start = match solution {
            LabelledSolution::Hopf(_) => Start::HopfPoint { label: reference.label.clone() },
            LabelledSolution::Cycle { orbit, branching } => {
                LabelledPoint::check_orbit(reference, &wheel, &orbit)?;
                self.cycle(&reference.label, along, *orbit, branching)
            }
        };
        Ok((wheel, start))
    }

    /// What starts at samples of an orbit.
    fn start_at_samples(&self, samples: &Path, along: Along) -> Result<(Wheel, Start), Error> {
        let wheel = self.wheel.read()?;
        check_within(&wheel, along)?;
        let orbit = read_orbit(samples, wheel.free_states())?;
        let name = samples.file_name().unwrap_or_default().to_string_lossy();
        Ok((wheel, Start::Cycle { origin: format!("the orbit in {name}"), start: CycleStart::Orbit(orbit) }))
    }

    /// What starts at a cycle: the branch that bifurcates there, or the one through it.
    fn cycle(
        &self,
        label: &str,
        along: Along,
        orbit: Orbit,
        branching: Option<(Box<Branching>, Key)>,
    ) -> Start {
        // The doubled cycles leave along every parameter, the other branch at a branch point along its own.
        let branching = branching
            .filter(|(branching, key)| branching.doubled || *key == along.key())
            .and_then(|(branching, _)| if self.stay { branching.known_branch() } else { Some(*branching) });
        let Some(branching) = branching else {
            return Start::Cycle { origin: label.to_owned(), start: CycleStart::Orbit(orbit) };
        };
        let how = match (branching.doubled, self.stay) {
            (true, _) => "the doubled cycles",
            (false, true) => "the branch on which it was found",
            (false, false) => "the other branch through it",
        };
        Start::Cycle { origin: format!("{label}, {how}"), start: CycleStart::Branching(branching) }
    }
}

/// That the interval contains the value of the wheel.
fn check_within(wheel: &Wheel, along: Along) -> Result<(), Error> {
    let value = wheel.get(along.key());
    if along.contains(value) {
        return Ok(());
    }
    let (start, end) = along.ends();
    Err(KingpinError::OutsideInterval { key: along.key(), value, start, end }.into())
}

impl CyclesAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> Vec<String> {
        match &self.start {
            Start::Cycle { origin, start: CycleStart::Orbit(_) }
                if !self.stay && matches!(kind(origin), "PD" | "BPC") =>
            {
                vec![format!(
                    "the branch of the cycle {origin} itself is followed, not the one that bifurcates there"
                )]
            }
            _ => Vec::new(),
        }
    }

    /// Finds the Hopf points where it starts from them, and follows the branches. Where the control stops it the result is what
    /// there is up to there.
    ///
    /// # Errors
    /// [`Error::NothingFound`] where there is no Hopf point to start from, [`Error::NoBranch`] where none has a branch;
    /// [`Error::Wheel`].
    pub fn run(&self, control: &Control<'_>) -> Result<CyclesResult, Error> {
        self.run_watched(control, &mut |_| {})
    }

    /// The same under the eyes of somebody who is told every cycle as it is found.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_watched(
        &self,
        control: &Control<'_>,
        watcher: &mut dyn FnMut(FoundPoint<'_>),
    ) -> Result<CyclesResult, Error> {
        let along = self.along;
        // The most steps are those along a branch of cycles.
        let search_steps = Steps { steps: Steps::default().steps, ..self.steps };
        let settings = MotionOptions::default().settings(search_steps.settings(equilibrium_settings()));
        let mut found = 0;
        let mut observer = |point: &CyclePoint| {
            found += 1;
            let (value, period) = (readable(point.value), readable(point.period));
            control.at(&format!("{found} cycles, {} = {value}, period {period} s", along.key()));
            watcher(FoundPoint {
                values: &[point.value],
                max: &point.max,
                min: &point.min,
                stable: point.stable,
                label: point.label,
                orbit: Some(&point.orbit),
            });
            control.flow()
        };
        let mut course = Vec::new();
        let followed = match &self.start {
            Start::Cycle { origin, start } => {
                let (origin, start) = (origin.clone(), start.clone());
                let cycles = self.wheel.cycles_from(start, along, &self.options, &mut observer)?;
                let branches = vec![FollowedBranch { origin, hopf: None, reached: None, cycles }];
                Followed { branches, not_followed: Vec::new() }
            }
            Start::HopfPoints => {
                let branch = search(&self.wheel, along, &settings, control)?;
                course = course_of(&branch);
                from_hopf_points(&branch.hopf_points, None, along, &self.options, &mut observer)?
            }
            Start::HopfPoint { label } => {
                // The point of an earlier search is found again along the parameter that now varies, on the way from one end:
                // a search that starts at the point itself would not see the growth rate change its sign.
                let value = self.wheel.get(along.key());
                let wheel = self.wheel.with(along.key(), along.ends().0)?;
                let points = search(&wheel, along, &settings, control)?.hopf_points;
                let place = points.iter().position(|point| same_value(point.value, value));
                let only = place.ok_or_else(|| {
                    Error::NothingFound(format!(
                        "{label} is no Hopf point along {}: the wheel was changed, or the growth rate does not change its \
                         sign there; without --from all Hopf points of the interval are found",
                        along.key()
                    ))
                })?;
                from_hopf_points(&points, Some(only), along, &self.options, &mut observer)?
            }
        };
        let missed = self.missed(&followed.branches);
        let monitors = &self.options.monitors;
        Ok(CyclesResult { course, ..CyclesResult::new(self.wheel, along, followed, missed, monitors)? })
    }

    /// A cycle that was found, over one period as it is seen from above, at so many times.
    ///
    /// # Errors
    /// [`Error::Wheel`].
    pub fn seen_from_above(&self, value: f64, orbit: &Orbit, samples: usize) -> Result<SeenFromAbove, Error> {
        SeenFromAbove::of_cycle(&self.wheel.with(self.along.key(), value)?, orbit, samples)
    }

    /// The values asked for at which there is no cycle.
    fn missed(&self, branches: &[FollowedBranch]) -> Vec<f64> {
        let on_branches = |value: f64| {
            branches.iter().flat_map(|branch| &branch.cycles.points).any(|cycle| cycle.value == value)
        };
        self.options.at.iter().copied().filter(|value| !on_branches(self.along.as_found(*value))).collect()
    }
}
