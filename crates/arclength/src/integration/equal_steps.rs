//! Steps of the explicit method of order 8 in any scalar, so that the flow over a short time can be differentiated.

use super::tableau::MATRIX;
use crate::differentiation::Scalar;

/// Row of the tableau that gives the solution.
const SOLUTION: usize = 12;

/// The state a time `duration` after `state`, by some equal steps of the method of Dormand and Prince of order 8; `field` writes the
/// derivative at a state.
pub(crate) fn equal_steps<T: Scalar>(
    mut field: impl FnMut(&[T], &mut [T]),
    state: &[T],
    duration: T,
    count: usize,
) -> Vec<T> {
    let step = duration * (count as f64).recip();
    (0..count).fold(state.to_vec(), |state, _| single_step(&mut field, &state, step))
}

fn single_step<T: Scalar>(mut field: impl FnMut(&[T], &mut [T]), state: &[T], step: T) -> Vec<T> {
    let n = state.len();
    let mut slopes: Vec<Vec<T>> = Vec::with_capacity(SOLUTION);
    for row in &MATRIX[..=SOLUTION] {
        let mut stage = state.to_vec();
        for (index, coefficient) in *row {
            for (entry, slope) in stage.iter_mut().zip(&slopes[*index]) {
                *entry += step * *slope * *coefficient;
            }
        }
        if slopes.len() == SOLUTION {
            return stage;
        }
        let mut slope = vec![T::zero(); n];
        field(&stage, &mut slope);
        slopes.push(slope);
    }
    state.to_vec()
}

#[cfg(test)]
mod tests {
    use super::equal_steps;
    use crate::differentiation::{Dual, Scalar};

    #[test]
    fn a_step_and_its_derivatives_are_those_of_the_flow() {
        // x' = -x^2: x(t) = x / (1 + x t), with derivatives in x and in t.
        let x = Dual::<f64, 2>::variable(0.7, 0);
        let t = Dual::<f64, 2>::variable(0.1, 1);
        let after = equal_steps(|x, slope| slope[0] = -(x[0] * x[0]), &[x], t, 2)[0];
        let exact = x / (x * t + 1.0);
        assert!((after.value - exact.value).abs() < 1e-14);
        for (one, other) in after.derivatives.iter().zip(exact.derivatives) {
            assert!((one - other).abs() < 1e-11);
        }
        assert!(after.is_constant() == exact.is_constant());
    }
}
