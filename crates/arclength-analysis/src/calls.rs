//! Calls along a cycle in the text of an expression: `max(..)`, `min(..)`, `mean(..)` and `at(.., PHASE)`.
//!
//! The language of models does not know them. They are taken out of the text, and what is left is an expression of that
//! language, with a name for the value of each.

/// A function of an expression along a cycle, as it is called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Call {
    /// `max`.
    Largest,
    /// `min`.
    Smallest,
    /// `mean`.
    Mean,
    /// `at`.
    At,
}

/// A call in an expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// The function.
    pub call: Call,
    /// What stands between its parentheses.
    pub argument: String,
}

/// The name that stands in the place of a call, counted from 1.
pub(crate) fn part_name(index: usize) -> String {
    format!("along_cycle_{index}")
}

/// The names in an expression, with where each ends.
fn names(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_part = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let mut rest = 0;
    std::iter::from_fn(move || {
        loop {
            let start = rest + text[rest..].find(is_part)?;
            let end =
                text[start..].find(|character| !is_part(character)).map_or(text.len(), |end| start + end);
            rest = end;
            if text[start..].starts_with(|first: char| !first.is_ascii_digit()) {
                return Some((start, &text[start..end]));
            }
        }
    })
}

/// What becomes of a name in a text.
pub(crate) enum Named {
    /// It stays.
    Kept,
    /// Another one stands in its place.
    Replaced(String),
}

/// A text with some of its names replaced.
pub(crate) fn replace_names(text: &str, mut replacement: impl FnMut(&str) -> Named) -> String {
    let (mut replaced, mut copied) = (String::new(), 0);
    for (start, name) in names(text) {
        if let Named::Replaced(other) = replacement(name) {
            replaced.push_str(&text[copied..start]);
            replaced.push_str(&other);
            copied = start + name.len();
        }
    }
    replaced.push_str(&text[copied..]);
    replaced
}

/// Whether one of the names in an expression is meant; they are given in small letters.
pub(crate) fn mentions(text: &str, is_meant: impl Fn(&str) -> bool) -> bool {
    names(text).any(|(_, name)| is_meant(&name.to_ascii_lowercase()))
}

/// Takes calls of `max`, `min` and `mean` with one argument, and those of `at` where they mean `phases`, out of an expression:
/// the expression with names in their place, and what each stands for. (With two arguments `max` and `min` are functions of
/// numbers.)
pub(crate) fn divide(text: &str, phases: bool) -> (String, Vec<Part>) {
    let (mut outer, mut parts, mut copied) = (String::new(), Vec::new(), 0);
    for (start, name) in names(text) {
        let call = match name.to_ascii_lowercase().as_str() {
            "max" => Call::Largest,
            "min" => Call::Smallest,
            "mean" => Call::Mean,
            "at" if phases => Call::At,
            _ => continue,
        };
        if start < copied {
            continue;
        }
        let Some((open, close)) = argument_list(text, start + name.len()) else { continue };
        let argument = &text[open..close];
        if call != Call::At && arguments_of(argument).len() != 1 {
            continue;
        }
        outer.push_str(&text[copied..start]);
        parts.push(Part { call, argument: argument.to_owned() });
        outer.push_str(&part_name(parts.len()));
        copied = close + 1;
    }
    outer.push_str(&text[copied..]);
    (outer, parts)
}

/// Where the arguments of a call lie whose name ends at `after`.
fn argument_list(text: &str, after: usize) -> Option<(usize, usize)> {
    let gap = text[after..].find(|character: char| !character.is_whitespace())?;
    let open = after + gap;
    if !text[open..].starts_with('(') {
        return None;
    }
    let mut depth = 0;
    for (index, character) in text[open..].char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some((open + 1, open + index));
        }
    }
    None
}

/// Arguments, divided at the commas that stand in no parentheses.
pub(crate) fn arguments_of(list: &str) -> Vec<&str> {
    let mut depth = 0;
    list.split(|character| {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        character == ',' && depth == 0
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_along_the_cycle_are_told_from_functions_of_numbers() {
        let (outer, parts) =
            divide("max(x+y) - min( max(x, y) ) + max(a, 1) + mean(f(x))/2 - at(max(x, y), 0.5)", true);
        assert_eq!(outer, "along_cycle_1 - along_cycle_2 + max(a, 1) + along_cycle_3/2 - along_cycle_4");
        let expected = [
            (Call::Largest, "x+y"),
            (Call::Smallest, " max(x, y) "),
            (Call::Mean, "f(x)"),
            (Call::At, "max(x, y), 0.5"),
        ];
        assert_eq!(parts, expected.map(|(call, argument)| Part { call, argument: argument.to_owned() }));
        assert_eq!(arguments_of("max(x, y), 0.5"), ["max(x, y)", " 0.5"]);
        // The model has a function of its own by that name.
        assert_eq!(divide("at(a, 1)", false), ("at(a, 1)".to_owned(), Vec::new()));
    }
}
