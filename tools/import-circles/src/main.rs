//! Finds files of a crate that import each other in a circle: `cargo run -p import-circles [CRATE/src ..]`, by default those of
//! all crates. Exit code 1 if there is one.
//!
//! Files that know each other in a circle can only be read, tested and changed together. An import is a path, in a `use` or in
//! the code, that leads to an item of another file; re-exports are followed to where the item is defined, and re-exporting is
//! not importing, so that a folder's `mod.rs` may show what its files hold. Code of tests does not count.

mod circles;
mod paths;
mod source;
mod tree;

use circles::Import;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tree::CrateTree;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let given: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let roots = if given.is_empty() { all_crates()? } else { given };
    let mut found = 0;
    for root in &roots {
        let tree = CrateTree::read(root)?;
        let imports = tree.imports();
        for circle in circles::circles(tree.len(), &imports) {
            found += 1;
            println!("{}: {} files import each other in a circle", root.display(), circle.len());
            let inside = |it: &&Import| circle.contains(&it.from) && circle.contains(&it.to);
            let inside: Vec<&Import> = imports.iter().filter(inside).collect();
            for pair in inside.chunk_by(|one, other| (one.from, one.to) == (other.from, other.to)) {
                let paths: Vec<&str> = pair.iter().map(|it| it.path.as_str()).collect();
                println!(
                    "    {} -> {}: {}",
                    tree.name(pair[0].from),
                    tree.name(pair[0].to),
                    paths.join(", ")
                );
            }
        }
    }
    println!("{found} circles in {} crates", roots.len());
    Ok(if found == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The sources of all crates of the workspace.
fn all_crates() -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates").canonicalize()?;
    let mut roots = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let sources = entry?.path().join("src");
        if sources.is_dir() {
            roots.push(sources);
        }
    }
    roots.sort();
    Ok(roots)
}
