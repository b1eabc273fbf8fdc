//! `kingpin damper`: over circles and loads, and what it says.

use crate::Folder;
use crate::bad_input::fails;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Over circles the one decides that takes most; the front is enough on all of them.
#[test]
fn over_circles_and_loads() {
    let folder = Folder::new();
    let wheel = "damper --up-to v=3 -s l=0.04 --small-motions";
    let over = folder.json(&format!("{wheel} --radius 0.9:inf --load -200:-50"));
    assert_eq!(over["radius"]["end"], "inf");
    for key in ["c_q", "c_psi"] {
        let radii = [0.9, 1.5, 5.0, f64::INFINITY];
        let alone = radii.map(|radius| number(&folder.json(&format!("{wheel} -s r={radius}"))[key]));
        let largest = alone.into_iter().fold(0.0, f64::max);
        assert!(number(&over[key]) >= largest * (1.0 - 1e-9), "{key}: {over} {alone:?}");
        // At the decisive circle it takes just as much.
        let at = &over["corner"][format!("{key}_at")];
        let radius = at["r"].as_f64().map_or("inf".to_owned(), |radius| format!("{radius:e}"));
        let there = number(&folder.json(&format!("{wheel} -s r={radius}"))[key]);
        assert!((number(&over[key]) / there - 1.0).abs() < 1e-6, "{key}: {over} {there}");
        assert_eq!(at["v"], over["corner"][key]);
    }
    let several = folder.json(&format!("{wheel} --radius 0.9,inf"));
    assert!(number(&several["c_q"]) <= number(&over["c_q"]) * (1.0 + 1e-9));
    assert_eq!(several["radius"], serde_json::json!([0.9, "inf"]));
    // Straight as one of several, and as the only one.
    let straight = |options: &str| number(&folder.json(&format!("{wheel} {options}"))["c_q"]);
    let right = straight("-s r=inf");
    assert!((straight("--radius inf") / right - 1.0).abs() < 1e-12 && straight("--radius 200,inf") >= right);
    let table = folder.succeed(&format!("{wheel} --radius 0.9:inf")).output;
    let heading = "up to v = 3 m/s, r from 0.9 to inf m at l = 0.04 m";
    for part in [heading, "lateral damper alone", ", r = ", " decides"] {
        assert!(table.contains(part), "{part}: {table}");
    }
}

/// On circles the longitudinal motion of a wheel that nothing damps in that direction grows, and asks for other dampers.
#[test]
fn the_longitudinal_motion_decides_where_nothing_damps_it() {
    let folder = Folder::new();
    let wheel = "damper --up-to v=3 -s l=0.2 -s r=4 -s k=100 -s k_psi=0.01 --small-motions";
    let strict = folder.json(wheel);
    assert!(strict["c_psi"] != 0.0 && number(&strict["c_q"]) > 0.0, "{strict}");
    let with = &strict["with_longitudinal_damper"];
    assert_eq!([number(&with["c_q"]), number(&with["c_psi"])], [0.0; 2]);
    let damped = folder.json(&format!("{wheel} -s c_u={}", with["c_u"]));
    assert_eq!([number(&damped["c_q"]), number(&damped["c_psi"])], [0.0; 2]);
    assert!(damped.get("with_longitudinal_damper").is_none());
    let table = folder.succeed(wheel).output;
    assert!(table.contains("nothing damps it (c_u = 0)") && table.contains("no c_psi needed"), "{table}");
    // Straight ahead it does not count, and here it changes nothing.
    let wheel = "damper --up-to v=3 -s l=0.04 --small-motions";
    for circle in ["-s r=inf", "-s r=1"] {
        assert!(
            folder.json(&format!("{wheel} {circle}")).get("with_longitudinal_damper").is_none(),
            "{circle}"
        );
    }
}

#[test]
fn ranges_that_make_no_sense() {
    fails("damper --up-to v=3 --radius 0:1", 2, &["r = 0", "allowed"]);
    fails("damper --up-to v=3 --radius 2:2", 2, &["--radius", "empty interval"]);
    fails("damper --up-to v=3 --radius 1:x", 2, &["--radius", "x"]);
    fails("damper --up-to v=3 --load -50:inf", 2, &["F_Az", "inf"]);
}
