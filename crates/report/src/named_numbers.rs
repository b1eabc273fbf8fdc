//! Numbers with names in their order, and numbers that may be infinite, as JSON.
//!
//! JSON has no infinity: it is the text `"inf"`.

use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

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

/// Fields of numbers that may be infinite, each written as a [`Number`]: `#[serde(with = "kingpin_report::number")]` on a field of
/// type `f64`, `[f64; 2]` or `[[f64; 2]; 2]`.
pub mod number {
    use super::Number;
    use serde::de::DeserializeOwned;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// A number, or pairs of them.
    pub trait Numbers: Copy {
        /// As it is written.
        type Written: Serialize + DeserializeOwned;
        /// As it is written.
        fn written(self) -> Self::Written;
        /// As it was read.
        fn read(written: Self::Written) -> Self;
    }

    impl Numbers for f64 {
        type Written = Number;

        fn written(self) -> Number {
            Number(self)
        }

        fn read(Number(value): Number) -> Self {
            value
        }
    }

    impl<N: Numbers> Numbers for [N; 2] {
        type Written = [N::Written; 2];

        fn written(self) -> Self::Written {
            self.map(N::written)
        }

        fn read(written: Self::Written) -> Self {
            written.map(N::read)
        }
    }

    /// Writes numbers, or the text `"inf"` for one that is infinite.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<N: Numbers, S: Serializer>(value: &N, serializer: S) -> Result<S::Ok, S::Error> {
        value.written().serialize(serializer)
    }

    /// Reads numbers, or the text `"inf"` for one that is infinite.
    ///
    /// # Errors
    /// Another text, and those of the deserializer.
    pub fn deserialize<'de, N: Numbers, D: Deserializer<'de>>(deserializer: D) -> Result<N, D::Error> {
        N::Written::deserialize(deserializer).map(N::read)
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
