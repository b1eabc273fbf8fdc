//! Vector fields.
//!
//! Everything that the rest of the crate asks of a model goes through [`VectorField::evaluate`],
//! with dual numbers where derivatives are needed.

use crate::differentiation::Scalar;
use crate::direction::Direction;
use crate::erased::*;
use crate::threshold::Threshold;

/// The right-hand side of `x' = f(x, p)`, smooth in the state `x` and in the parameters `p`, at least
/// [piece by piece](Self::thresholds).
///
/// ```
/// use arclength::{Scalar, VectorField};
///
/// struct VanDerPol;
///
/// impl VectorField for VanDerPol {
///     fn state_names(&self) -> Vec<String> {
///         vec!["x".into(), "y".into()]
///     }
///     fn parameter_names(&self) -> Vec<String> {
///         vec!["mu".into()]
///     }
///     fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
///         let (x, y, mu) = (state[0], state[1], parameters[0]);
///         derivative[0] = y;
///         derivative[1] = mu * (-(x * x) + 1.0) * y - x;
///     }
/// }
///
/// let mut derivative = [0.0; 2];
/// VanDerPol.evaluate(&[1.0, 2.0], &[5.0], &mut derivative);
/// assert_eq!(derivative, [2.0, -1.0]);
/// ```
pub trait VectorField: Sync {
    /// Names of the state variables; their number is the dimension.
    fn state_names(&self) -> Vec<String>;

    /// Names of the parameters, in the order in which [`evaluate`](Self::evaluate) takes them.
    fn parameter_names(&self) -> Vec<String>;

    /// Writes `f(state, parameters)` into `derivative`.
    ///
    /// Outside its domain the field writes numbers that are not finite; it does not panic.
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]);

    /// Number of state variables.
    fn dimension(&self) -> usize {
        self.state_names().len()
    }

    /// Where each switch function passes from one cell to the next, in a field that is smooth only piece by piece; empty for one
    /// that is smooth everywhere.
    ///
    /// A field with switch functions is evaluated [in a region](crate::pieces) where the parameters are followed by the cell of each of
    /// them: then it takes these for granted, so that it is smooth, and writes the switch functions behind the derivative as far as
    /// there is room. A switch function may depend on the cells of those before it.
    fn thresholds(&self) -> Vec<Threshold> {
        Vec::new()
    }

    /// The field without its type, as equilibria, cycles and curves in two parameters take it.
    ///
    /// A field that is large, and used in other crates, says this again where it is defined, with `#[inline(never)]` and
    /// [`ErasedField::new`]: then it is compiled there, once, and not in every crate that follows one of its branches.
    fn erased(&self) -> ErasedField<'_>
    where
        Self: Sized,
    {
        ErasedField::new(self)
    }

    /// The events of the field, at which the state jumps: for each, in which direction its condition passes zero where it happens;
    /// empty for a field whose motions are continuous.
    ///
    /// ```
    /// use arclength::{Direction, Scalar, VectorField};
    ///
    /// /// `v' = i - v`, set back to 0 where `v` reaches 1.
    /// struct IntegrateAndFire;
    /// impl VectorField for IntegrateAndFire {
    ///     fn state_names(&self) -> Vec<String> { vec!["v".into()] }
    ///     fn parameter_names(&self) -> Vec<String> { vec!["i".into()] }
    ///     fn evaluate<T: Scalar>(&self, v: &[T], i: &[T], slope: &mut [T]) {
    ///         slope[0] = i[0] - v[0];
    ///     }
    ///     fn events(&self) -> Vec<Direction> { vec![Direction::Rising] }
    ///     fn evaluate_event<T: Scalar>(&self, _event: usize, v: &[T], _i: &[T], values: &mut [T]) {
    ///         let (condition, next) = values.split_at_mut(1);
    ///         condition[0] = v[0] - 1.0;
    ///         if let [next] = next {
    ///             *next = T::zero();
    ///         }
    ///     }
    /// }
    ///
    /// let mut values = [0.0; 2];
    /// IntegrateAndFire.evaluate_event(0, &[1.25], &[2.0], &mut values);
    /// assert_eq!(values, [0.25, 0.0]);
    /// ```
    fn events(&self) -> Vec<Direction> {
        Vec::new()
    }

    /// Writes the condition of an event at a state into the first of `values`, and behind it, if there is room, the state to which
    /// the event takes this one.
    ///
    /// A field with [events](Self::events) defines it. Events that happen at the same state follow each other in their order, each
    /// from the state to which the one before has led.
    fn evaluate_event<T: Scalar>(&self, event: usize, state: &[T], parameters: &[T], values: &mut [T]) {
        let _ = (event, state, parameters, values);
    }
}

macro_rules! vector_field_table {
    ($($method:ident, $event:ident: $scalar:ty $(, $lifted:ident)?;)*) => {
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
            fn thresholds(&self) -> Vec<Threshold> {
                VectorField::thresholds(self)
            }
            fn events(&self) -> Vec<Direction> {
                VectorField::events(self)
            }
            $(
                fn $method(&self, state: &[$scalar], parameters: &[$scalar], derivative: &mut [$scalar]) {
                    self.evaluate(state, parameters, derivative);
                }
                fn $event(
                    &self,
                    event: usize,
                    state: &[$scalar],
                    parameters: &[$scalar],
                    values: &mut [$scalar],
                ) {
                    self.evaluate_event(event, state, parameters, values);
                }
            )*
        }
    };
}

with_field_scalars!(vector_field_table);

impl<F: VectorField> VectorField for &F {
    fn state_names(&self) -> Vec<String> {
        (**self).state_names()
    }
    fn parameter_names(&self) -> Vec<String> {
        (**self).parameter_names()
    }
    #[inline(always)]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        (**self).evaluate(state, parameters, derivative);
    }
    fn dimension(&self) -> usize {
        (**self).dimension()
    }
    fn thresholds(&self) -> Vec<Threshold> {
        (**self).thresholds()
    }
    fn erased(&self) -> ErasedField<'_> {
        (**self).erased()
    }
    fn events(&self) -> Vec<Direction> {
        (**self).events()
    }
    fn evaluate_event<T: Scalar>(&self, event: usize, state: &[T], parameters: &[T], values: &mut [T]) {
        (**self).evaluate_event(event, state, parameters, values);
    }
}
