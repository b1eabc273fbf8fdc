//! Orbits that are a cycle traversed several times: how often, and the cycle traversed once.
//!
//! A motion that settles slowly beside a period doubling comes nearer to its start after two turns than after one, and an orbit that is
//! given may hold several periods. The equations hold for such an orbit as they do for the cycle, but its period is a multiple, its
//! multipliers are powers, and no period doubling can be located on its branch.

use super::orbit::Orbit;
use super::sizes::extent;
use crate::collocation::gauss::Gauss;
use crate::collocation::mesh::SAME_TIME;
use crate::collocation::polynomials::Polynomials;

/// Numbers of turns that are looked for; others are their products.
const TURNS: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
/// Places of a turn at which states are compared, and where the first of them is: not where meshes and jumps are likely to be.
const SAMPLES: usize = 64;
const FIRST_SAMPLE: f64 = 0.37;
/// Smallest size of a state, as part of its magnitude: of one that rests it is rounding.
const RESTING: f64 = 1e-5;

impl Orbit {
    /// The orbit of the first of several turns that differ by less than `closeness` of the size of each state; `None` where it has one, or
    /// rests.
    pub(super) fn traversed_once(&self, closeness: f64) -> Option<Self> {
        if self.rests() {
            return None;
        }
        let count = TURNS.into_iter().find(|&count| self.repeats(count, closeness))?;
        let part = self.first_of(count);
        Some(part.traversed_once(closeness).unwrap_or(part))
    }

    /// Whether all states move by no more than what may be rounding.
    fn rests(&self) -> bool {
        (0..self.dimension).all(|component| {
            let (low, high) = extent(&self.states, self.dimension, component);
            high - low <= RESTING * high.abs().max(low.abs())
        })
    }

    /// Whether the states are the same again after one of several parts of equal length, within `closeness` of the size of each.
    pub fn repeats(&self, parts: usize, closeness: f64) -> bool {
        let gauss = Gauss::of(self.degree);
        let allowed: Vec<f64> = (0..self.dimension)
            .map(|component| {
                let (low, high) = extent(&self.states, self.dimension, component);
                closeness * (high - low).max(RESTING * high.abs().max(low.abs()))
            })
            .collect();
        let count = SAMPLES * parts;
        (0..count).all(|sample| {
            let [state, later] = [sample, (sample + SAMPLES) % count]
                .map(|sample| self.state_with(&gauss, (sample as f64 + FIRST_SAMPLE) / count as f64));
            state
                .iter()
                .zip(&later)
                .zip(&allowed)
                .all(|((one, other), allowed)| (one - other).abs() <= *allowed)
        })
    }

    /// The first of parts of equal length.
    fn first_of(&self, parts: usize) -> Self {
        let gauss = Gauss::of(self.degree);
        let end = 1.0 / parts as f64;
        let mut mesh: Vec<f64> = self.mesh.iter().copied().filter(|time| *time < end - SAME_TIME).collect();
        mesh.push(end);
        let nodes = Polynomials { mesh: &mesh, gauss: &gauss, n: 0, states: &[] }.node_times();
        let states = nodes.into_iter().flat_map(|time| self.state_with(&gauss, time)).collect();
        mesh.iter_mut().for_each(|time| *time *= parts as f64);
        if let Some(last) = mesh.last_mut() {
            *last = 1.0;
        }
        Self {
            mesh,
            degree: self.degree,
            dimension: self.dimension,
            states,
            period: self.period / parts as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Turns of a motion with harmonics of the whole time.
    fn orbit(turns: usize, subharmonic: f64) -> Orbit {
        let mesh: Vec<f64> = (0..=40).map(|index| f64::from(index) / 40.0).collect();
        let gauss = Gauss::of(4);
        let states = mesh.windows(2).flat_map(|pair| {
            let inner = gauss.points.iter().map(|place| pair[0] + place * (pair[1] - pair[0]));
            let times: Vec<f64> = std::iter::once(pair[0]).chain(inner).collect();
            times.into_iter().flat_map(|time| {
                let angle = TAU * turns as f64 * time;
                [angle.cos() + subharmonic * (TAU * time).sin(), angle.sin(), 2.0]
            })
        });
        Orbit { degree: 4, dimension: 3, states: states.collect(), period: 6.0, mesh: mesh.clone() }
    }

    #[test]
    fn turns_are_counted() {
        for turns in [2, 3, 4, 6] {
            let once = orbit(turns, 0.0).traversed_once(1e-3).expect("several turns");
            assert!((once.period - 6.0 / turns as f64).abs() < 1e-15, "{turns}: {}", once.period);
            for phase in [0.0, 0.2, 0.7] {
                let state = once.state_at(phase * once.period);
                assert!((state[0] - (TAU * phase).cos()).abs() < 1e-3, "{turns}: {state:?}");
            }
        }
    }

    #[test]
    fn an_orbit_that_rests_has_no_turns() {
        let mut resting = orbit(1, 0.0);
        for state in resting.states.chunks_exact_mut(3) {
            state.copy_from_slice(&[1.0, 1.0 + 1e-7 * state[1], 2.0]);
        }
        assert_eq!(resting.traversed_once(1e-3), None);
    }

    #[test]
    fn a_doubled_cycle_and_a_single_one_are_left() {
        assert_eq!(orbit(1, 0.0).traversed_once(1e-3), None);
        assert_eq!(orbit(2, 0.01).traversed_once(1e-3), None);
    }
}
