//! Computations as they stand in journals and in the folders of shards: what differs between that which is kept and that which is asked for.

use serde_json::Value;

/// The first field in which two computations differ.
pub(crate) fn difference(kept: &Value, asked: &Value) -> Option<String> {
    if kept == asked {
        return None;
    }
    if let (Some(kept), Some(asked)) = (kept.as_object(), asked.as_object()) {
        // The parameters first: other fields may differ because of them.
        let part = |nested: bool| asked.iter().filter(move |(_, value)| value.is_object() == nested);
        let differing = part(true).chain(part(false)).find_map(|(name, value)| {
            difference(kept.get(name).unwrap_or(&Value::Null), value).map(|text| match value.is_object() {
                true => text,
                false => format!("{name} {text}"),
            })
        });
        return differing.or(Some("it has other fields".to_owned()));
    }
    Some(format!("was {kept}, now it is {asked}"))
}
