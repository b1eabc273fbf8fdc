//! Normal-form coefficients of points of codimension two.
//!
//! Source: Kuznetsov, *SIAM J. Numer. Anal.* 36 (1999): cusp (section 2.1), Bogdanov-Takens (section 2.2), generalised
//! Hopf (section 3).

use crate::algebraic::{Differentiator, ScaledLu};
use crate::branch::SpecialKind;
use crate::equilibrium::coefficient_error::{self, UncertainEquilibrium};
use crate::equilibrium::hopf::CriticalPair;
use crate::equilibrium::multilinear::MultilinearForms;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::erased::ErasedField;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;
use std::borrow::Cow;

/// Coefficients by name at a state with all parameters, behind each its error under its name with `_error`: how much it changes
/// where the equilibrium moves by its own error.
pub(super) fn with_errors(
    equilibrium: UncertainEquilibrium<'_>,
    coefficients: impl Fn(&[f64], &[f64]) -> Vec<(Cow<'static, str>, f64)>,
) -> Vec<(Cow<'static, str>, f64)> {
    let known = coefficients(equilibrium.state, equilibrium.parameters);
    let with_error = |index: usize| {
        let (name, value) = known[index].clone();
        let there = |state: &[f64], parameters: &[f64]| Some([coefficients(state, parameters).get(index)?.1]);
        let error = coefficient_error::errors([value], equilibrium, there);
        let error = error.map(|[error]| (format!("{name}_error").into(), error));
        [Some((name, value)), error].into_iter().flatten()
    };
    (0..known.len()).flat_map(with_error).collect()
}

/// The coefficients that exist, by name.
pub(super) fn coefficients(
    kind: SpecialKind,
    field: ErasedField<'_>,
    state: &[f64],
    parameters: &[f64],
    scales: &[f64],
    frequency: Option<f64>,
) -> Vec<(Cow<'static, str>, f64)> {
    let forms = MultilinearForms { field, state, parameters };
    let named = |names: &[&'static str], values: Option<Vec<f64>>| {
        let values = values.filter(|values| values.iter().all(|value| value.is_finite())).unwrap_or_default();
        names.iter().map(|name| Cow::Borrowed(*name)).zip(values).collect()
    };
    match kind {
        SpecialKind::Cusp => named(&["c"], cusp(&forms, scales).map(|c| vec![c])),
        SpecialKind::BogdanovTakens => {
            named(&["a", "b"], bogdanov_takens(&forms, scales).map(|ab| ab.to_vec()))
        }
        SpecialKind::GeneralizedHopf => {
            let pair =
                frequency.and_then(|omega| CriticalPair::at(field, state, parameters, omega, scales).ok());
            named(&["second_lyapunov"], pair.and_then(|pair| pair.second_lyapunov()).map(|value| vec![value]))
        }
        _ => Vec::new(),
    }
}

/// Product of null vectors, as part of the size of its terms, below which zero is a double eigenvalue.
const DOUBLE: f64 = 1e-6;

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A singular Jacobian with its null vectors and solves on their complements.
struct Singular {
    /// `q`, `<q, q> = 1`.
    right: Vec<f64>,
    /// `p`, not normalised.
    left: Vec<f64>,
    bordered: ScaledLu,
    transposed: ScaledLu,
}

impl Singular {
    fn of(forms: &MultilinearForms<'_>, scales: &[f64]) -> Option<Self> {
        let n = forms.state.len();
        let mut matrix = vec![0.0; n * n];
        let mut residual = vec![0.0; n];
        let problem = EquilibriumProblem::new(forms.field, forms.parameters, &[]);
        Differentiator::default().jacobian(&problem, forms.state, &mut residual, &mut matrix, n);
        let real =
            |vector: Vec<Complex64>| -> Vec<f64> { vector.into_iter().map(|entry| entry.re).collect() };
        let right = real(right_eigenvector(&matrix, n, Complex64::ZERO).ok()?.vector);
        let left = real(left_eigenvector(&matrix, n, Complex64::ZERO).ok()?.vector);
        let m = n + 1;
        let (mut bordered, mut transposed) = (vec![0.0; m * m], vec![0.0; m * m]);
        for column in 0..n {
            for row in 0..n {
                bordered[row + m * column] = matrix[row + n * column];
                transposed[column + m * row] = matrix[row + n * column];
            }
            let square = scales[column] * scales[column];
            bordered[n + m * column] = right[column] / square;
            bordered[column + m * n] = left[column] * square;
            transposed[n + m * column] = left[column] * square;
            transposed[column + m * n] = right[column] / square;
        }
        let columns: Vec<f64> = scales.iter().copied().chain([1.0]).collect();
        let inverse: Vec<f64> = columns.iter().map(|scale| scale.recip()).collect();
        let mut found = Self { right, left, bordered: ScaledLu::default(), transposed: ScaledLu::default() };
        let regular = found.bordered.factorize(m, &bordered, &columns) != 0.0
            && found.transposed.factorize(m, &transposed, &inverse) != 0.0;
        regular.then_some(found)
    }

    /// A solution of `A y = b`, where there is one.
    fn solve(&self, right_hand_side: &[f64]) -> Vec<f64> {
        let mut vector = right_hand_side.to_vec();
        vector.push(0.0);
        self.bordered.solve(&mut vector);
        vector.pop();
        vector
    }

    /// A solution of `A' y = b`, where there is one.
    fn solve_transposed(&self, right_hand_side: &[f64]) -> Vec<f64> {
        let mut vector = right_hand_side.to_vec();
        vector.push(0.0);
        self.transposed.solve(&mut vector);
        vector.pop();
        vector
    }
}

/// `c = <p, C(q, q, q) + 3 B(q, h)>/6`, `A h = -B(q, q)`, `<p, q> = 1`.
fn cusp(forms: &MultilinearForms<'_>, scales: &[f64]) -> Option<f64> {
    let singular = Singular::of(forms, scales)?;
    let q = &singular.right;
    // Where zero is a double eigenvalue the coefficient does not exist; the size of the terms does not depend on units.
    let size: f64 = singular.left.iter().zip(q).map(|(p, q)| (p * q).abs()).sum();
    if inner(&singular.left, q).abs() < DOUBLE * size {
        return None;
    }
    let square: Vec<f64> = forms.real(&[q, q]).iter().map(|entry| -entry).collect();
    let second = singular.solve(&square);
    let cubic = inner(&singular.left, &forms.real(&[q, q, q]));
    let mixed = inner(&singular.left, &forms.real(&[q, &second]));
    Some((cubic + 3.0 * mixed) / (6.0 * inner(&singular.left, q)))
}

/// `a = <p1, B(q0, q0)>/2`, `b = <p0, B(q0, q0)> + <p1, B(q0, q1)>` with `A q0 = 0`, `A q1 = q0`, `A' p1 = 0`,
/// `A' p0 = p1`, `<q0, q0> = <p0, q0> = <p1, q1> = 1`, `<q1, q0> = <p0, q1> = 0`; `a` is not negative.
fn bogdanov_takens(forms: &MultilinearForms<'_>, scales: &[f64]) -> Option<[f64; 2]> {
    let singular = Singular::of(forms, scales)?;
    let q0 = &singular.right;
    let mut q1 = singular.solve(q0);
    let share = inner(&q1, q0);
    q1.iter_mut().zip(q0).for_each(|(entry, q)| *entry -= share * q);
    let factor = inner(&singular.left, &q1);
    let p1: Vec<f64> = singular.left.iter().map(|entry| entry / factor).collect();
    let mut p0 = singular.solve_transposed(&p1);
    let share = inner(&p0, &q1);
    p0.iter_mut().zip(&p1).for_each(|(entry, p)| *entry -= share * p);
    let square = forms.real(&[q0, q0]);
    let mixed = forms.real(&[q0, &q1]);
    let (a, b) = (0.5 * inner(&p1, &square), inner(&p0, &square) + inner(&p1, &mixed));
    // q0 may be replaced by its negative.
    Some(if a < 0.0 { [-a, -b] } else { [a, b] })
}
