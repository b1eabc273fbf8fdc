//! As much of JSON Schema as the description of the routes uses.

use serde_json::Value;

/// The schema that a reference names, or the schema itself.
pub(crate) fn resolved<'a>(document: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(reference) => {
            let pointer = reference.strip_prefix('#').unwrap();
            let found = document.pointer(pointer).unwrap_or_else(|| panic!("{reference} names nothing"));
            resolved(document, found)
        }
        None => schema,
    }
}

fn is_of(kind: &str, value: &Value) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("type {other}"),
    }
}

/// What is wrong with a value; nothing where it obeys the schema. No other properties are allowed than those that the schema names.
pub(crate) fn mistake(document: &Value, schema: &Value, value: &Value) -> Option<String> {
    let schema = resolved(document, schema);
    if let Some(list) = schema["anyOf"].as_array().or(schema["oneOf"].as_array()) {
        let mistakes: Vec<String> =
            list.iter().map(|one| mistake(document, one, value)).collect::<Option<_>>()?;
        return Some(mistakes.join(", or "));
    }
    let kinds = match &schema["type"] {
        Value::String(kind) => vec![kind.as_str()],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => panic!("a schema without a type: {schema}"),
    };
    if !kinds.iter().any(|kind| is_of(kind, value)) {
        return Some(format!("{value} is none of {kinds:?}"));
    }
    if let Some(allowed) = schema["enum"].as_array()
        && !allowed.contains(value)
    {
        return Some(format!("{value} is none of {allowed:?}"));
    }
    if let Some(items) = value.as_array() {
        let within = |bound: &str, fits: fn(u64, u64) -> bool| {
            schema[bound].as_u64().is_none_or(|bound| fits(items.len() as u64, bound))
        };
        if !within("minItems", |count, least| count >= least)
            || !within("maxItems", |count, most| count <= most)
        {
            return Some(format!("{} items", items.len()));
        }
        return items.iter().find_map(|item| mistake(document, &schema["items"], item));
    }
    let fields = value.as_object()?;
    let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let missing = required.into_iter().find(|name| !fields.contains_key(*name));
    if let Some(name) = missing {
        return Some(format!("{name} is missing"));
    }
    fields.iter().find_map(|(name, field)| {
        let own = &schema["properties"][name];
        let other = &schema["additionalProperties"];
        match (own.is_null(), other.is_object()) {
            (false, _) => mistake(document, own, field).map(|mistake| format!("{name}: {mistake}")),
            (true, true) => mistake(document, other, field),
            // What is described in words only may hold anything.
            (true, false) if schema["properties"].is_null() => None,
            (true, false) => Some(format!("{name} is not described")),
        }
    })
}
