//! Eigenvectors of products of matrices, checked factor by factor.

use arclength::linear::eigenvalues::eigenvalues;
use arclength::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use arclength::linear::multiplier::Multiplier;
use arclength::linear::periodic_schur::multipliers;
use arclength::linear::product_eigenvectors::{product_eigenvector, product_left_eigenvector};
use num_complex::Complex64;
use proptest::prelude::*;

fn pseudo_random(seed: u64, length: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..length)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

fn image(factor: &[f64], vector: &[Complex64]) -> Vec<Complex64> {
    let n = vector.len();
    (0..n).map(|row| (0..n).map(|column| vector[column] * factor[row + n * column]).sum()).collect()
}

fn transposed(a: &[f64], n: usize) -> Vec<f64> {
    (0..n * n).map(|k| a[k / n + n * (k % n)]).collect()
}

fn norm(vector: &[Complex64]) -> f64 {
    vector.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt()
}

fn assert_parallel(a: &[Complex64], b: &[Complex64], tolerance: f64) {
    let distance = a.iter().zip(b).map(|(x, y)| (x - y).norm_sqr()).sum::<f64>().sqrt();
    assert!(distance <= tolerance * norm(a).max(norm(b)), "{a:?} {b:?}");
}

/// Follows right and left vectors of each multiplier through the factors.
fn check_all(factors: &[f64], n: usize, count: usize, tolerance: f64) {
    let size = n * n;
    for multiplier in multipliers(factors, n, count).unwrap() {
        let mu = multiplier.to_complex();
        let right = product_eigenvector(factors, n, count, multiplier).unwrap();
        let left = product_left_eigenvector(factors, n, count, multiplier).unwrap();
        assert!(right.residual < 1e-13 && left.residual < 1e-13, "{right:?} {left:?}");
        let (z, w) = (&right.vectors, &left.vectors);
        assert!((norm(&z[..n]) - 1.0).abs() < 1e-14 && (norm(&w[..n]) - 1.0).abs() < 1e-14);
        for j in 0..count {
            let following: Vec<_> = if j + 1 < count {
                z[n * (j + 1)..n * (j + 2)].to_vec()
            } else {
                z[..n].iter().map(|x| x * mu).collect()
            };
            let scale = norm(&z[n * j..n * (j + 1)]);
            let difference: Vec<_> = image(&factors[size * j..size * (j + 1)], &z[n * j..n * (j + 1)])
                .iter()
                .zip(&following)
                .map(|(a, b)| a - b)
                .collect();
            assert!(norm(&difference) < tolerance * scale, "factor {j}: {difference:?}");

            let at = if j + 1 < count { n * (j + 1)..n * (j + 2) } else { 0..n };
            let previous: Vec<_> = if j > 0 {
                w[n * j..n * (j + 1)].to_vec()
            } else {
                w[..n].iter().map(|x| x * mu.conj()).collect()
            };
            let back = image(&transposed(&factors[size * j..size * (j + 1)], n), &w[at.clone()]);
            let difference: Vec<_> = back.iter().zip(&previous).map(|(a, b)| a - b).collect();
            assert!(norm(&difference) < tolerance * norm(&w[at]), "adjoint factor {j}");
        }
        if multiplier.is_real() {
            assert!(z.iter().chain(w).all(|x| x.im == 0.0));
        }
        let largest = z[..n].iter().fold(0.0_f64, |m, x| m.max(x.norm()));
        assert!(z[..n].iter().any(|x| x.im == 0.0 && x.re > 0.99 * largest));
    }
}

#[test]
fn one_factor_agrees_with_eigenvectors_of_a_matrix() {
    for seed in 0..30 {
        let matrix = pseudo_random(seed, 25);
        for value in eigenvalues(&matrix, 5).unwrap() {
            let product = product_eigenvector(&matrix, 5, 1, value).unwrap();
            assert_parallel(&product.vectors, &right_eigenvector(&matrix, 5, value).unwrap().vector, 1e-10);
            let product = product_left_eigenvector(&matrix, 5, 1, value).unwrap();
            assert_parallel(&product.vectors, &left_eigenvector(&matrix, 5, value).unwrap().vector, 1e-10);
        }
    }
}

#[test]
fn vectors_of_the_smallest_multiplier_survive_growth_and_decay() {
    // Diagonal factors seen in rotated coordinates, 60 times: multipliers from 2^60 to 2^-60. Decaying
    // vectors cannot be found from the product, whose rounding errors exceed the small multipliers by twenty
    // orders of magnitude.
    let (n, count) = (3, 60);
    let q = |j: usize| {
        let (s, c) = (0.7 + 0.3 * (j % count) as f64).sin_cos();
        let (t, d) = (0.2 + 0.5 * (j % count) as f64).sin_cos();
        // Rotation in the first two coordinates after one in the last two.
        [c, s, 0.0, -s * d, c * d, t, s * t, -c * t, d]
    };
    let mut factors = Vec::new();
    for j in 0..count {
        let (before, after) = (q(j), q(j + 1));
        for column in 0..n {
            for row in 0..n {
                factors.push(
                    (0..n).map(|k| after[row + n * k] * [2.0, 1.0, 0.5][k] * before[column + n * k]).sum(),
                );
            }
        }
    }
    for (k, base) in [2.0_f64, 1.0, 0.5].into_iter().enumerate() {
        let multiplier = Multiplier { log_modulus: count as f64 * base.ln(), argument: 0.0 };
        for vectors in [
            product_eigenvector(&factors, n, count, multiplier).unwrap().vectors,
            product_left_eigenvector(&factors, n, count, multiplier).unwrap().vectors,
        ] {
            let expected = &q(0)[n * k..n * (k + 1)];
            let cosine: f64 = vectors[..n].iter().zip(expected).map(|(a, b)| a.re * b).sum();
            let error =
                vectors[..n].iter().zip(expected).map(|(a, b)| (a.re - cosine * b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-13, "multiplier {base}^{count}: {error:e}");
        }
    }
    check_all(&factors, n, count, 1e-12);
}

#[test]
fn multipliers_out_of_range() {
    // 1e500 and 1e-400 at once; z_j stays in range where it can.
    let factors = [1e5, 0.0, 1e4, 1e-4].repeat(100);
    for log in [500.0, -400.0] {
        let multiplier = Multiplier { log_modulus: log * std::f64::consts::LN_10, argument: 0.0 };
        let right = product_eigenvector(&factors, 2, 100, multiplier).unwrap();
        assert!(right.residual < 1e-14, "{}", right.residual);
        let expected = if log > 0.0 { [1.0, 0.0] } else { [-0.1 / 1.01_f64.sqrt(), 1.0 / 1.01_f64.sqrt()] };
        for (a, b) in right.vectors.iter().zip(expected) {
            assert!((a.re - b).abs() < 1e-9, "{:?}", &right.vectors[..2]);
        }
    }
}

#[test]
fn multiplier_zero() {
    // The second factor is a projection; the product is [[1, 1], [0, 0]], which maps (1, -1) to zero.
    let factors = [1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    let z = product_eigenvector(&factors, 2, 2, Multiplier::ZERO).unwrap();
    assert!(z.residual < 1e-15 && (z.vectors[0] + z.vectors[1]).norm() < 1e-15, "{z:?}");
}

#[test]
fn wrong_multiplier_shows_in_the_residual() {
    let factors = [2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0, 1.0];
    assert!(product_eigenvector(&factors, 2, 2, 2.0).unwrap().residual > 1e-2);
    assert!(product_eigenvector(&factors, 2, 2, 1e300).unwrap().residual > 1e-2);
    assert!(product_eigenvector(&factors, 2, 2, f64::NAN).is_err());
    assert!(product_eigenvector(&factors, 2, 2, f64::INFINITY).is_err());
    assert!(product_eigenvector(&factors, 2, 3, 1.0).is_err());
}

#[test]
fn mixed_units_do_not_cost_digits() {
    let d = [1e-7, 1.0, 1e7];
    let plain = pseudo_random(3, 4 * 9);
    let scaled: Vec<f64> = (0..4 * 9).map(|k| plain[k] * d[k % 9 / 3] / d[k % 3]).collect();
    for multiplier in multipliers(&plain, 3, 4).unwrap() {
        let a = product_eigenvector(&plain, 3, 4, multiplier).unwrap().vectors;
        let b = product_eigenvector(&scaled, 3, 4, multiplier).unwrap().vectors;
        // b is D^-1 a up to a factor.
        let ratio = b[0] * d[0] / a[0];
        (0..3).for_each(|k| assert!((b[k] * d[k] / a[k] / ratio - 1.0).norm() < 1e-10, "{a:?} {b:?}"));
    }
}

proptest! {
    #[test]
    fn random_products(n in 1usize..7, count in 1usize..15, seed in any::<u64>()) {
        let mut factors = pseudo_random(seed, n * n * count);
        for factor in factors.chunks_exact_mut(n * n) {
            (0..n).for_each(|k| factor[k + n * k] += 2.0 + k as f64);
        }
        check_all(&factors, n, count, 1e-10);
    }
}
