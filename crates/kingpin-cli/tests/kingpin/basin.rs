//! Where motions end, and the smallest disturbances that do not return.

use crate::{Folder, read};
use serde_json::Value;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const GRID: &str = "basin --x psi=-1:1:24 --y Omega=-60:60:20 -s v=6";

#[test]
fn tables() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.succeed(GRID).output);
    insta::assert_snapshot!(folder.succeed("basin --samples 300 --seed 7 -s v=6").output);
    insta::assert_snapshot!(folder.succeed("safe-kick -s v=6").output);
    insta::assert_snapshot!(folder.succeed("safe-kick --kind jolt -s v=2").output);
    insta::assert_snapshot!(folder.succeed("margin --along v=5:7:3 --kind release-angle").output);
}

#[test]
fn basin_has_the_fields_that_scripts_rely_on() {
    let folder = Folder::new();
    let result = folder.json(&format!("{GRID} -q"));
    assert_eq!(result["schema"], serde_json::json!({"name": "kingpin.basin", "version": 1}));
    assert_eq!(result["x"]["state"], "psi");
    assert_eq!(result["y"]["unit"], "rad/s");
    let fates = result["fates"].as_array().unwrap();
    assert_eq!(fates.len(), 480);
    // Near the uniform motion all return, at the corner of rows and columns 0 and 19 the caster turns right round.
    assert_eq!(fates[24 * 10 + 12], "uniform motion");
    assert_eq!(fates[24 * 19], "tumbling");
    let shares = result["fractions"].as_array().unwrap();
    let total: f64 = shares.iter().map(|fraction| fraction["share"].as_f64().unwrap()).sum();
    assert!((total - 1.0).abs() < 1e-12);
    let sample = folder.json("basin --samples 300 --seed 7 -s v=6 -q");
    let returned = &sample["fractions"][0];
    let share = shares[0]["share"].as_f64().unwrap();
    // Two counts of the same basin: the grid's share is within twice the interval of the sample.
    let [low, high] = [0, 1].map(|end| returned["interval"][end].as_f64().unwrap());
    assert!((share - 0.5 * (low + high)).abs() < high - low, "{share} {low} {high}");
}

#[test]
fn basins_are_the_same_on_any_number_of_threads() {
    let folder = Folder::new();
    for threads in [1, 2, 3] {
        folder.succeed(&format!("{GRID} -q --threads {threads} -o {threads}.json -o {threads}.svg"));
    }
    for ending in ["json", "svg"] {
        let first = read(&folder.path(&format!("1.{ending}")));
        assert!(first == read(&folder.path(&format!("2.{ending}"))));
        assert!(first == read(&folder.path(&format!("3.{ending}"))));
    }
    assert!(folder.files().iter().all(|name| !name.contains("journal")));
}

/// Starts the program and waits until so many lines are in its journal.
fn start(folder: &Folder, arguments: &str, journal: &str, lines: usize) -> Child {
    let mut child = Command::new(env!("CARGO_BIN_EXE_kingpin"))
        .args(arguments.split_whitespace())
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let path = folder.path(journal);
    while std::fs::read_to_string(&path).map_or(0, |text| text.lines().count()) < lines {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be interrupted");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn a_killed_run_is_resumed_without_computing_finished_cells_again() {
    let folder = Folder::new();
    let long = "basin --x psi=-1:1:120 --y Omega=-60:60:100 -s v=6 -q --threads 2 -o a.json";
    let mut child = start(&folder, long, "a.json.journal", 12);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!folder.path("a.json").exists());
    let kept = String::from_utf8(read(&folder.path("a.json.journal"))).unwrap();
    let whole: Vec<&str> = kept.split_inclusive('\n').filter(|line| line.ends_with('\n')).collect();
    assert!((12..189).contains(&whole.len()), "{}", whole.len());

    // Without --resume the kept run is not overwritten, another computation does not take it for its own.
    let refused = folder.run(long);
    assert!(refused.exit_code == 2 && refused.messages.contains("--resume"), "{}", refused.messages);
    let other = folder.run(&format!("{long} -s v=5 --resume"));
    assert!(
        other.exit_code == 2 && other.messages.contains("v was 6.0, now it is 5.0"),
        "{}",
        other.messages
    );
    assert_eq!(read(&folder.path("a.json.journal")), kept.as_bytes());

    // The same as in one go.
    folder.succeed(&long.replace("a.json", "whole.json"));
    folder.succeed(&format!("{long} --resume"));
    assert!(read(&folder.path("a.json")) == read(&folder.path("whole.json")));
    assert_eq!(folder.files(), ["a.json", "whole.json"]);

    // What the journal says of a finished tile is believed, not computed again.
    let [header, part] = [whole[0], whole[1]].map(|line| line.trim_end().split_once(' ').unwrap().1);
    let (number, _) = serde_json::from_str::<(usize, Vec<String>)>(part).unwrap();
    let told = serde_json::json!([number, vec!["shimmy"; 64]]).to_string();
    let checksum = crc32fast::hash(format!("{header}{told}").as_bytes());
    let altered = format!("{}{checksum:08x} {told}\n{}", whole[0], whole[2..].concat());
    std::fs::write(folder.path("a.json.journal"), altered).unwrap();
    folder.succeed(&format!("{long} --resume"));
    let fates = |name: &str| {
        let result: Value = serde_json::from_slice(&read(&folder.path(name))).unwrap();
        result["fates"].as_array().unwrap().clone()
    };
    let mut expected = fates("whole.json");
    expected[64 * number..64 * (number + 1)].fill(Value::from("shimmy"));
    assert!(fates("a.json") == expected);
}

#[test]
fn a_journal_that_was_changed_is_refused_with_line_and_remedy() {
    let folder = Folder::new();
    let long = "margin --along v=4:7:8 --kind release-angle --threads 1 -o a.csv";
    let mut child = start(&folder, long, "a.csv.journal", 4);
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = String::from_utf8(read(&folder.path("a.csv.journal"))).unwrap();
    // One digit of the second part that was kept.
    let line = kept.split_inclusive('\n').nth(2).unwrap();
    let digit = line.rfind(|character: char| character.is_ascii_digit()).unwrap();
    let other = if &line[digit..=digit] == "7" { "3" } else { "7" };
    let changed = kept.replace(line, &format!("{}{other}{}", &line[..digit], &line[digit + 1..]));
    std::fs::write(folder.path("a.csv.journal"), &changed).unwrap();
    let refused = folder.run(&format!("{long} --resume"));
    assert_eq!(refused.exit_code, 2, "{}", refused.messages);
    for word in ["--resume a.csv.journal", "line 3 was changed", "delete line 3"] {
        assert!(refused.messages.contains(word), "no `{word}` in {}", refused.messages);
    }
    assert_eq!(read(&folder.path("a.csv.journal")), changed.as_bytes());
    // The remedy helps.
    std::fs::write(folder.path("a.csv.journal"), kept.replace(line, "")).unwrap();
    folder.succeed(&format!("{long} --resume"));
    folder.succeed(&long.replace("a.csv", "whole.csv"));
    assert!(read(&folder.path("a.csv")) == read(&folder.path("whole.csv")));
    // What an earlier version kept has no checksums.
    let old: String = kept.lines().map(|line| format!("{}\n", line.split_once(' ').unwrap().1)).collect();
    std::fs::write(folder.path("a.csv.journal"), old).unwrap();
    let refused = folder.run(&format!("{long} --resume"));
    assert_eq!(refused.exit_code, 2, "{}", refused.messages);
    for word in ["a.csv.journal", "line 1 has no checksum", "delete it", "without --resume"] {
        assert!(refused.messages.contains(word), "no `{word}` in {}", refused.messages);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_says_what_is_finished() {
    let folder = Folder::new();
    let long = "margin --along v=4:7:8 --kind release-angle --threads 1 -o a.csv";
    let child = start(&folder, long, "a.csv.journal", 2);
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{messages}");
    assert!(messages.contains("of 8 parts are finished, kept in a.csv.journal"), "{messages}");
    assert!(!folder.path("a.csv").exists());
    let resumed = folder.succeed(&format!("{long} --resume"));
    assert!(resumed.messages.contains("of 8 parts were finished"), "{}", resumed.messages);
    folder.succeed(&long.replace("a.csv", "whole.csv"));
    assert!(read(&folder.path("a.csv")) == read(&folder.path("whole.csv")));
    assert_eq!(folder.files(), ["a.csv", "whole.csv"]);
}

#[test]
fn the_ringing_of_straight_running_is_no_shimmy() {
    let folder = Folder::new();
    // Without c_u the longitudinal oscillation never decays; kicks of 0.5 N s return all the same.
    let kick = folder.json("safe-kick -s r=inf -s v=4 -q");
    assert!(kick["safe"].as_f64().unwrap() > 0.5, "{}", kick["safe"]);
    let sample = folder.json("basin -s r=inf -s v=4 --samples 200 -q");
    assert!(sample["fates"].as_array().unwrap().iter().all(|fate| fate != "shimmy"));
}

#[test]
fn an_unstable_uniform_motion_has_no_safe_kick() {
    let result = Folder::new().json("safe-kick -s v=9 -q");
    assert_eq!((&result["safe"], &result["positive"]["fails"]), (&Value::from(0.0), &Value::from(0.0)));
    assert_ne!(result["positive"]["fate"], "shimmy");
}

#[test]
fn where_there_are_no_motions_to_show_the_picture_says_why() {
    let folder = Folder::new();
    for (command, says) in [
        ("safe-kick -s v=9", "small disturbances grow: none is safe"),
        ("safe-kick --kind release-angle --largest 1e-3 --duration 1", "all that were tried return"),
    ] {
        let run = folder.succeed(&format!("{command} -q"));
        let with = folder.succeed(&format!("{command} -o kick.json -o kick.svg"));
        assert_eq!(run.output, with.output, "{command}");
        let picture = String::from_utf8(crate::read(&folder.path("kick.svg"))).unwrap();
        assert!(picture.contains(says), "{command}: {picture}");
        let result: Value = serde_json::from_slice(&crate::read(&folder.path("kick.json"))).unwrap();
        assert!(result["fails"].is_null(), "{command}");
    }
    // A margin of nothing but unstable motions is drawn, too.
    folder.succeed("margin --along v=9:10:2 -q -o margin.svg");
}

#[test]
fn margins_have_the_cycles_wherever_the_interval_ends() {
    let folder = Folder::new();
    // The Hopf point is at 8.43 m/s.
    let points = |arguments: &str| folder.json(arguments)["points"].as_array().unwrap().clone();
    let slow = points("margin --along v=2:4:2 --kind release-angle -q");
    let near = points("margin --along v=4:6:2 --kind release-angle -q");
    let amplitude = |point: &Value| point["unstable_amplitude"].as_f64().unwrap();
    assert!((amplitude(&slow[1]) - 0.567_751_45).abs() < 1e-6);
    assert!((amplitude(&slow[1]) - amplitude(&near[0])).abs() < 1e-9);
    assert_eq!(slow[1]["safe"], near[0]["safe"]);
    // Two values have no correlation worth the name.
    let whole = folder.json("margin --along v=4:6:2 --kind release-angle -q");
    assert!(whole["indicator"]["correlation"].is_null() && whole["remarks"].as_array().unwrap().is_empty());
}

/// The wheel without dampers is unstable at every speed, and there are cycles all the same.
#[test]
fn a_margin_of_unstable_motions_says_that_nothing_is_safe() {
    let folder = Folder::new();
    let wheels = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
    let margin = format!("margin --wheel {wheels}/dolly.toml --contact rolling --along v=2:40:3 -q");
    let result = folder.json(&margin);
    assert!(result["indicator"].is_null(), "{result}");
    for point in result["points"].as_array().unwrap() {
        assert_eq!(point["safe"], 0.0, "{point}");
        assert!(point["unstable_amplitude"].is_null() && point["ratio"].is_null(), "{point}");
    }
    let output = folder.succeed(&margin).output;
    assert!(output.contains("at all of these values small motions grow: no disturbance is safe"), "{output}");
    assert!(!output.contains("per rad of amplitude") && !output.contains("Hopf point"), "{output}");
}

#[test]
fn margins_say_why_there_is_no_cycle_and_what_is_undecided() {
    let folder = Folder::new();
    // At v = 0.02 m/s small disturbances grow or decay within days.
    let result = folder.json("margin --along v=0.02:9:2 --duration 2 -q");
    let slow = &result["points"][0];
    assert!(slow["safe"].is_null() && slow["positive"]["fate"] == "undecided", "{slow}");
    let text = result["remarks"][0].as_str().unwrap();
    assert!(text.starts_with("the limit cycles from the Hopf point at v = 8.43"), "{text}");
}

#[test]
fn safe_kicks_lie_on_both_sides_of_the_edge() {
    let folder = Folder::new();
    let result = folder.json("safe-kick --kind release-angle -s v=6 -q");
    let edge = &result["positive"];
    let [returns, fails] = ["returns", "fails"].map(|side| edge[side].as_f64().unwrap());
    assert!(returns < fails && fails - returns < 1.6e-6);
    // The motions on both sides of the edge start there and part.
    let angles = |side: &str| result[side]["psi"].as_array().unwrap().clone();
    let (inside, outside) = (angles("returns"), angles("fails"));
    let difference =
        |index: usize| (inside[index].as_f64().unwrap() - outside[index].as_f64().unwrap()).abs();
    assert!(difference(0) < 1e-5 && difference(inside.len() - 1) > 0.5);
}

#[test]
fn a_wheel_that_may_slide_returns_from_a_small_release() {
    let folder = Folder::new();
    let wheel = "-s r=inf -s c_u=0.1 --contact sliding --duration 30";
    let result = folder.json(&format!("basin --x psi=-0.2:0.2:3 --y Omega=-1:1:2 {wheel} -q"));
    assert_eq!(result["contact"], "sliding");
    assert!(result["fates"].as_array().unwrap().iter().all(|fate| fate == "uniform motion"));
    let slides = folder.run("basin --contact sliding");
    assert_eq!(slides.exit_code, 1);
    assert!(slides.messages.contains("needs 5.8254 N of friction"), "{}", slides.messages);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::new();
    for (arguments, words) in [
        ("basin --x phi=-1:1:5", &["unknown state `phi`", "u, q, psi, V, Omega"][..]),
        ("basin --x psi=-1:1", &["STATE=A:B:N", "KEY=A:B:N"]),
        ("basin --x psi=-1:1:-3", &["`-3` points", "at least 2"]),
        ("basin --x psi=1:1:3", &["empty interval"]),
        ("basin --x psi=-inf:1:3", &["psi", "finite"]),
        ("basin --x psi=-1:1:3 --y psi=0:1:3", &["same state", "two different states"]),
        ("basin --x psi=-1:1:100000 --y Omega=-1:1:100000", &["too many"]),
        ("basin --samples -5", &["--samples", "-5"]),
        ("basin --samples 0", &["--samples", "1..="]),
        ("basin --seed 3", &["--samples"]),
        ("basin --duration -1", &["--duration -1", "positive"]),
        ("basin --resume", &["--resume", "--out"]),
        ("basin -o a.txt", &[".json, .csv, .parquet, .svg, .png, .pdf"]),
        ("safe-kick --largest -1", &["--largest -1", "positive and finite, in N s"]),
        ("safe-kick --kind jolt --largest 4", &["stand before the jolt", "below v = 4"]),
        ("safe-kick --kind push", &["push", "release-angle"]),
        ("margin --along w=1:2:3", &["unknown key `w`"]),
        ("margin --along v=1:2:-3", &["`-3` points"]),
        ("margin --along r=1:inf:3", &["finite"]),
    ] {
        let run = folder.run(arguments);
        assert_eq!(run.exit_code, 2, "{arguments}: {}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: no `{word}` in {}", run.messages);
        }
        assert!(folder.files().is_empty(), "{arguments}");
    }
}
