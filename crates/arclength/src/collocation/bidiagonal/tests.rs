//! The elimination against that of the full matrix.

use super::{Bidiagonal, Blocks, Sizes};
use crate::linear::lu;
use proptest::prelude::*;

/// Numbers of a generated system, given out one after the other.
struct Numbers(std::vec::IntoIter<f64>);

impl Numbers {
    fn take(&mut self, count: usize) -> Vec<f64> {
        self.0.by_ref().take(count).collect()
    }
}

/// The full matrix in the unknowns `u_0, ..., u_N, s`; rows: block rows, boundary conditions, dense rows.
fn full_matrix(blocks: Blocks<'_>, sizes: Sizes) -> Vec<f64> {
    let Sizes { components: n, scalars, boundary_conditions, intervals } = sizes;
    let states = intervals * n;
    let size = states + n + scalars;
    let mut full = vec![0.0; size * size];
    let mut set = |row: usize, column: usize, value: f64| full[row + size * column] = value;
    for j in 0..intervals {
        for row in 0..n {
            set(j * n + row, (j + 1) * n + row, 1.0);
            for column in 0..n {
                set(j * n + row, j * n + column, -blocks.transfer[j * n * n + row + n * column]);
            }
            for column in 0..scalars {
                let value = -blocks.scalar_columns[j * n * scalars + row + n * column];
                set(j * n + row, states + n + column, value);
            }
        }
    }
    for row in 0..boundary_conditions {
        for column in 0..2 * n + scalars {
            let place = match column {
                column if column < n => states + column,
                column if column < 2 * n => column - n,
                column => states + column - n,
            };
            set(states + row, place, blocks.boundary[row + boundary_conditions * column]);
        }
    }
    for row in 0..sizes.dense_rows() {
        let place = states + boundary_conditions + row;
        for column in 0..states {
            set(place, column, blocks.rows[row * states + column]);
        }
        for column in 0..scalars {
            set(place, states + n + column, blocks.corner[row * scalars + column]);
        }
    }
    full
}

/// Boundary conditions `u_N = +-u_0`.
fn periodic(n: usize, scalars: usize, sign: f64) -> Vec<f64> {
    let mut boundary = vec![0.0; n * (2 * n + scalars)];
    for component in 0..n {
        boundary[component * (n + 1)] = 1.0;
        boundary[n * n + component * (n + 1)] = -sign;
    }
    boundary
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]
    #[test]
    fn agrees_with_dense_elimination(
        n in 1usize..5, intervals in 1usize..7, scalars in 1usize..4, kind in 0..3,
        separated in 0.0..1.0f64, stretch in -6.0..6.0f64,
        entries in prop::collection::vec(-1.0..1.0f64, 1200),
    ) {
        let boundary_conditions = match kind {
            0 => (separated * (n + scalars + 1) as f64) as usize,
            _ => n,
        };
        let sizes = Sizes { components: n, scalars, boundary_conditions, intervals };
        let mut numbers = Numbers(entries.into_iter());
        let mut transfer = numbers.take(intervals * n * n);
        // One strongly growing and one strongly decaying direction.
        for block in transfer.chunks_exact_mut(n * n) {
            block[0] += stretch.exp2() * 4.0;
        }
        let scalar_columns = numbers.take(intervals * n * scalars);
        let rows = numbers.take(sizes.dense_rows() * intervals * n);
        let corner = numbers.take(sizes.dense_rows() * scalars);
        let boundary = match kind {
            0 => numbers.take(boundary_conditions * (2 * n + scalars)),
            1 => periodic(n, scalars, 1.0),
            _ => periodic(n, scalars, -1.0),
        };
        let blocks = Blocks {
            transfer: &transfer,
            scalar_columns: &scalar_columns,
            boundary: &boundary,
            rows: &rows,
            corner: &corner,
        };
        let full = full_matrix(blocks, sizes);
        let (states, size) = (intervals * n, (intervals + 1) * n + scalars);
        let truth = numbers.take(size);
        let mut right: Vec<f64> = (0..size)
            .map(|row| (0..size).map(|column| full[row + size * column] * truth[column]).sum())
            .collect();
        // The last block row has no right-hand side.
        right[states - n..states].fill(0.0);
        let mut pivots = vec![0; size];
        let mut factors = full.clone();
        prop_assume!(lu::factorize(&mut factors, size, &mut pivots) != 0.0);
        let mut exact = right.clone();
        lu::solve(&factors, size, &pivots, &mut exact);
        // One step of refinement tells how far elimination with partial pivoting is from the truth.
        let mut correction: Vec<f64> = (0..size)
            .map(|row| right[row] - (0..size).map(|column| full[row + size * column] * exact[column]).sum::<f64>())
            .collect();
        lu::solve(&factors, size, &pivots, &mut correction);
        let uncertainty = correction.iter().fold(1e-13_f64, |most, entry| most.max(entry.abs()));
        let scale = exact.iter().fold(1.0_f64, |most, entry| most.max(entry.abs()));
        let mut bidiagonal = Bidiagonal::default();
        prop_assert!(bidiagonal.factorize(blocks, sizes) != 0.0);
        let (starts, conditions) = right.split_at_mut(states);
        bidiagonal.solve(starts, conditions);
        let error = right.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // As accurate as elimination with partial pivoting on the full matrix, near singular too.
        prop_assert!(error <= 1e3 * uncertainty * scale, "{error} {uncertainty}");
    }
}

#[test]
fn survives_modes_whose_product_would_overflow() {
    let (n, intervals) = (2, 400);
    let transfer: Vec<f64> = (0..intervals).flat_map(|_| [10.0, 0.0, 0.0, 0.1]).collect();
    let scalar_columns = vec![1.0; intervals * n];
    let rows = vec![1.0; intervals * n];
    let boundary = periodic(n, 1, 1.0);
    let mut bidiagonal = Bidiagonal::default();
    let blocks = Blocks {
        transfer: &transfer,
        scalar_columns: &scalar_columns,
        boundary: &boundary,
        rows: &rows,
        corner: &[0.0],
    };
    let sizes = Sizes { components: n, scalars: 1, boundary_conditions: n, intervals };
    assert!(bidiagonal.factorize(blocks, sizes) != 0.0);
    // u_j = (1/9, -1/0.9) s * (-1) solves u - R u = s with constant u.
    let mut states = vec![0.0; intervals * n];
    let mut conditions = [0.0, 0.0, 1.0];
    bidiagonal.solve(&mut states, &mut conditions);
    let s = 1.0 / (intervals as f64 * (-1.0 / 9.0 + 1.0 / 0.9));
    assert!((conditions[2] / s - 1.0).abs() < 1e-12);
    assert!((states[200] / (-s / 9.0) - 1.0).abs() < 1e-12);
}
