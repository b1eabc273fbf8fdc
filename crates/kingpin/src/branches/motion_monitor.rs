//! Quantities of motions of a wheel that are recorded along branches and curves, with values at which a point is wanted or the run
//! is to end, and those that keep their value along a curve in two parameters.
//!
//! A quantity is a function of the wheel, with the parameters that vary at their values there, and of the motion: a uniform
//! motion in [all states](Wheel::states), or a cycle of the [free ones](Wheel::free_states).

use crate::{RollingModel, Wheel};
use arclength::branch::Monitor;
use arclength::cycle::Orbit;
use arclength::locus::Held;
use std::fmt;
use std::sync::Arc;

type Quantity<M> = dyn Fn(&Wheel, &M) -> Option<f64> + Send + Sync;

/// A quantity of motions of a wheel: of uniform motions (`[f64]`) or of cycles ([`Orbit`]).
///
/// ```
/// use kingpin::{Wheel, branches::MotionMonitor};
/// use arclength::cycle::Orbit;
/// let period = MotionMonitor::new("period", |_: &Wheel, cycle: &Orbit| Some(cycle.period)).until(&[2.0]);
/// assert_eq!(period.name(), "period");
/// ```
pub struct MotionMonitor<M: ?Sized> {
    name: String,
    quantity: Arc<Quantity<M>>,
    at: Vec<f64>,
    until: Vec<f64>,
}

impl<M: ?Sized> MotionMonitor<M> {
    /// A quantity with a name; `None` where it does not exist.
    pub fn new(name: &str, quantity: impl Fn(&Wheel, &M) -> Option<f64> + Send + Sync + 'static) -> Self {
        Self { name: name.to_owned(), quantity: Arc::new(quantity), at: Vec::new(), until: Vec::new() }
    }

    /// The same with values at which a point is wanted.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// The same with values at which the run ends.
    pub fn until(mut self, values: &[f64]) -> Self {
        self.until = values.to_vec();
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value at a motion of a wheel, if it exists.
    pub fn value(&self, wheel: &Wheel, motion: &M) -> Option<f64> {
        (self.quantity)(wheel, motion).filter(|value| value.is_finite())
    }

    /// The monitor of the points of a branch or curve; `value` finds the wheel and the motion at a point, and hands both on.
    fn on_points<'a, P>(
        &'a self,
        value: impl Fn(&P, &dyn Fn(&Wheel, &M) -> Option<f64>) -> Option<f64> + 'a,
    ) -> Monitor<'a, P> {
        let quantity = |wheel: &Wheel, motion: &M| self.value(wheel, motion);
        Monitor::new(&self.name, move |point| value(point, &quantity)).at(&self.at).until(&self.until)
    }
}

impl MotionMonitor<[f64]> {
    /// The monitor of points whose states and values of the active keys `place` gives.
    pub(super) fn on_motions<'a, P: 'a>(
        &'a self,
        model: &'a RollingModel,
        place: impl Fn(&P) -> (&[f64], Vec<f64>) + 'a,
    ) -> Monitor<'a, P> {
        self.on_points(move |point, value| {
            let (free, values) = place(point);
            value(&model.wheel_at(&values).ok()?, &model.full_state(free, &values))
        })
    }

    /// The quantity that keeps its value along a curve of uniform motions.
    pub(super) fn held(&self, model: &RollingModel, value: f64) -> Held<[f64]> {
        let (model, quantity) = (model.clone(), Arc::clone(&self.quantity));
        Held::of_state(&self.name, move |free, values| {
            quantity(&model.wheel_at(values).ok()?, &model.full_state(free, values))
        })
        .at(value)
    }
}

impl MotionMonitor<Orbit> {
    /// The monitor of points whose orbits and values of the active keys `place` gives.
    pub(super) fn on_cycles<'a, P: 'a>(
        &'a self,
        model: &'a RollingModel,
        place: impl Fn(&P) -> (&Orbit, Vec<f64>) + 'a,
    ) -> Monitor<'a, P> {
        self.on_points(move |point, value| {
            let (orbit, values) = place(point);
            value(&model.wheel_at(&values).ok()?, orbit)
        })
    }

    /// The quantity that keeps its value along a curve of cycles.
    pub(super) fn held(&self, model: &RollingModel, value: f64) -> Held {
        let (model, quantity) = (model.clone(), Arc::clone(&self.quantity));
        Held::new(&self.name, move |orbit, values| quantity(&model.wheel_at(values).ok()?, orbit)).at(value)
    }
}

impl<M: ?Sized> Clone for MotionMonitor<M> {
    fn clone(&self) -> Self {
        let Self { name, quantity, at, until } = self;
        Self { name: name.clone(), quantity: Arc::clone(quantity), at: at.clone(), until: until.clone() }
    }
}

impl<M: ?Sized> fmt::Debug for MotionMonitor<M> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, at, until, .. } = self;
        write!(formatter, "{name} (points at {at:?}, an end at {until:?})")
    }
}
