//! Totals that every motion conserves: linear combinations of the states whose rate of change is zero whatever the state.
//!
//! Reaction networks have them (enzyme and complex together, say). Equilibria are then not isolated, Jacobians singular
//! everywhere, and the equilibrium that belongs to an initial state is the one with its totals. [`WithTotals`] is the field with
//! a term that draws every total to its value, so that its equilibria with these totals are regular; on motions that have these
//! values it is the field itself. Source: Feinberg, *Foundations of Chemical Reaction Network Theory* (2019), section 3.4
//! (conservation laws as the left null space).

use super::problem::EquilibriumProblem;
use crate::algebraic::Differentiator;
use crate::algebraic::scales::natural_scales;
use crate::differentiation::Scalar;
use crate::direction::Direction;
use crate::erased::*;
use crate::field::VectorField;
use crate::numbers::readable;
use crate::random::Random;
use crate::threshold::Threshold;
use num_complex::Complex64;

/// States, in units of their sizes, and parameters at which the field is sampled: from this much above the start up to one.
const LEAST_DISPLACEMENT: f64 = 0.1;
/// Part of their values by which parameters are displaced.
const PARAMETER_PART: f64 = 0.1;
/// Samples more than there are states.
const MORE_SAMPLES: usize = 10;
/// A combination of samples below this part of them is zero.
const ZERO: f64 = 1e-11;
/// Coefficients this close to whole numbers are these.
const WHOLE: f64 = 1e-9;

/// A linear combination of the states that is conserved.
#[derive(Clone, Debug, PartialEq)]
pub struct ConservedTotal {
    /// Coefficient of every state, the smallest modulus among them 1.
    pub coefficients: Vec<f64>,
    /// A state of it that is no other total's.
    pub own_state: usize,
}

impl ConservedTotal {
    /// Its value at a state.
    pub fn value(&self, state: &[f64]) -> f64 {
        self.coefficients.iter().zip(state).map(|(coefficient, value)| coefficient * value).sum()
    }

    /// The combination in words, `e + c` or `2 a - b`.
    pub fn text(&self, states: &[String]) -> String {
        let mut text = String::new();
        for (coefficient, name) in self.coefficients.iter().zip(states).filter(|(one, _)| **one != 0.0) {
            let sign = match (text.is_empty(), *coefficient < 0.0) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            let size = coefficient.abs();
            let factor = if size == 1.0 { String::new() } else { format!("{} ", readable(size)) };
            text.push_str(&format!("{sign}{factor}{name}"));
        }
        text
    }
}

/// The independent linear combinations of the states that the field conserves, whatever the parameters, found by sampling it
/// around `state`. Parameters that are zero stay so (an inflow that is shut), but for those that are to vary, given by their indices.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::conserved_totals};
/// /// a -> b and back.
/// struct Exchange;
/// impl VectorField for Exchange {
///     fn state_names(&self) -> Vec<String> { vec!["a".into(), "b".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["k".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
///         derivative[0] = x[1] - p[0] * x[0];
///         derivative[1] = p[0] * x[0] - x[1];
///     }
/// }
/// let totals = conserved_totals(&Exchange, &[1.0, 0.0], &[2.0], &[0]);
/// assert_eq!(totals[0].text(&["a".into(), "b".into()]), "a + b");
/// ```
pub fn conserved_totals<F: VectorField>(
    field: &F,
    state: &[f64],
    parameters: &[f64],
    varying: &[usize],
) -> Vec<ConservedTotal> {
    let field = field.erased();
    let n = state.len();
    let sizes = natural_scales(&field, state, parameters, &vec![0.0; n]);
    let mut random = Random::new(1);
    let mut displaced = |value: &f64, size: f64| {
        value + size * (LEAST_DISPLACEMENT + (1.0 - LEAST_DISPLACEMENT) * random.next_unit())
    };
    let mut samples = Vec::new();
    let mut rate = vec![0.0; n];
    for _ in 0..n + MORE_SAMPLES {
        let there: Vec<f64> = state.iter().zip(&sizes).map(|(value, size)| displaced(value, *size)).collect();
        let with: Vec<f64> = parameters
            .iter()
            .enumerate()
            .map(|(index, value)| {
                let size = if *value == 0.0 && varying.contains(&index) { 1.0 } else { value.abs() };
                displaced(value, PARAMETER_PART * size)
            })
            .collect();
        field.evaluate(&there, &with, &mut rate);
        if rate.iter().all(|value| value.is_finite()) {
            samples.push(rate.clone());
        }
    }
    if samples.len() <= n {
        return Vec::new();
    }
    // Every state in units of its largest rate.
    let units: Vec<f64> = (0..n)
        .map(|state| samples.iter().map(|sample| sample[state].abs()).fold(0.0, f64::max))
        .map(|largest| if largest > 0.0 { largest } else { 1.0 })
        .collect();
    samples.iter_mut().for_each(|sample| sample.iter_mut().zip(&units).for_each(|(a, unit)| *a /= unit));
    let (pivots, reduced) = reduced_echelon(samples, n);
    let free = (0..n).filter(|column| !pivots.contains(column));
    let totals = free.map(|own_state| {
        let mut coefficients = vec![0.0; n];
        coefficients[own_state] = 1.0 / units[own_state];
        for (row, &pivot) in pivots.iter().enumerate() {
            let entry = reduced[row][own_state];
            coefficients[pivot] = if entry.abs() < WHOLE { 0.0 } else { -entry / units[pivot] };
        }
        ConservedTotal { coefficients: whole(coefficients), own_state }
    });
    without_signs(totals.collect())
}

/// Coefficients whose smallest modulus is 1, whole where they nearly are, the first positive.
fn whole(mut coefficients: Vec<f64>) -> Vec<f64> {
    let sizes = coefficients.iter().map(|value| value.abs()).filter(|size| *size > 0.0);
    let smallest = sizes.fold(f64::INFINITY, f64::min);
    let sign = coefficients.iter().find(|value| **value != 0.0).map_or(1.0, |value| value.signum());
    for value in &mut coefficients {
        *value *= sign / smallest;
        if (*value - value.round()).abs() < WHOLE * value.abs() {
            *value = value.round();
        }
    }
    coefficients
}

/// The same totals, those of mixed signs with others added or subtracted that make them amounts where that is possible.
fn without_signs(totals: Vec<ConservedTotal>) -> Vec<ConservedTotal> {
    let is_amount = |coefficients: &[f64]| {
        coefficients.iter().all(|value| *value >= 0.0) || coefficients.iter().all(|value| *value <= 0.0)
    };
    let amounts: Vec<Vec<f64>> = totals
        .iter()
        .filter(|total| is_amount(&total.coefficients))
        .map(|total| total.coefficients.clone())
        .collect();
    let improved = |total: ConservedTotal| {
        if is_amount(&total.coefficients) {
            return total;
        }
        let candidates = amounts.iter().flat_map(|amount| [(amount, 1.0), (amount, -1.0)]);
        let sums = candidates.map(|(amount, sign)| -> Vec<f64> {
            total.coefficients.iter().zip(amount).map(|(one, other)| one + sign * other).collect()
        });
        let best = sums.into_iter().find(|sum| is_amount(sum) && sum.iter().any(|value| *value != 0.0));
        ConservedTotal { coefficients: best.map_or(total.coefficients, whole), ..total }
    };
    totals.into_iter().map(improved).collect()
}

/// The reduced row echelon form of a matrix given by its rows: the columns of the pivots, and the rows.
fn reduced_echelon(mut rows: Vec<Vec<f64>>, columns: usize) -> (Vec<usize>, Vec<Vec<f64>>) {
    let mut pivots: Vec<usize> = Vec::new();
    for column in 0..columns {
        let first = pivots.len();
        let candidates = first..rows.len();
        let largest = candidates.max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()));
        let Some(place) = largest.filter(|&place| rows[place][column].abs() > ZERO) else { continue };
        rows.swap(first, place);
        let pivot = rows[first][column];
        rows[first].iter_mut().for_each(|entry| *entry /= pivot);
        let pivot_row = rows[first].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(index, _)| *index != first) {
            let factor = row[column];
            row.iter_mut().zip(&pivot_row).for_each(|(entry, value)| *entry -= factor * value);
        }
        pivots.push(column);
    }
    (pivots, rows)
}

/// A field with a term for every conserved total that draws it to the value that it has at a state.
#[derive(Clone, Debug)]
pub struct WithTotals<'a, F> {
    field: &'a F,
    drawn: DrawnToTotals<'a>,
}

/// The same for the scalars on the list: the field itself is not compiled again for it.
#[derive(Clone, Debug)]
struct DrawnToTotals<'a> {
    field: ErasedField<'a>,
    totals: Vec<ConservedTotal>,
    reference: Vec<f64>,
    rates: Vec<f64>,
}

/// Rates at which totals are drawn to their values, in units of the fastest rate at the start: no eigenvalue is like them.
const RATE: f64 = 1.618_033_988_749_895;
/// Relative distance of an eigenvalue from such a rate within which it is that of a total.
const SAME_RATE: f64 = 1e-6;

impl<'a, F: VectorField> WithTotals<'a, F> {
    /// The field with the totals that it conserves at the values that they have at `state`; `varying` are the indices of the
    /// parameters that are to vary.
    pub fn at(field: &'a F, state: &[f64], parameters: &[f64], varying: &[usize]) -> Self {
        let totals = conserved_totals(field, state, parameters, varying);
        let rates = if totals.is_empty() {
            Vec::new()
        } else {
            let fastest = fastest_rate(&field.erased(), state, parameters);
            (0..totals.len()).map(|index| RATE * fastest * (1.0 + 0.1 * index as f64)).collect()
        };
        let drawn = DrawnToTotals { field: field.erased(), totals, reference: state.to_vec(), rates };
        Self { field, drawn }
    }

    /// The field as it is, without totals: what it conserves need not outlast the events at which its state jumps.
    pub fn none(field: &'a F) -> Self {
        let drawn = DrawnToTotals {
            field: field.erased(),
            totals: Vec::new(),
            reference: Vec::new(),
            rates: Vec::new(),
        };
        Self { field, drawn }
    }

    /// The conserved totals.
    pub fn totals(&self) -> &[ConservedTotal] {
        &self.drawn.totals
    }

    /// Puts zero in place of the eigenvalues with which the totals are drawn to their values: those of the field itself.
    pub fn restore_eigenvalues(&self, eigenvalues: &mut [Complex64]) {
        for rate in &self.drawn.rates {
            let distance = |value: &Complex64| (value + rate).norm();
            let nearest = eigenvalues.iter_mut().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            if let Some(value) = nearest.filter(|value| distance(value) < SAME_RATE * rate) {
                *value = Complex64::ZERO;
            }
        }
    }
}

/// A norm of the Jacobian that does not depend on units much: the largest diagonal entry, or one where there is none.
fn fastest_rate(field: &ErasedField<'_>, state: &[f64], parameters: &[f64]) -> f64 {
    let n = state.len();
    let problem = EquilibriumProblem::new(*field, parameters, &[]);
    let (mut residual, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
    Differentiator::default().jacobian(&problem, state, &mut residual, &mut matrix, n);
    let rates = (0..n).map(|index| matrix[index * (n + 1)].abs()).filter(|rate| rate.is_finite());
    let fastest = rates.fold(0.0, f64::max);
    if fastest > 0.0 { fastest } else { 1.0 }
}

impl<F: VectorField> VectorField for WithTotals<'_, F> {
    fn state_names(&self) -> Vec<String> {
        self.field.state_names()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.field.parameter_names()
    }

    fn dimension(&self) -> usize {
        self.field.dimension()
    }

    fn thresholds(&self) -> Vec<Threshold> {
        self.field.thresholds()
    }

    fn events(&self) -> Vec<Direction> {
        self.field.events()
    }

    fn evaluate_event<T: Scalar>(&self, event: usize, state: &[T], parameters: &[T], values: &mut [T]) {
        self.field.evaluate_event(event, state, parameters, values);
    }

    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        self.field.evaluate(state, parameters, derivative);
        self.drawn.draw(state, derivative);
    }

    fn erased(&self) -> ErasedField<'_> {
        ErasedField::new(&self.drawn)
    }
}

impl DrawnToTotals<'_> {
    fn draw<T: Scalar>(&self, state: &[T], derivative: &mut [T]) {
        for (total, rate) in self.totals.iter().zip(&self.rates) {
            let mut excess = T::zero();
            for ((coefficient, value), reference) in total.coefficients.iter().zip(state).zip(&self.reference)
            {
                if *coefficient != 0.0 {
                    excess += (*value - *reference) * *coefficient;
                }
            }
            let own = total.own_state;
            derivative[own] -= excess * (*rate / total.coefficients[own]);
        }
    }
}

macro_rules! drawn_table {
    ($($method:ident, $event:ident: $scalar:ty $(, $lifted:ident)?;)*) => {
        impl Table for DrawnToTotals<'_> {
            fn state_names(&self) -> Vec<String> {
                self.field.state_names()
            }
            fn parameter_names(&self) -> Vec<String> {
                self.field.parameter_names()
            }
            fn dimension(&self) -> usize {
                self.field.dimension()
            }
            fn thresholds(&self) -> Vec<Threshold> {
                self.field.thresholds()
            }
            fn events(&self) -> Vec<Direction> {
                self.field.events()
            }
            $(
                fn $method(&self, state: &[$scalar], parameters: &[$scalar], derivative: &mut [$scalar]) {
                    self.field.evaluate(state, parameters, derivative);
                    self.draw(state, derivative);
                }
                fn $event(
                    &self,
                    event: usize,
                    state: &[$scalar],
                    parameters: &[$scalar],
                    values: &mut [$scalar],
                ) {
                    self.field.evaluate_event(event, state, parameters, values);
                }
            )*
        }
    };
}

with_field_scalars!(drawn_table);
