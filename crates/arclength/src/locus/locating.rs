//! Locates points of codimension two that were bracketed on a curve.

use super::codimension_two::CodimensionTwoPoint;
use super::curve::{EquilibriumLocusInspection, LocusCurve};
use super::newton::{Newton, newton};
use super::normal_form;
use crate::algebraic::length;
use crate::branch::SpecialKind;
use crate::continuation::{Solution, correct, finish, locate};
use crate::equilibrium::coefficient_error::UncertainEquilibrium;
use crate::equilibrium::spectrum::{critical_pair, without};
use crate::error::Error;
use num_complex::Complex64;

/// Lengths, as parts of a bracket, to which it is shortened before Newton's method is tried, and tried again.
const BRACKETS: [f64; 2] = [1e-2, 1e-6];
/// The same where there is no Newton's method: for generalised Hopf points and degenerate ones.
const LAST_BRACKET: f64 = 1e-12;
/// A test function that is larger than this where it is smallest has a pole and no zero.
const POLE: f64 = 1e-3;
/// A located point may be this many bracket lengths away from the bracket.
const NEAR: f64 = 1.0;

type Node = Solution<EquilibriumLocusInspection>;

/// The point of codimension two between two neighbours; `None` if a test function has a pole there or the point is not of the
/// kind sought (two real eigenvalues of opposite sign are no Hopf-Hopf point).
pub(super) fn codimension_two(
    curve: &mut LocusCurve<'_>,
    before: &Node,
    after: &Node,
    distance: f64,
    kind: SpecialKind,
) -> Result<Option<Node>, Error> {
    // On a curve of branch points the defining systems of the others are singular; where a quantity is held the curve itself
    // says where a point lies.
    let by_secant = kind == SpecialKind::GeneralizedHopf
        || matches!(curve.system.problem.kind(), None | Some(SpecialKind::BranchPoint));
    if !by_secant {
        for tolerance in BRACKETS {
            let near = near_zero(curve, before, after, tolerance, kind);
            match newton(curve, &near, kind)? {
                Newton::Solved(solved, frequencies) => {
                    let mut unknown = near.unknown.clone();
                    let n = curve.states.len();
                    let end = unknown.len() - 2;
                    unknown[..n].copy_from_slice(&solved.unknown[..n]);
                    unknown[end..].copy_from_slice(&solved.unknown[solved.unknown.len() - 2..]);
                    let update = &solved.last_update[solved.last_update.len() - 2..];
                    let error = [0, 1]
                        .map(|index| update[index].abs().max(f64::EPSILON * unknown[end + index].abs()));
                    let offset: Vec<f64> = unknown.iter().zip(&near.unknown).map(|(a, b)| a - b).collect();
                    if length(&offset, &curve.system.scales) > NEAR * distance {
                        continue;
                    }
                    let spectrum = curve.spectrum(&unknown)?;
                    if frequencies.iter().all(|&frequency| spectrum.has_pair(frequency, true)) {
                        let mut here = solution_at(curve, &near, &unknown).unwrap_or(near);
                        let own = &mut here.point.monitor.frequency;
                        *own = own.and(frequencies.first().copied());
                        // Where eigenvalues are on the axis their test function may be undefined; its limit is zero.
                        if here.point.monitor.test(kind).is_none() {
                            here.point.monitor.add(kind, 0.0);
                        }
                        return Ok(Some(complete(curve, here, unknown, error, kind, true)?));
                    }
                }
                Newton::OtherKind => return Ok(None),
                Newton::Failed => {}
            }
        }
    }
    let near = near_zero(curve, before, after, LAST_BRACKET, kind);
    let smallest = near.point.monitor.test(kind).map_or(f64::INFINITY, f64::abs);
    let ends = [before, after]
        .iter()
        .filter_map(|node| node.point.monitor.test(kind))
        .map(f64::abs)
        .fold(0.0, f64::max);
    if smallest > POLE * ends.max(POLE) {
        return Ok(None);
    }
    // The parameters are known as well as the test function is, which is accurate to about the square root of rounding at
    // worst: its slope along the bracket gives the error.
    let end = near.unknown.len() - 2;
    let part = LAST_BRACKET.max(smallest / ends.max(f64::MIN_POSITIVE));
    // Where Newton's method fails the point is degenerate: its defining system has a double zero there at least, known to the
    // root, and so has the curve on which it lies.
    let part = if by_secant { part } else { part.powf(DEGENERATE) };
    let error = [0, 1].map(|index| {
        let change = (after.unknown[end + index] - before.unknown[end + index]).abs();
        (part * change).max(f64::EPSILON * near.unknown[end + index].abs())
    });
    let unknown = near.unknown.clone();
    // Two real eigenvalues of opposite sign are no pair on the axis.
    let zero = [Complex64::ZERO];
    let removed = if kind == SpecialKind::Hopf { &zero[..0] } else { &zero };
    let eigenvalues = without(&near.point.spectrum.eigenvalues, removed);
    let pair = critical_pair(&eigenvalues);
    let has_pair = matches!(kind, SpecialKind::ZeroHopf | SpecialKind::Hopf);
    if by_secant && has_pair && pair.is_none_or(|pair| pair[0].im == 0.0) {
        return Ok(None);
    }
    Ok(Some(complete(curve, near, unknown, error, kind, by_secant)?))
}

/// Power of the part of a bracket that is left of it at a degenerate point.
const DEGENERATE: f64 = 0.25;

/// A solution close to the zero of a test function.
fn near_zero(
    curve: &mut LocusCurve<'_>,
    before: &Node,
    after: &Node,
    tolerance: f64,
    kind: SpecialKind,
) -> Node {
    let settings = curve.settings;
    match locate(curve, before, after, &settings, tolerance, |_, solution| solution.point.monitor.test(kind))
    {
        Ok(Some(near)) => near,
        _ => {
            let value = |node: &Node| node.point.monitor.test(kind).map_or(f64::INFINITY, f64::abs);
            if value(before) < value(after) { before.clone() } else { after.clone() }
        }
    }
}

/// The solution of the curve at the equilibrium and the parameters in `unknown`, so that eigenvectors, frequency and test
/// functions are those of the located point and not of its neighbour `near`.
fn solution_at(curve: &mut LocusCurve<'_>, near: &Node, unknown: &[f64]) -> Option<Node> {
    let (n, end) = (curve.states.len(), unknown.len() - 2);
    // Of states and parameters the one that the curve moves most tells its points apart, also where both parameters turn.
    let speed = |place: usize| (near.tangent[place] / curve.system.scales[place]).abs();
    let place = (0..n).chain([end, end + 1]).max_by(|&one, &other| speed(one).total_cmp(&speed(other)))?;
    let mut border = vec![0.0; unknown.len()];
    border[place] = 1.0;
    let mut corrected = unknown.to_vec();
    let settings = curve.settings;
    correct(curve, &mut corrected, &border, &settings).ok()?;
    finish(curve, corrected, &near.tangent).ok()
}

/// The located point as a solution of the curve.
fn complete(
    curve: &mut LocusCurve<'_>,
    near: Node,
    unknown: Vec<f64>,
    location_error: [f64; 2],
    kind: SpecialKind,
    regular: bool,
) -> Result<Node, Error> {
    let n = curve.states.len();
    let end = unknown.len() - 2;
    let spectrum = curve.spectrum(&unknown)?;
    let values = [unknown[unknown.len() - 2], unknown[unknown.len() - 1]];
    let problem = curve.system.problem.equilibria();
    let parameters = problem.parameters_at(&values);
    let active = [problem.active[0], problem.active[1]];
    let frequency = near.point.monitor.frequency;
    let part =
        location_error.iter().zip(curve.ranges).map(|(error, range)| error / range).fold(0.0, f64::max);
    let scales = [&curve.states[..], &curve.ranges[..]].concat();
    let equilibrium = UncertainEquilibrium {
        state: &unknown[..n],
        parameters: &parameters,
        active: &active,
        scales: &scales,
        location_error: part,
    };
    let coefficients = normal_form::with_errors(equilibrium, |state, parameters| {
        normal_form::coefficients(kind, problem.field, state, parameters, &curve.states, frequency)
    });
    let point = CodimensionTwoPoint {
        kind,
        parameters,
        active,
        values,
        location_error,
        state: unknown[..n].to_vec(),
        eigenvalues: spectrum.eigenvalues.clone(),
        coefficients,
        regular,
    };
    let mut node = near;
    node.unknown[..n].copy_from_slice(&unknown[..n]);
    node.unknown[end..].copy_from_slice(&unknown[end..]);
    node.point.spectrum = spectrum;
    // Those of the neighbour do not hold here.
    if kind == SpecialKind::BogdanovTakens {
        node.point.monitor.frequency = None;
    }
    if kind != SpecialKind::GeneralizedHopf {
        node.point.monitor.first_lyapunov = None;
    }
    node.point.special = Some(Box::new(point));
    Ok(node)
}
