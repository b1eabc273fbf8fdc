//! The equations of motion of a wheel with a tyre, over any scalar.
//!
//! With the speed of the king pin across the caster, `P = V2 + l Omega`, the deflection of the tyre and the momentum balances about
//! the king pin are
//!
//! ```text
//! u'   = V1 cos psi + P sin psi - v + omega q
//! q'   = -V1 sin psi + P cos psi - omega u
//! psi' = omega - Omega
//! y_t' = -(V2 + a Omega) - |V1| y_t/sigma
//! M V1'                                  = (m_w + m_c) V2 Omega + m Omega^2 + F1
//! (m_w + m_c) (P' + V1 Omega) - n Omega' = F2 + T2
//! I Omega' - n (P' + V1 Omega)           = -l T2 + M_z - kappa Omega/|V1| - c_psi (Omega - omega) + k_psi psi + M_r
//! ```
//!
//! with `n = (m_w + m_c) l - m`, `I = J + n l - m l`, force `T2` and moment `M_z` of the [law](super::law), and the moment `M_r` of dry
//! friction about the king pin; `F1` and `F2` are the components of the force on the king pin. In a direction in which the king pin is rigid its acceleration is known and the force is not:
//! there the balance is projected on the other direction.

use super::law::{self, Piece, Stiffness};
use crate::parameters::{Key, Tyre};
use arclength::Scalar;
use std::ops::Mul;

/// In which directions the king pin gives way, and so which states are free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KingPin {
    /// In both: seven states.
    Elastic,
    /// Laterally, `k_u = inf`: `q psi V2 Omega y_t`.
    Lateral,
    /// Longitudinally, `k_q = inf`: `u psi V1 Omega y_t`.
    Longitudinal,
    /// In none: `psi Omega y_t`.
    Rigid,
}

impl KingPin {
    /// Whether it gives way along x and along y.
    pub(super) fn of(longitudinal_stiffness: f64, lateral_stiffness: f64) -> Self {
        match (longitudinal_stiffness.is_finite(), lateral_stiffness.is_finite()) {
            (true, true) => Self::Elastic,
            (false, true) => Self::Lateral,
            (true, false) => Self::Longitudinal,
            (false, false) => Self::Rigid,
        }
    }

    /// Indices of the free states among `u q psi V1 V2 Omega y_t`.
    pub(super) const fn free(self) -> &'static [usize] {
        match self {
            Self::Elastic => &[0, 1, 2, 3, 4, 5, 6],
            Self::Lateral => &[1, 2, 4, 5, 6],
            Self::Longitudinal => &[0, 2, 3, 5, 6],
            Self::Rigid => &[2, 5, 6],
        }
    }
}

/// What the equations need of the parameters that do not describe the towing. `C` is `f64`, or the scalar of the evaluation where one
/// of these parameters is active.
#[derive(Clone, Copy, Debug)]
pub(super) struct TyreBody<C> {
    caster_length: C,
    /// `m_w + m_c` in kg.
    mass: C,
    /// `M = m_w + m_c + J_wxi/R^2` in kg.
    rolling_mass: C,
    /// `m = m_c (l - l_c)` in kg m, of the caster about the wheel centre.
    static_moment: C,
    /// `n = m_w l + m_c l_c` in kg m, of all about the king pin.
    moment_about_king_pin: C,
    /// `I = J_Cz + J_wzeta + m_w l^2 + m_c l_c^2` in kg m^2, about the king pin.
    inertia: C,
    longitudinal_stiffness: C,
    lateral_stiffness: C,
    longitudinal_damping: C,
    lateral_damping: C,
    rotational_damping: C,
    rotational_stiffness: C,
    inverse_relaxation: C,
    half_contact_length: C,
    tread_width: C,
    tyre: Stiffness<C>,
}

impl<C: Scalar> TyreBody<C> {
    #[inline(always)]
    pub(super) fn new(get: impl Fn(Key) -> C) -> Self {
        let (m_w, m_c) = (get(Key::MW), get(Key::MC));
        let (l, l_c, radius) = (get(Key::L), get(Key::LC), get(Key::WheelRadius));
        let mass = m_w + m_c;
        let normal = mass * get(Key::G) - get(Key::FAz);
        let cornering = get(Key::CAlpha);
        Self {
            caster_length: l,
            mass,
            rolling_mass: mass + get(Key::JWxi) / (radius * radius),
            static_moment: m_c * (l - l_c),
            moment_about_king_pin: m_w * l + m_c * l_c,
            inertia: get(Key::JCz) + get(Key::JWzeta) + m_w * l * l + m_c * l_c * l_c,
            longitudinal_stiffness: get(Key::KU),
            lateral_stiffness: get(Key::KQ),
            longitudinal_damping: get(Key::CU),
            lateral_damping: get(Key::CQ),
            rotational_damping: get(Key::CPsi),
            rotational_stiffness: get(Key::KPsi),
            inverse_relaxation: get(Key::Sigma).recip(),
            half_contact_length: get(Key::HalfContactLength),
            tread_width: get(Key::Kappa),
            tyre: Stiffness {
                cornering,
                trail: get(Key::TP),
                slip_ratio: cornering / (get(Key::MuS) * normal * 3.0),
            },
        }
    }
}

/// The states and forces of which the rest is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<T> {
    /// Rates of `u q psi V1 V2 Omega y_t`.
    pub rates: [T; 7],
    /// Lateral force of the ground, `T2`.
    pub lateral_force: T,
    /// The slip, and the part of the bristles of a brush that hold, negative where all slide.
    pub switches: [T; 2],
}

/// What a wheel with a tyre is, beside its numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    pub tyre: Tyre,
    pub king_pin: KingPin,
}

impl Kind {
    /// All seven states from the free ones.
    #[inline(always)]
    pub(super) fn full_state<T, C>(self, body: &TyreBody<C>, (v, omega): (T, T), free: &[T]) -> [T; 7]
    where
        T: Scalar + Mul<C, Output = T>,
        C: Copy,
    {
        let zero = T::zero();
        match (self.king_pin, free) {
            (KingPin::Elastic, &[u, q, psi, forward, lateral, yaw_rate, deflection, ..]) => {
                [u, q, psi, forward, lateral, yaw_rate, deflection]
            }
            (KingPin::Lateral, &[q, psi, lateral, yaw_rate, deflection, ..]) => {
                let (sine, cosine) = psi.sin_cos();
                let across = lateral + yaw_rate * body.caster_length;
                let forward = (v - omega * q - across * sine) / cosine;
                [zero, q, psi, forward, lateral, yaw_rate, deflection]
            }
            (KingPin::Longitudinal, &[u, psi, forward, yaw_rate, deflection, ..]) => {
                let (sine, cosine) = psi.sin_cos();
                let across = (omega * u + forward * sine) / cosine;
                let lateral = across - yaw_rate * body.caster_length;
                [u, zero, psi, forward, lateral, yaw_rate, deflection]
            }
            (_, free) => {
                let (psi, yaw_rate, deflection) = (free[0], free[1], free[2]);
                let (sine, cosine) = psi.sin_cos();
                let lateral = v * sine - yaw_rate * body.caster_length;
                [zero, zero, psi, v * cosine, lateral, yaw_rate, deflection]
            }
        }
    }

    /// The equations at all seven states, under a moment of dry friction about the king pin. `piece` is that of the brush law whose field
    /// is asked for, the one in which the state is if there is none.
    #[inline(always)]
    pub(super) fn motion<T, C>(
        self,
        body: &TyreBody<C>,
        (v, omega): (T, T),
        piece: Option<Piece<T>>,
        friction_moment: T,
        &[u, q, psi, forward, lateral, yaw_rate, deflection]: &[T; 7],
    ) -> Motion<T>
    where
        T: Scalar + Mul<C, Output = T>,
        C: Copy,
    {
        let zero = T::zero();
        let (sine, cosine) = psi.sin_cos();
        let across = lateral + yaw_rate * body.caster_length;
        let psi_rate = omega - yaw_rate;
        let rate_x = forward * cosine + across * sine - v + omega * q;
        let rate_y = across * cosine - forward * sine - omega * u;
        let slip = deflection * body.inverse_relaxation;
        let deflection_rate = -(lateral + yaw_rate * body.half_contact_length) - forward.abs() * slip;

        let ([lateral_force, aligning], held) = match self.tyre {
            Tyre::Brush => law::brush(&body.tyre, slip, piece),
            _ => (law::linear(&body.tyre, slip), zero),
        };
        let tread = yaw_rate * body.tread_width / forward.abs();
        let moment = aligning - tread - lateral_force * body.caster_length
            + psi_rate * body.rotational_damping
            + psi * body.rotational_stiffness
            + friction_moment;

        let force_x = -(u * body.longitudinal_stiffness + rate_x * body.longitudinal_damping);
        let force_y = -(q * body.lateral_stiffness + rate_y * body.lateral_damping);
        let moved = yaw_rate * body.static_moment * yaw_rate + lateral * yaw_rate * body.mass;
        let centripetal = omega * forward;
        let n = body.moment_about_king_pin;

        let (u_rate, q_rate, forward_acceleration, across_acceleration, yaw_acceleration);
        match self.king_pin {
            KingPin::Elastic => {
                (u_rate, q_rate) = (rate_x, rate_y);
                let along = force_x * cosine - force_y * sine;
                let right = force_x * sine + force_y * cosine + lateral_force;
                let determinant = T::one() * body.mass * body.inertia - T::one() * n * n;
                forward_acceleration = (moved + along) / (T::one() * body.rolling_mass);
                // P' + V1 Omega, less V1 omega.
                across_acceleration = (right * body.inertia + moment * n) / determinant - centripetal;
                yaw_acceleration = (right * n + moment * body.mass) / determinant;
            }
            KingPin::Rigid => {
                (u_rate, q_rate) = (zero, zero);
                forward_acceleration = -(psi_rate * across);
                across_acceleration = zero;
                yaw_acceleration = (centripetal * n + moment) / (T::one() * body.inertia);
            }
            KingPin::Lateral | KingPin::Longitudinal => {
                // The direction that is free, and the known acceleration in the other one, along and across the caster.
                let (force, free, known) = if self.king_pin == KingPin::Lateral {
                    (u_rate, q_rate) = (zero, rate_y);
                    let acceleration = -(omega * rate_y);
                    (force_y, [-sine, cosine], [acceleration * cosine, acceleration * sine])
                } else {
                    (u_rate, q_rate) = (rate_x, zero);
                    let acceleration = omega * rate_x;
                    (force_x, [cosine, sine], [-(acceleration * sine), acceleration * cosine])
                };
                let turning = known[0] - psi_rate * across;
                let pulled = turning * body.rolling_mass - moved;
                let pushed = (known[1] + centripetal) * body.mass - lateral_force;
                let right = force - free[0] * pulled - free[1] * pushed;
                let inertial = (known[1] + centripetal) * n + moment;
                let mass = free[0] * free[0] * body.rolling_mass + free[1] * free[1] * body.mass;
                let coupling = free[1] * n;
                let determinant = mass * body.inertia - coupling * coupling;
                let acceleration = (right * body.inertia + coupling * inertial) / determinant;
                yaw_acceleration = (mass * inertial + coupling * right) / determinant;
                forward_acceleration = free[0] * acceleration + turning;
                across_acceleration = free[1] * acceleration + known[1];
            }
        }
        // P' is `across_acceleration` less the turning of the frame, psi' V1.
        let lateral_acceleration =
            across_acceleration + psi_rate * forward - yaw_acceleration * body.caster_length;
        Motion {
            rates: [
                u_rate,
                q_rate,
                psi_rate,
                forward_acceleration,
                lateral_acceleration,
                yaw_acceleration,
                deflection_rate,
            ],
            lateral_force,
            switches: [slip, held],
        }
    }
}
