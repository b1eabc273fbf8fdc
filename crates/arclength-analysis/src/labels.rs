//! Labels of special and requested cycles, numbered along a result: LPC1, PD1, NS1, BPC1, AT1.

use arclength::branch::{Label, SpecialKind};

/// Whether something bifurcates at a labelled point: it was not merely asked for, nor is it an end, a neutral saddle or a label that
/// only one model has.
pub fn is_bifurcation(label: Option<&str>) -> bool {
    let label = label.and_then(|label| label.parse::<Label>().ok());
    label.is_some_and(|label| !matches!(label.kind, SpecialKind::Requested | SpecialKind::NeutralSaddle))
}

/// A label without its number. The labels of resonances end in a digit of their own.
///
/// ```
/// use arclength_analysis::labels::kind;
/// assert_eq!((kind("LPC2"), kind("R12"), kind("EP1")), ("LPC", "R1", "EP"));
/// ```
pub fn kind(label: &str) -> &str {
    match label.parse::<Label>() {
        Ok(label) => label.kind.label(),
        Err(_) => label.trim_end_matches(|character: char| character.is_ascii_digit()),
    }
}

/// The label of a point of a branch that is one of its ends, as AUTO's users know it.
pub fn of_end(index: usize, count: usize) -> Option<String> {
    match index {
        0 => Some("EP1".to_owned()),
        _ if index + 1 == count => Some("EP2".to_owned()),
        _ => None,
    }
}
