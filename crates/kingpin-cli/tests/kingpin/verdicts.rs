//! Verdicts that strangers found wrong: what is said is right, or said to be undecided.

use super::Folder;
use serde_json::{Value, json};

/// A supermarket trolley's front caster in straight towing.
const TROLLEY: &str = "-s r=inf -s v=1.5 -s m_w=0.35 -s m_c=0.45 -s J_wxi=7e-4 -s J_wzeta=4.5e-4 -s J_Cz=4e-4 -s R=0.0625 \
                       -s l_c=0.012 -s k=30000 -s F_Az=-150 -s mu_s=0.7";

fn refused(folder: &Folder, arguments: &str) -> String {
    let run = folder.run(arguments);
    assert_eq!(run.exit_code, 1, "{arguments}");
    run.messages
}

/// At l = 0.04 m the growth rate is +10.5 1/s at 1.5 m/s, and positive at every speed: l_crit = 0.16940741 m.
#[test]
fn a_search_for_hopf_points_says_what_stability_says() {
    let folder = Folder::new();
    let message = refused(&folder, &format!("hopf --along v=0.5:10 {TROLLEY} -s l=0.04"));
    assert!(message.contains("unstable at v = 0.5 m/s and unstable at v = 10 m/s"), "{message}");
    let message = refused(&folder, &format!("hopf --along v=0.5:10 {TROLLEY} -s l=0.2"));
    assert!(message.contains("is stable at v = 0.5 m/s and stable at v = 10 m/s"), "{message}");
}

#[test]
fn a_chart_of_straight_towing_has_the_one_limit_that_there_is() {
    let folder = Folder::new();
    let chart = folder.json(&format!("chart {TROLLEY} --x v=0.05:5:40 --y l=0.005:0.2:40 -q"));
    let curves = chart["stability_boundary"].as_array().unwrap();
    assert_eq!(curves.len(), 1);
    // l_c + (J_Cz + J_wzeta)/(m_c l_c)
    let critical = 0.012 + 8.5e-4 / (0.45 * 0.012);
    for point in curves[0].as_array().unwrap() {
        assert!((point[1].as_f64().unwrap() - critical).abs() < 1e-9, "{point}");
    }
}

/// The exact growth rate is -2e-17 1/s.
#[test]
fn stability_within_rounding_is_undecided() {
    let folder = Folder::new();
    let wheel = "-s c_q=0.1 -s k_psi=0.1 -s r=1e8";
    assert_eq!(folder.json(&format!("stability {wheel}"))["stable"], Value::Null);
    let table = folder.succeed(&format!("stability {wheel}")).output;
    assert!(table.contains(": undecided\n") && table.contains("no critical speed was found"), "{table}");
    assert_eq!(folder.json("stability -s c_q=0.1 -s k_psi=0.1 -s r=1e3")["stable"], json!(true));
}

#[test]
fn a_value_without_uniform_motion_leaves_the_others_of_a_margin() {
    let folder = Folder::new();
    let result = folder.json("margin --along v=38:46:3 --duration 1 -q");
    let points = result["points"].as_array().unwrap();
    let problems: Vec<&Value> = points.iter().map(|point| &point["problem"]).collect();
    assert_eq!(problems, [&Value::Null, &json!("no uniform motion"), &json!("no uniform motion")]);
    assert!(points[0]["positive"]["fails"].is_number() && points[1]["safe"].is_null());
    folder.succeed("margin --along v=38:46:3 --duration 1 -q -o margin.json");
    assert_eq!(folder.files(), ["margin.json"]);
}

/// From -0.8039 to -0.8119 N s the wheel does not return, by simulations with three step sizes; -0.8130 N s returns again.
#[test]
fn a_gap_just_below_the_edge_of_a_safe_kick_is_found() {
    let folder = Folder::new();
    let result = folder.json("safe-kick -s v=8 -s F_Az=-100 --contact sliding -q");
    let [returns, fails] = ["returns", "fails"].map(|side| result["negative"][side].as_f64().unwrap());
    assert!(fails > -0.8045 && fails < returns && returns - fails < 2e-6, "{returns} {fails}");
    let largest =
        [&result["positive"], &result["negative"]].map(|edge| edge["returns"].as_f64().unwrap().abs());
    assert_eq!(result["resolution"].as_f64().unwrap(), largest[0].max(largest[1]) / 64.0);
}
