//! What comes with a request: the request of an analysis, and the files that it names.

use crate::failure::Failure;
use arclength_analysis::FilesInMemory;
use axum::body::Bytes;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

/// A request of an analysis with the files that it names.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked<R> {
    /// The request.
    pub request: R,
    /// Earlier results by the names under which the request has them.
    #[serde(default, deserialize_with = "files")]
    pub files: FilesInMemory,
}

fn files<'de, D: Deserializer<'de>>(deserializer: D) -> Result<FilesInMemory, D::Error> {
    let texts = BTreeMap::<String, String>::deserialize(deserializer)?;
    Ok(texts.into_iter().map(|(name, text)| (name, text.into_bytes())).collect())
}

/// Reads the body of a request.
///
/// # Errors
/// [`Failure::bad_request`] with what is wrong and where.
pub fn parse<B: DeserializeOwned>(body: &Bytes) -> Result<B, Failure> {
    serde_json::from_slice(body)
        .map_err(|error| Failure::bad_request(format!("the body of the request cannot be read: {error}")))
}
