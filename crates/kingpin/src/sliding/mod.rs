//! The wheel that rolls or slides, with Coulomb friction.
//!
//! While it slides with the slip velocity `s = (V1 - W, V2)` the ground pulls with `T = -mu_d N s/|s|`; while it rolls, with
//! whatever the constraint demands, up to `mu_s N`. Unless it is set, `mu_d` is 0.8 or `mu_s`, whichever is less; a larger `mu_d` than
//! `mu_s` is refused. The motion is a sequence of [`Phase`]s whose ends are located as
//! events; friction is not smoothed. With dry friction about the king pin (`M_f`) the caster swings or sticks besides, in the same way:
//! each mode of the one goes with each of the other.
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
//!
//! # Whether slip vanishes
//!
//! Slip that has become small does not always vanish. Its direction turns to a limit direction to which nearby ones turn, and only if
//! `lambda < 0` there it gets to zero. Where `|T*| < mu_d N` it always does. Where `mu_d N < |T*| < mu_s N` there is a growing direction, to
//! which slip turns that passes by zero, however near. Other slip still gets to zero, and the wheel rolls on, where a shrinking
//! direction attracts, `mu_d N e'.B e' > -lambda`: with `T*` across the caster where `B_1 > B_2 (1 + |T*|/(mu_d N))`, which is so for
//! most wheels, as they are far more mobile along the caster; were `B` isotropic, only on the line of `T*` itself, as a block that is
//! thrown straight up a slope stays there.

mod history;
pub(crate) mod model;
mod pieces;
mod regime;
mod smoothed;
mod steady;
#[cfg(test)]
mod swing_tests;
#[cfg(test)]
mod tests;

pub use history::SlidingHistory;
pub use regime::KingPin;
pub use smoothed::SmoothedSlidingWheel;

use crate::error::KingpinError;
use crate::motion_integrator::motion_integrator;
use crate::rolling::RollingWheel;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::integration::Integrator;
use model::{Equations, S1, S2, SlipState, slips};
pub(crate) use pieces::Piece;
pub(crate) use regime::{Mode, Regime};

/// Names of the states: as those of the rolling wheel, with `V1` and `V2` the velocity of the wheel centre along and across the
/// caster in m/s and `W` the speed of the rim in m/s.
pub const SLIDING_STATE_NAMES: [&str; 7] = ["u", "q", "psi", "V1", "V2", "Omega", "W"];

/// Slip speed in m/s below which slip that grows from zero is taken to be on its limit direction.
pub const ONSET_SLIP: f64 = 1e-6;

/// Slip speed in m/s below which shrinking slip is followed to zero along a straight line.
pub const VANISHING_SLIP: f64 = 1e-9;

/// Absolute tolerance of the slip velocity, relative to the slip speed at which it is taken to vanish.
const SLIP_RESOLUTION: f64 = 1e-4;

/// Caster angle in rad below which a wheel whose small motions die out with dry friction about the king pin is at rest: further swings
/// would be smaller and smaller, without end.
pub const RESTING_ANGLE: f64 = 1e-9;

/// Part of `M_f` by which rounding may exceed it at rest.
pub(crate) const RESTING_EXCESS: f64 = 1e-9;

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

/// A stretch of time in which the wheel only rolls or only slides, and the caster only swings or only sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// What the wheel does.
    pub contact: Contact,
    /// What the caster does; without dry friction about the king pin it swings.
    pub king_pin: KingPin,
    /// Start in s.
    pub start: f64,
    /// End in s.
    pub end: f64,
}

/// The phase at a time: where two meet, the later one.
pub(crate) fn phase_at(phases: &[Phase], time: f64) -> Option<&Phase> {
    let later = phases.partition_point(|phase| phase.start <= time);
    later.checked_sub(1).map(|index| &phases[index])
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
    wheel: Wheel,
    equations: Equations<f64>,
    rolling: RollingWheel,
    /// Whether the ground supplies whatever force rolling takes.
    rolls_always: bool,
    /// Whether small motions die out with dry friction about the king pin, in straight towing.
    comes_to_rest: bool,
    while_rolling: Integrator,
    while_sliding: Integrator,
    /// Slip speeds at which slip leaves its limit direction and at which it is taken straight to zero.
    onset_slip: f64,
    vanishing_slip: f64,
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
        Ok(self.follower(Equations::new(self)?, false)?)
    }

    /// The wheel as one that rolls whatever force that takes, with dry friction about its king pin.
    ///
    /// # Errors
    /// `k_u = inf`.
    pub(crate) fn always_rolling(&self) -> Result<SlidingWheel, SimulationError> {
        if self.has_lateral_elasticity_only() {
            self.check_without_dry_friction("a motion with k_u = inf", "set a finite k_u or M_f = 0")?;
        }
        Ok(self.follower(Equations::with(|key| self.get(key)), true)?)
    }

    fn follower(&self, equations: Equations<f64>, rolls_always: bool) -> Result<SlidingWheel, KingpinError> {
        Ok(SlidingWheel {
            wheel: *self,
            equations,
            rolling: self.rolling(&[])?,
            rolls_always,
            comes_to_rest: self.swing_factor().is_some_and(|factor| factor.abs() < 1.0),
            while_rolling: motion_integrator(SLIDING_TOLERANCE),
            while_sliding: sliding_integrator(SLIDING_TOLERANCE, VANISHING_SLIP),
            onset_slip: ONSET_SLIP,
            vanishing_slip: VANISHING_SLIP,
            maximum_phases: MAXIMUM_PHASES,
        })
    }
}

/// Tolerances while sliding: the direction of the slip must be known down to where the slip vanishes.
fn sliding_integrator(tolerance: f64, vanishing_slip: f64) -> Integrator {
    let mut absolute = [0.01 * tolerance; 7];
    absolute[S1] = SLIP_RESOLUTION * vanishing_slip;
    absolute[S2] = SLIP_RESOLUTION * vanishing_slip;
    motion_integrator(tolerance).absolute_tolerances(&absolute)
}

impl SlidingWheel {
    /// Sets the relative tolerance of the integration.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.while_rolling = motion_integrator(tolerance);
        self.while_sliding = sliding_integrator(tolerance, self.vanishing_slip);
        self
    }

    /// Sets the slip speed in m/s at which slip leaves its limit direction, and that at which it is taken straight to zero.
    pub(crate) fn slips(mut self, onset: f64, vanishing: f64) -> Self {
        self.onset_slip = onset;
        self.vanishing_slip = vanishing;
        self
    }

    /// The equations that hold in a mode.
    pub(crate) fn equations_in(&self, mode: Mode) -> Equations<f64> {
        self.equations.under(mode.friction_moment)
    }

    /// A state without slip.
    pub(crate) fn rolling_state(&self, &[u, q, psi, speed, yaw]: &[f64; 5]) -> HybridState {
        HybridState { contact: Contact::Rolling, state: [u, q, psi, speed, 0.0, yaw, 0.0] }
    }

    /// The states [`SLIDING_STATE_NAMES`]: the wheel slides where they have slip.
    pub(crate) fn slipping_state(&self, &[u, q, psi, forward, lateral, yaw, rim]: &[f64; 7]) -> HybridState {
        let state = [u, q, psi, forward, lateral, yaw, forward - rim];
        let contact = if slips(&state) { Contact::Sliding } else { Contact::Rolling };
        HybridState { contact, state }
    }
}

pub(crate) fn as_slip_state(state: &[f64]) -> SlipState {
    std::array::from_fn(|i| state[i])
}
