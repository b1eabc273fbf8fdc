//! A queue of initial states worked off by the lanes of one thread.

use super::quadratic::QuadraticWheel;
use super::taylor::{Series, TaylorMethod, lanes, lanes_mut};
use super::trajectory::{Ending, Monitor, Outcome, Progress};
use arclength::control::{Control, Interrupted};
use pulp::{Simd, WithSimd};
use std::ops::ControlFlow;

/// The lanes of the widest registers.
const WIDEST: usize = 8;

/// Trajectories to follow and where their ends go.
pub(super) struct Queue<'a, F> {
    pub wheel: &'a QuadraticWheel,
    pub tolerance: f64,
    pub maximum_steps: u32,
    pub initial: &'a [[f64; 5]],
    /// Index of the first trajectory.
    pub first: usize,
    pub duration: f64,
    pub monitor: &'a F,
    pub control: &'a Control<'a>,
    pub outcomes: &'a mut [Outcome],
}

/// What is known of the trajectory in a lane besides its state.
struct Lane<M> {
    trajectory: usize,
    time: f64,
    steps: u32,
    monitor: M,
}

impl<M: Monitor, F: Fn(usize) -> M> WithSimd for Queue<'_, F> {
    type Output = Result<(), Interrupted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { wheel, tolerance, maximum_steps, initial, first, duration, monitor, control, outcomes } =
            self;
        let method = TaylorMethod::new(simd, wheel, tolerance);
        let mut series = Series::new(simd);
        let mut waiting = 0..initial.len();
        let mut slots: [Option<Lane<M>>; WIDEST] = [const { None }; WIDEST];
        let slots = &mut slots[..S::F64_LANES.min(WIDEST)];
        let mut steps = simd.splat_f64s(0.0);
        let mut running = 0;
        for (lane, slot) in slots.iter_mut().enumerate() {
            *slot = start(&mut waiting, initial, first, monitor, &mut series, lane);
            running += usize::from(slot.is_some());
        }
        while running > 0 {
            control.check()?;
            method.expand(&mut series);
            method.propose_steps(&series, &mut steps);
            for (step, slot) in lanes_mut(&mut steps).iter_mut().zip(slots.iter()) {
                *step = match slot {
                    Some(lane) => step.min(duration - lane.time),
                    None => 0.0,
                };
            }
            method.advance(&mut series, steps);
            for (index, (slot, &step)) in slots.iter_mut().zip(lanes(&steps)).enumerate() {
                let Some(lane) = slot else { continue };
                lane.steps += 1;
                let is_last = step >= duration - lane.time;
                lane.time = if is_last { duration } else { lane.time + step };
                let state = series.state(index);
                let progress =
                    Progress { trajectory: first + lane.trajectory, time: lane.time, state: &state };
                let ending = if !state.iter().sum::<f64>().is_finite() || !(step > 0.0 || is_last) {
                    Some(Ending::NotFinite)
                } else if lane.monitor.observe(progress) == ControlFlow::Break(()) {
                    Some(Ending::Stopped)
                } else if is_last {
                    Some(Ending::Completed)
                } else if lane.steps >= maximum_steps {
                    Some(Ending::TooManySteps)
                } else {
                    None
                };
                if let Some(ending) = ending {
                    outcomes[lane.trajectory] = Outcome {
                        time: lane.time,
                        state: QuadraticWheel::rolling_state(state),
                        steps: lane.steps,
                        ending,
                    };
                    *slot = start(&mut waiting, initial, first, monitor, &mut series, index);
                    running -= usize::from(slot.is_none());
                }
            }
        }
        Ok(())
    }
}

/// Puts the next waiting trajectory into a lane; an idle lane rests in a harmless state.
#[inline(always)]
fn start<S: Simd, M>(
    waiting: &mut std::ops::Range<usize>,
    initial: &[[f64; 5]],
    first: usize,
    monitor: &impl Fn(usize) -> M,
    series: &mut Series<S>,
    lane: usize,
) -> Option<Lane<M>> {
    let next = waiting.next();
    let state = next.map_or([0.0, 0.0, 0.0, 1.0, 0.0], |trajectory| initial[trajectory]);
    series.set_state(lane, &QuadraticWheel::state(state));
    next.map(|trajectory| Lane { trajectory, time: 0.0, steps: 0, monitor: monitor(first + trajectory) })
}
