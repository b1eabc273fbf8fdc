//! Multilinear forms of a vector field: the higher derivatives that normal forms are made of.
//!
//! Computed by nested dual numbers, one level for each direction, exact to rounding.

use crate::differentiation::{Dual, Scalar};
use crate::erased::{ErasedField, FieldScalar};
use num_complex::Complex64;

/// A number with one infinitesimal for each of several directions.
trait Nested: Scalar {
    fn lift(value: f64, directions: &[f64]) -> Self;
    fn mixed_derivative(&self) -> f64;
}

impl Nested for f64 {
    fn lift(value: f64, _directions: &[f64]) -> Self {
        value
    }
    fn mixed_derivative(&self) -> f64 {
        *self
    }
}

impl<T: Nested> Nested for Dual<T, 1> {
    fn lift(value: f64, directions: &[f64]) -> Self {
        Self { value: T::lift(value, &directions[1..]), derivatives: [T::from(directions[0])] }
    }
    fn mixed_derivative(&self) -> f64 {
        self.derivatives[0].mixed_derivative()
    }
}

type First = Dual<f64, 1>;
type Second = Dual<First, 1>;
type Third = Dual<Second, 1>;
type Fourth = Dual<Third, 1>;
type Fifth = Dual<Fourth, 1>;

/// Adds a multiple of a derivative along real directions in the space of states to `values` at many points: states, directions and
/// values hold `n` numbers for each point, and `points` are the indices of those that are wanted.
pub(crate) fn add_along(
    (field, parameters): (ErasedField<'_>, &[f64]),
    states: &[f64],
    directions: &[&[f64]],
    factor: f64,
    points: impl Iterator<Item = usize>,
    values: &mut [f64],
) {
    match directions.len() {
        1 => add_nested::<First>((field, parameters), states, directions, factor, points, values),
        2 => add_nested::<Second>((field, parameters), states, directions, factor, points, values),
        3 => add_nested::<Third>((field, parameters), states, directions, factor, points, values),
        4 => add_nested::<Fourth>((field, parameters), states, directions, factor, points, values),
        _ => add_nested::<Fifth>((field, parameters), states, directions, factor, points, values),
    }
}

fn add_nested<T: Nested + FieldScalar>(
    (field, parameters): (ErasedField<'_>, &[f64]),
    states: &[f64],
    directions: &[&[f64]],
    factor: f64,
    points: impl Iterator<Item = usize>,
    values: &mut [f64],
) {
    let n = field.dimension();
    let mut slopes = vec![0.0; directions.len()];
    let parameters: Vec<T> = parameters.iter().map(|&value| T::lift(value, &slopes)).collect();
    let mut state = vec![T::zero(); n];
    let mut image = vec![T::zero(); n];
    for point in points {
        for (component, entry) in state.iter_mut().enumerate() {
            let place = point * n + component;
            for (slope, direction) in slopes.iter_mut().zip(directions) {
                *slope = direction[place];
            }
            *entry = T::lift(states[place], &slopes);
        }
        field.evaluate(&state, &parameters, &mut image);
        for (entry, value) in values[point * n..].iter_mut().zip(&image) {
            *entry += factor * value.mixed_derivative();
        }
    }
}

/// The derivatives of a field with respect to the state (and one parameter) at a point.
#[derive(Clone, Debug)]
pub(crate) struct MultilinearForms<'a> {
    pub field: ErasedField<'a>,
    pub state: &'a [f64],
    pub parameters: &'a [f64],
}

impl MultilinearForms<'_> {
    /// The derivative of order `directions.len()` (one to five) along real directions in the space of states followed
    /// by parameters; a direction may stop after the states.
    pub(crate) fn real(&self, directions: &[&[f64]]) -> Vec<f64> {
        match directions.len() {
            1 => self.nested::<First>(directions),
            2 => self.nested::<Second>(directions),
            3 => self.nested::<Third>(directions),
            4 => self.nested::<Fourth>(directions),
            _ => self.nested::<Fifth>(directions),
        }
    }

    fn nested<T: Nested + FieldScalar>(&self, directions: &[&[f64]]) -> Vec<f64> {
        let mut slopes = vec![0.0; directions.len()];
        let mut lift = |index: usize, value: f64| {
            for (slope, direction) in slopes.iter_mut().zip(directions) {
                *slope = direction.get(index).copied().unwrap_or(0.0);
            }
            T::lift(value, &slopes)
        };
        let n = self.state.len();
        let state: Vec<T> = self.state.iter().enumerate().map(|(i, &value)| lift(i, value)).collect();
        let parameters: Vec<T> =
            self.parameters.iter().enumerate().map(|(i, &value)| lift(n + i, value)).collect();
        let mut image = vec![T::zero(); n];
        self.field.evaluate(&state, &parameters, &mut image);
        image.iter().map(Nested::mixed_derivative).collect()
    }

    /// The derivative of order `directions.len()` (one to five) along complex directions.
    pub(crate) fn complex(&self, directions: &[&[Complex64]]) -> Vec<Complex64> {
        let order = directions.len();
        let parts: Vec<[Vec<f64>; 2]> = directions
            .iter()
            .map(|direction| {
                [
                    direction.iter().map(|entry| entry.re).collect(),
                    direction.iter().map(|entry| entry.im).collect(),
                ]
            })
            .collect();
        let mut sum = vec![Complex64::ZERO; self.state.len()];
        for choice in 0..1_usize << order {
            let chosen: Vec<&[f64]> =
                (0..order).map(|index| parts[index][choice >> index & 1].as_slice()).collect();
            if chosen.iter().any(|part| part.iter().all(|&entry| entry == 0.0)) {
                continue;
            }
            let factor = Complex64::I.powu(choice.count_ones());
            for (total, value) in sum.iter_mut().zip(self.real(&chosen)) {
                *total += factor * value;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::VectorField;

    struct Monomial;

    impl VectorField for Monomial {
        fn state_names(&self) -> Vec<String> {
            vec!["x".into(), "y".into()]
        }
        fn parameter_names(&self) -> Vec<String> {
            vec!["p".into()]
        }
        fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
            derivative[0] = state[0].powi(3) * state[1].powi(2) * parameters[0];
            derivative[1] = state[0].exp();
        }
    }

    #[test]
    fn forms_of_a_monomial() {
        let forms = MultilinearForms { field: Monomial.erased(), state: &[2.0, 3.0], parameters: &[5.0] };
        let (x, y, p): (&[f64], &[f64], &[f64]) = (&[1.0], &[0.0, 1.0], &[0.0, 0.0, 1.0]);
        assert_eq!(forms.real(&[x]), [5.0 * 12.0 * 9.0, 2f64.exp()]);
        assert_eq!(forms.real(&[x, y])[0], 5.0 * 12.0 * 6.0);
        assert_eq!(forms.real(&[x, x, x, y, y])[0], 5.0 * 6.0 * 2.0);
        assert_eq!(forms.real(&[x, x, y, p])[0], 12.0 * 6.0);
        assert_eq!(forms.real(&[x, x, x, x]), [0.0, 2f64.exp()]);
        // A complex direction is the sum of its parts.
        let q = [Complex64::new(1.0, 2.0), Complex64::new(0.0, -1.0)];
        let square = forms.complex(&[&q, &q])[0];
        let (xx, xy, yy) = (5.0 * 12.0 * 9.0, 5.0 * 12.0 * 6.0, 5.0 * 8.0 * 2.0);
        let expected = q[0] * q[0] * xx + q[0] * q[1] * 2.0 * xy + q[1] * q[1] * yy;
        assert!((square - expected).norm() < 1e-12 * expected.norm());
    }
}
