//! Partition of an interval into pieces on each of which a smooth function has at most one zero.
//!
//! The function is interpolated at Chebyshev points; where the coefficients have not decayed the
//! interval is halved (Battles and Trefethen, SIAM J. Sci. Comput. 25, 2004). The interpolant is then
//! divided until on each piece bounds on its derivatives exclude a zero or a turning point. So
//! two zeros that are close together are told apart however many of them lie in the interval.

/// Degree of the interpolant.
const DEGREE: usize = 16;
/// An interpolant is taken for the function when its last coefficients are this small beside the largest.
const RESOLUTION: f64 = 1e-10;
/// Number of trailing coefficients that must be small.
const TAIL: usize = 3;
/// Trailing coefficients this small beside the largest that do not fall when an interval is halved are noise: the
/// function is not known better.
const LARGEST_NOISE: f64 = 1e-4;
/// Factor by which halving must reduce what is no noise; a smooth function that is nearly resolved gives 1e-4.
const NOISE_RATIO: f64 = 0.1;
/// Points between the nodes where the interpolant is compared with the function.
const PROBES: [f64; 2] = [-0.535_898_384_862_245, 0.267_949_192_431_123];
/// Tolerance at the probes, relative to the largest coefficient.
const PROBE_TOLERANCE: f64 = 1e-8;
/// Halvings after which a function that is still not resolved (it is not smooth) is taken as it is sampled.
const DEEPEST_HALVING: u32 = 10;
/// Width, relative to the interval of an interpolant, below which a piece with a turning point is not divided.
const NARROWEST_PIECE: f64 = 1e-9;

/// Chebyshev points and the matrix that turns values there into coefficients.
#[derive(Clone, Debug)]
pub(super) struct ChebyshevPartition {
    nodes: [f64; DEGREE + 1],
    matrix: [[f64; DEGREE + 1]; DEGREE + 1],
    /// Intervals to visit, with the size of the trailing coefficients on the interval of which each is a half.
    pieces: Vec<(f64, f64, f64)>,
}

impl ChebyshevPartition {
    pub(super) fn new() -> Self {
        let angle = |k: usize| std::f64::consts::PI * k as f64 / DEGREE as f64;
        let halved_at_ends = |k: usize| if k == 0 || k == DEGREE { 0.5 } else { 1.0 };
        let nodes = std::array::from_fn(|k| -angle(k).cos());
        let matrix = std::array::from_fn(|order| {
            std::array::from_fn(|k| {
                let value = (order as f64 * (std::f64::consts::PI - angle(k))).cos();
                2.0 / DEGREE as f64 * halved_at_ends(order) * halved_at_ends(k) * value
            })
        });
        Self { nodes, matrix, pieces: Vec::with_capacity(2 * DEEPEST_HALVING as usize) }
    }

    /// Calls `visit` with increasing fractions in (0, 1], the ends of pieces on each of which `function` of
    /// the fraction has at most one zero, until `visit` returns false.
    ///
    /// Pieces without a zero are not divided, so the fractions are few for most functions.
    pub(super) fn visit_pieces(
        &mut self,
        mut function: impl FnMut(f64) -> f64,
        mut visit: impl FnMut(f64, f64) -> bool,
    ) {
        self.pieces.clear();
        self.pieces.push((0.0, 1.0, f64::INFINITY));
        while let Some((left, right, tail_before)) = self.pieces.pop() {
            let half = 0.5 * (right - left);
            let fraction = |x: f64| left + (x + 1.0) * half;
            let mut values = self.nodes;
            for value in &mut values {
                *value = function(fraction(*value));
            }
            let mut coefficients = [0.0; DEGREE + 1];
            for (coefficient, row) in coefficients.iter_mut().zip(&self.matrix) {
                *coefficient = row.iter().zip(&values).map(|(a, b)| a * b).sum();
            }
            let largest = coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
            let tail =
                coefficients[DEGREE + 1 - TAIL..].iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
            let is_noise = tail <= LARGEST_NOISE * largest && tail > NOISE_RATIO * tail_before;
            let resolved = is_noise
                || tail <= RESOLUTION * largest
                    && PROBES.iter().all(|&x| {
                        (evaluate(&coefficients, x) - function(fraction(x))).abs()
                            <= PROBE_TOLERANCE * largest
                    });
            if resolved {
                let keep_on = visit_pieces_of(&coefficients, -1.0, 1.0, &mut |x| {
                    visit(fraction(x), function(fraction(x)))
                });
                if !keep_on {
                    return;
                }
            } else if half > 0.5f64.powi(DEEPEST_HALVING as i32 + 1) {
                self.pieces.push((left + half, right, tail));
                self.pieces.push((left, left + half, tail));
            } else {
                for (x, value) in self.nodes.iter().zip(&values).skip(1) {
                    if !visit(fraction(*x), *value) {
                        return;
                    }
                }
            }
        }
    }
}

/// Divides [left, right] until each piece has no zero or no turning point; false if `visit` asked to stop.
fn visit_pieces_of(
    coefficients: &[f64; DEGREE + 1],
    left: f64,
    right: f64,
    visit: &mut impl FnMut(f64) -> bool,
) -> bool {
    let middle = 0.5 * (left + right);
    let half = 0.5 * (right - left);
    let Taylor { value, slope, bend } = expansion(coefficients, middle);
    // Taylor's theorem about the middle with bounds on the next derivative.
    let bounds = derivative_bounds(coefficients);
    let no_zero = value.abs() >= slope.abs() * half + bounds[0] * half * half / 2.0;
    let no_turning_point = slope.abs() >= bend.abs() * half + bounds[1] * half * half / 2.0;
    if no_zero || no_turning_point || half < NARROWEST_PIECE {
        return visit(right);
    }
    visit_pieces_of(coefficients, left, middle, visit) && visit_pieces_of(coefficients, middle, right, visit)
}

/// Upper bounds of the second and the third derivative on [-1, 1].
fn derivative_bounds(coefficients: &[f64; DEGREE + 1]) -> [f64; 2] {
    let mut bounds = [0.0; 2];
    for (order, coefficient) in coefficients.iter().enumerate() {
        let square = (order * order) as f64;
        let second = coefficient.abs() * square * (square - 1.0).max(0.0) / 3.0;
        bounds[0] += second;
        bounds[1] += second * (square - 4.0).max(0.0) / 5.0;
    }
    bounds
}

/// Value of the interpolant (Clenshaw).
fn evaluate(coefficients: &[f64; DEGREE + 1], x: f64) -> f64 {
    expansion(coefficients, x).value
}

/// A value with its first and second derivative.
#[derive(Clone, Copy)]
struct Taylor {
    value: f64,
    slope: f64,
    bend: f64,
}

/// The interpolant at `x`.
fn expansion(coefficients: &[f64; DEGREE + 1], x: f64) -> Taylor {
    // Recurrences of T_k and of its derivatives.
    let mut polynomials =
        [Taylor { value: 1.0, slope: 0.0, bend: 0.0 }, Taylor { value: x, slope: 1.0, bend: 0.0 }];
    let mut sum = Taylor { value: coefficients[0] + coefficients[1] * x, slope: coefficients[1], bend: 0.0 };
    for &coefficient in &coefficients[2..] {
        let [before, last] = polynomials;
        let next = Taylor {
            value: 2.0 * x * last.value - before.value,
            slope: 2.0 * (last.value + x * last.slope) - before.slope,
            bend: 2.0 * (2.0 * last.slope + x * last.bend) - before.bend,
        };
        sum.value += coefficient * next.value;
        sum.slope += coefficient * next.slope;
        sum.bend += coefficient * next.bend;
        polynomials = [last, next];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count_sign_changes(function: impl Fn(f64) -> f64) -> usize {
        let mut last = function(0.0);
        let mut changes = 0;
        ChebyshevPartition::new().visit_pieces(&function, |_, value| {
            if last * value < 0.0 {
                changes += 1;
            }
            if value != 0.0 {
                last = value;
            }
            true
        });
        changes
    }

    #[test]
    fn a_pair_of_zeros_close_together_is_found() {
        for gap in [1e-1, 1e-2, 1e-3, 1e-4] {
            assert_eq!(count_sign_changes(|x| (x - 0.337_f64).powi(2) - gap * gap), 2, "{gap}");
        }
    }

    #[test]
    fn all_zeros_of_a_fast_function_are_found() {
        for count in [1, 10, 37, 200] {
            let found = count_sign_changes(|x| (std::f64::consts::PI * (f64::from(count) * x + 0.25)).sin());
            assert_eq!(found, count as usize);
        }
    }

    #[test]
    fn noise_is_not_resolved_further() {
        let mut evaluations = 0;
        let noisy = |x: f64| {
            evaluations += 1;
            let noise = (x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1u64 << 53) as f64;
            x - 0.37 + 1e-7 * noise
        };
        ChebyshevPartition::new().visit_pieces(noisy, |_, _| true);
        assert!(evaluations < 300, "{evaluations}");
    }

    #[test]
    fn a_kink_is_sampled() {
        assert_eq!(count_sign_changes(|x| (x - 0.437_f64).abs() - 0.01), 2);
    }

    #[test]
    fn a_touching_zero_is_no_change_of_sign() {
        assert_eq!(count_sign_changes(|x| (x - 0.337_f64).powi(2)), 0);
    }
}
