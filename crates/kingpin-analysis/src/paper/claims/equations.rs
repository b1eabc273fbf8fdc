//! The paper's equations (3), (7) and (8), with the pseudo velocities `beta_1 = psi'` and `beta_2 = u'`, against the model.
//!
//! As printed, (3) and (8) contain six misprints. Each is left in alone and the rates that follow are compared with the
//! model at random wheels and states.

use super::claim::{Claim, Verdict};
use super::random::Random;
use crate::error::Error;
use crate::paper::numbers::{largest, number};
use arclength::{Dual, VectorField};
use kingpin::{Key, Wheel};

/// Random wheels and states.
pub(super) const SAMPLES: usize = 200;
const SEED: u64 = 2012;
/// The forms agree when rates differ by less than this, relative to one plus their size.
pub(super) const AGREEMENT: f64 = 1e-10;
/// They disagree when the rates at half of the states differ by more than this.
const DISAGREEMENT: f64 = 1e-3;

/// A place where the paper's equations do not follow from its own (1), (2) and (4) to (7).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Misprint {
    LateralKinematics,
    SpeedInYawEquation,
    CasterInYawEquation,
    PowerOfCosine,
    StaticMomentSign,
    MissingRadius,
}

/// Each misprint with its place and what stands there.
const MISPRINTS: [(Misprint, &str, &str, &str); 6] = [
    (Misprint::LateralKinematics, "equation (3), first line", "v + (v/r) q + β₂", "v − (v/r) q + β₂"),
    (
        Misprint::SpeedInYawEquation,
        "equation (8), first, bracket before β₁",
        "v + (v/r)(q + 2 l sin ψ) − β₂",
        "−v + (v/r)(q + 2 l sin ψ) − β₂",
    ),
    (Misprint::CasterInYawEquation, "equation (8), first, last bracket", "q − l sin ψ", "q + l sin ψ"),
    (Misprint::PowerOfCosine, "equation (8), second, first term", "cos³ψ in the denominator", "cos²ψ"),
    (
        Misprint::StaticMomentSign,
        "equation (8), second, β₁ term",
        "2 m_c (l − l_c)/cos ψ",
        "−2 m_c (l − l_c)/cos ψ",
    ),
    (
        Misprint::MissingRadius,
        "equation (8), second, β₁ term",
        "(J_wξ + (m_w + m_c) R²)/(R² cos³ψ) sin ψ",
        "the same times r",
    ),
];

pub(super) fn claims() -> Result<Vec<Claim>, Error> {
    let samples = samples()?;
    let corrected = disagreements(&samples, &[])?;
    let worst = corrected[SAMPLES - 1];
    let as_printed = disagreements(&samples, &MISPRINTS.map(|(misprint, ..)| misprint))?[SAMPLES / 2];
    let mut claims = vec![pseudo_forces(&samples)];
    claims.push(Claim {
        place: "equations (3) and (8)",
        statement: "The printed equations of motion, coupled with each other, describe the motion uniquely.".into(),
        verdict: verdict(worst, as_printed),
        evidence: format!(
            "As printed the rates differ from the independently derived model by {} (median, relative) at {SAMPLES} random \
             wheels and states. With the six corrections below they agree: the largest difference is {}.",
            number(as_printed, 2),
            number(worst, 2)
        ),
    });
    for (misprint, place, printed, correct) in MISPRINTS {
        let left_in = disagreements(&samples, &[misprint])?;
        let (median, largest) = (left_in[SAMPLES / 2], left_in[SAMPLES - 1]);
        claims.push(Claim {
            place,
            statement: format!("Printed: {printed}."),
            verdict: verdict(worst, median),
            evidence: format!(
                "Correct: {correct}. With only this misprint left in, the rates differ from the model by {} \
                 (median, relative) and up to {}.",
                number(median, 2),
                number(largest, 2)
            ),
        });
    }
    Ok(claims)
}

/// The verdict on a formula from the largest difference of its corrected form and the median of the printed one.
fn verdict(corrected: f64, printed: f64) -> Verdict {
    match (corrected < AGREEMENT, printed > DISAGREEMENT) {
        (_, false) => Verdict::Confirmed,
        (true, true) => Verdict::Corrected,
        (false, true) => Verdict::Contradicted,
    }
}

/// A wheel and a state `(u, q, psi, beta_1, beta_2)`.
pub(super) type Sample = (Wheel, [f64; 5]);

pub(super) fn samples() -> Result<Vec<Sample>, Error> {
    let mut random = Random::new(SEED);
    let sample = |_| {
        let wheel = [
            (Key::V, 0.5..8.0),
            (Key::L, 0.03..0.2),
            (Key::TurningRadius, 0.4..5.0),
            (Key::K, 20.0..300.0),
            (Key::MW, 0.1..1.0),
            (Key::MC, 0.02..0.3),
            (Key::JWxi, 1e-5..1e-3),
            (Key::JWzeta, 1e-5..1e-3),
            (Key::JCz, 1e-6..1e-3),
            (Key::WheelRadius, 0.02..0.1),
            (Key::LC, 0.0..0.1),
        ]
        .into_iter()
        .try_fold(Wheel::default(), |wheel, (key, range)| wheel.with(key, random.within(range)))?;
        let state =
            [-0.1..0.1, -0.1..0.1, -1.2..1.2, -20.0..20.0, -2.0..2.0].map(|range| random.within(range));
        Ok((wheel, state))
    };
    (0..SAMPLES).map(sample).collect()
}

/// Largest relative difference of the three rates at every sample, ascending.
fn disagreements(samples: &[Sample], left_in: &[Misprint]) -> Result<Vec<f64>, Error> {
    let difference = |(wheel, state): &Sample| {
        let pairs = paper_form(wheel, *state, left_in).into_iter().zip(model_form(wheel, *state)?);
        Ok::<_, Error>(largest(pairs.map(|(paper, model)| (paper - model).abs() / (1.0 + model.abs()))))
    };
    let mut differences: Vec<f64> = samples.iter().map(difference).collect::<Result<_, _>>()?;
    differences.sort_by(f64::total_cmp);
    Ok(differences)
}

/// `(q', beta_1', beta_2')` from (3) and (8), with some misprints left in.
fn paper_form(wheel: &Wheel, [u, q, psi, b1, b2]: [f64; 5], left_in: &[Misprint]) -> [f64; 3] {
    let printed = |misprint: Misprint| left_in.contains(&misprint);
    let [v, l, r, k] = [Key::V, Key::L, Key::TurningRadius, Key::K].map(|key| wheel.get(key));
    let [m_w, m_c, l_c, wheel_radius] =
        [Key::MW, Key::MC, Key::LC, Key::WheelRadius].map(|key| wheel.get(key));
    let [j_wxi, j_wzeta, j_cz] = [Key::JWxi, Key::JWzeta, Key::JCz].map(|key| wheel.get(key));
    let (sin, cos) = psi.sin_cos();
    let tan = sin / cos;
    let omega = v / r;
    let static_moment = m_c * (l - l_c);
    let square = wheel_radius * wheel_radius;
    let rolling_mass = (j_wxi + (m_w + m_c) * square) / square;

    let sign = if printed(Misprint::LateralKinematics) { 1.0 } else { -1.0 };
    let q_rate = ((omega - b1) * l - (v + sign * omega * q + b2) * sin) / cos - omega * u;

    let speed = if printed(Misprint::SpeedInYawEquation) { v } else { -v };
    let caster = if printed(Misprint::CasterInYawEquation) { -l * sin } else { l * sin };
    let b1_rate = -(static_moment / cos
        * (b1 * b1 * l * sin - (speed + omega * (q + 2.0 * l * sin) - b2) * b1)
        - omega * static_moment / cos * (v - omega * (q + caster) + b2)
        - k * l * (q * cos + u * sin))
        / (j_cz + j_wzeta + static_moment * (l - l_c));

    let leading = rolling_mass / if printed(Misprint::PowerOfCosine) { cos.powi(3) } else { cos.powi(2) };
    let moment_sign = if printed(Misprint::StaticMomentSign) { 1.0 } else { -1.0 };
    let radius = if printed(Misprint::MissingRadius) { 1.0 } else { r };
    let rest = (static_moment / cos - rolling_mass / cos.powi(3) * l) * b1 * b1
        + (omega * (moment_sign * 2.0 * static_moment / cos - rolling_mass / cos.powi(3) * radius * sin)
            + rolling_mass / (r * cos.powi(3)) * (v * q - r * b2) * sin)
            * b1
        - omega * rolling_mass / cos.powi(2) * b2 * tan
        + omega * omega * rolling_mass / cos.powi(2) * (q * tan - u)
        + k * (q * tan - u)
        + omega
            * omega
            * ((m_c * (3.0 * l - l_c) + 2.0 * m_w * l + m_c * (l - l_c) * (2.0 * psi).cos())
                / (2.0 * cos.powi(3))
                + j_wxi * l / (square * cos.powi(3))
                - rolling_mass / cos.powi(3) * r * sin);
    let b2_rate = rest / leading - b1_rate * l * sin;
    [q_rate, b1_rate, b2_rate]
}

/// The same rates from the model.
pub(super) fn model_form(wheel: &Wheel, [u, q, psi, b1, b2]: [f64; 5]) -> Result<[f64; 3], Error> {
    let [v, l] = [Key::V, Key::L].map(|key| wheel.get(key));
    let omega = wheel.towing_yaw_rate();
    let yaw_rate = omega - b1;
    // u' = b2 solved for the forward speed.
    let forward_speed = (b2 + v - omega * q - l * yaw_rate * psi.sin()) / psi.cos();
    let field = wheel.rolling(&[])?;
    let state = [u, q, psi, forward_speed, yaw_rate];
    let mut rate = [0.0; 5];
    field.evaluate(&state, &[], &mut rate);
    // u'' is the derivative of u' along the motion.
    let along: [Dual<f64, 1>; 5] =
        std::array::from_fn(|index| Dual { value: state[index], derivatives: [rate[index]] });
    let mut rate_along = [Dual::constant(0.0); 5];
    field.evaluate(&along, &[], &mut rate_along);
    Ok([rate[1], -rate[4], rate_along[0].derivatives[0]])
}

/// (7) against the power of the spring forces in a virtual motion that rolls.
fn pseudo_forces(samples: &[Sample]) -> Claim {
    let difference = |(wheel, [u, q, psi, ..]): &Sample| {
        let [l, k] = [Key::L, Key::K].map(|key| wheel.get(key));
        let (sin, cos) = psi.sin_cos();
        // Virtual velocities (u', q') of the king pin for unit pseudo velocities, from the rolling constraint.
        let virtual_velocities = [(0.0, -l / cos), (1.0, -sin / cos)];
        let printed = [k * l * q / cos, k * (q * sin / cos - u)];
        largest(virtual_velocities.into_iter().zip(printed).map(|((u_rate, q_rate), printed)| {
            let power = -k * u * u_rate - k * q * q_rate;
            (power - printed).abs() / (1.0 + printed.abs())
        }))
    };
    let worst = largest(samples.iter().map(difference));
    Claim {
        place: "equations (6) and (7)",
        statement: "The pseudo forces are Γ₁ = k l q/cos ψ and Γ₂ = k (q tan ψ − u).".into(),
        verdict: Verdict::of(worst < AGREEMENT),
        evidence: format!(
            "They are the power of the spring forces in every virtual motion that rolls: largest relative difference {} \
             at {SAMPLES} random states.",
            number(worst, 2)
        ),
    }
}
