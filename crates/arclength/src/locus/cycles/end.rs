//! Why a curve of special cycles ends, apart from the reasons that all curves share.

use crate::branch::WithParameters;
use crate::continuation::{Explanation, Reason, Wording};
use crate::cycle::CycleEnd;
use serde::{Deserialize, Serialize};

/// The reason of its own for which a curve of special cycles ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CycleLocusEnd {
    /// A reason for which branches of cycles end as well; its parameter is the first one.
    Cycle(CycleEnd),
    /// The amplitude went to zero: the curve of folds of cycles ends at a generalised Hopf point.
    GeneralizedHopfPoint {
        /// Values of the two parameters there.
        values: [f64; 2],
        /// Angular frequency there.
        frequency: f64,
    },
    /// The amplitude went to zero: the curve of torus bifurcations ends at a Hopf-Hopf point.
    HopfHopfPoint {
        /// Values of the two parameters there.
        values: [f64; 2],
        /// Angular frequency of the cycles there.
        frequency: f64,
    },
    /// The amplitude went to zero: the curve of torus bifurcations ends at a zero-Hopf point.
    ZeroHopfPoint {
        /// Values of the two parameters there.
        values: [f64; 2],
        /// Angular frequency of the cycles there.
        frequency: f64,
    },
    /// A curve of torus bifurcations ends at a strong resonance, where its multipliers meet.
    StrongResonance {
        /// 1 or 2: the power of the multipliers that is one.
        order: u8,
    },
}

impl WithParameters for CycleLocusEnd {
    fn with_parameters(self, convert: impl Fn(usize, f64) -> f64) -> Self {
        let both = |[one, two]: [f64; 2]| [convert(0, one), convert(1, two)];
        match self {
            Self::Cycle(end) => Self::Cycle(end.with_parameters(convert)),
            Self::GeneralizedHopfPoint { values, frequency } => {
                Self::GeneralizedHopfPoint { values: both(values), frequency }
            }
            Self::HopfHopfPoint { values, frequency } => {
                Self::HopfHopfPoint { values: both(values), frequency }
            }
            Self::ZeroHopfPoint { values, frequency } => {
                Self::ZeroHopfPoint { values: both(values), frequency }
            }
            end @ Self::StrongResonance { .. } => end,
        }
    }
}

impl Reason for CycleLocusEnd {
    fn explain(&self, wording: &Wording<'_>) -> Explanation {
        let shrink = |name: &str, [first, second]: &[f64; 2], frequency: f64| {
            Explanation::of(format!(
                "the cycles shrink to a {name} at {}, {} with angular frequency {}",
                wording.at(0, *first),
                wording.at(1, *second),
                wording.frequency(frequency)
            ))
        };
        match self {
            Self::Cycle(end) => end.explain(wording),
            Self::GeneralizedHopfPoint { values, frequency } => {
                shrink("generalised Hopf point", values, *frequency)
            }
            Self::HopfHopfPoint { values, frequency } => shrink("Hopf-Hopf point", values, *frequency),
            Self::ZeroHopfPoint { values, frequency } => shrink("zero-Hopf point", values, *frequency),
            Self::StrongResonance { order } => Explanation::of(format!(
                "the curve of torus bifurcations ends at a 1:{order} resonance, where its multipliers meet"
            )),
        }
    }
}
