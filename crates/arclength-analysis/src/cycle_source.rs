//! What a branch of cycles starts from, as it is written in an option.

use crate::point_reference::PointReference;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What a branch of cycles starts from.
///
/// ```
/// use arclength_analysis::CycleSource;
/// assert!(matches!("runs/cycles.json:LPC1".parse()?, CycleSource::Point(_)));
/// assert!(matches!("runs/orbit.csv".parse()?, CycleSource::Samples { .. }));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum CycleSource {
    /// A labelled point of an earlier result.
    Point(PointReference),
    /// An orbit over one period, stable or not.
    Samples {
        /// A file of comma-separated values: a line of names, among them `t` and those of all states, and a line for every sample,
        /// of which the last repeats the first one period later.
        samples: PathBuf,
    },
}

impl From<PointReference> for CycleSource {
    fn from(reference: PointReference) -> Self {
        Self::Point(reference)
    }
}

impl FromStr for CycleSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = Path::new(text);
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
            return Ok(Self::Samples { samples: path.to_owned() });
        }
        let reference = text.parse().map(Self::Point);
        reference.map_err(|problem: String| format!("{problem}, or be a file of samples, FILE.csv"))
    }
}
