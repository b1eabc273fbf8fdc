//! Which equations hold: rolling, sliding or just beginning to slide, and what the caster does about the king pin.
//!
//! Dry friction about the king pin works in the same way as that of the ground. While the caster swings its moment is
//! `M_f sign(psi')`; while it sticks, `Omega = omega`, it is whatever that takes, up to `M_f`. Which of the modes follow each other is
//! decided where one has ended, from the state alone: the accelerations of a body under forces of Coulomb's kind are the minimum of
//! a convex function (Gauss's principle), so that one mode fits, and one only where `mu_d = mu_s`; where static friction exceeds the
//! sliding one, holding comes first.

use super::model::{Equations, FrictionMoment};
use super::{Contact, HybridState, SlidingWheel};
use arclength::Scalar;

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
    /// The mode in which the motion goes on from a state.
    pub(crate) fn mode(&self, present: &HybridState) -> Mode {
        let state = &present.state;
        let regimes: &[Regime] = match present.contact {
            Contact::Rolling => &[Regime::Rolling, Regime::Onset],
            Contact::Sliding => &[Regime::Sliding],
        };
        let limit = self.equations.largest_friction_moment;
        let rate = self.equations.swing_rate(state);
        let moments: &[FrictionMoment<f64>] = if limit == 0.0 {
            &[FrictionMoment::Absent]
        } else if rate != 0.0 {
            &[FrictionMoment::Swinging(limit.copysign(rate))]
        } else {
            &[FrictionMoment::Sticking, FrictionMoment::Swinging(limit), FrictionMoment::Swinging(-limit)]
        };
        // Where rounding lets no mode fit, the caster is at its limit and sticks.
        let mut at_limit = Mode { regime: regimes[0], friction_moment: moments[0] };
        for &regime in regimes {
            for &friction_moment in moments {
                let equations = self.equations.under(friction_moment);
                let is_contact = match regime {
                    Regime::Rolling => self.holds(&equations, state),
                    Regime::Onset => !self.holds(&equations, state),
                    Regime::Sliding => true,
                };
                let mode = Mode { regime, friction_moment };
                if is_contact && fits_about_king_pin(&equations, mode, state) {
                    return mode;
                }
                if is_contact && friction_moment == FrictionMoment::Sticking {
                    at_limit = mode;
                }
            }
        }
        at_limit
    }
}

/// Whether what the caster does about the king pin fits the forces.
fn fits_about_king_pin(equations: &Equations<f64>, mode: Mode, state: &[f64]) -> bool {
    let friction = mode.regime.friction(equations, state);
    match mode.friction_moment {
        FrictionMoment::Absent => true,
        FrictionMoment::Sticking => {
            equations.friction_moment(state, friction).abs() <= equations.largest_friction_moment
        }
        FrictionMoment::Swinging(moment) => {
            let mut rate = [0.0; 7];
            equations.derivative(state, friction, &mut rate);
            equations.swing_rate(state) != 0.0 || -rate[5] * moment > 0.0
        }
    }
}
