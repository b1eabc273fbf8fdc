//! Hopf points and limit cycles, against values from outside the program, and restarts from labelled points.

use crate::{Folder, read};
use serde_json::Value;

const CYCLES: &str = "cycles --along v=2:9 --at v=4,2.5";

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[track_caller]
pub(crate) fn close(value: &Value, expected: f64, tolerance: f64) {
    let relative = (number(value) - expected).abs() / expected.abs();
    assert!(relative < tolerance, "{value}, not {expected}");
}

pub(crate) fn labelled<'a>(result: &'a Value, label: &str) -> &'a Value {
    let points = result["points"].as_array().unwrap();
    points.iter().find(|point| point["label"] == label).unwrap_or_else(|| panic!("no {label}"))
}

#[test]
fn the_hopf_point_of_the_paper() {
    let result = Folder::new().json("hopf --along v=12:0.5");
    assert_eq!(result["schema"]["name"], "kingpin.hopf");
    assert_eq!(result["points"].as_array().unwrap().len(), 1);
    let hopf = labelled(&result, "HB1");
    // Closed form of the critical yaw rate; frequency and Lyapunov coefficient from 30-digit arithmetic.
    close(&hopf["value"], 8.43103697014, 1e-11);
    close(&hopf["frequency"], 43.2553921186, 1e-10);
    close(&hopf["first_lyapunov"], 6.520929e-5, 1e-6);
    assert_eq!(hopf["criticality"], "subcritical");
    close(&hopf["state"]["Omega"], 8.43103697014, 1e-11);
    assert_eq!(result["along"], serde_json::json!({"key": "v", "unit": "m/s", "start": 0.5, "end": 12.0}));
    assert_eq!(result["stable_at_ends"], serde_json::json!([true, false]));
}

#[test]
fn a_cycle_of_the_paper() {
    let result = Folder::new().json(CYCLES);
    // Single shooting with a tolerance of 3e-14.
    let cycle = labelled(&result, "AT1");
    assert_eq!(cycle["value"], 4.0);
    close(&cycle["period"], 0.15274192836, 1e-9);
    assert_eq!(cycle["stable"], false);
    assert_eq!(cycle["multipliers"].as_array().unwrap().len(), 5);
    for point in result["points"].as_array().unwrap() {
        assert!(number(&point["error_estimate"]) < 1e-6);
        assert!(number(&point["psi_min"]) <= number(&point["psi_max"]));
    }
    let hopf = labelled(&result, "HB1");
    close(&hopf["period"], std::f64::consts::TAU / 43.2553921186, 1e-10);
    assert_eq!(hopf["stable"], Value::Null);
}

#[test]
fn a_cycle_of_a_file_is_followed_along_another_parameter() {
    let folder = Folder::new();
    folder.succeed(&format!("{CYCLES} -q -o first.json"));
    let onwards = folder.json("cycles --from first.json:AT1 --along l=0.07:0.09 --at 0.085");
    assert_eq!(onwards["parameters"]["v"], 4.0);
    assert!(onwards["parameters"].get("l").is_none());
    // The same cycle from the other side: the branch along v at that caster length.
    let direct = folder.json("cycles --along v=3:9 --at 4 -s l=0.085");
    for field in ["period", "psi_max", "psi_min"] {
        close(&labelled(&onwards, "AT1")[field], number(&labelled(&direct, "AT1")[field]), 1e-8);
    }
}

#[test]
fn a_hopf_point_of_a_file_is_followed_along_another_parameter() {
    let folder = Folder::new();
    folder.succeed("hopf --along v=1:12 -s l=0.1 -q -o hopf.json");
    let result = folder.json("cycles --from hopf.json:HB1 --along l=0.09:0.12");
    close(&labelled(&result, "HB1")["value"], 0.1, 1e-9);
    // The critical yaw rate at l = 0.1 m.
    close(&result["parameters"]["v"], 8.21277233215, 1e-11);
    assert!(result["points"].as_array().unwrap().len() > 5);
}

#[test]
fn a_branch_reaches_the_straight_path() {
    let folder = Folder::new();
    folder.succeed(&format!("{CYCLES} -q -o first.json"));
    let result = folder.json("cycles --from first.json:AT1 --along r=0.8:inf --at r=inf,2");
    let ends = [labelled(&result, "AT1"), labelled(&result, "AT2")];
    let straight = ends.into_iter().find(|point| point["value"] == "inf").unwrap();
    // On a straight path the motion is symmetric.
    assert!((number(&straight["psi_max"]) + number(&straight["psi_min"])).abs() < 1e-8);
    let curved = ends.into_iter().find(|point| point["value"] != "inf").unwrap();
    close(&curved["value"], 2.0, 1e-12);
}

#[test]
fn the_same_bytes_every_time() {
    let folder = Folder::new();
    for (name, threads) in [("one", 1), ("two", 2)] {
        folder.succeed(&format!(
            "{CYCLES} -q --threads {threads} -o {name}.json -o {name}.csv -o {name}.parquet -o {name}.svg"
        ));
    }
    for ending in ["json", "csv", "parquet", "svg"] {
        let [one, two] = ["one", "two"].map(|name| read(&folder.path(&format!("{name}.{ending}"))));
        assert!(one == two, "{ending}");
    }
}

#[test]
fn cycles_start_at_folds_and_leave_at_branch_points() {
    let folder = Folder::new();
    // An aircraft's nose wheel; its cycles in straight towing are symmetric up to a branch point.
    let wheel = "l = 0.15\nr = inf\nm_w = 300.0\nm_c = 40.0\nJ_wxi = 12.0\nJ_wzeta = 7.0\nJ_Cz = 1.5\nR = 0.35\n\
                 l_c = 0.05\nk = 2e6\nk_psi = 2e4\nc_psi = 200.0\nc_u = 1000.0\nF_Az = -3e4\n";
    std::fs::write(folder.path("nose.toml"), wheel).unwrap();
    folder.succeed("cycles --wheel nose.toml --along v=5:8 -q -o cycles.json");
    let skew = |point: &Value| number(&point["psi_max"]) + number(&point["psi_min"]);

    let through = folder.json("cycles --from cycles.json:LPC1 --along v=5:8");
    let points = through["points"].as_array().unwrap();
    assert!(points.len() > 5 && points.iter().all(|point| skew(point).abs() < 1e-6));

    let run = folder.run("cycles --from cycles.json:BPC1 --along c_psi=150:250 --steps 2");
    assert!(run.messages.contains("the branch of the cycle BPC1 itself is followed"), "{}", run.messages);

    let other = folder.json("cycles --from cycles.json:BPC1 --along v=5:8");
    let skews: Vec<f64> = other["points"].as_array().unwrap().iter().map(skew).collect();
    assert!(skews.iter().any(|skew| *skew > 0.1) && skews.iter().any(|skew| *skew < -0.1), "{skews:?}");
}
