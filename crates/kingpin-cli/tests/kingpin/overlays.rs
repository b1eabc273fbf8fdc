//! Charts with the limits for several values of a third parameter.

use crate::bad_input::fails;
use crate::{Folder, read};
use kingpin::{Key, Wheel};

const CHART: &str = "chart --x v=0.1:20:30 --y l=0.02:0.3:20";

fn points(curves: &serde_json::Value) -> Vec<[f64; 2]> {
    let curves = curves.as_array().unwrap().iter();
    let points = curves.flat_map(|curve| curve.as_array().unwrap());
    points.map(|point| [point[0].as_f64().unwrap(), point[1].as_f64().unwrap()]).collect()
}

/// At 5 m the limit of stability lies in a strip narrower than a cell of the grid from which it is traced.
#[test]
fn limits_for_several_radii_are_those_of_the_closed_form() {
    let chart = Folder::new().json(&format!("{CHART} --overlay r=0.5,2,5,inf"));
    let overlays = chart["overlays"].as_array().unwrap();
    assert_eq!(overlays.len(), 4);
    for (overlay, radius) in overlays.iter().zip([0.5, 2.0, 5.0, f64::INFINITY]) {
        assert_eq!(overlay["key"], "r");
        let limit = points(&overlay["stability_boundary"]);
        if radius.is_infinite() {
            assert_eq!(overlay["value"], "inf");
            let critical =
                Wheel::default().with(Key::TurningRadius, radius).unwrap().critical_caster_length();
            assert!(limit.iter().all(|[_, l]| (l / critical.unwrap() - 1.0).abs() < 1e-9));
        } else {
            assert_eq!(overlay["value"], radius);
            for [v, l] in &limit {
                let critical = Wheel::default().with(Key::L, *l).unwrap().critical_yaw_rate().unwrap();
                assert!((v / (radius * critical) - 1.0).abs() < 1e-6, "{v} {l} at {radius}");
            }
        }
        let fastest = limit.iter().map(|[v, _]| *v).fold(0.0, f64::max);
        let reaches = if radius < 2.5 { 8.43 * radius } else { 20.0 };
        assert!((fastest / reaches - 1.0).abs() < 1e-3, "{fastest} at {radius}");
    }
    let mut plain = Folder::new().json(CHART);
    plain["overlays"] = chart["overlays"].clone();
    assert_eq!(plain, chart);
}

#[test]
fn limits_of_rolling_for_several_loads_are_where_the_friction_is_used_up() {
    let folder = Folder::new();
    let chart = folder.json(&format!("{CHART} --overlay F_Az=0,-20 --overlay mu_s=0.5 -o a.svg -o a.csv"));
    let overlays = chart["overlays"].as_array().unwrap();
    let wheels = [(Key::FAz, 0.0), (Key::FAz, -20.0), (Key::MuS, 0.5)];
    let mut count = 0;
    for (overlay, (key, value)) in overlays.iter().zip(wheels) {
        assert_eq!(overlay["stability_boundary"], chart["stability_boundary"]);
        let limit = points(&overlay["rolling_limit"]);
        assert!(limit.len() > 20);
        count += limit.len() + points(&overlay["stability_boundary"]).len();
        for [v, l] in limit {
            let wheel =
                Wheel::default().with(key, value).unwrap().with(Key::V, v).unwrap().with(Key::L, l).unwrap();
            let force = wheel.uniform_motion().unwrap().contact_force();
            assert!((force.friction() / force.limit - 1.0).abs() < 1e-6);
        }
    }
    assert!(read(&folder.path("a.svg")).len() > 1000);
    let table = String::from_utf8(read(&folder.path("a.csv"))).unwrap();
    assert!(table.starts_with("v,l,growth_rate,stable,rolls,limit,overlay,overlay_value,curve\n"));
    assert_eq!(table.lines().count(), 1 + 30 * 20 + count);
    assert!(table.lines().last().unwrap().ends_with(",rolling,mu_s,0.5,1"), "{table}");
    insta::assert_snapshot!(folder.succeed(&format!("{CHART} --overlay F_Az=0,-20")).output);
}

/// The text of a picture.
fn drawn(overlays: &str) -> String {
    let folder = Folder::new();
    folder.succeed(&format!("{CHART} {overlays} -q -o a.svg"));
    String::from_utf8(read(&folder.path("a.svg"))).unwrap()
}

/// Colours of lines in a picture.
fn colors(picture: &str) -> std::collections::BTreeSet<&str> {
    picture.split("stroke=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// More values than there are colours have other ones all the same, and a load, which changes no stability, hides no limit of it.
#[test]
fn every_value_has_its_own_colour() {
    let [few, many] = ["0.5,1", "0.3,0.5,0.7,1,1.5,2,3"].map(|radii| drawn(&format!("--overlay r={radii}")));
    assert_eq!(colors(&many).len() - colors(&few).len(), 5, "{:?} {:?}", colors(&few), colors(&many));
    // The third colour is that of the load: its limit of rolling, and no second limit of stability over that of the wheel.
    let beside = drawn("--overlay r=0.5,1 --overlay F_Az=-5");
    assert_eq!(beside.matches("stroke=\"#009e73\"").count(), 1, "{beside}");
    // What has no limit is named in the legend all the same.
    let lifted = drawn("--overlay F_Az=-5,10");
    assert_eq!(lifted.matches("stroke=\"#0072b2\"").count(), 1, "{lifted}");
}

#[test]
fn overlays_that_make_no_sense() {
    fails("chart --overlay v=1,2", 2, &["--overlay v=1,2", "varies with the axis `v`"]);
    fails("chart --overlay r=1,0", 2, &["--overlay r=1,0", "r = 0", "allowed"]);
    fails("chart --overlay r=1,,2", 2, &["--overlay r=1,,2", "not a number"]);
    fails("chart --overlay M_f=0.1", 2, &["--overlay M_f=0.1", "cannot vary"]);
    fails("chart --overlay radius=1", 2, &["--overlay radius=1", "`R`", "`r`"]);
    fails("chart --overlay sigma=0.1", 2, &["--overlay sigma=0.1", "tyre"]);
    fails("chart --overlay mu_d=2", 2, &["--overlay mu_d=2", "at most mu_s"]);
    fails("chart --overlay r", 2, &["KEY=VALUE"]);
    let many = (1..=25).map(|radius| radius.to_string()).collect::<Vec<_>>().join(",");
    fails(&format!("chart --overlay r={many}"), 2, &["25 values", "at most 24"]);
}
