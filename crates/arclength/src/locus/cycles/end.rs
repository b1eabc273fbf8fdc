//! Why a curve of special cycles ends, apart from the reasons that all curves share.

use crate::continuation::{Explanation, Reason};
use crate::cycle::CycleEnd;
use crate::numbers::readable;
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
    /// A curve of torus bifurcations ends at a strong resonance, where its multipliers meet.
    StrongResonance {
        /// 1 or 2: the power of the multipliers that is one.
        order: u8,
    },
}

impl Reason for CycleLocusEnd {
    fn explain(&self, keys: &[&str]) -> Explanation {
        match self {
            Self::Cycle(end) => end.explain(keys),
            Self::GeneralizedHopfPoint { values: [first, second], frequency } => Explanation::of(format!(
                "the cycles shrink to a generalised Hopf point at {} = {}, {} = {} with angular frequency {}",
                keys.first().copied().unwrap_or("the first parameter"),
                readable(*first),
                keys.get(1).copied().unwrap_or("the second"),
                readable(*second),
                readable(*frequency)
            )),
            Self::StrongResonance { order } => Explanation::of(format!(
                "the curve of torus bifurcations ends at a 1:{order} resonance, where its multipliers meet"
            )),
        }
    }
}
