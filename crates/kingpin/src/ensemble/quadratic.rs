//! The rolling wheel in quadratic form.
//!
//! With the spring deflection in the body frame, `a = u cos psi - q sin psi` and `b = u sin psi + q cos psi`, and with
//! `C = cos psi`, `S = sin psi` as states, the equations of motion have no trigonometric function and six products:
//!
//! ```text
//! a'   = V - v C + Omega b           C'   = -S W
//! b'   = l Omega - v S - Omega a     S'   =  C W
//! psi' = W = omega - Omega
//! M V'     =  m Omega^2 - k a - c (V - v C + omega b)
//! J Omega' = -m V Omega - k l b - c l (l Omega - v S - omega a) + c_psi W + k_psi psi
//! ```
//!
//! Stiffness and damping must be the same in both directions, `k_u = k_q = k` and `c_u = c_q = c`.

use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;

/// Number of states: a, b, C, S, psi, V, Omega.
pub(super) const STATES: usize = 7;
/// Indices of the states.
pub(super) const A: usize = 0;
pub(super) const B: usize = 1;
pub(super) const COSINE: usize = 2;
pub(super) const SINE: usize = 3;
pub(super) const PSI: usize = 4;
pub(super) const SPEED: usize = 5;
pub(super) const YAW: usize = 6;

/// Coefficients of the equations in quadratic form.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadraticWheel {
    pub towing_speed: f64,
    pub towing_yaw_rate: f64,
    pub caster_length: f64,
    /// `m/M`.
    pub centrifugal: f64,
    /// `k/M`.
    pub stiffness: f64,
    /// `c/M`.
    pub damping: f64,
    /// `m/J`.
    pub yaw_coupling: f64,
    /// `k l/J`.
    pub yaw_stiffness: f64,
    /// `c l/J`.
    pub yaw_damping: f64,
    /// `c_psi/J`.
    pub rotational_damping: f64,
    /// `k_psi/J`.
    pub rotational_stiffness: f64,
    /// Size of one unit of each state, as a speed in m/s at the wheel.
    pub weights: [f64; STATES],
}

impl QuadraticWheel {
    pub(super) fn new(wheel: &Wheel) -> Result<Self, SimulationError> {
        let (k_u, k_q) = (wheel.get(Key::KU), wheel.get(Key::KQ));
        if k_u != k_q {
            return Err(SimulationError::out_of_range("k_u", k_u, "equal to k_q for an ensemble"));
        }
        let (c_u, c_q) = (wheel.get(Key::CU), wheel.get(Key::CQ));
        if c_u != c_q {
            return Err(SimulationError::out_of_range("c_u", c_u, "equal to c_q for an ensemble"));
        }
        let body = wheel.body();
        let (per_mass, per_inertia) = (body.inverse_rolling_mass, body.inverse_yaw_inertia);
        let length = body.caster_length;
        let frequency = (k_q * per_mass).sqrt();
        let speed = wheel.get(Key::V).max(frequency * length);
        Ok(Self {
            towing_speed: wheel.get(Key::V),
            towing_yaw_rate: wheel.towing_yaw_rate(),
            caster_length: length,
            centrifugal: body.static_moment * per_mass,
            stiffness: k_q * per_mass,
            damping: c_q * per_mass,
            yaw_coupling: body.static_moment * per_inertia,
            yaw_stiffness: k_q * length * per_inertia,
            yaw_damping: c_q * length * per_inertia,
            rotational_damping: body.rotational_damping * per_inertia,
            rotational_stiffness: body.rotational_stiffness * per_inertia,
            weights: [frequency, frequency, speed, speed, speed, 1.0, length],
        })
    }

    /// From the states `(u, q, psi, V, Omega)`.
    pub(super) fn state([u, q, psi, speed, yaw]: [f64; 5]) -> [f64; STATES] {
        let (sine, cosine) = psi.sin_cos();
        [u * cosine - q * sine, u * sine + q * cosine, cosine, sine, psi, speed, yaw]
    }

    /// Back to the states `(u, q, psi, V, Omega)`.
    pub(super) fn rolling_state([a, b, _, _, psi, speed, yaw]: [f64; STATES]) -> [f64; 5] {
        let (sine, cosine) = psi.sin_cos();
        [a * cosine + b * sine, b * cosine - a * sine, psi, speed, yaw]
    }
}
