//! Where a branch of cycles meets a grazing: an event whose condition the cycles only touch, or a border at which the field jumps.
//!
//! Short of it the cycles depend smoothly on the parameter, and their equations go on to have solutions beyond, on which the condition
//! is passed without the jump: these are none of the model. So the zero of the largest value of the condition is located between two
//! solutions, and the branch ends there. Cycles that jump at the event come to a grazing where they pass its condition ever more
//! slowly; there the equations end, and the parameter is that to which the last cycles lead.

use super::curve::{CycleCurve, CycleInspection};
use super::end::{CycleEnd, Grazed};
use super::gate::GateFunction;
use super::passages::{Along, Reach, Touch};
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::{Solution, locate};

/// Part of the step between two cycles to which a grazing is located.
const LOCATION: f64 = 1e-12;
/// Cycles from which the place of a grazing is told where the equations end.
const LAST_CYCLES: usize = 3;
/// How much faster than the next one each of them passes the event.
const FASTER: f64 = 2.0;
/// The last cycle is this close to a grazing that is located, as part of the parameter's range.
const CLOSE: f64 = 1e-5;

impl CycleCurve<'_> {
    /// An event whose condition a cycle passes without the jump.
    pub(super) fn touch(&self, unknown: &[f64]) -> Option<Touch> {
        let problem = &self.collocation.problem;
        problem.segments.as_ref()?;
        let value = *unknown.last()?;
        problem.segments_of(self.collocation.polynomials(unknown), value).ok()??.touched
    }

    /// The grazing between a cycle and one beyond it.
    pub(super) fn grazing(
        &mut self,
        before: &Solution<CycleInspection>,
        after: &Solution<CycleInspection>,
        touch: Touch,
    ) -> CycleEnd {
        let settings = self.settings;
        let found = locate(self, before, after, &settings, LOCATION, |curve, solution| {
            curve.reach(&solution.unknown, touch).map(|reach| reach.beyond)
        });
        let [period, parameter] = match &found {
            Ok(Some(solution)) => last_two(&solution.unknown),
            _ => last_two(&before.unknown),
        };
        let located = matches!(found, Ok(Some(_)));
        let turns = match &found {
            Ok(Some(solution)) => self.reach(&solution.unknown, touch).is_none_or(|reach| reach.turns),
            _ => true,
        };
        let of = match touch.function {
            GateFunction::Condition { event } if !turns => Grazed::Together(event + 1),
            GateFunction::Condition { event } => Grazed::Event(event + 1),
            GateFunction::Border { .. } | GateFunction::Pull { .. } => Grazed::Border,
        };
        CycleEnd::Grazing { of, parameter, period, located }
    }

    /// How far the condition of an event gets beyond zero, near where it is touched.
    fn reach(&self, unknown: &[f64], touch: Touch) -> Option<Reach> {
        let problem = &self.collocation.problem;
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = *unknown.last()?;
        let along = Along::new(problem.field, self.collocation.polynomials(unknown), &parameters)?;
        let course = problem.segments.as_ref()?.course_at(touch.time);
        Some(along.reach(touch, course, problem.jumps()))
    }

    /// The grazing to which the last cycles lead before the event that was lost happens no more.
    pub(super) fn grazing_ahead(&self, last: &[&Solution<CycleInspection>]) -> Option<CycleEnd> {
        let event = self.lost?;
        // The last ones lie close together: of those before every one counts at which the event was passed twice as fast.
        let mut known: Vec<[f64; 3]> = Vec::new();
        for solution in last.iter().rev() {
            let [period, parameter] = last_two(&solution.unknown);
            let Some(rate) = self.rate_at(solution, event).map(f64::abs) else { break };
            if known.last().is_none_or(|[slower, ..]| rate >= FASTER * slower) {
                known.push([rate, parameter, period]);
            }
            if known.len() == LAST_CYCLES {
                break;
            }
        }
        let slows = known.len() == LAST_CYCLES;
        let [_, last_parameter, last_period] = *known.first()?;
        let at_rest = |place: usize| {
            known.iter().enumerate().fold(0.0, |sum, (index, point)| {
                let others = known.iter().enumerate().filter(|(other, _)| *other != index);
                let weight: f64 = others.map(|(_, other)| -other[0] / (point[0] - other[0])).product();
                sum + weight * point[place]
            })
        };
        let [parameter, period] =
            if slows { [at_rest(1), at_rest(2)] } else { [last_parameter, last_period] };
        // What is left out of the extrapolation is of a higher order than what it adds.
        let located = slows && (parameter - last_parameter).abs() < CLOSE * self.parameter_scale;
        // An event that is passed at a speed to the last is not touched: it is lost because another one comes at its time.
        let of = if slows { Grazed::Event(event + 1) } else { Grazed::Together(event + 1) };
        Some(CycleEnd::Grazing { of, parameter, period, located })
    }

    /// The rate of the condition of an event where it happens on a cycle, the smallest if it does more than once.
    fn rate_at(&self, solution: &Solution<CycleInspection>, event: usize) -> Option<f64> {
        let degree = self.collocation.gauss().degree();
        let mut problem = self.collocation.problem.clone();
        problem.segments.clone_from(&solution.point.segments);
        let mesh = solution.point.mesh.clone();
        let collocation = crate::collocation::equations::Collocation::new(problem, mesh, degree);
        let [period, parameter] = last_two(&solution.unknown);
        let segments = collocation.problem.segments.as_ref()?;
        let rates = segments.jumps_of(event).filter_map(|index| {
            let point = collocation.mesh().partition_point(|point| *point < segments.times[index]);
            let before = collocation.end_of(&solution.unknown, point - 1);
            let active = [(collocation.problem.active, parameter)];
            segments.delay(collocation.problem.field, index, &before, period, &active)
        });
        rates.map(|(_, rate)| rate).min_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}

/// Period and parameter of a cycle.
fn last_two(unknown: &[f64]) -> [f64; 2] {
    [unknown[unknown.len() - 2], unknown[unknown.len() - 1]]
}
