//! Where a branch of cycles meets a grazing: an event whose condition the cycles only touch.
//!
//! Short of it the cycles depend smoothly on the parameter, and their equations go on to have solutions beyond, on which the condition
//! is passed without the jump: these are none of the model. So the zero of the largest value of the condition is located between two
//! solutions, and the branch ends there. Cycles that jump at the event come to a grazing where they pass its condition ever more
//! slowly; there the equations end, and the parameter is that to which the last cycles lead.

use super::curve::{CycleCurve, CycleInspection};
use super::end::CycleEnd;
use super::passages::{Along, Touch};
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::{Solution, locate};

/// Part of the step between two cycles to which a grazing is located.
const LOCATION: f64 = 1e-12;
/// Cycles from which the place of a grazing is told where the equations end.
const LAST_CYCLES: usize = 3;
/// The rate of the condition at its event is to have become smaller than this part of what it was at most on the last cycles.
const SLOW: f64 = 0.5;

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
            curve.reach(&solution.unknown, touch)
        });
        let [period, parameter] = match &found {
            Ok(Some(solution)) => last_two(&solution.unknown),
            _ => last_two(&before.unknown),
        };
        let located = matches!(found, Ok(Some(_)));
        CycleEnd::Grazing { event: touch.event + 1, parameter, period, located }
    }

    /// How far the condition of an event gets beyond zero, near where it is touched.
    fn reach(&self, unknown: &[f64], touch: Touch) -> Option<f64> {
        let problem = &self.collocation.problem;
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = *unknown.last()?;
        let along = Along::new(problem.field, self.collocation.polynomials(unknown), &parameters)?;
        Some(along.reach(touch, problem.jumps()))
    }

    /// The grazing to which the last cycles lead before the event that was lost happens no more.
    pub(super) fn grazing_ahead(&self, last: &[&Solution<CycleInspection>]) -> Option<CycleEnd> {
        let event = self.lost?;
        let known: Vec<[f64; 3]> = last
            .iter()
            .rev()
            .take(LAST_CYCLES)
            .filter_map(|solution| {
                let [period, parameter] = last_two(&solution.unknown);
                Some([self.rate_at(solution, event)?, parameter, period])
            })
            .collect();
        let fastest = known.iter().map(|[rate, ..]| rate.abs()).fold(0.0, f64::max);
        let slows = known.len() == LAST_CYCLES
            && known.windows(2).all(|pair| pair[0][0].abs() < pair[1][0].abs())
            && known[0][0].abs() < SLOW * fastest;
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
        Some(CycleEnd::Grazing { event: event + 1, parameter, period, located: false })
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
