//! Why a continuation run ended, what to try, in words.

use super::CorrectionFailure;
use crate::error::Error;

/// The reason for which a run ended in one direction.
#[derive(Debug)]
pub enum Stop {
    /// A parameter reached an end of its range.
    RangeEnd {
        /// Index of the parameter among the unknowns' bounds.
        bound: usize,
        /// The end that was reached.
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
    /// The amplitude went to zero: the branch of cycles ends at a Hopf point.
    HopfPoint {
        /// Parameter value there.
        parameter: f64,
        /// Angular frequency there.
        frequency: f64,
        /// Whether the point was located by Newton's method; otherwise both values are extrapolated from the last cycles.
        located: bool,
    },
    /// The amplitude went to zero: the curve of folds of cycles ends at a generalised Hopf point.
    GeneralizedHopfPoint {
        /// Values of the two parameters there.
        values: [f64; 2],
        /// Angular frequency there.
        frequency: f64,
    },
    /// The two halves of doubled cycles became equal: the branch ends at a period doubling.
    PeriodDoubling {
        /// Parameter value there.
        parameter: f64,
        /// Period of the single cycle there.
        period: f64,
    },
    /// A curve of torus bifurcations ends at a strong resonance, where its multipliers meet.
    StrongResonance {
        /// 1 or 2: the power of the multipliers that is one.
        order: u8,
    },
    /// The period grows without bound: the cycles approach a homoclinic or heteroclinic orbit.
    PeriodUnbounded {
        /// Period of the last cycle.
        period: f64,
        /// Parameter value of the last cycle.
        parameter: f64,
    },
    /// The state grows without bound while the parameter tends to a value.
    StateUnbounded {
        /// That value.
        parameter: f64,
    },
    /// The observer asked for the end.
    Interrupted,
    /// The problem could not be resolved any further.
    Failed(Error),
}

impl std::fmt::Display for Stop {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::RangeEnd { value, .. } => write!(formatter, "reached the end of the range at {value}"),
            Self::Closed => write!(formatter, "the branch is closed: it came back to where it started"),
            Self::StepTooSmall { cause } => write!(
                formatter,
                "the step became too small: {cause}; the field may not be smooth here, or a scale may be \
                 extreme: try another parameter, or start from the last labelled point"
            ),
            Self::MostSteps => {
                write!(formatter, "the most steps allowed were taken; allow more, or narrow the range")
            }
            Self::HopfPoint { parameter, frequency, located: true } => write!(
                formatter,
                "the cycles shrink to a Hopf point at {parameter} with angular frequency {frequency}"
            ),
            Self::HopfPoint { parameter, frequency, located: false } => write!(
                formatter,
                "the cycles shrink to a Hopf point near {parameter:.3e} with an angular frequency of about {frequency:.3e}"
            ),
            Self::GeneralizedHopfPoint { values: [first, second], frequency } => write!(
                formatter,
                "the cycles shrink to a generalised Hopf point at {first}, {second} with angular frequency {frequency}"
            ),
            Self::PeriodDoubling { parameter, period } => write!(
                formatter,
                "the halves of the doubled cycles become equal at a period doubling at {parameter}, where the single \
                 cycle has the period {period}"
            ),
            Self::StrongResonance { order } => write!(
                formatter,
                "the two multipliers on the unit circle meet: the curve ends at a 1:{order} resonance"
            ),
            Self::PeriodUnbounded { period, parameter } => write!(
                formatter,
                "the period grows without bound ({period} at {parameter}): a homoclinic or heteroclinic \
                 orbit is near"
            ),
            Self::StateUnbounded { parameter } => {
                write!(formatter, "the state grows without bound while the parameter tends to {parameter}")
            }
            Self::Interrupted => write!(formatter, "interrupted"),
            Self::Failed(error) => write!(formatter, "{error}"),
        }
    }
}
