//! Nonlinear least squares with bounds, by the method of Levenberg and Marquardt.
//!
//! Columns of the Jacobian are scaled by the largest norms that they have had (Moré, *The Levenberg-Marquardt algorithm*, Lecture Notes
//! in Mathematics 630, 1978), and the damping follows the gain of each step (Nielsen, *Damping parameter in Marquardt's method*, IMM-REP-1999-05).
//! Unknowns at a bound that would leave it are held, and steps are cut at the bounds.
//!
//! It is written here since the crates that have it (levenberg-marquardt, argmin) know no bounds, and the first of them with nalgebra
//! takes 24 s of a processor to compile.

use super::singular_values::{SingularValues, dot};
use arclength::control::{Control, Interrupted};

/// Damping at the start, as a part of the largest squared singular value.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping from which on no step is worth trying.
const MOST_DAMPING: f64 = 1e16;
/// Cosine of the angle between residuals and columns from which on they are orthogonal.
const ORTHOGONAL: f64 = 1e-11;
/// A relative change of the unknowns that is rounding.
const NO_CHANGE: f64 = 1e-14;

/// A vector of residuals.
pub(super) trait Residuals: Sync {
    /// Why residuals cannot be computed.
    type Error: From<Interrupted>;

    /// The residuals at these unknowns.
    fn residuals(&self, unknowns: &[f64], control: &Control<'_>) -> Result<Vec<f64>, Self::Error>;

    /// Their derivatives, one column for each unknown.
    fn jacobian(&self, unknowns: &[f64], control: &Control<'_>) -> Result<Vec<Vec<f64>>, Self::Error>;
}

/// What the unknowns may be, and how long they are sought.
#[derive(Clone, Debug)]
pub(super) struct Limits<'a> {
    /// Smallest and largest value of each unknown; where they are equal the unknown is held.
    pub bounds: &'a [[f64; 2]],
    /// Most steps.
    pub steps: usize,
    /// A relative reduction of the sum of squares that is not worth a step.
    pub tolerance: f64,
}

/// Where the sum of squares is smallest.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub unknowns: Vec<f64>,
    pub residuals: Vec<f64>,
    pub jacobian: Vec<Vec<f64>>,
    /// Whether it is one; otherwise the steps were used up.
    pub converged: bool,
}

impl Minimum {
    /// The sum of squares.
    pub(super) fn sum_of_squares(&self) -> f64 {
        dot(&self.residuals, &self.residuals)
    }

    /// Unknowns that are not held by a bound.
    pub(super) fn free(&self, bounds: &[[f64; 2]]) -> Vec<usize> {
        let is_free = |&index: &usize| {
            let ([low, high], value) = (bounds[index], self.unknowns[index]);
            // Half the slope of the sum of squares.
            let slope = dot(&self.jacobian[index], &self.residuals);
            low < high && !(value <= low && slope >= 0.0) && !(value >= high && slope <= 0.0)
        };
        (0..self.unknowns.len()).filter(is_free).collect()
    }
}

/// Seeks the smallest sum of squares from a start. A step to where residuals cannot be computed is not taken.
///
/// # Errors
/// Residuals that cannot be computed at the start; an interruption.
pub(super) fn minimise<R: Residuals>(
    problem: &R,
    start: &[f64],
    limits: &Limits<'_>,
    control: &Control<'_>,
) -> Result<Minimum, R::Error> {
    let bounds = limits.bounds;
    let unknowns: Vec<f64> =
        start.iter().zip(bounds).map(|(value, [low, high])| value.clamp(*low, *high)).collect();
    let residuals = problem.residuals(&unknowns, control)?;
    let jacobian = problem.jacobian(&unknowns, control)?;
    let mut best = Minimum { unknowns, residuals, jacobian, converged: false };
    let mut scales = vec![0.0_f64; start.len()];
    let mut damping = None;
    let mut growth = 2.0;
    for _ in 0..limits.steps {
        control.check()?;
        for (scale, column) in scales.iter_mut().zip(&best.jacobian) {
            *scale = scale.max(dot(column, column).sqrt());
        }
        let free: Vec<usize> = best.free(bounds).into_iter().filter(|&index| scales[index] > 0.0).collect();
        let size = best.sum_of_squares().sqrt();
        let cosine = |&index: &usize| {
            let column = &best.jacobian[index];
            dot(column, &best.residuals).abs() / (size * dot(column, column).sqrt()).max(f64::MIN_POSITIVE)
        };
        if size == 0.0 || free.iter().map(cosine).fold(0.0, f64::max) < ORTHOGONAL {
            best.converged = true;
            return Ok(best);
        }
        let scaled = free
            .iter()
            .map(|&index| best.jacobian[index].iter().map(|entry| entry / scales[index]).collect());
        let decomposition = SingularValues::of(scaled.collect());
        // A step is sought along which the sum of squares falls.
        loop {
            let strength = *damping.get_or_insert(FIRST_DAMPING * decomposition.largest().powi(2));
            let step = damped_step(&decomposition, &best.residuals, strength);
            let mut unknowns = best.unknowns.clone();
            let mut is_cut = false;
            for (&index, step) in free.iter().zip(&step) {
                let [low, high] = bounds[index];
                let moved = unknowns[index] + step / scales[index];
                unknowns[index] = moved.clamp(low, high);
                is_cut |= unknowns[index] != moved;
            }
            let taken: Vec<f64> =
                free.iter().map(|&index| scales[index] * (unknowns[index] - best.unknowns[index])).collect();
            let predicted = predicted_reduction(&best, &free, &scales, &taken);
            let size_of_unknowns =
                free.iter().map(|&index| (scales[index] * best.unknowns[index]).powi(2)).sum::<f64>();
            let is_rounding = dot(&step, &step).sqrt() <= NO_CHANGE * size_of_unknowns.sqrt();
            if is_rounding
                || strength > MOST_DAMPING
                || (predicted <= limits.tolerance * size * size && !is_cut)
            {
                best.converged = strength <= MOST_DAMPING;
                return Ok(best);
            }
            if predicted <= 0.0 {
                // What is left of a step that was cut may lead uphill; a shorter one turns down the slope.
                damping = Some(strength * growth);
                growth *= 2.0;
                continue;
            }
            let trial = match problem.residuals(&unknowns, control) {
                Ok(residuals) => Some(residuals),
                Err(_) => {
                    control.check()?;
                    None
                }
            };
            let reduction =
                trial.as_ref().map_or(f64::NAN, |residuals| size * size - dot(residuals, residuals));
            if let Some(residuals) = trial.filter(|_| reduction > 0.0)
                && let Ok(jacobian) = problem.jacobian(&unknowns, control)
            {
                let gain = reduction / predicted;
                let factor = (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                damping = Some(strength * factor);
                growth = 2.0;
                best = Minimum { unknowns, residuals, jacobian, converged: false };
                break;
            }
            control.check()?;
            damping = Some(strength * growth);
            growth *= 2.0;
        }
    }
    Ok(best)
}

/// The step of the damped linear problem, in scaled unknowns.
fn damped_step(decomposition: &SingularValues, residuals: &[f64], damping: f64) -> Vec<f64> {
    let mut step = vec![0.0; decomposition.values.len()];
    let directions = decomposition.values.iter().zip(&decomposition.scaled_left).zip(&decomposition.right);
    for ((value, left), right) in directions {
        let length = -dot(left, residuals) / (value * value + damping);
        step.iter_mut().zip(right).for_each(|(step, right)| *step += length * right);
    }
    step
}

/// By how much the sum of squares of the linear problem falls along a step in scaled unknowns.
fn predicted_reduction(best: &Minimum, free: &[usize], scales: &[f64], step: &[f64]) -> f64 {
    let mut changes = vec![0.0; best.residuals.len()];
    for (&index, step) in free.iter().zip(step) {
        for (change, entry) in changes.iter_mut().zip(&best.jacobian[index]) {
            *change += step / scales[index] * entry;
        }
    }
    -2.0 * dot(&changes, &best.residuals) - dot(&changes, &changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals given by functions.
    struct Given<F, D>(F, D);

    impl<F: Fn(&[f64]) -> Vec<f64> + Sync, D: Fn(&[f64]) -> Vec<Vec<f64>> + Sync> Residuals for Given<F, D> {
        type Error = Interrupted;
        fn residuals(&self, x: &[f64], _: &Control<'_>) -> Result<Vec<f64>, Interrupted> {
            Ok(self.0(x))
        }
        fn jacobian(&self, x: &[f64], _: &Control<'_>) -> Result<Vec<Vec<f64>>, Interrupted> {
            Ok(self.1(x))
        }
    }

    const ANYTHING: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn rosenbrock() -> impl Residuals<Error = Interrupted> {
        Given(
            |x: &[f64]| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]],
            |x: &[f64]| vec![vec![-20.0 * x[0], -1.0], vec![10.0, 0.0]],
        )
    }

    #[test]
    fn the_bottom_of_a_curved_valley_is_found() {
        let limits = Limits { bounds: &[ANYTHING; 2], steps: 200, tolerance: 1e-13 };
        let found = minimise(&rosenbrock(), &[-1.2, 1.0], &limits, &Control::none()).unwrap();
        assert!(found.converged);
        assert!(found.unknowns.iter().all(|x| (x - 1.0).abs() < 1e-12), "{:?}", found.unknowns);
    }

    #[test]
    fn a_bound_holds() {
        // On x <= 0.5 the smallest value lies at x = 0.5, y = 0.25.
        let limits = Limits { bounds: &[[-5.0, 0.5], ANYTHING], steps: 200, tolerance: 1e-13 };
        let found = minimise(&rosenbrock(), &[-1.2, 1.0], &limits, &Control::none()).unwrap();
        assert!((found.unknowns[0] - 0.5).abs() < 1e-12 && (found.unknowns[1] - 0.25).abs() < 1e-8);
        assert_eq!(found.free(limits.bounds), [1]);
    }

    #[test]
    fn published_values_of_a_hard_problem_are_found() {
        // NIST StRD, Misra1a: y = b1 (1 - exp(-b2 x)); certified b1 = 238.94212918, b2 = 5.5015643181e-4, sum of squares 0.12455138894.
        let x =
            [77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0];
        let y = [
            10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78,
        ];
        let problem = Given(
            |b: &[f64]| x.iter().zip(y).map(|(x, y)| b[0] * (1.0 - (-b[1] * x).exp()) - y).collect(),
            |b: &[f64]| {
                vec![
                    x.iter().map(|x| 1.0 - (-b[1] * x).exp()).collect(),
                    x.iter().map(|x| b[0] * x * (-b[1] * x).exp()).collect(),
                ]
            },
        );
        let limits = Limits { bounds: &[ANYTHING; 2], steps: 500, tolerance: 1e-13 };
        let found = minimise(&problem, &[500.0, 0.0001], &limits, &Control::none()).unwrap();
        assert!(found.converged);
        assert!((found.unknowns[0] / 238.942_129_18 - 1.0).abs() < 1e-9);
        assert!((found.unknowns[1] / 5.501_564_318_1e-4 - 1.0).abs() < 1e-9);
        assert!((found.sum_of_squares() / 0.124_551_388_94 - 1.0).abs() < 1e-9);
    }
}
