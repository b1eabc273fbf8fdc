//! Right and left eigenvectors of a real matrix for a known eigenvalue, by inverse iteration.
//!
//! The matrix is balanced first, then `A - lambda I` is factorised with tiny pivots replaced (Wilkinson 1965,
//! chapter 9; Ipsen 1997). Of a few iterates the one with the smallest residual counts: a second step spoils
//! the vector of a defective eigenvalue, and improves all others.

use num_complex::Complex64;

use super::balancing::{largest_exponent, power_of_two, scale};
use super::complex_lu::ComplexLu;
use super::eigenvalues::{EigenvalueError, check};

/// Steps of inverse iteration from one starting vector; two suffice for a simple eigenvalue accurate to
/// rounding.
const MAXIMUM_STEPS: usize = 5;
/// Starting vectors tried, for one may be nearly orthogonal to what is sought.
const MAXIMUM_STARTS: usize = 4;
/// A relative residual below this is rounding error.
const SMALL_RESIDUAL: f64 = f64::EPSILON;
/// With a relative residual below this no further starting vector is tried.
const ACCEPTABLE_RESIDUAL: f64 = 1e-14;
/// A balanced entry below this part of the largest is no influence: the square root of rounding.
const NO_INFLUENCE: f64 = 1e-8;
/// A balanced component below this part of the largest is its rounding.
const NO_PART: f64 = 32.0 * f64::EPSILON;
/// Components whose modulus is within this part of the largest count as largest; the first of them becomes
/// real.
const TIE: f64 = 1e-6;

/// An eigenvector `q` with `<q, q> = 1` whose largest component is real and positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenvector {
    /// The components.
    pub vector: Vec<Complex64>,
    /// Residual after balancing, relative to the matrix or the eigenvalue, whichever is larger:
    /// `|A q - lambda q| / max(|A|, |lambda|)` with the Frobenius norm.
    pub residual: f64,
}

/// The vector `q` with `A q = lambda q` for the column-major n-by-n `matrix`.
///
/// `eigenvalue` should be accurate to rounding, as from [`eigenvalues`](super::eigenvalues::eigenvalues). Of
/// a multiple eigenvalue one vector is found. A real eigenvalue gives an exactly real vector. That
/// `eigenvalue` is no eigenvalue shows in the residual.
///
/// # Errors
/// [`EigenvalueError`] when the shape is wrong or a number is not finite.
///
/// # Examples
/// ```
/// use arclength::linear::eigenvectors::right_eigenvector;
/// let q = right_eigenvector(&[2.0, 0.0, 1.0, 3.0], 2, 3.0.into())?;
/// assert!((q.vector[0].re - 0.5_f64.sqrt()).abs() < 1e-15 && q.residual < 1e-15);
/// # Ok::<(), arclength::linear::eigenvalues::EigenvalueError>(())
/// ```
pub fn right_eigenvector(
    matrix: &[f64],
    n: usize,
    eigenvalue: Complex64,
) -> Result<Eigenvector, EigenvalueError> {
    check(matrix, n, 1)?;
    check_eigenvalue(eigenvalue)?;
    let mut balanced = matrix.to_vec();
    let exponent = largest_exponent(matrix).unwrap_or(0);
    let (a, b) = power_of_two(-exponent);
    balanced.iter_mut().for_each(|x| *x = *x * a * b);
    let eigenvalue = eigenvalue * a * b;
    let scales = balancing_scales(&balanced, n);
    for (entry, value) in balanced.iter_mut().enumerate() {
        *value *= scales[entry / n] / scales[entry % n];
    }
    let norm = balanced.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut shifted: Vec<Complex64> = balanced.iter().map(|x| Complex64::from(*x)).collect();
    (0..n).for_each(|i| shifted[i + n * i] -= eigenvalue);
    let size = match norm.max(eigenvalue.norm()) {
        0.0 => 1.0,
        size => size,
    };
    let lu = ComplexLu::of(n, shifted.clone(), f64::EPSILON * size);

    let residual = |iterate: &[Complex64]| {
        let mut square = 0.0;
        for row in 0..n {
            let entry: Complex64 = (0..n).map(|column| shifted[row + n * column] * iterate[column]).sum();
            square += entry.norm_sqr();
        }
        square.sqrt() / size
    };
    let (mut vector, residual) = inverse_iteration(n, |iterate| lu.solve(iterate), residual);
    drop_rounding(&mut vector);
    vector.iter_mut().zip(&scales).for_each(|(x, scale)| *x *= scale);
    normalize(&mut vector);
    fix_phase(&mut vector);
    Ok(Eigenvector { vector, residual })
}

/// Puts zeros for the balanced components that are rounding of the largest: where a state has no part in the eigenvector each step of the
/// iteration leaves less of it, and what is left, however small, would have a sign.
fn drop_rounding(vector: &mut [Complex64]) {
    let largest = vector.iter().fold(0.0_f64, |largest, entry| largest.max(entry.norm()));
    for entry in vector.iter_mut().filter(|entry| entry.norm() < NO_PART * largest) {
        *entry = Complex64::ZERO;
    }
}

/// Scales that balance the matrix. Influences on each other whose product is rounding are none: they would make components of
/// very different size, and the error of the largest would swamp the smallest.
fn balancing_scales(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut coupling = matrix.to_vec();
    loop {
        let mut balanced = coupling.clone();
        let mut scales = vec![1.0; n];
        scale(&mut balanced, n, 0, n, &mut scales);
        let largest = balanced.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let mut changed = false;
        for (entry, value) in balanced.iter().enumerate() {
            if coupling[entry] != 0.0 && entry / n != entry % n && value.abs() < NO_INFLUENCE * largest {
                coupling[entry] = 0.0;
                changed = true;
            }
        }
        if !changed {
            return scales;
        }
    }
}

/// The vector `p` with `p^H A = lambda p^H`, that is `A^T p = conj(lambda) p`, normalised as the right one.
///
/// Kuznetsov's adjoint eigenvector (`<p, q> = sum of conj(p_i) q_i = 1`) is this one divided by `conj(<p,
/// q>)`.
///
/// # Errors
/// As [`right_eigenvector`].
pub fn left_eigenvector(
    matrix: &[f64],
    n: usize,
    eigenvalue: Complex64,
) -> Result<Eigenvector, EigenvalueError> {
    check(matrix, n, 1)?;
    let transposed: Vec<f64> = (0..n * n).map(|k| matrix[k / n + n * (k % n)]).collect();
    right_eigenvector(&transposed, n, eigenvalue.conj())
}

pub(super) fn check_eigenvalue(eigenvalue: Complex64) -> Result<(), EigenvalueError> {
    if eigenvalue.is_finite() {
        Ok(())
    } else {
        Err(EigenvalueError::EigenvalueNotFinite { re: eigenvalue.re, im: eigenvalue.im })
    }
}

/// Solves repeatedly from one or more starting vectors; returns the iterate of smallest residual, and the
/// residual.
pub(super) fn inverse_iteration(
    length: usize,
    solve: impl Fn(&mut [Complex64]),
    residual: impl Fn(&[Complex64]) -> f64,
) -> (Vec<Complex64>, f64) {
    let mut best = vec![Complex64::ZERO; length];
    let mut smallest = f64::INFINITY;
    for start in 1..=MAXIMUM_STARTS {
        let mut iterate = starting_vector(length, start);
        let mut previous = f64::INFINITY;
        for _ in 0..MAXIMUM_STEPS {
            solve(&mut iterate);
            normalize(&mut iterate);
            let current = residual(&iterate);
            if current < smallest {
                smallest = current;
                best.copy_from_slice(&iterate);
            }
            if current <= SMALL_RESIDUAL || current >= previous {
                break;
            }
            previous = current;
        }
        if smallest <= ACCEPTABLE_RESIDUAL {
            break;
        }
    }
    (best, smallest)
}

/// Real vectors without symmetry: multiples of the golden ratio modulo one are spread evenly.
fn starting_vector(length: usize, start: usize) -> Vec<Complex64> {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let offset = if start == 1 { 0.5 } else { -0.5 };
    (1..=length).map(|k| Complex64::from(offset + ((k as f64).powi(start as i32) * golden).fract())).collect()
}

/// Scales to Euclidean norm one, whatever the size of the components.
pub(super) fn normalize(vector: &mut [Complex64]) {
    let largest = vector.iter().fold(0.0_f64, |m, x| m.max(x.re.abs()).max(x.im.abs()));
    if largest == 0.0 {
        return;
    }
    vector.iter_mut().for_each(|x| *x = Complex64::new(x.re / largest, x.im / largest));
    let norm = vector.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|x| *x /= norm);
}

/// Makes the largest component real and positive; returns the number of modulus one by which the vector was
/// multiplied.
pub(super) fn fix_phase(vector: &mut [Complex64]) -> Complex64 {
    let largest = vector.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
    let Some(at) = vector.iter().position(|x| x.norm() >= (1.0 - TIE) * largest && largest > 0.0) else {
        return Complex64::ONE;
    };
    let component = vector[at];
    let turn =
        if component.im == 0.0 { component.re.signum().into() } else { component.conj() / component.norm() };
    vector.iter_mut().for_each(|x| *x *= turn);
    vector[at].im = 0.0;
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_without_part_in_the_vector_is_zero_in_it() {
        // A filter that is driven: its state is no part of the left vector of what drives it, nor what drives it of its own right one.
        let matrix = [-0.3, 2.0, 0.7, -1.0, 0.3, 0.4, 0.0, 0.0, -1.7];
        let driving = Complex64::new(0.0, (2.0_f64 - 0.09).sqrt());
        let left = left_eigenvector(&matrix, 3, driving).expect("finite").vector;
        assert_eq!(left[2], Complex64::ZERO);
        let right = right_eigenvector(&matrix, 3, (-1.7).into()).expect("finite").vector;
        assert_eq!(right[..2], [Complex64::ZERO; 2]);
    }

    #[test]
    fn couplings_at_rounding_do_not_spoil_the_vector() {
        // Predator and prey with a third state that is almost extinct; its growth rate is zero.
        for coupling in [0.0, 1e-300, -1.8e-40, 1e-25] {
            let matrix = [-0.3, 2.0 / 3.0, 0.0, -4.0 / 3.0, 0.4, coupling, 0.0, -0.5, 0.0];
            let vector = right_eigenvector(&matrix, 3, Complex64::ZERO).expect("finite").vector;
            for row in 0..2 {
                let image: Complex64 = (0..3).map(|column| matrix[row + 3 * column] * vector[column]).sum();
                assert!(image.norm() < 1e-14, "{coupling}: {vector:?}");
            }
            assert!(vector[2].re.abs() > 0.1, "{coupling}: {vector:?}");
        }
    }
}
