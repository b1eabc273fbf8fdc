//! Special cycles between two points of a branch: folds, period doublings and torus bifurcations, detected by
//! test functions and located by Newton's method on their defining systems.

use super::collocation::Collocation;
use super::curve::{CycleCurve, CycleInspection, state_metric};
use super::defining::{Defining, Kind};
use super::problem::PeriodicProblem;
use crate::continuation::{Adaptation, Curve, Solution, correct, finish, locate};
use crate::error::Error;
use crate::linear::product_eigenvectors::product_eigenvector;
use num_complex::Complex64;

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

/// Part of the bracket to which a test function's zero is bracketed before Newton's method takes over.
const START_TOLERANCE: f64 = 1e-2;
/// Part of the bracket to which a branch point is located by its test function alone.
const BRANCH_POINT_TOLERANCE: f64 = 1e-8;

/// All special cycles between two consecutive solutions, in the order of the branch.
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
    let torus = outside_before.abs_diff(outside_after) >= explained + 2;
    let mut found = Vec::new();
    let sign = before.orientation;
    let wanted: [(bool, Sought); 4] = [
        (fold, Sought::Defined(Kind::Fold)),
        (doubling, Sought::Defined(Kind::Doubling)),
        (torus, Sought::Defined(Kind::Torus)),
        (branch_point, Sought::BranchPoint),
    ];
    for (_, sought) in wanted.into_iter().filter(|(detected, _)| *detected) {
        let tolerance = if sought == Sought::BranchPoint { BRANCH_POINT_TOLERANCE } else { START_TOLERANCE };
        let settings = curve.settings;
        let start = locate(curve, before, after, &settings, tolerance, |_, solution| {
            let point = &solution.point;
            match sought {
                Sought::Defined(Kind::Fold) => Some(point.fold_test),
                Sought::Defined(Kind::Doubling) => Some(point.doubling_test()),
                Sought::Defined(Kind::Torus) => torus_test(point, outside_before.min(outside_after)),
                Sought::BranchPoint => branch_point_test(solution, sign),
            }
        });
        let located = match (start, sought) {
            (Ok(Some(start)), Sought::Defined(kind)) => converge(curve, before, &start, kind)?,
            (Ok(Some(mut start)), Sought::BranchPoint) => {
                start.point.special = Some(Special::BranchPoint);
                Some(start)
            }
            (Ok(None) | Err(Error::NotFound { .. }), _) => None,
            (Err(error), _) => return Err(error),
        };
        match located {
            Some(solution) => found.push(solution),
            None => curve.unlocated.push(Unlocated {
                test: sought.name(),
                between: [before, after].map(|solution| solution.unknown[solution.unknown.len() - 1]),
            }),
        }
    }
    let mut image = vec![0.0; before.tangent.len()];
    curve.apply_metric(&before.tangent, &mut image);
    let position = |solution: &Solution<CycleInspection>| -> f64 {
        solution
            .unknown
            .iter()
            .zip(&before.unknown)
            .zip(&image)
            .map(|((a, b), weight)| (a - b) * weight)
            .sum()
    };
    found.sort_by(|a, b| position(a).total_cmp(&position(b)));
    Ok(found)
}

/// What is sought between two solutions.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sought {
    /// A special cycle with a defining system.
    Defined(Kind),
    /// A branch point.
    BranchPoint,
}

impl Sought {
    fn name(self) -> &'static str {
        match self {
            Self::Defined(Kind::Fold) => "fold of cycles",
            Self::Defined(Kind::Doubling) => "period doubling",
            Self::Defined(Kind::Torus) => "torus bifurcation",
            Self::BranchPoint => "branch point of cycles",
        }
    }
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

/// A curve made of a defining system, as far as Newton's method needs it.
struct DefiningCurve<'a> {
    collocation: Collocation<Defining<'a>>,
    scales: Vec<f64>,
    parameter_scale: f64,
}

impl Curve for DefiningCurve<'_> {
    type Point = ();

    fn unknowns(&self) -> usize {
        self.collocation.unknowns()
    }
    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.collocation.residual(unknown, residual);
    }
    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.collocation.factorize(unknown, border, residual)
    }
    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.collocation.solve(right_hand_side);
    }
    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        state_metric(&self.collocation, &self.scales, vector, image);
        let end = vector.len() - self.collocation.problem.scalars();
        image[end..].copy_from_slice(&vector[end..]);
        let scale = self.collocation.problem.period_scale;
        image[end] /= scale * scale;
        let last = vector.len() - 2;
        image[last] /= self.parameter_scale * self.parameter_scale;
    }
    fn adapt(
        &mut self,
        _unknown: &mut Vec<f64>,
        _vectors: &mut [&mut Vec<f64>],
    ) -> Result<Adaptation, Error> {
        Ok(Adaptation::Unchanged)
    }
    fn inspect(&mut self, _unknown: &[f64], _tangent: &[f64], _orientation: f64) -> Result<(), Error> {
        Ok(())
    }
    fn special_points(
        &mut self,
        _before: &Solution<()>,
        _after: &Solution<()>,
    ) -> Result<Vec<Solution<()>>, Error> {
        Ok(Vec::new())
    }
    fn signature(&self, unknown: &[f64]) -> Vec<f64> {
        unknown.to_vec()
    }
}

/// Newton's method on the defining system from a nearby solution of the branch.
///
/// `None` when it does not converge to a cycle of this kind: then there is none, for instance because two real
/// multipliers met on the unit circle's side of it.
fn converge(
    curve: &mut CycleCurve<'_>,
    before: &Solution<CycleInspection>,
    start: &Solution<CycleInspection>,
    kind: Kind,
) -> Result<Option<Solution<CycleInspection>>, Error> {
    let Some((eigenfunctions, own)) = eigenfunctions(curve, start, kind)? else { return Ok(None) };
    let problem = &curve.collocation.problem;
    let n = problem.dimension();
    let states = &start.unknown[..start.unknown.len() - 2];
    let (period, parameter) = (start.unknown[states.len()], start.unknown[states.len() + 1]);
    let mut unknown: Vec<f64> = Vec::new();
    for (node, state) in states.chunks_exact(n).enumerate() {
        unknown.extend_from_slice(state);
        for function in &eigenfunctions {
            unknown.extend_from_slice(&function[node * n..(node + 1) * n]);
        }
    }
    unknown.push(period);
    unknown.extend(own);
    unknown.extend([parameter, 0.0]);
    let defining = Defining {
        field: problem.field,
        kind,
        parameters: problem.parameters.clone(),
        active: problem.active,
        second: None,
        scales: problem.scales.clone(),
        period_scale: period,
    };
    let mut collocation =
        Collocation::new(defining, curve.collocation.mesh().to_vec(), curve.collocation.gauss().degree());
    collocation.set_reference(&unknown);
    let scales = problem.scales.repeat(1 + kind.eigenfunctions());
    let mut defining_curve = DefiningCurve { collocation, scales, parameter_scale: curve.parameter_scale };
    let mut border = vec![0.0; unknown.len()];
    if let Some(last) = border.last_mut() {
        *last = 1.0;
    }
    if correct(&mut defining_curve, &mut unknown, &border, &curve.settings).is_err() {
        return Ok(None);
    }
    let width = n * (1 + kind.eigenfunctions());
    let (functions, scalars) = unknown.split_at(states.len() / n * width);
    let mut base: Vec<f64> =
        functions.chunks_exact(width).flat_map(|state| state[..n].iter().copied()).collect();
    base.push(scalars[0]);
    base.push(scalars[scalars.len() - 2]);
    let mut solution = finish(curve, base, &before.tangent)?;
    solution.point.special = Some(match kind {
        Kind::Fold => Special::Fold,
        Kind::Doubling => Special::Doubling,
        Kind::Torus => Special::Torus { argument: scalars[1].abs() },
    });
    Ok(Some(solution))
}

/// Real eigenfunctions on the nodes of a cycle.
type Functions = Vec<Vec<f64>>;

/// Critical eigenfunctions on the nodes of the start, normalised, and the kind's own scalars.
fn eigenfunctions(
    curve: &mut CycleCurve<'_>,
    start: &Solution<CycleInspection>,
    kind: Kind,
) -> Result<Option<(Functions, Vec<f64>)>, Error> {
    let length = start.unknown.len();
    let states = length - 2;
    let (mut functions, own) = match kind {
        // At a fold the tangent, which has no component in the parameter, is the null function.
        Kind::Fold => (vec![start.tangent[..states].to_vec()], vec![start.tangent[states]]),
        Kind::Doubling | Kind::Torus => {
            // The blocks of the start itself, not of the last trial point.
            let mut residual = vec![0.0; length];
            curve.collocation.factorize(&start.unknown, &start.tangent, &mut residual);
            let near = |multiplier: &Complex64| match kind {
                Kind::Doubling => (multiplier + 1.0).norm(),
                _ => {
                    if multiplier.im > 0.0 {
                        multiplier.norm().ln().abs()
                    } else {
                        f64::INFINITY
                    }
                }
            };
            let multipliers = start.point.floquet.multipliers();
            let Some(critical) = multipliers.iter().min_by(|a, b| near(a).total_cmp(&near(b))).copied()
            else {
                return Ok(None);
            };
            if !near(&critical).is_finite() {
                return Ok(None);
            }
            (
                periodic_eigenfunctions(&curve.collocation, critical)?,
                if kind == Kind::Torus { vec![critical.arg()] } else { vec![] },
            )
        }
    };
    // Normalise in the metric of the states.
    let mut square = 0.0;
    let mut padded = vec![0.0; length];
    let mut image = vec![0.0; length];
    for function in &functions {
        padded[..states].copy_from_slice(function);
        state_metric(&curve.collocation, &curve.collocation.problem.scales, &padded, &mut image);
        square += padded.iter().zip(&image).take(states).map(|(a, b)| a * b).sum::<f64>();
    }
    if kind == Kind::Fold {
        square += (own[0] / start.unknown[states]).powi(2);
    }
    if !(square > 0.0 && square.is_finite()) {
        return Ok(None);
    }
    let factor = 1.0 / square.sqrt();
    functions.iter_mut().flatten().for_each(|value| *value *= factor);
    let own = if kind == Kind::Fold { vec![own[0] * factor] } else { own };
    Ok(Some((functions, own)))
}

/// Solutions of the variational equation with `z(1) = mu z(0)`, real for a real multiplier; for a complex one
/// real and imaginary part of `z(t) exp(-i theta t)`, which is periodic when `|mu| = 1`.
fn periodic_eigenfunctions<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    multiplier: Complex64,
) -> Result<Functions, Error> {
    let n = collocation.problem.dimension();
    let intervals = collocation.intervals();
    let degree = collocation.gauss().degree();
    let starts = product_eigenvector(collocation.transfer(), n, intervals, multiplier)
        .map_err(|_| Error::Eigenvalues { quantity: "Floquet multipliers" })?
        .vectors;
    let is_real = multiplier.im == 0.0;
    let count = if is_real { 1 } else { 2 };
    let mut functions = vec![Vec::with_capacity(collocation.unknowns()); count];
    let angle = multiplier.arg();
    let mut parts = [vec![0.0; degree * n], vec![0.0; degree * n]];
    for interval in 0..intervals {
        let start = &starts[interval * n..(interval + 1) * n];
        let real: Vec<f64> = start.iter().map(|z| z.re).collect();
        let imaginary: Vec<f64> = start.iter().map(|z| z.im).collect();
        collocation.interior_response(interval, &real, &mut parts[0]);
        collocation.interior_response(interval, &imaginary, &mut parts[1]);
        let left = collocation.mesh()[interval];
        let width = collocation.mesh()[interval + 1] - left;
        let times = std::iter::once(0.0).chain(collocation.gauss().points.iter().copied());
        for (node, position) in times.enumerate() {
            let rotation = if is_real {
                Complex64::new(1.0, 0.0)
            } else {
                Complex64::from_polar(1.0, -angle * (left + position * width))
            };
            for (component, value) in start.iter().enumerate() {
                let z = if node == 0 {
                    *value
                } else {
                    let index = (node - 1) * n + component;
                    Complex64::new(parts[0][index], parts[1][index])
                };
                let rotated = z * rotation;
                functions[0].push(rotated.re);
                if !is_real {
                    functions[1].push(rotated.im);
                }
            }
        }
    }
    Ok(functions)
}
