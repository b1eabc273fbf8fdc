//! Strong motions of wheels with a tyre and of ones with lateral elasticity only, with and without dry friction about the king pin: against
//! the equations set up in the ground frame with multipliers (SciPy, DOP853, tolerance 1e-10), closed forms of the rests, the
//! balance of impulses, and the limits in which they are other models of this crate.

use arclength::control::Control;
use kingpin::basin::{
    Axis, BasinMap, ClassificationSettings, ContactModel, Destinations, Disturbance, Fate, SafeKick,
};
use kingpin::{Key, Tyre, Wheel};

fn wheel(text: &str) -> Wheel {
    Wheel::from_toml(text).unwrap()
}

/// Of the size of the paper's wheel on stiffer springs.
const CASTER: &str =
    "l = 0.1\nv = 3.0\nsigma = 0.05\na = 0.03\nC_alpha = 500.0\nk = 2000.0\nc_u = 1.0\nc_q = 2.0\n";

fn fate(wheel: &Wheel, change: &[(&str, f64)]) -> Fate {
    let settings = ClassificationSettings::with_duration(5.0);
    let destinations = Destinations::new(wheel, ContactModel::Rolling, settings).unwrap();
    destinations.of_disturbed(&disturbed(wheel, change), &Control::none()).unwrap()
}

/// The seven states after a disturbance of the uniform motion.
fn disturbed(wheel: &Wheel, change: &[(&str, f64)]) -> [f64; 7] {
    let (_, mut state) = Disturbance::Impulse.apply(wheel, ContactModel::Rolling, 0.0).unwrap();
    for (name, amount) in change {
        let index = ["u", "q", "psi", "V1", "V2", "Omega", "y_t"].iter().position(|state| state == name);
        state[index.unwrap()] += amount;
    }
    state
}

#[test]
fn swings_and_rests_are_those_of_the_ground_frame() {
    let straight = wheel(&format!("{CASTER}tyre = \"linear\"\nr = inf\nM_f = 0.3"));
    let circle = wheel(&format!("{CASTER}tyre = \"brush\"\nr = 2.0\nM_f = 0.3\nkappa = 0.02\nF_Az = -20.0"));
    let cases = [
        (
            straight,
            [0.0, 0.0, 0.3, 3.0, 0.0, 0.0, 0.0],
            0.5,
            [
                -3.102515652859683e-04,
                -1.340918397362687e-03,
                5.322633326236903e-03,
                2.913793391872753,
                1.558802196510907e-02,
                0.0,
                -2.674135400034835e-04,
            ],
        ),
        (
            circle,
            [0.001, 0.002, 0.2, 3.0, 0.1, 1.0, 0.001],
            0.2,
            [
                1.489541898748408e-03,
                -9.493968828731987e-04,
                3.358252878203016e-02,
                2.948_226_128_349_98,
                -4.088527930262154e-02,
                1.5,
                3.958161819334946e-05,
            ],
        ),
    ];
    for (wheel, start, duration, expected) in cases {
        let history = wheel.simulate_with_tyre_from(&start, duration, 3, &Control::none()).unwrap();
        for (found, expected) in history.states[2].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{found} {expected}");
        }
        assert!(history.phases.len() > 2 && history.dry_friction_work > 0.0);
    }
}

#[test]
fn a_stop_is_that_of_the_ground_frame() {
    let straight = wheel(&format!("{CASTER}tyre = \"linear\"\nr = inf"));
    let start = [0.0, 0.0, 0.3, 3.0, 0.0, 0.0, 0.0];
    let history = straight.simulate_with_tyre_from(&start, 0.5, 3, &Control::none()).unwrap();
    assert!((history.stopped_at.unwrap() - 0.143_362_940_39).abs() < 1e-8, "{:?}", history.stopped_at);
    // So its fate is undecided, and said to be for that reason.
    assert_eq!(fate(&straight, &[("psi", 0.3)]), Fate::ModelEnds);
    assert!(Fate::ModelEnds.is_undecided());
}

#[test]
fn rests_are_those_of_the_balance_of_moments() {
    for tyre in [Tyre::Linear, Tyre::Brush] {
        let mut wheel = wheel(&format!("{CASTER}tyre = \"linear\"\nr = inf\nM_f = 0.3\nF_Az = -200.0"));
        wheel.set_tyre(tyre);
        let [low, high] = wheel.resting_angles().unwrap().unwrap();
        assert!((low + high).abs() < 1e-9);
        // The moment of the force and of its trail, from the formulas of the law.
        let (slip, limit) = (high.tan(), wheel.get(Key::MuS) * wheel.normal_force());
        let z = 500.0 * slip / (3.0 * limit);
        let [force, trail] = match tyre {
            Tyre::Brush => [1.0 - z + z * z / 3.0, (1.0 - z).powi(3)],
            _ => [1.0, 1.0],
        };
        let moment = 500.0 * slip * (0.1 * force + 0.01 * trail);
        assert!((moment - 0.3).abs() < 1e-9, "{tyre}: {moment}");
    }
    // The ground cannot turn a caster whose friction takes all that a sliding brush gives.
    let held = wheel(&format!("{CASTER}tyre = \"brush\"\nr = inf\nM_f = 5.0\nF_Az = -20.0"));
    assert!(held.resting_angles().unwrap().unwrap()[1] > 1.4);
    assert_eq!(Wheel::default().with(Key::MF, 1.0).unwrap().resting_angles().unwrap(), None);
}

#[test]
fn the_inside_of_the_interval_of_rests_is_safe() {
    // Unstable without friction.
    let unstable = |moment: f64| wheel(&format!("{CASTER}tyre = \"linear\"\nr = inf\nM_f = {moment:?}"));
    assert_eq!(unstable(0.0).uniform_motion().unwrap().is_stable(), Some(false));
    let held = unstable(0.3);
    let [_, high] = held.resting_angles().unwrap().unwrap();
    let destinations =
        Destinations::new(&held, ContactModel::Rolling, ClassificationSettings::with_duration(5.0)).unwrap();
    assert_eq!(destinations.attracts(), Some(true));
    for part in [-0.9, 0.5, 0.9] {
        assert_eq!(fate(&held, &[("psi", part * high)]), Fate::UniformMotion, "{part}");
    }
    // Small motions and small moments are to scale.
    let safe = |moment: f64| {
        let settings = ClassificationSettings::with_duration(5.0);
        let kind = Disturbance::Impulse;
        let largest = 2.0 * moment;
        SafeKick::find(&unstable(moment), ContactModel::Rolling, settings, kind, largest, &Control::none())
            .unwrap()
            .unwrap()
    };
    let [one, two] = [1e-3, 2e-3].map(safe);
    assert!(one.returns > 0.0 && one.fate != Some(Fate::UniformMotion), "{one:?}");
    assert!((two.returns / one.returns - 2.0).abs() < 0.01, "{one:?} {two:?}");
}

/// Beyond its Hopf point the nose gear on a brush swings to and fro, as far as its cycle does, whatever the disturbance.
#[test]
fn shimmy_of_a_brush_is_its_cycle() {
    let gear = wheel(
        "tyre = \"brush\"\nl = 0.1\nl_c = 0.05\nv = 25.0\nr = inf\nm_w = 1.0\nm_c = 1.0\nJ_wzeta = 0.9\nJ_Cz = 0.0875\nk = inf\n\
         k_psi = 1e5\nc_psi = 10.0\nF_Az = -8980.0\nsigma = 0.3\na = 0.1\nC_alpha = 180000.0\nt_p = 0.1\nkappa = 270.0",
    );
    assert_eq!(gear.uniform_motion().unwrap().is_stable(), Some(false));
    let settings = ClassificationSettings::with_duration(10.0);
    let destinations = Destinations::new(&gear, ContactModel::Rolling, settings).unwrap();
    let axes = [
        Axis::of_wheel(&gear, "psi", -0.2, 0.2).unwrap(),
        Axis::of_wheel(&gear, "y_t", -0.01, 0.01).unwrap(),
    ];
    assert!(Axis::of_wheel(&gear, "q", 0.0, 1.0).unwrap_err().to_string().contains("psi, Omega, y_t"));
    let map = BasinMap::grid(&destinations, &axes, [4, 2]).unwrap();
    let fates: Vec<Fate> = map
        .run(&Control::none(), |_| false, |_| {})
        .unwrap()
        .into_iter()
        .flat_map(|tile| tile.fates)
        .collect();
    assert_eq!(fates, [Fate::Shimmy; 8]);
}

/// The momenta that a blow gives, for every motion that the king pin allows: its impulse times the speed of the rim.
#[test]
fn a_blow_is_a_balance_of_impulses() {
    let blow = 0.7;
    for (k_u, k_q) in [("2000.0", "3000.0"), ("inf", "3000.0"), ("2000.0", "inf"), ("inf", "inf")] {
        for tyre in [Tyre::Linear, Tyre::Rigid] {
            if tyre == Tyre::Rigid && k_q == "inf" {
                continue;
            }
            let caster = CASTER.replace("v = 3.0", "v = 1.0").replace("k = 2000.0\n", "");
            let mut wheel = wheel(&format!("{caster}tyre = \"linear\"\nr = 0.5\nk_u = {k_u}\nk_q = {k_q}"));
            wheel.set_tyre(tyre);
            let get = |key: Key| wheel.get(key);
            let (sine, cosine) = wheel.uniform_motion().unwrap().psi().sin_cos();
            let [lateral, yaw] = wheel.velocity_change(blow, ContactModel::Rolling).unwrap();
            let l = get(Key::L);
            // Directions (V1, V2, Omega) and what they do to the king pin along x and y.
            let king_pin = |[v1, v2, o]: [f64; 3]| {
                [v1 * cosine + (v2 + l * o) * sine, (v2 + l * o) * cosine - v1 * sine]
            };
            let rigid = [k_u == "inf", k_q == "inf"];
            // The forward speed follows where the king pin does not give way along x, or else along y.
            let forward = match rigid {
                [true, _] => -(lateral + l * yaw) * sine / cosine,
                [false, true] => (lateral + l * yaw) * cosine / sine,
                _ => 0.0,
            };
            let change = [forward, lateral, yaw];
            for (moves, rigid) in king_pin(change).into_iter().zip(rigid) {
                assert!(!rigid || moves.abs() < 1e-12, "{k_u} {k_q} {moves}");
            }
            let mass = wheel.mass();
            let d = l - get(Key::LC);
            let static_moment = get(Key::MC) * d;
            let inertia = get(Key::JCz) + get(Key::JWzeta) + static_moment * d;
            let rolling = mass + get(Key::JWxi) / get(Key::WheelRadius).powi(2);
            let momentum = |[v1, v2, o]: [f64; 3]| {
                rolling * forward * v1
                    + mass * lateral * v2
                    + static_moment * (lateral * o + yaw * v2)
                    + inertia * yaw * o
            };
            let allowed = |direction: [f64; 3]| {
                let moves = king_pin(direction);
                let rolls = tyre == Tyre::Rigid && direction[1] != 0.0;
                !rolls && moves.into_iter().zip(rigid).all(|(moves, rigid)| !rigid || moves.abs() < 1e-12)
            };
            // All that keep a rigid king pin where it is.
            let mut tried = 0;
            for direction in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
                .into_iter()
                .chain([
                    [-l * sine / cosine, 0.0, 1.0],
                    [-sine / cosine, 1.0, 0.0],
                    [cosine / sine, 1.0, 0.0],
                ])
                .chain([[l * cosine / sine, 0.0, 1.0], [0.0, -l, 1.0]])
                .filter(|direction| allowed(*direction))
            {
                let [_, v2, o] = direction;
                let given = blow * (v2 + get(Key::WheelRadius) * o);
                let found = momentum(direction);
                assert!((found - given).abs() < 1e-12, "{k_u} {k_q} {tyre} {direction:?}: {found} {given}");
                tried += 1;
            }
            assert!(tried > 0);
        }
    }
}

#[test]
fn lateral_elasticity_only_is_a_stiff_longitudinal_spring() {
    let text = "l = 0.06\nr = 2.0\nv = 2.0\nM_f = 0.01\nc_q = 0.1\n";
    let rigid = wheel(&format!("{text}k_u = inf"));
    let [_, _, _, forward, _] = rigid.perturbed_uniform_motion(&[("psi", 0.3)]).unwrap();
    let mut errors = Vec::new();
    let expected = rigid.simulate(0.6, &[("psi", 0.3)], 2, &Control::none()).unwrap();
    for (stiffness, damping) in [(2e5, 600.0), (8e5, 1200.0)] {
        let stiff = wheel(&format!("{text}k_u = {stiffness:?}\nc_u = {damping:?}"));
        let mut start = stiff.perturbed_uniform_motion(&[("psi", 0.3)]).unwrap();
        start[3] = forward;
        let found = stiff.simulate_from(&start, 0.6, 2, &Control::none()).unwrap();
        let [one, two] = [&found, &expected].map(|history| history.states[1]);
        errors.push((one[2] - two[2]).abs() + (one[1] - two[1]).abs());
    }
    assert!(errors[1] < 1e-3 && errors[1] < 0.7 * errors[0], "{errors:?}");
    assert!(expected.phases.len() > 2);
}

/// Straight, with `c_q` at which straight running is stable at every speed, a large stable cycle lies beside an unstable one
/// (AUTO-07p: between folds at 0.047780593 and 14.0025055 m/s).
#[test]
fn with_lateral_elasticity_only_large_cycles_catch_strong_kicks() {
    let at = |v: f64| wheel(&format!("l = 0.04\nr = inf\nc_q = 0.1\nk_u = inf\nv = {v:?}"));
    let end = |v: f64, psi: f64| {
        let settings = ClassificationSettings::with_duration(30.0);
        let destinations = Destinations::new(&at(v), ContactModel::Rolling, settings).unwrap();
        destinations.of_disturbed(&disturbed(&at(v), &[("psi", psi)]), &Control::none()).unwrap()
    };
    assert_eq!(at(10.0).uniform_motion().unwrap().is_stable(), Some(true));
    assert_eq!(end(10.0, 0.02), Fate::UniformMotion);
    let fates = [0.6, 0.8, 1.0, 1.2].map(|psi| end(10.0, psi));
    assert!(fates.contains(&Fate::Shimmy), "{fates:?}");
    // Beyond the fold there is none.
    let fates = [0.6, 0.8, 1.0, 1.2].map(|psi| end(15.0, psi));
    assert!(!fates.contains(&Fate::Shimmy), "{fates:?}");
}
