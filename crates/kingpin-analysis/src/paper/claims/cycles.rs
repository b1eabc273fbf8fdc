//! The statements about Hopf bifurcations and limit cycles.

use super::claim::{Claim, Verdict};
use crate::error::Error;
use crate::paper::branches::{
    Branch, Branches, COMPARED_SPEEDS, FIGURE_5_RADIUS, FIGURE_6_LENGTH, SLOWEST, hopf_point,
};
use crate::paper::numbers::{largest, number, per_cent};
use crate::paper::wheel::paper_wheel;
use arclength::branch::Criticality;
use arclength::branch::{Labelled, SpecialKind};
use arclength::cycle::CyclePoint;
use arclength_analysis::Control;
use kingpin::branches::HopfPoint;
use kingpin::parallel;

/// Caster lengths and radii in m of the Hopf points whose sense is computed.
const HOPF_LENGTHS: [f64; 10] = [0.0465, 0.05, 0.055, 0.06, 0.07, 0.08, 0.1, 0.13, 0.17, 0.2];
const HOPF_RADII: [f64; 4] = [0.5, 1.0, 2.0, 3.0];
/// Relative difference within which two locations of a Hopf point are the same.
const SAME_PLACE: f64 = 1e-9;
/// Speed in m/s of the motions that start near the cycle of [`FIGURE_6_LENGTH`] and [`FIGURE_5_RADIUS`].
const SPEED: f64 = 4.0;
/// Their deviation from the uniform motion, relative to the cycle.
const BESIDE: [f64; 2] = [0.95, 1.05];
/// How many periods they are followed, and samples in each.
const PERIODS: usize = 20;
const SAMPLES: usize = 64;
/// A perturbation of the caster angle alone, in rad, and the time in s after which the motion has settled or not.
const KICK: f64 = 1.2;
const SETTLING: f64 = 30.0;
/// A swing below this part of the first has settled.
const SETTLED: f64 = 0.01;
/// Effects smaller than this are not relevant, by the standard of this report.
const RELEVANT: f64 = 0.05;
/// Speed in m/s that counts as low: far from every stability boundary.
const LOW_SPEED: f64 = 1.0;

pub(in crate::paper) fn of_the_hopf_points() -> Result<Vec<Claim>, Error> {
    let places: Vec<(f64, f64)> = HOPF_LENGTHS
        .into_iter()
        .flat_map(|length| HOPF_RADII.into_iter().map(move |radius| (length, radius)))
        .collect();
    let points: Vec<HopfPoint> = parallel::try_map(&places, |&(length, radius)| hopf_point(length, radius))?;
    let mut deviation = 0.0_f64;
    let mut crossings = 0;
    for (point, (length, radius)) in points.iter().zip(&places) {
        let critical = paper_wheel(point.value, *length, *radius)?.critical_yaw_rate().unwrap_or(f64::NAN);
        deviation = deviation.max((point.value / (radius * critical) - 1.0).abs());
        crossings += usize::from(point.detail.crossing_speed.is_some_and(|speed| speed > 0.0));
    }
    let frequencies = || points.iter().map(|point| point.frequency);
    let lyapunov: Vec<f64> = points.iter().filter_map(|point| point.first_lyapunov).collect();
    let subcritical = points.iter().filter(|point| point.criticality == Criticality::Subcritical).count();
    let smallest = lyapunov.iter().copied().fold(f64::INFINITY, f64::min);
    let example = places
        .iter()
        .zip(&points)
        .find(|(place, _)| **place == (FIGURE_6_LENGTH, FIGURE_5_RADIUS))
        .map_or_else(String::new, |((length, radius), point)| {
            format!(
                " At l = {length} m, r = {radius} m it is {}, with ω₀ = {} rad/s.",
                number(point.first_lyapunov.unwrap_or(f64::NAN), 7),
                number(point.frequency, 12)
            )
        });
    Ok(vec![
        Claim {
            place: "section 4",
            statement: "The linear stability boundary corresponds to Hopf bifurcations.".into(),
            verdict: Verdict::of(crossings == points.len() && deviation < SAME_PLACE),
            evidence: format!(
                "At {crossings} of {} points of the boundary (l from {} to {} m, r from {} to {} m) a pair of eigenvalues \
                 crosses the imaginary axis with non-zero speed, with frequencies from {} to {} rad/s. The speeds agree \
                 with the closed form within {} (relative).",
                points.len(),
                HOPF_LENGTHS[0],
                HOPF_LENGTHS[HOPF_LENGTHS.len() - 1],
                HOPF_RADII[0],
                HOPF_RADII[HOPF_RADII.len() - 1],
                number(frequencies().fold(f64::INFINITY, f64::min), 4),
                number(largest(frequencies()), 4),
                number(deviation, 2)
            ),
        },
        Claim {
            place: "section 4, figure 5",
            statement: "The Hopf bifurcation is subcritical.".into(),
            verdict: Verdict::of(subcritical == points.len()),
            evidence: format!(
                "The first Lyapunov coefficient is positive at {subcritical} of {} points along the boundary, from {} \
                 to {}.{example}",
                points.len(),
                number(smallest, 4),
                number(largest(lyapunov.iter().copied()), 4)
            ),
        },
    ])
}

pub(in crate::paper) fn of_the_basin(branches: &Branches) -> Result<Vec<Claim>, Error> {
    let branch = branch_of_figure_6(branches, FIGURE_5_RADIUS)?;
    let cycle = cycle_at(branch, SPEED)?;
    let [inside, outside] = BESIDE.map(|scale| swing_after(branch, cycle, scale));
    let (inside, outside) = (inside?, outside?);
    let bounded = inside < 1.0 && outside > 1.0;
    let stable = branch.wheel(SPEED)?.uniform_motion()?.is_stable() == Some(true);
    Ok(vec![
        Claim {
            place: "section 4",
            statement: "A large enough perturbation leads to unwanted vibrations even where the motion is linearly stable."
                .into(),
            verdict: Verdict::of(bounded && stable),
            evidence: format!(
                "At v = {SPEED} m/s, r = {FIGURE_5_RADIUS} m, l = {FIGURE_6_LENGTH} m the motion is linearly {}. Started with \
                 {} times the deviations of the limit cycle, the wheel swings {} times as far as in the cycle after \
                 {PERIODS} periods; started with {} times, {} times as far.",
                if stable { "stable" } else { "unstable" },
                BESIDE[1],
                number(outside, 3),
                BESIDE[0],
                number(inside, 3)
            ),
        },
        boundary_of_the_basin(branches, branch, cycle, bounded)?,
        no_stable_cycles(branches),
    ])
}

fn boundary_of_the_basin(
    branches: &Branches,
    branch: &Branch,
    cycle: &CyclePoint,
    bounded: bool,
) -> Result<Claim, Error> {
    let all = |branch: &Branch| branch.cycles.iter().all(|cycle| cycle.unstable_multipliers == 1);
    let saddles = branches.of_figure_5().all(all);
    let more: Vec<String> = branches.of_figure_6().filter_map(more_unstable_directions).collect();
    let wheel = branch.wheel(SPEED)?;
    let samples = (SETTLING / cycle.period) as usize * SAMPLES;
    let history = wheel.simulate(SETTLING, &[("psi", KICK)], samples + 1, &Control::none())?;
    let angles: Vec<f64> = history.states.iter().map(|state| state[2]).collect();
    let left = swing(&angles[samples - SAMPLES..]) / (2.0 * KICK);
    let amplitude = 0.5 * (cycle.max[2] - cycle.min[2]);
    let kick_dies_out = left < SETTLED && KICK > amplitude;
    Ok(Claim {
        place: "section 4, figures 5 and 6",
        statement:
            "The unstable limit cycles bound the basin of attraction of the uniform motion, so that their \
                    amplitudes compare the basins."
                .into(),
        verdict: Verdict::sharpened(saddles && bounded, kick_dies_out || !more.is_empty()),
        evidence: format!(
            "{} of figure 5 have one Floquet multiplier outside the unit circle, so that their stable manifolds can \
             separate motions that die out from motions that grow{}. The amplitude is not the size of the basin: at \
             v = {SPEED} m/s, r = {} m the caster angle swings by {} rad in the cycle, but a perturbation of the angle alone \
             by {KICK} rad {} (to {} of it in {SETTLING} s).",
            if saddles { "All cycles" } else { "Not all cycles" },
            match more.is_empty() {
                true => String::new(),
                false => format!(
                    ". In figure 6 it is three, beyond torus bifurcations, {}: there the cycle alone does not bound the basin",
                    more.join(", ")
                ),
            },
            branch.radius,
            number(amplitude, 3),
            if kick_dies_out { "dies out" } else { "does not die out" },
            number(left, 2)
        ),
    })
}

/// Where the cycles of a branch have more than one multiplier outside the unit circle, in words.
fn more_unstable_directions(branch: &Branch) -> Option<String> {
    let mut speeds =
        branch.cycles.iter().filter(|cycle| cycle.unstable_multipliers > 1).map(|cycle| cycle.value);
    let fastest = speeds.next()?;
    let slowest = speeds.next_back().unwrap_or(fastest);
    let tori = branch.cycles.iter().filter(|cycle| cycle.special_kind() == Some(SpecialKind::Torus));
    let ends = tori.map(|cycle| cycle.value);
    // The bifurcations themselves, where there are any, rather than the points next to them.
    let (slowest, fastest) =
        ends.fold((slowest, fastest), |(slow, fast), end| (slow.min(end), fast.max(end)));
    let radius = if branch.radius.is_infinite() { "∞".to_owned() } else { format!("{} m", branch.radius) };
    let (slowest, fastest) = (number(slowest, 4), number(fastest, 4));
    Some(format!("from v = {slowest} to {fastest} m/s at r = {radius}"))
}

fn no_stable_cycles(branches: &Branches) -> Claim {
    let cycles = || branches.iter().flat_map(|branch| &branch.cycles);
    let stable = cycles().filter(|cycle| cycle.stable == Some(true)).count();
    let count = |kind: SpecialKind| cycles().filter(|cycle| cycle.special_kind() == Some(kind)).count();
    let folds = count(SpecialKind::FoldOfCycles);
    let tori = count(SpecialKind::Torus);
    let others = count(SpecialKind::PeriodDoubling) + count(SpecialKind::BranchPointOfCycles);
    Claim {
        place: "section 5",
        statement: "Without damping or sliding there are, unlike in other models of towed wheels, no stable large vibrations \
                    beside the stable motion."
            .into(),
        verdict: Verdict::of(stable == 0 && folds == 0),
        evidence: format!(
            "Of {} cycles on {} branches down to v = {SLOWEST} m/s {stable} are stable, and {folds} folds were found at which a \
             branch could turn back; other bifurcations: {tori} to tori, {others} to other cycles. Tori were not \
             followed.",
            cycles().count(),
            branches.iter().count()
        ),
    }
}

pub(in crate::paper) fn of_the_radius(branches: &Branches) -> Result<Vec<Claim>, Error> {
    // Amplitudes at a speed, of the radii for which there is a cycle.
    let amplitudes = |speed: f64| -> Vec<f64> {
        let cycles = branches.of_figure_6().filter_map(|branch| branch.cycle_at(speed));
        cycles.map(|(cycle, _)| 0.5 * (cycle.max[2] - cycle.min[2])).collect()
    };
    let spread = |speed: f64| {
        let amplitudes = amplitudes(speed);
        largest(amplitudes.iter().copied()) / amplitudes.iter().copied().fold(f64::INFINITY, f64::min) - 1.0
    };
    let spreads: Vec<String> = COMPARED_SPEEDS
        .into_iter()
        .map(|speed| {
            let radii = amplitudes(speed).len();
            format!("{} at v = {speed} m/s ({radii} radii)", per_cent(spread(speed)))
        })
        .collect();
    let mut asymmetries = Vec::new();
    for branch in branches.of_figure_6() {
        let mut most = (0.0, 0.0_f64);
        for cycle in &branch.cycles {
            let uniform = branch.uniform_angle(cycle.value)?;
            let (above, below) = (cycle.max[2] - uniform, uniform - cycle.min[2]);
            let asymmetry = (above - below) / (above + below);
            if asymmetry.abs() > most.1.abs() {
                most = (cycle.value, asymmetry);
            }
        }
        asymmetries.push((branch.radius, most));
    }
    let in_cornering = || asymmetries.iter().filter(|(radius, _)| radius.is_finite());
    let straight = largest(
        asymmetries
            .iter()
            .filter(|(radius, _)| radius.is_infinite())
            .map(|(_, (_, asymmetry))| asymmetry.abs()),
    );
    let most = largest(in_cornering().map(|(_, (_, asymmetry))| asymmetry.abs()));
    let parts: Vec<String> = in_cornering()
        .map(|(radius, (speed, asymmetry))| {
            format!("{} at r = {radius} m (v = {} m/s)", per_cent(*asymmetry), number(*speed, 3))
        })
        .collect();
    Ok(vec![
        Claim {
            place: "section 4, figure 6",
            statement: "At low speed, far from the stability boundary, the cornering radius has no relevant effect on the \
                        amplitude of the unstable cycles."
                .into(),
            verdict: Verdict::of(amplitudes(LOW_SPEED).len() > 1 && spread(LOW_SPEED) < RELEVANT),
            evidence: format!(
                "Largest over smallest amplitude among the radii of figure 6, minus one: {}.",
                spreads.join(", ")
            ),
        },
        Claim {
            place: "section 4, figure 6",
            statement: "The cycles are slightly asymmetric: perturbations of one size but opposite directions may end \
                        differently."
                .into(),
            verdict: Verdict::of(most > 0.0 && most < RELEVANT),
            evidence: format!(
                "Difference of the upper and the lower amplitude over their sum, where it is largest along the branch: {}. \
                 In straight running the cycle is symmetric ({}).",
                parts.join(", "),
                number(straight, 2)
            ),
        },
    ])
}

fn branch_of_figure_6(branches: &Branches, radius: f64) -> Result<&Branch, Error> {
    branches.branch(FIGURE_6_LENGTH, radius).ok_or_else(|| {
        Error::not_found("branch of cycles", &format!("l = {FIGURE_6_LENGTH} m, r = {radius} m"))
    })
}

fn cycle_at(branch: &Branch, speed: f64) -> Result<&CyclePoint, Error> {
    branch.cycle_at(speed).map(|(cycle, _)| cycle).ok_or_else(|| {
        let place = format!("v = {speed} m/s, l = {} m, r = {} m", branch.caster_length, branch.radius);
        Error::not_found("limit cycle", &place)
    })
}

/// The swing in the last of some periods, relative to that of the cycle, of the motion whose deviation from the uniform
/// motion starts as a multiple of the cycle's.
fn swing_after(branch: &Branch, cycle: &CyclePoint, scale: f64) -> Result<f64, Error> {
    let wheel = branch.wheel(cycle.value)?;
    let uniform = wheel.uniform_motion()?.state();
    let on_cycle = cycle.orbit.state_at(0.0);
    let mut start = uniform;
    for (value, on_cycle) in start.iter_mut().zip(on_cycle) {
        *value += scale * (on_cycle - *value);
    }
    let samples = PERIODS * SAMPLES;
    let history =
        wheel.simulate_from(&start, PERIODS as f64 * cycle.period, samples + 1, &Control::none())?;
    let angles: Vec<f64> = history.states.iter().map(|state| state[2]).collect();
    Ok(swing(&angles[samples - SAMPLES..]) / (cycle.max[2] - cycle.min[2]))
}

/// Largest minus smallest.
fn swing(angles: &[f64]) -> f64 {
    let largest = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest - angles.iter().copied().fold(f64::INFINITY, f64::min)
}
