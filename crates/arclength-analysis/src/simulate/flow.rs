//! The flow of a model, for the integrator: in a region between its switches, or along a switch.
//!
//! Where the fields on both sides of a switch push towards it the motion slides along it, by the mean of both fields that keeps the
//! switch function at its border (Filippov, *Differential Equations with Discontinuous Righthand Sides*, 1988).

use super::condition::{Condition, ROUNDING};
use arclength::integration::{JacobianColumns, System, exact_jacobian};
use arclength_ode::{Event, Model, Outcome};

/// The right-hand side of a model in an interval of time, at times beyond it that at its ends.
#[derive(Clone, Debug)]
pub(super) struct Flow<'a> {
    model: &'a Model,
    /// The parameters and, in a region, its cells.
    parameters: Vec<f64>,
    interval: [f64; 2],
    slide: Option<Slide>,
}

/// A switch along which a motion slides.
#[derive(Clone, Debug)]
struct Slide {
    switch: usize,
    /// Parameters and cells above it; those of the flow are below.
    above: Vec<f64>,
}

/// The rates of a switch function by the fields below and above it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    pub below: f64,
    pub above: f64,
}

impl Rates {
    /// Part of the field above in the mean that keeps the switch function.
    fn part_above(self) -> f64 {
        let difference = self.below - self.above;
        if difference == 0.0 { 0.5 } else { (self.below / difference).clamp(0.0, 1.0) }
    }
}

impl<'a> Flow<'a> {
    /// Of a model at parameters, in a region given by its cells, or everywhere if there are none, in an interval of time.
    pub(super) fn new(model: &'a Model, parameters: &[f64], cells: &[f64], interval: [f64; 2]) -> Self {
        Self { model, parameters: [parameters, cells].concat(), interval, slide: None }
    }

    /// The same along a switch, beyond which the region has these cells.
    pub(super) fn along(mut self, switch: usize, above: &[f64]) -> Self {
        let cells = self.parameters.len() - above.len();
        self.slide = Some(Slide { switch, above: [&self.parameters[..cells], above].concat() });
        self
    }

    fn clamped(&self, time: f64) -> f64 {
        let [low, high] = self.interval;
        time.min(high).max(low)
    }

    /// The switch functions, by the field of the region.
    pub(super) fn switches(&self, time: f64, state: &[f64], count: usize) -> Vec<f64> {
        let mut values = vec![0.0; state.len() + count];
        self.model.evaluate_at(self.clamped(time), state, &self.parameters, &mut values);
        values.split_off(state.len())
    }

    /// A switch function by the field of the region, with its gradient.
    pub(super) fn switch_slope(&self, time: f64, state: &[f64], switch: usize) -> Slope {
        let parameters = constants(&self.parameters);
        let last = state.len();
        let mut values = vec![JacobianColumns::constant(0.0); last + switch + 1];
        let function = |point: &[JacobianColumns]| {
            self.model.evaluate_at(point[last], &point[..last], &parameters, &mut values);
            values[last + switch]
        };
        Slope::of(function, self.clamped(time), state)
    }

    /// The condition of an event.
    pub(super) fn condition_value(&self, event: &Event, time: f64, state: &[f64]) -> f64 {
        event.condition(self.clamped(time), state, &self.parameters)
    }

    /// The condition of an event, with its rate along the motion; `sizes` are magnitudes of states that rounding is
    /// measured by where they are larger than the state.
    pub(super) fn condition(&self, event: &Event, time: f64, state: &[f64], sizes: &[f64]) -> Condition {
        let parameters = constants(&self.parameters);
        let last = state.len();
        let clamped = self.clamped(time);
        let slope =
            Slope::of(|point| event.condition(point[last], &point[..last], &parameters), clamped, state);
        let mut velocity = self.velocity(time, state);
        velocity.push(if clamped == time { 1.0 } else { 0.0 });
        let sizes = sizes.iter().copied().chain(std::iter::repeat(0.0));
        let sizes = state.iter().zip(sizes).map(|(value, size)| value.abs().max(size)).chain([time.abs()]);
        let mut condition = Condition { value: slope.value, rate: 0.0, value_noise: 0.0, rate_noise: 0.0 };
        for ((gradient, velocity), size) in slope.gradient.iter().zip(&velocity).zip(sizes) {
            condition.rate += gradient * velocity;
            condition.rate_noise += (gradient * velocity).abs();
            condition.value_noise += (gradient * size).abs();
        }
        condition.value_noise += condition.rate_noise * time.abs();
        condition
    }

    /// The side of zero on which the condition of an event is as soon as times are told apart; nothing where it is on none.
    pub(super) fn side_ahead(&self, event: &Event, time: f64, state: &[f64]) -> Option<f64> {
        let step = ROUNDING * time.abs();
        let velocity = self.velocity(time, state);
        let ahead: Vec<f64> = state.iter().zip(&velocity).map(|(value, rate)| value + step * rate).collect();
        let value = self.condition_value(event, time + step, &ahead);
        (value != 0.0 && !value.is_nan()).then(|| value.signum())
    }

    /// Takes a state to that behind an event.
    pub(super) fn apply(&self, event: &Event, time: f64, state: &mut [f64]) -> Outcome {
        event.apply(self.clamped(time), state, &self.parameters)
    }

    /// The rates of a switch function along motions with these two velocities.
    pub(super) fn rates(
        &self,
        time: f64,
        state: &[f64],
        switch: usize,
        [below, above]: [&[f64]; 2],
    ) -> Rates {
        let parameters = constants(&self.parameters);
        let moving = state.iter().zip(below.iter().zip(above)).map(|(value, (below, above))| {
            JacobianColumns { value: *value, derivatives: [*below, *above, 0.0, 0.0] }
        });
        let [low, high] = self.interval;
        // Beyond its interval the time of the field stands still.
        let pace = f64::from(low <= time && time <= high);
        let time = JacobianColumns { value: self.clamped(time), derivatives: [pace, pace, 0.0, 0.0] };
        let mut values = vec![JacobianColumns::constant(0.0); state.len() + switch + 1];
        self.model.evaluate_at(time, &moving.collect::<Vec<_>>(), &parameters, &mut values);
        let [below, above, ..] = values[state.len() + switch].derivatives;
        Rates { below, above }
    }

    /// The rates of the switch function along which the motion slides.
    pub(super) fn slide_rates(&self, time: f64, state: &[f64]) -> Option<Rates> {
        let slide = self.slide.as_ref()?;
        let [below, above] = self.sides(time, state, slide);
        Some(self.rates(time, state, slide.switch, [&below, &above]))
    }

    /// The fields on both sides.
    fn sides(&self, time: f64, state: &[f64], slide: &Slide) -> [Vec<f64>; 2] {
        [&self.parameters, &slide.above].map(|parameters| {
            let mut derivative = vec![0.0; state.len()];
            self.model.evaluate_at(self.clamped(time), state, parameters, &mut derivative);
            derivative
        })
    }

    /// The field at a state.
    pub(super) fn velocity(&self, time: f64, state: &[f64]) -> Vec<f64> {
        let mut derivative = vec![0.0; state.len()];
        match &self.slide {
            None => {
                self.model.evaluate_at(self.clamped(time), state, &self.parameters, &mut derivative);
            }
            Some(slide) => {
                let [below, above] = self.sides(time, state, slide);
                let part = self.rates(time, state, slide.switch, [&below, &above]).part_above();
                for (mean, (below, above)) in derivative.iter_mut().zip(below.iter().zip(&above)) {
                    *mean = below + part * (above - below);
                }
            }
        }
        derivative
    }
}

/// A function of state and time at a point, with its gradient.
#[derive(Clone, Debug)]
pub(super) struct Slope {
    pub value: f64,
    /// By the states and then by the time.
    pub gradient: Vec<f64>,
}

impl Slope {
    fn of(mut function: impl FnMut(&[JacobianColumns]) -> JacobianColumns, time: f64, state: &[f64]) -> Self {
        let point = [state, &[time]].concat();
        let mut value = 0.0;
        let mut columns = vec![0.0; point.len() * point.len()];
        exact_jacobian(
            |point, result| {
                result[0] = function(point);
                value = result[0].value;
            },
            &point,
            &mut columns,
        );
        Self { value, gradient: columns.into_iter().step_by(point.len()).collect() }
    }

    /// What of the value may be rounding.
    pub(super) fn noise(&self, time: f64, state: &[f64]) -> f64 {
        let point = state.iter().chain([&time]);
        ROUNDING * self.gradient.iter().zip(point).map(|(slope, value)| (slope * value).abs()).sum::<f64>()
    }
}

fn constants(values: &[f64]) -> Vec<JacobianColumns> {
    values.iter().map(|value| JacobianColumns::constant(*value)).collect()
}

impl System for Flow<'_> {
    fn dimension(&self) -> usize {
        self.model.states().len()
    }

    fn evaluate(&mut self, time: f64, state: &[f64], derivative: &mut [f64]) {
        if self.slide.is_some() {
            derivative.copy_from_slice(&self.velocity(time, state));
        } else {
            self.model.evaluate_at(self.clamped(time), state, &self.parameters, derivative);
        }
    }

    fn jacobian(&mut self, time: f64, state: &[f64], jacobian: &mut [f64]) {
        let time = JacobianColumns::constant(self.clamped(time));
        let parameters = constants(&self.parameters);
        let field = |state: &[JacobianColumns], slope: &mut [JacobianColumns]| {
            self.model.evaluate_at(time, state, &parameters, slope);
        };
        // Along a switch that of one side: an approximation does for the steps of Newton's method.
        exact_jacobian(field, state, jacobian);
    }
}
