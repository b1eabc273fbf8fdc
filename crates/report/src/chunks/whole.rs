//! All chunks of a plan put together, if they are there as they were written and nothing else is.

use super::chunk::Kept;
use super::error::ChunkError;
use super::manifest::write_manifest;
use super::plan::{PLAN, Plan};
use crate::columns::Columns;
use std::collections::BTreeSet;
use std::fs;

/// Most shards that are named one by one.
const NAMED: usize = 12;

impl Plan {
    /// All chunks, put together in the order of the points; the manifest is written.
    ///
    /// # Errors
    /// [`ChunkError::Stranger`], [`ChunkError::Damaged`], [`ChunkError::Missing`], [`ChunkError::File`].
    pub fn put_together(&self) -> Result<Columns, ChunkError> {
        self.check_for_strangers()?;
        let (mut all, mut receipts) = (None::<Columns>, Vec::new());
        let (mut missing, mut of_shards) = (0, BTreeSet::new());
        for chunk in 0..self.chunks() {
            let damaged = |problem| ChunkError::Damaged {
                path: self.file(chunk),
                problem,
                shard: format!("{}/{}", self.shard_of(chunk), self.shards()),
            };
            match self.look(chunk)? {
                Kept::Missing => {
                    missing += 1;
                    of_shards.insert(self.shard_of(chunk));
                }
                Kept::Damaged(problem) => return Err(damaged(problem)),
                Kept::Whole(columns, receipt) => {
                    receipts.push(receipt);
                    let is_alike = match &mut all {
                        Some(all) => all.append(columns),
                        none => none.insert(columns).rows() > 0,
                    };
                    if !is_alike {
                        return Err(damaged("it has other columns".to_owned()));
                    }
                }
            }
        }
        if missing > 0 {
            let (folder, count) = (self.folder.clone(), self.chunks());
            return Err(ChunkError::Missing { folder, missing, count, shards: self.named(&of_shards) });
        }
        write_manifest(&self.folder, &self.document, &receipts)?;
        Ok(all.unwrap_or_default())
    }

    /// Shards as options.
    fn named(&self, shards: &BTreeSet<usize>) -> String {
        let some = shards.iter().take(NAMED).map(|shard| format!("--shard {shard}/{}", self.shards()));
        let some = some.collect::<Vec<_>>().join(", ");
        match shards.len().saturating_sub(NAMED) {
            0 => some,
            more => format!("{some} and {more} more"),
        }
    }

    /// Chunks that were put here from elsewhere are refused: which ones are right nobody knows.
    fn check_for_strangers(&self) -> Result<(), ChunkError> {
        let own: BTreeSet<String> = (0..self.chunks()).map(|chunk| self.file_name(chunk)).collect();
        let length = own.first().map_or(0, String::len);
        let mut strangers: Vec<String> = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(ChunkError::file(&self.folder))? {
            let name = entry.map_err(ChunkError::file(&self.folder))?.file_name();
            let Some(name) = name.to_str() else { continue };
            let is_chunk = name.len() == length
                && name.ends_with(".parquet")
                && name.bytes().take(8).all(|byte| byte.is_ascii_digit());
            if is_chunk && !own.contains(name) {
                strangers.push(name.to_owned());
            }
        }
        match strangers.into_iter().min() {
            Some(name) => Err(ChunkError::Stranger { path: self.folder.join(name), plan: PLAN }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chunks::canonical::{digest, sha256};
    use serde_json::{Value, json};
    use std::ops::Range;
    use std::path::Path;

    /// Seven points in chunks of two, in three shards.
    fn plan(folder: &Path) -> Plan {
        let function = json!({"program": "test", "command": "square"});
        Plan::in_folder(folder, &function, [7, 2, 3]).unwrap()
    }

    fn columns(points: Range<usize>) -> Columns {
        Columns::new().numbers("square", points.map(|point| (point * point) as f64))
    }

    fn compute(plan: &Plan, shard: usize) {
        for chunk in plan.chunks_of(shard) {
            plan.keep(chunk, &columns(plan.rows(chunk))).unwrap();
        }
    }

    #[test]
    fn shards_make_the_whole() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("made/here");
        for shard in [2, 3, 1] {
            let plan = plan(&place);
            assert_eq!((plan.chunks(), plan.shards()), (4, 3));
            compute(&plan, shard);
            assert!(plan.chunks_of(shard).all(|chunk| plan.is_kept(chunk).unwrap()));
        }
        let plan = Plan::read(&place).unwrap();
        assert_eq!(plan.put_together().unwrap(), columns(0..7));
        let manifest: Value =
            serde_json::from_slice(&fs::read(place.join("manifest.json")).unwrap()).unwrap();
        assert_eq!(manifest["chunks"][3]["rows"], 1);
        assert_eq!(manifest["sweep"]["points"], 7);
        // Nothing but plan, manifest, and each chunk with its hash.
        assert_eq!(fs::read_dir(&place).unwrap().count(), 2 + 2 * 4);
    }

    #[test]
    fn what_is_not_there_is_named_by_its_shards() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path());
        compute(&plan, 2);
        let message = plan.put_together().unwrap_err().to_string();
        assert!(message.contains("3 of 4 chunks are not there, of --shard 1/3, --shard 3/3"), "{message}");
        assert!(!folder.path().join("manifest.json").exists());
    }

    #[test]
    fn what_was_changed_or_comes_from_elsewhere_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path());
        (1..=3).for_each(|shard| compute(&plan, shard));
        let refused = || plan.put_together().unwrap_err().to_string();
        let path = plan.file(1);
        let kept = fs::read(&path).unwrap();
        for place in [0, kept.len() / 2, kept.len() - 1] {
            let mut changed = kept.clone();
            changed[place] ^= 1;
            fs::write(&path, &changed).unwrap();
            assert!(refused().contains("--shard 2/3 again"), "{}", refused());
            assert!(!plan.is_kept(1).unwrap());
        }
        // Another chunk under its name, with a hash that fits.
        let other = fs::read(plan.file(0)).unwrap();
        fs::write(&path, &other).unwrap();
        fs::write(path.with_extension("sha256"), format!("{}  {}\n", sha256(&other), plan.file_name(1)))
            .unwrap();
        assert!(refused().contains("other points"), "{}", refused());
        fs::remove_file(path.with_extension("sha256")).unwrap();
        assert!(refused().contains("its hash is not beside it"), "{}", refused());
        compute(&plan, 2);
        plan.put_together().unwrap();
        let stranger = format!("00000002-{}.parquet", digest("another"));
        fs::copy(plan.file(2), folder.path().join(&stranger)).unwrap();
        assert!(refused().contains(&format!("{stranger}: it is a chunk of another")), "{}", refused());
        // A plan that was changed.
        let path = plan.path();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replace("\"points\":7", "\"points\":8")).unwrap();
        assert!(Plan::read(folder.path()).unwrap_err().to_string().contains("not what was written"));
        fs::write(&path, "{\"function\":{}}").unwrap();
        assert!(Plan::read(folder.path()).unwrap_err().to_string().contains("python -m arclength merge"));
        fs::remove_file(&path).unwrap();
        assert!(matches!(Plan::read(folder.path()), Err(ChunkError::NoPlan { .. })));
    }
}
