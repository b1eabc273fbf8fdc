//! Parameters: the example file, overriding, and bad input.

use kingpin::{Key, KingpinError, Wheel};

#[test]
fn the_example_file_is_the_default_wheel() {
    let text = include_str!("../../examples/wheel.toml");
    assert_eq!(Wheel::from_toml(text).unwrap(), Wheel::default());
    let written: Vec<&str> =
        text.lines().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key).collect();
    for (key, _) in Wheel::default().parameters() {
        let name = if matches!(key, Key::KU | Key::KQ) { "k" } else { key.name() };
        assert!(written.contains(&name), "{name}");
    }
}

#[test]
fn infinity_is_written_both_ways() {
    for text in ["r = inf", "r = \"inf\"", "curvature = 0", "r = +inf"] {
        assert_eq!(Wheel::from_toml(text).unwrap().get(Key::TurningRadius), f64::INFINITY, "{text}");
    }
    let lateral = Wheel::from_toml("k_u = inf\nk = 50").unwrap();
    assert_eq!((lateral.get(Key::KU), lateral.get(Key::KQ)), (f64::INFINITY, 50.0));
    assert_eq!(lateral.free_states(), ["q", "psi", "Omega"]);
    assert!(matches!(lateral.rolling(&[Key::V]), Err(KingpinError::LateralElasticityOnly)));
}

#[test]
fn what_is_given_twice_is_known() {
    for (text, stiffness, radius) in [
        ("k = 10\nk_u = 20", true, false),
        ("r = 3\ncurvature = 0.5", false, true),
        ("r = 3\nk = 10", false, false),
    ] {
        let wheel = Wheel::from_toml(text).unwrap();
        assert_eq!((wheel.stiffness_is_given_twice(), wheel.radius_is_given_twice()), (stiffness, radius));
        // What an analysis varies is not given.
        let varied = Wheel::from_toml("r = 3").unwrap().with(Key::Curvature, 0.5).unwrap();
        assert!(!varied.radius_is_given_twice());
    }
}

#[test]
fn bad_files_say_where_and_what_is_allowed() {
    for (text, message) in [
        (
            "v = 1\n  l_C = 2",
            "line 2, column 3: unknown key `l_C`; the nearest known key is `l_c` (distance from king pin to \
          C, negative where C lies ahead of the king pin, m)",
        ),
        (
            "v = 1\nl = -2",
            "line 2, column 5: l = -2: out of range; allowed: 1e-6 to 1000 m (caster length, from king \
          pin to wheel)",
        ),
        ("r = \"wide\"", "line 1, column 5: r = wide: not a number; allowed: 1e-3 to 1e12, or inf m"),
        ("r = nan", "line 1, column 5: r = nan: not a number; allowed: 1e-3 to 1e12, or inf m"),
        ("r = [1]", "line 1, column 5: r = [1]: not a number; allowed: 1e-3 to 1e12, or inf m"),
    ] {
        assert_eq!(Wheel::from_toml(text).unwrap_err().to_string(), message);
    }
    let broken = Wheel::from_toml("v = 1\nl = = 2").unwrap_err().to_string();
    assert!(broken.contains("line 2"), "{broken}");
    let missing = Wheel::read("no such file.toml").unwrap_err().to_string();
    assert!(missing.contains("no such file.toml"), "{missing}");
}

#[test]
fn every_parameter_refuses_what_is_not_allowed() {
    for key in Key::ALL {
        for bad in ["nan", "1e300", "-1e300", "-inf", "", "fast", "1,5", "4 m/s"] {
            let mut wheel = Wheel::default();
            let message = wheel.set(key.name(), bad).unwrap_err().to_string();
            assert!(message.contains(key.name()) && message.contains(key.unit()), "{message}");
            assert!(message.contains(&key.allowed().to_string()), "{message}");
            assert_eq!(wheel, Wheel::default());
        }
        let zero_and_negative = [key.allowed().contains(0.0), key.allowed().contains(-1.0)];
        let expected = match key {
            Key::FAz | Key::LC | Key::TP => [true, true],
            Key::V
            | Key::G
            | Key::MuS
            | Key::MuD
            | Key::CU
            | Key::CQ
            | Key::CPsi
            | Key::KPsi
            | Key::MF
            | Key::HalfContactLength
            | Key::Kappa
            | Key::Curvature => [true, false],
            _ => [false, false],
        };
        assert_eq!(zero_and_negative, expected, "{key}");
    }
    let typo = Wheel::default().set("mus", "1").unwrap_err().to_string();
    assert!(typo.contains("unknown key `mus`; the nearest known key is `mu_s`"), "{typo}");
}

#[test]
fn sections_of_a_file_are_refused_as_such() {
    for text in ["v = 1.5\n[wheel]\nl = 0.1\n", "wheel = { l = 0.1 }"] {
        let error = Wheel::from_toml(text).unwrap_err().to_string();
        assert!(error.starts_with("line ") && error.contains("[wheel]: there are no sections"), "{error}");
    }
}

#[test]
fn one_key_may_set_two() {
    let mut wheel = Wheel::default();
    wheel.set("k", "70").unwrap();
    assert_eq!((wheel.get(Key::KU), wheel.get(Key::KQ), wheel.get(Key::K)), (70.0, 70.0, 70.0));
    wheel.set("curvature", "0.5").unwrap();
    assert_eq!(wheel.get(Key::TurningRadius), 2.0);
    wheel.set("k_u", "7").unwrap();
    assert!(matches!(wheel.rolling(&[Key::K]), Err(KingpinError::AmbiguousStiffness { .. })));
    assert!(matches!(wheel.rolling(&[Key::K, Key::KU]), Err(KingpinError::DependentKeys { .. })));
    assert!(matches!(wheel.rolling(&[Key::V, Key::V]), Err(KingpinError::DependentKeys { .. })));
    wheel.set("r", "inf").unwrap();
    assert!(matches!(wheel.rolling(&[Key::TurningRadius]), Err(KingpinError::InfiniteRadius)));
    assert_eq!(wheel.rolling(&[Key::Curvature]).unwrap().parameters(), [0.0]);
}

#[test]
fn sliding_friction_stays_below_the_static_one_until_it_is_set() {
    let mut wheel = Wheel::default();
    assert_eq!(wheel.get(Key::MuD), 0.8);
    wheel.set("mu_s", "0.5").unwrap();
    assert_eq!(wheel.get(Key::MuD), 0.5);
    assert!(wheel.sliding().is_ok());
    wheel.set("mu_s", "2").unwrap();
    assert_eq!(wheel.get(Key::MuD), 0.8);
    wheel.set("mu_d", "0.7").unwrap();
    wheel.set("mu_s", "0.5").unwrap();
    assert_eq!(wheel.get(Key::MuD), 0.7);
    assert!(wheel.sliding().unwrap_err().to_string().contains("mu_d = 0.7"));
    assert_eq!(Wheel::from_toml("mu_s = 0.3").unwrap().get(Key::MuD), 0.3);
}
