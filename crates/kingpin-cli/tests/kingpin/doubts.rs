//! What is told of numbers with which a verdict means nothing, or that no wheel has.

use crate::Folder;

/// Words that are told where nothing presses the wheel on the ground.
const LIFTED: &str = "nothing presses the wheel on the ground, N = -F_Az + (m_w + m_c) g = -5.892553 N";

#[test]
fn a_wheel_that_is_lifted_is_told_by_every_command() {
    let folder = Folder::new();
    for command in [
        "steady",
        "stability",
        "hopf --along v=1:12",
        "cycles --along v=7:9",
        "chart --x v=0.1:10:5 --y l=0.03:0.2:5",
        "damper --up-to v=3 --small-motions",
        "steady --along v=1:4:4",
        "simulate --duration 0.1 --contact rolling",
    ] {
        let told = folder.succeed(&format!("{command} -s F_Az=10")).messages;
        assert!(told.contains(LIFTED) && told.contains("F_Az = 10 N pulls upwards"), "{command}: {told}");
        let told = folder.succeed(&format!("{command} -s g=0")).messages;
        assert!(told.contains("(m_w + m_c) g = 0 N: the ground cannot pull"), "{command}: {told}");
        let told = folder.succeed(&format!("{command} -s F_Az=-10")).messages;
        assert!(!told.contains("presses"), "{command}: {told}");
    }
    let steady = folder.succeed("steady -s F_Az=10").output;
    assert!(steady.contains("no: nothing presses the wheel on the ground"), "{steady}");
}

/// With a linear tyre, whose law knows no load, and with lateral elasticity only.
#[test]
fn whatever_the_model() {
    let tyre = "-s tyre=linear -s sigma=0.02 -s C_alpha=100 -s r=inf";
    for wheel in [tyre, "-s k_u=inf"] {
        let told = Folder::new().succeed(&format!("stability {wheel} -s F_Az=10")).messages;
        assert!(told.contains(LIFTED), "{wheel}: {told}");
    }
}

#[test]
fn where_the_load_varies_it_is_told_over_which_part() {
    let folder = Folder::new();
    for (command, words) in [
        (
            "chart --x F_Az=-10:10:5 --y l=0.03:0.2:5",
            "nothing presses the wheel on the ground over a part of F_Az,",
        ),
        (
            "chart --x F_Az=5:10:5 --y l=0.03:0.2:5",
            "nothing presses the wheel on the ground at any F_Az here,",
        ),
        (
            "chart --x m_w=0.1:1:5 --y l=0.03:0.2:5 -s F_Az=5",
            "nothing presses the wheel on the ground over a part of m_w,",
        ),
        ("steady --along F_Az=-10:10:5", "goes from -5.892553 to 14.107447 N"),
    ] {
        let told = folder.succeed(command).messages;
        assert!(told.contains(words), "{command}: {told}");
    }
    let told = folder.succeed("chart --x F_Az=-10:-5:5 --y l=0.03:0.2:5 -s F_Az=10").messages;
    assert_eq!(told, "");
}

#[test]
fn a_report_says_it_first_and_gives_no_other_reason() {
    let folder = Folder::new();
    let report = folder.succeed("report -s F_Az=10 -s v=2 --up-to v=3 -q").output;
    let verdict = report.split("verdict\n").nth(1).unwrap().trim_start();
    assert!(verdict.starts_with("Nothing presses the wheel on the ground"), "{report}");
    assert!(
        !report.contains("it slides at every speed") && !report.contains("more friction than"),
        "{report}"
    );
}

#[test]
fn numbers_in_other_units_are_told() {
    let folder = Folder::new();
    for (given, words) in [
        ("-s l=80 -s r=inf", "l = 80 m is not that of a wheel: at most 100 R = 4 m"),
        ("-s m_w=351.9 -s r=inf", "is it in g? that is 0.3519 kg"),
        ("-s J_wxi=46.3", "a thin rim has; is it in kg mm^2? that is 4.63e-5 kg m^2"),
        ("-s J_wzeta=1e-5", "J_wzeta = 1e-5 kg m^2 is not that of a wheel: at least J_wxi/2"),
    ] {
        let told = folder.succeed(&format!("stability {given}")).messages;
        assert!(told.contains(words), "{given}: {told}");
    }
    assert_eq!(folder.succeed("stability").messages, "");
    // Along a parameter its own value does not count.
    assert_eq!(folder.succeed("chart --x v=0.1:10:5 --y l=0.03:0.2:5 -s l=80").messages, "");
}
