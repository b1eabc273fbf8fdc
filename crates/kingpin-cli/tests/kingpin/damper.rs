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

/// With a tyre a damper about the king pin alone has to be the stronger the slower the wheel: that the slowest speed decides is told, and
/// the front, which falls steeply from there, has more points.
#[test]
fn where_the_lowest_speed_decides_that_is_told() {
    let folder = Folder::new();
    let wheel = "damper --up-to v=3 --small-motions -s l=0.04 -s m_w=0.35 -s m_c=0.45 -s J_wxi=7e-4 -s J_wzeta=4.5e-4 -s J_Cz=4e-4 \
                 -s R=0.0625 -s l_c=0.012 -s k=3e4 -s F_Az=-150 -s mu_s=0.7 -s mu_d=0.6 -s r=inf";
    let tyre = format!("{wheel} -s tyre=brush -s sigma=0.03 -s a=0.01 -s C_alpha=1500");
    let table = folder.succeed(&tyre).output;
    let told = "v = 0.003 m/s decides, the lowest speed that was looked at: lower ones may take more";
    assert!(table.contains(told), "{table}");
    let result = folder.json(&tyre);
    let front =
        |key: &str| -> Vec<f64> { result["front"][key].as_array().unwrap().iter().map(number).collect() };
    let [lateral, rotational] = ["c_q", "c_psi"].map(front);
    assert!(lateral.len() > 9 && lateral.is_sorted(), "{lateral:?}");
    assert!(rotational.windows(2).all(|pair| pair[0] >= pair[1]), "{rotational:?}");
    // Straight lines between the points are right to a tenth or so: at one between the first two evenly spaced ones.
    let at = 0.06 * number(&result["c_q"]);
    let after = lateral.iter().position(|c_q| *c_q > at).unwrap();
    let part = (at - lateral[after - 1]) / (lateral[after] - lateral[after - 1]);
    let drawn = rotational[after - 1] + part * (rotational[after] - rotational[after - 1]);
    let beside = folder.json(&format!(
        "stability -s v=3 -s c_q={at} -s c_psi={} {}",
        1.3 * drawn,
        tyre.split_once("small-motions").unwrap().1
    ));
    assert_eq!(beside["stable"], true, "{at} {drawn}: {beside}");
    let beside = folder.json(&format!(
        "stability -s v=3 -s c_q={at} -s c_psi={} {}",
        0.7 * drawn,
        tyre.split_once("small-motions").unwrap().1
    ));
    assert_eq!(beside["stable"], false, "{at} {drawn}: {beside}");
    // Without a tyre there is nothing to tell.
    let table = folder.succeed(wheel).output;
    assert!(!table.contains("lowest speed"), "{table}");
    assert_eq!(folder.json(wheel)["front"]["c_q"].as_array().unwrap().len(), 9);
}

/// Up to which speed dry friction makes small motions die out depends on the dampers: which are meant is told.
#[test]
fn dry_friction_is_told_with_the_dampers_that_are_meant() {
    let folder = Folder::new();
    let wheel = "-s l=0.04 -s r=inf -s M_f=0.01";
    let speed = |dampers: &str| {
        let stability = folder.json(&format!("stability {wheel} {dampers}"));
        format!("{:.4}", number(&stability["critical_speed_with_friction"]))
    };
    let damped = "-s c_psi=1e-4";
    let table = folder.succeed(&format!("damper --up-to v=3 --small-motions {wheel} {damped}")).output;
    for (words, dampers) in
        [("none of these dampers small", ""), ("the wheel's own, c_psi = 1e-4 N m s/rad, small", damped)]
    {
        let line = table.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{table}"));
        let told: f64 = line.rsplit(' ').nth(1).unwrap().parse().unwrap();
        assert_eq!(format!("{told:.4}"), speed(dampers), "{line}");
    }
}
