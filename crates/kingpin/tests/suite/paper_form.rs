//! The paper's own equations (3) and (8), with the pseudo velocities beta_1 = psi' and beta_2 = u', against the model.
//!
//! As printed they contain six misprints. Corrected they agree with the model; with any one left in they do not.

use arclength::{Dual, VectorField};
use kingpin::{Key, Wheel};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// A place where the paper's equations do not follow from its own (1), (2) and (4) to (7).
#[derive(Clone, Copy, Debug, PartialEq)]
enum Misprint {
    /// (3), first line: the sign of `(v/r) q`.
    LateralKinematics,
    /// (8), first equation, bracket that multiplies beta_1: the sign of `v`.
    SpeedInYawEquation,
    /// (8), first equation, last bracket: the sign of `l sin psi`.
    CasterInYawEquation,
    /// (8), second equation, first term: `cos^3` for `cos^2`.
    PowerOfCosine,
    /// (8), second equation, beta_1 term: the sign of `2 m_c (l - l_c)/cos psi`.
    StaticMomentSign,
    /// (8), second equation, beta_1 term: a factor `r` that is missing.
    MissingRadius,
}

/// `(q', beta_1', beta_2')` from the state `(u, q, psi, beta_1, beta_2)`, with one misprint left in or none.
fn paper_form(wheel: &Wheel, [u, q, psi, b1, b2]: [f64; 5], left_in: Option<Misprint>) -> [f64; 3] {
    let printed = |misprint: Misprint| left_in == Some(misprint);
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

/// The same from the model, at a state of the paper's form.
fn model_form(wheel: &Wheel, [u, q, psi, b1, b2]: [f64; 5]) -> [f64; 3] {
    let [v, l] = [Key::V, Key::L].map(|key| wheel.get(key));
    let omega = wheel.towing_yaw_rate();
    let yaw_rate = omega - b1;
    // u' = b2 solved for the forward speed.
    let forward_speed = (b2 + v - omega * q - l * yaw_rate * psi.sin()) / psi.cos();
    let field = wheel.rolling(&[]).unwrap();
    let state = [u, q, psi, forward_speed, yaw_rate];
    let mut rate = [0.0; 5];
    field.evaluate(&state, &[], &mut rate);
    // u'' is the derivative of u' along the motion.
    let along: [Dual<f64, 1>; 5] =
        std::array::from_fn(|index| Dual { value: state[index], derivatives: [rate[index]] });
    let mut rate_along = [Dual::constant(0.0); 5];
    field.evaluate(&along, &[], &mut rate_along);
    [rate[1], -rate[4], rate_along[0].derivatives[0]]
}

prop_compose! {
    fn wheels()(
        v in 0.5..8.0, l in 0.03..0.2, r in 0.4..5.0, k in 20.0..300.0, m_w in 0.1..1.0, m_c in 0.02..0.3,
        j_wxi in 1e-5..1e-3, j_wzeta in 1e-5..1e-3, j_cz in 1e-6..1e-3, radius in 0.02..0.1, l_c in 0.0..0.1,
    ) -> Wheel {
        [
            (Key::V, v), (Key::L, l), (Key::TurningRadius, r), (Key::K, k), (Key::MW, m_w), (Key::MC, m_c),
            (Key::JWxi, j_wxi), (Key::JWzeta, j_wzeta), (Key::JCz, j_cz), (Key::WheelRadius, radius), (Key::LC, l_c),
        ]
        .into_iter()
        .fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value).unwrap())
    }
}

prop_compose! {
    fn states()(u in -0.1..0.1, q in -0.1..0.1, psi in -1.2..1.2, b1 in -20.0..20.0, b2 in -2.0..2.0) -> [f64; 5] {
        [u, q, psi, b1, b2]
    }
}

/// Largest relative difference of the three rates; rates are sums of larger terms, hence the 1.
fn disagreement(wheel: &Wheel, state: [f64; 5], left_in: Option<Misprint>) -> f64 {
    let pairs = paper_form(wheel, state, left_in).into_iter().zip(model_form(wheel, state));
    pairs.map(|(paper, model)| (paper - model).abs() / (1.0 + model.abs())).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn corrected_equations_agree_with_the_model(wheel in wheels(), state in states()) {
        prop_assert!(disagreement(&wheel, state, None) < 1e-10, "{}", disagreement(&wheel, state, None));
    }
}

/// The median over 200 random wheels and states.
fn typical_disagreement(left_in: Option<Misprint>) -> f64 {
    let mut runner = TestRunner::deterministic();
    let mut sample: Vec<f64> = (0..200)
        .map(|_| {
            let wheel = wheels().new_tree(&mut runner).unwrap().current();
            let state = states().new_tree(&mut runner).unwrap().current();
            disagreement(&wheel, state, left_in)
        })
        .collect();
    sample.sort_by(f64::total_cmp);
    sample[100]
}

macro_rules! misprint_tests {
    ($($test:ident: $misprint:ident),*) => {$(
        #[test]
        fn $test() {
            let disagreement = typical_disagreement(Some(Misprint::$misprint));
            assert!(disagreement > 1e-3, "{disagreement}");
            assert!(typical_disagreement(None) < 1e-12);
        }
    )*};
}

misprint_tests! {
    misprint_1_left_in_disagrees: LateralKinematics,
    misprint_2_left_in_disagrees: SpeedInYawEquation,
    misprint_3_left_in_disagrees: CasterInYawEquation,
    misprint_4_left_in_disagrees: PowerOfCosine,
    misprint_5_left_in_disagrees: StaticMomentSign,
    misprint_6_left_in_disagrees: MissingRadius
}
