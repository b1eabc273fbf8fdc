//! Eigenvalues and eigenvectors against matrices whose spectrum is known in closed form.

use arclength::linear::eigenvalues::{EigenvalueError, EigenvalueWorkspace, eigenvalues};
use arclength::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;
use proptest::prelude::*;

/// Largest distance between two spectra, matching each expected eigenvalue with the nearest unused one.
fn distance(found: &[Complex64], expected: &[Complex64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let mut left = found.to_vec();
    let mut worst = 0.0_f64;
    for value in expected {
        let nearest =
            (0..left.len()).min_by(|a, b| (left[*a] - value).norm().total_cmp(&(left[*b] - value).norm()));
        let nearest = left.swap_remove(nearest.unwrap());
        worst = worst.max((nearest - value).norm());
    }
    worst
}

fn from_rows(rows: &[&[f64]]) -> Vec<f64> {
    let n = rows.len();
    (0..n * n).map(|k| rows[k % n][k / n]).collect()
}

fn pseudo_random(seed: u64, length: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..length)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

#[test]
fn triangular_matrix_in_any_order_is_exact() {
    let upper = from_rows(&[&[3.0, 1e8, -7.0], &[0.0, 1e-9, 5.0], &[0.0, 0.0, -2.0]]);
    let values = eigenvalues(&upper, 3).unwrap();
    assert_eq!(values, [3.0.into(), 1e-9.into(), Complex64::from(-2.0)]);
    let permuted = from_rows(&[&[-2.0, 0.0, 0.0], &[5.0, 1e-9, 0.0], &[-7.0, 1e8, 3.0]]);
    assert_eq!(eigenvalues(&permuted, 3).unwrap(), values);
}

#[test]
fn small_dimensions() {
    assert!(eigenvalues(&[], 0).unwrap().is_empty());
    assert_eq!(eigenvalues(&[-4.5], 1).unwrap(), [Complex64::from(-4.5)]);
    let pair = eigenvalues(&from_rows(&[&[1.0, -2.0], &[2.0, 1.0]]), 2).unwrap();
    assert_eq!(pair, [Complex64::new(1.0, -2.0), Complex64::new(1.0, 2.0)]);
    assert_eq!(eigenvalues(&[0.0; 25], 5).unwrap(), [Complex64::ZERO; 5]);
}

#[test]
fn tridiagonal_toeplitz_to_dimension_200() {
    // Eigenvalues 2 cos(k pi / (n + 1)).
    for n in [3, 5, 10, 50, 200] {
        let mut matrix = vec![0.0; n * n];
        for k in 1..n {
            matrix[k + n * (k - 1)] = 1.0;
            matrix[k - 1 + n * k] = 1.0;
        }
        let values = eigenvalues(&matrix, n).unwrap();
        for (k, value) in values.iter().enumerate() {
            let expected = 2.0 * ((k + 1) as f64 * std::f64::consts::PI / (n + 1) as f64).cos();
            assert!((value.re - expected).abs() < 1e-13 && value.im == 0.0, "n = {n}, k = {k}: {value}");
        }
    }
}

#[test]
fn cyclic_permutation_needs_an_exceptional_shift() {
    // Plain double shifts leave this orthogonal matrix unchanged. Its eigenvalues are the roots of one.
    for n in [3, 4, 5, 8, 31, 100] {
        let mut matrix = vec![0.0; n * n];
        (0..n).for_each(|k| matrix[(k + 1) % n + n * k] = 1.0);
        let angle = |k: usize| k as f64 * std::f64::consts::TAU / n as f64;
        let expected: Vec<_> = (0..n).map(|k| Complex64::from_polar(1.0, angle(k))).collect();
        assert!(distance(&eigenvalues(&matrix, n).unwrap(), &expected) < 1e-13, "n = {n}");
    }
}

#[test]
fn orthogonal_matrix_that_defeats_many_implementations() {
    // Batterson and Day (1990): Francis's shifts without exceptional ones do not converge.
    let matrix = from_rows(&[
        &[0.0, 0.0, 0.0, 1.0],
        &[1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 0.0, 0.0],
        &[0.0, 0.0, 1.0, 0.0],
    ]);
    let expected = [1.0.into(), Complex64::I, -Complex64::I, Complex64::from(-1.0)];
    assert!(distance(&eigenvalues(&matrix, 4).unwrap(), &expected) < 1e-15);
    let h = from_rows(&[
        &[0.0, 0.0, 0.0, -1.0],
        &[1.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 0.0, 0.0],
        &[0.0, 0.0, 1.0, 0.0],
    ]);
    let root = 0.5_f64.sqrt();
    let expected =
        [(root, root), (root, -root), (-root, root), (-root, -root)].map(|(re, im)| Complex64::new(re, im));
    assert!(distance(&eigenvalues(&h, 4).unwrap(), &expected) < 1e-15);
}

#[test]
fn companion_matrix_of_known_polynomial() {
    // (x - 1)(x - 2)(x - 3)(x - 4)(x - 5).
    let companion = from_rows(&[
        &[15.0, -85.0, 225.0, -274.0, 120.0],
        &[1.0, 0.0, 0.0, 0.0, 0.0],
        &[0.0, 1.0, 0.0, 0.0, 0.0],
        &[0.0, 0.0, 1.0, 0.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0, 0.0],
    ]);
    for (value, expected) in eigenvalues(&companion, 5).unwrap().iter().zip([5.0, 4.0, 3.0, 2.0, 1.0]) {
        assert!((value - expected).norm() < 1e-11, "{value}");
    }
}

#[test]
fn mixed_units_do_not_cost_digits() {
    // D^-1 A D has the eigenvalues of A; D spans sixteen orders of magnitude.
    let a = from_rows(&[&[2.0, 1.0, 0.5], &[1.0, 3.0, -1.0], &[0.5, -1.0, -2.0]]);
    let d = [1e-8, 1.0, 1e8];
    let scaled: Vec<f64> = (0..9).map(|k| a[k] * d[k / 3] / d[k % 3]).collect();
    let (plain, scaled) = (eigenvalues(&a, 3).unwrap(), eigenvalues(&scaled, 3).unwrap());
    assert!(distance(&plain, &scaled) < 1e-14);
}

#[test]
fn extreme_magnitudes() {
    let a = [1.0, 3.0, 2.0, 4.0, 0.5, -1.0, 2.0, 1.0, -1.5];
    let expected = eigenvalues(&a, 3).unwrap();
    for exponent in [-1000, -300, 300, 1000] {
        let scale = 2f64.powi(exponent);
        let values = eigenvalues(&a.map(|x| x * scale), 3).unwrap();
        for (value, expected) in values.iter().zip(&expected) {
            assert!((value / scale - expected).norm() < 1e-14);
        }
    }
}

#[test]
fn graded_matrix_keeps_small_eigenvalues() {
    // Diagonal 1, 1e-8, 1e-16 with couplings of the geometric mean: a diagonal similarity of nothing worse
    // than one.
    let matrix = from_rows(&[&[1.0, 1e-5, 1e-9], &[1e-5, 1e-8, 1e-13], &[1e-9, 1e-13, 1e-16]]);
    let product: f64 = eigenvalues(&matrix, 3).unwrap().iter().map(|value| value.re).product();
    // Determinant in exact rational arithmetic: 1e-24 - 1e-26 + 2e-27 - 1e-26 - 1e-26.
    assert!((product / 9.72e-25 - 1.0).abs() < 1e-10, "{product:e}");
}

#[test]
fn bad_input_is_an_error() {
    assert!(matches!(eigenvalues(&[1.0; 5], 2), Err(EigenvalueError::Shape { expected: 4, found: 5, .. })));
    let error = eigenvalues(&[1.0, 2.0, f64::NAN, 4.0], 2);
    assert!(matches!(error, Err(EigenvalueError::NotFinite { factor: 0, row: 0, column: 1, .. })));
    assert!(eigenvalues(&[f64::INFINITY], 1).is_err());
    assert!(right_eigenvector(&[1.0], 1, Complex64::new(f64::NAN, 0.0)).is_err());
}

#[test]
fn workspace_gives_what_the_function_gives() {
    let mut workspace = EigenvalueWorkspace::new(5);
    for seed in 0..20 {
        let matrix = pseudo_random(seed, 25);
        assert_eq!(workspace.eigenvalues(&matrix).unwrap(), eigenvalues(&matrix, 5).unwrap());
    }
}

#[test]
fn eigenvectors_of_a_jordan_block_are_its_only_ones() {
    let jordan = from_rows(&[&[2.0, 1.0, 0.0], &[0.0, 2.0, 1.0], &[0.0, 0.0, 2.0]]);
    let right = right_eigenvector(&jordan, 3, 2.0.into()).unwrap();
    assert!(right.residual < 1e-14);
    assert!((right.vector[0] - 1.0).norm() < 1e-4, "{right:?}");
    let left = left_eigenvector(&jordan, 3, 2.0.into()).unwrap();
    assert!((left.vector[2] - 1.0).norm() < 1e-4, "{left:?}");
}

#[test]
fn eigenvector_of_zero_matrix() {
    let vector = right_eigenvector(&[0.0], 1, Complex64::ZERO).unwrap();
    assert_eq!((vector.vector[0], vector.residual), (Complex64::ONE, 0.0));
}

#[test]
fn defective_eigenvalue_needs_another_starting_vector() {
    // Eigenvalues 2 and, three times, 0 with Jordan blocks; the computed ones are off by 1e-8.
    let matrix = from_rows(&[
        &[0.0, 0.0, 0.0, 0.0],
        &[1.0, 0.0, 0.0, 1.0],
        &[0.0, 1.0, 1.0, 0.0],
        &[1.0, 1.0, 1.0, 1.0],
    ]);
    for value in eigenvalues(&matrix, 4).unwrap() {
        let right = right_eigenvector(&matrix, 4, value).unwrap();
        let left = left_eigenvector(&matrix, 4, value).unwrap();
        assert!(right.residual < 1e-14 && left.residual < 1e-14, "{value}: {right:?} {left:?}");
    }
}

#[test]
fn wrong_eigenvalue_shows_in_the_residual() {
    let matrix = from_rows(&[&[2.0, 1.0], &[0.0, 3.0]]);
    assert!(right_eigenvector(&matrix, 2, 2.5.into()).unwrap().residual > 1e-2);
}

#[test]
fn eigenvector_of_badly_scaled_matrix_is_accurate_in_each_component() {
    // A = [[0, 1e10], [1e-10, 0]] has eigenvalue 1 with vector (1e10, 1) and left vector (1, 1e10).
    let matrix = from_rows(&[&[0.0, 1e10], &[1e-10, 0.0]]);
    let right = right_eigenvector(&matrix, 2, 1.0.into()).unwrap().vector;
    assert!((right[1].re / right[0].re * 1e10 - 1.0).abs() < 1e-14);
    let left = left_eigenvector(&matrix, 2, 1.0.into()).unwrap().vector;
    assert!((left[0].re / left[1].re * 1e10 - 1.0).abs() < 1e-14);
}

proptest! {
    #[test]
    fn random_matrices(n in 1usize..13, seed in any::<u64>()) {
        let matrix = pseudo_random(seed, n * n);
        let values = eigenvalues(&matrix, n).unwrap();
        let norm = matrix.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Order, conjugate pairs, trace.
        for pair in values.windows(2) {
            prop_assert!(pair[0].re > pair[1].re || (pair[0].re == pair[1].re && pair[0].im <= pair[1].im));
        }
        for value in values.iter().filter(|value| value.im != 0.0) {
            prop_assert!(values.contains(&value.conj()));
        }
        let trace: f64 = (0..n).map(|i| matrix[i + n * i]).sum();
        let sum: Complex64 = values.iter().sum();
        prop_assert!((sum - trace).norm() < 1e-13 * norm * n as f64);
        // Each is an eigenvalue of the matrix: right and left residuals, computed here without balancing.
        for value in &values {
            let right = right_eigenvector(&matrix, n, *value).unwrap();
            let left = left_eigenvector(&matrix, n, *value).unwrap();
            for i in 0..n {
                let image: Complex64 = (0..n).map(|j| right.vector[j] * matrix[i + n * j]).sum();
                prop_assert!((image - value * right.vector[i]).norm() < 1e-12 * norm, "right, {value}");
                let image: Complex64 = (0..n).map(|j| left.vector[j].conj() * matrix[j + n * i]).sum();
                prop_assert!((image - value * left.vector[i].conj()).norm() < 1e-12 * norm, "left, {value}");
            }
            let norm: f64 = right.vector.iter().map(|x| x.norm_sqr()).sum();
            prop_assert!((norm - 1.0).abs() < 1e-14);
            let largest = right.vector.iter().fold(0.0_f64, |m, x| m.max(x.norm()));
            prop_assert!(right.vector.iter().any(|x| x.im == 0.0 && x.re > 0.99 * largest));
            if value.im == 0.0 {
                prop_assert!(right.vector.iter().all(|x| x.im == 0.0));
            }
        }
    }

    #[test]
    fn orthogonal_similarity_of_known_blocks(seed in any::<u64>(), n in 2usize..20) {
        // Blocks [a -b; b a] and single entries on the diagonal, hidden by random reflections.
        let numbers = pseudo_random(seed, n * (n + 2));
        let mut matrix = vec![0.0; n * n];
        let mut expected = Vec::new();
        let mut k = 0;
        while k < n {
            let (a, b) = (numbers[2 * k], numbers[2 * k + 1]);
            matrix[k + n * k] = a;
            if k + 1 < n && k % 3 != 2 {
                matrix[k + 1 + n * (k + 1)] = a;
                matrix[k + 1 + n * k] = b;
                matrix[k + n * (k + 1)] = -b;
                expected.extend([Complex64::new(a, b), Complex64::new(a, -b)]);
                k += 2;
            } else {
                expected.push(a.into());
                k += 1;
            }
        }
        for v in numbers[2 * n..].chunks_exact(n) {
            let square: f64 = v.iter().map(|x| x * x).sum();
            for column in matrix.chunks_exact_mut(n) {
                let sum: f64 = v.iter().zip(&*column).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(v).for_each(|(x, v)| *x -= 2.0 * sum / square * v);
            }
            for i in 0..n {
                let sum: f64 = (0..n).map(|j| matrix[i + n * j] * v[j]).sum();
                (0..n).for_each(|j| matrix[i + n * j] -= 2.0 * sum / square * v[j]);
            }
        }
        let values = eigenvalues(&matrix, n).unwrap();
        prop_assert!(distance(&values, &expected) < 2e-14 * n as f64, "{values:?} {expected:?}");
    }
}
