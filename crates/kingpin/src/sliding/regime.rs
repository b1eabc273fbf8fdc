//! Which equations hold: rolling, sliding or just beginning to slide, and what the caster does about the king pin.
//!
//! Dry friction about the king pin works in the same way as that of the ground. While the caster swings its moment is
//! `M_f sign(psi')`; while it sticks, `Omega = omega`, it is whatever that takes, up to `M_f`. Which of the modes follow each other is
//! decided where one has ended, from the state alone: the accelerations of a body under forces of Coulomb's kind are the minimum of
//! a convex function (Gauss's principle), so that one mode fits, and one only where `mu_d = mu_s`; where static friction exceeds the
//! sliding one, holding comes first.

use super::model::{Equations, FrictionMoment, SlipState};
use super::{Contact, HybridState, RESTING_ANGLE, RESTING_EXCESS, SlidingWheel};
use arclength::Scalar;
use std::f64::consts::TAU;

/// What the caster does about the king pin where dry friction acts there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KingPin {
    /// It turns in the towing frame; without dry friction it always does.
    Swinging,
    /// It keeps its angle.
    Sticking,
}

/// Which equations of the contact hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Regime {
    /// No slip.
    Rolling,
    /// Slip grows from zero along its limit direction.
    Onset,
    /// Slip.
    Sliding,
}

impl Regime {
    /// Friction force of the ground.
    #[inline]
    pub(crate) fn friction<T: Scalar>(self, equations: &Equations<T>, state: &[T]) -> [T; 2] {
        match self {
            Self::Rolling => equations.holding_force(state),
            Self::Onset => equations.incipient_force(state),
            Self::Sliding => equations.sliding_force(state),
        }
    }

    /// Derivative of the seven states.
    #[inline]
    pub(crate) fn field<T: Scalar>(self, equations: &Equations<T>, state: &[T], derivative: &mut [T]) {
        equations.derivative(state, self.friction(equations, state), derivative);
    }

    /// Number of events of the contact at which it ends; that of the caster comes after them.
    pub(crate) fn contact_events(self) -> usize {
        if self == Self::Onset { 2 } else { 1 }
    }

    /// What the wheel is said to do.
    pub(crate) fn contact(self) -> Contact {
        if self == Self::Rolling { Contact::Rolling } else { Contact::Sliding }
    }
}

/// Which equations hold, of the contact and about the king pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mode {
    pub regime: Regime,
    pub friction_moment: FrictionMoment<f64>,
}

impl Mode {
    /// What the caster is said to do.
    pub(crate) fn king_pin(&self) -> KingPin {
        match self.friction_moment {
            FrictionMoment::Sticking => KingPin::Sticking,
            _ => KingPin::Swinging,
        }
    }

    /// The same with a caster that sticks.
    pub(crate) fn sticking(self) -> Self {
        Self { friction_moment: FrictionMoment::Sticking, ..self }
    }
}

impl SlidingWheel {
    /// Derivative of the state.
    pub(crate) fn rate(&self, state: &HybridState) -> SlipState {
        let regime = match state.contact {
            Contact::Rolling => Regime::Rolling,
            Contact::Sliding => Regime::Sliding,
        };
        let friction_moment = match self.equations.largest_friction_moment {
            0.0 => FrictionMoment::Absent,
            _ => self.mode(state).friction_moment,
        };
        let mut rate = [0.0; 7];
        regime.field(&self.equations_in(Mode { regime, friction_moment }), &state.state, &mut rate);
        rate
    }

    /// The mode in which the motion goes on from a state.
    pub(crate) fn mode(&self, present: &HybridState) -> Mode {
        let state = &present.state;
        let limit = self.equations.largest_friction_moment;
        if limit == 0.0 {
            return self.mode_under(FrictionMoment::Absent, present);
        }
        let rate = self.equations.swing_rate(state);
        if rate != 0.0 {
            return self.mode_under(FrictionMoment::Swinging(limit.copysign(rate)), present);
        }
        let sticking = self.mode_under(FrictionMoment::Sticking, present);
        let equations = self.equations_in(sticking);
        let needed = equations.friction_moment(state, sticking.regime.friction(&equations, state));
        let rests = self.comes_to_rest
            && present.contact == Contact::Rolling
            && off_path(state).abs() < RESTING_ANGLE;
        if needed.abs() <= if rests { limit * (1.0 + RESTING_EXCESS) } else { limit } {
            return sticking;
        }
        // Friction opposes the swing that takes more than it can give.
        self.mode_under(FrictionMoment::Swinging(limit.copysign(needed)), present)
    }

    /// A state where a swing has ended, with the caster laid along the straight path where what is left of its angle is no motion.
    pub(crate) fn laid_along_path(&self, mut present: HybridState) -> HybridState {
        let angle = off_path(&present.state);
        if self.comes_to_rest && present.contact == Contact::Rolling && angle.abs() < RESTING_ANGLE {
            present.state[2] -= angle;
        }
        present
    }

    /// The mode with a moment about the king pin.
    fn mode_under(&self, friction_moment: FrictionMoment<f64>, present: &HybridState) -> Mode {
        let regime = match present.contact {
            Contact::Sliding => Regime::Sliding,
            Contact::Rolling if self.holds(&self.equations.under(friction_moment), &present.state) => {
                Regime::Rolling
            }
            Contact::Rolling => Regime::Onset,
        };
        Mode { regime, friction_moment }
    }
}

/// Caster angle less whole turns.
fn off_path(state: &[f64]) -> f64 {
    state[2] - TAU * (state[2] / TAU).round()
}
