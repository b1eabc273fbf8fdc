//! Over which speeds the uniform motion is stable: every change of its stability, not only the first.
//!
//! Changes that are not known in closed form come from two sides: from a scan of speeds, as the critical speed does, and from the
//! Hopf points of the motion that is followed, which also tell windows that are narrower than the distance of the scan. Between
//! them the speeds of the scan say which stability is certain.

use crate::branches::{Along, MotionOptions};
use crate::error::KingpinError;
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::control::Control;

/// The motion is followed from each speed to so many times as much, so that steps suit slow motions too.
const DECADE: f64 = 10.0;
/// Relative distance within which two changes are the same.
const SAME_CHANGE: f64 = 1e-6;
/// Relative distance from a change at which the stability beside it is asked for.
const BESIDE: f64 = 1e-6;
/// Where certain stability ends, and not at a change, that speed is narrowed down to this part of it.
const EDGE: f64 = 1e-6;

/// Speeds with one stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedPart {
    /// Lowest speed in m/s.
    pub from: f64,
    /// Highest speed in m/s.
    pub to: f64,
    /// `None` where rounding of the parameters could decide it either way.
    pub stable: Option<bool>,
}

/// The stability of the uniform motion over the speed.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityOverSpeed {
    /// Lowest and highest speed in m/s that was looked at.
    pub searched: [f64; 2],
    /// Parts in ascending order; between them, where they do not touch, no uniform motion was found.
    pub parts: Vec<SpeedPart>,
    /// Speeds in m/s at which the stability changes, in ascending order.
    pub changes: Vec<f64>,
    /// Whether the changes are known in closed form, so that there are no others.
    pub is_complete: bool,
    /// Speeds between which the motion could not be followed, so that only the scan tells of changes.
    pub not_followed: Vec<[f64; 2]>,
}

impl Wheel {
    /// The stability of the uniform motion at all speeds at which a critical speed is looked for.
    ///
    /// # Errors
    /// [`KingpinError::Interrupted`].
    pub fn stability_over_speed(&self, control: &Control<'_>) -> Result<StabilityOverSpeed, KingpinError> {
        let scanned = self.scanned_speeds();
        let closed_form = self.changes_in_closed_form();
        let is_complete = closed_form.is_some();
        let mut not_followed = Vec::new();
        let mut changes = match closed_form {
            Some(changes) => changes,
            None => {
                let followed = self.changes_followed(&scanned, &mut not_followed, control)?;
                self.changes_sought().chain(followed).collect()
            }
        };
        changes.sort_by(f64::total_cmp);
        changes.dedup_by(|next, before| (*next - *before).abs() <= SAME_CHANGE * *before);
        let searched = ends_of(&scanned);
        let parts = self.parts(scanned, &changes);
        Ok(StabilityOverSpeed { searched, parts, changes, is_complete, not_followed })
    }

    /// The changes of stability at Hopf points of the motion as it is followed, of those that this wheel has by itself.
    fn changes_followed(
        &self,
        scanned: &[f64],
        not_followed: &mut Vec<[f64; 2]>,
        control: &Control<'_>,
    ) -> Result<Vec<f64>, KingpinError> {
        let [mut slow, fastest] = ends_of(scanned);
        let mut changes = Vec::new();
        while slow < fastest {
            let fast = (DECADE * slow).min(fastest);
            let along = Along::new(Key::V, slow, fast)?;
            match self.motion_branch(along, &MotionOptions::default(), |_| control.flow()) {
                Ok(branch) => changes.extend(
                    branch
                        .hopf_points
                        .iter()
                        .filter(|hopf| hopf.is_of_wheels_own_motion())
                        .map(|hopf| hopf.value),
                ),
                // The scan tells the same.
                Err(KingpinError::NoUniformMotion { .. }) => {}
                Err(KingpinError::Continuation(_)) => not_followed.push([slow, fast]),
                Err(error) => return Err(error),
            }
            control.check()?;
            slow = fast;
        }
        changes.retain(|&speed| self.changes_stability_at(speed));
        Ok(changes)
    }

    fn parts(&self, mut speeds: Vec<f64>, changes: &[f64]) -> Vec<SpeedPart> {
        // Nothing where there is no motion.
        let word = |speed: f64| Some(self.with(Key::V, speed).ok()?.uniform_motion().ok()?.is_stable());
        speeds.extend(changes.iter().flat_map(|speed| [1.0 - BESIDE, 1.0 + BESIDE].map(|part| part * speed)));
        speeds.sort_by(f64::total_cmp);
        let mut parts: Vec<SpeedPart> = Vec::new();
        let mut before: Option<(f64, Option<Option<bool>>)> = None;
        for speed in speeds {
            let here = word(speed);
            let edge = match before {
                Some((_, last)) if last == here => None,
                Some((slower, last)) => {
                    let change = changes.iter().copied().find(|change| (slower..speed).contains(change));
                    Some(change.unwrap_or_else(|| edge_of(word, last, [slower, speed])))
                }
                None => Some(speed),
            };
            if let Some(edge) = edge {
                if let (Some(part), Some((_, Some(_)))) = (parts.last_mut(), before) {
                    part.to = edge;
                }
                parts.extend(here.map(|stable| SpeedPart { from: edge, to: speed, stable }));
            } else if let (Some(part), Some(_)) = (parts.last_mut(), here) {
                part.to = speed;
            }
            before = Some((speed, here));
        }
        parts
    }
}

/// The lowest and the highest of some speeds in ascending order.
fn ends_of(speeds: &[f64]) -> [f64; 2] {
    [speeds.first(), speeds.last()].map(|speed| speed.copied().unwrap_or_default())
}

/// Up to which speed between two there is the same word as at the slower one.
fn edge_of<W: PartialEq>(word: impl Fn(f64) -> W, first: W, [mut low, mut high]: [f64; 2]) -> f64 {
    while high - low > EDGE * high {
        let middle = 0.5 * (low + high);
        if word(middle) == first { low = middle } else { high = middle }
    }
    low
}
