//! Whether the linear stability of a uniform motion is certain in spite of rounding.
//!
//! The Routh-Hurwitz conditions are evaluated with [bounds](crate::bounded) on the errors of everything that goes into them: the
//! parameters, which were rounded when they were read; the uniform motion, whose error is that of one step of Newton's method; the
//! Jacobian there. A condition closer to zero than its bound decides nothing.

use crate::body::Body;
use crate::bounded::{Bounded, characteristic_polynomial};
use crate::certain_jacobian::certain_jacobian;
use crate::hurwitz::{
    determinants, hopf_condition, is_surely_stable, plain_characteristic_polynomial, surely,
};
use crate::lateral;
use crate::linear_stability::lateral_cubic;
use crate::parameters::Key;
use crate::uniform_motion::{UniformMotion, jacobian_over};
use crate::wheel::Wheel;

impl UniformMotion {
    /// Whether the conditions for stability hold or fail beyond doubt; those of the lateral motion in rectilinear towing, where the
    /// longitudinal one is damped by `c_u` or does not count.
    pub(crate) fn is_surely_stable(&self) -> Option<bool> {
        let wheel = self.wheel();
        if let Some(state) = self.tyre_state() {
            return wheel.tyre_is_surely_stable(&state);
        }
        let parameter = |key| Bounded::read(wheel.get(key));
        let [_, q, psi, forward_speed, yaw_rate] = self.state();
        if wheel.towing_yaw_rate() == 0.0 && forward_speed > 0.0 {
            return is_surely_stable(&lateral_cubic(&Body::new(parameter), parameter(Key::V)));
        }
        if wheel.has_lateral_elasticity_only() {
            let jacobian =
                certain_jacobian([q, psi, yaw_rate], |state| lateral::jacobian_over(parameter, state))?;
            return is_surely_stable(&characteristic_polynomial(&jacobian));
        }
        if wheel.is_plain() && forward_speed > 0.0 {
            return is_plain_surely_stable(wheel);
        }
        let jacobian = certain_jacobian(self.state(), |state| jacobian_over(parameter, state))?;
        is_surely_stable(&characteristic_polynomial(&jacobian))
    }
}

/// The same for the plain wheel on a circle, from the closed forms.
fn is_plain_surely_stable(wheel: &Wheel) -> Option<bool> {
    let parameter = |key| Bounded::read(wheel.get(key));
    let body = Body::new(parameter);
    let curvature = parameter(Key::Curvature);
    let omega = parameter(Key::V) * curvature;
    let squared = omega * omega;
    let remaining = body.lateral_stiffness * body.caster_length - body.static_moment * squared;
    let sine = remaining / body.lateral_stiffness * curvature;
    if !(remaining.is_positive() && (Bounded::from(1.0) - sine * sine).is_positive()) {
        // Whether there is a motion at all could be decided either way.
        return None;
    }
    let [c1, c2, c3, c4, c5] = plain_characteristic_polynomial(&body, squared);
    let [second, _] = determinants([c1, c2, c3, c4, c5]);
    let [stiff, inertial] = hopf_condition(&body);
    surely([c1, c3, c5, second, Bounded::from(0.0) - stiff - inertial * squared], [c2, c4])
}
