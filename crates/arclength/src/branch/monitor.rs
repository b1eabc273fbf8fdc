//! Quantities that are recorded along a branch, and values of theirs at which a point is wanted or the branch is to end.

use crate::continuation::Purpose;
use std::fmt;

/// A function of the points of a branch.
///
/// ```
/// use arclength::branch::Monitor;
/// use arclength::cycle::CyclePoint;
/// let period = Monitor::new("period", |cycle: &CyclePoint| Some(cycle.period)).at(&[10.0]).until(&[50.0]);
/// assert_eq!(period.name(), "period");
/// ```
pub struct Monitor<'a, P> {
    name: String,
    #[allow(clippy::type_complexity)]
    function: Box<dyn Fn(&P) -> Option<f64> + 'a>,
    /// Values, and what happens there.
    values: Vec<(f64, Purpose)>,
}

impl<'a, P> Monitor<'a, P> {
    /// A quantity with a name; `None` where it does not exist.
    pub fn new(name: &str, function: impl Fn(&P) -> Option<f64> + 'a) -> Self {
        Self { name: name.to_owned(), function: Box::new(function), values: Vec::new() }
    }

    /// Values at which a point is wanted.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.values.extend(values.iter().map(|value| (*value, Purpose::Point)));
        self
    }

    /// Values at which a point is wanted if one can be computed there; the branch goes on without it otherwise.
    pub fn mark(mut self, values: &[f64]) -> Self {
        self.values.extend(values.iter().map(|value| (*value, Purpose::Mark)));
        self
    }

    /// Values at which the branch ends.
    pub fn until(mut self, values: &[f64]) -> Self {
        self.values.extend(values.iter().map(|value| (*value, Purpose::End)));
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value at a point.
    pub fn value(&self, point: &P) -> Option<f64> {
        (self.function)(point).filter(|value| value.is_finite())
    }

    /// Values at which something happens, and what.
    pub(crate) fn values(&self) -> &[(f64, Purpose)] {
        &self.values
    }
}

impl<P> fmt::Debug for Monitor<'_, P> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Monitor").field("name", &self.name).field("values", &self.values).finish()
    }
}
