//! Newton's method on the defining system of a special cycle.

use super::borders::MOST_FITS;
use super::curve::{CycleCurve, CycleInspection, Fitted};
use super::defining::{Defining, Kind};
use super::eigenfunctions::{Eigenfunctions, critical};
use super::extrema::extremes;
use super::floquet::{Floquet, floquet};
use super::limit_cycle::LimitCycle;
use super::normal_form::CriticalCycle;
use super::orbit::Orbit;
use super::sizes::extent;
use crate::collocation::equations::Collocation;
use crate::collocation::gauss::Gauss;
use crate::collocation::global_error::{GlobalError, largest};
use crate::collocation::linear_problem::Nodes;
use crate::collocation::mesh::{SAME_TIME, fit_jumps, halved};
use crate::collocation::polynomials::Polynomials;
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::{
    Adaptation, Curve, Discretised, Equations, Settings, Solution, correct, finish, rounding_updates,
};
use crate::error::Error;

/// Size, in periods, of the own scalars of a torus bifurcation: they say how much of the flow is taken out of the eigenfunction, which
/// grows without bound where the cycle shrinks to a point, and are no distance along the curve.
const GAUGE_SIZE: f64 = 1e6;

/// A curve made of a defining system, as far as Newton's method needs it.
pub(crate) struct DefiningCurve<'a> {
    pub collocation: Collocation<Defining<'a>>,
    /// Sizes of the components: states and eigenfunctions.
    pub scales: Vec<f64>,
    /// Sizes of the two parameters.
    pub parameter_scales: [f64; 2],
}

impl<'a> DefiningCurve<'a> {
    /// The defining system of a special cycle `kind` on a mesh with Gauss polynomials of `degree`, with `unknown`, which
    /// [`join`] put together, as the reference. Where `second` is `None` the second parameter has no effect.
    pub(crate) fn new(
        problem: &LimitCycle<'a>,
        kind: Kind,
        (mesh, degree): (Vec<f64>, usize),
        (second, parameter_scales): (Option<usize>, [f64; 2]),
        unknown: &[f64],
    ) -> Self {
        let defining = Defining {
            field: problem.field,
            kind,
            parameters: problem.parameters.clone(),
            active: problem.active,
            second,
            scales: problem.scales.clone(),
            segments: problem.segments.clone(),
            period_scale: unknown[unknown.len() - 3 - kind.own_scalars()],
            parameter_scale: parameter_scales[0],
            stand_in: [0.0; 3],
        };
        let scales = component_scales(&problem.scales, kind, 1.0);
        let mut collocation = Collocation::new(defining, mesh, degree);
        collocation.set_reference(unknown);
        Self { collocation, scales, parameter_scales }
    }
}

impl DefiningCurve<'_> {
    /// Errors of a solution at which the system was linearised last: the relative one of the period and the states, and that of
    /// the parameter.
    fn errors(&mut self, unknown: &[f64]) -> [f64; 2] {
        let error = GlobalError::new(self.collocation.gauss()).of(&mut self.collocation, unknown);
        let problem = &self.collocation.problem;
        let (nodes, scalars) = error.split_at(error.len() - problem.scalars());
        let states = problem.scales.len();
        let relative = nodes
            .chunks_exact(problem.dimension())
            .flat_map(|node| node[..states].iter().zip(&problem.scales))
            .map(|(error, scale)| error / scale)
            .chain([scalars[0] / problem.period_scale]);
        [largest(relative.map(f64::abs)), scalars[scalars.len() - 2].abs()]
    }
}

impl<'f> Discretised for DefiningCurve<'f> {
    type System = Collocation<Defining<'f>>;

    fn system(&self) -> &Self::System {
        &self.collocation
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.collocation
    }
}

impl Curve for DefiningCurve<'_> {
    type Point = ();
    type Kind = std::convert::Infallible;
    type Reason = std::convert::Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.collocation.apply_metric(&self.scales, vector, image);
        let end = vector.len() - self.collocation.problem.scalars();
        image[end..].copy_from_slice(&vector[end..]);
        let scale = self.collocation.problem.period_scale;
        image[end] /= scale * scale;
        // The own scalars that multiply the flow are times.
        let (times, scale) = match self.collocation.problem.kind {
            Kind::Fold => (end + 1..end + 2, scale),
            Kind::Torus => (end + 2..end + 4, GAUGE_SIZE * scale),
            Kind::Doubling | Kind::BranchPoint | Kind::Cycle => (end..end, scale),
        };
        image[times].iter_mut().for_each(|entry| *entry /= scale * scale);
        let last = vector.len() - 2;
        for (entry, scale) in image[last..].iter_mut().zip(self.parameter_scales) {
            *entry /= scale * scale;
        }
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
    fn may_stagnate(&self) -> bool {
        false
    }
    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        unknown.iter().map(|value| (*value, 1.0)).collect()
    }
}

/// A located special cycle: a solution of the branch and the critical eigenfunctions with their scalars.
pub(crate) struct Located {
    pub solution: Solution<CycleInspection>,
    pub eigenfunctions: Eigenfunctions,
}

/// Newton's method on the defining system from a nearby solution of the branch.
///
/// `tangent` is the direction of the branch nearby. `None` when it does not converge to a cycle of this kind: then there is none, for instance because two real
/// multipliers met on the unit circle's side of it.
pub(crate) fn converge(
    curve: &mut CycleCurve<'_>,
    tangent: &[f64],
    start: &Solution<CycleInspection>,
    kind: Kind,
) -> Result<Option<Located>, Error> {
    let multipliers = start.point.floquet.multipliers();
    let place = (&start.unknown[..], curve.follows_neutral_family);
    let Some(eigenfunctions) = critical(&mut curve.collocation, place, &multipliers, kind)? else {
        return Ok(None);
    };
    let problem = &curve.collocation.problem;
    let n = problem.dimension();
    let has_borders = problem.has_borders();
    let mut unknown = join(&start.unknown, n, &eigenfunctions);
    let nodes = (curve.collocation.mesh().to_vec(), curve.collocation.gauss().degree());
    let parameters = (None, [curve.parameter_scale, 1.0]);
    let mut defining_curve = DefiningCurve::new(problem, kind, nodes, parameters, &unknown);
    // The scalar of the second parameter has no effect and stays zero.
    let mut border = vec![0.0; unknown.len()];
    if let Some(last) = border.last_mut() {
        *last = 1.0;
    }
    if correct(&mut defining_curve, &mut unknown, &border, &curve.settings).is_err() {
        return Ok(None);
    }
    let (mut base, eigenfunctions) = split(&unknown, n, kind);
    base.pop();
    let [error, parameter_error] = defining_curve.errors(&unknown);
    let mut solution = if kind == Kind::BranchPoint {
        // The Jacobian bordered by the tangent is singular here: the tangent is that of the branch nearby.
        let mut residual = vec![0.0; base.len()];
        curve.factorize(&base, tangent, &mut residual);
        let point = curve.inspect(&base, tangent, 0.0)?;
        Solution { unknown: base, tangent: tangent.to_vec(), orientation: 0.0, point }
    } else {
        finish(curve, base, tangent)?
    };
    let point = &mut solution.point;
    (point.error_estimate, point.error_across) = (error, error);
    point.parameter_error = Some(parameter_error);
    // The places of extremes depend on the borders, those of special cycles do not.
    if has_borders && !fit_borders(&mut defining_curve, &mut unknown, &mut border, &curve.settings) {
        return Ok(None);
    }
    if has_borders {
        let (cycle, _) = split(&unknown, n, kind);
        let states = cycle[..cycle.len() - 3].to_vec();
        point.extremes = extremes(&defining_curve.collocation, &unknown, n);
        point.fitted = Some(Fitted { mesh: defining_curve.collocation.mesh().to_vec(), states });
    }
    Ok(Some(Located { solution, eigenfunctions }))
}

/// Moves mesh points to the borders that a special cycle passes and corrects it, until they are there; `false` where that fails.
fn fit_borders(
    curve: &mut DefiningCurve<'_>,
    unknown: &mut Vec<f64>,
    border: &mut Vec<f64>,
    settings: &Settings,
) -> bool {
    for _ in 0..MOST_FITS {
        match fit_jumps(&mut curve.collocation, unknown, &mut [border]) {
            Some(moved) if moved <= SAME_TIME => return true,
            Some(_) if correct(curve, unknown, border, settings).is_ok() => {}
            _ => return false,
        }
    }
    false
}

/// What a special cycle becomes where its unknowns, and those of its defining system, are rounded up and down.
pub(crate) fn rounded(curve: &CycleCurve<'_>, located: &Located, kind: Kind) -> Vec<Vec<f64>> {
    let (collocation, n) = (&curve.collocation, curve.collocation.problem.dimension());
    let nodes = (collocation.mesh().to_vec(), collocation.gauss().degree());
    let unknown = join(&located.solution.unknown, n, &located.eigenfunctions);
    let parameters = (None, [curve.parameter_scale, 1.0]);
    let mut defining = DefiningCurve::new(&collocation.problem, kind, nodes, parameters, &unknown);
    let (mut border, mut residual) = (vec![0.0; unknown.len()], vec![0.0; unknown.len()]);
    border[unknown.len() - 1] = 1.0;
    defining.factorize(&unknown, &border, &mut residual);
    let moved = rounding_updates(&mut defining, &unknown).map(|mut update| {
        update.iter_mut().zip(&unknown).for_each(|(update, value)| *update = value - *update);
        let (mut cycle, _) = split(&update, n, kind);
        cycle.pop();
        cycle
    });
    moved.into()
}

/// A special cycle on a finer mesh.
pub(crate) struct Finer<'a> {
    /// The cycle alone, factorised there.
    collocation: Collocation<LimitCycle<'a>>,
    unknown: Vec<f64>,
    eigenfunctions: Eigenfunctions,
}

impl Finer<'_> {
    /// Its multipliers.
    ///
    /// # Errors
    /// When they cannot be computed.
    pub(super) fn floquet(&self) -> Result<Floquet, Error> {
        floquet(&self.collocation, &self.unknown, &self.collocation.problem.scales, &mut None)
    }

    /// The coefficients of its normal form by name.
    pub(crate) fn coefficients(&self, kind: Kind) -> Vec<(&'static str, f64)> {
        CriticalCycle::of(&self.collocation, &self.unknown).coefficients(kind, &self.eigenfunctions)
    }
}

/// The same special cycle with every interval of the mesh halved; `None` where Newton's method does not find it.
pub(crate) fn on_halves<'a>(curve: &CycleCurve<'a>, located: &Located, kind: Kind) -> Option<Finer<'a>> {
    let (collocation, n) = (&curve.collocation, curve.collocation.problem.dimension());
    let (mesh, degree) = (collocation.mesh(), collocation.gauss().degree());
    let halves = halved(mesh);
    let problem = &collocation.problem;
    let parameters = (None, [curve.parameter_scale, 1.0]);
    let unknown = join(&located.solution.unknown, n, &located.eigenfunctions);
    let coarse = DefiningCurve::new(problem, kind, (mesh.to_vec(), degree), parameters, &unknown);
    let mut unknown = coarse.collocation.carry(&unknown, &halves);
    let mut fine = DefiningCurve::new(problem, kind, (halves.clone(), degree), parameters, &unknown);
    let mut border = vec![0.0; unknown.len()];
    *border.last_mut()? = 1.0;
    correct(&mut fine, &mut unknown, &border, &curve.settings).ok()?;
    let (mut unknown, eigenfunctions) = split(&unknown, n, kind);
    unknown.pop();
    let mut collocation = Collocation::new(problem.clone(), halves, degree);
    collocation.set_reference(&unknown);
    let mut border = vec![0.0; unknown.len()];
    *border.last_mut()? = 1.0;
    let mut residual = vec![0.0; unknown.len()];
    collocation.factorize(&unknown, &border, &mut residual);
    Some(Finer { collocation, unknown, eigenfunctions })
}

/// Sizes of all components of a defining system; `weight` multiplies those of the eigenfunctions.
pub(crate) fn component_scales(states: &[f64], kind: Kind, weight: f64) -> Vec<f64> {
    let mut scales = states.to_vec();
    for _ in 0..kind.eigenfunctions() {
        scales.extend(states.iter().map(|scale| match kind {
            Kind::BranchPoint => weight / scale,
            _ => weight * scale,
        }));
    }
    scales
}

/// Unknowns of a defining system from those of a cycle `(states, T, p)` and its eigenfunctions, the second parameter zero.
pub(crate) fn join(cycle: &[f64], n: usize, (functions, own): &Eigenfunctions) -> Vec<f64> {
    let states = cycle.len() - 2;
    let mut unknown = Vec::with_capacity(states * (1 + functions.len()) + own.len() + 3);
    for (node, state) in cycle[..states].chunks_exact(n).enumerate() {
        unknown.extend_from_slice(state);
        for function in functions {
            unknown.extend_from_slice(&function[node * n..(node + 1) * n]);
        }
    }
    unknown.push(cycle[states]);
    unknown.extend(own);
    unknown.extend([cycle[states + 1], 0.0]);
    unknown
}

/// The cycle `(states, T, p, second p)` of a solution of a defining system, and its eigenfunctions.
pub(crate) fn split(unknown: &[f64], n: usize, kind: Kind) -> (Vec<f64>, Eigenfunctions) {
    let width = n * (1 + kind.eigenfunctions());
    let (nodes, scalars) = unknown.split_at(unknown.len() - 3 - kind.own_scalars());
    let part = |index: usize| -> Vec<f64> {
        nodes
            .chunks_exact(width)
            .flat_map(|state| state[index * n..(index + 1) * n].iter().copied())
            .collect()
    };
    let mut cycle = part(0);
    let end = scalars.len() - 2;
    cycle.extend([scalars[0], scalars[end], scalars[end + 1]]);
    let functions = (1..=kind.eigenfunctions()).map(part).collect();
    (cycle, (functions, scalars[1..end].to_vec()))
}

/// Parameter value and period of the single cycle at the period doubling where the two halves of doubled cycles like `orbit`
/// become equal, by Newton's method.
pub(crate) fn doubling_near(
    problem: &LimitCycle<'_>,
    orbit: &Orbit,
    parameter: f64,
    parameter_scale: f64,
    settings: &Settings,
) -> Option<(f64, f64)> {
    let n = orbit.dimension;
    // The points of both halves in one mesh of the single cycle.
    let mut mesh: Vec<f64> =
        orbit.mesh.iter().map(|time| (2.0 * time).rem_euclid(1.0)).chain([0.0, 1.0]).collect();
    mesh.sort_by(f64::total_cmp);
    mesh.dedup_by(|later, earlier| *later - *earlier < CLOSE_POINTS);
    *mesh.last_mut()? = 1.0;
    let gauss = Gauss::of(orbit.degree);
    let (mut cycle, mut eigenfunction) = (Vec::new(), Vec::new());
    for pair in mesh.windows(2) {
        for node in std::iter::once(0.0).chain(gauss.points.iter().copied()) {
            let time = 0.5 * (pair[0] + node * (pair[1] - pair[0]));
            let [one, other] = [time, time + 0.5].map(|time| orbit.state_at(time * orbit.period));
            cycle.extend(one.iter().zip(&other).map(|(a, b)| 0.5 * (a + b)));
            eigenfunction.extend(one.iter().zip(&other).map(|(a, b)| 0.5 * (a - b)));
        }
    }
    cycle.extend([0.5 * orbit.period, parameter]);
    let mut problem = problem.clone();
    let states = cycle.len() - 2;
    for (component, scale) in problem.scales.iter_mut().enumerate() {
        let (low, high) = extent(&cycle[..states], n, component);
        *scale = if high > low { 0.5 * (high - low) } else { *scale };
    }
    let polynomials = Polynomials { mesh: &mesh, gauss: &gauss, n, states: &cycle };
    problem.segments = problem.segments_of(polynomials, parameter).ok()?;
    if let Some(segments) = &mut problem.segments {
        segments.snap_to(&mesh);
    }
    let nodes = Nodes { mesh: &mesh, gauss: &gauss, jumps: &[] };
    let weighted: Vec<f64> = eigenfunction
        .iter()
        .enumerate()
        .map(|(index, value)| value / problem.scales[index % n].powi(2))
        .collect();
    let size = nodes.product(&eigenfunction, &weighted).sqrt();
    eigenfunction.iter_mut().for_each(|value| *value /= size);
    let mut unknown = join(&cycle, n, &(vec![eigenfunction], Vec::new()));
    let parameters = (None, [parameter_scale, 1.0]);
    let mut curve =
        DefiningCurve::new(&problem, Kind::Doubling, (mesh.clone(), orbit.degree), parameters, &unknown);
    let mut border = vec![0.0; unknown.len()];
    *border.last_mut()? = 1.0;
    correct(&mut curve, &mut unknown, &border, settings).ok()?;
    let (cycle, _) = split(&unknown, n, Kind::Doubling);
    Some((cycle[states + 1], cycle[states]))
}

/// Mesh points closer than this count as one.
const CLOSE_POINTS: f64 = 1e-6;
