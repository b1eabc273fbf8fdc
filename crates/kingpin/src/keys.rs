//! Keys as they are given: read from text, with the nearest known key where there is none, and checked to vary
//! independently of each other.

use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use std::str::FromStr;

/// Words that the meanings of the parameters do not have, each with one that they have.
const OTHER_WORDS: [(&str, &str); 13] = [
    ("arm", "caster length"),
    ("damper", "damping"),
    ("dry", "dry"),
    ("load", "vertical force"),
    ("moi", "inertia"),
    ("offset", "caster length"),
    ("spring", "stiffness"),
    ("stiff", "stiffness"),
    ("tire", "tyre"),
    ("torque", "moment"),
    ("trail", "caster length"),
    ("velocity", "speed"),
    ("weight", "vertical force"),
];

/// Most keys that are named where one is not known.
const SUGGESTED: usize = 4;

impl Key {
    /// The keys that may be meant by what was given, the likeliest first, at most four; none where none is near.
    ///
    /// That is the key whose name is nearest: fewest edits when case and underscores are disregarded, then fewest edits with them. Where
    /// that is another name altogether, it is those whose meaning has most of the words given.
    pub fn suggestions(given: &str) -> Vec<Key> {
        /// Characters that are looked at: no key has as many.
        const LOOKED_AT: usize = 40;
        let given = &given.chars().take(LOOKED_AT).collect::<String>();
        let plain = |text: &str| text.to_lowercase().replace('_', "");
        let distance =
            |key: &Key| (edit_distance(&plain(given), &plain(key.name())), edit_distance(given, key.name()));
        let nearest = Self::ALL.into_iter().min_by_key(distance).unwrap_or(Key::V);
        let shorter = plain(given).chars().count().min(plain(nearest.name()).len() + 1);
        let is_near = 2 * distance(&nearest).0 <= shorter;
        if is_near && !Self::ALL.into_iter().any(|key| key.words_of_meaning().any(|word| word == given)) {
            return vec![nearest];
        }
        Self::by_meaning(given)
    }

    /// The words of the meaning of the key, without what is said of special values.
    fn words_of_meaning(self) -> impl Iterator<Item = &'static str> {
        self.meaning()
            .split(';')
            .take(1)
            .flat_map(|part| part.split(|letter: char| !letter.is_alphanumeric()))
    }

    /// The keys whose meaning has the most of some words; first those in which the words stand first.
    fn by_meaning(given: &str) -> Vec<Key> {
        let mut separated = String::new();
        for letter in given.chars() {
            let begins_word = letter.is_uppercase() && separated.ends_with(char::is_lowercase);
            separated.extend(begins_word.then_some('_').into_iter().chain([letter]));
        }
        let separated = separated.to_lowercase();
        let words: Vec<&str> = separated.split(|letter: char| !letter.is_alphanumeric()).collect();
        let mut found: Vec<(usize, usize, Key)> = Self::ALL
            .into_iter()
            .map(|key| {
                let places: Vec<usize> = words.iter().filter_map(|word| key.place_in_meaning(word)).collect();
                (places.len(), places.into_iter().min().unwrap_or(0), key)
            })
            .collect();
        let most = found.iter().map(|(count, ..)| *count).max().unwrap_or(0);
        found.retain(|(count, ..)| *count == most && most > 0);
        found.sort_by_key(|(_, place, _)| *place);
        found.into_iter().map(|(.., key)| key).take(SUGGESTED).collect()
    }

    /// Where in the meaning of the key a word stands, or one of the same meaning, counted in words.
    fn place_in_meaning(self, given: &str) -> Option<usize> {
        /// Shorter words stand everywhere.
        const SHORTEST: usize = 4;
        let has = |given: &str, exactly: bool| {
            let mut words = self.words_of_meaning();
            words.position(|word| if exactly { word == given } else { word.starts_with(given) })
        };
        let itself = if given.len() < SHORTEST { None } else { has(given, false) };
        itself.or_else(|| {
            let (_, other) = OTHER_WORDS.into_iter().find(|(word, _)| given.starts_with(word))?;
            let places: Option<Vec<usize>> = other.split(' ').map(|word| has(word, true)).collect();
            places?.into_iter().min()
        })
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
            suggestions: Self::suggestions(given),
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
            assert_eq!(Key::suggestions(given), [nearest], "{given}");
        }
        for (given, meant) in [
            ("stiffness", vec![Key::K, Key::KU, Key::KQ, Key::KPsi]),
            ("lateral_stiffness", vec![Key::KQ]),
            ("spring", vec![Key::K, Key::KU, Key::KQ, Key::KPsi]),
            ("caster_length", vec![Key::L]),
            ("casterLength", vec![Key::L]),
            ("speed", vec![Key::V]),
            ("towing_speed", vec![Key::V]),
            ("velocity", vec![Key::V]),
            ("damping", vec![Key::CU, Key::CQ, Key::CPsi]),
            ("damper", vec![Key::CU, Key::CQ, Key::CPsi]),
            ("rotational_damper", vec![Key::CPsi]),
            ("trail", vec![Key::L, Key::TP]),
            ("pneumatic_trail", vec![Key::TP]),
            ("radius", vec![Key::WheelRadius, Key::TurningRadius]),
            ("wheel radius", vec![Key::WheelRadius]),
            ("turning_radius", vec![Key::TurningRadius]),
            ("friction", vec![Key::MuS, Key::MuD, Key::MF]),
            ("dry_friction", vec![Key::MF]),
            ("static_friction", vec![Key::MuS]),
            ("mass", vec![Key::MW, Key::MC]),
            ("mass_of_the_caster", vec![Key::MC]),
            ("inertia", vec![Key::JWxi, Key::JWzeta, Key::JCz]),
            ("load", vec![Key::FAz]),
            ("vertical_load", vec![Key::FAz]),
            ("gravity", vec![Key::G, Key::JCz]),
            ("relaxation", vec![Key::Sigma]),
            ("cornering_stiffness", vec![Key::CAlpha]),
        ] {
            assert_eq!(Key::suggestions(given), meant, "{given}");
        }
        for given in ["foo", "w", "x", "temperature"] {
            assert_eq!(Key::suggestions(given), [], "{given}");
        }
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }
}
