//! One of so many shards.

use std::fmt;
use std::str::FromStr;

/// One of so many shards, `I/N`, counted from 1.
///
/// ```
/// use kingpin_analysis::sharded::Shard;
/// let shard: Shard = "3/10".parse()?;
/// assert_eq!((shard.number(), shard.of()), (3, 10));
/// assert!("0/10".parse::<Shard>().is_err());
/// # Ok::<(), kingpin_analysis::sharded::InvalidShard>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

/// A text that names no shard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must have the form I/N with I from 1 to N, such as 3/10, and N at most {most}", most = Shard::MOST)]
pub struct InvalidShard;

impl Shard {
    /// Most shards.
    pub const MOST: usize = 100_000;

    /// Which one, from 1.
    pub fn number(self) -> usize {
        self.number
    }

    /// How many there are.
    pub fn of(self) -> usize {
        self.of
    }
}

impl FromStr for Shard {
    type Err = InvalidShard;

    fn from_str(text: &str) -> Result<Self, InvalidShard> {
        let (number, of) = text.split_once('/').ok_or(InvalidShard)?;
        let whole = |text: &str| text.trim().parse::<usize>().map_err(|_| InvalidShard);
        let (number, of) = (whole(number)?, whole(of)?);
        let is_one = (1..=Self::MOST).contains(&of) && (1..=of).contains(&number);
        if is_one { Ok(Self { number, of }) } else { Err(InvalidShard) }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_name_no_shard_are_refused() {
        for text in ["", "3", "0/3", "4/3", "-1/3", "1/0", "1/3/5", "a/b", "1/100001", "1.0/2"] {
            assert_eq!(text.parse::<Shard>(), Err(InvalidShard), "{text}");
        }
        assert_eq!("2/3".parse::<Shard>().unwrap().to_string(), "2/3");
    }
}
