//! The description of the routes, an OpenAPI document that is a part of the program and served with the page.

use serde_json::{Map, Value};

/// A document of the program as data. One that is none is empty, which a test would notice.
pub(crate) fn described(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_default()
}

/// A document with the paths and schemas of another one added, and its title.
pub fn joined(mut document: Value, text: &str) -> Value {
    let other = described(text);
    for place in ["/paths", "/components/schemas"] {
        let added = other.pointer(place).and_then(Value::as_object).cloned().unwrap_or_default();
        if let Some(known) = document.pointer_mut(place).and_then(Value::as_object_mut) {
            known.extend(added);
        }
    }
    let info = other.get("info").and_then(Value::as_object).cloned().unwrap_or_else(Map::new);
    if let Some(known) = document.get_mut("info").and_then(Value::as_object_mut) {
        known.extend(info);
    }
    document
}
