//! Finding a periodic motion: let it settle, see that it repeats itself, refine it.

use super::error::ShimmyError;
use super::return_map::{PSI, ReturnMap, Start};
use super::variation::STATES;
use super::{MOTION_TOLERANCE, PeriodicSliding, middle_of_longest_passage};
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::sliding::model::{S1, SlipState};
use crate::sliding::{HybridState, Piece, SlidingWheel, as_slip_state};
use crate::wheel::Wheel;
use arclength::control::Control;
use std::f64::consts::{PI, TAU};

/// Tolerance while a motion settles: what is left is for Newton's method.
pub(super) const SETTLING_TOLERANCE: f64 = 1e-9;
/// What settling is of the whole time, roughly.
const PART_OF_SETTLING: f64 = 0.8;
/// Samples of a natural period of the springs while returns are looked for.
const SAMPLES_PER_NATURAL_PERIOD: f64 = 400.0;
/// A return this near, relative to the size of the motion, is tried.
const NEAR: f64 = 0.1;
/// The first return counts unless a later one is so many times nearer.
const MUCH_NEARER: f64 = 4.0;
/// Distance below which interpolation cannot tell returns apart.
const RESOLUTION: f64 = 5e-4;
/// A motion whose caster angle varies by less than this, in rad, has died out.
pub(super) const AT_REST: f64 = 1e-3;

/// How a periodic motion is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingMotionSearch {
    /// Time in s for which the motion is left to settle.
    pub settling_time: f64,
    /// Longest period in s.
    pub longest_period: f64,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
}

impl Default for SlidingMotionSearch {
    /// Thirty seconds to settle, a period of up to two seconds, a tolerance of [`MOTION_TOLERANCE`].
    fn default() -> Self {
        Self { settling_time: 30.0, longest_period: 2.0, tolerance: MOTION_TOLERANCE }
    }
}

impl SlidingMotionSearch {
    pub(super) fn check(&self) -> Result<(), SimulationError> {
        for (name, value) in [("settling_time", self.settling_time), ("longest_period", self.longest_period)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SimulationError::out_of_range(name, value, "positive and finite, in s"));
            }
        }
        Ok(())
    }
}

impl Wheel {
    /// The periodic motion with sliding phases on which the motion from a state `(u, q, psi, V, Omega)` without slip settles.
    ///
    /// Whole turns that the caster has made before are taken off, so that it swings about an angle between -pi and pi.
    ///
    /// # Errors
    /// [`ShimmyError`]: the motion dies out, does not repeat itself, cannot be followed, or was not waited for.
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, shimmy::SlidingMotionSearch};
    ///
    /// // A short caster shimmies by itself; the friction bounds the amplitude.
    /// let wheel = Wheel::default()
    ///     .with(Key::L, 0.03)?
    ///     .with(Key::V, 0.5)?
    ///     .with(Key::Curvature, 0.0)?
    ///     .with(Key::CU, 0.1)?
    ///     .with(Key::CQ, 0.1)?;
    /// let start = wheel.perturbed_uniform_motion(&[("psi", 0.2)])?;
    /// let search = SlidingMotionSearch { settling_time: 10.0, ..SlidingMotionSearch::default() };
    /// let motion = wheel.sliding_motion(&start, &search, &Control::none())?;
    /// assert_eq!(motion.stable, Some(true));
    /// assert!((motion.period - 0.1423).abs() < 1e-4 && (motion.psi_max - 0.645).abs() < 1e-3);
    /// # Ok::<(), kingpin::shimmy::ShimmyError>(())
    /// ```
    pub fn sliding_motion(
        &self,
        initial: &[f64; 5],
        search: &SlidingMotionSearch,
        control: &Control<'_>,
    ) -> Result<PeriodicSliding, ShimmyError> {
        search.check()?;
        let (settling, control) = (control.part(0.0..PART_OF_SETTLING), &control.quiet());
        let sliding = self.sliding()?.tolerance(SETTLING_TOLERANCE);
        let initial = sliding.rolling_state(initial);
        let settled = sliding.follow(initial, search.settling_time, &[], &settling, |_| true)?;
        let recurrence = self.recurrence(&sliding, settled, search, control)?;
        let Recurrence { start, scales, turns } = recurrence;
        let map = ReturnMap::new(self, &start, scales, turns, search.tolerance)?;
        let (passages, _) = map.follow(&start, &[], control)?;
        let start = map.start_after(&start, middle_of_longest_passage(&passages, start.period), control)?;
        let mut map = ReturnMap::new(self, &start, scales, turns, search.tolerance)?;
        let (mut start, mut image) = map.solve(&start, control)?;
        if let Some(parts) = map.repetitions(&start, control)? {
            // The return that was found is not the first.
            map.turns /= parts;
            map.expected = None;
            start.period /= f64::from(parts);
            map.period_scale = start.period;
            (start, image) = map.solve(&start, control)?;
        }
        let motion = PeriodicSliding::describe(&map, &start, &image, control)?;
        let range = motion.psi_max - motion.psi_min;
        if range < AT_REST {
            return Err(ShimmyError::DiesOut { window: search.longest_period, range });
        }
        if motion.stable == Some(false) {
            let settling_time = search.settling_time;
            return Err(ShimmyError::NotSettled { settling_time, period: motion.period });
        }
        Ok(motion)
    }

    /// The first near return to a settled state.
    fn recurrence(
        &self,
        sliding: &SlidingWheel,
        settled: HybridState,
        search: &SlidingMotionSearch,
        control: &Control<'_>,
    ) -> Result<Recurrence, ShimmyError> {
        let body = self.body();
        let natural_period = TAU * (body.rolling_mass / body.lateral_stiffness).sqrt();
        let window = 1.05 * search.longest_period;
        let count = (window / natural_period * SAMPLES_PER_NATURAL_PERIOD).ceil();
        let times: Vec<f64> = (0..=count as usize).map(|index| window * (index as f64 / count)).collect();
        let mut samples: Vec<(f64, HybridState)> = Vec::with_capacity(times.len());
        sliding.follow(settled, window, &times, control, |Piece { phase, solution, .. }| {
            samples.extend(solution.samples().map(|(time, state)| {
                (time, HybridState { contact: phase.contact, state: as_slip_state(state) })
            }));
            true
        })?;
        let states: Vec<SlipState> = samples.iter().map(|(_, sample)| sample.state).collect();
        let scales = sizes(self, &states);
        let (low, high) =
            samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, sample)| {
                (low.min(sample.state[PSI]), high.max(sample.state[PSI]))
            });
        if high - low < AT_REST {
            return Err(ShimmyError::DiesOut { window, range: high - low });
        }
        let rate = sliding.rate(&settled);
        // Without a spring about the king pin whole turns make no difference.
        let turned = self.get(Key::KPsi) == 0.0;
        let all_turns = if turned { TAU * (0.5 * (low + high) / TAU).round() } else { 0.0 };
        let whole_turns = |state: &SlipState| {
            if turned { ((state[PSI] - settled.state[PSI]) / TAU).round() } else { 0.0 }
        };
        let difference = |state: &SlipState| -> SlipState {
            let turns = whole_turns(state);
            std::array::from_fn(|i| {
                let turn = if i == PSI { TAU * turns } else { 0.0 };
                (state[i] - settled.state[i] - turn) / scales[i]
            })
        };
        let position = |state: &SlipState| -> f64 {
            difference(state).iter().zip(&rate).zip(&scales).map(|((x, rate), scale)| x * rate / scale).sum()
        };
        let mut returns: Vec<(f64, f64, i32)> = Vec::new();
        for pair in samples.windows(2) {
            let [(start, before), (end, after)] = pair else { continue };
            let (p, n) = (position(&before.state), position(&after.state));
            if !(p < 0.0 && n >= 0.0) || before.contact != settled.contact || after.contact != settled.contact
            {
                continue;
            }
            let fraction = p / (p - n);
            let state = interpolate(sliding, before, after, end - start, fraction);
            let distance = difference(&state).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let time = start + fraction * (end - start);
            if time <= search.longest_period {
                returns.push((time, distance, whole_turns(&state) as i32));
            }
        }
        let nearest = returns.iter().fold(f64::INFINITY, |least, entry| least.min(entry.1));
        let limit = NEAR.min((MUCH_NEARER * nearest).max(RESOLUTION));
        let found = returns.iter().find(|entry| entry.1 <= limit);
        let &(period, _, turns) = found.ok_or(ShimmyError::NotPeriodic {
            longest_period: search.longest_period,
            settling_time: search.settling_time,
            nearest,
        })?;
        let mut state = settled;
        // A caster that turns right round swings about no angle.
        let all_turns = if turns == 0 { all_turns } else { TAU * (settled.state[PSI] / TAU).round() };
        state.state[PSI] -= all_turns;
        Ok(Recurrence { start: Start { state, period }, scales, turns })
    }
}

/// An approximate periodic motion.
struct Recurrence {
    start: Start,
    scales: [f64; STATES],
    turns: i32,
}

/// The cubic between two samples in the same phase with the right rates.
fn interpolate(
    wheel: &SlidingWheel,
    before: &HybridState,
    after: &HybridState,
    step: f64,
    x: f64,
) -> SlipState {
    let (start, end) = (wheel.rate(before), wheel.rate(after));
    let rise = x * x * (3.0 - 2.0 * x);
    let (departure, arrival) = (x * (1.0 - x) * (1.0 - x) * step, x * x * (x - 1.0) * step);
    std::array::from_fn(|i| {
        let difference = after.state[i] - before.state[i];
        before.state[i] + rise * difference + departure * start[i] + arrival * end[i]
    })
}

/// Half the range of each state; the caster angle at most half a turn, the slip as the velocities.
pub(super) fn sizes(wheel: &Wheel, samples: &[SlipState]) -> [f64; STATES] {
    /// Size of a state that hardly varies, relative to its largest value and to the caster angle.
    const LEAST: f64 = 1e-3;
    let mut scales: [f64; STATES] = std::array::from_fn(|i| {
        let fold = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
        let values = samples.iter().map(|sample| sample[i]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        0.5 * (high - low)
    });
    scales[PSI] = scales[PSI].min(PI);
    let speed = scales[3].max(scales[4]).max(scales[S1]).max(LEAST * wheel.get(Key::V));
    for i in [3, 4, S1] {
        scales[i] = speed;
    }
    let displacement = scales[0].max(scales[1]);
    scales[0] = displacement;
    scales[1] = displacement;
    scales.map(|scale| scale.max(f64::MIN_POSITIVE))
}
