//! The equations of the wheel that slides, and the limit directions of its slip.
//!
//! They hold in one mode of the king pin: without dry friction about it, while it swings under the moment of that, or while it
//! sticks. A caster that sticks turns with the towing frame, `Omega' = 0`: across itself its mass alone resists the ground, so
//! that the mobility of the contact point, and with it the limit directions, are others.

use crate::body::Body;
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::Scalar;
use std::f64::consts::TAU;

/// Halvings of the bracket of the secular equation: enough for every bit of a double.
const BISECTIONS: usize = 200;

/// State while sliding: u, q, psi, V1, V2, Omega and the longitudinal slip velocity s1 = V1 - W. The lateral slip
/// velocity is V2. With the slip as a state, its direction keeps all digits as it vanishes.
pub(crate) type SlipState = [f64; 7];

/// Index of the longitudinal slip velocity.
pub(crate) const S1: usize = 6;
/// Index of the lateral slip velocity.
pub(crate) const S2: usize = 4;

/// A direction in which slip may grow from or shrink to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LimitDirection<T> {
    /// Unit vector of the slip, along and across the caster.
    pub direction: [T; 2],
    /// Rate of |s| in m/s^2: positive where slip grows.
    pub growth: f64,
}

/// The moment of dry friction about the king pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FrictionMoment<T> {
    /// There is none.
    Absent,
    /// That of a caster that swings, in N m.
    Swinging(T),
    /// Whatever keeps the yaw rate as it is.
    Sticking,
}

/// Coefficients of the equations; with dual numbers they carry derivatives with respect to a parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Equations<T> {
    body: Body<T>,
    v: T,
    omega: T,
    /// `m_w + m_c`.
    mass: T,
    /// `J_wxi/R^2`.
    rim_mass: T,
    /// `(m_w + m_c) J - m^2`.
    determinant: T,
    /// The moment of dry friction about the king pin that acts.
    friction_moment: FrictionMoment<T>,
    /// `M_f` in N m.
    pub largest_friction_moment: T,
    /// Mobility of the contact point, along and across the caster: the acceleration of the slip is its value without
    /// friction plus the mobility times the friction force.
    mobility: [T; 2],
    /// `mu_s N` in N.
    pub static_limit: T,
    /// `mu_d N` in N.
    pub sliding_friction: T,
}

impl Equations<f64> {
    /// # Errors
    /// What [`Wheel::sliding`] refuses.
    pub(crate) fn new(wheel: &Wheel) -> Result<Self, SimulationError> {
        // The check for a finite longitudinal stiffness is that of the rolling wheel.
        wheel.rolling(&[])?;
        if wheel.normal_force() < 0.0 {
            let allowed = "at most (m_w + m_c) g: a larger force lifts the wheel off the ground";
            return Err(SimulationError::out_of_range("F_Az", wheel.get(Key::FAz), allowed));
        }
        wheel.check()?;
        Ok(Self::with(|key| wheel.get(key)))
    }
}

impl<T: Scalar> Equations<T> {
    /// The coefficients made of these values of the stored parameters and the curvature.
    pub(crate) fn with(get: impl Fn(Key) -> T) -> Self {
        let body: Body<T> = Body::new(&get);
        let mass = get(Key::MW) + get(Key::MC);
        let rim_mass = get(Key::JWxi) / get(Key::WheelRadius).powi(2);
        let determinant = mass * body.yaw_inertia - body.static_moment.powi(2);
        let normal = mass * get(Key::G) - get(Key::FAz);
        Self {
            v: get(Key::V),
            omega: get(Key::V) * get(Key::Curvature),
            mass,
            rim_mass,
            determinant,
            friction_moment: FrictionMoment::Absent,
            largest_friction_moment: get(Key::MF),
            mobility: [mass.recip() + rim_mass.recip(), body.yaw_inertia / determinant],
            static_limit: get(Key::MuS) * normal,
            sliding_friction: get(Key::MuD) * normal,
            body,
        }
    }

    /// The equations under another moment of dry friction about the king pin.
    pub(crate) fn under(mut self, friction_moment: FrictionMoment<T>) -> Self {
        self.friction_moment = friction_moment;
        let across = match friction_moment {
            FrictionMoment::Sticking => self.mass.recip(),
            _ => self.body.yaw_inertia / self.determinant,
        };
        self.mobility[1] = across;
        self
    }

    /// The moment of dry friction in N m that acts under a friction force of the ground: of a caster that sticks, the one that it takes.
    pub(crate) fn friction_moment(&self, state: &[T], friction: [T; 2]) -> T {
        match self.friction_moment {
            FrictionMoment::Absent => T::zero(),
            FrictionMoment::Swinging(moment) => moment,
            FrictionMoment::Sticking => {
                let mut rate = [T::zero(); 7];
                self.under(FrictionMoment::Absent).derivative(state, friction, &mut rate);
                // What takes the yaw acceleration away, the force of the ground being the same.
                -(rate[5] * self.determinant) / self.mass
            }
        }
    }

    /// Rate of the caster angle.
    #[inline]
    pub(crate) fn swing_rate(&self, state: &[T]) -> T {
        self.omega - state[5]
    }

    /// Yaw acceleration that a moment about the king pin gives to the rolling wheel.
    pub(crate) fn yaw_acceleration(&self, moment: T) -> T {
        moment * self.body.inverse_yaw_inertia
    }

    /// Yaw rate of the towing frame: that of a caster that sticks.
    pub(crate) fn towing_yaw_rate(&self) -> T {
        self.omega
    }

    /// Derivative of the state under a friction force `[T1, T2]`.
    #[inline]
    pub(crate) fn derivative(&self, state: &[T], friction: [T; 2], derivative: &mut [T]) {
        let body = &self.body;
        let (u, q, psi, forward, lateral, yaw) = (state[0], state[1], state[2], state[3], state[4], state[5]);
        let (sine, cosine) = psi.sin_cos();
        let across = lateral + body.caster_length * yaw;
        let u_rate = forward * cosine + across * sine - self.v + self.omega * q;
        let q_rate = across * cosine - forward * sine - self.omega * u;
        let force_x = -(body.longitudinal_stiffness * u) - body.longitudinal_damping * u_rate;
        let force_y = -(body.lateral_stiffness * q) - body.lateral_damping * q_rate;
        let force_along = force_x * cosine - force_y * sine;
        let force_across = force_x * sine + force_y * cosine;
        let mut moment = body.caster_length * force_across - body.rotational_damping * (yaw - self.omega)
            + body.rotational_stiffness * psi;
        let lateral_force = force_across + friction[1];
        let forward_rate =
            lateral * yaw + (body.static_moment * yaw * yaw + force_along + friction[0]) / self.mass;
        derivative[0] = u_rate;
        derivative[1] = q_rate;
        derivative[2] = self.omega - yaw;
        derivative[3] = forward_rate;
        derivative[S1] = forward_rate + friction[0] / self.rim_mass;
        match self.friction_moment {
            FrictionMoment::Absent => {}
            FrictionMoment::Swinging(friction) => moment += friction,
            FrictionMoment::Sticking => {
                derivative[S2] = lateral_force / self.mass - forward * yaw;
                derivative[5] = T::zero();
                return;
            }
        }
        derivative[S2] = (body.yaw_inertia * lateral_force - body.static_moment * moment) / self.determinant
            - forward * yaw;
        derivative[5] = (self.mass * moment - body.static_moment * lateral_force) / self.determinant;
    }

    /// Friction force `-mu_d N s/|s|` at a state with slip.
    #[inline]
    pub(crate) fn sliding_force(&self, state: &[T]) -> [T; 2] {
        if self.sliding_friction.value() == 0.0 {
            return [T::zero(); 2];
        }
        let [along, across] = in_range_of_squares([state[S1], state[S2]]);
        let factor = -self.sliding_friction / (along * along + across * across).sqrt();
        [factor * along, factor * across]
    }

    /// The friction force that would keep the slip velocity as it is: the rolling force where there is no slip.
    #[inline]
    pub(crate) fn holding_force(&self, state: &[T]) -> [T; 2] {
        let mut rate = [T::zero(); 7];
        self.derivative(state, [T::zero(); 2], &mut rate);
        [-rate[S1] / self.mobility[0], -rate[S2] / self.mobility[1]]
    }

    /// Friction force while slip grows from zero along its limit direction.
    #[inline]
    pub(crate) fn incipient_force(&self, state: &[T]) -> [T; 2] {
        let limit = self.limit_direction(self.holding_force(state));
        limit.direction.map(|e| -self.sliding_friction * e)
    }

    /// Slip speed along the limit direction.
    #[inline]
    pub(crate) fn slip_along_limit_direction(&self, state: &[T]) -> T {
        let [along, across] = self.limit_direction(self.holding_force(state)).direction;
        along * state[S1] + across * state[S2]
    }

    /// Square of the static limit less that of the holding force.
    #[inline]
    pub(crate) fn static_reserve(&self, state: &[T]) -> T {
        reserve(self.static_limit, self.holding_force(state))
    }

    /// Square of the sliding friction less that of the holding force: slip may grow from zero where it is negative.
    #[inline]
    pub(crate) fn sliding_reserve(&self, state: &[T]) -> T {
        reserve(self.sliding_friction, self.holding_force(state))
    }

    /// Rate of the length of slip with a direction, given by its angle from the caster, and the rate at which that turns, times the length:
    /// where the slip is so small that the holding force does not change.
    fn small_slip(&self, holding_force: [f64; 2], angle: f64) -> [f64; 2] {
        let (across, along) = angle.sin_cos();
        let friction = self.sliding_friction.value();
        let rate = |i: usize, e: f64| -self.mobility[i].value() * (friction * e + holding_force[i]);
        let (rate_along, rate_across) = (rate(0, along), rate(1, across));
        [along * rate_along + across * rate_across, along * rate_across - across * rate_along]
    }

    /// Whether slip so small that nothing else changes shrinks to nothing. Its direction turns to a limit direction, and it does where that
    /// one shrinks. Where rolling takes less than the sliding friction they all do; where it takes more, most slip grows again, however
    /// small it has become.
    pub(crate) fn slip_vanishes(&self, state: &[T]) -> bool {
        /// Part of a turn by which the direction is followed, and halvings of the last one.
        const TURN: f64 = TAU / 720.0;
        const HALVINGS: usize = 50;
        let holding_force = self.holding_force(state).map(|force| force.value());
        let mut angle = state[S2].value().atan2(state[S1].value());
        let sense = self.small_slip(holding_force, angle)[1].signum();
        let turns_on = |angle: f64| self.small_slip(holding_force, angle)[1] * sense > 0.0;
        let mut turned = 0.0;
        while turned < TAU && turns_on(angle) {
            let mut step = TURN * sense;
            if !turns_on(angle + step) {
                for _ in 0..HALVINGS {
                    step *= 0.5;
                    if turns_on(angle + step) {
                        angle += step;
                    }
                }
                break;
            }
            angle += step;
            turned += TURN;
        }
        self.small_slip(holding_force, angle)[0] < 0.0
    }

    /// Solves the secular equation for the limit direction of largest growth.
    pub(crate) fn limit_direction(&self, force: [T; 2]) -> LimitDirection<T> {
        let [along, across] = self.mobility;
        let friction = self.sliding_friction;
        let (force_value, friction_value) = (force.map(|f| f.value()), friction.value());
        let mobility = [along.value(), across.value()];
        let length_squared = |growth: f64| {
            let e = |i: usize| force_value[i] * mobility[i] / (growth + friction_value * mobility[i]);
            e(0) * e(0) + e(1) * e(1)
        };
        let mut low = -friction_value * mobility[0].min(mobility[1]);
        let mut high = (force_value[0] * mobility[0]).hypot(force_value[1] * mobility[1]);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if length_squared(middle) > 1.0 { low = middle } else { high = middle }
        }
        // A step of Newton's method with dual numbers gives the growth its derivatives.
        let resistance = [friction * along + high, friction * across + high];
        let e = [-(force[0] * along) / resistance[0], -(force[1] * across) / resistance[1]];
        let squares = [e[0] * e[0], e[1] * e[1]];
        let slope = -2.0 * (squares[0] / resistance[0] + squares[1] / resistance[1]).value();
        let correction = -(squares[0] + squares[1] - 1.0) / slope;
        let direction = [
            -(force[0] * along) / (resistance[0] + correction),
            -(force[1] * across) / (resistance[1] + correction),
        ];
        let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        LimitDirection { direction: [direction[0] / length, direction[1] / length], growth: high }
    }
}

/// Whether there is slip.
#[inline]
pub(crate) fn slips(state: &[f64]) -> bool {
    state[S1] != 0.0 || state[S2] != 0.0
}

/// Square of the slip speed.
#[inline]
pub(crate) fn slip_squared<T: Scalar>(state: &[T]) -> T {
    state[S1] * state[S1] + state[S2] * state[S2]
}

/// A vector of the same direction whose square neither underflows nor overflows; nearly always the vector itself.
#[inline]
fn in_range_of_squares<T: Scalar>(vector: [T; 2]) -> [T; 2] {
    /// 2^500: scaling by a power of two loses no digit.
    const SCALE: f64 = f64::from_bits((1023 + 500) << 52);
    let largest = vector[0].value().abs().max(vector[1].value().abs());
    if largest < 1.0 / SCALE {
        vector.map(|entry| entry * (SCALE * SCALE))
    } else if largest > SCALE {
        vector.map(|entry| entry * (1.0 / (SCALE * SCALE)))
    } else {
        vector
    }
}

#[inline]
fn reserve<T: Scalar>(limit: T, force: [T; 2]) -> T {
    limit * limit - force[0] * force[0] - force[1] * force[1]
}

impl Equations<f64> {
    /// Kinetic energy and energy of the springs in J.
    pub(crate) fn energy(&self, state: &SlipState) -> f64 {
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

    /// Force of springs and dampers on the king pin in N, forwards and towards the centre of the circle.
    pub(crate) fn king_pin_force(&self, state: &SlipState) -> [f64; 2] {
        let mut rate = [0.0; 7];
        self.derivative(state, [0.0; 2], &mut rate);
        let body = &self.body;
        [
            -body.longitudinal_stiffness * state[0] - body.longitudinal_damping * rate[0],
            -body.lateral_stiffness * state[1] - body.lateral_damping * rate[1],
        ]
    }

    /// Power in W that the dampers take.
    pub(crate) fn power_of_damping(&self, state: &SlipState) -> f64 {
        let mut rate = [0.0; 7];
        self.derivative(state, [0.0; 2], &mut rate);
        let body = &self.body;
        body.longitudinal_damping * rate[0] * rate[0]
            + body.lateral_damping * rate[1] * rate[1]
            + body.rotational_damping * (state[5] - self.omega).powi(2)
    }

    /// Power in W that a friction force takes while the wheel slides.
    pub(crate) fn power_of_sliding(&self, state: &SlipState, friction: [f64; 2]) -> f64 {
        -friction[0] * state[S1] - friction[1] * state[S2]
    }

    /// Power in W of the towing frame, and the power that the dampers, dry friction about the king pin and a friction force dissipate.
    pub(crate) fn power(&self, state: &SlipState, friction: [f64; 2]) -> (f64, f64) {
        let mut rate = [0.0; 7];
        self.derivative(state, friction, &mut rate);
        let body = &self.body;
        let [u, q, psi, _, _, yaw, _] = *state;
        let damping = [-body.longitudinal_damping * rate[0], -body.lateral_damping * rate[1]];
        let force = [damping[0] - body.longitudinal_stiffness * u, damping[1] - body.lateral_stiffness * q];
        let dry = self.friction_moment(state, friction);
        let about_king_pin =
            body.rotational_stiffness * psi - body.rotational_damping * (yaw - self.omega) + dry;
        let towing =
            force[0] * (self.v - self.omega * q) + force[1] * self.omega * u + about_king_pin * self.omega;
        let dissipated =
            self.power_of_damping(state) + dry * (self.omega - yaw) + self.power_of_sliding(state, friction);
        (towing, dissipated)
    }
}
