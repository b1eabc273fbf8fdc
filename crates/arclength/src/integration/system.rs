//! Systems of ordinary differential equations that can be integrated.

use crate::VectorField;
use crate::differentiation::Dual;

/// The right-hand side of `x' = f(t, x)`.
///
/// It takes `&mut self`, so that an implementation may own scratch memory.
pub trait System {
    /// Number of state variables.
    fn dimension(&self) -> usize;

    /// Writes `f(time, state)` into `derivative`; outside its domain, numbers that are not finite.
    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]);

    /// Whether steps are told apart from each other only, not from the time, however late that is: for right-hand sides that are the
    /// same at all times and turn within less than what rounding makes of the time, as slip does that passes close by zero.
    fn has_own_clock(&self) -> bool {
        false
    }

    /// Writes the derivatives of the right-hand side with respect to the state into `jacobian`, column by column; by default they are
    /// difference quotients. Implicit methods use them.
    fn jacobian(&mut self, time: f64, state: &[f64], jacobian: &mut [f64]) {
        difference_quotients(self, time, state, jacobian);
    }
}

/// Writes difference quotients of a right-hand side into a Jacobian, column by column.
pub(super) fn difference_quotients<S: System + ?Sized>(
    system: &mut S,
    time: f64,
    state: &[f64],
    jacobian: &mut [f64],
) {
    let n = state.len();
    let (mut point, mut slope) = (state.to_vec(), vec![0.0; n]);
    system.evaluate(time, state, &mut slope);
    for (index, column) in jacobian.chunks_exact_mut(n.max(1)).enumerate() {
        point[index] += f64::EPSILON.sqrt() * state[index].abs().max(SMALLEST_SIZE);
        system.evaluate(time, &point, column);
        let difference = point[index] - state[index];
        column.iter_mut().zip(&slope).for_each(|(entry, slope)| *entry = (*entry - slope) / difference);
        point[index] = state[index];
    }
}

/// Size of a state from which difference quotients are not finer.
const SMALLEST_SIZE: f64 = 1e-5;

/// Directions in which a right-hand side is differentiated at once.
const DIRECTIONS: usize = 4;

/// A scalar that carries some columns of a Jacobian.
pub type JacobianColumns = Dual<f64, DIRECTIONS>;

/// Writes the exact Jacobian of a right-hand side, column by column, by automatic differentiation; `evaluate` writes the derivative at a
/// state.
pub fn exact_jacobian(
    mut evaluate: impl FnMut(&[JacobianColumns], &mut [JacobianColumns]),
    state: &[f64],
    jacobian: &mut [f64],
) {
    let n = state.len();
    let mut point: Vec<JacobianColumns> = state.iter().map(|value| Dual::constant(*value)).collect();
    let mut slope = vec![Dual::constant(0.0); n];
    for first in (0..n).step_by(DIRECTIONS) {
        let last = n.min(first + DIRECTIONS);
        (first..last).for_each(|index| point[index] = Dual::variable(state[index], index - first));
        evaluate(&point, &mut slope);
        for index in first..last {
            let column = &mut jacobian[index * n..(index + 1) * n];
            column
                .iter_mut()
                .zip(&slope)
                .for_each(|(entry, slope)| *entry = slope.derivatives[index - first]);
            point[index] = Dual::constant(state[index]);
        }
    }
}

impl<S: System> System for &mut S {
    fn dimension(&self) -> usize {
        (**self).dimension()
    }
    #[inline]
    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]) {
        (**self).evaluate(time, state, derivative);
    }
    fn has_own_clock(&self) -> bool {
        (**self).has_own_clock()
    }
    fn jacobian(&mut self, time: f64, state: &[f64], jacobian: &mut [f64]) {
        (**self).jacobian(time, state, jacobian);
    }
}

/// A closure as a system, see [`from_fn`].
#[derive(Clone, Copy, Debug)]
pub struct ClosureSystem<F> {
    dimension: usize,
    function: F,
}

/// The system of `dimension` equations whose right-hand side is `function(time, state, derivative)`.
pub fn from_fn<F: FnMut(f64, &[f64], &mut [f64])>(dimension: usize, function: F) -> ClosureSystem<F> {
    ClosureSystem { dimension, function }
}

impl<F: FnMut(f64, &[f64], &mut [f64])> System for ClosureSystem<F> {
    fn dimension(&self) -> usize {
        self.dimension
    }
    #[inline]
    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]) {
        (self.function)(time, state, derivative);
    }
}

/// A closure as an autonomous system, see [`from_rates`].
#[derive(Clone, Copy, Debug)]
pub struct AutonomousClosure<F> {
    dimension: usize,
    function: F,
}

/// The autonomous system of `dimension` equations whose right-hand side is `function(state, derivative)`, with a clock of its own.
///
/// ```
/// use arclength::integration::{Integrator, from_rates};
///
/// let decay = from_rates(1, |x, derivative| derivative[0] = -x[0]);
/// let end = Integrator::default().integrate(decay, 0.0, &[1.0], 1.0)?.state;
/// assert!((end[0] - (-1.0_f64).exp()).abs() < 1e-9);
/// # Ok::<(), arclength::integration::IntegrationError>(())
/// ```
pub fn from_rates<F: FnMut(&[f64], &mut [f64])>(dimension: usize, function: F) -> AutonomousClosure<F> {
    AutonomousClosure { dimension, function }
}

impl<F: FnMut(&[f64], &mut [f64])> System for AutonomousClosure<F> {
    fn dimension(&self) -> usize {
        self.dimension
    }
    #[inline]
    fn evaluate(&mut self, _time: f64, state: &[f64], derivative: &mut [f64]) {
        (self.function)(state, derivative);
    }
    fn has_own_clock(&self) -> bool {
        true
    }
}

/// A vector field at fixed parameters as a system, see [`autonomous`].
#[derive(Clone, Copy, Debug)]
pub struct Autonomous<'a, F> {
    field: F,
    parameters: &'a [f64],
    dimension: usize,
}

/// The system `x' = field(x, parameters)`.
pub fn autonomous<F: VectorField>(field: F, parameters: &[f64]) -> Autonomous<'_, F> {
    let dimension = field.dimension();
    Autonomous { field, parameters, dimension }
}

impl<F: VectorField> System for Autonomous<'_, F> {
    fn dimension(&self) -> usize {
        self.dimension
    }
    #[inline]
    fn evaluate(&mut self, _time: f64, state: &[f64], derivative: &mut [f64]) {
        self.field.evaluate(state, self.parameters, derivative);
    }
    fn jacobian(&mut self, _time: f64, state: &[f64], jacobian: &mut [f64]) {
        let parameters: Vec<JacobianColumns> = self.parameters.iter().map(|p| Dual::constant(*p)).collect();
        exact_jacobian(|state, slope| self.field.evaluate(state, &parameters, slope), state, jacobian);
    }
}
