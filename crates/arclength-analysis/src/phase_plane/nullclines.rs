//! Curves on which a component of the velocity is zero: where it changes its sign on a grid, drawn through points that are zeros to
//! rounding, as close together as the curve bends.

use super::plane_field::PlaneField;
use kingpin_figure::contour_lines;

/// Cells of the coarsest and of the finest grid across the window.
const COARSEST: usize = 128;
const FINEST: usize = 1024;
/// Part of the nodes of a finer grid at which a sign that the coarser one does not show means that the field is finer than both.
const UNSEEN: f64 = 1e-4;
/// How far from a curve, in parts of the window, the chord between two of its points may be.
const FLATNESS: f64 = 1e-4;
/// How often a chord is halved.
const HALVINGS: usize = 6;
/// How often a change of sign is narrowed.
const BISECTIONS: usize = 50;
/// What is left of a continuous function where a change of its sign was narrowed; a jump leaves more.
const CONTINUOUS: f64 = 1e-3;

/// The velocity at the nodes of a grid.
pub(super) struct GridSamples {
    nodes: Vec<f64>,
    /// Both components, row by row.
    values: [Vec<f64>; 2],
}

impl GridSamples {
    /// On a grid that is so fine that one twice as fine shows nothing else, or on the finest.
    pub(super) fn of(field: &PlaneField<'_>) -> Self {
        let mut cells = COARSEST;
        loop {
            cells *= 2;
            let samples = Self::on(cells, |point| field.velocity(point));
            if cells >= FINEST || samples.shows_what_every_second_does() {
                return samples;
            }
        }
    }

    fn on(cells: usize, velocity: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let nodes: Vec<f64> = (0..=cells).map(|index| index as f64 / cells as f64).collect();
        let mut values = [Vec::new(), Vec::new()];
        for y in &nodes {
            for x in &nodes {
                let velocity = velocity([*x, *y]);
                values.iter_mut().zip(velocity).for_each(|(values, value)| values.push(value));
            }
        }
        Self { nodes, values }
    }

    /// Whether almost no node between four others of one sign has another sign.
    fn shows_what_every_second_does(&self) -> bool {
        let columns = self.nodes.len();
        let centres = || {
            (1..columns)
                .step_by(2)
                .flat_map(|row| (1..columns).step_by(2).map(move |column| row * columns + column))
        };
        self.values.iter().all(|values| {
            let is_unseen = |centre: &usize| {
                let positive = |index: usize| values[index] > 0.0;
                let corner = centre - columns - 1;
                [0, 2, 2 * columns, 2 * columns + 2]
                    .iter()
                    .all(|step| positive(corner + step) != positive(*centre))
            };
            let unseen = centres().filter(is_unseen).count();
            unseen as f64 <= UNSEEN * centres().count() as f64
        })
    }

    fn cells(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Centres of the cells in which both components may be zero: both change their sign, or vanish, at the corners.
    pub(super) fn standstills(&self) -> Vec<[f64; 2]> {
        let (columns, cells) = (self.nodes.len(), self.cells());
        let mut centres = Vec::new();
        for row in 0..cells {
            for column in 0..cells {
                let corner = row * columns + column;
                let changes = self.values.iter().all(|values| {
                    let corners = [0, 1, columns, columns + 1].map(|step| values[corner + step]);
                    corners.iter().all(|value| value.is_finite())
                        && corners.iter().any(|value| *value >= 0.0)
                        && corners.iter().any(|value| *value <= 0.0)
                });
                if changes {
                    centres.push([column, row].map(|index| (index as f64 + 0.5) / cells as f64));
                }
            }
        }
        centres
    }
}

/// The curves on which a component is zero.
pub(super) fn zero_curves(
    samples: &GridSamples,
    axis: usize,
    component: impl Fn([f64; 2]) -> f64,
) -> Vec<Vec<[f64; 2]>> {
    let lines = contour_lines(&samples.nodes, &samples.nodes, &samples.values[axis], 0.0);
    let mut curves = Vec::new();
    for line in lines {
        let line: Vec<[f64; 2]> = line.iter().map(|point| [point.x, point.y]).collect();
        let last = line.len() - 1;
        let mut curve: Vec<[f64; 2]> = Vec::new();
        for index in 0..=last {
            let (before, behind) = (line[index.saturating_sub(1)], line[last.min(index + 1)]);
            let zero = nearest_zero(&component, line[index], [before, behind], 1.0 / samples.cells() as f64);
            match zero {
                Some(zero) => {
                    if let Some(from) = curve.last().copied() {
                        bend(&component, from, zero, HALVINGS, &mut curve);
                    }
                    curve.push(zero);
                }
                // A jump through zero is no zero.
                None => finish(&mut curve, &mut curves),
            }
        }
        finish(&mut curve, &mut curves);
    }
    curves
}

fn finish(curve: &mut Vec<[f64; 2]>, curves: &mut Vec<Vec<[f64; 2]>>) {
    let curve = std::mem::take(curve);
    if curve.len() > 1 {
        curves.push(curve);
    }
}

/// Adds what lies between two points of a curve where it is not straight.
fn bend(
    component: &impl Fn([f64; 2]) -> f64,
    from: [f64; 2],
    to: [f64; 2],
    halvings: usize,
    curve: &mut Vec<[f64; 2]>,
) {
    let middle = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]));
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let Some(zero) = nearest_zero(component, middle, [from, to], 0.5 * length) else { return };
    if halvings > 0 && (zero[0] - middle[0]).hypot(zero[1] - middle[1]) > FLATNESS {
        bend(component, from, zero, halvings - 1, curve);
        curve.push(zero);
        bend(component, zero, to, halvings - 1, curve);
    }
}

/// The zero nearest to a point on the normal of a chord, within a reach.
fn nearest_zero(
    component: &impl Fn([f64; 2]) -> f64,
    near: [f64; 2],
    [from, to]: [[f64; 2]; 2],
    reach: f64,
) -> Option<[f64; 2]> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    if length == 0.0 {
        return Some(near);
    }
    let at = |step: f64| [near[0] - step * dy / length, near[1] + step * dx / length];
    let here = component(near);
    if here == 0.0 {
        return Some(near);
    }
    let mut steps = [0.125, 0.25, 0.5, 1.0].iter().flat_map(|part| [part * reach, -part * reach]);
    let (far, there) = steps.find_map(|step| {
        let value = component(at(step));
        (value * here <= 0.0).then_some((step, value))
    })?;
    let (mut inner, mut outer) = ((0.0, here), (far, there));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (inner.0 + outer.0);
        let value = component(at(middle));
        if value * here > 0.0 {
            inner = (middle, value);
        } else {
            outer = (middle, value);
        }
    }
    let largest = here.abs().max(there.abs());
    let is_zero = inner.1.abs().max(outer.1.abs()) <= CONTINUOUS * largest;
    is_zero.then(|| at(outer.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(component: impl Fn([f64; 2]) -> f64) -> Vec<Vec<[f64; 2]>> {
        zero_curves(&GridSamples::on(COARSEST, |point| [component(point); 2]), 0, component)
    }

    #[test]
    fn a_circle_is_round() {
        for radius in [0.01, 0.1, 0.44] {
            let curves = sampled(|[x, y]| (x - 0.5).hypot(y - 0.503) - radius);
            assert_eq!(curves.len(), 1);
            let angle = |[x, y]: [f64; 2]| (y - 0.503).atan2(x - 0.5);
            for pair in curves[0].windows(2) {
                assert!(((pair[0][0] - 0.5).hypot(pair[0][1] - 0.503) - radius).abs() < 1e-12);
                let turn = (angle(pair[1]) - angle(pair[0])).sin().abs();
                assert!(radius * (1.0 - (0.5 * turn).cos()) < 2.0 * FLATNESS, "{radius}: {turn}");
            }
        }
    }

    #[test]
    fn a_jump_through_zero_is_no_nullcline() {
        assert!(sampled(|[x, _]| if x > 0.31 { 1.0 } else { -1.0 }).is_empty());
        assert!(sampled(|[x, y]| 1.0 / (x - 0.2 - 0.1 * y)).is_empty());
        assert_eq!(sampled(|[x, y]| if x > 0.31 { y - 0.7 } else { -1.0 }).len(), 1);
    }

    #[test]
    fn a_field_finer_than_the_grid_is_noticed() {
        let wave = |periods: f64| {
            GridSamples::on(256, |[x, y]: [f64; 2]| {
                let bend = y - 0.5 - 0.3 * (std::f64::consts::TAU * periods * x).sin();
                [bend, 1.0]
            })
            .shows_what_every_second_does()
        };
        assert!(wave(5.0) && !wave(80.0));
    }

    #[test]
    fn crossing_lines_are_both_drawn() {
        let curves = sampled(|[x, y]| (x - 0.3) * (y - 0.6));
        let near =
            |point: [f64; 2]| curves.iter().flatten().any(|[x, y]| (x - point[0]).hypot(y - point[1]) < 0.01);
        for point in [[0.3, 0.1], [0.3, 0.9], [0.1, 0.6], [0.9, 0.6], [0.3, 0.6]] {
            assert!(near(point), "{point:?}");
        }
    }
}
