//! Dry friction about the king pin, as people and scripts see it.

use crate::Folder;

const WHEELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");

fn trolley(command: &str) -> String {
    command.replace("TROLLEY", &format!("--wheel {WHEELS}/trolley.toml"))
}

#[test]
fn tables() {
    let folder = Folder::new();
    for (name, command) in [
        ("steady", "steady TROLLEY -s M_f=0.3"),
        ("stability", "stability TROLLEY -s M_f=5"),
        ("hopf", "hopf TROLLEY -s M_f=0.3 -s c_psi=0.05 --along v=0.5:9"),
        ("rolls", "simulate TROLLEY -s M_f=0.3 --duration 2 --perturb psi=0.3"),
        (
            "slides",
            "simulate TROLLEY -s M_f=3 --duration 0.5 --perturb psi=0.3 --perturb Omega=30 --contact sliding",
        ),
        (
            "safe_kick",
            "safe-kick TROLLEY -s M_f=0.3 --kind release-angle --largest 0.4 --contact sliding --duration 2 -q",
        ),
    ] {
        // Where the wheels are differs from machine to machine.
        let output = folder.succeed(&trolley(command)).output.replace(WHEELS, "WHEELS");
        insta::assert_snapshot!(name, output);
    }
}

#[test]
fn no_time_has_no_sign() {
    let command = "simulate TROLLEY -s M_f=0.05 --contact sliding --blow 0.05 --duration 0.01";
    let output = Folder::new().succeed(&trolley(command)).output;
    assert!(output.contains("sticks for 0.0 % of the time"), "{output}");
}

#[test]
fn histories_tell_what_the_caster_does() {
    let folder = Folder::new();
    for contact in ["rolling", "sliding"] {
        let simulate =
            format!("simulate TROLLEY --duration 1 --points 11 --perturb psi=0.3 --contact {contact}");
        let with = folder.json(&trolley(&format!("{simulate} -s M_f=0.3")));
        assert_eq!(with["parameters"]["M_f"], 0.3);
        assert_eq!(with["king_pin"].as_array().unwrap().len(), 11);
        assert_eq!(with["king_pin"][0], "sticking");
        assert_eq!(with["phases"][1]["king_pin"], "swinging");
        assert!(with["dry_friction_work"].as_f64().unwrap() > 0.0);
        let without = folder.json(&trolley(&simulate));
        assert!(without.get("king_pin").is_none() && without.get("friction_moment").is_none());
        let table = folder.succeed(&trolley(&format!("{simulate} -s M_f=0.3 --format csv"))).output;
        let heading = table.lines().next().unwrap();
        assert!(heading.ends_with(",friction_moment,king_pin"), "{heading}");
    }
}

#[test]
fn what_takes_no_account_of_it_says_so() {
    let folder = Folder::new();
    for command in [
        "hopf TROLLEY -s c_psi=0.05 --along v=0.5:9",
        "cycles TROLLEY -s c_psi=0.05 --along v=0.5:9 -q",
        "chart TROLLEY --x v=1:9:5 --y c_psi=0:1:5",
        "damper TROLLEY --up-to v=3 -q",
    ] {
        let run = folder.succeed(&trolley(&format!("{command} -s M_f=0.3")));
        assert!(run.output.contains("M_f = 0.3 N m was left out"), "{command}: {}", run.output);
        let result = folder.json(&trolley(&format!("{command} -s M_f=0.3")));
        assert_eq!(result["dry_friction"]["moment"], 0.3, "{command}");
        assert!(folder.json(&trolley(command)).get("dry_friction").is_none(), "{command}");
    }
    // The critical speed beside is that of `stability`.
    let hopf = folder.json(&trolley("hopf TROLLEY -s c_psi=0.05 --along v=0.5:9 -s M_f=0.3"));
    let stability = folder.json(&trolley("stability TROLLEY -s c_psi=0.05"));
    let speed = |result: &serde_json::Value| result["critical_speed_with_friction"].as_f64().unwrap();
    assert_eq!(speed(&hopf["dry_friction"]), speed(&stability));
}

/// On a circle on which small motions grow without it, nothing is known to return.
#[test]
fn what_is_not_known_to_return_is_not_told_as_returning() {
    let folder = Folder::new();
    let kick = "safe-kick TROLLEY -s r=3 -s M_f=0.3 --kind release-angle --contact rolling --duration 1 -q --largest";
    let small = folder.succeed(&trolley(&format!("{kick} 1e-3"))).output;
    assert!(small.contains("none was found that ends elsewhere") && !small.contains("return\n"), "{small}");
    assert!(small.contains("tried 1.5625e-5 rad apart") && !small.contains("replay"), "{small}");
    let large = folder.json(&trolley(&format!("{kick} 0.6")));
    assert!(large["returns"].is_null() && large["fails"]["magnitude"].is_number());
    // As far as the smallest that ends elsewhere.
    let resolution = large["resolution"].as_f64().unwrap();
    assert!((0.33..0.35).contains(&(64.0 * resolution)), "{resolution}");
    let returning = folder.succeed("safe-kick --kind release-angle --largest 1e-3 --duration 1 -q").output;
    assert!(!returning.contains("below what does not return"), "{returning}");
}

#[test]
fn what_cannot_be_asked_for_is_refused() {
    let folder = Folder::new();
    for (command, reason) in [
        ("steady -s M_f=-1", "M_f = -1: out of range"),
        ("hopf --along M_f=0:1", "`M_f` cannot vary here"),
        ("chart --x v=1:9:5 --y M_f=0:1:5", "`M_f` cannot vary here"),
    ] {
        let run = folder.run(command);
        assert_eq!(run.exit_code, 2, "{command}: {}", run.messages);
        assert!(run.messages.contains(reason), "{command}: {}", run.messages);
    }
}

#[test]
fn small_motions_of_the_real_wheels_end_as_the_factor_of_a_swing_says() {
    let folder = Folder::new();
    for (wheel, safe) in
        [("dolly", true), ("nosegear", false), ("office", true), ("trolley", true), ("wheelchair", true)]
    {
        let wheel = format!("--wheel {WHEELS}/{wheel}.toml -s M_f=0.1");
        let stability = folder.json(&format!("stability {wheel}"));
        assert_eq!(stability["stable"], false);
        assert_eq!(stability["swing_factor"].as_f64().unwrap().abs() < 1.0, safe, "{wheel}");
        let kick = "safe-kick --kind release-angle --largest 1.5e-4 --contact sliding --duration 1 -q";
        let kick = folder.json(&format!("{kick} {wheel}"));
        for direction in ["positive", "negative"] {
            // All that were tried return, or none.
            assert_eq!(kick[direction].is_null(), safe, "{wheel}: {}", kick[direction]);
            assert!(safe || kick[direction]["fails"] == 0.0, "{wheel}: {}", kick[direction]);
        }
    }
}

#[test]
fn margins_follow_the_moment_and_vanish_where_swings_grow() {
    let folder = Folder::new();
    let margin = "margin TROLLEY --kind release-angle --contact sliding --duration 1 --largest 0.004 -q";
    let along_moment = folder.succeed(&trolley(&format!("{margin} --along M_f=0:0.005:2"))).output;
    let lines: Vec<&str> = along_moment.lines().collect();
    assert!(lines[4].ends_with("the uniform motion is unstable"), "{along_moment}");
    assert!(lines[5].ends_with("all that were tried return"), "{along_moment}");
    assert!(along_moment.contains("whatever M_f"), "{along_moment}");
    // The critical speed with friction is 8.33 m/s.
    let along_speed = folder.succeed(&trolley(&format!("{margin} --along v=8:9:2 -s M_f=0.3"))).output;
    let lines: Vec<&str> = along_speed.lines().collect();
    assert!(lines[4].ends_with("all that were tried return"), "{along_speed}");
    assert!(lines[5].ends_with("small motions grow in spite of dry friction"), "{along_speed}");
}

/// On a tyre: simulated just below the blow that is told the caster swings once, just above it again.
#[test]
fn the_blow_that_leaves_the_rest_is_told_by_steady_and_stability() {
    let folder = Folder::new();
    let tyre = "TROLLEY -s tyre=brush -s sigma=0.05 -s a=0.02 -s C_alpha=3000 -s M_f=1";
    let edge = folder.json(&trolley(&format!("stability {tyre}")))["blow_out_of_rest"].clone();
    assert_eq!(folder.json(&trolley(&format!("steady {tyre}")))["blow_out_of_rest"], edge);
    assert_eq!(edge["method"], "simulation");
    assert_eq!(edge["ends_in"], "rest");
    let blow = edge["blow"].as_f64().unwrap();
    assert!(edge["resolution"].as_f64().unwrap() <= 1e-6 * blow, "{edge}");
    for (part, once) in [(0.99, true), (1.01, false)] {
        let replay = format!("simulate {tyre} --blow {} --duration 30", part * blow);
        let motion = folder.json(&trolley(&replay));
        let phases = motion["phases"].as_array().unwrap();
        let swings = phases.iter().filter(|phase| phase["king_pin"] == "swinging").count();
        assert_eq!(swings == 1, once, "{part}: {}", motion["phases"]);
    }
    // A rigid wheel that rolls rests at one angle only; without friction nothing is told.
    let rigid = folder.json(&trolley("stability TROLLEY -s M_f=1"));
    assert_eq!(rigid["blow_out_of_rest"]["blow"], 0.0);
    assert_eq!(rigid["blow_out_of_rest"]["method"], "closed form");
    assert!(folder.json(&trolley("steady TROLLEY")).get("blow_out_of_rest").is_none());
    // Held at any angle while it slides.
    let held = folder.json("stability -s M_f=0.6 -s F_Az=-3 -s v=1 -s r=inf");
    assert!(held["blow_out_of_rest_while_sliding"]["blow"].is_null());
}

/// On axes with the speed a chart has the limit with dry friction as a curve, which is the critical speed of `stability`.
#[test]
fn a_chart_over_the_speed_has_the_limit_with_friction() {
    let folder = Folder::new();
    let chart = "chart TROLLEY -s c_psi=0 -s M_f=0.05 -q";
    for axes in ["--x v=1:15:5 --y l=0.03:0.1:5", "--y v=1:15:5 --x l=0.03:0.1:5"] {
        let speed = usize::from(axes.starts_with("--y"));
        let result = folder.json(&trolley(&format!("{chart} {axes}")));
        let curves = result["friction_boundary"].as_array().unwrap();
        let points: Vec<[f64; 2]> = curves
            .iter()
            .flat_map(|curve| curve.as_array().unwrap())
            .map(|point| [0, 1].map(|place| point[place].as_f64().unwrap()))
            .collect();
        assert!(points.len() > 10, "{result}");
        for point in points.iter().step_by(points.len() / 3) {
            let stability = format!("stability TROLLEY -s c_psi=0 -s l={}", point[1 - speed]);
            let told = folder.json(&trolley(&stability))["critical_speed_with_friction"].as_f64().unwrap();
            assert!((told - point[speed]).abs() < 1e-6 * told, "{point:?} {told}");
        }
        let run = folder.succeed(&trolley(&format!("{chart} {axes}")));
        assert!(
            run.output.contains("over the chart the limit up to which they die out is at "),
            "{}",
            run.output
        );
    }
    for without in ["chart TROLLEY -s M_f=0.05 --x k=1e4:2e4:3 --y l=0.03:0.1:3", "chart TROLLEY --x v=1:9:3"]
    {
        assert!(folder.json(&trolley(without)).get("friction_boundary").is_none(), "{without}");
    }
}
