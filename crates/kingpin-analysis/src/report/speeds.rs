//! At which speeds the uniform motion is stable.

use super::finding::Finding;
use crate::error::{Error, unless_stopped};
use arclength::continuation::Stop;
use arclength_analysis::Control;
use kingpin::branches::{Along, MotionBranch, MotionOptions};
use kingpin::{Key, Wheel};
use kingpin_report::numbers::{readable, significant};

/// The slowest speed, as part of the fastest.
const SLOWEST: f64 = 1e-3;
/// Speeds in each part at which the stability that was followed is compared with that of the motion in closed form.
const COMPARED: usize = 20;

/// A part of the speeds with one stability.
struct Part {
    from: f64,
    to: f64,
    /// Nothing where it is undecided.
    stable: Option<bool>,
}

fn word(stable: Option<bool>) -> &'static str {
    match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "of undecided stability",
    }
}

/// The stability of the uniform motion of a wheel over the speed.
pub(super) struct Speeds {
    wheel: Wheel,
    branch: MotionBranch,
    parts: Vec<Part>,
}

impl Speeds {
    /// Follows the uniform motion up to a speed.
    ///
    /// # Errors
    /// No uniform motion, [`Error::Stopped`].
    pub(super) fn follow(wheel: &Wheel, fastest: f64, control: &Control<'_>) -> Result<Self, Error> {
        let along = Along::new(Key::V, SLOWEST * fastest, fastest)?;
        let branch = wheel.motion_branch(along, &MotionOptions::default(), |_| control.flow())?;
        unless_stopped(control)?;
        let ends = [branch.motions.first(), branch.motions.last()];
        let ends = ends.map(|motion| motion.map_or(f64::NAN, |motion| motion.value));
        let turns = branch.hopf_points.iter().map(|hopf| hopf.value);
        let edges: Vec<f64> = std::iter::once(ends[0]).chain(turns).chain([ends[1]]).collect();
        let parts = edges.windows(2).map(|pair| {
            let inside =
                branch.motions.iter().filter(|motion| pair[0] < motion.value && motion.value < pair[1]);
            let mut words = inside.map(|motion| motion.stability.is_stable());
            // Where a step passes the whole part, its middle tells.
            let middle = || {
                let motion = wheel.with(Key::V, 0.5 * (pair[0] + pair[1])).ok()?.uniform_motion().ok()?;
                motion.is_stable()
            };
            let first = words.next().unwrap_or_else(middle);
            let stable = if words.all(|word| word == first) { first } else { None };
            Part { from: pair[0], to: pair[1], stable }
        });
        let mut joined: Vec<Part> = Vec::new();
        for part in parts {
            match joined.last_mut() {
                Some(before) if before.stable == part.stable => before.to = part.to,
                _ => joined.push(part),
            }
        }
        let parts = joined;
        Ok(Self { wheel: *wheel, branch, parts })
    }

    /// The speeds of the Hopf points.
    pub(super) fn hopf_points(&self) -> Vec<f64> {
        self.branch.hopf_points.iter().map(|hopf| hopf.value).collect()
    }

    /// Whether the motion is stable at a speed.
    pub(super) fn at(&self, speed: f64) -> Option<bool> {
        self.parts.iter().find(|part| part.from < speed && speed <= part.to).and_then(|part| part.stable)
    }

    /// What is said of it.
    pub(super) fn finding(&self, subject: String) -> Finding {
        let undecided = self.parts.iter().any(|part| part.stable.is_none());
        Finding::new(subject, self.text(), self.check()).undecided_if(undecided)
    }

    /// The slowest range of speeds in which the motion is stable.
    pub(super) fn first_stable(&self) -> Option<[f64; 2]> {
        self.parts.iter().find(|part| part.stable == Some(true)).map(|part| [part.from, part.to])
    }

    /// Its stability in a few words.
    pub(super) fn in_short(&self) -> String {
        match self.parts.as_slice() {
            [only] => format!("{} at every speed up to {} m/s", word(only.stable), readable(only.to)),
            [first, then] => {
                let to = significant(first.to, 4);
                format!("{} up to {to} m/s and {} beyond", word(first.stable), word(then.stable))
            }
            parts => {
                let part =
                    |part: &Part| format!("{} up to {} m/s", word(part.stable), significant(part.to, 4));
                parts.iter().map(part).collect::<Vec<_>>().join(", ")
            }
        }
    }

    fn text(&self) -> String {
        let end = self.parts.last().map_or(f64::NAN, |part| part.to);
        let mut text = match self.parts.as_slice() {
            [only] => {
                format!(
                    "The uniform motion is {} at every speed up to {} m/s",
                    word(only.stable),
                    readable(end)
                )
            }
            parts => {
                let said = parts.iter().enumerate().map(|(index, part)| {
                    let to = significant(part.to, 5);
                    match index {
                        0 => format!("{} up to {to} m/s", word(part.stable)),
                        _ => format!("{} from there to {to} m/s", word(part.stable)),
                    }
                });
                format!("The uniform motion is {}", said.collect::<Vec<_>>().join(", "))
            }
        };
        if let [_, Some(stop)] = &self.branch.stops
            && !matches!(stop, Stop::RangeEnd { .. })
        {
            let why = self.branch.end_in_words(1).unwrap_or_else(|| stop.to_string());
            text += &format!("; beyond, it could not be followed ({why})");
        }
        text + "."
    }

    fn check(&self) -> String {
        let mut agree = 0;
        let mut compared = 0;
        for part in &self.parts {
            for index in 0..COMPARED {
                let speed = part.from + (part.to - part.from) * (index as f64 + 0.5) / COMPARED as f64;
                let motion = self.wheel.with(Key::V, speed).and_then(|wheel| wheel.uniform_motion());
                compared += 1;
                agree += usize::from(motion.is_ok_and(|motion| motion.is_stable() == part.stable));
            }
        }
        let mut text = format!(
            "The changes are located by Newton's method on the equations of a Hopf point; the characteristic polynomial says the same \
             at {agree} of {compared} speeds between them"
        );
        if let Some(critical) = self.wheel.critical_speed() {
            let values = self.branch.hopf_points.iter().map(|hopf| (hopf.value / critical.speed - 1.0).abs());
            match values.min_by(f64::total_cmp) {
                Some(apart) if apart < 1e-3 => {
                    text += &format!(
                        "; the critical speed from it differs by {} (relative)",
                        significant(apart, 2)
                    );
                }
                _ => {
                    text += &format!("; the critical speed from it is {} m/s", significant(critical.speed, 6))
                }
            }
        }
        text + "."
    }
}
