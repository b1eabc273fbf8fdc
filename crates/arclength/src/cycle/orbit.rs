//! A periodic orbit as plain data: a piecewise polynomial that can be sampled, stored and restarted from.

use super::gauss::Gauss;
use serde::{Deserialize, Serialize};

/// A periodic orbit, piecewise polynomial in the unit time `t / period`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// Mesh `0 = t_0 < ... < t_N = 1`.
    pub mesh: Vec<f64>,
    /// Degree of the polynomials.
    pub degree: usize,
    /// Number of state variables.
    pub dimension: usize,
    /// For every interval the states at its left end and at its Gauss points.
    pub states: Vec<f64>,
    /// Period.
    pub period: f64,
}

impl Orbit {
    /// States at `count` equidistant times `0, T/count, ...`, with the times.
    pub fn sample(&self, count: usize) -> Vec<(f64, Vec<f64>)> {
        let gauss = Gauss::new(self.degree);
        let mut basis = vec![0.0; self.degree + 1];
        (0..count)
            .map(|index| {
                let time = index as f64 / count as f64;
                (time * self.period, self.state_with(&gauss, &mut basis, time))
            })
            .collect()
    }

    /// State at time `time` (any real number; the orbit repeats).
    pub fn state_at(&self, time: f64) -> Vec<f64> {
        let phase = (time / self.period).rem_euclid(1.0);
        self.state_with(&Gauss::new(self.degree), &mut vec![0.0; self.degree + 1], phase)
    }

    fn state_with(&self, gauss: &Gauss, basis: &mut [f64], phase: f64) -> Vec<f64> {
        let interval = self.mesh[1..self.mesh.len() - 1].partition_point(|&point| point <= phase);
        let (left, right) = (self.mesh[interval], self.mesh[interval + 1]);
        gauss.basis((phase - left) / (right - left), basis);
        let size = (self.degree + 1) * self.dimension;
        let mut state = vec![0.0; self.dimension];
        super::collocation::combine(&self.states[interval * size..(interval + 1) * size], basis, &mut state);
        state
    }
}
