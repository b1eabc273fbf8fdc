//! Branches of limit cycles as a result.

use super::{Branch, picture};
use crate::along::{VaryingParameter, as_followed};
use crate::commands::hopf::{criticality, named_state};
use crate::description;
use crate::error::Error;
use crate::wheel_options::parameters_of;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{Branching, CyclePoint, Orbit};
use arclength_analysis::labels::{Labels, is_bifurcation, kind};
use kingpin::Wheel;
use kingpin::branches::{Along, HopfPoint};
use kingpin::rolling::STATE_NAMES;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::Columns;
use kingpin_report::Report;
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Cell, Table};
use kingpin_report::{NamedNumbers, Number, Schema};
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use std::io::{self, Write};

/// Index of the caster angle among the states.
const CASTER_ANGLE: usize = 2;

/// A cycle, or the Hopf point at which a branch starts or ends.
#[derive(Debug, Serialize)]
pub struct PointReport {
    pub branch: u64,
    pub value: Number,
    pub period: f64,
    pub psi_max: f64,
    pub psi_min: f64,
    pub multipliers: Vec<[f64; 2]>,
    /// How far the computed trivial multiplier is from 1.
    pub trivial_multiplier_error: f64,
    /// Nothing where a multiplier is on the unit circle, or too near to say.
    pub stable: Option<bool>,
    pub error_estimate: f64,
    pub label: Option<String>,
    /// Largest and smallest value of every state.
    pub max: NamedNumbers,
    pub min: NamedNumbers,
    /// The cycle itself, where a computation can start from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orbit: Option<Orbit>,
    /// The start of the branch that leaves there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branching: Option<Branching>,
}

/// Where a branch starts and why it ends.
#[derive(Debug, Serialize)]
struct BranchReport {
    branch: u64,
    from: String,
    /// At the first point and at the last one.
    ends: [String; 2],
}

/// Branches of limit cycles along a parameter.
#[derive(Debug, Serialize)]
pub struct CyclesReport {
    #[serde(skip)]
    pub wheel: Wheel,
    #[serde(skip)]
    pub interval: Along,
    along: VaryingParameter,
    branches: Vec<BranchReport>,
    pub points: Vec<PointReport>,
}

impl CyclesReport {
    /// The result of branches in their order.
    ///
    /// # Errors
    /// [`Error::Wheel`] where a Hopf point has no uniform motion.
    pub(super) fn new(wheel: Wheel, interval: Along, branches: &[Branch]) -> Result<Self, Error> {
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
            ends.push(BranchReport {
                branch: number,
                from: branch.origin.clone(),
                ends: [first, ending(&interval, last)],
            });
        }
        Ok(Self { wheel, interval, along: interval.into(), branches: ends, points })
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

fn pairs(multipliers: impl IntoIterator<Item = Complex64>) -> Vec<[f64; 2]> {
    multipliers.into_iter().map(|multiplier| [multiplier.re, multiplier.im]).collect()
}

fn at_cycle(branch: u64, cycle: &CyclePoint, label: Option<String>) -> PointReport {
    PointReport {
        branch,
        value: Number(cycle.value),
        period: cycle.period,
        psi_max: cycle.max[CASTER_ANGLE],
        psi_min: cycle.min[CASTER_ANGLE],
        multipliers: pairs(cycle.multipliers.iter().copied()),
        trivial_multiplier_error: cycle.trivial_multiplier_error,
        stable: cycle.stable,
        error_estimate: cycle.error_estimate,
        orbit: label.as_ref().map(|_| cycle.orbit.clone()),
        branching: cycle.branching.clone(),
        label,
        max: named_state(&cycle.max),
        min: named_state(&cycle.min),
    }
}

/// The Hopf point as a cycle of no amplitude: its multipliers are the exponentials of the eigenvalues.
fn at_hopf(branch: u64, hopf: &HopfPoint, label: String) -> Result<PointReport, Error> {
    let period = TAU / hopf.frequency;
    let eigenvalues = hopf.wheel.uniform_motion()?.eigenvalues();
    let multipliers: Vec<Complex64> =
        eigenvalues.iter().map(|eigenvalue| (eigenvalue * period).exp()).collect();
    let nearest =
        multipliers.iter().map(|multiplier| (multiplier - 1.0).norm()).fold(f64::INFINITY, f64::min);
    Ok(PointReport {
        branch,
        value: Number(hopf.value),
        period,
        psi_max: hopf.state[CASTER_ANGLE],
        psi_min: hopf.state[CASTER_ANGLE],
        multipliers: pairs(multipliers),
        trivial_multiplier_error: nearest,
        stable: None,
        error_estimate: 0.0,
        label: Some(label),
        max: named_state(&hopf.state),
        min: named_state(&hopf.state),
        orbit: None,
        branching: None,
    })
}

impl Report for CyclesReport {
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
            let points: Vec<&PointReport> =
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
        Ok(Some(picture::bifurcation_diagram(self)))
    }
}

impl PointReport {
    /// Whether a multiplier is on the unit circle by definition.
    pub fn is_bifurcation(&self) -> bool {
        is_bifurcation(self.label.as_deref())
    }

    /// Whether the uniform motion bifurcates here.
    pub fn is_hopf_point(&self) -> bool {
        self.label.as_deref().is_some_and(|label| kind(label) == SpecialKind::Hopf.label())
    }
}

fn cells(point: &PointReport) -> [Cell; 8] {
    let modulus = |multiplier: &[f64; 2]| multiplier[0].hypot(multiplier[1]);
    // All but the trivial one, which is the nearest to 1.
    let distance = |multiplier: &[f64; 2]| (multiplier[0] - 1.0).hypot(multiplier[1]);
    let trivial = (0..point.multipliers.len())
        .min_by(|&a, &b| distance(&point.multipliers[a]).total_cmp(&distance(&point.multipliers[b])));
    let others = point.multipliers.iter().enumerate().filter(|(index, _)| Some(*index) != trivial);
    let largest = others.map(|(_, multiplier)| modulus(multiplier)).max_by(f64::total_cmp);
    let stability = match point.stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None if point.is_bifurcation() => "",
        None => "undecided",
    };
    [
        point.label.clone().into(),
        point.value.0.into(),
        point.period.into(),
        point.psi_max.into(),
        point.psi_min.into(),
        largest.into(),
        Cell::Text(significant(point.error_estimate, 2)),
        stability.into(),
    ]
}
