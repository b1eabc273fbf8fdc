//! The uniform motion in diagrams of the caster angle over a parameter.

use crate::along::drawn_as;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin_figure::{Branch, Stability};

/// Values of the parameter at which the uniform motion is drawn.
const UNIFORM_MOTIONS: usize = 400;

/// A point of the curve with its stability, and whether the wheel does not roll there.
pub(crate) type UniformPoint = ((f64, f64), Stability, bool);

/// The uniform motion where it exists, its stability changing exactly at the points given, dotted where it does not roll.
pub(crate) fn uniform_motion(wheel: &Wheel, along: &Along, mut points: Vec<UniformPoint>) -> Branch {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let (start, end) = (abscissa(start), abscissa(end));
    let (low, high) = (start.min(end), start.max(end));
    for index in 0..=UNIFORM_MOTIONS {
        let value = low + (high - low) * index as f64 / UNIFORM_MOTIONS as f64;
        let motion = wheel.with(key, value).and_then(|wheel| wheel.uniform_motion());
        // Outside its range there is nothing to draw.
        if let Ok(motion) = motion {
            let stability = Stability::from(motion.is_stable() == Some(true));
            points.push(((value, motion.psi()), stability, !motion.rolls()));
        }
    }
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let dotted: Vec<bool> = points.iter().map(|(_, _, slides)| *slides).collect();
    Branch::new(points.into_iter().map(|(place, stability, _)| (place, stability))).dotted(dotted)
}
