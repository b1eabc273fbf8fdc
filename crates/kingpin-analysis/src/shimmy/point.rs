//! A periodic motion in a result: with sliding phases, or a cycle of a wheel with a tyre.

use crate::cycles::{CyclePointResult, at_cycle};
use crate::forces::ForcesResult;
use arclength::branch::SpecialKind;
use arclength::cycle::{CyclePoint, Orbit};
use arclength_analysis::branch::{pairs, stability};
use arclength_analysis::labels::is_bifurcation;
use kingpin::branches::Along;
use kingpin::shimmy::{SlidingBranchPoint, SlidingRole};
use kingpin::sliding::{Contact, KingPin, SLIDING_STATE_NAMES};
use kingpin::{Key, KingpinError, Tyre, Wheel};
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Cell, NamedNumbers};
use num_complex::Complex64;
use serde::Serialize;

/// Label of the last motion before its sequence of phases changes.
pub(super) const GRAZING: &str = "GR";

/// A stretch of the period in which the wheel only rolls or only slides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShimmyPhase {
    /// `rolling` or `sliding`.
    pub contact: &'static str,
    /// `swinging` or `sticking`, where dry friction acts about the king pin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub king_pin: Option<&'static str>,
    /// Its start in s; the period starts inside a phase.
    pub start: f64,
    /// Its end in s.
    pub end: f64,
    /// Its duration in s.
    pub duration: f64,
}

/// A periodic motion of a wheel that may slide, or of one with a tyre.
#[derive(Clone, Debug, Serialize)]
pub struct ShimmyPointResult {
    /// Number of the branch, from 1.
    pub branch: u64,
    /// LPC, PD, NS where it bifurcates, AT where it was asked for, GR where its phases change, RL where a tyre takes all the static friction.
    pub label: Option<String>,
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Period in s.
    pub period: f64,
    /// Largest caster angle in rad.
    pub psi_max: f64,
    /// Smallest caster angle in rad.
    pub psi_min: f64,
    /// Caster angle of the uniform motion in rad; nothing where there is none.
    pub psi_0: Option<f64>,
    /// Largest psi - psi_0 in rad.
    pub deviation_max: Option<f64>,
    /// Smallest psi - psi_0 in rad.
    pub deviation_min: Option<f64>,
    /// Turns of the caster in a period, towards larger angles.
    pub turns: i32,
    /// Floquet multipliers, largest modulus first, the trivial one among them.
    pub multipliers: Vec<[Option<f64>; 2]>,
    /// Distance of the computed trivial multiplier from 1.
    pub trivial_multiplier_error: f64,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Error of period and extremes, relative to the period and to the range of the angle.
    pub error_estimate: f64,
    /// Forces along it.
    #[serde(flatten)]
    pub forces: ForcesResult,
    /// What the friction takes while the wheel slides, the mean over a period in W.
    pub sliding_power: Option<f64>,
    /// What dry friction about the king pin takes, the mean over a period in W, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction_power: Option<f64>,
    /// Part of the period in which the wheel slides.
    pub sliding_fraction: f64,
    /// The phases of a period.
    pub phases: Vec<ShimmyPhase>,
    /// The states at the start of the period.
    pub state: NamedNumbers,
    /// What changes at a point GR.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
    /// The cycle of a wheel with a tyre.
    #[serde(skip)]
    pub orbit: Option<Box<Orbit>>,
}

/// Why a motion stands in a branch, before labels are numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Step,
    Special(SpecialKind),
    Grazing,
    RollingLimit,
}

impl From<SlidingRole> for Role {
    fn from(role: SlidingRole) -> Self {
        match role {
            SlidingRole::Step => Self::Step,
            SlidingRole::Requested => Self::Special(SpecialKind::Requested),
            SlidingRole::Bifurcation(kind) => Self::Special(kind),
            SlidingRole::Grazing(_) => Self::Grazing,
        }
    }
}

/// A motion of a branch with its forces.
pub(super) fn at_motion(
    point: &SlidingBranchPoint,
    forces: Option<kingpin::shimmy::ShimmyForces>,
) -> ShimmyPointResult {
    let motion = &point.motion;
    let psi_0 = motion.wheel.uniform_motion().ok().map(|uniform| uniform.psi());
    let is_dry = motion.wheel.get(Key::MF) > 0.0;
    let phases: Vec<ShimmyPhase> = motion
        .phases
        .iter()
        .map(|phase| ShimmyPhase {
            contact: if phase.contact == Contact::Rolling { "rolling" } else { "sliding" },
            king_pin: is_dry.then_some(match phase.king_pin {
                KingPin::Swinging => "swinging",
                KingPin::Sticking => "sticking",
            }),
            start: phase.start,
            end: phase.end,
            duration: phase.end - phase.start,
        })
        .collect();
    let mut forces_result = forces.map(|forces| ForcesResult::from(forces.forces)).unwrap_or_default();
    forces_result.rolls = Some(phases.iter().all(|phase| phase.contact == "rolling"));
    let state = SLIDING_STATE_NAMES.map(str::to_owned).into_iter().zip(motion.state());
    ShimmyPointResult {
        branch: 0,
        label: None,
        value: point.value,
        period: motion.period,
        psi_max: motion.psi_max,
        psi_min: motion.psi_min,
        psi_0,
        deviation_max: psi_0.map(|angle| motion.psi_max - angle),
        deviation_min: psi_0.map(|angle| motion.psi_min - angle),
        turns: motion.turns,
        multipliers: pairs(&motion.multipliers),
        trivial_multiplier_error: motion.trivial_multiplier_error,
        // At a bifurcation a multiplier is on the unit circle by definition.
        stable: if matches!(point.role, SlidingRole::Bifurcation(_)) { None } else { motion.stable },
        error_estimate: motion.error_estimate,
        forces: forces_result,
        sliding_power: forces.map(|forces| forces.sliding_power),
        dry_friction_power: forces.filter(|_| is_dry).map(|forces| forces.dry_friction_power),
        sliding_fraction: motion.sliding_fraction(),
        phases,
        state: NamedNumbers(state.collect()),
        remark: match point.role {
            SlidingRole::Grazing(change) => Some(change.to_string()),
            _ => None,
        },
        orbit: None,
    }
}

/// A cycle of a wheel with a tyre: it rolls all along.
///
/// # Errors
/// A value that the wheel does not take.
pub(super) fn at_smooth_cycle(
    cycle: CyclePoint,
    role: Role,
    wheel: &Wheel,
    along: &Along,
) -> Result<ShimmyPointResult, KingpinError> {
    let orbit = cycle.orbit.clone();
    let here = wheel.with(along.key(), cycle.value)?;
    let states = here.rolling_model(&[])?.full_state(&orbit.state_at(0.0), &[]);
    let names = here.states().iter().map(|name| (*name).to_owned());
    let CyclePointResult { psi_max, psi_min, psi_0, deviation_max, deviation_min, forces, cycle, .. } =
        at_cycle(0, cycle, None, (wheel, along))?;
    let phase = ShimmyPhase {
        contact: "rolling",
        king_pin: None,
        start: 0.0,
        end: cycle.period,
        duration: cycle.period,
    };
    let bifurcates = matches!(role, Role::Special(kind) if kind != SpecialKind::Requested);
    Ok(ShimmyPointResult {
        branch: 0,
        label: None,
        value: cycle.value,
        period: cycle.period,
        psi_max,
        psi_min,
        psi_0,
        deviation_max,
        deviation_min,
        turns: 0,
        multipliers: cycle.multipliers,
        trivial_multiplier_error: cycle.trivial_multiplier_error,
        stable: cycle.stable.filter(|_| !bifurcates),
        error_estimate: cycle.error_estimate,
        forces,
        sliding_power: None,
        dry_friction_power: None,
        sliding_fraction: 0.0,
        phases: vec![phase],
        state: NamedNumbers(names.zip(states).collect()),
        remark: (role == Role::RollingLimit).then(|| "needs all of the static friction".to_owned()),
        orbit: Some(Box::new(orbit)),
    })
}

impl ShimmyPointResult {
    /// Whether a multiplier is on the unit circle by definition.
    pub fn is_bifurcation(&self) -> bool {
        is_bifurcation(self.label.as_deref())
    }

    /// Its phases with their durations in words.
    pub(super) fn phases_in_words(&self) -> String {
        let phase = |phase: &ShimmyPhase| {
            let king_pin = phase.king_pin.filter(|what| *what == "sticking");
            let king_pin = king_pin.map(|what| format!(" {what}")).unwrap_or_default();
            format!("{}{king_pin} {}", phase.contact, readable(phase.duration))
        };
        self.phases.iter().map(phase).collect::<Vec<_>>().join(" ")
    }

    /// Its row in a table.
    pub(super) fn cells(&self) -> [Cell; 11] {
        [
            self.label.clone().into(),
            self.value.into(),
            self.period.into(),
            self.psi_max.into(),
            self.psi_min.into(),
            largest_modulus(&self.multipliers).into(),
            Cell::Text(significant(self.error_estimate, 2)),
            Cell::Text(format!("{:.1} %", 100.0 * self.sliding_fraction)),
            // The period starts inside a phase, which is listed at both ends.
            Cell::Text(self.phases.len().saturating_sub(1).max(1).to_string()),
            stability(self.stable, self.is_bifurcation()).into(),
            self.remark.clone().unwrap_or_default().into(),
        ]
    }
}

/// The largest modulus of all but the trivial multiplier, which is the nearest to 1.
fn largest_modulus(multipliers: &[[Option<f64>; 2]]) -> Option<f64> {
    let multipliers: Vec<Complex64> = multipliers
        .iter()
        .filter_map(|[real, imaginary]| Some(Complex64::new((*real)?, (*imaginary)?)))
        .collect();
    let distance = |index: usize| (multipliers[index] - 1.0).norm();
    let trivial = (0..multipliers.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let others = multipliers.iter().enumerate().filter(|(index, _)| Some(*index) != trivial);
    others.map(|(_, multiplier)| multiplier.norm()).max_by(f64::total_cmp)
}

/// What shimmy of a wheel is called: that of a rigid one slides.
pub(super) fn what(wheel: &Wheel) -> &'static str {
    if wheel.tyre() == Tyre::Rigid { "shimmy with sliding" } else { "shimmy" }
}

/// The order in which branches are told: by ascending value.
pub(super) fn ascending(points: &mut [(ShimmyPointResult, Role)]) -> bool {
    let reversed = match points {
        [(first, _), .., (last, _)] => first.value > last.value,
        _ => false,
    };
    if reversed {
        points.reverse();
    }
    reversed
}

/// Whether a value lies between those of a branch.
pub(super) fn covers(points: &[(ShimmyPointResult, Role)], value: f64) -> bool {
    points.windows(2).any(|pair| {
        let [one, two] = [&pair[0].0, &pair[1].0];
        let between = one.value.min(two.value)..=one.value.max(two.value);
        between.contains(&value) && [one, two].iter().all(|point| point.stable != Some(false))
    })
}
