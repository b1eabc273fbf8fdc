//! Normal-form coefficients in words, by the names that users of AUTO and MatCont know.

use crate::labels::kind;
use arclength::branch::{Criticality, SpecialKind};
use arclength::equilibrium::{Crossing, SpecialPoint};
use arclength::locus::CodimensionTwoPoint;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::significant;

/// Digits of coefficients.
const COEFFICIENT: usize = 7;
/// Digits of frequencies.
const FREQUENCY: usize = 11;

/// What the normal form of a special equilibrium says.
pub fn of_equilibrium(special: &SpecialPoint) -> String {
    let coefficient = |name: &str, value: Option<f64>| {
        value.map_or(format!("{name} does not exist"), |value| {
            format!("{name} = {}", significant(value, COEFFICIENT))
        })
    };
    match special {
        SpecialPoint::Hopf(hopf) => {
            let frequency = significant(hopf.frequency, FREQUENCY);
            let first = coefficient("l1", hopf.first_lyapunov);
            let c1 = hopf.c1_real.map_or(String::new(), |c1| format!(", {}", coefficient("Re c1", Some(c1))));
            format!("omega = {frequency}, {first}{c1}, {}", criticality(hopf.criticality))
        }
        SpecialPoint::Fold(fold) => coefficient("a", fold.quadratic),
        SpecialPoint::BranchPoint(point) => match (point.crossing, point.cubic) {
            (Crossing::Transcritical, _) => format!(
                "transcritical, {}, {}, {}",
                coefficient("a11", Some(point.quadratic)),
                coefficient("a12", Some(point.mixed)),
                coefficient("a22", Some(point.parametric))
            ),
            (Crossing::Pitchfork, cubic) => {
                let sense =
                    point.criticality.map_or(String::new(), |sense| format!("{} ", criticality(sense)));
                format!("{sense}pitchfork, {}", coefficient("c", cubic))
            }
        },
        SpecialPoint::NeutralSaddle(saddle) => {
            format!("neutral saddle, eigenvalues +-{}", significant(saddle.eigenvalue, COEFFICIENT))
        }
        SpecialPoint::Degenerate { location_error, .. } => {
            format!("degenerate, bracketed only: +-{}", significant(*location_error, 2))
        }
    }
}

/// What the normal form of a point of codimension two says.
pub fn of_codimension_two(point: &CodimensionTwoPoint) -> String {
    let name = match point.kind {
        SpecialKind::GeneralizedHopf => "l2",
        _ => "",
    };
    let texts: Vec<String> = point
        .coefficients
        .iter()
        .map(|(given, value)| {
            let name = if given == "second_lyapunov" { name } else { given.as_ref() };
            format!("{name} = {}", significant(*value, COEFFICIENT))
        })
        .collect();
    let located = if point.regular { "" } else { " (degenerate, bracketed only)" };
    match texts.is_empty() {
        true => format!("{}{located}", point.kind.name()),
        false => format!("{}{located}, {}", point.kind.name(), texts.join(", ")),
    }
}

/// The sense of a bifurcation in a word.
pub fn criticality(criticality: Criticality) -> &'static str {
    match criticality {
        Criticality::Supercritical => "supercritical",
        Criticality::Subcritical => "subcritical",
        Criticality::Degenerate => "degenerate",
    }
}

/// What the normal form of a special cycle says, given its coefficients by the names of the library.
pub fn of_cycle(label: Option<&str>, coefficients: &NamedNumbers) -> String {
    let mut texts: Vec<String> = coefficients
        .0
        .iter()
        .map(|(name, value)| {
            let name = match name.as_str() {
                "quadratic_coefficient" => "b",
                "quadratic_coefficient_of_unit_function" => "b (null function of unit size)",
                "cubic_coefficient_imaginary" => "Im d",
                "cubic_coefficient" if label.is_some_and(|label| kind(label) == "NS") => "Re d",
                "cubic_coefficient" => "c",
                "argument" => "argument of the multipliers",
                "first_lyapunov" => "l1",
                "c1_real" => "Re c1",
                other => other,
            };
            format!("{name} = {}", significant(*value, COEFFICIENT))
        })
        .collect();
    if let Some(cubic) = coefficients.named("cubic_coefficient") {
        texts.push(if cubic < 0.0 { "supercritical" } else { "subcritical" }.to_owned());
    }
    texts.join(", ")
}
