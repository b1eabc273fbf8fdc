//! The gallery: every value of its pages is computed here, compared with the published one and with the page.
//!
//! `UPDATE_GALLERY=1 cargo test -p arclength-cli --test gallery` writes pages and figures again.

mod chemistry;
mod nerves;
mod normal_forms;
mod oscillators;
mod page;
mod populations;
mod study;
mod wheel;

use std::path::{Path, PathBuf};

/// The folder of the gallery.
fn gallery() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../gallery")
}

#[test]
fn every_model_has_its_page() {
    if std::env::var_os("UPDATE_GALLERY").is_some() {
        // The pages are being written.
        return;
    }
    let names = |folder: &str, ending: &str| {
        let entries = std::fs::read_dir(gallery().join(folder)).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let wanted = paths.filter(|path| path.extension().is_some_and(|given| given == ending));
        let mut names: Vec<String> =
            wanted.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let mut pages = names("", "md");
    pages.retain(|name| name != "README");
    assert_eq!(names("models", "ode"), pages);
    let index = std::fs::read_to_string(gallery().join("README.md")).unwrap();
    for page in pages {
        assert!(index.contains(&format!("({page}.md)")), "{page} is not in README.md");
    }
}
