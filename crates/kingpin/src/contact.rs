//! The force of the ground on the wheel.
//!
//! The friction force is what the rolling constraint demands: the momentum equations of the wheel that may slide, with
//! the slip velocity zero, give its components in the body frame
//!
//! ```text
//! T1 = -(J_wxi/R^2) V'          T2 = (m_w + m_c) V Omega + m Omega' - F2
//! ```
//!
//! where `F2` includes the dampers at the king pin. The wheel rolls while `|T| < mu_s N`.

use crate::parameters::Key;
use crate::rolling::right_hand_side;
use crate::wheel::Wheel;

/// The force of the ground on the rolling wheel, in N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// `T1`, along the caster, from wheel to king pin.
    pub longitudinal: f64,
    /// `T2`, across the caster.
    pub lateral: f64,
    /// `N`; negative where the load lifts the wheel.
    pub normal: f64,
    /// `mu_s N`, the largest friction force with which the wheel rolls.
    pub limit: f64,
}

impl ContactForce {
    /// The friction force `|T|`.
    pub fn friction(&self) -> f64 {
        self.longitudinal.hypot(self.lateral)
    }

    /// What is left of the static friction, as a difference of squares in N^2, which is smooth where the force vanishes; below zero
    /// the wheel cannot roll.
    pub(crate) fn static_reserve(&self) -> f64 {
        self.limit * self.limit.abs() - self.longitudinal.powi(2) - self.lateral.powi(2)
    }

    /// Whether the ground can supply the friction force: `|T| < mu_s N`.
    pub fn rolls(&self) -> bool {
        self.friction() < self.limit
    }
}

impl Wheel {
    /// `mu_s N`, the largest friction force with which the wheel rolls, in N; negative where the load lifts the wheel.
    pub fn static_limit(&self) -> f64 {
        self.get(Key::MuS) * self.normal_force()
    }

    /// The force of the ground on the rolling wheel, without a tyre, at a state `(u, q, psi, V, Omega)`; where `k_u = inf`, `u` and `V` do not
    /// count, for they follow from the others.
    pub fn contact_force(&self, state: &[f64; 5]) -> ContactForce {
        if self.has_lateral_elasticity_only() {
            let [_, q, psi, _, yaw_rate] = *state;
            return self.lateral_contact_force(&[q, psi, yaw_rate]);
        }
        let body = self.body();
        let mut derivative = [0.0; 5];
        let towing = (self.get(Key::V), self.towing_yaw_rate());
        let force_across = right_hand_side(&body, true, true, towing, state, &mut derivative);
        let [.., forward_speed, yaw_rate] = *state;
        let [.., forward_acceleration, yaw_acceleration] = derivative;
        self.ground_force(
            forward_acceleration,
            forward_speed * yaw_rate,
            body.static_moment * yaw_acceleration - force_across,
        )
    }

    /// `centripetal_acceleration` is `V Omega`; `remaining` is `m Omega' - F2`.
    #[inline]
    pub(crate) fn ground_force(
        &self,
        forward_acceleration: f64,
        centripetal_acceleration: f64,
        remaining: f64,
    ) -> ContactForce {
        let mass = self.mass();
        let wheel_radius = self.get(Key::WheelRadius);
        ContactForce {
            longitudinal: -(self.get(Key::JWxi) / (wheel_radius * wheel_radius)) * forward_acceleration,
            lateral: mass * centripetal_acceleration + remaining,
            normal: self.normal_force(),
            limit: self.static_limit(),
        }
    }
}
