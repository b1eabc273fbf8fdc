//! The parameters of a result: numbers, and words where a model has a choice.

use crate::named_numbers::{NamedNumbers, Number};
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Parameters with names. In JSON they are one object, words first; an infinite number is the text `"inf"`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Those that are words.
    pub words: Vec<(String, String)>,
    /// Those that are numbers.
    pub numbers: NamedNumbers,
    /// What is worth knowing of how they were given; not in JSON.
    pub remarks: Vec<String>,
}

impl From<NamedNumbers> for Parameters {
    fn from(numbers: NamedNumbers) -> Self {
        Self { numbers, ..Self::default() }
    }
}

/// What a parameter is.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Value {
    Number(Number),
    Word(String),
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let words = self.words.iter().map(|(name, word)| (name, Value::Word(word.clone())));
        let numbers = self.numbers.0.iter().map(|(name, number)| (name, Value::Number(Number(*number))));
        serializer.collect_map(words.chain(numbers))
    }
}

impl<'de> Deserialize<'de> for Parameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(InOrder)
    }
}

/// Reads an object entry by entry, so that the order of the names is kept.
struct InOrder;

impl<'de> Visitor<'de> for InOrder {
    type Value = Parameters;

    fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("an object of numbers and words")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Parameters, A::Error> {
        let mut parameters = Parameters::default();
        while let Some((name, value)) = entries.next_entry()? {
            match value {
                Value::Number(Number(number)) => parameters.numbers.0.push((name, number)),
                Value::Word(word) => parameters.words.push((name, word)),
            }
        }
        Ok(parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_words_are_read_back() {
        let numbers = NamedNumbers(vec![("r".to_owned(), f64::INFINITY), ("l".to_owned(), 0.1)]);
        let parameters = Parameters {
            words: vec![("tyre".to_owned(), "brush".to_owned())],
            numbers,
            ..Parameters::default()
        };
        let text = serde_json::to_string(&parameters).unwrap();
        assert_eq!(text, r#"{"tyre":"brush","r":"inf","l":0.1}"#);
        assert_eq!(serde_json::from_str::<Parameters>(&text).unwrap(), parameters);
    }
}
