//! The shimmy that remains: what a wheel that may slide swings by for ever, where small motions grow or after a strong blow.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::error::{Error, unless_stopped};
use crate::shimmy::{ShimmyPointResult, ShimmyRequest, ShimmyResult};
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Control, Interval};
use kingpin::Tyre;
use kingpin_report::numbers::{readable, significant};

/// The slowest speed, as part of the fastest, of a wheel whose small motions grow at every speed; and that of one whose small motions grow from some
/// speed on, as part of that.
const SLOWEST: f64 = 0.1;
const BELOW_CRITICAL: f64 = 0.9;
/// Most motions of a branch in one direction. The branches of real wheels take about as many; near an end at which a motion is very unstable each
/// takes long, and the report has to end.
const STEPS: u32 = 25;
/// What a search says of motions of which nothing can be told.
const UNSETTLED: &str = "does not settle";

const PER_CENT: f64 = 100.0;

/// What a search for shimmy over the speed came to.
pub(super) enum Shimmy {
    Found(Box<ShimmyResult>),
    /// None, with what was tried.
    None(String),
}

/// What the report says of the speeds at which shimmy is sought.
#[derive(Clone, Copy)]
pub(super) struct Searched {
    /// The wheel's own.
    pub speed: f64,
    pub fastest: f64,
    /// Whether the uniform motion is stable at the wheel's own speed, where that is decided.
    pub stable: Option<bool>,
    /// The slowest speeds at which it is stable.
    pub stable_speeds: Option<[f64; 2]>,
}

impl Searched {
    /// Where shimmy begins motions are very unstable, and following them takes a minute: there is no search at speeds at which small motions die
    /// out, but for those next to the others.
    fn slowest(self) -> f64 {
        match self.stable_speeds {
            Some([_, critical]) if self.stable == Some(true) => BELOW_CRITICAL * critical,
            Some([_, critical]) if critical < self.speed => self.speed,
            _ if self.speed > 0.0 => self.speed.min(SLOWEST * self.fastest),
            _ => SLOWEST * self.fastest,
        }
    }

    /// Kicks the wheel over the speeds and follows what settles.
    ///
    /// # Errors
    /// A wheel that cannot slide in this program, [`Error::Stopped`].
    pub(super) fn seek(self, wheel: &WheelRequest, control: &Control<'_>) -> Result<Shimmy, Error> {
        let along = Interval::new("v", self.slowest(), self.fastest);
        let at = Some(self.speed).filter(|speed| along.contains(*speed)).into_iter().collect();
        let request = ShimmyRequest { wheel: wheel.clone(), at, steps: STEPS, ..ShimmyRequest::new(along) };
        let found = match request.validate()?.run(control) {
            Ok(result) => Shimmy::Found(Box::new(result)),
            Err(Error::NothingFound(tried)) => Shimmy::None(tried),
            Err(error) => return Err(error),
        };
        // A search that was stopped has what it found up to there.
        unless_stopped(control)?;
        Ok(found)
    }

    /// The stable motion at the wheel's own speed.
    fn here(self, result: &ShimmyResult) -> Option<&ShimmyPointResult> {
        stable(result).find(|point| point.value == self.speed)
    }

    /// What is said of it.
    pub(super) fn finding(self, subject: String, shimmy: &Shimmy) -> Finding {
        let range = format!("{} to {} m/s", readable(self.slowest()), readable(self.fastest));
        let is_left_open = self.stable != Some(true);
        match shimmy {
            Shimmy::None(tried) => {
                let text = format!("No shimmy was found at speeds from {range}.");
                let undecided = is_left_open || tried.contains(UNSETTLED);
                Finding::new(subject, text, format!("{tried}.")).undecided_if(undecided)
            }
            Shimmy::Found(result) => {
                let mut said = vec![extent(result).unwrap_or_else(|| {
                    format!("No stable shimmy was found at speeds from {range}, only unstable motions")
                })];
                let here = self.here(result);
                said.extend(here.map(|point| motion(point, self.speed)));
                if here.is_none() && is_left_open {
                    said.push(format!(
                        "What the wheel settles on at {} m/s was not found",
                        readable(self.speed)
                    ));
                }
                let undecided = here.is_none() && is_left_open;
                Finding::new(subject, said.join(". ") + ".", check(result)).undecided_if(undecided)
            }
        }
    }

    /// The same in a few words; nothing where none was found.
    pub(super) fn in_short(self, shimmy: &Shimmy) -> Option<String> {
        let Shimmy::Found(result) = shimmy else { return None };
        if let Some(point) = self.here(result) {
            let how =
                if self.stable == Some(true) { "after a strong blow it may shimmy" } else { "it shimmies" };
            return Some(format!(
                "{how} at {} m/s by {} rad, {} times a second",
                readable(self.speed),
                significant(reach(point), 3),
                significant(point.period.recip(), 3)
            ));
        }
        let largest = stable(result).map(reach).fold(0.0, f64::max);
        (largest > 0.0).then(|| {
            format!(
                "it shimmies by up to {} rad {}",
                significant(largest, 3),
                in_words(&stable_parts(result))
            )
        })
    }
}

fn stable(result: &ShimmyResult) -> impl Iterator<Item = &ShimmyPointResult> {
    result.points.iter().filter(|point| point.stable == Some(true))
}

/// Largest caster angle of a motion in either direction.
fn reach(point: &ShimmyPointResult) -> f64 {
    point.psi_max.abs().max(point.psi_min.abs())
}

/// The speeds at which stable motions follow one another on a branch.
fn stable_parts(result: &ShimmyResult) -> Vec<[f64; 2]> {
    let mut parts: Vec<[f64; 2]> = Vec::new();
    let mut before = None;
    for point in &result.points {
        let is_stable = point.stable == Some(true);
        let goes_on = before == Some(point.branch);
        match parts.last_mut() {
            Some([low, high]) if is_stable && goes_on => {
                (*low, *high) = (low.min(point.value), high.max(point.value));
            }
            _ if is_stable => parts.push([point.value; 2]),
            _ => {}
        }
        // A bifurcation ends a part.
        before = is_stable.then_some(point.branch);
    }
    parts.retain(|[low, high]| high > low);
    parts.sort_by(|one, other| one[0].total_cmp(&other[0]));
    // Several branches may be stable at one speed.
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        match joined.last_mut() {
            Some([_, high]) if part[0] <= *high => *high = high.max(part[1]),
            _ => joined.push(part),
        }
    }
    joined
}

fn in_words(parts: &[[f64; 2]]) -> String {
    let part =
        |[low, high]: &[f64; 2]| format!("from {} to {} m/s", significant(*low, 4), significant(*high, 4));
    parts.iter().map(part).collect::<Vec<_>>().join(" and ")
}

/// Where there is stable shimmy, and how bad it is there; nothing where none is stable.
fn extent(result: &ShimmyResult) -> Option<String> {
    let ends = |quantity: fn(&ShimmyPointResult) -> f64| {
        stable(result)
            .map(quantity)
            .fold([f64::INFINITY, 0.0_f64], |[low, high], value| [low.min(value), high.max(value)])
    };
    let parts = stable_parts(result);
    if parts.is_empty() {
        return None;
    }
    let ([smallest, largest], [slowest, fastest]) = (ends(reach), ends(|point| point.period.recip()));
    let force = stable(result).filter_map(|point| point.forces.king_pin_force_max).fold(0.0, f64::max);
    let how = match result.wheel.tyre() {
        Tyre::Rigid => "Sliding bounds the motion: stable shimmy, rolling and sliding in turn,",
        _ => "Stable shimmy",
    };
    let mut text = format!(
        "{how} was found {} at least, with caster angles that reach {} to {} rad, {} to {} times a second",
        in_words(&parts),
        significant(smallest, 3),
        significant(largest, 3),
        significant(slowest, 3),
        significant(fastest, 3)
    );
    if force > 0.0 {
        text += &format!(" and up to {} N on the king pin", significant(force, 3));
    }
    Some(text)
}

/// What the wheel does at its own speed.
fn motion(point: &ShimmyPointResult, speed: f64) -> String {
    let mut text = format!(
        "At {} m/s the caster angle swings from {} to {} rad with a period of {} s",
        readable(speed),
        significant(point.psi_min, 4),
        significant(point.psi_max, 4),
        significant(point.period, 5)
    );
    if point.sliding_fraction > 0.0 {
        text += &format!(
            ", and the wheel slides for {} % of it",
            significant(PER_CENT * point.sliding_fraction, 3)
        );
    }
    let forces = &point.forces;
    if let (Some(friction), Some(ratio)) = (forces.friction_max, forces.friction_ratio_max) {
        text += &format!(
            "; it uses up to {} N of friction, {} % of what there is at rest",
            significant(friction, 3),
            significant(PER_CENT * ratio, 3)
        );
    }
    if let Some(force) = forces.king_pin_force_max {
        text += &format!(", and takes {} N on the king pin", significant(force, 3));
    }
    if let Some(power) = point.sliding_power {
        text += &format!("; sliding takes {} W", significant(power, 3));
    }
    text
}

/// What was searched.
fn check(result: &ShimmyResult) -> String {
    let mut speeds: Vec<String> = result.tried.iter().map(|attempt| readable(attempt.value)).collect();
    speeds.dedup();
    let error = result.points.iter().map(|point| point.error_estimate).fold(0.0, f64::max);
    format!(
        "{} kicks at {} m/s; what settled was followed both ways along the speed, and is stable by its Floquet multipliers. The estimated \
         error of periods and extremes is {} at most (relative). There may be other shimmy, and at other speeds.",
        result.tried.len(),
        speeds.join(", "),
        significant(error, 2)
    )
}

/// The branches over the speed.
///
/// # Errors
/// The picture cannot be drawn.
pub(super) fn illustration(shimmy: &Shimmy, radius: f64) -> Result<Option<Illustration>, Error> {
    let Shimmy::Found(result) = shimmy else { return Ok(None) };
    let slides = result.wheel.tyre() == Tyre::Rigid;
    let radius = if radius.is_infinite() { "∞".to_owned() } else { format!("{} m", readable(radius)) };
    let caption = format!(
        "Largest and smallest caster angle of the shimmy that remains over the speed at <i>r</i> = {radius}{}; solid where stable, dashed \
         where unstable.{}",
        if slides { ", rolling and sliding" } else { "" },
        if slides { " GR: the order of rolling and sliding changes." } else { "" }
    );
    Illustration::of(result.as_ref(), caption)
}

#[cfg(test)]
mod tests {
    use super::*;
    use arclength_analysis::Assignment;

    const TROLLEY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels/trolley.toml");

    fn sought(set: &[(&str, &str)], stable: bool) -> (Searched, Shimmy) {
        let set = set.iter().map(|(key, value)| Assignment { key: (*key).into(), value: (*value).into() });
        let wheel = WheelRequest { wheel: Some(TROLLEY.into()), set: set.collect() };
        let searched = Searched { speed: 1.5, fastest: 1.6, stable: Some(stable), stable_speeds: None };
        let found = searched.seek(&wheel, &Control::none()).unwrap();
        (searched, found)
    }

    /// By `kingpin simulate --wheel trolley.toml --contact sliding --perturb psi=1.2 --duration 30` the caster swings by 0.179 rad at the end,
    /// with a period of 0.0305 s.
    #[test]
    fn the_trolley_shimmies_by_what_it_settles_on() {
        let (searched, found) = sought(&[], false);
        let told = searched.finding("shimmy".to_owned(), &found);
        assert!(!told.undecided, "{told:?}");
        let motion = "At 1.5 m/s the caster angle swings from -0.17";
        assert!(told.text.contains(motion) && told.text.contains("period of 0.03"), "{}", told.text);
        assert!(told.text.contains("% of what there is at rest"), "{}", told.text);
        assert!(searched.in_short(&found).unwrap().starts_with("it shimmies at 1.5 m/s by 0.17"));
        let shown = illustration(&found, f64::INFINITY).unwrap().unwrap();
        assert!(shown.caption.contains("<i>r</i> = ∞"));
    }

    #[test]
    fn where_every_kick_dies_out_none_is_told_and_nothing_is_left_open() {
        let dampers = [("c_u", "50"), ("c_q", "300"), ("c_psi", "2")];
        let (searched, found) = sought(&dampers, true);
        let told = searched.finding("shimmy".to_owned(), &found);
        assert!(told.text.starts_with("No shimmy was found") && !told.undecided, "{told:?}");
        assert!(told.check.contains("it dies out"), "{}", told.check);
        assert!(searched.in_short(&found).is_none() && illustration(&found, 2.0).unwrap().is_none());
        // Where small motions grow something has to be.
        let unstable = Searched { stable: Some(false), ..searched };
        assert!(unstable.finding(String::new(), &found).undecided);
    }
}
