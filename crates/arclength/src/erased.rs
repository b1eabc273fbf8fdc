//! A vector field behind a pointer, so that everything else is compiled once and not for every field.
//!
//! [`crate::VectorField::evaluate`] is generic over the scalar. Equilibria, cycles and the curves in two parameters use a short list
//! of scalars, the [`FieldScalar`]s, so a field can be erased to a table with one entry for each of them. That divides the
//! time to compile a program with many fields by more than ten; the cost is one indirect call for an evaluation. A scalar that
//! is not on the list does not compile.

use crate::differentiation::{Dual, Scalar};
use crate::direction::Direction;
use crate::threshold::Threshold;

/// Chunks of directions of a Jacobian, and the same with one and two more infinitesimals.
pub(crate) type Narrow = Dual<f64, 4>;
pub(crate) type Wide = Dual<f64, 8>;
pub(crate) type NarrowAlong = Dual<Narrow, 1>;
pub(crate) type WideAlong = Dual<Wide, 1>;
pub(crate) type NarrowAlongPair = Dual<Narrow, 2>;
pub(crate) type WideAlongPair = Dual<Wide, 2>;
pub(crate) type NarrowAlongTwice = Dual<NarrowAlong, 1>;
pub(crate) type Pair = Dual<f64, 2>;
/// One infinitesimal for each direction of a multilinear form.
pub(crate) type First = Dual<f64, 1>;
pub(crate) type Second = Dual<First, 1>;
pub(crate) type Third = Dual<Second, 1>;
pub(crate) type Fourth = Dual<Third, 1>;
pub(crate) type Fifth = Dual<Fourth, 1>;

/// A scalar for which every field has an entry in its table: `f64` and a short list of dual numbers. The list is closed.
pub trait FieldScalar: Scalar {
    /// Writes `f(state, parameters)` into `derivative`, by the entry for this scalar.
    #[doc(hidden)]
    fn evaluate(field: &dyn Table, state: &[Self], parameters: &[Self], derivative: &mut [Self]);

    /// Writes the condition of an event and the state behind it into `values`, by the entry for this scalar.
    #[doc(hidden)]
    fn evaluate_event(
        field: &dyn Table,
        event: usize,
        state: &[Self],
        parameters: &[Self],
        values: &mut [Self],
    );

    /// The rate at which a switch function changes along a direction, by the entry for a scalar with one more infinitesimal; not a
    /// number where there is no such entry.
    #[doc(hidden)]
    fn rate_along(
        field: &dyn Table,
        switch: usize,
        state: &[Self],
        direction: &[Self],
        parameters: &[Self],
    ) -> Self;
}

/// A scalar that Jacobians are computed with: `f64` for the value, dual numbers with four or eight directions for the columns.
///
/// Defining systems of special points differentiate once more, in one or two directions: a field has entries for that, too.
pub trait JacobianScalar:
    FieldScalar
    + Lift<1, Lifted = Dual<Self, 1>, Lifted: FieldScalar>
    + Lift<2, Lifted = Dual<Self, 2>, Lifted: FieldScalar>
{
}

impl JacobianScalar for f64 {}
impl JacobianScalar for Narrow {}
impl JacobianScalar for Wide {}

/// A scalar of Jacobians that are computed four columns at a time. Defining systems may differentiate twice more in one
/// direction; in eight columns that would be a fifth of what is compiled for a field.
pub trait NarrowScalar:
    JacobianScalar + Lift<1, Lifted: Lift<1, Lifted = Dual<Dual<Self, 1>, 1>, Lifted: FieldScalar>>
{
}

impl NarrowScalar for f64 {}
impl NarrowScalar for Narrow {}

/// A scalar with `N` more infinitesimals, under a name of its own so that a trait can say what it is.
pub trait Lift<const N: usize> {
    /// `Dual<Self, N>`.
    type Lifted;
}

impl<T: Scalar, const N: usize> Lift<N> for T {
    type Lifted = Dual<T, N>;
}

/// The rate of a switch function by a scalar that has one with one more infinitesimal on the list, and by one that has none.
macro_rules! rate_of {
    ($field:ident, $switch:ident, $state:ident, $direction:ident, $parameters:ident, lifted) => {
        rate_by($field, $switch, $state, $direction, $parameters)
    };
    ($field:ident, $switch:ident, $state:ident, $direction:ident, $parameters:ident) => {{
        let _ = ($field, $switch, $state, $direction, $parameters);
        f64::NAN.into()
    }};
}

/// Hands the method of a [`Table`] for each scalar on the list, with the scalar, to a macro; `lifted` are those of which the one with
/// one more infinitesimal is on it, too.
macro_rules! with_field_scalars {
    ($macro:ident) => {
        $macro! {
            evaluate_value, event_value: f64, lifted;
            evaluate_narrow, event_narrow: Narrow, lifted;
            evaluate_wide, event_wide: Wide, lifted;
            evaluate_narrow_along, event_narrow_along: NarrowAlong, lifted;
            evaluate_wide_along, event_wide_along: WideAlong;
            evaluate_narrow_along_pair, event_narrow_along_pair: NarrowAlongPair;
            evaluate_wide_along_pair, event_wide_along_pair: WideAlongPair;
            evaluate_narrow_along_twice, event_narrow_along_twice: NarrowAlongTwice;
            evaluate_pair, event_pair: Pair;
            evaluate_first, event_first: First, lifted;
            evaluate_second, event_second: Second, lifted;
            evaluate_third, event_third: Third, lifted;
            evaluate_fourth, event_fourth: Fourth, lifted;
            evaluate_fifth, event_fifth: Fifth;
        }
    };
}
pub(crate) use with_field_scalars;

macro_rules! table {
    ($($method:ident, $event:ident: $scalar:ty $(, $lifted:ident)?;)*) => {
        /// A field, for the scalars in use.
        pub trait Table: Sync {
            /// As `VectorField::state_names`.
            fn state_names(&self) -> Vec<String>;
            /// As `VectorField::parameter_names`.
            fn parameter_names(&self) -> Vec<String>;
            /// As `VectorField::dimension`.
            fn dimension(&self) -> usize;
            /// As `VectorField::thresholds`.
            fn thresholds(&self) -> Vec<Threshold>;
            /// As `VectorField::events`.
            fn events(&self) -> Vec<Direction>;
            $(
                /// As `VectorField::evaluate`.
                fn $method(&self, state: &[$scalar], parameters: &[$scalar], derivative: &mut [$scalar]);
                /// As `VectorField::evaluate_event`.
                fn $event(
                    &self,
                    event: usize,
                    state: &[$scalar],
                    parameters: &[$scalar],
                    values: &mut [$scalar],
                );
            )*
        }

        $(impl FieldScalar for $scalar {
            #[inline(always)]
            fn evaluate(field: &dyn Table, state: &[Self], parameters: &[Self], derivative: &mut [Self]) {
                field.$method(state, parameters, derivative);
            }

            #[inline(always)]
            fn evaluate_event(
                field: &dyn Table,
                event: usize,
                state: &[Self],
                parameters: &[Self],
                values: &mut [Self],
            ) {
                field.$event(event, state, parameters, values);
            }

            fn rate_along(
                field: &dyn Table,
                switch: usize,
                state: &[Self],
                direction: &[Self],
                parameters: &[Self],
            ) -> Self {
                rate_of!(field, switch, state, direction, parameters $(, $lifted)?)
            }
        })*
    };
}

with_field_scalars!(table);

/// The rate of a switch function along a direction, by the scalar with one more infinitesimal.
fn rate_by<T: FieldScalar>(
    field: &dyn Table,
    switch: usize,
    state: &[T],
    direction: &[T],
    parameters: &[T],
) -> T
where
    Dual<T, 1>: FieldScalar,
{
    let moving = state.iter().zip(direction);
    let moving: Vec<Dual<T, 1>> =
        moving.map(|(value, slope)| Dual { value: *value, derivatives: [*slope] }).collect();
    let parameters: Vec<Dual<T, 1>> = parameters.iter().copied().map(Dual::constant).collect();
    let mut results = vec![Dual::zero(); state.len() + switch + 1];
    FieldScalar::evaluate(field, &moving, &parameters, &mut results);
    results[state.len() + switch].derivatives[0]
}

/// A field of unknown type.
#[derive(Clone, Copy)]
pub struct ErasedField<'a>(&'a dyn Table);

impl<'a> ErasedField<'a> {
    /// The field without its type, compiled where this is written; see [`crate::VectorField::erased`].
    pub fn new(field: &'a dyn Table) -> Self {
        Self(field)
    }

    /// As [`crate::VectorField::state_names`].
    pub(crate) fn state_names(&self) -> Vec<String> {
        self.0.state_names()
    }

    /// As [`crate::VectorField::parameter_names`].
    pub(crate) fn parameter_names(&self) -> Vec<String> {
        self.0.parameter_names()
    }

    /// As [`crate::VectorField::dimension`].
    pub(crate) fn dimension(&self) -> usize {
        self.0.dimension()
    }

    /// As [`crate::VectorField::thresholds`].
    pub(crate) fn thresholds(&self) -> Vec<Threshold> {
        self.0.thresholds()
    }

    /// As [`crate::VectorField::events`].
    pub(crate) fn events(&self) -> Vec<Direction> {
        self.0.events()
    }

    /// As [`crate::VectorField::evaluate_event`], for the scalars of the list.
    pub(crate) fn evaluate_event<T: FieldScalar>(
        &self,
        event: usize,
        state: &[T],
        parameters: &[T],
        values: &mut [T],
    ) {
        T::evaluate_event(self.0, event, state, parameters, values);
    }

    /// The rate at which a switch function changes along a direction; not a number for scalars without one more infinitesimal.
    pub(crate) fn rate_along<T: FieldScalar>(
        &self,
        switch: usize,
        state: &[T],
        direction: &[T],
        parameters: &[T],
    ) -> T {
        T::rate_along(self.0, switch, state, direction, parameters)
    }

    /// As [`crate::VectorField::evaluate`], for the scalars of the list.
    #[inline(always)]
    pub(crate) fn evaluate<T: FieldScalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        T::evaluate(self.0, state, parameters, derivative);
    }
}

impl std::fmt::Debug for ErasedField<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "a vector field of {}", self.0.state_names().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VectorField;

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
        fn check<T: FieldScalar + PartialEq>(x: T, p: T) {
            let (mut direct, mut erased) = ([T::zero()], [T::zero()]);
            VectorField::evaluate(&Square, &[x], &[p], &mut direct);
            Square.erased().evaluate(&[x], &[p], &mut erased);
            assert!(direct == erased && direct[0].value() == 18.0);
        }
        check(3.0, 2.0);
        check(Wide::variable(3.0, 1), Wide::variable(2.0, 5));
        check(NarrowAlongTwice::variable(Dual::from(3.0), 0), NarrowAlongTwice::from(2.0));
        check(Fifth::variable(Dual::from(3.0), 0), Fifth::from(2.0));
        assert_eq!(Square.erased().dimension(), 1);
    }
}
