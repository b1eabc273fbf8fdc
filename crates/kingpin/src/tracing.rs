//! Traces the zero set of a function in the unit square as curves.
//!
//! Starting points are the zeros on the edges of a coarse grid; from each the curve is followed both ways with
//! pseudo-arclength steps: a predictor along the tangent, Newton's method back to the zero set along the gradient
//! (Allgower and Georg, *Introduction to Numerical Continuation Methods*, chapter 3). Only the starting points depend on
//! the grid, so a closed curve inside a cell may be missed, and a strip narrower than one, unless the function ends there.

use arclength::control::{Control, Interrupted};

/// A point of the unit square.
pub(crate) type Point = [f64; 2];

/// Cells of the coarse grid along each side.
const CELLS: usize = 48;
/// Longest step; it bounds the distance of points on a curve.
const LONGEST_STEP: f64 = 0.01;
/// Where even this step fails, the curve ends: at the edge of the square or of the domain of the function.
const SHORTEST_STEP: f64 = 1e-9;
/// Largest angle in rad by which the tangent may turn in a step.
const LARGEST_TURN: f64 = 0.1;
/// Newton's method has converged when its step is below this.
const CORRECTION: f64 = 1e-13;
/// Newton's method, and the bisection at a starting point, give up after so many steps.
const CORRECTIONS: usize = 8;
/// The edge of the domain of the function is looked for by so many halvings of an edge of the grid.
const HALVINGS: usize = 16;
/// Half the distance of the points from which the gradient is taken.
const DIFFERENCE: f64 = 1e-6;
/// Nearer than this to the edge of the domain what is zero is not told from the edge itself.
const AT_EDGE: f64 = 1e-4;
/// Most consecutive points there: a curve that meets the edge has fewer before its steps are too short, one that has more runs along it.
const MOST_AT_EDGE: usize = 64;
/// A starting point nearer than this to a curve lies on it.
const SAME_CURVE: f64 = 1e-3;
/// More points than a curve has.
const MOST_POINTS: usize = 20_000;

/// A traced curve; a closed one ends with its first point.
#[derive(Clone, Debug)]
pub(crate) struct Traced {
    pub points: Vec<Point>,
    pub closed: bool,
}

/// The curves on which the function vanishes. Where it has no value the curves end; that it tends to zero there, as a growth rate does where
/// two motions meet, makes no curve of the edge of its domain.
pub(crate) fn trace_zero_set(
    function: impl Fn(Point) -> Option<f64>,
    control: &Control<'_>,
) -> Result<Vec<Traced>, Interrupted> {
    let tracer = Tracer {
        control,
        function: |point: Point| {
            if is_in_square(point) { function(point).filter(|value| value.is_finite()) } else { None }
        },
    };
    let mut curves: Vec<Traced> = Vec::new();
    let starts = tracer.starting_points()?;
    let progress = control.count(starts.len());
    for start in starts {
        let known = |curve: &Traced| curve.points.windows(2).any(|ends| distance(start, ends) < SAME_CURVE);
        if !curves.iter().any(known) {
            curves.extend(tracer.trace(start)?);
        }
        progress.advance(1);
    }
    Ok(curves)
}

struct Tracer<'a, F> {
    control: &'a Control<'a>,
    function: F,
}

impl<F: Fn(Point) -> Option<f64>> Tracer<'_, F> {
    /// Zeros on the edges of the coarse grid, row by row.
    fn starting_points(&self) -> Result<Vec<Point>, Interrupted> {
        let at = |index: usize| index as f64 / CELLS as f64;
        let nodes: Vec<Option<f64>> = (0..=CELLS)
            .flat_map(|row| (0..=CELLS).map(move |column| [at(column), at(row)]))
            .map(|node| self.control.check().map(|()| (self.function)(node)))
            .collect::<Result<_, _>>()?;
        let mut zeros = Vec::new();
        for row in 0..=CELLS {
            for column in 0..=CELLS {
                self.control.check()?;
                for (right, up) in [(1, 0), (0, 1)] {
                    if column + right > CELLS || row + up > CELLS {
                        continue;
                    }
                    let value = nodes[row * (CELLS + 1) + column];
                    let next = nodes[(row + up) * (CELLS + 1) + column + right];
                    let ends = [[at(column), at(row)], [at(column + right), at(row + up)]];
                    match (value, next) {
                        (Some(value), Some(next)) if (value < 0.0) != (next < 0.0) => {
                            zeros.extend(self.zero_between(ends, value));
                        }
                        (Some(value), None) => zeros.extend(self.zero_before_the_edge(ends, value)),
                        (None, Some(next)) => {
                            zeros.extend(self.zero_before_the_edge([ends[1], ends[0]], next));
                        }
                        _ => {}
                    }
                }
            }
        }
        Ok(zeros)
    }

    /// A zero on the way from a point to another where the function has no value.
    fn zero_before_the_edge(&self, [mut inside, mut outside]: [Point; 2], value: f64) -> Option<Point> {
        for _ in 0..HALVINGS {
            let middle = [0.5 * (inside[0] + outside[0]), 0.5 * (inside[1] + outside[1])];
            match (self.function)(middle) {
                Some(other) if (other < 0.0) != (value < 0.0) => {
                    return self.zero_between([inside, middle], value);
                }
                Some(_) => inside = middle,
                None => outside = middle,
            }
        }
        None
    }

    /// Bisection until Newton's method takes over.
    fn zero_between(&self, [mut low, mut high]: [Point; 2], low_value: f64) -> Option<Point> {
        for _ in 0..CORRECTIONS {
            let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
            let value = (self.function)(middle)?;
            if (value < 0.0) == (low_value < 0.0) { low = middle } else { high = middle }
        }
        self.correct(low).map(|(point, _)| point)
    }

    /// The gradient by differences, one-sided at the edge of the domain.
    fn gradient(&self, point: Point, value: f64) -> Option<Point> {
        let mut gradient = [0.0; 2];
        for (direction, slope) in gradient.iter_mut().enumerate() {
            let side = |step: f64| {
                let mut moved = point;
                moved[direction] += step;
                (self.function)(moved)
            };
            *slope = match (side(-DIFFERENCE), side(DIFFERENCE)) {
                (Some(below), Some(above)) => (above - below) / (2.0 * DIFFERENCE),
                (None, Some(above)) => (above - value) / DIFFERENCE,
                (Some(below), None) => (value - below) / DIFFERENCE,
                (None, None) => return None,
            };
        }
        Some(gradient)
    }

    /// Whether the domain of the function ends next to a point, other than with the square.
    fn is_at_the_edge(&self, [x, y]: Point) -> bool {
        [[x - AT_EDGE, y], [x + AT_EDGE, y], [x, y - AT_EDGE], [x, y + AT_EDGE]]
            .into_iter()
            .any(|beside| is_in_square(beside) && (self.function)(beside).is_none())
    }

    /// Newton's method along the gradient: the zero and the unit tangent there.
    fn correct(&self, mut point: Point) -> Option<(Point, Point)> {
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let value = (self.function)(point)?;
            let gradient = self.gradient(point, value)?;
            let steepness = gradient[0].hypot(gradient[1]);
            let step = value / steepness;
            if !step.is_finite() {
                return None;
            }
            // Steps that no longer shrink are at the level of rounding.
            if step.abs() < CORRECTION || (step.abs() >= 0.5 * last && step.abs() < CORRECTION.sqrt()) {
                return Some((point, [-gradient[1] / steepness, gradient[0] / steepness]));
            }
            last = step.abs();
            for (coordinate, slope) in point.iter_mut().zip(gradient) {
                *coordinate -= step * slope / steepness;
            }
        }
        None
    }

    /// The curve through a starting point; `None` where Newton's method does not get back to it.
    fn trace(&self, start: Point) -> Result<Option<Traced>, Interrupted> {
        let Some((start, tangent)) = self.correct(start) else { return Ok(None) };
        if self.is_at_the_edge(start) {
            return Ok(None);
        }
        let (mut forward, closed) = self.follow(start, tangent)?;
        if closed {
            forward.insert(0, start);
            forward.push(start);
            return Ok(Some(Traced { points: forward, closed }));
        }
        let (mut points, _) = self.follow(start, tangent.map(|component| -component))?;
        points.reverse();
        points.push(start);
        points.append(&mut forward);
        Ok(Some(Traced { points, closed }))
    }

    /// The points after the start, and whether the curve came back to it.
    fn follow(&self, start: Point, mut tangent: Point) -> Result<(Vec<Point>, bool), Interrupted> {
        let mut points = Vec::new();
        let (mut point, mut step) = (start, LONGEST_STEP);
        let first_tangent = tangent;
        let mut at_edge = 0;
        while step > SHORTEST_STEP && points.len() < MOST_POINTS && at_edge < MOST_AT_EDGE {
            self.control.check()?;
            let predicted = [point[0] + step * tangent[0], point[1] + step * tangent[1]];
            let accepted = self.correct(predicted).and_then(|(next, direction)| {
                let cosine = direction[0] * tangent[0] + direction[1] * tangent[1];
                let direction = direction.map(|component| component * cosine.signum());
                let moved = (next[0] - predicted[0]).hypot(next[1] - predicted[1]);
                (cosine.abs() > LARGEST_TURN.cos() && moved < 0.5 * step).then_some((
                    next,
                    direction,
                    cosine.abs(),
                ))
            });
            let Some((next, direction, cosine)) = accepted else {
                step *= 0.5;
                continue;
            };
            let same_way = first_tangent[0] * direction[0] + first_tangent[1] * direction[1] > 0.0;
            if points.len() > 2 && same_way && distance(start, &[point, next]) < 0.1 * step {
                return Ok((points, true));
            }
            at_edge = if self.is_at_the_edge(next) { at_edge + 1 } else { 0 };
            points.push(next);
            (point, tangent) = (next, direction);
            if cosine > (0.5 * LARGEST_TURN).cos() {
                step = (2.0 * step).min(LONGEST_STEP);
            }
        }
        Ok((points, false))
    }
}

fn is_in_square(point: Point) -> bool {
    point.iter().all(|coordinate| (0.0..=1.0).contains(coordinate))
}

/// Distance of a point from a line segment.
fn distance(point: Point, ends: &[Point]) -> f64 {
    let [from, to] = [ends[0], ends[1]];
    let along = [to[0] - from[0], to[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let projection = ((point[0] - from[0]) * along[0] + (point[1] - from[1]) * along[1]) / square;
    let part = if square > 0.0 { projection.clamp(0.0, 1.0) } else { 0.0 };
    (point[0] - from[0] - part * along[0]).hypot(point[1] - from[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_one_closed_curve() {
        let circle = |[x, y]: Point| Some((x - 0.5).powi(2) + (y - 0.4).powi(2) - 0.09);
        let curves = trace_zero_set(circle, &Control::none()).unwrap();
        let [circle] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert!(circle.closed);
        let radius = |point: &Point| (point[0] - 0.5).hypot(point[1] - 0.4);
        assert!(circle.points.iter().all(|point| (radius(point) - 0.3).abs() < 1e-12));
        let length: f64 = circle
            .points
            .windows(2)
            .map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]))
            .sum();
        assert!((length - 0.6 * std::f64::consts::PI).abs() < 1e-4, "{length}");
    }

    /// Between two rows of the grid, of which one lies outside of the domain.
    #[test]
    fn a_curve_close_to_the_edge_of_the_domain_is_found() {
        let strip = |[_, y]: Point| (y > 0.401).then_some(y - 0.405);
        let curves = trace_zero_set(strip, &Control::none()).unwrap();
        let [line] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert!(line.points.iter().all(|[_, y]| (y - 0.405).abs() < 1e-12));
        let [first, last] = [line.points[0][0], line.points[line.points.len() - 1][0]];
        assert!((last - first).abs() > 1.0 - 1e-6, "{first} {last}");
    }

    /// It vanishes as the square root of the distance from a circle behind which it has no value, as a growth rate does at a fold, and on a
    /// line, which is the only curve.
    #[test]
    fn the_edge_of_the_domain_is_no_curve() {
        let evaluations = std::cell::Cell::new(0);
        let fold = |[x, y]: Point| {
            evaluations.set(evaluations.get() + 1);
            let inside = 0.49 - (x - 0.1).powi(2) - (y - 0.2).powi(2);
            // Beyond the last bits of it the other motion is found.
            let sign = if inside < 1e-15 { -1.0 } else { 1.0 };
            (inside > 0.0).then(|| sign * inside.sqrt() * (x - 0.3 - 0.1 * y))
        };
        let curves = trace_zero_set(fold, &Control::none()).unwrap();
        let [line] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert!(line.points.iter().all(|[x, y]| (x - 0.3 - 0.1 * y).abs() < 1e-9));
        let [from, to] = [line.points[0][1], line.points[line.points.len() - 1][1]];
        assert!((from.min(to)).abs() < 1e-8 && (from.max(to) - 0.84).abs() < 0.02, "{from} {to}");
        assert!(evaluations.get() < 20_000, "{}", evaluations.get());
    }

    #[test]
    fn open_curves_reach_the_edges() {
        // Two branches of a hyperbola, and no value in a corner.
        let hyperbola = |[x, y]: Point| (x + y < 1.9).then_some((x - 0.5) * (y - 0.5) - 0.01);
        let curves = trace_zero_set(hyperbola, &Control::none()).unwrap();
        assert_eq!(curves.len(), 2);
        for curve in &curves {
            assert!(!curve.closed);
            for [x, y] in [curve.points[0], curve.points[curve.points.len() - 1]] {
                let gap = x.min(y).min(1.0 - x).min(1.0 - y).min((1.9 - x - y).abs());
                assert!(gap < 1e-8, "{x} {y}");
            }
            for ends in curve.points.windows(2) {
                assert!((ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]) < 0.02);
            }
        }
    }
}
