//! The segments of a cycle whose field is smooth only piece by piece, or whose state jumps: the smooth field of each, and the gate
//! at its end, a smooth function that is zero there.

use crate::erased::{ErasedField, FieldScalar};
use crate::integration::equal_steps;
use crate::parameters::with_parameters;

/// The smooth field of a segment: that of a region, or along a switch.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Course {
    /// Parameters of the model and then the cells of the region; along a switch those below it.
    pub parameters: Vec<f64>,
    /// The switch along which the cycle slides, with the parameters and cells above it.
    pub slide: Option<Slide>,
}

/// A switch along which a cycle slides: the fields on both sides push towards it, and the cycle follows the mean of both that keeps
/// the switch function at its border (Filippov, *Differential Equations with Discontinuous Righthand Sides*, 1988).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slide {
    pub switch: usize,
    pub above: Vec<f64>,
}

/// What ends a segment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gate {
    pub function: GateFunction,
    /// Whether the function that is zero here grows.
    pub upwards: bool,
    /// The events that happen here, in their order.
    pub events: Vec<usize>,
}

/// A function of the state that is zero at a gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GateFunction {
    /// A switch function less its value at a border.
    Border { switch: usize, value: f64 },
    /// The condition of an event.
    Condition { event: usize },
    /// The rate of a switch function by the field below or above it, along which the cycle slides until that no longer pushes.
    Pull { switch: usize, above: bool },
}

impl Course {
    /// The field of a region.
    pub(crate) fn within(parameters: &[f64], cells: &[f64]) -> Self {
        Self { parameters: [parameters, cells].concat(), slide: None }
    }

    /// The cells of the regions that it is made of: those of the only one, or those below and above the switch.
    pub(crate) fn cells(&self, switches: usize) -> [&[f64]; 2] {
        let cells = |all: &'_ [f64]| all.len() - switches;
        let above = self.slide.as_ref().map_or(&self.parameters, |slide| &slide.above);
        [&self.parameters[cells(&self.parameters)..], &above[cells(above)..]]
    }

    /// Writes the field at a state; `replaced` are the parameters that vary.
    pub(crate) fn velocity<T: FieldScalar>(
        &self,
        field: ErasedField<'_>,
        state: &[T],
        replaced: &[(usize, T)],
        derivative: &mut [T],
    ) {
        with_parameters(&self.parameters, replaced.iter().copied(), |below: &[T]| match &self.slide {
            None => field.evaluate(state, below, derivative),
            Some(slide) => with_parameters(&slide.above, replaced.iter().copied(), |above: &[T]| {
                sliding(field, slide.switch, state, [below, above], derivative);
            }),
        });
    }

    /// The state a time after another one, by equal steps.
    pub(super) fn flow<T: FieldScalar>(
        &self,
        field: ErasedField<'_>,
        state: &[T],
        replaced: &[(usize, T)],
        duration: T,
        steps: usize,
    ) -> Vec<T> {
        with_parameters(&self.parameters, replaced.iter().copied(), |below: &[T]| match &self.slide {
            None => equal_steps(|state, slope| field.evaluate(state, below, slope), state, duration, steps),
            Some(slide) => with_parameters(&slide.above, replaced.iter().copied(), |above: &[T]| {
                let flow = |state: &[T], slope: &mut [T]| {
                    sliding(field, slide.switch, state, [below, above], slope);
                };
                equal_steps(flow, state, duration, steps)
            }),
        })
    }
}

/// Writes the field along a switch.
fn sliding<T: FieldScalar>(
    field: ErasedField<'_>,
    switch: usize,
    state: &[T],
    [below, above]: [&[T]; 2],
    derivative: &mut [T],
) {
    let n = state.len();
    let mut other = vec![T::zero(); n];
    field.evaluate(state, below, derivative);
    field.evaluate(state, above, &mut other);
    let rate_below = field.rate_along(switch, state, derivative, below);
    let rate_above = field.rate_along(switch, state, &other, below);
    let part = rate_below / (rate_below - rate_above);
    for (mean, above) in derivative.iter_mut().zip(&other) {
        *mean += part * (*above - *mean);
    }
}

impl Gate {
    /// The function that is zero here, at a state of the segment that ends here.
    pub(super) fn value<T: FieldScalar>(
        &self,
        field: ErasedField<'_>,
        course: &Course,
        state: &[T],
        replaced: &[(usize, T)],
        switches: usize,
    ) -> T {
        let n = state.len();
        with_parameters(&course.parameters, replaced.iter().copied(), |parameters: &[T]| {
            match self.function {
                GateFunction::Border { switch, value } => {
                    let mut results = vec![T::zero(); n + switches];
                    field.evaluate(state, parameters, &mut results);
                    results[n + switch] - value
                }
                GateFunction::Condition { event } => {
                    let mut value = [T::zero()];
                    let own = parameters.len() - switches;
                    field.evaluate_event(event, state, &parameters[..own], &mut value);
                    value[0]
                }
                GateFunction::Pull { switch, above } => {
                    let mut velocity = vec![T::zero(); n];
                    match &course.slide {
                        Some(slide) if above => {
                            with_parameters(&slide.above, replaced.iter().copied(), |above: &[T]| {
                                field.evaluate(state, above, &mut velocity);
                            });
                        }
                        _ => field.evaluate(state, parameters, &mut velocity),
                    }
                    field.rate_along(switch, state, &velocity, parameters)
                }
            }
        })
    }

    /// Takes a state to that behind the events that happen here.
    pub(super) fn reset<T: FieldScalar>(
        &self,
        field: ErasedField<'_>,
        course: &Course,
        state: &mut [T],
        replaced: &[(usize, T)],
        switches: usize,
    ) {
        let mut values = vec![T::zero(); state.len() + 1];
        with_parameters(&course.parameters, replaced.iter().copied(), |parameters: &[T]| {
            let own = parameters.len() - switches;
            for event in &self.events {
                field.evaluate_event(*event, state, &parameters[..own], &mut values);
                state.copy_from_slice(&values[1..]);
            }
        });
    }
}
