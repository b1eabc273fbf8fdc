//! What curves in two parameters are asked for: two parameters, their ranges, and which way is forward.

use crate::continuation::Bound;
use crate::equilibrium::{check_length, check_range};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use std::ops::RangeInclusive;

/// A parameter and its range.
pub(super) type Range = (String, RangeInclusive<f64>);

/// The first parameter stands still where it changes less than this part of the second, in parts of their ranges.
const STANDSTILL: f64 = 1e-3;

/// Two parameters of a field and the ranges in which they may vary; the last two unknowns of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwoParameters {
    pub active: [usize; 2],
    pub bounds: [Bound; 2],
}

impl TwoParameters {
    /// Checks what was asked for of a curve that starts with the values `parameters`.
    ///
    /// # Errors
    /// [`Error::Invalid`]
    pub fn checked(
        field: &ErasedField<'_>,
        along: &[Option<Range>; 2],
        parameters: &[f64],
    ) -> Result<Self, Error> {
        let [Some(first), Some(second)] = along else {
            return Err(invalid("along", "fewer than two parameters", "two parameters and their ranges"));
        };
        let names = field.parameter_names();
        let index = |name: &str| {
            let found = names.iter().position(|candidate| candidate == name);
            found.ok_or_else(|| invalid("along", name, &format!("one of {}", names.join(", "))))
        };
        let active = [index(&first.0)?, index(&second.0)?];
        if active[0] == active[1] {
            return Err(invalid("along", &first.0, "two different parameters"));
        }
        check_length("parameters of the start", parameters, names.len(), "the number of parameters")?;
        let bounds = [
            Bound { from_end: 2, ..check_range(&first.0, &first.1)? },
            Bound { from_end: 1, ..check_range(&second.0, &second.1)? },
        ];
        for (bound, (&index, name)) in bounds.iter().zip(active.iter().zip([&first.0, &second.0])) {
            let value = parameters[index];
            if !(bound.lower..=bound.upper).contains(&value) {
                return Err(invalid(
                    &format!("range of {name}"),
                    &format!("{} to {}", bound.lower, bound.upper),
                    &format!("a range that contains {value}, where the curve starts"),
                ));
            }
        }
        Ok(Self { active, bounds })
    }

    /// The same with the other parameter first.
    pub fn swapped(self) -> Self {
        let Self { active: [first, second], bounds: [one, other] } = self;
        Self {
            active: [second, first],
            bounds: [Bound { from_end: 1, ..one }, Bound { from_end: 2, ..other }],
        }
    }

    /// Lengths of the ranges in the order of the unknowns.
    pub fn ranges(&self) -> [f64; 2] {
        let mut ranges = [0.0; 2];
        for bound in self.bounds {
            ranges[2 - bound.from_end] = bound.upper - bound.lower;
        }
        ranges
    }
}

/// Turns a tangent so that it points forward: the first parameter grows, or the second one where the first stands still.
pub(super) fn point_forward(tangent: &mut [f64], ranges: [f64; 2]) {
    let end = tangent.len() - 2;
    let [one, other] = [0, 1].map(|index| tangent[end + index] / ranges[index]);
    let moves = one.abs() > STANDSTILL * other.abs();
    if (if moves { one } else { other }) < 0.0 {
        tangent.iter_mut().for_each(|entry| *entry = -*entry);
    }
}

/// An error about something asked for.
pub(super) fn invalid(name: &str, value: &str, allowed: &str) -> Error {
    Error::Invalid { name: name.into(), value: value.into(), allowed: allowed.into() }
}
