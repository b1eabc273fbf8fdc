//! Ctrl-C ends commands that would run for hours, whatever they are at.

use super::Folder;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Time after which a command has read its options and listens to signals.
const UNDER_WAY: Duration = Duration::from_secs(2);

#[test]
fn long_commands_end_soon_after_ctrl_c_and_write_nothing() {
    let folder = Folder::new();
    let start = |arguments: &&str| -> Child {
        Command::new(env!("CARGO_BIN_EXE_kingpin"))
            .args(arguments.split_whitespace())
            .args(["-o", "result.json"])
            .current_dir(folder.path(""))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    let commands = [
        "simulate --duration 1e9 --perturb psi=0.1",
        "simulate --duration 1e9 --perturb psi=0.2 --contact sliding -s l=0.03 -s v=0.5 -s r=inf -s c_u=0.1 -s c_q=0.1",
        "safe-kick --kind release-angle -s v=8.43 --duration 1e7",
        "chart --x v=0.1:10:3100 --y l=0.03:0.2:3100",
    ];
    let children: Vec<Child> = commands.iter().map(start).collect();
    std::thread::sleep(UNDER_WAY);
    for child in &children {
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }
    let asked = Instant::now();
    for (child, command) in children.into_iter().zip(commands) {
        let output = child.wait_with_output().unwrap();
        let messages = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{command}: {messages}");
        assert!(messages.contains("interrupted"), "{command}: {messages}");
        assert!(output.stdout.is_empty(), "{command}");
    }
    assert!(asked.elapsed() < Duration::from_secs(5), "{:?}", asked.elapsed());
    assert!(folder.files().is_empty());
}
