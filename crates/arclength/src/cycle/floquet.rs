//! Floquet multipliers of a cycle from the condensed blocks of its collocation system.
//!
//! The multiplier 1 that belongs to the direction of the flow is split off exactly: at every mesh point a
//! reflection maps that direction onto the first axis, and what remains of the blocks `R_j` are factors of
//! size `n - 1` whose product has the other multipliers. At a fold of cycles, where 1 is a double and
//! defective eigenvalue of the monodromy matrix, this keeps the other multiplier accurate to rounding instead
//! of its square root. The products are never formed (Fairgrieve and Jepson 1991; Lust 2001): the multipliers
//! come from a periodic Schur decomposition.

use super::deflation::Deflated;
use super::volume::Volume;
use crate::collocation::condensation::Jump;
use crate::collocation::equations::Collocation;
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::events::Spectrum;
use crate::error::Error;
use crate::linear::multiplier::Multiplier;
use crate::linear::periodic_schur::PeriodicSchur;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Logarithms of multipliers are not followed below this.
const SMALLEST_LOGARITHM: f64 = -700.0;
/// Logarithm of the product of two multipliers above which the test of torus bifurcations saturates.
const SATURATION: f64 = 0.1;

/// Logarithms of multipliers near one, and of those that discretisation may have kept from it.
const NEAR_ONE: f64 = 1.0;
const NOT_FAR_FROM_ONE: f64 = 10.0;
/// Integral of the divergence below which directions die out within a period, which no mesh of a cycle resolves.
const DEAD: f64 = -30.0;
/// The two sides of Liouville's formula differ by this at most where the multipliers are resolved.
pub(super) const DEFECT: f64 = 1e-3;
/// Difference of the two sides of Liouville's formula above which the multipliers are wrong.
const CONTRADICTION: f64 = 0.05;

/// Errors of multipliers over what their product shows of them.
const CANCELLATION: f64 = 10.0;

/// Floquet multipliers of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Floquet {
    /// The multipliers other than the trivial one, largest modulus first.
    pub nontrivial: Vec<Multiplier>,
    /// The trivial multiplier as computed.
    pub trivial: f64,
    /// How far the computed trivial multiplier, and with it the split, is from exact.
    pub trivial_error: f64,
    /// The integral of the divergence of the field over the period: by Liouville's formula the logarithm of the product of all
    /// multipliers. Where the state jumps the logarithms of the determinants are in it.
    pub divergence: f64,
    /// Sign of the product of all multipliers: that of a flow is positive, where the state jumps it need not be.
    pub sign: f64,
    /// Relative error of the multipliers where it was measured, else zero.
    pub measured_error: f64,
}

/// How many multipliers are outside the unit circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UnstableCount {
    pub count: usize,
    /// Whether that is certain: none is closer to the circle than the error of the trivial one, and they do not contradict each other.
    pub is_certain: bool,
}

/// The test function of torus bifurcations.
pub(crate) struct TorusTest {
    pub product: f64,
    /// Number of pairs that are on the unit circle within the error.
    pub undecided: usize,
}

impl Floquet {
    /// All multipliers as complex numbers, the trivial one among them, largest modulus first.
    pub(crate) fn multipliers(&self) -> Vec<Complex64> {
        let mut all: Vec<Complex64> =
            self.nontrivial.iter().map(|multiplier| multiplier.to_complex()).collect();
        let place = all.partition_point(|multiplier| multiplier.norm() > self.trivial.abs());
        all.insert(place, Complex64::from(self.trivial));
        all
    }

    /// Relative errors of all multipliers in their order, from those of the nontrivial ones.
    pub(super) fn errors(&self, nontrivial: &[f64]) -> Vec<f64> {
        let mut all = nontrivial.to_vec();
        let place = self.nontrivial.partition_point(|one| one.log_modulus > self.trivial.abs().ln());
        all.insert(place.min(all.len()), self.trivial_error);
        all
    }

    /// The nontrivial multipliers outside the unit circle.
    pub(crate) fn unstable(&self) -> UnstableCount {
        let margin = self.margin();
        let outside = self.nontrivial.iter().filter(|multiplier| multiplier.log_modulus > 0.0).count();
        let is_certain = self.nontrivial.iter().all(|multiplier| multiplier.log_modulus.abs() > margin);
        UnstableCount { count: outside, is_certain: is_certain && !self.is_contradictory() }
    }

    /// Whether the cycle is stable, where that is certain: one multiplier that is outside for certain decides it.
    pub(crate) fn is_stable(&self) -> Option<bool> {
        // Errors of the multipliers are of the size of those that their product shows, and may cancel there in part.
        let margin = self.margin().max(CANCELLATION * self.defect());
        self.verdict(self.nontrivial.iter().map(|multiplier| {
            let is_certain = multiplier.log_modulus.abs() > margin;
            is_certain.then_some(multiplier.log_modulus < 0.0)
        }))
    }

    /// Whether the cycle is stable, from whether each multiplier is inside the circle where that is certain.
    pub(crate) fn verdict(&self, insides: impl Iterator<Item = Option<bool>>) -> Option<bool> {
        let insides: Vec<Option<bool>> = insides.collect();
        if self.is_contradictory() {
            None
        } else if insides.contains(&Some(false)) {
            Some(false)
        } else {
            insides.iter().all(|inside| *inside == Some(true)).then_some(true)
        }
    }

    /// What the search for special cycles compares from cycle to cycle: logarithms of the multipliers.
    pub(crate) fn growth(&self) -> Spectrum {
        let UnstableCount { count: unstable, is_certain: decided } = self.unstable();
        let exponent = |multiplier: &Multiplier| {
            Complex64::new(multiplier.log_modulus.max(SMALLEST_LOGARITHM), multiplier.argument)
        };
        Spectrum {
            exponents: self.nontrivial.iter().map(exponent).collect(),
            unstable,
            decided,
            noise: self.margin(),
            is_periodic: true,
        }
    }

    /// Product over all pairs of multipliers that are complex conjugate or real of one sign of the logarithm of their product's
    /// modulus, each saturating at +-1: changes sign where a pair is on the unit circle. Pairs that are so within the error do
    /// not count. Two real ones of different signs never have the product one: they count as
    /// a product inside the circle, so that the sign of one that is rounding does not matter.
    pub(crate) fn torus_test(&self) -> TorusTest {
        let mut test = TorusTest { product: 1.0, undecided: 0 };
        for (index, one) in self.nontrivial.iter().enumerate() {
            for other in &self.nontrivial[index + 1..] {
                let together = if one.is_real() && other.is_real() {
                    if one.argument != other.argument {
                        test.product = -test.product;
                    }
                    one.argument == other.argument
                } else {
                    one.argument == -other.argument && one.log_modulus == other.log_modulus
                };
                if !together {
                    continue;
                }
                let [a, b] = [one, other].map(|multiplier| multiplier.log_modulus.max(SMALLEST_LOGARITHM));
                let sum = a + b;
                // Beside one that is one, as all along a family of cycles, the sign is that of the other.
                let is_one = |multiplier: &Multiplier| {
                    multiplier.argument == 0.0 && multiplier.log_modulus.abs() <= self.margin()
                };
                if sum.abs() <= 2.0 * self.margin() || is_one(one) || is_one(other) {
                    test.undecided += 1;
                } else {
                    test.product *= sum / sum.hypot(SATURATION);
                }
            }
        }
        test
    }

    /// The multipliers at a special cycle, one of which is known: of two the integral of the divergence gives the other. `None` of
    /// any other number.
    pub(crate) fn with_critical(&self, critical: Multiplier) -> Option<Self> {
        let nontrivial = match self.nontrivial.len() {
            2 => {
                // Their product is known.
                let turn = if self.sign < 0.0 { PI - critical.argument } else { critical.argument };
                let other =
                    Multiplier { log_modulus: self.divergence - critical.log_modulus, argument: turn };
                let is_larger = other.log_modulus > critical.log_modulus;
                if is_larger { vec![other, critical] } else { vec![critical, other] }
            }
            _ => return None,
        };
        Some(Self { nontrivial, ..self.clone() })
    }

    pub(super) fn margin(&self) -> f64 {
        self.trivial_error.max(self.measured_error).max(f64::EPSILON)
    }

    /// Whether a positive multiplier, or a pair with a positive real part, may be one next to this cycle. In the plane the only one
    /// is known for certain.
    pub(crate) fn comes_near_one(&self) -> bool {
        let near = if self.nontrivial.len() == 1 { NEAR_ONE } else { NOT_FAR_FROM_ONE };
        self.nontrivial
            .iter()
            .any(|multiplier| multiplier.log_modulus.abs() < near && multiplier.argument.cos() > 0.0)
    }

    /// Minus one for every positive multiplier above one, multiplied.
    pub(crate) fn parity_above_one(&self) -> f64 {
        let above = self
            .nontrivial
            .iter()
            .filter(|multiplier| multiplier.argument == 0.0 && multiplier.log_modulus > 0.0);
        if above.count() % 2 == 0 { 1.0 } else { -1.0 }
    }

    /// Difference between the sum of the logarithms of the multipliers and the integral of the divergence, which are equal
    /// (Liouville); zero where directions that die out within a period make both meaningless on the mesh of a cycle.
    pub(crate) fn defect(&self) -> f64 {
        let sum: f64 = self.nontrivial.iter().map(|multiplier| multiplier.log_modulus).sum();
        if self.defect_is_silent() { 0.0 } else { (sum - self.divergence).abs() }
    }

    /// Whether the defect says nothing, because directions die out within a period.
    pub(super) fn defect_is_silent(&self) -> bool {
        self.divergence < DEAD
    }

    /// Whether all multipliers are larger than the error and an odd number of them is negative, or their product is not what
    /// Liouville's formula says: that of a flow is positive and known, so the mesh does not resolve them.
    pub(crate) fn is_contradictory(&self) -> bool {
        if self.defect() > CONTRADICTION {
            return true;
        }
        let floor = self.margin().ln();
        let negative =
            self.nontrivial.iter().filter(|multiplier| multiplier.is_real() && multiplier.argument != 0.0);
        let is_odd = negative.count() % 2 == 1;
        is_odd != (self.sign < 0.0) && self.nontrivial.iter().all(|multiplier| multiplier.log_modulus > floor)
    }
}

/// Changes of multipliers, the largest moduli first, relative to themselves.
pub(super) fn multiplier_changes(now: &[Multiplier], then: &[Multiplier]) -> Vec<f64> {
    let pairs = now.iter().zip(then);
    pairs
        .map(|(now, then)| {
            let turn = (now.argument.abs() - then.argument.abs()).abs();
            (now.log_modulus - then.log_modulus).abs().max(turn)
        })
        .map(|change| if change.is_nan() { 0.0 } else { change })
        .collect()
}

/// Multipliers from the blocks of the last factorisation at `unknown`, `scales` being the sizes of the states.
pub(crate) fn floquet<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    scales: &[f64],
    workspace: &mut Option<(usize, PeriodicSchur)>,
) -> Result<Floquet, Error> {
    let n = scales.len();
    let intervals = collocation.intervals();
    let scalars = &unknown[intervals * collocation.interval_size()..];
    let mut flow = vec![0.0; intervals * n];
    for (interval, flow) in flow.chunks_exact_mut(n).enumerate() {
        let start = &collocation.interval(unknown, interval)[..n];
        collocation.problem.field(collocation.mesh()[interval], start, scalars, flow);
    }
    let divergence = divergence(collocation, n);
    floquet_of(flow, collocation.transfer(), scales, (divergence, collocation.linear_jumps()), workspace)
}

/// As [`floquet`], from the flow direction at the beginning of every part of the period and the block that maps it to the next; with the
/// integral of the divergence and the jumps.
pub(super) fn floquet_of(
    flow: Vec<f64>,
    transfer: &[f64],
    scales: &[f64],
    (divergence, jumps): (f64, &[Jump]),
    workspace: &mut Option<(usize, PeriodicSchur)>,
) -> Result<Floquet, Error> {
    let intervals = flow.len() / scales.len();
    let failed = || Error::Eigenvalues { quantity: "Floquet multipliers" };
    let Deflated { factors, trivial, trivial_error } =
        Deflated::of(flow, transfer, scales).ok_or_else(failed)?;
    let volume = Volume::of(divergence, jumps, scales);
    let nontrivial = match scales.len() {
        1 => Vec::new(),
        // Liouville's formula gives the only one, however far from one it is.
        2 => {
            let argument = if volume.sign < 0.0 { PI } else { 0.0 };
            vec![Multiplier { log_modulus: volume.logarithm, argument }]
        }
        n => {
            let mut multipliers =
                of_product(&factors, (n - 1, intervals), workspace).ok_or_else(failed)?.to_vec();
            // What a jump takes to nothing stays there, whatever rounding makes of it.
            for multiplier in multipliers.iter_mut().rev().take(volume.lost) {
                *multiplier = Multiplier { log_modulus: f64::NEG_INFINITY, argument: 0.0 };
            }
            multipliers
        }
    };
    let (divergence, sign) = (volume.logarithm, volume.sign);
    Ok(Floquet { nontrivial, trivial, trivial_error, divergence, sign, measured_error: 0.0 })
}

/// The multipliers of the product of `count` factors of size `n`.
fn of_product<'w>(
    factors: &[f64],
    (n, count): (usize, usize),
    workspace: &'w mut Option<(usize, PeriodicSchur)>,
) -> Option<&'w [Multiplier]> {
    if workspace.as_ref().is_none_or(|(last, _)| *last != count) {
        *workspace = Some((count, PeriodicSchur::new(n, count)));
    }
    let (_, schur) = workspace.as_mut()?;
    schur.multipliers(factors).ok()
}

/// The integral of the trace of the Jacobian over one period, from the derivatives of the last factorisation.
fn divergence<P: BoundaryValueEquations>(collocation: &Collocation<P>, n: usize) -> f64 {
    let columns = n + collocation.problem.scalars();
    let degree = collocation.gauss().degree();
    let blocks = collocation.derivatives().chunks_exact(n * columns);
    let places = collocation.mesh().windows(2).flat_map(|pair| {
        collocation.gauss().weights[..degree].iter().map(move |weight| weight * (pair[1] - pair[0]))
    });
    blocks
        .zip(places)
        .map(|(block, weight)| weight * (0..n).map(|index| block[index * (n + 1)]).sum::<f64>())
        .sum()
}
