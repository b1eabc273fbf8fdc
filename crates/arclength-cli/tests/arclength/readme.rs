//! The README's commands print what stands below them.

use crate::Folder;
use std::path::Path;

/// The arguments of the README's commands, each with the lines below it.
fn commands() -> Vec<(String, String)> {
    let readme = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md");
    let text = std::fs::read_to_string(readme).unwrap();
    let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.strip_prefix("text\n"));
    let runs = blocks.flat_map(|block| block.split("$ arclength ").skip(1));
    runs.filter_map(|run| run.split_once('\n'))
        .map(|(arguments, output)| (arguments.to_owned(), output.trim_end().to_owned()))
        .collect()
}

#[test]
fn commands_print_what_it_says() {
    let folder = Folder::with("lure.ode");
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery/models");
    folder.write("ab.ode", &std::fs::read_to_string(gallery.join("ab.ode")).unwrap());
    folder.write("typo.ode", "x' = -gama*x\npar gamma=1\ninit x=1\n");
    let commands = commands();
    assert!(commands.len() > 5, "{commands:?}");
    for (arguments, expected) in commands {
        let run = folder.run(&arguments);
        let printed = if run.exit_code == 0 { run.output } else { run.messages };
        assert_eq!(printed.trim_end(), expected, "arclength {arguments}");
    }
}
