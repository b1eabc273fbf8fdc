//! The manifolds of a saddle, on which motions approach or leave it: curves, followed as motions that start next to it.

use super::equilibria::{PlaneEquilibrium, eigenvalues};
use super::plane_field::PlaneField;
use arclength::integration::{Integrator, Method, Stepper, from_rates};
use serde::{Deserialize, Serialize};

/// How far from the saddle a curve starts, in parts of the window; the curve bends away from its tangent by the square of it.
const START: f64 = 1e-4;
/// How far beyond the window a curve is followed.
const MARGIN: f64 = 0.5;
/// Its largest length, in windows.
const LONGEST: f64 = 20.0;
/// A curve that comes this close to an equilibrium ends there.
const AT_EQUILIBRIUM: f64 = 1e-3;
/// Points of a curve are at least this far from each other.
const SPACING: f64 = 2e-3;
/// Points of a step.
const POINTS: usize = 24;
const TOLERANCE: f64 = 1e-9;
const MOST_STEPS: usize = 5000;
/// Times of the slowest rate for which a curve is followed.
const LONGEST_TIME: f64 = 1e4;

/// One side of a manifold of a saddle.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Manifold {
    /// Whether motions on it approach the saddle.
    pub stable: bool,
    /// Its points, from the saddle on.
    pub points: Vec<[f64; 2]>,
}

/// Both sides of both manifolds of a saddle.
pub(super) fn of(
    field: &PlaneField<'_>,
    saddle: &PlaneEquilibrium,
    equilibria: Option<&[PlaneEquilibrium]>,
) -> Vec<Manifold> {
    let matrix = field.jacobian(saddle.place);
    let rates = eigenvalues(matrix).map(|value| value.re);
    let others: Vec<[f64; 2]> = equilibria
        .unwrap_or_default()
        .iter()
        .map(|found| found.place)
        .filter(|place| *place != saddle.place)
        .collect();
    let mut curves = Vec::new();
    for rate in rates {
        let direction = eigenvector(matrix, rate);
        for side in [1.0, -1.0] {
            let start = [0, 1].map(|axis| saddle.place[axis] + side * START * direction[axis]);
            let mut places = vec![saddle.place];
            follow(field, rate, start, &others, &mut places);
            let points = places.into_iter().map(|place| field.point(place)).collect();
            curves.push(Manifold { stable: rate < 0.0, points });
        }
    }
    curves
}

/// The unit vector that the matrix only stretches, by `rate`.
fn eigenvector([[a, b], [c, d]]: [[f64; 2]; 2], rate: f64) -> [f64; 2] {
    // Of the two rows that say so the longer one is the more exact.
    let (one, two) = ([b, rate - a], [rate - d, c]);
    let length = |[x, y]: [f64; 2]| x.hypot(y);
    let vector = if length(one) >= length(two) { one } else { two };
    let length = length(vector);
    vector.map(|entry| entry / length)
}

/// Adds the motion from a start, backwards in time where the rate is negative. Where it cannot be followed on the curve ends.
fn follow(
    field: &PlaneField<'_>,
    rate: f64,
    start: [f64; 2],
    others: &[[f64; 2]],
    places: &mut Vec<[f64; 2]>,
) {
    let sense = rate.signum();
    let system = || {
        from_rates(2, move |place: &[f64], slope: &mut [f64]| {
            let velocity = field.velocity([place[0], place[1]]);
            slope.iter_mut().zip(velocity).for_each(|(slope, velocity)| *slope = sense * velocity);
        })
    };
    let integrator =
        Integrator::with_tolerance(TOLERANCE).maximum_steps(MOST_STEPS).method(Method::Automatic);
    let Ok(mut stepper) = Stepper::new(system(), &integrator, 0.0, &start, LONGEST_TIME / rate.abs()) else {
        return;
    };
    let mut length = 0.0;
    let mut last = start;
    places.push(start);
    while !stepper.is_finished() && stepper.advance().is_ok() {
        stepper.prepare_dense_output();
        let (from, to) = (stepper.previous_time(), stepper.time());
        for index in 1..=POINTS {
            let mut place = [0.0; 2];
            stepper.interpolate(from + (to - from) * index as f64 / POINTS as f64, &mut place);
            let distance = (place[0] - last[0]).hypot(place[1] - last[1]);
            let outside = place.iter().any(|value| !(-MARGIN..=1.0 + MARGIN).contains(value));
            if distance >= SPACING || outside {
                length += distance;
                last = place;
                places.push(place);
            }
            if outside || length > LONGEST {
                return;
            }
        }
        let is_near =
            |other: &&[f64; 2]| (other[0] - last[0]).hypot(other[1] - last[1]) < AT_EQUILIBRIUM.max(SPACING);
        if let Some(other) = others.iter().find(is_near) {
            places.push(*other);
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_only_stretched() {
        for matrix in [[[0.0, 1.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, -2.0]], [[1.0, 1e6], [0.0, -1.0]]] {
            for rate in eigenvalues(matrix).map(|value| value.re) {
                let [x, y] = eigenvector(matrix, rate);
                let image = matrix.map(|[a, b]| a * x + b * y);
                let off = (image[0] - rate * x).hypot(image[1] - rate * y);
                assert!(off < 1e-9 * 1e6, "{matrix:?} {rate}: {off}");
            }
        }
    }
}
