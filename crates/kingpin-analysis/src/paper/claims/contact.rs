//! The statements about the contact force.

use super::claim::{Claim, Verdict};
use crate::error::Error;
use crate::paper::numbers::{largest, number};
use crate::paper::rolling_limit::RollingLimits;
use crate::paper::wheel::{RADII, paper_wheel};
use kingpin::{Key, UniformMotion};

/// The friction forces agree when they differ by less than this, relative to their size.
const ROUNDING: f64 = 1e-10;
/// Caster lengths in m and yaw rates in rad/s of the compared motions.
const LENGTHS: [f64; 5] = [0.05, 0.08, 0.12, 0.2, 0.3];
const YAW_RATES: [f64; 6] = [0.5, 2.0, 4.0, 6.0, 8.0, 11.0];
/// Caster length in m and radius in m at which the loads are compared.
const LENGTH: f64 = 0.08;
const RADIUS: f64 = 1.0;
/// Coefficient of static friction of the paper.
const FRICTION: f64 = 1.0;

pub(in crate::paper) fn claims(limits: &RollingLimits) -> Result<Vec<Claim>, Error> {
    Ok(vec![friction_formula()?, realistic_loads(limits)?, force_in_cornering()?])
}

/// The two terms under the root of (9), in N.
fn terms_of_equation_9(motion: &UniformMotion) -> [f64; 2] {
    let wheel = motion.wheel();
    let [m_w, m_c, l, l_c] = [Key::MW, Key::MC, Key::L, Key::LC].map(|key| wheel.get(key));
    let [r, j_wxi, wheel_radius] =
        [Key::TurningRadius, Key::JWxi, Key::WheelRadius].map(|key| wheel.get(key));
    let (u, q, psi) = (motion.u(), motion.q(), motion.psi());
    let factor = wheel.towing_yaw_rate().powi(2) / psi.cos();
    let first = j_wxi / (wheel_radius * wheel_radius) * (u + (r - q) * psi.tan() - l / psi.cos());
    let second = (m_w * l + m_c * l_c) / l * (q - r + l * psi.sin());
    [factor * first, factor * second]
}

fn friction_formula() -> Result<Claim, Error> {
    let (mut first_part, mut difference, mut motions) = (0.0_f64, 0.0_f64, 0);
    for radius in RADII.into_iter().filter(|radius| radius.is_finite()) {
        for length in LENGTHS {
            for yaw_rate in YAW_RATES {
                let motion = paper_wheel(yaw_rate * radius, length, radius)?.uniform_motion()?;
                let [first, second] = terms_of_equation_9(&motion);
                let force = motion.contact_force().friction();
                first_part = first_part.max(first.abs() / force);
                difference = difference.max((first.hypot(second) / force - 1.0).abs());
                motions += 1;
            }
        }
    }
    Ok(Claim {
        place: "equation (9)",
        statement: "The friction force of the uniform motion has two parts, of which the first stems from the spin inertia \
                    of the wheel."
            .into(),
        verdict: Verdict::sharpened(difference < ROUNDING, first_part < ROUNDING),
        evidence: format!(
            "The formula agrees with Newton's law for the wheel within {} (relative) at {motions} motions, and its first \
             part is identically zero (at most {} of the force, by rounding), for the wheel does not accelerate: \
             F_f = (m_w + m_c l_c/l) V₀ ω.",
            number(difference, 2),
            number(first_part, 2)
        ),
    })
}

fn realistic_loads(limits: &RollingLimits) -> Result<Claim, Error> {
    let not_found = |what: &str| Error::not_found(what, &format!("l = {LENGTH} m, r = {RADIUS} m"));
    let wheel = paper_wheel(1.0, LENGTH, RADIUS)?;
    let critical = wheel.critical_speed().ok_or_else(|| not_found("critical speed"))?.speed;
    let mut parts = Vec::new();
    let mut increasing = true;
    let mut slowest_limit = 0.0;
    for limit in &limits.limits {
        let speed = limit.speed_at(LENGTH).ok_or_else(|| not_found("rolling limit"))?;
        increasing &= speed > slowest_limit;
        slowest_limit = speed;
        parts.push(format!("{} m/s under {} N", number(speed, 4), limit.load.abs()));
    }
    let force = paper_wheel(critical, LENGTH, RADIUS)?.uniform_motion()?.contact_force();
    let needed = force.friction() / FRICTION - force.normal;
    Ok(Claim {
        place: "section 3, figure 4",
        statement: "Under realistic vertical loads the computed uniform motion can exist in practice.".into(),
        verdict: Verdict::of(increasing && slowest_limit > critical),
        evidence: format!(
            "At l = {LENGTH} m, r = {RADIUS} m, μ_s = {FRICTION} the wheel rolls up to {}; a load of {} N is enough \
             for all speeds up to the critical one, {} m/s.",
            parts.join(", "),
            number(needed, 4),
            number(critical, 5)
        ),
    })
}

fn force_in_cornering() -> Result<Claim, Error> {
    const SPEED: f64 = 4.0;
    let force = |radius: f64| -> Result<f64, Error> {
        Ok(paper_wheel(SPEED, LENGTH, radius)?.uniform_motion()?.contact_force().friction())
    };
    let forces: Vec<(f64, f64)> =
        RADII.into_iter().map(|radius| Ok((radius, force(radius)?))).collect::<Result<_, Error>>()?;
    let straight = largest(forces.iter().filter(|(radius, _)| radius.is_infinite()).map(|(_, force)| *force));
    let grows = forces.windows(2).all(|pair| pair[0].1 > pair[1].1);
    let parts: Vec<String> = forces
        .iter()
        .filter(|(radius, _)| radius.is_finite())
        .map(|(radius, force)| format!("{} N at r = {radius} m", number(*force, 4)))
        .collect();
    Ok(Claim {
        place: "section 1",
        statement:
            "Cornering is the less favourable manoeuvre because of the larger lateral force at the contact."
                .into(),
        verdict: Verdict::of(grows),
        evidence: format!(
            "Lateral force at v = {SPEED} m/s, l = {LENGTH} m: {}, and {} N in straight running.",
            parts.join(", "),
            number(straight, 2)
        ),
    })
}
