//! Driving straight, then suddenly round a curve: safe or not, against speed and turning radius.
//!
//! This is the paper's own scenario. The wheel runs straight in its uniform motion; at once the towing point follows a
//! circle. Ideal rolling is compared with Coulomb friction; the boundary of linear stability is drawn beside both.

use super::fate_color::fate_color;
use super::study::{Drawing, Finding, Study};
use super::wheel::wheel;
use crate::error::{Error, unless_stopped};
use arclength_analysis::Control;
use kingpin::basin::{ClassificationSettings, ContactModel, Destinations, Fate};
use kingpin::parallel;
use kingpin::simulation::SimulationError;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Axis, CategoryMap, Color, Figure, Grid, Legend, Line, Panel, palette};
use kingpin_report::Columns;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Speeds in m/s and turning radii in m.
const SPEEDS: (f64, f64) = (0.25, 12.0);
const RADII: (f64, f64) = (0.2, 2.0);
/// Points on each axis, for ideal rolling and for wheels that may slide, which take longer.
const ROLLING_POINTS: [usize; 2] = [72, 54];
const SLIDING_POINTS: [usize; 2] = [32, 24];
/// Vertical force on the king pin in N where the wheel may slide.
const LOAD: f64 = -100.0;
/// Seconds for which motions are followed.
const DURATION: f64 = 30.0;
const SLIDING_DURATION: f64 = 15.0;

/// What becomes of the wheel on a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// The curve has a uniform motion in which the wheel rolls; the motion ends so.
    Ends(Fate),
    /// Rolling uniformly round the curve takes more than the static friction: there is nothing to return to.
    Slides,
    /// The curve has no uniform motion.
    NoUniformMotion,
}

impl Outcome {
    /// All outcomes, in the order of the legend.
    fn all() -> impl Iterator<Item = Self> {
        Fate::ALL.into_iter().map(Self::Ends).chain([Self::Slides, Self::NoUniformMotion])
    }

    fn name(self) -> &'static str {
        match self {
            Self::Ends(fate) => fate.name(),
            Self::Slides => "slides on the curve",
            Self::NoUniformMotion => "no uniform motion",
        }
    }

    fn color(self) -> Color {
        match self {
            Self::Ends(fate) => fate_color(fate),
            Self::Slides => palette::GREEN.lightened(0.6),
            Self::NoUniformMotion => palette::WHITE,
        }
    }
}

/// The outcomes over speed (faster) and radius.
struct Map {
    model: ContactModel,
    points: [usize; 2],
    outcomes: Vec<Outcome>,
}

pub(super) fn study(control: &Control<'_>) -> Result<Study, Error> {
    let total = ROLLING_POINTS.iter().product::<usize>() + SLIDING_POINTS.iter().product::<usize>();
    let done = AtomicUsize::new(0);
    let step = || {
        control.done((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total as f64);
        unless_stopped(control)
    };
    let maps = [
        Map::compute(ContactModel::Rolling, ROLLING_POINTS, DURATION, &step)?,
        Map::compute(ContactModel::Sliding, SLIDING_POINTS, SLIDING_DURATION, &step)?,
    ];
    let findings = maps.iter().flat_map(Map::findings).collect();
    Ok(Study { findings, drawings: vec![drawing(&maps)?], pictures: Vec::new(), notes: Vec::new() })
}

fn values((low, high): (f64, f64), count: usize) -> Vec<f64> {
    (0..count).map(|index| low + (high - low) * index as f64 / (count - 1) as f64).collect()
}

fn curve(model: ContactModel, speed: f64, radius: f64) -> Result<Wheel, KingpinError> {
    let load = if model == ContactModel::Sliding { LOAD } else { 0.0 };
    wheel(&[(Key::V, speed), (Key::TurningRadius, radius), (Key::FAz, load)])
}

/// What becomes of the straight running wheel on its curve.
fn outcome(wheel: &Wheel, model: ContactModel, settings: ClassificationSettings) -> Result<Outcome, Error> {
    let destinations = match Destinations::new(wheel, model, settings) {
        Ok(destinations) => destinations,
        Err(SimulationError::UniformMotionSlides { .. }) => return Ok(Outcome::Slides),
        Err(SimulationError::Wheel(KingpinError::NoUniformMotion { .. })) => {
            return Ok(Outcome::NoUniformMotion);
        }
        Err(error) => return Err(error.into()),
    };
    let straight = wheel.with(Key::TurningRadius, f64::INFINITY)?.uniform_motion()?.state();
    let fates = destinations.of(&[straight], &Control::none())?;
    Ok(fates.first().map_or(Outcome::NoUniformMotion, |&fate| Outcome::Ends(fate)))
}

impl Map {
    fn compute(
        model: ContactModel,
        points: [usize; 2],
        duration: f64,
        step: &(dyn Fn() -> Result<(), Error> + Sync),
    ) -> Result<Self, Error> {
        let (speeds, radii) = (values(SPEEDS, points[0]), values(RADII, points[1]));
        let outcome = |index: usize| -> Result<Outcome, Error> {
            let (speed, radius) = (speeds[index % points[0]], radii[index / points[0]]);
            let found = outcome(
                &curve(model, speed, radius)?,
                model,
                ClassificationSettings::with_duration(duration),
            )?;
            step()?;
            Ok(found)
        };
        let outcomes = parallel::try_map_indices(points[0] * points[1], outcome)?;
        Ok(Self { model, points, outcomes })
    }

    fn name(&self) -> String {
        match self.model {
            ContactModel::Rolling => "ideal rolling".to_owned(),
            ContactModel::Sliding => format!("rolling and sliding, load {} N", -LOAD),
        }
    }

    /// Speed and radius of every curve, in the order of the outcomes.
    fn curves(&self) -> Vec<(f64, f64)> {
        let (speeds, radii) = (values(SPEEDS, self.points[0]), values(RADII, self.points[1]));
        (0..self.outcomes.len())
            .map(|index| (speeds[index % self.points[0]], radii[index / self.points[0]]))
            .collect()
    }

    fn is_stable(&self, (speed, radius): (f64, f64)) -> bool {
        let motion = curve(self.model, speed, radius).and_then(|wheel| wheel.uniform_motion());
        motion.is_ok_and(|motion| motion.is_stable() == Some(true))
    }

    fn findings(&self) -> Vec<Finding> {
        let curves = || self.curves().into_iter().zip(self.outcomes.iter().copied());
        // Stable curves on which the wheel rolls: there alone a step can fail.
        let rolling: Vec<Fate> = curves()
            .filter_map(|(curve, outcome)| match outcome {
                Outcome::Ends(fate) if self.is_stable(curve) => Some(fate),
                _ => None,
            })
            .collect();
        let part = |fits: &dyn Fn(Fate) -> bool| {
            rolling.iter().filter(|&&fate| fits(fate)).count() as f64 / rolling.len().max(1) as f64
        };
        let undecided = |fate: Fate| fate.is_undecided();
        let fails = |fate: Fate| fate != Fate::UniformMotion && !undecided(fate);
        let name = self.name();
        let mut findings = vec![
            Finding::new(
                format!("{name}: part of the linearly stable curves on which the step fails"),
                part(&fails),
                "",
            ),
            Finding::new("  part that is undecided", part(&undecided), ""),
        ];
        let slide = self.outcomes.iter().filter(|&&outcome| outcome == Outcome::Slides).count();
        if slide > 0 {
            let share = slide as f64 / self.outcomes.len() as f64;
            findings.push(Finding::new(
                "  part of the map in which no uniform motion rolls on the curve",
                share,
                "",
            ));
        }
        let lowest = curves()
            .filter(|(_, outcome)| matches!(outcome, Outcome::Ends(fate) if fails(*fate)))
            .filter(|(curve, _)| self.is_stable(*curve))
            .map(|((speed, radius), _)| speed / radius)
            .fold(f64::INFINITY, f64::min);
        if lowest.is_finite() {
            findings.push(Finding::new(
                "  lowest yaw rate v/r of a stable curve on which it fails",
                lowest,
                "rad/s",
            ));
        }
        findings
    }
}

fn drawing(maps: &[Map; 2]) -> Result<Drawing, Error> {
    let seen: Vec<Outcome> =
        Outcome::all().filter(|outcome| maps.iter().any(|map| map.outcomes.contains(outcome))).collect();
    let critical = wheel(&[(Key::V, 1.0)])?.critical_yaw_rate();
    let mut figure = Figure::double_column().columns(2).height_mm(88.0).description(
        "Where the wheel ends after a step from straight towing to a curve, against speed and turning radius",
    );
    for (map, tag) in maps.iter().zip(["(a)", "(b)"]) {
        let [columns, rows] = map.points;
        let cells: Vec<usize> = map
            .outcomes
            .iter()
            .filter_map(|outcome| seen.iter().position(|candidate| candidate == outcome))
            .collect();
        let colors = CategoryMap::new(
            Grid::new(values(SPEEDS, columns), values(RADII, rows))?,
            cells,
            seen.iter().map(|outcome| (outcome.name(), outcome.color())),
        )?;
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").limits(SPEEDS.0, SPEEDS.1),
            Axis::new("$r$ (m)").limits(RADII.0, RADII.1),
        )
        .tag(tag)
        .title(map.name())
        .map(colors)
        .legend(Legend::Below);
        if let Some(yaw_rate) = critical {
            let line = Line::new([(RADII.0 * yaw_rate, RADII.0), (SPEEDS.1, SPEEDS.1 / yaw_rate)])
                .color(palette::BLACK)
                .dashed();
            panel = panel.curve(line.legend("limit of linear stability"));
        }
        figure = figure.panel(panel);
    }
    let rows = || {
        maps.iter().flat_map(|map| {
            let outcomes = map.outcomes.iter().copied();
            map.curves().into_iter().zip(outcomes).map(|(curve, outcome)| (map.model, curve, outcome))
        })
    };
    let data = Columns::new()
        .texts("contact", rows().map(|row| Some(row.0.name().to_owned())))
        .numbers("v [m/s]", rows().map(|row| row.1.0))
        .numbers("r [m]", rows().map(|row| row.1.1))
        .texts("outcome", rows().map(|row| Some(row.2.name().to_owned())));
    Ok(Drawing { number: 11, figure, data })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_on_which_the_wheel_slides_are_a_class_of_their_own() {
        let of = |model, speed, radius| {
            let settings = ClassificationSettings::with_duration(1.0);
            outcome(&curve(model, speed, radius).unwrap(), model, settings).unwrap()
        };
        // The uniform motion takes 124.95 N of friction, the ground can supply 104.1 N.
        assert_eq!(of(ContactModel::Sliding, 12.0, 0.5), Outcome::Slides);
        assert_ne!(of(ContactModel::Rolling, 3.0, 0.5), Outcome::Slides);
        assert_eq!(of(ContactModel::Rolling, 12.0, 0.08), Outcome::NoUniformMotion);
    }
}
