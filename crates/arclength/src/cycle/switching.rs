//! Where new branches of cycles start: small cycles next to a Hopf point, doubled cycles, the other branch at a branch point.
//!
//! At a branch point the null space of the linearised problem is spanned by `(v, beta, 0)`, with the null function `v`, and
//! a vector `(y, tau, 1)` in which the parameter varies. The directions `a (v, beta, 0) + (y, tau, 1)` of the branches solve
//! the algebraic branching equation, the part of the second-order terms along the adjoint null function (Keller, "Numerical
//! solution of bifurcation and nonlinear eigenvalue problems" (1977); Doedel, Keller and Kernevez (1991), section 2.4).

use super::eigenfunctions::Eigenfunctions;
use super::expansion::Expansion;
use super::hopf_start::HopfStart;
use super::normal_form::CriticalCycle;
use super::orbit::Orbit;
use crate::collocation::gauss::Gauss;
use crate::collocation::linear_problem::{LinearProblem, NodeFunction};
use crate::equilibrium::multilinear::MultilinearForms;
use crate::error::Error;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Mesh intervals of the first cycle next to a Hopf point.
const FIRST_INTERVALS: usize = 8;
/// Part of the derivative in the parameter that no change of the cycle answers, above which the parameter cannot move.
const UNSOLVED: f64 = 1e-3;
/// Below this part of the other coefficients of the branching equation a coefficient counts as zero.
const NEGLIGIBLE: f64 = 1e-6;

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

/// The other branch at a branch point; `tangent` is the direction `(states, T, p)` of the known one, `active` the index of
/// the parameter that varies, `scale` its size.
pub(super) fn other_branch(
    orbit: &Orbit,
    (functions, _): &Eigenfunctions,
    critical: &CriticalCycle<'_>,
    (active, scale): (usize, f64),
    tangent: &[f64],
) -> Option<Branching> {
    let n = orbit.dimension;
    let CriticalCycle { field, parameters, states, linearization: linear, .. } = critical;
    let adjoint = functions.first()?;
    let (null, beta) = linear.null_function()?;
    let flow_row = linear.dual(&linear.flow);
    let row = linear.dual(&null);
    let columns: [&[f64]; 2] = [&linear.flow, &null];
    let mut problem =
        LinearProblem::new(linear.nodes, vec![1.0; n], &linear.matrices, &columns, &[&flow_row, &row])?;
    // The parameter moves by its size, so that both vectors are of order one.
    let source: NodeFunction = linear.parameter.iter().map(|value| value * scale).collect();
    let (response, scalars) = problem.solve(&source, &[0.0, 0.0])?;
    // Where something is conserved the parameter cannot move, and there are two null functions.
    let size = linear.nodes.product(&source, &linear.dual(&source)).sqrt();
    let moving = if scalars[1].abs() <= UNSOLVED * size.max(NEGLIGIBLE) {
        (response, scalars[0], scale)
    } else {
        let (second, beta) = linear.null_function_beside(Some(&null))?;
        (second, beta, 0.0)
    };
    let vectors = [(null, beta, 0.0), moving];
    let second = |one: &(NodeFunction, f64, f64), other: &(NodeFunction, f64, f64)| -> f64 {
        let derivative = |node: usize, vector: &(NodeFunction, f64, f64)| {
            let mut direction = vector.0[node * n..(node + 1) * n].to_vec();
            direction.resize(n + parameters.len(), 0.0);
            direction[n + active] = vector.2;
            direction
        };
        linear
            .nodes
            .gauss_points()
            .map(|(_, node, weight)| {
                let forms =
                    MultilinearForms { field: *field, state: &states[node * n..(node + 1) * n], parameters };
                let (first, last) = (derivative(node, one), derivative(node, other));
                let curvature = forms.real(&[&first, &last]);
                let (slope_first, slope_last) = (forms.real(&[&first]), forms.real(&[&last]));
                (0..n)
                    .map(|row| {
                        let value = orbit.period * curvature[row]
                            + one.1 * slope_last[row]
                            + other.1 * slope_first[row];
                        weight * adjoint[node * n + row] * value
                    })
                    .sum::<f64>()
            })
            .sum()
    };
    let (a, b, c) = (
        second(&vectors[0], &vectors[0]),
        second(&vectors[0], &vectors[1]),
        second(&vectors[1], &vectors[1]),
    );
    // a x^2 + 2 b x y + c y^2 = 0 for directions x (null) + y (response).
    let size = a.abs().max(b.abs()).max(c.abs());
    let discriminant = b * b - a * c;
    if !(discriminant > 0.0 && size > 0.0) {
        return None;
    }
    let root = discriminant.sqrt();
    let larger = -(b + root.copysign(b));
    let mut directions: Vec<(f64, f64)> = Vec::new();
    if a.abs() > NEGLIGIBLE * size {
        directions.push((larger / a, 1.0));
    } else {
        directions.push((1.0, 0.0));
    }
    directions.push(if larger == 0.0 { (0.0, 1.0) } else { (c / larger, 1.0) });
    let assemble = |(x, y): (f64, f64)| {
        let states: NodeFunction =
            vectors[0].0.iter().zip(&vectors[1].0).map(|(one, other)| x * one + y * other).collect();
        (states, x * vectors[0].1 + y * vectors[1].1, x * vectors[0].2 + y * vectors[1].2)
    };
    // The known branch is the one whose direction is closest to the tangent.
    let cosine = |direction: &(NodeFunction, f64, f64)| {
        let product = |a: &(&[f64], f64, f64), b: &(&[f64], f64, f64)| {
            linear.nodes.product(a.0, &linear.dual(b.0))
                + a.1 * b.1 / (orbit.period * orbit.period)
                + a.2 * b.2 / (scale * scale)
        };
        let end = tangent.len() - 2;
        let known = (&tangent[..end], tangent[end], tangent[end + 1]);
        let own = (&direction.0[..], direction.1, direction.2);
        product(&known, &own).abs() / (product(&known, &known) * product(&own, &own)).sqrt()
    };
    let mut found: Vec<_> = directions.into_iter().map(assemble).collect();
    found.sort_by(|one, other| cosine(one).total_cmp(&cosine(other)));
    let mut found = found.into_iter();
    let (direction, period, parameter) = found.next()?;
    let known = found.next().map(|(states, period, parameter)| BranchDirection { states, period, parameter });
    Some(Branching { orbit: orbit.clone(), direction, period, parameter, doubled: false, known })
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
