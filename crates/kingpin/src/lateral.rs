//! The rolling wheel with lateral elasticity only, `k_u = inf`.
//!
//! The king pin cannot move along the towing direction: `u = 0`. Three states are left, and the forward speed follows
//! from them (Takács, Stépán and Hogan, "Isolated large amplitude periodic motions of towed rigid wheels", 2008):
//!
//! ```text
//! V cos psi = v - omega q - l Omega sin psi
//! q'        = -V sin psi + l Omega cos psi
//! psi'      = omega - Omega
//! (J Omega' + m V Omega) - l tan psi (M V' - m Omega^2) = l F_y/cos psi - c_psi (Omega - omega) + k_psi psi
//! ```
//!
//! with `F_y = -k_q q - c_q q'`. `V'` contains `Omega'`; the equation is solved for the latter. At `psi = pi/2` the
//! constraints leave `V` free and the field is not defined: motions that pass through lose digits there.

use crate::active::ActiveParameters;
use crate::body::Body;
use crate::contact::ContactForce;
use crate::error::{KingpinError, NoUniformMotion};
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::{Dual, Scalar, VectorField};
use std::ops::Mul;

/// Names of the states: lateral displacement of the king pin in m, caster angle in rad, absolute yaw rate of the caster
/// in rad/s.
pub const LATERAL_STATE_NAMES: [&str; 3] = ["q", "psi", "Omega"];

/// Newton's method for the caster angle stops when the step is below this, in rad.
const NEWTON_TOLERANCE: f64 = 1e-15;
/// Newton's method gives up after this many steps.
const NEWTON_STEPS: usize = 50;

/// What follows from the constraints at a state.
struct Kinematics<T> {
    forward_speed: T,
    forward_acceleration: T,
}

/// The equations, once for all scalars, under a moment of dry friction about the king pin.
#[inline(always)]
fn right_hand_side<T, C>(
    body: &Body<C>,
    (v, omega): (T, T),
    friction_moment: T,
    state: &[T],
    derivative: &mut [T],
) -> Kinematics<T>
where
    T: Scalar + Mul<C, Output = T>,
    C: Copy,
{
    let (q, psi, yaw_rate) = (state[0], state[1], state[2]);
    let (sine, cosine) = psi.sin_cos();
    let tangent = sine / cosine;
    let lateral_speed = yaw_rate * body.caster_length;
    let forward_speed = (v - omega * q - lateral_speed * sine) / cosine;
    let q_rate = lateral_speed * cosine - forward_speed * sine;
    let psi_rate = omega - yaw_rate;
    // V' = free - l tan psi Omega'
    let free = (tangent * forward_speed - lateral_speed) * psi_rate - omega * q_rate / cosine;

    let force_y = -(q * body.lateral_stiffness + q_rate * body.lateral_damping);
    let moving_static_moment = yaw_rate * body.static_moment;
    let about_king_pin =
        psi * body.rotational_stiffness + psi_rate * body.rotational_damping + friction_moment;
    let along = free * body.rolling_mass - moving_static_moment * yaw_rate;
    let moment =
        force_y * body.caster_length / cosine + about_king_pin + (tangent * along) * body.caster_length
            - moving_static_moment * forward_speed;
    let arm = tangent * body.caster_length;
    let inertia = arm * arm * body.rolling_mass + T::one() * body.yaw_inertia;

    derivative[0] = q_rate;
    derivative[1] = psi_rate;
    derivative[2] = moment / inertia;
    Kinematics { forward_speed, forward_acceleration: free - arm * derivative[2] }
}

/// A rolling wheel with lateral elasticity only, some of its parameters active: a vector field over the states
/// [`LATERAL_STATE_NAMES`].
#[derive(Clone, Debug)]
pub struct LateralWheel {
    active: ActiveParameters,
}

impl Wheel {
    /// The wheel with lateral elasticity only, as a vector field in which the given keys are the parameters.
    ///
    /// ```
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::from_toml("k_u = inf\nc_q = 0.05\nr = inf\nl = 0.04")?;
    /// assert_eq!(wheel.lateral(&[Key::V])?.parameters(), [4.0]);
    /// assert_eq!(wheel.uniform_motion()?.is_stable(), Some(false));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// [`LongitudinalElasticity`](KingpinError::LongitudinalElasticity) unless `k_u = inf`,
    /// [`NoLongitudinalMotion`](KingpinError::NoLongitudinalMotion) for `k`, `k_u` and `c_u`, and those of
    /// [`rolling`](Self::rolling) for other keys that cannot vary.
    pub fn lateral(&self, active: &[Key]) -> Result<LateralWheel, KingpinError> {
        self.check_rigid()?;
        if !self.has_lateral_elasticity_only() {
            return Err(KingpinError::LongitudinalElasticity { longitudinal: self.get(Key::KU) });
        }
        if let Some(&key) = active.iter().find(|key| [Key::K, Key::KU, Key::CU].contains(key)) {
            return Err(KingpinError::NoLongitudinalMotion { key });
        }
        Ok(LateralWheel { active: ActiveParameters::new(self, active)? })
    }

    /// The state `(q, psi, Omega)` of the uniform motion. Without a spring about the king pin the closed form. With it one
    /// equation is left, `sin psi (1 - k_psi psi cos psi/(k l r)) = (l - a0)/r`.
    fn lateral_uniform_free_state(&self) -> Result<[f64; 3], NoUniformMotion> {
        let body = self.body();
        let [_, q, angle, _, omega] = self.isotropic_uniform_state(&body)?;
        if body.rotational_stiffness == 0.0 || omega == 0.0 {
            return Ok([q, angle, omega]);
        }
        let (v, curvature) = (self.get(Key::V), self.get(Key::Curvature));
        let elastic = body.lateral_stiffness * body.caster_length;
        let weight = curvature * body.rotational_stiffness / elastic;
        let equation = |psi: Dual<f64, 1>| psi.sin() * (-(psi * psi.cos() * weight) + 1.0) - angle.sin();
        let mut psi = angle;
        for _ in 0..NEWTON_STEPS {
            let Dual { value, derivatives: [slope] } = equation(Dual::variable(psi, 0));
            let step = value / slope;
            psi -= step;
            if step.abs() < NEWTON_TOLERANCE {
                // q = (k_psi psi cos psi - m omega^2 l/sin psi)/(k l), in which omega/sin psi stays finite.
                let moment = body.rotational_stiffness * psi * psi.cos();
                let centripetal = body.static_moment * omega * v * body.caster_length * curvature / psi.sin();
                return Ok([(moment - centripetal) / elastic, psi, omega]);
            }
        }
        Err(NoUniformMotion::NotFound { residual: equation(Dual::constant(psi)).value.abs() })
    }

    /// The states `(u, q, psi, V, Omega)` of the uniform motion.
    pub(crate) fn lateral_uniform_state(&self) -> Result<[f64; 5], NoUniformMotion> {
        let state = self.lateral_uniform_free_state()?;
        let (kinematics, _) = self.lateral_motion(0.0, &state);
        let [q, psi, yaw_rate] = state;
        Ok([0.0, q, psi, kinematics.forward_speed, yaw_rate])
    }

    /// What follows from the constraints at a state `(q, psi, Omega)`, and the vector field, under a moment of dry friction about the king
    /// pin in N m.
    fn lateral_motion(&self, friction_moment: f64, state: &[f64; 3]) -> (Kinematics<f64>, [f64; 3]) {
        let mut derivative = [0.0; 3];
        let towing = (self.get(Key::V), self.towing_yaw_rate());
        let kinematics = right_hand_side(&self.body(), towing, friction_moment, state, &mut derivative);
        (kinematics, derivative)
    }

    /// The vector field at a state `(q, psi, Omega)`, and its Jacobian.
    pub(crate) fn lateral_linearisation(&self, state: &[f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        type Gradient = Dual<f64, 3>;
        let state: [Gradient; 3] = std::array::from_fn(|index| Gradient::variable(state[index], index));
        let towing = [self.get(Key::V), self.towing_yaw_rate()].map(Gradient::constant);
        let mut derivative = [Gradient::constant(0.0); 3];
        right_hand_side(&self.body(), towing.into(), Gradient::constant(0.0), &state, &mut derivative);
        (derivative.map(|component| component.value), derivative.map(|component| component.derivatives))
    }

    /// The force of the ground on the wheel at a state `(q, psi, Omega)`. The longitudinal force on the king pin, which
    /// holds it at `u = 0`, is on the way: `M V' - m Omega^2 = F1`.
    pub(crate) fn lateral_contact_force(&self, state: &[f64; 3]) -> ContactForce {
        self.lateral_contact_force_under(0.0, state)
    }

    /// The same under a moment of dry friction about the king pin in N m.
    pub(crate) fn lateral_contact_force_under(&self, friction_moment: f64, state: &[f64; 3]) -> ContactForce {
        let body = self.body();
        let (Kinematics { forward_speed, forward_acceleration }, [q_rate, _, yaw_acceleration]) =
            self.lateral_motion(friction_moment, state);
        let [q, psi, yaw_rate] = *state;
        let force_y = -body.lateral_stiffness * q - body.lateral_damping * q_rate;
        let force_along = body.rolling_mass * forward_acceleration - body.static_moment * yaw_rate * yaw_rate;
        let force_x = (force_along + force_y * psi.sin()) / psi.cos();
        let force_across = force_x * psi.sin() + force_y * psi.cos();
        self.ground_force(
            forward_acceleration,
            forward_speed * yaw_rate,
            body.static_moment * yaw_acceleration - force_across,
        )
    }
}

/// The vector field at a state `(q, psi, Omega)` and its Jacobian over any scalar, from the parameters as such.
pub(crate) fn jacobian_over<T: Scalar>(
    parameter: impl Fn(Key) -> T,
    state: &[T; 3],
) -> ([T; 3], [[T; 3]; 3]) {
    let constant = |key| Dual::<T, 3>::constant(parameter(key));
    let body = Body::new(constant);
    let state: [Dual<T, 3>; 3] = std::array::from_fn(|index| Dual::variable(state[index], index));
    let v = constant(Key::V);
    let mut derivative = [Dual::constant(T::zero()); 3];
    right_hand_side(
        &body,
        (v, v * constant(Key::Curvature)),
        Dual::constant(T::zero()),
        &state,
        &mut derivative,
    );
    (derivative.map(|component| component.value), derivative.map(|component| component.derivatives))
}

/// The coefficients of the characteristic polynomial `s^3 + c1 s^2 + c2 s + c3` of a matrix.
pub(crate) fn characteristic_cubic(a: &[[f64; 3]; 3]) -> [f64; 3] {
    let minor = |i: usize, j: usize| a[i][i] * a[j][j] - a[i][j] * a[j][i];
    let cofactor = |i: usize, j: usize| a[1][i] * a[2][j] - a[1][j] * a[2][i];
    let determinant = a[0][0] * cofactor(1, 2) - a[0][1] * cofactor(0, 2) + a[0][2] * cofactor(0, 1);
    [-(a[0][0] + a[1][1] + a[2][2]), minor(0, 1) + minor(0, 2) + minor(1, 2), -determinant]
}

impl LateralWheel {
    /// Which parameters are active.
    pub(crate) fn active_parameters(&self) -> &ActiveParameters {
        &self.active
    }

    /// The wheel with the values that it was made with.
    pub fn wheel(&self) -> &Wheel {
        self.active.wheel()
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

    /// Forward speed `V` of the wheel in m/s at a state `(q, psi, Omega)`.
    pub fn forward_speed(&self, state: &[f64; 3]) -> f64 {
        self.wheel().lateral_motion(0.0, state).0.forward_speed
    }

    /// The same at other values of the active keys.
    pub(crate) fn forward_speed_at<T: Scalar>(&self, state: &[T], parameters: &[T]) -> T {
        self.motion(state, parameters, T::zero(), &mut [T::zero(); 3]).forward_speed
    }

    /// The forward speed and its rate of change at other values of the active keys, with the vector field, under a moment of dry friction
    /// about the king pin.
    pub(crate) fn forward_motion<T: Scalar>(
        &self,
        state: &[T],
        parameters: &[T],
        friction_moment: T,
        derivative: &mut [T],
    ) -> [T; 2] {
        let motion = self.motion(state, parameters, friction_moment, derivative);
        [motion.forward_speed, motion.forward_acceleration]
    }

    /// The force of the ground on the wheel at a state `(q, psi, Omega)`.
    pub fn contact_force(&self, state: &[f64; 3]) -> ContactForce {
        self.wheel().lateral_contact_force(state)
    }

    #[inline]
    fn motion<T: Scalar>(
        &self,
        state: &[T],
        parameters: &[T],
        friction_moment: T,
        derivative: &mut [T],
    ) -> Kinematics<T> {
        let towing = self.active.towing(parameters);
        match self.active.fixed_body() {
            Some(body) => right_hand_side(body, towing, friction_moment, state, derivative),
            None => {
                right_hand_side(&self.active.body(parameters), towing, friction_moment, state, derivative)
            }
        }
    }
}

impl VectorField for LateralWheel {
    fn state_names(&self) -> Vec<String> {
        LATERAL_STATE_NAMES.map(str::to_owned).into()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.active.names()
    }

    fn dimension(&self) -> usize {
        LATERAL_STATE_NAMES.len()
    }

    #[inline]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        self.motion(state, parameters, T::zero(), derivative);
    }
}
