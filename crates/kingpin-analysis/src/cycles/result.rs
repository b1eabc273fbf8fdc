//! Branches of limit cycles as a result.

use super::followed::FollowedBranch;
use super::picture;
use super::point::{CyclePointResult, at_cycle, at_hopf, cells};
use crate::along::{as_followed, varying};
use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use arclength::continuation::Stop;
use arclength_analysis::VaryingParameter;
use arclength_analysis::labels::Labels;
use arclength_analysis::normal_form::criticality;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin::rolling::STATE_NAMES;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Report, Schema, Table};
use serde::Serialize;
use std::io::{self, Write};

/// Where a branch starts and why it ends.
#[derive(Debug, Serialize)]
pub struct BranchResult {
    /// Its number, from 1.
    pub branch: u64,
    /// The label of what it starts from.
    pub from: String,
    /// At the first point and at the last one.
    pub ends: [String; 2],
}

/// Branches of limit cycles along a parameter.
#[derive(Debug, Serialize)]
pub struct CyclesResult {
    #[serde(skip)]
    wheel: Wheel,
    #[serde(skip)]
    interval: Along,
    /// The parameter that varies.
    pub along: VaryingParameter,
    /// The branches.
    pub branches: Vec<BranchResult>,
    /// Values that were asked for at which there is no cycle.
    #[serde(skip)]
    missed: Vec<f64>,
    /// Their cycles, branch by branch.
    pub points: Vec<CyclePointResult>,
}

impl CyclesResult {
    /// The result of branches in their order.
    ///
    /// # Errors
    /// [`Error::Wheel`] where a Hopf point has no uniform motion.
    pub(super) fn new(
        wheel: Wheel,
        interval: Along,
        branches: &[FollowedBranch],
        missed: Vec<f64>,
    ) -> Result<Self, Error> {
        let mut labels = Labels::default();
        let mut points = Vec::new();
        let mut ends = Vec::new();
        for (number, branch) in (1..).zip(branches) {
            if let Some(hopf) = &branch.hopf {
                points.push(at_hopf(number, hopf, branch.origin.clone())?);
            }
            for cycle in &branch.cycles.points {
                points.push(at_cycle(number, cycle, labels.of(cycle)));
            }
            if let Some((label, hopf)) = &branch.reached {
                points.push(at_hopf(number, hopf, label.clone())?);
            }
            let (first, last) = &branch.cycles.stops;
            let first = match (first, &branch.hopf) {
                (Some(stop), _) => ending(&interval, stop),
                (None, Some(hopf)) => {
                    format!("starts at the {} Hopf point {}", criticality(hopf.criticality), branch.origin)
                }
                (None, None) => format!("starts at {}", branch.origin),
            };
            ends.push(BranchResult {
                branch: number,
                from: branch.origin.clone(),
                ends: [first, ending(&interval, last)],
            });
        }
        Ok(Self { wheel, interval, along: varying(&interval), branches: ends, points, missed })
    }

    /// What is worth knowing about it.
    pub fn warnings(&self) -> Vec<String> {
        let key = self.interval.key();
        let missed = self.missed.iter();
        missed
            .map(|value| format!("no cycle at {key} = {}: no branch passes there", readable(*value)))
            .collect()
    }
}

/// Why a branch ends, in values of the parameter.
fn ending(along: &Along, stop: &Stop) -> String {
    let at = |value: f64| description::quantity(along.key(), as_followed(along, value));
    match stop {
        Stop::RangeEnd { value, .. } => format!("reached the end of the interval, {}", at(*value)),
        Stop::HopfPoint { parameter, frequency, .. } => format!(
            "the cycles shrink to a Hopf point at {} with angular frequency {} rad/s",
            at(*parameter),
            readable(*frequency)
        ),
        Stop::PeriodUnbounded { period, parameter } => format!(
            "the period grows without bound ({} s at {}): a homoclinic or heteroclinic orbit is near",
            readable(*period),
            at(*parameter)
        ),
        other => other.to_string(),
    }
}

impl Report for CyclesResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.cycles")
    }

    fn parameters(&self) -> NamedNumbers {
        parameters_of(&self.wheel, &[self.interval.key()])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let key = self.interval.key();
        writeln!(out, "limit cycles at {}", description::of(&self.wheel, &[key]))?;
        for branch in &self.branches {
            let count = self.points.iter().filter(|point| point.branch == branch.branch).count();
            writeln!(out, "\nbranch {} from {}, {count} points", branch.branch, branch.from)?;
            writeln!(out, "  first: {}\n  last:  {}\n", branch.ends[0], branch.ends[1])?;
            let mut table = Table::new([
                "label".to_owned(),
                format!("{key} ({})", key.unit()),
                "period (s)".to_owned(),
                "psi_max (rad)".to_owned(),
                "psi_min (rad)".to_owned(),
                "largest multiplier".to_owned(),
                "error".to_owned(),
                String::new(),
            ]);
            let points: Vec<&CyclePointResult> =
                self.points.iter().filter(|point| point.branch == branch.branch).collect();
            let last = points.len().saturating_sub(1);
            for (index, point) in points.iter().enumerate() {
                if point.label.is_some() || index == 0 || index == last {
                    table.row(cells(point));
                }
            }
            table.write(out)?;
        }
        Ok(())
    }

    fn columns(&self) -> Columns {
        let points = || self.points.iter();
        let mut columns = Columns::new()
            .counts("branch", points().map(|point| point.branch))
            .texts("label", points().map(|point| point.label.clone()))
            .numbers("value", points().map(|point| point.value.0))
            .numbers("period", points().map(|point| point.period))
            .numbers("psi_max", points().map(|point| point.psi_max))
            .numbers("psi_min", points().map(|point| point.psi_min))
            .booleans("stable", points().map(|point| point.stable))
            .numbers("error_estimate", points().map(|point| point.error_estimate))
            .numbers("trivial_multiplier_error", points().map(|point| point.trivial_multiplier_error));
        for number in 0..STATE_NAMES.len() {
            for (part, name) in ["real", "imaginary"].into_iter().enumerate() {
                columns = columns.optional_numbers(
                    format!("multiplier_{}_{name}", number + 1),
                    points().map(|point| point.multipliers.get(number).map(|multiplier| multiplier[part])),
                );
            }
        }
        columns
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        Ok(Some(picture::bifurcation_diagram(&self.wheel, &self.interval, &self.points)))
    }
}
