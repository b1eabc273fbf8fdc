//! JSON texts that are the same for equal values, and their hashes.

use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Hexadecimal digits of a short hash.
const DIGITS: usize = 20;

/// A value as a text: keys in order, no spaces, nothing but ASCII, as Python's `json.dumps` writes it with `sort_keys`. Of numbers only
/// whole ones are the same there.
pub(super) fn canonical(value: &Value) -> String {
    let mut text = String::new();
    append(value, &mut text);
    text
}

fn append(value: &Value, text: &mut String) {
    let separated = |index: usize, text: &mut String| text.push_str(if index > 0 { "," } else { "" });
    match value {
        Value::Array(items) => {
            text.push('[');
            for (index, item) in items.iter().enumerate() {
                separated(index, text);
                append(item, text);
            }
            text.push(']');
        }
        Value::Object(fields) => {
            let mut fields: Vec<(&String, &Value)> = fields.iter().collect();
            fields.sort_unstable_by_key(|(name, _)| *name);
            text.push('{');
            for (index, (name, field)) in fields.into_iter().enumerate() {
                separated(index, text);
                append_ascii(&Value::from(name.as_str()).to_string(), text);
                text.push(':');
                append(field, text);
            }
            text.push('}');
        }
        other => append_ascii(&other.to_string(), text),
    }
}

/// Escapes what is not printable ASCII, which stands in strings only.
fn append_ascii(json: &str, text: &mut String) {
    for character in json.chars() {
        if (' '..='~').contains(&character) {
            text.push(character);
            continue;
        }
        for unit in character.encode_utf16(&mut [0; 2]) {
            // Writing to memory does not fail.
            let _ = write!(text, "\\u{unit:04x}");
        }
    }
}

/// The SHA-256 of a content in hexadecimal digits.
pub(super) fn sha256(content: &[u8]) -> String {
    Sha256::digest(content).iter().fold(String::new(), |mut digits, byte| {
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

/// A short hash of a text, for names.
pub(super) fn digest(text: &str) -> String {
    let mut digits = sha256(text.as_bytes());
    digits.truncate(DIGITS);
    digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// What Python 3.11 says of the same value.
    #[test]
    fn texts_and_hashes_are_those_of_python() {
        let value = json!({"b": [1, null, true], "a": "é\u{7f}\n\"\\ 𝛼", "ä": {"z": 0, "y": ""}});
        let text = canonical(&value);
        let python = "{\"a\":\"\\u00e9\\u007f\\n\\\"\\\\ \\ud835\\udefc\",\"b\":[1,null,true],\"\\u00e4\":{\"y\":\"\",\"z\":0}}";
        assert_eq!(text, python);
        assert_eq!(digest("abc"), "ba7816bf8f01cfea4141");
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }
}
