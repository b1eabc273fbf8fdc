//! The program `kingpin` as others run it: in a folder of its own, by its exit code, its output and its files.

mod bad_input;
mod basin;
mod branches;
mod curves;
mod damper;
mod doubts;
mod dry_friction;
mod ends;
mod files;
mod fit;
mod forces;
mod formats;
mod headings;
#[cfg(unix)]
mod interruption;
mod lateral;
mod long_values;
mod monitors;
mod overlays;
mod readme;
mod sharded;
mod shimmy;
mod studies;
mod tables;
mod tyre;
mod verdicts;
mod wheels;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// An empty folder that goes when dropped, in which the program is run.
struct Folder(tempfile::TempDir);

/// What a run left.
#[derive(Debug)]
struct Run {
    exit_code: i32,
    output: String,
    messages: String,
}

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the program with arguments separated by spaces.
    fn run(&self, arguments: &str) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_kingpin"))
            .args(arguments.split_whitespace())
            .current_dir(&self.0)
            .env_remove("COLUMNS")
            .stdin(Stdio::null())
            .output()
            .unwrap();
        Run {
            exit_code: output.status.code().expect("ended by itself"),
            output: String::from_utf8(output.stdout).unwrap(),
            messages: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs the program, which must succeed.
    fn succeed(&self, arguments: &str) -> Run {
        let run = self.run(arguments);
        assert_eq!(run.exit_code, 0, "{arguments}: {}", run.messages);
        run
    }

    fn json(&self, arguments: &str) -> serde_json::Value {
        serde_json::from_str(&self.succeed(&format!("{arguments} --format json")).output).unwrap()
    }

    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}
