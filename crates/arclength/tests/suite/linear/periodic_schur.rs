//! Multipliers of products of matrices that are built from known ones.

use arclength::linear::eigenvalues::{EigenvalueError, eigenvalues};
use arclength::linear::multiplier::Multiplier;
use arclength::linear::periodic_schur::{PeriodicSchur, multipliers};
use num_complex::Complex64;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

struct Random(u64);

impl Random {
    /// Uniform in (-1, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn matrix(&mut self, n: usize) -> Vec<f64> {
        (0..n * n).map(|_| self.next()).collect()
    }

    /// A product of plane rotations by angles up to `angle`.
    fn orthogonal(&mut self, n: usize, angle: f64) -> Vec<f64> {
        let mut q: Vec<f64> = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        for i in 0..n {
            for j in 0..i {
                let (s, c) = (angle * self.next()).sin_cos();
                for column in q.chunks_exact_mut(n) {
                    (column[i], column[j]) = (c * column[i] - s * column[j], s * column[i] + c * column[j]);
                }
            }
        }
        q
    }
}

fn product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    (0..n * n).map(|k| (0..n).map(|m| a[k % n + n * m] * b[m + n * (k / n)]).sum()).collect()
}

fn transposed(a: &[f64], n: usize) -> Vec<f64> {
    (0..n * n).map(|k| a[k / n + n * (k % n)]).collect()
}

/// What stands on the diagonal of the triangular factors.
#[derive(Clone, Copy, Debug)]
enum Diagonal {
    /// An entry with this logarithm of its modulus at each factor on average, negative at every third factor.
    Real(f64),
    /// A 2-by-2 rotation times a number with this logarithm, by this angle at each factor on average.
    Pair(f64, f64),
}

/// Factors `Q_(j+1) T_j Q_j^T` with `Q_N = Q_0`, and the multipliers that the diagonals of the `T_j` give.
fn known(
    random: &mut Random,
    diagonal: &[Diagonal],
    count: usize,
    angle: f64,
    coupling: f64,
) -> (usize, Vec<f64>, Vec<Multiplier>) {
    let n = diagonal.iter().map(|entry| if let Diagonal::Real(_) = entry { 1 } else { 2 }).sum();
    let rotations: Vec<_> = (0..count).map(|_| random.orthogonal(n, angle)).collect();
    let mut expected: Vec<(f64, f64)> = vec![(0.0, 0.0); diagonal.len()];
    let mut factors = Vec::new();
    for j in 0..count {
        let mut t: Vec<f64> =
            (0..n * n).map(|k| if k % n < k / n { coupling * random.next() } else { 0.0 }).collect();
        let mut at = 0;
        for (entry, expected) in diagonal.iter().zip(&mut expected) {
            match *entry {
                Diagonal::Real(logarithm) => {
                    let logarithm = logarithm + 0.1 * random.next();
                    let sign = if j % 3 == 2 { -1.0 } else { 1.0 };
                    t[at + n * at] = sign * logarithm.exp();
                    expected.0 += logarithm;
                    expected.1 = if sign < 0.0 { PI - expected.1 } else { expected.1 };
                    at += 1;
                }
                Diagonal::Pair(logarithm, turn) => {
                    let logarithm = logarithm + 0.1 * random.next();
                    let turn = turn + 0.01 * random.next();
                    let (s, c) = turn.sin_cos();
                    t[at + n * at] = c * logarithm.exp();
                    t[at + 1 + n * (at + 1)] = c * logarithm.exp();
                    t[at + 1 + n * at] = s * logarithm.exp();
                    t[at + n * (at + 1)] = -s * logarithm.exp();
                    expected.0 += logarithm;
                    expected.1 += turn;
                    at += 2;
                }
            }
        }
        let left = product(&rotations[(j + 1) % count], &t, n);
        factors.extend(product(&left, &transposed(&rotations[j], n), n));
    }
    let mut multipliers = Vec::new();
    for (entry, (log_modulus, argument)) in diagonal.iter().zip(expected) {
        if let Diagonal::Real(_) = entry {
            multipliers.push(Multiplier { log_modulus, argument });
        } else {
            let argument = (argument + PI).rem_euclid(TAU) - PI;
            multipliers.push(Multiplier { log_modulus, argument: -argument.abs() });
            multipliers.push(Multiplier { log_modulus, argument: argument.abs() });
        }
    }
    multipliers
        .sort_by(|a, b| b.log_modulus.total_cmp(&a.log_modulus).then(a.argument.total_cmp(&b.argument)));
    (n, factors, multipliers)
}

fn assert_close(found: &[Multiplier], expected: &[Multiplier], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        let turn = (a.argument - b.argument).abs();
        let turn = turn.min(TAU - turn);
        assert!(
            (a.log_modulus - b.log_modulus).abs() < tolerance && turn < tolerance,
            "{found:#?} against {expected:#?}"
        );
    }
}

use Diagonal::{Pair, Real};

#[test]
fn multipliers_from_1e300_to_1e_minus_300_together() {
    // A thousand factors; exp(0.69 * 1000) is about 1e300.
    for seed in 0..3 {
        let diagonal = [Real(0.69), Pair(0.3, 0.7), Real(0.0), Real(-0.2), Pair(-0.5, 1.3), Real(-0.69)];
        let (n, factors, expected) = known(&mut Random(seed), &diagonal, 1000, 3.0, 0.3);
        assert!(expected[0].log_modulus > 680.0 && expected[n - 1].log_modulus < -680.0);
        assert_close(&multipliers(&factors, n, 1000).unwrap(), &expected, 1e-10);
    }
}

#[test]
fn any_order_on_the_diagonal_and_any_strength_of_the_coupling() {
    // Ascending order with weak coupling is the hard case: shifts from the bottom dwarf the top.
    for angle in [0.0, 1e-14, 1e-8, 1e-3, 1.0] {
        for diagonal in [
            [Real(-0.6), Real(-0.3), Real(0.1), Real(0.3), Real(0.6)],
            [Real(0.6), Real(0.3), Real(0.1), Real(-0.3), Real(-0.6)],
            [Real(-0.6), Real(0.6), Real(-0.3), Real(0.3), Real(0.1)],
        ] {
            for count in [1, 2, 12, 100, 600] {
                let (n, factors, expected) = known(&mut Random(count as u64), &diagonal, count, angle, 0.2);
                assert_close(&multipliers(&factors, n, count).unwrap(), &expected, 1e-10);
            }
        }
        let pairs = [Pair(-0.6, 0.4), Pair(0.6, 1.0), Real(0.1), Pair(0.3, 2.0)];
        for count in [1, 2, 12, 100, 600] {
            let (n, factors, expected) = known(&mut Random(count as u64), &pairs, count, angle, 0.2);
            assert_close(&multipliers(&factors, n, count).unwrap(), &expected, 1e-10);
        }
    }
}

#[test]
fn two_by_two_products() {
    for count in [1, 3, 50, 1000] {
        for diagonal in [vec![Real(0.6), Real(-0.6)], vec![Pair(0.5, 0.3)], vec![Real(-0.1), Real(0.6)]] {
            let (n, factors, expected) = known(&mut Random(7), &diagonal, count, 3.0, 0.5);
            assert_close(&multipliers(&factors, n, count).unwrap(), &expected, 1e-10);
        }
    }
}

#[test]
fn factors_of_extreme_size() {
    let mut factors = vec![1e250, 2e250, -1e250, 3e250];
    factors.extend([1e-280, 0.5e-280, 0.2e-280, -1e-280]);
    factors.extend([1e300, 1e299, 0.0, 1e300]);
    let plain = vec![1.0, 2.0, -1.0, 3.0, 1.0, 0.5, 0.2, -1.0, 1.0, 0.1, 0.0, 1.0];
    let (found, reference) = (multipliers(&factors, 2, 3).unwrap(), multipliers(&plain, 2, 3).unwrap());
    for (a, b) in found.iter().zip(reference) {
        assert!((a.log_modulus - b.log_modulus - 270.0 * std::f64::consts::LN_10).abs() < 1e-11);
        assert!((a.argument - b.argument).abs() < 1e-14);
    }
}

#[test]
fn one_factor_agrees_with_eigenvalues() {
    for seed in 0..200 {
        let n = 1 + seed as usize % 12;
        let matrix = Random(seed).matrix(n);
        let mut found: Vec<_> = multipliers(&matrix, n, 1).unwrap().iter().map(|m| m.to_complex()).collect();
        for value in eigenvalues(&matrix, n).unwrap() {
            let distance = |z: &Complex64| (*z - value).norm();
            let nearest =
                (0..found.len()).min_by(|a, b| distance(&found[*a]).total_cmp(&distance(&found[*b])));
            assert!(distance(&found.swap_remove(nearest.unwrap())) < 1e-11 * n as f64, "seed {seed}");
        }
    }
}

#[test]
fn mixed_units_do_not_cost_digits() {
    let d = [1e-7, 1.0, 1e7, 1e3];
    let mut random = Random(5);
    let plain: Vec<f64> = (0..6).flat_map(|_| random.matrix(4)).collect();
    let scaled: Vec<f64> = (0..6 * 16).map(|k| plain[k] * d[k % 16 / 4] / d[k % 4]).collect();
    let (plain, scaled) = (multipliers(&plain, 4, 6).unwrap(), multipliers(&scaled, 4, 6).unwrap());
    assert_close(&scaled, &plain, 1e-11);
}

#[test]
fn singular_factors_give_multipliers_that_are_exactly_zero() {
    let zeros = |found: &[Multiplier]| found.iter().filter(|m| m.log_modulus == f64::NEG_INFINITY).count();
    for seed in 0..200 {
        let random = &mut Random(seed);
        let (n, count) = (2 + seed as usize % 7, 1 + seed as usize % 5);
        let mut factors: Vec<f64> = (0..count).flat_map(|_| random.matrix(n)).collect();
        // Well conditioned but for the rank taken away below.
        factors.chunks_exact_mut(n * n).for_each(|factor| (0..n).for_each(|k| factor[k + n * k] += 3.0));
        let at = seed as usize % count;
        let factor = &mut factors[n * n * at..n * n * (at + 1)];
        match seed % 4 {
            // Two equal columns, a zero row, two equal rows, a matrix of rank one.
            0 => factor.copy_within(0..n, n * (n - 1)),
            1 => factor.chunks_exact_mut(n).for_each(|column| column[1] = 0.0),
            2 => factor.chunks_exact_mut(n).for_each(|column| column[n - 1] = column[0]),
            _ => (1..n).for_each(|k| {
                let factor_of_column = 0.5 * k as f64;
                (0..n).for_each(|row| factor[row + n * k] = factor_of_column * factor[row]);
            }),
        }
        let found = multipliers(&factors, n, count).unwrap();
        let expected = if seed % 4 == 3 { n - 1 } else { 1 };
        assert_eq!(zeros(&found), expected, "seed {seed}: {found:#?}");
        // The others agree with the product, formed directly.
        let mut whole = factors[..n * n].to_vec();
        factors.chunks_exact(n * n).skip(1).for_each(|factor| whole = product(factor, &whole, n));
        let trace: f64 = (0..n).map(|k| whole[k + n * k]).sum();
        let sum: Complex64 = found.iter().map(|m| m.to_complex()).sum();
        let norm = whole.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((sum - trace).norm() < 1e-12 * norm, "seed {seed}: {sum} {trace}");
    }
}

#[test]
fn several_singular_factors_and_the_zero_matrix() {
    let n = 4;
    let mut factors = vec![0.0; 2 * n * n];
    // Two nilpotent shifts.
    for factor in factors.chunks_exact_mut(n * n) {
        (1..n).for_each(|k| factor[k - 1 + n * k] = 1.0);
    }
    assert!(multipliers(&factors, n, 2).unwrap().iter().all(|m| *m == Multiplier::ZERO));
    factors.fill(0.0);
    assert!(multipliers(&factors, n, 2).unwrap().iter().all(|m| *m == Multiplier::ZERO));
    // Projections onto overlapping coordinate planes: only the common coordinate survives.
    let mut projections = vec![0.0; 2 * 9];
    (projections[0], projections[4], projections[9 + 4], projections[9 + 8]) = (2.0, 3.0, 5.0, 7.0);
    let found = multipliers(&projections, 3, 2).unwrap();
    assert!((found[0].to_complex() - 15.0).norm() < 1e-13);
    assert_eq!(found[1..], [Multiplier::ZERO; 2]);
}

#[test]
fn small_entries_of_triangular_factors_are_not_taken_for_zero() {
    // diag(1, 1e-25) with full coupling, twelve times: the small multiplier is 1e-300.
    let factors = [1.0, 0.0, 0.7, 1e-25].repeat(12);
    let found = multipliers(&factors, 2, 12).unwrap();
    assert!(found[0].log_modulus.abs() < 1e-14);
    assert!((found[1].log_modulus + 300.0 * std::f64::consts::LN_10).abs() < 1e-11);
}

#[test]
fn permutations_whose_product_is_a_cycle() {
    // The identity and cyclic shifts: roots of one, on which plain double shifts stand still.
    for n in [3, 4, 5, 8, 20] {
        let mut shift = vec![0.0; n * n];
        (0..n).for_each(|k| shift[(k + 1) % n + n * k] = 1.0);
        let mut identity = vec![0.0; n * n];
        (0..n).for_each(|k| identity[k + n * k] = 1.0);
        let factors = [identity.clone(), shift, identity].concat();
        for multiplier in multipliers(&factors, n, 3).unwrap() {
            assert!(multiplier.log_modulus.abs() < 1e-13);
            let turns = multiplier.argument * n as f64 / TAU;
            assert!((turns - turns.round()).abs() < 1e-12);
        }
    }
}

#[test]
fn degenerate_shapes_and_bad_input() {
    assert!(multipliers(&[], 0, 5).unwrap().is_empty());
    assert_eq!(multipliers(&[], 2, 0).unwrap(), [Multiplier { log_modulus: 0.0, argument: 0.0 }; 2]);
    let found = multipliers(&[-2.0, 3.0], 1, 2).unwrap();
    assert!((found[0].log_modulus - 6f64.ln()).abs() < 1e-15 && found[0].argument == PI);
    assert!(matches!(
        multipliers(&[1.0; 7], 2, 2),
        Err(EigenvalueError::Shape { expected: 8, found: 7, .. })
    ));
    let mut factors = [1.0; 8];
    factors[6] = f64::NAN;
    let error = multipliers(&factors, 2, 2);
    assert!(matches!(error, Err(EigenvalueError::NotFinite { factor: 1, row: 0, column: 1, .. })));
}

#[test]
fn fifty_rows() {
    let diagonal: Vec<_> = (0..20)
        .flat_map(|k| [Real(0.3 - 0.03 * k as f64), Pair(0.31 - 0.03 * k as f64, 0.5)])
        .take(33)
        .collect();
    let (n, factors, mut expected) = known(&mut Random(3), &diagonal, 8, 3.0, 0.02);
    assert_eq!(n, 49);
    // Neighbours may be close: compare as sorted by argument classes.
    let mut found = multipliers(&factors, n, 8).unwrap();
    let key = |m: &Multiplier| {
        (
            if m.is_real() {
                0
            } else if m.argument < 0.0 {
                1
            } else {
                2
            },
            m.log_modulus,
        )
    };
    for list in [&mut found, &mut expected] {
        list.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(b).1.total_cmp(&key(a).1)));
    }
    assert_close(&found, &expected, 1e-9);
}

#[test]
fn workspace_gives_what_the_function_gives() {
    let mut workspace = PeriodicSchur::new(5, 12);
    let mut random = Random(11);
    for _ in 0..20 {
        let factors: Vec<f64> = (0..12).flat_map(|_| random.matrix(5)).collect();
        assert_eq!(workspace.multipliers(&factors).unwrap(), multipliers(&factors, 5, 12).unwrap());
    }
}

proptest! {
    #[test]
    fn products_of_small_integers_keep_their_trace(n in 1usize..8, count in 1usize..4, seed in any::<u64>()) {
        // Often singular, defective, or with nearly dependent columns; the trace of the product is exact.
        let mut random = Random(seed);
        let factors: Vec<f64> = (0..n * n * count).map(|_| (1.5 * random.next()).round()).collect();
        let mut whole = factors[..n * n].to_vec();
        factors.chunks_exact(n * n).skip(1).for_each(|factor| whole = product(factor, &whole, n));
        let trace: f64 = (0..n).map(|k| whole[k + n * k]).sum();
        let found = multipliers(&factors, n, count).unwrap();
        let sum: Complex64 = found.iter().map(|m| m.to_complex()).sum();
        let norm = |factor: &[f64]| factor.iter().map(|x| x * x).sum::<f64>().sqrt();
        let bound: f64 = factors.chunks_exact(n * n).map(norm).product();
        prop_assert!((sum - trace).norm() <= 1e-12 * bound, "{sum} {trace}");
    }

    #[test]
    fn short_products_agree_with_the_product_formed_directly(n in 1usize..9, count in 1usize..4, seed in any::<u64>()) {
        let mut random = Random(seed);
        // Near a multiple of the identity, so that the product is well conditioned.
        let factors: Vec<f64> = (0..count)
            .flat_map(|_| {
                let mut factor = random.matrix(n);
                (0..n).for_each(|k| factor[k + n * k] += 3.0);
                factor
            })
            .collect();
        let mut whole = factors[..n * n].to_vec();
        factors.chunks_exact(n * n).skip(1).for_each(|factor| whole = product(factor, &whole, n));
        let found = multipliers(&factors, n, count).unwrap();
        let norm = whole.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Coefficients of the characteristic polynomial depend smoothly even on multiple eigenvalues.
        for point in [Complex64::new(0.3, 0.5), Complex64::new(-1.0, 0.2), Complex64::new(1.1, 1.3)] {
            let value = |list: &mut dyn Iterator<Item = Complex64>| -> Complex64 { list.map(|z| z / norm - point).product() };
            let a = value(&mut found.iter().map(|m| m.to_complex()));
            let b = value(&mut eigenvalues(&whole, n).unwrap().into_iter());
            prop_assert!((a - b).norm() < 1e-12 * b.norm());
        }
        for pair in found.windows(2) {
            prop_assert!(pair[0].log_modulus >= pair[1].log_modulus);
        }
        for m in found.iter().filter(|m| !m.is_real()) {
            prop_assert!(found.contains(&m.conj()));
        }
    }

    #[test]
    fn moduli_multiply_to_the_determinants(n in 1usize..7, count in 1usize..40, seed in any::<u64>()) {
        let mut random = Random(seed);
        let factors: Vec<f64> = (0..count).flat_map(|_| random.matrix(n)).collect();
        let found = multipliers(&factors, n, count).unwrap();
        let expected: f64 = factors
            .chunks_exact(n * n)
            .flat_map(|factor| eigenvalues(factor, n).unwrap())
            .map(|value| value.norm().ln())
            .sum();
        let sum: f64 = found.iter().map(|m| m.log_modulus).sum();
        prop_assert!((sum - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{sum} {expected}");
    }
}

#[test]
fn clusters_of_equal_multipliers_in_a_symmetric_ring() {
    // The flow of 24 coupled oscillators next to the origin: a circulant matrix times a rotation, in eight equal parts of a turn.
    const CELLS: usize = 24;
    const PARTS: usize = 8;
    let step = std::f64::consts::TAU / PARTS as f64;
    let mode =
        |j: usize, distance: usize| (std::f64::consts::TAU * (j * distance) as f64 / CELLS as f64).cos();
    let decay = |j: usize| 0.2 * (1.0 - mode(j, 1));
    let n = 2 * CELLS;
    let (sine, cosine) = step.sin_cos();
    let mut part = vec![0.0; n * n];
    for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
        let sum: f64 = (0..CELLS).map(|j| (-step * decay(j)).exp() * mode(j, row.abs_diff(column))).sum();
        for (a, b, entry) in [(0, 0, cosine), (0, 1, -sine), (1, 0, sine), (1, 1, cosine)] {
            part[2 * row + a + n * (2 * column + b)] = sum / CELLS as f64 * entry;
        }
    }
    // Other coordinates at every part mix the equal multipliers.
    let mut random = Random(7);
    let frames: Vec<Vec<f64>> = (0..PARTS).map(|_| random.orthogonal(n, 1.0)).collect();
    let factors: Vec<f64> = (0..PARTS)
        .flat_map(|index| {
            let changed = product(&part, &transposed(&frames[index], n), n);
            product(&frames[(index + 1) % PARTS], &changed, n)
        })
        .collect();
    let found = multipliers(&factors, n, PARTS).unwrap();
    let mut expected: Vec<f64> = (0..CELLS).flat_map(|j| [-std::f64::consts::TAU * decay(j); 2]).collect();
    expected.sort_by(|a, b| b.total_cmp(a));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found.log_modulus - expected).abs() < 1e-12, "{} {expected}", found.log_modulus);
    }
}

#[test]
fn clusters_of_nearly_equal_multipliers_are_found_whatever_the_coordinates() {
    // Multipliers of the synchronous cycle of six coupled oscillators, next to the Hopf point where it is born: quadruples that differ
    // in the last digits. In some coordinates rounding errors of the sweeps themselves keep them coupled.
    let decay = |j: usize| 0.6 * TAU * (1.0 - (TAU * j as f64 / 6.0).cos());
    let mut random = Random(29);
    for case in 0..400 {
        let count = 8 + case % 20;
        let split = 1e-6 * (case + 1) as f64;
        let logarithms: Vec<f64> =
            [0, 1, 2, 3, 4, 5].iter().flat_map(|&j| [-decay(j), -decay(j) - split]).skip(1).collect();
        let n = logarithms.len();
        let frames: Vec<Vec<f64>> = (0..count).map(|_| random.orthogonal(n, PI)).collect();
        let mut part = vec![0.0; n * n];
        for (entry, logarithm) in part.iter_mut().step_by(n + 1).zip(&logarithms) {
            *entry = (logarithm / count as f64).exp();
        }
        let factors: Vec<f64> = (0..count)
            .flat_map(|index| {
                let changed = product(&part, &transposed(&frames[index], n), n);
                product(&frames[(index + 1) % count], &changed, n)
            })
            .collect();
        let found = multipliers(&factors, n, count).unwrap();
        let mut expected = logarithms;
        expected.sort_by(|a, b| b.total_cmp(a));
        for (found, expected) in found.iter().zip(expected) {
            let error = (found.log_modulus - expected).abs().max(found.argument.abs());
            assert!(error < 1e-11, "case {case}: {found:?}, not {expected}");
        }
    }
}
