//! The statements of the paper's text, each beside what was computed.
//!
//! A statement is paraphrased by hand; its verdict and the evidence are computed in the run. The statements are those
//! about the equations, the uniform motion and its stability, the contact force, and the limit cycles.

mod contact;
mod cycles;
mod equations;
mod linear;
mod random;

use super::branches::Branches;
use super::rolling_limit::RollingLimits;
use super::stability_chart::StabilityChart;
use super::uniform_motion::UniformMotions;
use super::{PaperError, Progress};
use kingpin_report::numbers::significant;
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
    fn of(holds: bool) -> Self {
        if holds { Self::Confirmed } else { Self::Contradicted }
    }

    /// The verdict on a statement of which a sharper form is tested too.
    fn sharpened(holds: bool, sharper_form_holds: bool) -> Self {
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

/// What the figures have computed already.
pub(super) struct Computed<'a> {
    pub motions: &'a UniformMotions,
    pub chart: &'a StabilityChart,
    pub limits: &'a RollingLimits,
    pub branches: &'a Branches,
}

/// All statements in the order of the paper.
pub(super) fn all(computed: &Computed, progress: &Progress) -> Result<Vec<Claim>, PaperError> {
    type Group<'a> = Box<dyn Fn() -> Result<Vec<Claim>, PaperError> + Sync + 'a>;
    use rayon::prelude::*;
    let groups: [Group; GROUPS] = [
        Box::new(equations::claims),
        Box::new(|| linear::of_the_uniform_motion(computed.motions)),
        Box::new(|| linear::of_its_stability(computed.chart)),
        Box::new(|| contact::claims(computed.limits)),
        Box::new(cycles::of_the_hopf_points),
        Box::new(|| cycles::of_the_basin(computed.branches)),
        Box::new(|| cycles::of_the_radius(computed.branches)),
    ];
    let found: Vec<Vec<Claim>> = groups
        .par_iter()
        .with_max_len(1)
        .map(|group| {
            let claims = group()?;
            progress.step()?;
            Ok(claims)
        })
        .collect::<Result<_, PaperError>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Groups of statements that are computed side by side.
pub(super) const GROUPS: usize = 7;

/// A number with so many significant digits, as it is printed: powers of ten raised, a minus sign for a hyphen.
pub(super) fn number(value: f64, digits: usize) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let plain = significant(value, digits);
    let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, ""));
    let mut printed = mantissa.replace('-', "−");
    if !exponent.is_empty() {
        printed.push_str("·10");
        printed.extend(exponent.chars().map(|character| match character.to_digit(10) {
            Some(digit) => RAISED[digit as usize],
            None => '⁻',
        }));
    }
    printed
}

/// A ratio in per cent, with two significant digits but no power of ten.
fn per_cent(ratio: f64) -> String {
    let value = 100.0 * ratio;
    if value.abs() < 10.0 { format!("{} %", number(value, 2)) } else { format!("{value:.0} %") }
}

/// The largest of some numbers that are not negative.
fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_printed_as_in_a_text() {
        assert_eq!(number(4.4e-16, 2), "4.4·10⁻¹⁶");
        assert_eq!(number(-2.5, 2), "−2.5");
        assert_eq!(per_cent(2.49), "249 %");
        assert_eq!(per_cent(-0.0234), "−2.3 %");
    }
}
