//! The words of an expression.

use crate::error::{OdeError, Span};
use crate::look_alike;
use crate::source::Text;

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
        let name_end = line.identifier_end(position).min(end);
        if name_end > position {
            let name = line.string(position, name_end).to_ascii_lowercase();
            tokens.push((Token::Name(name), line.span(position, name_end)));
            position = name_end;
        } else if character.is_ascii_digit() || character == '.' {
            let after = line.number_end(position).min(end);
            let text = line.string(position, after);
            let value = parse_number(&text).ok_or_else(|| {
                OdeError::syntax(line.span(position, after), format!("`{text}` is not a number"))
            })?;
            tokens.push((Token::Number(value), line.span(position, after)));
            position = after;
        } else {
            let symbol = SYMBOLS.iter().find(|symbol| {
                symbol.chars().enumerate().all(|(offset, expected)| line.at(position + offset) == expected)
            });
            let Some(symbol) = symbol else {
                let (sign, remedy) = (character.escape_default(), look_alike::remedy(character));
                let message = format!("`{sign}` has no meaning in an expression{remedy}");
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

/// A decimal number with an optional sign, such as `-1e-3`, `.5`, `2.` or `inf`; not `nan`.
pub(crate) fn parse_number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| !number.is_nan())
}
