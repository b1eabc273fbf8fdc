//! What curves in two parameters are asked for: the order of the two parameters, and which way is forward.

use crate::branch::invalid;
use crate::continuation::{Bound, START_ROUNDING};
use crate::error::Error;

/// The first parameter stands still where it changes less than this part of the second, in parts of their ranges.
const STANDSTILL: f64 = 1e-3;

/// Two parameters and the ranges in which they may vary, the last two unknowns of a curve. Bounds are in the order in which they
/// were asked for, indices in the order of the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwoParameters {
    pub active: [usize; 2],
    pub bounds: [Bound; 2],
    /// Whether the two orders differ.
    pub swapped: bool,
}

impl TwoParameters {
    /// That the start, with the values `parameters`, lies inside the ranges.
    ///
    /// # Errors
    /// [`Error::Invalid`]
    pub(super) fn checked(
        active: &[usize],
        bounds: &[Bound],
        names: &[String],
        parameters: &[f64],
    ) -> Result<Self, Error> {
        for (&index, bound) in active.iter().zip(bounds) {
            let value = parameters[index];
            if !bound.holds(value, START_ROUNDING) {
                return Err(invalid(
                    &format!("range of {}", names[index]),
                    &format!("{} to {}", bound.lower, bound.upper),
                    &format!("a range that contains {value}, where the curve starts"),
                ));
            }
        }
        Ok(Self { active: [active[0], active[1]], bounds: [bounds[0], bounds[1]], swapped: false })
    }

    /// The same with the other parameter first among the unknowns.
    pub(super) fn swapped(self) -> Self {
        let Self { active: [first, second], bounds: [one, other], swapped } = self;
        let bounds = [Bound { from_end: other.from_end, ..one }, Bound { from_end: one.from_end, ..other }];
        Self { active: [second, first], bounds, swapped: !swapped }
    }

    /// Lengths of the ranges in the order of the unknowns.
    pub(super) fn ranges(&self) -> [f64; 2] {
        let mut ranges = [0.0; 2];
        for bound in self.bounds {
            ranges[2 - bound.from_end] = bound.width();
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
