//! Settings of an integration: tolerances and limits, with their checks.

use super::IntegrationError;

/// Smallest relative tolerance: below it the error estimate is rounding.
const SMALLEST_RELATIVE_TOLERANCE: f64 = 10.0 * f64::EPSILON;

/// By which method an integration is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The explicit Runge-Kutta method of order 8.
    #[default]
    Explicit,
    /// The implicit Runge-Kutta method Radau IIA of order 5, for stiff problems.
    Implicit,
    /// The explicit one, and the implicit one where the problem is stiff.
    Automatic,
}

/// Tolerances and limits of an integration.
///
/// A step is accepted when the root mean square over the components of error / (absolute + relative |x|)
/// is at most one.
///
/// ```
/// use arclength::integration::{Integrator, from_fn};
///
/// let oscillator = from_fn(2, |_time, x, derivative| {
///     derivative[0] = x[1];
///     derivative[1] = -x[0];
/// });
/// let times = [0.0, 0.5, 1.0];
/// let solution = Integrator::default().sample(oscillator, &[0.0, 1.0], &times)?;
/// for (time, state) in solution.samples() {
///     assert!((state[0] - time.sin()).abs() < 1e-9);
/// }
/// # Ok::<(), arclength::integration::IntegrationError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Integrator {
    relative_tolerance: f64,
    absolute_tolerances: Vec<f64>,
    pub(super) initial_step: Option<f64>,
    pub(super) maximum_step: f64,
    pub(super) maximum_steps: usize,
    pub(super) method: Method,
}

impl Default for Integrator {
    /// Relative tolerance 1e-10, absolute tolerance 1e-12, at most a million steps of any size, by the explicit method.
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-10,
            absolute_tolerances: vec![1e-12],
            initial_step: None,
            maximum_step: f64::INFINITY,
            maximum_steps: 1_000_000,
            method: Method::Explicit,
        }
    }
}

impl Integrator {
    /// The default with both tolerances set: relative, and a hundredth of it absolute.
    pub fn with_tolerance(tolerance: f64) -> Self {
        Self::default().relative_tolerance(tolerance).absolute_tolerance(0.01 * tolerance)
    }

    /// Sets the relative tolerance.
    pub fn relative_tolerance(mut self, tolerance: f64) -> Self {
        self.relative_tolerance = tolerance;
        self
    }

    /// Sets the absolute tolerance of every component.
    pub fn absolute_tolerance(mut self, tolerance: f64) -> Self {
        self.absolute_tolerances = vec![tolerance];
        self
    }

    /// Sets the absolute tolerance of each component in the units of the component.
    pub fn absolute_tolerances(mut self, tolerances: &[f64]) -> Self {
        self.absolute_tolerances = tolerances.to_vec();
        self
    }

    /// Sets the size of the first step, which is otherwise found from the right-hand side.
    pub fn initial_step(mut self, step: f64) -> Self {
        self.initial_step = Some(step);
        self
    }

    /// Sets the largest step.
    pub fn maximum_step(mut self, step: f64) -> Self {
        self.maximum_step = step;
        self
    }

    /// Sets the largest number of steps.
    pub fn maximum_steps(mut self, steps: usize) -> Self {
        self.maximum_steps = steps;
        self
    }

    /// Sets the method.
    pub fn method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Size of what is left to be found of the stages of an implicit step, in units of the tolerance: well below the error of the
    /// step, above rounding.
    pub(super) fn newton_tolerance(&self) -> f64 {
        let rounding = 10.0 * f64::EPSILON / self.relative_tolerance.max(f64::EPSILON);
        self.relative_tolerance.sqrt().clamp(1e-3, 0.03).max(rounding.min(0.1))
    }

    /// Refuses settings that are out of range for a system of `dimension` equations.
    pub(super) fn check(&self, dimension: usize) -> Result<(), IntegrationError> {
        let refuse = |name, value, allowed| Err(IntegrationError::BadSetting { name, value, allowed });
        let relative = self.relative_tolerance;
        if !(relative == 0.0 || (SMALLEST_RELATIVE_TOLERANCE..1.0).contains(&relative)) {
            return refuse("relative tolerance", relative, "0, or from 2.3e-15 to less than 1");
        }
        if self.absolute_tolerances.len() != 1 && self.absolute_tolerances.len() != dimension {
            return Err(IntegrationError::WrongLength {
                name: "the list of absolute tolerances",
                found: self.absolute_tolerances.len(),
                expected: dimension,
            });
        }
        for &absolute in &self.absolute_tolerances {
            let positive_sum = absolute > 0.0 || absolute == 0.0 && relative > 0.0;
            if !(positive_sum && absolute.is_finite()) {
                return refuse(
                    "absolute tolerance",
                    absolute,
                    "positive, or 0 if the relative tolerance is not",
                );
            }
        }
        match self.initial_step {
            Some(step) if !(step > 0.0 && step.is_finite()) => {
                refuse("initial step", step, "positive and finite")
            }
            _ if self.maximum_step.is_nan() || self.maximum_step <= 0.0 => {
                refuse("maximum step", self.maximum_step, "positive")
            }
            _ => Ok(()),
        }
    }

    /// Tolerance of a component of size `size`.
    #[inline]
    pub(super) fn scale(&self, component: usize, size: f64) -> f64 {
        let absolute = match self.absolute_tolerances.as_slice() {
            [uniform] => *uniform,
            each => each[component],
        };
        // A component that is exactly zero under a purely relative tolerance must not divide by zero.
        (absolute + self.relative_tolerance * size).max(f64::MIN_POSITIVE)
    }
}
