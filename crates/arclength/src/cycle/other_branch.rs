//! The other branch at a branch point of cycles.
//!
//! There the null space of the linearised problem is spanned by `(v, beta, 0)`, with the null function `v`, and a vector
//! `(y, tau, 1)` in which the parameter varies. The directions `a (v, beta, 0) + (y, tau, 1)` of the branches solve
//! the algebraic branching equation, the part of the second-order terms along the adjoint null function (Keller, "Numerical
//! solution of bifurcation and nonlinear eigenvalue problems" (1977); Doedel, Keller and Kernevez (1991), section 2.4).

use super::eigenfunctions::Eigenfunctions;
use super::normal_form::CriticalCycle;
use super::orbit::Orbit;
use super::switching::{BranchDirection, Branching};
use crate::collocation::linear_problem::{LinearProblem, NodeFunction};
use crate::equilibrium::multilinear::MultilinearForms;

/// Part of the derivative in the parameter that no change of the cycle answers, above which the parameter cannot move.
const UNSOLVED: f64 = 1e-3;
/// Below this part of the other coefficients of the branching equation a coefficient counts as zero.
const NEGLIGIBLE: f64 = 1e-6;

/// The other branch at a branch point; `tangent` is the direction `(states, T, p)` of the known one, `active` the index of
/// the parameter that varies, `scale` its size.
pub(super) fn other_branch(
    orbit: &Orbit,
    (functions, _): &Eigenfunctions,
    critical: &CriticalCycle<'_>,
    (active, scale): (usize, f64),
    tangent: &[f64],
) -> Option<Branching> {
    let adjoint = functions.first()?;
    let [null, moving] = null_space(critical, scale)?;
    let equation = BranchingEquation { critical, adjoint, period: orbit.period, active };
    let coefficients =
        [(&null, &null), (&null, &moving), (&moving, &moving)].map(|(one, other)| equation.part(one, other));
    let mut found = roots(coefficients)?.map(|(x, y)| combination(x, &null, y, &moving));
    // The known branch is the one whose direction is closest to the tangent.
    let (states, scalars) = tangent.split_at(tangent.len() - 2);
    let tangent = BranchDirection { states: states.to_vec(), period: scalars[0], parameter: scalars[1] };
    let product = |a: &BranchDirection, b: &BranchDirection| {
        let linear = &critical.linearization;
        linear.nodes.product(&a.states, &linear.dual(&b.states))
            + a.period * b.period / (orbit.period * orbit.period)
            + a.parameter * b.parameter / (scale * scale)
    };
    let cosine = |own: &BranchDirection| {
        product(&tangent, own).abs() / (product(&tangent, &tangent) * product(own, own)).sqrt()
    };
    found.sort_by(|one, other| cosine(one).total_cmp(&cosine(other)));
    let [BranchDirection { states, period, parameter }, known] = found;
    let orbit = orbit.clone();
    Some(Branching { orbit, direction: states, period, parameter, doubled: false, known: Some(known) })
}

/// The two directions that span the null space: one in which the parameter stays, and one in which it moves by its size `scale` if it can.
fn null_space(critical: &CriticalCycle<'_>, scale: f64) -> Option<[BranchDirection; 2]> {
    let linear = &critical.linearization;
    let (null, beta) = linear.null_function()?;
    let flow_row = linear.dual(&linear.flow);
    let row = linear.dual(&null);
    let columns: [&[f64]; 2] = [&linear.flow, &null];
    let signs = vec![1.0; linear.scales.len()];
    let mut problem =
        LinearProblem::new(linear.nodes, signs, &linear.matrices, &columns, &[&flow_row, &row])?;
    // The parameter moves by its size, so that both vectors are of order one.
    let source: NodeFunction = linear.parameter.iter().map(|value| value * scale).collect();
    let (response, scalars) = problem.solve(&source, &[0.0, 0.0])?;
    // Where something is conserved the parameter cannot move, and there are two null functions.
    let size = linear.nodes.product(&source, &linear.dual(&source)).sqrt();
    let moving = if scalars[1].abs() <= UNSOLVED * size.max(NEGLIGIBLE) {
        BranchDirection { states: response, period: scalars[0], parameter: scale }
    } else {
        let (second, beta) = linear.null_function_beside(Some(&null))?;
        BranchDirection { states: second, period: beta, parameter: 0.0 }
    };
    Some([BranchDirection { states: null, period: beta, parameter: 0.0 }, moving])
}

/// The second-order terms along the adjoint null function.
struct BranchingEquation<'a> {
    critical: &'a CriticalCycle<'a>,
    adjoint: &'a [f64],
    period: f64,
    /// Index of the parameter that varies.
    active: usize,
}

impl BranchingEquation<'_> {
    /// Their part along two directions.
    fn part(&self, one: &BranchDirection, other: &BranchDirection) -> f64 {
        let CriticalCycle { field, parameters, states, linearization: linear, .. } = self.critical;
        let n = linear.scales.len();
        let at_node = |node: usize, vector: &BranchDirection| {
            let mut direction = vector.states[node * n..(node + 1) * n].to_vec();
            direction.resize(n + parameters.len(), 0.0);
            direction[n + self.active] = vector.parameter;
            direction
        };
        let points = linear.nodes.gauss_points().map(|(_, node, weight)| {
            let state = &states[node * n..(node + 1) * n];
            let forms = MultilinearForms { field: *field, state, parameters };
            let (first, last) = (at_node(node, one), at_node(node, other));
            let curvature = forms.real(&[&first, &last]);
            let (slope_first, slope_last) = (forms.real(&[&first]), forms.real(&[&last]));
            (0..n)
                .map(|row| {
                    let value = self.period * curvature[row]
                        + one.period * slope_last[row]
                        + other.period * slope_first[row];
                    weight * self.adjoint[node * n + row] * value
                })
                .sum::<f64>()
        });
        points.sum()
    }
}

/// The solutions `(x, y)` of `a x^2 + 2 b x y + c y^2 = 0`, if there are two.
fn roots([a, b, c]: [f64; 3]) -> Option<[(f64, f64); 2]> {
    let size = a.abs().max(b.abs()).max(c.abs());
    let discriminant = b * b - a * c;
    if !(discriminant > 0.0 && size > 0.0) {
        return None;
    }
    let larger = -(b + discriminant.sqrt().copysign(b));
    let first = if a.abs() > NEGLIGIBLE * size { (larger / a, 1.0) } else { (1.0, 0.0) };
    let second = if larger == 0.0 { (0.0, 1.0) } else { (c / larger, 1.0) };
    Some([first, second])
}

fn combination(x: f64, one: &BranchDirection, y: f64, other: &BranchDirection) -> BranchDirection {
    let states = one.states.iter().zip(&other.states).map(|(one, other)| x * one + y * other);
    BranchDirection {
        states: states.collect(),
        period: x * one.period + y * other.period,
        parameter: x * one.parameter + y * other.parameter,
    }
}
