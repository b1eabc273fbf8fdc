//! `tyre = linear` and `tyre = brush`: the commands that take a tyre, and those that say that they do not.

use crate::Folder;
use crate::branches::{close, labelled, number};
use serde_json::Value;

/// Somieski's nose gear (1997).
const NOSE_GEAR: &str = include_str!("../../../kingpin/examples/nose_gear.toml");

/// The paper's wheel with a load and a tyre.
const SOFT: &str = "-s tyre=linear -s sigma=0.03 -s a=0.01 -s C_alpha=400 -s kappa=0.003 -s F_Az=-20";

fn nose_gear() -> Folder {
    let folder = Folder::new();
    std::fs::write(folder.path("gear.toml"), NOSE_GEAR).unwrap();
    folder
}

#[test]
fn hopf_points_of_the_nose_gear_are_those_published() {
    let folder = nose_gear();
    for (damping, published) in [(0, 15.259_297_292), (10, 20.511_049_179)] {
        let result = folder.json(&format!("hopf --wheel gear.toml -s c_psi={damping} --along v=1:200"));
        let points = result["points"].as_array().unwrap();
        assert_eq!(points.len(), 1);
        assert!((number(&points[0]["value"]) - published).abs() < 5e-10);
        assert_eq!(result["parameters"]["tyre"], "linear");
        assert_eq!(result["parameters"]["k_q"], "inf");
        let states: Vec<&String> = points[0]["state"].as_object().unwrap().keys().collect();
        assert_eq!(states, ["Omega", "V1", "V2", "psi", "q", "u", "y_t"]);
    }
    let run = folder.run("hopf --wheel gear.toml -s c_psi=50 --along v=1:200");
    assert_eq!(run.exit_code, 1);
    assert!(run.messages.contains("stable at v = 1 m/s and stable at v = 200 m/s"), "{}", run.messages);
}

#[test]
fn branches_start_from_files_and_keep_their_tyre() {
    let folder = nose_gear();
    folder.succeed("hopf --wheel gear.toml -s tyre=brush --along v=5:60 -q -o hopf.json");
    let hopf: Value = serde_json::from_slice(&crate::read(&folder.path("hopf.json"))).unwrap();
    let point = &hopf["points"][0];
    assert!(point["first_lyapunov"].is_null() && point["criticality"] == "supercritical");
    assert!(point["remark"].as_str().unwrap().contains("no first Lyapunov coefficient exists"));
    folder.succeed("cycles --from hopf.json:HB1 --along v=5:60 --at 30 -q -o cycles.json");
    let cycles: Value = serde_json::from_slice(&crate::read(&folder.path("cycles.json"))).unwrap();
    let cycle = labelled(&cycles, "AT1");
    assert_eq!((&cycles["parameters"]["tyre"], &cycle["stable"]), (&"brush".into(), &true.into()));
    // The amplitude grows along a line at first.
    let slope = number(&point["psi_max_slope"]);
    let first = &cycles["points"][1];
    let ratio = number(&first["psi_max"]) / (number(&first["value"]) - number(&point["value"]));
    assert!((ratio / slope - 1.0).abs() < 0.05, "{ratio} {slope}");
    // From that cycle on along another parameter, and a motion on it.
    let other = folder.json("cycles --from cycles.json:AT1 --along c_psi=0:5 --at 4");
    assert!(number(&labelled(&other, "AT1")["psi_max"]) < number(&cycle["psi_max"]));
    let start: Vec<f64> = (0..3).map(|index| number(&cycle["orbit"]["states"][index])).collect();
    let perturbations: Vec<String> = ["psi", "Omega", "y_t"]
        .iter()
        .zip(&start)
        .map(|(name, value)| format!("--perturb {name}={value:e}"))
        .collect();
    let history = folder.json(&format!(
        "simulate --wheel gear.toml -s tyre=brush -s v=30 --duration {:e} --points 2001 {}",
        number(&cycle["period"]),
        perturbations.join(" ")
    ));
    for name in ["psi", "Omega", "y_t", "V1", "V2"] {
        let values: Vec<f64> = history[name].as_array().unwrap().iter().map(number).collect();
        let size = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        assert!((values[0] - values[2000]).abs() < 1e-7 * size, "{name}");
        let largest = values.iter().fold(f64::NEG_INFINITY, |largest, &value| largest.max(value));
        assert!((largest - number(&cycle["max"][name])).abs() < 1e-5 * size, "{name}");
    }
    // Twice the damper, and the Hopf point as a curve.
    let curve = folder.json("locus --from hopf.json:HB1 --in v=1:60,c_psi=0:20 --at 20");
    let points = curve["points"].as_array().unwrap();
    let published = points.iter().map(|point| number(&point["values"][0])).filter(|v| *v < 30.0).count();
    assert!(published > 5 && points.iter().all(|point| point["first_lyapunov"].is_null()));
}

/// A pneumatic trail that was not set follows the contact length, from files too.
#[test]
fn the_pneumatic_trail_follows_the_contact_length_from_files() {
    let folder = Folder::new();
    folder.succeed(&format!("hopf {SOFT} -s v=12 --along a=0.001:0.05 -q -o hopf.json"));
    let hopf: Value = serde_json::from_slice(&crate::read(&folder.path("hopf.json"))).unwrap();
    assert!(hopf["parameters"]["t_p"].is_null(), "{}", hopf["parameters"]);
    let a = number(&hopf["points"][0]["value"]);
    // At that contact length the same point is found along the speed, from the file or directly.
    let direct = folder.json(&format!("hopf {SOFT} -s a={a:e} --along v=10:14"));
    close(&direct["points"][0]["value"], 12.0, 1e-9);
    close(&direct["parameters"]["t_p"], a / 3.0, 1e-12);
    let curve = folder.json("locus --from hopf.json:HB1 --in a=0.001:0.05,v=8:16 --steps 5");
    assert!(curve["points"].as_array().unwrap().len() > 3);
    let cycles = folder.json("cycles --from hopf.json:HB1 --along a=0.001:0.05 --steps 3");
    close(&cycles["points"][0]["value"], a, 1e-9);
}

#[test]
fn branches_end_where_the_wheel_stops() {
    let folder = nose_gear();
    let result = folder.json("cycles --wheel gear.toml --along v=5:60");
    let end = result["branches"][0]["ends"][1].as_str().unwrap();
    assert!(end.contains("smallest V1/v") && end.contains("0.01"), "{end}");
}

#[test]
fn tables() {
    let folder = nose_gear();
    for command in [
        &format!("steady {SOFT}"),
        &format!("stability {SOFT}"),
        &format!("stability {SOFT} -s r=inf -s k=inf"),
        &format!("chart {SOFT} --x v=1:9:9 --y l=0.04:0.12:5"),
        &format!("hopf {SOFT} --along v=1:40"),
        &format!("simulate {SOFT} -s tyre=brush --duration 0.5 --perturb psi=0.05"),
        &format!("simulate {SOFT} -s r=inf -s l=0.03 -s k=inf --duration 5 --perturb psi=0.4"),
        "hopf --wheel gear.toml -s tyre=brush --along v=1:60",
        "cycles --wheel gear.toml -s tyre=brush --along v=5:60 --at 20,40",
    ] {
        let run = folder.succeed(command);
        insta::assert_snapshot!(run.output);
    }
}

#[test]
fn the_damper_of_the_nose_gear_is_that_of_its_published_hopf_point() {
    let folder = nose_gear();
    for tyre in ["linear", "brush"] {
        let result = folder.json(&format!("damper --wheel gear.toml -s tyre={tyre} --up-to v=20.511049179"));
        close(&result["c_psi"], 10.0, 1e-6);
        // A rigid king pin leaves nothing to a lateral damper.
        assert!(result["c_q"].is_null() && result["corner"]["c_psi"] == 20.511_049_179);
    }
}

#[test]
fn the_chart_agrees_with_the_hopf_points() {
    let folder = nose_gear();
    let chart = folder.json("chart --wheel gear.toml --x v=5:40:30 --y c_psi=0:20:5");
    let boundary = chart["stability_boundary"].as_array().unwrap();
    assert!(!boundary.is_empty());
    let near = |wanted: [f64; 2]| {
        boundary.iter().flat_map(|curve| curve.as_array().unwrap()).any(|point| {
            (number(&point[0]) - wanted[0]).abs() < 1e-6 && (number(&point[1]) - wanted[1]).abs() < 1e-6
        })
    };
    assert!(near([15.259_297_292, 0.0]), "{boundary:?}");
}

#[test]
fn what_is_missing_or_not_taken_is_said() {
    let folder = Folder::new();
    let fails = |arguments: &str, words: &[&str]| {
        let run = folder.run(arguments);
        assert_eq!(run.exit_code, 2, "{arguments}: {}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: {}", run.messages);
        }
    };
    fails("steady -s tyre=linear -s C_alpha=400", &["tyre = linear needs sigma", "relaxation length"]);
    fails("steady -s tyre=linear -s sigma=0.05", &["needs C_alpha", "N/rad"]);
    fails("steady -s tyre=elastic", &["tyre = elastic", "rigid, linear, brush"]);
    fails("steady -s sigma=0.05", &["`sigma` belongs to a tyre", "tyre = linear"]);
    fails("steady -s k_q=inf", &["k_q = inf", "without a tyre"]);
    fails("hopf --along tyre=0:1", &["cannot vary"]);
    fails("hopf --along sigma=0.01:0.1", &["`sigma` belongs to a tyre"]);
    fails("chart --x v=1:5:3 --y C_alpha=100:500:3", &["`C_alpha` belongs to a tyre"]);
    fails(&format!("steady {SOFT} -s tyre=brush -s F_Az=20"), &["needs friction", "F_Az"]);
    fails(&format!("hopf {SOFT} -s k=inf --along c_q=0:1"), &["`c_q` cannot vary", "finite k_q"]);
    fails(&format!("simulate {SOFT} -s k=inf --duration 1 --perturb q=0.1"), &["`q`", "psi, Omega, y_t"]);
    let possible =
        ["tyre = linear", "with a tyre there are", "cycles", "simulations", "safe kicks", "tyre = rigid"];
    for command in [
        "basin --x psi=-1:1:3 --y Omega=-1:1:3 --contact sliding",
        "safe-kick --contact sliding",
        "simulate --duration 1 --contact sliding",
    ] {
        fails(&format!("{command} {SOFT}"), &possible);
    }
    // Said to be rigid, the wheel of a file with a tyre is the one without.
    let (bare, said) =
        (folder.json("steady"), folder.json(&format!("steady {SOFT} -s F_Az=0 -s tyre=rigid")));
    assert_eq!(bare, said);
    close(&said["V"], 4.023_968_7, 1e-7);
}

/// With dry friction about the king pin the caster rests at any angle up to atan(M_f/((l + t_p) C_alpha)) of the linear law, on either
/// side, and kicks end there.
#[test]
fn a_tyre_with_dry_friction_rests_askew() {
    let folder = Folder::new();
    let soft = format!("{SOFT} -s r=inf -s M_f=0.01");
    let steady = folder.json(&format!("steady {soft}"));
    let [l, t_p, cornering] = ["l", "t_p", "C_alpha"].map(|key| number(&steady["parameters"][key]));
    let angle = (0.01 / ((l + t_p) * cornering)).atan();
    close(&steady["resting_angles"][1], angle, 1e-9);
    let run = folder.succeed(&format!("stability {soft}"));
    assert!(run.output.contains("without dry friction about the king pin"), "{}", run.output);
    let start = format!("--perturb psi={}", 0.5 * angle);
    let history = folder.json(&format!("simulate {soft} --duration 2 {start}"));
    assert_eq!(history["king_pin"].as_array().unwrap().last().unwrap(), "sticking");
    let ends = [-0.9 * angle, 0.9 * angle];
    let basin = format!("basin {soft} --x psi={}:{}:3 --y y_t=0:1e-9:2 -q", ends[0], ends[1]);
    let fates = folder.json(&basin);
    assert_eq!(fates["fates"].as_array().unwrap(), &vec![serde_json::json!("uniform motion"); 6]);
    assert_eq!(fates["y"]["unit"], "m");
}

/// Where the wheel stops rolling forwards the law of the tyre ends: the blow beyond which it does is safe up to there, and that is said.
#[test]
fn a_kick_that_stops_the_wheel_is_told() {
    let folder = Folder::new();
    let command = format!("safe-kick {SOFT} --largest 2 -s r=inf -s c_u=0.5 -s v=0.6 -q");
    let result = folder.json(&command);
    let edge = &result["positive"];
    assert_eq!(edge["fate"], "end of the model", "{result}");
    assert!(number(&result["safe"]) > 0.0);
    let stops = folder.json(&format!(
        "simulate --blow {:e} --duration 2 {SOFT} -s r=inf -s c_u=0.5 -s v=0.6",
        number(&edge["fails"])
    ));
    assert!(number(&stops["stopped_at"]) > 0.0);
    // The command that is told shows it, too.
    let replay = result["replay"].as_str().unwrap();
    let replayed = folder.json(&format!("simulate {replay}"));
    assert_eq!(replayed["stopped_at"], stops["stopped_at"], "{replay}");
    let table = folder.succeed(&command).output;
    assert!(table.contains("V1 = 0") && table.contains("undecided"), "{table}");
}
