//! The statements about the uniform motion and its linear stability.

use super::claim::{Claim, Verdict};
use super::random::Random;
use crate::error::Error;
use crate::paper::numbers::{largest, number, per_cent};
use crate::paper::stability_chart::{StabilityChart, critical_caster_length, growth_rate};
use crate::paper::uniform_motion::UniformMotions;
use crate::paper::wheel::{RADII, paper_wheel};
use arclength_analysis::Control;
use kingpin::{Axis, Key, Plane};

/// Rounding: a relative difference below this counts as none.
const ROUNDING: f64 = 1e-10;
/// Random wheels at which the closed form of the boundary is compared with eigenvalues.
const RANDOM_WHEELS: usize = 4000;
const SEED: u64 = 2013;
/// Eigenvalues nearer to the imaginary axis than this, in 1/s, do not tell stability.
const UNDECIDED: f64 = 1e-9;
/// Caster lengths and radius in m at which the wheel with and without longitudinal freedom is compared, the largest speed
/// in m/s and the number of speeds.
const COMPARED_LENGTHS: [f64; 4] = [0.06, 0.08, 0.1, 0.15];
const COMPARED_RADIUS: f64 = 1.0;
const FASTEST: f64 = 12.0;
const SPEEDS: usize = 120;
/// Distance from the critical caster length, relative to it, at which both sides are tried.
const BESIDE: f64 = 1e-6;
/// Speeds of straight running in m/s, from slow to fast, and their number.
const STRAIGHT_SPEEDS: (f64, f64, usize) = (0.01, 1000.0, 61);
/// Caster lengths in m among which the largest critical yaw rate is looked for.
const LENGTHS: (f64, f64) = (0.01, 0.45);
/// Points of the grid beyond the largest critical speed, and of the grid for cornering against straight running.
const GRID: [usize; 2] = [150, 100];

pub(in crate::paper) fn of_the_uniform_motion(motions: &UniformMotions) -> Result<Vec<Claim>, Error> {
    let pairs = || motions.closed_form.iter().zip(&motions.newton);
    let difference = largest(pairs().map(|(closed, newton)| {
        let scale = largest(closed.state().map(f64::abs));
        largest(closed.state().into_iter().zip(newton.state()).map(|(a, b)| (a - b).abs() / scale))
    }));
    let residual = largest(motions.closed_form.iter().map(|motion| motion.residual()));
    let longitudinal = motions.largest_longitudinal_displacement();
    let lateral = largest(motions.newton.iter().map(|motion| motion.q().abs()));
    let closed = Claim {
        place: "section 3",
        statement:
            "The uniform motion follows from transcendental equations and can only be found numerically."
                .into(),
        verdict: Verdict::sharpened(residual < 1e-9, difference < ROUNDING),
        evidence: format!(
            "It has a closed form: sin ψ₀ = (l − a₀)/r with a₀ = m_c (l − l_c) ω²/k, and q₀, V₀ are explicit too. \
             Newton's method on the equations of motion, started elsewhere, agrees within {} (relative) at {} speeds \
             of figure 2; the closed form leaves a residual of {} in SI units.",
            number(difference, 2),
            motions.newton.len(),
            number(residual, 2)
        ),
    };
    let zero = Claim {
        place: "section 3, figure 2",
        statement: "The longitudinal displacement u₀ of the uniform motion is practically zero.".into(),
        verdict: Verdict::sharpened(longitudinal < 1e-3 * lateral, longitudinal < f64::EPSILON * lateral),
        evidence: format!(
            "It is exactly zero: in steady motion the power of the spring force, k ω r u₀, must vanish. Newton's method \
             finds |u₀| up to {} m where |q₀| reaches {} m.",
            number(longitudinal, 2),
            number(lateral, 3)
        ),
    };
    Ok(vec![closed, zero, longitudinal_freedom()?])
}

/// The stability with and without longitudinal freedom of the king pin.
fn longitudinal_freedom() -> Result<Claim, Error> {
    let mut numbers = Vec::new();
    let mut qualitative = true;
    for length in COMPARED_LENGTHS {
        let (mut elastic, mut rigid) = (0, 0);
        for index in 1..=SPEEDS {
            let wheel = paper_wheel(FASTEST * index as f64 / SPEEDS as f64, length, COMPARED_RADIUS)?;
            elastic += usize::from(wheel.uniform_motion()?.is_stable() == Some(true));
            rigid +=
                usize::from(wheel.with(Key::KU, f64::INFINITY)?.uniform_motion()?.is_stable() == Some(true));
        }
        // One loses its stability within the range of speeds and the other does not.
        qualitative &= (elastic < SPEEDS) != (rigid < SPEEDS);
        numbers.push(format!("{elastic} with and {rigid} without at l = {length} m"));
    }
    Ok(Claim {
        place: "section 3",
        statement:
            "Although u₀ vanishes, the longitudinal degree of freedom changes linear stability qualitatively."
                .into(),
        verdict: Verdict::of(qualitative),
        evidence: format!(
            "Of {SPEEDS} speeds up to {FASTEST} m/s at r = {COMPARED_RADIUS} m the motion is stable, with longitudinal \
             freedom and without (k_u = ∞), at {}.",
            numbers.join(", ")
        ),
    })
}

pub(in crate::paper) fn of_its_stability(chart: &StabilityChart) -> Result<Vec<Claim>, Error> {
    Ok(vec![
        closed_form_of_the_boundary()?,
        critical_length()?,
        critical_speed_in_cornering()?,
        proportional_to_the_radius(chart),
        cornering_against_straight_running()?,
    ])
}

fn closed_form_of_the_boundary() -> Result<Claim, Error> {
    let mut random = Random::new(SEED);
    let (mut compared, mut mismatches) = (0, 0);
    for _ in 0..RANDOM_WHEELS {
        let length = random.within(0.013..0.3);
        let radius = random.within(0.4..6.0);
        let yaw_rate = random.within(0.5..12.0);
        let wheel = paper_wheel(yaw_rate * radius, length, radius)?;
        let rate = growth_rate(&wheel)?;
        if rate.abs() > UNDECIDED {
            compared += 1;
            let stable = wheel.critical_yaw_rate().is_some_and(|critical| yaw_rate < critical);
            mismatches += usize::from(stable != (rate < 0.0));
        }
    }
    let agree = compared > 0 && mismatches == 0;
    Ok(Claim {
        place: "section 3",
        statement: "The stability boundary is found by computing eigenvalues of the linearised equations."
            .into(),
        verdict: Verdict::sharpened(true, agree),
        evidence: format!(
            "It has a closed form v = r ω_crit(l), from the Routh-Hurwitz conditions, in which the forward speed cancels. \
             Stability by it and by eigenvalues of the Jacobian differ at {mismatches} of {compared} random (v, l, r)."
        ),
    })
}

fn critical_length() -> Result<Claim, Error> {
    let critical = critical_caster_length()?;
    let (slow, fast, count) = STRAIGHT_SPEEDS;
    let stable_at = |length: f64| -> Result<usize, Error> {
        let mut stable = 0;
        for index in 0..count {
            let speed = slow * (fast / slow).powf(index as f64 / (count - 1) as f64);
            let motion = paper_wheel(speed, length, f64::INFINITY)?.uniform_motion()?;
            stable += usize::from(motion.growth_rate() < 0.0);
        }
        Ok(stable)
    };
    let (above, below) = (stable_at(critical * (1.0 + BESIDE))?, stable_at(critical * (1.0 - BESIDE))?);
    let holds = above == count;
    Ok(Claim {
        place: "section 3, figure 3",
        statement: "In straight running there is a critical caster length above which the motion is stable at any speed."
            .into(),
        verdict: Verdict::sharpened(holds, below == 0),
        evidence: format!(
            "The length is l_c + (J_Cz + J_wζ)/(m_c l_c) = {} m. A millionth above it the lateral motion is stable at \
             {above} of {count} speeds from {slow} to {fast} m/s, a millionth below it at {below}. (The longitudinal \
             oscillation, undamped, neither grows nor decays in straight running.)",
            number(critical, 10)
        ),
    })
}

fn critical_speed_in_cornering() -> Result<Claim, Error> {
    let critical = |length: f64| -> Result<f64, Error> {
        Ok(paper_wheel(1.0, length, 1.0)?.critical_yaw_rate().unwrap_or(0.0))
    };
    let (length, largest) = maximum(critical, LENGTHS)?;
    let (mut points, mut stable) = (0, 0);
    let finite = || RADII.into_iter().filter(|radius| radius.is_finite());
    for radius in finite() {
        let limit = radius * largest;
        let plane = Plane::new(
            Axis::new(Key::V, limit * (1.0 + BESIDE)..=4.0 * limit)?,
            Axis::new(Key::L, LENGTHS.0..=LENGTHS.1)?,
        )?;
        let wheel = paper_wheel(limit, LENGTHS.1, radius)?;
        let chart = wheel.growth_rate_chart(&plane, GRID, &Control::none())?;
        points += chart.growth_rate.iter().flatten().count();
        stable += chart.stable.iter().filter(|stable| **stable == Some(true)).count();
    }
    let just_below = growth_rate(&paper_wheel(largest * (1.0 - BESIDE), length, 1.0)?)? < 0.0;
    Ok(Claim {
        place: "section 3, figure 3",
        statement: "In cornering there is always a critical speed above which the motion is unstable whatever the caster length."
            .into(),
        verdict: Verdict::sharpened(stable == 0, just_below),
        evidence: format!(
            "It is r times the largest critical yaw rate, {} rad/s, at l = {} m. Of {points} points (v, l) beyond it, in \
             charts at {} radii, {stable} are stable; a millionth below it the caster of that length {} stable.",
            number(largest, 10),
            number(length, 8),
            finite().count(),
            if just_below { "is" } else { "is not" }
        ),
    })
}

fn proportional_to_the_radius(chart: &StabilityChart) -> Claim {
    let deviation = chart.largest_deviation();
    let mut falling = true;
    for one in &chart.crossings {
        for other in chart.crossings.iter().filter(|other| other.caster_length == one.caster_length) {
            falling &= (one.radius < other.radius) == (one.speed < other.speed);
        }
    }
    Claim {
        place: "section 3, figure 3",
        statement: "The smaller the cornering radius, the smaller the critical speed.".into(),
        verdict: Verdict::sharpened(falling, deviation < ROUNDING),
        evidence: format!(
            "The critical speed is proportional to the radius: v/r is the same function of l at every radius. {} crossings \
             of eigenvalues at four radii deviate from it by at most {} (relative).",
            chart.crossings.len(),
            number(deviation, 2)
        ),
    }
}

fn cornering_against_straight_running() -> Result<Claim, Error> {
    let plane = Plane::new(Axis::new(Key::V, 0.1..=20.0)?, Axis::new(Key::L, 0.02..=0.3)?)?;
    let chart = |radius: f64| -> Result<Vec<bool>, Error> {
        let wheel = paper_wheel(1.0, 0.1, radius)?;
        let chart = wheel.growth_rate_chart(&plane, GRID, &Control::none())?;
        Ok(chart.stable.into_iter().map(|stable| stable == Some(true)).collect())
    };
    let straight = chart(f64::INFINITY)?;
    let (mut gained, mut lost) = (0, Vec::new());
    for radius in RADII.into_iter().filter(|radius| radius.is_finite()) {
        let cornering = chart(radius)?;
        let pairs = || cornering.iter().zip(&straight);
        gained += pairs().filter(|(cornering, straight)| **cornering && !**straight).count();
        let stable = straight.iter().filter(|stable| **stable).count().max(1);
        let part =
            pairs().filter(|(cornering, straight)| !**cornering && **straight).count() as f64 / stable as f64;
        lost.push((radius, part));
    }
    let parts: Vec<String> =
        lost.iter().map(|(radius, part)| format!("{} at r = {radius} m", per_cent(*part))).collect();
    Ok(Claim {
        place: "section 5",
        statement: "For linear stability cornering is worse than straight running.".into(),
        verdict: Verdict::of(gained == 0 && lost.iter().all(|(_, part)| *part > 0.0)),
        evidence: format!(
            "In charts up to v = 20 m/s and l = 0.3 m, {gained} of {} points are stable in cornering but not in straight \
             running; of those stable in straight running cornering loses {}.",
            straight.len() * lost.len(),
            parts.join(", ")
        ),
    })
}

/// Place and value of the maximum of a function with one maximum: a coarse search, then golden sections (Kiefer 1953).
fn maximum(
    function: impl Fn(f64) -> Result<f64, Error>,
    (low, high): (f64, f64),
) -> Result<(f64, f64), Error> {
    const COARSE: usize = 64;
    const SECTIONS: usize = 60;
    let at = |index: usize| low + (high - low) * index as f64 / COARSE as f64;
    let mut best = (low, f64::NEG_INFINITY);
    for index in 0..=COARSE {
        let value = function(at(index))?;
        if value > best.1 {
            best = (at(index), value);
        }
    }
    let width = (high - low) / COARSE as f64;
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (best.0 - width, best.0 + width);
    for _ in 0..SECTIONS {
        let inner = (right - golden * (right - left), left + golden * (right - left));
        if function(inner.0)? > function(inner.1)? { right = inner.1 } else { left = inner.0 }
    }
    let place = 0.5 * (left + right);
    Ok((place, function(place)?))
}
