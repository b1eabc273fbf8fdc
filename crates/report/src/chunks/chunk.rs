//! One chunk: written, and looked at whether it is there as it was written.

use super::error::ChunkError;
use super::manifest::Receipt;
use super::plan::Plan;
use super::published::publish;
use crate::columns::Columns;
use crate::parquet;
use std::fs;
use std::io;
use std::path::Path;

/// Key of what a chunk depends on in the metadata of its file.
const IDENTITY: &str = "arclength.chunk";

/// What there is of a chunk.
#[derive(Debug)]
pub(super) enum Kept {
    /// It is as it was written.
    Whole(Columns, Receipt),
    /// It is there, but not as it was written, for this reason.
    Damaged(String),
    /// It is not there.
    Missing,
}

impl Plan {
    /// Writes a chunk, beside it first its hash.
    ///
    /// # Errors
    /// [`ChunkError::File`] and [`ChunkError::Report`].
    pub fn keep(&self, chunk: usize, columns: &Columns) -> Result<(), ChunkError> {
        let mut content = Vec::new();
        parquet::write(columns, &[(IDENTITY, self.identity(chunk))], &mut content)?;
        let path = self.file(chunk);
        let receipt = Receipt::new(chunk, self.file_name(chunk), columns.rows(), &content);
        publish(&path.with_extension("sha256"), receipt.hash_line().as_bytes())?;
        publish(&path, &content)
    }

    /// Whether a chunk is there as it was written.
    ///
    /// # Errors
    /// [`ChunkError::File`].
    pub fn is_kept(&self, chunk: usize) -> Result<bool, ChunkError> {
        Ok(matches!(self.look(chunk)?, Kept::Whole(..)))
    }

    /// Looks at a chunk.
    pub(super) fn look(&self, chunk: usize) -> Result<Kept, ChunkError> {
        let path = self.file(chunk);
        let Some(content) = content_of(&path)? else { return Ok(Kept::Missing) };
        let Some(hash) = content_of(&path.with_extension("sha256"))? else {
            return Ok(Kept::Damaged("its hash is not beside it".to_owned()));
        };
        let rows = self.rows(chunk).len();
        let receipt = Receipt::new(chunk, self.file_name(chunk), rows, &content);
        if hash != receipt.hash_line().as_bytes() {
            return Ok(Kept::Damaged("its content does not fit the hash beside it".to_owned()));
        }
        let stored = match parquet::read(content) {
            Ok(stored) => stored,
            Err(error) => return Ok(Kept::Damaged(error.to_string())),
        };
        let identity = Some(self.identity(chunk));
        let is_its_own = stored.metadata.iter().any(|(key, value)| key == IDENTITY && *value == identity);
        Ok(match is_its_own && stored.columns.rows() == rows {
            true => Kept::Whole(stored.columns, receipt),
            false => Kept::Damaged("it holds other points".to_owned()),
        })
    }
}

/// The content of a file; nothing where there is none.
fn content_of(path: &Path) -> Result<Option<Vec<u8>>, ChunkError> {
    match fs::read(path) {
        Ok(content) => Ok(Some(content)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(ChunkError::file(path)(error)),
    }
}
