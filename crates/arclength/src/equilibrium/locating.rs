//! Newton's method on the defining system of a special point that was bracketed on a curve of equilibria.

use super::branch_point::BranchPoint;
use super::curve::{EquilibriumCurve, EquilibriumInspection};
use super::defining::{BranchPointSystem, FoldSystem, HopfSystem};
use super::fold::FoldPoint;
use super::hopf::HopfPoint;
use super::special::{NeutralSaddle, SpecialPoint};
use super::spectrum::{UNDECIDED, critical_pairs};
use crate::algebraic::scales::natural_scales;
use crate::algebraic::{Differentiator, Solved, length, position, solve_square};
use crate::branch::SpecialKind;
use crate::continuation::events::Event;
use crate::continuation::{Bracket, Solution, distance, finish, locate};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::linear::eigenvalues::eigenvalues;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;

/// Lengths, as parts of a bracket, to which it is shortened before Newton's method is tried, and tried again.
const BRACKETS: [f64; 2] = [1e-2, 1e-6];
/// The same where Newton's method fails and the bracket is all there is.
const LAST_BRACKET: f64 = 1e-10;
/// Pairs of eigenvalues that are tried for a Hopf point.
const CANDIDATES: usize = 3;
/// Derivative in the parameter, beside the curvature at a fold, both in sizes of states and parameter, that is rounding, or this many
/// times the last update: Newton's method converges slowly to a branch point, at which the equations of a fold are singular.
const NO_UNFOLDING: f64 = 1e-8;
const UNCERTAIN: f64 = 1e3;
/// A located point may lie this part of the bracket outside it, and as far as solutions may be off next to a point at which the
/// Jacobian is singular.
const MARGIN: f64 = 1e-6;
/// Perturbation of the field, relative to its fastest rate, below which a branch point is one of the field itself.
const UNPERTURBED: f64 = 1e-12;
/// Distance, in the metric, of a point located by Newton's method from the bracket of its crossing.
const AGREEMENT: f64 = 1e-6;
/// Square of the moduli of a located pair, as a part of that next to it, below which both eigenvalues are zero: that is no Hopf point, nor a
/// neutral saddle.
const COLLAPSED: f64 = 1e-8;
/// Ratio of the imaginary part of a bracketed eigenvalue to what is left of its real part up to which it may be real.
const SLOW: f64 = 1e3;
/// Distance from zero, in the metric, of eigenvalues that are critical at a point which is only bracketed.
const CRITICAL: f64 = 1e-5;
/// Relative difference of the frequencies of two pairs.
const DISTINCT: f64 = 1e-6;

type Node = Solution<EquilibriumInspection>;

/// A function whose zero is sought.
type Test = fn(&EquilibriumCurve<'_>, &Node) -> f64;

/// A solution close to the zero of a test function.
fn near_zero(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
    tolerance: f64,
    test: Test,
) -> Node {
    let settings = curve.settings;
    match locate(curve, before, after, &settings, tolerance, |curve, solution| Some(test(curve, solution))) {
        Ok(Some(near)) => near,
        // Next to a branch point corrections fail, but the ends are good starts.
        _ => nearer_end(curve, before, after, test),
    }
}

/// The end at which a test function is closer to zero.
fn nearer_end(curve: &EquilibriumCurve<'_>, before: &Node, after: &Node, test: Test) -> Node {
    let is_before = test(curve, before).abs() < test(curve, after).abs();
    if is_before { before.clone() } else { after.clone() }
}

/// Whether `unknown` lies between the two ends, give or take a margin, and near the curve.
fn inside(scales: &[f64], before: &Node, distance: f64, unknown: &[f64]) -> bool {
    let along = position(before, unknown, scales);
    let offset: Vec<f64> = unknown.iter().zip(&before.unknown).map(|(there, here)| there - here).collect();
    let margin = MARGIN * distance + AGREEMENT;
    along > -margin && along < distance + margin && length(&offset, scales) < 1.5 * distance + AGREEMENT
}

/// Error estimate of the parameter, the last unknown.
fn location_error(solved: &Solved) -> f64 {
    let (Some(update), Some(value)) = (solved.last_update.last(), solved.unknown.last()) else { return 0.0 };
    update.abs().max(f64::EPSILON * value.abs())
}

/// What is left when the defining system has no regular solution.
///
/// # Errors
/// [`Error::OtherBranch`] if the ends are on different branches, so that there is nothing between them.
fn degenerate(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
    distance: f64,
    of: SpecialKind,
    test: Test,
) -> Result<Node, Error> {
    let settings = curve.settings;
    let mut sign = |curve: &mut EquilibriumCurve<'_>, solution: &Node| Some(test(curve, solution));
    let mut narrowed = None;
    if let Some(mut bracket) = Bracket::new(curve, before, after, &mut sign) {
        narrowed = bracket.narrow(curve, &settings, LAST_BRACKET, &mut sign).ok().flatten().cloned();
        if narrowed.is_some() && bracket.is_torn(curve) {
            narrowed = None;
        }
    }
    // Next to a branch point corrections fail, too: shorter steps tell.
    if narrowed.is_none() && distance > settings.shortest_jump {
        return Err(Error::OtherBranch);
    }
    let node = narrowed.unwrap_or_else(|| nearer_end(curve, before, after, test));
    Ok(bracketed(curve, node, of, LAST_BRACKET * distance))
}

/// A point that was only bracketed, between places this far apart in the metric. Where several eigenvalues are zero at once solutions are
/// known to the root of rounding only, and signs may change elsewhere: their distance from zero tells how far. Which of them are stable
/// is rounding there.
fn bracketed(curve: &EquilibriumCurve<'_>, mut node: Node, of: SpecialKind, distance: f64) -> Node {
    let n = curve.dimension();
    let spectrum = &node.point.spectrum;
    // An eigenvalue is known up to its rounding.
    let away = |(value, size): (&Complex64, &f64), rate: &Complex64| {
        let largest = value.re.abs() + UNDECIDED * size;
        if value.re == 0.0 { 0.0 } else { largest / rate.re.abs() }
    };
    let values = spectrum.eigenvalues.iter().zip(&spectrum.sizes);
    let critical = values.zip(&node.point.rates).map(|(pair, rate)| (*pair.0, away(pair, rate)));
    let critical: Vec<(Complex64, f64)> = critical.filter(|(_, away)| *away < CRITICAL).collect();
    let farthest = critical.iter().map(|(_, away)| *away).fold(distance, f64::max);
    let values: Vec<Complex64> = critical.into_iter().map(|(value, _)| value).collect();
    node.point.spectrum.stability = spectrum.stability_beside(&values);
    let (value, location_error) = (node.unknown[n], farthest * curve.system.scales[n]);
    node.point.special =
        Some(Box::new(SpecialPoint::Degenerate { of, value, location_error, at_border: false }));
    node
}

/// Completes a located point of the curve.
fn complete(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    unknown: Vec<f64>,
    special: SpecialPoint,
) -> Result<Node, Error> {
    let mut node = finish(curve, unknown, &before.tangent)?;
    node.point.special = Some(Box::new(special));
    Ok(node)
}

/// The fold between two solutions.
pub(super) fn fold(curve: &mut EquilibriumCurve<'_>, before: &Node, after: &Node) -> Result<Node, Error> {
    let n = curve.dimension();
    let distance = distance(curve, &before.unknown, &after.unknown);
    let test: Test = |curve, node| curve.turn(&node.tangent);
    for tolerance in BRACKETS {
        let near = near_zero(curve, before, after, tolerance, test);
        let scales = curve.system.scales.clone();
        let size = length(&near.tangent[..n], &scales[..n]);
        let vector: Vec<f64> = near.tangent[..n].iter().map(|entry| entry / size).collect();
        let normal = vector.iter().zip(&scales).map(|(entry, scale)| entry / (scale * scale)).collect();
        let system = FoldSystem { equilibria: curve.system.problem.clone(), normal, left: Vec::new() };
        let start = [&near.unknown[..n], &vector, &near.unknown[n..]].concat();
        let sizes = [&scales[..n], &scales[..n], &scales[n..]].concat();
        let Ok(solved) = solve_square(&system, &start, &sizes) else { continue };
        let unknown = [&solved.unknown[..n], &solved.unknown[2 * n..]].concat();
        if inside(&scales, before, distance, &unknown) {
            let point = FoldPoint::at(&curve.system.problem, &unknown, &scales, location_error(&solved))?;
            let update = length(&solved.last_update, &sizes);
            if !moves_the_parameter(&point, &scales, NO_UNFOLDING.max(UNCERTAIN * update)) {
                break;
            }
            match complete(curve, before, unknown, SpecialPoint::Fold(point)) {
                // Two folds at once: more than one direction is along a branch.
                Err(Error::NotFound { .. }) => break,
                completed => return completed,
            }
        }
    }
    degenerate(curve, before, after, distance, SpecialKind::Fold, test)
}

/// Whether the branch through a point that satisfies the equations of a fold turns there as a parabola does. At a branch point, which
/// satisfies them too, the derivative in the parameter is nothing but rounding.
fn moves_the_parameter(point: &FoldPoint, scales: &[f64], rounding: f64) -> bool {
    let n = point.state.len();
    let size = length(&point.null_vector, &scales[..n]).recip();
    match (point.unfolding, point.quadratic) {
        (Some(unfolding), Some(quadratic)) => {
            unfolding.abs() * scales[n] > rounding * quadratic.abs() * size * size
        }
        _ => true,
    }
}

/// The Hopf point or neutral saddle between two solutions.
pub(super) fn hopf(curve: &mut EquilibriumCurve<'_>, before: &Node, after: &Node) -> Result<Node, Error> {
    let distance = distance(curve, &before.unknown, &after.unknown);
    let test: Test = |_, node| node.point.spectrum.hopf_closest;
    // Pairs that stay on the axis are not what crosses it; of the others a weakly damped one may be closer to it.
    let neutral = before.point.spectrum.hopf_undecided;
    for (tolerance, candidate) in
        BRACKETS.into_iter().flat_map(|part| (0..CANDIDATES).map(move |k| (part, k)))
    {
        let near = near_zero(curve, before, after, tolerance, test);
        let pairs = critical_pairs(&near.point.spectrum.eigenvalues);
        let Some(&pair) = pairs.get(neutral + candidate) else { continue };
        let Some(node) = hopf_of_pair(curve, before, &near, pair)? else { continue };
        if inside(&curve.system.scales, before, distance, &node.unknown) {
            return Ok(node);
        }
    }
    degenerate(curve, before, after, distance, SpecialKind::Hopf, test)
}

/// The Hopf point or neutral saddle to which Newton's method converges from a solution and the pair of its eigenvalues that
/// is about to become critical; wherever it lies.
fn hopf_of_pair(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    near: &Node,
    pair: [Complex64; 2],
) -> Result<Option<Node>, Error> {
    let n = curve.dimension();
    let matrix = curve.jacobian(&near.unknown);
    let scales = curve.system.scales.clone();
    let Some((system, start)) =
        HopfSystem::from_pair(curve.system.problem.clone(), &near.unknown, &matrix, pair, &scales)?
    else {
        return Ok(None);
    };
    let sizes = [&scales[..n], &scales[..n], &scales[..n], &[1.0], &scales[n..]].concat();
    let Ok(solved) = solve_square(&system, &start, &sizes) else { return Ok(None) };
    let unknown = [&solved.unknown[..n], &solved.unknown[3 * n + 1..]].concat();
    let kappa = solved.unknown[3 * n];
    if kappa.abs() < COLLAPSED {
        return Ok(None);
    }
    let eigenvalue = system.rate * kappa.abs().sqrt();
    let Ok(mut node) = finish(curve, unknown, &before.tangent) else { return Ok(None) };
    if !node.point.spectrum.has_pair(eigenvalue, kappa > 0.0) {
        return Ok(None);
    }
    let error = location_error(&solved);
    let (problem, unknown) = (&curve.system.problem, &node.unknown);
    let special = if kappa > 0.0 {
        SpecialPoint::Hopf(HopfPoint::at(problem, unknown, &scales, eigenvalue, error)?)
    } else {
        let parameters = problem.parameters_at(&unknown[n..]);
        SpecialPoint::NeutralSaddle(NeutralSaddle {
            value: unknown[n],
            parameters,
            active: problem.active[0],
            location_error: error,
            state: unknown[..n].to_vec(),
            eigenvalue,
        })
    };
    node.point.special = Some(Box::new(special));
    Ok(Some(node))
}

impl<'a> HopfSystem<'a> {
    /// The system and a start close to a point with two eigenvalues of sum nearly zero, `pair`, of the Jacobian `matrix`
    /// there. `None` if both are zero.
    pub(crate) fn from_pair(
        equilibria: super::problem::EquilibriumProblem<'a>,
        unknown: &[f64],
        matrix: &[f64],
        pair: [Complex64; 2],
        scales: &[f64],
    ) -> Result<Option<(Self, Vec<f64>)>, Error> {
        let n = equilibria.dimension;
        let rate = (pair[0] * pair[1]).norm().sqrt();
        if rate == 0.0 || !rate.is_finite() {
            return Ok(None);
        }
        let failed = |_| Error::Eigenvalues { quantity: "eigenvectors of the Hopf point" };
        let unit = |mut vector: Vec<f64>| {
            let size = length(&vector, &scales[..n]);
            vector.iter_mut().for_each(|entry| *entry /= size);
            vector
        };
        let one = right_eigenvector(matrix, n, pair[0]).map_err(failed)?.vector;
        let first: Vec<f64> = if pair[0].im == 0.0 {
            let other = right_eigenvector(matrix, n, pair[1]).map_err(failed)?.vector;
            let [one, other] = [one, other].map(|vector| unit(vector.iter().map(|entry| entry.re).collect()));
            one.iter().zip(&other).map(|(a, b)| a + b).collect()
        } else {
            // The real part of a multiple of the eigenvector that is long, so that it does not vanish in the metric.
            let real: Vec<f64> = one.iter().map(|entry| entry.re).collect();
            let imaginary: Vec<f64> = one.iter().map(|entry| entry.im).collect();
            if length(&real, &scales[..n]) >= length(&imaginary, &scales[..n]) { real } else { imaginary }
        };
        let first = unit(first);
        let second: Vec<f64> = (0..n)
            .map(|row| (0..n).map(|column| matrix[row + n * column] * first[column]).sum::<f64>() / rate)
            .collect();
        let Some((normal, conormal)) = normals(&first, &second, &scales[..n]) else { return Ok(None) };
        // The square of the frequency is positive for a pair of complex eigenvalues, negative for real ones.
        let kappa = if pair[0].im == 0.0 { -1.0 } else { 1.0 };
        let start = [&unknown[..n], &first, &second, &[kappa], &unknown[n..]].concat();
        Ok(Some((Self { equilibria, normal, conormal, rate }, start)))
    }
}

/// The covectors that single out `first` in the plane that it spans with `second`; `None` if they are parallel.
pub(crate) fn normals(first: &[f64], second: &[f64], scales: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let dual = |vector: &[f64]| -> Vec<f64> {
        vector.iter().zip(scales).map(|(entry, scale)| entry / (scale * scale)).collect()
    };
    let against =
        |covector: &[f64], vector: &[f64]| -> f64 { covector.iter().zip(vector).map(|(a, b)| a * b).sum() };
    let mut normal = dual(first);
    let square = against(&normal, first);
    normal.iter_mut().for_each(|entry| *entry /= square);
    let share = against(&normal, second);
    let rest: Vec<f64> = second.iter().zip(first).map(|(b, a)| b - share * a).collect();
    let size = length(&rest, scales);
    let conormal: Vec<f64> = dual(&rest).iter().map(|entry| entry / size).collect();
    conormal.iter().all(|entry| entry.is_finite()).then_some((normal, conormal))
}

/// The Hopf point close to an approximate equilibrium and frequency, by Newton's method.
pub(crate) fn hopf_point_near(
    field: ErasedField<'_>,
    state: &[f64],
    parameters: &[f64],
    active: usize,
    frequency: f64,
) -> Option<HopfPoint> {
    let n = state.len();
    let problem = super::problem::EquilibriumProblem::new(field, parameters, &[active]);
    let unknown = [state, &[parameters[active]]].concat();
    let mut matrix = vec![0.0; n * (n + 1)];
    let mut residual = vec![0.0; n];
    Differentiator::default().jacobian(&problem, &unknown, &mut residual, &mut matrix, n);
    let mut scales = natural_scales(&problem.field, state, parameters, &vec![0.0; n]);
    scales.push(if unknown[n] == 0.0 { 1.0 } else { unknown[n].abs() });
    let target = Complex64::new(0.0, frequency);
    let nearest = eigenvalues(&matrix[..n * n], n)
        .ok()?
        .into_iter()
        .min_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()))?;
    let pair = [nearest, nearest.conj()];
    let (system, start) =
        HopfSystem::from_pair(problem.clone(), &unknown, &matrix[..n * n], pair, &scales).ok()??;
    let sizes = [&scales[..n], &scales[..n], &scales[..n], &[1.0], &scales[n..]].concat();
    let solved = solve_square(&system, &start, &sizes).ok()?;
    let kappa = solved.unknown[3 * n];
    if kappa <= 0.0 {
        return None;
    }
    let unknown = [&solved.unknown[..n], &solved.unknown[3 * n + 1..]].concat();
    HopfPoint::at(&problem, &unknown, &scales, system.rate * kappa.sqrt(), location_error(&solved)).ok()
}

/// The branch point between two solutions.
///
/// # Errors
/// [`Error::OtherBranch`] if there is none but that of a perturbed field: what looks like one is a step from one branch to
/// another that passes by.
pub(super) fn branch_point(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    after: &Node,
) -> Result<Node, Error> {
    let n = curve.dimension();
    let distance = distance(curve, &before.unknown, &after.unknown);
    let test: Test = |_, node| node.orientation * node.point.determinant;
    let failed = |_| Error::Eigenvalues { quantity: "null vector of the branch point" };
    let mut perturbed = false;
    for tolerance in [1.0, BRACKETS[0], BRACKETS[1]] {
        let near = near_zero(curve, before, after, tolerance, test);
        let matrix = curve.jacobian(&near.unknown);
        let scales = curve.system.scales.clone();
        let rate = near.point.spectrum.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let mut left: Vec<f64> = left_eigenvector(&matrix, n, Complex64::ZERO)
            .map_err(failed)?
            .vector
            .iter()
            .map(|entry| entry.re)
            .collect();
        let size = left.iter().zip(&scales).map(|(entry, scale)| (entry * scale).powi(2)).sum::<f64>().sqrt();
        left.iter_mut().for_each(|entry| *entry /= size);
        let normal = left.iter().zip(&scales).map(|(entry, scale)| entry * scale * scale).collect();
        let inverse: Vec<f64> = scales[..n].iter().map(|scale| scale.recip()).collect();
        let system = BranchPointSystem {
            equilibria: curve.system.problem.clone(),
            normal,
            scales: scales[..n].to_vec(),
            rate: if rate > 0.0 { rate } else { 1.0 },
        };
        let start = [&near.unknown[..n], &left, &[0.0], &near.unknown[n..]].concat();
        let sizes = [&scales[..n], &inverse, &[system.rate], &scales[n..]].concat();
        let Ok(solved) = solve_square(&system, &start, &sizes) else { continue };
        let unknown = [&solved.unknown[..n], &solved.unknown[2 * n + 1..]].concat();
        if !inside(&scales, before, distance, &unknown) {
            continue;
        }
        if solved.unknown[2 * n].abs() > UNPERTURBED * system.rate {
            perturbed = true;
            continue;
        }
        let tangent: Vec<f64> =
            before.tangent.iter().zip(&after.tangent).map(|(a, b)| 0.5 * (a + b)).collect();
        let error = location_error(&solved);
        let Some(point) = BranchPoint::at(&curve.system.problem, &unknown, &tangent, &scales, error)? else {
            continue;
        };
        // The Jacobian bordered by the tangent is singular here: what is known comes from the normal form.
        return curve.at_branch_point(unknown, point);
    }
    if perturbed && distance > curve.settings.shortest_jump {
        return Err(Error::OtherBranch);
    }
    degenerate(curve, before, after, distance, SpecialKind::BranchPoint, test)
}

/// What crosses at one place, `near`, where the number of unstable eigenvalues changes by `change`: pairs of different
/// frequencies one by one, or what was bracketed. `half` is half of the length of the bracket.
pub(super) fn crossing(
    curve: &mut EquilibriumCurve<'_>,
    before: &Node,
    near: Node,
    change: usize,
    half: f64,
) -> Result<Vec<Event<SpecialKind, EquilibriumInspection>>, Error> {
    let eigenvalues = &near.point.spectrum.eigenvalues;
    let closest = eigenvalues.iter().min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
    // Real ones that are zero together may be taken for a slow pair by as much as they are off.
    let oscillates = closest.is_some_and(|value| value.im.abs() > SLOW * value.re.abs());
    if oscillates && change > 0 && change.is_multiple_of(2) {
        let pairs = critical_pairs(eigenvalues).into_iter().filter(|pair| pair[0].im != 0.0);
        let mut hopf: Vec<Node> = Vec::new();
        for pair in pairs.take(change / 2) {
            let Some(node) = hopf_of_pair(curve, before, &near, pair)? else { break };
            let Some(own) = frequency(&node) else { break };
            let new = hopf.iter().filter_map(frequency).all(|other| are_distinct(own, other));
            if !new || distance(curve, &node.unknown, &near.unknown) > AGREEMENT {
                break;
            }
            hopf.push(node);
        }
        if hopf.len() == change / 2 {
            let located = |solution| Event { kind: SpecialKind::Hopf, is_located: true, solution };
            return Ok(hopf.into_iter().map(located).collect());
        }
    }
    let of = if oscillates { SpecialKind::Hopf } else { SpecialKind::BranchPoint };
    let near = bracketed(curve, near, of, half);
    Ok(vec![Event { kind: of, is_located: false, solution: near }])
}

fn frequency(node: &Node) -> Option<f64> {
    match node.point.special.as_deref() {
        Some(SpecialPoint::Hopf(hopf)) => Some(hopf.frequency),
        _ => None,
    }
}

/// Whether two frequencies are those of two pairs.
pub(super) fn are_distinct(one: f64, other: f64) -> bool {
    (one - other).abs() > DISTINCT * one
}
