//! Functions along a cycle: the largest and the smallest value over one period, and the mean.

use super::orbit::Orbit;
use crate::collocation::gauss::Gauss;

/// Samples in every interval of the mesh among which an extremum is bracketed.
const SAMPLES: usize = 16;
/// Length of a bracket, as part of its interval, at which the value at an extremum no longer changes.
const BRACKET: f64 = 1e-9;
/// Points of the quadrature in every interval.
const QUADRATURE: usize = 7;
/// The smaller part of the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_2;

impl Orbit {
    /// Largest value of a function of the state over one period; not a number where the function is not one anywhere.
    ///
    /// It is bracketed among 16 samples in every interval of the mesh and narrowed down by golden section.
    ///
    /// ```
    /// use arclength::cycle::Orbit;
    /// use std::f64::consts::TAU;
    /// let circle = Orbit::from_function(TAU, |time| vec![time.cos(), time.sin()]);
    /// assert!((circle.maximum(|state| state[0] + state[1]) - 2_f64.sqrt()).abs() < 1e-10);
    /// assert!((circle.mean(|state| state[0] * state[0]) - 0.5).abs() < 1e-10);
    /// ```
    pub fn maximum(&self, function: impl Fn(&[f64]) -> f64) -> f64 {
        let gauss = Gauss::new(self.degree);
        let value = |time: f64| function(&self.state_with(&gauss, time));
        let mut best = (f64::NEG_INFINITY, 0.0, 0.0);
        let count = self.mesh.len();
        let mut before = self.mesh[count - 1] - self.mesh[count - 2];
        for pair in self.mesh.windows(2) {
            let length = pair[1] - pair[0];
            let step = length / SAMPLES as f64;
            // The extremum may lie in the interval before.
            let reach = length.max(before) / SAMPLES as f64;
            before = length;
            for sample in 0..SAMPLES {
                let time = pair[0] + step * sample as f64;
                let here = value(time);
                if here.is_nan() {
                    return f64::NAN;
                }
                if here > best.0 {
                    best = (here, time, reach);
                }
            }
        }
        let (mut largest, middle, step) = best;
        let (mut left, mut right) = (middle - step, middle + step);
        let inside = |time: f64| value(time.rem_euclid(1.0));
        let (mut one, mut other) = (left + GOLDEN * (right - left), right - GOLDEN * (right - left));
        let (mut at_one, mut at_other) = (inside(one), inside(other));
        while right - left > BRACKET * step {
            if at_one > at_other {
                (right, other, at_other) = (other, one, at_one);
                one = left + GOLDEN * (right - left);
                at_one = inside(one);
            } else {
                (left, one, at_one) = (one, other, at_other);
                other = right - GOLDEN * (right - left);
                at_other = inside(other);
            }
            largest = largest.max(at_one).max(at_other);
        }
        largest
    }

    /// Smallest value of a function of the state over one period, as [`maximum`](Self::maximum).
    pub fn minimum(&self, function: impl Fn(&[f64]) -> f64) -> f64 {
        -self.maximum(|state| -function(state))
    }

    /// Mean of a function of the state over one period, by Gauss quadrature in every interval of the mesh.
    pub fn mean(&self, function: impl Fn(&[f64]) -> f64) -> f64 {
        let quadrature = Gauss::new(QUADRATURE);
        let gauss = Gauss::new(self.degree);
        let interval = |pair: &[f64]| {
            let length = pair[1] - pair[0];
            let values = quadrature.points.iter().zip(&quadrature.weights);
            let sum: f64 = values
                .map(|(point, weight)| weight * function(&self.state_with(&gauss, pair[0] + point * length)))
                .sum();
            length * sum
        };
        self.mesh.windows(2).map(interval).sum()
    }
}
