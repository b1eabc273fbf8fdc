//! Where motions end with dry friction about the king pin.

use super::*;
use proptest::prelude::*;

/// The paper's wheel with a short caster towed straight: unstable at every speed without friction.
fn short_caster(moment: f64) -> Wheel {
    let values = [(Key::L, 0.04), (Key::Curvature, 0.0), (Key::V, 2.0), (Key::FAz, -20.0), (Key::MF, moment)];
    values.into_iter().try_fold(Wheel::default(), |wheel, (key, value)| wheel.with(key, value)).unwrap()
}

fn safe_blow(wheel: &Wheel, model: ContactModel, largest: f64) -> SafeKick {
    let settings = ClassificationSettings::with_duration(2.0);
    SafeKick::find(wheel, model, settings, Disturbance::Impulse, largest, &Control::none()).unwrap().unwrap()
}

#[test]
fn the_safe_blow_is_as_large_as_the_friction_allows() {
    assert_eq!(short_caster(0.0).uniform_motion().unwrap().is_stable(), Some(false));
    assert!(short_caster(0.0).swing_factor().unwrap().abs() < 1.0);
    for model in [ContactModel::Rolling, ContactModel::Sliding] {
        let without = safe_blow(&short_caster(0.0), model, 1e-3);
        assert_eq!((without.returns, without.fails), (0.0, 0.0));
        // Small motions and small moments are to scale.
        let [one, two] =
            [1e-4, 2e-4].map(|moment| safe_blow(&short_caster(moment), model, 1e-2 * moment / 1e-4));
        assert!(one.returns > 0.0, "{model:?} {one:?}");
        let ratio = two.returns / one.returns;
        assert!((ratio - 2.0).abs() < 0.01, "{model:?} {ratio}");
    }
}

#[test]
fn where_swings_grow_no_blow_is_safe_at_any_friction() {
    let critical = short_caster(1.0).critical_speed_with_friction().unwrap();
    let settings = ClassificationSettings::with_duration(2.0);
    for (part, returns) in [(0.99, true), (1.01, false)] {
        for moment in [1e-4, 1e-2, 1.0] {
            let wheel = short_caster(moment).with(Key::V, part * critical).unwrap();
            let destinations = Destinations::new(&wheel, ContactModel::Rolling, settings).unwrap();
            assert_eq!(destinations.attracts(), Some(returns));
            let start = wheel.perturbed_uniform_motion(&[("psi", 1e-6)]).unwrap();
            let fate = destinations.of(&[start], &Control::none()).unwrap()[0];
            assert_eq!(fate == Fate::UniformMotion, returns, "{part} {moment}: {fate:?}");
        }
        if !returns {
            let wheel = short_caster(1.0).with(Key::V, part * critical).unwrap();
            let edge = SafeKick::find(
                &wheel,
                ContactModel::Rolling,
                settings,
                Disturbance::ReleaseAngle,
                0.1,
                &Control::none(),
            );
            assert_eq!(edge.unwrap().unwrap().fails, 0.0);
        }
    }
}

#[test]
fn any_deflection_that_friction_holds_is_a_rest() {
    let wheel = short_caster(0.5);
    let [_, held] = wheel.resting_deflections().unwrap().unwrap();
    let destinations =
        Destinations::new(&wheel, ContactModel::Sliding, ClassificationSettings::default()).unwrap();
    let fate = |q: f64| {
        let start = wheel.perturbed_uniform_motion(&[("q", q)]).unwrap();
        destinations.of(&[start], &Control::none()).unwrap()[0]
    };
    // Far from the uniform motion, but at rest.
    assert!(held > 0.1);
    assert_eq!(fate(0.9 * held), Fate::UniformMotion);
    assert_eq!(fate(-0.9 * held), Fate::UniformMotion);
}

#[test]
fn on_a_circle_only_what_is_known_is_told() {
    let settings = ClassificationSettings::default();
    let stable = Wheel::default().with(Key::MF, 0.01).unwrap();
    let destinations = Destinations::new(&stable, ContactModel::Rolling, settings).unwrap();
    let start = stable.perturbed_uniform_motion(&[("psi", 0.3)]).unwrap();
    assert_eq!(destinations.of(&[start], &Control::none()).unwrap(), [Fate::UniformMotion]);
    let unstable = stable.with(Key::V, 9.0).unwrap();
    // Beyond the critical speed nobody knows what friction makes of small motions; large ones tumble all the same.
    let destinations = Destinations::new(&unstable, ContactModel::Rolling, settings).unwrap();
    assert_eq!(destinations.attracts(), None);
    let at = |psi: f64| unstable.perturbed_uniform_motion(&[("psi", psi)]).unwrap();
    let fates = destinations.of(&[at(1e-4), at(1.2)], &Control::none()).unwrap();
    assert_eq!(fates, [Fate::Undecided, Fate::Tumbling]);
    let control = Control::none();
    let kind = Disturbance::ReleaseAngle;
    let edge =
        SafeKick::find(&unstable, ContactModel::Rolling, settings, kind, 1.2, &control).unwrap().unwrap();
    assert!(edge.returns == 0.0 && edge.fails > 1e-4 && edge.fate == Some(Fate::Tumbling), "{edge:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// On a circle small motions that die out without friction die out with it, however much there is.
    #[test]
    fn friction_does_no_harm_on_a_circle(
        l in 0.05..0.12f64, part in 0.2..0.9f64, curvature in 0.3..1.5f64, moment in -5.0..0.0f64, psi in -0.15..0.15f64,
        yaw in -5.0..5.0f64, c_u in prop_oneof![Just(0.0), 0.0..0.5f64],
    ) {
        let wheel = Wheel::default()
            .with(Key::L, l)
            .and_then(|wheel| wheel.with(Key::Curvature, curvature))
            .and_then(|wheel| wheel.with(Key::MF, 10f64.powf(moment)))
            .and_then(|wheel| wheel.with(Key::CU, c_u))
            .unwrap();
        let critical = wheel.critical_speed().map_or(5.0, |critical| critical.speed);
        let wheel = wheel.with(Key::V, part * critical).unwrap();
        prop_assume!(wheel.uniform_motion().is_ok_and(|motion| motion.is_stable() == Some(true)));
        let settings = ClassificationSettings::for_wheel(&wheel).unwrap();
        let destinations = Destinations::new(&wheel, ContactModel::Rolling, settings).unwrap();
        let start = wheel.perturbed_uniform_motion(&[("psi", psi), ("Omega", yaw)]).unwrap();
        let fate = destinations.of(&[start], &Control::none()).unwrap()[0];
        prop_assert_eq!(fate, Fate::UniformMotion);
    }
}
