//! What is monitored along branches of a wheel, where they end for it, and curves on which it is held.

use crate::Folder;
use crate::bad_input::{fails, fails_in};
use crate::branches::{close, labelled, number};
use serde_json::Value;

#[test]
fn what_is_monitored_on_cycles_is_what_else_is_told_of_them() {
    let folder = Folder::new();
    let cycles = folder.json(
        "cycles --along v=0.5:9 --at 7 --monitor max(psi)=0.4 --monitor max(friction_force) --monitor max(king_pin_force) \
         --monitor max(V)-v --until period=0.15",
    );
    let points = &cycles["points"];
    for point in points.as_array().unwrap().iter().filter(|point| point["label"] != "HB1") {
        let monitors = &point["monitors"];
        close(&monitors["max(psi)"], number(&point["psi_max"]), 1e-9);
        close(&monitors["max(friction_force)"], number(&point["friction_max"]), 1e-9);
        close(&monitors["max(king_pin_force)"], number(&point["king_pin_force_max"]), 1e-9);
        close(&monitors["max(V)-v"], number(&point["max"]["V"]) - number(&point["value"]), 1e-8);
    }
    close(&labelled(&cycles, "AT2")["value"], 7.0, 1e-15);
    close(&labelled(&cycles, "AT1")["psi_max"], 0.4, 1e-10);
    close(&labelled(&cycles, "AT3")["period"], 0.15, 1e-10);
    assert_eq!(cycles["branches"][0]["ends"][1], "period reached the value 0.15 at which to stop");
}

#[test]
fn uniform_motions_have_the_forces_that_steady_tells() {
    let folder = Folder::new();
    let result = folder.json("hopf --along v=0.5:12 --monitor friction_force=9 --monitor q --until v=10");
    let motion =
        result["motions"].as_array().unwrap().iter().find(|motion| motion["label"] == "AT1").unwrap();
    let steady = folder.json(&format!("steady -s v={:e}", number(&motion["value"])));
    close(&steady["friction_force"], 9.0, 1e-9);
    close(&motion["monitors"]["q"], number(&steady["q"]), 1e-9);
    close(
        &result["points"][0]["monitors"]["friction_force"],
        number(&result["points"][0]["friction_max"]),
        1e-9,
    );
    assert_eq!(result["ends"][1]["cause"], "v reached the value 10 at which to stop");
}

#[test]
fn a_wheel_with_a_tyre_is_monitored_too() {
    let folder = Folder::new();
    let nose_gear = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/nose_gear.toml");
    let result = folder.json(&format!("hopf --wheel {nose_gear} --along v=1:200 -s c_psi=10 --monitor V1/v"));
    assert!(!result["points"].as_array().unwrap().is_empty());
    for point in result["points"].as_array().unwrap() {
        close(&point["monitors"]["V1/v"], number(&point["state"]["V1"]) / number(&point["value"]), 1e-9);
    }
}

#[test]
fn quantities_are_held() {
    let folder = Folder::new();
    folder.succeed("cycles --along v=0.5:9 --at 7 -q -o cycles.json");
    let curve = folder
        .json("locus --from cycles.json:AT1 --hold max(psi)=0.3 --in v=0.5:9,l=0.06:0.12 --monitor period");
    assert!(curve["points"].as_array().unwrap().len() > 5);
    for point in curve["points"].as_array().unwrap() {
        close(&point["max"]["psi"], 0.3, 1e-9);
        close(&point["monitors"]["period"], number(&point["period"]), 1e-15);
    }
    // A uniform motion whose caster angle is held: sin(psi) = l/r.
    folder.succeed("hopf --along v=0.5:12 -q -o hopf.json");
    let curve = folder.json("locus --from hopf.json:HB1 --hold psi --in l=0.05:0.2,r=0.5:2");
    assert_eq!(curve["kind"], Value::Null);
    let angle = number(&curve["held"]["psi"]);
    for point in curve["points"].as_array().unwrap() {
        close(&point["state"]["psi"], angle, 1e-9);
    }
    folder.succeed("locus --from hopf.json:HB1 --hold psi --in l=0.05:0.2,r=0.5:2 -q -o held.json");
    fails_in(
        &folder,
        "cycles --from held.json:EP1 --along v=1:9",
        2,
        &["EP1 is a uniform motion", "Hopf points (HB)"],
    );
}

#[test]
fn what_cannot_be_monitored_is_refused() {
    for (asked, pieces) in [
        (
            "cycles --along v=1:9 --monitor PSI",
            &["--monitor PSI", "capital letters count", "perhaps psi"][..],
        ),
        ("cycles --along v=1:9 --until psi=1", &["--until psi", "no single value on a cycle", "max(psi)"]),
        (
            "cycles --along v=1:9 --monitor friction_force",
            &["friction_force has no single value", "max(friction_force)"],
        ),
        (
            "hopf --along v=1:9 --monitor omega",
            &["--monitor omega", "perhaps Omega is meant", "friction_force"],
        ),
        ("hopf --along v=1:9 --monitor nonsense", &["--monitor nonsense", "unknown name", "king_pin_force"]),
    ] {
        fails(asked, 2, pieces);
    }
}

#[test]
fn a_branch_that_reaches_the_end_of_what_a_parameter_may_be_is_told() {
    // The branch ends where the damping is zero, or below by rounding.
    let folder = Folder::new();
    let bed = "-s v=1.4 -s l=0.045 -s r=2 -s m_w=0.6 -s m_c=0.9 -s J_wxi=0.0016 -s J_wzeta=0.0009 -s J_Cz=0.0011 -s R=0.075 -s l_c=0.02 \
               -s k=60000 -s F_Az=-450 -s mu_s=0.7";
    let cycles = folder.json(&format!("cycles --along c_q=0:90 {bed}"));
    assert!(cycles["points"].as_array().unwrap().iter().all(|point| number(&point["value"]) >= 0.0));
}
