//! Driving straight, then suddenly round a curve: safe or not, against speed and turning radius.
//!
//! This is the paper's own scenario. The wheel runs straight in its uniform motion; at once the towing point follows a
//! circle. Ideal rolling is compared with Coulomb friction; the boundary of linear stability is drawn beside both.

use super::{Drawing, Finding, Study, fate_map, occurring, wheel};
use crate::columns::Columns;
use crate::failure::Failure;
use kingpin::basin::{ClassificationSettings, ContactModel, Destinations, Fate};
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Axis, Figure, Legend, Line, Panel, palette};
use rayon::prelude::*;
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

/// The fates over speed (faster) and radius; `None` where the curve has no uniform motion.
struct Map {
    model: ContactModel,
    points: [usize; 2],
    fates: Vec<Option<Fate>>,
}

pub(super) fn study(progress: &(dyn Fn(f64) + Sync)) -> Result<Study, Failure> {
    let total = ROLLING_POINTS.iter().product::<usize>() + SLIDING_POINTS.iter().product::<usize>();
    let done = AtomicUsize::new(0);
    let step = || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total as f64);
    let maps = [
        Map::compute(ContactModel::Rolling, ROLLING_POINTS, DURATION, &step)?,
        Map::compute(ContactModel::Sliding, SLIDING_POINTS, SLIDING_DURATION, &step)?,
    ];
    let findings = maps.iter().flat_map(Map::findings).collect();
    Ok(Study { findings, drawings: vec![drawing(&maps)?], pictures: Vec::new() })
}

fn values((low, high): (f64, f64), count: usize) -> Vec<f64> {
    (0..count).map(|index| low + (high - low) * index as f64 / (count - 1) as f64).collect()
}

fn curve(model: ContactModel, speed: f64, radius: f64) -> Result<Wheel, KingpinError> {
    let load = if model == ContactModel::Sliding { LOAD } else { 0.0 };
    wheel(&[(Key::V, speed), (Key::TurningRadius, radius), (Key::FAz, load)])
}

impl Map {
    fn compute(
        model: ContactModel,
        points: [usize; 2],
        duration: f64,
        step: &(dyn Fn() + Sync),
    ) -> Result<Self, Failure> {
        let (speeds, radii) = (values(SPEEDS, points[0]), values(RADII, points[1]));
        let fate = |index: usize| -> Result<Option<Fate>, Failure> {
            let (speed, radius) = (speeds[index % points[0]], radii[index / points[0]]);
            let wheel = curve(model, speed, radius)?;
            let found = match wheel.uniform_motion() {
                Ok(_) => {
                    let straight = wheel.with(Key::TurningRadius, f64::INFINITY)?.uniform_motion()?.state();
                    let settings = ClassificationSettings { duration };
                    let fates = Destinations::new(&wheel, model, settings)?.of(&[straight])?;
                    fates.first().copied()
                }
                Err(KingpinError::NoUniformMotion { .. }) => None,
                Err(error) => return Err(error.into()),
            };
            step();
            Ok(found)
        };
        let fates = (0..points[0] * points[1]).into_par_iter().map(fate).collect::<Result<_, _>>()?;
        Ok(Self { model, points, fates })
    }

    fn name(&self) -> String {
        match self.model {
            ContactModel::Rolling => "ideal rolling".to_owned(),
            ContactModel::Sliding => format!("rolling and sliding, load {} N", -LOAD),
        }
    }

    /// Whether the uniform motion on the curve is stable, in the order of the fates.
    fn stable(&self) -> Vec<bool> {
        let (speeds, radii) = (values(SPEEDS, self.points[0]), values(RADII, self.points[1]));
        (0..self.fates.len())
            .map(|index| {
                let (speed, radius) = (speeds[index % self.points[0]], radii[index / self.points[0]]);
                let motion = curve(self.model, speed, radius).and_then(|wheel| wheel.uniform_motion());
                motion.is_ok_and(|motion| motion.is_stable())
            })
            .collect()
    }

    fn findings(&self) -> Vec<Finding> {
        let stable = self.stable();
        let count = stable.iter().filter(|&&stable| stable).count();
        let fails = self
            .fates
            .iter()
            .zip(&stable)
            .filter(|(fate, stable)| **stable && **fate != Some(Fate::UniformMotion))
            .count();
        let mut findings = vec![Finding::new(
            format!("{}: part of the linearly stable curves on which the step fails", self.name()),
            fails as f64 / count.max(1) as f64,
            "",
        )];
        // The lowest yaw rate of a curve on which the step fails.
        let (speeds, radii) = (values(SPEEDS, self.points[0]), values(RADII, self.points[1]));
        let failing = self
            .fates
            .iter()
            .enumerate()
            .filter(|(_, fate)| fate.is_some_and(|fate| fate != Fate::UniformMotion));
        let lowest = failing
            .map(|(index, _)| speeds[index % self.points[0]] / radii[index / self.points[0]])
            .fold(f64::INFINITY, f64::min);
        if lowest.is_finite() {
            findings.push(Finding::new(
                "  lowest yaw rate v/r of a failing step on the grid",
                lowest,
                "rad/s",
            ));
        }
        findings
    }
}

fn drawing(maps: &[Map; 2]) -> Result<Drawing, Failure> {
    let seen = occurring(maps.iter().flat_map(|map| &map.fates));
    let critical = wheel(&[(Key::V, 1.0)])?.critical_yaw_rate();
    let mut figure = Figure::double_column().columns(2).height_mm(88.0).description(
        "Where the wheel ends after a step from straight towing to a curve, against speed and turning radius",
    );
    for (map, tag) in maps.iter().zip(["(a)", "(b)"]) {
        let [columns, rows] = map.points;
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").limits(SPEEDS.0, SPEEDS.1),
            Axis::new("$r$ (m)").limits(RADII.0, RADII.1),
        )
        .tag(tag)
        .title(map.name())
        .map(fate_map(values(SPEEDS, columns), values(RADII, rows), &map.fates, &seen)?)
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
            let (speeds, radii) = (values(SPEEDS, map.points[0]), values(RADII, map.points[1]));
            map.fates.iter().enumerate().map(move |(index, fate)| {
                (map.model, speeds[index % map.points[0]], radii[index / map.points[0]], *fate)
            })
        })
    };
    let model = |model: ContactModel| match model {
        ContactModel::Rolling => "rolling",
        ContactModel::Sliding => "sliding",
    };
    let data = Columns::new()
        .texts("contact", rows().map(|row| Some(model(row.0).to_owned())))
        .numbers("v [m/s]", rows().map(|row| row.1))
        .numbers("r [m]", rows().map(|row| row.2))
        .texts("fate", rows().map(|row| row.3.map(|fate| fate.name().to_owned())));
    Ok(Drawing { number: 11, figure, data })
}
