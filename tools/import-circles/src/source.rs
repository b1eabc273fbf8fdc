//! Rust text without what is no code of the program: comments, the contents of strings, code of tests.

/// The code of a file. Line breaks stay, comments and the contents of literals are blank.
pub(crate) fn code(text: &str) -> String {
    without_tests(&without_comments(text))
}

fn without_comments(text: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let mut code = String::with_capacity(text.len());
    let mut at = 0;
    while at < characters.len() {
        let rest = &characters[at..];
        let length = match rest {
            ['/', '/', ..] => rest.iter().position(|&c| c == '\n').unwrap_or(rest.len()),
            ['/', '*', ..] => block_comment(rest),
            ['r', '"' | '#', ..] if !follows_word(&code) => raw_string(rest).unwrap_or(0),
            ['"', ..] => string(rest),
            ['\'', ..] => character(rest).unwrap_or(0),
            _ => 0,
        };
        if length == 0 {
            code.push(characters[at]);
            at += 1;
        } else {
            code.extend(rest[..length].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
            at += length;
        }
    }
    code
}

fn follows_word(code: &str) -> bool {
    code.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_')
}

fn block_comment(text: &[char]) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        match &text[at..] {
            ['/', '*', ..] => (depth, at) = (depth + 1, at + 2),
            ['*', '/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

fn string(text: &[char]) -> usize {
    let mut at = 1;
    while at < text.len() {
        match text[at] {
            '\\' => at += 2,
            '"' => return at + 1,
            _ => at += 1,
        }
    }
    text.len()
}

fn raw_string(text: &[char]) -> Option<usize> {
    let hashes = text[1..].iter().take_while(|&&c| c == '#').count();
    let open = 1 + hashes;
    if text.get(open) != Some(&'"') {
        return None;
    }
    let closes = |at: &usize| {
        text[*at] == '"' && text[at + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes
    };
    Some((open + 1..text.len()).find(closes).map_or(text.len(), |at| at + 1 + hashes))
}

/// A character, which a lifetime is not.
fn character(text: &[char]) -> Option<usize> {
    match text {
        ['\'', '\\', _, rest @ ..] => Some(3 + rest.iter().position(|&c| c == '\'')? + 1),
        ['\'', _, '\'', ..] => Some(3),
        _ => None,
    }
}

/// Blanks the modules that are compiled for tests only.
fn without_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = code.to_owned();
    while let Some(start) = kept.find(MARK) {
        let after = start + MARK.len();
        let end = match kept[after..].find(['{', ';']) {
            Some(at) if kept[after + at..].starts_with('{') => after + at + braces(&kept[after + at..]),
            Some(at) => after + at + 1,
            None => kept.len(),
        };
        let blank: String = kept[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        kept.replace_range(start..end, &blank);
    }
    kept
}

/// Length of what stands between the brace at the start and its partner, both included.
fn braces(code: &str) -> usize {
    let mut depth = 0_usize;
    for (at, character) in code.char_indices() {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    code.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_tests_are_blank() {
        let text = r##"
            use crate::kept; // crate::comment
            /* crate::block /* crate::inner */ */
            const TEXT: &str = "crate::string \" crate::more";
            const RAW: &str = r#"crate::raw " "#;
            fn life<'a>(x: &'a str) -> char { if x.is_empty() { '"' } else { '\'' } }
            #[cfg(test)]
            mod tests { use crate::tested; fn f() { { } } }
            use crate::after;
        "##;
        let code = code(text);
        let paths: Vec<&str> = code.split("crate::").skip(1).collect();
        assert_eq!(paths.len(), 2, "{code}");
        assert!(paths[0].starts_with("kept") && paths[1].starts_with("after"));
        assert!(code.contains("fn life<'a>(x: &'a str)"));
    }
}
