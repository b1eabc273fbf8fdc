//! The limit cycles that are born of the uniform motion: the shimmy that is, or that waits for a blow.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::classification::{Contact, contact_in_words};
use crate::cycles::{CyclesRequest, CyclesResult};
use crate::error::Error;
use crate::forces::ForcesResult;
use crate::wheel_request::WheelRequest;
use arclength_analysis::labels::kind;
use arclength_analysis::{Control, Interval};
use kingpin::Tyre;
use kingpin_report::numbers::{readable, significant};

/// The slowest speed, as part of the fastest.
const SLOWEST: f64 = 1e-2;

/// Forces below so many times the friction that there is are told by how much they exceed it.
const TWICE: f64 = 2.0;
const PER_CENT: f64 = 100.0;

/// Cycles up to a speed; `None` where no Hopf point is there from which any could start.
///
/// # Errors
/// Why they cannot be followed.
pub(super) fn follow(
    wheel: &WheelRequest,
    [speed, fastest]: [f64; 2],
    control: &Control<'_>,
) -> Result<Option<CyclesResult>, Error> {
    let along = Interval::new("v", SLOWEST * fastest, fastest);
    let request = CyclesRequest { wheel: wheel.clone(), at: vec![speed], ..CyclesRequest::new(along) };
    match request.validate()?.run(control) {
        Ok(result) => Ok(Some(result)),
        Err(Error::NothingFound(_)) => Ok(None),
        Err(error) => Err(error),
    }
}

/// What is said where no Hopf point is up to a speed, of those of the stability section that are slower than what is followed, and of
/// large cycles that are born of none.
pub(super) fn none_is_born(
    subject: String,
    fastest: f64,
    hopf_points: &[f64],
    large_cycles: &str,
) -> Finding {
    let mut text = format!(
        "No Hopf point up to {} m/s, so no limit cycle is born of the uniform motion; large ones beside it {large_cycles}.",
        readable(fastest)
    );
    if let Some(left_out) = left_out(SLOWEST * fastest, hopf_points) {
        text = format!("{left_out}. From there on: {text}");
    }
    Finding::new(subject, text, "")
}

/// Hopf points of the stability section that lie below the speeds over which cycles are followed, in words.
fn left_out(slowest: f64, hopf_points: &[f64]) -> Option<String> {
    let below: Vec<String> =
        hopf_points.iter().filter(|speed| **speed < slowest).map(|speed| significant(*speed, 4)).collect();
    let words = match below.as_slice() {
        [] => return None,
        [only] => format!("that at {only} m/s"),
        several => format!("those at {} m/s", several.join(", ")),
    };
    Some(format!(
        "Hopf points are counted from {} m/s on; {words}, and cycles born there, were left out",
        readable(slowest)
    ))
}

/// What is said of them; `stable_motion` is whether the uniform motion is stable at the wheel's own speed, `hopf_points` are the speeds
/// of those that the stability section tells.
pub(super) fn finding(
    subject: String,
    cycles: &CyclesResult,
    speed: f64,
    (stable_motion, hopf_points): (Option<bool>, &[f64]),
) -> Finding {
    let mut said: Vec<String> = left_out(cycles.interval.ends().0, hopf_points).into_iter().collect();
    let tyre = cycles.wheel.tyre();
    for branch in &cycles.branches {
        let points = || cycles.points.iter().filter(|point| point.branch == branch.branch);
        let values = points().map(|point| point.cycle.value);
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let reach = points().map(|point| point.psi_max.abs().max(point.psi_min.abs())).fold(0.0, f64::max);
        said.push(format!(
            "A branch of limit cycles {}; it lies between {} and {} m/s, with caster angles up to {} rad as far as it was followed ({})",
            branch.ends[0],
            significant(low, 4),
            significant(high, 4),
            significant(reach, 4),
            branch.ends[1]
        ));
    }
    let here = cycles.points.iter().filter(|point| {
        point.cycle.value == speed && point.cycle.label.as_deref().is_some_and(|label| kind(label) == "AT")
    });
    for point in here {
        let word = match point.cycle.stable {
            Some(true) => "a stable cycle, the wheel shimmies",
            Some(false) if stable_motion == Some(true) => {
                "an unstable cycle, which bounds what the ideally rolling wheel returns from"
            }
            Some(false) => "an unstable cycle",
            None => "a cycle of undecided stability",
        };
        said.push(format!(
            "At {} m/s there is {word}: caster angle {} to {} rad, period {} s{}",
            readable(speed),
            significant(point.psi_min, 4),
            significant(point.psi_max, 4),
            significant(point.cycle.period, 5),
            friction(&point.forces, tyre)
        ));
    }
    said.extend(cycles.not_followed.iter().map(|point| {
        format!("No branch could be followed from {} at {} m/s", point.from, significant(point.value, 4))
    }));
    let unlocated: usize = cycles.branches.iter().map(|branch| branch.unlocated.len()).sum();
    let is_undecided = unlocated > 0 || !cycles.not_followed.is_empty();
    let check = check(cycles, speed);
    Finding::new(subject, said.join(". ") + ".", check).undecided_if(is_undecided)
}

/// How large the errors are, where the cycles are told and where they are largest.
fn check(cycles: &CyclesResult, speed: f64) -> String {
    let errors = || cycles.points.iter().map(|point| (point.cycle.error_estimate, point.cycle.value));
    let largest = errors().max_by(|(one, _), (other, _)| one.total_cmp(other));
    let here = errors().filter(|(_, value)| *value == speed).map(|(error, _)| error).max_by(f64::total_cmp);
    let mut text = "Collocation; cycles at a speed asked for are solved for again on a finer mesh. The estimated error of periods and \
                    extremes is "
        .to_owned();
    if let Some(here) = here {
        text += &format!("{} at most at {} m/s, and ", significant(here, 2), readable(speed));
    }
    if let Some((error, value)) = largest {
        text += &format!("largest, {}, at {} m/s.", significant(error, 2), significant(value, 4));
    }
    text
}

/// What a cycle asks of the ground.
fn friction(forces: &ForcesResult, tyre: Tyre) -> String {
    let (Some(force), Some(ratio)) = (forces.friction_max, forces.friction_ratio_max) else {
        return String::new();
    };
    let part = if (1.0..TWICE).contains(&ratio) {
        format!("{} % more than there is", significant(PER_CENT * (ratio - 1.0), 2))
    } else {
        format!("{} times what there is", significant(ratio, 3))
    };
    let consequence = match tyre {
        _ if ratio < 1.0 => "it rolls",
        Tyre::Rigid => "it cannot roll, and slides",
        // The law saturates by itself: what exceeds it comes from turning the wheel about its axle.
        Tyre::Brush => {
            "the brush law limits the lateral force, and the tyre slides by it; nothing limits the longitudinal force in this model"
        }
        Tyre::Linear => "the linear law of the tyre has no limit, and holds no longer",
    };
    format!(
        "; at its worst moment it asks for {} N of friction, {part}: {consequence}",
        significant(force, 3)
    )
}

/// The branches over the speed.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(cycles: &CyclesResult, radius: f64) -> Result<Option<Illustration>, Error> {
    let caption = format!(
        "Largest and smallest caster angle of the limit cycles over the speed at <i>r</i> = {}, {}; solid where stable, \
         dashed where unstable, dotted where {}.",
        if radius.is_infinite() { "∞".to_owned() } else { format!("{} m", readable(radius)) },
        contact_in_words(&cycles.wheel, Contact::Rolling.model().name()),
        match cycles.wheel.tyre() {
            Tyre::Rigid => "the wheel cannot roll like this",
            Tyre::Linear | Tyre::Brush => "the force of the ground exceeds <i>mu_s N</i>",
        }
    );
    Illustration::of(cycles, caption)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hopf_points_that_are_left_out_are_told() {
        assert_eq!(left_out(0.2, &[0.3, 13.0]), None);
        let told = left_out(0.2, &[0.0331, 0.0593, 13.0]).unwrap();
        assert!(told.contains("from 0.2 m/s on; those at 0.0331, 0.0593 m/s"), "{told}");
        let none = none_is_born(String::new(), 20.0, &[0.0331], "were not sought").text;
        assert!(none.starts_with("Hopf points are counted from 0.2 m/s on; that at 0.0331 m/s"), "{none}");
    }

    /// The lateral force of a brush saturates by itself: nothing "cannot" be rolled, and what exceeds it is told in per cent.
    #[test]
    fn friction_is_judged_by_the_law_of_the_tyre() {
        let forces = |ratio: f64| ForcesResult {
            friction_max: Some(712.0),
            friction_ratio_max: Some(ratio),
            ..ForcesResult::default()
        };
        let told = friction(&forces(1.000_36), Tyre::Brush);
        assert!(told.contains("0.036 % more than there is") && !told.contains("cannot"), "{told}");
        assert!(friction(&forces(3.0), Tyre::Linear).contains("3 times what there is: the linear law"));
        assert!(friction(&forces(1.5), Tyre::Rigid).ends_with("it cannot roll, and slides"));
        assert!(friction(&forces(0.5), Tyre::Rigid).ends_with("0.5 times what there is: it rolls"));
    }
}
