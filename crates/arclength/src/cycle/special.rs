//! Special cycles between two points of a branch: folds, period doublings and torus bifurcations, detected by
//! test functions and located by Newton's method on their defining systems.

use super::curve::{CycleCurve, CycleInspection};
use super::defining::Kind;
use super::locating::{Located, converge};
use super::normal_form::CriticalCycle;
use super::orbit::Orbit;
use super::switching::{doubled, other_branch};
use crate::collocation::problem::PeriodicProblem;
use crate::continuation::{Bracket, Solution, along};
use crate::error::Error;

/// What is special about a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Special {
    /// Fold of cycles (LPC).
    Fold,
    /// Period doubling (PD).
    Doubling,
    /// Torus bifurcation (NS) with the argument of its multipliers.
    Torus {
        /// In radians, between 0 and pi.
        argument: f64,
    },
    /// Branch point of cycles (BPC).
    BranchPoint,
}

/// Parts of the step to which a test function's zero is bracketed before Newton's method takes over, and tries again.
const START_TOLERANCES: [f64; 4] = [0.5, 1e-2, 1e-4, 1e-7];
/// Part of the range of the parameter by which it has to vary in a step for a fold to be told from rounding.
const PARAMETER_ROUNDING: f64 = 1e-13;
/// Perturbation of the field at a branch point, relative to its size over one period, below which it is one of the field itself:
/// a part of the tolerance of the cycles, whose mesh may break a symmetry by so much, and never less than this.
const UNPERTURBED_PART: f64 = 0.1;
const UNPERTURBED: f64 = 1e-10;
/// A step longer than this, in the metric, over a branch point that is none of the field itself is shortened.
const SHORTEST_JUMP: f64 = 1e-4;
/// A special cycle may lie this part of the step outside it.
const MARGIN: f64 = 0.1;

/// All special cycles between two consecutive solutions.
///
/// # Errors
/// [`Error::OtherBranch`] if the orientation changes where there is no branch point, or only one of a perturbed field: then the
/// step has led to another branch.
pub(super) fn between(
    curve: &mut CycleCurve<'_>,
    before: &Solution<CycleInspection>,
    after: &Solution<CycleInspection>,
) -> Result<Vec<Solution<CycleInspection>>, Error> {
    let changes = |a: f64, b: f64| a * b < 0.0;
    let fold = changes(before.point.fold_test, after.point.fold_test);
    let branch_point = changes(before.orientation, after.orientation);
    let doubling = changes(before.point.doubling_test(), after.point.doubling_test());
    let (outside_before, _) = before.point.floquet.unstable();
    let (outside_after, _) = after.point.floquet.unstable();
    let explained = usize::from(fold) + usize::from(branch_point) + usize::from(doubling);
    let pairs = outside_before.abs_diff(outside_after).saturating_sub(explained) / 2;
    let mut found = Vec::new();
    let sign = before.orientation;
    let direction: Vec<f64> = before.tangent.iter().zip(&after.tangent).map(|(a, b)| 0.5 * (a + b)).collect();
    // Each with its rank: pairs that cross together are told apart by it.
    let single = [(branch_point, Kind::BranchPoint), (fold, Kind::Fold), (doubling, Kind::Doubling)];
    let wanted = single.into_iter().filter(|(detected, _)| *detected).map(|(_, kind)| (kind, 0));
    let tori = (0..pairs).map(|pair| (Kind::Torus, outside_before.min(outside_after) + 2 * pair));
    let length = along(curve, before, &after.unknown);
    // On the explosion of a canard the parameter may vary by its rounding only.
    let variation = length * before.point.fold_test.abs().max(after.point.fold_test.abs());
    let varies = variation > PARAMETER_ROUNDING;
    let resolved = ![before, after].iter().any(|solution| solution.point.floquet.is_contradictory());
    let unperturbed = (UNPERTURBED_PART * curve.resolution.tolerance).max(UNPERTURBED);
    for (kind, rank) in wanted.chain(tori) {
        let settings = curve.settings;
        let mut located = None;
        let test = |_: &mut CycleCurve<'_>, solution: &Solution<CycleInspection>| {
            let point = &solution.point;
            match kind {
                Kind::Fold => Some(point.fold_test),
                Kind::Doubling => Some(point.doubling_test()),
                Kind::Torus => torus_test(point, rank),
                Kind::BranchPoint => branch_point_test(solution, sign),
            }
        };
        // The tests of all but folds are multipliers.
        let decidable = if kind == Kind::Fold { varies } else { resolved };
        let mut bracket = decidable.then(|| Bracket::new(curve, before, after, test)).flatten();
        for tolerance in START_TOLERANCES {
            let Some(bracket) = &mut bracket else { break };
            let converged = match bracket.narrow(curve, &settings, tolerance, test) {
                Ok(Some(start)) => converge(curve, &direction, start, kind)?,
                // Next to a branch point the equations of the branch are singular, but its ends are good starts.
                Ok(None) | Err(Error::NotFound { .. }) if kind == Kind::BranchPoint => {
                    let ends = [before, after].into_iter();
                    let distance = |end: &Solution<CycleInspection>| {
                        branch_point_test(end, sign).map_or(f64::INFINITY, f64::abs)
                    };
                    let nearest = ends.min_by(|one, other| distance(one).total_cmp(&distance(other)));
                    nearest.map(|start| converge(curve, &direction, start, kind)).transpose()?.flatten()
                }
                Ok(None) | Err(Error::NotFound { .. }) => None,
                Err(error) => return Err(error),
            };
            // Newton's method may have left for a special cycle elsewhere.
            located = converged.filter(|located| {
                let position = along(curve, before, &located.solution.unknown);
                let perturbation = located.eigenfunctions.1.first().filter(|_| kind == Kind::BranchPoint);
                (-MARGIN * length..=(1.0 + MARGIN) * length).contains(&position)
                    && perturbation.is_none_or(|perturbation| perturbation.abs() < unperturbed)
            });
            if located.is_some() {
                break;
            }
        }
        match located {
            Some(located) => found.push(describe(curve, located, kind)?),
            // On the branch that turns at a pitchfork the parameter turns too, but that is no fold.
            None if kind == Kind::Fold && at_branch_point(&found) => {}
            None if kind == Kind::BranchPoint && resolved && length > SHORTEST_JUMP => {
                return Err(Error::OtherBranch);
            }
            None => {
                let [from, to] = [before, after].map(|solution| solution.unknown[solution.unknown.len() - 1]);
                // Rounding may change a sign in step after step.
                match curve.unlocated.last_mut() {
                    Some(last) if last.test == name(kind) && last.between[1] == from => last.between[1] = to,
                    _ => curve.unlocated.push(Unlocated { test: name(kind), between: [from, to] }),
                }
            }
        }
    }
    Ok(found)
}

fn at_branch_point(found: &[Solution<CycleInspection>]) -> bool {
    found.iter().any(|solution| solution.point.special == Some(Special::BranchPoint))
}

fn name(kind: Kind) -> &'static str {
    match kind {
        Kind::Fold => "fold of cycles",
        Kind::Doubling => "period doubling",
        Kind::Torus => "torus bifurcation",
        Kind::BranchPoint => "branch point of cycles",
    }
}

/// The located cycle with its normal form and the branch that leaves it.
fn describe(
    curve: &mut CycleCurve<'_>,
    located: Located,
    kind: Kind,
) -> Result<Solution<CycleInspection>, Error> {
    let Located { mut solution, eigenfunctions } = located;
    let end = solution.unknown.len() - 2;
    let mut residual = vec![0.0; solution.unknown.len()];
    curve.collocation.factorize(&solution.unknown, &solution.tangent, &mut residual);
    let critical = CriticalCycle::of(&curve.collocation, &solution.unknown);
    let orbit = Orbit {
        mesh: curve.collocation.mesh().to_vec(),
        degree: curve.collocation.gauss().degree(),
        dimension: curve.collocation.problem.dimension(),
        states: solution.unknown[..end].to_vec(),
        period: solution.unknown[end],
    };
    let point = &mut solution.point;
    (point.special, point.normal_form, point.branching) = match kind {
        Kind::Fold => {
            // MatCont's scaling does not exist where the period stands still, as it does in a forced oscillator.
            let named = critical.fold(&eigenfunctions).map(|(own, scaled)| match scaled {
                Some(value) => ("quadratic_coefficient", value),
                None => ("quadratic_coefficient_of_unit_function", own),
            });
            (Some(Special::Fold), named.into_iter().collect(), None)
        }
        Kind::Doubling => {
            let coefficient = critical.doubling(&eigenfunctions);
            let named = coefficient.map(|value| ("cubic_coefficient", value));
            (Some(Special::Doubling), named.into_iter().collect(), doubled(&orbit, &eigenfunctions))
        }
        Kind::Torus => {
            let argument = eigenfunctions.1[0].abs();
            let mut named = vec![("argument", argument)];
            if let Some([real, imaginary]) = critical.torus(&eigenfunctions) {
                named.extend([("cubic_coefficient", real), ("cubic_coefficient_imaginary", imaginary)]);
            }
            (Some(Special::Torus { argument }), named, None)
        }
        Kind::BranchPoint => {
            let other = other_branch(
                &orbit,
                &eigenfunctions,
                &critical,
                (curve.collocation.problem.active, curve.parameter_scale),
                &solution.tangent,
            );
            (Some(Special::BranchPoint), Vec::new(), other)
        }
    };
    Ok(solution)
}

/// A change of a test function behind which no special cycle could be located.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unlocated {
    /// What the test function stands for.
    pub test: &'static str,
    /// Parameter values between which it changed.
    pub between: [f64; 2],
}

/// Logarithm of the modulus of the positive multiplier nearest to one, signed by the orientation.
fn branch_point_test(solution: &Solution<CycleInspection>, sign: f64) -> Option<f64> {
    let multipliers = &solution.point.floquet.nontrivial;
    let positive = multipliers.iter().filter(|multiplier| multiplier.argument == 0.0);
    let nearest = positive.map(|multiplier| multiplier.log_modulus.abs()).fold(f64::INFINITY, f64::min);
    nearest.is_finite().then_some(if solution.orientation == sign { -nearest } else { nearest })
}

/// Logarithm of the modulus of the pair that changes sides when the multipliers are counted from outside: the
/// multiplier behind the `fixed` largest ones.
fn torus_test(point: &CycleInspection, fixed: usize) -> Option<f64> {
    point.floquet.nontrivial.get(fixed).map(|multiplier| multiplier.log_modulus)
}
