//! The times at which motions are sampled.

use super::error::SimulationError;

/// So many equidistant times from 0 to `duration`, both included.
///
/// # Errors
/// A duration that is not positive and finite, fewer than two samples.
pub(crate) fn sampling_times(duration: f64, samples: usize) -> Result<Vec<f64>, SimulationError> {
    if !(duration > 0.0 && duration.is_finite()) {
        return Err(SimulationError::out_of_range("duration", duration, "positive and finite, in s"));
    }
    if samples < 2 {
        return Err(SimulationError::out_of_range("samples", samples as f64, "at least 2"));
    }
    let last = (samples - 1) as f64;
    Ok((0..samples).map(|i| duration * (i as f64 / last)).collect())
}
