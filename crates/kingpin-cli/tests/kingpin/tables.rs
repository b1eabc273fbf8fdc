//! Results as people read them.

use crate::Folder;

#[test]
fn steady() {
    insta::assert_snapshot!(Folder::new().succeed("steady").output);
    insta::assert_snapshot!(Folder::new().succeed("steady -s v=2 -s l=0.1 -s r=inf -s c_q=0.05").output);
}

#[test]
fn stability() {
    insta::assert_snapshot!(Folder::new().succeed("stability -s v=9").output);
    insta::assert_snapshot!(Folder::new().succeed("stability -s r=inf").output);
}

#[test]
fn real_wheels() {
    for wheel in ["dolly", "nosegear", "office", "trolley", "wheelchair"] {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
        let straight = Folder::new().succeed(&format!("stability --wheel {file}/{wheel}.toml"));
        insta::assert_snapshot!(format!("stability_{wheel}"), straight.output);
        let damper = Folder::new()
            .succeed(&format!("damper --up-to v=3 --small-motions -q --wheel {file}/{wheel}.toml"));
        insta::assert_snapshot!(format!("damper_{wheel}"), damper.output);
    }
}

/// On a circle of 2 m, at nearly the largest speed at which they roll.
#[test]
fn real_wheels_on_a_circle() {
    let wheels =
        [("dolly", 20.0), ("nosegear", 18.4), ("office", 42.2), ("trolley", 21.3), ("wheelchair", 18.7)];
    for (wheel, speed) in wheels {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
        let wheel_there = format!("--wheel {file}/{wheel}.toml -s r=2 -s v={speed}");
        let rolls = |speed: f64| {
            let steady = format!("steady --wheel {file}/{wheel}.toml -s r=2 -s v={speed}");
            Folder::new().json(&steady)["rolls"].as_bool()
        };
        assert_eq!([rolls(speed), rolls(1.02 * speed)], [Some(true), Some(false)], "{wheel}");
        let stability = Folder::new().succeed(&format!("stability {wheel_there}"));
        insta::assert_snapshot!(format!("stability_circle_{wheel}"), stability.output);
        let hopf = Folder::new().run(&format!("hopf -q {wheel_there} --along v=0.5:{speed}"));
        insta::assert_snapshot!(format!("hopf_circle_{wheel}"), format!("{}{}", hopf.output, hopf.messages));
    }
}

#[test]
fn damper() {
    insta::assert_snapshot!(Folder::new().succeed("damper --up-to v=30 --small-motions -q").output);
}

#[test]
fn report() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels/trolley.toml");
    let wheels = [
        ("paper", String::new()),
        ("loaded", "-s F_Az=-20 -s v=3 -s r=2".to_owned()),
        ("trolley", format!("--wheel {file}")),
        ("damped", format!("--wheel {file} -s c_psi=0.02 --up-to v=3")),
    ];
    for (name, wheel) in wheels {
        let folder = Folder::new();
        let run = folder.succeed(&format!("report -q --out page {wheel}"));
        insta::assert_snapshot!(format!("report_{name}"), run.output);
        let page = std::fs::read_to_string(folder.path("page/report.html")).unwrap();
        for file in run.output.lines().filter(|line| line.ends_with(".svg")) {
            let file = file.rsplit(['/', '\\']).next().unwrap();
            assert!(page.contains(file), "{file}");
        }
    }
    let run = Folder::new().run("report -q --up-to v=1");
    assert_eq!(run.exit_code, 2);
    insta::assert_snapshot!("report_slower_than_the_wheel", run.messages);
}

#[test]
fn chart() {
    insta::assert_snapshot!(
        Folder::new().succeed("chart --x v=0.1:12:120 --y l=0.02:0.3:57 -s F_Az=-20").output
    );
}

#[test]
fn simulate() {
    let run = Folder::new().succeed("simulate --duration 2 --perturb psi=0.1 --perturb V=-0.2");
    insta::assert_snapshot!(run.output);
    insta::assert_snapshot!(run.messages);
}

#[test]
fn hopf() {
    insta::assert_snapshot!(Folder::new().succeed("hopf --along v=1:12").output);
}

#[test]
fn cycles() {
    insta::assert_snapshot!(Folder::new().succeed("cycles --along v=2:9 --at 4").output);
}

#[test]
fn help() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.succeed("chart -h").output);
    let long = folder.succeed("chart --help").output;
    assert!(long.contains("J_wzeta") && long.contains("J_wζ") && long.contains("kg m^2"), "{long}");
}
