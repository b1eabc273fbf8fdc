//! Multipliers by exponentials, for cycles whose mesh may not resolve what happens beside them.
//!
//! The two exponentials of every part of an interval are exact where the Jacobian does not change, however fast a direction turns or dies
//! out, and are of order four where it does (Thalhammer, "A fourth-order commutator-free exponential integrator for nonautonomous
//! differential equations" (2006)). They are a second discretisation: where it agrees with the cycle's own, that is a witness for both.

use super::floquet::{DEFECT, Floquet, floquet_of, multiplier_changes};
use super::limit_cycle::LimitCycle;
use crate::collocation::equations::Collocation;
use crate::collocation::gauss::Gauss;
use crate::collocation::problem::BoundaryValueEquations;
use crate::differentiation::Dual;
use crate::erased::JacobianScalar;
use crate::linear::eigenvalues::EigenvalueWorkspace;
use crate::linear::exponential::{Exponential, multiply};

/// Columns of a Jacobian at a time, of few states and of many.
const NARROW: usize = 4;
const WIDE: usize = 8;

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

/// Whether the mesh of a cycle that was linearised last may not resolve the directions beside it: where one turns too far in an interval,
/// or where one dies out so fast that collocation lets it live. Eigenvalues of the Jacobian amid an interval say so; they are computed where
/// the norms of its symmetric and antisymmetric parts, which bound their real and imaginary parts (Bendixson 1902), do not exclude it.
pub(super) fn may_be_unresolved(collocation: &Collocation<LimitCycle<'_>>) -> bool {
    let problem = &collocation.problem;
    let (n, degree) = (problem.dimension(), collocation.gauss().degree());
    let size = n * (n + problem.scalars());
    let ratios = ratios(&problem.scales);
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
        for (entry, (derivative, ratio)) in scaled.iter_mut().zip(block.iter().zip(&ratios)) {
            *entry = width * derivative * ratio;
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

/// The multipliers of a cycle that was linearised last, `found` on its mesh, as told: those, where exponentials agree with them, or those by
/// exponentials, every interval in as many parts as it takes until they do not change any more and are what the divergence of the field
/// says; with the change of each. `None` where they do not settle, where that is not affordable, or where the field switches.
pub(super) fn multipliers_by_exponentials(
    collocation: &Collocation<LimitCycle<'_>>,
    unknown: &[f64],
    found: &Floquet,
) -> Option<(Floquet, Vec<f64>)> {
    if collocation.problem.has_borders() {
        return None;
    }
    let mut before: Option<Floquet> = None;
    let mut parts = 1;
    while parts <= MOST_PARTS_OF_EXPONENTIALS {
        let exponentials = by_exponentials(collocation, unknown, parts, found.divergence)?;
        // Where both agree those are told that special cycles are defined by.
        let differences = multiplier_changes(&found.nontrivial, &exponentials.nontrivial);
        if are_resolved(found, &differences) {
            return Some((found.clone(), differences));
        }
        if let Some(before) = before {
            let changes = multiplier_changes(&exponentials.nontrivial, &before.nontrivial);
            if are_resolved(&exponentials, &changes) {
                let counted = changes.iter().zip(&exponentials.nontrivial);
                let counted = counted.filter(|(_, multiplier)| multiplier.log_modulus > COUNTED);
                let measured_error = counted.map(|(change, _)| *change).fold(0.0, f64::max);
                // The cycle's own mesh resolves its direction, and the divergence along it.
                let Floquet { trivial, trivial_error, .. } = *found;
                return Some((Floquet { trivial, trivial_error, measured_error, ..exponentials }, changes));
            }
        }
        before = Some(exponentials);
        parts *= 2;
    }
    None
}

/// The multipliers by two exponentials in each of the parts of an interval. The divergence along the cycle is known better on its own mesh.
fn by_exponentials(
    collocation: &Collocation<LimitCycle<'_>>,
    unknown: &[f64],
    parts: usize,
    divergence: f64,
) -> Option<Floquet> {
    let n = collocation.problem.dimension();
    if 2 * collocation.intervals() * parts * PRODUCTS * n * n * n > MOST_MULTIPLICATIONS {
        return None;
    }
    let (flow, transfer) = if n <= NARROW {
        linearised_flow::<NARROW>(collocation, unknown, parts)?
    } else {
        linearised_flow::<WIDE>(collocation, unknown, parts)?
    };
    floquet_of(flow, &transfer, &collocation.problem.scales, (divergence, &[]), &mut None).ok()
}

/// The flow at the beginning of every part of an interval, and how the linearised flow maps it to the next part: matrices, column-major.
fn linearised_flow<const D: usize>(
    collocation: &Collocation<LimitCycle<'_>>,
    unknown: &[f64],
    parts: usize,
) -> Option<(Vec<f64>, Vec<f64>)>
where
    Dual<f64, D>: JacobianScalar,
{
    let problem = &collocation.problem;
    let n = problem.dimension();
    let ratios = ratios(&problem.scales);
    let points = &Gauss::of(WEIGHTS.len()).points;
    let polynomials = collocation.polynomials(unknown);
    let scalars = &unknown[collocation.intervals() * collocation.interval_size()..];
    let mut jacobian = Jacobian::<D>::new(problem, scalars);
    let mut exponential = Exponential::new(n);
    let mut state = vec![0.0; n];
    let mut jacobians = [vec![0.0; n * n], vec![0.0; n * n]];
    let mut halves = jacobians.clone();
    let mut flow = vec![0.0; collocation.intervals() * parts * n];
    let mut transfer = vec![0.0; collocation.intervals() * parts * n * n];
    let places = flow.chunks_exact_mut(n).zip(transfer.chunks_exact_mut(n * n)).enumerate();
    for (index, (flow, transfer)) in places {
        let (interval, part) = (index / parts, index % parts);
        let [left, right] = [collocation.mesh()[interval], collocation.mesh()[interval + 1]];
        let width = (right - left) / parts as f64;
        let time = left + part as f64 * width;
        polynomials.state_within(interval..interval + 1, time, &mut state);
        problem.field(time, &state, scalars, flow);
        for (matrix, point) in jacobians.iter_mut().zip(points) {
            let time = left + (part as f64 + point) * width;
            polynomials.state_within(interval..interval + 1, time, &mut state);
            jacobian.at(time, &state, matrix);
        }
        for (half, weights) in halves.iter_mut().zip([WEIGHTS, [WEIGHTS[1], WEIGHTS[0]]]) {
            let pairs = jacobians[0].iter().zip(&jacobians[1]);
            for (entry, ((one, other), ratio)) in half.iter_mut().zip(pairs.zip(&ratios)) {
                *entry = width * ratio * (weights[0] * one + weights[1] * other);
            }
            exponential.apply(half).then_some(())?;
        }
        multiply(&halves[1], &halves[0], transfer, n);
        transfer.iter_mut().zip(&ratios).for_each(|(entry, ratio)| *entry /= ratio);
    }
    Some((flow, transfer))
}

/// Factors by which the entries of a Jacobian (column-major) become those in units of the sizes of the states.
fn ratios(scales: &[f64]) -> Vec<f64> {
    scales.iter().flat_map(|column| scales.iter().map(move |row| column / row)).collect()
}

/// Jacobians of the field along a cycle, `D` columns at a time, with the memory for them.
struct Jacobian<'c, const D: usize> {
    problem: &'c LimitCycle<'c>,
    scalars: Vec<Dual<f64, D>>,
    state: Vec<Dual<f64, D>>,
    values: Vec<Dual<f64, D>>,
}

impl<'c, const D: usize> Jacobian<'c, D>
where
    Dual<f64, D>: JacobianScalar,
{
    fn new(problem: &'c LimitCycle<'c>, scalars: &[f64]) -> Self {
        let zeros = vec![Dual::constant(0.0); problem.dimension()];
        let scalars = scalars.iter().map(|value| Dual::constant(*value)).collect();
        Self { problem, scalars, state: zeros.clone(), values: zeros }
    }

    /// Writes the Jacobian (`n` by `n`, column-major) at a time and a state.
    fn at(&mut self, time: f64, state: &[f64], matrix: &mut [f64]) {
        for (dual, value) in self.state.iter_mut().zip(state) {
            *dual = Dual::constant(*value);
        }
        for (chunk, columns) in matrix.chunks_mut(D * state.len()).enumerate() {
            let count = columns.len() / state.len();
            for direction in 0..count {
                self.state[chunk * D + direction].derivatives[direction] = 1.0;
            }
            self.problem.field(time, &self.state, &self.scalars, &mut self.values);
            for (direction, column) in columns.chunks_exact_mut(state.len()).enumerate() {
                self.state[chunk * D + direction].derivatives[direction] = 0.0;
                for (entry, value) in column.iter_mut().zip(&self.values) {
                    *entry = value.derivatives[direction];
                }
            }
        }
    }
}
