//! A cycle, or a Hopf point, of a branch in a result.

use crate::error::Error;
use crate::forces::ForcesResult;
use crate::states::named_state;
use arclength::branch::SpecialKind;
use arclength::cycle::CyclePoint;
use arclength_analysis::branch::{pairs, stability};
use arclength_analysis::cycles::{AlongCycle, CycleResult};
use arclength_analysis::labels::{is_bifurcation, kind};
use kingpin::branches::{Along, HopfPoint};
use kingpin::{KingpinError, Wheel};
use kingpin_report::numbers::significant;
use kingpin_report::{Cell, NamedNumbers};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Index of the caster angle among the states.
const CASTER_ANGLE: usize = 2;

/// Label of cycles whose largest friction force is mu_s N.
pub(crate) const ROLLING_LIMIT: &str = "RL";

/// What such a cycle is.
pub(crate) const ROLLING_LIMIT_NAME: &str = "rolling limit";

/// A cycle, or the Hopf point at which a branch starts or ends.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CyclePointResult {
    /// Number of the branch, from 1.
    pub branch: u64,
    /// Largest caster angle in rad.
    pub psi_max: f64,
    /// Smallest caster angle in rad.
    pub psi_min: f64,
    /// Caster angle of the uniform motion in rad; nothing where there is none.
    #[serde(default)]
    pub psi_0: Option<f64>,
    /// Largest psi - psi_0 in rad.
    #[serde(default)]
    pub deviation_max: Option<f64>,
    /// Smallest psi - psi_0 in rad.
    #[serde(default)]
    pub deviation_min: Option<f64>,
    /// The forces along it.
    #[serde(flatten)]
    pub forces: ForcesResult,
    /// The cycle.
    #[serde(flatten)]
    pub cycle: CycleResult,
}

impl CyclePointResult {
    /// Whether a multiplier is on the unit circle by definition.
    pub fn is_bifurcation(&self) -> bool {
        is_bifurcation(self.cycle.label.as_deref())
    }

    /// Whether it stands here because there the largest friction force is mu_s N.
    pub fn is_rolling_limit(&self) -> bool {
        self.cycle.label.as_deref().is_some_and(|label| kind(label) == ROLLING_LIMIT)
    }

    /// Whether the uniform motion bifurcates here.
    pub fn is_hopf_point(&self) -> bool {
        self.cycle.label.as_deref().is_some_and(|label| kind(label) == SpecialKind::Hopf.label())
    }
}

/// A cycle of a branch of a wheel along a parameter.
///
/// # Errors
/// A value that the wheel does not take.
pub(crate) fn at_cycle(
    branch: u64,
    cycle: CyclePoint,
    label: Option<String>,
    (wheel, along): (&Wheel, &Along),
) -> Result<CyclePointResult, KingpinError> {
    let wheel = wheel.with(along.key(), cycle.value)?;
    let forces = wheel.cycle_forces(&cycle.orbit)?;
    let psi_0 = wheel.uniform_motion().ok().map(|motion| motion.psi());
    let (psi_max, psi_min) = (cycle.max[CASTER_ANGLE], cycle.min[CASTER_ANGLE]);
    Ok(CyclePointResult {
        branch,
        psi_max,
        psi_min,
        psi_0,
        deviation_max: psi_0.map(|angle| psi_max - angle),
        deviation_min: psi_0.map(|angle| psi_min - angle),
        forces: forces.into(),
        cycle: CycleResult::new(cycle, label, named_state),
    })
}

/// The Hopf point as a cycle of no amplitude: its multipliers are the exponentials of the eigenvalues.
pub(super) fn at_hopf(branch: u64, hopf: &HopfPoint, label: String) -> Result<CyclePointResult, Error> {
    let period = TAU / hopf.frequency;
    let motion = hopf.motion();
    let eigenvalues = motion.eigenvalues();
    let multipliers: Vec<Complex64> =
        eigenvalues.iter().map(|eigenvalue| (eigenvalue * period).exp()).collect();
    let nearest =
        multipliers.iter().map(|multiplier| (multiplier - 1.0).norm()).fold(f64::INFINITY, f64::min);
    let coefficients = [
        ("first_lyapunov", hopf.first_lyapunov),
        ("first_lyapunov_error", hopf.detail.first_lyapunov_error),
        ("c1_real", hopf.detail.c1_real),
    ];
    let coefficients = coefficients.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    Ok(CyclePointResult {
        branch,
        psi_max: hopf.state[CASTER_ANGLE],
        psi_min: hopf.state[CASTER_ANGLE],
        psi_0: Some(hopf.state[CASTER_ANGLE]),
        deviation_max: Some(0.0),
        deviation_min: Some(0.0),
        forces: motion.forces()?.into(),
        cycle: CycleResult {
            value: hopf.value,
            period,
            max: named_state(&hopf.state),
            min: named_state(&hopf.state),
            aux: AlongCycle::default(),
            multipliers: pairs(&multipliers),
            multiplier_errors: Vec::new(),
            trivial_multiplier_error: nearest,
            stable: None,
            neutral: false,
            error_estimate: 0.0,
            value_error: None,
            intervals: 0,
            label: Some(label),
            tests: NamedNumbers::default(),
            monitors: NamedNumbers::default(),
            normal_form: NamedNumbers(coefficients.collect()),
            orbit: None,
            branching: None,
        },
    })
}

/// Its row in a table, with what is monitored by these names.
pub(super) fn cells(point: &CyclePointResult, monitors: &[&str]) -> Vec<Cell> {
    let cycle = &point.cycle;
    // All but the trivial multiplier, which is the nearest to 1.
    let multipliers: Vec<Complex64> = cycle
        .multipliers
        .iter()
        .filter_map(|[real, imaginary]| Some(Complex64::new((*real)?, (*imaginary)?)))
        .collect();
    let distance = |index: usize| (multipliers[index] - 1.0).norm();
    let trivial = (0..multipliers.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let others = multipliers.iter().enumerate().filter(|(index, _)| Some(*index) != trivial);
    let largest = others.map(|(_, multiplier)| multiplier.norm()).max_by(f64::total_cmp);
    let remark = match point {
        _ if point.is_rolling_limit() => "needs all of the static friction".to_owned(),
        _ if point.is_hopf_point() => String::new(),
        _ => cycle.remark(),
    };
    let mut cells: Vec<Cell> = vec![
        cycle.label.clone().into(),
        cycle.value.into(),
        cycle.period.into(),
        point.psi_max.into(),
        point.psi_min.into(),
        largest.into(),
        Cell::Text(significant(cycle.error_estimate, 2)),
        point.forces.cell(),
    ];
    cells.extend(monitors.iter().map(|name| Cell::from(cycle.monitors.named(name))));
    cells.extend([stability(cycle.stable, point.is_bifurcation()).into(), Cell::from(remark)]);
    cells
}
