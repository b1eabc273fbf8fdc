//! Forces along a motion that rolls: of the ground on the wheel and of the springs and dampers on the king pin, with the power that
//! the dampers take.
//!
//! They follow from the momentum balances, in which all accelerations are known from the vector field, and so in the same way whether
//! the king pin is elastic or rigid. Without a tyre
//!
//! ```text
//! F1 = M V' - m Omega^2           F2 = (J Omega' + m V Omega + c_psi (Omega - omega) - k_psi psi)/l
//! T1 = -(J_wxi/R^2) V'            T2 = (m_w + m_c) V Omega + m Omega' - F2
//! ```
//!
//! and with one, whose law gives `T2`,
//!
//! ```text
//! F1 = M V1' - (m_w + m_c) V2 Omega - m Omega^2           F2 = (m_w + m_c) (V2' + V1 Omega) + m Omega' - T2
//! ```

use crate::active::ActiveParameters;
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::rolling_model::RollingModel;
use crate::uniform_motion::UniformMotion;
use crate::wheel::Wheel;
use arclength::cycle::Orbit;
use arclength::{Dual, Scalar, VectorField};

/// Index of the caster angle among all states.
const CASTER_ANGLE: usize = 2;

/// The forces at a state, in the body frame of the caster, in N.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forces<T> {
    /// `T1` and `T2`, of the ground on the wheel along and across the caster.
    pub ground: [T; 2],
    /// `F1` and `F2`, on the king pin along and across the caster.
    pub king_pin: [T; 2],
    /// What the dampers at the king pin and about it take, in W.
    pub damper_power: T,
}

/// A number along a cycle with its slope in time.
type Sloped = Dual<f64, 1>;

/// What the forces need of a motion.
struct Motion<T> {
    psi: T,
    yaw_rate: T,
    yaw_acceleration: T,
    /// `u'` and `q'`.
    king_pin_speeds: [T; 2],
    /// `V` and `V'`, with a tyre `V1` and `V1'`.
    forward: [T; 2],
    /// With a tyre `V2`, `V2'` and `T2`.
    tyre: Option<[T; 3]>,
    /// Moment of dry friction about the king pin.
    friction_moment: T,
}

/// What the forces need of the wheel, at values of the active parameters.
pub(crate) struct ForceParameters<T> {
    omega: T,
    mass: T,
    /// `J_wxi/R^2`.
    spin: T,
    l: T,
    static_moment: T,
    /// About the king pin.
    inertia: T,
    rotational_damping: T,
    rotational_stiffness: T,
    longitudinal_damping: T,
    lateral_damping: T,
}

impl<T: Scalar> ForceParameters<T> {
    fn at(active: &ActiveParameters, parameters: &[T]) -> Self {
        let value = |key| active.value(key, parameters);
        let (_, omega) = active.towing(parameters);
        let radius = value(Key::WheelRadius);
        let arm = value(Key::L) - value(Key::LC);
        let static_moment = value(Key::MC) * arm;
        Self {
            omega,
            mass: value(Key::MW) + value(Key::MC),
            spin: value(Key::JWxi) / (radius * radius),
            l: value(Key::L),
            static_moment,
            inertia: value(Key::JCz) + value(Key::JWzeta) + static_moment * arm,
            rotational_damping: value(Key::CPsi),
            rotational_stiffness: value(Key::KPsi),
            longitudinal_damping: value(Key::CU),
            lateral_damping: value(Key::CQ),
        }
    }

    fn forces(&self, motion: &Motion<T>) -> Forces<T> {
        let Motion { psi, yaw_rate, yaw_acceleration, .. } = *motion;
        let [forward, forward_acceleration] = motion.forward;
        let turning = yaw_rate - self.omega;
        let along = (self.mass + self.spin) * forward_acceleration - self.static_moment * yaw_rate * yaw_rate;
        let centripetal = self.mass * forward * yaw_rate + self.static_moment * yaw_acceleration;
        let (king_pin, lateral) = match motion.tyre {
            Some([lateral, lateral_acceleration, force]) => {
                let along = along - self.mass * lateral * yaw_rate;
                ([along, self.mass * lateral_acceleration + centripetal - force], force)
            }
            None => {
                let about_king_pin = self.rotational_damping * turning - self.rotational_stiffness * psi;
                let moment = self.inertia * yaw_acceleration
                    + self.static_moment * forward * yaw_rate
                    + about_king_pin
                    - motion.friction_moment;
                let across = moment / self.l;
                ([along, across], centripetal - across)
            }
        };
        let [u_rate, q_rate] = motion.king_pin_speeds;
        // A direction in which the king pin is rigid has no speed, whatever its damper.
        Forces {
            ground: [-(self.spin * forward_acceleration), lateral],
            king_pin,
            damper_power: self.longitudinal_damping * u_rate * u_rate
                + self.lateral_damping * q_rate * q_rate
                + self.rotational_damping * turning * turning,
        }
    }
}

impl RollingModel {
    /// What the forces need of the wheel, the same all along a motion.
    pub(crate) fn force_parameters<T: Scalar>(&self, parameters: &[T]) -> ForceParameters<T> {
        let active = match self {
            Self::Elastic(wheel) => wheel.active_parameters(),
            Self::Lateral(wheel) => wheel.active_parameters(),
            Self::Tyre(wheel) => wheel.active_parameters(),
        };
        ForceParameters::at(active, parameters)
    }

    /// The forces at a state of the vector field.
    pub(crate) fn forces<T: Scalar>(&self, state: &[T], parameters: &[T]) -> Forces<T> {
        self.forces_along(&self.force_parameters(parameters), T::zero(), state, parameters)
    }

    /// The forces at a state of a motion of which the parameters of the forces are known, under a moment of dry friction about the king pin
    /// in N m. Where the king pin is elastic in both directions that makes no difference to the force on it.
    fn forces_along<T: Scalar>(
        &self,
        known: &ForceParameters<T>,
        friction_moment: T,
        state: &[T],
        parameters: &[T],
    ) -> Forces<T> {
        let zero = T::zero();
        match self {
            Self::Elastic(wheel) => {
                let mut rates = [zero; 5];
                wheel.evaluate(state, parameters, &mut rates);
                known.forces(&Motion {
                    psi: state[2],
                    yaw_rate: state[4],
                    yaw_acceleration: rates[4],
                    king_pin_speeds: [rates[0], rates[1]],
                    forward: [state[3], rates[3]],
                    tyre: None,
                    friction_moment: zero,
                })
            }
            Self::Lateral(wheel) => {
                let mut rates = [zero; 3];
                let forward = wheel.forward_motion(state, parameters, friction_moment, &mut rates);
                known.forces(&Motion {
                    psi: state[1],
                    yaw_rate: state[2],
                    yaw_acceleration: rates[2],
                    king_pin_speeds: [zero, rates[0]],
                    forward,
                    tyre: None,
                    friction_moment,
                })
            }
            Self::Tyre(wheel) => {
                let full = wheel.full_state(state, parameters);
                let (rates, lateral_force) =
                    wheel.rates_and_lateral_force(state, parameters, friction_moment);
                known.forces(&Motion {
                    psi: full[2],
                    yaw_rate: full[5],
                    yaw_acceleration: rates[5],
                    king_pin_speeds: [rates[0], rates[1]],
                    forward: [full[3], rates[3]],
                    tyre: Some([full[4], rates[4], lateral_force]),
                    friction_moment,
                })
            }
        }
    }

    /// The largest forces along a cycle of this vector field.
    pub(crate) fn cycle_forces(&self, orbit: &Orbit, parameters: &[f64]) -> CycleForces {
        let static_limit = self.static_limit(parameters);
        if !self.determines_speed(orbit) {
            let unknown = f64::NAN;
            return CycleForces {
                friction_max: unknown,
                static_limit,
                king_pin_force_max: unknown,
                damper_power: unknown,
            };
        }
        let known = self.force_parameters(parameters);
        let [friction_max, king_pin_force_max] =
            self.largest(orbit, parameters, |forces| [forces.ground, forces.king_pin]);
        CycleForces {
            friction_max,
            static_limit,
            king_pin_force_max,
            damper_power: orbit.mean(|state| self.forces_along(&known, 0.0, state, parameters).damper_power),
        }
    }

    /// The largest friction force along a cycle over `mu_s N`; `None` where nothing presses the wheel down, not a number where the
    /// states do not determine the speed.
    pub(crate) fn friction_ratio_max(&self, orbit: &Orbit, parameters: &[f64]) -> Option<f64> {
        let limit = self.static_limit(parameters);
        let largest = || {
            let [friction] = self.largest(orbit, parameters, |forces| [forces.ground]);
            friction
        };
        (limit > 0.0).then(|| if self.determines_speed(orbit) { largest() / limit } else { f64::NAN })
    }

    fn static_limit(&self, parameters: &[f64]) -> f64 {
        self.wheel_at(parameters).map_or(f64::NAN, |wheel| wheel.static_limit())
    }

    /// The largest lengths of some forces along a cycle that determines the speed.
    fn largest<const K: usize>(
        &self,
        orbit: &Orbit,
        parameters: &[f64],
        chosen: fn(&Forces<Sloped>) -> [[Sloped; 2]; K],
    ) -> [f64; K] {
        let parameters: Vec<Sloped> = parameters.iter().map(|&value| Dual::constant(value)).collect();
        let known = self.force_parameters(&parameters);
        // The square is smooth where the force vanishes.
        let squares = orbit.ranges_of(|state| {
            let forces = self.forces_along(&known, Scalar::zero(), state, &parameters);
            chosen(&forces).map(|[along, across]| along * along + across * across)
        });
        squares.map(|[_, largest]| largest.sqrt())
    }
}

/// The largest forces along a cycle, of the collocation polynomials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleForces {
    /// Largest friction force of the ground on the wheel, in N. All forces are not numbers where, with `k_u = inf`, the caster comes near
    /// `psi = pi/2`.
    pub friction_max: f64,
    /// `mu_s N`, the largest friction force with which the wheel rolls, in N; negative where the load lifts the wheel.
    pub static_limit: f64,
    /// Largest force on the king pin, in N.
    pub king_pin_force_max: f64,
    /// What all dampers take, the mean over a period in W.
    pub damper_power: f64,
}

impl CycleForces {
    /// The largest friction force over `mu_s N`; `None` where nothing presses the wheel down.
    pub fn friction_ratio_max(&self) -> Option<f64> {
        (self.static_limit > 0.0).then(|| self.friction_max / self.static_limit)
    }

    /// Whether the ground can supply the friction all along the cycle; `None` where that is not known.
    pub fn rolls(&self) -> Option<bool> {
        (!self.friction_max.is_nan()).then_some(self.friction_max < self.static_limit)
    }
}

impl Wheel {
    /// The largest forces along a cycle of the rolling wheel in its [free states](Self::free_states).
    ///
    /// # Errors
    /// An orbit that is none of this wheel, [`KingpinError::Continuation`]; those of [`rolling_model`](Self::rolling_model).
    pub fn cycle_forces(&self, orbit: &Orbit) -> Result<CycleForces, KingpinError> {
        orbit.check(self.free_states().len())?;
        Ok(self.rolling_model(&[])?.cycle_forces(orbit, &[]))
    }
}

/// A force along and across a caster in the towing frame: forwards, and towards the centre of the circle.
pub fn in_towing_frame(psi: f64, [along, across]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = psi.sin_cos();
    [along * cosine + across * sine, across * cosine - along * sine]
}

/// What the king pin bears and what the dampers take at a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KingPinLoad {
    /// Force on the king pin in N, forwards and towards the centre of the circle.
    pub components: [f64; 2],
    /// What all dampers take, in W.
    pub damper_power: f64,
}

impl KingPinLoad {
    /// Force on the king pin in N.
    pub fn force(&self) -> f64 {
        self.components[0].hypot(self.components[1])
    }
}

/// What ground and king pin bear at a state of a motion that rolls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingLoad {
    /// Force of the ground on the wheel in N, forwards and towards the centre of the circle.
    pub ground: [f64; 2],
    /// That of the king pin.
    pub king_pin: KingPinLoad,
}

impl Wheel {
    /// The loads at [all states](Self::states) of a motion that rolls, each with the moment of dry friction about the king pin in N m, which
    /// is no damper.
    ///
    /// # Errors
    /// Those of [`rolling_model`](Self::rolling_model).
    ///
    /// # Panics
    /// Where there are fewer states than the wheel has.
    pub fn rolling_loads<'a>(
        &self,
        states: impl IntoIterator<Item = (&'a [f64], f64)>,
    ) -> Result<Vec<RollingLoad>, KingpinError> {
        let model = self.rolling_model(&[])?;
        let known = model.force_parameters(&[]);
        let load = |(states, friction_moment): (&[f64], f64)| {
            let forces = model.forces_along(&known, friction_moment, &model.free_state(states), &[]);
            let psi = states[CASTER_ANGLE];
            let components = in_towing_frame(psi, forces.king_pin);
            RollingLoad {
                ground: in_towing_frame(psi, forces.ground),
                king_pin: KingPinLoad { components, damper_power: forces.damper_power },
            }
        };
        Ok(states.into_iter().map(load).collect())
    }
}

impl UniformMotion {
    /// The forces of the uniform motion as those of a cycle of no size.
    ///
    /// # Errors
    /// Those of [`rolling_model`](Wheel::rolling_model).
    pub fn forces(&self) -> Result<CycleForces, KingpinError> {
        let model = self.wheel().rolling_model(&[])?;
        let forces = model.forces(&model.free_state(&self.states()), &[]);
        let [along, across] = forces.king_pin;
        Ok(CycleForces {
            friction_max: self.contact_force().friction(),
            static_limit: self.wheel().static_limit(),
            king_pin_force_max: along.hypot(across),
            damper_power: 0.0,
        })
    }
}
