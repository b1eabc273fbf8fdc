//! The missing upper branch of figure 5: large stable shimmy in which the wheel rolls and slides in turn.
//!
//! Under a load of 100 N the paper's wheel has, beside its stable uniform motion, a periodic motion with sliding phases. It is
//! found by letting a kicked wheel settle, and followed in the speed by shooting through the events. Between it and the
//! uniform motion lies the unstable cycle of ideal rolling.

use super::animation;
use super::study::{Drawing, Finding, Study};
use super::wheel::wheel;
use crate::error::{Error, unless_stopped};
use arclength::continuation::Settings;
use arclength::cycle::CyclePoint;
use arclength_analysis::Control;
use kingpin::branches::{Along, CycleOptions, HopfPoint};
use kingpin::shimmy::{
    PeriodicSliding, SlidingBranch, SlidingBranchOptions, SlidingMotionSearch, SlidingRole,
};
use kingpin::{Key, Wheel};
use kingpin_figure::{
    Axis, Branch, Figure, Legend, Line, Marker, MarkerShape, Markers, Panel, Region, Stability, palette,
};
use kingpin_report::Columns;

/// Vertical force on the king pin in N.
const LOAD: f64 = -100.0;
/// Damping in both directions in N s/m: none, and some.
const DAMPINGS: [f64; 2] = [0.0, 0.1];
/// Speed in m/s at which the shimmy is sought, and the angle in rad at which the caster is released.
const START: f64 = 8.4;
const RELEASE_ANGLE: f64 = 1.2;
const SETTLING_TIME: f64 = 25.0;
/// Speeds in m/s over which the motions are followed.
const SPEEDS: (f64, f64) = (7.0, 9.6);
/// Where a grazing is, is found to this part of the size of the motion.
const SMALLEST_STEP: f64 = 3e-5;
/// Samples of a period between which the friction force of a cycle is looked at.
const FORCE_SAMPLES: usize = 400;

/// Motions along the speed with one damping.
struct Motions {
    damping: f64,
    at_start: PeriodicSliding,
    shimmy: SlidingBranch,
    /// Where the uniform motion loses its stability within the speeds, and the cycles born there.
    hopf: Option<HopfPoint>,
    cycles: Vec<CyclePoint>,
    /// For every cycle the largest friction force over the static limit.
    friction: Vec<f64>,
}

fn loaded(speed: f64, damping: f64) -> Result<Wheel, Error> {
    Ok(wheel(&[(Key::V, speed), (Key::FAz, LOAD), (Key::CU, damping), (Key::CQ, damping)])?)
}

pub(super) fn study(control: &Control<'_>) -> Result<Study, Error> {
    let [first, second] = DAMPINGS;
    let (bare, damped) =
        rayon::join(|| Motions::compute(first, control), || Motions::compute(second, control));
    let all = [bare?, damped?];
    unless_stopped(control)?;
    control.done(0.9);
    let findings = all.iter().flat_map(Motions::findings).collect();
    let animation = animation::animation(&all[0].at_start)?;
    Ok(Study { findings, drawings: vec![drawing(&all)?], pictures: vec![("animation.svg", animation)] })
}

impl Motions {
    fn compute(damping: f64, control: &Control<'_>) -> Result<Self, Error> {
        let wheel = loaded(START, damping)?;
        let start = wheel.perturbed_uniform_motion(&[("psi", RELEASE_ANGLE)])?;
        let search = SlidingMotionSearch { settling_time: SETTLING_TIME, ..SlidingMotionSearch::default() };
        let at_start = wheel.sliding_motion(&start, &search, &control.quiet())?;
        let along = Along::new(Key::V, SPEEDS.0, SPEEDS.1)?;
        let mut options = SlidingBranchOptions { through_grazings: true, ..SlidingBranchOptions::default() };
        options.settings.smallest_step = SMALLEST_STEP;
        let shimmy = at_start.along(along, &options, &control.quiet(), |_, _| control.flow())?;
        let slower = loaded(SPEEDS.0, damping)?;
        let hopf = slower.hopf_points(along, &control.quiet())?.points.into_iter().next();
        let settings =
            Settings { largest_parameter_change: 0.02, predictor_error: 0.005, ..Settings::default() };
        let options = CycleOptions { settings, ..CycleOptions::default() };
        let mut cycles = match &hopf {
            Some(hopf) => hopf.cycles(along, &options, |_| control.flow())?.points,
            None => Vec::new(),
        };
        cycles.sort_by(|a, b| b.value.total_cmp(&a.value));
        let friction = cycles.iter().map(|cycle| friction(cycle, damping)).collect::<Result<_, Error>>()?;
        Ok(Self { damping, at_start, shimmy, hopf, cycles, friction })
    }

    /// The smallest and largest speed of stable shimmy on the branch.
    fn stable_range(&self) -> Option<[f64; 2]> {
        let stable = self.shimmy.points.iter().filter(|point| point.motion.stable == Some(true));
        stable.map(|point| point.value).fold(None, |range, value| match range {
            None => Some([value, value]),
            Some([low, high]) => Some([low.min(value), high.max(value)]),
        })
    }

    /// The smaller one of a speed and that at which the uniform motion loses its stability.
    fn limit(&self, speed: f64) -> f64 {
        self.hopf.as_ref().map_or(speed, |hopf| speed.min(hopf.value))
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

    fn findings(&self) -> Vec<Finding> {
        let dampers = format!("c_u = c_q = {} N s/m", self.damping);
        let mut findings = Vec::new();
        let mut find = |what: String, value: f64, unit| findings.push(Finding::new(what, value, unit));
        find(format!("{dampers}: shimmy at v = {START} m/s, period"), self.at_start.period, "s");
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
            find("  both shimmy and uniform motion stable, width in v".into(), self.limit(high) - low, "m/s");
        }
        if let Some(speed) = self.rolling_ends() {
            find("  the unstable cycle needs more than static friction below v".into(), speed, "m/s");
        }
        findings
    }

    fn panel(&self, tag: &str, legend: Legend) -> Result<Panel, Error> {
        let mut panel = Panel::new(
            Axis::new("$v$ (m/s)").limits(SPEEDS.0, SPEEDS.1),
            Axis::new("extremes of $\\psi$ (rad)").limits(-3.3, 1.6),
        )
        .tag(tag)
        .legend(legend);
        if let Some([low, high]) = self.stable_range() {
            let right = self.limit(high);
            let corners = [(low, -3.3), (right, -3.3), (right, 1.6), (low, 1.6)];
            panel = panel
                .region(Region::new(corners).fill(palette::SKY_BLUE.lightened(0.75)).legend("both stable"));
        }
        let mut uniform = Vec::new();
        for index in 0..=100 {
            let speed = SPEEDS.0 + (SPEEDS.1 - SPEEDS.0) * f64::from(index) / 100.0;
            let motion = loaded(speed, self.damping)?.uniform_motion()?;
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
fn friction(cycle: &CyclePoint, damping: f64) -> Result<f64, Error> {
    let wheel = loaded(cycle.value, damping)?;
    let initial: [f64; 5] = std::array::from_fn(|index| cycle.orbit.states[index]);
    let history = wheel.simulate_from(&initial, cycle.period, FORCE_SAMPLES, &Control::none())?;
    let largest = history.friction_force().into_iter().fold(0.0, f64::max);
    Ok(largest / (wheel.get(Key::MuS) * wheel.normal_force()))
}

fn drawing(all: &[Motions; 2]) -> Result<Drawing, Error> {
    let [bare, damped] = all;
    let title = |motions: &Motions| match motions.damping {
        0.0 => "no dampers".to_owned(),
        damping => format!("$c_u=c_q={damping}$ N s/m"),
    };
    let figure = Figure::double_column()
        .columns(2)
        .height_mm(92.0)
        .description(
            "Extremes of the caster angle against the speed: uniform motion, unstable cycle, large shimmy",
        )
        .panel(bare.panel("(a)", Legend::Below)?.title(title(bare)))
        .panel(damped.panel("(b)", Legend::Below)?.title(title(damped)));
    Ok(Drawing { number: 8, figure, data: data(all) })
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
                motions.damping,
                [point.value, motion.period, motion.psi_max, motion.psi_min],
                slides,
                None,
                word(motion.stable),
            ));
        }
        for (cycle, &friction) in motions.cycles.iter().zip(&motions.friction) {
            rows.push((
                "rolling cycle",
                motions.damping,
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
