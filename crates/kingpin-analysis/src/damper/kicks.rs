//! Strong random kicks of a damped wheel: whether one finds what continuation has not.

use crate::classification::{Classification, NamedFate};
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::basin::{Axis, BasinMap, ContactModel, Destinations, Fate};
use kingpin::simulation::SimulationError;
use kingpin::{Key, KingpinError, Wheel};
use serde::Serialize;

/// Speeds at which the wheel is kicked, as parts of the largest of the range.
const SPEEDS: [f64; 2] = [0.5, 1.0];
/// Kicks at each speed, and the seed of their random numbers.
const KICKS: usize = 16;
const SEED: u64 = 1;
/// Largest caster angle in rad; the largest yaw rate is that of a blow which would change the speed of the wheel by the towing speed.
const LARGEST_ANGLE: f64 = 1.5;
/// The damper is this much stronger than the one that is tested.
const STRONGER: f64 = 1.01;
/// Where a kick does not return, dampers so many times as strong are tried, so often.
const FACTOR: f64 = 1.5;
const RAISES: usize = 8;

/// What became of the kicks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KickedWheels {
    /// Number of kicks with a hundredth more than the damper.
    pub kicks: usize,
    /// Number of those that returned to the uniform motion.
    pub returned: usize,
    /// Where others ended.
    pub ends: Vec<NamedFate>,
    /// A damper with which all returned: the first of some that are 1.5 times as strong each; nothing where none was found, or none
    /// was kicked.
    pub all_return: Option<f64>,
}

/// Kicks a wheel with a damper, and with stronger ones until all kicks return. Nothing where there are no motions to kick: a tyre, or
/// lateral elasticity only.
///
/// # Errors
/// A motion that cannot be followed, [`Error::Stopped`].
pub(super) fn kick(
    wheel: &Wheel,
    key: Key,
    [damping, up_to]: [f64; 2],
    control: &Control<'_>,
) -> Result<Option<KickedWheels>, Error> {
    let mut first = None;
    for raise in 0..RAISES {
        let damper = STRONGER * damping * FACTOR.powi(raise as i32);
        if !key.allowed().contains(damper) {
            break;
        }
        let mut fates = Vec::new();
        for speed in SPEEDS {
            match fates_at(&wheel.with(key, damper)?.with(Key::V, speed * up_to)?, control) {
                Ok(found) => fates.extend(found),
                Err(Error::Simulation(
                    SimulationError::UniformMotionSlides { .. }
                    | SimulationError::Wheel(KingpinError::NoUniformMotion { .. }),
                )) => {}
                Err(Error::Simulation(SimulationError::Wheel(_)) | Error::Wheel(_)) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        let returned = fates.iter().filter(|fate| **fate == Fate::UniformMotion).count();
        let mut ends: Vec<Fate> = fates.iter().copied().filter(|fate| *fate != Fate::UniformMotion).collect();
        ends.sort();
        ends.dedup();
        let kicked = first.get_or_insert_with(|| KickedWheels {
            kicks: fates.len(),
            returned,
            ends: ends.into_iter().map(NamedFate).collect(),
            all_return: None,
        });
        if !fates.is_empty() && returned == fates.len() {
            kicked.all_return = Some(damper);
            break;
        }
    }
    Ok(first)
}

/// Fates of kicks of a wheel, which may slide where its load is known.
fn fates_at(wheel: &Wheel, control: &Control<'_>) -> Result<Vec<Fate>, Error> {
    let classification = Classification::default();
    let model = classification.contact_by_load(wheel).model();
    let destinations = Destinations::new(wheel, model, classification.settings(wheel)?)?;
    let blow = wheel.get(Key::V) * (wheel.get(Key::MW) + wheel.get(Key::MC));
    let [_, turn] = wheel.velocity_change(blow, ContactModel::Rolling);
    let yaw = wheel.towing_yaw_rate();
    let axes =
        [Axis::new("psi", -LARGEST_ANGLE, LARGEST_ANGLE)?, Axis::new("Omega", yaw - turn, yaw + turn)?];
    let map = BasinMap::samples(&destinations, &axes, KICKS, SEED)?;
    let tiles = map.run(control, |_| false, |_| {})?;
    if tiles.len() < map.tiles() {
        return Err(Error::Stopped);
    }
    Ok(tiles.into_iter().flat_map(|tile| tile.fates).collect())
}
