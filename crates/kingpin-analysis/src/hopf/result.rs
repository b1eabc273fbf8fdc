//! Hopf points of the uniform motion as a result.

use super::course::course_of;
use super::motion::{BracketedResult, MotionResult, named_tests};
use super::search::label;
use crate::along::{along, varying};
use crate::description;
use crate::forces::{self, ForcesResult};
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::{parameters_over, wheel_of};
use crate::states::{self, named_state};
use arclength::branch::{Criticality, SpecialKind};
use arclength::equilibrium::SpecialPoint;
use arclength_analysis::branch::{pairs, stability};
use arclength_analysis::course::{self, ToldPoint};
use arclength_analysis::labels::kind;
use arclength_analysis::monitor::{monitored, named};
use arclength_analysis::normal_form::criticality;
use arclength_analysis::{End, Interval, VaryingParameter};
use kingpin::branches::{Along, HopfPoint, MotionBranch};
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Cell, Columns, NamedNumbers, Parameters, Report, Schema, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// A Hopf point in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HopfPointResult {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Angular frequency in rad/s.
    pub frequency: f64,
    /// First Lyapunov coefficient in Kuznetsov's scaling.
    pub first_lyapunov: Option<f64>,
    /// Sense of the bifurcation.
    pub criticality: Criticality,
    /// The uniform motion.
    pub state: NamedNumbers,
    /// HB1, HB2, .. by ascending value.
    pub label: String,
    /// The first Lyapunov coefficient times the frequency, MatCont's scaling.
    #[serde(default)]
    pub c1_real: Option<f64>,
    /// Error of the first Lyapunov coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_lyapunov_error: Option<f64>,
    /// Where there is none: slope of the largest caster angle of the cycles in the parameter, negative where they lie below.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psi_max_slope: Option<f64>,
    /// Why there is none, and whether the uniform motion is another one than `steady` gives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
    /// What moves farthest: `longitudinal` or `lateral`, the king pin, or `yaw`, the wheel about it.
    #[serde(default)]
    pub mode: Option<String>,
    /// Number of unstable directions of the uniform motion just below the value.
    #[serde(default)]
    pub unstable_before: Option<usize>,
    /// The same just above.
    #[serde(default)]
    pub unstable_after: Option<usize>,
    /// Slope in the parameter of the square of the largest psi - psi_0 of the cycles, in rad^2 over its unit, negative where they lie
    /// below.
    #[serde(default)]
    pub psi_max_squared_slope: Option<f64>,
    /// Slope of the largest friction force in the largest psi - psi_0 of the cycles, in N/rad.
    #[serde(default)]
    pub friction_slope: Option<f64>,
    /// Forces of the uniform motion: the limit of those of the cycles.
    #[serde(flatten)]
    pub forces: ForcesResult,
    /// Error estimate of the value.
    #[serde(default)]
    pub location_error: Option<f64>,
    /// Eigenvalues by descending real part.
    #[serde(default)]
    pub eigenvalues: Vec<[Option<f64>; 2]>,
    /// Test functions by the label of the point at which each changes its sign.
    #[serde(default)]
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
}

/// Hopf points along a parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "StoredHopfPoints")]
pub struct HopfResult {
    /// The wheel; its value of the parameter that varies is anywhere.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameter and its interval.
    #[serde(skip)]
    pub interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// Part of the interval in which the uniform motion was followed.
    #[serde(with = "kingpin_report::number")]
    pub searched: [f64; 2],
    /// Whether the uniform motion is stable where it was followed no further, below and above.
    pub stable_at_ends: [Option<bool>; 2],
    /// Why it was followed no further, below and above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ends: Option<[End; 2]>,
    /// What was detected but only bracketed.
    pub unlocated: Vec<BracketedResult>,
    /// Where the uniform motion turns or ends inside the interval, and changes of its stability that were not located, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub course: Vec<String>,
    /// The Hopf points by ascending value.
    pub points: Vec<HopfPointResult>,
    /// The uniform motions that were computed on the way.
    pub motions: Vec<MotionResult>,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// The result as it is read back.
#[derive(Deserialize)]
struct StoredHopfPoints {
    parameters: Parameters,
    along: VaryingParameter,
    #[serde(with = "kingpin_report::number")]
    searched: [f64; 2],
    stable_at_ends: [Option<bool>; 2],
    #[serde(default)]
    ends: Option<[End; 2]>,
    #[serde(default)]
    unlocated: Vec<BracketedResult>,
    #[serde(default)]
    course: Vec<String>,
    points: Vec<HopfPointResult>,
    #[serde(default)]
    motions: Vec<MotionResult>,
}

impl TryFrom<StoredHopfPoints> for HopfResult {
    type Error = KingpinError;

    fn try_from(stored: StoredHopfPoints) -> Result<Self, KingpinError> {
        let VaryingParameter { key, start, end, .. } = &stored.along;
        let wheel = wheel_of(&stored.parameters)?;
        let interval = along(&Interval::new(key, *start, *end))?;
        let dry_friction = NeglectedDryFriction::of(&wheel, &[interval.key()]);
        Ok(Self {
            wheel,
            interval,
            along: stored.along,
            searched: stored.searched,
            stable_at_ends: stored.stable_at_ends,
            ends: stored.ends,
            unlocated: stored.unlocated,
            course: stored.course,
            points: stored.points,
            motions: stored.motions,
            dry_friction,
        })
    }
}

impl HopfResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "kingpin.hopf";

    /// The result of a search.
    ///
    /// # Errors
    /// Those of the wheel at a Hopf point.
    pub(super) fn new(
        wheel: Wheel,
        interval: Along,
        branch: &MotionBranch,
        monitors: &[String],
    ) -> Result<Self, KingpinError> {
        let along = varying(&interval);
        let motions: Vec<MotionResult> =
            branch.motions.iter().map(|motion| MotionResult::new(motion, monitors)).collect();
        let last = |motion: Option<&MotionResult>| {
            let value = motion.map(|motion| (along.key.clone(), motion.value));
            let state = motion.iter().flat_map(|motion| motion.state.0.iter().cloned());
            NamedNumbers(value.into_iter().chain(state).collect())
        };
        let end = |stop: &Option<_>, motion: Option<&MotionResult>| {
            End::monitored(stop.as_ref(), std::slice::from_ref(&along), &branch.monitors, last(motion))
        };
        let ends = [end(&branch.stops[0], motions.first()), end(&branch.stops[1], motions.last())];
        let stable = |motion: Option<&MotionResult>| motion.and_then(|motion| motion.stable);
        Ok(Self {
            wheel,
            interval,
            searched: branch.searched(),
            stable_at_ends: [stable(motions.first()), stable(motions.last())],
            ends: Some(ends),
            unlocated: branch.motions.iter().filter_map(BracketedResult::at).collect(),
            course: course_of(branch),
            points: (0..)
                .zip(&branch.hopf_points)
                .map(|(index, point)| hopf_point(index, point, interval.key(), branch, monitors))
                .collect::<Result<_, _>>()?,
            motions,
            along,
            dry_friction: NeglectedDryFriction::of(&wheel, &[interval.key()]),
        })
    }

    /// The Hopf points.
    fn table(&self) -> Table {
        let monitors = monitored(self.points.iter().map(|point| &point.monitors));
        let heading = self.along.heading();
        let headings = [
            "label",
            &heading,
            "frequency (rad/s)",
            "first Lyapunov coefficient",
            "",
            "mode",
            "stable",
            ForcesResult::HEADING,
        ];
        let mut table = Table::new(headings.into_iter().chain(monitors.iter().copied()));
        for point in &self.points {
            let cells = [
                point.label.as_str().into(),
                point.value.into(),
                point.frequency.into(),
                point.first_lyapunov.into(),
                criticality(point.criticality).into(),
                point.mode.clone().into(),
                point.stable_side().into(),
                point.forces.cell(),
            ];
            let recorded = monitors.iter().map(|name| Cell::from(point.monitors.named(name)));
            table.row(cells.into_iter().chain(recorded));
        }
        table
    }

    /// The uniform motions at which a monitor has a value that was asked for, if there are any.
    fn asked_for(&self) -> Option<Table> {
        let is_asked_for = |motion: &&MotionResult| {
            motion.label.as_deref().is_some_and(|label| kind(label) == SpecialKind::Requested.label())
        };
        let motions: Vec<&MotionResult> = self.motions.iter().filter(is_asked_for).collect();
        let monitors = monitored(motions.iter().map(|motion| &motion.monitors));
        let heading = self.along.heading();
        let headings = ["label", &heading, "stable"].into_iter().chain(monitors.iter().copied());
        let mut table = Table::new(headings);
        for motion in &motions {
            let cells =
                [motion.label.clone().into(), motion.value.into(), stability(motion.stable, false).into()];
            let recorded = monitors.iter().map(|name| Cell::from(motion.monitors.named(name)));
            table.row(cells.into_iter().chain(recorded));
        }
        (!motions.is_empty()).then_some(table)
    }

    /// What was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        self.unlocated.iter().map(|point| point.text(&self.along)).collect()
    }
}

/// What else is to be known of a Hopf point.
fn remark(point: &HopfPoint, key: Key) -> Option<String> {
    let remarks: Vec<String> =
        [no_first_lyapunov(point, key), elsewhere(point)].into_iter().flatten().collect();
    (!remarks.is_empty()).then(|| remarks.join("; "))
}

/// Why a Hopf point has no first Lyapunov coefficient, and what it has instead.
fn no_first_lyapunov(point: &HopfPoint, key: Key) -> Option<String> {
    let straight = point.wheel.towing_yaw_rate() == 0.0;
    if point.first_lyapunov.is_some() || !straight || point.wheel.tyre() != Tyre::Brush {
        return None;
    }
    let reason =
        "no first Lyapunov coefficient exists, for the curvature of the brush law jumps at zero slip";
    let slope = point.psi_max_slope.map(|slope| {
        let side = if slope < 0.0 { "below" } else { "above" };
        let unit = if key.unit() == "1" { String::new() } else { format!(" per {}", key.unit()) };
        format!("; psi_max grows by {} rad{unit} {side} it", readable(slope.abs()))
    });
    Some(reason.to_owned() + &slope.unwrap_or_default())
}

/// That the uniform motion is another one than the wheel has by itself, as behind a fold.
fn elsewhere(point: &HopfPoint) -> Option<String> {
    if point.is_of_wheels_own_motion() {
        return None;
    }
    let motion = point.motion();
    let backwards = if motion.forward_speed() < 0.0 { ", and rolls backwards" } else { "" };
    match point.wheel.uniform_motion() {
        Ok(steady) => Some(format!(
            "the uniform motion has psi = {} rad{backwards}; `steady` gives another one here, with psi = {} rad",
            readable(motion.psi()),
            readable(steady.psi())
        )),
        Err(_) => Some(format!(
            "the uniform motion has psi = {} rad{backwards}; `steady` finds none here",
            readable(motion.psi())
        )),
    }
}

impl HopfPointResult {
    /// On which side of the point the uniform motion is stable.
    pub fn stable_side(&self) -> &'static str {
        match (self.unstable_before, self.unstable_after) {
            (Some(0), _) => "below",
            (_, Some(0)) => "above",
            (Some(_), Some(_)) => "neither",
            _ => "undecided",
        }
    }
}

fn hopf_point(
    index: usize,
    point: &HopfPoint,
    key: Key,
    branch: &MotionBranch,
    monitors: &[String],
) -> Result<HopfPointResult, KingpinError> {
    let motion = branch.motions.iter().find(|motion| {
        motion.value == point.value && matches!(motion.special.as_deref(), Some(SpecialPoint::Hopf(_)))
    });
    let [unstable_before, unstable_after] = point.birth.unstable;
    Ok(HopfPointResult {
        value: point.value,
        frequency: point.frequency,
        first_lyapunov: point.first_lyapunov,
        criticality: point.criticality,
        state: named_state(&point.state),
        label: label(index),
        c1_real: point.detail.c1_real,
        psi_max_slope: point.psi_max_slope,
        remark: remark(point, key),
        mode: Some(point.birth.mode.to_string()),
        unstable_before,
        unstable_after,
        psi_max_squared_slope: point.birth.psi_max_squared_slope,
        friction_slope: point.birth.friction_slope,
        forces: point.motion().forces()?.into(),
        first_lyapunov_error: point.detail.first_lyapunov_error,
        location_error: Some(point.location_error).filter(|error| error.is_finite()),
        eigenvalues: motion.map(|motion| pairs(&motion.eigenvalues)).unwrap_or_default(),
        tests: motion.map(named_tests).unwrap_or_default(),
        monitors: motion.map(|motion| named(monitors, &motion.monitors)).unwrap_or_default(),
    })
}

impl Report for HopfResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &[(self.interval.key(), self.interval.ends().into())])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let key = self.interval.key();
        let (low, high) = self.interval.ends();
        let [low, high] = [low, high].map(readable);
        writeln!(out, "uniform motion at {}", description::on_lines(&self.wheel, &[key]))?;
        writeln!(out, "Hopf points for {key} from {low} to {high} {}\n", key.unit())?;
        self.table().write(out)?;
        for (label, remark) in
            self.points.iter().filter_map(|point| Some((&point.label, point.remark.as_ref()?)))
        {
            writeln!(out, "{label}: {remark}")?;
        }
        for sentence in &self.course {
            writeln!(out, "{sentence}")?;
        }
        if let Some(table) = self.asked_for() {
            writeln!(out, "\nuniform motions asked for\n")?;
            table.write(out)?;
        }
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        let count = |number: Option<usize>| number.map(|number| number as f64);
        let points = || self.points.iter();
        let columns = Columns::new()
            .texts("label", points().map(|point| Some(point.label.clone())))
            .numbers("value", points().map(|point| point.value))
            .unit(self.interval.key().unit())
            .numbers("frequency", points().map(|point| point.frequency))
            .unit("rad/s")
            .optional_numbers("first_lyapunov", points().map(|point| point.first_lyapunov))
            .texts("criticality", points().map(|point| Some(criticality(point.criticality).to_owned())));
        let columns = self.wheel.states().iter().enumerate().fold(columns, |columns, (index, &name)| {
            columns
                .optional_numbers(name, points().map(move |point| point.state.get(index)))
                .unit(states::unit(name))
        });
        let columns = columns
            .optional_numbers("c1_real", points().map(|point| point.c1_real))
            .optional_numbers("location_error", points().map(|point| point.location_error))
            .unit(self.interval.key().unit())
            .complex_numbers(
                "eigenvalue",
                self.wheel.states().len(),
                points().map(|point| &point.eigenvalues),
            )
            .named_numbers("test", points().map(|point| &point.tests))
            .texts("mode", points().map(|point| point.mode.clone()))
            .optional_numbers("unstable_before", points().map(|point| count(point.unstable_before)))
            .optional_numbers("unstable_after", points().map(|point| count(point.unstable_after)))
            .optional_numbers("psi_max_squared_slope", points().map(|point| point.psi_max_squared_slope))
            .optional_numbers("friction_slope", points().map(|point| point.friction_slope))
            .unit("N/rad")
            .named_numbers("monitor", points().map(|point| &point.monitors));
        forces::columns(columns, points().map(|point| &point.forces))
    }

    fn story(&self) -> Option<Story> {
        let mut story = Story::new();
        story.tell(
            "start",
            format!("the uniform motion at {}", description::of(&self.wheel, &[self.interval.key()])),
        );
        if let Some(ends) = &self.ends {
            course::tell_ends(&mut story, ends);
        }
        let place = |motion: &MotionResult| {
            let hopf = self.points.iter().find(|point| point.value == motion.value);
            (motion.clone(), hopf.map(|point| point.label.clone()).or(motion.label.clone()))
        };
        let motions: Vec<(MotionResult, Option<String>)> = self.motions.iter().map(place).collect();
        let places: Vec<ToldPoint<'_>> = motions
            .iter()
            .map(|(motion, label)| ToldPoint {
                value: motion.value,
                stable: motion.stable,
                label: label.as_deref(),
                remark: motion.remark.clone(),
            })
            .collect();
        course::tell_way(&mut story, &self.along, &places);
        self.warnings().into_iter().for_each(|text| story.tell("not located", text));
        let largest = self.points.iter().filter_map(|point| point.location_error).fold(0.0, f64::max);
        if largest > 0.0 {
            story.tell(
                "errors",
                format!("Hopf points are located to {largest:.1e} or better in {}", self.along.key),
            );
        }
        Some(story)
    }
}
