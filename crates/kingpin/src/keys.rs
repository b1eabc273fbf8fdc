//! Keys as they are given: read from text, with the nearest known key where there is none, and checked to vary
//! independently of each other.

use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use std::str::FromStr;

impl Key {
    /// The key whose name is nearest to what was given: fewest edits when case and underscores are disregarded,
    /// then fewest edits with them. Where that is another name altogether, the key whose meaning begins with the words given, or has
    /// them.
    pub fn nearest(given: &str) -> Key {
        /// Characters that are looked at: no key has as many.
        const LOOKED_AT: usize = 40;
        let given = &given.chars().take(LOOKED_AT).collect::<String>();
        let plain = |text: &str| text.to_lowercase().replace('_', "");
        let distance =
            |key: &Key| (edit_distance(&plain(given), &plain(key.name())), edit_distance(given, key.name()));
        let nearest = Self::ALL.into_iter().min_by_key(distance).unwrap_or(Key::V);
        if 2 * distance(&nearest).0 <= plain(given).chars().count() {
            return nearest;
        }
        let by_meaning = Self::ALL.into_iter().filter_map(|key| Some((key.place_in_meaning(given)?, key)));
        by_meaning.min_by_key(|(place, _)| *place).map_or(nearest, |(_, key)| key)
    }

    /// Where in the meaning of the key the first of some words stands, if all of them do.
    fn place_in_meaning(self, given: &str) -> Option<usize> {
        /// Words as short as these stand everywhere.
        const SHORT: usize = 3;
        let given = given.to_lowercase();
        let words = given.split(|letter: char| !letter.is_alphanumeric()).filter(|word| word.len() > SHORT);
        let places: Option<Vec<usize>> = words.map(|word| self.meaning().find(word)).collect();
        places?.into_iter().min()
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
        if given == Tyre::KEY {
            return Err(KingpinError::TyreVaries);
        }
        Self::ALL.into_iter().find(|key| key.name() == given).ok_or_else(|| KingpinError::UnknownKey {
            given: given.to_owned(),
            nearest: Self::nearest(given),
            position: None,
        })
    }
}

impl FromStr for Tyre {
    type Err = KingpinError;

    fn from_str(given: &str) -> Result<Self, KingpinError> {
        Self::ALL
            .into_iter()
            .find(|tyre| tyre.name() == given)
            .ok_or_else(|| KingpinError::UnknownTyre { given: given.to_owned(), position: None })
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
        for (given, meant) in [
            ("stiffness", Key::K),
            ("lateral_stiffness", Key::KQ),
            ("caster_length", Key::L),
            ("towing_speed", Key::V),
            ("wheel radius", Key::WheelRadius),
            ("mass_of_the_caster", Key::MC),
            ("gravity", Key::G),
        ] {
            assert_eq!(Key::nearest(given), meant, "{given}");
        }
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
