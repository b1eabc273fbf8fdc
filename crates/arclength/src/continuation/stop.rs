//! Why a continuation run ended, in words.

use crate::error::{CorrectionFailure, Error};
use crate::numbers::{readable, significant};
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
    /// So many steps in a row were much shorter than the first one is asked to be: the curve does not get on.
    Creeping {
        /// How many.
        steps: usize,
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
    /// The reason in words.
    fn explain(&self, wording: &Wording<'_>) -> Explanation;
}

/// How numbers are told: names and units of the parameters that vary, in the order of the bounds, and of times; names of the
/// monitors.
#[derive(Clone, Debug, Default)]
pub struct Wording<'a> {
    parameters: Vec<(&'a str, Option<&'a str>)>,
    monitors: Vec<&'a str>,
}

/// Digits of a number that is known roughly.
const ROUGH: usize = 3;

impl<'a> Wording<'a> {
    /// Parameters with their names and, where they have units, those of the SI (`1` for numbers); times are then in seconds.
    pub fn of(parameters: impl IntoIterator<Item = (&'a str, Option<&'a str>)>) -> Self {
        Self { parameters: parameters.into_iter().collect(), monitors: Vec::new() }
    }

    /// Parameters without units.
    pub fn of_names(names: &[&'a str]) -> Self {
        Self::of(names.iter().map(|name| (*name, None)))
    }

    /// The same with the names of the monitors, in the order in which they were asked for.
    pub fn monitors(self, names: impl IntoIterator<Item = &'a str>) -> Self {
        Self { monitors: names.into_iter().collect(), ..self }
    }

    fn parameter(&self, index: usize) -> (&'a str, Option<&'a str>) {
        self.parameters.get(index).or(self.parameters.first()).copied().unwrap_or(("the parameter", None))
    }

    fn told(&self, index: usize, value: f64, text: &str) -> String {
        match self.parameter(index) {
            (name, Some(unit)) if unit != "1" && value.is_finite() => format!("{name} = {text} {unit}"),
            (name, _) => format!("{name} = {text}"),
        }
    }

    /// The name of a parameter.
    pub fn name(&self, index: usize) -> &'a str {
        self.parameter(index).0
    }

    /// A parameter with a value, `v = 4 m/s`.
    pub fn at(&self, index: usize, value: f64) -> String {
        self.told(index, value, &readable(value))
    }

    /// A parameter with a value that is known roughly.
    pub fn near(&self, index: usize, value: f64) -> String {
        self.told(index, value, &significant(value, ROUGH))
    }

    fn has_units(&self) -> bool {
        self.parameters.iter().any(|(_, unit)| unit.is_some())
    }

    /// A time.
    pub fn time(&self, value: f64) -> String {
        format!("{}{}", readable(value), if self.has_units() { " s" } else { "" })
    }

    /// An angular frequency.
    pub fn frequency(&self, value: f64) -> String {
        format!("{}{}", readable(value), if self.has_units() { " rad/s" } else { "" })
    }

    /// An angular frequency that is known roughly.
    pub fn rough_frequency(&self, value: f64) -> String {
        format!("{}{}", significant(value, ROUGH), if self.has_units() { " rad/s" } else { "" })
    }
}

impl Reason for Infallible {
    fn explain(&self, _wording: &Wording<'_>) -> Explanation {
        match *self {}
    }
}

impl<R: Reason> Stop<R> {
    /// The stop in words.
    pub fn explain(&self, wording: &Wording<'_>) -> Explanation {
        let shorter = "shorter steps from the start (--finer 10)";
        match self {
            Self::RangeEnd { bound, value } => {
                Explanation::of(format!("reached the end of the interval, {}", wording.at(*bound, *value)))
            }
            Self::Monitor { index, value } => {
                let name = wording.monitors.get(*index).copied().unwrap_or("a monitor");
                Explanation::of(format!("{name} reached the value {} at which to stop", readable(*value)))
            }
            Self::Closed => Explanation::of("the branch is closed: it came back to where it started"),
            Self::StepTooSmall { cause } => Explanation::of(format!("the step became too small: {cause}"))
                .try_this(
                    "shorter steps from the start (--finer 10); if they end here too, the field may not be smooth here, or \
                     the curve turns more sharply than double precision tells",
                ),
            Self::Creeping { steps } => Explanation::of(format!(
                "the curve does not get on: {steps} steps in a row had to be shorter than a ten-thousandth of the first one"
            ))
            .try_this("other coordinates, such as logarithms of what comes near zero; a smaller --tolerance"),
            Self::MostSteps => Explanation::of("the most steps allowed were taken")
                .try_this("allow more with --steps, or start again from this end"),
            Self::Problem(reason) => reason.explain(wording),
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
        formatter.write_str(&self.explain(&Wording::default()).cause)
    }
}
