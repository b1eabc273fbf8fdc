//! What dampers it takes.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::damper::{DamperRequest, DamperResult, WithoutCycles};
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::Key;
use kingpin_figure::{Axis, Figure, Line, Panel, palette};
use kingpin_report::Columns;
use kingpin_report::numbers::{readable, significant};

/// The part of the lateral dampers in which the line of both may rise steeply, and how many times as high it rises then as elsewhere.
const STEEP_BEGINNING: f64 = 0.05;
const STEEP: f64 = 2.0;

/// The smallest dampers with which no shimmy is born up to a speed.
///
/// # Errors
/// [`Error::Stopped`].
pub(super) fn seek(wheel: &WheelRequest, fastest: f64, control: &Control<'_>) -> Result<DamperResult, Error> {
    let up_to = Assignment { key: "v".to_owned(), value: fastest.to_string() };
    DamperRequest::new(wheel.clone(), up_to).run(control)
}

/// The same for small motions only, at the radius of the wheel.
///
/// # Errors
/// [`Error::Stopped`], no uniform motion up to the speed.
pub(super) fn seek_for_small_motions(
    wheel: &WheelRequest,
    fastest: f64,
    control: &Control<'_>,
) -> Result<DamperResult, Error> {
    let up_to = Assignment { key: "v".to_owned(), value: fastest.to_string() };
    DamperRequest { small_motions: true, ..DamperRequest::new(wheel.clone(), up_to) }.run(control)
}

/// What is said of them.
pub(super) fn finding(subject: String, dampers: &DamperResult) -> Finding {
    let up_to = readable(dampers.up_to);
    let text = match (dampers.c_q, dampers.c_psi) {
        (Some(c_q), Some(c_psi)) if c_q == 0.0 && c_psi == 0.0 => {
            format!("No damper is needed for the uniform motion to be stable up to {up_to} m/s.")
        }
        (lateral, rotational) => {
            let one =
                |damping: f64, key: &str, unit: &str| format!("{key} = {} {unit}", significant(damping, 4));
            let enough: Vec<String> = [
                lateral.map(|damping| one(damping, "c_q", "N s/m")),
                rotational.map(|damping| one(damping, "c_psi", "N m s/rad")),
            ]
            .into_iter()
            .flatten()
            .collect();
            match enough.as_slice() {
                [] => format!("No damper that was tried makes the uniform motion stable up to {up_to} m/s."),
                some => format!(
                    "For the uniform motion to be stable up to {up_to} m/s it takes {}.",
                    some.join(", or ")
                ),
            }
        }
    };
    let mut text = text;
    if let Some(isola_free) = &dampers.isola_free {
        let found = [(&isola_free.c_q, "c_q", "N s/m"), (&isola_free.c_psi, "c_psi", "N m s/rad")];
        let said: Vec<String> =
            found.iter().filter_map(|(found, key, unit)| large_cycles(found.as_ref()?, key, unit)).collect();
        if !said.is_empty() {
            text.push_str(&format!(" That no large cycle is found either takes {}.", said.join(", or ")));
        }
    }
    let slowest: Vec<&str> = dampers.decided_by_the_slowest().into_iter().map(Key::name).collect();
    if !slowest.is_empty() {
        text.push_str(&format!(
            " Over {} the lowest speed decides that was looked at: lower ones may take more.",
            slowest.join(" and ")
        ));
    }
    // Beside its own a wheel takes less.
    if let Some(own) = dampers.replaced_dampers() {
        text.push_str(&format!(" All this is without the wheel's own dampers ({own})."));
    }
    let check = if dampers.isola_free.is_none() {
        "The dampers with which the motion gains its stability, sought over all speeds. Large cycles were not sought."
    } else {
        "The dampers with which the motion gains its stability, sought over all speeds; cycles followed from the Hopf points of weaker dampers along speed and \
                 damping, their folds in both, and strong random kicks with a hundredth more than the damper. What was searched is no proof \
                 that there is no other large cycle."
    };
    Finding::new(subject, text, check).undecided_if(dampers.c_q.is_none() && dampers.c_psi.is_none())
}

/// The same in a few words, of a path where that has to be said: what it takes that nothing was found which does not return or, where that is
/// not known, for small motions.
pub(super) fn in_short(dampers: &DamperResult, path: Option<&str>) -> String {
    let path = path.map_or_else(String::new, |path| format!("{path}, "));
    format!("{path}{}", requirement(dampers))
}

fn requirement(dampers: &DamperResult) -> String {
    let up_to = format!("up to {} m/s", readable(dampers.up_to));
    let quantities = |values: [Option<f64>; 2]| {
        let units = [("c_q", "N s/m"), ("c_psi", "N m s/rad")];
        let known =
            values.into_iter().zip(units).filter_map(|(value, (key, unit))| Some((value?, key, unit)));
        known
            .map(|(value, key, unit)| format!("{key} = {} {unit}", significant(value, 4)))
            .collect::<Vec<_>>()
    };
    let none_needed = |values: [Option<f64>; 2]| values.contains(&Some(0.0));
    let large = dampers.isola_free.as_ref();
    let safe = [large.and_then(|large| large.c_q.as_ref()), large.and_then(|large| large.c_psi.as_ref())];
    let safe = safe.map(|found| found.and_then(|found| found.damping));
    let small = [dampers.c_q, dampers.c_psi];
    let instead = if dampers.replaced_dampers().is_some() { " instead of yours" } else { "" };
    match (quantities(safe).as_slice(), quantities(small).as_slice()) {
        _ if none_needed(safe) => format!("it takes no damper to be safe {up_to}"),
        ([], _) if none_needed(small) => format!("small motions die out {up_to} without any damper"),
        ([], []) => format!("no damper that was tried makes it stable {up_to}"),
        ([], small) => {
            format!("for small motions to die out {up_to} it takes {}{instead}", small.join(" or "))
        }
        (safe, _) => format!("to be safe {up_to} it takes {}{instead}", safe.join(" or ")),
    }
}

/// What one damper alone takes so that no large cycle is found; nothing where that is not known.
fn large_cycles(found: &WithoutCycles, key: &str, unit: &str) -> Option<String> {
    let damping = found.by_continuation?;
    let kicked = match &found.kicked {
        Some(kicked) if kicked.returned < kicked.kicks => match kicked.none_lost {
            _ if kicked.ends.is_empty() => format!(" ({kicked})"),
            Some(damper) => {
                format!(" ({kicked}, so that is not enough; none does so with {})", significant(damper, 4))
            }
            None => format!(" ({kicked}, so that is not enough)"),
        },
        _ => String::new(),
    };
    if damping == 0.0 {
        return Some(format!("no {key}{kicked}"));
    }
    Some(format!("{key} = {} {unit}{kicked}", significant(damping, 4)))
}

/// Both dampers together; nothing where none is needed.
pub(super) fn illustration(dampers: &DamperResult) -> Option<Illustration> {
    let front = &dampers.front;
    if front.c_q.len() < 2 {
        return None;
    }
    let points = front.c_q.iter().copied().zip(front.c_psi.iter().copied());
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let end = |values: &[f64]| 1.05 * largest(values);
    // A line that rises steeply at its first points would hide what it does elsewhere.
    let beginning = STEEP_BEGINNING * largest(&front.c_q);
    let elsewhere: Vec<f64> =
        points.clone().filter(|(c_q, _)| *c_q >= beginning).map(|(_, c_psi)| c_psi).collect();
    let is_cut = largest(&front.c_psi) > STEEP * largest(&elsewhere);
    let top = if is_cut { STEEP * largest(&elsewhere) } else { end(&front.c_psi) };
    let panel = Panel::new(
        Axis::new("$c_q$ (N s/m)").limits(0.0, end(&front.c_q)),
        Axis::new("$c_\\psi$ (N m s/rad)").limits(0.0, top),
    )
    .curve(Line::new(points).color(palette::BLUE));
    let figure = Figure::single_column()
        .description("Smallest damper about the king pin beside a lateral damper")
        .panel(panel);
    let mut caption = format!(
        "Dampers with which the uniform motion is stable up to {} m/s lie above the line.",
        readable(dampers.up_to)
    );
    if is_cut {
        let [first_lateral, first] = [front.c_q[0], front.c_psi[0]].map(|damping| significant(damping, 4));
        caption += &format!(
            " It leaves the picture: beside <i>c</i><sub>q</sub> = {first_lateral} N s/m it takes {first} N m s/rad."
        );
    }
    let data = Columns::new()
        .numbers("c_q", front.c_q.iter().copied())
        .unit("N s/m")
        .numbers("c_psi", front.c_psi.iter().copied())
        .unit("N m s/rad");
    Some(Illustration { figure, data, caption })
}
