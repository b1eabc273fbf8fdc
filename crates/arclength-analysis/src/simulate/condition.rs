//! The condition of an event at a state: on which side of zero it is, and to which side it moves.

/// What is lost by rounding and by the resolution of time.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A condition at a state, and how it changes along the motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    pub value: f64,
    pub rate: f64,
    /// What of the value and of the rate may be rounding.
    pub value_noise: f64,
    pub rate_noise: f64,
}

impl Condition {
    /// The side on which it is, 0 if that is lost in rounding.
    pub(super) fn side(self) -> f64 {
        beyond(self.value, self.value_noise)
    }

    /// The side to which it moves.
    pub(super) fn course(self) -> f64 {
        beyond(self.rate, self.rate_noise)
    }

    /// The side from which it has come.
    pub(super) fn origin(self, known: f64) -> f64 {
        [self.side(), -self.course()].into_iter().find(|side| *side != 0.0).unwrap_or(known)
    }
}

/// The sign of a value, 0 if it is noise.
fn beyond(value: f64, noise: f64) -> f64 {
    if value.abs() > ROUNDING * noise { value.signum() } else { 0.0 }
}
