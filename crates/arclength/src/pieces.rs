//! Fields that are smooth only piece by piece.
//!
//! A field with `abs`, `max`, a saturation or an `if` is smooth in each of the regions into which switch functions divide the state
//! space. In a region it is a smooth field of its own, which can be evaluated beyond the region's borders too: that is what
//! integration and collocation need to take a step up to a border, and to find the border itself as the zero of a smooth function.
//!
//! A region is a list of numbers, the *cell* of every switch function. It goes into the field as parameters do, so that a field in a
//! region is an ordinary [`VectorField`] and is differentiated like one.

use crate::erased::{ErasedField, FieldScalar};
use crate::field::VectorField;
use crate::parameters::with_parameters;
use crate::threshold::Threshold;

/// A border of a region on the way out of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// Index of the switch function.
    pub switch: usize,
    /// Its value at the border.
    pub value: f64,
    /// Whether it grows across the border.
    pub upwards: bool,
}

/// The pieces of a field with [switch functions](VectorField::thresholds).
///
/// ```
/// use arclength::pieces::Pieces;
/// use arclength::{Scalar, Threshold, VectorField};
///
/// /// `x' = p - |x|`, where the sign of `x` is the one switch.
/// struct Kink;
/// impl VectorField for Kink {
///     fn state_names(&self) -> Vec<String> { vec!["x".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["p".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
///         result[0] = p[0] - match p.get(1) {
///             None => x[0].abs(),
///             Some(sign) => *sign * x[0],
///         };
///         if let Some(switch) = result.get_mut(1) {
///             *switch = x[0];
///         }
///     }
///     fn thresholds(&self) -> Vec<Threshold> { vec![Threshold::Zero] }
/// }
///
/// let pieces = Pieces::of(&Kink).unwrap();
/// let region = pieces.region_at(&[-2.0], &[1.0]);
/// assert_eq!(region, [-1.0]);
/// let (mut derivative, mut switches) = ([0.0], [0.0]);
/// pieces.evaluate(&region, &[0.5], &[1.0], &mut derivative, &mut switches);
/// // The piece left of the kink goes on beyond it.
/// assert_eq!((derivative, switches), ([1.5], [0.5]));
/// ```
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    pub(crate) field: ErasedField<'a>,
    thresholds: Vec<Threshold>,
}

impl<'a> Pieces<'a> {
    /// The pieces of a field; `None` for one that is smooth everywhere.
    pub fn of<F: VectorField>(field: &'a F) -> Option<Self> {
        Self::of_erased(field.erased())
    }

    pub(crate) fn of_erased(field: ErasedField<'a>) -> Option<Self> {
        let thresholds = field.thresholds();
        (!thresholds.is_empty()).then_some(Self { field, thresholds })
    }

    /// The pieces of a field that may be smooth everywhere: then there is one.
    pub(crate) fn of_hybrid(field: ErasedField<'a>) -> Self {
        Self { field, thresholds: field.thresholds() }
    }

    /// Where each switch function passes from cell to cell.
    pub fn thresholds(&self) -> &[Threshold] {
        &self.thresholds
    }

    /// Writes the field of a region at a state, not necessarily in it, and the switch functions.
    pub fn evaluate<T: FieldScalar>(
        &self,
        region: &[f64],
        state: &[T],
        parameters: &[f64],
        derivative: &mut [T],
        switches: &mut [T],
    ) {
        let all = [parameters, region].concat();
        let mut values = vec![T::zero(); derivative.len() + switches.len()];
        with_parameters(&all, [], |parameters: &[T]| self.field.evaluate(state, parameters, &mut values));
        let (first, last) = values.split_at(derivative.len());
        derivative.copy_from_slice(first);
        switches.copy_from_slice(last);
    }

    /// The switch functions at a state, by the field of a region.
    pub fn switches(&self, region: &[f64], state: &[f64], parameters: &[f64]) -> Vec<f64> {
        let mut derivative = vec![0.0; state.len()];
        let mut switches = vec![0.0; self.thresholds.len()];
        self.evaluate(region, state, parameters, &mut derivative, &mut switches);
        switches
    }

    /// The region in which a state lies; at a border the upper one.
    pub fn region_at(&self, state: &[f64], parameters: &[f64]) -> Vec<f64> {
        let region = vec![1.0; self.thresholds.len()];
        self.settled(region, state, parameters, |threshold, _, value| threshold.cell(value))
    }

    /// The region beyond a border of another one at a state on that border.
    pub fn beyond(&self, region: &[f64], border: Border, state: &[f64], parameters: &[f64]) -> Vec<f64> {
        let mut next = region.to_vec();
        next[border.switch] = self.thresholds[border.switch].next(region[border.switch], border.upwards);
        let forced = next[border.switch];
        let before = self.switches(region, state, parameters);
        let mut index = 0;
        // Others change only where what they depend on has jumped.
        let settled = self.settled(next, state, parameters, |threshold, cell, value| {
            let [lower, upper] = threshold.borders(cell);
            let place = index % self.thresholds.len();
            let margin = ON_BORDER * value.abs().max(1.0);
            let jumps =
                (value - before[place]).abs() > ON_BORDER * value.abs().max(before[place].abs()).max(1.0);
            let stays =
                place == border.switch || !jumps && (lower - margin..=upper + margin).contains(&value);
            index += 1;
            if stays { cell } else { threshold.cell(value) }
        });
        debug_assert_eq!(settled[border.switch], forced);
        settled
    }

    /// Sets the cells one after the other, as those behind may depend on those before.
    fn settled(
        &self,
        mut region: Vec<f64>,
        state: &[f64],
        parameters: &[f64],
        mut cell: impl FnMut(Threshold, f64, f64) -> f64,
    ) -> Vec<f64> {
        for _ in 0..self.thresholds.len() {
            let values = self.switches(&region, state, parameters);
            let cells = self.thresholds.iter().zip(&region).zip(values);
            let next: Vec<f64> =
                cells.map(|((threshold, known), value)| cell(*threshold, *known, value)).collect();
            if next == region {
                break;
            }
            region = next;
        }
        region
    }
}

/// A switch function this close to a border, relative to its value or to one, is on it.
const ON_BORDER: f64 = 1e-9;
