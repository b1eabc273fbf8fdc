//! The search for Hopf points, which must find one.

use super::course::{ends, turns, unlocated_changes};
use crate::description;
use crate::error::{Error, unless_stopped};
use crate::neglected_dry_friction::NeglectedDryFriction;
use arclength::equilibrium::EquilibriumPoint;
use arclength_analysis::Control;
use kingpin::branches::{Along, MotionBranch, MotionOptions};
use kingpin::{Key, Wheel};
use kingpin_report::numbers::readable;

/// Relative distance of parameter values within which two Hopf points are the same.
const SAME_HOPF_POINT: f64 = 1e-6;

/// The Hopf points of the interval, of which there must be one.
///
/// # Errors
/// [`Error::NothingFound`] with the stability at both ends, and those of the search.
pub(crate) fn search(
    wheel: &Wheel,
    along: Along,
    options: &MotionOptions,
    control: &Control<'_>,
) -> Result<MotionBranch, Error> {
    let branch = wheel.motion_branch(along, options, |value| {
        control.at(&format!("uniform motions, {} = {}", along.key(), readable(value)));
        control.flow()
    })?;
    if !branch.hopf_points.is_empty() {
        return Ok(branch);
    }
    unless_stopped(control)?;
    Err(Error::NothingFound(nothing_found(wheel, along, &branch)))
}

/// That there is no Hopf point, with the stability at both ends and what to try.
fn nothing_found(wheel: &Wheel, along: Along, branch: &MotionBranch) -> String {
    let end = |motion: Option<&EquilibriumPoint>| {
        motion.map_or((f64::NAN, None), |motion| (motion.value, motion.stability.is_stable()))
    };
    let [(low, low_stable), (high, high_stable)] = [end(branch.motions.first()), end(branch.motions.last())];
    let stability = |stable: Option<bool>| match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "of undecided stability",
    };
    let (start, end) = along.ends();
    let mut message = format!(
        "no Hopf point for {} from {} to {} at {}: the uniform motion is {} at {} and {} at {}",
        along.key(),
        readable(start),
        readable(end),
        description::of(wheel, &[along.key()]),
        stability(low_stable),
        description::quantity(along.key(), low),
        stability(high_stable),
        description::quantity(along.key(), high),
    );
    for sentence in turns(branch).chain(ends(branch)) {
        message += &format!("; {sentence}");
    }
    let changes: Vec<String> = unlocated_changes(branch).collect();
    if !changes.is_empty() {
        return format!("{message}; {}", changes.join("; "));
    }
    message += &if let Some(always) = always(wheel, along.key(), [low_stable, high_stable]) {
        always
    } else if let Some(elsewhere) = elsewhere(wheel, along) {
        elsewhere
    } else if does_not_act(wheel, along.key(), [low, high]) {
        format!(
            "; {} does not act on the stability of this wheel: the eigenvalues stay the same",
            along.key()
        )
    } else {
        "; try a wider interval, or see with `kingpin chart` where the stability changes".to_owned()
    };
    let neglected = NeglectedDryFriction::of(wheel, &[along.key()]);
    for sentence in neglected.iter().flat_map(NeglectedDryFriction::sentences) {
        message += &format!("; {sentence}");
    }
    message
}

/// At which speeds outside the interval the stability changes, where the speed varies, as `stability` finds them; or that it finds none.
fn elsewhere(wheel: &Wheel, along: Along) -> Option<String> {
    if along.key() != Key::V {
        return None;
    }
    let over_speed = wheel.stability_over_speed(&Control::none()).ok()?;
    let (start, end) = along.ends();
    let outside: Vec<String> = over_speed
        .changes
        .iter()
        .filter(|speed| !(start..=end).contains(*speed))
        .map(|speed| readable(*speed))
        .collect();
    let [low, high] = over_speed.searched.map(readable);
    match outside.as_slice() {
        [] if over_speed.changes.is_empty() => {
            Some(format!("; no change of its stability was found from {low} to {high} m/s"))
        }
        [] => None,
        speeds => Some(format!("; its stability changes at {} m/s", speeds.join(", "))),
    }
}

/// That a wheel has one stability at every speed, where that is known in closed form and the speed varies; an unstable one with what
/// dry friction about the king pin makes of it.
fn always(wheel: &Wheel, key: Key, ends: [Option<bool>; 2]) -> Option<String> {
    if key != Key::V || ends[0].is_none() || ends[0] != ends[1] {
        return None;
    }
    let over_speed = wheel.stability_over_speed(&Control::none()).ok()?;
    if !over_speed.is_complete || !over_speed.changes.is_empty() || wheel.critical_speed().is_some() {
        return None;
    }
    if ends[0] == Some(true) {
        return Some("; it is stable at every speed".to_owned());
    }
    let with_friction = match wheel.critical_speed_with_friction() {
        // With a moment of its own it is told at the end.
        _ if !wheel.get(Key::TurningRadius).is_infinite() || wheel.get(Key::MF) > 0.0 => String::new(),
        Some(0.0) => {
            "; with dry friction about the king pin small motions grow at every speed all the same".to_owned()
        }
        Some(speed) => format!(
            "; with dry friction about the king pin, however little, small motions die out up to {} m/s",
            readable(speed)
        ),
        None => {
            "; with dry friction about the king pin, however little, small motions die out at every speed"
                .to_owned()
        }
    };
    Some(format!(
        "; it is unstable at every speed; `kingpin damper` tells what makes it stable{with_friction}"
    ))
}

/// Whether the eigenvalues are the same, to the last digit, at both ends of an interval of a key and in its middle.
fn does_not_act(wheel: &Wheel, key: Key, [low, high]: [f64; 2]) -> bool {
    let eigenvalues = |value: f64| {
        let motion = wheel.with(key, value).ok()?.uniform_motion().ok()?;
        Some(motion.eigenvalues())
    };
    let first = eigenvalues(low);
    low != high
        && first.is_some()
        && [0.5 * (low + high), high].into_iter().all(|value| eigenvalues(value) == first)
}

/// Label of the Hopf point with an index.
pub(crate) fn label(index: usize) -> String {
    format!("HB{}", index + 1)
}

/// Whether two values of the parameter are those of one Hopf point.
pub(crate) fn same_value(first: f64, second: f64) -> bool {
    first == second || (first - second).abs() <= SAME_HOPF_POINT * first.abs().max(second.abs())
}
