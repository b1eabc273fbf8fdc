//! The fold of cycles with the largest damping on a curve of folds: where the last cycle dies, an isola shrinks to a point.

use arclength::locus::CycleLocusPoint;

/// Half the width of the window in which the curve is interpolated, relative to the value there.
const WINDOW: f64 = 0.05;
/// Nodes of the interpolation.
const NODES: usize = 7;
/// Newton's method for the extremum of the polynomial stops below this step, relative to the window.
const TOLERANCE: f64 = 1e-9;
const NEWTON_STEPS: usize = 50;

/// The fold with the largest damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LastFold {
    /// Value of the parameter that is not the damping.
    pub value: f64,
    pub damping: f64,
    pub period: f64,
    /// Largest caster angle.
    pub angle: f64,
}

impl LastFold {
    /// The largest damping inside a curve of folds over `(value, damping)`: from the largest computed point, folds at exact values
    /// around it, and the maximum of the polynomial through them. `folds_at` computes them: it is given the fold to start from, the window and
    /// the values. `angle` is the largest caster angle. Nothing where the damping is largest at an end of the curve, or where folds
    /// are missing.
    ///
    /// # Errors
    /// Those of `folds_at`.
    pub(crate) fn inside<E>(
        folds: &[CycleLocusPoint],
        angle: impl Fn(&CycleLocusPoint) -> f64,
        folds_at: impl FnOnce(&CycleLocusPoint, [f64; 2], &[f64]) -> Result<Vec<CycleLocusPoint>, E>,
    ) -> Result<Option<Self>, E> {
        let damping = |index: usize| folds[index].values[1];
        let inside = 1..folds.len().saturating_sub(1);
        let Some(highest) = inside.max_by(|&a, &b| damping(a).total_cmp(&damping(b))) else {
            return Ok(None);
        };
        if damping(highest - 1).max(damping(highest + 1)) >= damping(highest) {
            return Ok(None);
        }
        // The vertex of the parabola through three points is the middle of the window.
        let Some(middle) = vertex([highest - 1, highest, highest + 1].map(|index| folds[index].values))
        else {
            return Ok(None);
        };
        let start = &folds[highest];
        let half = (WINDOW * middle.abs()).max(1.5 * (middle - start.values[0]).abs());
        let nodes: Vec<f64> =
            (0..NODES).map(|index| 0.9 * half * (2.0 * index as f64 / (NODES - 1) as f64 - 1.0)).collect();
        let wanted: Vec<f64> = nodes.iter().map(|node| middle + node).collect();
        let window = folds_at(start, [middle - half, middle + half], &wanted)?;
        let at = |value: &f64| window.iter().find(|point| point.values[0] == *value);
        let Some(points) = wanted.iter().map(at).collect::<Option<Vec<_>>>() else { return Ok(None) };
        let scaled: Vec<f64> = nodes.iter().map(|node| node / half).collect();
        let polynomial = |value: &dyn Fn(&CycleLocusPoint) -> f64| {
            let values: Vec<f64> = points.iter().map(|point| value(point)).collect();
            Polynomial::through(&scaled, &values)
        };
        let damping = polynomial(&|point| point.values[1]);
        let mut place = 0.0;
        for _ in 0..NEWTON_STEPS {
            let [_, slope, curvature] = damping.at(place);
            let step = slope / curvature;
            place -= step;
            if step.abs() < TOLERANCE {
                let is_inside = place.abs() <= 1.0 && curvature < 0.0;
                return Ok(is_inside.then(|| Self {
                    value: middle + half * place,
                    damping: damping.at(place)[0],
                    period: polynomial(&|point| point.period).at(place)[0],
                    angle: polynomial(&angle).at(place)[0],
                }));
            }
        }
        Ok(None)
    }
}

/// Abscissa of the vertex of the parabola through three points.
fn vertex([[x0, y0], [x1, y1], [x2, y2]]: [[f64; 2]; 3]) -> Option<f64> {
    let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let place = 0.5 * (x0 + x1) - 0.5 * left * (x2 - x0) / (right - left);
    place.is_finite().then_some(place)
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

    #[test]
    fn the_vertex_of_a_parabola() {
        let parabola = |x: f64| [x, 3.0 - 2.0 * (x - 0.3) * (x - 0.3)];
        assert!((vertex([parabola(-1.0), parabola(0.1), parabola(0.9)]).unwrap() - 0.3).abs() < 1e-15);
    }
}
