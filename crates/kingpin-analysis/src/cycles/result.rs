//! Branches of limit cycles as a result.

use super::followed::{Followed, NotFollowed};
use super::picture;
use super::point::{CyclePointResult, ROLLING_LIMIT, ROLLING_LIMIT_NAME, at_cycle, at_hopf, cells};
use crate::along::{along, varying};
use crate::description;
use crate::error::Error;
use crate::forces::{self, ForcesResult};
use crate::monitors::names;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::{parameters_over, wheel_of};
use crate::states;
use arclength::branch::LabelCounter;
use arclength::cycle::Orbit;
use arclength_analysis::cycles::{CycleResult, UnlocatedResult, tell, warnings};
use arclength_analysis::monitor::{monitored, named};
use arclength_analysis::normal_form::criticality;
use arclength_analysis::{End, Interval, VaryingParameter};
use kingpin::branches::{Along, HopfPoint, MotionMonitor};
use kingpin::{KingpinError, Wheel};
use kingpin_figure::{Figure, FigureError};
use kingpin_report::numbers::{counted, readable};
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Story, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Where a branch starts and why it ends.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct BranchResult {
    /// Its number, from 1.
    pub branch: u64,
    /// The label of what it starts from.
    pub from: String,
    /// Why it ends, at the first point and at the last one.
    pub ends: [String; 2],
    /// The last good point in either direction.
    #[serde(default)]
    pub last: [NamedNumbers; 2],
    /// What to try at either end, where anything is left to do.
    #[serde(default)]
    pub remedies: [Option<String>; 2],
    /// What was detected but not located.
    #[serde(default)]
    pub unlocated: Vec<UnlocatedResult>,
}

impl BranchResult {
    fn ends(&self) -> [End; 2] {
        [0, 1].map(|index| End {
            cause: self.ends[index].clone(),
            last: self.last[index].clone(),
            remedy: self.remedies[index].clone(),
        })
    }
}

/// Branches of limit cycles along a parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "StoredCycles")]
pub struct CyclesResult {
    /// The wheel; its value of the parameter that varies is anywhere.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The parameter and its interval.
    #[serde(skip)]
    pub interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// The branches.
    pub branches: Vec<BranchResult>,
    /// Hopf points from which no branch could be followed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_followed: Vec<NotFollowed>,
    /// Where the uniform motion on which Hopf points were sought turns or ends inside the interval, and changes of its stability that
    /// were not located, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub course: Vec<String>,
    /// Values that were asked for at which there is no cycle.
    #[serde(skip)]
    pub missed: Vec<f64>,
    /// Their cycles, branch by branch.
    pub points: Vec<CyclePointResult>,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// The result as it is read back.
#[derive(Deserialize)]
struct StoredCycles {
    parameters: Parameters,
    along: VaryingParameter,
    branches: Vec<BranchResult>,
    #[serde(default)]
    not_followed: Vec<NotFollowed>,
    #[serde(default)]
    course: Vec<String>,
    points: Vec<CyclePointResult>,
}

impl TryFrom<StoredCycles> for CyclesResult {
    type Error = KingpinError;

    fn try_from(stored: StoredCycles) -> Result<Self, KingpinError> {
        let VaryingParameter { key, start, end, .. } = &stored.along;
        let wheel = wheel_of(&stored.parameters)?;
        let interval = along(&Interval::new(key, *start, *end))?;
        Ok(Self {
            wheel,
            interval,
            dry_friction: NeglectedDryFriction::of(&wheel, &[interval.key()]),
            along: stored.along,
            branches: stored.branches,
            not_followed: stored.not_followed,
            course: stored.course,
            missed: Vec::new(),
            points: stored.points,
        })
    }
}

impl CyclesResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "kingpin.cycles";

    /// The result of branches in their order, and the values that were asked for at which there is no cycle.
    ///
    /// # Errors
    /// [`Error::Wheel`] where a Hopf point has no uniform motion.
    pub(super) fn new(
        wheel: Wheel,
        interval: Along,
        Followed { branches: followed, not_followed }: Followed,
        missed: Vec<f64>,
        monitors: &[MotionMonitor<Orbit>],
    ) -> Result<Self, Error> {
        let along = varying(&interval);
        let recorded = names(monitors);
        let mut labels = LabelCounter::default();
        let mut all = Vec::new();
        let mut branches = Vec::new();
        let mut rolling_limits = 0;
        for (number, branch) in (1..).zip(followed) {
            let mut points = Vec::new();
            if let Some(hopf) = &branch.hopf {
                points.push(at_hopf(number, hopf, branch.origin.clone())?);
            }
            for (index, cycle) in branch.cycles.points.into_iter().enumerate() {
                // Numbered along the whole result.
                let label = if branch.cycles.rolling_limits.contains(&index) {
                    rolling_limits += 1;
                    Some(format!("{ROLLING_LIMIT}{rolling_limits}"))
                } else {
                    cycle.label.map(|label| labels.next(label.kind).to_string())
                };
                let monitors = named(&recorded, &cycle.monitors);
                let mut point = at_cycle(number, cycle, label, (&wheel, &interval))?;
                point.cycle.monitors = monitors;
                points.push(point);
            }
            if let Some((label, hopf)) = &branch.reached {
                points.push(at_hopf(number, hopf, label.clone())?);
            }
            let last = |point: Option<&CyclePointResult>| {
                let values = point.map(|CyclePointResult { cycle, .. }| {
                    [(along.key.clone(), cycle.value), ("period".to_owned(), cycle.period)]
                });
                NamedNumbers(values.into_iter().flatten().collect())
            };
            let missed = branch.cycles.missed_rolling_limits.into_iter();
            let missed =
                missed.map(|between| UnlocatedResult { test: ROLLING_LIMIT_NAME.to_owned(), between });
            let unlocated = branch.cycles.unlocated.iter().map(UnlocatedResult::from).chain(missed).collect();
            let [first, second] = &branch.cycles.stops;
            let varying = std::slice::from_ref(&along);
            let words = &branch.cycles.monitors;
            let first = match (first, &branch.hopf) {
                (Some(stop), _) => End::monitored(Some(stop), varying, words, last(points.first())),
                (None, Some(hopf)) => {
                    End { cause: birth(hopf, &branch.origin), ..End::start(last(points.first())) }
                }
                (None, None) => {
                    End { cause: format!("starts at {}", branch.origin), ..End::start(last(points.first())) }
                }
            };
            let ends = [first, End::monitored(second.as_ref(), varying, words, last(points.last()))];
            branches.push(BranchResult {
                branch: number,
                from: branch.origin,
                ends: [0, 1].map(|index| ends[index].cause.clone()),
                remedies: [0, 1].map(|index| ends[index].remedy.clone()),
                last: ends.map(|end| end.last),
                unlocated,
            });
            all.extend(points);
        }
        let dry_friction = NeglectedDryFriction::of(&wheel, &[interval.key()]);
        Ok(Self {
            wheel,
            interval,
            along,
            branches,
            not_followed,
            course: Vec::new(),
            missed,
            points: all,
            dry_friction,
        })
    }

    /// From where no branch could be followed, what was asked for and not found, and what was detected but not located.
    pub fn warnings(&self) -> Vec<String> {
        let unlocated: Vec<UnlocatedResult> =
            self.branches.iter().flat_map(|branch| branch.unlocated.iter().cloned()).collect();
        let missed = |value: &f64| format!("no cycle at {}: no branch passes there", self.missing(*value));
        let missed = self.missed.iter().map(missed);
        let not_followed = self.not_followed.iter().map(|point| point.text(&self.interval));
        not_followed.chain(missed).chain(warnings(&unlocated, &self.along)).collect()
    }

    /// The labelled points of a branch and its ends.
    fn table(&self, points: &[&CyclePointResult]) -> Table {
        let monitors = monitored(points.iter().map(|point| &point.cycle.monitors));
        let heading = self.along.heading();
        let headings = [
            "label",
            &heading,
            "period (s)",
            "psi_max (rad)",
            "psi_min (rad)",
            "largest multiplier",
            "error",
            ForcesResult::HEADING,
        ];
        let mut table = Table::new(headings.into_iter().chain(monitors.iter().copied()).chain(["", ""]));
        let last = points.len().saturating_sub(1);
        for (index, point) in points.iter().enumerate() {
            if point.cycle.label.is_some() || index == 0 || index == last {
                table.row(cells(point, &monitors));
            }
        }
        table
    }

    fn missing(&self, value: f64) -> String {
        format!("{} = {}", self.along.key, readable(value))
    }

    fn points_of(&self, branch: &BranchResult) -> Vec<&CyclePointResult> {
        self.points.iter().filter(|point| point.branch == branch.branch).collect()
    }
}

/// Of what kind the Hopf point is at which a branch starts.
fn birth(hopf: &HopfPoint, label: &str) -> String {
    let kind = criticality(hopf.criticality);
    if hopf.psi_max_slope.is_some() {
        format!(
            "starts at the Hopf point {label}, {kind} by the growth of its cycles (no first Lyapunov coefficient exists)"
        )
    } else {
        format!("starts at the {kind} Hopf point {label}")
    }
}

impl Report for CyclesResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        parameters_over(&self.wheel, &[(self.interval.key(), self.interval.ends().into())])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "limit cycles at {}", description::on_lines(&self.wheel, &[self.interval.key()]))?;
        for sentence in &self.course {
            writeln!(out, "{sentence}")?;
        }
        for branch in &self.branches {
            let points = self.points_of(branch);
            let count = counted(points.len(), "point", "points");
            writeln!(out, "\nbranch {} from {}, {count}", branch.branch, branch.from)?;
            let [first, last] = branch.ends();
            writeln!(out, "  first: {}\n  last:  {}\n", first.text(), last.text())?;
            self.table(&points).write(out)?;
        }
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        let cycles = || self.points.iter().map(|point| &point.cycle);
        let mut columns = Columns::new()
            .counts("branch", self.points.iter().map(|point| point.branch))
            .texts("label", cycles().map(|cycle| cycle.label.clone()))
            .numbers("value", cycles().map(|cycle| cycle.value))
            .unit(self.interval.key().unit())
            .numbers("period", cycles().map(|cycle| cycle.period))
            .unit("s")
            .numbers("psi_max", self.points.iter().map(|point| point.psi_max))
            .unit("rad")
            .numbers("psi_min", self.points.iter().map(|point| point.psi_min))
            .unit("rad")
            .booleans("stable", cycles().map(|cycle| cycle.stable))
            .numbers("error_estimate", cycles().map(|cycle| cycle.error_estimate))
            .numbers("trivial_multiplier_error", cycles().map(|cycle| cycle.trivial_multiplier_error))
            .complex_numbers(
                "multiplier",
                self.wheel.states().len(),
                cycles().map(|cycle| &cycle.multipliers),
            )
            .counts("intervals", cycles().map(|cycle| cycle.intervals as u64));
        for &name in self.wheel.states() {
            let unit = states::unit(name);
            columns = columns
                .optional_numbers(format!("max_{name}"), cycles().map(move |cycle| cycle.max.named(name)))
                .unit(unit)
                .optional_numbers(format!("min_{name}"), cycles().map(move |cycle| cycle.min.named(name)))
                .unit(unit);
        }
        columns = columns
            .named_numbers("test", cycles().map(|cycle| &cycle.tests))
            .named_numbers("monitor", cycles().map(|cycle| &cycle.monitors))
            .optional_numbers("psi_0", self.points.iter().map(|point| point.psi_0))
            .unit("rad")
            .optional_numbers("deviation_max", self.points.iter().map(|point| point.deviation_max))
            .unit("rad")
            .optional_numbers("deviation_min", self.points.iter().map(|point| point.deviation_min))
            .unit("rad");
        forces::columns(columns, self.points.iter().map(|point| &point.forces))
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        Ok(Some(picture::bifurcation_diagram(&self.wheel, &self.interval, &self.points, &[])))
    }

    fn story(&self) -> Option<Story> {
        let mut story = Story::new();
        for branch in &self.branches {
            let cycles: Vec<&CycleResult> =
                self.points_of(branch).into_iter().map(|point| &point.cycle).collect();
            story.tell("branch", format!("{} from {}", branch.branch, branch.from));
            tell(&mut story, &self.along, &branch.ends(), &branch.unlocated, &cycles);
        }
        Some(story)
    }
}
