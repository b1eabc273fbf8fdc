//! Uniform motions that turn or end inside the interval asked for, and changes of stability that a single number does not tell.

use crate::Folder;
use crate::branches::number;

const TURNS_BACKWARDS: &str = include_str!("../../../kingpin/tests/wheels/turns_backwards.toml");
const ENDS: &str = include_str!("../../../kingpin/tests/wheels/ends_on_the_circle.toml");
const FOLDS: &str = include_str!("../../../kingpin/tests/wheels/folds_on_the_circle.toml");
const NARROW: &str = include_str!("../../../kingpin/tests/wheels/narrow_window.toml");
const SEVERAL: &str = include_str!("../../../kingpin/tests/wheels/several_changes.toml");
const WEAK: &str = include_str!("../../../kingpin/tests/wheels/weak_change.toml");
const LATERAL: &str = include_str!("../../../kingpin/tests/wheels/lateral_on_a_circle.toml");

fn wheel(toml: &str) -> Folder {
    let folder = Folder::new();
    std::fs::write(folder.path("wheel.toml"), toml).unwrap();
    folder
}

#[test]
fn hopf_points_up_to_the_end_of_the_motion_are_given_and_the_end_is_told() {
    let folder = wheel(ENDS);
    let run = folder.succeed("hopf --wheel wheel.toml --along v=0.1:20");
    for expected in ["Hopf points for v from 0.1 to 20 m/s", "0.59139026", "3.1168486", "3.7399194"] {
        assert!(run.output.contains(expected), "{expected}: {}", run.output);
    }
    insta::assert_snapshot!("hopf_beyond_the_end", run.output);
}

#[test]
fn hopf_points_of_a_tyre_that_rolls_backwards_are_none() {
    let folder = wheel(TURNS_BACKWARDS);
    let run = folder.succeed("hopf --wheel wheel.toml --along v=0.05:2");
    assert!(!run.output.contains("0.65432647"), "{}", run.output);
    insta::assert_snapshot!("hopf_behind_a_fold", run.output);
    let result = folder.json("hopf --wheel wheel.toml --along v=0.05:2");
    for point in result["points"].as_array().unwrap() {
        assert!(number(&point["state"]["V1"]) > 0.0, "{point}");
    }
}

/// Nobody gave a start, and what was found is given.
#[test]
fn cycles_are_followed_where_the_motion_ends() {
    let folder = wheel(FOLDS);
    let run = folder.run("cycles --wheel wheel.toml --along v=0.1:20 --steps 3");
    assert!(!run.messages.contains("start given"), "{}", run.messages);
    assert_eq!(run.exit_code, 0, "{}", run.messages);
    assert!(run.output.contains("turns at v = 5.3000088 m/s"), "{}", run.output);
}

#[test]
fn stability_tells_every_change_and_what_was_looked_at() {
    for (name, toml) in [
        ("stability_in_a_narrow_window", NARROW),
        ("stability_that_changes_often", SEVERAL),
        ("stability_that_changes_weakly", WEAK),
    ] {
        let run = wheel(toml).succeed("stability --wheel wheel.toml");
        assert!(!run.output.contains("at every speed"), "{}", run.output);
        insta::assert_snapshot!(name, run.output);
    }
}

#[test]
fn a_change_that_was_not_located_is_told() {
    let run = wheel(WEAK).run("hopf --wheel wheel.toml --along v=0.05:26.06");
    assert_eq!(run.exit_code, 1);
    let expected = "the uniform motion gains stability, and where was not located: its growth rate is";
    assert!(run.messages.contains(expected), "{}", run.messages);
    assert!(!run.messages.contains("wider interval"), "{}", run.messages);
}

#[test]
fn blows_to_a_wheel_with_lateral_elasticity_only_on_a_circle() {
    let folder = wheel(LATERAL);
    for kind in ["impulse", "release-angle"] {
        let run = folder.succeed(&format!("safe-kick --wheel wheel.toml --kind {kind} --contact rolling"));
        assert!(run.output.contains("ends in"), "{}", run.output);
    }
}

#[test]
fn the_law_of_the_tyre_is_among_the_keys() {
    let run = Folder::new().run("steady -s foo=1");
    assert!(run.messages.contains("and `tyre`, which is a word"), "{}", run.messages);
}

/// What no wider interval helps is not answered with one.
#[test]
fn a_wheel_that_is_unstable_at_every_speed_is_told_so() {
    let folder = wheel(include_str!("../../../kingpin/examples/wheels/office.toml"));
    for command in ["hopf", "cycles"] {
        let run = folder.run(&format!("{command} --wheel wheel.toml --along v=0.5:5"));
        assert_eq!(run.exit_code, 1);
        for told in ["it is unstable at every speed", "kingpin damper", "small motions die out up to "] {
            assert!(run.messages.contains(told), "{}", run.messages);
        }
        assert!(!run.messages.contains("wider interval"), "{}", run.messages);
    }
    // The critical speed with friction stands beside the chart, at the length of the wheel.
    let chart = "chart --wheel wheel.toml -s M_f=0.01 --x v=0.5:5:5 --y l=0.02:0.03:5 -q";
    let run = folder.succeed(chart);
    assert!(run.output.contains("at l = 0.022 m with it small motions die out up to "), "{}", run.output);
}

#[test]
fn a_load_that_does_not_enter_decides_nothing() {
    let folder = wheel(include_str!("../../../kingpin/examples/wheels/trolley.toml"));
    let run = folder.succeed("damper --wheel wheel.toml --up-to v=3 --load=-300:-100 --small-motions -q");
    assert!(
        run.output.contains("all loads alike") && run.output.contains("v = 3 m/s decides"),
        "{}",
        run.output
    );
}

/// With springs that differ, and no damper along the path, the king pin has no place of its own along the path where
/// `m_c (l - l_c) omega^2 = k_u l`: two eigenvalues are zero, and motions with any `u` branch off.
#[test]
fn an_anisotropic_suspension_loses_its_stability_at_a_branch_point() {
    let folder = Folder::new();
    let wheel = "-s l=0.09 -s r=1.5 -s m_w=0.35 -s m_c=0.09 -s J_wxi=5e-5 -s J_wzeta=3e-5 -s J_Cz=4e-6 -s R=0.04 -s l_c=0.02 \
                 -s k_u=40 -s k_q=300 -s F_Az=-20";
    let speed = 1.5 * (40.0 * 0.09 / (0.09 * 0.07_f64)).sqrt();
    for interval in ["20:40", "4:60", "30:39.5"] {
        let run = folder.run(&format!("hopf {wheel} --along v={interval} -q"));
        let text = run.output.clone() + &run.messages;
        let told: Vec<f64> = text
            .split("other uniform motions branch off at v = ")
            .skip(1)
            .map(|rest| rest.split(' ').next().unwrap().parse().unwrap())
            .collect();
        assert!(matches!(told[..], [told] if (told - speed).abs() < 1e-6), "{text}");
        assert!(!text.contains("bracketed") && !text.contains("turns"), "{text}");
    }
}

/// Where `stability` knows at which speed the stability changes, no interval has to be guessed.
#[test]
fn where_the_stability_changes_is_told_where_no_hopf_point_is_found() {
    let folder = Folder::new();
    let critical = folder.json("stability")["critical_speed"].as_f64().unwrap();
    let dolly = format!("--wheel {}/../kingpin/examples/wheels/dolly.toml", env!("CARGO_MANIFEST_DIR"));
    for command in ["hopf", "cycles"] {
        let run = folder.run(&format!("{command} --along v=0.5:2 -q"));
        assert_eq!(run.exit_code, 1);
        let told = run.messages.split("its stability changes at ").nth(1).unwrap_or_default();
        let speed: f64 = told.split([' ', ',']).next().unwrap().parse().unwrap();
        assert!((speed - critical).abs() < 1e-6 && !run.messages.contains("wider"), "{}", run.messages);
        // With dry friction the speed up to which small motions die out stands beside.
        let run = folder.run(&format!("{command} {dolly} -s M_f=1 --along v=2:5 -q"));
        let told =
            ["its stability changes at 1.13", "M_f = 1 N m was left out", "small motions die out up to 11.8"];
        assert!(told.iter().all(|told| run.messages.contains(told)), "{}", run.messages);
    }
    let tyre = "-s r=inf -s tyre=linear -s C_alpha=100 -s sigma=0.02";
    let run = folder.run(&format!("hopf --along v=0.5:2 {tyre} -q"));
    assert!(
        run.messages.contains("no change of its stability was found from 0.001 to 10000 m/s"),
        "{}",
        run.messages
    );
}
