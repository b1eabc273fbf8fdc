//! A vector field behind a pointer, so that everything else is compiled once and not for every field.
//!
//! [`VectorField::evaluate`] is generic over the scalar. Equilibria, cycles and the curves in two parameters use a short list
//! of scalars, so a field can be erased to a table with one entry for each of them. That divides the time
//! to compile a program with many fields by more than ten; the cost is one indirect call for an evaluation.

use crate::differentiation::{Dual, Scalar};
use crate::field::VectorField;
use std::any::TypeId;

/// Chunks of directions of a Jacobian, and the same with one and two more infinitesimals.
type Narrow = Dual<f64, 4>;
type Wide = Dual<f64, 8>;
type NarrowAlong = Dual<Narrow, 1>;
type WideAlong = Dual<Wide, 1>;
type NarrowAlongPair = Dual<Narrow, 2>;
type WideAlongPair = Dual<Wide, 2>;
type Pair = Dual<f64, 2>;
type NarrowAlongTwice = Dual<NarrowAlong, 1>;
/// One infinitesimal for each direction of a multilinear form.
type First = Dual<f64, 1>;
type Second = Dual<First, 1>;
type Third = Dual<Second, 1>;
type Fourth = Dual<Third, 1>;
type Fifth = Dual<Fourth, 1>;

macro_rules! scalars {
    ($($method:ident: $scalar:ty;)*) => {
        /// A field, for the scalars in use.
        trait Table: Sync {
            fn state_names(&self) -> Vec<String>;
            fn parameter_names(&self) -> Vec<String>;
            fn dimension(&self) -> usize;
            $(fn $method(&self, state: &[$scalar], parameters: &[$scalar], derivative: &mut [$scalar]);)*
        }

        impl<F: VectorField> Table for F {
            fn state_names(&self) -> Vec<String> {
                VectorField::state_names(self)
            }
            fn parameter_names(&self) -> Vec<String> {
                VectorField::parameter_names(self)
            }
            fn dimension(&self) -> usize {
                VectorField::dimension(self)
            }
            $(fn $method(&self, state: &[$scalar], parameters: &[$scalar], derivative: &mut [$scalar]) {
                self.evaluate(state, parameters, derivative);
            })*
        }

        impl VectorField for ErasedField<'_> {
            fn state_names(&self) -> Vec<String> {
                self.0.state_names()
            }
            fn parameter_names(&self) -> Vec<String> {
                self.0.parameter_names()
            }
            fn dimension(&self) -> usize {
                self.0.dimension()
            }
            fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
                $(if let (Some(state), Some(parameters)) =
                    (same::<T, $scalar>(state), same::<T, $scalar>(parameters))
                    && let Some(derivative) = same_mut::<T, $scalar>(derivative)
                {
                    return self.0.$method(state, parameters, derivative);
                })*
                // No computation here uses another scalar; a result that is not finite is noticed everywhere.
                debug_assert!(false, "no entry for {}", std::any::type_name::<T>());
                derivative.fill(T::from(f64::NAN));
            }
        }
    };
}

/// A field of unknown type.
#[derive(Clone, Copy)]
pub(crate) struct ErasedField<'a>(&'a dyn Table);

impl<'a> ErasedField<'a> {
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self(field)
    }
}

impl std::fmt::Debug for ErasedField<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "a vector field of {}", self.0.state_names().join(", "))
    }
}

scalars! {
    evaluate_value: f64;
    evaluate_narrow: Narrow;
    evaluate_wide: Wide;
    evaluate_narrow_along: NarrowAlong;
    evaluate_narrow_along_twice: NarrowAlongTwice;
    evaluate_wide_along: WideAlong;
    evaluate_narrow_along_pair: NarrowAlongPair;
    evaluate_wide_along_pair: WideAlongPair;
    evaluate_pair: Pair;
    evaluate_first: First;
    evaluate_second: Second;
    evaluate_third: Third;
    evaluate_fourth: Fourth;
    evaluate_fifth: Fifth;
}

/// The slice itself, if `T` and `U` are one and the same type.
fn same<T: 'static, U: 'static>(slice: &[T]) -> Option<&[U]> {
    // SAFETY: the types are identical, so pointer, length and lifetime stay valid.
    (TypeId::of::<T>() == TypeId::of::<U>())
        .then(|| unsafe { std::slice::from_raw_parts(slice.as_ptr().cast::<U>(), slice.len()) })
}

/// The slice itself, if `T` and `U` are one and the same type.
fn same_mut<T: 'static, U: 'static>(slice: &mut [T]) -> Option<&mut [U]> {
    // SAFETY: the types are identical, so pointer, length and lifetime stay valid; the borrow is handed on.
    (TypeId::of::<T>() == TypeId::of::<U>())
        .then(|| unsafe { std::slice::from_raw_parts_mut(slice.as_mut_ptr().cast::<U>(), slice.len()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Square;

    impl VectorField for Square {
        fn state_names(&self) -> Vec<String> {
            vec!["x".into()]
        }
        fn parameter_names(&self) -> Vec<String> {
            vec!["p".into()]
        }
        fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
            derivative[0] = parameters[0] * state[0] * state[0];
        }
    }

    #[test]
    fn an_erased_field_is_the_field() {
        fn check<T: Scalar + PartialEq>(x: T, p: T) {
            let (mut direct, mut erased) = ([T::zero()], [T::zero()]);
            Square.evaluate(&[x], &[p], &mut direct);
            ErasedField::of(&Square).evaluate(&[x], &[p], &mut erased);
            assert!(direct == erased && direct[0].value() == 18.0);
        }
        check(3.0, 2.0);
        check(Wide::variable(3.0, 1), Wide::variable(2.0, 5));
        check(NarrowAlongTwice::variable(Dual::from(3.0), 0), NarrowAlongTwice::from(2.0));
        check(Fifth::variable(Dual::from(3.0), 0), Fifth::from(2.0));
        assert_eq!(VectorField::dimension(&ErasedField::of(&Square)), 1);
    }
}
