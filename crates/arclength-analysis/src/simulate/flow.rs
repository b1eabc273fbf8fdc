//! The flow of a model over a time without switches in time, for the integrator.

use arclength::integration::{JacobianColumns, System, exact_jacobian};
use arclength_ode::Model;

/// The right-hand side of a model, at times beyond an interval that at its ends.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    model: &'a Model,
    parameters: &'a [f64],
    interval: [f64; 2],
}

impl<'a> Flow<'a> {
    /// Of a model at parameters, perhaps followed by the cells of a region, in an interval of time.
    pub(super) fn new(model: &'a Model, parameters: &'a [f64], interval: [f64; 2]) -> Self {
        Self { model, parameters, interval }
    }

    fn clamped(&self, time: f64) -> f64 {
        let [low, high] = self.interval;
        time.min(high).max(low)
    }
}

impl System for Flow<'_> {
    fn dimension(&self) -> usize {
        self.model.states().len()
    }

    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]) {
        self.model.evaluate_at(self.clamped(time), state, self.parameters, derivative);
    }

    fn jacobian(&mut self, time: f64, state: &[f64], jacobian: &mut [f64]) {
        let parameters: Vec<_> =
            self.parameters.iter().map(|value| JacobianColumns::constant(*value)).collect();
        let time = JacobianColumns::constant(self.clamped(time));
        let field = |state: &[JacobianColumns], slope: &mut [JacobianColumns]| {
            self.model.evaluate_at(time, state, &parameters, slope);
        };
        exact_jacobian(field, state, jacobian);
    }
}
