//! Where kicked wheels end: maps over the release angle and the yaw rate at several speeds, rolling ideally.

use super::fate_color::fate_color;
use super::study::{Drawing, Finding, Study};
use super::wheel::wheel;
use crate::error::{Error, unless_stopped};
use arclength_analysis::Control;
use kingpin::Key;
use kingpin::basin::{
    Axis as Range, BasinMap, ClassificationSettings, ContactModel, Destinations, Fate, Fraction,
};
use kingpin_figure::{Axis, CategoryMap, Figure, Grid, Legend, Panel};
use kingpin_report::Columns;

/// Speeds in m/s of the maps.
const SPEEDS: [f64; 4] = [2.0, 4.0, 6.0, 8.0];
/// Largest deviations of the caster angle in rad and of the yaw rate in rad/s from the uniform motion.
const ANGLE: f64 = std::f64::consts::PI;
const YAW_RATE: f64 = 100.0;
/// Points of a map on each axis.
const POINTS: usize = 80;
/// Seconds for which motions are followed.
const DURATION: f64 = 30.0;

/// A map at one speed, the angle running faster.
struct Map {
    speed: f64,
    fates: Vec<Fate>,
}

pub(super) fn study(control: &Control<'_>) -> Result<Study, Error> {
    let mut maps = Vec::new();
    let mut findings = Vec::new();
    let axes = [Range::new("psi", -ANGLE, ANGLE)?, Range::new("Omega", -YAW_RATE, YAW_RATE)?];
    for (index, speed) in SPEEDS.into_iter().enumerate() {
        let settings = ClassificationSettings::with_duration(DURATION);
        let destinations = Destinations::new(&wheel(&[(Key::V, speed)])?, ContactModel::Rolling, settings)?;
        let map = BasinMap::grid(&destinations, &axes, [POINTS, POINTS])?;
        let tiles = map.run(&control.quiet(), |_| false, |_| {})?;
        unless_stopped(control)?;
        for fraction in Fraction::of(&tiles).into_iter().filter(|fraction| fraction.count > 0) {
            let what = format!("v = {speed} m/s: part of the map that ends in {}", fraction.fate.name());
            findings.push(Finding::new(what, fraction.share, ""));
        }
        maps.push(Map { speed, fates: tiles.into_iter().flat_map(|tile| tile.fates).collect() });
        control.done((index + 1) as f64 / SPEEDS.len() as f64);
    }
    Ok(Study { findings, drawings: vec![drawing(&maps)?], pictures: Vec::new(), notes: Vec::new() })
}

fn values(largest: f64) -> Vec<f64> {
    (0..POINTS).map(|index| largest * (2.0 * index as f64 / (POINTS - 1) as f64 - 1.0)).collect()
}

fn drawing(maps: &[Map]) -> Result<Drawing, Error> {
    let seen: Vec<Fate> =
        Fate::ALL.into_iter().filter(|fate| maps.iter().any(|map| map.fates.contains(fate))).collect();
    let mut figure = Figure::double_column()
        .columns(2)
        .height_mm(150.0)
        .description("Where motions end, against initial caster angle and yaw rate, at four speeds");
    for (map, tag) in maps.iter().zip(["(a)", "(b)", "(c)", "(d)"]) {
        let cells: Vec<usize> =
            map.fates.iter().filter_map(|fate| seen.iter().position(|candidate| candidate == fate)).collect();
        let colors = CategoryMap::new(
            Grid::new(values(ANGLE), values(YAW_RATE))?,
            cells,
            seen.iter().map(|&fate| (fate.name(), fate_color(fate))),
        )?;
        let panel = Panel::new(
            Axis::new("$\\psi-\\psi_0$ (rad)").limits(-ANGLE, ANGLE),
            Axis::new("$\\Omega-\\omega$ (rad/s)").limits(-YAW_RATE, YAW_RATE),
        )
        .tag(tag)
        .title(format!("$v={}$ m/s", map.speed))
        .map(colors)
        .legend(if tag < "(c)" { Legend::None } else { Legend::Below });
        figure = figure.panel(panel);
    }
    let rows = || {
        maps.iter()
            .flat_map(|map| map.fates.iter().enumerate().map(move |(index, fate)| (map.speed, index, *fate)))
    };
    let (angles, yaw_rates) = (values(ANGLE), values(YAW_RATE));
    let data = Columns::new()
        .numbers("v [m/s]", rows().map(|row| row.0))
        .numbers("psi - psi0 [rad]", rows().map(|row| angles[row.1 % POINTS]))
        .numbers("Omega - omega [rad/s]", rows().map(|row| yaw_rates[row.1 / POINTS]))
        .texts("fate", rows().map(|row| Some(row.2.name().to_owned())));
    Ok(Drawing { number: 10, figure, data })
}
