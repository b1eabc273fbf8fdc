//! The field of a model of two states over a window that is mapped to the unit square, so that both states count alike.

use crate::model::ChosenModel;
use arclength::Scalar;
use arclength::VectorField;
use arclength::algebraic::{AlgebraicProblem, solve_square};
use arclength::integration::{JacobianColumns, exact_jacobian};

/// The field in the coordinates of the unit square.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneField<'a> {
    chosen: &'a ChosenModel,
    axes: [usize; 2],
    window: [[f64; 2]; 2],
}

impl<'a> PlaneField<'a> {
    /// The field with these states on the axes.
    pub(super) fn new(chosen: &'a ChosenModel, axes: [usize; 2], window: [[f64; 2]; 2]) -> Self {
        Self { chosen, axes, window }
    }

    /// What the states on the axes are at a point of the square.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [[left, right], [bottom, top]] = self.window;
        [left + u * (right - left), bottom + v * (top - bottom)]
    }

    fn state(&self, point: [f64; 2]) -> Vec<f64> {
        let values = self.point(point);
        let mut state = vec![0.0; 2];
        self.axes.iter().zip(values).for_each(|(axis, value)| state[*axis] = value);
        state
    }

    fn widths(&self) -> [f64; 2] {
        self.window.map(|[low, high]| high - low)
    }

    /// The velocity at a point of the square, in the square.
    pub(super) fn velocity(&self, point: [f64; 2]) -> [f64; 2] {
        let (speed, widths) = (self.speed(point), self.widths());
        [0, 1].map(|axis| speed[axis] / widths[axis])
    }

    /// How fast the states on the axes change at a point of the square.
    pub(super) fn speed(&self, point: [f64; 2]) -> [f64; 2] {
        let mut derivative = [0.0; 2];
        self.chosen.model.evaluate(&self.state(point), &self.chosen.parameters, &mut derivative);
        self.axes.map(|axis| derivative[axis])
    }

    /// The derivatives of the velocity: row by row, in the square.
    pub(super) fn jacobian(&self, point: [f64; 2]) -> [[f64; 2]; 2] {
        let parameters: Vec<JacobianColumns> =
            self.chosen.parameters.iter().map(|value| JacobianColumns::constant(*value)).collect();
        let mut columns = [0.0; 4];
        let evaluate = |state: &[JacobianColumns], slope: &mut [JacobianColumns]| {
            self.chosen.model.evaluate(state, &parameters, slope);
        };
        exact_jacobian(evaluate, &self.state(point), &mut columns);
        let widths = self.widths();
        [0, 1].map(|row| {
            [0, 1]
                .map(|column| columns[self.axes[column] * 2 + self.axes[row]] * widths[column] / widths[row])
        })
    }

    /// The equilibrium to which Newton's method leads from a point, if there is one.
    pub(super) fn equilibrium(&self, from: [f64; 2]) -> Option<[f64; 2]> {
        let widths = self.widths();
        let mut scales = [0.0; 2];
        self.axes.iter().zip(widths).for_each(|(axis, width)| scales[*axis] = width);
        let solved = solve_square(&Standstill(self.chosen), &self.state(from), &scales).ok()?;
        let found = [0, 1].map(|axis| {
            let [low, _] = self.window[axis];
            (solved.unknown[self.axes[axis]] - low) / widths[axis]
        });
        found.iter().all(|value| value.is_finite()).then_some(found)
    }
}

/// That nothing changes.
struct Standstill<'a>(&'a ChosenModel);

impl AlgebraicProblem for Standstill<'_> {
    fn unknowns(&self) -> usize {
        2
    }

    fn equations(&self) -> usize {
        2
    }

    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        let parameters: Vec<T> = self.0.parameters.iter().map(|value| T::from(*value)).collect();
        self.0.model.evaluate(unknown, &parameters, residual);
    }
}

/// Arrows of the direction field across and up.
pub(super) const ARROWS: [usize; 2] = [21, 15];

/// The places of the arrows of a direction field, in the unit square.
pub(super) fn places_of_arrows() -> impl Iterator<Item = [f64; 2]> {
    let at = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
    let [across, up] = ARROWS;
    (0..up).flat_map(move |row| (0..across).map(move |column| [at(column, across), at(row, up)]))
}
