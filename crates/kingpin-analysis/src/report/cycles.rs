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
use kingpin_report::numbers::{readable, significant};

/// The slowest speed, as part of the fastest.
const SLOWEST: f64 = 1e-2;

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

/// What is said where no Hopf point is up to a speed, and of large cycles that are born of none.
pub(super) fn none_is_born(subject: String, fastest: f64, large_cycles: &str) -> Finding {
    let text = format!(
        "No Hopf point up to {} m/s, so no limit cycle is born of the uniform motion; large ones beside it {large_cycles}.",
        readable(fastest)
    );
    Finding::new(subject, text, "")
}

/// What is said of them; `stable_motion` is whether the uniform motion is stable at the wheel's own speed.
pub(super) fn finding(
    subject: String,
    cycles: &CyclesResult,
    speed: f64,
    stable_motion: Option<bool>,
) -> Finding {
    let mut said = Vec::new();
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
            friction(&point.forces)
        ));
    }
    let error = cycles.points.iter().map(|point| point.cycle.error_estimate).fold(0.0, f64::max);
    let unlocated: usize = cycles.branches.iter().map(|branch| branch.unlocated.len()).sum();
    let check = format!(
        "Collocation; the estimated error of periods and extremes is {} at most, and cycles at a speed asked for are solved for again on a \
         finer mesh.",
        significant(error, 2)
    );
    Finding::new(subject, said.join(". ") + ".", check).undecided_if(unlocated > 0)
}

/// What a cycle asks of the ground.
fn friction(forces: &ForcesResult) -> String {
    let (Some(force), Some(ratio)) = (forces.friction_max, forces.friction_ratio_max) else {
        return String::new();
    };
    let consequence = if ratio < 1.0 { "it rolls" } else { "it cannot roll, and slides" };
    format!(
        "; at its worst moment it asks for {} N of friction, {} times what there is: {consequence}",
        significant(force, 3),
        significant(ratio, 3)
    )
}

/// The branches over the speed.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(cycles: &CyclesResult, radius: f64) -> Result<Option<Illustration>, Error> {
    let caption = format!(
        "Largest and smallest caster angle of the limit cycles over the speed at <i>r</i> = {}, {}; solid where stable, \
         dashed where unstable, dotted where the wheel cannot roll like this.",
        if radius.is_infinite() { "∞".to_owned() } else { format!("{} m", readable(radius)) },
        contact_in_words(&cycles.wheel, Contact::Rolling.model().name())
    );
    Illustration::of(cycles, caption)
}
