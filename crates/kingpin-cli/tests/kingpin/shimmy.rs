//! `kingpin shimmy`: what it finds for any wheel, and what it says where there is nothing.

use crate::Folder;
use serde_json::Value;

const WHEELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");

/// The real casters, with speeds at which they shimmy.
const SPEEDS: [(&str, &str); 5] = [
    ("office", "v=0.9:1"),
    ("trolley", "v=2:2.2"),
    ("wheelchair", "v=1.6:1.8"),
    ("dolly", "v=3.4:3.6"),
    ("nosegear", "v=13:14"),
];

fn points(result: &Value) -> &[Value] {
    result["points"].as_array().unwrap()
}

#[test]
fn the_real_casters_shimmy_straight_and_on_a_circle() {
    let folder = Folder::new();
    for (name, along) in SPEEDS {
        // A circle for the lightest of them.
        let radii: &[&str] = if name == "office" { &["inf", "5"] } else { &["inf"] };
        for radius in radii {
            let command = format!("shimmy --wheel {WHEELS}/{name}.toml -s r={radius} --along {along}");
            let result = folder.json(&command);
            assert_eq!(
                result["schema"]["name"].as_str().or(result["schema"].as_str()),
                Some("kingpin.shimmy")
            );
            assert!(points(&result).iter().any(|point| point["stable"] == true), "{command}");
            for point in points(&result) {
                let number = |field: &str| point[field].as_f64().unwrap();
                assert!(number("friction_ratio_max") <= 1.0 + 1e-12, "{command}: {point}");
                assert_eq!(point["rolls"], false, "{command}");
                let phases = point["phases"].as_array().unwrap();
                let duration: f64 = phases.iter().map(|phase| phase["duration"].as_f64().unwrap()).sum();
                assert!((duration / number("period") - 1.0).abs() < 1e-9, "{command}");
                assert!(number("sliding_power") > 0.0 && number("damper_power") >= 0.0, "{command}");
                assert!((number("psi_0") + number("deviation_max") - number("psi_max")).abs() < 1e-12);
            }
        }
    }
}

/// Period, extremes and durations of the phases of wheels that stand in no other list, each confirmed by integration in the ground
/// frame with Lagrange multipliers (SciPy), which comes back to its start to 2e-11. The error that is told covers the difference.
#[test]
fn shimmy_agrees_with_integration_in_the_ground_frame() {
    let wheels = [
        (
            "-s l=0.03 -s k=150 -s F_Az=-5 -s c_u=0.1 -s r=inf --along v=0.5:0.9 --at 0.7",
            [0.10944253809303, 0.82970580219432, -0.82970580219432],
        ),
        (
            "-s l=0.05 -s m_w=1 -s m_c=0.8 -s J_wxi=2e-3 -s J_wzeta=1e-3 -s J_Cz=8e-4 -s R=0.08 -s l_c=0.015 -s k_u=2e4 \
             -s k_q=9e3 -s c_psi=0.02 -s c_u=2 -s F_Az=-80 -s mu_s=0.9 -s mu_d=0.7 -s r=3 --along v=1.3:1.6 --at 1.4",
            [0.06921645717442, 0.41423406399565, -0.37974498578112],
        ),
        (
            "-s l=0.1 -s m_w=4 -s m_c=6 -s J_wxi=0.05 -s J_wzeta=0.04 -s J_Cz=0.06 -s R=0.15 -s l_c=0.05 -s k_u=1e5 -s k_q=6e4 \
             -s k_psi=5 -s c_q=30 -s F_Az=-500 -s mu_s=0.7 -s mu_d=0.5 -s r=inf --along v=2.7:3.1 --at 2.9",
            [0.08228053092561, 0.08960589967554, -0.08960589967554],
        ),
    ];
    let folder = Folder::new();
    for (wheel, expected) in wheels {
        let result = folder.json(&format!("shimmy {wheel}"));
        let point = points(&result).iter().find(|point| point["label"] == "AT1").unwrap();
        for (field, expected) in ["period", "psi_max", "psi_min"].into_iter().zip(expected) {
            let found = point[field].as_f64().unwrap();
            let error = (found / expected - 1.0).abs();
            assert!(error < 1e-9, "{wheel}: {field} {found} {expected}");
            let told = point["error_estimate"].as_f64().unwrap();
            assert!(error <= told + 2e-11 && told >= 1e-11, "{wheel}: {field} {error} {told}");
        }
    }
}

#[test]
fn table_and_files() {
    let folder = Folder::new();
    let command = format!("shimmy --wheel {WHEELS}/trolley.toml -s c_u=1 --along v=3.9:4.2 --at 4,4.05");
    insta::assert_snapshot!("shimmy", folder.succeed(&format!("{command} --explain")).output);
    folder.succeed(&format!("{command} -q -o a.json -o a.csv -o a.svg"));
    folder.succeed(&format!("{command} -q --threads 1 -o b.json -o b.csv -o b.svg"));
    for ending in ["json", "csv", "svg"] {
        let [one, other] = ["a", "b"].map(|name| crate::read(&folder.path(&format!("{name}.{ending}"))));
        assert!(one == other && !one.is_empty(), "{ending}");
    }
    let csv = String::from_utf8(crate::read(&folder.path("a.csv"))).unwrap();
    for column in [
        "value",
        "period",
        "psi_max",
        "stable",
        "sliding_fraction",
        "phases",
        "friction_max",
        "sliding_power",
    ] {
        assert!(csv.lines().next().unwrap().split(',').any(|name| name.starts_with(column)), "{column}");
    }
}

#[test]
fn where_there_is_none_it_says_what_was_tried() {
    let folder = Folder::new();
    let run = folder.run("shimmy --along v=1:2 -s F_Az=-50 -s c_u=5 -s c_q=5 -s c_psi=0.01");
    assert_eq!(run.exit_code, 1);
    for part in ["no shimmy with sliding was found", "20 kicked motions", "it dies out (20 of them)", "try"] {
        assert!(run.messages.contains(part), "{part}: {}", run.messages);
    }
}

#[test]
fn what_cannot_slide_here_is_refused() {
    let folder = Folder::new();
    for (set, reason) in [
        ("-s k_u=inf", "k_u = inf"),
        ("-s tyre=linear -s sigma=0.03 -s C_alpha=400 -s M_f=0.1", "shimmy with a tyre"),
        ("-s F_Az=100", "F_Az = 100"),
        ("--at 3", "--at"),
        ("--steps 0", "steps"),
    ] {
        let run = folder.run(&format!("shimmy --along v=1:2 {set}"));
        assert_eq!(run.exit_code, 2, "{set}: {}", run.messages);
        assert!(run.messages.contains(reason), "{set}: {}", run.messages);
    }
}

/// With a tyre shimmy is a smooth cycle: what kicked motions settle on, here of a nose gear with `c_u = 0`, on which the longitudinal motion
/// rings for long. A small release and a larger one lead to different ones; `simulate` settles on the same.
#[test]
fn shimmy_with_a_tyre_is_what_a_simulation_settles_on() {
    let folder = Folder::new();
    let wheel = format!("--wheel {WHEELS}/nosegear.toml -s tyre=brush -s sigma=0.3 -s a=0.1 -s C_alpha=1e5");
    let result = folder.json(&format!("shimmy {wheel} --along v=28:32 --at 30"));
    let stable = |point: &&Value| point["value"] == 30.0 && point["stable"] == true;
    let found: Vec<&Value> = points(&result).iter().filter(stable).collect();
    let amplitudes: Vec<f64> = found.iter().map(|point| point["psi_max"].as_f64().unwrap()).collect();
    assert!(amplitudes.len() == 2 && amplitudes[0] > 1.0, "{amplitudes:?}");
    let point = found[1];
    let number = |field: &str| point[field].as_f64().unwrap();
    assert_eq!(point["phases"][0]["contact"], "rolling");
    assert_eq!(point["state"].as_object().unwrap().len(), 7);

    let history =
        folder.json(&format!("simulate {wheel} -s v=30 --perturb psi=0.05 --duration 60 --points 120001"));
    let column = |name: &str| -> Vec<f64> {
        history[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (times, angles) = (column("t"), column("psi"));
    let end = times.len() - 10_000;
    let (times, angles) = (&times[end..], &angles[end..]);
    let largest = angles.iter().copied().fold(0.0, f64::max);
    assert!((largest / number("psi_max") - 1.0).abs() < 1e-4, "{largest}");
    let passes: Vec<f64> = times
        .windows(2)
        .zip(angles.windows(2))
        .filter(|(_, angle)| angle[0] < 0.0 && angle[1] >= 0.0)
        .map(|(time, angle)| time[0] - (time[1] - time[0]) * angle[0] / (angle[1] - angle[0]))
        .collect();
    let period = (passes[passes.len() - 1] - passes[0]) / (passes.len() - 1) as f64;
    assert!((period / number("period") - 1.0).abs() < 1e-6, "{period}");
}

#[test]
fn shimmy_with_a_tyre_and_dry_friction_is_refused() {
    let run = Folder::new().run(
        "shimmy -s tyre=linear -s sigma=0.03 -s a=0.01 -s C_alpha=400 -s F_Az=-20 -s M_f=0.1 --along v=1:5",
    );
    assert_eq!(run.exit_code, 2);
    assert!(
        run.messages.contains("shimmy with a tyre with dry friction about the king pin"),
        "{}",
        run.messages
    );
}
