//! Multipliers of the variational equation along a given orbit, resolved as finely as it needs.
//!
//! A mesh that resolves a cycle need not resolve what happens beside it: a direction that the cycle does not feel may turn a thousand
//! times within the period. Solving for the cycle on ever finer meshes until its multipliers stay is a waste then: the orbit is
//! known, and the variational equation along it is linear. For a cycle that is confirmed it is discretised by collocation of high order
//! on parts of the intervals, along two solutions for the orbit on different meshes. What differs between both has the errors of the
//! discretisation and of the orbit in it.
//!
//! Any other cycle whose mesh may not resolve what happens beside it has its multipliers from exponentials: the two of every part of an
//! interval are exact where the Jacobian does not change, however fast a direction turns or dies out, and are of order four where it
//! does (Thalhammer, "A fourth-order commutator-free exponential integrator for nonautonomous differential equations" (2006)).

use super::floquet::{DEFECT, Floquet, floquet, floquet_of, multiplier_changes};
use super::limit_cycle::LimitCycle;
use crate::collocation::equations::Collocation;
use crate::collocation::problem::BoundaryValueEquations;
use crate::linear::eigenvalues::EigenvalueWorkspace;
use crate::linear::exponential::{Exponential, multiply};

/// Degree of the polynomials: the phase of a direction that turns fast has an error of order 24 in the width of a part.
const DEGREE: usize = 12;
/// Parts of an interval at most.
const MOST_PARTS: usize = 64;
/// Numbers in the matrices of all parts at most: 128 megabytes, and about a second of work.
const MOST_NUMBERS: usize = 1 << 24;

/// Parts of an interval at most in which exponentials are taken.
const MOST_PARTS_OF_EXPONENTIALS: usize = 16;
/// Multiplications in all exponentials at most, each counted as those of so many products of matrices: some tenths of a second.
const MOST_MULTIPLICATIONS: usize = 1 << 29;
const PRODUCTS: usize = 20;
/// Change of the multipliers at which parts are small enough, as far as their logarithms are above `COUNTED`.
const CHANGE: f64 = 1e-3;
const COUNTED: f64 = -18.0;
/// What a direction may turn within an interval, in radians and for every degree of the polynomials, for these to resolve it. By that
/// angle the rate at which it grows is told wrong by some thousandths.
const RESOLVED_TURN: f64 = 1.0;
/// Weights of the Jacobians at the two Gauss points of a part in its first exponential: 1/4 +- sqrt(3)/6.
const WEIGHTS: [f64; 2] = [0.538_675_134_594_812_9, -0.038_675_134_594_812_88];

/// An orbit as collocation knows it.
#[derive(Clone, Copy)]
pub(super) struct KnownOrbit<'a> {
    pub mesh: &'a [f64],
    pub degree: usize,
    /// States, period and parameter.
    pub unknown: &'a [f64],
}

/// The multipliers along the finer of two solutions for one orbit, and the changes of each (those other than the trivial one, the
/// largest modulus first) against the other solution. Intervals are divided until the changes are small enough. `None` where the field
/// switches, or what that takes is not affordable.
pub(super) fn resolved_multipliers(
    problem: &LimitCycle<'_>,
    [coarse, fine]: [KnownOrbit<'_>; 2],
    changes: impl Fn(&Floquet, &Floquet) -> Vec<f64>,
    is_enough: impl Fn(&Floquet, &[f64]) -> bool,
) -> Option<(Floquet, Vec<f64>)> {
    if problem.has_borders() {
        return None;
    }
    let mut parts = 1;
    while parts <= MOST_PARTS {
        let one = multipliers_along(problem, coarse, parts)?;
        let other = multipliers_along(problem, fine, parts)?;
        let changes = changes(&other, &one);
        if is_enough(&other, &changes) {
            return Some((other, changes));
        }
        parts *= 2;
    }
    None
}

/// The multipliers of the variational equation along an orbit, every interval in a number of parts.
fn multipliers_along(problem: &LimitCycle<'_>, orbit: KnownOrbit<'_>, parts: usize) -> Option<Floquet> {
    let n = problem.dimension();
    let inner = DEGREE * n;
    let intervals = (orbit.mesh.len() - 1) * parts;
    if intervals * inner * (inner + n + problem.scalars()) > MOST_NUMBERS {
        return None;
    }
    let (finer, unknown) = linearised(problem, orbit, parts, DEGREE);
    floquet(&finer, &unknown, &problem.scales, &mut None).ok()
}

/// An orbit with every interval in a number of parts and polynomials of some degree, linearised, and its unknowns.
fn linearised<'a>(
    problem: &LimitCycle<'a>,
    orbit: KnownOrbit<'_>,
    parts: usize,
    degree: usize,
) -> (Collocation<LimitCycle<'a>>, Vec<f64>) {
    let n = problem.dimension();
    let within = |pair: &[f64], part: usize| pair[0] + (pair[1] - pair[0]) * part as f64 / parts as f64;
    let mesh = orbit.mesh.windows(2).flat_map(|pair| (0..parts).map(move |part| within(pair, part)));
    let mesh: Vec<f64> = mesh.chain([1.0]).collect();
    let known = Collocation::new(problem.clone(), orbit.mesh.to_vec(), orbit.degree);
    let mut finer = Collocation::new(problem.clone(), mesh, degree);
    let times = finer.polynomials(&[]).node_times();
    let mut unknown = vec![0.0; times.len() * n];
    for (state, time) in unknown.chunks_exact_mut(n).zip(times) {
        known.evaluate(orbit.unknown, time, state);
    }
    unknown.extend_from_slice(&orbit.unknown[orbit.unknown.len() - 2..]);
    finer.set_reference(&unknown);
    let mut border = vec![0.0; unknown.len()];
    if let Some(last) = border.last_mut() {
        *last = 1.0;
    }
    let mut residual = vec![0.0; unknown.len()];
    finer.factorize(&unknown, &border, &mut residual);
    (finer, unknown)
}

/// Whether the mesh of a cycle that was linearised last may not resolve the directions beside it: where one turns too far in an interval,
/// or where one dies out so fast that collocation lets it live. Eigenvalues of the Jacobian amid an interval say so; they are computed where
/// the norms of its symmetric and antisymmetric parts, which bound their real and imaginary parts (Bendixson 1902), do not exclude it.
pub(super) fn may_be_unresolved(collocation: &Collocation<LimitCycle<'_>>) -> bool {
    let problem = &collocation.problem;
    let (n, degree) = (problem.dimension(), collocation.gauss().degree());
    let size = n * (n + problem.scalars());
    let scales = &problem.scales;
    let farthest_turn = RESOLVED_TURN * degree as f64;
    // The stability function takes exp(-r) for exp(-k / r) with k = 2 m (m + 1) where r is large.
    let kept = (2 * degree * (degree + 1)) as f64;
    let (mut rate, mut rate_by_collocation) = (0.0, 0.0);
    let blocks = collocation.derivatives().chunks_exact(degree * size);
    let mut workspace: Option<EigenvalueWorkspace> = None;
    let mut scaled = vec![0.0; n * n];
    for (points, pair) in blocks.zip(collocation.mesh().windows(2)) {
        let width = pair[1] - pair[0];
        let block = &points[degree / 2 * size..];
        for (index, entry) in scaled.iter_mut().enumerate() {
            *entry = width * block[index] * scales[index / n] / scales[index % n];
        }
        let (mut symmetric, mut antisymmetric) = (0.0, 0.0);
        for column in 0..n {
            for row in 0..=column {
                let [above, below] = [scaled[row + n * column], scaled[column + n * row]];
                let count = if row == column { 0.25 } else { 0.5 };
                symmetric += count * (above + below) * (above + below);
                antisymmetric += count * (above - below) * (above - below);
            }
        }
        let may_die = symmetric > kept && rate_by_collocation < -COUNTED;
        if antisymmetric.sqrt() <= farthest_turn && !may_die {
            continue;
        }
        let workspace = workspace.get_or_insert_with(|| EigenvalueWorkspace::new(n));
        let Ok(eigenvalues) = workspace.eigenvalues(&scaled) else { continue };
        if eigenvalues.iter().any(|eigenvalue| eigenvalue.im.abs() > farthest_turn) {
            return true;
        }
        let fastest = eigenvalues.iter().fold(0.0, |fastest: f64, eigenvalue| fastest.max(-eigenvalue.re));
        rate += fastest;
        rate_by_collocation += fastest.min(kept / fastest);
    }
    rate > -COUNTED && rate_by_collocation < -COUNTED
}

/// Whether multipliers change little from one discretisation to the other, as far as they count.
pub(super) fn are_resolved(floquet: &Floquet, changes: &[f64]) -> bool {
    let counted = changes.iter().zip(&floquet.nontrivial);
    let mut counted = counted.filter(|(_, multiplier)| multiplier.log_modulus > COUNTED);
    floquet.defect() <= DEFECT && counted.all(|(change, _)| *change < CHANGE)
}

/// The multipliers along an orbit by exponentials, every interval in as many parts as it takes until they do not change any more and are
/// what the divergence of the field says; with the change of each. `None` where they do not settle, where that is not affordable, or where
/// the field switches.
pub(super) fn multipliers_by_exponentials(
    problem: &LimitCycle<'_>,
    orbit: KnownOrbit<'_>,
    divergence: f64,
) -> Option<(Floquet, Vec<f64>)> {
    if problem.has_borders() {
        return None;
    }
    let mut before: Option<Floquet> = None;
    let mut parts = 1;
    while parts <= MOST_PARTS_OF_EXPONENTIALS {
        // The divergence along the cycle is known better on its own mesh.
        let found = Floquet { divergence, ..by_exponentials(problem, orbit, parts)? };
        if let Some(before) = before {
            let changes = multiplier_changes(&found.nontrivial, &before.nontrivial);
            if are_resolved(&found, &changes) {
                let counted = changes.iter().zip(&found.nontrivial);
                let counted = counted.filter(|(_, multiplier)| multiplier.log_modulus > COUNTED);
                let error = counted.map(|(change, _)| *change).fold(0.0, f64::max);
                return Some((Floquet { measured_error: error, ..found }, changes));
            }
        }
        before = Some(found);
        parts *= 2;
    }
    None
}

/// The multipliers by two exponentials in each of the parts of an interval.
fn by_exponentials(problem: &LimitCycle<'_>, orbit: KnownOrbit<'_>, parts: usize) -> Option<Floquet> {
    let n = problem.dimension();
    let intervals = (orbit.mesh.len() - 1) * parts;
    if 2 * intervals * PRODUCTS * n * n * n > MOST_MULTIPLICATIONS {
        return None;
    }
    let (finer, unknown) = linearised(problem, orbit, parts, WEIGHTS.len());
    let scales = &problem.scales;
    let size = n * (n + problem.scalars());
    let mut exponential = Exponential::new(n);
    let mut halves = [vec![0.0; n * n], vec![0.0; n * n]];
    let mut transfer = vec![0.0; intervals * n * n];
    let points = finer.derivatives().chunks_exact(WEIGHTS.len() * size).zip(finer.mesh().windows(2));
    for ((blocks, pair), transfer) in points.zip(transfer.chunks_exact_mut(n * n)) {
        let (first, second) = blocks.split_at(size);
        let width = pair[1] - pair[0];
        for (half, [of_first, of_second]) in halves.iter_mut().zip([WEIGHTS, [WEIGHTS[1], WEIGHTS[0]]]) {
            for (index, entry) in half.iter_mut().enumerate() {
                let factor = width * scales[index / n] / scales[index % n];
                *entry = factor * (of_first * first[index] + of_second * second[index]);
            }
            exponential.apply(half).then_some(())?;
        }
        multiply(&halves[1], &halves[0], transfer, n);
        for (index, entry) in transfer.iter_mut().enumerate() {
            *entry *= scales[index % n] / scales[index / n];
        }
    }
    floquet_of(&finer, &transfer, &unknown, scales, &mut None).ok()
}
