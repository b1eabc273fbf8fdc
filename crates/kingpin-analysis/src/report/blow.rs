//! The smallest blow from which the wheel does not return.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::classification::{Classification, Contact};
use crate::disturbance::DisturbanceRequest;
use crate::error::Error;
use crate::safe_kick::{SafeKickRequest, SafeKickResult};
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin_report::numbers::{readable, significant};

/// Seeks it.
///
/// # Errors
/// A motion that cannot be followed, [`Error::Stopped`].
pub(super) fn seek(
    wheel: &WheelRequest,
    contact: Contact,
    control: &Control<'_>,
) -> Result<SafeKickResult, Error> {
    let disturbance = DisturbanceRequest::default();
    let classification = Classification { contact: Some(contact), ..Classification::default() };
    let request = SafeKickRequest { wheel: wheel.clone(), disturbance, classification };
    request.validate()?.run(control)
}

/// The motions on both sides of the edge.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(result: &SafeKickResult) -> Result<Option<Illustration>, Error> {
    let contact = if result.contact == "rolling" { "with ideal rolling" } else { "rolling and sliding" };
    let caption = format!(
        "Caster angle over time after the largest blow from which the wheel returns and the smallest from which it does not, {contact}."
    );
    Illustration::of(result, caption)
}

/// What is said of it.
pub(super) fn finding(subject: String, result: &SafeKickResult, speed: f64) -> Finding {
    let smallest = [result.positive, result.negative]
        .into_iter()
        .flatten()
        .min_by(|a, b| a.fails.abs().total_cmp(&b.fails.abs()));
    let speed = readable(speed);
    let check = format!(
        "Every {} N s up to {} N s in both directions, each motion integrated until it settles, at most {} s; the edge is halved to {} N s. \
         Failures in a narrower range may lie below it.",
        significant(result.resolution, 3),
        readable(result.largest),
        readable(result.duration),
        significant(result.resolution_beside_edge, 3)
    );
    match smallest {
        None => {
            let text = format!(
                "At {speed} m/s the wheel returns from every sideways blow on its rim up to {} N s.",
                readable(result.largest)
            );
            Finding::new(subject, text, check)
        }
        Some(edge) if edge.is_undecided() => {
            let text = format!(
                "At {speed} m/s the wheel returns from blows up to {} N s; what becomes of it beyond is undecided.",
                significant(edge.returns.abs(), 4)
            );
            Finding::new(subject, text, check).undecided_if(true)
        }
        Some(edge) => {
            let text = format!(
                "At {speed} m/s the smallest sideways blow on the rim from which the wheel does not return is {} N s; it ends in {}.",
                significant(edge.fails.abs(), 4),
                edge.ending()
            );
            Finding::new(subject, text, check)
        }
    }
}
