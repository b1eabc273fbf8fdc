//! Special cycles between two points of a branch: folds, period doublings, torus bifurcations and branch points, bracketed by
//! their test functions and located by Newton's method on their defining systems, with their normal forms.

use super::curve::{CycleCurve, CycleInspection, Fitted};
use super::defining::Kind;
use super::eigenfunctions::critical;
use super::floquet::{Floquet, multiplier_changes};
use super::locating::{Finer, Located, converge, on_halves, rounded};
use super::normal_form::CriticalCycle;
use super::orbit::Orbit;
use super::other_branch::other_branch;
use super::switching::doubled;
use crate::branch::SpecialKind;
use crate::collocation::mesh::halved;
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::events::{Event, Location};
use crate::continuation::{Bracket, Curve, Equations, Solution, along};
use crate::error::Error;
use crate::linear::multiplier::Multiplier;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Parts of the step to which a test function's zero is bracketed before Newton's method takes over, and tries again.
const START_TOLERANCES: [f64; 4] = [0.5, 1e-2, 1e-4, 1e-7];
/// Perturbation of the field at a branch point, relative to its size over one period, below which it is one of the field itself:
/// the error of the cycle there, whose mesh may break a symmetry by so much, a part of the tolerance, and never less than this.
const UNPERTURBED_PART: f64 = 0.1;
const UNPERTURBED: f64 = 1e-10;
/// No coefficient is told to be more exact than this part of itself.
const LEAST_ERROR: f64 = 1e-13;
/// Part of the step to which the place is bracketed where a multiplier passes one.
const PASSING: f64 = 1e-12;
/// A special cycle may lie this part of the step, and this far in the metric, outside it: cycles are known to the tolerance of
/// Newton's method only, and close to homoclinic orbits brackets are shorter than what comes of it.
const MARGIN: f64 = 0.01;
const LEAST_MARGIN: f64 = 1e-5;
/// Times that the intervals are halved, at most, where multipliers refute a special cycle.
const MOST_HALVINGS: usize = 3;
/// Relative difference of period and parameter up to which a special cycle is the same on two meshes.
const SAME_PLACE: f64 = 1e-6;
/// What rounding of the unknowns does to multipliers counts this many times: each of some hundred blocks, whose product has them, is
/// rounded too.
const UNCERTAIN: f64 = 100.0;

type Node = Solution<CycleInspection>;

/// The defining system of a kind of special cycles.
fn defining(kind: SpecialKind) -> Option<Kind> {
    match kind {
        SpecialKind::FoldOfCycles => Some(Kind::Fold),
        SpecialKind::PeriodDoubling => Some(Kind::Doubling),
        SpecialKind::Torus => Some(Kind::Torus),
        SpecialKind::BranchPointOfCycles => Some(Kind::BranchPoint),
        _ => None,
    }
}

/// Distance of the logarithm of a multiplier from that of a special cycle beyond which it is another one.
const CRITICAL: f64 = 0.05;

/// The special cycle of a kind between two solutions.
///
/// # Errors
/// [`Error::OtherBranch`] if the orientation changes where there is no branch point, or only one of a perturbed field: then the
/// step has led to another branch.
pub(super) fn locate(
    curve: &mut CycleCurve<'_>,
    kind: SpecialKind,
    [before, after]: [&Node; 2],
) -> Result<Location<CycleInspection>, Error> {
    let Some(defining) = defining(kind) else { return Ok(Location::Nothing) };
    // The pair that changes sides when the multipliers are counted from outside.
    let outside = [before, after].map(|node| node.point.floquet.unstable().count);
    let rank = outside[0].min(outside[1]);
    if kind == SpecialKind::Torus && !is_pair_between(before, after, rank) {
        return Ok(Location::Nothing);
    }
    let mut located = newton(curve, defining, [before, after], rank)?;
    if defining == Kind::Fold
        && before.point.floquet.nontrivial.len() == 1
        && located.as_ref().is_none_or(|located| !is_critical(&located.solution.point.floquet, defining))
    {
        located = passing_one(curve, [before, after])?;
    }
    match located {
        // The defining system may have a solution where the mesh does not resolve the multipliers: they have to agree.
        Some(mut located) if !is_critical(&located.solution.point.floquet, defining) => {
            if let Some(solution) = on_finer_mesh(curve, &located.solution, [before, after], defining)? {
                return Ok(Location::At(solution));
            }
            let is_certain = is_passed(&located.solution, [before, after], defining)
                && stays(curve, &located, &rounded(curve, &located, defining));
            let known = is_certain
                .then(|| located.solution.point.floquet.with_critical(defining.critical()?))
                .flatten();
            match known {
                Some(floquet) => {
                    located.solution.point.floquet = floquet;
                    Ok(Location::At(describe(curve, located, defining)?))
                }
                None => Ok(Location::Missed),
            }
        }
        Some(located) => Ok(Location::At(describe(curve, located, defining)?)),
        None if defining == Kind::BranchPoint
            && along(curve, before, &after.unknown) > curve.settings.shortest_jump =>
        {
            Err(Error::OtherBranch)
        }
        None => Ok(Location::Missed),
    }
}

/// Whether a multiplier is where a special cycle of the kind has one.
fn is_critical(floquet: &Floquet, kind: Kind) -> bool {
    let (argument, real) = match kind {
        Kind::Fold | Kind::BranchPoint => (Some(0.0), true),
        Kind::Doubling => (Some(PI), true),
        Kind::Torus => (None, false),
        Kind::Cycle => return true,
    };
    floquet.nontrivial.iter().any(|multiplier| {
        let away = argument.map_or(0.0, |argument| (multiplier.argument.abs() - argument).abs());
        // Next to a resonance two real ones may be a pair by rounding.
        (multiplier.is_real() == real || away < CRITICAL) && multiplier.log_modulus.abs().max(away) < CRITICAL
    })
}

/// The fold between two solutions in the plane where the multiplier passes one. On the explosion of a canard the parameter does not
/// change to its last digit, so that its extreme value is anywhere, but the integral of the divergence is known.
fn passing_one(curve: &mut CycleCurve<'_>, [before, after]: [&Node; 2]) -> Result<Option<Located>, Error> {
    let settings = curve.settings;
    let mut test = |_: &mut CycleCurve<'_>, solution: &Node| {
        solution.point.floquet.nontrivial.first().map(|multiplier| multiplier.log_modulus)
    };
    let Some(mut bracket) = Bracket::new(curve, before, after, &mut test) else { return Ok(None) };
    let mut solution = match bracket.narrow(curve, &settings, PASSING, &mut test) {
        Ok(Some(solution)) if is_critical(&solution.point.floquet, Kind::Fold) => solution.clone(),
        Ok(_) | Err(Error::NotFound { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    let mut residual = vec![0.0; solution.unknown.len()];
    curve.factorize(&solution.unknown, &solution.tangent, &mut residual);
    let error = curve.global_error.of(&mut curve.collocation, &solution.unknown);
    solution.point.parameter_error = error.last().map(|error| error.abs());
    let multipliers = solution.point.floquet.multipliers();
    let place = (&solution.unknown[..], false);
    let eigenfunctions = critical(&mut curve.collocation, place, &multipliers, Kind::Fold)?;
    Ok(eigenfunctions.map(|eigenfunctions| Located { solution, eigenfunctions }))
}

/// The special cycle next to one that its own multipliers refute, on the first finer mesh where they do not, described there.
/// `None` where there is none.
///
/// Next to homoclinic orbits multipliers may change by orders of magnitude within the last digits of the cycle. One that is at the
/// same place on two meshes is there, if rounding moves its multipliers by as much as they are far from critical ones.
fn on_finer_mesh(
    curve: &CycleCurve<'_>,
    refuted: &Node,
    [before, after]: [&Node; 2],
    kind: Kind,
) -> Result<Option<Solution<CycleInspection>>, Error> {
    let (mut mesh, mut solution) = (curve.collocation.mesh().to_vec(), refuted.clone());
    let mut finer = None;
    for _ in 0..MOST_HALVINGS {
        if mesh.len() - 1 > curve.resolution.most_intervals {
            return Ok(None);
        }
        let coarse = finer.as_ref().unwrap_or(curve);
        mesh = halved(&mesh);
        let mut start = solution.clone();
        start.tangent = coarse.collocation.carry(&solution.tangent, &mesh);
        start.unknown = coarse.collocation.carry(&solution.unknown, &mesh);
        let mut fine = coarse.on_mesh(mesh.clone(), &start.unknown);
        let mut residual = vec![0.0; start.unknown.len()];
        fine.factorize(&start.unknown, &start.tangent, &mut residual);
        start.point = fine.inspect(&start.unknown, &start.tangent, 0.0)?;
        let tangent = start.tangent.clone();
        let Some(mut located) = converge(&mut fine, &tangent, &start, kind)? else { return Ok(None) };
        let floquet = located.solution.point.floquet.clone();
        let known = if is_critical(&floquet, kind) {
            Some(floquet)
        } else if let Some(critical) = kind.critical()
            && stays(curve, &located, std::slice::from_ref(&solution.unknown))
            && is_as_uncertain(&mut fine, &located, kind, critical)?
        {
            floquet.with_critical(critical)
        } else {
            None
        };
        if let Some(floquet) = known {
            located.solution.point.floquet = floquet;
            let mut solution = describe(&mut fine, located, kind)?;
            let (states, scalars) = solution.unknown.split_at(solution.unknown.len() - 2);
            solution.point.place = Some([scalars[0], scalars[1]]);
            solution.point.fitted.get_or_insert(Fitted { mesh, states: states.to_vec() });
            // Its place among its neighbours is that of the same point on their mesh.
            let position = along(curve, before, &refuted.unknown);
            let there = if position < 0.0 {
                before
            } else if position > along(curve, before, &after.unknown) {
                after
            } else {
                refuted
            };
            (solution.unknown, solution.tangent) = (there.unknown.clone(), there.tangent.clone());
            return Ok(Some(solution));
        }
        solution = located.solution;
        finer = Some(fine);
    }
    Ok(None)
}

/// Period and parameter among the unknowns of a cycle.
fn place(unknown: &[f64]) -> [f64; 2] {
    [2, 1].map(|from_end| unknown[unknown.len() - from_end])
}

/// Whether other solutions for a special cycle are at its place. Those with rounded unknowns are not where the parameter does not change
/// to its last digits, so that any cycle looks like a special one.
fn stays(curve: &CycleCurve<'_>, located: &Located, others: &[Vec<f64>]) -> bool {
    let here = place(&located.solution.unknown);
    others.iter().all(|other| is_same_place(place(other), here, curve.parameter_scale))
}

/// Whether periods and parameters of two special cycles agree.
pub(super) fn is_same_place(one: [f64; 2], other: [f64; 2], parameter_scale: f64) -> bool {
    (one[0] / other[0] - 1.0).abs().max((one[1] - other[1]).abs() / parameter_scale) < SAME_PLACE
}

/// Whether rounding alone leaves a special cycle where it is and changes its multipliers by as much as they differ from critical ones.
fn is_as_uncertain(
    curve: &mut CycleCurve<'_>,
    located: &Located,
    kind: Kind,
    critical: Multiplier,
) -> Result<bool, Error> {
    let rounded = rounded(curve, located, kind);
    if !stays(curve, located, &rounded) {
        return Ok(false);
    }
    let critical = critical.to_complex();
    let product = |floquet: &Floquet| {
        let distances = floquet.nontrivial.iter().map(|multiplier| multiplier.to_complex() - critical);
        distances.product::<Complex64>().re
    };
    let here = product(&located.solution.point.floquet);
    let tangent = &located.solution.tangent;
    let mut residual = vec![0.0; tangent.len()];
    let mut largest = 0.0_f64;
    for unknown in rounded {
        curve.factorize(&unknown, tangent, &mut residual);
        let point = curve.inspect(&unknown, tangent, 0.0)?;
        largest = largest.max((product(&point.floquet) - here).abs());
    }
    Ok(here.abs() <= UNCERTAIN * largest)
}

/// Whether something else than the multipliers at the point itself shows that it is passed between two others: next to homoclinic
/// orbits multipliers change by orders of magnitude within the last digits of the parameter. Multipliers of the kind have crossed the circle
/// between both ends, or the parameter has an extreme value.
fn is_passed(solution: &Node, ends: [&Node; 2], kind: Kind) -> bool {
    let outside = |node: &Node| {
        let floquet = &node.point.floquet;
        let argument = kind.critical().map(|critical| critical.argument);
        let outside = floquet.nontrivial.iter().filter(|multiplier| multiplier.log_modulus > 0.0);
        let count = outside.filter(|multiplier| Some(multiplier.argument) == argument).count();
        (!floquet.is_contradictory()).then_some(count)
    };
    let crosses = matches!(ends.map(outside), [Some(one), Some(other)] if one != other);
    let value = |node: &Node| node.unknown[node.unknown.len() - 1];
    let [one, other] = ends.map(|end| value(solution) - value(end));
    crosses || (kind == Kind::Fold && one * other >= 0.0)
}

/// Pairs of multipliers that cross the unit circle at one place, where the number of those outside changes by `change`.
///
/// # Errors
/// When a solution nearby cannot be computed.
pub(super) fn crossing(
    curve: &mut CycleCurve<'_>,
    [before, after]: [&Node; 2],
    change: usize,
) -> Result<Vec<Event<SpecialKind, CycleInspection>>, Error> {
    let outside = [before, after].map(|node| node.point.floquet.unstable().count);
    let mut found = Vec::new();
    for pair in 0..change / 2 {
        let rank = outside[0].min(outside[1]) + 2 * pair;
        let Some(located) = newton(curve, Kind::Torus, [before, after], rank)? else { return Ok(Vec::new()) };
        let solution = describe(curve, located, Kind::Torus)?;
        found.push(Event { kind: SpecialKind::Torus, is_located: true, solution });
    }
    Ok(found)
}

/// Whether a complex pair of multipliers crosses the unit circle between two solutions. The test function also changes its sign
/// where the product of two real ones is one.
fn is_pair_between(before: &Node, after: &Node, rank: usize) -> bool {
    let complex = |node: &Node| {
        let pairs = node.point.floquet.nontrivial.iter().filter(|multiplier| multiplier.argument > 0.0);
        let outside =
            pairs.clone().filter(|multiplier| !multiplier.is_real() && multiplier.log_modulus > 0.0);
        (pairs.filter(|multiplier| !multiplier.is_real()).count(), outside.count())
    };
    let [(count, outside), (other_count, other_outside)] = [before, after].map(complex);
    if count == other_count {
        return outside != other_outside;
    }
    // Real ones have met in between.
    [before, after]
        .iter()
        .any(|node| node.point.floquet.nontrivial.get(rank).is_some_and(|multiplier| !multiplier.is_real()))
}

/// Newton's method on the defining system from ever closer starts; for a torus bifurcation of the pair behind the `rank` largest
/// multipliers.
fn newton(
    curve: &mut CycleCurve<'_>,
    kind: Kind,
    [before, after]: [&Node; 2],
    rank: usize,
) -> Result<Option<Located>, Error> {
    let settings = curve.settings;
    let sign = before.orientation;
    let branch_point_test = |curve: &CycleCurve<'_>, solution: &Node| {
        branch_point_test(solution, sign, curve.follows_neutral_family)
    };
    let direction: Vec<f64> = before.tangent.iter().zip(&after.tangent).map(|(a, b)| 0.5 * (a + b)).collect();
    let length = along(curve, before, &after.unknown);
    let unperturbed = (UNPERTURBED_PART * curve.resolution.tolerance).max(UNPERTURBED);
    let mut test = |curve: &mut CycleCurve<'_>, solution: &Node| {
        let point = &solution.point;
        match kind {
            Kind::Fold => Some(curve.certain_turn(solution)),
            Kind::Doubling => Some(point.doubling_test()),
            Kind::Torus => torus_test(point, rank),
            Kind::BranchPoint => branch_point_test(curve, solution),
            Kind::Cycle => None,
        }
    };
    let Some(mut bracket) = Bracket::new(curve, before, after, &mut test) else { return Ok(None) };
    for tolerance in START_TOLERANCES {
        let converged = match bracket.narrow(curve, &settings, tolerance, &mut test) {
            Ok(Some(start)) => converge(curve, &direction, start, kind)?,
            // Next to a branch point the equations of the branch are singular, but its ends are good starts.
            Ok(None) | Err(Error::NotFound { .. }) if kind == Kind::BranchPoint => {
                let distance = |end: &Node| branch_point_test(curve, end).map_or(f64::INFINITY, f64::abs);
                let nearest = if distance(before) <= distance(after) { before } else { after };
                converge(curve, &direction, nearest, kind)?
            }
            Ok(None) | Err(Error::NotFound { .. }) => None,
            Err(error) => return Err(error),
        };
        // Newton's method may have left for a special cycle elsewhere.
        let located = converged.filter(|located| {
            let position = along(curve, before, &located.solution.unknown);
            let perturbation = located.eigenfunctions.1.first().filter(|_| kind == Kind::BranchPoint);
            let margin = MARGIN * length + LEAST_MARGIN;
            (-margin..=length + margin).contains(&position)
                && perturbation.is_none_or(|perturbation| {
                    perturbation.abs() < unperturbed.max(located.solution.point.error_estimate)
                })
        });
        if located.is_some() {
            return Ok(located);
        }
    }
    Ok(None)
}

/// The located cycle with its normal form and the branch that leaves it.
fn describe(
    curve: &mut CycleCurve<'_>,
    located: Located,
    kind: Kind,
) -> Result<Solution<CycleInspection>, Error> {
    let Located { solution, eigenfunctions } = &located;
    let end = solution.unknown.len() - 2;
    let mut residual = vec![0.0; solution.unknown.len()];
    curve.collocation.factorize(&solution.unknown, &solution.tangent, &mut residual);
    let critical = CriticalCycle::of(&curve.collocation, &solution.unknown);
    let orbit = Orbit {
        mesh: solution.point.mesh.clone(),
        degree: curve.collocation.gauss().degree(),
        dimension: curve.collocation.problem.dimension(),
        states: solution.unknown[..end].to_vec(),
        period: solution.unknown[end],
    };
    let branching = match kind {
        Kind::Doubling => doubled(&orbit, eigenfunctions),
        // What borders do to second derivatives is not computed.
        Kind::BranchPoint if critical.has_borders => None,
        Kind::BranchPoint => other_branch(
            &orbit,
            eigenfunctions,
            &critical,
            (curve.collocation.problem.active, curve.parameter_scale),
            &solution.tangent,
        ),
        Kind::Fold | Kind::Torus | Kind::Cycle => None,
    };
    let coefficients = critical.coefficients(kind, eigenfunctions);
    // A second mesh measures what is told; of fields with borders it would have to find them anew.
    let finer = if critical.has_borders { None } else { on_halves(curve, &located, kind) };
    let multipliers = finer.as_ref().and_then(|finer| finer.floquet().ok());
    let normal_form =
        if critical.has_borders { coefficients } else { with_errors(coefficients, finer.as_ref(), kind) };
    let mut solution = located.solution;
    let point = &mut solution.point;
    (point.normal_form, point.branching) = (normal_form, branching);
    if let Some(there) = multipliers {
        let floquet = &point.floquet;
        let mut changes = multiplier_changes(&floquet.nontrivial, &there.nontrivial);
        changes.iter_mut().for_each(|change| *change = change.max(floquet.measured_error));
        point.multiplier_errors = floquet.errors(&changes);
    }
    // The parameter stands still there because it turns, and not along a family.
    solution.point.is_neutral &= kind != Kind::Fold;
    Ok(solution)
}

/// Coefficients of the normal form by their names, each followed by its error: the difference from that on intervals half as wide.
/// Where the cycle does not exist there none is told: next to homoclinic orbits and on canards coefficients change by orders of magnitude.
fn with_errors(
    coefficients: Vec<(&'static str, f64)>,
    finer: Option<&Finer<'_>>,
    kind: Kind,
) -> Vec<(&'static str, f64)> {
    let Some(finer) = finer else { return Vec::new() };
    let there = finer.coefficients(kind);
    let with_error = |(name, value): (&'static str, f64)| {
        let finer = there.iter().find(|(other, _)| *other == name).map(|(_, finer)| *finer);
        let error = finer.map(|finer| (value - finer).abs().max(LEAST_ERROR * value.abs()));
        let error = error.filter(|error| error.is_finite()).map(|error| (error_name(name), error));
        std::iter::once((name, value)).chain(error)
    };
    coefficients.into_iter().flat_map(with_error).collect()
}

/// The name under which the error of a coefficient is told.
fn error_name(name: &str) -> &'static str {
    match name {
        "quadratic_coefficient" => "quadratic_coefficient_error",
        "quadratic_coefficient_of_unit_function" => "quadratic_coefficient_of_unit_function_error",
        "cubic_coefficient" => "cubic_coefficient_error",
        "cubic_coefficient_imaginary" => "cubic_coefficient_imaginary_error",
        _ => "argument_error",
    }
}

/// Logarithm of the modulus of the positive multiplier nearest to one, signed by the orientation. Along a family of cycles for one value of
/// the parameter a multiplier is one everywhere, and the orientation alone tells.
fn branch_point_test(solution: &Solution<CycleInspection>, sign: f64, is_along_family: bool) -> Option<f64> {
    if is_along_family {
        return Some(-sign * solution.orientation);
    }
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
