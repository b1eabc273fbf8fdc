//! The parameters along which branches and curves of the wheel are followed.

use crate::axis_label;
use arclength_analysis::{Interval, VaryingParameter};
use kingpin::branches::Along;
use kingpin::{Key, KingpinError};

/// The interval of a parameter of the wheel; `r` may end at infinity.
///
/// # Errors
/// An unknown key, or ends that the parameter may not take.
pub(crate) fn along(interval: &Interval) -> Result<Along, KingpinError> {
    Along::new(interval.key.parse()?, interval.start, interval.end)
}

/// The parameter and its interval, in results.
pub(crate) fn varying(along: &Along) -> VaryingParameter {
    let (start, end) = along.ends();
    let (key, unit) = (along.key().name().to_owned(), along.key().unit().to_owned());
    VaryingParameter { key, unit: Some(unit), start, end }
}

/// Where a value is drawn: an `r` that reaches infinity is drawn as a curvature.
pub(crate) fn drawn_as(along: &Along) -> (Key, fn(f64) -> f64) {
    if along.key() == Key::TurningRadius && along.ends().1.is_infinite() {
        (Key::Curvature, f64::recip)
    } else {
        (along.key(), |value| value)
    }
}

/// Two parameters of the wheel and their intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPlane(pub [Along; 2]);

impl ParameterPlane {
    /// The plane of two parameters in a result.
    ///
    /// # Errors
    /// An unknown key, or ends that a parameter may not take.
    pub fn of([one, two]: &[VaryingParameter; 2]) -> Result<Self, KingpinError> {
        let axis = |VaryingParameter { key, start, end, .. }: &VaryingParameter| {
            along(&Interval::new(key, *start, *end))
        };
        Ok(Self([axis(one)?, axis(two)?]))
    }

    /// The keys of both.
    pub fn keys(&self) -> [Key; 2] {
        self.0.map(|along| along.key())
    }

    /// The labels of both axes of a picture.
    pub fn labels(&self) -> [String; 2] {
        self.0.map(|along| axis_label::of(drawn_as(&along).0))
    }

    /// How values are drawn on both axes.
    pub fn scales(&self) -> [fn(f64) -> f64; 2] {
        self.0.map(|along| drawn_as(&along).1)
    }

    /// The parameters and their intervals, in results.
    pub fn varying(&self) -> [VaryingParameter; 2] {
        [varying(&self.0[0]), varying(&self.0[1])]
    }
}
