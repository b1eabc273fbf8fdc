//! Newton's method on the defining system of a point of codimension two that was bracketed on a curve.

use super::codimension_two::{
    BogdanovTakensSystem, CodimensionTwoPoint, CuspSystem, HopfHopfSystem, ZeroHopfSystem,
};
use super::curve::{Inspection, LocusCurve};
use super::normal_form;
use crate::algebraic::{AlgebraicEquations, ScaledLu, Solved, length, solve_square};
use crate::branch::SpecialKind;
use crate::continuation::{Solution, correct, finish, locate};
use crate::equilibrium::coefficient_error::Place;
use crate::equilibrium::defining::{FoldSystem, HopfSystem};
use crate::equilibrium::spectrum::{critical_pair, without};
use crate::error::Error;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;

/// Lengths, as parts of a bracket, to which it is shortened before Newton's method is tried, and tried again.
const BRACKETS: [f64; 2] = [1e-2, 1e-6];
/// The same where there is no Newton's method: for generalised Hopf points and degenerate ones.
const LAST_BRACKET: f64 = 1e-12;
/// A test function that is larger than this where it is smallest has a pole and no zero.
const POLE: f64 = 1e-3;
/// A located point may be this many bracket lengths away from the bracket.
const NEAR: f64 = 1.0;

type Node = Solution<Inspection>;

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
                            here.point.monitor.tests.push((kind, 0.0));
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
    let place = Place {
        state: &unknown[..n],
        parameters: &parameters,
        active: &active,
        scales: &scales,
        location_error: part,
    };
    let coefficients = normal_form::with_errors(place, |state, parameters| {
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

enum Newton {
    /// A solution of the defining system and the frequencies at which it claims eigenvalues on the imaginary axis.
    Solved(Solved, Vec<f64>),
    /// The eigenvalues next to the axis are not those that the kind asks for.
    OtherKind,
    Failed,
}

impl Newton {
    /// `squares` are the places among the unknowns and the units of the squares of frequencies.
    fn on<P: AlgebraicEquations>(system: &P, start: &[f64], sizes: &[f64], squares: &[(usize, f64)]) -> Self {
        let Ok(solved) = solve_square(system, start, sizes) else { return Self::Failed };
        if squares.iter().any(|&(index, _)| solved.unknown[index] <= 0.0) {
            return Self::OtherKind;
        }
        let frequencies = squares.iter().map(|&(index, rate)| rate * solved.unknown[index].sqrt()).collect();
        Self::Solved(solved, frequencies)
    }
}

/// Newton's method from a point close by.
fn newton(curve: &mut LocusCurve<'_>, near: &Node, kind: SpecialKind) -> Result<Newton, Error> {
    let n = curve.states.len();
    let matrix = curve.jacobian(&near.unknown).to_vec();
    let point = curve.equilibrium(&near.unknown);
    let problem = curve.system.problem.equilibria().clone();
    let scales = curve.states.clone();
    let ranges = &curve.system.scales[curve.system.scales.len() - 2..];
    let covector = |vector: &[f64]| -> Vec<f64> {
        let square = length(vector, &scales).powi(2);
        vector.iter().zip(&scales).map(|(entry, scale)| entry / (scale * scale) / square).collect()
    };
    let failed = |_| Error::Eigenvalues { quantity: "null vectors" };
    let real = |vector: Vec<Complex64>| -> Vec<f64> { vector.into_iter().map(|entry| entry.re).collect() };
    let unit = |mut vector: Vec<f64>| {
        let size = length(&vector, &scales);
        vector.iter_mut().for_each(|entry| *entry /= size);
        vector
    };
    // The vector y, orthogonal to the null vector, with f_x y = right-hand side up to the part that cannot be reached.
    let solve = |null: &[f64], right_hand_side: &[f64]| -> Result<Option<Vec<f64>>, Error> {
        let left = real(left_eigenvector(&matrix, n, Complex64::ZERO).map_err(failed)?.vector);
        let m = n + 1;
        let normal = covector(null);
        let mut bordered = vec![0.0; m * m];
        for column in 0..n {
            bordered[m * column..m * column + n].copy_from_slice(&matrix[n * column..n * (column + 1)]);
            bordered[n + m * column] = normal[column];
            bordered[column + m * n] = left[column] * scales[column] * scales[column];
        }
        let mut columns = scales.clone();
        columns.push(1.0);
        let mut lu = ScaledLu::default();
        if lu.factorize(m, &bordered, &columns) == 0.0 {
            return Ok(None);
        }
        let mut vector = right_hand_side.to_vec();
        vector.push(0.0);
        lu.solve(&mut vector);
        vector.truncate(n);
        Ok(vector.iter().all(|entry| entry.is_finite()).then_some(vector))
    };
    let null_vector = || -> Result<Vec<f64>, Error> {
        Ok(unit(real(right_eigenvector(&matrix, n, Complex64::ZERO).map_err(failed)?.vector)))
    };
    let pair_system =
        |pair: [Complex64; 2]| HopfSystem::from_pair(problem.clone(), &point, &matrix, pair, &scales);

    Ok(match kind {
        SpecialKind::Cusp => {
            let null = null_vector()?;
            let forms = crate::equilibrium::multilinear::MultilinearForms {
                field: problem.field,
                state: &point[..n],
                parameters: &problem.parameters_at(&point[n..]),
            };
            let square: Vec<f64> = forms.real(&[&null, &null]).iter().map(|entry| -entry).collect();
            let Some(second) = solve(&null, &square)? else { return Ok(Newton::Failed) };
            let normal = covector(&null);
            let system = CuspSystem { fold: FoldSystem { equilibria: problem, normal, left: Vec::new() } };
            let start = [&point[..n], &null, &second, &point[n..]].concat();
            let second_sizes: Vec<f64> =
                scales.iter().map(|scale| scale * length(&second, &scales).max(1.0)).collect();
            Newton::on(&system, &start, &[&scales, &scales, &second_sizes, ranges].concat(), &[])
        }
        SpecialKind::BogdanovTakens => {
            let null = null_vector()?;
            let Some(generalized) = solve(&null, &null)? else { return Ok(Newton::Failed) };
            // f_x v = rate w with v of unit size and w the null vector.
            let size = length(&generalized, &scales);
            let first: Vec<f64> = generalized.iter().map(|entry| entry / size).collect();
            let rate = size.recip();
            let Some((normal, conormal)) = crate::equilibrium::locating::normals(&first, &null, &scales)
            else {
                return Ok(Newton::Failed);
            };
            let hopf = HopfSystem { equilibria: problem, normal, conormal, rate };
            let start = [&point[..n], &first, &null, &point[n..]].concat();
            let sizes = [&scales, &scales, &scales, ranges].concat();
            Newton::on(&BogdanovTakensSystem { hopf }, &start, &sizes, &[])
        }
        SpecialKind::ZeroHopf => {
            let zero = near
                .point
                .spectrum
                .eigenvalues
                .iter()
                .filter(|value| value.im == 0.0)
                .min_by(|a, b| a.norm().total_cmp(&b.norm()))
                .copied();
            let Some(zero) = zero else { return Ok(Newton::Failed) };
            let Some(pair) = critical_pair(&without(&near.point.spectrum.eigenvalues, &[zero])) else {
                return Ok(Newton::Failed);
            };
            if pair[0].im == 0.0 {
                return Ok(Newton::OtherKind);
            }
            let null = unit(real(right_eigenvector(&matrix, n, zero).map_err(failed)?.vector));
            let Some((hopf, start)) = pair_system(pair)? else { return Ok(Newton::Failed) };
            let (own, values) = start.split_at(3 * n + 1);
            let squares = [(3 * n, hopf.rate)];
            let system = ZeroHopfSystem { hopf, null_normal: covector(&null) };
            let sizes = [&scales, &scales, &scales, [1.0].as_slice(), &scales, ranges].concat();
            Newton::on(&system, &[own, &null, values].concat(), &sizes, &squares)
        }
        SpecialKind::HopfHopf => {
            let eigenvalues = &near.point.spectrum.eigenvalues;
            let own = curve.system.problem.critical_eigenvalues(&near.unknown);
            let (Some(first), Some(second)) =
                (nearest_pair(eigenvalues, &own), critical_pair(&without(eigenvalues, &own)))
            else {
                return Ok(Newton::Failed);
            };
            if first[0].im == 0.0 || second[0].im == 0.0 {
                return Ok(Newton::OtherKind);
            }
            let (Some((one, start)), Some((other, other_start))) =
                (pair_system(first)?, pair_system(second)?)
            else {
                return Ok(Newton::Failed);
            };
            let m = 3 * n + 1;
            let start = [&start[..m], &other_start[n..m], &start[m..]].concat();
            let pair_sizes = [&scales, &scales, [1.0].as_slice()].concat();
            let sizes = [&scales, pair_sizes.as_slice(), &pair_sizes, ranges].concat();
            let squares = [(3 * n, one.rate), (5 * n + 1, other.rate)];
            Newton::on(&HopfHopfSystem { pairs: [one, other] }, &start, &sizes, &squares)
        }
        _ => Newton::Failed,
    })
}

/// The two eigenvalues closest to those given.
fn nearest_pair(eigenvalues: &[Complex64], targets: &[Complex64]) -> Option<[Complex64; 2]> {
    let nearest = |target: &Complex64| {
        eigenvalues.iter().copied().min_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()))
    };
    Some([nearest(targets.first()?)?, nearest(targets.get(1)?)?])
}
