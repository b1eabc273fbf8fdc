//! The statements about kinematics and method: the rolling constraint (1), the number of states, and the energy of
//! acceleration (4), (5), each against motions of bodies that are written down anew here.

use super::claim::{Claim, Verdict};
use super::equations::{AGREEMENT, SAMPLES, Sample, model_form, samples};
use super::random::Random;
use crate::error::Error;
use crate::paper::numbers::{largest, number, per_cent};
use arclength::{Dual, Scalar};
use kingpin::{Key, Wheel};

const SEED: u64 = 2014;
/// Angles through which the wheel is turned about its axle.
const TURNS: usize = 24;
/// Difference of the two transverse moments of inertia of a wheel that is not round, relative to their mean.
const OUT_OF_ROUND: f64 = 0.1;

pub(super) fn claims() -> Result<Vec<Claim>, Error> {
    let samples = samples()?;
    Ok(vec![rolling_constraint(&samples), cyclic_coordinate(&samples), energy_of_acceleration(&samples)?])
}

fn rolling_constraint(samples: &[Sample]) -> Claim {
    let mut random = Random::new(SEED);
    let slips = samples.iter().map(|(wheel, state)| {
        let [turned, spin] = [0.0..6.0, -100.0..100.0].map(|range| random.within(range));
        slip_over_the_ground(wheel, *state, turned, spin)
    });
    let worst = largest(slips.collect::<Vec<_>>());
    Claim {
        place: "equation (1)",
        statement: "Rolling without slip is expressed by the two kinematic constraints as printed.".into(),
        verdict: Verdict::of(worst < AGREEMENT),
        evidence: format!(
            "With q̇ and u̇ from (1) the contact point has no velocity over the ground: at most {} (relative) at {SAMPLES} random \
             wheels and states, by differentiating its path on the ground, round the centre of the circle.",
            number(worst, 2)
        ),
    }
}

/// Speed of the contact point over the ground, relative to that of the rim, when `q'` and `u'` follow from (1).
fn slip_over_the_ground(wheel: &Wheel, [u, q, psi, psi_rate, _]: [f64; 5], turned: f64, spin: f64) -> f64 {
    let [l, r, radius] = [Key::L, Key::TurningRadius, Key::WheelRadius].map(|key| wheel.get(key));
    let (v, omega) = (wheel.get(Key::V), wheel.towing_yaw_rate());
    let (sin, cos) = psi.sin_cos();
    let q_rate = -l * psi_rate * cos + radius * spin * sin - omega * (u - l * cos);
    let u_rate = -l * psi_rate * sin - radius * spin * cos + omega * (q + l * sin) - v;
    let along = |value: f64, rate: f64| Dual::<f64, 1> { value, derivatives: [rate] };
    let (u, q, psi, turned) =
        (along(u, u_rate), along(q, q_rate), along(psi, psi_rate), along(turned, omega));
    let [(sin, cos), (turn_sin, turn_cos)] = [psi.sin_cos(), turned.sin_cos()];
    // The wheel, seen from the centre of the circle in the towing frame, and turned with it.
    let (x, y) = (u - cos * l, q + sin * l - r);
    let (ground_x, ground_y) = (turn_cos * x - turn_sin * y, turn_sin * x + turn_cos * y);
    let heading = (turn_cos * cos + turn_sin * sin, turn_sin * cos - turn_cos * sin);
    let slip_x = ground_x.derivatives[0] + radius * spin * heading.0.value;
    let slip_y = ground_y.derivatives[0] + radius * spin * heading.1.value;
    slip_x.hypot(slip_y) / (1.0 + radius * spin.abs())
}

fn cyclic_coordinate(samples: &[Sample]) -> Claim {
    let spread = |difference: f64| largest(samples.iter().map(|sample| spread_of_energy(sample, difference)));
    let [round, not_round] = [0.0, OUT_OF_ROUND].map(spread);
    Claim {
        place: "section 2",
        statement:
            "The wheel rotation φ is a cyclic coordinate and can be eliminated, which leaves five states."
                .into(),
        verdict: Verdict::sharpened(round < AGREEMENT, not_round > 1e3 * AGREEMENT),
        evidence: format!(
            "φ enters neither (1) nor the springs, and turning the wheel about its axle changes its kinetic energy by {} \
             (relative) at most, at {SAMPLES} states and {TURNS} angles: four coordinates and two pseudo velocities less φ are five \
             states. It takes a round wheel: were its two transverse moments of inertia {} apart, the energy would depend on φ \
             by up to {}.",
            number(round, 2),
            per_cent(OUT_OF_ROUND),
            per_cent(not_round)
        ),
    }
}

/// Largest less smallest kinetic energy of rotation of the wheel over all angles about its axle, relative to the mean, when its transverse
/// moments of inertia differ.
fn spread_of_energy((wheel, state): &Sample, difference: f64) -> f64 {
    let [spin_inertia, transverse, radius] =
        [Key::JWxi, Key::JWzeta, Key::WheelRadius].map(|key| wheel.get(key));
    let (speed, yaw_rate) = (forward_speed(wheel, *state), wheel.towing_yaw_rate() - state[3]);
    let (mut low, mut high, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
    for turn in 0..TURNS {
        let (sin, cos) = (std::f64::consts::TAU * turn as f64 / TURNS as f64).sin_cos();
        // The yaw rate along the two transverse axes that turn with the wheel.
        let [one, other] = [cos * yaw_rate, sin * yaw_rate];
        let transverse =
            transverse * ((1.0 + 0.5 * difference) * one * one + (1.0 - 0.5 * difference) * other * other);
        let energy = 0.5 * (spin_inertia * (speed / radius).powi(2) + transverse);
        low = low.min(energy);
        high = high.max(energy);
        sum += energy;
    }
    (high - low) * TURNS as f64 / sum
}

/// Forward speed of the wheel, from `u' = beta_2`.
fn forward_speed(wheel: &Wheel, [_, q, psi, b1, b2]: [f64; 5]) -> f64 {
    let (omega, l) = (wheel.towing_yaw_rate(), wheel.get(Key::L));
    let (sin, cos) = psi.sin_cos();
    (b2 + wheel.get(Key::V) - omega * q - l * (omega - b1) * sin) / cos
}

fn energy_of_acceleration(samples: &[Sample]) -> Result<Claim, Error> {
    let (mut difference, mut contribution, mut size) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (wheel, state) in samples {
        let [_, b1_rate, b2_rate] = model_form(wheel, *state)?;
        let Acceleration { energy, gyroscopic } = acceleration(wheel, *state, b1_rate, b2_rate);
        let [u, q, psi, ..] = *state;
        let [l, k] = [Key::L, Key::K].map(|key| wheel.get(key));
        let forces = [k * l * q / psi.cos(), k * (q * psi.tan() - u)];
        for ((left, force), part) in energy.derivatives.into_iter().zip(forces).zip(gyroscopic.derivatives) {
            difference = difference.max((left - force).abs() / (1.0 + force.abs()));
            contribution = contribution.max(part.abs());
        }
        size = size.max(gyroscopic.value.abs());
    }
    Ok(Claim {
        place: "equations (4) and (5)",
        statement: "The energy of acceleration has third terms ε·(ω × Jω) for caster and wheel; its derivatives give the equations of \
                    motion."
            .into(),
        verdict: Verdict::sharpened(difference < AGREEMENT, contribution == 0.0 && size > 0.0),
        evidence: format!(
            "The derivatives of (5), by automatic differentiation, equal the pseudo forces (7) when the accelerations are those of the \
             independently derived model: largest relative difference {} at {SAMPLES} random wheels and states. The third terms \
             contribute {} to them: that of the caster vanishes, that of the wheel does not, but has no pseudo \
             acceleration in it.",
            number(difference, 2),
            if contribution == 0.0 { "nothing".to_owned() } else { number(contribution, 2) }
        ),
    })
}

/// The energy of acceleration (5) and its third terms, with their derivatives with respect to the pseudo accelerations.
struct Acceleration {
    energy: Dual<f64, 2>,
    gyroscopic: Dual<f64, 2>,
}

fn acceleration(wheel: &Wheel, state: [f64; 5], b1_rate: f64, b2_rate: f64) -> Acceleration {
    type Vector = [Dual<f64, 2>; 3];
    let [_, _, psi, b1, _] = state;
    let [l, l_c, radius, m_w, m_c] =
        [Key::L, Key::LC, Key::WheelRadius, Key::MW, Key::MC].map(|key| wheel.get(key));
    let [j_wxi, j_wzeta, j_cz] = [Key::JWxi, Key::JWzeta, Key::JCz].map(|key| wheel.get(key));
    let omega = wheel.towing_yaw_rate();
    let (sin, cos) = psi.sin_cos();
    let (speed, yaw) = (forward_speed(wheel, state), omega - b1);
    let q_rate = -speed * sin + l * yaw * cos - omega * state[0];
    let (b1_rate, b2_rate) = (Dual::variable(b1_rate, 0), Dual::variable(b2_rate, 1));
    let yaw_rate: Dual<f64, 2> = -b1_rate;
    // The derivative of u' = beta_2, solved for that of the forward speed.
    let speed_rate =
        (b2_rate + (speed * sin - l * yaw * cos) * b1 - yaw_rate * (l * sin) - omega * q_rate) / cos;
    let distance = l - l_c;
    // Along the caster and across it; both turn with the yaw rate.
    let of_wheel = [speed_rate, Dual::constant(speed * yaw)];
    let of_caster = [speed_rate - distance * yaw * yaw, yaw_rate * distance + speed * yaw];
    let nothing = Dual::constant(0.0);
    let spin = speed / radius;
    let caster: ([f64; 3], Vector, [f64; 3]) =
        ([0.0, 0.0, yaw], [nothing, nothing, yaw_rate], [0.0, 0.0, j_cz]);
    let wheel_spin: ([f64; 3], Vector, [f64; 3]) = (
        [0.0, spin, yaw],
        [Dual::constant(-yaw * spin), speed_rate / radius, yaw_rate],
        [j_wzeta, j_wxi, j_wzeta],
    );
    let mut energy = nothing;
    for (mass, acceleration) in [(m_w, of_wheel), (m_c, of_caster)] {
        energy += (acceleration[0] * acceleration[0] + acceleration[1] * acceleration[1]) * (0.5 * mass);
    }
    let mut gyroscopic = nothing;
    for (rate, angular, inertia) in [caster, wheel_spin] {
        let momentum: [f64; 3] = std::array::from_fn(|axis| inertia[axis] * rate[axis]);
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let cross = rate[next] * momentum[last] - rate[last] * momentum[next];
            energy += angular[axis] * angular[axis] * (0.5 * inertia[axis]);
            gyroscopic += angular[axis] * cross;
        }
    }
    Acceleration { energy: energy + gyroscopic, gyroscopic }
}
