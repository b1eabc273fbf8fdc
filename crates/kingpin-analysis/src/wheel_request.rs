//! Which wheel an analysis is asked for: a part of every request.

use crate::error::Error;
use arclength_analysis::Assignment;
use kingpin::{Key, KingpinError, Wheel};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Which wheel: that of a file, or the paper's, with the parameters that are set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WheelRequest {
    /// File of `key = value` lines; the paper's wheel where there is none.
    pub wheel: Option<PathBuf>,
    /// Parameters that are set; they win over the file.
    pub set: Vec<Assignment>,
}

impl WheelRequest {
    /// The wheel of the file, or the paper's, with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with the file or a parameter.
    pub fn read(&self) -> Result<Wheel, Error> {
        let wheel = self.wheel.as_ref().map_or(Ok(Wheel::default()), Wheel::read)?;
        self.change(wheel).map_err(|error| match (error, &self.wheel) {
            // Keys that disagree are the file's where nothing else was set.
            (Error::Wheel(source), Some(path)) if self.set.is_empty() => {
                Error::Wheel(KingpinError::InFile { path: path.clone(), source: Box::new(source) })
            }
            (error, _) => error,
        })
    }

    /// The options of a command that ask for the same wheel, with a space behind each. What a later setting replaces is left out.
    pub(crate) fn options(&self) -> String {
        let file = self.wheel.iter().map(|path| format!("--wheel {} ", quoted(&path.display().to_string())));
        let stored = |setting: &Assignment| setting.key.parse::<Key>().map(Key::sets).unwrap_or_default();
        let is_replaced = |index: usize| {
            let (own, later) = (stored(&self.set[index]), &self.set[index + 1..]);
            let replaces = |setting: &Assignment| own.iter().all(|key| stored(setting).contains(key));
            !own.is_empty() && later.iter().any(replaces)
        };
        let set = self
            .set
            .iter()
            .enumerate()
            .filter(|(index, _)| !is_replaced(*index))
            .map(|(_, Assignment { key, value })| format!("-s {} ", quoted(&format!("{key}={value}"))));
        file.chain(set).collect()
    }

    /// A wheel with the parameters that are set.
    ///
    /// # Errors
    /// What is wrong with a parameter.
    pub fn change(&self, mut wheel: Wheel) -> Result<Wheel, Error> {
        for Assignment { key, value } in &self.set {
            wheel.set(key, value).map_err(|source| Error::Set {
                field: "set",
                given: format!("{key}={value}"),
                source: Box::new(source),
            })?;
        }
        wheel.check()?;
        Ok(wheel)
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "_-+=./,:%@\\".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_options_ask_for_the_same_wheel() {
        let set = |key: &str, value: &str| Assignment { key: key.into(), value: value.into() };
        let request = WheelRequest {
            wheel: Some(PathBuf::from("my wheels/it's.toml")),
            set: vec![set("v", "4"), set("r", "inf")],
        };
        assert_eq!(request.options(), "--wheel 'my wheels/it'\\''s.toml' -s v=4 -s r=inf ");
        assert_eq!(WheelRequest::default().options(), "");
    }

    #[test]
    fn settings_that_later_ones_replace_are_left_out() {
        let set = |key: &str, value: &str| Assignment { key: key.into(), value: value.into() };
        let all = [("v", "1.5"), ("k_q", "80"), ("M_f", "0.05"), ("k", "90"), ("v", "1"), ("k_u", "70")];
        let request =
            WheelRequest { wheel: None, set: all.into_iter().map(|(key, value)| set(key, value)).collect() };
        // What sets two stays where only one of them is set again.
        assert_eq!(request.options(), "-s M_f=0.05 -s k=90 -s v=1 -s k_u=70 ");
        let radius = WheelRequest { wheel: None, set: vec![set("r", "2"), set("r", "inf")] };
        assert_eq!(radius.options(), "-s r=inf ");
    }
}
