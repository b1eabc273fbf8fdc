//! The equations of the wheel with a tyre against those set up a second way, in the ground frame, and the energy: in any motion, in the
//! uniform one and beside it.

use arclength::VectorField;
use arclength::integration::{Event, Integrator, from_fn};
use kingpin::tyre::TYRE_STATE_NAMES;
use kingpin::{Key, KingpinError, Tyre, Wheel};
use proptest::prelude::*;

use crate::tyres::wheel;

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
