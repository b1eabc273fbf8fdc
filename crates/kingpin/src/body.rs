//! The wheel and its caster as the equations of motion see them: masses, stiffnesses and dampers, in the combinations
//! that occur, computed once for all evaluations in which none of them varies.

use crate::arithmetic::Arithmetic;
use crate::parameters::Key;
use crate::wheel::Wheel;

/// What the equations need of the parameters that do not describe the towing. `C` is `f64`, or the scalar of the
/// evaluation where one of these parameters is active.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<C> {
    /// `l` in m.
    pub caster_length: C,
    /// `m = m_c (l - l_c)` in kg m.
    pub static_moment: C,
    /// `M = m_w + m_c + J_wxi/R^2` in kg.
    pub rolling_mass: C,
    /// `1/M`.
    pub inverse_rolling_mass: C,
    /// `J = J_Cz + J_wzeta + m_c (l - l_c)^2` in kg m^2.
    pub yaw_inertia: C,
    /// `1/J`.
    pub inverse_yaw_inertia: C,
    pub longitudinal_stiffness: C,
    pub lateral_stiffness: C,
    pub longitudinal_damping: C,
    pub lateral_damping: C,
    pub rotational_damping: C,
    pub rotational_stiffness: C,
}

impl<C: Arithmetic> Body<C> {
    #[inline(always)]
    pub(crate) fn new(get: impl Fn(Key) -> C) -> Self {
        let arm = get(Key::L) - get(Key::LC);
        let static_moment = get(Key::MC) * arm;
        let wheel_radius = get(Key::WheelRadius);
        let rolling_mass = get(Key::MW) + get(Key::MC) + get(Key::JWxi) / (wheel_radius * wheel_radius);
        let yaw_inertia = get(Key::JCz) + get(Key::JWzeta) + static_moment * arm;
        Self {
            caster_length: get(Key::L),
            static_moment,
            rolling_mass,
            inverse_rolling_mass: C::from(1.0) / rolling_mass,
            yaw_inertia,
            inverse_yaw_inertia: C::from(1.0) / yaw_inertia,
            longitudinal_stiffness: get(Key::KU),
            lateral_stiffness: get(Key::KQ),
            longitudinal_damping: get(Key::CU),
            lateral_damping: get(Key::CQ),
            rotational_damping: get(Key::CPsi),
            rotational_stiffness: get(Key::KPsi),
        }
    }
}

impl Wheel {
    #[inline]
    pub(crate) fn body(&self) -> Body<f64> {
        Body::new(|key| self.get(key))
    }
}
