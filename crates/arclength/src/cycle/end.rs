//! Why a branch of cycles ends, apart from the reasons that all curves share.

use super::slow_passage::SlowPassage;
use crate::branch::WithParameters;
use crate::continuation::{Explanation, Reason, Wording};
use crate::numbers::{readable, significant};
use serde::{Deserialize, Serialize};

/// The reason of its own for which a branch of cycles ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CycleEnd {
    /// The amplitude went to zero: the branch ends at a Hopf point.
    HopfPoint {
        /// Parameter value there.
        parameter: f64,
        /// Angular frequency there.
        frequency: f64,
        /// Whether the point was located by Newton's method; otherwise both values are extrapolated from the last cycles.
        located: bool,
    },
    /// The two halves of doubled cycles became equal: the branch ends at a period doubling.
    PeriodDoubling {
        /// Parameter value there.
        parameter: f64,
        /// Period of the single cycle there.
        period: f64,
    },
    /// The period grows without bound: the cycles approach a homoclinic or heteroclinic orbit, or a saddle-node is born on them.
    PeriodUnbounded {
        /// Period of the last cycle.
        period: f64,
        /// Parameter value of the last cycle.
        parameter: f64,
        /// The equilibrium beside which the time is spent.
        beside: SlowPassage,
    },
    /// The cycles touch the condition of an event, or a border at which the field jumps, without passing it: beyond this grazing they
    /// go another way.
    Grazing {
        /// What is touched.
        of: Grazed,
        /// Parameter value there.
        parameter: f64,
        /// Period there.
        period: f64,
        /// Whether it was located; otherwise it is where the last cycles lead.
        located: bool,
    },
    /// A state comes so near to zero that double precision does not resolve the cycles any further.
    NearZero {
        /// Its name.
        state: String,
        /// Its absolute value nearest to zero on the last cycle.
        smallest: f64,
        /// Its largest absolute value there.
        largest: f64,
        /// Parameter value of the last cycle.
        parameter: f64,
    },
    /// The period tends to zero, and the cycles to a point at which the field jumps or an event happens.
    PeriodVanishes {
        /// Period of the last cycle.
        period: f64,
        /// Parameter value of the last cycle.
        parameter: f64,
        /// Mean state of the last cycle.
        state: Vec<f64>,
    },
    /// The amplitude grows without bound while the parameter tends to a value.
    AmplitudeUnbounded {
        /// Period of the last cycle.
        period: f64,
        /// Parameter value of the last cycle.
        parameter: f64,
    },
}

/// What cycles touch at a grazing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grazed {
    /// The condition of an event, by its number, counted from one.
    Event(usize),
    /// Not touched but passed: the condition of an event, by its number, at the time of another one. Beyond, both happen in another order,
    /// or one of them no more.
    Together(usize),
    /// A border at which the field jumps.
    Border,
}

impl WithParameters for CycleEnd {
    fn with_parameters(mut self, convert: impl Fn(usize, f64) -> f64) -> Self {
        match &mut self {
            Self::HopfPoint { parameter, .. }
            | Self::PeriodDoubling { parameter, .. }
            | Self::Grazing { parameter, .. }
            | Self::NearZero { parameter, .. }
            | Self::PeriodVanishes { parameter, .. }
            | Self::AmplitudeUnbounded { parameter, .. } => *parameter = convert(0, *parameter),
            Self::PeriodUnbounded { parameter, beside, .. } => {
                *parameter = convert(0, *parameter);
                if let SlowPassage::SaddleNode { parameter, .. } = beside {
                    *parameter = convert(0, *parameter);
                }
            }
        }
        self
    }
}

impl Reason for CycleEnd {
    fn explain(&self, wording: &Wording<'_>) -> Explanation {
        let list = |state: &[f64]| state.iter().map(|value| readable(*value)).collect::<Vec<_>>().join(", ");
        match self {
            Self::HopfPoint { parameter, frequency, located: false } => Explanation::of(format!(
                "the cycles shrink to a Hopf point near {} with an angular frequency of about {}; it was not located",
                wording.near(0, *parameter),
                wording.rough_frequency(*frequency)
            ))
            .try_this("shorter steps (--finer 10)"),
            Self::HopfPoint { parameter, frequency, .. } => Explanation::of(format!(
                "the cycles shrink to a Hopf point at {} with angular frequency {}",
                wording.at(0, *parameter),
                wording.frequency(*frequency)
            )),
            Self::PeriodDoubling { parameter, period } => Explanation::of(format!(
                "the doubled cycles end at a period doubling at {}, where the single cycle has the period {}",
                wording.at(0, *parameter),
                wording.time(*period)
            )),
            Self::Grazing { of: Grazed::Together(event), parameter, period, located } => {
                let (about, place) = if *located {
                    ("", wording.at(0, *parameter))
                } else {
                    ("about ", wording.near(0, *parameter))
                };
                Explanation::of(format!(
                    "two events at once: at {about}{place} another event comes at the time of event {event} of the cycle of period {}, \
                     and beyond it they happen in another order, or not both",
                    wording.time(*period)
                ))
                .try_this("simulate beyond, and cycles from the end of that motion")
            }
            Self::Grazing { of, parameter, period, located } => {
                let (about, place) = if *located {
                    ("", wording.at(0, *parameter))
                } else {
                    ("about ", wording.near(0, *parameter))
                };
                let touched = match of {
                    Grazed::Event(event) | Grazed::Together(event) => {
                        format!("the condition of event {event}")
                    }
                    Grazed::Border => "a border at which the field jumps".to_owned(),
                };
                Explanation::of(format!(
                    "grazing: at {about}{place} the cycle of period {} touches {touched} without passing it, and beyond it goes \
                     another way",
                    wording.time(*period)
                ))
                .try_this("simulate beyond, and cycles from the end of that motion")
            }
            Self::NearZero { state, smallest, largest, parameter } => Explanation::of(format!(
                "the branch does not get on at {}: {state} comes as near to zero as {} on cycles on which it reaches {}, and double \
                 precision does not resolve that",
                wording.at(0, *parameter),
                significant(*smallest, 2),
                readable(*largest)
            ))
            .try_this("the model with the logarithm of that state in its place"),
            Self::AmplitudeUnbounded { period, parameter } => Explanation::of(format!(
                "the amplitude grows without bound while {} tends to {}; the last period is {}",
                wording.name(0),
                readable(*parameter),
                wording.time(*period)
            ))
            .try_this("nothing, if it does in truth; else other coordinates, such as logarithms"),
            Self::PeriodVanishes { period, parameter, state } => Explanation::of(format!(
                "the period tends to zero ({} at {}): the cycles shrink to a point next to ({}) at which the field jumps or an event happens",
                wording.time(*period),
                wording.at(0, *parameter),
                list(state)
            )),
            Self::PeriodUnbounded { period, parameter, beside } => {
                let near = match beside {
                    SlowPassage::Saddle { state } => format!(
                        "a homoclinic or heteroclinic orbit is near, to the saddle ({})",
                        list(state)
                    ),
                    SlowPassage::AtGate { state, event } => {
                        let gate = event.map_or_else(
                            || "a border at which the field switches".to_owned(),
                            |event| format!("the condition of event {event}"),
                        );
                        format!("an equilibrium, ({}), comes to lie on {gate}", list(state))
                    }
                    SlowPassage::SaddleNode { state, parameter } => format!(
                        "a saddle-node ({}) is born on the cycle at {}",
                        list(state),
                        wording.at(0, *parameter)
                    ),
                };
                Explanation::of(format!(
                    "the period grows without bound ({} at {}): {near}",
                    wording.time(*period),
                    wording.at(0, *parameter)
                ))
            }
        }
    }
}
