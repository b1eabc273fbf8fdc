//! A curve of special cycles as continuation sees it.

use super::end::CycleLocusEnd;
use super::hold::Hold;
use super::monitor;
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::collocation::global_error::{GlobalError, largest};
use crate::collocation::mesh::{error_profile, fit_jumps, fit_mesh};
use crate::collocation::polynomials::Polynomials;
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::events::{Location, Reading, Spectrum, TestFunction};
use crate::continuation::{Adaptation, Curve, Ending, Equations, Settings, Solution, Stop};
use crate::cycle::defining::Kind;
use crate::cycle::eigenfunctions::Eigenfunctions;
use crate::cycle::extrema::{Extremes, extremes};
use crate::cycle::floquet::{Floquet, floquet};
use crate::cycle::limit_cycle::LimitCycle;
use crate::cycle::locating::{DefiningCurve, component_scales, split};
use crate::cycle::normal_form::CriticalCycle;
use crate::cycle::segments::Segments;
use crate::cycle::sizes::{StateSizes, vanishing_point};
use crate::cycle::slow_passage::{Passing, SlowPassage};
use crate::cycle::{CycleEnd, Resolution};
use crate::error::{CorrectionFailure, Error};
use crate::linear::periodic_schur::PeriodicSchur;
use num_complex::Complex64;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

/// Sizes of eigenfunctions in the metric, so that they count less than states and parameters.
const EIGENFUNCTION_WEIGHT: f64 = 10.0;
/// The sizes are measured anew when one has changed by this factor.
const SIZE_CHANGE: f64 = 1.5;

/// A state counts as one that rests if its amplitude where the curve starts is below this part of the size that the
/// nonlinearity of the field gives it.
const RESTING: f64 = 1e-4;
/// Distance of the angle from that of a resonance within which it counts as there.
const AT_RESONANCE: f64 = 1e-6;
/// Samples for the difference of the halves of a doubled cycle.
const HALF_SAMPLES: usize = 64;

/// What is known about a point of the curve.
#[derive(Clone, Debug)]
pub(super) struct CycleLocusInspection {
    /// Error of cycle and eigenfunctions relative to their sizes; as long as it is not measured, the local estimate.
    pub error_estimate: f64,
    pub floquet: Floquet,
    pub extremes: Vec<Extremes>,
    pub mesh: Vec<f64>,
    pub tests: Vec<(SpecialKind, f64)>,
    /// Coefficient of the normal form.
    pub coefficient: Option<f64>,
    /// What that coefficient counts against.
    pub natural_coefficient: f64,
    /// Argument of the multipliers of a torus bifurcation.
    pub argument: Option<f64>,
    /// Error estimates of the two parameters at a point of codimension two.
    pub location_error: Option<[f64; 2]>,
}

/// The curve of one kind of special cycles in two parameters.
pub(super) struct CycleLocusCurve<'a> {
    pub system: DefiningCurve<'a>,
    /// The cycle alone, for its multipliers and normal form.
    base: Collocation<LimitCycle<'a>>,
    resolution: Resolution,
    pub(super) settings: Settings,
    states: usize,
    second: usize,
    sizes: StateSizes,
    error_estimate: f64,
    global_error: GlobalError,
    /// Smallest scales of the states: their natural sizes where they rest, otherwise zero.
    least: Vec<f64>,
    /// Sign of the null function of a fold with which its coefficient is positive where the curve starts.
    sign: Option<f64>,
    schur: Option<(usize, PeriodicSchur)>,
    /// What keeps its value along a curve of [any cycles](Kind::Cycle).
    pub hold: Option<Hold>,
}

impl<'a> CycleLocusCurve<'a> {
    pub(super) fn new(
        mut system: DefiningCurve<'a>,
        base: Collocation<LimitCycle<'a>>,
        sizes: StateSizes,
        second: usize,
        (resolution, settings): (Resolution, Settings),
        least: Vec<f64>,
    ) -> Self {
        let global_error = GlobalError::new(system.collocation.gauss());
        let states = system.collocation.problem.scales.len();
        let kind = system.collocation.problem.kind;
        system.scales = component_scales(&system.collocation.problem.scales, kind, EIGENFUNCTION_WEIGHT);
        Self {
            system,
            base,
            resolution,
            settings,
            states,
            second,
            sizes,
            error_estimate: f64::INFINITY,
            global_error,
            least,
            sign: None,
            schur: None,
            hold: None,
        }
    }

    pub(super) fn kind(&self) -> Kind {
        self.system.collocation.problem.kind
    }

    /// Measures the period and the sizes of the states; whether they have changed so much that the normalisation has to follow.
    fn rescale(&mut self, cycle: &[f64]) -> bool {
        let mut changed = false;
        let mut follow = |old: &mut f64, scale: f64| {
            let ratio = scale / *old;
            if scale > 0.0 && ratio.is_finite() && !(1.0 / SIZE_CHANGE..=SIZE_CHANGE).contains(&ratio) {
                *old = scale;
                changed = true;
            }
        };
        let (states, period) = (&cycle[..cycle.len() - 3], cycle[cycle.len() - 3]);
        let problem = &mut self.system.collocation.problem;
        follow(&mut problem.period_scale, period);
        for ((old, size), least) in problem.scales.iter_mut().zip(self.sizes.measure(states)).zip(&self.least)
        {
            follow(old, size.scale.max(*least));
        }
        if changed {
            let scales = self.system.collocation.problem.scales.clone();
            self.system.scales = component_scales(&scales, self.kind(), EIGENFUNCTION_WEIGHT);
            self.base.problem.scales = scales;
        }
        changed
    }

    /// Sizes against which errors count: of the states their own, of eigenfunctions their largest one in units of the states.
    fn error_scales(&self, functions: &Eigenfunctions) -> Vec<f64> {
        let scales = &self.system.collocation.problem.scales;
        let mut all = scales.clone();
        for function in &functions.0 {
            let largest = function
                .chunks_exact(self.states)
                .flat_map(|state| state.iter().zip(scales).map(|(value, scale)| (value / scale).abs()))
                .fold(0.0, f64::max)
                .max(f64::MIN_POSITIVE);
            all.extend(scales.iter().map(|scale| scale * largest));
        }
        all
    }

    /// The error of cycle and eigenfunctions at a solution at which the system was factorised last, relative to their sizes: what
    /// the defect of the polynomials does through the linearised equations, across the curve.
    fn error(&mut self, unknown: &[f64]) -> f64 {
        let mut error = self.global_error.of(&mut self.system.collocation, unknown);
        if let Some(hold) = &self.hold {
            hold.change_by(0.0, &self.system, &mut error);
        }
        let (_, eigenfunctions) = split(unknown, self.states, self.kind());
        let sizes = self.error_scales(&eigenfunctions);
        let problem = &self.system.collocation.problem;
        let (nodes, scalars) = error.split_at(error.len() - problem.scalars());
        let relative = nodes.iter().zip(sizes.iter().cycle()).map(|(error, size)| error / size);
        largest(relative.chain([scalars[0] / problem.period_scale]).map(f64::abs))
    }

    /// Coefficient of the normal form, and what it counts against; the base has just been factorised.
    fn coefficient(&self, cycle: &[f64], eigenfunctions: &Eigenfunctions) -> (Option<f64>, f64) {
        let critical = CriticalCycle::of(&self.base, &cycle[..cycle.len() - 1]);
        let coefficient = match self.kind() {
            _ if self.base.problem.has_borders() => None,
            Kind::Fold => critical.fold(eigenfunctions).map(|(own, _)| own),
            Kind::Doubling => critical.doubling(eigenfunctions),
            Kind::Torus => critical.torus(eigenfunctions).map(|[real, _]| real),
            Kind::BranchPoint | Kind::Cycle => None,
        };
        let scales = &self.system.collocation.problem.scales;
        let sizes: Vec<f64> =
            self.sizes.natural().zip(scales).map(|(natural, scale)| natural.max(*scale)).collect();
        (coefficient, critical.natural_coefficient(self.kind(), eigenfunctions, &sizes))
    }

    /// Moves mesh points to the borders that the cycle passes; they have to be those that it passed before.
    fn fit_segments(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<(), Error> {
        let collocation = &mut self.system.collocation;
        let Some(segments) = &collocation.problem.segments else { return Ok(()) };
        let (cycle, _) = split(unknown, self.states, collocation.problem.kind);
        let end = cycle.len() - 3;
        let mut parameters = collocation.problem.parameters.clone();
        parameters[collocation.problem.active] = cycle[end + 1];
        parameters[self.second] = cycle[end + 2];
        let polynomials = Polynomials {
            mesh: collocation.mesh(),
            gauss: collocation.gauss(),
            n: self.states,
            states: &cycle,
        };
        let now = Segments::of(collocation.problem.field, polynomials, &parameters, Some(segments))?;
        let is_same = now.is_some_and(|now| now.are_like(segments) && now.touched.is_none());
        if !is_same || fit_jumps(collocation, unknown, vectors).is_none() {
            return Err(Error::BordersChange);
        }
        Ok(())
    }

    /// Speeds of the two parameters over their ranges.
    pub(super) fn parameter_speeds(&self, solution: &Solution<CycleLocusInspection>) -> [f64; 2] {
        let last = solution.tangent.len() - 2;
        [0, 1].map(|index| solution.tangent[last + index] / self.system.parameter_scales[index])
    }

    /// The equilibrium beside which a cycle is slowest, if it makes periods grow without bound.
    fn slow_passage(&self, unknown: &[f64]) -> Option<SlowPassage> {
        let (cycle, _) = split(unknown, self.states, self.kind());
        let problem = &self.base.problem;
        let (states, scalars) = cycle.split_at(cycle.len() - 3);
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = scalars[1];
        parameters[self.second] = scalars[2];
        let passing = Passing {
            field: problem.field,
            parameters: &parameters,
            active: (problem.active, self.system.parameter_scales[0]),
            states,
            scales: &problem.scales,
        };
        passing.slow_passage()
    }

    /// Whether the curve turns back between two solutions.
    fn turns_back(
        &self,
        before: &Solution<CycleLocusInspection>,
        after: &Solution<CycleLocusInspection>,
    ) -> bool {
        let [one, other] = [before, after].map(|solution| self.parameter_speeds(solution));
        one[0] * other[0] + one[1] * other[1] < 0.0
    }

    /// The place of the angle of a torus bifurcation among the unknowns, counted from their end.
    pub(super) fn angle_from_end(&self) -> usize {
        self.system.collocation.problem.scalars() - 1
    }

    /// The angle of a torus bifurcation as the curve counts it: past 0 and pi it goes on.
    pub(super) fn angle(&self, solution: &Solution<CycleLocusInspection>) -> Option<f64> {
        let place = solution.unknown.len() - self.angle_from_end();
        (self.kind() == Kind::Torus).then(|| solution.unknown[place])
    }

    /// Parameter value at which the two halves of doubled cycles become equal between two solutions; behind it a curve goes on
    /// to the same cycles, the halves exchanged.
    fn halves_become_equal(
        &self,
        before: &Solution<CycleLocusInspection>,
        after: &Solution<CycleLocusInspection>,
    ) -> Option<f64> {
        let n = self.states;
        let half_difference = |solution: &Solution<CycleLocusInspection>| -> (Vec<f64>, f64) {
            let (mut cycle, _) = split(&solution.unknown, n, self.kind());
            let parameter = cycle[cycle.len() - 2];
            cycle.pop();
            let (mut one, mut other) = (vec![0.0; n], vec![0.0; n]);
            let mut differences = Vec::with_capacity(n * HALF_SAMPLES);
            for sample in 0..HALF_SAMPLES {
                let time = 0.5 * sample as f64 / HALF_SAMPLES as f64;
                self.base.evaluate(&cycle, time, &mut one);
                self.base.evaluate(&cycle, time + 0.5, &mut other);
                let scaled = one.iter().zip(&other).zip(&self.base.problem.scales);
                differences.extend(scaled.map(|((a, b), scale)| (a - b) / scale));
            }
            (differences, parameter)
        };
        let ((one, a), (other, b)) = (half_difference(before), half_difference(after));
        let product =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / HALF_SAMPLES as f64;
        let (first, second) = (product(&one, &one), product(&other, &other));
        let rounding = self.resolution.tolerance.powi(2);
        let exchanged = product(&one, &other) < 0.0 && first > rounding && second > rounding;
        exchanged.then(|| vanishing_point((a, first), (b, second)))
    }
}

/// The sizes that the nonlinearity of the field gives to those states of a cycle, given on its nodes, that rest; zero for the
/// others.
pub(super) fn sizes_of_resting(sizes: &StateSizes, states: &[f64]) -> Vec<f64> {
    let natural: Vec<f64> = sizes.natural().collect();
    let amplitude = |component: usize| {
        let values = states.iter().skip(component).step_by(natural.len());
        let (low, high) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(*value), b.max(*value)));
        0.5 * (high - low)
    };
    let size = |(component, natural): (usize, &f64)| {
        if amplitude(component) < RESTING * natural { *natural } else { 0.0 }
    };
    natural.iter().enumerate().map(size).collect()
}

pub(super) fn test_value(solution: &Solution<CycleLocusInspection>, kind: SpecialKind) -> Option<f64> {
    solution.point.tests.iter().find(|(candidate, _)| *candidate == kind).map(|(_, value)| *value)
}

impl Equations for CycleLocusCurve<'_> {
    fn unknowns(&self) -> usize {
        self.system.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.system.residual(unknown, residual);
        if let Some(hold) = &self.hold {
            hold.add_residual(&self.system, unknown, residual);
        }
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        match &mut self.hold {
            None => self.system.factorize(unknown, border, residual),
            Some(hold) => hold.factorize(&mut self.system, unknown, border, residual),
        }
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        match &self.hold {
            None => self.system.solve(right_hand_side),
            Some(hold) => hold.solve(&mut self.system, right_hand_side),
        }
    }
}

impl Curve for CycleLocusCurve<'_> {
    type Point = CycleLocusInspection;
    type Kind = SpecialKind;
    type Reason = CycleLocusEnd;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        let (cycle, eigenfunctions) = split(unknown, self.states, self.kind());
        let period = cycle[cycle.len() - 3];
        if period <= 0.0 || self.sizes.is_equilibrium(&cycle[..cycle.len() - 3]) {
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        let rescaled = self.rescale(&cycle);
        self.fit_segments(unknown, vectors)?;
        let scales = self.error_scales(&eigenfunctions);
        let errors = error_profile(&self.system.collocation, unknown, &scales);
        let (adaptation, worst) =
            fit_mesh(&mut self.system.collocation, &errors, &self.resolution, unknown, vectors)?;
        self.error_estimate = worst;
        Ok(if rescaled { Adaptation::Renormalised } else { adaptation })
    }

    fn carry_over(&self, point: &mut CycleLocusInspection) {
        point.mesh = self.system.collocation.mesh().to_vec();
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        _tangent: &[f64],
        _orientation: f64,
    ) -> Result<CycleLocusInspection, Error> {
        let kind = self.kind();
        self.base.problem.segments.clone_from(&self.system.collocation.problem.segments);
        let (cycle, eigenfunctions) = split(unknown, self.states, kind);
        let end = cycle.len() - 3;
        self.base.problem.parameters[self.second] = cycle[end + 2];
        let base = &cycle[..end + 2];
        self.base.set_mesh(self.system.collocation.mesh().to_vec(), base);
        let mut border = vec![0.0; base.len()];
        border[end + 1] = 1.0;
        let mut residual = vec![0.0; base.len()];
        self.base.factorize(base, &border, &mut residual);
        let floquet = floquet(&self.base, base, &self.base.problem.scales, &mut self.schur)?;
        let (mut coefficient, natural_coefficient) = self.coefficient(&cycle, &eigenfunctions);
        if let (Kind::Fold, Some(value)) = (kind, &mut coefficient) {
            *value *= *self.sign.get_or_insert(value.signum());
        }
        // Where the multipliers have met and gone on, the angle of the other one is below pi.
        let angle = eigenfunctions.1.first().map_or(0.0, |angle| angle.rem_euclid(TAU));
        let angle = angle.min(TAU - angle);
        let multipliers: Vec<Complex64> =
            floquet.nontrivial.iter().map(|multiplier| multiplier.to_complex()).collect();
        if !monitor::is_critical(kind, &multipliers, floquet.trivial_error) {
            let cause = CorrectionFailure::Diverged;
            return Err(Error::NotFound { sought: "cycle with the multiplier of the curve", cause });
        }
        Ok(CycleLocusInspection {
            error_estimate: self.error_estimate,
            extremes: extremes(&self.base, base, self.states),
            mesh: self.base.mesh().to_vec(),
            tests: monitor::tests(kind, &multipliers, coefficient, angle),
            coefficient,
            natural_coefficient,
            argument: (kind == Kind::Torus).then_some(angle),
            location_error: None,
            floquet,
        })
    }

    fn measure(&mut self, solution: &mut Solution<CycleLocusInspection>) {
        solution.point.error_estimate = self.error(&solution.unknown);
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(monitor::test_functions(self.kind()))
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<CycleLocusInspection>) -> Option<Reading> {
        let value = test_value(solution, kind)?;
        if !monitor::is_coefficient(kind) {
            return Some(Reading::exact(value));
        }
        // Next to poles it does not run away. One that is zero all along, by symmetry for instance, changes its sign at random.
        let saturated = value / (solution.point.natural_coefficient + value.abs());
        Some(Reading::exact(saturated).with_noise(self.resolution.tolerance))
    }

    /// The tests for resonances are made of the angle, which is an unknown.
    fn test_rate(&self, kind: SpecialKind, solution: &Solution<CycleLocusInspection>) -> Option<f64> {
        if !matches!(kind, SpecialKind::Resonance3 | SpecialKind::Resonance4) {
            return None;
        }
        let place = solution.tangent.len() - self.angle_from_end();
        let is_folded = self.angle(solution)?.rem_euclid(TAU) > PI;
        Some(if is_folded { -solution.tangent[place] } else { solution.tangent[place] })
    }

    fn spectrum(&self, solution: &Solution<CycleLocusInspection>) -> Spectrum {
        let point = &solution.point;
        monitor::growth(self.kind(), &point.floquet, point.argument.unwrap_or(0.0))
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        [before, after]: [&Solution<CycleLocusInspection>; 2],
    ) -> Result<Location<CycleLocusInspection>, Error> {
        self.point_of_codimension_two(kind, [before, after])
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let (cycle, _) = split(unknown, self.states, self.kind());
        let end = cycle.len() - 3;
        let mut signature = vec![(cycle[end].ln(), 1.0)];
        signature.extend(self.sizes.signature(&extremes(&self.base, &cycle[..end + 2], self.states)));
        signature
    }

    fn ending(
        &mut self,
        before: &Solution<CycleLocusInspection>,
        after: &Solution<CycleLocusInspection>,
    ) -> Option<Ending<CycleLocusEnd>> {
        let end = after.unknown.len() - self.system.collocation.problem.scalars();
        let period = after.unknown[end];
        let last = after.tangent.len() - 2;
        let [one, other] =
            [0, 1].map(|index| after.tangent[last + index] / self.system.parameter_scales[index]);
        let sensitivity = (after.tangent[end] / period).abs() / one.hypot(other);
        if self.sizes.period_is_unbounded(period, sensitivity, self.resolution.tolerance)
            && let Some(beside) = self.slow_passage(&after.unknown)
        {
            let parameter = after.unknown[last];
            return Some(Ending::After(Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::PeriodUnbounded {
                period,
                parameter,
                beside,
            }))));
        }
        // Next to the end both parameters depend on the amplitude through its square.
        let [(here, a), (there, b)] = [before, after].map(|solution| {
            let (mut cycle, _) = split(&solution.unknown, self.states, self.kind());
            let parameter = cycle[cycle.len() - 2];
            cycle.truncate(cycle.len() - 3);
            (cycle, parameter)
        });
        if let Some(parameter) = self.sizes.amplitude_passes_zero((&here, a), (&there, b)) {
            let frequency = 2.0 * PI / period;
            return Some(Ending::Between(Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::HopfPoint {
                parameter,
                frequency,
                located: false,
            }))));
        }
        if let Some(parameter) = self.halves_become_equal(before, after) {
            return Some(Ending::Between(Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::PeriodDoubling {
                parameter,
                period: 0.5 * period,
            }))));
        }
        let (from, to) = (self.angle(before)?, self.angle(after)?);
        // Folds with the angle 0 and period doublings with the angle pi solve the defining system as well and cross its curve
        // at the resonances, where the continuation may turn onto theirs.
        let nearest = (to / PI).round();
        let order = |multiple: f64| if multiple.rem_euclid(2.0) == 0.0 { 1 } else { 2 };
        if (to - nearest * PI).abs() < AT_RESONANCE {
            return Some(Ending::Approached(Stop::Problem(CycleLocusEnd::StrongResonance {
                order: order(nearest),
            })));
        }
        let multiple = (from.max(to) / PI).floor();
        let crosses = from.min(to) < multiple * PI;
        // Cycles that a symmetry maps onto themselves half a period later have the squares of other multipliers: theirs go
        // through -1 together, and the curve goes on. At a resonance it comes back on itself.
        if crosses
            && self
                .comes_back([before, after], multiple * PI)
                .unwrap_or_else(|| self.turns_back(before, after))
        {
            return Some(Ending::Approached(Stop::Problem(CycleLocusEnd::StrongResonance {
                order: order(multiple),
            })));
        }
        None
    }
}
