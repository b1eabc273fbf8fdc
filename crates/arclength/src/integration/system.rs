//! Systems of ordinary differential equations that can be integrated.

use crate::VectorField;

/// The right-hand side of `x' = f(t, x)`.
///
/// It takes `&mut self`, so that an implementation may own scratch memory.
pub trait System {
    /// Number of state variables.
    fn dimension(&self) -> usize;

    /// Writes `f(time, state)` into `derivative`; outside its domain, numbers that are not finite.
    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]);
}

impl<S: System> System for &mut S {
    fn dimension(&self) -> usize {
        (**self).dimension()
    }
    #[inline]
    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]) {
        (**self).evaluate(time, state, derivative);
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
}
