//! Where a cycle comes to rest at the end of one of its parts: an equilibrium of the field of that part reaches the condition of the
//! event, or the border, at which the part ends, and the time that it takes grows without bound, as that of a neuron that fires ever
//! more rarely. Where the cycle only grazes, some state still moves.

use super::curve::CycleCurve;
use super::gate::GateFunction;
use super::slow_passage::SlowPassage;

/// Way in a whole period at the speed at the gate, in sizes of the states, below which all of them stand still.
const STANDSTILL: f64 = 1e-4;

impl CycleCurve<'_> {
    /// The gate at which all states stand still.
    pub(super) fn standstill(&self, unknown: &[f64]) -> Option<SlowPassage> {
        let problem = &self.collocation.problem;
        let segments = problem.segments.as_ref()?;
        let [period, parameter] = [unknown[unknown.len() - 2], unknown[unknown.len() - 1]];
        let mesh = self.collocation.mesh();
        segments.gates().find_map(|(time, function, course)| {
            let interval = mesh.partition_point(|point| *point < time).checked_sub(1)?;
            let state = self.collocation.end_of(unknown, interval);
            let mut velocity = vec![0.0; state.len()];
            course.velocity(problem.field, &state, &[(problem.active, parameter)], &mut velocity);
            let ways =
                velocity.iter().zip(&problem.scales).map(|(speed, scale)| period * speed.abs() / scale);
            let event = match function {
                GateFunction::Condition { event } => Some(event + 1),
                GateFunction::Border { .. } | GateFunction::Pull { .. } => None,
            };
            ways.fold(0.0, f64::max).le(&STANDSTILL).then_some(SlowPassage::AtGate { state, event })
        })
    }
}
