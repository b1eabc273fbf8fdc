//! Isolas: large oscillations that straight running gives no warning of.
//!
//! The model with lateral elasticity only (Takács, Stépán and Hogan, "Isolated large amplitude periodic motions of towed
//! rigid wheels", 2008) at the paper's wheel with a short caster. [`Isola::compute`] follows branches of cycles along the
//! speed for several dampers, then the folds in speed and damping; [`drawing`](Isola::drawing) shows both.

mod drawing;
mod extremum;

use super::study::{Finding, Study};
use super::wheel::wheel;
use crate::error::{Error, unless_stopped};
use arclength::branch::SpecialKind;
use arclength::continuation::{Settings, Stop};
use arclength::cycle::{CycleBranch, CycleEnd, CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::{Equilibria, HopfPoint};
use arclength::locus::{CycleLocus, CycleLocusBranch};
use arclength_analysis::Control;
use extremum::{Extremum, largest_damping};
use kingpin::{Key, KingpinError, LateralWheel};
use std::ops::RangeInclusive;

/// Caster length in m: shorter than the critical one, so that straight running shimmies without damper.
const CASTER_LENGTH: f64 = 0.04;
/// Lateral damping in N s/m: with Hopf points, without.
const WITH_HOPF_POINTS: f64 = 0.05;
const DETACHED: f64 = 0.1;
/// Further closed branches that are shown, in N s/m.
const SHOWN: [f64; 2] = [0.08, 0.11];
/// Smallest and largest damping in N s/m of the cycle that is followed from one to the other.
const BRIDGED: (f64, f64) = (1e-3, 0.2);
/// Speed in m/s of the cycle that is followed from one damping to the other.
const BRIDGE: f64 = 10.0;
/// Speeds in m/s along which branches are followed.
const SPEEDS: RangeInclusive<f64> = 0.015..=60.0;
/// Speeds in m/s and dampings in N s/m in which folds are followed.
const FOLD_SPEEDS: RangeInclusive<f64> = 0.015..=60.0;
const FOLD_DAMPINGS: RangeInclusive<f64> = 0.02..=1.0;
/// Part of its range by which the speed changes in one step at most, and the error of the predictor that the step control
/// aims at: small enough to draw smooth curves through the points.
const LARGEST_CHANGE: f64 = 0.02;
const PREDICTOR_ERROR: f64 = 0.005;
const FOLD_PREDICTOR_ERROR: f64 = 1e-3;
/// Relative difference below which two Hopf points are one.
const SAME: f64 = 1e-6;

/// What is shown.
pub(super) struct Isola {
    /// Hopf points at the smaller damping, by speed.
    pub hopf_points: Vec<HopfPoint>,
    /// The branches of cycles from them; one where it leads from one to the other.
    pub attached: Vec<CycleBranch>,
    /// Largest caster angle in rad with hardly any damper.
    pub undamped_angle: f64,
    /// The closed branch at the larger damping, and others with their damping.
    pub closed: CycleBranch,
    pub shown: Vec<(f64, CycleBranch)>,
    /// Its folds in speed and damping.
    pub folds: CycleLocusBranch,
    /// Where straight running loses its Hopf points and the isola is born, from the closed form.
    pub birth: HopfVertex,
    /// Where the isola shrinks to a point.
    pub death: Extremum,
}

/// The damping above which straight running has no Hopf points, and the speed at which the last two meet.
///
/// With `u = 0` and `r = inf` the characteristic polynomial of straight running is
/// `J s^3 + (m v + l^2 c_q) s^2 + (l^2 k_q + l c_q v) s + l k_q v`; there are two Hopf points in `v` while
/// `c_q < sqrt(k_q) (sqrt(J) - sqrt(m l))/l`, and they meet at `v = sqrt(l^3 k_q/m)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HopfVertex {
    pub speed: f64,
    pub damping: f64,
    static_moment: f64,
    yaw_inertia: f64,
    stiffness: f64,
}

impl HopfVertex {
    fn new() -> Result<Self, KingpinError> {
        let wheel = lateral(0.0, 0.0)?;
        let wheel = wheel.wheel();
        let [mass, inertia, inertia_of_wheel, arm, stiffness] =
            [Key::MC, Key::JCz, Key::JWzeta, Key::LC, Key::KQ].map(|key| wheel.get(key));
        let distance = CASTER_LENGTH - arm;
        let static_moment = mass * distance;
        let yaw_inertia = inertia + inertia_of_wheel + mass * distance * distance;
        Ok(Self {
            speed: (CASTER_LENGTH.powi(3) * stiffness / static_moment).sqrt(),
            damping: stiffness.sqrt() * (yaw_inertia.sqrt() - (static_moment * CASTER_LENGTH).sqrt())
                / CASTER_LENGTH,
            static_moment,
            yaw_inertia,
            stiffness,
        })
    }

    /// Both speeds at which straight running has a Hopf point with this damping.
    pub(super) fn speeds_at(&self, damping: f64) -> Option<[f64; 2]> {
        let (l, m, k) = (CASTER_LENGTH, self.static_moment, self.stiffness);
        // m c v^2 + (m l k + l^2 c^2 - J k) v + l^3 c k = 0
        let half = 0.5 * (self.yaw_inertia * k - m * l * k - (l * damping).powi(2)) / (m * damping);
        let product = l.powi(3) * k / m;
        let root = half * half - product;
        (root >= 0.0).then(|| {
            let upper = half + root.sqrt();
            [product / upper, upper]
        })
    }
}

/// The wheel of this study, speed and damping being the parameters.
pub(super) fn lateral(speed: f64, damping: f64) -> Result<LateralWheel, KingpinError> {
    let values = [
        (Key::KU, f64::INFINITY),
        (Key::TurningRadius, f64::INFINITY),
        (Key::L, CASTER_LENGTH),
        (Key::V, speed),
        (Key::CQ, damping),
    ];
    wheel(&values)?.lateral(&[Key::V, Key::CQ])
}

pub(super) fn study(control: &Control<'_>) -> Result<Study, Error> {
    let isola = Isola::compute(control)?;
    Ok(Study { findings: isola.findings(), drawings: vec![isola.drawing()], pictures: Vec::new() })
}

impl Isola {
    pub(super) fn compute(control: &Control<'_>) -> Result<Self, Error> {
        let field = lateral(1.0, WITH_HOPF_POINTS)?;
        let straight =
            Equilibria::of(&field).parameters(&[1.0, WITH_HOPF_POINTS]).along("v", 0.1..=20.0).run()?;
        let mut hopf_points: Vec<HopfPoint> = straight.hopf_points().cloned().collect();
        hopf_points.sort_by(|a, b| a.value.total_cmp(&b.value));
        let mut attached = Vec::new();
        for hopf in &hopf_points {
            let ends_here = |branch: &CycleBranch| {
                matches!(branch.stops[1], Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. }))
                    if (parameter / hopf.value - 1.0).abs() < SAME)
            };
            if attached.iter().any(ends_here) {
                continue;
            }
            attached.push(along_speed(&field, CycleStart::from(hopf), [hopf.value, WITH_HOPF_POINTS])?);
        }
        control.done(0.2);
        unless_stopped(control)?;
        let bridge = attached
            .iter()
            .flat_map(|branch| &branch.points)
            .filter(|point| point.value == BRIDGE)
            .max_by(|a, b| a.max[1].total_cmp(&b.max[1]))
            .ok_or_else(|| Error::not_found("limit cycle", "v = 10 m/s, c_q = 0.05 N s/m"))?;
        let bridged = Cycles::of(&field, CycleStart::Orbit(bridge.orbit.clone()))
            .parameters(&[BRIDGE, WITH_HOPF_POINTS])
            .along("c_q", BRIDGED.0..=BRIDGED.1)
            .at(&[SHOWN[0], DETACHED, SHOWN[1]])
            .run()?;
        let reached = |damping: f64| -> Result<&Orbit, Error> {
            let at = |point: &&CyclePoint| point.value == damping;
            let found = bridged.points.iter().find(at).map(|point| &point.orbit);
            found
                .ok_or_else(|| Error::not_found("limit cycle", &format!("v = 10 m/s, c_q = {damping} N s/m")))
        };
        control.done(0.3);
        unless_stopped(control)?;
        let start = |damping: f64| Ok::<_, Error>(CycleStart::Orbit(reached(damping)?.clone()));
        let lightest = bridged.points.iter().min_by(|a, b| a.value.total_cmp(&b.value));
        let undamped_angle = lightest.map_or(0.0, |point| point.max[1]);
        let shown = SHOWN
            .into_iter()
            .map(|damping| Ok((damping, along_speed(&field, start(damping)?, [BRIDGE, damping])?)))
            .collect::<Result<Vec<_>, Error>>()?;
        control.done(0.5);
        unless_stopped(control)?;
        let closed = along_speed(&field, start(DETACHED)?, [BRIDGE, DETACHED])?;
        if let Some(stop) = closed.stops[1].as_ref().filter(|stop| !matches!(stop, Stop::Closed)) {
            return Err(Error::NothingFound(format!(
                "the branch of cycles at c_q = {DETACHED} N s/m does not close: {stop}"
            )));
        }
        control.done(0.6);
        unless_stopped(control)?;
        let fold = closed
            .of_kind(SpecialKind::FoldOfCycles)
            .max_by(|a, b| a.value.total_cmp(&b.value))
            .ok_or_else(|| Error::not_found("fold of cycles", "c_q = 0.1 N s/m"))?;
        let folds = CycleLocus::of(&field)
            .from_cycle(SpecialKind::FoldOfCycles, &fold.orbit, &[fold.value, DETACHED])
            .along("v", FOLD_SPEEDS)
            .and("c_q", FOLD_DAMPINGS)
            .settings(Settings { predictor_error: FOLD_PREDICTOR_ERROR, ..settings() })
            .run()?;
        control.done(0.9);
        unless_stopped(control)?;
        let death = largest_damping(&field, &folds)?;
        Ok(Self {
            hopf_points,
            attached,
            undamped_angle,
            closed,
            shown,
            folds,
            birth: HopfVertex::new()?,
            death,
        })
    }

    /// Folds of the closed branch by speed.
    pub(super) fn closed_folds(&self) -> Vec<&CyclePoint> {
        let mut folds: Vec<&CyclePoint> = self.closed.of_kind(SpecialKind::FoldOfCycles).collect();
        folds.sort_by(|a, b| a.value.total_cmp(&b.value));
        folds
    }

    fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut find =
            |quantity: String, value: f64, unit| findings.push(Finding::new(quantity, value, unit));
        for hopf in &self.hopf_points {
            let criticality = format!("{:?}", hopf.criticality).to_lowercase();
            find(
                format!("Hopf point at c_q = {WITH_HOPF_POINTS} N s/m, {criticality}: v"),
                hopf.value,
                "m/s",
            );
        }
        find(
            format!("largest psi at v = {BRIDGE} m/s, c_q = {} N s/m", BRIDGED.0),
            self.undamped_angle,
            "rad",
        );
        for (index, fold) in self.closed_folds().into_iter().enumerate() {
            let end = if index == 0 { "lower" } else { "upper" };
            find(format!("{end} fold of the isola at c_q = {DETACHED} N s/m: v"), fold.value, "m/s");
            find("  its period".to_owned(), fold.period, "s");
            find("  its largest psi".to_owned(), fold.max[1], "rad");
        }
        find("the last Hopf points meet, the isola is born: c_q".to_owned(), self.birth.damping, "N s/m");
        find("  v".to_owned(), self.birth.speed, "m/s");
        find("the isola shrinks to a point and dies: c_q".to_owned(), self.death.damping, "N s/m");
        find("  v".to_owned(), self.death.speed, "m/s");
        find("  period".to_owned(), self.death.period, "s");
        find("  largest psi".to_owned(), self.death.angle, "rad");
        findings
    }
}

fn settings() -> Settings {
    Settings {
        largest_parameter_change: LARGEST_CHANGE,
        predictor_error: PREDICTOR_ERROR,
        ..Settings::default()
    }
}

fn along_speed(
    field: &LateralWheel,
    start: CycleStart,
    parameters: [f64; 2],
) -> Result<CycleBranch, arclength::Error> {
    Cycles::of(field, start)
        .parameters(&parameters)
        .along("v", SPEEDS)
        .at(&[BRIDGE])
        .settings(settings())
        .run()
}
