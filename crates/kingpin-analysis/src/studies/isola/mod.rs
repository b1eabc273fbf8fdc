//! Isolas: large oscillations that straight running gives no warning of.
//!
//! The model with lateral elasticity only (Takács, Stépán and Hogan, "Isolated large amplitude periodic motions of towed
//! rigid wheels", 2008) at the paper's wheel with a short caster. [`Isola::compute`] follows branches of cycles along the
//! speed for several dampers, then the folds in speed and damping; [`drawing`](Isola::drawing) shows both.

mod drawing;

use super::study::{Finding, Study};
use super::wheel::{rounded, wheel};
use crate::error::{Error, unless_stopped};
use crate::last_fold::LastFold;
use arclength::branch::SpecialKind;
use arclength::continuation::{Settings, Stop, Wording};
use arclength::cycle::{CycleBranch, CycleEnd, CyclePoint, Cycles};
use arclength::equilibrium::{Equilibria, HopfPoint};
use arclength::locus::{CycleLocus, CycleLocusBranch};
use arclength_analysis::Control;
use kingpin::{Key, KingpinError, LateralWheel, Wheel};
use kingpin_report::numbers::readable;

/// Caster length in m of the paper's wheel here: shorter than the critical one, so that straight running shimmies without damper.
const CASTER_LENGTH: f64 = 0.04;

/// Speeds in m/s and lateral dampings in N s/m that are looked at: those below for the paper's wheel; for another they are scaled with the
/// speed and the damping at which its isola is born.
#[derive(Clone, Debug)]
pub(super) struct Ranges {
    /// Damping with Hopf points, and without.
    pub with_hopf_points: f64,
    pub detached: f64,
    /// Dampings of further closed branches that are shown.
    pub shown: [f64; 2],
    /// Smallest and largest damping of the cycle that is followed from one to the other.
    pub bridged: (f64, f64),
    /// Speed of that cycle.
    pub bridge: f64,
    /// Speeds along which branches and folds are followed.
    pub speeds: (f64, f64),
    /// Speeds in which Hopf points are sought, and from which one on.
    pub hopf_speeds: (f64, f64),
    pub hopf_start: f64,
    /// Dampings in which folds are followed.
    pub fold_dampings: (f64, f64),
}

/// Those of the paper's wheel.
const RANGES: Ranges = Ranges {
    with_hopf_points: 0.05,
    detached: 0.1,
    shown: [0.08, 0.11],
    bridged: (1e-3, 0.2),
    bridge: 10.0,
    speeds: (0.015, 60.0),
    hopf_speeds: (0.1, 20.0),
    hopf_start: 1.0,
    fold_dampings: (0.02, 1.0),
};

impl Ranges {
    /// Those of a wheel whose isola is born at some damping and speed.
    fn of(birth: &HopfVertex) -> Result<Self, Error> {
        let paper = HopfVertex::of(&lateral_wheel(None)?)
            .ok_or_else(|| Error::not_found("isola", "the paper's wheel"))?;
        let damping = |value: f64| rounded(value * (birth.damping / paper.damping));
        let speed = |value: f64| rounded(value * (birth.speed / paper.speed));
        let Ranges {
            with_hopf_points,
            detached,
            shown,
            bridged,
            bridge,
            speeds,
            hopf_speeds,
            hopf_start,
            fold_dampings,
        } = RANGES;
        Ok(Self {
            with_hopf_points: damping(with_hopf_points),
            detached: damping(detached),
            shown: shown.map(damping),
            bridged: (damping(bridged.0), damping(bridged.1)),
            bridge: speed(bridge),
            speeds: (speed(speeds.0), speed(speeds.1)),
            hopf_speeds: (speed(hopf_speeds.0), speed(hopf_speeds.1)),
            hopf_start: speed(hopf_start),
            fold_dampings: (damping(fold_dampings.0), damping(fold_dampings.1)),
        })
    }
}

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
    pub death: LastFold,
    /// What was looked at.
    pub ranges: Ranges,
}

/// The lateral damping above which straight running has no Hopf points, and the speed at which the last two meet.
///
/// With `u = 0` and `r = inf` the characteristic polynomial of straight running is
/// `J s^3 + (m v + l^2 c_q + c_psi) s^2 + (l^2 k_q + l c_q v + k_psi) s + l k_q v`: the Hopf condition is quadratic in `v`, with two positive
/// roots up to a damping. Without `c_psi` and `k_psi` that is `sqrt(k_q) (sqrt(J) - sqrt(m l))/l`, and they meet at
/// `v = sqrt(l^3 k_q/m)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct HopfVertex {
    pub speed: f64,
    pub damping: f64,
    wheel: Wheel,
}

/// The interval in which the damping of the vertex lies is doubled up to so many times, and halved so many times.
const DOUBLINGS: usize = 200;
const HALVINGS: usize = 200;

/// Coefficients of the Hopf condition `a v^2 + b v + c = 0` with a lateral damping.
fn hopf_condition(wheel: &Wheel, damping: f64) -> [f64; 3] {
    let [mass, inertia, inertia_of_wheel, arm, stiffness, l] =
        [Key::MC, Key::JCz, Key::JWzeta, Key::LC, Key::KQ, Key::L].map(|key| wheel.get(key));
    let distance = l - arm;
    let static_moment = mass * distance;
    let yaw_inertia = inertia + inertia_of_wheel + mass * distance * distance;
    let viscous = l * l * damping + wheel.get(Key::CPsi);
    let elastic = l * l * stiffness + wheel.get(Key::KPsi);
    [
        static_moment * l * damping,
        static_moment * elastic + viscous * l * damping - yaw_inertia * l * stiffness,
        viscous * elastic,
    ]
}

impl HopfVertex {
    /// That of a wheel; nothing where straight running has no Hopf points however small the damping is.
    fn of(wheel: &Wheel) -> Option<Self> {
        // Below zero while there are two roots.
        let excess = |damping: f64| {
            let [a, b, c] = hopf_condition(wheel, damping);
            b + 2.0 * (a * c).sqrt()
        };
        let smallest = Key::CQ.allowed().highest * f64::EPSILON.powi(2);
        if wheel.get(Key::L) <= wheel.get(Key::LC) || excess(smallest) >= 0.0 {
            return None;
        }
        let mut high =
            (0..DOUBLINGS).map(|power| smallest * 2_f64.powi(power as i32)).find(|&c| excess(c) > 0.0)?;
        let mut low = 0.5 * high;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        let [a, _, c] = hopf_condition(wheel, low);
        Some(Self { speed: (c / a).sqrt(), damping: low, wheel: *wheel })
    }

    /// Both speeds at which straight running has a Hopf point with this damping.
    pub(super) fn speeds_at(&self, damping: f64) -> Option<[f64; 2]> {
        let [a, b, c] = hopf_condition(&self.wheel, damping);
        let half = -0.5 * b / a;
        let product = c / a;
        let root = half * half - product;
        (root >= 0.0).then(|| {
            let upper = half + root.sqrt();
            [product / upper, upper]
        })
    }
}

/// A wheel with lateral elasticity only and without lateral damper, towed straight: that which is given, or the paper's.
fn lateral_wheel(given: Option<&Wheel>) -> Result<Wheel, KingpinError> {
    let base = match given {
        Some(given) => *given,
        None => wheel(&[(Key::L, CASTER_LENGTH)])?,
    };
    base.with(Key::KU, f64::INFINITY)?.with(Key::TurningRadius, f64::INFINITY)?.with(Key::CQ, 0.0)
}

pub(super) fn study(given: Option<&Wheel>, control: &Control<'_>) -> Result<Study, Error> {
    let notes = given.and_then(replaced).into_iter();
    Ok(match Isola::compute(&lateral_wheel(given)?, control)? {
        Outcome::Isola(isola) => Study {
            findings: isola.findings(),
            drawings: vec![isola.drawing()],
            pictures: Vec::new(),
            notes: notes.collect(),
        },
        Outcome::None(why) => {
            Study { notes: std::iter::once(why).chain(notes).collect(), ..Study::default() }
        }
    })
}

/// Which parameters of a wheel that is given the study replaces; nothing where they are those of the study.
fn replaced(given: &Wheel) -> Option<String> {
    let (radius, damping, stiffness) =
        (given.get(Key::TurningRadius), given.get(Key::CQ), given.get(Key::KU));
    let mut left_out = Vec::new();
    if radius.is_finite() {
        left_out.push(format!("r = {} m by r = inf", readable(radius)));
    }
    if stiffness.is_finite() {
        left_out.push(format!("k_u = {} N/m by k_u = inf", readable(stiffness)));
    }
    if damping > 0.0 {
        left_out.push(format!("c_q = {} N s/m by the dampers that are told", readable(damping)));
    }
    let said = "the study is about straight running with lateral elasticity only; of this wheel it replaces";
    (!left_out.is_empty()).then(|| format!("{said} {}", left_out.join(", ")))
}

/// What comes of a search.
pub(super) enum Outcome {
    /// An isola.
    Isola(Box<Isola>),
    /// None, and what was searched.
    None(String),
}

/// The branches of cycles from Hopf points, every branch once.
fn attached_branches(
    field: &LateralWheel,
    hopf_points: &[HopfPoint],
    ranges: &Ranges,
) -> Result<Vec<CycleBranch>, Error> {
    let mut attached: Vec<CycleBranch> = Vec::new();
    for hopf in hopf_points {
        let ends_here = |branch: &CycleBranch| {
            matches!(branch.stops[1], Some(Stop::Problem(CycleEnd::HopfPoint { parameter, .. }))
                if (parameter / hopf.value - 1.0).abs() < SAME)
        };
        if !attached.iter().any(ends_here) {
            attached.push(along_speed(hopf.cycles(field), ranges)?);
        }
    }
    Ok(attached)
}

/// That the largest cycles at a damping, followed to stronger ones at a speed, end before straight running becomes stable.
fn none_found(
    birth: &HopfVertex,
    attached: &[CycleBranch],
    bridged: &CycleBranch,
    (damping, speed): (f64, f64),
) -> String {
    let found: Vec<String> = attached.iter().map(|branch| told(branch, "v", "m/s")).collect();
    format!(
        "no isola was found. Straight running is stable at every speed from c_q = {} N s/m on; the largest cycles at c_q = {damping} N s/m, \
         followed in the damping at v = {} m/s, end before that: {}. Searched were the branches from the Hopf points at c_q = {damping} \
         N s/m: {}",
        readable(birth.damping),
        readable(speed),
        told(bridged, "c_q", "N s/m"),
        found.join("; ")
    )
}

/// The folds of a closed branch in speed and damping.
fn folds_of(field: &LateralWheel, closed: &CycleBranch, ranges: &Ranges) -> Result<CycleLocusBranch, Error> {
    let curve = closed
        .of_kind(SpecialKind::FoldOfCycles)
        .max_by(|a, b| a.value.total_cmp(&b.value))
        .and_then(|fold| fold.curve(field))
        .ok_or_else(|| Error::not_found("fold of cycles", &format!("c_q = {} N s/m", ranges.detached)))?;
    Ok(curve
        .along("v", ranges.speeds.0..=ranges.speeds.1)
        .and("c_q", ranges.fold_dampings.0..=ranges.fold_dampings.1)
        .settings(settings().predictor_error(FOLD_PREDICTOR_ERROR))
        .run()?)
}

impl Isola {
    pub(super) fn compute(wheel: &Wheel, control: &Control<'_>) -> Result<Outcome, Error> {
        let Some(birth) = HopfVertex::of(wheel) else {
            return Ok(Outcome::None(
                "no isola: with lateral elasticity only (k_u = inf) straight running of this wheel is stable at every speed however weak \
                 the lateral damper is, so that there are no cycles that a damper could detach; that follows from the Hopf \
                 condition, nothing else was searched"
                    .to_owned(),
            ));
        };
        let mut ranges = Ranges::of(&birth)?;
        let Ranges { with_hopf_points, bridged: dampings, .. } = ranges;
        let field = wheel.lateral(&[Key::V, Key::CQ])?;
        let straight = Equilibria::of(&field)
            .parameters(&[ranges.hopf_start, with_hopf_points])
            .along("v", ranges.hopf_speeds.0..=ranges.hopf_speeds.1)
            .run()?;
        let mut hopf_points: Vec<HopfPoint> = straight.hopf_points().cloned().collect();
        hopf_points.sort_by(|a, b| a.value.total_cmp(&b.value));
        let attached = attached_branches(&field, &hopf_points, &ranges)?;
        control.done(0.2);
        unless_stopped(control)?;
        let largest = |at: &dyn Fn(&&CyclePoint) -> bool| {
            let points = attached.iter().flat_map(|branch| &branch.points).filter(at);
            points.max_by(|a, b| a.max[1].total_cmp(&b.max[1]))
        };
        // Where no cycle has that speed, the largest of all is followed.
        let bridge = largest(&|point| point.value == ranges.bridge).or_else(|| largest(&|_| true));
        let Some(bridge) = bridge else {
            return Ok(Outcome::None(format!(
                "no isola: straight running has no Hopf point at c_q = {with_hopf_points} N s/m for v from {} to {} m/s, and so no cycles",
                ranges.hopf_speeds.0, ranges.hopf_speeds.1
            )));
        };
        let speed = bridge.value;
        ranges.bridge = speed;
        let follow =
            |wanted: &[f64]| bridge.cycles(&field).along("c_q", dampings.0..=dampings.1).at(wanted).run();
        let mut bridged = follow(&[ranges.shown[0], ranges.detached, ranges.shown[1]])?;
        let strongest = bridged.points.iter().map(|point| point.value).fold(0.0, f64::max);
        if strongest < ranges.detached {
            if strongest <= birth.damping {
                return Ok(Outcome::None(none_found(&birth, &attached, &bridged, (with_hopf_points, speed))));
            }
            // Between the two the branch is detached.
            ranges.detached = 0.5 * (birth.damping + strongest);
            bridged = follow(&[ranges.detached])?;
        }
        let reached = |damping: f64| -> Result<&CyclePoint, Error> {
            let at = |point: &&CyclePoint| point.value == damping;
            let found = bridged.points.iter().find(at);
            let place = || format!("v = {} m/s, c_q = {} N s/m", readable(speed), readable(damping));
            found.ok_or_else(|| Error::not_found("limit cycle", &place()))
        };
        control.done(0.3);
        unless_stopped(control)?;
        let lightest = bridged.points.iter().min_by(|a, b| a.value.total_cmp(&b.value));
        let undamped_angle = lightest.map_or(0.0, |point| point.max[1]);
        let shown = ranges
            .shown
            .into_iter()
            .filter(|damping| reached(*damping).is_ok())
            .map(|damping| Ok((damping, along_speed(reached(damping)?.cycles(&field), &ranges)?)))
            .collect::<Result<Vec<_>, Error>>()?;
        control.done(0.5);
        unless_stopped(control)?;
        let detached = ranges.detached;
        let closed = along_speed(reached(detached)?.cycles(&field), &ranges)?;
        if let Some(stop) = closed.stops[1].as_ref().filter(|stop| !matches!(stop, Stop::Closed)) {
            return Err(Error::NothingFound(format!(
                "the branch of cycles at c_q = {detached} N s/m does not close: {stop}"
            )));
        }
        control.done(0.6);
        unless_stopped(control)?;
        let folds = folds_of(&field, &closed, &ranges)?;
        control.done(0.9);
        unless_stopped(control)?;
        let death = largest_damping(&field, &folds)?;
        let isola =
            Self { hopf_points, attached, undamped_angle, closed, shown, folds, birth, death, ranges };
        Ok(Outcome::Isola(Box::new(isola)))
    }

    /// Folds of the closed branch by speed.
    pub(super) fn closed_folds(&self) -> Vec<&CyclePoint> {
        let mut folds: Vec<&CyclePoint> = self.closed.of_kind(SpecialKind::FoldOfCycles).collect();
        folds.sort_by(|a, b| a.value.total_cmp(&b.value));
        folds
    }

    fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        let Ranges { with_hopf_points, detached, bridge, bridged, .. } = &self.ranges;
        let mut find =
            |quantity: String, value: f64, unit| findings.push(Finding::new(quantity, value, unit));
        for hopf in &self.hopf_points {
            let criticality = format!("{:?}", hopf.criticality).to_lowercase();
            find(
                format!("Hopf point at c_q = {with_hopf_points} N s/m, {criticality}: v"),
                hopf.value,
                "m/s",
            );
        }
        find(
            format!("largest psi at v = {bridge} m/s, c_q = {} N s/m", bridged.0),
            self.undamped_angle,
            "rad",
        );
        for (index, fold) in self.closed_folds().into_iter().enumerate() {
            let end = if index == 0 { "lower" } else { "upper" };
            find(format!("{end} fold of the isola at c_q = {detached} N s/m: v"), fold.value, "m/s");
            find("  its period".to_owned(), fold.period, "s");
            find("  its largest psi".to_owned(), fold.max[1], "rad");
        }
        find("the last Hopf points meet, the isola is born: c_q".to_owned(), self.birth.damping, "N s/m");
        find("  v".to_owned(), self.birth.speed, "m/s");
        find("the isola shrinks to a point and dies: c_q".to_owned(), self.death.damping, "N s/m");
        find("  v".to_owned(), self.death.value, "m/s");
        find("  period".to_owned(), self.death.period, "s");
        find("  largest psi".to_owned(), self.death.angle, "rad");
        let neglected = self.birth.wheel.get(Key::MF);
        if neglected > 0.0 {
            find("dry friction about the king pin, which is left out: M_f".to_owned(), neglected, "N m");
        }
        findings
    }
}

fn settings() -> Settings {
    Settings::default().largest_parameter_change(LARGEST_CHANGE).predictor_error(PREDICTOR_ERROR)
}

/// The range of a branch and why it ends, in words.
fn told(branch: &CycleBranch, key: &str, unit: &str) -> String {
    let values = || branch.points.iter().map(|point| point.value);
    let wording = Wording::of([(key, Some(unit))]);
    let ends: Vec<String> = branch.stops.iter().flatten().map(|stop| stop.explain(&wording).cause).collect();
    format!(
        "{key} from {} to {} {unit} ({})",
        readable(values().fold(f64::INFINITY, f64::min)),
        readable(values().fold(f64::NEG_INFINITY, f64::max)),
        ends.join("; ")
    )
}

fn along_speed(cycles: Cycles<'_>, ranges: &Ranges) -> Result<CycleBranch, arclength::Error> {
    cycles.along("v", ranges.speeds.0..=ranges.speeds.1).at(&[ranges.bridge]).settings(settings()).run()
}

/// The fold with the largest damping.
fn largest_damping(field: &LateralWheel, folds: &CycleLocusBranch) -> Result<LastFold, Error> {
    let found = LastFold::inside(
        &folds.points,
        |fold| fold.max[1],
        |start, [from, to], wanted| {
            let [speed, damping] = start.values;
            let window = CycleLocus::of(field)
                .from_cycle(SpecialKind::FoldOfCycles, &start.orbit, &[speed, damping])
                .along("v", from..=to)
                .and("c_q", 0.5 * damping..=2.0 * damping)
                .at(wanted)
                .run()?;
            Ok::<_, Error>(window.points)
        },
    )?;
    found.ok_or_else(|| {
        let ends: Vec<String> = folds.stops.iter().flatten().map(ToString::to_string).collect();
        let place = format!("the curve of folds, which ends because: {}", ends.join("; "));
        Error::not_found("largest damping", &place)
    })
}
