//! The smallest blow from which a wheel that may slide does not return, over the speed.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::classification::{Classification, Contact};
use crate::error::Error;
use crate::margin::{MarginPoint, MarginRequest, MarginResult};
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Control, SampledInterval};
use kingpin::Key;
use kingpin_report::numbers::{readable, significant};

/// Speeds at which it is sought: each takes as long as the blow at the wheel's own. With dry friction motions stick and slip for long, and a
/// speed takes ten times as long.
const SPEEDS: usize = 4;
const SPEEDS_WITH_DRY_FRICTION: usize = 3;
/// The slowest and the fastest of them, as parts of the speeds at which the uniform motion is stable: at their very end no blow is small enough, and
/// near it motions take long to return.
const INSIDE: [f64; 2] = [0.2, 0.95];

/// Seeks it at some speeds of a range in which the uniform motion is stable.
///
/// # Errors
/// A motion that cannot be followed, [`Error::Stopped`].
pub(super) fn seek(
    wheel: &WheelRequest,
    stable: [f64; 2],
    control: &Control<'_>,
) -> Result<MarginResult, Error> {
    let is_dry = wheel.read()?.get(Key::MF) > 0.0;
    let speeds = if is_dry { SPEEDS_WITH_DRY_FRICTION } else { SPEEDS };
    let [low, high] = INSIDE.map(|part| stable[0] + part * (stable[1] - stable[0]));
    let request = MarginRequest {
        wheel: wheel.clone(),
        along: SampledInterval::new("v", low, high, speeds),
        classification: Classification { contact: Some(Contact::Sliding), ..Classification::default() },
        ..MarginRequest::default()
    };
    let analysis = request.validate()?;
    let journal = analysis.journal(None, false)?;
    match analysis.run(control, &journal) {
        Err(Error::Interrupted { .. }) => Err(Error::Stopped),
        result => result,
    }
}

/// What is said of it.
pub(super) fn finding(subject: String, result: &MarginResult) -> Finding {
    let failing = |point: &MarginPoint| {
        let edges = [point.found.positive, point.found.negative].into_iter().flatten();
        let edges = edges.filter(|edge| !edge.is_undecided());
        edges.map(|edge| edge.fails.abs()).min_by(f64::total_cmp)
    };
    let (low, high) = result.interval.ends();
    let range = format!("{} and {} m/s", significant(low, 3), significant(high, 3));
    let found: Vec<(f64, f64)> =
        result.points.iter().filter_map(|point| Some((point.value, failing(point)?))).collect();
    let weakest = found.iter().min_by(|one, other| one.1.total_cmp(&other.1));
    let text = match weakest {
        None => format!(
            "At {} speeds between {range} the wheel returned from every blow on its rim that was tried, or it is undecided whether.",
            result.points.len()
        ),
        Some((speed, blow)) => format!(
            "At {} of {} speeds between {range} a blow was found from which the wheel does not return: the smallest, {} N s, at {} m/s.",
            found.len(),
            result.points.len(),
            significant(*blow, 3),
            significant(*speed, 3)
        ),
    };
    let undecided = result.points.iter().filter(|point| point.safe.is_none() && failing(point).is_none());
    let problems = undecided.filter(|point| {
        let edges = [point.found.positive, point.found.negative];
        point.found.problem.is_some() || edges.iter().any(Option::is_some)
    });
    let check = "At each speed as for one speed, which the section on the blow tells. Between the speeds nothing was computed.";
    Finding::new(subject, text, check).undecided_if(problems.count() > 0)
}

/// The blows over the speed.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(result: &MarginResult, radius: f64) -> Result<Option<Illustration>, Error> {
    let has_edge = |point: &MarginPoint| point.found.positive.is_some() || point.found.negative.is_some();
    if !result.points.iter().any(has_edge) {
        return Ok(None);
    }
    let radius = if radius.is_infinite() { "∞".to_owned() } else { format!("{} m", readable(radius)) };
    Illustration::of(
        result,
        format!(
            "Largest sideways blow on the rim from which the wheel returns in either direction, rolling and sliding, over the speed at <i>r</i> = \
             {radius}, and the amplitude of the unstable cycle of ideal rolling."
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::classification::NamedFate;
    use crate::disturbance::Edge;
    use arclength_analysis::Assignment;
    use kingpin::basin::Fate;

    /// With this damper the trolley returns from every blow up to 1.1448 m/s (`kingpin margin`).
    #[test]
    fn blows_over_the_speed_are_told_and_shown_as_far_as_they_were_found() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels/trolley.toml");
        let set = vec![Assignment { key: "c_psi".to_owned(), value: "0.02".to_owned() }];
        let wheel = WheelRequest { wheel: Some(file.into()), set };
        let mut result = seek(&wheel, [0.0, 1.0], &Control::none()).unwrap();
        assert_eq!(result.points.len(), SPEEDS);
        let told = finding("blow over the speed".to_owned(), &result);
        let all = "At 4 speeds between 0.2 and 0.95 m/s the wheel returned from every blow";
        assert!(told.text.starts_with(all) && !told.undecided, "{told:?}");
        assert!(illustration(&result, 2.0).unwrap().is_none());
        // As if it did not at the third.
        let edge = |fails: f64| {
            let fate = Some(NamedFate(Fate::Shimmy));
            Some(Edge { returns: 0.99 * fails, fails, fate, smaller_are_undecided: false })
        };
        (result.points[2].found.positive, result.points[2].found.negative) = (edge(0.4), edge(-0.3));
        let told = finding("blow over the speed".to_owned(), &result).text;
        assert!(told.starts_with("At 1 of 4 speeds") && told.ends_with("0.3 N s, at 0.7 m/s."), "{told}");
        assert!(illustration(&result, 2.0).unwrap().unwrap().caption.contains("<i>r</i> = 2 m"));
    }
}
