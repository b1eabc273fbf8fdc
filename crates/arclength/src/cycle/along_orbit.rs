//! Functions along a cycle: the largest and the smallest value over one period, the mean, and the value at a phase.

use super::orbit::Orbit;
use crate::collocation::gauss::Gauss;
use crate::collocation::polynomials::{Polynomials, combine};

/// Samples in every interval of the mesh among which an extremum is bracketed.
const SAMPLES: usize = 16;
/// Length of a bracket, as part of its interval, at which the value at an extremum no longer changes.
const BRACKET: f64 = 1e-9;
/// Halvings of a bracket until it is as short as numbers allow.
const HALVINGS: usize = 60;
/// Points of the quadrature in every interval.
const QUADRATURE: usize = 7;
/// The smaller part of the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_2;

/// Where a function of the unit time is largest among samples.
struct Bracket {
    largest: f64,
    middle: f64,
    /// How far the extremum itself may be.
    reach: f64,
}

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
        let gauss = Gauss::of(self.degree);
        let value = |time: f64| function(&self.state_with(&gauss, time));
        let Some(Bracket { mut largest, middle, reach }) = self.bracket(value) else { return f64::NAN };
        let (mut left, mut right) = (middle - reach, middle + reach);
        let inside = |time: f64| value(time.rem_euclid(1.0));
        let (mut one, mut other) = (left + GOLDEN * (right - left), right - GOLDEN * (right - left));
        let (mut at_one, mut at_other) = (inside(one), inside(other));
        while right - left > BRACKET * reach {
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

    /// The largest of the samples of a function of the unit time; nothing where the function is not a number anywhere.
    fn bracket(&self, mut value: impl FnMut(f64) -> f64) -> Option<Bracket> {
        let mut best = Bracket { largest: f64::NEG_INFINITY, middle: 0.0, reach: 0.0 };
        let count = self.mesh.len();
        let mut before = self.mesh[count - 1] - self.mesh[count - 2];
        for pair in self.mesh.windows(2) {
            let length = pair[1] - pair[0];
            // The extremum may lie in the interval before.
            let reach = length.max(before) / SAMPLES as f64;
            before = length;
            for sample in 0..SAMPLES {
                let time = pair[0] + length / SAMPLES as f64 * sample as f64;
                let here = value(time);
                if here.is_nan() {
                    return None;
                }
                if here > best.largest {
                    best = Bracket { largest: here, middle: time, reach };
                }
            }
        }
        Some(best)
    }

    /// Where a state is largest, in the unit time from 0 to 1: a zero of its slope, so that it is as exact as the orbit.
    fn place_of_largest(&self, component: usize) -> Option<f64> {
        let gauss = Gauss::of(self.degree);
        let orbit = Polynomials { mesh: &self.mesh, gauss: &gauss, states: &self.states, n: self.dimension };
        let Bracket { middle, reach, .. } = self.bracket(|time| orbit.component(time, component).0)?;
        let (mut left, mut right) = (middle - reach, middle + reach);
        for _ in 0..HALVINGS {
            let time = 0.5 * (left + right);
            if orbit.component(time, component).1 > 0.0 {
                left = time;
            } else {
                right = time;
            }
        }
        Some(0.5 * (left + right))
    }

    /// Value of a function of the state at a phase: a part of the period, counted from the place where the first state is
    /// largest. Where it is largest at two places, either may be taken. Not a number where the orbit is not one.
    ///
    /// ```
    /// use arclength::cycle::Orbit;
    /// use std::f64::consts::TAU;
    /// let circle = |turn: f64| Orbit::from_function(TAU, move |time| vec![(time - 1.0).cos(), turn * (time - 1.0).sin()]);
    /// // A quarter of the period after the largest x, y is at its largest or smallest, by the sense of the motion.
    /// assert!((circle(1.0).at_phase(0.25, |state| state[1]) - 1.0).abs() < 1e-10);
    /// assert!((circle(-1.0).at_phase(0.25, |state| state[1]) + 1.0).abs() < 1e-10);
    /// // Where y changes fastest, the place itself counts.
    /// assert!(circle(1.0).at_phase(0.0, |state| state[1]).abs() < 1e-10);
    /// ```
    pub fn at_phase(&self, phase: f64, function: impl Fn(&[f64]) -> f64) -> f64 {
        match self.place_of_largest(0) {
            Some(place) => function(&self.state_at((place + phase) * self.period)),
            None => f64::NAN,
        }
    }

    /// Smallest value of a function of the state over one period, as [`maximum`](Self::maximum).
    pub fn minimum(&self, function: impl Fn(&[f64]) -> f64) -> f64 {
        -self.maximum(|state| -function(state))
    }

    /// Mean of a function of the state over one period, by Gauss quadrature in every interval of the mesh.
    pub fn mean(&self, function: impl Fn(&[f64]) -> f64) -> f64 {
        let quadrature = Gauss::of(QUADRATURE);
        let gauss = Gauss::of(self.degree);
        let mut bases = vec![0.0; QUADRATURE * (self.degree + 1)];
        for (basis, point) in bases.chunks_exact_mut(self.degree + 1).zip(&quadrature.points) {
            gauss.basis(*point, basis);
        }
        let mut state = vec![0.0; self.dimension];
        let intervals = self.states.chunks_exact((self.degree + 1) * self.dimension);
        let interval = |(pair, states): (&[f64], &[f64])| {
            let mut sum = 0.0;
            for (basis, weight) in bases.chunks_exact(self.degree + 1).zip(&quadrature.weights) {
                combine(states, basis, &mut state);
                sum += weight * function(&state);
            }
            (pair[1] - pair[0]) * sum
        };
        self.mesh.windows(2).zip(intervals).map(interval).sum()
    }
}
