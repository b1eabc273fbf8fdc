//! Equilibria on which a quantity keeps its value while two parameters vary.
//!
//! The quantity is any function, so that its row of the Jacobian comes from difference quotients; the equations of the field have
//! exact derivatives as ever. Folds and Hopf points are the special points on such a curve.

use super::held::Held;
use super::kind::{Linearized, LocusKind, Monitor, zero_test};
use crate::algebraic::AlgebraicEquations;
use crate::branch::SpecialKind;
use crate::continuation::events::TestFunction;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::spectrum::HopfTest;
use crate::erased::NarrowScalar;
use crate::error::Error;
use num_complex::Complex64;

/// Step of a central difference, as part of the size of an unknown: the cube root of rounding.
const STEP: f64 = 6e-6;

/// `f(x, p) = 0` and `quantity(x, p) = value` with the unknowns `(x, two parameters)`.
#[derive(Clone)]
pub(super) struct HeldSystem<'a> {
    pub equilibria: EquilibriumProblem<'a>,
    pub held: Held<[f64]>,
    pub value: f64,
    /// Sizes of the unknowns where the curve starts.
    pub sizes: Vec<f64>,
    /// Largest modulus of an eigenvalue so far, against which others count.
    pub fastest: f64,
}

impl HeldSystem<'_> {
    /// The quantity, not a number where it does not exist.
    fn quantity(&self, unknown: &[f64]) -> f64 {
        let (state, values) = unknown.split_at(self.equilibria.dimension);
        self.held.of(state, &self.equilibria.parameters_at(values)).unwrap_or(f64::NAN)
    }

    /// Its rate of change with one of the unknowns.
    fn slope(&self, unknown: &[f64], index: usize) -> f64 {
        let step = STEP * self.sizes[index].max(unknown[index].abs());
        let [ahead, behind] = [step, -step].map(|step| {
            let mut moved = unknown.to_vec();
            moved[index] += step;
            (moved[index], self.quantity(&moved))
        });
        (ahead.1 - behind.1) / (ahead.0 - behind.0)
    }
}

impl AlgebraicEquations for HeldSystem<'_> {
    fn unknowns(&self) -> usize {
        self.equilibria.dimension + 2
    }

    fn equations(&self) -> usize {
        self.equilibria.dimension + 1
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.equilibria.dimension;
        self.equilibria.evaluate(unknown, &mut residual[..n]);
        let values: Vec<f64> = unknown.iter().map(|entry| entry.value()).collect();
        let mut row = T::from(self.quantity(&values) - self.value);
        for (index, entry) in unknown.iter().enumerate().filter(|(_, entry)| !entry.is_constant()) {
            row += (*entry - values[index]) * self.slope(&values, index);
        }
        residual[n] = row;
    }
}

impl<'a> LocusKind<'a> for HeldSystem<'a> {
    fn kind(&self) -> Option<SpecialKind> {
        None
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        const {
            &[
                TestFunction::new(SpecialKind::Fold).changing(&[1]).of_spectrum(),
                TestFunction::new(SpecialKind::Hopf).changing(&[0, 2]).of_spectrum(),
            ]
        }
    }

    fn equilibria(&self) -> &EquilibriumProblem<'a> {
        &self.equilibria
    }

    fn sizes(&self, states: &[f64], ranges: [f64; 2]) -> Vec<f64> {
        states.iter().copied().chain(ranges).collect()
    }

    fn renormalize(
        &mut self,
        _unknown: &mut [f64],
        _vectors: &mut [&mut Vec<f64>],
        _states: &[f64],
        _largest: f64,
    ) {
    }

    fn monitor(&mut self, point: &Linearized<'_>) -> Result<Monitor, Error> {
        self.fastest = point.eigenvalues.iter().map(|value| value.norm()).fold(self.fastest, f64::max);
        let zero = zero_test(point.eigenvalues, self.fastest);
        let mut monitor = Monitor::default();
        monitor.add(SpecialKind::Fold, if zero.is_nan() { 0.0 } else { zero });
        let pairs = HopfTest::of_one_block(point.eigenvalues);
        if point.scales.len() > 1 {
            // The secant method may hit the point itself.
            let value = if pairs.undecided == 0 { pairs.closest.copysign(pairs.product) } else { 0.0 };
            monitor.add(SpecialKind::Hopf, value);
        }
        Ok(monitor)
    }

    fn critical_eigenvalues(&self, _unknown: &[f64]) -> Vec<Complex64> {
        Vec::new()
    }
}
