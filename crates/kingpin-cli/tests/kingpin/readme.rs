//! The README's commands print what stands below them.

use crate::Folder;
use std::path::{Path, PathBuf};

/// The arguments of the README's commands, each with the lines below it.
fn commands() -> Vec<(String, String)> {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.strip_prefix("text\n"));
    let runs = blocks.flat_map(|block| block.split("$ kingpin ").skip(1));
    runs.filter_map(|run| run.split_once('\n'))
        .map(|(arguments, output)| (arguments.to_owned(), output.trim_end().to_owned()))
        .collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn commands_print_what_it_says() {
    let folder = Folder::new();
    let files = ["crates/kingpin/examples/decay.csv", "crates/kingpin/examples/wheels/trolley.toml"];
    for file in files {
        let copy = folder.path(file);
        std::fs::create_dir_all(copy.parent().unwrap()).unwrap();
        std::fs::copy(root().join(file), copy).unwrap();
    }
    let commands = commands();
    assert!(commands.len() > 8, "{commands:?}");
    for (arguments, expected) in commands {
        let run = folder.run(&arguments);
        let printed = if run.exit_code == 0 { run.output } else { run.messages };
        // How many kicks of a tumbling wheel come back hangs on the last digit of the damper.
        let certain = |text: &str| -> Vec<String> {
            text.trim_end().lines().filter(|line| !line.contains("random kicks")).map(String::from).collect()
        };
        assert_eq!(certain(&printed), certain(&expected), "kingpin {arguments}");
    }
}
