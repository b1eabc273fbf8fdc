//! How exactly a motion is followed.

use arclength::integration::{Integrator, Method};

/// How exactly a motion is followed.
#[derive(Clone, Debug)]
pub(super) struct Accuracy {
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance of every state.
    pub absolute: Vec<f64>,
    /// Largest step.
    pub largest_step: f64,
    /// Largest number of steps.
    pub most_steps: usize,
    /// Method of integration.
    pub method: Method,
}

impl Accuracy {
    /// An integrator of this accuracy.
    pub(super) fn integrator(&self) -> Integrator {
        Integrator::default()
            .relative_tolerance(self.relative)
            .absolute_tolerances(&self.absolute)
            .maximum_step(self.largest_step)
            .method(self.method)
    }

    /// Differences of states that count as none.
    pub(super) fn scales(&self, state: &[f64]) -> Vec<f64> {
        let scale =
            |(absolute, value): (&f64, &f64)| (absolute + self.relative * value.abs()).max(f64::MIN_POSITIVE);
        self.absolute.iter().zip(state).map(scale).collect()
    }

    /// The root mean square of the differences of two states in units of their tolerances.
    pub(super) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let squares = a.iter().zip(b).zip(&self.absolute).map(|((a, b), absolute)| {
            let scale = (absolute + self.relative * a.abs().max(b.abs())).max(f64::MIN_POSITIVE);
            ((a - b) / scale).powi(2)
        });
        (squares.sum::<f64>() / self.absolute.len().max(1) as f64).sqrt()
    }
}
