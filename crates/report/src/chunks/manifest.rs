//! What is told of chunks: of each a receipt, of all of them the manifest.

use super::canonical::{canonical, sha256};
use super::error::ChunkError;
use super::published::publish;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// Name of the manifest.
const MANIFEST: &str = "manifest.json";

/// What is told of a chunk.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Receipt {
    chunk: usize,
    file: String,
    rows: usize,
    bytes: usize,
    sha256: String,
}

impl Receipt {
    /// That of a chunk with this content.
    pub(super) fn new(chunk: usize, file: String, rows: usize, content: &[u8]) -> Self {
        Self { chunk, file, rows, bytes: content.len(), sha256: sha256(content) }
    }

    /// The line of the file beside the chunk.
    pub(super) fn hash_line(&self) -> String {
        format!("{}  {}\n", self.sha256, self.file)
    }
}

/// Writes the manifest of a computation whose chunks are all there.
pub(super) fn write_manifest(folder: &Path, plan: &Value, receipts: &[Receipt]) -> Result<(), ChunkError> {
    let manifest = canonical(&json!({"sweep": plan, "chunks": receipts}));
    publish(&folder.join(MANIFEST), manifest.as_bytes())
}
