//! Which parameters of a wheel a vector field takes as its arguments.
//!
//! Everything that no active parameter changes is computed once, in `f64`, so that derivatives are not carried through it.

use crate::body::Body;
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::Scalar;

/// Parameters that act on the towing or on the ground, not on the body.
const BESIDE_THE_BODY: [Key; 7] =
    [Key::V, Key::TurningRadius, Key::Curvature, Key::G, Key::MuS, Key::MuD, Key::FAz];
/// Those of them that act on the towing.
const OF_THE_TOWING: [Key; 3] = [Key::V, Key::TurningRadius, Key::Curvature];

/// Where the curvature of the towing path comes from.
#[derive(Clone, Copy, Debug)]
enum Path {
    /// It is this number.
    Fixed(f64),
    /// It is the active parameter at this index.
    Curvature(usize),
    /// Its reciprocal is the active parameter at this index.
    Radius(usize),
}

/// A wheel of which some parameters are active.
#[derive(Clone, Debug)]
pub(crate) struct ActiveParameters {
    wheel: Wheel,
    keys: Vec<Key>,
    /// Index of `v` among the active parameters.
    speed: Option<usize>,
    path: Path,
    fixed_body: Option<Body<f64>>,
}

impl ActiveParameters {
    /// # Errors
    /// That these keys cannot vary together, or not from this wheel.
    pub(crate) fn new(wheel: &Wheel, keys: &[Key]) -> Result<Self, KingpinError> {
        Key::check_independent(keys)?;
        if keys.contains(&Key::MF) {
            return Err(KingpinError::DryFrictionVaries);
        }
        wheel.check_varies(keys)?;
        let (longitudinal, lateral) = (wheel.get(Key::KU), wheel.get(Key::KQ));
        if keys.contains(&Key::K) && longitudinal != lateral {
            return Err(KingpinError::AmbiguousStiffness { longitudinal, lateral });
        }
        if keys.contains(&Key::TurningRadius) && wheel.get(Key::TurningRadius).is_infinite() {
            return Err(KingpinError::InfiniteRadius);
        }
        let index = |key: Key| keys.iter().position(|&candidate| candidate == key);
        let path = match (index(Key::Curvature), index(Key::TurningRadius)) {
            (Some(curvature), _) => Path::Curvature(curvature),
            (None, Some(radius)) => Path::Radius(radius),
            (None, None) => Path::Fixed(wheel.get(Key::Curvature)),
        };
        let fixed = keys.iter().all(|key| BESIDE_THE_BODY.contains(key));
        Ok(Self {
            wheel: *wheel,
            keys: keys.to_vec(),
            speed: index(Key::V),
            path,
            fixed_body: fixed.then(|| wheel.body()),
        })
    }

    pub(crate) fn wheel(&self) -> &Wheel {
        &self.wheel
    }

    pub(crate) fn keys(&self) -> &[Key] {
        &self.keys
    }

    pub(crate) fn names(&self) -> Vec<String> {
        self.keys.iter().map(Key::to_string).collect()
    }

    /// The values of the active keys in the wheel.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.keys.iter().map(|&key| self.wheel.get(key)).collect()
    }

    /// The wheel at other values of the active keys.
    pub(crate) fn wheel_at(&self, parameters: &[f64]) -> Result<Wheel, KingpinError> {
        // A solution at the end of what a parameter may be lies beyond it by rounding.
        let nearest = |key: Key, value: f64| key.allowed().nearest(value);
        let pairs = self.keys.iter().zip(parameters);
        pairs.into_iter().try_fold(self.wheel, |wheel, (&key, &value)| wheel.with(key, nearest(key, value)))
    }

    /// Whether the parameter is active or not zero.
    pub(crate) fn matters(&self, key: Key) -> bool {
        self.wheel.get(key) != 0.0 || self.keys.contains(&key)
    }

    /// Towing speed and yaw rate.
    #[inline(always)]
    pub(crate) fn towing<T: Scalar>(&self, parameters: &[T]) -> (T, T) {
        let v = match self.speed {
            Some(index) => parameters[index],
            None => T::from(self.wheel.get(Key::V)),
        };
        let omega = match self.path {
            Path::Fixed(curvature) => v * curvature,
            Path::Curvature(index) => v * parameters[index],
            Path::Radius(index) => v / parameters[index],
        };
        (v, omega)
    }

    /// Whether no active parameter changes anything but the towing.
    pub(crate) fn change_only_the_towing(&self) -> bool {
        self.keys.iter().all(|key| OF_THE_TOWING.contains(key))
    }

    /// The body, where no active parameter changes it.
    #[inline(always)]
    pub(crate) fn fixed_body(&self) -> Option<&Body<f64>> {
        self.fixed_body.as_ref()
    }

    /// A stored parameter at these values of the active ones.
    #[inline]
    pub(crate) fn value<T: Scalar>(&self, key: Key, parameters: &[T]) -> T {
        let sets = |active: &Key| *active == key || active.sets().contains(&key);
        match self.keys.iter().position(sets) {
            Some(index) => parameters[index],
            None => T::from(self.wheel.get(key)),
        }
    }

    /// The body at these values of the active parameters.
    #[inline]
    pub(crate) fn body<T: Scalar>(&self, parameters: &[T]) -> Body<T> {
        Body::new(|key| self.value(key, parameters))
    }
}
