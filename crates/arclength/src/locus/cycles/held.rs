//! A quantity that keeps its value along a curve of cycles in two parameters.

use crate::cycle::Orbit;
use std::fmt;
use std::sync::Arc;

type Quantity = dyn Fn(&Orbit, &[f64]) -> Option<f64> + Send + Sync;

/// A smooth function of a cycle and of all parameters that keeps its value along a
/// [curve in two parameters](crate::locus::CycleLocus::from_held_cycle): the period, a largest value, a mean.
///
/// ```
/// use arclength::locus::Held;
/// let period = Held::new("period", |orbit, _| Some(orbit.period)).at(50.0);
/// assert_eq!((period.name(), period.value()), ("period", Some(50.0)));
/// ```
#[derive(Clone)]
pub struct Held {
    name: String,
    function: Arc<Quantity>,
    value: Option<f64>,
}

impl Held {
    /// A quantity with a name that keeps the value it has where the curve starts; `None` where it does not exist.
    pub fn new(name: &str, function: impl Fn(&Orbit, &[f64]) -> Option<f64> + Send + Sync + 'static) -> Self {
        Self { name: name.to_owned(), function: Arc::new(function), value: None }
    }

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

    /// Its value on a cycle, if it exists.
    pub fn of(&self, orbit: &Orbit, parameters: &[f64]) -> Option<f64> {
        (self.function)(orbit, parameters).filter(|value| value.is_finite())
    }
}

impl fmt::Debug for Held {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Held").field("name", &self.name).field("value", &self.value).finish()
    }
}
