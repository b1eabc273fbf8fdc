//! Why a continuation run ended, in words.

use crate::error::{CorrectionFailure, Error};
use crate::numbers::readable;
use std::convert::Infallible;
use std::fmt;

/// The reason for which a run ended in one direction; `R` are the reasons of the problem's own.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Stop<R = Infallible> {
    /// A parameter reached an end of its range.
    RangeEnd {
        /// Index of the parameter among the unknowns' bounds.
        bound: usize,
        /// The end that was reached.
        value: f64,
    },
    /// A monitor reached the value at which the run was to end.
    Monitor {
        /// Index of the monitor.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The curve came back to where it started.
    Closed,
    /// The corrector failed at the smallest step.
    StepTooSmall {
        /// Why the last correction failed.
        cause: CorrectionFailure,
    },
    /// The most steps allowed were taken.
    MostSteps,
    /// A reason special to the problem.
    Problem(R),
    /// The observer asked for the end.
    Interrupted,
    /// The problem could not be resolved any further.
    Failed(Error),
}

/// Why a run ended and what to try, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// The cause.
    pub cause: String,
    /// What to try, where anything is left to do.
    pub remedy: Option<&'static str>,
}

impl Explanation {
    /// A cause about which nothing is left to do.
    pub fn of(cause: impl Into<String>) -> Self {
        Self { cause: cause.into(), remedy: None }
    }

    /// The same with something to try.
    pub fn try_this(self, remedy: &'static str) -> Self {
        Self { remedy: Some(remedy), ..self }
    }
}

/// A reason of a problem's own for which a curve ends.
pub trait Reason: Clone + fmt::Debug {
    /// The reason in words; `keys` are the names of the parameters that vary, in the order of the bounds.
    fn explain(&self, keys: &[&str]) -> Explanation;
}

impl Reason for Infallible {
    fn explain(&self, _keys: &[&str]) -> Explanation {
        match *self {}
    }
}

impl<R: Reason> Stop<R> {
    /// The stop in words; `keys` are the names of the parameters that vary, in the order of the bounds.
    pub fn explain(&self, keys: &[&str]) -> Explanation {
        let key = |index: usize| keys.get(index).copied().unwrap_or("the parameter");
        let shorter = "shorter steps from the start (--finer 10)";
        match self {
            Self::RangeEnd { bound, value } => Explanation::of(format!(
                "reached the end of the interval, {} = {}",
                key(*bound),
                readable(*value)
            )),
            Self::Monitor { value, .. } => {
                Explanation::of(format!("a monitor reached the value {} at which to stop", readable(*value)))
            }
            Self::Closed => Explanation::of("the branch is closed: it came back to where it started"),
            Self::StepTooSmall { cause } => Explanation::of(format!("the step became too small: {cause}"))
                .try_this(
                    "shorter steps from the start (--finer 10); if they end here too, the field may not be smooth here, or \
                     the curve turns more sharply than double precision tells",
                ),
            Self::MostSteps => Explanation::of("the most steps allowed were taken")
                .try_this("allow more with --steps, or start again from this end"),
            Self::Problem(reason) => reason.explain(keys),
            Self::Interrupted => Explanation::of("interrupted").try_this("start again from this end"),
            Self::Failed(Error::MeshLimit { limit, error_estimate }) => Explanation::of(format!(
                "the cycle needs more than {limit} mesh intervals (error estimate {})",
                readable(*error_estimate)
            ))
            .try_this("more with --intervals, or a larger --tolerance"),
            Self::Failed(error) => Explanation::of(error.to_string()).try_this(shorter),
        }
    }
}

impl<R: Reason> fmt::Display for Stop<R> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.explain(&[]).cause)
    }
}
