//! Branches of shimmy as a result.

use super::drawn_point::DrawnPoint;
use super::picture;
use super::point::{GRAZING, Role, ShimmyPointResult, ascending, at_motion, at_smooth_cycle, what};
use super::search::Attempt;
use crate::along::varying;
use crate::cycles::{ROLLING_LIMIT, ROLLING_LIMIT_NAME};
use crate::description;
use crate::error::Error;
use crate::forces::{self, ForcesResult};
use crate::parameters::parameters_over;
use crate::states;
use arclength::branch::{LabelCounter, SpecialKind};
use arclength_analysis::cycles::{UnlocatedResult, warnings};
use arclength_analysis::{Control, End, VaryingParameter};
use kingpin::branches::{Along, WheelCycles};
use kingpin::shimmy::{ShimmyError, SlidingBranch, SlidingBranchEnd};
use kingpin::sliding::SLIDING_STATE_NAMES;
use kingpin::{Tyre, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::numbers::{counted, readable};
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Story, Table};
use serde::Serialize;
use std::io::{self, Write};

/// A branch that was followed, by ascending value of the parameter.
pub(super) struct ShimmyBranch {
    attempt: Attempt,
    pub points: Vec<(ShimmyPointResult, Role)>,
    ends: [End; 2],
    unlocated: Vec<UnlocatedResult>,
}

impl ShimmyBranch {
    fn new(
        attempt: Attempt,
        mut points: Vec<(ShimmyPointResult, Role)>,
        along: &VaryingParameter,
        end: impl Fn(usize, NamedNumbers) -> End,
        unlocated: Vec<UnlocatedResult>,
    ) -> Self {
        let last = |point: Option<&(ShimmyPointResult, Role)>| {
            let values = point
                .map(|(point, _)| [(along.key.clone(), point.value), ("period".to_owned(), point.period)]);
            NamedNumbers(values.into_iter().flatten().collect())
        };
        let mut ends = [end(0, last(points.first())), end(1, last(points.last()))];
        if ascending(&mut points) {
            ends.reverse();
        }
        Self { attempt, points, ends, unlocated }
    }

    /// Periods of the motions that it has at a value, between two of its points by the straight line.
    pub(super) fn periods_at(&self, value: f64) -> impl Iterator<Item = f64> {
        self.points.windows(2).filter_map(move |pair| {
            let [(one, _), (two, _)] = pair else { return None };
            let part =
                if one.value == two.value { 0.0 } else { (value - one.value) / (two.value - one.value) };
            (0.0..=1.0).contains(&part).then_some(one.period + part * (two.period - one.period))
        })
    }

    /// Of motions that slide, with their forces.
    ///
    /// # Errors
    /// A motion that cannot be followed again.
    pub(super) fn of_sliding(
        attempt: Attempt,
        branch: &SlidingBranch,
        along: &Along,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let mut points = Vec::with_capacity(branch.points.len());
        for (index, point) in branch.points.iter().enumerate() {
            control.at(&format!("forces, {} of {}", index + 1, branch.points.len()));
            let forces = match point.motion.forces(&Control::none()) {
                Ok(forces) => Some(forces),
                // At a grazing rounding may change the phases.
                Err(ShimmyError::NotConverged { .. }) => None,
                Err(error) => return Err(error.into()),
            };
            points.push((at_motion(point, forces), point.role.into()));
        }
        let along = varying(along);
        let end = |index: usize, last| told(&branch.ends[index], &along, last);
        Ok(Self::new(attempt, points, &along, end, Vec::new()))
    }

    /// Of the cycles of a wheel with a tyre.
    ///
    /// # Errors
    /// A value that the wheel does not take.
    pub(super) fn of_cycles(attempt: Attempt, cycles: WheelCycles, along: &Along) -> Result<Self, Error> {
        let WheelCycles {
            wheel,
            points,
            stops,
            unlocated,
            rolling_limits,
            missed_rolling_limits,
            monitors,
            ..
        } = cycles;
        let points = points.into_iter().enumerate().map(|(index, point)| {
            let role = match point.label {
                _ if rolling_limits.contains(&index) => Role::RollingLimit,
                Some(label) => Role::Special(label.kind),
                None => Role::Step,
            };
            Ok((at_smooth_cycle(point, role, &wheel, along)?, role))
        });
        let points = points.collect::<Result<Vec<_>, Error>>()?;
        let along = varying(along);
        let end = |index: usize, last| {
            End::monitored(stops[index].as_ref(), std::slice::from_ref(&along), &monitors, last)
        };
        let missed = missed_rolling_limits.into_iter();
        let missed = missed.map(|between| UnlocatedResult { test: ROLLING_LIMIT_NAME.to_owned(), between });
        let unlocated = unlocated.iter().map(UnlocatedResult::from).chain(missed).collect();
        Ok(Self::new(attempt, points, &along, end, unlocated))
    }
}

/// Where a branch was found and why it ends.
#[derive(Clone, Debug, Serialize)]
pub struct ShimmyBranchResult {
    /// Its number, from 1.
    pub branch: u64,
    /// The kick from which its first motion was reached.
    pub from: String,
    /// Why it ends, at the first point and at the last one.
    pub ends: [String; 2],
    /// The last good point in either direction.
    pub last: [NamedNumbers; 2],
    /// What to try at either end, where anything is left to do.
    pub remedies: [Option<String>; 2],
    /// What was detected but not located.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unlocated: Vec<UnlocatedResult>,
}

/// Branches of shimmy along a parameter.
#[derive(Clone, Debug, Serialize)]
pub struct ShimmyResult {
    /// The wheel; its value of the parameter that varies is anywhere.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameter and its interval.
    #[serde(skip)]
    pub interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// The branches.
    pub branches: Vec<ShimmyBranchResult>,
    /// Values that were asked for at which no branch has a motion.
    #[serde(skip)]
    pub missed: Vec<f64>,
    /// Their motions, branch by branch.
    pub points: Vec<ShimmyPointResult>,
    /// Every kick that was tried.
    pub tried: Vec<Attempt>,
}

impl ShimmyResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "kingpin.shimmy";

    pub(super) fn new(
        wheel: Wheel,
        interval: Along,
        found: Vec<ShimmyBranch>,
        tried: Vec<Attempt>,
        at: &[f64],
    ) -> Self {
        let along = varying(&interval);
        let is_asked = |value: f64| at.iter().any(|asked| interval.as_found(*asked) == value);
        let (mut labels, mut grazings, mut rolling_limits) = (LabelCounter::default(), 0, 0);
        let (mut points, mut branches) = (Vec::new(), Vec::new());
        for (number, branch) in (1..).zip(found) {
            let ShimmyBranch { attempt, points: motions, ends, unlocated } = branch;
            for (point, role) in motions {
                let label = match role {
                    Role::Step if !is_asked(point.value) => None,
                    // A branch may start at a value that was asked for.
                    Role::Step => Some(labels.next(SpecialKind::Requested).to_string()),
                    Role::Special(kind) => Some(labels.next(kind).to_string()),
                    Role::Grazing => {
                        grazings += 1;
                        Some(format!("{GRAZING}{grazings}"))
                    }
                    Role::RollingLimit => {
                        rolling_limits += 1;
                        Some(format!("{ROLLING_LIMIT}{rolling_limits}"))
                    }
                };
                points.push(ShimmyPointResult { branch: number, label, ..point });
            }
            branches.push(ShimmyBranchResult {
                branch: number,
                from: format!("{} at {}", attempt.kick(), along.at(attempt.value)),
                ends: [0, 1].map(|index| ends[index].cause.clone()),
                remedies: [0, 1].map(|index| ends[index].remedy.clone()),
                last: ends.map(|end| end.last),
                unlocated,
            });
        }
        let is_there = |value: f64| points.iter().any(|point: &ShimmyPointResult| point.value == value);
        let missed = at.iter().copied().filter(|value| !is_there(interval.as_found(*value))).collect();
        Self { wheel, interval, along, branches, missed, points, tried }
    }

    /// What was asked for and not found.
    pub fn warnings(&self) -> Vec<String> {
        let missed = |value: &f64| format!("no shimmy at {}: no branch passes there", self.along.at(*value));
        let unlocated = self.branches.iter().flat_map(|branch| warnings(&branch.unlocated, &self.along));
        self.missed.iter().map(missed).chain(unlocated).collect()
    }

    /// Names of the states that every motion starts from.
    fn states(&self) -> &'static [&'static str] {
        if self.wheel.tyre() == Tyre::Rigid { &SLIDING_STATE_NAMES } else { self.wheel.states() }
    }

    fn points_of(&self, branch: &ShimmyBranchResult) -> Vec<&ShimmyPointResult> {
        self.points.iter().filter(|point| point.branch == branch.branch).collect()
    }
}

/// What of a point decides where a branch is stable.
#[derive(Clone, Copy)]
struct Place {
    value: f64,
    stable: bool,
    bifurcates: bool,
}

impl From<&&ShimmyPointResult> for Place {
    fn from(point: &&ShimmyPointResult) -> Self {
        Self { value: point.value, stable: point.stable == Some(true), bifurcates: point.is_bifurcation() }
    }
}

/// The parts of a branch, as intervals of the parameter, in which it is stable, from bifurcation to bifurcation.
fn stable_parts(places: &[Place]) -> Vec<[f64; 2]> {
    let mut parts: Vec<[f64; 2]> = Vec::new();
    let mut goes_on = false;
    for pair in places.windows(2) {
        let [one, other] = [pair[0], pair[1]];
        // Between a stable motion and a bifurcation, or another stable motion, every one is stable.
        let stable = (one.stable && (other.stable || other.bifurcates)) || (one.bifurcates && other.stable);
        match parts.last_mut() {
            Some([_, end]) if stable && goes_on => *end = other.value,
            _ if stable => parts.push([one.value, other.value]),
            _ => {}
        }
        goes_on = stable;
    }
    parts.into_iter().map(|[one, other]| [one.min(other), one.max(other)]).collect()
}

/// Why a branch ends.
fn told(end: &SlidingBranchEnd, along: &VaryingParameter, last: NamedNumbers) -> End {
    match end {
        SlidingBranchEnd::Continuation(stop) => End::of(stop, std::slice::from_ref(along), last),
        SlidingBranchEnd::Grazing { change, value, .. } => End {
            cause: format!("{change}, at {}; no motion beside it has the other phases", along.at(*value)),
            last,
            remedy: Some("an interval beyond it, where kicked motions may settle on others".to_owned()),
        },
        SlidingBranchEnd::Inexact { error, value } => End {
            cause: format!(
                "beyond {} the motion is known to a part of {error:.1e} only, however short the step",
                along.at(*value)
            ),
            last,
            remedy: Some("an interval beyond it, where kicked motions may settle on others".to_owned()),
        },
        SlidingBranchEnd::NotFollowed { cause, value } => End {
            cause: format!("beyond {} the motion cannot be followed: {cause}", along.at(*value)),
            last,
            remedy: Some("an interval beyond it, where kicked motions may settle on others".to_owned()),
        },
        end => End { cause: end.to_string(), last, remedy: None },
    }
}

impl Report for ShimmyResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &[(self.interval.key(), self.interval.ends().into())])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "{} at {}",
            what(&self.wheel),
            description::on_lines(&self.wheel, &[self.interval.key()])
        )?;
        for branch in &self.branches {
            let points = self.points_of(branch);
            let count = counted(points.len(), "point", "points");
            writeln!(out, "\nbranch {} from {}, {count}", branch.branch, branch.from)?;
            writeln!(out, "  first: {}\n  last:  {}\n", branch.ends[0], branch.ends[1])?;
            let heading = self.along.heading();
            let mut table = Table::new([
                "label",
                &heading,
                "period (s)",
                "psi_max (rad)",
                "psi_min (rad)",
                "largest multiplier",
                "error",
                "slides",
                "phases",
                "",
                "",
            ]);
            let last = points.len().saturating_sub(1);
            for (index, point) in points.iter().enumerate() {
                if point.label.is_some() || index == 0 || index == last {
                    table.row(point.cells());
                }
            }
            table.write(out)?;
            let places: Vec<Place> = points.iter().map(Place::from).collect();
            let part = |[low, high]: [f64; 2]| format!("from {} to {}", readable(low), readable(high));
            let parts: Vec<String> = stable_parts(&places).into_iter().map(part).collect();
            match &parts[..] {
                [] => writeln!(out, "\nno stable shimmy on it")?,
                parts => {
                    let unit = self.interval.key().unit();
                    writeln!(out, "\nstable shimmy for {} {} {unit}", self.along.key, parts.join(" and "))?;
                }
            }
        }
        Ok(())
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let columns = Columns::new()
            .counts("branch", points().map(|point| point.branch))
            .texts("label", points().map(|point| point.label.clone()))
            .numbers("value", points().map(|point| point.value))
            .unit(self.interval.key().unit())
            .numbers("period", points().map(|point| point.period))
            .unit("s")
            .numbers("psi_max", points().map(|point| point.psi_max))
            .unit("rad")
            .numbers("psi_min", points().map(|point| point.psi_min))
            .unit("rad")
            .booleans("stable", points().map(|point| point.stable))
            .numbers("error_estimate", points().map(|point| point.error_estimate))
            .numbers("trivial_multiplier_error", points().map(|point| point.trivial_multiplier_error))
            .complex_numbers("multiplier", self.states().len(), points().map(|point| &point.multipliers))
            .numbers("turns", points().map(|point| f64::from(point.turns)))
            .optional_numbers("psi_0", points().map(|point| point.psi_0))
            .unit("rad")
            .optional_numbers("deviation_max", points().map(|point| point.deviation_max))
            .unit("rad")
            .optional_numbers("deviation_min", points().map(|point| point.deviation_min))
            .unit("rad")
            .numbers("sliding_fraction", points().map(|point| point.sliding_fraction))
            .texts("phases", points().map(|point| Some(point.phases_in_words())))
            .optional_numbers("sliding_power", points().map(|point| point.sliding_power))
            .unit("W");
        let columns = self.states().iter().fold(columns, |columns, &name| {
            columns
                .optional_numbers(name, points().map(move |point| point.state.named(name)))
                .unit(states::unit(name))
        });
        let forces: Vec<&ForcesResult> = points().map(|point| &point.forces).collect();
        forces::columns(columns, forces.into_iter())
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let points: Vec<DrawnPoint> = self.points.iter().map(DrawnPoint::from).collect();
        Ok(Some(picture::diagram(&self.wheel, &self.interval, &points)))
    }

    fn story(&self) -> Option<Story> {
        let mut story = Story::new();
        for attempt in &self.tried {
            story.tell(
                "tried",
                format!("{}, {}: {}", self.along.at(attempt.value), attempt.kick(), attempt.outcome),
            );
        }
        for branch in &self.branches {
            story.tell("branch", format!("{} from {}", branch.branch, branch.from));
            branch.ends.iter().for_each(|end| story.tell("end", end.clone()));
        }
        Some(story)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stable_parts_reach_from_bifurcation_to_bifurcation() {
        let place = |value: f64, word: char| Place { value, stable: word == 's', bifurcates: word == 'b' };
        let parts = |words: &str| {
            let places: Vec<Place> =
                words.chars().enumerate().map(|(index, word)| place(index as f64, word)).collect();
            stable_parts(&places)
        };
        assert_eq!(parts("ubssbuu"), [[1.0, 4.0]]);
        assert_eq!(parts("ssuuss"), [[0.0, 1.0], [4.0, 5.0]]);
        assert_eq!(parts("ssbss"), [[0.0, 4.0]]);
        assert_eq!(parts("uubu"), [[0.0; 2]; 0]);
        // A branch that turns back.
        let back = [place(2.0, 's'), place(1.0, 's'), place(0.5, 'b')];
        assert_eq!(stable_parts(&back), [[0.5, 2.0]]);
    }
}
