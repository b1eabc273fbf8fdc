//! Strong random kicks of a damped wheel: whether one finds what continuation has not.

use crate::classification::{Classification, NamedFate};
use crate::disturbance::natural_period;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::basin::{Axis, BasinMap, ClassificationSettings, ContactModel, Destinations, Fate};
use kingpin::simulation::SimulationError;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_report::numbers::counted;
use serde::Serialize;
use std::fmt;

/// Speeds at which the wheel is kicked, as parts of the largest of the range.
const SPEEDS: [f64; 2] = [0.5, 1.0];
/// Kicks at each speed, and the seed of their random numbers.
const KICKS: usize = 16;
const SEED: u64 = 1;
/// Largest caster angle in rad; the largest yaw rate is that of a blow which would change the speed of the wheel by the towing speed.
const LARGEST_ANGLE: f64 = 1.5;
/// Natural periods of the springs for which a motion is followed, ten times as long while it is unsettled.
const PERIODS: f64 = 30.0;
/// The damper is this much stronger than the one that is tested.
const STRONGER: f64 = 1.01;
/// Where a kick is lost, dampers so many times as strong are tried, so often.
const FACTOR: f64 = 1.5;
const RAISES: usize = 8;

/// What became of the kicks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KickedWheels {
    /// Number of kicks with a hundredth more than the damper.
    pub kicks: usize,
    /// Number of those that returned to the uniform motion.
    pub returned: usize,
    /// Number of those of which it is undecided where they end, as where the longitudinal motion rings for long, or where
    /// the equations cease to hold.
    pub undecided: usize,
    /// Where others ended.
    pub ends: Vec<NamedFate>,
    /// A damper with which none ended elsewhere: the first of some that are 1.5 times as strong each; nothing where none was found, or
    /// none was kicked.
    pub none_lost: Option<f64>,
}

impl fmt::Display for KickedWheels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kicks, returned, undecided, ends, .. } = self;
        match returned {
            returned if returned == kicks => write!(f, "all {kicks} strong random kicks return")?,
            returned => {
                let verb = if *returned == 1 { "returns" } else { "return" };
                write!(f, "{returned} of {kicks} strong random kicks {verb}")?;
            }
        }
        if *undecided > 0 {
            write!(f, ", {}", counted(*undecided, "is undecided", "are undecided"))?;
        }
        if !ends.is_empty() {
            let ends: Vec<&str> = ends.iter().map(|fate| fate.0.name()).collect();
            let lost = counted(kicks - returned - undecided, "ends", "end");
            write!(f, ", {lost} in {}", ends.join(" or "))?;
        }
        Ok(())
    }
}

/// Kicks wheels with a damper, and with stronger ones until no kick ends elsewhere than in the uniform motion. Nothing where no
/// damper is allowed.
///
/// # Errors
/// A motion that cannot be followed, [`Error::Stopped`].
pub(super) fn kick(
    wheels: &[Wheel],
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
        for (wheel, speed) in wheels.iter().flat_map(|wheel| SPEEDS.map(|speed| (wheel, speed))) {
            match fates_at(&wheel.with(key, damper)?.with(Key::V, speed * up_to)?, control) {
                Ok(found) => fates.extend(found),
                Err(Error::Simulation(
                    SimulationError::UniformMotionSlides { .. }
                    | SimulationError::Wheel(KingpinError::NoUniformMotion { .. }),
                )) => {}
                Err(error) => return Err(error),
            }
        }
        let returned = fates.iter().filter(|fate| **fate == Fate::UniformMotion).count();
        // A wheel that swings on irregularly for so long is no better than one that shimmies.
        let is_undecided = |fate: &Fate| matches!(fate, Fate::Undecided | Fate::ModelEnds);
        let undecided = fates.iter().filter(|fate| is_undecided(fate)).count();
        let is_lost = |fate: &Fate| *fate != Fate::UniformMotion && !is_undecided(fate);
        let mut ends: Vec<Fate> = fates.iter().copied().filter(is_lost).collect();
        ends.sort();
        ends.dedup();
        let kicked = first.get_or_insert_with(|| KickedWheels {
            kicks: fates.len(),
            returned,
            undecided,
            ends: ends.into_iter().map(NamedFate).collect(),
            none_lost: None,
        });
        if !fates.is_empty() && !fates.iter().any(is_lost) {
            kicked.none_lost = Some(damper);
            break;
        }
    }
    Ok(first)
}

/// Fates of kicks of a wheel, which may slide where its load is known.
fn fates_at(wheel: &Wheel, control: &Control<'_>) -> Result<Vec<Fate>, Error> {
    let model = Classification::default().contact_by_load(wheel).model();
    let duration = PERIODS * natural_period(wheel);
    let destinations = Destinations::new(wheel, model, ClassificationSettings::with_duration(duration))?;
    let blow = wheel.get(Key::V) * wheel.mass();
    let [_, turn] = wheel.velocity_change(blow, ContactModel::Rolling)?.map(f64::abs);
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
