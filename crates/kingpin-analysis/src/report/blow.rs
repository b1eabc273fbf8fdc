//! The smallest blow from which the wheel does not return.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::classification::{Classification, Contact, contact_in_words, may_slide};
use crate::disturbance::DisturbanceRequest;
use crate::error::Error;
use crate::safe_kick::{SafeKickRequest, SafeKickResult};
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin::basin::SafeKick;
use kingpin::{Tyre, Wheel};
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

/// The motions on both sides of the edge, as far as there are any.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(result: &SafeKickResult) -> Result<Option<Illustration>, Error> {
    if result.fails.is_none() {
        // The words are in the finding.
        return Ok(None);
    }
    let contact = contact_in_words(&result.wheel, result.contact);
    let shown = result.shown().replace("impulse", "blow");
    Illustration::of(result, format!("Caster angle over time after {shown}: {contact}."))
}

/// What is said of it.
pub(super) fn finding(subject: String, result: &SafeKickResult, speed: f64) -> Finding {
    let speed = readable(speed);
    let largest = readable(result.largest);
    let blow = |magnitude: f64| significant(magnitude.abs(), 4);
    let edge = result.nearest();
    let text = match edge {
        None => {
            format!(
                "At {speed} m/s the wheel returns from every sideways blow on its rim up to {largest} N s."
            )
        }
        Some(edge) if edge.is_unstable() => {
            format!("At {speed} m/s small motions grow: no blow is small enough.")
        }
        Some(edge) if edge.none_returns() => format!(
            "At {speed} m/s no blow was found from which the wheel returns, however small; it ends in {}.",
            edge.ending()
        ),
        Some(edge) if edge.smaller_are_undecided => {
            let found = if edge.is_found() {
                format!(
                    "After one of {} N s it does not return; it ends in {}.",
                    blow(edge.fails),
                    edge.ending()
                )
            } else {
                format!("After none up to {largest} N s it was found to end elsewhere.")
            };
            format!(
                "At {speed} m/s on this circle small motions grow without dry friction about the king pin, and whether they die out with \
                 it is not known: so it is undecided whether the wheel returns from a small sideways blow on its rim. {found}"
            )
        }
        Some(edge) if edge.is_undecided() => format!(
            "At {speed} m/s the wheel returns from blows up to {} N s; what becomes of it beyond is undecided.",
            blow(edge.returns)
        ),
        Some(edge) => format!(
            "At {speed} m/s the smallest sideways blow on the rim from which the wheel does not return is {} N s; it ends in {}.",
            blow(edge.fails),
            edge.ending()
        ),
    };
    let text = format!("{text}{}", limit_of_the_model(&result.wheel));
    Finding::new(subject, text, check(result)).undecided_if(edge.is_some_and(|edge| edge.is_undecided()))
}

/// The same in a few words.
pub(super) fn in_short(result: &SafeKickResult, speed: f64) -> String {
    let speed = readable(speed);
    // Where the wheel may slide, that is what is meant.
    let rolls = may_slide(&result.wheel) && result.contact == Contact::Rolling.model().name();
    let how = if rolls { ", if it rolls ideally" } else { "" };
    match result.nearest() {
        None => {
            let largest = significant(result.largest, 3);
            format!("at {speed} m/s it returns from every blow up to {largest} N s{how}")
        }
        Some(edge) if edge.is_unstable() => format!("at {speed} m/s no blow is small enough"),
        Some(edge) if edge.none_returns() => {
            format!("at {speed} m/s no blow was found from which it returns{how}")
        }
        Some(edge) if edge.is_undecided() => {
            format!("at {speed} m/s it is undecided what blow is too hard{how}")
        }
        Some(edge) => {
            let what = match edge.ending() {
                "shimmy" => "starts shimmy".to_owned(),
                ending => format!("ends in {ending}"),
            };
            let fails = significant(edge.fails.abs(), 3);
            format!("smallest blow that {what} at {speed} m/s: {fails} N s{how}")
        }
    }
}

/// What the model of the contact does not have.
fn limit_of_the_model(wheel: &Wheel) -> &'static str {
    match wheel.tyre() {
        _ if may_slide(wheel) => "",
        Tyre::Rigid => {
            " With k_u = inf the wheel rolls whatever force that takes: there is no sliding in this model."
        }
        Tyre::Linear | Tyre::Brush => {
            " What force the ground supplies is told by the law of the tyre: there is no other sliding in this model."
        }
    }
}

/// Which blows were tried, and for how long their motions were followed.
fn check(result: &SafeKickResult) -> String {
    if result.nearest().is_some_and(|edge| edge.is_unstable()) {
        return String::new();
    }
    let number = |value: f64| significant(value, 3);
    let finer = match result.nearest().filter(|edge| !edge.is_open()) {
        Some(_) if result.resolution > 0.0 => format!(
            ", then every {} N s up to the smallest with another end, and every {} N s just below it",
            number(result.resolution),
            number(result.resolution_beside_edge)
        ),
        // Nothing is left below.
        Some(_) => ", then ever smaller ones, down to a billionth of that".to_owned(),
        None => String::new(),
    };
    format!(
        "Every {} N s up to {} N s in both directions{finer}; each motion is followed for {} s, ten times as long while it swings unsettled. \
         Failures in a narrower range may lie between.",
        number(SafeKick::resolution(result.largest)),
        readable(result.largest),
        readable(result.duration)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use arclength_analysis::Assignment;

    /// A trolley on a circle on which small motions grow without its dry friction.
    fn struck(largest: f64) -> SafeKickResult {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels/trolley.toml");
        let set = [("r", "3"), ("M_f", "0.3")];
        let set = set.map(|(key, value)| Assignment { key: key.to_owned(), value: value.to_owned() });
        let wheel = WheelRequest { wheel: Some(file.into()), set: set.into() };
        let disturbance = DisturbanceRequest { largest: Some(largest), ..DisturbanceRequest::default() };
        let classification = Classification { contact: Some(Contact::Rolling), duration: Some(1.0) };
        let request = SafeKickRequest { wheel, disturbance, classification };
        request.validate().unwrap().run(&Control::none()).unwrap()
    }

    #[test]
    fn where_nothing_is_known_to_return_nothing_is_said_to() {
        let small = struck(1e-3);
        let said = finding("blow".to_owned(), &small, 1.5);
        assert!(
            said.undecided
                && said.text.ends_with("After none up to 0.001 N s it was found to end elsewhere.")
        );
        let tried = "Every 1.56e-5 N s up to 0.001 N s in both directions; each motion";
        assert!(said.check.starts_with(tried), "{}", said.check);
        assert!(illustration(&small).unwrap().is_none());
    }

    #[test]
    fn the_smallest_that_ends_elsewhere_is_told_and_shown() {
        let large = struck(0.6);
        let said = finding("blow".to_owned(), &large, 1.5);
        assert!(said.undecided && said.text.contains("N s it does not return; it ends in"), "{}", said.text);
        assert!(said.check.contains("N s up to 0.6 N s in both directions, then every"));
        let shown = illustration(&large).unwrap().unwrap();
        let caption =
            "Caster angle over time after the smallest blow that was found not to return: ideal rolling.";
        assert_eq!(shown.caption, caption);
    }
}
