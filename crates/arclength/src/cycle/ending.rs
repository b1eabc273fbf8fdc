//! The points in which branches of cycles end, solved for: Hopf points and period doublings.

use super::asked::Asked;
use super::branch::{CycleBranch, CyclePoint};
use super::end::CycleEnd;
use super::locating::doubling_near;
use crate::algebraic::scales::natural_scales;
use crate::continuation::Stop;
use crate::equilibrium::HopfPoint;
use crate::equilibrium::locating::hopf_point_near;
use std::f64::consts::PI;

/// Part of the parameter's range, and of the states, within which a Hopf point may be the end that the last cycle points to.
const NEAR_END: f64 = 0.05;
/// Part of its natural size within which a state that rests on all cycles may be found there.
const RESTING: f64 = 1e-6;
/// The logarithm of its frequency differs from that of the last cycle by less than this.
const SAME_FREQUENCY: f64 = 0.5;

impl Asked<'_> {
    /// Replaces extrapolated ends of a branch, at Hopf points and period doublings, by the points themselves where Newton's
    /// method finds them.
    pub(super) fn refine_ends(&self, branch: &mut CycleBranch) {
        let last = branch.points.len().saturating_sub(1);
        for (index, stop) in [0, last].into_iter().zip(&mut branch.stops) {
            let (Some(Stop::Problem(end)), Some(point)) = (stop, branch.points.get(index)) else { continue };
            match end {
                CycleEnd::HopfPoint { parameter, frequency, located } => {
                    let mean: Vec<f64> =
                        point.max.iter().zip(&point.min).map(|(max, min)| 0.5 * (max + min)).collect();
                    let mut parameters = self.parameters.clone();
                    parameters[self.active] = *parameter;
                    let found = hopf_point_near(self.field, &mean, &parameters, self.active, *frequency);
                    if let Some(found) = found.filter(|found| self.may_end_at(found, point, *parameter)) {
                        (*parameter, *frequency, *located) = (found.value, found.frequency, true);
                    }
                }
                CycleEnd::PeriodDoubling { parameter, period } => {
                    let width = self.bound.width();
                    let problem = self.problem();
                    let found = doubling_near(&problem, &point.orbit, *parameter, width, &self.settings);
                    if let Some((value, exact)) = found
                        && (value - *parameter).abs() <= (point.value - *parameter).abs()
                    {
                        (*parameter, *period) = (value, exact);
                    }
                }
                CycleEnd::PeriodUnbounded { .. }
                | CycleEnd::AmplitudeUnbounded { .. }
                | CycleEnd::PeriodVanishes { .. }
                | CycleEnd::NearZero { .. }
                | CycleEnd::Grazing { .. } => {}
            }
        }
    }

    /// Whether the branch whose last cycle is `last`, and which seems to end at the parameter value `estimate`, may end at this
    /// Hopf point.
    fn may_end_at(&self, hopf: &HopfPoint, last: &CyclePoint, estimate: f64) -> bool {
        let width = self.bound.width();
        let distance = (last.value - estimate).abs().max(NEAR_END * width);
        // A state that stays zero is so to rounding only.
        let natural =
            natural_scales(&self.field, &hopf.state, &hopf.parameters, &vec![0.0; hopf.state.len()]);
        let ranges = last.max.iter().zip(&last.min).zip(natural);
        let inside = hopf.state.iter().zip(ranges).all(|(value, ((max, min), natural))| {
            let margin = (max - min) + NEAR_END * max.abs().max(min.abs()) + RESTING * natural;
            (min - margin..=max + margin).contains(value)
        });
        let frequencies = (hopf.frequency * last.period / (2.0 * PI)).ln().abs();
        (hopf.value - estimate).abs() <= distance && inside && frequencies < SAME_FREQUENCY
    }
}
