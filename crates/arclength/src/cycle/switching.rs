//! Where new branches of cycles start: small cycles next to a Hopf point, doubled cycles, the other branch at a branch point.

use super::eigenfunctions::Eigenfunctions;
use super::expansion::Expansion;
use super::hopf_start::HopfStart;
use super::orbit::Orbit;
use crate::collocation::gauss::Gauss;
use crate::error::Error;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Mesh intervals of the first cycle next to a Hopf point.
const FIRST_INTERVALS: usize = 8;

/// The start of a branch that leaves another one at a bifurcation: the cycle there, traversed twice at a period doubling, and
/// the direction of the new branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Branching {
    /// The cycle.
    pub orbit: Orbit,
    /// Change of the states along the new branch, in the layout of [`Orbit::states`].
    pub direction: Vec<f64>,
    /// Change of the period.
    pub period: f64,
    /// Change of the parameter along which the bifurcation was found.
    pub parameter: f64,
    /// Whether the cycle is one traversed twice.
    pub doubled: bool,
    /// The direction of the branch on which a branch point was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<BranchDirection>,
}

/// The direction of a branch of cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchDirection {
    /// Change of the states, in the layout of [`Orbit::states`].
    pub states: Vec<f64>,
    /// Change of the period.
    pub period: f64,
    /// Change of the parameter.
    pub parameter: f64,
}

impl Branching {
    /// That the numbers fit together and belong to a field of `dimension` states.
    ///
    /// # Errors
    /// [`Error::Invalid`] with what does not fit.
    pub fn check(&self, dimension: usize) -> Result<(), Error> {
        self.orbit.check(dimension)?;
        let fits = |states: &[f64], period: f64, parameter: f64| {
            states.len() == self.orbit.states.len()
                && states.iter().chain([&period, &parameter]).all(|value| value.is_finite())
        };
        let known = self.known.as_ref();
        if fits(&self.direction, self.period, self.parameter)
            && known.is_none_or(|known| fits(&known.states, known.period, known.parameter))
        {
            return Ok(());
        }
        Err(Error::Invalid {
            name: "direction of the new branch".into(),
            value: format!("{} numbers", self.direction.len()),
            allowed: format!("{} finite numbers", self.orbit.states.len()),
        })
    }

    /// The start, from the same branch point, of the branch on which it was found.
    pub fn known_branch(&self) -> Option<Self> {
        let known = self.known.clone()?;
        Some(Self {
            orbit: self.orbit.clone(),
            direction: known.states,
            period: known.period,
            parameter: known.parameter,
            doubled: false,
            known: Some(BranchDirection {
                states: self.direction.clone(),
                period: self.period,
                parameter: self.parameter,
            }),
        })
    }
}

/// The doubled branch at a period doubling.
pub(super) fn doubled(orbit: &Orbit, (functions, _): &Eigenfunctions) -> Option<Branching> {
    let function = functions.first()?;
    let half = |offset: f64| orbit.mesh.iter().map(move |time| 0.5 * (time + offset));
    let mesh: Vec<f64> = half(0.0).chain(half(1.0).skip(1)).collect();
    Some(Branching {
        direction: function.iter().copied().chain(function.iter().map(|value| -value)).collect(),
        orbit: Orbit { mesh, states: orbit.states.repeat(2), period: 2.0 * orbit.period, ..orbit.clone() },
        period: 0.0,
        parameter: 0.0,
        doubled: true,
        known: None,
    })
}

/// A start on a mesh: unknowns, direction of the branch, mesh and degree.
pub(super) struct Departure {
    pub unknown: Vec<f64>,
    pub tangent: Vec<f64>,
    pub mesh: Vec<f64>,
    pub degree: usize,
}

impl HopfStart<'_> {
    /// A small cycle next to the Hopf point, to first order in its amplitude, or to second with an expansion, and the direction of
    /// the branch.
    pub(super) fn cycle(
        &self,
        parameter: f64,
        amplitude: f64,
        expansion: Option<&Expansion>,
        degree: usize,
    ) -> Departure {
        let mesh: Vec<f64> =
            (0..=FIRST_INTERVALS).map(|index| index as f64 / FIRST_INTERVALS as f64).collect();
        let gauss = Gauss::of(degree);
        let square = amplitude * amplitude;
        let (mut unknown, mut tangent) = (Vec::new(), Vec::new());
        for pair in mesh.windows(2) {
            let nodes = std::iter::once(0.0).chain(gauss.points.iter().copied());
            for time in nodes.map(|node| pair[0] + node * (pair[1] - pair[0])) {
                let phase = Complex64::from_polar(2.0 * amplitude, 2.0 * PI * time);
                for (value, component) in self.state.iter().zip(self.eigenvector) {
                    let deviation = (component * phase).re;
                    unknown.push(value + deviation);
                    tangent.push(deviation);
                }
                if let Some(Expansion { mean, second_harmonic, .. }) = expansion {
                    let second = Complex64::from_polar(square, 4.0 * PI * time);
                    let states = unknown.iter_mut().rev().zip(mean.iter().zip(second_harmonic).rev());
                    states.for_each(|(state, (mean, harmonic))| {
                        *state += square * mean + (harmonic * second).re
                    });
                }
            }
        }
        let frequency = self.frequency + expansion.map_or(0.0, |expansion| square * expansion.frequency);
        let parameter = parameter + expansion.map_or(0.0, |expansion| square * expansion.parameter);
        unknown.extend([2.0 * PI / frequency, parameter]);
        tangent.extend([0.0, 0.0]);
        Departure { unknown, tangent, mesh, degree }
    }
}
