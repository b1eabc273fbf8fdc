//! In which direction a function of the state passes zero.

/// Which crossings of zero count, in the direction of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
    /// Both.
    #[default]
    Either,
}

impl Direction {
    /// Whether a passage from a value of the sign `from` to one of the sign `to` is one of these.
    pub fn counts(self, from: f64, to: f64) -> bool {
        match self {
            Self::Rising => from < 0.0 && to > 0.0,
            Self::Falling => from > 0.0 && to < 0.0,
            Self::Either => from * to < 0.0,
        }
    }
}
