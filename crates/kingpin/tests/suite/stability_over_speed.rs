//! Every change of stability over the speed, and narrow windows of it.

use arclength::control::Control;
use kingpin::{Key, StabilityOverSpeed, Wheel};

fn over_speed(toml: &str) -> StabilityOverSpeed {
    Wheel::from_toml(toml).unwrap().stability_over_speed(&Control::none()).unwrap()
}

fn stable_at(found: &StabilityOverSpeed, speed: f64) -> Option<bool> {
    found.parts.iter().find(|part| (part.from..part.to).contains(&speed)).unwrap().stable
}

#[test]
fn all_changes_are_found_and_not_only_the_first() {
    let toml = include_str!("../wheels/several_changes.toml");
    let found = over_speed(toml);
    for (change, expected) in found.changes.iter().zip([0.033_145_856, 0.059_279, 13.007, 13.636]) {
        assert!((change / expected - 1.0).abs() < 1e-4, "{:?}", found.changes);
    }
    assert!(found.changes.len() >= 4 && !found.is_complete, "{:?}", found.changes);
    for (speed, stable) in [(0.02, false), (0.045, true), (2.49, false), (13.3, true), (14.0, false)] {
        assert_eq!(stable_at(&found, speed), Some(stable), "{speed}: {:?}", found.parts);
    }
    let critical = Wheel::from_toml(toml).unwrap().critical_speed().unwrap();
    assert_eq!(found.changes[0], critical.speed);
}

/// It is stable between 7.2752 and 7.309 m/s only, less than the distance of the speeds that are scanned.
#[test]
fn narrow_windows_are_found_on_the_motion_that_is_followed() {
    let found = over_speed(include_str!("../wheels/narrow_window.toml"));
    assert!((found.changes[0] - 7.275_197).abs() < 1e-6, "{:?}", found.changes);
    assert_eq!(stable_at(&found, 7.2), Some(false));
    assert_eq!(stable_at(&found, 7.29), Some(true), "{:?}", found.parts);
}

/// The growth rate is 1.7e-9 1/s at 0.3 m/s and -1.9e-8 1/s at 0.5 m/s, at 1804 rad/s: both signs are certain, the place of the
/// change is not.
#[test]
fn a_change_that_is_not_located_is_undecided_between() {
    let found = over_speed(include_str!("../wheels/weak_change.toml"));
    for (speed, stable) in [(0.05, Some(false)), (0.3, Some(false)), (0.5, Some(true)), (26.0, Some(true))] {
        assert_eq!(stable_at(&found, speed), stable, "{speed}: {:?}", found.parts);
    }
    assert!(found.parts.windows(2).all(|pair| pair[0].to <= pair[1].from), "{:?}", found.parts);
    assert!((found.changes[0] - 170.085_77).abs() < 1e-4, "{:?}", found.changes);
}

/// In closed form there are no others: straight, the roots of a quadratic.
#[test]
fn closed_forms_are_complete() {
    let straight = Wheel::default().with(Key::TurningRadius, f64::INFINITY).unwrap();
    let found = straight.stability_over_speed(&Control::none()).unwrap();
    assert!(found.is_complete && found.changes.is_empty());
    let circle = Wheel::default().stability_over_speed(&Control::none()).unwrap();
    assert!(circle.is_complete && circle.not_followed.is_empty());
    assert_eq!(circle.changes, [Wheel::default().critical_speed().unwrap().speed]);
    assert_eq!(circle.parts.len(), 2, "{:?}", circle.parts);
}
