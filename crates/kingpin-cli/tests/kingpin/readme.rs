//! The commands of the README and of the studies print what stands below them.

use crate::Folder;
use std::path::{Path, PathBuf};

/// The arguments of a document's commands, each with the lines below it.
fn commands(document: &str) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(root().join(document)).unwrap();
    let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.strip_prefix("text\n"));
    let runs = blocks.flat_map(|block| block.split("$ kingpin ").skip(1));
    runs.filter_map(|run| run.split_once('\n'))
        .map(|(arguments, output)| (arguments.to_owned(), output.trim_end().to_owned()))
        .collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Runs the commands of a document one after the other, as they stand; how many there are.
fn type_in(document: &str) -> usize {
    let folder = Folder::new();
    let files = ["crates/kingpin/examples/decay.csv", "crates/kingpin/examples/wheels/trolley.toml"];
    for file in files {
        let copy = folder.path(file);
        std::fs::create_dir_all(copy.parent().unwrap()).unwrap();
        std::fs::copy(root().join(file), copy).unwrap();
    }
    let commands = commands(document);
    for (arguments, expected) in &commands {
        let run = folder.run(arguments);
        let printed = if run.exit_code == 0 { run.output } else { run.messages };
        assert_eq!(comparable(&printed), comparable(expected), "kingpin {arguments}");
    }
    commands.len()
}

/// What is the same everywhere. How many kicks of a tumbling wheel come back hangs on the last digit of the damper.
fn comparable(text: &str) -> Vec<String> {
    text.trim_end().lines().filter(|line| !line.contains("random kicks")).map(String::from).collect()
}

#[test]
fn commands_of_the_readme_print_what_it_says() {
    assert!(type_in("README.md") > 8);
}

#[test]
fn commands_of_the_studies_print_what_they_say() {
    assert_eq!(type_in("docs/studies.md"), 4);
}
