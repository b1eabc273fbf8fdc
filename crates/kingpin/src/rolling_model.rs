//! Which states a rolling wheel has.
//!
//! With longitudinal elasticity there are five, `(u, q, psi, V, Omega)`. With lateral elasticity only, `k_u = inf`, three
//! of them are left, `(q, psi, Omega)`, for `u = 0` and `V` follows from the others. [`Wheel::rolling_model`] is the vector
//! field of the one or the other; results are given in all five states either way.

use crate::error::KingpinError;
use crate::lateral::{LATERAL_STATE_NAMES, LateralWheel};
use crate::parameters::Key;
use crate::rolling::{RollingWheel, STATE_NAMES};
use crate::wheel::Wheel;
use arclength::cycle::Orbit;
use arclength::{Dual, Scalar, VectorField};

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
}

impl Wheel {
    /// Whether the wheel has lateral elasticity only, `k_u = inf`.
    #[inline]
    pub fn has_lateral_elasticity_only(&self) -> bool {
        self.get(Key::KU).is_infinite()
    }

    /// That the wheel has longitudinal elasticity too.
    pub(crate) fn check_elastic(&self) -> Result<(), KingpinError> {
        if self.has_lateral_elasticity_only() { Err(KingpinError::LateralElasticityOnly) } else { Ok(()) }
    }

    /// Names of the states that the rolling wheel can take independently of each other.
    pub fn free_states(&self) -> &'static [&'static str] {
        if self.has_lateral_elasticity_only() { &LATERAL_STATE_NAMES } else { &STATE_NAMES }
    }

    /// The rolling wheel as a vector field in which the given keys are the parameters, in this order.
    ///
    /// ```
    /// use arclength::VectorField;
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::from_toml("k_u = inf")?;
    /// let model = wheel.rolling_model(&[Key::V])?;
    /// let uniform = wheel.uniform_motion()?.state();
    /// let free = model.free_state(&uniform);
    /// assert_eq!(free.len(), 3);
    /// assert_eq!(model.full_state(&free, &[4.0]), uniform);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`rolling`](Self::rolling) and [`lateral`](Self::lateral) for keys that cannot vary.
    pub fn rolling_model(&self, active: &[Key]) -> Result<RollingModel, KingpinError> {
        if self.has_lateral_elasticity_only() {
            Ok(RollingModel::Lateral(self.lateral(active)?))
        } else {
            Ok(RollingModel::Elastic(self.rolling(active)?))
        }
    }
}

impl RollingModel {
    /// The state of the vector field at the states `(u, q, psi, V, Omega)`: those of them that are free.
    pub fn free_state(&self, &[u, q, psi, forward_speed, yaw_rate]: &[f64; 5]) -> Vec<f64> {
        match self {
            Self::Elastic(_) => vec![u, q, psi, forward_speed, yaw_rate],
            Self::Lateral(_) => vec![q, psi, yaw_rate],
        }
    }

    /// The states `(u, q, psi, V, Omega)` at a state of the vector field, which must have its dimension.
    pub fn full_state(&self, free: &[f64], parameters: &[f64]) -> [f64; 5] {
        match self {
            Self::Elastic(_) => std::array::from_fn(|index| free[index]),
            Self::Lateral(lateral) => {
                [0.0, free[0], free[1], lateral.forward_speed_at(free, parameters), free[2]]
            }
        }
    }

    /// Gives the extrema of a cycle of this vector field in the states `(u, q, psi, V, Omega)`. Those of a `V` that follows
    /// from the other states are its extrema along their interpolating polynomials; where the cycle comes near
    /// `psi = pi/2` these do not determine it, and it is not a number.
    pub(crate) fn complete_extrema(
        &self,
        orbit: &Orbit,
        largest: &mut Vec<f64>,
        smallest: &mut Vec<f64>,
        parameters: &[f64],
    ) {
        let Self::Lateral(lateral) = self else { return };
        let parameters: Vec<Dual<f64, 1>> = parameters.iter().map(|&value| Dual::constant(value)).collect();
        let [lowest, highest] = orbit.range_of(|state| state[1].cos());
        let [slowest, fastest] = if lowest < SMALLEST_COSINE && highest > -SMALLEST_COSINE {
            [f64::NAN; 2]
        } else {
            orbit.range_of(|state| lateral.forward_speed_at(state, &parameters))
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
        }
    }

    fn parameter_names(&self) -> Vec<String> {
        match self {
            Self::Elastic(wheel) => wheel.parameter_names(),
            Self::Lateral(wheel) => wheel.parameter_names(),
        }
    }

    fn dimension(&self) -> usize {
        match self {
            Self::Elastic(wheel) => wheel.dimension(),
            Self::Lateral(wheel) => wheel.dimension(),
        }
    }

    #[inline]
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        match self {
            Self::Elastic(wheel) => wheel.evaluate(state, parameters, derivative),
            Self::Lateral(wheel) => wheel.evaluate(state, parameters, derivative),
        }
    }
}
