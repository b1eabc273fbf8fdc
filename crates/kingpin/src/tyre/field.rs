//! A wheel with a tyre as a vector field over its free states.

use super::equations::{Kind, KingPin, Motion, TyreBody};
use super::law::Piece;
use crate::active::ActiveParameters;
use crate::contact::ContactForce;
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::wheel::{HALF_LENGTHS_PER_TRAIL, Wheel};
use arclength::cycle::Orbit;
use arclength::{Dual, Scalar, Threshold, VectorField};
use std::ops::Mul;

/// Names of the states: longitudinal and lateral displacement of the king pin in m, caster angle in rad, forward and lateral speed of
/// the wheel centre in m/s, absolute yaw rate of the caster in rad/s, lateral deflection of the leading contact point in m.
pub const TYRE_STATE_NAMES: [&str; 7] = ["u", "q", "psi", "V1", "V2", "Omega", "y_t"];

/// A wheel with a tyre, some of its parameters active: a vector field over the states that its king pin leaves free.
///
/// It is meant for `V1 > 0`; a motion that reaches `V1 = 0` ends there.
#[derive(Clone, Debug)]
pub struct TyreWheel {
    active: ActiveParameters,
    kind: Kind,
    /// What no active parameter changes.
    fixed: Option<TyreBody<f64>>,
}

impl Wheel {
    pub(super) fn tyre_kind(&self) -> Kind {
        Kind { tyre: self.tyre(), king_pin: KingPin::of(self.get(Key::KU), self.get(Key::KQ)) }
    }

    /// The names of the free states of a wheel with a tyre.
    pub(crate) fn tyre_free_states(&self) -> &'static [&'static str] {
        match self.tyre_kind().king_pin {
            KingPin::Elastic => &TYRE_STATE_NAMES,
            KingPin::Lateral => &["q", "psi", "V2", "Omega", "y_t"],
            KingPin::Longitudinal => &["u", "psi", "V1", "Omega", "y_t"],
            KingPin::Rigid => &["psi", "Omega", "y_t"],
        }
    }

    /// The force of the ground on a wheel with a tyre at a state `(u, q, psi, V1, V2, Omega, y_t)`; that along the caster turns the
    /// wheel about its axle.
    pub(crate) fn tyre_contact_force(&self, state: &[f64; 7]) -> ContactForce {
        self.tyre_contact_force_under(0.0, state)
    }

    /// The same under a moment of dry friction about the king pin in N m.
    pub(crate) fn tyre_contact_force_under(&self, friction_moment: f64, state: &[f64; 7]) -> ContactForce {
        let towing = (self.get(Key::V), self.towing_yaw_rate());
        let body = TyreBody::new(|key| self.get(key));
        let motion = self.tyre_kind().motion(&body, towing, None, friction_moment, state);
        let radius = self.get(Key::WheelRadius);
        let normal = self.normal_force();
        ContactForce {
            longitudinal: -self.get(Key::JWxi) / (radius * radius) * motion.rates[3],
            lateral: motion.lateral_force,
            normal,
            limit: self.get(Key::MuS) * normal,
        }
    }

    /// The wheel with its tyre as a vector field in which the given keys are the parameters, in this order.
    ///
    /// ```
    /// use arclength::VectorField;
    /// use kingpin::Wheel;
    /// let wheel = Wheel::from_toml("tyre = \"linear\"\nsigma = 0.05\nC_alpha = 500.0\nk = inf")?;
    /// assert_eq!(wheel.with_tyre(&[])?.state_names(), ["psi", "Omega", "y_t"]);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// [`NeedsTyre`](KingpinError::NeedsTyre) for a rigid wheel, those of [`check_tyre`](Self::check_tyre),
    /// [`NoLongitudinalMotion`](KingpinError::NoLongitudinalMotion) and [`NoLateralMotion`](KingpinError::NoLateralMotion) for keys of
    /// the king pin in a direction in which it is rigid, and those of [`rolling`](Self::rolling).
    pub fn with_tyre(&self, active: &[Key]) -> Result<TyreWheel, KingpinError> {
        if self.tyre() == Tyre::Rigid {
            return Err(KingpinError::NeedsTyre);
        }
        self.check_tyre()?;
        let of_the_king_pin = |stiffness: Key, damping: Key| {
            let varies = [Key::K, stiffness, damping];
            let rigid = self.get(stiffness).is_infinite();
            active.iter().copied().find(|key| rigid && varies.contains(key))
        };
        if let Some(key) = of_the_king_pin(Key::KU, Key::CU) {
            return Err(KingpinError::NoLongitudinalMotion { key });
        }
        if let Some(key) = of_the_king_pin(Key::KQ, Key::CQ) {
            return Err(KingpinError::NoLateralMotion { key });
        }
        let active = ActiveParameters::new(self, active)?;
        let fixed = active.change_only_the_towing().then(|| TyreBody::new(|key| self.get(key)));
        Ok(TyreWheel { kind: self.tyre_kind(), fixed, active })
    }
}

impl TyreWheel {
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

    /// The smallest forward speed of the wheel on a cycle, as a part of the towing speed.
    pub(crate) fn smallest_speed_ratio(&self, orbit: &Orbit, parameters: &[f64]) -> f64 {
        let constants: Vec<Dual<f64, 1>> = parameters.iter().map(|&value| Dual::constant(value)).collect();
        let [slowest, _] = orbit.range_of(|state| self.full_state(state, &constants)[3]);
        slowest / self.active.towing(parameters).0
    }

    /// The forward speed of the wheel at a state, as a part of the towing speed.
    pub(crate) fn speed_ratio(&self, free: &[f64], parameters: &[f64]) -> f64 {
        self.full_state(free, parameters)[3] / self.active.towing(parameters).0
    }

    /// Indices of the free states among [`TYRE_STATE_NAMES`].
    pub(crate) fn free(&self) -> &'static [usize] {
        self.kind.king_pin.free()
    }

    /// All seven states, in the order of [`TYRE_STATE_NAMES`], at a state of the vector field.
    pub fn full_state<T: Scalar>(&self, free: &[T], parameters: &[T]) -> [T; 7] {
        let towing = self.active.towing(parameters);
        match &self.fixed {
            Some(body) => self.kind.full_state(body, towing, free),
            None => self.kind.full_state(&self.body(parameters), towing, free),
        }
    }

    /// The rates of all seven states and the lateral force of the ground at a state of the vector field, under a moment of dry friction
    /// about the king pin.
    pub(crate) fn rates_and_lateral_force<T: Scalar>(
        &self,
        free: &[T],
        parameters: &[T],
        friction_moment: T,
    ) -> ([T; 7], T) {
        let motion = self.motion(free, parameters, friction_moment);
        (motion.rates, motion.lateral_force)
    }

    /// The rates of all seven states and the forces at a state of the vector field, whose parameters may be followed by the cells of
    /// its switch functions.
    #[inline(always)]
    fn motion<T: Scalar>(&self, free: &[T], parameters: &[T], friction_moment: T) -> Motion<T> {
        let towing = self.active.towing(parameters);
        let piece = match parameters.get(self.active.keys().len()..) {
            Some(&[sign, held, ..]) => Some(Piece { sign, holds: held.value() > 0.0 }),
            _ => None,
        };
        match &self.fixed {
            Some(body) => self.motion_of(body, towing, piece, friction_moment, free),
            None => self.motion_of(&self.body(parameters), towing, piece, friction_moment, free),
        }
    }

    #[inline(always)]
    fn motion_of<T, C>(
        &self,
        body: &TyreBody<C>,
        towing: (T, T),
        piece: Option<Piece<T>>,
        friction_moment: T,
        free: &[T],
    ) -> Motion<T>
    where
        T: Scalar + Mul<C, Output = T>,
        C: Copy,
    {
        let state = self.kind.full_state(body, towing, free);
        self.kind.motion(body, towing, piece, friction_moment, &state)
    }

    fn body<T: Scalar>(&self, parameters: &[T]) -> TyreBody<T> {
        let value = |key| self.active.value(key, parameters);
        TyreBody::new(|key| match key {
            Key::TP if self.wheel().pneumatic_trail_follows() && !self.active().contains(&key) => {
                value(Key::HalfContactLength) / HALF_LENGTHS_PER_TRAIL
            }
            _ => value(key),
        })
    }
}

impl VectorField for TyreWheel {
    fn state_names(&self) -> Vec<String> {
        self.free().iter().map(|&index| TYRE_STATE_NAMES[index].to_owned()).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.active.names()
    }

    fn dimension(&self) -> usize {
        self.free().len()
    }

    /// Those of the brush law, whose curvature jumps where there is no slip and where the last bristle begins to slide.
    fn thresholds(&self) -> Vec<Threshold> {
        match self.kind.tyre {
            Tyre::Brush => vec![Threshold::Zero; 2],
            _ => Vec::new(),
        }
    }

    #[inline]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let motion = self.motion(state, parameters, T::zero());
        let (rates, switches) = derivative.split_at_mut(self.free().len());
        for (rate, &index) in rates.iter_mut().zip(self.free()) {
            *rate = motion.rates[index];
        }
        for (switch, value) in switches.iter_mut().zip(motion.switches) {
            *switch = value;
        }
    }
}
