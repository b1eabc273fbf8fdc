//! Kinds of special points and their labels.
//!
//! Plain data that can be written to a file and read back, so that a computation can start from any
//! labelled point of an earlier one.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

macro_rules! special_kinds {
    ($($(#[$documentation:meta])* $variant:ident = $label:literal, $name:literal;)*) => {
        /// The kinds of special points, with the labels that users of AUTO and MatCont know.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[non_exhaustive]
        pub enum SpecialKind {
            $($(#[$documentation])* #[serde(rename = $label)] $variant,)*
        }

        impl SpecialKind {
            /// All kinds.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The short label, `HB` for a Hopf point.
            pub fn label(self) -> &'static str {
                match self { $(Self::$variant => $label,)* }
            }

            /// The name in words, "Hopf point" for a Hopf point.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }
    };
}

special_kinds! {
    /// Fold (limit point, saddle-node) of equilibria.
    Fold = "LP", "fold";
    /// Branch point of equilibria: two branches cross.
    BranchPoint = "BP", "branch point";
    /// Hopf point.
    Hopf = "HB", "Hopf point";
    /// Two real eigenvalues of an equilibrium with sum zero; no bifurcation.
    NeutralSaddle = "NSE", "neutral saddle";
    /// Fold of cycles.
    FoldOfCycles = "LPC", "fold of cycles";
    /// Period doubling.
    PeriodDoubling = "PD", "period doubling";
    /// Torus (Neimark-Sacker) bifurcation.
    Torus = "NS", "torus bifurcation";
    /// Branch point of cycles.
    BranchPointOfCycles = "BPC", "branch point of cycles";
    /// A parameter value that was asked for.
    Requested = "AT", "requested value";
    /// Cusp.
    Cusp = "CP", "cusp";
    /// Bogdanov-Takens point: a double zero eigenvalue.
    BogdanovTakens = "BT", "Bogdanov-Takens point";
    /// Generalised Hopf (Bautin) point: the first Lyapunov coefficient is zero.
    GeneralizedHopf = "GH", "generalised Hopf point";
    /// Zero-Hopf (fold-Hopf) point.
    ZeroHopf = "ZH", "zero-Hopf point";
    /// Hopf-Hopf (double Hopf) point.
    HopfHopf = "HH", "Hopf-Hopf point";
    /// Cusp of cycles.
    CuspOfCycles = "CPC", "cusp of cycles";
    /// Strong resonance 1:1, a double multiplier 1.
    Resonance1 = "R1", "1:1 resonance";
    /// Strong resonance 1:2, a double multiplier -1.
    Resonance2 = "R2", "1:2 resonance";
    /// Strong resonance 1:3.
    Resonance3 = "R3", "1:3 resonance";
    /// Strong resonance 1:4.
    Resonance4 = "R4", "1:4 resonance";
    /// Fold-flip: multipliers 1 and -1.
    FoldFlip = "LPPD", "fold-flip";
    /// Generalised period doubling: the coefficient of the normal form is zero.
    GeneralizedPeriodDoubling = "GPD", "generalised period doubling";
    /// Chenciner point: the coefficient of the torus bifurcation's normal form is zero.
    Chenciner = "CH", "Chenciner point";
    /// Fold of cycles with a torus bifurcation.
    FoldTorus = "LPNS", "fold-torus point";
    /// Period doubling with a torus bifurcation.
    PeriodDoublingTorus = "PDNS", "period-doubling-torus point";
    /// Two torus bifurcations.
    DoubleTorus = "NSNS", "double torus point";
}

impl fmt::Display for SpecialKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.label())
    }
}

/// A special point's label: its kind and its number along the branch, `HB1`.
///
/// ```
/// use arclength::branch::{Label, SpecialKind};
/// let label: Label = "HB2".parse()?;
/// assert_eq!(label, Label { kind: SpecialKind::Hopf, number: 2 });
/// assert_eq!(label.to_string(), "HB2");
/// # Ok::<(), arclength::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Label {
    /// What happens there.
    pub kind: SpecialKind,
    /// Counts the points of this kind along the branch from one.
    pub number: usize,
}

impl fmt::Display for Label {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(&format!("{}{}", self.kind.label(), self.number))
    }
}

impl FromStr for Label {
    type Err = crate::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        // The labels of resonances end in a digit: the longest label that fits is the kind.
        SpecialKind::ALL
            .iter()
            .filter_map(|&kind| Some((kind, text.strip_prefix(kind.label())?.parse().ok()?)))
            .max_by_key(|(kind, _)| kind.label().len())
            .map(|(kind, number)| Self { kind, number })
            .ok_or_else(|| crate::Error::Invalid {
                name: "label".into(),
                value: text.into(),
                allowed: "a kind and a number, such as HB1, LP2, BP1".into(),
            })
    }
}

impl From<Label> for String {
    fn from(label: Label) -> Self {
        label.to_string()
    }
}

impl TryFrom<String> for Label {
    type Error = crate::Error;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

/// Numbers the points of every kind along a branch.
///
/// ```
/// use arclength::branch::{LabelCounter, SpecialKind};
/// let mut counter = LabelCounter::default();
/// let labels = [SpecialKind::Hopf, SpecialKind::Fold, SpecialKind::Hopf].map(|kind| counter.next(kind).to_string());
/// assert_eq!(labels, ["HB1", "LP1", "HB2"]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct LabelCounter(BTreeMap<SpecialKind, usize>);

impl LabelCounter {
    /// The label of the next point of this kind.
    pub fn next(&mut self, kind: SpecialKind) -> Label {
        let number = self.0.entry(kind).or_default();
        *number += 1;
        Label { kind, number: *number }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_label_can_be_read_back() {
        for &kind in SpecialKind::ALL {
            for number in [1, 2, 10, 123] {
                let label = Label { kind, number };
                assert_eq!(label.to_string().parse::<Label>().unwrap(), label);
            }
        }
        for wrong in ["", "HB", "XX1", "1", "HB-1"] {
            assert!(wrong.parse::<Label>().is_err(), "{wrong}");
        }
    }
}
