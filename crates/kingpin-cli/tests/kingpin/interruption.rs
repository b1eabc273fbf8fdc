//! Ctrl-C and the signal to terminate end commands that would run for hours, whatever they are at.

use super::Folder;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Time after which a command has read its options and computes.
const UNDER_WAY: Duration = Duration::from_secs(2);
/// Time within which a command ends, also on a machine that is busy with all of them.
const SOON: Duration = Duration::from_secs(5);

/// Signals with the exit codes of programs that they end.
const SIGNALS: [(&str, i32); 2] = [("-INT", 130), ("-TERM", 143)];

fn start(folder: &Folder, arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_kingpin"))
        .args(arguments.split_whitespace())
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// The output of a program, which must end soon.
#[track_caller]
fn ended(child: Child, what: &str) -> Output {
    let asked = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(asked.elapsed() < SOON, "{what}: {:?}", asked.elapsed());
    output
}

#[test]
fn long_commands_end_soon_and_write_nothing() {
    let commands = [
        "simulate --duration 1e9 -s v=8.43 --perturb psi=0.1 -o a.json",
        "simulate --duration 1e9 --perturb psi=0.2 --contact sliding -s l=0.03 -s v=0.5 -s r=inf -s c_u=0.1 -s c_q=0.1 -o a.json",
        "safe-kick --kind release-angle -s v=8.43 --duration 1e7 -o a.json",
        "chart --x v=0.1:10:3100 --y l=0.03:0.2:3100 -o a.json",
        "study basin --out .",
        "study sliding --out .",
    ];
    for (signal, exit_code) in SIGNALS {
        let folder = Folder::new();
        let children: Vec<Child> = commands.iter().map(|command| start(&folder, command)).collect();
        std::thread::sleep(UNDER_WAY);
        children.iter().for_each(|child| send(signal, child));
        for (child, command) in children.into_iter().zip(commands) {
            let output = ended(child, command);
            let messages = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(exit_code), "{command}: {messages}");
            assert!(
                messages.contains("interrupted") && messages.contains("nothing was written"),
                "{messages}"
            );
            assert!(output.stdout.is_empty(), "{command}");
        }
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

#[test]
fn branches_are_written_as_far_as_they_came() {
    let folder = Folder::new();
    folder.succeed("cycles --along v=0.2:20 -s l=0.08 -s r=0.4 -s c_q=0.1 -q -o cycles.json");
    for (signal, exit_code) in SIGNALS {
        let long =
            "locus --from cycles.json:PD1 --in v=0.2:20,r=0.2:1 --finer 1000 --steps 100000 -o curve.json";
        let child = start(&folder, long);
        std::thread::sleep(UNDER_WAY);
        send(signal, &child);
        let output = ended(child, long);
        let messages = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(exit_code), "{messages}");
        assert!(messages.contains("what was computed before is in the result"), "{messages}");
        let curve: serde_json::Value =
            serde_json::from_slice(&crate::read(&folder.path("curve.json"))).unwrap();
        assert!(curve["points"].as_array().unwrap().len() > 10);
        assert_eq!(folder.files(), ["curve.json", "cycles.json"]);
        std::fs::remove_file(folder.path("curve.json")).unwrap();
    }
}

#[test]
fn a_run_that_is_terminated_is_resumed() {
    let folder = Folder::new();
    let long = "basin --x psi=-1:1:120 --y Omega=-60:60:100 -s v=6 -q --threads 1 -o a.json";
    let child = start(&folder, long);
    let journal = folder.path("a.json.journal");
    while std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 12 {
        std::thread::sleep(Duration::from_millis(2));
    }
    send("-TERM", &child);
    let output = ended(child, long);
    let messages = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(143), "{messages}");
    assert!(messages.contains("kept in a.json.journal; go on with --resume"), "{messages}");
    assert_eq!(folder.files(), ["a.json.journal"]);
    folder.succeed(&format!("{long} --resume"));
    folder.succeed(&long.replace("a.json", "whole.json"));
    assert!(crate::read(&folder.path("a.json")) == crate::read(&folder.path("whole.json")));
}

/// A result waits for the reader of a pipe: the signal ends the program there too, and the files beside it are whole or not there.
#[test]
fn a_signal_while_the_result_is_written_leaves_nothing_unfinished() {
    let folder = Folder::new();
    assert!(Command::new("mkfifo").arg(folder.path("first.csv")).status().unwrap().success());
    for (signal, exit_code) in SIGNALS {
        // The second file is complete under its temporary name when the first pipe is waited for.
        let child = start(&folder, "chart --x v=1:9:3 --y l=0.05:0.1:3 -q -o first.csv -o second.csv");
        std::thread::sleep(UNDER_WAY);
        send(signal, &child);
        let output = ended(child, "chart");
        let messages = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(exit_code), "{messages}");
        assert!(messages.contains("interrupted while the result was written"), "{messages}");
        assert_eq!(folder.files(), ["first.csv"]);
    }
}
