//! The rolling wheel as a vector field.
//!
//! The quasi-velocities are the forward speed `V` of the wheel and the absolute yaw rate `Omega` of the caster, in which
//! the Appell-Gibbs equations become those of the Chaplygin sleigh on springs, without a singularity at `psi = pi/2`:
//!
//! ```text
//! u'       =  V cos psi + l Omega sin psi - v + omega q
//! q'       = -V sin psi + l Omega cos psi - omega u
//! psi'     =  omega - Omega
//! M V'     =  m Omega^2 + F1
//! J Omega' = -m V Omega + l F2 - c_psi (Omega - omega) + k_psi psi
//! ```
//!
//! with `omega = v/r`, `M = m_w + m_c + J_wxi/R^2`, `m = m_c (l - l_c)`, `J = J_Cz + J_wzeta + m (l - l_c)`. The force on
//! the king pin, `F_x = -k_u u - c_u u'` and `F_y = -k_q q - c_q q'`, has the components `F1` along the caster, from
//! wheel to king pin, and `F2` across it.

use crate::active::ActiveParameters;
use crate::body::Body;
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::{Scalar, VectorField};
use std::ops::Mul;

/// Names of the states: longitudinal and lateral displacement of the king pin in m, caster angle in rad, forward
/// speed of the wheel in m/s, absolute yaw rate of the caster in rad/s.
pub const STATE_NAMES: [&str; 5] = ["u", "q", "psi", "V", "Omega"];

/// The equations, once for all scalars; `about_king_pin` includes the rotational damper and spring, `damped` the dampers
/// in both directions. Returns `F2`, the force on the king pin across the caster.
#[inline(always)]
pub(crate) fn right_hand_side<T, C>(
    body: &Body<C>,
    damped: bool,
    about_king_pin: bool,
    (v, omega): (T, T),
    state: &[T],
    derivative: &mut [T],
) -> T
where
    T: Scalar + Mul<C, Output = T>,
    C: Copy,
{
    let (u, q, psi, forward_speed, yaw_rate) = (state[0], state[1], state[2], state[3], state[4]);
    let (sine, cosine) = psi.sin_cos();
    let lateral_speed = yaw_rate * body.caster_length;
    let u_rate = forward_speed * cosine + lateral_speed * sine - v + omega * q;
    let q_rate = lateral_speed * cosine - forward_speed * sine - omega * u;

    let mut force_x = -(u * body.longitudinal_stiffness);
    let mut force_y = -(q * body.lateral_stiffness);
    if damped {
        force_x -= u_rate * body.longitudinal_damping;
        force_y -= q_rate * body.lateral_damping;
    }
    let force_along = force_x * cosine - force_y * sine;
    let force_across = force_x * sine + force_y * cosine;
    let moving_static_moment = yaw_rate * body.static_moment;
    let mut moment = force_across * body.caster_length - moving_static_moment * forward_speed;
    if about_king_pin {
        moment += psi * body.rotational_stiffness - (yaw_rate - omega) * body.rotational_damping;
    }

    derivative[0] = u_rate;
    derivative[1] = q_rate;
    derivative[2] = omega - yaw_rate;
    derivative[3] = (moving_static_moment * yaw_rate + force_along) * body.inverse_rolling_mass;
    derivative[4] = moment * body.inverse_yaw_inertia;
    force_across
}

/// A rolling wheel with some of its parameters active: a vector field over the states [`STATE_NAMES`].
///
/// ```
/// use arclength::VectorField;
/// use kingpin::{Key, Wheel};
/// let wheel = Wheel::default();
/// let rolling = wheel.rolling(&[Key::V])?;
/// let mut derivative = [0.0; 5];
/// rolling.evaluate(&wheel.uniform_motion()?.state(), &[4.0], &mut derivative);
/// assert!(derivative.iter().all(|component| component.abs() < 1e-12));
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RollingWheel {
    active: ActiveParameters,
    damped: bool,
    about_king_pin: bool,
}

impl Wheel {
    /// The wheel as a vector field in which the given keys are the parameters, in this order.
    ///
    /// # Errors
    /// [`DependentKeys`](KingpinError::DependentKeys), [`InfiniteRadius`](KingpinError::InfiniteRadius),
    /// [`AmbiguousStiffness`](KingpinError::AmbiguousStiffness), where `k_u = inf`
    /// [`LateralElasticityOnly`](KingpinError::LateralElasticityOnly), with a tyre [`TyreNotTaken`](KingpinError::TyreNotTaken).
    pub fn rolling(&self, active: &[Key]) -> Result<RollingWheel, KingpinError> {
        self.check_elastic()?;
        let active = ActiveParameters::new(self, active)?;
        Ok(RollingWheel {
            damped: active.matters(Key::CU) || active.matters(Key::CQ),
            about_king_pin: active.matters(Key::CPsi) || active.matters(Key::KPsi),
            active,
        })
    }
}

impl RollingWheel {
    /// Which parameters are active.
    pub(crate) fn active_parameters(&self) -> &ActiveParameters {
        &self.active
    }

    /// The wheel with the values that it was made with.
    pub fn wheel(&self) -> &Wheel {
        self.active.wheel()
    }

    /// The body at these values of the active keys.
    pub(crate) fn body<T: Scalar>(&self, parameters: &[T]) -> Body<T> {
        self.active.body(parameters)
    }

    /// The active keys, in the order of the parameters.
    pub fn active(&self) -> &[Key] {
        self.active.keys()
    }

    /// The values of the active keys in [`wheel`](Self::wheel): the parameters to start from.
    pub fn parameters(&self) -> Vec<f64> {
        self.active.values()
    }

    /// The wheel at other values of the active keys.
    ///
    /// # Errors
    /// [`OutOfRange`](KingpinError::OutOfRange).
    pub fn wheel_at(&self, parameters: &[f64]) -> Result<Wheel, KingpinError> {
        self.active.wheel_at(parameters)
    }
}

impl VectorField for RollingWheel {
    fn state_names(&self) -> Vec<String> {
        STATE_NAMES.map(str::to_owned).into()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.active.names()
    }

    fn dimension(&self) -> usize {
        STATE_NAMES.len()
    }

    #[inline]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let towing = self.active.towing(parameters);
        let (damped, about_king_pin) = (self.damped, self.about_king_pin);
        match self.active.fixed_body() {
            Some(body) => right_hand_side(body, damped, about_king_pin, towing, state, derivative),
            None => {
                let body = self.active.body(parameters);
                right_hand_side(&body, damped, about_king_pin, towing, state, derivative)
            }
        };
    }
}
