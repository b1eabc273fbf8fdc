//! The course of the uniform motion along a parameter, as far as Hopf points do not tell it: where it turns, branches or ends, and changes of its
//! stability that were not located.

use crate::description;
use arclength::branch::SpecialKind;
use arclength::equilibrium::EquilibriumPoint;
use kingpin::branches::MotionBranch;
use kingpin_report::numbers::{readable, significant};

/// Digits of a growth rate that is told beside its frequency.
const ROUGH: usize = 3;

/// Sentences on the course of a branch.
pub(crate) fn course_of(branch: &MotionBranch) -> Vec<String> {
    turns(branch).chain(ends(branch)).chain(unlocated_changes(branch)).collect()
}

/// Where it turns at folds, and where others meet it.
pub(super) fn turns(branch: &MotionBranch) -> impl Iterator<Item = String> {
    branch.motions.iter().filter_map(move |motion| {
        let label = motion.label?;
        let place = description::quantity(branch.along.key(), motion.value);
        match label.kind {
            SpecialKind::Fold => Some(format!("the uniform motion turns at {place} ({label})")),
            SpecialKind::BranchPoint => {
                Some(format!("other uniform motions branch off at {place} ({label})"))
            }
            _ => None,
        }
    })
}

/// Where it ends inside the interval, and why.
pub(super) fn ends(branch: &MotionBranch) -> impl Iterator<Item = String> {
    let (start, end) = branch.along.ends();
    let asked = [start, end].map(|value| branch.along.as_found(value));
    let ends = [(0, branch.motions.first()), (1, branch.motions.last())];
    ends.into_iter().filter_map(move |(index, motion)| {
        let reached = motion?.value;
        if asked.contains(&reached) || [start, end].contains(&reached) {
            return None;
        }
        let why = branch.end_in_words(index).map_or_else(String::new, |why| format!(" ({why})"));
        Some(format!("beyond {} it could not be followed{why}", readable(reached)))
    })
}

/// Changes from certain stability to certain instability, or back, without a special point between.
pub(super) fn unlocated_changes(branch: &MotionBranch) -> impl Iterator<Item = String> {
    let mut decided: Option<(&EquilibriumPoint, bool)> = None;
    branch.motions.iter().filter_map(move |motion| {
        if motion.special.is_some() {
            decided = None;
            return None;
        }
        let stable = motion.stability.is_stable()?;
        let before = decided.replace((motion, stable));
        let (from, _) = before.filter(|(_, other)| *other != stable)?;
        Some(unlocated_change(branch, from, motion, stable))
    })
}

fn unlocated_change(
    branch: &MotionBranch,
    from: &EquilibriumPoint,
    to: &EquilibriumPoint,
    is_gained: bool,
) -> String {
    let key = branch.along.key();
    let growth = |motion: &EquilibriumPoint| {
        let first = motion.eigenvalues.first().copied().unwrap_or_default();
        let frequency = if first.im == 0.0 {
            String::new()
        } else {
            format!(" at {} rad/s", significant(first.im.abs(), ROUGH))
        };
        format!("{} 1/s{frequency}", significant(first.re, ROUGH))
    };
    format!(
        "between {} and {} {} the uniform motion {} stability, and where was not located: its growth rate is {} and {}",
        readable(from.value),
        readable(to.value),
        key.unit(),
        if is_gained { "gains" } else { "loses" },
        growth(from),
        growth(to),
    )
}
