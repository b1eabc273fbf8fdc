//! Normal-form coefficients in words, by the names that users of AUTO and MatCont know.

use crate::branch::certain_digits;
use crate::labels::kind;
use arclength::branch::{Criticality, SpecialKind};
use arclength::equilibrium::{BranchPoint, Crossing, FoldPoint, SpecialPoint};
use arclength::locus::CodimensionTwoPoint;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::significant;

/// Digits of coefficients.
const COEFFICIENT: usize = 7;
/// Why a fold or a branch point has no coefficients.
const DOUBLE_ZERO: &str = "zero is a double eigenvalue: no normal form";
/// Digits of frequencies.
const FREQUENCY: usize = 11;

/// What the normal form of a special equilibrium says.
pub fn of_equilibrium(special: &SpecialPoint) -> String {
    let coefficient = |name: &str, value: Option<f64>, error: Option<f64>| {
        value.map_or(format!("{name} does not exist"), |value| told(name, value, error))
    };
    match special {
        SpecialPoint::Hopf(hopf) => {
            let frequency = significant(hopf.frequency, FREQUENCY);
            let error = hopf.first_lyapunov_error;
            let first = coefficient("l1", hopf.first_lyapunov, error);
            let error = error.map(|error| error * hopf.frequency);
            let c1 = hopf.c1_real.map_or(String::new(), |c1| format!(", {}", told("Re c1", c1, error)));
            format!("omega = {frequency}, {first}{c1}, {}", criticality(hopf.criticality))
        }
        SpecialPoint::Fold(FoldPoint { quadratic: None, .. }) => DOUBLE_ZERO.to_owned(),
        SpecialPoint::Fold(fold) => coefficient("a", fold.quadratic, fold.quadratic_error),
        SpecialPoint::BranchPoint(BranchPoint { crossing, quadratic: None, .. }) => {
            let crossing = match crossing {
                Crossing::Transcritical => "transcritical",
                Crossing::Pitchfork => "pitchfork",
            };
            format!("{crossing}, {DOUBLE_ZERO}")
        }
        SpecialPoint::BranchPoint(point) => {
            let error = |index: usize| point.quadratic_errors.map(|errors| errors[index]);
            match (point.crossing, point.cubic) {
                (Crossing::Transcritical, _) => format!(
                    "transcritical, {}, {}, {}",
                    coefficient("a11", point.quadratic, error(0)),
                    coefficient("a12", point.mixed, error(1)),
                    coefficient("a22", point.parametric, error(2))
                ),
                (Crossing::Pitchfork, cubic) => {
                    let sense =
                        point.criticality.map_or(String::new(), |sense| format!("{} ", criticality(sense)));
                    format!("{sense}pitchfork, {}", coefficient("c", cubic, point.cubic_error))
                }
            }
        }
        SpecialPoint::NeutralSaddle(saddle) => {
            format!("neutral saddle, eigenvalues +-{}", significant(saddle.eigenvalue, COEFFICIENT))
        }
        SpecialPoint::Degenerate { of, at_border: true, .. } => format!(
            "{}, on a border between two pieces of the field: no normal form",
            match of {
                SpecialKind::Fold => "non-smooth fold",
                SpecialKind::Hopf => "two eigenvalues or more cross the axis at once",
                _ => "branches meet or an eigenvalue crosses zero",
            }
        ),
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
        .filter(|(given, _)| !given.ends_with(ERROR))
        .map(|(given, value)| {
            let name = if given == "second_lyapunov" { name } else { given.as_ref() };
            let error = point.coefficients.iter().find(|(other, _)| other.strip_suffix(ERROR) == Some(given));
            told(name, *value, error.map(|(_, error)| *error))
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
    let error = |name: &str| coefficients.named(&format!("{name}{ERROR}"));
    let values = coefficients.0.iter().filter(|(name, _)| !name.ends_with(ERROR));
    let mut texts: Vec<String> = values
        .map(|(name, value)| {
            let shown = match name.as_str() {
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
            told(shown, *value, error(name))
        })
        .collect();
    if let Some(cubic) = coefficients.named("cubic_coefficient") {
        let is_certain = error("cubic_coefficient").is_some_and(|error| cubic.abs() > error);
        let verdict = match (is_certain, cubic < 0.0) {
            (false, _) => "undecided",
            (true, true) => "supercritical",
            (true, false) => "subcritical",
        };
        texts.push(verdict.to_owned());
    }
    texts.join(", ")
}

/// End of the name under which the error of a coefficient is told.
const ERROR: &str = "_error";

/// A coefficient with the digits that hold.
fn told(name: &str, value: f64, error: Option<f64>) -> String {
    let digits = error.map_or(COEFFICIENT, |error| certain_digits(value, error).min(COEFFICIENT));
    format!("{name} = {}", significant(value, digits))
}
