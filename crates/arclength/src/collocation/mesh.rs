//! Error estimate of a collocation solution and meshes that equidistribute it.
//!
//! On an interval of width `h` the residual of a collocation polynomial is, to leading order, a constant
//! times `(t - c_1) ... (t - c_m)`. Its value at the two ends of the interval gives the constant, its
//! integral the error of the polynomial between the mesh points. (At the mesh points the error is of order
//! `h^(2m)` and much smaller.) Sources: de Boor, "Good approximation by splines with variable knots" (1973);
//! Russell and Christiansen, "Adaptive mesh selection strategies" (1978).

use super::equations::Collocation;
use super::polynomials::{MOST_NODES, combine};
use super::problem::BoundaryValueEquations;
use super::resolution::Resolution;
use crate::continuation::Adaptation;
use crate::error::Error;

/// Ratio of the largest to the smallest mesh width of neighbours-to-be is limited through this floor on
/// the mesh density, relative to its mean.
const DENSITY_FLOOR: f64 = 0.2;
/// A new mesh aims at this part of the tolerance.
const TARGET: f64 = 0.2;
/// An error of an interval below this, relative to the sizes of the states, is rounding, which is no smaller where the interval is narrower.
const ROUNDING: f64 = 1e-13;
/// Fewest intervals between two jumps.
const FEWEST_BETWEEN_JUMPS: f64 = 2.0;
/// The mesh is made coarser when it has this many times the intervals needed, and made anew where a part of it between two jumps, which
/// may shrink from step to step, has this many times its share.
const EXCESS: f64 = 1.6;
const EXCESS_OF_A_PART: f64 = 2.0;

/// Largest error of the polynomial on each interval, relative to `scales`.
pub(crate) fn error_profile<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    unknown: &[f64],
    scales: &[f64],
) -> Vec<f64> {
    let gauss = collocation.gauss();
    let n = collocation.problem.dimension();
    let intervals = collocation.intervals();
    let scalars = &unknown[intervals * collocation.interval_size()..];
    let shape = gauss.largest_integral;
    let ends = [0.0, 1.0];
    let mut bases = [[0.0; MOST_NODES]; 2];
    let mut slopes = [[0.0; MOST_NODES]; 2];
    let nodes = gauss.degree() + 1;
    for (index, end) in ends.iter().enumerate() {
        gauss.basis(*end, &mut bases[index][..nodes]);
        gauss.basis_slopes(*end, &mut slopes[index][..nodes]);
    }
    let (mut state, mut slope, mut field) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    (0..intervals)
        .map(|interval| {
            let (left, right) = (collocation.mesh()[interval], collocation.mesh()[interval + 1]);
            let width = right - left;
            let values = collocation.interval(unknown, interval);
            let mut largest = 0.0_f64;
            for (index, end) in ends.iter().enumerate() {
                combine(values, &bases[index][..nodes], &mut state);
                combine(values, &slopes[index][..nodes], &mut slope);
                // At its end the field is still that of the interval.
                let time = (left + end * width).min(right.next_down());
                collocation.problem.field(time, &state, scalars, &mut field);
                let constant = 1.0 / gauss.node_polynomial(*end);
                for component in 0..scales.len() {
                    let residual = slope[component] - width * field[component];
                    largest = largest.max((residual * constant * shape / scales[component]).abs());
                }
            }
            largest
        })
        .collect()
}

/// Fits the mesh of `collocation` to the errors of the intervals at `unknown` and carries `unknown` and `vectors` over to it;
/// makes `unknown` the reference either way. Returns the largest error on the mesh that was.
///
/// # Errors
/// [`Error::MeshLimit`] when the errors are not finite or more intervals would be needed than allowed.
pub(crate) fn fit_mesh<P: BoundaryValueEquations>(
    collocation: &mut Collocation<P>,
    errors: &[f64],
    resolution: &Resolution,
    unknown: &mut Vec<f64>,
    vectors: &mut [&mut Vec<f64>],
) -> Result<(Adaptation, f64), Error> {
    let worst = errors.iter().copied().fold(0.0, f64::max);
    let limit = resolution.most_intervals;
    if !worst.is_finite() {
        return Err(Error::MeshLimit { limit, error_estimate: f64::MAX });
    }
    let degree = collocation.gauss().degree();
    let intervals = collocation.intervals();
    let needed = intervals_needed(errors, degree, TARGET * resolution.tolerance);
    let wanted = (needed.ceil() as usize).max(resolution.fewest_intervals);
    let too_coarse = worst > resolution.tolerance || intervals < resolution.fewest_intervals;
    let is_fine = !too_coarse && (intervals as f64) < EXCESS * wanted as f64;
    let kept = collocation.jump_points();
    // Without jumps there is one part, which has its share.
    if is_fine && kept.is_empty() {
        collocation.set_reference(unknown);
        return Ok((Adaptation::Unchanged, worst));
    }
    let masses = masses(collocation.mesh(), errors, degree);
    let is_distorted = parts(&masses, &kept)
        .any(|(part, share)| part.len() as f64 > EXCESS_OF_A_PART * count_of_part(share, intervals) as f64);
    if is_fine && !is_distorted {
        collocation.set_reference(unknown);
        return Ok((Adaptation::Unchanged, worst));
    }
    if wanted > limit {
        return Err(Error::MeshLimit { limit, error_estimate: worst });
    }
    // An estimate from a coarse mesh is not to be trusted far: at most double at a time.
    let count = wanted.min(2 * intervals);
    let count = if too_coarse { count.max(intervals + 1) } else { count };
    let mesh = equidistribute(collocation.mesh(), &masses, count, &kept);
    collocation.move_to_mesh(mesh, unknown, vectors);
    Ok((Adaptation::Changed, worst))
}

/// As many intervals, divided anew by their errors without what is rounding, where a jump misses its mesh point by more than the width of
/// an interval beside it: polynomials do not go on that far. Carries `unknown` and `vectors` along.
pub(crate) fn widen_beside_jumps<P: BoundaryValueEquations>(
    collocation: &mut Collocation<P>,
    scales: &[f64],
    unknown: &mut Vec<f64>,
    vectors: &mut [&mut Vec<f64>],
) {
    let Some(times) = jump_times(collocation, unknown) else { return };
    let (mesh, kept) = (collocation.mesh(), collocation.jump_points());
    let is_narrow = |(time, point): (&f64, &usize)| {
        let width = (mesh[*point] - mesh[point - 1]).min(mesh[point + 1] - mesh[*point]);
        (time - mesh[*point]).abs() > width
    };
    if !times.iter().zip(&kept).any(is_narrow) {
        return;
    }
    let mut errors = error_profile(collocation, unknown, scales);
    errors.iter_mut().filter(|error| **error < ROUNDING).for_each(|error| *error = 0.0);
    let masses = masses(mesh, &errors, collocation.gauss().degree());
    let mesh = equidistribute(mesh, &masses, collocation.intervals(), &kept);
    collocation.move_to_mesh(mesh, unknown, vectors);
}

/// Number of intervals of an equidistributed mesh that would have the error `target`.
fn intervals_needed(errors: &[f64], degree: usize, target: f64) -> f64 {
    let power = 1.0 / (degree as f64 + 1.0);
    errors.iter().map(|error| (error / target).powf(power)).sum()
}

/// The part of the intervals of a new mesh that every old one stands for.
fn masses(mesh: &[f64], errors: &[f64], degree: usize) -> Vec<f64> {
    let power = 1.0 / (degree as f64 + 1.0);
    let total: f64 = errors.iter().map(|error| error.powf(power)).sum();
    // The floor keeps quiet stretches from being starved.
    let floor = DENSITY_FLOOR * total.max(f64::MIN_POSITIVE);
    let pairs = errors.iter().zip(mesh.windows(2));
    pairs.map(|(error, pair)| error.powf(power) + floor * (pair[1] - pair[0])).collect()
}

/// The masses of the parts between mesh points number `kept`, each with its share of all.
fn parts<'a>(masses: &'a [f64], kept: &'a [usize]) -> impl Iterator<Item = (&'a [f64], f64)> {
    let all: f64 = masses.iter().sum();
    let ends = kept.iter().copied().chain([masses.len()]);
    let starts = std::iter::once(0).chain(kept.iter().copied());
    starts.zip(ends).map(move |(start, end)| {
        let part = &masses[start..end];
        (part, if kept.is_empty() { 1.0 } else { part.iter().sum::<f64>() / all })
    })
}

/// Number of intervals that a part between two jumps has of some.
fn count_of_part(share: f64, intervals: usize) -> usize {
    (share * intervals as f64).round().max(FEWEST_BETWEEN_JUMPS) as usize
}

/// A mesh of about `intervals` intervals on which the error is about the same everywhere; mesh points number `kept` stay.
fn equidistribute(mesh: &[f64], masses: &[f64], intervals: usize, kept: &[usize]) -> Vec<f64> {
    let mut result = vec![0.0];
    let mut start = 0;
    for (part, share) in parts(masses, kept) {
        let end = start + part.len();
        let count = if kept.is_empty() { intervals } else { count_of_part(share, intervals) };
        result.extend(dividing_equally(&mesh[start..=end], part, count));
        result.push(mesh[end]);
        start = end;
    }
    result
}

/// The points that divide the intervals of `knots` anew into as many, in each of which there is an equal part of their masses.
pub(crate) fn dividing_equally(knots: &[f64], masses: &[f64], intervals: usize) -> Vec<f64> {
    let sum: f64 = masses.iter().sum();
    let (mut interval, mut passed) = (0, 0.0);
    let point = |index: usize| {
        let wanted = sum * index as f64 / intervals as f64;
        while interval + 1 < masses.len() && passed + masses[interval] < wanted {
            passed += masses[interval];
            interval += 1;
        }
        let fraction = ((wanted - passed) / masses[interval]).clamp(0.0, 1.0);
        knots[interval] + fraction * (knots[interval + 1] - knots[interval])
    };
    (1..intervals).map(point).collect()
}

/// The mesh with every interval halved.
pub(crate) fn halved(mesh: &[f64]) -> Vec<f64> {
    let starts = mesh.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
    starts.chain(mesh.last().copied()).collect()
}

/// The times at which jumps take place, which mesh points may miss, in unit time; `None` where one does not take place nearby.
pub(crate) fn jump_times<P: BoundaryValueEquations>(
    collocation: &Collocation<P>,
    unknown: &[f64],
) -> Option<Vec<f64>> {
    let scalars = &unknown[unknown.len() - collocation.problem.scalars()..];
    let jumps = collocation.problem.jumps().iter().zip(collocation.jump_points()).enumerate();
    let time = |(index, (time, point)): (usize, (&f64, usize))| {
        let before = collocation.end_of(unknown, point - 1);
        Some(time + collocation.problem.delay(index, &before, scalars)?)
    };
    jumps.map(time).collect()
}

/// Moves the mesh points of jumps to where the jumps take place, and those between them in proportion; carries `unknown` and
/// `vectors` along. `None` where a jump does not take place nearby. Returns the largest distance by which one was moved.
pub(crate) fn fit_jumps<P: BoundaryValueEquations>(
    collocation: &mut Collocation<P>,
    unknown: &mut Vec<f64>,
    vectors: &mut [&mut Vec<f64>],
) -> Option<f64> {
    let old = collocation.problem.jumps().to_vec();
    let points = collocation.jump_points();
    let times = jump_times(collocation, unknown)?;
    let largest = times.iter().zip(&old).map(|(time, old)| (time - old).abs()).fold(0.0, f64::max);
    let is_ordered = times.first().is_none_or(|time| *time > 0.0)
        && times.last().is_none_or(|time| *time < 1.0)
        && times.windows(2).all(|pair| pair[0] < pair[1]);
    if !is_ordered {
        return None;
    }
    if largest <= SAME_TIME {
        return Some(largest);
    }
    let mut mesh = collocation.mesh().to_vec();
    let ends =
        |list: &[f64]| -> Vec<f64> { [0.0].into_iter().chain(list.iter().copied()).chain([1.0]).collect() };
    let (from, to) = (ends(&old), ends(&times));
    let mut start = 0;
    for (segment, end) in points.iter().copied().chain([mesh.len() - 1]).enumerate() {
        for point in &mut mesh[start + 1..end] {
            let part = (*point - from[segment]) / (from[segment + 1] - from[segment]);
            *point = to[segment] + part * (to[segment + 1] - to[segment]);
        }
        if end + 1 < mesh.len() {
            mesh[end] = times[segment];
        }
        start = end;
    }
    if !mesh.windows(2).all(|pair| pair[0] < pair[1]) {
        return None;
    }
    *unknown = collocation.carry_segments(unknown, &mesh, &points);
    for vector in vectors.iter_mut() {
        **vector = collocation.carry_segments(vector, &mesh, &points);
    }
    collocation.problem.move_jumps(&times);
    collocation.set_mesh(mesh, unknown);
    Some(largest)
}

/// Two times of the unit interval that are closer than this are one.
pub(crate) const SAME_TIME: f64 = 1e-10;
