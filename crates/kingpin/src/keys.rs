//! Keys as they are given: read from text, with the nearest known key where there is none, and checked to vary
//! independently of each other.

use crate::error::KingpinError;
use crate::parameters::Key;
use std::str::FromStr;

impl Key {
    /// The key whose name is nearest to what was given: fewest edits when case and underscores are disregarded,
    /// then fewest edits with them.
    pub fn nearest(given: &str) -> Key {
        /// Characters that are looked at: no key has as many.
        const LOOKED_AT: usize = 40;
        let given = &given.chars().take(LOOKED_AT).collect::<String>();
        let plain = |text: &str| text.to_lowercase().replace('_', "");
        let distance =
            |key: &Key| (edit_distance(&plain(given), &plain(key.name())), edit_distance(given, key.name()));
        Self::ALL.into_iter().min_by_key(distance).unwrap_or(Key::V)
    }

    /// That no two of the keys set the same parameter.
    pub(crate) fn check_independent(keys: &[Key]) -> Result<(), KingpinError> {
        for (index, &second) in keys.iter().enumerate() {
            for &first in &keys[..index] {
                if first.sets().iter().any(|key| second.sets().contains(key)) {
                    return Err(KingpinError::DependentKeys { first, second });
                }
            }
        }
        Ok(())
    }
}

impl FromStr for Key {
    type Err = KingpinError;

    fn from_str(given: &str) -> Result<Self, KingpinError> {
        Self::ALL.into_iter().find(|key| key.name() == given).ok_or_else(|| KingpinError::UnknownKey {
            given: given.to_owned(),
            nearest: Self::nearest(given),
            position: None,
        })
    }
}

/// Levenshtein's distance (1966): the fewest insertions, deletions and replacements of characters.
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (line, from_character) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (column, &to_character) in to.iter().enumerate() {
            let replaced = diagonal + usize::from(from_character != to_character);
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_key_is_found() {
        for (given, nearest) in [
            ("kq", Key::KQ),
            ("J_xi", Key::JWxi),
            ("lc", Key::LC),
            ("Mus", Key::MuS),
            ("vv", Key::V),
            ("faz", Key::FAz),
        ] {
            assert_eq!(Key::nearest(given), nearest, "{given}");
        }
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
