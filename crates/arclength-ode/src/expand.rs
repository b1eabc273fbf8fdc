//! Array notation: `x[1..5]'=...[j+1]...` and `%[1..5] ... %` blocks become plain lines.
//!
//! XPPAUT expands arrays as text, once for each value of the index `j`, and so does this module;
//! `x[j-1]` with `j = 3` is the name `x2`. Expansion stops at the line `done`.

use crate::error::{OdeError, Span, Warning};
use crate::source::{Text, is_identifier_part, logical_lines};

/// Largest number of lines after expansion.
const MAXIMUM_LINES: usize = 50_000;
/// Largest number of characters after expansion.
const MAXIMUM_CHARACTERS: usize = 4_000_000;

/// All lines of the model with arrays expanded; comments, empty lines and what follows `done` are gone.
pub(crate) fn expanded_lines(source: &str, warnings: &mut Vec<Warning>) -> Result<Vec<Text>, OdeError> {
    let mut output = Output::default();
    let mut lines = logical_lines(source, warnings).into_iter();
    while let Some(line) = lines.next() {
        let start = line.skip_blanks(0);
        if line.is_remark() {
            continue;
        }
        if is_done(&line) {
            if line.skip_blanks(line.identifier_end(start)) < line.len()
                && !line.string(start, line.identifier_end(start)).eq_ignore_ascii_case("done")
            {
                let message =
                    "the model ends here: XPPAUT takes a line that begins with a word in d for `done`";
                warnings.push(Warning::new(line.span(start, line.len()), message));
            }
            break;
        }
        if line.at(start) == '%' {
            let Some(range) = find_range(&line)? else {
                return Err(OdeError::syntax(
                    line.span(start, start + 1),
                    "a block starts with %[first..last] and ends with a line %",
                ));
            };
            let block: Vec<Text> = lines
                .by_ref()
                .take_while(|line| line.at(line.skip_blanks(0)) != '%')
                .filter(|line| !line.is_remark())
                .collect();
            for index in range.indices() {
                for line in &block {
                    output.push(substitute(line, Some(index), None)?)?;
                }
            }
        } else if let Some(range) = find_range(&line)? {
            for index in range.indices() {
                output.push(substitute(&line, Some(index), Some(&range))?)?;
            }
        } else {
            output.push(substitute(&line, None, None)?)?;
        }
    }
    Ok(output.lines)
}

#[derive(Default)]
struct Output {
    lines: Vec<Text>,
    characters: usize,
}

impl Output {
    fn push(&mut self, line: Text) -> Result<(), OdeError> {
        self.characters += line.len();
        let place = line.span(0, 1).into();
        self.lines.push(line);
        if self.lines.len() > MAXIMUM_LINES {
            let what = "too many lines after array expansion".into();
            return Err(OdeError::TooLarge { place, what, limit: MAXIMUM_LINES });
        }
        if self.characters > MAXIMUM_CHARACTERS {
            let what = "too much text after array expansion".into();
            return Err(OdeError::TooLarge { place, what, limit: MAXIMUM_CHARACTERS });
        }
        Ok(())
    }
}

/// The line `done`, which XPPAUT knows by its first letter.
fn is_done(line: &Text) -> bool {
    let start = line.skip_blanks(0);
    let end = line.find(start, |c| c.is_whitespace() || matches!(c, '=' | '\'' | '(' | '/'));
    let next = line.at(line.skip_blanks(end));
    line.lower_at(start) == 'd' && !matches!(next, '=' | '\'' | '(' | '/')
}

/// `first..last` in brackets; runs downwards when `last < first`.
#[derive(Debug, PartialEq)]
struct Range {
    first: i64,
    last: i64,
}

impl Range {
    fn indices(&self) -> impl Iterator<Item = i64> + use<> {
        let step = if self.last < self.first { -1 } else { 1 };
        let first = self.first;
        (0..=(self.last - first).abs()).map(move |count| first + step * count)
    }
}

/// The range `[first..last]` of a line. XPPAUT knows one index, so a second range must be the same.
fn find_range(line: &Text) -> Result<Option<Range>, OdeError> {
    let mut found: Option<Range> = None;
    let mut index = 0;
    while index < line.len() && (line.at(index) != '#' || line.is_include(index)) {
        if line.at(index) != '[' {
            index += 1;
            continue;
        }
        let close = line.find(index, |character| character == ']');
        let inside = line.string(index + 1, close);
        if let Some((first, last)) = inside.split_once("..") {
            let span = line.span(index, close + 1);
            // XPPAUT takes the last two of several points.
            let last = last.trim_start_matches('.');
            let bound = |text: &str| -> Result<i64, OdeError> {
                text.trim().parse::<i32>().map(i64::from).map_err(|_| {
                    OdeError::syntax(span, "the ends of an array range must be whole numbers, as in [1..5]")
                })
            };
            let range = Range { first: bound(first)?, last: bound(last)? };
            if (range.last - range.first).unsigned_abs() as usize >= MAXIMUM_LINES {
                let what = "too many elements in an array".into();
                return Err(OdeError::TooLarge { place: span.into(), what, limit: MAXIMUM_LINES });
            }
            match &found {
                Some(earlier) if *earlier != range => {
                    let message = "a line can hold one array range only; use [j] after the first";
                    return Err(OdeError::syntax(span, message));
                }
                _ => found = Some(range),
            }
        }
        index = close + 1;
    }
    Ok(found)
}

/// Replaces every bracket of the line by its number.
fn substitute(line: &Text, index: Option<i64>, range: Option<&Range>) -> Result<Text, OdeError> {
    let mut output = Text::default();
    let mut position = 0;
    while position < line.len() {
        let character = line.at(position);
        if character == '#' && !line.is_include(position) {
            break;
        }
        // `int[a]{...}` is a kernel, not an array; the expression parser refuses it by name.
        let kernel = position >= 3 && line.string(position - 3, position).eq_ignore_ascii_case("int");
        if character != '[' || kernel {
            output.push(character, line.place(position));
            position += 1;
            continue;
        }
        let close = line.find(position, |character| character == ']');
        let span = line.span(position, close + 1);
        if close == line.len() {
            return Err(OdeError::syntax(span, "the bracket [ is never closed"));
        }
        let inside = line.string(position + 1, close);
        let value = index_value(&inside, index, range.is_some(), span).map_err(|error| {
            if is_behind_number(line, position) {
                let message = format!(
                    "`[{inside}]` has no meaning behind a number: brackets hold the index of an array; remove it"
                );
                return OdeError::syntax(span, message);
            }
            error
        })?;
        if value < 0 && position > 0 && is_identifier_part(line.at(position - 1)) {
            return Err(OdeError::syntax(span, format!("the array index is {value}; it cannot be negative")));
        }
        for digit in value.to_string().chars() {
            output.push(digit, line.place(position));
        }
        position = close + 1;
    }
    Ok(output)
}

/// Whether the word that ends at a place is a number.
fn is_behind_number(line: &Text, end: usize) -> bool {
    let is_part = |index: usize| is_identifier_part(line.at(index)) || line.at(index) == '.';
    let start = (0..end).rev().find(|&index| !is_part(index)).map_or(0, |before| before + 1);
    start < end && line.number_end(start) == end
}

/// Value of `j`, `j+n`, `j-n`, `j*n`, a number, or the range itself.
fn index_value(inside: &str, index: Option<i64>, has_range: bool, span: Span) -> Result<i64, OdeError> {
    let compact: String = inside.chars().filter(|character| !character.is_whitespace()).collect();
    if let Ok(number) = compact.parse::<i32>() {
        return Ok(i64::from(number));
    }
    if compact.contains("..") && has_range {
        return Ok(index.unwrap_or_default());
    }
    let malformed =
        || OdeError::syntax(span, "an array index is [j], [j+1], [j-1], [j*2] or a whole number such as [3]");
    let Some(rest) = compact.strip_prefix(['j', 'J']) else { return Err(malformed()) };
    let Some(index) = index else {
        return Err(OdeError::syntax(span, "[j] has no meaning outside an array line such as x[1..5]'=..."));
    };
    if rest.is_empty() {
        return Ok(index);
    }
    let mut characters = rest.chars();
    let operator = characters.next();
    let operand = characters.as_str().parse::<i32>().map(i64::from).map_err(|_| malformed())?;
    match operator {
        Some('+') => Ok(index + operand),
        Some('-') => Ok(index - operand),
        Some('*') => Ok(index * operand),
        _ => Err(malformed()),
    }
}
