//! The curve of limit cycles of one parameter: mesh adaptation, metric, stability along the way.

use super::end::CycleEnd;
use super::exponentials::{may_be_unresolved, multipliers_by_exponentials};
use super::extrema::Extremes;
use super::floquet::{DEFECT, Floquet, floquet};
use super::limit_cycle::LimitCycle;
use super::segments::Segments;
use super::sizes::{StateSizes, vanishing_point};
use super::slow_passage::{Passing, SlowPassage};
use super::switching::Branching;
use crate::collocation::equations::Collocation;
use crate::collocation::global_error::{GlobalError, largest};
use crate::collocation::mesh::error_profile;
use crate::collocation::problem::BoundaryValueEquations;
use crate::collocation::resolution::Resolution;
use crate::continuation::{Settings, Solution};
use crate::error::Error;
use crate::linear::multiplier::Multiplier;
use crate::linear::periodic_schur::PeriodicSchur;

/// Samples for the difference of the halves of a doubled cycle.
const HALF_SAMPLES: usize = 64;

/// Rate of change of the parameter, as part of its range, above which its sign is certain, and one below which it is rounding.
const CERTAIN_TURN: f64 = 1e-6;
const ROUNDING_TURN: f64 = 1e-12;

/// Rate of change of the parameter, as part of its range, below which it may stand still, and logarithm of a multiplier that may
/// be one there.
pub(super) const STANDING: f64 = 1e-8;
const NEUTRAL: f64 = 1e-4;
/// That logarithm over the errors of multiplier and cycle: one that is certainly not zero is none of a family, however slowly the
/// parameter changes beside a branch point.
const NEUTRAL_ERRORS: f64 = 100.0;
/// The same along a family that was followed so far: large cycles of it may not resolve it better, and from mesh to mesh the
/// parameter changes by its error. What stands still on an analytic curve does so all along.
const STILL_STANDING: f64 = 1e-5;
const STILL_NEUTRAL: f64 = 0.5;

/// What is known about one cycle.
#[derive(Clone, Debug)]
pub(crate) struct CycleInspection {
    /// Error relative to the period and to the amplitudes; as long as it is not measured, the local estimate.
    pub error_estimate: f64,
    /// The part of it across the tangent: without what a small error of the parameter does next to a fold.
    pub(super) error_across: f64,
    /// Whether the parameter stands still and a multiplier is one, as along a family of cycles that a conserved quantity makes.
    pub(crate) is_neutral: bool,
    /// Error of the parameter at a special point.
    pub parameter_error: Option<f64>,
    /// Whether the multipliers say that the parameter changes the other way than the tangent, whose last digit that is.
    pub(super) turn_is_reversed: bool,
    /// Multipliers.
    pub floquet: Floquet,
    /// Relative errors of all multipliers, at a special cycle that was found on a second mesh.
    pub(super) multiplier_errors: Vec<f64>,
    /// Largest and smallest value of each state.
    pub(super) extremes: Vec<Extremes>,
    /// Mesh of this solution.
    pub mesh: Vec<f64>,
    /// Segments of this solution.
    pub segments: Option<Segments>,
    /// The cycle on a mesh whose points are the borders that it passes, where those of its own mesh miss them.
    pub(super) fitted: Option<Fitted>,
    /// Period and parameter, where a finer mesh gave them.
    pub(super) place: Option<[f64; 2]>,
    /// Coefficients of its normal form by name.
    pub normal_form: Vec<(&'static str, f64)>,
    /// The branch that leaves here.
    pub branching: Option<Branching>,
}

impl CycleInspection {
    /// Product of `1 + mu` over the real nontrivial multipliers, scaled: zero at a period doubling.
    pub(crate) fn doubling_test(&self) -> f64 {
        let real = self.floquet.nontrivial.iter().filter(|multiplier| multiplier.is_real());
        real.map(|multiplier| {
            let value = multiplier.to_complex().re;
            if value.is_finite() { (1.0 + value) / (1.0 + value.abs()) } else { value.signum() }
        })
        .product()
    }
}

/// A cycle with mesh points at the borders that it passes, to be told: its polynomials do not go on beyond a border.
#[derive(Clone, Debug)]
pub(crate) struct Fitted {
    pub mesh: Vec<f64>,
    pub states: Vec<f64>,
}

/// What is known of a branch of cycles from where it starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Birth {
    /// Nothing.
    Unknown,
    /// At a Hopf point whose first Lyapunov coefficient certainly is not zero: the parameter changes along the branch.
    OfCertainSense,
    /// At a period doubling: it ends where the cycles become single again.
    Doubled,
}

/// Limit cycles `u' = T f(u, p)` along one parameter.
#[derive(Debug)]
pub(crate) struct CycleCurve<'a> {
    /// The discretised problem.
    pub collocation: Collocation<LimitCycle<'a>>,
    /// Resolution asked for.
    pub resolution: Resolution,
    /// Settings of corrections made while special points are located.
    pub settings: Settings,
    /// Weight of the parameter in the metric: the length of its range.
    pub parameter_scale: f64,
    pub(super) period_scale: f64,
    /// Sizes that measure the error: amplitudes.
    pub(super) amplitudes: Vec<f64>,
    pub(super) sizes: StateSizes,
    /// What is known of the branch from where it starts.
    pub birth: Birth,
    pub(super) error_estimate: f64,
    /// Whether both ends of the last step are neutral.
    pub(super) follows_neutral_family: bool,
    /// Factor of the tolerance that the multipliers ask for.
    pub(super) refinement: f64,
    pub(super) global_error: GlobalError,
    pub(super) schur: Option<(usize, PeriodicSchur)>,
    /// Sign of the rate of change of the parameter, the orientation and the parity of the number of multipliers above one,
    /// multiplied: the same all along the curve.
    relation: Option<f64>,
    /// Why the segments of the start are not known.
    pub(super) segments_error: Option<Error>,
    /// An event that a cycle did not come to any more where it had to.
    pub(super) lost: Option<usize>,
    /// Whether a cycle was met that passes no event without its jump.
    pub(super) is_clear: bool,
    /// The grazing in which the curve ends, with the unknowns of the solution before it.
    pub(super) grazes: Option<(CycleEnd, Vec<f64>)>,
}

impl<'a> CycleCurve<'a> {
    /// The curve through a start that is given on the mesh of the collocation.
    pub(crate) fn new(
        collocation: Collocation<LimitCycle<'a>>,
        resolution: Resolution,
        parameter_scale: f64,
        start: &[f64],
    ) -> Self {
        let sizes = StateSizes::new(&collocation.problem, start, parameter_scale);
        Self::with_sizes(collocation, (resolution, parameter_scale), start, sizes)
    }

    /// The same with sizes that are known.
    pub(super) fn with_sizes(
        mut collocation: Collocation<LimitCycle<'a>>,
        (resolution, parameter_scale): (Resolution, f64),
        start: &[f64],
        sizes: StateSizes,
    ) -> Self {
        collocation.set_reference(start);
        let n = collocation.problem.dimension();
        collocation.problem.segments = None;
        let segments_error = find_segments(&mut collocation, start).err();
        if collocation.problem.has_borders() {
            collocation.set_mesh(collocation.mesh().to_vec(), start);
        }
        let mut curve = Self {
            segments_error,
            resolution,
            settings: Settings::default(),
            parameter_scale,
            period_scale: 1.0,
            amplitudes: vec![1.0; n],
            sizes,
            birth: Birth::Unknown,
            error_estimate: f64::INFINITY,
            follows_neutral_family: false,
            refinement: 1.0,
            global_error: GlobalError::new(collocation.gauss()),
            collocation,
            schur: None,
            relation: None,
            lost: None,
            is_clear: false,
            grazes: None,
        };
        curve.rescale(start);
        curve.collocation.set_reference(start);
        curve
    }

    /// The same curve on another mesh, on which the unknowns are those of a solution.
    pub(super) fn on_mesh(&self, mesh: Vec<f64>, unknown: &[f64]) -> Self {
        let degree = self.collocation.gauss().degree();
        let collocation = Collocation::new(self.collocation.problem.clone(), mesh, degree);
        let settings = (self.resolution, self.parameter_scale);
        let mut curve = Self::with_sizes(collocation, settings, unknown, self.sizes.anew());
        (curve.settings, curve.birth) = (self.settings, self.birth);
        curve
    }

    /// Measures sizes on a solution.
    pub(super) fn rescale(&mut self, unknown: &[f64]) {
        let end = unknown.len() - 2;
        for (component, size) in self.sizes.measure(&unknown[..end]).into_iter().enumerate() {
            self.amplitudes[component] = size.amplitude;
            self.collocation.problem.scales[component] = size.scale;
        }
        self.period_scale = unknown[end].abs();
    }

    /// Gives states that rest the sizes that the nonlinearity of the field gives them, where a branch is left on which they do.
    pub(super) fn count_resting_states_fully(&mut self) {
        for (scale, natural) in self.collocation.problem.scales.iter_mut().zip(self.sizes.natural()) {
            *scale = scale.max(natural);
        }
    }

    /// The equilibrium beside which a cycle is slowest, if it makes periods grow without bound.
    pub(super) fn slow_passage(&self, unknown: &[f64]) -> Option<SlowPassage> {
        self.passing(unknown, |passing| passing.slow_passage())
    }

    /// Whether a cycle is too fast for a field without jumps.
    pub(super) fn lives_by_jumps(&self, unknown: &[f64]) -> bool {
        let period = unknown[unknown.len() - 2];
        self.passing(unknown, |passing| passing.is_too_fast(period))
    }

    fn passing<T>(&self, unknown: &[f64], look: impl FnOnce(&Passing<'_>) -> T) -> T {
        let problem = &self.collocation.problem;
        let (states, scalars) = unknown.split_at(unknown.len() - 2);
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = scalars[1];
        look(&Passing {
            field: problem.field,
            parameters: &parameters,
            active: (problem.active, self.parameter_scale),
            states,
            scales: &problem.scales,
        })
    }

    /// Multipliers of the cycle that was linearised last and, where they had to be computed by other means than its mesh, their errors.
    pub(super) fn multipliers(&mut self, unknown: &[f64]) -> Result<(Floquet, Vec<f64>), Error> {
        let problem = &self.collocation.problem;
        let found = floquet(&self.collocation, unknown, &problem.scales, &mut self.schur)?;
        // In the plane the only one is known from the divergence.
        let is_doubtful = found.nontrivial.len() > 1
            && (found.is_contradictory() || found.defect() > DEFECT || may_be_unresolved(&self.collocation));
        if !is_doubtful {
            return Ok((found, Vec::new()));
        }
        Ok(match multipliers_by_exponentials(&self.collocation, unknown, &found) {
            Some((told, changes)) => {
                let errors = told.errors(&changes);
                (told, errors)
            }
            None => (found, Vec::new()),
        })
    }

    /// Rate of change of the parameter along the curve, as part of its range: zero at a fold.
    pub(crate) fn turn(&self, tangent: &[f64]) -> f64 {
        tangent.last().map_or(0.0, |rate| rate / self.parameter_scale)
    }

    /// Whether the parameter stands still at a cycle with a multiplier one. At a single cycle this may be a fold; from cycle to
    /// cycle it is a family for one parameter value (Munoz-Almaraz, Freire, Galan, Doedel and Vanderbauwhede, "Continuation of
    /// periodic orbits in conservative and Hamiltonian systems" (2003)).
    pub(super) fn is_neutral(&self, tangent: &[f64], floquet: &Floquet) -> bool {
        let (standing, near) = if self.follows_neutral_family {
            (STILL_STANDING, STILL_NEUTRAL)
        } else {
            let error = floquet.margin().max(floquet.defect()).max(self.error_estimate);
            (STANDING, NEUTRAL.min(NEUTRAL_ERRORS * error))
        };
        let one = |multiplier: &Multiplier| multiplier.argument == 0.0 && multiplier.log_modulus.abs() < near;
        self.birth != Birth::OfCertainSense
            && self.turn(tangent).abs() < standing
            && floquet.nontrivial.iter().any(one)
    }

    /// Whether the rate of change of the parameter has the wrong sign. On the explosion of a canard it may be nothing but
    /// rounding; its sign, which changes where a multiplier passes one or the orientation changes, is known from these.
    pub(super) fn turn_is_reversed(&mut self, tangent: &[f64], orientation: f64, floquet: &Floquet) -> bool {
        let turn = self.turn(tangent);
        let relation = turn.signum() * orientation * floquet.parity_above_one();
        if relation == 0.0 || floquet.is_contradictory() {
            return false;
        }
        if turn.abs() > CERTAIN_TURN {
            self.relation = Some(relation);
        }
        // In the plane the multiplier is known better than the parameter, whatever the mesh.
        let uncertain = if floquet.nontrivial.len() == 1 { CERTAIN_TURN } else { ROUNDING_TURN };
        turn.abs() < uncertain && self.relation.is_some_and(|known| known != relation)
    }

    /// The rate of change of the parameter with the right sign.
    pub(super) fn certain_turn(&self, solution: &Solution<CycleInspection>) -> f64 {
        let turn = self.turn(&solution.tangent);
        if solution.point.turn_is_reversed { -turn } else { turn }
    }

    /// Relative errors of a cycle at which the collocation was linearised last: of the period and the extremes of the cycle with
    /// the same parameter value, and across the tangent of the period and all states at all times.
    pub(super) fn errors(&mut self, unknown: &[f64], tangent: &[f64]) -> [f64; 2] {
        let error = self.global_error.of(&mut self.collocation, unknown);
        let (states, scalars) = error.split_at(error.len() - 2);
        let (along_states, along) = tangent.split_at(tangent.len() - 2);
        let shift = scalars[1] / along[1];
        let period = unknown[unknown.len() - 2].abs();
        let sizes = self.amplitudes.iter().cycle().take(states.len()).chain([&period]);
        let across = states.iter().chain(&scalars[..1]).zip(sizes).map(|(error, size)| (error / size).abs());
        let across = largest(across);
        let n = self.amplitudes.len();
        let nodes = states.len() / n;
        let mut fixed = largest([((scalars[0] - shift * along[0]) / period).abs()].into_iter());
        for (component, size) in self.amplitudes.iter().enumerate() {
            let value = |node: usize| unknown[node * n + component];
            let by_value = |a: &usize, b: &usize| value(*a).total_cmp(&value(*b));
            let ends = [(0..nodes).max_by(by_value), (0..nodes).min_by(by_value)];
            // Around the extreme node, so that a zero of the error there does not count.
            let around = ends.into_iter().flatten().flat_map(|node| [node + nodes - 1, node, node + 1]);
            let errors = around.map(|node| (node % nodes) * n + component);
            let errors = errors.map(|place| ((states[place] - shift * along_states[place]) / size).abs());
            fixed = fixed.max(largest(errors));
        }
        [fixed, across]
    }

    /// Estimates the error of a cycle on the mesh as it is.
    pub(crate) fn estimate_error(&mut self, unknown: &[f64]) {
        self.rescale(unknown);
        let errors = error_profile(&self.collocation, unknown, &self.amplitudes);
        self.error_estimate = errors.into_iter().fold(0.0, f64::max);
    }

    /// Parameter value at which the two halves of a doubled cycle become equal between two solutions.
    pub(super) fn single_again(&self, before: &[f64], after: &[f64]) -> Option<f64> {
        let n = self.collocation.problem.dimension();
        let half_difference = |unknown: &[f64]| -> Vec<f64> {
            let (mut one, mut other) = (vec![0.0; n], vec![0.0; n]);
            let mut differences = Vec::with_capacity(n * HALF_SAMPLES);
            for sample in 0..HALF_SAMPLES {
                let time = 0.5 * sample as f64 / HALF_SAMPLES as f64;
                self.collocation.evaluate(unknown, time, &mut one);
                self.collocation.evaluate(unknown, time + 0.5, &mut other);
                let scaled = one.iter().zip(&other).zip(&self.collocation.problem.scales);
                differences.extend(scaled.map(|((a, b), scale)| (a - b) / scale));
            }
            differences
        };
        let (one, other) = (half_difference(before), half_difference(after));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (size_before, size_after) = (product(&one, &one), product(&other, &other));
        if product(&one, &other) >= 0.0 {
            return None;
        }
        let (a, b) = (before[before.len() - 1], after[after.len() - 1]);
        Some(vanishing_point((a, size_before), (b, size_after)))
    }
}

/// Finds the segments of a cycle, with the borders at points of the mesh.
fn find_segments(collocation: &mut Collocation<LimitCycle<'_>>, unknown: &[f64]) -> Result<(), Error> {
    find_exact_segments(collocation, unknown)?;
    let mesh = collocation.mesh().to_vec();
    if let Some(segments) = &mut collocation.problem.segments {
        segments.snap_to(&mesh);
    }
    Ok(())
}

/// Finds the segments of a cycle with the borders where they are.
pub(super) fn find_exact_segments(
    collocation: &mut Collocation<LimitCycle<'_>>,
    unknown: &[f64],
) -> Result<(), Error> {
    let value = unknown[unknown.len() - 1];
    let found = collocation.problem.segments_of(collocation.polynomials(unknown), value)?;
    collocation.problem.segments = found;
    Ok(())
}
