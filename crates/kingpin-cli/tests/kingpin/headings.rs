//! What results say of the wheel: its file and what was changed on one line, what a file leaves out, and which stiffness counts.

use crate::Folder;

const WHEELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");

#[test]
fn a_heading_is_one_line_and_names_the_file() {
    let folder = Folder::new();
    for wheel in ["dolly", "nosegear", "office", "trolley", "wheelchair"] {
        for command in [
            "steady",
            "stability",
            "damper --up-to v=1 --small-motions",
            "simulate --duration 0.1",
            "chart --x v=1:2:3",
        ] {
            let file = format!("--wheel {WHEELS}/{wheel}.toml");
            let run = folder.succeed(&format!("{command} {file} -s r=2 -q"));
            let heading = run.output.lines().next().unwrap();
            assert!(
                heading.contains(&format!("({wheel}.toml but for r)")) || command.contains("--x"),
                "{heading}"
            );
            assert!(heading.len() < 150, "{heading}");
            assert_eq!(run.messages, "");
        }
    }
    let changes = "-s l=0.05 -s k_q=20000 -s c_psi=0.02 -s M_f=0.3";
    let run = folder.succeed(&format!("stability --wheel {WHEELS}/trolley.toml {changes}"));
    let told = "v = 1.5 m/s, l = 0.05 m, r = inf, k_q = 20000 N/m, c_psi = 0.02 N m s/rad, M_f = 0.3 N m, F_Az = -150 N \
                (trolley.toml but for l, k_q, c_psi, M_f): ";
    assert!(run.output.contains(told), "{}", run.output);
}

/// A start from a labelled point of a result has the wheel of that file.
#[test]
fn the_wheel_of_a_result_is_named_after_the_result() {
    let folder = Folder::new();
    folder.succeed("hopf --along v=1:12 -s l=0.1 -s c_q=0.01 -q -o born.json");
    let run = folder.succeed("cycles --from born.json:HB1 --along v=7:10 -q");
    let heading = run.output.lines().next().unwrap();
    assert_eq!(heading, "limit cycles at l = 0.1 m, r = 1 m, c_q = 0.01 N s/m (born.json)");
}

#[test]
fn what_a_file_leaves_to_the_papers_wheel_is_said() {
    let folder = Folder::new();
    std::fs::write(folder.path("cart.toml"), "v = 2\nm_w = 1\nk_q = 300\nl_c = 0.03\n").unwrap();
    let left = "cart.toml does not say m_c, J_wxi, J_wzeta, J_Cz, R, k_u: taken from the paper's wheel";
    let run = folder.succeed("steady --wheel cart.toml");
    assert!(run.messages.contains(left), "{}", run.messages);
    let run = folder.succeed("steady --wheel cart.toml -s k_u=300 -s R=0.1");
    assert!(run.messages.contains("does not say m_c, J_wxi, J_wzeta, J_Cz: "), "{}", run.messages);
    assert_eq!(folder.succeed("steady --wheel cart.toml -q").messages, "");
    assert_eq!(folder.succeed("steady -s m_w=1 -s k_q=300").messages, "");
}

#[test]
fn which_stiffness_counts_is_said() {
    let folder = Folder::new();
    std::fs::write(folder.path("both.toml"), "k_q = 50\nk = 200\n").unwrap();
    for (arguments, values) in [
        ("-s k=200 -s k_q=50", Some("k_u = 200 N/m, k_q = 50 N/m")),
        ("-s k_q=50 -s k=200", Some("k_u = 200 N/m, k_q = 200 N/m")),
        ("-s k_u=50 -s k=200", Some("k_u = 200 N/m, k_q = 200 N/m")),
        ("--wheel both.toml", Some("k_u = 200 N/m, k_q = 50 N/m")),
        ("--wheel both.toml -s l=0.1", Some("k_u = 200 N/m, k_q = 50 N/m")),
        ("-s k=200", None),
        ("-s k_u=200 -s k_q=50", None),
    ] {
        let run = folder.succeed(&format!("steady {arguments}"));
        let remark = run.messages.lines().find(|line| line.contains("`k` sets"));
        assert_eq!(remark.is_some(), values.is_some(), "{arguments}: {}", run.messages);
        if let Some(value) = values {
            assert!(remark.unwrap().contains(value), "{arguments}: {}", run.messages);
            assert!(
                run.output.lines().next().unwrap().contains(value) || arguments.contains("toml"),
                "{}",
                run.output
            );
        }
    }
}

#[test]
fn unknown_keys_are_sought_by_what_they_mean() {
    let folder = Folder::new();
    for (given, meant) in [
        ("stiffness", vec!["`k`", "`k_u`", "`k_q`"]),
        ("caster_length", vec!["`l`"]),
        ("speed", vec!["`v`"]),
        ("damping", vec!["`c_psi`", "`c_q`", "`c_u`"]),
        ("trail", vec!["`l`"]),
        ("radius", vec!["`r`", "`R`"]),
        ("friction", vec!["`mu_s`", "`M_f`"]),
        ("mass", vec!["`m_w`", "`m_c`"]),
        ("inertia", vec!["`J_wxi`", "`J_wzeta`", "`J_Cz`"]),
        ("tire", vec!["`tyre`"]),
    ] {
        std::fs::write(folder.path("wheel.toml"), format!("v = 1\n{given} = 2\n")).unwrap();
        for arguments in [format!("-s {given}=2"), "--wheel wheel.toml".to_owned()] {
            let run = folder.run(&format!("steady {arguments}"));
            assert_eq!(run.exit_code, 2);
            assert!(run.messages.contains(&format!("unknown key `{given}`")), "{}", run.messages);
            for key in &meant {
                assert!(run.messages.contains(&format!("{key} (")), "{given}: no {key} in {}", run.messages);
            }
        }
    }
}

/// However much is changed, all of it is told.
#[test]
fn a_heading_hides_no_key() {
    let folder = Folder::new();
    let keys = "m_w=1 m_c=2 R=0.1 l_c=0.03 k_u=300 k_q=200 c_u=2 c_q=1 mu_s=0.5 J_Cz=1e-5 J_wxi=1e-3 c_psi=0.1 k_psi=0.2";
    let set: String = keys.split(' ').map(|key| format!(" -s {key}")).collect();
    for command in ["steady", "stability", "chart --x v=1:2:3", "safe-kick --duration 1 --largest 1e-3"] {
        let output = folder.succeed(&format!("{command}{set} -q")).output;
        let heading = output.split("\n\n").next().unwrap();
        for key in keys.split(' ') {
            let key = key.split('=').next().unwrap();
            assert!(heading.contains(&format!(" {key} = ")), "{key}: {heading}");
        }
        assert!(heading.lines().all(|line| line.len() < 150), "{heading}");
    }
}
