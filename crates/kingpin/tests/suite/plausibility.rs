//! What no built wheel has is told, and units that may be meant.

use kingpin::{Key, Wheel};

fn told(changes: &[(Key, f64)], varying: &[Key]) -> Vec<(Key, Option<(&'static str, f64)>)> {
    let wheel =
        changes.iter().fold(Wheel::default(), |wheel, (key, value)| wheel.with(*key, *value).unwrap());
    wheel.implausible(varying).into_iter().map(|told| (told.key, told.meant)).collect()
}

#[test]
fn other_units_are_recognised() {
    for (key, value, unit) in [
        (Key::L, 80.0, "mm"),
        (Key::WheelRadius, 40.0, "mm"),
        (Key::LC, -12.0, "mm"),
        (Key::MW, 351.9, "g"),
        (Key::MC, 66.8, "g"),
        (Key::JWxi, 46.3, "kg mm^2"),
        (Key::JWxi, 0.463, "kg cm^2"),
        (Key::JWxi, 46300.0, "g mm^2"),
        (Key::V, 4000.0, "mm/s"),
        (Key::G, 981.0, "cm/s^2"),
    ] {
        let told = told(&[(key, value)], &[]);
        let [(found, Some((in_unit, meant)))] = told[..] else { panic!("{key} = {value}: {told:?}") };
        assert_eq!((found, in_unit), (key, unit), "{value}");
        let own = Wheel::default().get(key);
        assert!((meant.abs() / own - 1.0).abs() < 1e-12 || key == Key::LC, "{key} = {value}: {meant}");
        assert!(Wheel::default().with(key, value).unwrap().implausible(&[key]).is_empty(), "{key} varies");
    }
}

#[test]
fn a_thin_rim_and_a_thin_disc_are_plausible_and_what_is_beyond_is_not() {
    let rim = 0.3519 * 0.04 * 0.04;
    for (spin, about_diameter, expected) in [
        (rim, 0.5 * rim, vec![]),
        (0.5 * rim, 0.25 * rim, vec![]),
        (1.1 * rim, rim, vec![Key::JWxi]),
        (0.5 * rim, 0.2 * rim, vec![Key::JWzeta]),
    ] {
        let told = told(&[(Key::JWxi, spin), (Key::JWzeta, about_diameter)], &[]);
        assert_eq!(told.iter().map(|(key, _)| *key).collect::<Vec<_>>(), expected, "{spin} {about_diameter}");
    }
}

#[test]
fn what_follows_is_told_once() {
    // In millimetres and grams all of it.
    let all = [(Key::WheelRadius, 40.0), (Key::L, 80.0), (Key::LC, 12.0), (Key::MW, 351.9), (Key::MC, 66.8)];
    assert_eq!(told(&all, &[]), [(Key::WheelRadius, Some(("mm", 0.04)))]);
}

#[test]
fn the_wheels_of_the_examples_are_plausible() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    for file in [
        "wheel",
        "nose_gear",
        "wheels/dolly",
        "wheels/nosegear",
        "wheels/office",
        "wheels/trolley",
        "wheels/wheelchair",
    ] {
        let wheel = Wheel::read(format!("{folder}/{file}.toml")).unwrap();
        assert_eq!(wheel.implausible(&[]), [], "{file}");
    }
}
