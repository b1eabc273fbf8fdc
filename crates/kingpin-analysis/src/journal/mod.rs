//! Journals of long runs: every finished part is kept beside the result file at once, so that a run that is interrupted, or
//! killed, can be resumed.
//!
//! A journal is text: its first line says which computation it belongs to, every other line is a JSON array of the index
//! of a part and its result. Before each stands its [`checksum`], so that what was changed afterwards is refused and not believed. A
//! last line that was torn is passed over. The journal goes when the result has been written.

mod checksum;

use crate::computation::difference;
use crate::error::Error;
use checksum::{Checked, Checksum};
use kingpin_report::UnfinishedFile;
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
    /// That of the first line, from which those of the parts go on.
    checksum: Checksum,
    finished: BTreeMap<usize, Part>,
    /// Why a part could not be kept.
    lost: Mutex<Option<std::io::Error>>,
}

impl<Part: Clone + Serialize + DeserializeOwned> Journal<Part> {
    /// A journal that keeps nothing.
    pub fn none() -> Self {
        let checksum = Checksum::of_nothing();
        Self { place: None, checksum, finished: BTreeMap::new(), lost: Mutex::default() }
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
        let mut fresh = UnfinishedFile::beside(&path).map_err(failure)?;
        let header = computation.to_string();
        let checksum = Checksum::of_nothing().and(header.as_bytes());
        fresh.file().write_all(checksum.line(&header).as_bytes()).map_err(failure)?;
        if path.exists() {
            copy_parts(&path, fresh.file()).map_err(failure)?;
        }
        let file = fresh.finish(&path).map_err(failure)?;
        Ok(Self { place: Some((path, Mutex::new(file))), checksum, finished, lost: Mutex::default() })
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
        let line = line.map(|line| self.checksum.and(line.as_bytes()).line(&line));
        if let Err(error) = line.and_then(|line| file.write_all(line.as_bytes())) {
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
fn lines(path: &Path) -> std::io::Result<Vec<Vec<u8>>> {
    let mut reader = BufReader::new(File::open(path)?);
    let mut lines = Vec::new();
    loop {
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line)?;
        if line.pop() != Some(b'\n') {
            return Ok(lines);
        }
        lines.push(line);
    }
}

fn copy_parts(from: &Path, to: &mut impl Write) -> std::io::Result<()> {
    lines(from)?.iter().skip(1).try_for_each(|line| to.write_all(line).and_then(|()| to.write_all(b"\n")))
}

/// The finished parts of a journal that belongs to a computation and is as it was kept.
fn read<T: DeserializeOwned>(path: &Path, computation: &Value) -> Result<BTreeMap<usize, T>, Error> {
    let lines = lines(path).map_err(|source| Error::Journal { path: path.to_owned(), source })?;
    let refused = |problem: String, remedy: &str| {
        Error::invalid(&["resume"], path.display().to_string(), &problem, remedy)
    };
    const ANOTHER: &str = "the same command, or delete the journal";
    const ANEW: &str = "a journal as it was kept: delete it, and run the command without --resume";
    let Some(first) = lines.first() else {
        return Err(refused("it is empty: no computation was kept in it".to_owned(), ANOTHER));
    };
    let start = Checksum::of_nothing();
    let (header, checksum) = match start.check(first) {
        Checked::Fits(content) => (content, start.and(content)),
        Checked::Differs => return Err(refused(changed(1), ANEW)),
        Checked::Missing if first.first() == Some(&b'{') => {
            let problem = "line 1 has no checksum: an earlier version kept it, and nothing shows whether its numbers are as they were";
            return Err(refused(problem.to_owned(), ANEW));
        }
        Checked::Missing => {
            let problem = "its first line does not say which computation it belongs to";
            return Err(refused(problem.to_owned(), ANEW));
        }
    };
    let header: Value =
        serde_json::from_slice(header).map_err(|error| refused(format!("line 1: {error}"), ANEW))?;
    if let Some(difference) = difference(&header, computation) {
        return Err(refused(format!("it is the journal of another computation: {difference}"), ANOTHER));
    }
    let part = |(index, line): (usize, &Vec<u8>)| {
        let number = index + 2;
        let Checked::Fits(content) = checksum.check(line) else {
            let remedy =
                format!("a journal as it was kept: delete line {number}, and its part is computed again");
            return Err(refused(changed(number), &remedy));
        };
        serde_json::from_slice(content).map_err(|error| refused(format!("line {number}: {error}"), ANEW))
    };
    lines.iter().skip(1).enumerate().map(part).collect()
}

fn changed(line: usize) -> String {
    format!("line {line} was changed after it was kept: it does not fit its checksum")
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
        for (content, reason) in [
            ("", "it is empty"),
            ("null\n", "its first line"),
            ("{\"comm", "it is empty"),
            ("{\"command\":\"basin\"}\n[0,[1]]\n", "line 1 has no checksum"),
        ] {
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

    #[test]
    fn whatever_is_changed_in_a_journal_is_refused_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let result = folder.path().join("a.json");
        let computation = json!({"command": "margin", "parameters": {"v": 4.0}});
        let never = AtomicBool::new(false);
        let journal = Journal::<f64>::open(Some(&result), &computation, false).unwrap();
        for part in 0..3 {
            journal.keep(part, &(0.441_323_28 + part as f64), &never);
        }
        let path = beside(&result);
        let kept = std::fs::read(&path).unwrap();
        let mut tried = 0;
        for place in 0..kept.len() {
            // Another digit, a letter, and a byte that is no text.
            for other in [b'0' + (kept[place].wrapping_sub(b'0').wrapping_add(1)) % 10, b'e', 0xff] {
                let mut altered = kept.clone();
                altered[place] = other;
                // The last line without its end is a torn one.
                if altered == kept || place + 1 == kept.len() {
                    continue;
                }
                std::fs::write(&path, &altered).unwrap();
                let line = 1 + kept[..place].iter().filter(|byte| **byte == b'\n').count();
                let error = Journal::<f64>::open(Some(&result), &computation, true).unwrap_err().to_string();
                let line = if line == 1 { "line".to_owned() } else { format!("line {line}") };
                assert!(error.contains("a.json.journal") && error.contains("delete"), "{error}");
                assert!(error.contains(&line), "{place} {other}: no {line} in {error}");
                tried += 1;
            }
        }
        assert!(tried > 2 * kept.len(), "{tried}");
        // A part of the journal of another computation.
        let other = folder.path().join("b.json");
        let at_5 = json!({"command": "margin", "parameters": {"v": 5.0}});
        Journal::<f64>::open(Some(&other), &at_5, false).unwrap().keep(0, &0.5, &never);
        let foreign = std::fs::read_to_string(beside(&other)).unwrap();
        let mixed = [&kept[..], foreign.lines().nth(1).unwrap().as_bytes(), b"\n"].concat();
        std::fs::write(&path, mixed).unwrap();
        let error = Journal::<f64>::open(Some(&result), &computation, true).unwrap_err().to_string();
        assert!(error.contains("line 5 was changed"), "{error}");
    }
}
