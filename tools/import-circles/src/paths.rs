//! The paths in the code of a file: what its `use` statements name, and the paths in expressions and types.

/// A name that a `use` statement brings into a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Use {
    /// Whether other modules see it too.
    pub is_reexport: bool,
    /// Where it comes from, segment by segment.
    pub path: Vec<String>,
    /// What it is called here; `*` for everything that is there.
    pub name: String,
}

/// The names that all `use` statements of the code bring in.
pub(crate) fn uses(code: &str) -> Vec<Use> {
    let mut found = Vec::new();
    for (start, statement) in statements(code) {
        let is_reexport = visibility(code[..start].trim_end());
        for (path, name) in expand(statement) {
            found.push(Use { is_reexport, path, name });
        }
    }
    found
}

/// Whether code ends with `pub` or `pub(..)`.
fn visibility(code: &str) -> bool {
    let head = match code.strip_suffix(')') {
        Some(inside) => inside.rsplit_once('(').map_or("", |(head, _)| head),
        None => code,
    };
    head.strip_suffix("pub").is_some_and(|before| !before.ends_with(is_word))
}

/// Where `use` stands, and what follows it up to the semicolon.
fn statements(code: &str) -> Vec<(usize, &str)> {
    let mut list = Vec::new();
    for (start, _) in code.match_indices("use ") {
        let is_word_of_its_own = !code[..start].ends_with(is_word);
        if let (true, Some(end)) = (is_word_of_its_own, code[start..].find(';')) {
            list.push((start, &code[start + 4..start + end]));
        }
    }
    list
}

/// The single paths of a `use` tree with the names that they get.
fn expand(tree: &str) -> Vec<(Vec<String>, String)> {
    let tree = tree.trim();
    if let Some((head, group)) = tree.split_once('{') {
        let group = group.trim_end().strip_suffix('}').unwrap_or(group);
        return split_at_commas(group)
            .into_iter()
            .flat_map(|part| expand(&format!("{}{}", head.trim(), part.trim())))
            .collect();
    }
    let (path, alias) = match tree.split_once(" as ") {
        Some((path, alias)) => (path, Some(alias.trim().to_owned())),
        None => (tree, None),
    };
    let mut path: Vec<String> = segments(path);
    // `use a::b::{self}` names `b`.
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let Some(last) = path.last().cloned() else { return Vec::new() };
    if last == "*" {
        path.pop();
    }
    vec![(path, alias.unwrap_or(last))]
}

fn split_at_commas(group: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0_usize, 0);
    for (at, character) in group.char_indices() {
        match character {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                parts.push(&group[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&group[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

fn segments(path: &str) -> Vec<String> {
    path.split("::").map(|segment| segment.trim().to_owned()).filter(|segment| !segment.is_empty()).collect()
}

/// Paths of at least two segments outside `use` statements.
pub(crate) fn inline(code: &str) -> Vec<Vec<String>> {
    let mut rest = code.to_owned();
    for (start, statement) in statements(code) {
        let end = start + 4 + statement.len();
        rest.replace_range(start..end, &" ".repeat(end - start));
    }
    let mut found = Vec::new();
    let is_part = |c: char| is_word(c) || c == ':';
    for text in rest.split(|c: char| !is_part(c)) {
        // A single colon separates a name from its type.
        let text = text.trim_end_matches(':');
        let path = segments(text);
        if path.len() > 1 && path.iter().all(|segment| segment.chars().all(is_word)) {
            found.push(path);
        }
    }
    found
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_expanded_and_visibility_is_seen() {
        let found = uses("pub(crate) use super::{a::{self, B}, c as d};\nuse crate::e::*; pub use f::G;");
        let told: Vec<(bool, String, &str)> =
            found.iter().map(|it| (it.is_reexport, it.path.join("::"), it.name.as_str())).collect();
        let expected = [
            (true, "super::a", "a"),
            (true, "super::a::B", "B"),
            (true, "super::c", "d"),
            (false, "crate::e", "*"),
            (true, "f::G", "G"),
        ];
        assert_eq!(told, expected.map(|(shown, path, name)| (shown, path.to_owned(), name)));
    }

    #[test]
    fn paths_in_code_are_found() {
        let found = inline("use a::b; fn f(x: crate::c::D) -> u8 { e::g(x) + T::zero() }");
        let joined: Vec<String> = found.iter().map(|path| path.join("::")).collect();
        assert_eq!(joined, ["crate::c::D", "e::g", "T::zero"]);
    }
}
