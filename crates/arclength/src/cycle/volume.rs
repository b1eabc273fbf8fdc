//! What a period makes of a volume of the state space, by Liouville's formula: the product of all multipliers.

use crate::collocation::condensation::Jump;
use crate::linear::lu;

/// A pivot of a jump below this part of the largest one is zero but for rounding: the jump takes a direction to nothing.
const SINGULAR: f64 = 1e-12;

/// The factor by which a period multiplies volumes.
pub(super) struct Volume {
    /// Logarithm of its modulus; minus infinity where a jump takes a direction to nothing.
    pub logarithm: f64,
    pub sign: f64,
    /// Number of directions that jumps take to nothing.
    pub lost: usize,
}

impl Volume {
    /// From the integral of the divergence and the jumps.
    pub(super) fn of(divergence: f64, jumps: &[Jump], scales: &[f64]) -> Self {
        let n = scales.len();
        let mut volume = Self { logarithm: divergence, sign: 1.0, lost: 0 };
        for jump in jumps {
            let (logarithm, sign) = determinant(&jump.derivatives[..n * n], n);
            volume.logarithm += logarithm;
            volume.sign *= sign;
            volume.lost = volume.lost.max(nullity(&jump.derivatives[..n * n], scales));
        }
        if volume.lost > 0 { Self { logarithm: f64::NEG_INFINITY, sign: 1.0, ..volume } } else { volume }
    }
}

/// Logarithm of the modulus of the determinant of a jump, and its sign; minus infinity where it is singular.
fn determinant(matrix: &[f64], n: usize) -> (f64, f64) {
    let mut factors = matrix.to_vec();
    let mut pivots = vec![0; n];
    let sign = lu::factorize(&mut factors, n, &mut pivots);
    if sign == 0.0 {
        return (f64::NEG_INFINITY, 1.0);
    }
    ((0..n).map(|index| factors[index * (n + 1)].abs().ln()).sum(), sign)
}

/// Number of independent directions that a jump takes to nothing, in units of the sizes of the states: by elimination with the
/// largest pivots.
fn nullity(matrix: &[f64], scales: &[f64]) -> usize {
    let n = scales.len();
    let scaled = |index: usize| matrix[index] * scales[index / n] / scales[index % n];
    let mut rest: Vec<f64> = (0..n * n).map(scaled).collect();
    let mut first = 0.0;
    for step in 0..n {
        let places = (step..n).flat_map(|column| (step..n).map(move |row| (row, column)));
        let largest = places.max_by(|a, b| rest[a.0 + n * a.1].abs().total_cmp(&rest[b.0 + n * b.1].abs()));
        let Some((row, column)) = largest else { break };
        let pivot = rest[row + n * column];
        first = if step == 0 { pivot.abs() } else { first };
        if pivot.abs() <= SINGULAR * first {
            return n - step;
        }
        (0..n).for_each(|other| rest.swap(step + n * other, row + n * other));
        (0..n).for_each(|other| rest.swap(other + n * step, other + n * column));
        for below in step + 1..n {
            let factor = rest[below + n * step] / pivot;
            for other in step..n {
                rest[below + n * other] -= factor * rest[step + n * other];
            }
        }
    }
    0
}
