//! Forces at Hopf points and on cycles, and the rolling limit on a branch, in files and for restarts.

use crate::Folder;
use serde_json::Value;

fn labelled<'a>(result: &'a Value, label: &str) -> &'a Value {
    let points = result["points"].as_array().unwrap();
    points.iter().find(|point| point["label"] == label).unwrap_or_else(|| panic!("{label}"))
}

fn number(point: &Value, field: &str) -> f64 {
    point[field].as_f64().unwrap_or_else(|| panic!("{field}: {point}"))
}

#[test]
fn the_rolling_limit_is_a_point_of_the_branch_from_which_to_start() {
    let folder = Folder::new();
    folder.succeed("cycles --along v=0.2:9 --at 1,4 -q -o cycles.json -o cycles.csv");
    let result: Value = serde_json::from_slice(&crate::read(&folder.path("cycles.json"))).unwrap();
    let limit = labelled(&result, "RL1");
    assert!((number(limit, "friction_ratio_max") - 1.0).abs() < 1e-9, "{limit}");
    for point in result["points"].as_array().unwrap() {
        let [value, ratio] = ["value", "friction_ratio_max"].map(|field| number(point, field));
        let beyond = value > number(limit, "value");
        assert!(point["label"] == "RL1" || (ratio > 1.0) == beyond, "{value} {ratio}");
        assert_eq!(point["rolls"], ratio < 1.0);
        assert!(
            (number(point, "psi_0") + number(point, "deviation_max") - number(point, "psi_max")).abs()
                < 1e-15
        );
        assert!(
            (number(point, "psi_0") + number(point, "deviation_min") - number(point, "psi_min")).abs()
                < 1e-15
        );
    }
    // What was asked for keeps its labels.
    assert_eq!(
        [labelled(&result, "AT1"), labelled(&result, "AT2")].map(|point| number(point, "value")),
        [4.0, 1.0]
    );
    // From there on at another load, along the caster length.
    let onward = folder.json("cycles --from cycles.json:RL1 --along l=0.07:0.09");
    assert!(onward["points"].as_array().unwrap().len() > 4);
    let csv = String::from_utf8(crate::read(&folder.path("cycles.csv"))).unwrap();
    let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(
        names[names.len() - 5..].iter().map(|name| name.split(' ').next().unwrap()).collect::<Vec<_>>(),
        ["friction_max", "friction_ratio_max", "rolls", "king_pin_force_max", "damper_power"]
    );
}

#[test]
fn hopf_points_have_mode_sides_slopes_and_forces() {
    let folder = Folder::new();
    let result = folder.json("hopf --along v=0.1:20 -s l=0.04 -s k_u=inf -s c_q=0.05");
    let [first, second] = [labelled(&result, "HB1"), labelled(&result, "HB2")];
    for point in [first, second] {
        assert_eq!(point["mode"], "lateral");
        assert!(number(point, "friction_max") > 0.0 && number(point, "friction_slope") > 0.0);
    }
    assert_eq!([&first["unstable_before"], &first["unstable_after"]], [0, 2]);
    assert_eq!([&second["unstable_before"], &second["unstable_after"]], [2, 0]);
    // Both are subcritical: the cycles lie where the motion is stable.
    assert!(number(first, "psi_max_squared_slope") < 0.0 && number(second, "psi_max_squared_slope") > 0.0);
}
