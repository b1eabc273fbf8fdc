//! What was measured: the states of a wheel at some times, and what is known of how the motion began.

use super::error::IdentificationError;
use crate::wheel::Wheel;

/// Fewest samples of a record.
pub const FEWEST_SAMPLES: usize = 5;

/// One measured state.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, one of the [free states](Wheel::free_states).
    pub state: String,
    /// Its values at the times of the record, in SI units.
    pub values: Vec<f64>,
}

/// A motion that was measured while the wheel was towed at one speed along one path.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The wheel, with the speed and the path at which it was towed; of what is estimated it has the values to start from.
    pub wheel: Wheel,
    /// Times in s, in ascending order.
    pub times: Vec<f64>,
    /// What was measured.
    pub columns: Vec<Column>,
}

/// What is known of a state at the first sample of every record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Nothing: it is estimated.
    Free,
    /// That of the uniform motion.
    Uniform,
    /// Its value, in SI units.
    At(f64),
}

impl Record {
    /// That every column is a state of the wheel with one finite value for each time, and that times grow.
    ///
    /// # Errors
    /// [`IdentificationError::Record`], which says what is wrong.
    pub(super) fn check(&self, index: usize) -> Result<(), IdentificationError> {
        let wrong = |problem: String| Err(IdentificationError::Record { record: index, problem });
        let count = self.times.len();
        if count < FEWEST_SAMPLES {
            return wrong(format!("{count} samples; allowed: at least {FEWEST_SAMPLES}"));
        }
        let grows = self.times.windows(2).all(|pair| pair[1] > pair[0]);
        if !(grows && self.times.iter().all(|time| time.is_finite())) {
            return wrong("the times do not grow from sample to sample".to_owned());
        }
        if self.columns.is_empty() {
            return wrong("no state was measured".to_owned());
        }
        let states = self.wheel.free_states();
        for (place, Column { state, values }) in self.columns.iter().enumerate() {
            if !states.contains(&state.as_str()) {
                return wrong(format!("`{state}` is no free state; allowed: {}", states.join(", ")));
            }
            if self.columns[..place].iter().any(|other| other.state == *state) {
                return wrong(format!("the state {state} stands twice"));
            }
            if values.len() != count {
                return wrong(format!("{} values of {state} at {count} times", values.len()));
            }
            if !values.iter().all(|value| value.is_finite()) {
                return wrong(format!("a value of {state} is not finite"));
            }
        }
        Ok(())
    }

    /// The number of measured values among the first samples.
    pub(super) fn values_in(&self, samples: usize) -> usize {
        samples * self.columns.len()
    }
}
