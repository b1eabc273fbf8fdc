//! The words of an expression.

use crate::error::{OdeError, Span};
use crate::source::{Text, is_identifier_start};

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    Number(f64),
    /// A name in lower case, and whether a prime follows it directly.
    Name(String),
    /// An operator, parenthesis, comma or other punctuation.
    Symbol(&'static str),
    End,
}

/// Punctuation, longest first.
const SYMBOLS: [&str; 26] = [
    "**", "==", ">=", "<=", "!=", "<>", "&&", "||", "+", "-", "*", "/", "^", "(", ")", ",", ">", "<", "&",
    "|", "{", "}", "[", "]", "'", "=",
];

/// Splits `line[start..end]` into tokens with their places; the last is [`Token::End`].
pub(crate) fn tokenize(line: &Text, start: usize, end: usize) -> Result<Vec<(Token, Span)>, OdeError> {
    let mut tokens = Vec::new();
    let mut position = start;
    loop {
        position = line.skip_blanks(position);
        if position >= end {
            break;
        }
        let character = line.at(position);
        if character.is_ascii_digit() || character == '.' {
            let after = number_end(line, position).min(end);
            let text = line.string(position, after);
            let value = parse_number(&text).ok_or_else(|| {
                OdeError::syntax(line.span(position, after), format!("`{text}` is not a number"))
            })?;
            tokens.push((Token::Number(value), line.span(position, after)));
            position = after;
        } else if is_identifier_start(character) {
            let after = line.identifier_end(position).min(end);
            let name = line.string(position, after).to_ascii_lowercase();
            tokens.push((Token::Name(name), line.span(position, after)));
            position = after;
        } else {
            let symbol = SYMBOLS.iter().find(|symbol| {
                symbol.chars().enumerate().all(|(offset, expected)| line.at(position + offset) == expected)
            });
            let Some(symbol) = symbol else {
                let message = format!("`{}` has no meaning in an expression", character.escape_default());
                return Err(OdeError::syntax(line.span(position, position + 1), message));
            };
            let after = position + symbol.len();
            tokens.push((Token::Symbol(symbol), line.span(position, after)));
            position = after;
        }
    }
    tokens.push((Token::End, line.span(end, end + 1)));
    Ok(tokens)
}

/// End of the number that starts at `start`: digits, a point, digits, and an exponent if it has digits.
fn number_end(line: &Text, start: usize) -> usize {
    let digits = |from: usize| line.find(from, |character| !character.is_ascii_digit());
    let mut end = digits(start);
    if line.at(end) == '.' {
        end = digits(end + 1);
    }
    if line.lower_at(end) == 'e' {
        let sign = usize::from(matches!(line.at(end + 1), '+' | '-'));
        let exponent_end = digits(end + 1 + sign);
        if exponent_end > end + 1 + sign {
            return exponent_end;
        }
    }
    end
}

/// A decimal number with an optional sign, such as `-1e-3`, `.5` or `2.`; neither `inf` nor `nan`.
pub(crate) fn parse_number(text: &str) -> Option<f64> {
    let starts_well =
        text.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit() || c == '.');
    if starts_well { text.parse().ok() } else { None }
}
