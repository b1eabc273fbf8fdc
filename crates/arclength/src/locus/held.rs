//! A quantity that keeps its value along a curve of equilibria or of cycles in two parameters.

use crate::cycle::Orbit;
use std::fmt;
use std::sync::Arc;

type Quantity<S> = dyn Fn(&S, &[f64]) -> Option<f64> + Send + Sync;

/// A smooth function of a solution `S` and of all parameters that keeps its value along a curve in two parameters.
///
/// Of a [cycle](crate::locus::CycleLocus::from_held_cycle): the period, a largest value, a mean.
///
/// ```
/// use arclength::locus::Held;
/// let period = Held::new("period", |orbit, _| Some(orbit.period)).at(50.0);
/// assert_eq!((period.name(), period.value()), ("period", Some(50.0)));
/// ```
///
/// Of the state of an [equilibrium](crate::locus::EquilibriumLocus::from_held_equilibrium):
///
/// ```
/// use arclength::locus::Held;
/// let energy = Held::of_state("energy", |state, parameters| Some(0.5 * parameters[0] * state[0] * state[0]));
/// assert_eq!(energy.of(&[2.0], &[3.0]), Some(6.0));
/// ```
pub struct Held<S: ?Sized = Orbit> {
    name: String,
    function: Arc<Quantity<S>>,
    value: Option<f64>,
}

impl Held<Orbit> {
    /// A quantity of a cycle, with a name, that keeps the value it has where the curve starts; `None` where it does not exist.
    pub fn new(name: &str, function: impl Fn(&Orbit, &[f64]) -> Option<f64> + Send + Sync + 'static) -> Self {
        Self { name: name.to_owned(), function: Arc::new(function), value: None }
    }
}

impl Held<[f64]> {
    /// A quantity of a state, with a name, that keeps the value it has where the curve starts; `None` where it does not exist.
    pub fn of_state(
        name: &str,
        function: impl Fn(&[f64], &[f64]) -> Option<f64> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.to_owned(), function: Arc::new(function), value: None }
    }
}

impl<S: ?Sized> Held<S> {
    /// The value that it is to have, near the one where the curve starts.
    pub fn at(self, value: f64) -> Self {
        Self { value: Some(value), ..self }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The value that it is to have; `None` for the one where the curve starts.
    pub fn value(&self) -> Option<f64> {
        self.value
    }

    /// Its value at a solution, if it exists.
    pub fn of(&self, solution: &S, parameters: &[f64]) -> Option<f64> {
        (self.function)(solution, parameters).filter(|value| value.is_finite())
    }
}

impl<S: ?Sized> Clone for Held<S> {
    fn clone(&self) -> Self {
        Self { name: self.name.clone(), function: Arc::clone(&self.function), value: self.value }
    }
}

impl<S: ?Sized> fmt::Debug for Held<S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Held").field("name", &self.name).field("value", &self.value).finish()
    }
}
