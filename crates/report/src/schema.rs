//! Name and version of a result, by which files are told apart when they are read back.

use serde::{Deserialize, Serialize};

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
