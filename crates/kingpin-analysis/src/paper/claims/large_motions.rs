//! The statements about large disturbances: a radius that changes at once, the direction of a disturbance, and what becomes of the motions
//! that do not return.
//!
//! Motions are followed by Taylor's method in quadratic form. One that does not return swings farther and farther until the caster turns
//! right round, which is what is watched for.

use super::claim::{Claim, Verdict};
use crate::error::Error;
use crate::paper::branches::{Branches, FIGURE_5_RADIUS, FIGURE_6_LENGTH};
use crate::paper::numbers::{number, per_cent};
use crate::paper::wheel::paper_wheel;
use arclength_analysis::Control;
use kingpin::ensemble::{Ending, Ensemble, Progress};
use kingpin::{Key, Wheel};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Tolerance with which motions are followed.
const TOLERANCE: f64 = 1e-9;
/// How a turning radius changes at once, from what time in s on motions that have not turned right round count as returned, and the part of
/// the critical speed from which on it is looked for the edge.
const CHANGES: [(Change, f64, f64); 2] =
    [(Change::FromStraight, 60.0, 0.96), (Change::FromOppositeCurve, 20.0, 0.84)];
/// Halvings of the interval in which the edge lies.
const HALVINGS: usize = 4;
/// Radius in m and speed in m/s at which the directions are compared, the largest release angle in rad, and the time in s that motions are
/// followed.
const RELEASE_RADIUS: f64 = 0.5;
const RELEASE_SPEED: f64 = 2.0;
const LARGEST_ANGLE: f64 = 1.5;
const RELEASED: f64 = 12.0;
/// Release angles that are tried side by side, and how often the gap in which the edge lies is divided so.
const ANGLES: usize = 8;
const ROUNDS: usize = 3;
/// Effects smaller than this are not relevant, by the standard of this report.
const RELEVANT: f64 = 0.05;
/// Release angles in rad of the motions whose energy is followed, at these speeds in m/s, to these times in s.
const BEYOND: [f64; 8] = [1.36, 1.38, 1.4, 1.42, 1.44, 1.46, 1.48, 1.5];
const TUMBLING_SPEED: f64 = 4.0;
const TIMES: [f64; 3] = [10.0, 20.0, 40.0];

/// How the turning radius changes at once.
#[derive(Clone, Copy)]
enum Change {
    /// From straight running to a curve.
    FromStraight,
    /// From a curve to one of the same radius to the other side.
    FromOppositeCurve,
}

/// Which of some motions turn right round within a time.
fn turn_round(wheel: &Wheel, starts: &[[f64; 5]], duration: f64) -> Result<Vec<bool>, Error> {
    let uniform = wheel.uniform_motion()?.psi();
    let watch = |progress: Progress<'_>| match (progress.psi() - uniform).abs() > PI {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let ensemble = Ensemble::new(wheel)?.tolerance(TOLERANCE);
    let ends = ensemble.integrate_watched(starts, duration, &Control::none(), |_| watch)?;
    Ok(ends.iter().map(|end| end.ending != Ending::Completed).collect())
}

pub(super) fn sudden_changes() -> Result<Vec<Claim>, Error> {
    let wheel = paper_wheel(1.0, FIGURE_6_LENGTH, FIGURE_5_RADIUS)?;
    let critical = wheel.critical_speed().map(|critical| critical.speed);
    let critical = critical.ok_or_else(|| Error::not_found("critical speed", "r = 1 m"))?;
    let mut parts = Vec::new();
    let mut all_fail = true;
    for (change, duration, from) in CHANGES {
        let fails = |part: f64| -> Result<bool, Error> {
            let wheel = wheel.with(Key::V, part * critical)?;
            Ok(turn_round(&wheel, &[change.start(&wheel)?], duration)?.contains(&true))
        };
        // Just below the critical speed it fails, if it ever does.
        let (mut returns, mut turns) = (from, 1.0 - 1e-3);
        all_fail &= fails(turns)? && !fails(returns)?;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (returns + turns);
            if fails(middle)? { turns = middle } else { returns = middle }
        }
        parts.push(format!("from {} of the critical speed on {}", per_cent(turns), change.name()));
    }
    let stable = wheel.with(Key::V, (1.0 - 1e-3) * critical)?.uniform_motion()?.is_stable() == Some(true);
    Ok(vec![Claim {
        place: "section 1",
        statement: "Shimmy starts more easily when the turning radius changes suddenly, even where the motion is linearly stable.".into(),
        verdict: Verdict::sharpened(stable && all_fail, all_fail),
        evidence: format!(
            "At r = {FIGURE_5_RADIUS} m, l = {FIGURE_6_LENGTH} m the wheel, which is linearly stable up to {} m/s, is thrown out of its uniform \
             motion {}; slower it returns. A single step costs hardly any of the stable range, the change from one side to the other \
             a part of it.",
            number(critical, 4),
            parts.join(", ")
        ),
    }])
}

impl Change {
    /// The state before the change, as it is in the frame of the curve.
    fn start(self, wheel: &Wheel) -> Result<[f64; 5], Error> {
        match self {
            Self::FromStraight => {
                Ok(wheel.with(Key::TurningRadius, f64::INFINITY)?.uniform_motion()?.state())
            }
            Self::FromOppositeCurve => {
                let [u, q, psi, speed, yaw_rate] = wheel.uniform_motion()?.state();
                Ok([u, -q, -psi, speed, -yaw_rate])
            }
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::FromStraight => "by a step from straight running to the curve",
            Self::FromOppositeCurve => "by the change from the same curve to the other side",
        }
    }
}

/// The smallest angle from the uniform motion, with the sign of the direction, at which the released caster turns right round.
fn smallest_release_angle(wheel: &Wheel, direction: f64) -> Result<f64, Error> {
    let state = wheel.uniform_motion()?.state();
    let (mut returns, mut turns) = (0.0, f64::NAN);
    let mut width = LARGEST_ANGLE / ANGLES as f64;
    for _ in 0..ROUNDS {
        let angle = |index: usize| returns + width * (index + 1) as f64;
        let starts: [[f64; 5]; ANGLES] = std::array::from_fn(|index| {
            let [u, q, psi, speed, yaw_rate] = state;
            [u, q, psi + direction * angle(index), speed, yaw_rate]
        });
        let first = turn_round(wheel, &starts, RELEASED)?.into_iter().position(|turned| turned);
        // Beyond the last one the angle is that which turned before.
        let next = match first {
            Some(first) => {
                turns = angle(first);
                angle(first) - width
            }
            None => angle(ANGLES - 1),
        };
        returns = next;
        width /= (ANGLES + 1) as f64;
    }
    if turns.is_nan() {
        let place = format!("v = {RELEASE_SPEED} m/s, r = {RELEASE_RADIUS} m up to {LARGEST_ANGLE} rad");
        return Err(Error::not_found("release angle from which the wheel does not return", &place));
    }
    Ok(turns)
}

pub(super) fn directions(branches: &Branches) -> Result<Vec<Claim>, Error> {
    let wheel = paper_wheel(RELEASE_SPEED, FIGURE_6_LENGTH, RELEASE_RADIUS)?;
    let [positive, negative] = [1.0, -1.0].map(|direction| smallest_release_angle(&wheel, direction));
    let (positive, negative) = (positive?, negative?);
    let released = (positive - negative) / (positive + negative);
    let place = || format!("v = {RELEASE_SPEED} m/s, r = {RELEASE_RADIUS} m");
    let branch = branches.branch(FIGURE_6_LENGTH, RELEASE_RADIUS);
    let cycle = branch.and_then(|branch| branch.cycle_at(RELEASE_SPEED));
    let (cycle, _) = cycle.ok_or_else(|| Error::not_found("limit cycle", &place()))?;
    let uniform = wheel.uniform_motion()?.psi();
    let (above, below) = (cycle.max[2] - uniform, uniform - cycle.min[2]);
    let of_cycle = (above - below) / (above + below);
    Ok(vec![Claim {
        place: "section 4, figure 6",
        statement: "The asymmetry is practically not relevant.".into(),
        verdict: Verdict::of(released.abs() < RELEVANT),
        evidence: format!(
            "It is larger than the cycles show. At {}, l = {FIGURE_6_LENGTH} m the caster, released at rest, does not return from \
             {} rad beyond its angle of uniform motion on, to the other side from {} rad on: difference over sum {}, of the \
             amplitudes of the cycle {}. By the standard of this report what is below {} is not relevant.",
            place(),
            number(positive, 3),
            number(-negative, 3),
            per_cent(released),
            per_cent(of_cycle),
            per_cent(RELEVANT)
        ),
    }])
}

/// Mean energy in J of some motions, kinetic and of the springs, and the largest deflection of the king pin in m.
fn energy(wheel: &Wheel, states: &[[f64; 5]]) -> (f64, f64) {
    let [m_w, m_c, l, l_c] = [Key::MW, Key::MC, Key::L, Key::LC].map(|key| wheel.get(key));
    let [j_wxi, j_wzeta, j_cz] = [Key::JWxi, Key::JWzeta, Key::JCz].map(|key| wheel.get(key));
    let rolling_mass = m_w + m_c + j_wxi / wheel.get(Key::WheelRadius).powi(2);
    let yaw_inertia = j_cz + j_wzeta + m_c * (l - l_c).powi(2);
    let of = |&[u, q, _, speed, yaw]: &[f64; 5]| {
        0.5 * (rolling_mass * speed * speed + yaw_inertia * yaw * yaw + wheel.get(Key::K) * (u * u + q * q))
    };
    let deflection = states.iter().map(|[u, q, ..]| u.hypot(*q)).fold(0.0, f64::max);
    (states.iter().map(of).sum::<f64>() / states.len() as f64, deflection)
}

pub(super) fn beyond_the_cycles() -> Result<Vec<Claim>, Error> {
    let wheel = paper_wheel(TUMBLING_SPEED, FIGURE_6_LENGTH, FIGURE_5_RADIUS)?;
    let [u, q, psi, speed, yaw_rate] = wheel.uniform_motion()?.state();
    let starts = BEYOND.map(|angle| [u, q, psi + angle, speed, yaw_rate]);
    let turned = turn_round(&wheel, &starts, TIMES[0])?.into_iter().filter(|turned| *turned).count();
    let ensemble = Ensemble::new(&wheel)?.tolerance(TOLERANCE);
    let (mut states, mut time) = (starts.to_vec(), 0.0);
    let mut found = vec![energy(&wheel, &states)];
    for until in TIMES {
        let ends = ensemble.integrate(&states, until - time, &Control::none())?;
        states = ends.iter().map(|end| end.state).collect();
        time = until;
        found.push(energy(&wheel, &states));
    }
    let grows = found.windows(2).all(|pair| pair[0].0 < pair[1].0);
    let energies: Vec<String> = TIMES
        .iter()
        .zip(&found[1..])
        .map(|(time, (energy, _))| format!("{} J after {time} s", number(*energy, 3)))
        .collect();
    Ok(vec![Claim {
        place: "section 5",
        statement: "Without damping or sliding the motions that do not return are no vibrations as in other models of towed wheels."
            .into(),
        verdict: Verdict::sharpened(turned == BEYOND.len(), grows),
        evidence: format!(
            "Of {} motions at v = {TUMBLING_SPEED} m/s, r = {FIGURE_5_RADIUS} m, released between {} and {} rad from the uniform motion, \
             {turned} have the caster turning right round within {} s. This tumbling is fed by the towing: the mean energy is {} J at \
             first and {}, with the king pin up to {} m away from its place. No bound was seen; without damping or sliding the \
             model says nothing of real motions there.",
            BEYOND.len(),
            BEYOND[0],
            BEYOND[BEYOND.len() - 1],
            TIMES[0],
            number(found[0].0, 3),
            energies.join(", "),
            number(found[found.len() - 1].1, 2)
        ),
    }])
}

#[cfg(test)]
mod tests {
    use super::*;
    use kingpin::basin::{ClassificationSettings, ContactModel, Disturbance, SafeKick};

    /// The search that follows every motion to its fate, by steps a hundred times as fine.
    #[test]
    fn release_angles_are_those_of_the_safe_kick() {
        let wheel = paper_wheel(RELEASE_SPEED, FIGURE_6_LENGTH, RELEASE_RADIUS).unwrap();
        let width = LARGEST_ANGLE / (ANGLES * (ANGLES + 1).pow(ROUNDS as u32 - 1)) as f64;
        for direction in [1.0, -1.0] {
            let found = smallest_release_angle(&wheel, direction).unwrap();
            let kick = SafeKick::find(
                &wheel,
                ContactModel::Rolling,
                ClassificationSettings::with_duration(30.0),
                Disturbance::ReleaseAngle,
                direction * LARGEST_ANGLE,
                &Control::none(),
            );
            let fails = kick.unwrap().unwrap().fails.abs();
            assert!(fails <= found && found < fails + width, "{found} {fails}");
        }
    }
}
