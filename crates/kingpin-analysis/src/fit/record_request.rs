//! A file of a record, with the parameters at which it was taken: `FILE.csv` or `FILE.csv:v=1.5,r=2`.

use arclength_analysis::Assignment;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// A file of a record, with the parameters that were others than those of the wheel when it was taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordRequest {
    /// The file.
    pub file: PathBuf,
    /// Parameters of this record alone, such as its speed.
    #[serde(default)]
    pub set: Vec<Assignment>,
}

impl FromStr for RecordRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (file, settings) = match text.rsplit_once(':') {
            Some((file, settings)) if settings.contains('=') && !settings.contains('/') => (file, settings),
            _ => (text, ""),
        };
        let assignments = settings.split(',').filter(|part| !part.is_empty());
        let set = assignments.map(str::parse).collect::<Result<_, <Assignment as FromStr>::Err>>();
        let set = set.map_err(|error| error.to_string())?;
        if file.is_empty() {
            return Err("there is no name of a file; allowed: FILE.csv or FILE.csv:v=1.5".to_owned());
        }
        Ok(Self { file: file.into(), set })
    }
}

impl fmt::Display for RecordRequest {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.file.display())?;
        for (index, Assignment { key, value }) in self.set.iter().enumerate() {
            write!(formatter, "{}{key}={value}", if index == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_settings_of_their_own() {
        for text in ["slow.csv", "slow.csv:v=0.5", "a/b:c.csv:v=0.5,r=inf", "C:/slow=1.csv"] {
            assert_eq!(text.parse::<RecordRequest>().unwrap().to_string(), text);
        }
        let request: RecordRequest = "a/b:c.csv:v=0.5,r=inf".parse().unwrap();
        assert_eq!((request.file, request.set.len()), (PathBuf::from("a/b:c.csv"), 2));
        assert!(":v=1".parse::<RecordRequest>().is_err());
    }
}
