//! What is echoed of a value, a key or a line stays short, however long it was, and what is said of it is whole.

use super::Folder;

/// Characters of what is given: in a file, and as an option, where the system allows 128 KiB.
const LONG: usize = 2_000_000;
const LONG_OPTION: usize = 100_000;

#[track_caller]
fn is_refused_briefly(folder: &Folder, arguments: &[&str], words: &[&str]) {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_kingpin"))
        .args(arguments)
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    let start: String = messages.chars().take(300).collect();
    assert_eq!(output.status.code(), Some(2), "{start}");
    assert!(messages.len() < 2500, "{} characters: {start}", messages.len());
    for word in words {
        assert!(messages.contains(word), "no `{word}` in {start}");
    }
}

#[test]
fn of_a_wheel_file() {
    let folder = Folder::new();
    let digits = "9".repeat(LONG);
    for (text, words) in [
        (
            format!("l = \"{digits}x\"\n"),
            &["line 1", "left out", "not a number; allowed: 1e-6 to 1000 m"][..],
        ),
        (
            format!("{} = 1\n", "k".repeat(LONG)),
            &["line 1", "unknown key `kkk", "left out", "the keys are v, l, r"],
        ),
        (format!("l = = {digits}\n"), &["line 1", "left out", "TOML"]),
        (format!("l = = {}\n", "9 ".repeat(LONG / 20)), &["line 1", "left out", "TOML"]),
        (format!("l = \"\"\"{}\"\"\"\n", "9\n".repeat(LONG)), &["lines left out", "not a number"]),
    ] {
        std::fs::write(folder.path("wheel.toml"), text).unwrap();
        is_refused_briefly(&folder, &["steady", "--wheel", "wheel.toml"], words);
    }
}

#[test]
fn of_options_and_result_files() {
    let folder = Folder::new();
    let digits = "9".repeat(LONG_OPTION);
    let value = format!("l={digits}x");
    is_refused_briefly(
        &folder,
        &["steady", "-s", &value],
        &["--set l=999", "left out", "allowed: 1e-6 to 1000 m"],
    );
    is_refused_briefly(&folder, &["steady", "-s", &digits], &["'999", "left out", "KEY=VALUE"]);
    is_refused_briefly(&folder, &["chart", "--x", &digits], &["'999", "left out", "KEY=A:B:N"]);
    is_refused_briefly(&folder, &[&digits], &["unrecognized subcommand", "left out"]);
    is_refused_briefly(&folder, &["steady", "--format", &digits], &["left out", "table, json, csv"]);
    is_refused_briefly(&folder, &["steady", "-o", &digits], &["left out", "allowed: .json, .csv, .parquet"]);
    let schema = format!("{{\"schema\": {{\"name\": \"{}\", \"version\": 1}}}}", "q".repeat(LONG));
    std::fs::write(folder.path("result.json"), schema).unwrap();
    let label = format!("result.json:{digits}");
    is_refused_briefly(
        &folder,
        &["cycles", "--from", &label, "--along", "v=1:2"],
        &["it is of qqq", "allowed"],
    );
}
