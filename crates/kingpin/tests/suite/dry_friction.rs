//! Dry friction about the king pin against a second formulation of the wheel, and against what must hold of any friction.
//!
//! The second formulation knows no caster frame: masses in the ground frame, generalised coordinates of king pin, heading and
//! wheel rotation, constraints with Lagrange multipliers, classical Runge-Kutta steps, and modes that change where a step shows that
//! they must.

use arclength::control::Control;
use kingpin::shimmy::SlidingMotionSearch;
use kingpin::sliding::{Contact, KingPin, SlidingHistory};
use kingpin::{Key, Wheel};
use proptest::prelude::*;

/// Position of the king pin in the ground frame, heading of the caster and rotation of the wheel, with their rates.
type GroundState = [f64; 8];

/// What holds at present, as in the second formulation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Modes {
    rolls: bool,
    sticks: bool,
    /// Sign of the rate of the caster angle while it swings.
    sense: f64,
}

struct Ground<'a> {
    wheel: &'a Wheel,
}

impl Ground<'_> {
    fn get(&self, key: Key) -> f64 {
        self.wheel.get(key)
    }

    /// Towing point, its velocity and the direction of towing, at a time: straight along x, or round the origin of a circle.
    fn towing(&self, time: f64) -> ([f64; 2], [f64; 2], f64) {
        let (v, omega) = (self.get(Key::V), self.wheel.towing_yaw_rate());
        let heading = omega * time;
        if omega == 0.0 {
            ([v * time, 0.0], [v, 0.0], 0.0)
        } else {
            let r = v / omega;
            ([r * heading.sin(), r * (1.0 - heading.cos())], [v * heading.cos(), v * heading.sin()], heading)
        }
    }

    /// Accelerations, ground force (x, y) and moment about the king pin that the constraints take.
    fn solve(&self, time: f64, state: &GroundState, modes: Modes) -> ([f64; 4], [f64; 2], f64) {
        let [x, y, theta, _, xd, yd, turn, _] = *state;
        let (m_w, m_c) = (self.get(Key::MW), self.get(Key::MC));
        let (l, l_c, radius) = (self.get(Key::L), self.get(Key::LC), self.get(Key::WheelRadius));
        let (sine, cosine) = theta.sin_cos();
        // Wheel at A - l e, centre of gravity at A - l_c e, with e along the caster.
        let mut mass = [[0.0; 4]; 4];
        let mut force = [0.0; 4];
        for (m, arm) in [(m_w, l), (m_c, l_c)] {
            mass[0][0] += m;
            mass[1][1] += m;
            mass[0][2] += m * arm * sine;
            mass[1][2] -= m * arm * cosine;
            mass[2][2] += m * arm * arm;
            // Centripetal acceleration + arm turn^2 e.
            force[0] -= m * arm * turn * turn * cosine;
            force[1] -= m * arm * turn * turn * sine;
        }
        mass[2][0] = mass[0][2];
        mass[2][1] = mass[1][2];
        mass[2][2] += self.get(Key::JCz) + self.get(Key::JWzeta);
        mass[3][3] = self.get(Key::JWxi);
        let (point, velocity, heading) = self.towing(time);
        let omega = self.wheel.towing_yaw_rate();
        // Springs and dampers act in the towing frame.
        let (s, c) = heading.sin_cos();
        let (dx, dy) = (x - point[0], y - point[1]);
        let (u, q) = (c * dx + s * dy, c * dy - s * dx);
        let (rx, ry) = (xd - velocity[0], yd - velocity[1]);
        let (ud, qd) = (c * rx + s * ry + omega * q, c * ry - s * rx - omega * u);
        let along = -self.get(Key::KU) * u - self.get(Key::CU) * ud;
        let across = -self.get(Key::KQ) * q - self.get(Key::CQ) * qd;
        force[0] += c * along - s * across;
        force[1] += s * along + c * across;
        // psi = heading - theta.
        let (psi, rate) = (heading - theta, omega - turn);
        force[2] += self.get(Key::KPsi) * psi + self.get(Key::CPsi) * rate;
        if !modes.sticks {
            force[2] += self.get(Key::MF) * modes.sense;
        }
        // Contact velocity: along the caster xd c + yd s - spin R (forward rolling spins positively), across -xd s + yd c - l turn.
        let rows = [[cosine, sine, 0.0, -radius], [-sine, cosine, -l, 0.0]];
        let slip = self.slip(state);
        let speed = slip[0].hypot(slip[1]);
        if !modes.rolls {
            let pull = self.get(Key::MuD) * self.wheel.normal_force() / speed;
            for (row, slip) in rows.iter().zip(slip) {
                for (force, entry) in force.iter_mut().zip(row) {
                    *force -= pull * slip * entry;
                }
            }
        }
        // Rates of the rows times the velocities, for the constraints on accelerations.
        let drift = [turn * (-sine * xd + cosine * yd), turn * (-cosine * xd - sine * yd)];
        let mut constraints: Vec<([f64; 4], f64)> = Vec::new();
        if modes.rolls {
            constraints.extend(rows.into_iter().zip(drift.map(|drift| -drift)));
        }
        if modes.sticks {
            constraints.push(([0.0, 0.0, 1.0, 0.0], 0.0));
        }
        let size = 4 + constraints.len();
        let mut matrix = vec![vec![0.0; size + 1]; size];
        for row in 0..4 {
            matrix[row][..4].copy_from_slice(&mass[row]);
            matrix[row][size] = force[row];
        }
        for (index, (row, value)) in constraints.iter().enumerate() {
            for column in 0..4 {
                matrix[4 + index][column] = row[column];
                matrix[column][4 + index] = -row[column];
            }
            matrix[4 + index][size] = *value;
        }
        let solution = eliminate(matrix);
        let multipliers = &solution[4..];
        let ground = if modes.rolls {
            [multipliers[0], multipliers[1]]
        } else {
            let pull = self.get(Key::MuD) * self.wheel.normal_force() / speed;
            slip.map(|slip| -pull * slip)
        };
        let moment = if modes.sticks { multipliers[multipliers.len() - 1] } else { 0.0 };
        ([solution[0], solution[1], solution[2], solution[3]], ground, moment)
    }

    /// Slip velocity along and across the caster.
    fn slip(&self, state: &GroundState) -> [f64; 2] {
        let [_, _, theta, _, xd, yd, turn, spin] = *state;
        let (sine, cosine) = theta.sin_cos();
        [
            cosine * xd + sine * yd - self.get(Key::WheelRadius) * spin,
            cosine * yd - sine * xd - self.get(Key::L) * turn,
        ]
    }

    fn step(&self, time: f64, state: &GroundState, modes: Modes, step: f64) -> GroundState {
        let slope = |time: f64, state: &GroundState| -> GroundState {
            let (acceleration, ..) = self.solve(time, state, modes);
            std::array::from_fn(|i| if i < 4 { state[4 + i] } else { acceleration[i - 4] })
        };
        let add = |slope: &GroundState, step: f64| std::array::from_fn(|i| state[i] + step * slope[i]);
        let a = slope(time, state);
        let b = slope(time + 0.5 * step, &add(&a, 0.5 * step));
        let c = slope(time + 0.5 * step, &add(&b, 0.5 * step));
        let d = slope(time + step, &add(&c, step));
        std::array::from_fn(|i| state[i] + step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
    }

    /// The motion from the states `(u, q, psi, V1, V2, Omega, W)` over a duration, and the same states at its end.
    fn run(&self, initial: &[f64; 7], duration: f64, steps: usize) -> [f64; 7] {
        let [u, q, psi, forward, lateral, yaw, rim] = *initial;
        let (l, radius) = (self.get(Key::L), self.get(Key::WheelRadius));
        let theta = -psi;
        let (sine, cosine) = theta.sin_cos();
        let across = lateral + l * yaw;
        let mut state: GroundState = [
            u,
            q,
            theta,
            0.0,
            forward * cosine - across * sine,
            forward * sine + across * cosine,
            yaw,
            rim / radius,
        ];
        let omega = self.wheel.towing_yaw_rate();
        let limit = self.get(Key::MF);
        let static_limit = self.get(Key::MuS) * self.wheel.normal_force();
        let step = duration / steps as f64;
        let sense = |state: &GroundState| f64::signum(omega - state[6]);
        let slip = self.slip(&state);
        let mut modes = Modes { rolls: slip[0].hypot(slip[1]) < 1e-12, sticks: false, sense: sense(&state) };
        if state[6] == omega {
            modes.sticks = true;
        }
        for index in 0..steps {
            let time = index as f64 * step;
            // Modes that the forces do not allow end.
            for _ in 0..4 {
                let (_, ground, moment) = self.solve(time, &state, modes);
                if modes.rolls && ground[0].hypot(ground[1]) > static_limit {
                    modes.rolls = false;
                    // Slip begins against the force that held, with as much of it as steps resolve: the smaller it is, the faster its
                    // direction turns.
                    let trace = 1e3 * step / ground[0].hypot(ground[1]);
                    let (sine, cosine) = state[2].sin_cos();
                    state[7] += trace * ground[0] / radius;
                    state[4] += trace * ground[1] * sine;
                    state[5] -= trace * ground[1] * cosine;
                } else if modes.sticks && moment.abs() > limit {
                    modes.sticks = false;
                    modes.sense = moment.signum();
                } else {
                    break;
                }
            }
            let before = self.slip(&state);
            let mut next = self.step(time, &state, modes, step);
            let after = self.slip(&next);
            if !modes.sticks && (omega - next[6]) * modes.sense < 0.0 {
                // Stands still about the king pin: sticks, or swings back, as the moment then says.
                next[6] = omega;
                let held = Modes { sticks: true, ..modes };
                let (_, _, moment) = self.solve(time + step, &next, held);
                if moment.abs() <= limit {
                    modes.sticks = true;
                } else {
                    modes.sense = moment.signum();
                }
            }
            let change = (after[0] - before[0]).hypot(after[1] - before[1]);
            let reversed = before[0] * after[0] + before[1] * after[1] < 0.0;
            let shrinks = after[0].hypot(after[1]) < before[0].hypot(before[1]);
            if !modes.rolls && (reversed || shrinks && after[0].hypot(after[1]) < change) {
                // Slip ends within a step: the static friction holds the wheel where it can.
                let (_, ground, _) = self.solve(time + step, &next, Modes { rolls: true, ..modes });
                if ground[0].hypot(ground[1]) <= static_limit {
                    modes.rolls = true;
                    let (sine, cosine) = next[2].sin_cos();
                    next[7] += after[0] / radius;
                    next[4] += after[1] * sine;
                    next[5] -= after[1] * cosine;
                }
            }
            state = next;
        }
        let (point, _, heading) = self.towing(duration);
        let (s, c) = heading.sin_cos();
        let (dx, dy) = (state[0] - point[0], state[1] - point[1]);
        let slip = self.slip(&state);
        let (sine, cosine) = state[2].sin_cos();
        [
            c * dx + s * dy,
            c * dy - s * dx,
            heading - state[2],
            cosine * state[4] + sine * state[5],
            slip[1],
            state[6],
            radius * state[7],
        ]
    }
}

/// Solves linear equations given with their right-hand sides, by elimination with pivots.
fn eliminate(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let size = matrix.len();
    for column in 0..size {
        let pivot = (column..size)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))
            .unwrap();
        matrix.swap(column, pivot);
        let row = matrix[column].clone();
        for other in matrix.iter_mut().skip(column + 1) {
            let factor = other[column] / row[column];
            for (entry, pivot) in other.iter_mut().zip(&row) {
                *entry -= factor * pivot;
            }
        }
    }
    let mut solution = vec![0.0; size];
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|column| matrix[row][column] * solution[column]).sum();
        solution[row] = (matrix[row][size] - known) / matrix[row][row];
    }
    solution
}

fn real_wheel(name: &str) -> Wheel {
    Wheel::read(format!("{}/examples/wheels/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn with(wheel: Wheel, changes: &[(Key, f64)]) -> Wheel {
    changes.iter().try_fold(wheel, |wheel, &(key, value)| wheel.with(key, value)).unwrap()
}

fn history(wheel: &Wheel, perturbations: &[(&str, f64)], duration: f64, samples: usize) -> SlidingHistory {
    let start = wheel.perturbed_sliding_motion(perturbations).unwrap();
    wheel.sliding().unwrap().simulate_from(&start, duration, samples, &Control::none()).unwrap()
}

/// Number of the four modes that a motion visits.
fn modes_visited(history: &SlidingHistory) -> usize {
    let mut seen: Vec<(Contact, KingPin)> = Vec::new();
    for phase in &history.phases {
        if !seen.contains(&(phase.contact, phase.king_pin)) {
            seen.push((phase.contact, phase.king_pin));
        }
    }
    seen.len()
}

#[test]
fn motions_are_those_of_the_second_formulation() {
    let paper = Wheel::default();
    let circle = [(Key::V, 3.0), (Key::FAz, -20.0), (Key::MF, 0.3), (Key::CU, 0.1), (Key::KPsi, 0.2)];
    let straight =
        [(Key::Curvature, 0.0), (Key::V, 2.0), (Key::FAz, -10.0), (Key::MF, 0.05), (Key::KU, 150.0)];
    let mut visited = 0;
    for (wheel, kick, duration) in [
        (with(paper, &straight), &[("psi", 0.4)][..], 0.5),
        (with(paper, &straight), &[("Omega", 45.0)], 0.4),
        (with(paper, &circle), &[("psi", 0.5)], 0.4),
        (with(real_wheel("office"), &[(Key::MF, 0.4)]), &[("psi", 0.3)], 0.1),
        (with(real_wheel("trolley"), &[(Key::MF, 2.0)]), &[("Omega", 30.0)], 0.2),
        (with(real_wheel("trolley"), &[(Key::MF, 5.0)]), &[("psi", 0.5), ("Omega", 30.0)], 0.3),
        (with(real_wheel("wheelchair"), &[(Key::MF, 3.0)]), &[("psi", 0.5)], 0.3),
        (with(real_wheel("dolly"), &[(Key::MF, 60.0)]), &[("psi", 0.3)], 0.2),
        (with(real_wheel("nosegear"), &[(Key::MF, 20.0)]), &[("psi", 0.2)], 0.1),
    ] {
        let found = history(&wheel, kick, duration, 2);
        visited = visited.max(modes_visited(&found));
        let start = wheel.perturbed_sliding_motion(kick).unwrap();
        let errors = [25_000, 200_000].map(|steps| {
            let other = Ground { wheel: &wheel }.run(&start, duration, steps);
            let reach = wheel.get(Key::V).max(1.0);
            found.states[1]
                .iter()
                .zip(other)
                .zip([1.0, 1.0, 1.0, reach, reach, reach / wheel.get(Key::L), reach])
                .map(|((a, b), scale)| (a - b).abs() / scale)
                .fold(0.0, f64::max)
        });
        assert!(errors[1] < 1e-3, "{wheel:?} {kick:?}: {errors:?} {:?}", found.phases);
        // Modes change within steps: of first order.
        assert!(errors[1] < 0.6 * errors[0], "{wheel:?} {kick:?}: {errors:?}");
    }
    assert_eq!(visited, 4);
}

fn check_energy(wheel: &Wheel, kick: &[(&str, f64)], duration: f64) -> Result<usize, TestCaseError> {
    let count = 20_000;
    let history = history(wheel, kick, duration, count + 1);
    let mut work = 0.0;
    let mut turnover = 0.0;
    let mut swung = 0.0;
    for (index, (towing, dissipated)) in
        history.towing_power.iter().zip(&history.dissipated_power).enumerate()
    {
        let weight = if index == 0 || index == count { 0.5 } else { 1.0 };
        prop_assert!(*dissipated >= -1e-9 * (1.0 + towing.abs()), "{dissipated}");
        work += weight * duration / count as f64 * (towing - dissipated);
        let rate = wheel.towing_yaw_rate() - history.states[index][5];
        swung += weight * duration / count as f64 * history.friction_moment[index] * rate;
        turnover += duration / count as f64 * (towing.abs() + dissipated);
    }
    prop_assert!((swung - history.dry_friction_work).abs() < 5e-3 * turnover.max(1e-9), "{swung}");
    for moment in &history.friction_moment {
        prop_assert!(moment.abs() <= wheel.get(Key::MF) * (1.0 + 1e-9), "{moment}");
    }
    prop_assert!(
        (work - history.energy_gained).abs() < 5e-3 * turnover.max(1e-9),
        "{work} {}",
        history.energy_gained
    );
    Ok(modes_visited(&history))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Friction never gives energy, what it takes is what is missing, and its moment keeps its limit.
    #[test]
    fn energy_never_grows_by_friction(
        name in prop::sample::select(vec!["paper", "office", "trolley", "wheelchair", "dolly", "nosegear"]),
        length in 0.5..2.0f64, speed in 0.2..2.0f64, turn in prop_oneof![Just(0.0), 0.01..0.1f64],
        friction in -4.0..0.3f64, psi in -1.2..1.2f64, yaw in -10.0..10.0f64,
        c_u in prop_oneof![Just(0.0), 0.0..0.1f64], c_q in prop_oneof![Just(0.0), 0.0..0.1f64], k_psi in prop_oneof![Just(0.0), 0.0..1.0f64],
    ) {
        let wheel = match name {
            "paper" => with(Wheel::default(), &[(Key::FAz, -20.0)]),
            name => real_wheel(name),
        };
        let get = |key: Key| wheel.get(key);
        let mass = get(Key::MW) + get(Key::MC);
        let (damper, length) = ((get(Key::KQ) * mass).sqrt(), length * get(Key::L));
        let ground = get(Key::MuS) * wheel.normal_force() * length;
        let period = 6.0 * (mass / get(Key::KQ)).sqrt();
        let rate = (get(Key::KQ) / mass).sqrt();
        let wheel = with(wheel, &[
            (Key::L, length), (Key::V, speed * get(Key::V)), (Key::Curvature, turn / length),
            (Key::MF, 10f64.powf(friction) * ground), (Key::CU, c_u * damper), (Key::CQ, c_q * damper),
            (Key::KPsi, k_psi * ground),
        ]);
        prop_assume!(wheel.uniform_motion().is_ok());
        check_energy(&wheel, &[("psi", psi), ("Omega", 0.2 * yaw * rate)], 10.0 * period)?;
    }
}

/// Shimmy with sliding and dry friction about the king pin, found by shooting, comes back to its start.
#[test]
fn shimmy_returns_in_the_second_formulation() {
    let short = with(
        Wheel::default(),
        &[(Key::L, 0.03), (Key::V, 0.5), (Key::Curvature, 0.0), (Key::CU, 0.1), (Key::CQ, 0.1)],
    );
    let wheel = with(short, &[(Key::MF, 5e-4)]);
    let start = wheel.perturbed_uniform_motion(&[("psi", 1.0)]).unwrap();
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    let motion = wheel.sliding_motion(&start, &search, &Control::none()).unwrap();
    assert!(motion.forces(&Control::none()).unwrap().dry_friction_power > 0.0);
    let state = motion.state();
    let sizes = [0.01, 0.01, 1.0, 0.5, 0.5, 0.5 / 0.03, 0.5];
    let ground = Ground { wheel: &wheel };
    // Its error is of first order in the step: what is left of it falls to a quarter, and goes by extrapolation.
    let ends = [20_000, 80_000].map(|steps| ground.run(&state, motion.period, steps));
    let extrapolated: Vec<f64> = (0..7).map(|i| ends[1][i] + (ends[1][i] - ends[0][i]) / 3.0).collect();
    let error = |end: &[f64]| (0..7).map(|i| ((end[i] - state[i]) / sizes[i]).abs()).fold(0.0, f64::max);
    let errors = [error(&ends[0]), error(&ends[1]), error(&extrapolated)];
    assert!((3.5..4.5).contains(&(errors[0] / errors[1])) && errors[2] < 1e-3, "{errors:?}");
}
