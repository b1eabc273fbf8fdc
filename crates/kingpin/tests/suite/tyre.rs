//! The wheel with a tyre, against what does not come from its code: published Hopf points, the known limit of the straight-tangent
//! theory, the rolling wheel as the tyre grows stiff, the bristles of the brush one by one, the equations of motion set up a second
//! way in the ground frame, and the energy.

use approx::assert_relative_eq;
use arclength::VectorField;
use arclength::branch::Criticality;
use arclength::continuation::Stop;
use arclength::control::Control;
use arclength::integration::{Event, Integrator, from_fn};
use kingpin::branches::{Along, CycleOptions, SLOWEST_ON_CYCLES};
use kingpin::tyre::TYRE_STATE_NAMES;
use kingpin::{Key, KingpinError, Tyre, Wheel};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn wheel(tyre: Tyre, settings: &[(Key, f64)]) -> Wheel {
    let mut wheel = Wheel::default();
    wheel.set_tyre(tyre);
    settings.iter().fold(wheel, |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// Of the size of the paper's wheel, towed straight.
fn caster(tyre: Tyre, more: &[(Key, f64)]) -> Wheel {
    let settings = [
        (Key::TurningRadius, f64::INFINITY),
        (Key::Sigma, 0.05),
        (Key::HalfContactLength, 0.02),
        (Key::CAlpha, 300.0),
        (Key::FAz, -20.0),
    ];
    wheel(tyre, &[&settings[..], more].concat())
}

/// Somieski's nose gear (Aerospace Science and Technology 1, 1997): 1 kg m^2 about the king pin, which is rigid.
fn nose_gear(damping: f64) -> Wheel {
    wheel(
        Tyre::Linear,
        &[
            (Key::L, 0.1),
            (Key::LC, 0.05),
            (Key::MW, 1.0),
            (Key::MC, 1.0),
            (Key::JWzeta, 0.9),
            (Key::JCz, 0.0875),
            (Key::KU, f64::INFINITY),
            (Key::KQ, f64::INFINITY),
            (Key::KPsi, 1e5),
            (Key::CPsi, damping),
            (Key::TurningRadius, f64::INFINITY),
            (Key::Sigma, 0.3),
            (Key::HalfContactLength, 0.1),
            (Key::CAlpha, 9000.0 * 20.0),
            (Key::TP, 0.1),
            (Key::Kappa, 270.0),
        ],
    )
}

#[test]
fn hopf_points_of_the_nose_gear_are_those_published() {
    let along = Along::new(Key::V, 1.0, 200.0).unwrap();
    for (damping, published) in [(0.0, vec![15.259_297_292]), (10.0, vec![20.511_049_179]), (50.0, vec![])] {
        // As many digits with longitudinal elasticity, which is decoupled in straight towing.
        for longitudinal in [f64::INFINITY, 1e4] {
            let gear = nose_gear(damping).with(Key::KU, longitudinal).unwrap();
            let found = gear.hopf_points(along, &Control::none()).unwrap().points;
            assert_eq!(found.len(), published.len());
            for (point, published) in found.iter().zip(&published) {
                assert!((point.value - published).abs() < 5e-10, "{} {published}", point.value);
            }
        }
    }
    let critical = nose_gear(10.0).critical_speed().unwrap().speed;
    assert!((critical - 20.511_049_179).abs() < 5e-10);
    assert!(nose_gear(50.0).critical_speed().is_none());
}

proptest! {
    /// Pacejka: with a rigid king pin, without damping and tread width, straight towing is stable exactly for `l > sigma + a`, whatever
    /// the pneumatic trail.
    #[test]
    fn a_rigid_king_pin_needs_a_long_caster(
        v in 0.1..50.0f64, sigma in 0.01..0.5f64, a in 0.0..0.2f64, trail in -0.001..0.1f64,
        stiffness in 1.0..6.0f64, part in 0.5..1.5f64, mass in -1.0..2.0f64, brush in any::<bool>(),
    ) {
        let l = part * (sigma + a);
        let tyre = if brush { Tyre::Brush } else { Tyre::Linear };
        let wheel = wheel(tyre, &[
            (Key::V, v), (Key::L, l), (Key::MW, 10_f64.powf(mass)), (Key::K, f64::INFINITY),
            (Key::TurningRadius, f64::INFINITY), (Key::Sigma, sigma), (Key::HalfContactLength, a),
            (Key::CAlpha, 10_f64.powf(stiffness)), (Key::TP, trail),
        ]);
        let motion = wheel.uniform_motion().unwrap();
        // A trail that lies ahead by more than the caster is long would turn the caster round.
        prop_assume!(l + trail > 1e-3 && (part - 1.0).abs() > 1e-6);
        prop_assert_eq!(motion.is_stable(), Some(part > 1.0), "{}", motion.growth_rate());
    }
}

/// With `a = t_p = kappa = 0` the eigenvalues tend to those of the rolling wheel as the cornering stiffness grows, with an error that
/// falls as its reciprocal.
#[test]
fn a_stiff_tyre_is_the_rolling_wheel() {
    let mut circles = 0;
    for (v, radius, longitudinal) in [
        (4.0, 1.0, 100.0),
        (8.0, 1.0, 100.0),
        (4.0, f64::INFINITY, 100.0),
        (8.0, f64::INFINITY, 100.0),
        (4.0, 1.0, f64::INFINITY),
        (8.0, f64::INFINITY, f64::INFINITY),
    ] {
        let rigid = Wheel::default()
            .with(Key::V, v)
            .and_then(|wheel| wheel.with(Key::TurningRadius, radius))
            .and_then(|wheel| wheel.with(Key::KU, longitudinal))
            .unwrap();
        let limit = rigid.uniform_motion().unwrap();
        let errors = |cornering: f64| {
            let mut wheel = rigid;
            wheel.set_tyre(Tyre::Linear);
            let wheel =
                wheel.with(Key::Sigma, 0.05).and_then(|wheel| wheel.with(Key::CAlpha, cornering)).unwrap();
            let motion = wheel.uniform_motion().unwrap();
            let found = motion.eigenvalues();
            let farthest = limit
                .eigenvalues()
                .iter()
                .map(|expected| {
                    let distances = found.iter().map(|eigenvalue| (eigenvalue - expected).norm());
                    distances.fold(f64::INFINITY, f64::min) / expected.norm()
                })
                .fold(0.0, f64::max);
            let state = (motion.psi() - limit.psi()).abs() + (motion.q() - limit.q()).abs() / 0.08;
            (farthest, state)
        };
        let ((first, first_state), (second, second_state)) = (errors(1e6), errors(1e7));
        assert!(first < 0.1 && (first / second - 10.0).abs() < 0.2, "{v} {radius}: {first:e} {second:e}");
        if radius.is_finite() {
            circles += 1;
            assert!((first_state / second_state - 10.0).abs() < 0.2, "{first_state:e} {second_state:e}");
        }
    }
    assert_eq!(circles, 3);
}

/// Force and moment of a row of bristles, each bent as far as its friction holds it under a parabola of pressure.
fn bristles(wheel: &Wheel, slip: f64) -> [f64; 2] {
    const COUNT: usize = 200_000;
    let get = |key| wheel.get(key);
    let (a, friction) = (get(Key::HalfContactLength), get(Key::MuS) * wheel.normal_force());
    let stiffness = get(Key::CAlpha) / (2.0 * a * a);
    let width = 2.0 * a / COUNT as f64;
    (0..COUNT).fold([0.0; 2], |[force, moment], index| {
        let place = (index as f64 + 0.5) * width;
        let limit = 0.75 * friction * place * (2.0 * a - place) / (a * a * a);
        let bent = (stiffness * slip.abs() * place).min(limit).copysign(slip);
        [force + width * bent, moment + width * bent * (a - place)]
    })
}

#[test]
fn the_brush_is_its_bristles() {
    let wheel = caster(Tyre::Brush, &[(Key::K, f64::INFINITY)]);
    let [sigma, l] = [Key::Sigma, Key::L].map(|key| wheel.get(key));
    let field = wheel.with_tyre(&[]).unwrap();
    let inertia = inertia_about_king_pin(&wheel);
    for slip in [1e-6, 0.01, -0.05, 0.1, 0.2, -0.24, 0.3, 2.0] {
        let mut rate = [0.0; 3];
        field.evaluate(&[0.0, 0.0, slip * sigma], &[], &mut rate);
        let [force, moment] = bristles(&wheel, slip);
        // Without pneumatic trail there is the force alone, on the same arm.
        let mut without = [0.0; 3];
        let other = wheel.with(Key::TP, 0.0).unwrap().with_tyre(&[]).unwrap();
        other.evaluate(&[0.0, 0.0, slip * sigma], &[], &mut without);
        assert_relative_eq!(without[1] * inertia, -l * force, max_relative = 1e-6);
        assert!(((rate[1] - without[1]) * inertia - moment).abs() < 1e-6 * (0.02 * force).abs());
    }
}

fn inertia_about_king_pin(wheel: &Wheel) -> f64 {
    let get = |key| wheel.get(key);
    get(Key::JCz)
        + get(Key::JWzeta)
        + get(Key::MW) * get(Key::L).powi(2)
        + get(Key::MC) * get(Key::LC).powi(2)
}

/// Force and moment of the tyre, from the formulas of the law.
fn tyre_forces(wheel: &Wheel, forward: f64, yaw_rate: f64, deflection: f64) -> [f64; 2] {
    let get = |key| wheel.get(key);
    let slip = deflection / get(Key::Sigma);
    let linear = get(Key::CAlpha) * slip;
    let [force, aligning] = match wheel.tyre() {
        Tyre::Brush => {
            let limit = get(Key::MuS) * wheel.normal_force();
            let used = f64::min(1.0, get(Key::CAlpha) * slip.abs() / (3.0 * limit));
            let force = slip.signum() * limit * (1.0 - (1.0 - used).powi(3));
            [force, -get(Key::TP) * linear * (1.0 - used).powi(3)]
        }
        _ => [linear, -get(Key::TP) * linear],
    };
    [force, aligning - get(Key::Kappa) * yaw_rate / forward]
}

/// Gaussian elimination with partial pivoting.
fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> [f64; N] {
    for column in 0..N {
        let pivot = (column..N)
            .max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))
            .expect("a row");
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..N {
            let factor = matrix[row][column] / matrix[column][column];
            let above = matrix[column];
            matrix[row].iter_mut().zip(above).for_each(|(entry, above)| *entry -= factor * above);
            right[row] -= factor * right[column];
        }
    }
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right
}

/// The rates of `u q psi V1 V2 Omega y_t` from the balances of both bodies in the ground frame. The unknowns are the acceleration of the
/// king pin, the yaw acceleration and the force on the king pin, on the axes of the towing frame at that instant.
fn rates_in_the_ground_frame(wheel: &Wheel, state: &[f64; 7]) -> [f64; 7] {
    let get = |key| wheel.get(key);
    let &[u, q, psi, forward, lateral, yaw_rate, deflection] = state;
    let (v, omega) = (get(Key::V), wheel.towing_yaw_rate());
    let (along, across) = ([psi.cos(), -psi.sin()], [psi.sin(), psi.cos()]);
    let speed_of_wheel = [0, 1].map(|i| forward * along[i] + lateral * across[i]);
    let speed_of_pin = [0, 1].map(|i| speed_of_wheel[i] + get(Key::L) * yaw_rate * across[i]);
    let [u_rate, q_rate] = [speed_of_pin[0] - v + omega * q, speed_of_pin[1] - omega * u];
    let [force, moment] = tyre_forces(wheel, forward, yaw_rate, deflection);
    let spin = get(Key::JWxi) / get(Key::WheelRadius).powi(2);
    let about_pin = moment - get(Key::CPsi) * (yaw_rate - omega) + get(Key::KPsi) * psi;

    // A body at the distance d behind the king pin has the acceleration A - d (Omega' across - Omega^2 along).
    let bodies = [(get(Key::MW), get(Key::L)), (get(Key::MC), get(Key::LC))];
    let mut matrix = [[0.0; 5]; 5];
    let mut right = [0.0; 5];
    for (mass, distance) in bodies {
        for i in 0..2 {
            matrix[i][i] += mass;
            matrix[i][2] -= mass * distance * across[i];
            right[i] -= mass * distance * yaw_rate * yaw_rate * along[i];
            // Moments about the king pin, of -d along with the acceleration: only its part across counts.
            matrix[2][i] -= mass * distance * across[i];
        }
        matrix[2][2] += mass * distance * distance;
    }
    matrix[2][2] += get(Key::JCz) + get(Key::JWzeta);
    right[2] = about_pin - get(Key::L) * force;
    for i in 0..2 {
        right[i] += force * across[i];
        // The ground turns the wheel about its axle by T1 = -(J_wxi/R^2) V1', V1' = along (A + l Omega^2 along) + Omega V2.
        for j in 0..2 {
            matrix[i][j] += spin * along[i] * along[j];
        }
        right[i] -= spin * along[i] * (get(Key::L) * yaw_rate * yaw_rate + yaw_rate * lateral);
        matrix[i][3 + i] = -1.0;
    }
    for (i, (stiffness, damping, displacement, rate)) in
        [(Key::KU, Key::CU, u, u_rate), (Key::KQ, Key::CQ, q, q_rate)].into_iter().enumerate()
    {
        if get(stiffness).is_finite() {
            matrix[3 + i][3 + i] = 1.0;
            right[3 + i] = -get(stiffness) * displacement - get(damping) * rate;
        } else {
            matrix[3 + i][i] = 1.0;
            right[3 + i] = if i == 0 {
                -omega * q_rate - omega * speed_of_pin[1]
            } else {
                omega * u_rate + omega * speed_of_pin[0]
            };
        }
    }
    let [a_x, a_y, yaw_acceleration, ..] = solve(matrix, right);
    let wheel_acceleration = [a_x, a_y];
    let part = |axis: [f64; 2]| axis[0] * wheel_acceleration[0] + axis[1] * wheel_acceleration[1];
    [
        u_rate,
        q_rate,
        omega - yaw_rate,
        part(along) + get(Key::L) * yaw_rate * yaw_rate + yaw_rate * lateral,
        part(across) - get(Key::L) * yaw_acceleration - yaw_rate * forward,
        yaw_acceleration,
        -(lateral + get(Key::HalfContactLength) * yaw_rate) - forward * deflection / get(Key::Sigma),
    ]
}

/// A wheel with everything that it can have, from numbers between 0 and 1.
fn any_wheel(tyre: Tyre, pin: usize, part: &[f64; 16]) -> Wheel {
    let stiffness = |rigid: bool, part: f64| if rigid { f64::INFINITY } else { 50.0 + 300.0 * part };
    wheel(
        tyre,
        &[
            (Key::V, 1.0 + 7.0 * part[0]),
            (Key::Curvature, 1.5 * part[1]),
            (Key::L, 0.04 + 0.1 * part[2]),
            (Key::LC, -0.02 + 0.06 * part[3]),
            (Key::KU, stiffness(pin & 1 == 1, part[4])),
            (Key::KQ, stiffness(pin & 2 == 2, part[5])),
            (Key::CU, 0.3 * part[6]),
            (Key::CQ, 0.3 * part[7]),
            (Key::CPsi, 1e-3 * part[8]),
            (Key::KPsi, 0.1 * part[9]),
            (Key::Sigma, 0.02 + 0.1 * part[10]),
            (Key::HalfContactLength, 0.03 * part[11]),
            (Key::CAlpha, 20.0 + 500.0 * part[12]),
            (Key::TP, 0.02 * part[13]),
            (Key::Kappa, 0.01 * part[14]),
            (Key::FAz, -40.0 * part[15]),
        ],
    )
}

fn parts() -> impl Strategy<Value = [f64; 16]> {
    proptest::array::uniform16(0.0..1.0_f64)
}

fn tyre_of(brush: bool) -> Tyre {
    if brush { Tyre::Brush } else { Tyre::Linear }
}

proptest! {
    #[test]
    fn equations_are_those_of_the_ground_frame(
        part in parts(), pin in 0..4usize, brush in any::<bool>(), psi in -1.2..1.2f64, speed in 0.5..9.0f64,
        lateral in -2.0..2.0f64, yaw_rate in -20.0..20.0f64, deflection in -0.03..0.03f64,
    ) {
        let wheel = any_wheel(tyre_of(brush), pin, &part);
        let field = wheel.with_tyre(&[]).unwrap();
        let names = wheel.free_states();
        let index = |name: &str| TYRE_STATE_NAMES.iter().position(|state| *state == name).unwrap();
        let given = [0.01, -0.02, psi, speed, lateral, yaw_rate, deflection];
        let free: Vec<f64> = names.iter().map(|name| given[index(name)]).collect();
        let state = field.full_state(&free, &[]);
        prop_assume!(state[3] > 0.1);
        let mut rates = vec![0.0; free.len()];
        field.evaluate(&free, &[], &mut rates);
        let expected = rates_in_the_ground_frame(&wheel, &state);
        for (name, rate) in names.iter().zip(rates) {
            let expected = expected[index(name)];
            prop_assert!((rate - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{}: {} {}", name, rate, expected);
        }
        // What is not free follows.
        for (name, stiffness) in [("u", Key::KU), ("q", Key::KQ)] {
            prop_assert!(wheel.get(stiffness).is_finite() || expected[index(name)].abs() < 1e-9);
        }
    }

    /// The rate of kinetic and spring energy is the power of the towing point less that of dampers and tyre.
    #[test]
    fn energy_balance(part in parts(), brush in any::<bool>(), psi in -0.4..0.4f64) {
        let wheel = any_wheel(tyre_of(brush), 0, &part);
        let field = wheel.with_tyre(&[]).unwrap();
        let get = |key| wheel.get(key);
        let energy = |x: &[f64]| {
            let (m, arm) = (get(Key::MW) + get(Key::MC), get(Key::L) - get(Key::LC));
            let spin = get(Key::JWxi) / get(Key::WheelRadius).powi(2);
            let inertia = get(Key::JCz) + get(Key::JWzeta) + get(Key::MC) * arm * arm;
            0.5 * (m * (x[3] * x[3] + x[4] * x[4]) + spin * x[3] * x[3] + inertia * x[5] * x[5])
                + get(Key::MC) * arm * x[4] * x[5]
                + 0.5 * (get(Key::KU) * x[0] * x[0] + get(Key::KQ) * x[1] * x[1] + get(Key::KPsi) * x[2] * x[2])
        };
        let power = |x: &[f64], rate: &[f64]| {
            let (v, omega) = (get(Key::V), wheel.towing_yaw_rate());
            let pull = [
                -get(Key::KU) * x[0] - get(Key::CU) * rate[0],
                -get(Key::KQ) * x[1] - get(Key::CQ) * rate[1],
            ];
            let turning = get(Key::KPsi) * x[2] - get(Key::CPsi) * (x[5] - omega);
            let [force, moment] = tyre_forces(&wheel, x[3], x[5], x[6]);
            let towing = pull[0] * (v - omega * x[1]) + pull[1] * omega * x[0] + turning * omega;
            let damped = get(Key::CU) * rate[0].powi(2) + get(Key::CQ) * rate[1].powi(2)
                + get(Key::CPsi) * (x[5] - omega).powi(2);
            towing - damped + force * x[4] + moment * x[5]
        };
        let with_work = from_fn(8, |_, state, derivative| {
            field.evaluate(&state[..7], &[], &mut derivative[..7]);
            derivative[7] = power(&state[..7], &derivative[..7]);
        });
        let v = get(Key::V);
        let start = [0.01, -0.02, psi, v, 0.0, 3.0, 0.002, 0.0];
        // As far as the wheel rolls forwards.
        let mut stop = [Event::new(|_, state: &[f64]| state[3] - 0.1).falling().terminal()];
        let end = Integrator::with_tolerance(1e-11)
            .with_events(with_work, 0.0, &start, 0.3, &[], &mut stop)
            .unwrap()
            .state;
        let gained = energy(&end) - energy(&start);
        let size = energy(&start).max(energy(&end)).max(1.0);
        prop_assert!((gained - end[7]).abs() < 1e-8 * size, "{} {}", gained, end[7]);
    }

    /// In uniform motion nothing changes, by the equations set up the second way too, and what the towing point supplies is what
    /// the tyre uses up.
    #[test]
    fn uniform_motion_has_its_witnesses(part in parts(), pin in 0..4usize, brush in any::<bool>()) {
        let wheel = any_wheel(tyre_of(brush), pin, &part);
        match wheel.uniform_motion() {
            Ok(motion) => {
                let state: [f64; 7] = motion.states().try_into().unwrap();
                prop_assert!(motion.residual() < 1e-8);
                for rate in rates_in_the_ground_frame(&wheel, &state) {
                    prop_assert!(rate.abs() < 1e-7, "{}", rate);
                }
                // Where friction limits the force, the motion that is found is one that it can hold.
                let lateral = motion.contact_force().lateral.abs();
                prop_assert!(!brush || lateral <= wheel.get(Key::MuS) * wheel.normal_force() * (1.0 + 1e-12));
            }
            Err(error) => prop_assert!(matches!(error, KingpinError::NoUniformMotion { .. }), "{}", error),
        }
    }

    /// What is said to be stable has all its eigenvalues on the left, and those are eigenvalues of the field's differences.
    #[test]
    fn stability_is_that_of_the_equations(part in parts(), pin in 0..4usize, brush in any::<bool>()) {
        let wheel = any_wheel(tyre_of(brush), pin, &part);
        let Ok(motion) = wheel.uniform_motion() else { return Ok(()) };
        let field = wheel.with_tyre(&[]).unwrap();
        let index = |name: &str| TYRE_STATE_NAMES.iter().position(|state| *state == name).unwrap();
        let states = motion.states();
        let free: Vec<f64> = wheel.free_states().iter().map(|name| states[index(name)]).collect();
        let n = free.len();
        let mut columns = Vec::new();
        for column in 0..n {
            let side = |step: f64| {
                let mut moved = free.clone();
                moved[column] += step;
                let rates = rates_in_the_ground_frame(&wheel, &field.full_state(&moved, &[]));
                wheel.free_states().iter().map(|name| rates[index(name)]).collect::<Vec<f64>>()
            };
            let step = 1e-6;
            columns.extend(side(step).iter().zip(side(-step)).map(|(above, below)| (above - below) / (2.0 * step)));
        }
        let expected = arclength::linear::eigenvalues::eigenvalues(&columns, n).unwrap();
        let size = expected.iter().map(|value| value.norm()).fold(0.0, f64::max);
        prop_assert!((expected[0].re - motion.eigenvalues()[0].re).abs() < 1e-4 * size);
        if (expected[0].re).abs() > 1e-4 * size {
            prop_assert_eq!(motion.is_stable(), Some(expected[0].re < 0.0));
        }
    }
}

/// With the damper that is enough the wheel is stable at every speed, with a little less it is not at the one that decides.
#[test]
fn the_smallest_damper_is_at_the_edge() {
    let short = caster(Tyre::Linear, &[(Key::L, 0.05), (Key::Kappa, 1e-3)]);
    let rigid = short.with(Key::K, f64::INFINITY).unwrap();
    for (wheel, key) in [(short, Key::CPsi), (rigid, Key::CPsi), (nose_gear(0.0), Key::CPsi)] {
        let up_to = 8.0 * wheel.get(Key::V);
        let found = wheel.smallest_damper(key, up_to, &Control::none()).unwrap().unwrap();
        let speed = found.speed.unwrap();
        let stable = |damping: f64, v: f64| {
            let wheel = wheel.with(key, damping).and_then(|wheel| wheel.with(Key::V, v)).unwrap();
            wheel.uniform_motion().unwrap().is_stable()
        };
        assert_eq!(stable(0.9999 * found.damping, speed), Some(false));
        for index in 1..=1000 {
            let v = up_to * f64::from(index) / 1000.0;
            assert_ne!(stable(1.0001 * found.damping, v), Some(false), "{v}");
        }
    }
}

/// Under the brush law no first Lyapunov coefficient exists at a straight Hopf point: the amplitude grows in proportion to the distance
/// from it, as fast as the slope says.
#[test]
fn straight_brushes_have_a_slope_in_place_of_a_first_lyapunov_coefficient() {
    let brush = |gear: Wheel| {
        let mut brush = gear.with(Key::FAz, -9000.0).unwrap();
        brush.set_tyre(Tyre::Brush);
        brush
    };
    let elastic = nose_gear(10.0).with(Key::KU, 3e5).and_then(|gear| gear.with(Key::KQ, 1e7)).unwrap();
    for gear in [nose_gear(0.0), nose_gear(10.0), elastic] {
        let along = Along::new(Key::V, 5.0, 60.0).unwrap();
        let smooth = gear.hopf_points(along, &Control::none()).unwrap().points;
        let found = brush(gear).hopf_points(along, &Control::none()).unwrap().points;
        assert!(!found.is_empty() && smooth.len() == found.len());
        for (smooth, hopf) in smooth.iter().zip(&found) {
            // The linear parts of both laws are one.
            assert_relative_eq!(smooth.value, hopf.value, max_relative = 1e-9);
            assert!(smooth.first_lyapunov.is_some() && hopf.first_lyapunov.is_none());
            let slope = hopf.psi_max_slope.unwrap();
            // Cycles on the side on which the slope says they are.
            let near = [5e-3, 1e-2].map(|part| hopf.value * (1.0 + part * slope.signum()));
            let options = CycleOptions { at: near.to_vec(), ..CycleOptions::default() };
            let cycles = hopf.cycles(along, &options, |_| ControlFlow::Continue(())).unwrap();
            let amplitude = |value: f64| {
                let cycle = cycles.points.iter().find(|cycle| (cycle.value - value).abs() < 1e-12 * value);
                cycle.unwrap_or_else(|| panic!("no cycle at {value}")).max[2]
            };
            // The next term of the amplitude is of second order.
            let [first, second] = near.map(|value| amplitude(value) / (value - hopf.value));
            let extrapolated = 2.0 * first - second;
            assert_relative_eq!(extrapolated, slope, max_relative = 1e-3);
            let stable =
                cycles.points.iter().find(|cycle| cycle.value == near[0]).and_then(|cycle| cycle.stable);
            assert_eq!(stable, Some(hopf.criticality == Criticality::Supercritical));
        }
    }
    // On a circle there is slip, and the coefficient exists.
    let turning = brush(elastic).with(Key::TurningRadius, 30.0).unwrap();
    let found = turning.hopf_points(Along::new(Key::V, 5.0, 40.0).unwrap(), &Control::none()).unwrap().points;
    assert!(!found.is_empty() && found.iter().all(|point| point.first_lyapunov.is_some()));
}

/// Cycles are followed as far as the wheel rolls forwards.
#[test]
fn branches_end_where_the_wheel_stops() {
    let along = Along::new(Key::V, 5.0, 60.0).unwrap();
    let hopf = nose_gear(0.0).hopf_points(along, &Control::none()).unwrap().points.remove(0);
    let cycles = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
    assert!(matches!(cycles.stops[1], Some(Stop::Monitor { .. })), "{:?}", cycles.stops[1]);
    let last = cycles.points.last().unwrap();
    assert_relative_eq!(last.min[3] / last.value, SLOWEST_ON_CYCLES, max_relative = 1e-6);
    assert!(cycles.points.iter().all(|cycle| cycle.min[3] > 0.0));
}

/// A nose gear with seven states, whose cycles need ever finer meshes, under both laws: every branch is told to its end, and on no cycle
/// does the wheel stop.
#[test]
fn branches_of_seven_states_are_followed_to_their_ends() {
    for tyre in [Tyre::Linear, Tyre::Brush] {
        let gear = wheel(
            tyre,
            &[
                (Key::L, 0.09),
                (Key::TurningRadius, f64::INFINITY),
                (Key::MW, 5.0),
                (Key::MC, 3.0),
                (Key::JWxi, 0.08),
                (Key::JWzeta, 0.045),
                (Key::JCz, 0.02),
                (Key::WheelRadius, 0.17),
                (Key::LC, 0.03),
                (Key::K, 6e4),
                (Key::CPsi, 3.0),
                (Key::FAz, -1200.0),
                (Key::MuS, 0.8),
                (Key::Sigma, 0.1),
                (Key::HalfContactLength, 0.06),
                (Key::CAlpha, 2e4),
                (Key::Kappa, 5.0),
            ],
        );
        let along = Along::new(Key::V, 0.05, 40.0).unwrap();
        let found = gear.hopf_points(along, &Control::none()).unwrap().points;
        assert_eq!(found.len(), 2);
        for hopf in found {
            let cycles = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
            assert!(cycles.points.len() > 3, "{:?}", cycles.stops);
            for cycle in &cycles.points {
                assert!(cycle.min[3] > 0.9 * SLOWEST_ON_CYCLES * cycle.value, "{}", cycle.min[3]);
            }
        }
    }
}

/// A stable caster comes back; one whose king pin decelerates the wheel to a stop ends there.
#[test]
fn a_motion_that_stops_ends_there() {
    let history =
        caster(Tyre::Brush, &[]).simulate_with_tyre(2.0, &[("psi", 1.4)], 2001, &Control::none()).unwrap();
    let thrown = caster(Tyre::Linear, &[(Key::K, f64::INFINITY), (Key::L, 0.06)]);
    let stopped =
        thrown.simulate_with_tyre(5.0, &[("psi", 1.2), ("Omega", -40.0)], 5001, &Control::none()).unwrap();
    let time = stopped.stopped_at.expect("a stop");
    assert!(stopped.times.iter().all(|&sample| sample <= time) && stopped.times.len() < 5001);
    assert!(stopped.states.iter().all(|state| state[3] > 0.0));
    assert!(history.states.iter().all(|state| state[3] > 0.0));
    let refused = thrown.simulate_with_tyre(1.0, &[("psi", 2.0)], 11, &Control::none()).unwrap_err();
    assert!(refused.to_string().contains("roll forwards"), "{refused}");
}

#[test]
fn what_a_tyre_needs_is_said() {
    let message = |text: &str| {
        let wheel = Wheel::from_toml(text).unwrap();
        wheel.uniform_motion().unwrap_err().to_string()
    };
    assert!(message("tyre = \"linear\"\nsigma = 0.1").contains("needs C_alpha"));
    assert!(message("tyre = \"brush\"\nC_alpha = 100").contains("needs sigma"));
    assert!(message("sigma = 0.1").contains("the wheel has none"));
    assert!(message("k_q = inf").contains("without a tyre"));
    let brush = "tyre = \"brush\"\nsigma = 0.1\nC_alpha = 100\n";
    assert!(message(&format!("{brush}F_Az = 100")).contains("needs friction"));
    assert!(message(&format!("{brush}mu_s = 0")).contains("needs friction"));
    let error = Wheel::from_toml("l = 0.1\ntyre = \"soft\"").unwrap_err().to_string();
    assert!(
        error.starts_with("line 2, column 8: tyre = soft") && error.contains("rigid, linear, brush"),
        "{error}"
    );
    assert!("tyre".parse::<Key>().unwrap_err().to_string().contains("cannot vary"));
    // Said to be rigid, a wheel may keep what its tyre had.
    let mut rigid = Wheel::from_toml(brush).unwrap();
    rigid.set("tyre", "rigid").unwrap();
    assert_eq!(rigid.uniform_motion().unwrap().state(), Wheel::default().uniform_motion().unwrap().state());
    assert!(rigid.rolling(&[Key::Sigma]).is_err() && rigid.with_tyre(&[]).is_err());
    // What takes no tyre says what does.
    let soft = caster(Tyre::Linear, &[]);
    for error in [soft.rolling(&[]).unwrap_err(), soft.lateral(&[]).unwrap_err()] {
        assert!(error.to_string().contains("with a tyre there are"), "{error}");
    }
    assert!(soft.sliding().is_err() && soft.simulate(1.0, &[], 2, &Control::none()).is_err());
    assert!(soft.swing_factor().is_none() && soft.critical_speed_with_friction().is_none());
    assert!(soft.critical_yaw_rate().is_none() && soft.critical_caster_length().is_none());
}

/// The pneumatic trail is a third of the half contact length until it is set, along branches too.
#[test]
fn the_pneumatic_trail_follows_the_contact_length() {
    let soft = caster(Tyre::Linear, &[]);
    assert_eq!(soft.get(Key::TP), 0.02 / 3.0);
    assert_eq!(
        soft.with(Key::TP, 0.004)
            .and_then(|wheel| wheel.with(Key::HalfContactLength, 0.03))
            .unwrap()
            .get(Key::TP),
        0.004
    );
    let field = soft.with_tyre(&[Key::HalfContactLength]).unwrap();
    let other = soft.with(Key::HalfContactLength, 0.03).unwrap();
    let state = [0.001, 0.002, 0.1, 4.0, 0.1, 2.0, 0.003];
    let (mut varied, mut fixed) = ([0.0; 7], [0.0; 7]);
    field.evaluate(&state, &[0.03], &mut varied);
    other.with_tyre(&[]).unwrap().evaluate(&state, &[], &mut fixed);
    for (varied, fixed) in varied.iter().zip(fixed) {
        assert_relative_eq!(*varied, fixed, max_relative = 1e-13);
    }
}
