//! The plane of two parameters, in which charts are computed and boundaries traced.

use crate::error::KingpinError;
use crate::parameters::Key;
use std::ops::RangeInclusive;

/// A parameter with the interval in which it varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    key: Key,
    start: f64,
    end: f64,
}

impl Axis {
    /// A parameter with its interval; both ends must be finite and allowed.
    ///
    /// # Errors
    /// [`OutOfRange`](KingpinError::OutOfRange), [`InfiniteRadius`](KingpinError::InfiniteRadius),
    /// [`InfiniteEnd`](KingpinError::InfiniteEnd) and [`EmptyInterval`](KingpinError::EmptyInterval).
    pub fn new(key: Key, interval: RangeInclusive<f64>) -> Result<Self, KingpinError> {
        let (start, end) = interval.into_inner();
        for value in [start, end] {
            if key == Key::TurningRadius && value == f64::INFINITY {
                return Err(KingpinError::InfiniteRadius);
            }
            if !key.allowed().contains(value) {
                return Err(KingpinError::OutOfRange { key, value, position: None });
            }
            if value.is_infinite() {
                return Err(KingpinError::InfiniteEnd { key });
            }
        }
        if start < end {
            Ok(Self { key, start, end })
        } else {
            Err(KingpinError::EmptyInterval { key, start, end })
        }
    }

    /// The parameter.
    pub fn key(&self) -> Key {
        self.key
    }
    /// Start of the interval.
    pub fn start(&self) -> f64 {
        self.start
    }
    /// End of the interval.
    pub fn end(&self) -> f64 {
        self.end
    }
    /// The value at a part of the way from start to end; exact at both.
    #[inline]
    pub fn at(&self, part: f64) -> f64 {
        if part < 1.0 { self.start + part * (self.end - self.start) } else { self.end }
    }
    /// Equidistant values from start to end, for a count of at least two.
    pub fn values(&self, count: usize) -> Vec<f64> {
        (0..count).map(|index| self.at(index as f64 / (count - 1) as f64)).collect()
    }
}

/// The plane of two parameters.
///
/// ```
/// use kingpin::{Axis, Key, Plane};
/// let plane = Plane::new(Axis::new(Key::V, 0.0..=10.0)?, Axis::new(Key::L, 0.02..=0.2)?)?;
/// assert_eq!(plane.x().values(3), [0.0, 5.0, 10.0]);
/// assert!(Plane::new(Axis::new(Key::K, 1.0..=2.0)?, Axis::new(Key::KU, 1.0..=2.0)?).is_err());
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    x: Axis,
    y: Axis,
}

impl Plane {
    /// The plane of two parameters that do not set each other.
    ///
    /// # Errors
    /// [`DependentKeys`](KingpinError::DependentKeys).
    pub fn new(x: Axis, y: Axis) -> Result<Self, KingpinError> {
        Key::check_independent(&[x.key, y.key])?;
        Ok(Self { x, y })
    }

    /// The parameter along x.
    pub fn x(&self) -> &Axis {
        &self.x
    }
    /// The parameter along y.
    pub fn y(&self) -> &Axis {
        &self.y
    }
}
