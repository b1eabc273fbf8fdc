//! A statement of the paper, and what became of it.

use serde::Serialize;

/// What became of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Confirmed,
    /// It holds, and more can be said.
    Sharpened,
    /// A formula is misprinted; with the correction it holds.
    Corrected,
    /// It does not hold.
    Contradicted,
}

impl Verdict {
    /// The verdict on a statement without a correction or more to say.
    pub(super) fn of(holds: bool) -> Self {
        if holds { Self::Confirmed } else { Self::Contradicted }
    }

    /// The verdict on a statement of which a sharper form is tested too.
    pub(super) fn sharpened(holds: bool, sharper_form_holds: bool) -> Self {
        if holds && sharper_form_holds { Self::Sharpened } else { Self::of(holds) }
    }

    /// One word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Sharpened => "sharpened",
            Self::Corrected => "corrected",
            Self::Contradicted => "contradicted",
        }
    }
}

/// A statement of the paper with what was computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Claim {
    /// Where it stands in the paper.
    pub place: &'static str,
    /// The statement, in other words.
    pub statement: String,
    /// What became of it.
    pub verdict: Verdict,
    /// The numbers from which that follows.
    pub evidence: String,
}
