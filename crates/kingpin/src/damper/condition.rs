//! What a damper has to be enough for, and the smallest one.

use crate::branches::Along;
use crate::parameters::Key;
use crate::wheel::Wheel;

/// The smallest damper that is enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallestDamper {
    /// Damping in the unit of the parameter; zero where none is needed.
    pub damping: f64,
    /// The speed in m/s that decides: with a weaker damper the motion is unstable there. `None` where none is needed.
    pub speed: Option<f64>,
    /// The wheel there, with that damper, speed, radius and load. `None` where none is needed.
    pub corner: Option<Wheel>,
}

/// Values of a parameter, a radius or a load for example, at all of which a damper has to be enough.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// All values of an interval.
    Interval(Along),
    /// Each of these values.
    Values(Key, Vec<f64>),
}

impl Condition {
    /// The parameter.
    pub fn key(&self) -> Key {
        match self {
            Self::Interval(along) => along.key(),
            Self::Values(key, _) => *key,
        }
    }

    /// The ends of the interval, or all values.
    pub fn extremes(&self) -> Vec<f64> {
        match self {
            Self::Interval(along) => vec![along.ends().0, along.ends().1],
            Self::Values(_, values) => values.clone(),
        }
    }
}
