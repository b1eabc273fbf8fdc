//! Labels of special and requested cycles, numbered along a result: LPC1, PD1, NS1, BPC1, AT1.

use arclength::branch::{Label, SpecialKind};
use arclength::cycle::{CyclePoint, Role, Special};
use std::collections::BTreeMap;

/// Counts the points of each kind.
#[derive(Debug, Default)]
pub struct Labels(BTreeMap<SpecialKind, usize>);

impl Labels {
    /// The label of the next cycle; `None` for a step of the continuation.
    pub fn of(&mut self, cycle: &CyclePoint) -> Option<String> {
        let kind = match cycle.role {
            Role::Step => return None,
            Role::Requested => SpecialKind::Requested,
            Role::Special(Special::Fold) => SpecialKind::FoldOfCycles,
            Role::Special(Special::Doubling) => SpecialKind::PeriodDoubling,
            Role::Special(Special::Torus { .. }) => SpecialKind::Torus,
            Role::Special(Special::BranchPoint) => SpecialKind::BranchPointOfCycles,
        };
        let number = self.0.entry(kind).or_default();
        *number += 1;
        Some(Label { kind, number: *number }.to_string())
    }
}

/// Whether something bifurcates at a labelled point: it was not merely asked for.
pub fn is_bifurcation(label: Option<&str>) -> bool {
    label.is_some_and(|label| kind(label) != SpecialKind::Requested.label())
}

/// A label without its number.
pub fn kind(label: &str) -> &str {
    label.trim_end_matches(|character: char| character.is_ascii_digit())
}
