//! The boundary value problem of a limit cycle: `u' = T f(u, p)`, `u(1) = u(0)`, with the integral phase
//! condition of Doedel (1981).

use super::segments::Segments;
use crate::collocation::polynomials::Polynomials;
use crate::collocation::problem::{BoundaryValueEquations, Reference};
use crate::differentiation::Scalar;
use crate::erased::{ErasedField, JacobianScalar};
use crate::error::Error;
use crate::parameters::with_parameters;

/// A limit cycle with scalars `(T, p)`: period and active parameter.
#[derive(Debug, Clone)]
pub(crate) struct LimitCycle<'a> {
    /// The vector field.
    pub field: ErasedField<'a>,
    /// All parameters; the active one is replaced by the unknown.
    pub parameters: Vec<f64>,
    /// Index of the active parameter.
    pub active: usize,
    /// Sizes of the state variables, for conditions that mix them.
    pub scales: Vec<f64>,
    /// The segments of the cycle, where the field is smooth only piece by piece.
    pub segments: Option<Segments>,
}

impl LimitCycle<'_> {
    /// The segments of the cycle that polynomials describe at a value of the active parameter, with the gates where they are; the
    /// state jumps where it is known to.
    ///
    /// # Errors
    /// [`Error::TooManyBorders`].
    pub(crate) fn segments_of(&self, cycle: Polynomials<'_>, value: f64) -> Result<Option<Segments>, Error> {
        let mut parameters = self.parameters.clone();
        parameters[self.active] = value;
        Segments::of(self.field, cycle, &parameters, self.segments.as_ref())
    }

    /// Whether the field switches along the cycle.
    pub(crate) fn has_borders(&self) -> bool {
        self.segments.as_ref().is_some_and(|segments| !segments.times.is_empty())
    }
}

impl BoundaryValueEquations for LimitCycle<'_> {
    #[inline(always)]
    fn dimension(&self) -> usize {
        self.scales.len()
    }

    #[inline(always)]
    fn scalars(&self) -> usize {
        2
    }

    #[inline(always)]
    fn has_linear_boundary_conditions(&self) -> bool {
        true
    }

    #[inline(always)]
    fn integral_conditions(&self) -> usize {
        1
    }

    /// The period multiplies the field and does nothing else.
    #[inline(always)]
    fn is_known(&self, scalar: usize) -> bool {
        scalar == 0
    }

    #[inline(always)]
    fn known_derivative(
        &self,
        _scalar: usize,
        _state: &[f64],
        scalars: &[f64],
        value: &[f64],
        derivative: &mut [f64],
    ) {
        for (entry, value) in derivative.iter_mut().zip(value) {
            *entry = value / scalars[0];
        }
    }

    #[inline(always)]
    fn field<T: JacobianScalar>(&self, time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        match &self.segments {
            None => with_parameters(&self.parameters, [(self.active, scalars[1])], |parameters| {
                self.field.evaluate(state, parameters, derivative);
            }),
            Some(segments) => {
                let course = segments.course_at(time);
                course.velocity(self.field, state, &[(self.active, scalars[1])], derivative);
            }
        }
        for entry in derivative.iter_mut() {
            *entry *= scalars[0];
        }
    }

    fn jumps(&self) -> &[f64] {
        self.segments.as_ref().map_or(&[], |segments| &segments.times)
    }

    fn jump<T: JacobianScalar>(&self, index: usize, before: &[T], scalars: &[T], after: &mut [T]) {
        if let Some(segments) = &self.segments {
            segments.jump(self.field, index, before, scalars[0].value(), &[(self.active, scalars[1])], after);
        }
    }

    fn delay(&self, index: usize, before: &[f64], scalars: &[f64]) -> Option<f64> {
        let segments = self.segments.as_ref()?;
        let (delay, _) =
            segments.delay(self.field, index, before, scalars[0], &[(self.active, scalars[1])])?;
        Some(delay / scalars[0])
    }

    fn at_jump(&self, index: usize, before: &[f64], scalars: &[f64]) -> Option<[Vec<f64>; 2]> {
        let segments = self.segments.as_ref()?;
        segments.at_gate(self.field, index, before, scalars[0], &[(self.active, scalars[1])])
    }

    fn move_jumps(&mut self, times: &[f64]) {
        if let Some(segments) = &mut self.segments {
            segments.times.copy_from_slice(times);
        }
    }

    #[inline(always)]
    fn boundary_conditions<T: JacobianScalar>(
        &self,
        start: &[T],
        end: &[T],
        _scalars: &[T],
        values: &mut [T],
    ) {
        for ((value, start), end) in values.iter_mut().zip(start).zip(end) {
            *value = *end - *start;
        }
    }

    #[inline(always)]
    fn integrands<T: JacobianScalar>(
        &self,
        state: &[T],
        _scalars: &[T],
        reference: Reference<'_>,
        values: &mut [T],
    ) {
        values[0] = phase_integrand(state, reference, &self.scales);
    }
}

/// Integrand of the phase condition: `(u - u_ref) . u_ref'` in scaled variables.
#[inline(always)]
pub(crate) fn phase_integrand<T: Scalar>(state: &[T], reference: Reference<'_>, scales: &[f64]) -> T {
    let mut sum = T::zero();
    for (index, scale) in scales.iter().enumerate() {
        sum += (state[index] - reference.state[index]) * (reference.slope[index] / (scale * scale));
    }
    sum
}
