//! The missing upper branch of figure 5: large stable shimmy in which the wheel rolls and slides in turn.
//!
//! Under a load of 100 N the paper's wheel has, beside its stable uniform motion, a periodic motion with sliding phases. It is
//! found by letting a kicked wheel settle, and followed in the speed by shooting through the events. Between it and the
//! uniform motion lies the unstable cycle of ideal rolling.

use super::animation;
use super::study::{Drawing, Finding, Study};
use super::wheel::{rounded, wheel};
use crate::error::{Error, unless_stopped};
use arclength::continuation::Settings;
use arclength::cycle::CyclePoint;
use arclength_analysis::Control;
use kingpin::branches::{Along, CycleOptions, HopfPoint};
use kingpin::shimmy::{
    PeriodicSliding, ShimmyError, SlidingBranch, SlidingBranchOptions, SlidingMotionSearch, SlidingRole,
};
use kingpin::{Key, Wheel};
use kingpin_figure::{
    Axis, Branch, Figure, Legend, Line, Marker, MarkerShape, Markers, Panel, Region, Stability, palette,
};
use kingpin_report::Columns;
use kingpin_report::numbers::readable;

/// Vertical force on the king pin in N of the paper's wheel here.
const LOAD: f64 = -100.0;
/// What the dampers in both directions are raised by in N s/m: nothing, and some; that of another wheel is scaled with the square root of
/// stiffness and rolling mass.
const DAMPINGS: [f64; 2] = [0.0, 0.1];
/// Speed in m/s at which the shimmy is sought, and those over which the motions are followed: for the paper's wheel, and for another as
/// parts of its critical speed, or where it has none of its own speed.
const START: f64 = 8.4;
const SPEEDS: (f64, f64) = (7.0, 9.6);
const STARTS_AT: f64 = 0.995;
const PARTS: (f64, f64) = (0.83, 1.14);
const PARTS_OF_OWN: (f64, f64) = (0.5, 2.0);
/// The angle in rad at which the caster is released, and the time in s in which it settles.
const RELEASE_ANGLE: f64 = 1.2;
const SETTLING_TIME: f64 = 25.0;
/// Where a grazing is, is found to this part of the size of the motion.
const SMALLEST_STEP: f64 = 3e-5;
/// Samples of a period between which the friction force of a cycle is looked at.
const FORCE_SAMPLES: usize = 400;

/// The wheel, and where its motions are looked at.
#[derive(Clone, Copy)]
struct Subject {
    wheel: Wheel,
    start: f64,
    speeds: (f64, f64),
    /// What the dampers are raised by.
    damping: f64,
    /// What the speed to start at is, in words; nothing for the paper's wheel.
    place: &'static str,
}

impl Subject {
    /// Without further damping, and with some: of the wheel that is given, or of the paper's.
    fn both(given: Option<&Wheel>) -> Result<[Self; 2], Error> {
        let Some(given) = given else {
            let wheel = wheel(&[(Key::FAz, LOAD)])?;
            return Ok(DAMPINGS.map(|damping| Self {
                wheel,
                start: START,
                speeds: SPEEDS,
                damping,
                place: "",
            }));
        };
        let (reference, parts, place) = match given.critical_speed() {
            Some(critical) => {
                (critical.speed, PARTS, ", 0.995 of the critical speed, where this study begins")
            }
            None => {
                (given.get(Key::V), PARTS_OF_OWN, ", 0.995 of the wheel's own speed, where this study begins")
            }
        };
        let impedance = |wheel: &Wheel| {
            let spin = wheel.get(Key::JWxi) / wheel.get(Key::WheelRadius).powi(2);
            (wheel.get(Key::KQ) * (wheel.get(Key::MW) + wheel.get(Key::MC) + spin)).sqrt()
        };
        let scale = impedance(given) / impedance(&Wheel::default());
        Ok(DAMPINGS.map(|damping| Self {
            wheel: *given,
            start: (1e3 * STARTS_AT * reference).round() / 1e3,
            speeds: (rounded(parts.0 * reference), rounded(parts.1 * reference)),
            damping: if damping == 0.0 { 0.0 } else { rounded(damping * scale) },
            place,
        }))
    }

    /// The wheel at a speed, with its dampers raised.
    fn at(&self, speed: f64) -> Result<Wheel, Error> {
        let raised = |key: Key| self.wheel.get(key) + self.damping;
        Ok(self.wheel.with(Key::V, speed)?.with(Key::CU, raised(Key::CU))?.with(Key::CQ, raised(Key::CQ))?)
    }

    /// The lateral damping in N s/m.
    fn lateral_damping(&self) -> f64 {
        self.wheel.get(Key::CQ) + self.damping
    }

    /// The dampers in words.
    fn dampers(&self) -> String {
        let [along, across] = [Key::CU, Key::CQ].map(|key| self.wheel.get(key) + self.damping);
        match along == across {
            true => format!("c_u = c_q = {} N s/m", readable(across)),
            false => format!("c_u = {} N s/m, c_q = {} N s/m", readable(along), readable(across)),
        }
    }
}

/// Motions along the speed with one damping.
struct Motions {
    subject: Subject,
    at_start: PeriodicSliding,
    shimmy: SlidingBranch,
    /// Where the uniform motion loses its stability within the speeds, and the cycles born there.
    hopf: Option<HopfPoint>,
    cycles: Vec<CyclePoint>,
    /// For every cycle the largest friction force over the static limit.
    friction: Vec<f64>,
}

pub(super) fn study(given: Option<&Wheel>, control: &Control<'_>) -> Result<Study, Error> {
    let [first, second] = Subject::both(given)?;
    let (bare, damped) =
        rayon::join(|| Motions::compute(first, control), || Motions::compute(second, control));
    let all = [bare?, damped?];
    unless_stopped(control)?;
    control.done(0.9);
    let findings = all.iter().map(Motions::findings).collect::<Result<Vec<_>, _>>()?.concat();
    let animation = animation::animation(&all[0].at_start)?;
    Ok(Study {
        findings,
        drawings: vec![drawing(&all)?],
        pictures: vec![("animation.svg", animation)],
        notes: Vec::new(),
    })
}

impl Motions {
    fn compute(subject: Subject, control: &Control<'_>) -> Result<Self, Error> {
        let wheel = subject.at(subject.start)?;
        let start = wheel.perturbed_uniform_motion(&[("psi", RELEASE_ANGLE)])?;
        let search = SlidingMotionSearch { settling_time: SETTLING_TIME, ..SlidingMotionSearch::default() };
        let at_start = wheel.sliding_motion(&start, &search, &control.quiet()).map_err(|error| match error {
            ShimmyError::Interrupted(interrupted) => interrupted.into(),
            // What a search that succeeds needs is wrong, or there is no such motion.
            other => Error::NothingFound(format!(
                "no shimmy with sliding phases was found with {} at v = {} m/s{}: the caster was released {RELEASE_ANGLE} rad from the uniform \
                 motion and the motion followed for {SETTLING_TIME} s: {other}; `kingpin shimmy` seeks it over all speeds",
                subject.dampers(),
                subject.start,
                subject.place
            )),
        })?;
        let along = Along::new(Key::V, subject.speeds.0, subject.speeds.1)?;
        let mut options = SlidingBranchOptions::default().through_grazings(true);
        options.settings.smallest_step = SMALLEST_STEP;
        let shimmy = at_start.along(along, &options, &control.quiet(), |_, _| control.flow())?;
        let slower = subject.at(subject.speeds.0)?;
        let hopf = slower.hopf_points(along, &control.quiet())?.points.into_iter().next();
        let settings = Settings::default().largest_parameter_change(0.02).predictor_error(0.005);
        let options = CycleOptions::default().settings(settings);
        let mut cycles = match &hopf {
            Some(hopf) => hopf.cycles(along, &options, |_| control.flow())?.points,
            None => Vec::new(),
        };
        cycles.sort_by(|a, b| b.value.total_cmp(&a.value));
        let friction = cycles.iter().map(|cycle| friction(cycle, &subject)).collect::<Result<_, Error>>()?;
        Ok(Self { subject, at_start, shimmy, hopf, cycles, friction })
    }

    /// The smallest and largest speed of stable shimmy on the branch.
    fn stable_range(&self) -> Option<[f64; 2]> {
        let stable = self.shimmy.points.iter().filter(|point| point.motion.stable == Some(true));
        stable.map(|point| point.value).fold(None, |range, value| match range {
            None => Some([value, value]),
            Some([low, high]) => Some([low.min(value), high.max(value)]),
        })
    }

    /// The speeds at which both the shimmy and the uniform motion are stable.
    fn both_stable(&self) -> Result<Option<[f64; 2]>, Error> {
        let Some([low, high]) = self.stable_range() else { return Ok(None) };
        let is_stable = |speed: f64| -> Result<bool, Error> {
            Ok(self.subject.at(speed)?.uniform_motion()?.is_stable() == Some(true))
        };
        let hopf = self.hopf.as_ref().map_or(f64::NAN, |hopf| hopf.value);
        let (slow, fast) = match (is_stable(low)?, low < hopf && hopf < high) {
            (true, false) => (low, high),
            (true, true) => (low, hopf),
            (false, true) => (hopf, high),
            (false, false) => return Ok(None),
        };
        Ok(Some([slow, fast]))
    }

    /// The speed below which the unstable cycle of ideal rolling asks for more than the static friction, by
    /// interpolation between cycles.
    fn rolling_ends(&self) -> Option<f64> {
        let pairs = self.cycles.windows(2).zip(self.friction.windows(2));
        pairs
            .filter(|(_, friction)| (friction[0] < 1.0) != (friction[1] < 1.0))
            .map(|(cycles, friction)| {
                let part = (1.0 - friction[0]) / (friction[1] - friction[0]);
                cycles[0].value + part * (cycles[1].value - cycles[0].value)
            })
            .next()
    }

    fn findings(&self) -> Result<Vec<Finding>, Error> {
        let (dampers, start) = (self.subject.dampers(), self.subject.start);
        let mut findings = Vec::new();
        let mut find = |what: String, value: f64, unit| findings.push(Finding::new(what, value, unit));
        find(format!("{dampers}: shimmy at v = {start} m/s, period"), self.at_start.period, "s");
        find("  largest psi".into(), self.at_start.psi_max, "rad");
        find("  smallest psi".into(), self.at_start.psi_min, "rad");
        find("  part of the period in which it slides".into(), self.at_start.sliding_fraction(), "");
        let multiplier = self.at_start.multipliers.get(1).map_or(0.0, |multiplier| multiplier.norm());
        find("  modulus of its largest nontrivial multiplier".into(), multiplier, "");
        if let Some(hopf) = &self.hopf {
            find("  Hopf point of the uniform motion: v".into(), hopf.value, "m/s");
        }
        if let Some([low, high]) = self.stable_range() {
            find("  stable shimmy from v".into(), low, "m/s");
            find("    to v".into(), high, "m/s");
            if let Some([low, high]) = self.both_stable()? {
                find("  both shimmy and uniform motion stable, width in v".into(), high - low, "m/s");
            }
        }
        if let Some(speed) = self.rolling_ends() {
            find("  the unstable cycle needs more than static friction below v".into(), speed, "m/s");
        }
        Ok(findings)
    }

    fn panel(&self, tag: &str, angles: (f64, f64), legend: Legend) -> Result<Panel, Error> {
        let speeds = self.subject.speeds;
        let angles = [angles.0, angles.1];
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").limits(speeds.0, speeds.1),
            Axis::new("extremes of $\\psi$ (rad)").limits(angles[0], angles[1]),
        )
        .tag(tag)
        .legend(legend);
        if let Some([low, right]) = self.both_stable()? {
            let corners = [(low, angles[0]), (right, angles[0]), (right, angles[1]), (low, angles[1])];
            panel = panel
                .region(Region::new(corners).fill(palette::SKY_BLUE.lightened(0.75)).legend("both stable"));
        }
        let mut uniform = Vec::new();
        for index in 0..=100 {
            let speed = speeds.0 + (speeds.1 - speeds.0) * f64::from(index) / 100.0;
            let motion = self.subject.at(speed)?.uniform_motion()?;
            uniform.push(((speed, motion.psi()), Stability::from(motion.is_stable() == Some(true))));
        }
        let hopf: Vec<(f64, f64)> = self.hopf.iter().map(|hopf| (hopf.value, hopf.state[2])).collect();
        uniform.extend(hopf.iter().map(|&point| (point, Stability::Changes)));
        uniform.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        panel = panel.curve(Branch::new(uniform).color(palette::BLACK).legend("uniform motion"));
        let cycle = |extreme: fn(&CyclePoint) -> f64| {
            Line::new(
                hopf.iter().copied().chain(self.cycles.iter().map(|cycle| (cycle.value, extreme(cycle)))),
            )
            .dashed()
            .color(palette::BLUE)
        };
        let shimmy = |extreme: fn(&PeriodicSliding) -> f64| {
            Branch::new(self.shimmy.points.iter().map(|point| {
                let stability = match point.role {
                    SlidingRole::Bifurcation(_) => Stability::Changes,
                    _ => Stability::from(point.motion.stable == Some(true)),
                };
                ((point.value, extreme(&point.motion)), stability)
            }))
            .color(palette::VERMILION)
        };
        panel = panel
            .curve(shimmy(|motion| motion.psi_max).legend("shimmy with sliding phases"))
            .curve(shimmy(|motion| motion.psi_min));
        if self.hopf.is_some() {
            panel = panel
                .curve(cycle(|cycle| cycle.max[2]).legend("unstable cycle, rolling"))
                .curve(cycle(|cycle| cycle.min[2]));
            let marker = Marker::new(MarkerShape::Circle).color(palette::BLACK);
            panel = panel.markers(Markers::new(hopf, marker).legend("Hopf point"));
        }
        Ok(panel)
    }
}

/// The largest friction force along a cycle over the static limit.
fn friction(cycle: &CyclePoint, subject: &Subject) -> Result<f64, Error> {
    let wheel = subject.at(cycle.value)?;
    let initial: [f64; 5] = std::array::from_fn(|index| cycle.orbit.states[index]);
    let history = wheel.simulate_from(&initial, cycle.period, FORCE_SAMPLES, &Control::none())?;
    let largest = history.friction_force().into_iter().fold(0.0, f64::max);
    Ok(largest / (wheel.get(Key::MuS) * wheel.normal_force()))
}

fn drawing(all: &[Motions; 2]) -> Result<Drawing, Error> {
    let [bare, damped] = all;
    let title = |motions: &Motions| match motions.subject.at(motions.subject.start)?.is_damped() {
        false => Ok("no dampers".to_owned()),
        true => Ok::<_, Error>(
            motions
                .subject
                .dampers()
                .replace("c_u = c_q = ", "$c_u=c_q$ = ")
                .replace("c_u =", "$c_u$ =")
                .replace(" c_q =", " $c_q$ ="),
        ),
    };
    let angles = angles(all);
    let figure = Figure::double_column()
        .columns(2)
        .height_mm(92.0)
        .description(
            "Extremes of the caster angle against the speed: uniform motion, unstable cycle, large shimmy",
        )
        .panel(bare.panel("(a)", angles, Legend::Below)?.title(title(bare)?))
        .panel(damped.panel("(b)", angles, Legend::Below)?.title(title(damped)?));
    Ok(Drawing { number: 8, figure, data: data(all) })
}

/// The caster angles that are shown: all, with some room.
fn angles(all: &[Motions; 2]) -> (f64, f64) {
    let of_shimmy = all.iter().flat_map(|motions| &motions.shimmy.points);
    let of_cycles = all.iter().flat_map(|motions| &motions.cycles);
    let ranges = of_shimmy
        .map(|point| (point.motion.psi_min, point.motion.psi_max))
        .chain(of_cycles.map(|cycle| (cycle.min[2], cycle.max[2])));
    let (low, high) = ranges.fold((0.0_f64, 0.0_f64), |all, one| (all.0.min(one.0), all.1.max(one.1)));
    let room = 0.08 * (high - low);
    (low - room, high + room)
}

fn data(all: &[Motions; 2]) -> Columns {
    let word = |stable: Option<bool>| match stable {
        Some(true) => "stable",
        Some(false) => "unstable",
        None => "undecided",
    };
    let mut rows = Vec::new();
    for motions in all {
        for point in &motions.shimmy.points {
            let motion = &point.motion;
            let slides = Some(motion.sliding_fraction());
            rows.push((
                "shimmy",
                motions.subject.lateral_damping(),
                [point.value, motion.period, motion.psi_max, motion.psi_min],
                slides,
                None,
                word(motion.stable),
            ));
        }
        for (cycle, &friction) in motions.cycles.iter().zip(&motions.friction) {
            rows.push((
                "rolling cycle",
                motions.subject.lateral_damping(),
                [cycle.value, cycle.period, cycle.max[2], cycle.min[2]],
                None,
                Some(friction),
                word(cycle.stable),
            ));
        }
    }
    let number = |index: usize| rows.iter().map(move |row| row.2[index]);
    Columns::new()
        .texts("solution", rows.iter().map(|row| Some(row.0.to_owned())))
        .numbers("c_u = c_q [N s/m]", rows.iter().map(|row| row.1))
        .numbers("v [m/s]", number(0))
        .numbers("period [s]", number(1))
        .numbers("psi_max [rad]", number(2))
        .numbers("psi_min [rad]", number(3))
        .optional_numbers("part sliding [1]", rows.iter().map(|row| row.3))
        .optional_numbers("largest friction over static limit [1]", rows.iter().map(|row| row.4))
        .texts("stability", rows.iter().map(|row| Some(row.5.to_owned())))
}
