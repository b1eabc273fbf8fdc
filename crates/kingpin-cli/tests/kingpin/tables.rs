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
        let damper = Folder::new().succeed(&format!("damper --up-to v=3 -q --wheel {file}/{wheel}.toml"));
        insta::assert_snapshot!(format!("damper_{wheel}"), damper.output);
    }
}

#[test]
fn damper() {
    insta::assert_snapshot!(Folder::new().succeed("damper --up-to v=30 -q").output);
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
