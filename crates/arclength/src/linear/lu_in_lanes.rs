//! LU factorisation of several matrices of one size side by side, one in each lane of the processor's vectors.
//!
//! The interior systems of neighbouring collocation intervals have 4 to 40 rows: too few to fill vectors from one column. Taken
//! together, every operation is one on whole vectors. Matrices are column-major with one [`Lanes`] for an entry; columns behind
//! the square are right-hand sides. The diagonal is kept as pivot unless it is small within its column (threshold pivoting:
//! Duff, Erisman and Reid, *Direct Methods for Sparse Matrices*, 1986, section 5.4), because rows exchanged in one lane
//! only are moved number by number.

use super::lane_entry::{Entry, LANES, Lanes};
use std::array::from_fn;

/// Part of the largest entry below which the diagonal is not taken as pivot. Entries grow by at most `1 + 1/THRESHOLD` a step.
const THRESHOLD: f64 = 0.1;
/// Steps that are applied to the columns behind them together, so that these are read and written once for all.
const BLOCK: usize = 4;

/// The rows exchanged at one step, by lane.
pub(crate) type Exchange = [u32; LANES];

/// Factorises the leading squares in place as `P A = L U` and replaces the columns behind by the solutions of `A X = B`.
///
/// The reciprocals of the pivots are kept on the diagonal. Returns whether rows were exchanged in any lane, `None` if a matrix
/// is singular or not finite.
#[inline(always)]
pub(crate) fn factorize_and_solve<const FUSED: bool, E: Entry>(
    matrix: &mut [E],
    rows: usize,
    exchanges: &mut [Exchange],
) -> Option<bool> {
    let full = rows - rows % BLOCK;
    let mut exchanged = false;
    for first in (0..full).step_by(BLOCK) {
        exchanged |= eliminate_block::<FUSED, BLOCK, E>(matrix, rows, first, exchanges)?;
    }
    exchanged |= match rows % BLOCK {
        1 => eliminate_block::<FUSED, 1, E>(matrix, rows, full, exchanges)?,
        2 => eliminate_block::<FUSED, 2, E>(matrix, rows, full, exchanges)?,
        3 => eliminate_block::<FUSED, 3, E>(matrix, rows, full, exchanges)?,
        _ => false,
    };
    let (factors, right_hand_sides) = matrix.split_at_mut(rows * rows);
    let mut pairs = right_hand_sides.chunks_exact_mut(2 * rows);
    for pair in &mut pairs {
        let (one, two) = pair.split_at_mut(rows);
        substitute_back::<FUSED, 2, E>(factors, rows, [one, two]);
    }
    for column in pairs.into_remainder().chunks_exact_mut(rows) {
        substitute_back::<FUSED, 1, E>(factors, rows, [column]);
    }
    Some(exchanged)
}

/// Solves for one more right-hand side with the factors; `exchanges` is `None` if no rows were exchanged.
#[inline(always)]
pub(crate) fn solve<const FUSED: bool, E: Entry>(
    factors: &[E],
    rows: usize,
    exchanges: Option<&[Exchange]>,
    column: &mut [E],
) {
    for (step, exchange) in exchanges.into_iter().flatten().enumerate() {
        for (lane, &row) in exchange.iter().enumerate() {
            exchange_entries(column, row as usize, step, lane);
        }
    }
    let full = rows - rows % BLOCK;
    for first in (0..full).step_by(BLOCK) {
        apply_block::<FUSED, BLOCK, 1, E>(&factors[first * rows..], rows, first, [&mut *column]);
    }
    let rest = &factors[full * rows..];
    match rows % BLOCK {
        1 => apply_block::<FUSED, 1, 1, E>(rest, rows, full, [&mut *column]),
        2 => apply_block::<FUSED, 2, 1, E>(rest, rows, full, [&mut *column]),
        3 => apply_block::<FUSED, 3, 1, E>(rest, rows, full, [&mut *column]),
        _ => {}
    }
    substitute_back::<FUSED, 1, E>(factors, rows, [column]);
}

/// `B` steps of the elimination, applied to all columns behind them. Returns whether rows were exchanged.
#[inline(always)]
fn eliminate_block<const FUSED: bool, const B: usize, E: Entry>(
    matrix: &mut [E],
    rows: usize,
    first: usize,
    exchanges: &mut [Exchange],
) -> Option<bool> {
    let mut exchanged = false;
    for step in first..first + B {
        let column = &matrix[step * rows..(step + 1) * rows];
        let mut largest = Lanes::ZERO;
        for entry in &column[step..] {
            // `f64::max` would treat numbers that are not any, at twice the cost; the pivot's reciprocal shows them.
            largest = entry.sizes().zip(largest, |size, largest| if size > largest { size } else { largest });
        }
        exchanges[step] = [step as u32; LANES];
        let pivot = column[step].sizes();
        if (0..LANES).any(|lane| pivot.0[lane] < THRESHOLD * largest.0[lane]) {
            exchanged = true;
            for lane in 0..LANES {
                exchange_rows(matrix, rows, step, lane, &mut exchanges[step]);
            }
        }
        let (left, right) = matrix.split_at_mut((step + 1) * rows);
        let column = &mut left[step * rows..];
        let reciprocal = column[step].reciprocal();
        if !reciprocal.sizes().0.iter().all(|size| size.is_finite() && *size != 0.0) {
            return None;
        }
        column[step] = reciprocal;
        let multipliers = &mut column[step + 1..];
        multipliers.iter_mut().for_each(|multiplier| *multiplier = *multiplier * reciprocal);
        for other in right.chunks_exact_mut(rows).take(first + B - step - 1) {
            let factor = other[step];
            for (entry, multiplier) in other[step + 1..].iter_mut().zip(multipliers.iter()) {
                *entry = entry.minus::<FUSED>(factor, *multiplier);
            }
        }
    }
    let (left, right) = matrix.split_at_mut((first + B) * rows);
    let block = &left[first * rows..];
    let mut pairs = right.chunks_exact_mut(2 * rows);
    for pair in &mut pairs {
        let (one, two) = pair.split_at_mut(rows);
        apply_block::<FUSED, B, 2, E>(block, rows, first, [one, two]);
    }
    for column in pairs.into_remainder().chunks_exact_mut(rows) {
        apply_block::<FUSED, B, 1, E>(block, rows, first, [column]);
    }
    Some(exchanged)
}

/// Brings the largest entry of a column to the diagonal, in one lane.
#[cold]
fn exchange_rows<E: Entry>(matrix: &mut [E], rows: usize, step: usize, lane: usize, exchange: &mut Exchange) {
    let column = &matrix[step * rows..(step + 1) * rows];
    let size = |row: usize| column[row].sizes().0[lane];
    let row = (step + 1..rows).fold(step, |best, row| if size(row) > size(best) { row } else { best });
    exchange[lane] = row as u32;
    if row != step {
        for column in matrix.chunks_exact_mut(rows) {
            exchange_entries(column, row, step, lane);
        }
    }
}

#[inline(always)]
fn exchange_entries<E: Entry>(column: &mut [E], one: usize, other: usize, lane: usize) {
    let (first, second) = (column[one], column[other]);
    column[one].set_lane(lane, second);
    column[other].set_lane(lane, first);
}

/// Applies `B` steps, whose columns of multipliers start at `block`, to some columns.
#[inline(always)]
fn apply_block<const FUSED: bool, const B: usize, const C: usize, E: Entry>(
    block: &[E],
    rows: usize,
    first: usize,
    columns: [&mut [E]; C],
) {
    let mut heads = [[E::ZERO; B]; C];
    let middle = first + B;
    let below: [&[E]; B] = from_fn(|step| &block[step * rows + middle..(step + 1) * rows]);
    let count = rows - middle;
    let mut rest = columns.map(|column| &mut column[first..rows]);
    for (head, column) in heads.iter_mut().zip(&rest) {
        head.copy_from_slice(&column[..B]);
    }
    for step in 0..B {
        for row in step + 1..B {
            let multiplier = block[step * rows + first + row];
            for head in &mut heads {
                head[row] = head[row].minus::<FUSED>(head[step], multiplier);
            }
        }
    }
    for (head, column) in heads.iter().zip(&mut rest) {
        column[..B].copy_from_slice(head);
    }
    let targets = rest.map(|column| &mut column[B..][..count]);
    subtract_products::<FUSED, B, C, E>(below, heads, targets, count);
}

/// `target -= sum_k columns[k] factors[k]` for some targets of `count` entries.
#[inline(always)]
fn subtract_products<const FUSED: bool, const B: usize, const C: usize, E: Entry>(
    columns: [&[E]; B],
    factors: [[E; B]; C],
    mut targets: [&mut [E]; C],
    count: usize,
) {
    let columns = columns.map(|column| &column[..count]);
    for row in 0..count {
        // Not `from_fn`, which is not inlined for complex entries.
        let mut entries = [E::ZERO; B];
        for (entry, column) in entries.iter_mut().zip(&columns) {
            *entry = column[row];
        }
        for (target, factors) in targets.iter_mut().zip(&factors) {
            let mut entry = target[row];
            for step in 0..B {
                entry = entry.minus::<FUSED>(factors[step], entries[step]);
            }
            target[row] = entry;
        }
    }
}

/// Solves with the upper triangles.
#[inline(always)]
fn substitute_back<const FUSED: bool, const C: usize, E: Entry>(
    factors: &[E],
    rows: usize,
    mut columns: [&mut [E]; C],
) {
    let full = rows - rows % BLOCK;
    match rows % BLOCK {
        1 => substitute_block::<FUSED, 1, C, E>(factors, rows, full, &mut columns),
        2 => substitute_block::<FUSED, 2, C, E>(factors, rows, full, &mut columns),
        3 => substitute_block::<FUSED, 3, C, E>(factors, rows, full, &mut columns),
        _ => {}
    }
    for first in (0..full).step_by(BLOCK).rev() {
        substitute_block::<FUSED, BLOCK, C, E>(factors, rows, first, &mut columns);
    }
}

/// Solves for `B` entries and takes them out of those above.
#[inline(always)]
fn substitute_block<const FUSED: bool, const B: usize, const C: usize, E: Entry>(
    factors: &[E],
    rows: usize,
    first: usize,
    columns: &mut [&mut [E]; C],
) {
    let upper: [&[E]; B] = from_fn(|step| &factors[(first + step) * rows..][..first + B]);
    let mut heads = [[E::ZERO; B]; C];
    for (head, column) in heads.iter_mut().zip(columns.iter_mut()) {
        head.copy_from_slice(&column[first..first + B]);
        for step in (0..B).rev() {
            head[step] = head[step] * upper[step][first + step];
            for row in 0..step {
                head[row] = head[row].minus::<FUSED>(head[step], upper[step][first + row]);
            }
        }
        column[first..first + B].copy_from_slice(head);
    }
    let targets: [&mut [E]; C] = columns.each_mut().map(|column| &mut column[..first]);
    subtract_products::<FUSED, B, C, E>(upper, heads, targets, first);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solves_random_systems(rows in 1usize..14, extra in 1usize..4, seed in prop::collection::vec(-1.0..1.0f64, 1000)) {
            // Lanes: dominant diagonal, cyclically dominant (every row is exchanged), random, random with a zero diagonal.
            let mut numbers = seed.iter().cycle();
            let mut next = || *numbers.next().expect("a cycle");
            let mut matrix = vec![Lanes::ZERO; rows * (rows + extra + 1)];
            let mut truth = vec![Lanes::ZERO; rows * (extra + 1)];
            truth.iter_mut().for_each(|entry| *entry = Lanes::from(from_fn(|_| next())));
            for column in 0..rows {
                for row in 0..rows {
                    let entry = &mut matrix[row + rows * column];
                    *entry = Lanes::from(from_fn(|_| next()));
                    entry.0[0] += if row == column { 4.0 * rows as f64 } else { 0.0 };
                    entry.0[1] += if row == (column + 1) % rows { 4.0 * rows as f64 } else { 0.0 };
                    entry.0[3] = if row == column && rows > 1 { 0.0 } else { entry.0[3] };
                }
            }
            for right in 0..=extra {
                for row in 0..rows {
                    let sum: [f64; LANES] = from_fn(|lane| {
                        (0..rows).map(|column| matrix[row + rows * column].0[lane] * truth[column + rows * right].0[lane]).sum()
                    });
                    matrix[row + rows * (rows + right)] = Lanes::from(sum);
                }
            }
            let mut later = matrix[rows * (rows + extra)..].to_vec();
            let mut dense = matrix.clone();
            let mut exchanges = vec![[0; LANES]; rows];
            let exchanged = factorize_and_solve::<false, Lanes>(&mut matrix[..rows * (rows + extra)], rows, &mut exchanges);
            prop_assert!(exchanged.is_some());
            solve::<false, Lanes>(&matrix[..rows * rows], rows, Some(&exchanges), &mut later);
            for lane in 0..LANES {
                // As accurate as partial pivoting, up to the growth allowed.
                let (square, right) = dense.split_at_mut(rows * rows);
                let mut square: Vec<f64> = square.iter().map(|entry| entry.0[lane]).collect();
                let mut right: Vec<f64> = right.iter().map(|entry| entry.0[lane]).collect();
                let mut pivots = vec![0; rows];
                crate::linear::lu::factorize(&mut square, rows, &mut pivots);
                crate::linear::lu::solve(&square, rows, &pivots, &mut right);
                let computed = matrix[rows * rows..rows * (rows + extra)].iter().chain(&later);
                let error = |values: &mut dyn Iterator<Item = f64>| {
                    values.zip(&truth).map(|(value, exact)| (value - exact.0[lane]).abs()).fold(0.0, f64::max)
                };
                let by_partial_pivoting = error(&mut right.iter().copied());
                let here = error(&mut computed.map(|entry| entry.0[lane]));
                prop_assert!(here <= 1e3 * by_partial_pivoting.max(1e-14), "lane {lane}: {here} {by_partial_pivoting}");
            }
        }
    }

    #[test]
    fn singular_matrices_and_those_that_are_not_finite_are_told() {
        let mut exchanges = [[0; LANES]; 2];
        let mut factorize = |lane: [f64; 4]| {
            let mut matrix: Vec<Lanes> =
                [1.0, 0.0, 0.0, 1.0, 1.0, 1.0].map(|entry| Lanes::from([entry; LANES])).to_vec();
            matrix.iter_mut().zip(lane).for_each(|(entry, number)| entry.0[2] = number);
            factorize_and_solve::<false, Lanes>(&mut matrix, 2, &mut exchanges)
        };
        assert_eq!(factorize([1.0, 0.0, 0.0, 1.0]), Some(false));
        assert_eq!(factorize([0.0, 1.0, 1.0, 0.0]), Some(true));
        assert_eq!(factorize([1.0, 2.0, 2.0, 4.0]), None);
        assert_eq!(factorize([f64::NAN; 4]), None);
        assert_eq!(factorize([1.0, f64::INFINITY, 0.0, 1.0]), None);
    }
}
