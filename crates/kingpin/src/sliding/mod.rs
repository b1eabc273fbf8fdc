//! The wheel that rolls or slides, with Coulomb friction.
//!
//! While it slides with the slip velocity `s = (V1 - W, V2)` the ground pulls with `T = -mu_d N s/|s|`; while it rolls, with
//! whatever the constraint demands, up to `mu_s N`. Unless it is set, `mu_d` is 0.8 or `mu_s`, whichever is less; a larger `mu_d` than
//! `mu_s` is refused. The motion is a sequence of [`Phase`]s whose ends are located as
//! events; friction is not smoothed.
//!
//! # How slip starts
//!
//! At zero slip the direction of the friction is undefined. Near zero slip
//!
//! ```text
//! s' = B (T - T*),      B = diag(1/(m_w + m_c) + R^2/J_wxi,  J/((m_w + m_c) J - m^2))
//! ```
//!
//! where `T*` is the force that would keep the slip velocity as it is: the rolling force of the contact. Written with
//! `s = |s| e`, the rate of `|s|` is finite while `e` turns at a rate proportional to `1/|s|`. So a motion can leave or reach
//! `s = 0` only along a *limit direction* (Antali and Stepan, SIAM J. Appl. Dyn. Syst. 17, 2018, 823-858) at which `e` does not turn:
//!
//! ```text
//! -B T* - mu_d N B e = lambda e,     so     e = -(lambda B^-1 + mu_d N)^-1 T*,     |e| = 1
//! ```
//!
//! with `lambda` the rate of `|s|`. The length of the right-hand side falls as `lambda` grows from 0, where it is `|T*|/(mu_d N)`: so
//! there is exactly one direction in which slip grows when `|T*| > mu_d N` and none otherwise, and nearby directions turn towards
//! it at the rate `(lambda + mu_d N e'.B e')/|s|`, `e'` across `e`. It opposes `T*` exactly only where `lambda = 0` (`mu_d = mu_s` at the onset) or where `B` is
//! isotropic; otherwise the more mobile direction, along the caster, is preferred. From `s = 0` the first instants follow this
//! slow manifold, `e` being a function of the rest of the state, until `|s|` reaches [`ONSET_SLIP`]; the error is
//! of second order in it. Where the force only grazes the static limit the slip may shrink again before: `lambda` is negative then, and
//! the slow manifold leads back to zero. Sliding ends when `|s|` falls to [`VANISHING_SLIP`] and is followed to zero along the straight line
//! of its limit direction. There the wheel rolls on if `|T*| <= mu_s N`; otherwise it slides on, out along the one
//! growing limit direction.

mod history;
pub(crate) mod model;
mod smoothed;
#[cfg(test)]
mod tests;

pub use history::SlidingHistory;
pub use smoothed::SmoothedSlidingWheel;

use crate::rolling::RollingWheel;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::Control;
use arclength::integration::{
    Crossing, Direction, Event, Integrator, Solution, Stepper, autonomous, from_fn,
};
use model::{Equations, S1, S2, SlipState, slip_squared};

/// Names of the states: as those of the rolling wheel, with `V1` and `V2` the velocity of the wheel centre along and across the
/// caster in m/s and `W` the speed of the rim in m/s.
pub const SLIDING_STATE_NAMES: [&str; 7] = ["u", "q", "psi", "V1", "V2", "Omega", "W"];

/// Slip speed in m/s below which slip that grows from zero is taken to be on its limit direction.
pub const ONSET_SLIP: f64 = 1e-6;

/// Slip speed in m/s below which shrinking slip is followed to zero along a straight line.
pub const VANISHING_SLIP: f64 = 1e-9;

/// Absolute tolerance of the slip velocity in m/s.
const SLIP_RESOLUTION: f64 = 1e-4 * VANISHING_SLIP;

/// Relative tolerance of the integration unless another is set.
pub const SLIDING_TOLERANCE: f64 = 1e-10;

/// Largest number of phases unless another is set.
const MAXIMUM_PHASES: usize = 100_000;

/// Whether the wheel rolls or slides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// No slip.
    Rolling,
    /// Slip, with the sliding friction against it.
    Sliding,
}

/// A stretch of time in which the wheel only rolls or only slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// What it does.
    pub contact: Contact,
    /// Start in s.
    pub start: f64,
    /// End in s.
    pub end: f64,
}

/// A wheel that may roll or slide.
///
/// ```
/// use arclength::control::Control;
/// use kingpin::{Key, Wheel, sliding::Contact};
///
/// let wheel = Wheel::default().with(Key::FAz, -20.0)?;
/// let start = wheel.perturbed_uniform_motion(&[("psi", 0.6)])?;
/// let history = wheel.sliding()?.simulate(&start, 1.0, 101, &Control::none())?;
/// assert_eq!(history.phases[0].contact, Contact::Rolling);
/// assert_eq!(history.phases[1].contact, Contact::Sliding);
/// # Ok::<(), kingpin::simulation::SimulationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlidingWheel {
    equations: Equations<f64>,
    rolling: RollingWheel,
    while_rolling: Integrator,
    while_sliding: Integrator,
    maximum_phases: usize,
}

/// A state with what the wheel does there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HybridState {
    pub(crate) contact: Contact,
    pub(crate) state: SlipState,
}

impl HybridState {
    /// The states [`SLIDING_STATE_NAMES`].
    pub(crate) fn public(&self) -> [f64; 7] {
        let [u, q, psi, forward, lateral, yaw, slip] = self.state;
        [u, q, psi, forward, lateral, yaw, forward - slip]
    }
}

impl Wheel {
    /// The wheel as one that may slide.
    ///
    /// # Errors
    /// `mu_d > mu_s`, a load that lifts the wheel, or `k_u = inf`.
    pub fn sliding(&self) -> Result<SlidingWheel, SimulationError> {
        Ok(SlidingWheel {
            equations: Equations::new(self)?,
            rolling: self.rolling(&[])?,
            while_rolling: rolling_integrator(SLIDING_TOLERANCE),
            while_sliding: sliding_integrator(SLIDING_TOLERANCE),
            maximum_phases: MAXIMUM_PHASES,
        })
    }
}

/// Tolerances while rolling.
fn rolling_integrator(tolerance: f64) -> Integrator {
    Integrator::with_tolerance(tolerance)
}

/// Tolerances while sliding: the direction of the slip must be known down to where the slip vanishes.
fn sliding_integrator(tolerance: f64) -> Integrator {
    let mut absolute = [0.01 * tolerance; 7];
    absolute[S1] = SLIP_RESOLUTION;
    absolute[S2] = SLIP_RESOLUTION;
    Integrator::default().relative_tolerance(tolerance).absolute_tolerances(&absolute)
}

impl SlidingWheel {
    /// Sets the relative tolerance of the integration.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.while_rolling = rolling_integrator(tolerance);
        self.while_sliding = sliding_integrator(tolerance);
        self
    }

    /// Follows the motion for `duration`, calling `visit` with each piece of it, whether it resumes the phase of
    /// the piece before, and its solution, whose states are [`SlipState`]s. `times` are sampled. Ends early when
    /// `visit` returns false.
    pub(crate) fn follow(
        &self,
        initial: HybridState,
        duration: f64,
        times: &[f64],
        control: &Control<'_>,
        mut visit: impl FnMut(Phase, bool, &Solution) -> bool,
    ) -> Result<HybridState, SimulationError> {
        let mut now = 0.0;
        let mut present = initial;
        let mut sampled = 0;
        if self.equations.static_limit == 0.0 {
            present.contact = Contact::Sliding;
        }
        for _ in 0..self.maximum_phases {
            let due = &times[sampled..];
            let rest = control.part(now / duration..1.0);
            let (contact, solution, next) = match present.contact {
                Contact::Rolling if !self.holds(&present.state) => {
                    let (solution, next) = self.start_slip(now, &present.state, duration, due, &rest)?;
                    (Contact::Sliding, solution, next)
                }
                Contact::Rolling => {
                    let (solution, next) = self.roll(now, &present.state, duration, due, &rest)?;
                    (Contact::Rolling, solution, next)
                }
                Contact::Sliding => {
                    let (solution, next) = self.slide(now, &present.state, duration, due, &rest)?;
                    (Contact::Sliding, solution, next)
                }
            };
            sampled += solution.times.len();
            let resumes = present.contact == Contact::Sliding && now > 0.0;
            let keep_on = visit(Phase { contact, start: now, end: solution.time }, resumes, &solution);
            now = solution.time;
            control.done(now / duration);
            present = next;
            if now >= duration || !keep_on {
                return Ok(present);
            }
        }
        Err(SimulationError::out_of_range("number of phases", self.maximum_phases as f64, "fewer phases"))
    }

    /// Derivative of the state.
    pub(crate) fn rate(&self, state: &HybridState) -> SlipState {
        let equations = &self.equations;
        let friction = match state.contact {
            Contact::Rolling => equations.holding_force(&state.state),
            Contact::Sliding => equations.sliding_force(&state.state),
        };
        let mut rate = [0.0; 7];
        equations.derivative(&state.state, friction, &mut rate);
        rate
    }

    /// A state without slip.
    pub(crate) fn rolling_state(&self, &[u, q, psi, speed, yaw]: &[f64; 5]) -> HybridState {
        HybridState { contact: Contact::Rolling, state: [u, q, psi, speed, 0.0, yaw, 0.0] }
    }

    /// The states [`SLIDING_STATE_NAMES`]: the wheel slides where they have slip.
    pub(crate) fn slipping_state(&self, &[u, q, psi, forward, lateral, yaw, rim]: &[f64; 7]) -> HybridState {
        let state = [u, q, psi, forward, lateral, yaw, forward - rim];
        let slips = state[S1] != 0.0 || state[S2] != 0.0;
        let contact = if slips { Contact::Sliding } else { Contact::Rolling };
        HybridState { contact, state }
    }

    /// The wheel.
    pub(crate) fn wheel(&self) -> &Wheel {
        self.rolling.wheel()
    }

    /// Whether the static friction holds the wheel at a state without slip.
    fn holds(&self, state: &[f64]) -> bool {
        // The two are the same expression, so that equal limits give equal answers to the last bit.
        self.equations.static_reserve(state) >= 0.0 || self.equations.sliding_reserve(state) >= 0.0
    }

    /// Rolls until the static friction is exhausted. The solution has the seven states.
    fn roll(
        &self,
        start: f64,
        state: &SlipState,
        end: f64,
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let widen = |x: &[f64]| [x[0], x[1], x[2], x[3], 0.0, x[4], 0.0];
        let initial = [state[0], state[1], state[2], state[3], state[5]];
        let mut events = [Event::new(|_, x| self.equations.static_reserve(&widen(x))).falling().terminal()];
        let times = &times[..times.partition_point(|&time| time <= end)];
        let mut solution = self.while_rolling.under(control).with_events(
            autonomous(&self.rolling, &[]),
            start,
            &initial,
            end,
            times,
            &mut events,
        )?;
        solution.states = solution.states.chunks_exact(5).flat_map(widen).collect();
        let state = widen(&solution.state);
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }

    /// Slides out of `s = 0` along the limit direction.
    fn start_slip(
        &self,
        start: f64,
        state: &SlipState,
        end: f64,
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let equations = &self.equations;
        let system = from_fn(7, |_, state: &[f64], derivative: &mut [f64]| {
            equations.derivative(state, equations.incipient_force(state), derivative);
        });
        let mut events = [
            Event::new(|_, x| slip_squared(x) - ONSET_SLIP * ONSET_SLIP).rising().terminal(),
            Event::new(|_, x| equations.slip_along_limit_direction(x)).falling().terminal(),
        ];
        let integrator = self.while_sliding.under(control);
        let mut solution = integrator.with_events(system, start, state, end, times, &mut events)?;
        let state = as_slip_state(&solution.state);
        if solution.ended_by != Some(1) {
            let slips = state[S1] != 0.0 || state[S2] != 0.0;
            let contact = if slips { Contact::Sliding } else { Contact::Rolling };
            return Ok((solution, HybridState { contact, state }));
        }
        let state = stuck(state);
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }

    /// Slides until the slip vanishes; the crossing is where its straight way to zero begins.
    fn slide(
        &self,
        start: f64,
        state: &SlipState,
        end: f64,
        times: &[f64],
        control: &Control<'_>,
    ) -> Result<(Solution, HybridState), SimulationError> {
        let equations = &self.equations;
        let system = from_fn(7, |_, state: &[f64], derivative: &mut [f64]| {
            equations.derivative(state, equations.sliding_force(state), derivative);
        });
        // Without friction there is nothing special about zero slip.
        let vanishing = if equations.static_limit == 0.0 { 0.0 } else { VANISHING_SLIP * VANISHING_SLIP };
        // The direction of vanishing slip turns ever faster, so the steps shrink with the slip and cannot jump over zero:
        // looking at the end of each step is enough.
        let mut stepper = Stepper::new(system, &self.while_sliding, start, state, end)?;
        let mut solution = Solution::default();
        let mut vanished = false;
        loop {
            let reached = stepper.time();
            for &time in times[solution.times.len()..].iter().take_while(|&&time| time <= reached) {
                let from = solution.states.len();
                solution.states.resize(from + state.len(), 0.0);
                stepper.prepare_dense_output();
                stepper.interpolate(time, &mut solution.states[from..]);
                solution.times.push(time);
            }
            if stepper.is_finished() || vanished {
                break;
            }
            control.check()?;
            stepper.advance()?;
            vanished = slip_squared(stepper.state()) < vanishing;
        }
        solution.time = stepper.time();
        solution.state = stepper.state().to_vec();
        let mut state = as_slip_state(&solution.state);
        if !vanished {
            return Ok((solution, HybridState { contact: Contact::Sliding, state }));
        }
        solution.crossings.push(Crossing {
            event: 0,
            time: solution.time,
            state: solution.state.clone(),
            direction: Direction::Falling,
        });
        // The rest of the way to zero slip is a straight line.
        let mut rate = [0.0; 7];
        equations.derivative(&state, equations.sliding_force(&state), &mut rate);
        let shrinking = -(state[S1] * rate[S1] + state[S2] * rate[S2]);
        let rest = if shrinking > 0.0 { slip_squared(&state) / shrinking } else { 0.0 };
        let rest = rest.min(end - solution.time);
        for (component, rate) in state.iter_mut().zip(rate) {
            *component += rest * rate;
        }
        let state = stuck(state);
        solution.time += rest;
        solution.state = state.to_vec();
        Ok((solution, HybridState { contact: Contact::Rolling, state }))
    }
}

/// The state with what is left of the slip removed.
fn stuck(mut state: SlipState) -> SlipState {
    state[S1] = 0.0;
    state[S2] = 0.0;
    state
}

pub(crate) fn as_slip_state(state: &[f64]) -> SlipState {
    std::array::from_fn(|i| state[i])
}
