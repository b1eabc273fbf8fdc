//! How well the unknowns are known: covariances, and combinations of them that the records say nothing of.

use super::least_squares::Minimum;
use super::singular_values::{SingularValues, dot};

/// Singular value of the scaled Jacobian, relative to the largest, below which a combination is not determined. Derivatives are known
/// to about a hundredth of it.
const SINGULAR: f64 = 1e-6;
/// Share of an unknown in such a combination from which on it is not determined itself.
const SHARE: f64 = 1e-3;

/// The information that the residuals hold on some of the unknowns, the others being held.
#[derive(Clone, Debug)]
pub(super) struct Information {
    /// Which unknowns.
    unknowns: Vec<usize>,
    /// Norms of the columns.
    scales: Vec<f64>,
    decomposition: SingularValues,
}

impl Information {
    /// That on these unknowns at a minimum.
    pub(super) fn of(minimum: &Minimum, unknowns: &[usize]) -> Self {
        let scales: Vec<f64> = unknowns
            .iter()
            .map(|&index| dot(&minimum.jacobian[index], &minimum.jacobian[index]).sqrt())
            .collect();
        let columns = unknowns.iter().zip(&scales).map(|(&index, scale)| {
            let scale = if *scale > 0.0 { *scale } else { 1.0 };
            minimum.jacobian[index].iter().map(|entry| entry / scale).collect()
        });
        let decomposition = SingularValues::of(columns.collect());
        Self { unknowns: unknowns.to_vec(), scales, decomposition }
    }

    fn determines(&self, direction: usize) -> bool {
        self.decomposition.values[direction] > SINGULAR * self.decomposition.largest()
    }

    fn place(&self, unknown: usize) -> Option<usize> {
        self.unknowns.iter().position(|&index| index == unknown)
    }

    /// The covariance of two unknowns; nothing where one of them is held, or is not determined.
    pub(super) fn covariance(&self, one: usize, other: usize) -> Option<f64> {
        let (one, other) = (self.place(one)?, self.place(other)?);
        if self.scales[one] == 0.0 || self.scales[other] == 0.0 {
            return None;
        }
        let mut sum = 0.0;
        for (direction, right) in self.decomposition.right.iter().enumerate() {
            if self.determines(direction) {
                sum += right[one] * right[other] / self.decomposition.values[direction].powi(2);
            } else if right[one].abs() > SHARE || right[other].abs() > SHARE {
                return None;
            }
        }
        Some(sum / (self.scales[one] * self.scales[other]))
    }

    /// The correlation of two unknowns; nothing where one of them is held, or is not determined.
    pub(super) fn correlation(&self, one: usize, other: usize) -> Option<f64> {
        let [first, second] = [self.covariance(one, one)?, self.covariance(other, other)?];
        Some(self.covariance(one, other)? / (first * second).sqrt())
    }

    /// Groups of unknowns of which only combinations are determined.
    pub(super) fn undetermined(&self) -> Vec<Vec<usize>> {
        let directions = (0..self.unknowns.len()).filter(|&direction| !self.determines(direction));
        let group = |direction: usize| {
            let shares = self.decomposition.right[direction].iter().zip(&self.unknowns);
            shares.filter(|(share, _)| share.abs() > SHARE).map(|(_, &unknown)| unknown).collect()
        };
        directions.map(group).collect()
    }

    /// The unconstrained step to the minimum of the quadratic model, in the order of the unknowns; zero along what is not determined.
    pub(super) fn newton_step(&self, residuals: &[f64]) -> Vec<f64> {
        let mut step = vec![0.0; self.unknowns.len()];
        for (direction, right) in self.decomposition.right.iter().enumerate() {
            if self.determines(direction) {
                let value = self.decomposition.values[direction];
                let length = -dot(&self.decomposition.scaled_left[direction], residuals) / (value * value);
                for ((step, right), scale) in step.iter_mut().zip(right).zip(&self.scales) {
                    *step += length * right / scale;
                }
            }
        }
        step
    }

    /// How many unknowns some of the residuals determine: the trace of their block of the projection onto the columns.
    pub(super) fn determined_by(&self, rows: std::ops::Range<usize>) -> f64 {
        let directions = (0..self.unknowns.len()).filter(|&direction| self.determines(direction));
        let share = |direction: usize| {
            let left = &self.decomposition.scaled_left[direction][rows.clone()];
            dot(left, left) / self.decomposition.values[direction].powi(2)
        };
        directions.map(share).sum()
    }
}
