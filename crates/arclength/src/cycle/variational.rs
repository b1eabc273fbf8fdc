//! Multipliers of the variational equation along a given orbit, resolved as finely as it needs.
//!
//! A mesh that resolves a cycle need not resolve what happens beside it: a direction that the cycle does not feel may turn a thousand
//! times within the period. Solving for the cycle on ever finer meshes until its multipliers stay is a waste then: the orbit is
//! known, and the variational equation along it is linear. For a cycle that is confirmed it is discretised by collocation of high order
//! on parts of the intervals, along two solutions for the orbit on different meshes. What differs between both has the errors of the
//! discretisation and of the orbit in it.

use super::floquet::{Floquet, floquet};
use super::limit_cycle::LimitCycle;
use crate::collocation::equations::Collocation;
use crate::collocation::problem::BoundaryValueEquations;

/// Degree of the polynomials: the phase of a direction that turns fast has an error of order 24 in the width of a part.
const DEGREE: usize = 12;
/// Parts of an interval at most.
const MOST_PARTS: usize = 64;
/// Numbers in the matrices of all parts at most: 128 megabytes, and about a second of work.
const MOST_NUMBERS: usize = 1 << 24;

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
    let within = |pair: &[f64], part: usize| pair[0] + (pair[1] - pair[0]) * part as f64 / parts as f64;
    let mesh = orbit.mesh.windows(2).flat_map(|pair| (0..parts).map(move |part| within(pair, part)));
    let mesh: Vec<f64> = mesh.chain([1.0]).collect();
    let known = Collocation::new(problem.clone(), orbit.mesh.to_vec(), orbit.degree);
    let mut finer = Collocation::new(problem.clone(), mesh, DEGREE);
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
    floquet(&finer, &unknown, &problem.scales, &mut None).ok()
}
