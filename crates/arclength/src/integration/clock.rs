//! The clock of an integration: motions of systems that do not contain the time turn, where they are nearly singular, within less than
//! rounding leaves of a late time.

/// What is read on the clock of an integration, and what time that is.
///
/// It tells the time, but for systems that have a clock of their own: no time is better than another to them, and the
/// clock begins anew at every step: steps are told apart however late it is, and the time is the sum of all steps, of which nothing is
/// lost to rounding.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    begins_anew: bool,
    /// The time at which the clock reads zero, and what of it rounding took.
    origin: f64,
    rest: f64,
    /// The time at which the integration ends.
    finish: f64,
}

impl Clock {
    /// One that begins anew at every step, or that tells the time.
    pub(super) fn new(begins_anew: bool) -> Self {
        Self { begins_anew, ..Self::default() }
    }

    pub(super) fn begins_anew(&self) -> bool {
        self.begins_anew
    }

    /// The time at which the integration ends.
    pub(super) fn finish(&self) -> f64 {
        self.finish
    }

    /// Sets the clock for an integration between two times, and reads it at the first.
    pub(super) fn start(&mut self, time: f64, finish: f64) -> f64 {
        *self = Self { origin: if self.begins_anew { time } else { 0.0 }, rest: 0.0, finish, ..*self };
        if self.begins_anew { 0.0 } else { time }
    }

    pub(super) fn absolute(&self, reading: f64) -> f64 {
        self.origin + (self.rest + reading)
    }

    pub(super) fn reading(&self, time: f64) -> f64 {
        (time - self.origin) - self.rest
    }

    /// The reading at the end of the integration.
    pub(super) fn remaining(&self) -> f64 {
        self.reading(self.finish)
    }

    /// Lets it begin anew after some time.
    pub(super) fn advance(&mut self, elapsed: f64) {
        // The sum of two numbers with what rounding takes from it (Knuth, The Art of Computer Programming 2, 4.2.2, theorem B).
        let shift = self.rest + elapsed;
        let sum = self.origin + shift;
        let part = sum - self.origin;
        self.rest = (self.origin - (sum - part)) + (shift - part);
        self.origin = sum;
    }
}
