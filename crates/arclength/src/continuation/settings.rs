//! Tolerances and limits of a continuation run, all in the curve's own dimensionless metric.

/// Settings of [`follow`](super::follow). The defaults suit every problem of this crate; lengths are
/// measured in the metric of the curve, where states are scaled by their own size and parameters by
/// the length of their range.
///
/// ```
/// use arclength::continuation::Settings;
/// let short = Settings::default().largest_step(0.1).most_steps(50);
/// assert!(short.largest_step == 0.1 && short.most_steps == 50);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// First step.
    pub initial_step: f64,
    /// Largest step.
    pub largest_step: f64,
    /// Largest change of a bounded parameter in one step, as part of its range.
    pub largest_parameter_change: f64,
    /// Step below which the run gives up.
    pub smallest_step: f64,
    /// Distance between predicted and corrected point that the step control aims at.
    pub predictor_error: f64,
    /// A correction longer than this many times what is aimed at, or than this many hundredths of the step if that is more, has led
    /// elsewhere, and the step is made anew and shorter.
    pub largest_correction: f64,
    /// The corrector has converged when its last update is shorter than this.
    pub corrector_tolerance: f64,
    /// Updates that the corrector may use.
    pub corrector_iterations: usize,
    /// Most steps in one direction.
    pub most_steps: usize,
    /// Part of a step below which it is not divided any further in the search for special points.
    pub smallest_part: f64,
    /// Most solutions computed to sort out one step.
    pub most_trials: usize,
    /// A step longer than this that leads to another branch is made anew and shorter.
    pub shortest_jump: f64,
    /// Part of a step to which a place is bracketed where the number of unstable directions changes.
    pub shortest_bracket: f64,
}

/// Tolerance of the corrector for solutions between which special points are bracketed. Next to a homoclinic orbit the parameter
/// changes so little that a test function which is its rate changes its sign elsewhere where solutions are known less well.
const LOCATING_TOLERANCE: f64 = 1e-13;

/// A method for every field. They may be set directly too, but not listed all: more may come.
macro_rules! with_methods {
    ($($field:ident: $type:ty),* $(,)?) => {
        impl Settings {
            $(
                #[doc = concat!("The same with this [`", stringify!($field), "`](field@Self::", stringify!($field), ").")]
                pub fn $field(mut self, value: $type) -> Self {
                    self.$field = value;
                    self
                }
            )*
        }
    };
}

with_methods! {
    initial_step: f64,
    largest_step: f64,
    largest_parameter_change: f64,
    smallest_step: f64,
    predictor_error: f64,
    largest_correction: f64,
    corrector_tolerance: f64,
    corrector_iterations: usize,
    most_steps: usize,
    smallest_part: f64,
    most_trials: usize,
    shortest_jump: f64,
    shortest_bracket: f64,
}

impl Settings {
    /// The same for solutions between which special points are located.
    pub(crate) fn for_locating(self) -> Self {
        Self { corrector_tolerance: self.corrector_tolerance.min(LOCATING_TOLERANCE), ..self }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            initial_step: 0.01,
            largest_step: 10.0,
            largest_parameter_change: 0.04,
            smallest_step: 1e-9,
            predictor_error: 0.01,
            largest_correction: 10.0,
            corrector_tolerance: 1e-10,
            corrector_iterations: 12,
            most_steps: 10_000,
            smallest_part: 1e-5,
            most_trials: 100,
            shortest_jump: 1e-4,
            shortest_bracket: 1e-7,
        }
    }
}
