//! Results as JSON: one object with `schema`, `parameters` and the fields of the result.
//!
//! JSON has no infinity: among the parameters it is the text `"inf"`, and what is not a number elsewhere is `null`.
//! One line holds one field, or one object of a list, so that files can be read, searched and compared.

use crate::failure::Failure;
use crate::report::Report;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::io::{self, Write};

/// Name and version of the form of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Schema {
    /// Such as `kingpin.steady`.
    pub name: String,
    /// Raised when fields are removed or change their meaning; added fields leave it as it is.
    pub version: u32,
}

impl Schema {
    /// The first version of the form of a name.
    pub fn first(name: &str) -> Self {
        Self { name: name.to_owned(), version: 1 }
    }
}

/// A number that may be infinite: then it is the text `"inf"` or `"-inf"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_infinite() {
            serializer.serialize_str(&self.0.to_string())
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Entry {
            Number(f64),
            Text(String),
        }
        match Entry::deserialize(deserializer)? {
            Entry::Number(value) => Ok(Self(value)),
            Entry::Text(text) => match text.parse::<f64>() {
                Ok(value) if value.is_infinite() => Ok(Self(value)),
                _ => Err(D::Error::custom(format!("\"{text}\" is neither a number nor \"inf\""))),
            },
        }
    }
}

/// Numbers with names, in an order: parameters or states.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedNumbers(pub Vec<(String, f64)>);

impl NamedNumbers {
    /// The number with an index.
    pub fn get(&self, index: usize) -> Option<f64> {
        self.0.get(index).map(|&(_, number)| number)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The number with a name.
    pub fn named(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(candidate, _)| candidate == name).map(|&(_, number)| number)
    }
}

impl Serialize for NamedNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, Number(*value))))
    }
}

impl<'de> Deserialize<'de> for NamedNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(InOrder)
    }
}

/// Reads an object entry by entry, so that the order of the names is kept.
struct InOrder;

impl<'de> Visitor<'de> for InOrder {
    type Value = NamedNumbers;

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("an object of numbers")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<NamedNumbers, A::Error> {
        let mut named = Vec::new();
        while let Some((name, Number(value))) = entries.next_entry()? {
            named.push((name, value));
        }
        Ok(NamedNumbers(named))
    }
}

#[derive(Serialize)]
struct Document<'a, R> {
    schema: Schema,
    parameters: NamedNumbers,
    #[serde(flatten)]
    result: &'a R,
}

/// Writes a result as JSON.
///
/// # Errors
/// Those of the writer.
pub fn write<R: Report>(result: &R, out: &mut dyn Write) -> Result<(), Failure> {
    let document = Document { schema: result.schema(), parameters: result.parameters(), result };
    let mut serializer = serde_json::Serializer::with_formatter(&mut *out, Lines::default());
    let written = document.serialize(&mut serializer).map_err(io::Error::from);
    written
        .and_then(|()| out.write_all(b"\n"))
        .map_err(|error| crate::terminal::output_failure(error, "JSON"))
}

/// One field of the object, or one object of a list in it, on a line.
#[derive(Default)]
struct Lines {
    depth: usize,
    list_of_objects: bool,
}

impl serde_json::ser::Formatter for Lines {
    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.depth == 2 {
            self.list_of_objects = true;
            writer.write_all(b"\n    ")?;
        }
        self.depth += 1;
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        writer.write_all(if self.depth == 0 { b"\n}" } else { b"}" })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        match (self.depth, first) {
            (1, true) => writer.write_all(b"\n  "),
            (1, false) => writer.write_all(b",\n  "),
            (_, true) => Ok(()),
            (_, false) => writer.write_all(b", "),
        }
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        writer.write_all(b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if self.depth == 1 && std::mem::take(&mut self.list_of_objects) {
            writer.write_all(b"\n  ")?;
        }
        writer.write_all(b"]")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_read_back() {
        let parameters = NamedNumbers(vec![("r".to_owned(), f64::INFINITY), ("l".to_owned(), 0.1)]);
        let text = serde_json::to_string(&parameters).unwrap();
        assert_eq!(text, r#"{"r":"inf","l":0.1}"#);
        assert_eq!(serde_json::from_str::<NamedNumbers>(&text).unwrap(), parameters);
        let error = serde_json::from_str::<NamedNumbers>(r#"{"r":"far"}"#).unwrap_err();
        assert!(error.to_string().contains("\"far\""));
    }
}
