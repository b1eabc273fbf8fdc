//! Where the parameters of a wheel come from: which file, what it leaves out, and what was set since.
//!
//! A result is told with the name of the file and what was changed; what a file leaves out must not become the paper's in silence.

use crate::parameters::Key;
use arrayvec::ArrayString;

/// Bytes of the name of a file that are kept.
const NAME: usize = 48;

/// A set of keys.
#[derive(Clone, Copy, Debug, Default)]
struct KeySet(u32);

impl KeySet {
    fn contains(self, key: Key) -> bool {
        self.0 & (1 << key as u32) != 0
    }

    fn insert(&mut self, key: Key) {
        self.0 |= 1 << key as u32;
    }
}

/// Where the parameters of a wheel come from.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Origin {
    /// Name of the file, the beginning of it if it is long.
    file: Option<ArrayString<NAME>>,
    /// Stored keys that were set, by themselves or by a key that stands for them.
    set: KeySet,
    /// Keys that were set by themselves in the same place: the file, or after it.
    given: KeySet,
    /// Stored keys whose value was changed since the file was read.
    changed: KeySet,
    /// Whether `k` and a stiffness that it sets were given in the same place.
    stiffness_given_twice: bool,
    /// Whether the radius and its curvature were given in the same place.
    radius_given_twice: bool,
}

impl Origin {
    /// Takes note of a key that is set, and of the stored keys whose values that changes.
    pub(crate) fn note(&mut self, key: Key, changes: impl Fn(Key) -> bool) {
        self.given.insert(key);
        for &stored in key.sets() {
            self.set.insert(stored);
            if changes(stored) {
                self.changed.insert(stored);
            }
        }
        let one = self.given.contains(Key::KU) || self.given.contains(Key::KQ);
        self.stiffness_given_twice |= self.given.contains(Key::K) && one;
        self.radius_given_twice |=
            self.given.contains(Key::TurningRadius) && self.given.contains(Key::Curvature);
    }

    /// The same, where what was noted since another one was varied and not given.
    pub(crate) fn varied_from(self, before: Self) -> Self {
        let Self { given, stiffness_given_twice, radius_given_twice, .. } = before;
        Self { given, stiffness_given_twice, radius_given_twice, ..self }
    }

    /// That all so far is from a file.
    pub(crate) fn is_file(&mut self, name: &str) {
        let mut file = ArrayString::new();
        // A longer name is cut.
        let _ = name.chars().try_for_each(|character| file.try_push(character));
        self.file = Some(file);
        self.given = KeySet::default();
        self.changed = KeySet::default();
    }

    /// The name of the file.
    pub(crate) fn file_name(&self) -> Option<&str> {
        self.file.as_ref().map(ArrayString::as_str)
    }

    /// Whether a stored key was set.
    pub(crate) fn is_set(&self, key: Key) -> bool {
        self.set.contains(key)
    }

    /// Whether the value of a stored key was changed since the file was read.
    pub(crate) fn is_changed(&self, key: Key) -> bool {
        self.changed.contains(key)
    }

    /// Whether the radius and its curvature were given in the same place.
    pub(crate) fn radius_is_given_twice(&self) -> bool {
        self.radius_given_twice
    }

    /// Whether `k` and a stiffness that it sets were given in the same place.
    pub(crate) fn stiffness_is_given_twice(&self) -> bool {
        self.stiffness_given_twice
    }
}
