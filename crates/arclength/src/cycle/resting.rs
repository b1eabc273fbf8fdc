//! Motions that come to rest: whoever starts cycles from one of them is told so, and not of a cycle elsewhere.

use crate::algebraic::Differentiator;
use crate::equilibrium::newton::find_erased;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::field::VectorField;
use crate::integration::{Integrator, Method, autonomous};
use crate::linear::eigenvalues::eigenvalues;

/// Times in which the slowest motion about the equilibrium falls to `1/e`, for which a motion is followed.
const FOLDINGS: f64 = 12.0;
/// It rests where its distance from the equilibrium has fallen to this part of what it was: a hundred times more than it has to.
const RESTED: f64 = 1e-3;
/// Times as long as the motion was followed already it is followed at most.
const LONGEST: f64 = 100.0;
/// Part of the size of the equilibrium within which a motion is there.
const THERE: f64 = 1e-9;
/// Tolerance of the integration.
const TOLERANCE: f64 = 1e-8;

/// The stable equilibrium at which a motion from a state comes to rest; `None` where it does not, or where that takes so long, beside the
/// time for which it was followed, that it is not known.
pub(super) fn rests_at<F: VectorField>(
    field: &F,
    parameters: &[f64],
    initial: &[f64],
    duration: f64,
) -> Option<Vec<f64>> {
    let equilibrium = find_erased(field.erased(), initial, parameters).ok()?;
    let slowest = largest_growth_rate(field, parameters, &equilibrium)?;
    let norm = |vector: &mut dyn Iterator<Item = f64>| vector.map(|x| x * x).sum::<f64>().sqrt();
    let distance = |state: &[f64]| norm(&mut state.iter().zip(&equilibrium).map(|(x, rest)| x - rest));
    let start = distance(initial);
    if slowest >= 0.0 {
        return None;
    }
    if start <= THERE * norm(&mut equilibrium.iter().copied()) {
        return Some(equilibrium);
    }
    let time = FOLDINGS / -slowest;
    if time > LONGEST * duration {
        return None;
    }
    // Errors count beside how far it is from there.
    let integrator = Integrator::with_tolerance(TOLERANCE)
        .absolute_tolerance(TOLERANCE * RESTED * start)
        .method(Method::Automatic);
    let samples = integrator.sample(autonomous(field, parameters), initial, &[0.0, time]).ok()?;
    let (_, end) = samples.samples().last()?;
    (distance(end) < RESTED * start).then_some(equilibrium)
}

/// The largest real part of the eigenvalues of an equilibrium.
fn largest_growth_rate<F: VectorField>(field: &F, parameters: &[f64], equilibrium: &[f64]) -> Option<f64> {
    let n = equilibrium.len();
    let problem = EquilibriumProblem::new(field.erased(), parameters, &[]);
    let (mut value, mut jacobian) = (vec![0.0; n], vec![0.0; n * n]);
    Differentiator::default().jacobian(&problem, equilibrium, &mut value, &mut jacobian, n);
    let eigenvalues = eigenvalues(&jacobian, n).ok()?;
    eigenvalues.iter().map(|eigenvalue| eigenvalue.re).max_by(f64::total_cmp)
}
