//! What a branch of limit cycles is asked for by, and how it is computed.

use super::result::CyclesResult;
use crate::branch::Origin;
use crate::cycle_source::CycleSource;
use crate::error::Error;
use crate::files::{Disk, Files};
use crate::found_point::FoundPoint;
use crate::interval::{Along, Interval};
use crate::labels::kind;
use crate::model::ChosenModel;
use crate::model_request::{ModelRequest, ModelSource, OpenedModel};
use crate::monitor::{CycleMonitor, Monitored};
use crate::orbit_file::read_orbit_among;
use crate::point_reference::PointReference;
use crate::simulate::settled_orbit;
use crate::start::{LabelledPoint, LabelledSolution};
use crate::steps::{Mesh, Steps};
use crate::vocabulary::Vocabulary;
use arclength::VectorField;
use arclength::branch::{Monitor, SpecialKind};
use arclength::continuation::Settings;
use arclength::control::Control;
use arclength::cycle::{CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::SpecialPoint;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A branch of limit cycles along a parameter, from a Hopf point, a cycle or a time history of an earlier result, or from samples
/// of an orbit.
///
/// From a Hopf point (HB) the cycles that are born there are followed, from a period doubling (PD) the doubled ones, from a
/// branch point of cycles (BPC) the other branch, from any other cycle the branch through it, from the end (END) of a
/// time history the cycle on which it has settled, and from samples of an orbit the cycle nearest to them, stable or not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CyclesRequest {
    /// The labelled point, with its model and parameters, or samples of an orbit.
    pub from: CycleSource,
    /// The model of which samples are an orbit; a labelled point has its own.
    #[serde(default)]
    pub model: Option<ModelSource>,
    /// Values of parameters in place of those of the point or of the model.
    #[serde(default)]
    pub set: NamedNumbers,
    /// Parameter and its interval.
    pub along: Along,
    /// Values of the parameter at which cycles are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// What is recorded along the branch.
    #[serde(default)]
    pub monitors: Vec<Monitored>,
    /// Whether the branch of the labelled cycle itself is followed, not the one that bifurcates there.
    #[serde(default)]
    pub stay: bool,
    /// How steps are taken.
    #[serde(flatten)]
    pub steps: Steps,
    /// How finely cycles are resolved.
    #[serde(flatten)]
    pub mesh: Mesh,
}

/// What a branch starts from, with its model.
struct Opened {
    chosen: ChosenModel,
    start: CycleStart,
    origin: Origin,
    warnings: Vec<String>,
}

/// A request that makes sense, with what the branch starts from.
#[derive(Clone, Debug)]
pub struct CyclesAnalysis {
    chosen: ChosenModel,
    start: CycleStart,
    origin: Origin,
    warnings: Vec<String>,
    active: usize,
    along: Interval,
    at: Vec<f64>,
    monitors: Vec<(Monitored, CycleMonitor)>,
    steps: Steps,
    mesh: Mesh,
}

impl CyclesRequest {
    /// A request with the default of everything else.
    pub fn new(from: impl Into<CycleSource>, along: impl Into<Along>) -> Self {
        Self {
            from: from.into(),
            model: None,
            set: NamedNumbers::default(),
            along: along.into(),
            at: Vec::new(),
            monitors: Vec::new(),
            stay: false,
            steps: Steps::default(),
            mesh: Mesh::default(),
        }
    }

    /// Reads what the branch starts from and checks every field.
    ///
    /// # Errors
    /// What is wrong with the point, the samples, the model or a field; a time history that has not settled on a cycle.
    pub fn validate(&self) -> Result<CyclesAnalysis, Error> {
        self.validate_among(&Disk)
    }

    /// The same with other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`validate`](Self::validate).
    pub fn validate_among(&self, files: &dyn Files) -> Result<CyclesAnalysis, Error> {
        self.steps.check()?;
        self.mesh.check()?;
        let Opened { chosen, start, origin, warnings } = match (&self.from, &self.model) {
            (CycleSource::Point(reference), None) => self.open_point(reference, files)?,
            (CycleSource::Samples { samples }, Some(model)) => self.open_samples(samples, model, files)?,
            (CycleSource::Point(reference), Some(_)) => {
                let given = format!("with {}:{}", reference.path.display(), reference.label);
                let allowed =
                    "a labelled point without a model, or a model with samples of an orbit, FILE.csv";
                return Err(Error::invalid(
                    &["model"],
                    given,
                    "the labelled point has its own model",
                    allowed,
                ));
            }
            (CycleSource::Samples { samples }, None) => {
                let given = format!("missing beside {}", samples.display());
                let allowed = "the file of the model to which the orbit belongs";
                return Err(Error::invalid(&["model"], given, "samples of an orbit have no model", allowed));
            }
        };
        let monitors = self
            .monitors
            .iter()
            .map(|asked| Ok((asked.clone(), asked.on_cycles(&Vocabulary::of(&chosen.model))?)));
        let along = chosen.interval(&self.along)?;
        Ok(CyclesAnalysis {
            monitors: monitors.collect::<Result<_, Error>>()?,
            start,
            origin,
            warnings,
            active: chosen.along(&["along"], &along)?,
            chosen,
            along,
            at: self.at.clone(),
            steps: self.steps,
            mesh: self.mesh,
        })
    }

    /// The model with the parameters that are set, which must suit the interval.
    fn change(&self, mut chosen: ChosenModel, start: &str) -> Result<ChosenModel, Error> {
        chosen.set(&self.set)?;
        let along = chosen.interval(&self.along)?;
        chosen.along(&["along"], &along)?;
        chosen.starts_within(&["along"], &along, start)?;
        along.check_values(&self.at)?;
        Ok(chosen)
    }

    /// Samples of an orbit of a model.
    fn open_samples(&self, samples: &Path, model: &ModelSource, files: &dyn Files) -> Result<Opened, Error> {
        let OpenedModel { chosen, mut warnings, .. } = ModelRequest::new(model.clone()).open_among(files)?;
        let name = samples.file_name().unwrap_or_default().to_string_lossy();
        let mut chosen = self.change(chosen, &name)?;
        warnings.extend(chosen.prepare_for_continuation(None));
        let orbit = read_orbit_among(files, samples, chosen.model.states())?;
        chosen.start = orbit.state_at(0.0);
        Ok(Opened {
            chosen,
            start: CycleStart::Orbit(orbit),
            origin: Origin { label: None, how: format!("the orbit in {name}") },
            warnings,
        })
    }

    /// A labelled point with its model.
    fn open_point(&self, reference: &PointReference, files: &dyn Files) -> Result<Opened, Error> {
        let point = LabelledPoint::read(reference, files)?;
        let mut chosen = self.change(point.chosen.clone(), &point.label)?;
        let mut warnings = Vec::from_iter(chosen.prepare_for_continuation(None));
        let (start, how) = self.start(reference, &point, &chosen)?;
        let itself =
            matches!(start, CycleStart::Orbit(_)) && matches!(point.solution, LabelledSolution::Cycle { .. });
        if itself && !self.stay && matches!(kind(&point.label), "PD" | "BPC") {
            warnings.push(format!(
                "the branch of the cycle {} itself is followed, not the one that bifurcates there",
                point.label
            ));
        }
        let origin = Origin::labelled(&point.label, how);
        Ok(Opened { chosen, start, origin, warnings })
    }

    /// What the branch starts from at a labelled point, in words too.
    fn start(
        &self,
        reference: &PointReference,
        point: &LabelledPoint,
        chosen: &ChosenModel,
    ) -> Result<(CycleStart, &'static str), Error> {
        match &point.solution {
            LabelledSolution::Cycle { orbit, branching } => Ok(match branching {
                // The doubled cycles leave along every parameter, the other branch at a branch point along its own.
                Some((branching, key)) if !self.stay && (branching.doubled || *key == self.along.key()) => {
                    let how =
                        if branching.doubled { "the doubled cycles" } else { "the other branch through it" };
                    (CycleStart::Branching(branching.clone()), how)
                }
                // At a branch point Newton's method alone could find either branch.
                Some((branching, key))
                    if *key == self.along.key()
                        && let Some(known) = branching.known_branch() =>
                {
                    (CycleStart::Branching(known), "the branch on which it was found")
                }
                _ => (CycleStart::Orbit(orbit.clone()), "the branch through it"),
            }),
            LabelledSolution::Equilibrium(Some(SpecialPoint::Hopf(hopf))) => {
                Ok((CycleStart::from(hopf), "the cycles that are born there"))
            }
            LabelledSolution::Motion { duration, .. } => {
                let ChosenModel { model, parameters, .. } = chosen;
                let initial = &point.chosen.start;
                let orbit = if model.thresholds().is_empty() && model.global_events().is_empty() {
                    Orbit::from_time_history(model, parameters, initial, *duration)?
                } else {
                    settled_orbit(model, parameters, initial, *duration)?
                };
                Ok((CycleStart::Orbit(orbit), "the cycle on which the time history has settled"))
            }
            LabelledSolution::Equilibrium(Some(SpecialPoint::Degenerate { at_border: true, .. })) => {
                Err(reference.failure(format!(
                    "no cycles can be started at {}: it lies on a border between two pieces of the field, where eigenvalues jump \
                     and there is no normal form; start from the end (END) of a time history on a cycle",
                    point.label
                )))
            }
            LabelledSolution::Equilibrium(Some(SpecialPoint::Degenerate { of: SpecialKind::Hopf, .. })) => {
                Err(reference.failure(format!(
                    "no cycles can be started at {}: it is degenerate and only bracketed, either because several pairs of \
                     eigenvalues cross there together or because a pair does not cross with a speed other than zero; start \
                     at a regular Hopf point or from the end (END) of a time history on a cycle",
                    point.label
                )))
            }
            LabelledSolution::Equilibrium(_) => Err(reference.failure(format!(
                "no cycles start at {}; allowed: Hopf points (HB), cycles, and the end (END) of a time history on a cycle",
                point.label
            ))),
        }
    }
}

impl CyclesAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Follows the branch. Where the control stops it the result is the branch up to there.
    ///
    /// # Errors
    /// [`Error::Continuation`].
    pub fn run(&self, control: &Control<'_>) -> Result<CyclesResult, Error> {
        self.run_watched(control, &mut |_| {})
    }

    /// The same under the eyes of somebody who is told every point as it is found, in the order in which they are found.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_watched(
        &self,
        control: &Control<'_>,
        watcher: &mut dyn FnMut(FoundPoint<'_>),
    ) -> Result<CyclesResult, Error> {
        let name = &self.chosen.model.parameters()[self.active];
        let monitors = self.monitors.iter().map(|(asked, monitor)| {
            let value = |point: &CyclePoint| {
                let mut parameters = self.chosen.parameters.clone();
                parameters[self.active] = point.value;
                Some(monitor.value(&point.orbit, &parameters))
            };
            Monitor::new(&asked.expression, value).at(&asked.at).until(&asked.until)
        });
        let field = self.chosen.field_of_cycles(&[self.active]);
        let branch = monitors
            .fold(Cycles::of(&field, self.start.clone()), Cycles::monitor)
            .parameters(&self.chosen.parameters)
            .along(name, self.along.start..=self.along.end)
            .at(&self.at)
            .settings(self.steps.settings(Settings::default()))
            .resolution(self.mesh.resolution())
            .observer(|point| {
                let (value, period) = (readable(point.value), readable(point.period));
                control.at(&format!("cycles, {name} = {value}, period {period}"));
                watcher(FoundPoint {
                    values: &[point.value],
                    max: &point.max,
                    min: &point.min,
                    stable: point.stable,
                    label: point.label,
                    orbit: Some(&point.orbit),
                });
                control.flow()
            })
            .run()?;
        let names: Vec<String> = self.monitors.iter().map(|(asked, _)| asked.expression.clone()).collect();
        Ok(CyclesResult::new(&self.chosen, (self.active, &self.along), self.origin.clone(), &names, branch))
    }
}
