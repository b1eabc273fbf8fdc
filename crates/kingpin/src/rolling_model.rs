//! Which states a rolling wheel has.
//!
//! With longitudinal elasticity there are five, `(u, q, psi, V, Omega)`. With lateral elasticity only, `k_u = inf`, three
//! of them are left, `(q, psi, Omega)`, for `u = 0` and `V` follows from the others. With a tyre there are seven, or as many as
//! the king pin leaves free ([`TyreWheel`]). [`Wheel::rolling_model`] is the vector field of the one or the other; results are
//! given in all five or seven states either way.

use crate::error::KingpinError;
use crate::lateral::{LATERAL_STATE_NAMES, LateralWheel};
use crate::parameters::{Key, Tyre};
use crate::rolling::{RollingWheel, STATE_NAMES};
use crate::tyre::{Onset, TYRE_STATE_NAMES, TyreWheel};
use crate::wheel::Wheel;
use arclength::cycle::Orbit;
use arclength::equilibrium::HopfPoint;
use arclength::{Dual, ErasedField, Scalar, Threshold, VectorField};

/// Where the caster of a wheel with lateral elasticity only comes nearer than this to `psi = pi/2`, the errors of the other
/// states, divided by it, are too large for a `V` that follows from them.
const SMALLEST_COSINE: f64 = 0.01;

/// A rolling wheel, some of its parameters active, as a vector field over the states that it has.
#[derive(Clone, Debug)]
pub enum RollingModel {
    /// With longitudinal and lateral elasticity: five states.
    Elastic(RollingWheel),
    /// With lateral elasticity only: three states.
    Lateral(LateralWheel),
    /// With a tyre: seven states, or as many as the king pin leaves free.
    Tyre(TyreWheel),
}

impl Wheel {
    /// Whether the wheel has lateral elasticity only, `k_u = inf`.
    #[inline]
    pub fn has_lateral_elasticity_only(&self) -> bool {
        self.get(Key::KU).is_infinite()
    }

    /// That the wheel has longitudinal elasticity too, and no tyre.
    pub(crate) fn check_elastic(&self) -> Result<(), KingpinError> {
        self.check_rigid()?;
        if self.has_lateral_elasticity_only() { Err(KingpinError::LateralElasticityOnly) } else { Ok(()) }
    }

    /// Names of all states in which results are given.
    pub fn states(&self) -> &'static [&'static str] {
        if self.tyre() == Tyre::Rigid { &STATE_NAMES } else { &TYRE_STATE_NAMES }
    }

    /// Names of the states that the rolling wheel can take independently of each other.
    pub fn free_states(&self) -> &'static [&'static str] {
        if self.tyre() != Tyre::Rigid {
            return self.tyre_free_states();
        }
        if self.has_lateral_elasticity_only() { &LATERAL_STATE_NAMES } else { &STATE_NAMES }
    }

    /// The rolling wheel as a vector field in which the given keys are the parameters, in this order.
    ///
    /// ```
    /// use arclength::VectorField;
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::from_toml("k_u = inf")?;
    /// let model = wheel.rolling_model(&[Key::V])?;
    /// let uniform = wheel.uniform_motion()?.states();
    /// let free = model.free_state(&uniform);
    /// assert_eq!(free.len(), 3);
    /// assert_eq!(model.full_state(&free, &[4.0]), uniform);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`rolling`](Self::rolling), [`lateral`](Self::lateral) and [`with_tyre`](Self::with_tyre) for keys that cannot vary.
    pub fn rolling_model(&self, active: &[Key]) -> Result<RollingModel, KingpinError> {
        if self.tyre() != Tyre::Rigid {
            return Ok(RollingModel::Tyre(self.with_tyre(active)?));
        }
        if self.has_lateral_elasticity_only() {
            Ok(RollingModel::Lateral(self.lateral(active)?))
        } else {
            Ok(RollingModel::Elastic(self.rolling(active)?))
        }
    }
}

impl RollingModel {
    /// Indices of the free states among [all states](Wheel::states).
    pub(crate) fn free(&self) -> &'static [usize] {
        match self {
            Self::Elastic(_) => &[0, 1, 2, 3, 4],
            Self::Lateral(_) => &[1, 2, 4],
            Self::Tyre(wheel) => wheel.free(),
        }
    }

    /// The state of the vector field at [all states](Wheel::states): those of them that are free.
    ///
    /// # Panics
    /// Where there are fewer states than the wheel has.
    pub fn free_state(&self, full: &[f64]) -> Vec<f64> {
        self.free().iter().map(|&index| full[index]).collect()
    }

    /// The wheel at values of the active keys.
    pub(crate) fn wheel_at(&self, parameters: &[f64]) -> Result<Wheel, KingpinError> {
        match self {
            Self::Elastic(wheel) => wheel.wheel_at(parameters),
            Self::Lateral(wheel) => wheel.wheel_at(parameters),
            Self::Tyre(wheel) => wheel.wheel_at(parameters),
        }
    }

    /// Whether the states along a cycle determine the speed of the wheel: with lateral elasticity only they do not near `psi = pi/2`.
    pub(crate) fn determines_speed(&self, orbit: &Orbit) -> bool {
        if !matches!(self, Self::Lateral(_)) {
            return true;
        }
        let [lowest, highest] = orbit.range_of(|state| state[1].cos());
        lowest >= SMALLEST_COSINE || highest <= -SMALLEST_COSINE
    }

    /// [All states](Wheel::states) at a state of the vector field, which must have its dimension.
    pub fn full_state(&self, free: &[f64], parameters: &[f64]) -> Vec<f64> {
        match self {
            Self::Elastic(_) => free.to_vec(),
            Self::Lateral(lateral) => {
                vec![0.0, free[0], free[1], lateral.forward_speed_at(free, parameters), free[2]]
            }
            Self::Tyre(wheel) => wheel.full_state(free, parameters).into(),
        }
    }

    /// How far a cycle of this vector field is from where the equations cease to hold, [`Wheel::border_of_cycles`].
    pub(crate) fn distance_from_border(&self, orbit: &Orbit, parameters: &[f64]) -> Option<f64> {
        match self {
            Self::Elastic(_) => None,
            Self::Lateral(_) => Some(orbit.range_of(|state| state[1].cos())[0]),
            Self::Tyre(wheel) => Some(wheel.smallest_speed_ratio(orbit, parameters)),
        }
    }

    /// The forward speed of a wheel with a tyre at a state of this vector field, as a part of the towing speed.
    pub(crate) fn speed_ratio(&self, free: &[f64], parameters: &[f64]) -> Option<f64> {
        match self {
            Self::Elastic(_) | Self::Lateral(_) => None,
            Self::Tyre(wheel) => Some(wheel.speed_ratio(free, parameters)),
        }
    }

    /// That the wheel rolls forwards all along a cycle of this vector field, if it has a tyre.
    pub(crate) fn check_forwards(&self, orbit: &Orbit, parameters: &[f64]) -> Result<(), KingpinError> {
        let Self::Tyre(wheel) = self else { return Ok(()) };
        let ratio = wheel.smallest_speed_ratio(orbit, parameters);
        if ratio <= 0.0 { Err(KingpinError::RollsBackwards { ratio }) } else { Ok(()) }
    }

    /// Whether Hopf points have no first Lyapunov coefficient at these parameters: straight, under the brush law of the tyre.
    pub(crate) fn has_no_first_lyapunov(&self, parameters: &[f64]) -> bool {
        match self {
            Self::Elastic(_) | Self::Lateral(_) => false,
            Self::Tyre(wheel) => wheel.is_brush_towed_straight(parameters),
        }
    }

    /// How cycles grow at a Hopf point of this vector field where no first Lyapunov coefficient exists.
    pub(crate) fn onset(&self, point: &HopfPoint) -> Option<Onset> {
        match self {
            Self::Elastic(_) | Self::Lateral(_) => None,
            Self::Tyre(wheel) => wheel.onset(point),
        }
    }

    /// Gives the extrema of a cycle of this vector field in [all states](Wheel::states). Those of states that follow from the others
    /// are their extrema along the interpolating polynomials; where the cycle comes near `psi = pi/2` these do not determine a speed,
    /// and it is not a number.
    pub(crate) fn complete_extrema(
        &self,
        orbit: &Orbit,
        largest: &mut Vec<f64>,
        smallest: &mut Vec<f64>,
        parameters: &[f64],
    ) {
        let parameters: Vec<Dual<f64, 1>> = parameters.iter().map(|&value| Dual::constant(value)).collect();
        let lateral = match self {
            Self::Elastic(_) => return,
            Self::Lateral(lateral) => lateral,
            Self::Tyre(wheel) => {
                let range = |index: usize| match wheel.free().iter().position(|&free| free == index) {
                    Some(position) => [smallest[position], largest[position]],
                    None => orbit.range_of(|state| wheel.full_state(state, &parameters)[index]),
                };
                let ranges: Vec<[f64; 2]> = (0..TYRE_STATE_NAMES.len()).map(range).collect();
                *smallest = ranges.iter().map(|[low, _]| *low).collect();
                *largest = ranges.iter().map(|[_, high]| *high).collect();
                return;
            }
        };
        let [slowest, fastest] = if self.determines_speed(orbit) {
            orbit.range_of(|state| lateral.forward_speed_at(state, &parameters))
        } else {
            [f64::NAN; 2]
        };
        for (extremum, forward_speed) in [(smallest, slowest), (largest, fastest)] {
            *extremum = vec![0.0, extremum[0], extremum[1], forward_speed, extremum[2]];
        }
    }
}

impl VectorField for RollingModel {
    fn state_names(&self) -> Vec<String> {
        match self {
            Self::Elastic(wheel) => wheel.state_names(),
            Self::Lateral(wheel) => wheel.state_names(),
            Self::Tyre(wheel) => wheel.state_names(),
        }
    }

    fn parameter_names(&self) -> Vec<String> {
        match self {
            Self::Elastic(wheel) => wheel.parameter_names(),
            Self::Lateral(wheel) => wheel.parameter_names(),
            Self::Tyre(wheel) => wheel.parameter_names(),
        }
    }

    fn dimension(&self) -> usize {
        match self {
            Self::Elastic(wheel) => wheel.dimension(),
            Self::Lateral(wheel) => wheel.dimension(),
            Self::Tyre(wheel) => wheel.dimension(),
        }
    }

    #[inline]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        match self {
            Self::Elastic(wheel) => wheel.evaluate(state, parameters, derivative),
            Self::Lateral(wheel) => wheel.evaluate(state, parameters, derivative),
            Self::Tyre(wheel) => wheel.evaluate(state, parameters, derivative),
        }
    }

    // Compiled here, once for each scalar, and not in everything that follows a branch.
    #[inline(never)]
    fn erased(&self) -> ErasedField<'_> {
        ErasedField::new(self)
    }

    fn thresholds(&self) -> Vec<Threshold> {
        match self {
            Self::Elastic(wheel) => wheel.thresholds(),
            Self::Lateral(wheel) => wheel.thresholds(),
            Self::Tyre(wheel) => wheel.thresholds(),
        }
    }
}
