//! A cycle, or a Hopf point, of a branch in a result.

use crate::error::Error;
use crate::states::named_state;
use arclength::branch::SpecialKind;
use arclength::cycle::{Branching, CyclePoint, Orbit};
use arclength_analysis::labels::{is_bifurcation, kind};
use kingpin::branches::HopfPoint;
use kingpin_report::numbers::significant;
use kingpin_report::{Cell, NamedNumbers, Number};
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;

/// Index of the caster angle among the states.
const CASTER_ANGLE: usize = 2;

/// A cycle, or the Hopf point at which a branch starts or ends.
#[derive(Debug, Serialize)]
pub struct CyclePointResult {
    /// Number of the branch, from 1.
    pub branch: u64,
    /// Value of the parameter.
    pub value: Number,
    /// Period in s.
    pub period: f64,
    /// Largest caster angle in rad.
    pub psi_max: f64,
    /// Smallest caster angle in rad.
    pub psi_min: f64,
    /// Floquet multipliers, the largest modulus first.
    pub multipliers: Vec<[f64; 2]>,
    /// How far the computed trivial multiplier is from 1.
    pub trivial_multiplier_error: f64,
    /// Nothing where a multiplier is on the unit circle, or too near to say.
    pub stable: Option<bool>,
    /// Error estimate relative to the amplitudes.
    pub error_estimate: f64,
    /// Of special points and of values asked for.
    pub label: Option<String>,
    /// Largest value of every state.
    pub max: NamedNumbers,
    /// Smallest value of every state.
    pub min: NamedNumbers,
    /// The cycle itself, where a computation can start from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orbit: Option<Orbit>,
    /// The start of the branch that leaves there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branching: Option<Branching>,
}

impl CyclePointResult {
    /// Whether a multiplier is on the unit circle by definition.
    pub fn is_bifurcation(&self) -> bool {
        is_bifurcation(self.label.as_deref())
    }

    /// Whether the uniform motion bifurcates here.
    pub fn is_hopf_point(&self) -> bool {
        self.label.as_deref().is_some_and(|label| kind(label) == SpecialKind::Hopf.label())
    }
}

fn pairs(multipliers: impl IntoIterator<Item = Complex64>) -> Vec<[f64; 2]> {
    multipliers.into_iter().map(|multiplier| [multiplier.re, multiplier.im]).collect()
}

/// A cycle of a branch.
pub(super) fn at_cycle(branch: u64, cycle: &CyclePoint, label: Option<String>) -> CyclePointResult {
    CyclePointResult {
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
pub(super) fn at_hopf(branch: u64, hopf: &HopfPoint, label: String) -> Result<CyclePointResult, Error> {
    let period = TAU / hopf.frequency;
    let eigenvalues = hopf.wheel.uniform_motion()?.eigenvalues();
    let multipliers: Vec<Complex64> =
        eigenvalues.iter().map(|eigenvalue| (eigenvalue * period).exp()).collect();
    let nearest =
        multipliers.iter().map(|multiplier| (multiplier - 1.0).norm()).fold(f64::INFINITY, f64::min);
    Ok(CyclePointResult {
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

/// Its row in a table.
pub(super) fn cells(point: &CyclePointResult) -> [Cell; 8] {
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
