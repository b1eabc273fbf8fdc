//! Bad input: a message that says what is wrong and what is allowed, the right exit code, no panic, no file.

use crate::Folder;
use std::process::Command;

/// Runs the program, which must fail with the exit code, and a message with all the words, without a file.
#[track_caller]
pub(crate) fn fails(arguments: &str, exit_code: i32, words: &[&str]) {
    fails_in(&Folder::new(), arguments, exit_code, words);
}

#[track_caller]
pub(crate) fn fails_in(folder: &Folder, arguments: &str, exit_code: i32, words: &[&str]) {
    let before = folder.files();
    let run = folder.run(arguments);
    assert_eq!(run.exit_code, exit_code, "{arguments}: {}", run.messages);
    assert_eq!(run.output, "", "{arguments}");
    assert!(run.messages.starts_with("error: "), "{}", run.messages);
    assert!(!run.messages.contains("panicked"), "{}", run.messages);
    for word in words {
        assert!(run.messages.contains(word), "{arguments}: no `{word}` in {}", run.messages);
    }
    assert_eq!(folder.files(), before, "{arguments}");
}

#[test]
fn every_parameter_outside_its_range() {
    for key in kingpin::Key::ALL {
        let allowed = key.allowed();
        let mut wrong = vec!["nan".to_owned(), "-inf".to_owned(), "1e300".to_owned(), "-1e300".to_owned()];
        if allowed.lowest >= 0.0 {
            wrong.push("-1".to_owned());
        }
        if allowed.lowest > 0.0 {
            wrong.push("0".to_owned());
        }
        if !allowed.infinite {
            wrong.push("inf".to_owned());
        }
        wrong.push("abc".to_owned());
        for value in wrong {
            fails(
                &format!("steady -s {key}={value} -o a.json"),
                2,
                &[&format!("--set {key}={value}"), "allowed", key.unit()],
            );
        }
    }
}

#[test]
fn a_typo_in_a_key() {
    fails("steady -s kq=100", 2, &["--set kq=100", "unknown key `kq`", "`k_q`", "N/m"]);
    fails("chart --x vv=1:2:3", 2, &["unknown key `vv`", "`v`"]);
    fails("steady -s foo=1", 2, &["unknown key `foo`; the keys are v, l, r, "]);
    fails("simulate --duration 1 --perturb phi=0.1", 2, &["`phi`", "u, q, psi, V, Omega"]);
    fails("steady -s v", 2, &["'v'", "KEY=VALUE"]);
}

#[test]
fn sliding_friction_above_static_friction() {
    let words = &["mu_d = 2", "at most mu_s = 1"];
    for command in ["steady", "stability", "basin", "simulate --duration 1", "safe-kick"] {
        fails(&format!("{command} -s mu_d=2"), 2, words);
    }
}

#[test]
fn a_wheel_file_that_cannot_be_used() {
    let folder = Folder::new();
    fails_in(&folder, "steady --wheel missing.toml", 2, &["missing.toml", "cannot read"]);
    std::fs::write(folder.path("typo.toml"), "v = 4\nmw = 1\n").unwrap();
    fails_in(&folder, "steady --wheel typo.toml", 2, &["typo.toml", "line 2", "`mw`", "`m_w`"]);
    std::fs::write(folder.path("range.toml"), "v = 4\n\n  l = -1\n").unwrap();
    fails_in(&folder, "steady --wheel range.toml", 2, &["range.toml", "line 3", "l = -1", "allowed"]);
    std::fs::write(folder.path("disagree.toml"), "tyre = \"linear\"\n").unwrap();
    fails_in(&folder, "steady --wheel disagree.toml", 2, &["disagree.toml: tyre = linear needs "]);
    std::fs::write(folder.path("section.toml"), "[wheel]\nv = 4\n").unwrap();
    fails_in(&folder, "steady --wheel section.toml", 2, &["section.toml", "line 1", "there are no sections"]);
    std::fs::write(folder.path("syntax.toml"), "v = = 4\n").unwrap();
    fails_in(&folder, "steady --wheel syntax.toml", 2, &["syntax.toml", "TOML"]);
    fails_in(&folder, "steady --wheel .", 2, &["cannot read"]);
}

#[test]
fn files_that_cannot_be_written() {
    let folder = Folder::new();
    std::fs::write(folder.path("file"), "").unwrap();
    std::fs::create_dir(folder.path("folder.json")).unwrap();
    fails_in(&folder, "steady -o missing/a.json", 2, &["missing/a.json", "cannot write", "no file was left"]);
    fails_in(&folder, "steady -o file/a.json", 2, &["file/a.json", "cannot write"]);
    fails_in(&folder, "steady -o folder.json", 2, &["folder.json", "cannot write"]);
    #[cfg(target_os = "linux")]
    fails_in(&folder, "steady -o /proc/a.json", 2, &["/proc/a.json", "cannot write"]);
    assert!(std::fs::read_dir(folder.path("folder.json")).unwrap().next().is_none());
}

#[test]
fn endings_that_are_not_known() {
    fails("steady -o a.txt", 2, &["--out a.txt", ".json, .csv, .parquet"]);
    fails("steady -o a.svg", 2, &["--out a.svg", ".json, .csv, .parquet"]);
    fails("chart -o a.jpg", 2, &["--out a.jpg", ".json, .csv, .parquet, .svg, .png, .pdf"]);
    fails("chart -o a", 2, &["--out a", ".json"]);
}

#[test]
fn ranges_that_make_no_sense() {
    for (range, word) in [
        ("v=1:1:10", "empty interval"),
        ("v=1:2:1", "at least 2"),
        ("v=1:2:0", "at least 2"),
        ("v=1:2:99999999999999999999", "at least 2"),
        ("v=1:2", "KEY=A:B:N"),
        ("v=nan:2:5", "`nan` is not a number"),
        ("v=-1:2:5", "v = -1"),
        ("v=1:inf:5", "v = inf"),
        ("v=1:2:10000000", "at most 10000000 points"),
        ("v=1:2:9223372036854775807", "at most 10000000 points"),
        ("l=0.01:0.1:5", "cannot vary together"),
    ] {
        fails(&format!("chart --x {range} -o a.svg"), 2, &[word]);
    }
}

#[test]
fn no_uniform_motion() {
    fails("steady -s l=2", 1, &["no uniform motion", "|l - a0| < r fails", "raise r or lower l"]);
    fails("stability -s l=2 -o a.json", 1, &["no uniform motion"]);
    fails("damper --up-to l=3", 2, &["--up-to", "v=VALUE"]);
    fails("damper --up-to v=0", 2, &["a speed above 0"]);
    fails("damper --up-to v=-1", 2, &["--up-to v=-1"]);
    fails("steady -s v=0", 1, &["v = 0", "set v above 0"]);
    fails("steady -s v=0 -s r=inf", 1, &["l = 0.08 m, r = inf: at v = 0"]);
    fails("steady -s v=200", 1, &["m omega^2 < k l fails", "lower v"]);
    fails("simulate --duration 1 -s v=0", 1, &["v = 0"]);
}

#[test]
fn what_is_given_twice_is_told() {
    let folder = Folder::new();
    for (given, word) in
        [("-s k=10 -s k_u=20", "`k` sets"), ("-s curvature=0.5 -s r=3", "`curvature` sets r")]
    {
        let messages = folder.succeed(&format!("steady {given}")).messages;
        assert!(messages.contains(word), "{given}: {messages}");
    }
    assert_eq!(folder.succeed("steady -s r=3").messages, "");
}

#[test]
fn simulations_that_cannot_be_run() {
    for duration in ["0", "-1", "nan", "inf"] {
        fails(&format!("simulate --duration {duration}"), 2, &["duration", "positive and finite"]);
    }
    fails("simulate --duration x", 2, &["'x'", "--duration"]);
    fails("simulate --duration 1 --points 1", 2, &["--points", "2..="]);
    fails("simulate --duration 1 --points 99999999", 2, &["--points", "1000000"]);
    fails("simulate --duration 1 --perturb psi=x", 2, &["--perturb psi=x", "not a number"]);
    fails("simulate --duration 1 --perturb psi=nan", 2, &["psi", "finite"]);
    // Beyond the unstable cycle the ideally rolling wheel escapes.
    fails("simulate --duration 1e6 -s v=8 --perturb Omega=200 -o a.json", 1, &["cannot be followed"]);
}

/// The slip of so short a motion is so small that its square is zero.
#[test]
fn the_friction_of_the_shortest_motions_is_finite() {
    for duration in ["1e-20", "1e-160", "1e-200", "1e-300", "5e-324"] {
        for perturbation in ["", "--perturb psi=0.1", "--perturb Omega=3"] {
            let command = format!(
                "simulate --contact sliding --duration {duration} {perturbation} --points 5 --format csv"
            );
            let table = Folder::new().succeed(&command).output;
            let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
            let [force, phase] = ["friction_force", "phase"]
                .map(|name| names.iter().position(|other| *other == name).unwrap());
            let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
            assert!(
                rows.iter().flatten().all(|entry| entry.parse::<f64>().map_or(true, f64::is_finite)),
                "{table}"
            );
            // mu_d N while it slides.
            let end = rows.last().unwrap();
            let value: f64 = end[force].parse().unwrap();
            assert!(end[phase] == "sliding" && (value - 0.8 * 4.107447).abs() < 1e-12, "{command}: {table}");
        }
    }
}

#[test]
fn no_hopf_point_on_the_way() {
    let words = [
        "no Hopf point for v from 1 to 5",
        "stable at v = 1 m/s",
        "stable at v = 5 m/s",
        "its stability changes at 8.431037 m/s",
    ];
    fails("hopf --along v=1:5 -o a.json", 1, &words);
    fails("cycles --along v=1:5 -o a.svg", 1, &words);
    fails(
        "hopf --along v=1:5 -s r=inf",
        1,
        &["no Hopf point", "r = inf", "stable at v = 1 m/s", "stable at v = 5 m/s"],
    );
    fails("hopf --along l=2:5", 1, &["no uniform motion", "|l - a0| < r"]);
    // No interval is wide enough for what stability does not depend on.
    for along in ["mu_s=0.5:1", "g=5:15", "F_Az=-100:-10"] {
        fails(&format!("hopf --along {along}"), 1, &["does not act on the stability of this wheel"]);
    }
}

#[test]
fn branches_that_make_no_sense() {
    fails("hopf --along v=1", 2, &["KEY=A:B"]);
    fails("hopf --along v=1:inf", 2, &["v = inf", "allowed"]);
    fails("hopf --along r=inf:inf", 2, &["empty interval"]);
    fails("hopf --along w=1:2", 2, &["unknown key `w`"]);
    fails("hopf", 2, &["--along"]);
    fails("cycles --along v=1:9 --at 10", 2, &["--at 10", "outside the interval", "1 to 9"]);
    fails("cycles --along v=1:9 --at l=5", 2, &["--at l", "values of v"]);
    fails("cycles --along v=1:9 --at x", 2, &["`x` is not a number"]);
}

#[test]
fn labels_that_cannot_be_started_from() {
    let folder = Folder::new();
    fails_in(&folder, "cycles --from missing.json:HB1 --along v=1:9", 2, &["missing.json", "cannot be read"]);
    fails_in(&folder, "cycles --from hopf.json --along v=1:9", 2, &["FILE:LABEL"]);
    folder.succeed("hopf --along v=1:12 -q -o hopf.json");
    fails_in(&folder, "cycles --from hopf.json:HB7 --along v=1:9", 2, &["`HB7`", "the labels are: HB1"]);
    fails_in(&folder, "cycles --from hopf.json:HB1 --along v=1:5", 2, &["outside 1:5"]);
    fails_in(&folder, "cycles --from hopf.json:HB1 --along v=1:9 --wheel w.toml", 2, &["--wheel", "--from"]);
    fails_in(&folder, "cycles --from orbit.csv --along v=1:9", 2, &["orbit.csv", "cannot be read"]);
    fails_in(&folder, "cycles --from hopf.json:HB1 --along v=1:9 -s l=0.1", 1, &["HB1 is no Hopf point"]);
    folder.succeed("steady -q -o steady.json");
    fails_in(&folder, "cycles --from steady.json:HB1 --along v=1:9", 2, &["kingpin.hopf or kingpin.cycles"]);
    std::fs::write(folder.path("text.json"), "no JSON").unwrap();
    fails_in(&folder, "cycles --from text.json:HB1 --along v=1:9", 2, &["text.json", "line 1"]);
}

#[test]
fn an_orbit_that_was_tampered_with() {
    let folder = Folder::new();
    folder.succeed("cycles --along v=7:9 --at 8 -q -o good.json");
    let good: serde_json::Value = serde_json::from_slice(&crate::read(&folder.path("good.json"))).unwrap();
    let place = good["points"].as_array().unwrap().iter().position(|point| point["label"] == "AT1").unwrap();
    for (field, value, word) in [
        ("period", serde_json::json!(-1.0), "period"),
        ("mesh", serde_json::json!([0.0, 0.5, 0.4, 1.0]), "rise from 0 to 1"),
        ("states", serde_json::json!([1.0, 2.0]), "finite numbers"),
        ("degree", serde_json::json!(99), "degree 99"),
        ("dimension", serde_json::json!(3), "3 states"),
    ] {
        let mut bad = good.clone();
        bad["points"][place]["orbit"][field] = value;
        std::fs::write(folder.path("bad.json"), bad.to_string()).unwrap();
        fails_in(&folder, "cycles --from bad.json:AT1 --along v=7:9", 2, &["bad.json", "orbit of AT1", word]);
    }
    let mut bad = good.clone();
    bad["parameters"]["l"] = serde_json::json!(-1.0);
    std::fs::write(folder.path("bad.json"), bad.to_string()).unwrap();
    fails_in(&folder, "cycles --from bad.json:AT1 --along v=7:9", 2, &["bad.json", "l = -1", "allowed"]);
}

#[test]
fn options_that_do_not_exist() {
    fails("steady --colour", 2, &["--colour"]);
    fails("stedy", 2, &["stedy", "steady"]);
    fails("chart --threads 0", 2, &["--threads"]);
    fails("steady --format xml", 2, &["xml", "table, json, csv"]);
    let output = Command::new(env!("CARGO_BIN_EXE_kingpin")).output().unwrap();
    assert_eq!(output.status.code(), Some(2)); // without a command it says what there is
    assert!(String::from_utf8_lossy(&output.stderr).contains("Usage: kingpin"));
}
