//! Whether a motion that was pushed comes back, as the maxima of its caster angle tell.

use super::course::Course;
use super::fate::Target;
use super::maxima::{Maxima, Maximum};
use crate::simulation::SimulationError;
use arclength::control::Control;

/// Follows a motion that was pushed until its maxima decide whether it comes back. It does not where it cannot be followed, or where nothing
/// is decided in `patience` seconds.
///
/// # Errors
/// [`SimulationError::Interrupted`].
pub(super) fn comes_back(
    mut course: Course<'_>,
    patience: f64,
    target: &Target,
    control: &Control<'_>,
    mut verdict: impl FnMut(&[Maximum]) -> Option<bool>,
) -> Result<bool, SimulationError> {
    let (mut maxima, mut nodes, mut time) = (Maxima::default(), Vec::new(), 0.0);
    let piece = target.piece();
    while time < patience {
        match course.follow(piece, target.spacing(), &mut nodes, control) {
            Ok(()) => {}
            Err(SimulationError::Interrupted(interrupted)) => return Err(interrupted.into()),
            Err(_) => return Ok(false),
        }
        nodes.iter().for_each(|node| maxima.take(time, node, f64::INFINITY));
        time += piece;
        if let Some(is_back) = verdict(maxima.list()) {
            return Ok(is_back);
        }
    }
    Ok(false)
}
