//! Where files go, and what is left when a signal comes.

use super::Folder;

fn one_result() -> Folder {
    let folder = Folder::with("lure.ode");
    folder.succeed("equilibria lure.ode --along alpha=-1.5:1.5 -q -o equilibria.json");
    folder
}

fn files(folder: &Folder) -> Vec<String> {
    let entries = std::fs::read_dir(&folder.0).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn of_several_pictures_none_is_drawn_where_one_cannot_be() {
    let folder = one_result();
    let before = files(&folder);
    for bad in ["b.xyz", "b.json", "missing/b.svg"] {
        for order in [format!("-o a.svg -o {bad}"), format!("-o {bad} -o a.svg")] {
            let run = folder.run(&format!("show equilibria.json {order}"));
            assert_eq!(run.exit_code, 2, "{order}: {}", run.messages);
            assert!(run.output.is_empty() && run.messages.contains(bad), "{}", run.messages);
            assert_eq!(files(&folder), before, "{order}");
        }
    }
    folder.succeed("show equilibria.json -o a.svg -o a.pdf -q");
    assert_eq!(files(&folder).len(), before.len() + 2);
}

#[cfg(unix)]
#[test]
fn pictures_are_drawn_through_links() {
    let folder = one_result();
    let path = |name: &str| folder.0.path().join(name);
    std::os::unix::fs::symlink("target.svg", path("link.svg")).unwrap();
    folder.succeed("show equilibria.json -o link.svg -o plain.svg -q");
    assert!(std::fs::symlink_metadata(path("link.svg")).unwrap().is_symlink());
    assert!(std::fs::read(path("target.svg")).unwrap() == std::fs::read(path("plain.svg")).unwrap());
}

#[cfg(unix)]
#[test]
fn signals_end_every_command_soon() {
    use std::process::Command;
    use std::time::{Duration, Instant};
    let folder = one_result();
    folder.succeed("cycles --from equilibria.json:HB1 --along alpha=-1.5:1.5 -q -o cycles.json");
    // So many oscillators that the most steps that are taken take long.
    let oscillator = |index| format!("x{index}'=y{index}\ny{index}'=-x{index}\ninit x{index}=1\n");
    folder.write("slow.ode", &(0..300).map(oscillator).collect::<String>());
    let before = files(&folder);
    for (signal, exit_code) in [("-INT", 130), ("-TERM", 143)] {
        for (command, said) in [
            ("simulate slow.ode --duration 1e12 -o a.csv", "nothing was written"),
            (
                "locus --from cycles.json:PD1 --in alpha=-2:2,beta=0.2:2 --finer 1000 --steps 100000 -o a.json",
                "what was computed before is in the result",
            ),
        ] {
            let child = started(&folder, command);
            // Until it computes.
            std::thread::sleep(Duration::from_secs(1));
            assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
            let asked = Instant::now();
            let output = child.wait_with_output().unwrap();
            let messages = String::from_utf8(output.stderr).unwrap();
            assert!(asked.elapsed() < Duration::from_secs(5), "{command}: {:?}", asked.elapsed());
            assert_eq!(output.status.code(), Some(exit_code), "{command}: {messages}");
            assert!(messages.contains("interrupted") && messages.contains(said), "{command}: {messages}");
            let left = files(&folder);
            assert!(left.iter().all(|name| !name.starts_with('.')), "{left:?}");
            let _ = std::fs::remove_file(folder.0.path().join("a.json"));
            assert_eq!(files(&folder), before, "{command}");
        }
    }
}

/// The program, started in a folder; its messages can be read.
#[cfg(unix)]
fn started(folder: &Folder, command: &str) -> std::process::Child {
    use std::process::{Command, Stdio};
    Command::new(env!("CARGO_BIN_EXE_arclength"))
        .args(command.split_whitespace())
        .current_dir(&folder.0)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// A step of so large a model takes long: the first signal waits for its end and says so, the second does not.
#[cfg(unix)]
#[test]
fn a_second_signal_ends_a_command_at_once() {
    use std::process::Command;
    use std::time::{Duration, Instant};
    let count = 600;
    let equation = |index: usize| {
        let (left, right) = ((index + count - 1) % count, (index + 1) % count);
        format!("x{index}'=p-x{index}^3+0.1*(x{right}-2*x{index}+x{left})\n")
    };
    let model: String = (0..count).map(equation).chain(["par p=1\n".to_owned()]).collect();
    let folder = Folder::with_text("large.ode", &model);
    let child = started(&folder, "equilibria large.ode --along p=0:5 -o a.json");
    let send = || {
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        std::thread::sleep(Duration::from_millis(1500));
    };
    std::thread::sleep(Duration::from_secs(2));
    send();
    let asked = Instant::now();
    send();
    let output = child.wait_with_output().unwrap();
    let messages = String::from_utf8(output.stderr).unwrap();
    assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
    assert_eq!(output.status.code(), Some(130), "{messages}");
    assert!(messages.contains("once more ends it at once"), "{messages}");
    assert!(messages.contains("no result was written"), "{messages}");
    assert_eq!(files(&folder), ["large.ode"]);
}

#[test]
fn of_long_lines_and_names_only_what_matters_is_echoed() {
    let sum = " +x".repeat(300_000);
    let folder = Folder::with_text("long.ode", &format!("x'=-x{sum} +gamma{sum}\n"));
    let run = folder.run("simulate long.ode --duration 1");
    assert_eq!(run.exit_code, 2);
    let lines: Vec<&str> = run.messages.lines().collect();
    assert_eq!(lines[0], "error: long.ode: line 1, column 900008: unknown name `gamma`");
    // The carets stand under the name.
    let name = lines[2].find("gamma").unwrap();
    assert_eq!(lines[3].find("^^^^^"), Some(name), "{}", run.messages);
    assert!(run.messages.len() < 700, "{} characters", run.messages.len());

    let folder = Folder::with_text("long.ode", &format!("x'=-x\npar a={}z\n", "9".repeat(2_000_000)));
    let run = folder.run("simulate long.ode --duration 1");
    assert!(run.exit_code == 2 && run.messages.len() < 1500, "{} characters", run.messages.len());
    assert!(run.messages.contains("line 2"), "{}", run.messages);

    let folder = Folder::with_text("model.ode", "x'=p*x\npar p=1\n");
    folder.write("samples.csv", &format!("t,x\n0,{}z\n1,2\n", "7".repeat(2_000_000)));
    let run = folder.run("cycles model.ode --from samples.csv --along p=0:1");
    assert!(run.exit_code == 2 && run.messages.len() < 500, "{} characters", run.messages.len());
    for word in ["samples.csv: line 2, column x", "left out", "is no finite number"] {
        assert!(run.messages.contains(word), "no `{word}` in {}", run.messages);
    }
}
