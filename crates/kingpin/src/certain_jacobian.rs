//! The Jacobian at a uniform motion with bounds on its errors, those of the motion included.

use crate::bounded::Bounded;
use crate::uniform_motion::solve;

/// The error of a state is that of a step of Newton's method times this, since the Jacobian has errors too.
const STEP_SAFETY: f64 = 2.0;

/// The Jacobian at an equilibrium that is known up to rounding; `None` where it is singular.
pub(crate) fn certain_jacobian<const N: usize>(
    state: [f64; N],
    linearise: impl Fn(&[Bounded; N]) -> ([Bounded; N], [[Bounded; N]; N]),
) -> Option<[[Bounded; N]; N]> {
    let (residual, jacobian) = linearise(&state.map(Bounded::from));
    let values = jacobian.map(|row| row.map(|entry| entry.value));
    let mut errors = [0.0; N];
    for (component, residual) in residual.iter().enumerate() {
        let mut unit = [0.0; N];
        unit[component] = residual.value.abs() + residual.error;
        for (error, step) in errors.iter_mut().zip(solve(values, unit)?) {
            *error += STEP_SAFETY * step.abs();
        }
    }
    let known = std::array::from_fn(|index| Bounded { value: state[index], error: errors[index] });
    Some(linearise(&known).1)
}
