//! How a computation is divided, as it stands in its folder, and how its chunks are put together.

use super::canonical::{canonical, digest, sha256};
use super::error::ChunkError;
use super::published::publish_once;
use serde_json::{Value, json};
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Name of the plan.
pub(super) const PLAN: &str = "sweep.json";
/// Name of the form of a plan, and its version.
const SCHEMA: (&str, u64) = ("arclength.sweep", 2);

/// How a computation is divided, the same for whoever works on it.
#[derive(Debug)]
pub struct Plan {
    pub(super) folder: PathBuf,
    /// What the file says, without its own hash.
    pub(super) document: Value,
    key: String,
    points: usize,
    size: usize,
    shards: usize,
}

impl Plan {
    /// The plan in a folder, which is this one where there is none yet. The folder is made where there is none.
    ///
    /// `function` tells a computation from any other, in texts and whole numbers; its `points` are divided into chunks of `size`, and
    /// those into `shards`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn in_folder(
        folder: &Path,
        function: &Value,
        [points, size, shards]: [usize; 3],
    ) -> Result<Self, ChunkError> {
        let path = folder.join(PLAN);
        if !path.exists() {
            fs::create_dir_all(folder).map_err(ChunkError::file(folder))?;
            let mut document = json!({
                "schema": {"name": SCHEMA.0, "version": SCHEMA.1},
                "version": env!("CARGO_PKG_VERSION"),
                "function": function,
                "points": points,
                "chunk": size,
                "shards": shards,
            });
            document["sha256"] = sha256(canonical(&document).as_bytes()).into();
            // Whoever is first says how it is divided; all others go by that.
            publish_once(&path, canonical(&document).as_bytes())?;
        }
        Self::read(folder)
    }

    /// The plan that is in a folder.
    ///
    /// # Errors
    /// [`ChunkError::NoPlan`]; [`ChunkError::Plan`] where it is not what was written, or that of a sweep of the Python package;
    /// [`ChunkError::File`].
    pub fn read(folder: &Path) -> Result<Self, ChunkError> {
        let path = folder.join(PLAN);
        let text = fs::read_to_string(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => ChunkError::NoPlan { path: path.clone() },
            _ => ChunkError::file(&path)(error),
        })?;
        let refused = |problem: &str, allowed: &str| ChunkError::Plan {
            path: path.clone(),
            problem: problem.to_owned(),
            allowed: allowed.to_owned(),
        };
        let changed = || refused("it is not what was written", "another folder, where all is computed anew");
        let mut document: Value = serde_json::from_str(&text).map_err(|_| changed())?;
        let told = document.as_object_mut().and_then(|fields| fields.remove("sha256"));
        if document["function"]["program"].as_str().is_none() {
            let allowed = "a folder in which a command with --shard keeps its chunks; a sweep of the Python package is put together by `python -m arclength merge`";
            return Err(refused("it tells of no computation of this program", allowed));
        }
        if told != Some(sha256(canonical(&document).as_bytes()).into()) {
            return Err(changed());
        }
        let number = |name: &str| document[name].as_u64().and_then(|number| usize::try_from(number).ok());
        let numbers = [number("points"), number("chunk"), number("shards")];
        let [Some(points), Some(size @ 1..), Some(shards @ 1..)] = numbers else { return Err(changed()) };
        let key = digest(&canonical(&document));
        Ok(Self { folder: folder.to_owned(), document, key, points, size, shards })
    }

    /// What tells the computation from any other.
    pub fn function(&self) -> &Value {
        &self.document["function"]
    }

    /// The file of the plan.
    pub fn path(&self) -> PathBuf {
        self.folder.join(PLAN)
    }

    /// Number of shards.
    pub fn shards(&self) -> usize {
        self.shards
    }

    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.points.div_ceil(self.size)
    }

    /// The points of a chunk.
    pub fn rows(&self, chunk: usize) -> Range<usize> {
        chunk * self.size..((chunk + 1) * self.size).min(self.points)
    }

    /// The chunks of a shard, counted from 1: every so many-th, so that what takes long is spread.
    pub fn chunks_of(&self, shard: usize) -> impl Iterator<Item = usize> + use<> {
        (shard - 1..self.chunks()).step_by(self.shards)
    }

    /// What a chunk depends on.
    pub(super) fn identity(&self, chunk: usize) -> String {
        let Range { start, end } = self.rows(chunk);
        canonical(&json!({"sweep": self.key, "start": start, "stop": end}))
    }

    /// The name of its file.
    pub(super) fn file_name(&self, chunk: usize) -> String {
        format!("{chunk:08}-{}.parquet", digest(&self.identity(chunk)))
    }

    /// Its file.
    pub(super) fn file(&self, chunk: usize) -> PathBuf {
        self.folder.join(self.file_name(chunk))
    }

    pub(super) fn shard_of(&self, chunk: usize) -> usize {
        chunk % self.shards + 1
    }
}
