//! The extremum of the damping along a curve of folds: where the isola shrinks to a point.

use crate::error::Error;
use crate::parabola::vertex;
use arclength::branch::SpecialKind;
use arclength::locus::{CycleLocus, CycleLocusBranch, CycleLocusPoint};
use kingpin::LateralWheel;

/// Half the width of the window in which the curve is interpolated, relative to the speed.
const WINDOW: f64 = 0.05;
/// Nodes of the interpolation.
const NODES: usize = 7;
/// Newton's method for the extremum of the polynomial stops below this step, relative to the window.
const TOLERANCE: f64 = 1e-9;
const NEWTON_STEPS: usize = 50;

/// The fold with the largest damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::studies) struct Extremum {
    pub speed: f64,
    pub damping: f64,
    pub period: f64,
    /// Largest caster angle.
    pub angle: f64,
}

/// The largest damping on the curve: from the largest computed point, folds at exact speeds around it, and the
/// maximum of the polynomial through them.
pub(super) fn largest_damping(field: &LateralWheel, folds: &CycleLocusBranch) -> Result<Extremum, Error> {
    let ends: Vec<String> = folds.stops.iter().flatten().map(ToString::to_string).collect();
    let missing = || {
        Error::not_found(
            "largest damping",
            &format!("the curve of folds, which ends because: {}", ends.join("; ")),
        )
    };
    let highest = (1..folds.points.len().saturating_sub(1))
        .max_by(|&a, &b| folds.points[a].values[1].total_cmp(&folds.points[b].values[1]))
        .ok_or_else(missing)?;
    // The vertex of the parabola through three points is the middle of the window.
    let near = [highest - 1, highest, highest + 1].map(|index| folds.points[index].values);
    let start = &folds.points[highest];
    let middle = vertex(near).ok_or_else(missing)?;
    let half = (WINDOW * middle).max(1.5 * (middle - start.values[0]).abs());
    let nodes: Vec<f64> =
        (0..NODES).map(|index| 0.9 * half * (2.0 * index as f64 / (NODES - 1) as f64 - 1.0)).collect();
    let wanted: Vec<f64> = nodes.iter().map(|node| middle + node).collect();
    let window = CycleLocus::of(field)
        .from_cycle(SpecialKind::FoldOfCycles, &start.orbit, &start.values)
        .along("v", middle - half..=middle + half)
        .and("c_q", 0.5 * start.values[1]..=2.0 * start.values[1])
        .at(&wanted)
        .run()?;
    let at = |speed: f64| window.points.iter().find(|point| point.values[0] == speed).ok_or_else(missing);
    let points = wanted.iter().map(|&speed| at(speed)).collect::<Result<Vec<&CycleLocusPoint>, _>>()?;
    let scaled: Vec<f64> = nodes.iter().map(|node| node / half).collect();
    let polynomial = |value: fn(&CycleLocusPoint) -> f64| {
        let values: Vec<f64> = points.iter().map(|point| value(point)).collect();
        Polynomial::through(&scaled, &values)
    };
    let damping = polynomial(|point| point.values[1]);
    let mut place = 0.0;
    for _ in 0..NEWTON_STEPS {
        let [_, slope, curvature] = damping.at(place);
        let step = slope / curvature;
        place -= step;
        if step.abs() < TOLERANCE {
            return Ok(Extremum {
                speed: middle + half * place,
                damping: damping.at(place)[0],
                period: polynomial(|point| point.period).at(place)[0],
                angle: polynomial(|point| point.max[1]).at(place)[0],
            });
        }
    }
    Err(missing())
}

/// An interpolating polynomial in Newton's form.
struct Polynomial {
    nodes: Vec<f64>,
    coefficients: Vec<f64>,
}

impl Polynomial {
    fn through(nodes: &[f64], values: &[f64]) -> Self {
        let mut coefficients = values.to_vec();
        for order in 1..nodes.len() {
            for index in (order..nodes.len()).rev() {
                coefficients[index] =
                    (coefficients[index] - coefficients[index - 1]) / (nodes[index] - nodes[index - order]);
            }
        }
        Self { nodes: nodes.to_vec(), coefficients }
    }

    /// Value, first and second derivative.
    fn at(&self, x: f64) -> [f64; 3] {
        let mut value = [0.0; 3];
        for (node, coefficient) in self.nodes.iter().zip(&self.coefficients).rev() {
            let factor = x - node;
            value = [
                value[0] * factor + coefficient,
                value[1] * factor + value[0],
                value[2] * factor + 2.0 * value[1],
            ];
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_interpolated_with_their_derivatives() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x.powi(3);
        let nodes = [-1.0, -0.3, 0.4, 1.0];
        let polynomial = Polynomial::through(&nodes, &nodes.map(cubic));
        let [value, slope, curvature] = polynomial.at(0.7);
        assert!((value - cubic(0.7)).abs() < 1e-14);
        assert!((slope - (-2.0 + 1.5 * 0.49)).abs() < 1e-13);
        assert!((curvature - 2.1).abs() < 1e-12);
    }
}
