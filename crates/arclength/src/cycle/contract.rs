//! What continuation asks of a curve of cycles: residuals, meshes, test functions, where special points lie, where the curve ends.

use super::curve::{Birth, CycleCurve, CycleInspection, STANDING};
use super::end::CycleEnd;
use super::extrema::{Extremes, extremes, ways_between_jumps};
use super::floquet::DEFECT;
use super::limit_cycle::LimitCycle;
use super::sizes::LEAST_SENSITIVITY;
use super::special;
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::collocation::global_error::NOTHING_KNOWN;
use crate::collocation::mesh::{error_profile, fit_mesh};
use crate::collocation::problem::BoundaryValueEquations;
use crate::collocation::resolution::Resolution;
use crate::continuation::events::{Event, Location, Reading, Spectrum, TestFunction};
use crate::continuation::{Adaptation, Curve, Discretised, Ending, Solution, Stop};
use crate::error::{CorrectionFailure, Error};
use std::borrow::Cow;

/// Part of its largest value below which double precision does not resolve how near to zero a state comes.
const UNRESOLVED_PART: f64 = 1e-11;
/// The mesh is made finer than the tolerance asks for where the trivial multiplier is wrong by more than this part of the root
/// of the tolerance: next to a canard errors of the cycle are multiplied by large multipliers.
const MULTIPLIER_PART: f64 = 0.1;
/// Factors of the tolerance for that reason: the smallest of all, the strongest and the weakest at a time. Rounding sets an end
/// to it, too.
const FINEST: f64 = 1e-4;
const FINEST_TOLERANCE: f64 = 1e-10;
const REFINEMENT: (f64, f64) = (0.1, 0.5);
/// Where the linearised equations multiply errors, cycles need it finer than multipliers do.
const FINEST_TOLERANCE_OF_CYCLES: f64 = 1e-12;
/// Ratio of the error of a cycle to the local estimate above which the linearised equations multiply it.
const MULTIPLIED: f64 = 2.0;
/// Logarithm of a multiplier next to one.
const NEARLY_SINGULAR: f64 = 0.1;
/// Where the error is less than this part of what is allowed, the factor of the tolerance grows by `RELAXATION` from point to
/// point.
const MUCH_LESS: f64 = 0.01;
const RELAXATION: f64 = 1.5;
/// On the branch that turns at a pitchfork the parameter turns too, and a multiplier touches one. Two real multipliers with the
/// product one change the test of torus bifurcations as well.
const TEST_FUNCTIONS: &[TestFunction<SpecialKind>] = &[
    TestFunction::new(SpecialKind::BranchPointOfCycles)
        .changing(&[0, 1])
        .absorbing(&[SpecialKind::FoldOfCycles])
        .of_spectrum()
        .orienting(),
    TestFunction::new(SpecialKind::FoldOfCycles).changing(&[1]).turning(),
    TestFunction::new(SpecialKind::PeriodDoubling).changing(&[1]).of_spectrum(),
    TestFunction::new(SpecialKind::Torus).changing(&[0, 2]).of_spectrum(),
];
/// Rate of change of the parameter, as part of its range, that may be rounding, and one below which a cycle may be a fold.
const PARAMETER_ROUNDING: f64 = 1e-13;
const NEARLY_FOLD: f64 = 1e-8;
/// Growth of the states over their natural sizes beyond which a curve on which the parameter stands still leads to infinity.
const UNBOUNDED_GROWTH: f64 = 1e6;
/// Difference of the arguments of two pairs of multipliers.
const DISTINCT: f64 = 1e-6;

impl<'f> Discretised for CycleCurve<'f> {
    type System = Collocation<LimitCycle<'f>>;

    fn system(&self) -> &Self::System {
        &self.collocation
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.collocation
    }
}

impl Curve for CycleCurve<'_> {
    type Point = CycleInspection;
    type Kind = SpecialKind;
    type Reason = CycleEnd;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        let end = vector.len() - 2;
        self.collocation.apply_metric(&self.collocation.problem.scales, vector, image);
        image[end] = vector[end] / (self.period_scale * self.period_scale);
        image[end + 1] = vector[end + 1] / (self.parameter_scale * self.parameter_scale);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        // Equilibria and cycles with the time reversed solve the equations too, and Newton's method may jump there.
        let end = unknown.len() - 2;
        if unknown[end] <= 0.0 || self.sizes.is_equilibrium(&unknown[..end]) {
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        let segments = self.fit_segments(unknown, vectors)?;
        if segments != Adaptation::Unchanged {
            // The next correction is that of the cycle in its segments; its mesh is fitted then.
            return Ok(segments);
        }
        self.rescale(unknown);
        let errors = error_profile(&self.collocation, unknown, &self.amplitudes);
        let finer = Resolution { tolerance: self.refinement * self.resolution.tolerance, ..self.resolution };
        let (adaptation, worst) = match fit_mesh(&mut self.collocation, &errors, &finer, unknown, vectors) {
            Err(Error::MeshLimit { .. }) if self.refinement < 1.0 => {
                fit_mesh(&mut self.collocation, &errors, &self.resolution, unknown, vectors)?
            }
            result => result?,
        };
        self.error_estimate = worst;
        Ok(adaptation)
    }

    fn why_not_finite(&self, unknown: &[f64]) -> CorrectionFailure {
        if self.passes_its_gates(unknown) {
            CorrectionFailure::NotFinite
        } else {
            CorrectionFailure::GateMissed
        }
    }

    fn holds(&self, unknown: &[f64]) -> bool {
        let end = unknown.len() - 2;
        unknown[end] > 0.0 && !self.sizes.is_equilibrium(&unknown[..end]) && self.comes_to_its_events(unknown)
    }

    fn carry_over(&self, point: &mut CycleInspection) {
        point.mesh = self.collocation.mesh().to_vec();
    }

    fn keeps_solutions(&self) -> bool {
        self.collocation.problem.segments.is_some()
    }

    fn take_back(&mut self, solution: &Solution<CycleInspection>) {
        let point = &solution.point;
        self.collocation.problem.segments.clone_from(&point.segments);
        self.collocation.set_mesh(point.mesh.clone(), &solution.unknown);
        self.rescale(&solution.unknown);
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        tangent: &[f64],
        orientation: f64,
    ) -> Result<CycleInspection, Error> {
        let (floquet, multiplier_errors) = self.multipliers(unknown)?;
        let n = self.collocation.problem.dimension();
        let turn_is_reversed = self.turn_is_reversed(tangent, orientation, &floquet);
        Ok(CycleInspection {
            turn_is_reversed,
            error_estimate: self.error_estimate,
            error_across: self.error_estimate,
            is_neutral: self.is_neutral(tangent, &floquet),
            parameter_error: None,
            floquet,
            multiplier_errors,
            extremes: extremes(&self.collocation, unknown, n),
            mesh: self.collocation.mesh().to_vec(),
            segments: self.collocation.problem.segments.clone(),
            fitted: None,
            place: None,
            normal_form: Vec::new(),
            branching: None,
        })
    }

    fn measure(&mut self, solution: &mut Solution<CycleInspection>) {
        let mut errors = self.errors(&solution.unknown, &solution.tangent);
        let point = &mut solution.point;
        point.error_across = errors[1];
        match self.fitted(&solution.unknown, &solution.tangent) {
            Ok(Some(refitted)) => {
                (point.fitted, point.extremes) = (Some(refitted.fitted), refitted.extremes);
                errors = refitted.errors;
            }
            Ok(None) => {}
            // Its polynomials go on beyond a border, nobody knows how far.
            Err(_) => errors = [NOTHING_KNOWN; 2],
        }
        if !self.crosses_where_it_may(&solution.unknown) {
            errors = [NOTHING_KNOWN; 2];
        }
        let [fixed, across] = errors;
        point.error_estimate = if point.is_neutral { across } else { fixed };
    }

    fn resolves(&mut self, point: &CycleInspection) -> bool {
        let floquet = &point.floquet;
        let tolerance = self.resolution.tolerance;
        let allowed = MULTIPLIER_PART * tolerance.sqrt();
        let multipliers = if floquet.is_contradictory() {
            f64::INFINITY
        } else {
            (floquet.trivial_error / allowed).max(floquet.defect() / DEFECT)
        };
        // Where the local estimate is the larger one it has placed the mesh points already.
        // Next to a branch point, where a multiplier is one, no mesh helps, and one that changes breaks a symmetry.
        let is_singular = floquet
            .nontrivial
            .iter()
            .any(|multiplier| multiplier.argument == 0.0 && multiplier.log_modulus.abs() < NEARLY_SINGULAR);
        let is_multiplied = !is_singular && point.error_across > MULTIPLIED * self.error_estimate;
        let cycle = if is_multiplied { point.error_across / tolerance } else { 0.0 };
        let excess = multipliers.max(cycle);
        if excess <= 1.0 {
            if excess < MUCH_LESS {
                self.refinement = (RELAXATION * self.refinement).min(1.0);
            }
            return true;
        }
        let (strongest, weakest) = REFINEMENT;
        let reached = (self.error_estimate / tolerance).min(self.refinement);
        let finer = reached * (1.0 / excess).clamp(strongest, weakest);
        let finest_tolerance = if cycle > 1.0 { FINEST_TOLERANCE_OF_CYCLES } else { FINEST_TOLERANCE };
        let finest = FINEST.max(finest_tolerance / tolerance).min(1.0);
        self.refinement = finer.max(finest);
        finer < finest
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(TEST_FUNCTIONS)
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<CycleInspection>) -> Option<Reading> {
        let floquet = &solution.point.floquet;
        let reading = match kind {
            // The parameter stands still.
            SpecialKind::FoldOfCycles if self.follows_neutral_family => return None,
            // On the explosion of a canard the parameter may vary by its rounding only.
            SpecialKind::FoldOfCycles => {
                let turn = self.certain_turn(solution);
                return Some(Reading::exact(turn).with_noise(PARAMETER_ROUNDING));
            }
            // Where no multiplier is near one the sign of the determinant is rounding.
            SpecialKind::BranchPointOfCycles if !floquet.comes_near_one() => return None,
            SpecialKind::BranchPointOfCycles => Reading::exact(solution.orientation),
            SpecialKind::PeriodDoubling => Reading::exact(solution.point.doubling_test()),
            SpecialKind::Torus => {
                let test = floquet.torus_test();
                Reading::exact(test.product).in_class(test.undecided)
            }
            _ => return None,
        };
        Some(Reading { resolved: !floquet.is_contradictory(), ..reading })
    }

    fn spectrum(&self, solution: &Solution<CycleInspection>) -> Spectrum {
        let spectrum = solution.point.floquet.growth();
        // Which side of the circle a multiplier one is on is rounding.
        Spectrum { decided: spectrum.decided && !self.follows_neutral_family, ..spectrum }
    }

    fn undecided(&self, solution: &Solution<CycleInspection>) -> usize {
        if self.follows_neutral_family {
            return 0;
        }
        usize::from(!solution.point.floquet.unstable().is_certain)
            + usize::from(self.turn(&solution.tangent).abs() < NEARLY_FOLD)
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        between: [&Solution<CycleInspection>; 2],
    ) -> Result<Location<CycleInspection>, Error> {
        special::locate(self, kind, between)
    }

    fn locate_crossing(
        &mut self,
        between: [&Solution<CycleInspection>; 2],
        _near: Solution<CycleInspection>,
        change: usize,
        _half: f64,
    ) -> Result<Vec<Event<SpecialKind, CycleInspection>>, Error> {
        special::crossing(self, between, change)
    }

    fn are_same(&self, one: &CycleInspection, other: &CycleInspection) -> bool {
        let places = one.place.zip(other.place);
        places.is_some_and(|(one, other)| special::is_same_place(one, other, self.parameter_scale))
    }

    fn are_distinct(&self, one: &CycleInspection, other: &CycleInspection) -> bool {
        // Torus bifurcations of pairs with different arguments.
        let argument = |point: &CycleInspection| {
            point.normal_form.iter().find(|(name, _)| *name == "argument").map(|entry| entry.1)
        };
        matches!((argument(one), argument(other)), (Some(one), Some(other)) if (one - other).abs() > DISTINCT)
    }

    fn changes_at(&self, point: &CycleInspection) -> Option<&'static [usize]> {
        // A located torus bifurcation, whose complex pair is on the circle.
        point.normal_form.iter().any(|(name, _)| *name == "argument").then_some(&[2])
    }

    fn turns_at(&self, point: &CycleInspection) -> Option<bool> {
        let known = point.branching.as_ref()?.known.as_ref()?;
        Some(known.parameter == 0.0)
    }

    fn hindrance(&mut self, solution: &Solution<CycleInspection>) -> Option<CycleEnd> {
        let [period, parameter] = [solution.unknown[solution.unknown.len() - 2], *solution.unknown.last()?];
        if let Some(beside) = self.standstill(&solution.unknown) {
            return Some(CycleEnd::PeriodUnbounded { period, parameter, beside });
        }
        let states = self.collocation.problem.field.state_names();
        let unresolved = states.into_iter().enumerate().filter_map(|(index, state)| {
            let Extremes { smallest, largest } = solution.point.extremes[index];
            let size = smallest.abs().max(largest.abs());
            let unresolved = |[low, high]: &[f64; 2]| {
                // What an event sets to zero is not followed there, and what is rounding all the way means nothing.
                let is_followed = *high > UNRESOLVED_PART * size;
                is_followed && *low < UNRESOLVED_PART * *high
            };
            let mut ways = ways_between_jumps(&self.collocation, &solution.unknown, index);
            if ways.is_empty() {
                // One that passes zero is resolved as well as its size.
                ways.push([smallest.abs().min(largest.abs()), size]);
            }
            let way = ways.into_iter().filter(unresolved);
            way.min_by(|one, other| (one[0] / one[1]).total_cmp(&(other[0] / other[1])))
                .map(|way| (state, way))
        });
        let (state, [smallest, largest]) =
            unresolved.min_by(|(_, one), (_, other)| (one[0] / one[1]).total_cmp(&(other[0] / other[1])))?;
        Some(CycleEnd::NearZero { state, smallest, largest, parameter })
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let n = self.collocation.problem.dimension();
        let mut signature = vec![(unknown[unknown.len() - 2].ln(), 1.0)];
        signature.extend(self.sizes.signature(&extremes(&self.collocation, unknown, n)));
        signature
    }

    fn ending(
        &mut self,
        before: &Solution<CycleInspection>,
        after: &Solution<CycleInspection>,
    ) -> Option<Ending<CycleEnd>> {
        self.follows_neutral_family = before.point.is_neutral && after.point.is_neutral;
        // The place of a grazing in this step is known more closely than cycles beyond it are told from those before.
        let known = self.grazes.take().filter(|(_, from)| *from == before.unknown);
        if let Some((end, _)) = known.as_ref().filter(|(end, _)| lies_beyond(end, before, after)) {
            let end = end.clone();
            self.grazes = known;
            return Some(Ending::Approached(Stop::Problem(end)));
        }
        if let Some(touch) = self.touch(&after.unknown) {
            let grazes = known.map_or_else(|| self.grazing(before, after, touch), |(end, _)| end);
            self.grazes = Some((grazes.clone(), before.unknown.clone()));
            return Some(Ending::Approached(Stop::Problem(grazes)));
        }
        self.grazes = known;
        let end = after.unknown.len() - 2;
        let (period, parameter) = (after.unknown[end], after.unknown[end + 1]);
        if self.turn(&after.tangent).abs() < STANDING && self.sizes.growth() > UNBOUNDED_GROWTH {
            return Some(Ending::After(Stop::Problem(CycleEnd::AmplitudeUnbounded { period, parameter })));
        }
        let rate = after.tangent[end] / self.period_scale;
        let sensitivity = (rate / self.turn(&after.tangent)).abs();
        let tolerance = self.resolution.tolerance;
        let beside = if self.sizes.period_is_unbounded(period, sensitivity, tolerance) {
            self.slow_passage(&after.unknown).or_else(|| self.standstill(&after.unknown))
        } else if sensitivity > LEAST_SENSITIVITY {
            self.standstill(&after.unknown)
        } else {
            None
        };
        if let Some(beside) = beside {
            let end = CycleEnd::PeriodUnbounded { period, parameter, beside };
            return Some(Ending::After(Stop::Problem(end)));
        }
        if self.sizes.period_vanishes(period, sensitivity, tolerance) && self.lives_by_jumps(&after.unknown) {
            let state = after.point.extremes.iter();
            let state = state.map(|extremes| 0.5 * (extremes.smallest + extremes.largest)).collect();
            return Some(Ending::After(Stop::Problem(CycleEnd::PeriodVanishes { period, parameter, state })));
        }
        if self.birth == Birth::Doubled
            && let Some(parameter) = self.single_again(&before.unknown, &after.unknown)
        {
            return Some(Ending::Between(Stop::Problem(CycleEnd::PeriodDoubling {
                parameter,
                period: 0.5 * period,
            })));
        }
        let parameter_before = before.unknown[end + 1];
        let (here, there) = (&before.unknown[..end], &after.unknown[..end]);
        if let Some(parameter) =
            self.sizes.amplitude_passes_zero((here, parameter_before), (there, parameter))
        {
            let frequency = 2.0 * std::f64::consts::PI / period;
            return Some(Ending::Between(Stop::Problem(CycleEnd::HopfPoint {
                parameter,
                frequency,
                located: false,
            })));
        }
        // Cycles that are not known to be doubled ones may be so; then they pass what looks like a branch point.
        if self.birth != Birth::Doubled
            && before.orientation * after.orientation < 0.0
            && let Some(parameter) = self.single_again(&before.unknown, &after.unknown)
        {
            return Some(Ending::Between(Stop::Problem(CycleEnd::PeriodDoubling {
                parameter,
                period: 0.5 * period,
            })));
        }
        None
    }
}

/// Whether the parameter has passed a located end between two solutions.
fn lies_beyond(
    end: &CycleEnd,
    before: &Solution<CycleInspection>,
    after: &Solution<CycleInspection>,
) -> bool {
    let CycleEnd::Grazing { parameter, located: true, .. } = end else { return false };
    let [here, there] = [before, after].map(|solution| solution.unknown[solution.unknown.len() - 1]);
    (parameter - here) * (there - parameter) > 0.0
}
