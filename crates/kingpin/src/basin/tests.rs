//! Fates and margins against what is known of the limit cycles.

use super::*;
use arclength::control::Control;
use proptest::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// A point of the unstable cycle at v = 6 m/s.
const UNSTABLE_CYCLE: [f64; 5] =
    [0.006_788_672_435_187_8, -0.063_185_309_027_484_7, 0.513_078_505_728_634_6, 6.416_290_737_262_749, 6.0];

fn destinations(wheel: &Wheel, model: ContactModel, duration: f64) -> Destinations {
    Destinations::new(wheel, model, ClassificationSettings::with_duration(duration)).unwrap()
}

#[test]
fn the_two_sides_of_the_unstable_cycle() {
    // The segment from the unstable cycle to the uniform motion leads inwards.
    let wheel = Wheel::default().with(Key::V, 6.0).unwrap();
    let centre = wheel.uniform_motion().unwrap().state();
    let at = |part: f64| std::array::from_fn(|i| centre[i] + part * (UNSTABLE_CYCLE[i] - centre[i]));
    let fates = destinations(&wheel, ContactModel::Rolling, 60.0)
        .of(&[at(0.5), at(0.9), at(1.1), at(1.5)], &Control::none())
        .unwrap();
    assert_eq!(fates, [Fate::UniformMotion, Fate::UniformMotion, Fate::Tumbling, Fate::Tumbling]);
}

#[test]
fn followers_agree() {
    let wheel = Wheel::default();
    let initial: Vec<[f64; 5]> = [0.1, 0.4, 80.0]
        .into_iter()
        .zip(["psi", "psi", "Omega"])
        .map(|(amount, name)| wheel.perturbed_uniform_motion(&[(name, amount)]).unwrap())
        .collect();
    let ensemble = destinations(&wheel, ContactModel::Rolling, 20.0);
    let mut stepwise = ensemble.clone();
    stepwise.follower = Follower::Rolling;
    let sticky =
        wheel.with(Key::MuS, 100.0).unwrap().with(Key::MuD, 100.0).unwrap().with(Key::FAz, -1e5).unwrap();
    let sliding = destinations(&sticky, ContactModel::Sliding, 20.0);
    let expected = ensemble.of(&initial, &Control::none()).unwrap();
    assert_eq!(expected[0], Fate::UniformMotion);
    assert_eq!(expected[2], Fate::Tumbling);
    assert_eq!(stepwise.of(&initial, &Control::none()).unwrap(), expected);
    assert_eq!(sliding.of(&initial[..2], &Control::none()).unwrap(), expected[..2]);
}

#[test]
fn slow_motions_near_an_unstable_cycle_are_no_shimmy() {
    // Its range of psi is 0.383 rad at 5 s, 0.309 at 29 s, 0.102 at 60 s.
    let wheel = Wheel::default().with(Key::V, 8.0).unwrap();
    let [u, q, _, speed, _] = wheel.uniform_motion().unwrap().state();
    let slow = [u, q, -0.199, speed, -46.8];
    let mut of = destinations(&wheel, ContactModel::Rolling, 30.0);
    assert_eq!(of.of(&[slow], &Control::none()).unwrap(), [Fate::UniformMotion]);
    of.follower = Follower::Rolling;
    assert_eq!(of.of(&[slow], &Control::none()).unwrap(), [Fate::UniformMotion]);
}

#[test]
fn the_unstable_cycle_itself_is_no_shimmy() {
    // It repeats itself to nine digits for many periods, but a push sends it away.
    let wheel = Wheel::default().with(Key::V, 6.0).unwrap();
    let of = destinations(&wheel, ContactModel::Rolling, 2.0);
    assert_ne!(of.of(&[UNSTABLE_CYCLE], &Control::none()).unwrap(), [Fate::Shimmy]);
}

#[test]
fn straight_running_is_judged_by_the_lateral_motion() {
    // Without c_u the longitudinal motion that a kick leaves rings for ever, while psi decays: no shimmy.
    let wheel = Wheel::default().with(Key::Curvature, 0.0).unwrap();
    let settings = ClassificationSettings::for_wheel(&wheel).unwrap();
    let destinations = Destinations::new(&wheel, ContactModel::Rolling, settings).unwrap();
    for impulse in [0.19, 0.191, 0.3, 0.5] {
        let (_, state) = Disturbance::Impulse.apply(&wheel, ContactModel::Rolling, impulse).unwrap();
        assert_eq!(
            destinations.of_disturbed(&state, &Control::none()).unwrap(),
            Fate::UniformMotion,
            "{impulse} N s"
        );
    }
    // The longitudinal damper does not change how fast the lateral motion decays.
    let damped = wheel.with(Key::CU, 0.005).unwrap();
    assert_eq!(ClassificationSettings::for_wheel(&damped).unwrap(), settings);
}

#[test]
fn motions_that_take_too_many_steps_are_told_by_what_they_did() {
    // One of the kicks up to 1 N s tumbles so violently that a million steps do not take it to the end.
    for damping in [0.005, 0.01, 0.02] {
        let wheel = [(Key::Curvature, 0.0), (Key::CU, damping)]
            .into_iter()
            .try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value))
            .unwrap();
        let settings = ClassificationSettings::for_wheel(&wheel).unwrap();
        let kick = SafeKick::find(
            &wheel,
            ContactModel::Rolling,
            settings,
            Disturbance::Impulse,
            1.0,
            &Control::none(),
        )
        .unwrap();
        let fate = kick.and_then(|kick| kick.fate);
        assert!(matches!(fate, None | Some(Fate::Tumbling | Fate::Escape)), "{damping}: {fate:?}");
    }
    let wheel = Wheel::default();
    let mut hurried = destinations(&wheel, ContactModel::Rolling, 20.0);
    let Follower::Ensemble(ensemble) = &hurried.follower else { panic!("the wheel is isotropic") };
    hurried.follower = Follower::Ensemble(ensemble.clone().maximum_steps(1500));
    let start = |amount: f64| wheel.perturbed_uniform_motion(&[("Omega", amount)]).unwrap();
    assert_eq!(hurried.of(&[start(80.0)], &Control::none()).unwrap(), [Fate::Tumbling]);
}

#[test]
fn shimmy_with_sliding_phases_is_found() {
    // A short caster shimmies by itself; the friction bounds the amplitude.
    let wheel = [(Key::L, 0.03), (Key::V, 0.5), (Key::Curvature, 0.0), (Key::CU, 0.1), (Key::CQ, 0.1)]
        .into_iter()
        .try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value))
        .unwrap();
    let kicked = [0.05, 0.2].map(|angle| wheel.perturbed_uniform_motion(&[("psi", angle)]).unwrap());
    let fates = destinations(&wheel, ContactModel::Sliding, 10.0).of(&kicked, &Control::none()).unwrap();
    assert_eq!(fates, [Fate::Shimmy, Fate::Shimmy]);
    // Large shimmy with three swings in a period, beside a stable uniform motion; its largest multiplier is 0.23.
    let loaded = Wheel::default().with(Key::V, 8.4).unwrap().with(Key::FAz, -100.0).unwrap();
    let kicked = loaded.perturbed_uniform_motion(&[("psi", 1.2)]).unwrap();
    let fates = destinations(&loaded, ContactModel::Sliding, 15.0).of(&[kicked], &Control::none()).unwrap();
    assert_eq!(fates, [Fate::Shimmy]);
}

#[test]
fn acquaintance_with_shimmy_changes_no_fate() {
    // Large shimmy with three swings in a period beside a stable uniform motion, and one that everything ends in.
    let loaded = Wheel::default().with(Key::V, 8.4).unwrap().with(Key::FAz, -100.0).unwrap();
    let short = [(Key::L, 0.03), (Key::V, 0.5), (Key::Curvature, 0.0), (Key::CU, 0.1), (Key::CQ, 0.1)]
        .into_iter()
        .try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value))
        .unwrap();
    for (wheel, shimmies) in [(loaded, 1), (short, 5)] {
        let start = |angle: f64| wheel.perturbed_uniform_motion(&[("psi", angle)]).unwrap();
        let starts: Vec<[f64; 5]> = [-1.1, -0.3, 0.05, 0.4, 1.2].into_iter().map(start).collect();
        let stranger = destinations(&wheel, ContactModel::Sliding, 15.0);
        let [u, q, psi, speed, yaw] = start(1.2);
        let acquainted =
            stranger.clone().acquainted(&[[u, q, psi, speed, 0.0, yaw, speed]], &Control::none());
        let acquainted = acquainted.unwrap();
        assert_eq!(acquainted.attractors.len(), 1);
        let fates = stranger.of(&starts, &Control::none()).unwrap();
        assert_eq!(acquainted.of(&starts, &Control::none()).unwrap(), fates);
        assert_eq!(fates.iter().filter(|fate| **fate == Fate::Shimmy).count(), shimmies, "{fates:?}");
    }
}

#[test]
fn a_damped_kick_dies_out_and_a_wild_one_counts_as_escape() {
    // v = 2 m/s, straight, c = 0.2 N s/m: the caster turns round twice and comes to rest.
    let wheel = [(Key::V, 2.0), (Key::Curvature, 0.0), (Key::CU, 0.2), (Key::CQ, 0.2)]
        .into_iter()
        .try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value))
        .unwrap();
    let kicked = |rate| wheel.perturbed_uniform_motion(&[("Omega", rate)]).unwrap();
    let fates = destinations(&wheel, ContactModel::Rolling, 60.0)
        .of(&[kicked(120.0), kicked(1e5)], &Control::none())
        .unwrap();
    assert_eq!(fates, [Fate::UniformMotion, Fate::Escape]);
}

#[test]
fn tiles_can_be_stopped_and_resumed() {
    let wheel = Wheel::default();
    let destinations = destinations(&wheel, ContactModel::Rolling, 10.0);
    let axes = [Axis::new("psi", -0.5, 0.5).unwrap(), Axis::new("Omega", -60.0, 60.0).unwrap()];
    let map = BasinMap::grid(&destinations, &axes, [20, 13]).unwrap();
    let whole = map.run(&Control::none(), |_| false, |_| {}).unwrap();
    assert_eq!(whole.len(), 5);
    assert_eq!(whole.iter().map(|tile| tile.fates.len()).sum::<usize>(), 260);
    // Stop after the first tile, then do the rest.
    let stop = AtomicBool::new(false);
    let kept = Mutex::new(Vec::new());
    map.run(
        &Control::unobserved(&stop),
        |_| false,
        |tile| {
            kept.lock().unwrap().push(tile.clone());
            stop.store(true, Ordering::Relaxed);
        },
    )
    .unwrap();
    let mut kept = kept.into_inner().unwrap();
    assert!(!kept.is_empty() && kept.len() < 5);
    let done: Vec<usize> = kept.iter().map(|tile| tile.index).collect();
    kept.extend(map.run(&Control::none(), |index| done.contains(&index), |_| {}).unwrap());
    kept.sort_by_key(|tile| tile.index);
    assert_eq!(kept, whole);
}

#[test]
fn samples_are_reproducible_and_counted() {
    let wheel = Wheel::default();
    let destinations = destinations(&wheel, ContactModel::Rolling, 10.0);
    let axes = [Axis::new("psi", -1.0, 1.0).unwrap(), Axis::new("Omega", -60.0, 60.0).unwrap()];
    let map = BasinMap::samples(&destinations, &axes, 200, 7).unwrap();
    assert_eq!(
        map.initial_states(),
        BasinMap::samples(&destinations, &axes, 200, 7).unwrap().initial_states()
    );
    assert_ne!(
        map.initial_states(),
        BasinMap::samples(&destinations, &axes, 200, 8).unwrap().initial_states()
    );
    let tiles = map.run(&Control::none(), |_| false, |_| {}).unwrap();
    let fractions = Fraction::of(&tiles);
    assert_eq!(fractions.iter().map(|fraction| fraction.count).sum::<usize>(), 200);
    assert!(fractions.iter().all(|f| f.interval.0 <= f.share && f.share <= f.interval.1));
}

#[test]
fn wilson_interval_of_known_counts() {
    // Newcombe, Statistics in Medicine 17, 1998, table I, method 3.
    for ((count, total), (low, high)) in [
        ((81, 263), (0.2553, 0.3662)),
        ((15, 148), (0.0624, 0.1605)),
        ((0, 20), (0.0, 0.1611)),
        ((1, 29), (0.0061, 0.1718)),
    ] {
        let found = wilson_interval(count, total);
        assert!((found.0 - low).abs() < 5e-5 && (found.1 - high).abs() < 5e-5, "{found:?}");
    }
}

#[test]
fn wilson_interval_of_none_and_all_reaches_the_end_exactly() {
    for total in 1..400 {
        assert_eq!(wilson_interval(0, total).0, 0.0);
        assert_eq!(wilson_interval(total, total).1, 1.0);
    }
}

#[test]
fn smallest_kick_lies_between_return_and_failure() {
    let wheel = Wheel::default().with(Key::V, 6.0).unwrap();
    let settings = ClassificationSettings::for_wheel(&wheel).unwrap();
    let kick =
        SafeKick::find(&wheel, ContactModel::Rolling, settings, Disturbance::Impulse, 1.0, &Control::none())
            .unwrap()
            .unwrap();
    assert!(kick.returns < kick.fails && kick.fails - kick.returns < 2e-6);
    assert_eq!(kick.fate, Some(Fate::Tumbling));
    // The blow turns the caster by R I/J.
    let turned = kick.state[5] - wheel.uniform_motion().unwrap().state()[4];
    let inertia = 3.48e-6 + 2.38e-5 + 0.0668 * 0.068f64.powi(2);
    assert!((turned - 0.04 * kick.fails / inertia).abs() < 1e-9);
    // Near the edge the motion lingers for longer than 20 s: what looks like the edge then is none.
    let hasty = ClassificationSettings::with_duration(2.0);
    let hasty =
        SafeKick::find(&wheel, ContactModel::Rolling, hasty, Disturbance::Impulse, 1.0, &Control::none())
            .unwrap()
            .unwrap();
    assert_eq!(hasty.fate, Some(Fate::Undecided));
    let none = SafeKick::find(
        &wheel,
        ContactModel::Rolling,
        settings,
        Disturbance::ReleaseAngle,
        0.05,
        &Control::none(),
    )
    .unwrap();
    assert!(none.is_none());
    let bad =
        SafeKick::find(&wheel, ContactModel::Rolling, settings, Disturbance::Impulse, 0.0, &Control::none());
    assert!(bad.unwrap_err().to_string().contains("largest disturbance = 0"));
}

#[test]
fn rest_at_the_uniform_motion_is_return_unless_it_is_unstable() {
    // Straight ideal rolling is steady to the last bit: one step of the integration spans the whole duration.
    let straight = Wheel::default().with(Key::Curvature, 0.0).unwrap();
    for wheel in [Wheel::default(), straight] {
        let rest = wheel.uniform_motion().unwrap().state();
        assert_eq!(
            destinations(&wheel, ContactModel::Rolling, 30.0).of(&[rest], &Control::none()).unwrap(),
            [Fate::UniformMotion]
        );
    }
    let unstable = Wheel::default().with(Key::V, 9.0).unwrap();
    let near = unstable.perturbed_uniform_motion(&[("psi", 1e-3)]).unwrap();
    assert_ne!(
        destinations(&unstable, ContactModel::Rolling, 30.0).of(&[near], &Control::none()).unwrap(),
        [Fate::UniformMotion]
    );
}

#[test]
fn a_wheel_that_may_slide_needs_a_uniform_motion_that_rolls() {
    let settings = ClassificationSettings::default();
    let error = Destinations::new(&Wheel::default(), ContactModel::Sliding, settings).unwrap_err();
    assert!(matches!(error, SimulationError::UniformMotionSlides { needed, available }
        if (needed - 5.825_418_9).abs() < 1e-6 && (available - 4.107_447).abs() < 1e-6));
    // For ideal rolling there is one, and a decay time of 6.13 s asks for 74 s.
    let settings = ClassificationSettings::for_wheel(&Wheel::default()).unwrap();
    assert_eq!(settings.duration, 74.0);
}

#[test]
fn histories_begin_with_the_disturbance() {
    let wheel = Wheel::default().with(Key::Curvature, 0.0).unwrap().with(Key::CU, 0.1).unwrap();
    for model in [ContactModel::Rolling, ContactModel::Sliding] {
        let motion =
            Disturbance::ReleaseAngle.history(&wheel, model, 0.1, 0.5, 11, &Control::none()).unwrap();
        assert_eq!((motion.times.len(), motion.states.len()), (11, 11));
        assert_eq!(motion.states[0][2], 0.1);
    }
}

proptest! {
    #[test]
    fn wilson_interval_holds_the_share(count in 0usize..100, more in 1usize..100) {
        let total = count + more;
        let (low, high) = wilson_interval(count, total);
        let share = count as f64 / total as f64;
        prop_assert!(0.0 <= low && low <= share + 1e-15 && share <= high && high <= 1.0);
    }
}
