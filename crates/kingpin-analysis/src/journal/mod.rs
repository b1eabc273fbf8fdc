//! Journals of long runs: every finished part is kept beside the result file at once, so that a run that is interrupted, or
//! killed, can be resumed.
//!
//! A journal is text: its first line says which computation it belongs to, every other line is a JSON array of the index
//! of a part and its result. A last line that was torn is passed over. It goes when the result has been written.

use crate::error::Error;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// What is added to the name of the result file.
const ENDING: &str = ".journal";

/// The finished parts of a run, on disk where there is a result file.
#[derive(Debug)]
pub struct Journal<Part> {
    place: Option<(PathBuf, Mutex<File>)>,
    finished: BTreeMap<usize, Part>,
    /// Why a part could not be kept.
    lost: Mutex<Option<std::io::Error>>,
}

impl<Part: Clone + Serialize + DeserializeOwned> Journal<Part> {
    /// A journal that keeps nothing.
    pub fn none() -> Self {
        Self { place: None, finished: BTreeMap::new(), lost: Mutex::default() }
    }

    /// Starts a journal beside a result file, or goes on with the one that is there. Without a result file nothing is kept.
    ///
    /// # Errors
    /// [`Error::Invalid`] where there is a journal that was not asked for, or one of another computation;
    /// [`Error::Journal`] where it cannot be read or written.
    pub(crate) fn open(result: Option<&Path>, computation: &Value, resume: bool) -> Result<Self, Error> {
        let Some(result) = result else {
            if resume {
                return Err(Error::invalid(&["resume"], "", "there is no result file", "with --out PATH"));
            }
            return Ok(Self::none());
        };
        let path = beside(result);
        let failure = |source| Error::Journal { path: path.clone(), source };
        let mut finished = BTreeMap::new();
        if path.exists() {
            if !resume {
                return Err(Error::invalid(
                    &["out"],
                    path.display().to_string(),
                    "an unfinished run is kept in it",
                    "go on with it by --resume, or delete it",
                ));
            }
            finished = read(&path, computation)?;
        }
        // Written anew, so that it ends with a whole line: as a temporary file first, the old one stays if that fails.
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut fresh = tempfile::Builder::new()
            .prefix(".unfinished-")
            .tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(failure)?;
        writeln!(fresh, "{computation}").map_err(failure)?;
        if path.exists() {
            copy_parts(&path, &mut fresh).map_err(failure)?;
        }
        let file = fresh.persist(&path).map_err(|error| failure(error.error))?;
        Ok(Self { place: Some((path, Mutex::new(file))), finished, lost: Mutex::default() })
    }

    /// The parts that were finished when it was opened, by index.
    pub fn finished(&self) -> &BTreeMap<usize, Part> {
        &self.finished
    }

    /// Keeps a finished part. Where that fails the run is to be stopped, and [`checked`](Self::checked) tells why.
    pub(crate) fn keep(&self, index: usize, part: &Part, stop: &AtomicBool) {
        let Some((_, file)) = &self.place else { return };
        let line = serde_json::to_string(&(index, part)).map_err(std::io::Error::from);
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        if let Err(error) = line.and_then(|line| file.write_all(format!("{line}\n").as_bytes())) {
            *self.lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            stop.store(true, Ordering::Relaxed);
        }
    }

    /// All parts in their order: those that were finished and those that were computed now.
    ///
    /// # Errors
    /// [`Error::Journal`] where a part could not be kept, [`Error::Interrupted`] where there are fewer than `count`.
    pub(crate) fn checked(
        &self,
        computed: impl IntoIterator<Item = (usize, Part)>,
        count: usize,
    ) -> Result<Vec<Part>, Error> {
        let lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let (Some(source), Some((path, _))) = (lost, &self.place) {
            return Err(Error::Journal { path: path.clone(), source });
        }
        let mut all = self.finished.clone();
        all.extend(computed);
        if all.len() == count {
            Ok(all.into_values().collect())
        } else {
            Err(self.interrupted(all.len(), count))
        }
    }

    /// That the run was stopped when so many of its parts were finished.
    pub(crate) fn interrupted(&self, done: usize, parts: usize) -> Error {
        let kept = match &self.place {
            Some((path, _)) => format!("kept in {}; go on with --resume", path.display()),
            None => "nothing was kept; with --out PATH it would be".to_owned(),
        };
        Error::Interrupted { done, parts, kept }
    }

    /// Removes the journal once the result is written.
    ///
    /// # Errors
    /// [`Error::Journal`].
    pub fn finish(self) -> Result<(), Error> {
        match self.place {
            Some((path, _)) => std::fs::remove_file(&path).map_err(|source| Error::Journal { path, source }),
            None => Ok(()),
        }
    }
}

fn beside(result: &Path) -> PathBuf {
    let mut name = result.as_os_str().to_owned();
    name.push(ENDING);
    name.into()
}

/// The lines that are whole.
fn lines(path: &Path) -> std::io::Result<Vec<String>> {
    let mut reader = BufReader::new(File::open(path)?);
    let mut lines = Vec::new();
    loop {
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line)?;
        if line.pop() != Some(b'\n') {
            return Ok(lines);
        }
        lines.push(String::from_utf8(line).map_err(std::io::Error::other)?);
    }
}

fn copy_parts(from: &Path, to: &mut impl Write) -> std::io::Result<()> {
    lines(from)?.iter().skip(1).try_for_each(|line| writeln!(to, "{line}"))
}

fn read<T: DeserializeOwned>(path: &Path, computation: &Value) -> Result<BTreeMap<usize, T>, Error> {
    let lines = lines(path).map_err(|source| Error::Journal { path: path.to_owned(), source })?;
    let other = |problem: String| {
        Error::invalid(
            &["resume"],
            path.display().to_string(),
            &problem,
            "the same command, or delete the journal",
        )
    };
    let Some(first) = lines.first() else {
        return Err(other("it is empty: no computation was kept in it".to_owned()));
    };
    let header: Value = match serde_json::from_str(first) {
        Ok(header @ Value::Object(_)) => header,
        _ => return Err(other("its first line does not say which computation it belongs to".to_owned())),
    };
    if let Some(difference) = difference(&header, computation) {
        return Err(other(format!("it is the journal of another computation: {difference}")));
    }
    let part = |(number, line): (usize, &String)| {
        serde_json::from_str(line).map_err(|error| other(format!("line {}: {error}", number + 2)))
    };
    lines.iter().skip(1).enumerate().map(part).collect()
}

/// The first field in which two computations differ.
fn difference(kept: &Value, asked: &Value) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn torn_lines_are_computed_again_and_other_computations_refused() {
        let folder = tempfile::tempdir().unwrap();
        let result = folder.path().join("a.json");
        let computation = json!({"command": "basin", "parameters": {"v": 4.0}});
        let never = AtomicBool::new(false);
        let journal = Journal::<Vec<u8>>::open(Some(&result), &computation, false).unwrap();
        assert!(journal.finished().is_empty());
        journal.keep(3, &vec![1_u8, 2], &never);
        journal.keep(0, &vec![0_u8], &never);
        let computed = [(3, vec![1_u8, 2]), (0, vec![0])];
        assert!(matches!(journal.checked(computed, 5), Err(Error::Interrupted { done: 2, parts: 5, .. })));
        drop(journal);
        let path = beside(&result);
        let mut text = std::fs::read_to_string(&path).unwrap();
        text += "[1,[7";
        std::fs::write(&path, &text).unwrap();
        assert!(Journal::<Vec<u8>>::open(Some(&result), &computation, false).is_err());
        let other = json!({"command": "basin", "parameters": {"v": 5.0}});
        let refused = || Journal::<Vec<u8>>::open(Some(&result), &other, true).unwrap_err().to_string();
        assert!(refused().contains("v was 4.0, now it is 5.0"), "{}", refused());
        for (content, reason) in
            [("", "it is empty"), ("null\n", "its first line"), ("{\"comm", "it is empty")]
        {
            std::fs::write(&path, content).unwrap();
            assert!(refused().contains(reason), "{content}: {}", refused());
        }
        std::fs::write(&path, &text).unwrap();
        let journal = Journal::<Vec<u8>>::open(Some(&result), &computation, true).unwrap();
        assert_eq!(journal.finished(), &BTreeMap::from([(3, vec![1, 2]), (0, vec![0])]));
        journal.keep(1, &vec![9_u8], &never);
        assert_eq!(journal.checked([(1, vec![9])], 3).unwrap(), [vec![0], vec![9], vec![1, 2]]);
        assert_eq!(read::<Vec<u8>>(&path, &computation).unwrap()[&1], [9]);
        journal.finish().unwrap();
        assert!(!path.exists());
    }
}
