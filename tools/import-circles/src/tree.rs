//! The files of a crate as a tree of modules, and where the paths in them lead.

use crate::circles::Import;
use crate::paths::{Use, inline, uses};
use crate::source::code;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Re-exports that are followed one after the other before it is given up.
const MOST_REEXPORTS: usize = 16;

/// The place of a module: names from the root of the crate, which is empty.
type Place = Vec<String>;

/// A file.
struct Module {
    place: Place,
    uses: Vec<Use>,
    inline: Vec<Vec<String>>,
}

/// The files of a crate.
pub(crate) struct CrateTree {
    modules: Vec<Module>,
    index: BTreeMap<Place, usize>,
}

impl CrateTree {
    /// Reads the sources of a crate from its folder `src`. Files of tests and programs beside the library are left out.
    ///
    /// # Errors
    /// What cannot be read.
    pub(crate) fn read(root: &Path) -> io::Result<Self> {
        let mut texts = Vec::new();
        read_folder(root, &Place::new(), &mut texts)?;
        texts.sort();
        Ok(Self::new(texts))
    }

    /// From the places and texts of modules.
    pub(crate) fn new(texts: Vec<(Place, String)>) -> Self {
        let modules: Vec<Module> = texts
            .into_iter()
            .map(|(place, text)| {
                let code = code(&text);
                Module { place, uses: uses(&code), inline: inline(&code) }
            })
            .collect();
        let index = modules.iter().enumerate().map(|(index, module)| (module.place.clone(), index)).collect();
        Self { modules, index }
    }

    /// Number of files.
    pub(crate) fn len(&self) -> usize {
        self.modules.len()
    }

    /// Name of a file.
    pub(crate) fn name(&self, file: usize) -> String {
        let place = &self.modules[file].place;
        if place.is_empty() { "the root".to_owned() } else { place.join("/") }
    }

    /// All imports between different files.
    pub(crate) fn imports(&self) -> Vec<Import> {
        let mut imports = Vec::new();
        for (from, module) in self.modules.iter().enumerate() {
            let used = module.uses.iter().filter(|it| !it.is_reexport).map(|it| &it.path);
            for path in used.chain(&module.inline) {
                if let Some(to) = self.target(&module.place, path, MOST_REEXPORTS)
                    && to != from
                {
                    imports.push(Import { from, to, path: path.join("::") });
                }
            }
        }
        imports.sort();
        imports.dedup();
        imports
    }

    /// The file to which a path in a module leads; `None` if that is another crate or a local name.
    fn target(&self, from: &[String], path: &[String], patience: usize) -> Option<usize> {
        let patience = patience.checked_sub(1)?;
        let mut place = from.to_vec();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => (place, rest) = (Place::new(), &rest[1..]),
            "self" => rest = &rest[1..],
            "super" => {
                while let ["super", ..] = rest.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                    place.pop()?;
                    rest = &rest[1..];
                }
            }
            first => {
                let child = self.index.contains_key(&joined(&place, first));
                let imported = self.module(&place)?.uses.iter().any(|it| it.name == first && it.path != path);
                if !child && !imported {
                    return None;
                }
            }
        }
        // Down the tree as far as there are files, or along a name that was brought in.
        while let Some(next) = rest.first() {
            if self.index.contains_key(&joined(&place, next)) {
                place.push(next.clone());
                rest = &rest[1..];
                continue;
            }
            let brought_in = |it: &&Use| it.name == *next || it.name == "*";
            let uses = self.module(&place)?.uses.iter().filter(brought_in);
            for it in uses {
                let mut onward = it.path.clone();
                onward.extend_from_slice(if it.name == "*" { rest } else { &rest[1..] });
                if onward != path
                    && let Some(target) = self.target(&place, &onward, patience)
                {
                    return Some(target);
                }
            }
            break;
        }
        self.index.get(&place).copied()
    }

    fn module(&self, place: &[String]) -> Option<&Module> {
        self.index.get(place).map(|&index| &self.modules[index])
    }
}

fn joined(place: &[String], next: &str) -> Place {
    place.iter().cloned().chain([next.to_owned()]).collect()
}

fn read_folder(folder: &Path, place: &[String], texts: &mut Vec<(Place, String)>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Some(name) = path.file_stem().and_then(|name| name.to_str()) else { continue };
        if path.is_dir() {
            if name != "bin" {
                read_folder(&path, &joined(place, name), texts)?;
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") && name != "tests" {
            let is_root = place.is_empty() && (name == "lib" || name == "main");
            let own = if is_root || name == "mod" { place.to_vec() } else { joined(place, name) };
            texts.push((own, fs::read_to_string(&path)?));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imports(texts: &[(&str, &str)]) -> Vec<String> {
        let place = |path: &str| path.split('/').filter(|name| !name.is_empty()).map(String::from).collect();
        let tree =
            CrateTree::new(texts.iter().map(|(path, text)| (place(path), (*text).to_owned())).collect());
        tree.imports().iter().map(|it| format!("{} > {}", tree.name(it.from), tree.name(it.to))).collect()
    }

    #[test]
    fn reexports_lead_to_where_an_item_is_defined() {
        let found = imports(&[
            ("", "mod a; mod b; pub use a::c::Item;"),
            ("a", "mod c; pub use c::*;"),
            ("a/c", "pub struct Item;"),
            ("b", "use crate::{Item, a::Item as Other}; use std::fmt;"),
        ]);
        assert_eq!(found, ["b > a/c"; 2]);
    }

    #[test]
    fn paths_in_code_and_through_imported_modules_count() {
        let found = imports(&[
            ("", "mod a; mod b; mod c;"),
            ("a", "use super::b; fn f() { b::g(); crate::c::h(); T::zero(); }"),
            ("b", "fn g() { super::a::f() }"),
            ("c", "fn h() { self::local(); }"),
        ]);
        assert_eq!(found, ["a > b", "a > b", "a > c", "b > a"]);
    }

    #[test]
    fn reexporting_is_not_importing() {
        assert!(imports(&[("", "mod a; pub use a::Item;"), ("a", "pub struct Item;")]).is_empty());
        assert_eq!(
            imports(&[("", "mod a; use a::Item;"), ("a", "use super::f;")]),
            ["the root > a", "a > the root"]
        );
    }
}
