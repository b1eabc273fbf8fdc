//! The equations of the wheel that slides, and the limit directions of its slip.

use crate::parameters::Key;
use crate::rolling::Body;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;

/// Halvings of the bracket of the secular equation: enough for every bit of a double.
const BISECTIONS: usize = 200;

/// State while sliding: u, q, psi, V1, V2, Omega and the longitudinal slip velocity s1 = V1 - W. The lateral slip
/// velocity is V2. With the slip as a state, its direction keeps all digits as it vanishes.
pub(super) type SlipState = [f64; 7];

/// Index of the longitudinal slip velocity.
pub(super) const S1: usize = 6;
/// Index of the lateral slip velocity.
pub(super) const S2: usize = 4;

/// A direction in which slip may grow from or shrink to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LimitDirection {
    /// Unit vector of the slip, along and across the caster.
    pub direction: [f64; 2],
    /// Rate of |s| in m/s^2: positive where slip grows.
    pub growth: f64,
}

/// Coefficients of the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations {
    body: Body<f64>,
    v: f64,
    omega: f64,
    /// `m_w + m_c`.
    mass: f64,
    /// `J_wxi/R^2`.
    rim_mass: f64,
    /// Mobility of the contact point, along and across the caster: the acceleration of the slip is its value without
    /// friction plus the mobility times the friction force.
    mobility: [f64; 2],
    /// `mu_s N` in N.
    pub static_limit: f64,
    /// `mu_d N` in N.
    pub sliding_friction: f64,
}

impl Equations {
    pub fn new(wheel: &Wheel) -> Result<Self, SimulationError> {
        // The check for a finite longitudinal stiffness is that of the rolling wheel.
        wheel.rolling(&[])?;
        let normal = wheel.normal_force();
        if normal < 0.0 {
            let allowed = "at most (m_w + m_c) g: a larger force lifts the wheel off the ground";
            return Err(SimulationError::out_of_range("F_Az", wheel.get(Key::FAz), allowed));
        }
        let (mu_s, mu_d) = (wheel.get(Key::MuS), wheel.get(Key::MuD));
        if mu_d > mu_s {
            return Err(SimulationError::out_of_range("mu_d", mu_d, "at most mu_s"));
        }
        let body = wheel.body();
        let mass = wheel.get(Key::MW) + wheel.get(Key::MC);
        let rim_mass = wheel.get(Key::JWxi) / wheel.get(Key::WheelRadius).powi(2);
        let determinant = mass * body.yaw_inertia - body.static_moment.powi(2);
        Ok(Self {
            body,
            v: wheel.get(Key::V),
            omega: wheel.towing_yaw_rate(),
            mass,
            rim_mass,
            mobility: [1.0 / mass + 1.0 / rim_mass, body.yaw_inertia / determinant],
            static_limit: mu_s * normal,
            sliding_friction: mu_d * normal,
        })
    }

    /// Derivative of the state under a friction force `[T1, T2]`.
    #[inline]
    pub fn derivative(&self, state: &[f64], friction: [f64; 2], derivative: &mut [f64]) {
        let body = &self.body;
        let (u, q, psi, forward, lateral, yaw) = (state[0], state[1], state[2], state[3], state[4], state[5]);
        let (sine, cosine) = psi.sin_cos();
        let across = lateral + body.caster_length * yaw;
        let u_rate = forward * cosine + across * sine - self.v + self.omega * q;
        let q_rate = across * cosine - forward * sine - self.omega * u;
        let force_x = -body.longitudinal_stiffness * u - body.longitudinal_damping * u_rate;
        let force_y = -body.lateral_stiffness * q - body.lateral_damping * q_rate;
        let force_along = force_x * cosine - force_y * sine;
        let force_across = force_x * sine + force_y * cosine;
        let moment = body.caster_length * force_across - body.rotational_damping * (yaw - self.omega)
            + body.rotational_stiffness * psi;
        let lateral_force = force_across + friction[1];
        let determinant = self.mass * body.yaw_inertia - body.static_moment.powi(2);
        let forward_rate =
            lateral * yaw + (body.static_moment * yaw * yaw + force_along + friction[0]) / self.mass;
        derivative[0] = u_rate;
        derivative[1] = q_rate;
        derivative[2] = self.omega - yaw;
        derivative[3] = forward_rate;
        derivative[S2] =
            (body.yaw_inertia * lateral_force - body.static_moment * moment) / determinant - forward * yaw;
        derivative[5] = (self.mass * moment - body.static_moment * lateral_force) / determinant;
        derivative[S1] = forward_rate + friction[0] / self.rim_mass;
    }

    /// Friction force `-mu_d N s/|s|` at a state with slip.
    #[inline]
    pub fn sliding_force(&self, state: &[f64]) -> [f64; 2] {
        if self.sliding_friction == 0.0 {
            return [0.0; 2];
        }
        let factor = -self.sliding_friction / state[S1].hypot(state[S2]);
        [factor * state[S1], factor * state[S2]]
    }

    /// The friction force that would keep the slip velocity as it is: the rolling force where there is no slip.
    #[inline]
    pub fn holding_force(&self, state: &[f64]) -> [f64; 2] {
        let mut rate = [0.0; 7];
        self.derivative(state, [0.0; 2], &mut rate);
        [-rate[S1] / self.mobility[0], -rate[S2] / self.mobility[1]]
    }

    /// Where slip may start, or `None` where the sliding friction alone holds the wheel.
    pub fn incipient_slip(&self, state: &[f64]) -> Option<LimitDirection> {
        let force = self.holding_force(state);
        (force[0].hypot(force[1]) > self.sliding_friction).then(|| self.limit_direction(force))
    }

    /// Solves the secular equation for the limit direction of largest growth.
    pub fn limit_direction(&self, force: [f64; 2]) -> LimitDirection {
        let [along, across] = self.mobility;
        let direction = |growth: f64| {
            [
                -force[0] * along / (growth + self.sliding_friction * along),
                -force[1] * across / (growth + self.sliding_friction * across),
            ]
        };
        let mut low = -self.sliding_friction * along.min(across);
        let mut high = (force[0] * along).hypot(force[1] * across);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            let [e1, e2] = direction(middle);
            if e1 * e1 + e2 * e2 > 1.0 { low = middle } else { high = middle }
        }
        let [e1, e2] = direction(high);
        let length = e1.hypot(e2);
        LimitDirection { direction: [e1 / length, e2 / length], growth: high }
    }

    /// Kinetic energy and energy of the springs in J.
    pub fn energy(&self, state: &SlipState) -> f64 {
        let [u, q, psi, forward, lateral, yaw, slip] = *state;
        let body = &self.body;
        let rim_speed = forward - slip;
        0.5 * self.mass * (forward * forward + lateral * lateral)
            + 0.5 * self.rim_mass * rim_speed * rim_speed
            + 0.5 * body.yaw_inertia * yaw * yaw
            + body.static_moment * lateral * yaw
            + 0.5 * body.longitudinal_stiffness * u * u
            + 0.5 * body.lateral_stiffness * q * q
            + 0.5 * body.rotational_stiffness * psi * psi
    }

    /// Power in W of the towing frame, and the power that the dampers and a friction force dissipate.
    pub fn power(&self, state: &SlipState, friction: [f64; 2]) -> (f64, f64) {
        let mut rate = [0.0; 7];
        self.derivative(state, friction, &mut rate);
        let body = &self.body;
        let [u, q, psi, _, lateral, yaw, slip] = *state;
        let damping = [-body.longitudinal_damping * rate[0], -body.lateral_damping * rate[1]];
        let force = [damping[0] - body.longitudinal_stiffness * u, damping[1] - body.lateral_stiffness * q];
        let about_king_pin = body.rotational_stiffness * psi - body.rotational_damping * (yaw - self.omega);
        let towing =
            force[0] * (self.v - self.omega * q) + force[1] * self.omega * u + about_king_pin * self.omega;
        let dissipated = -damping[0] * rate[0] - damping[1] * rate[1]
            + body.rotational_damping * (yaw - self.omega).powi(2)
            - friction[0] * slip
            - friction[1] * lateral;
        (towing, dissipated)
    }
}
