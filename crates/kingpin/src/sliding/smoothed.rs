//! Smoothed friction: the wheel that slides as a smooth vector field, for methods that need one.
//!
//! The friction force is `T = -mu_d N s/sqrt(|s|^2 + s_0^2)` with a *smoothing speed* `s_0`. At slip speeds well above `s_0` it is Coulomb's;
//! below, the wheel that should roll creeps at a speed of the order of `s_0`. As `s_0` goes to zero motions tend to those of the
//! hybrid model with `mu_s = mu_d`; a static friction above the sliding one has no counterpart here. The error is of the order
//! `s_0^(4/5)`: slip begins gently, `|s| ~ t^2`, so that smoothing, which changes the friction by `s_0^2/|s|^2` of itself, matters for a time
//! `t ~ s_0^(2/5)` in which `|s|` reaches `s_0^(4/5)`. Where slip vanishes the error is of first order. The field is stiff: while the wheel creeps its fastest rate is about `mu_d N (1/(m_w + m_c) + R^2/J_wxi)/s_0`.

use super::SLIDING_STATE_NAMES;
use super::model::{Equations, S1, slip_squared};
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::{Scalar, VectorField};

/// The wheel with smoothed friction and some of its parameters active: a vector field over the states
/// [`SLIDING_STATE_NAMES`].
#[derive(Clone, Debug)]
pub struct SmoothedSlidingWheel {
    wheel: Wheel,
    active: Vec<Key>,
    smoothing_speed: f64,
}

impl Wheel {
    /// The wheel with friction smoothed over slip speeds of about `smoothing_speed` in m/s, as a vector field in which
    /// the given keys are the parameters, in this order.
    ///
    /// # Errors
    /// A smoothing speed that is not positive, what [`Wheel::sliding`] refuses, and keys that cannot vary (see [`Wheel::rolling`]).
    ///
    /// ```
    /// use arclength::VectorField;
    /// use kingpin::{Key, Wheel};
    ///
    /// let smoothed = Wheel::default().smoothed_sliding(&[Key::V], 1e-3)?;
    /// let mut rate = [0.0; 7];
    /// smoothed.evaluate(&[0.0, 0.0, 0.1, 4.0, 0.2, 0.0, 4.0], &[4.0], &mut rate);
    /// assert!(rate.iter().all(|x| x.is_finite()));
    /// # Ok::<(), kingpin::simulation::SimulationError>(())
    /// ```
    pub fn smoothed_sliding(
        &self,
        active: &[Key],
        smoothing_speed: f64,
    ) -> Result<SmoothedSlidingWheel, SimulationError> {
        if !(smoothing_speed > 0.0 && smoothing_speed.is_finite()) {
            let allowed = "positive and finite, in m/s";
            return Err(SimulationError::out_of_range("smoothing_speed", smoothing_speed, allowed));
        }
        self.check_without_dry_friction(
            "smoothed sliding",
            "set M_f = 0: smoothed, friction about the king pin would act as a damper at rest",
        )?;
        self.rolling(active)?;
        Equations::new(self)?;
        Ok(SmoothedSlidingWheel { wheel: *self, active: active.to_vec(), smoothing_speed })
    }
}

impl SmoothedSlidingWheel {
    /// The wheel with the values that it was made with.
    pub fn wheel(&self) -> &Wheel {
        &self.wheel
    }

    /// The smoothing speed in m/s.
    pub fn smoothing_speed(&self) -> f64 {
        self.smoothing_speed
    }

    /// The values of the active keys in [`wheel`](Self::wheel): the parameters to start from.
    pub fn parameters(&self) -> Vec<f64> {
        self.active.iter().map(|&key| self.wheel.get(key)).collect()
    }

    /// The wheel at other values of the active keys.
    ///
    /// # Errors
    /// [`OutOfRange`](KingpinError::OutOfRange).
    pub fn wheel_at(&self, parameters: &[f64]) -> Result<Wheel, KingpinError> {
        let pairs = self.active.iter().zip(parameters);
        pairs.into_iter().try_fold(self.wheel, |wheel, (&key, &value)| wheel.with(key, value))
    }

    fn equations<T: Scalar>(&self, parameters: &[T]) -> Equations<T> {
        let index = |wanted: &dyn Fn(Key) -> bool| self.active.iter().position(|&key| wanted(key));
        Equations::with(|key| {
            let follows = key == Key::MuD && self.wheel.sliding_friction_follows_static();
            let sets = |active: Key| {
                active == key || active.sets().contains(&key) || (follows && active == Key::MuS)
            };
            match (index(&sets), index(&|active| active == Key::TurningRadius)) {
                (Some(index), _) => parameters[index],
                (None, Some(radius)) if key == Key::Curvature => parameters[radius].recip(),
                _ => T::from(self.wheel.get(key)),
            }
        })
    }
}

impl VectorField for SmoothedSlidingWheel {
    fn state_names(&self) -> Vec<String> {
        SLIDING_STATE_NAMES.iter().map(|&name| name.to_owned()).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.active.iter().map(Key::to_string).collect()
    }

    fn dimension(&self) -> usize {
        SLIDING_STATE_NAMES.len()
    }

    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let equations = self.equations(parameters);
        // Inside, the longitudinal slip takes the place of the rim speed.
        let mut slipping: [T; 7] = std::array::from_fn(|i| state[i]);
        slipping[S1] = state[3] - state[S1];
        let speed = (slip_squared(&slipping) + self.smoothing_speed * self.smoothing_speed).sqrt();
        let factor = -equations.sliding_friction / speed;
        let friction = [factor * slipping[S1], factor * slipping[4]];
        equations.derivative(&slipping, friction, derivative);
        derivative[S1] = derivative[3] - derivative[S1];
    }
}
