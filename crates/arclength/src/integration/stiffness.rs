//! When a problem is stiff, and when it is no longer: which of two methods an integration is advanced by.
//!
//! The steps of an explicit method are stiff where stability keeps them short and not the tolerance. Its last two stages are at the
//! same time, so the ratio of the differences of their slopes and of their states tells the fastest rate; where that times the step
//! stays at the border of stability the problem is stiff (Hairer and Wanner, *Solving Ordinary Differential Equations II*, section
//! IV.2). Coming back, the fastest rate is that of the Jacobian. Every return makes the next change harder, so that a problem at the
//! border does not change its method all the time.

/// The fastest rate times the step at which the explicit method of order 8 loses its stability, nearly.
const STABILITY: f64 = 6.1;
/// How often steps are looked at.
const LOOKS: usize = 16;
/// Stiff steps, one after the other nearly, that make the problem stiff at first.
const PATIENCE: usize = 15;
/// Most of them.
const MOST_PATIENCE: usize = 4000;
/// Steps in a row that were not stiff, after which earlier ones do not count.
const FORGETTING: usize = 6;
/// An implicit step costs about as much as so many explicit ones.
const COST: f64 = 3.0;
/// Implicit steps that were not worth it, one after the other, that end them.
const RETURN: usize = 10;

/// Counts of steps that were stiff and of steps that were not.
#[derive(Clone, Debug)]
pub(super) struct StiffnessWatch {
    steps: usize,
    stiff: usize,
    other: usize,
    patience: usize,
}

impl StiffnessWatch {
    pub(super) fn new() -> Self {
        Self { steps: 0, stiff: 0, other: 0, patience: PATIENCE }
    }

    /// Whether the explicit step that was taken just now is to be looked at.
    #[inline]
    pub(super) fn looks(&mut self) -> bool {
        self.steps += 1;
        self.stiff > 0 || self.steps.is_multiple_of(LOOKS)
    }

    /// Takes note of the fastest rate times an explicit step; says whether the problem is stiff.
    pub(super) fn is_stiff(&mut self, rate_times_step: f64) -> bool {
        if rate_times_step > STABILITY {
            self.stiff += 1;
            self.other = 0;
        } else {
            self.other += 1;
            if self.other >= FORGETTING {
                self.stiff = 0;
            }
        }
        let is_stiff = self.stiff >= self.patience;
        if is_stiff {
            (self.stiff, self.other) = (0, 0);
        }
        is_stiff
    }

    /// Takes note of the fastest rate times an implicit step; says whether the explicit method would do as well.
    pub(super) fn is_over(&mut self, rate_times_step: f64) -> bool {
        self.other = if rate_times_step < COST * STABILITY { self.other + 1 } else { 0 };
        let is_over = self.other >= RETURN;
        if is_over {
            (self.stiff, self.other) = (0, 0);
            self.patience = (2 * self.patience).min(MOST_PATIENCE);
        }
        is_over
    }
}
