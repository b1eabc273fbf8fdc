//! Special points that were found, and changes behind which none could be located.

use crate::continuation::solution::Solution;

/// A special point that was found between two solutions.
#[derive(Clone, Debug)]
pub struct Event<K, P> {
    /// What it is.
    pub kind: K,
    /// Whether it satisfies its defining system; otherwise it was bracketed.
    pub is_located: bool,
    /// The point.
    pub solution: Solution<P>,
}

/// A change of sign, or of the number of unstable directions, behind which no special point could be located.
#[derive(Clone, Debug, PartialEq)]
pub struct Unlocated<K> {
    /// The kind whose test function changed its sign; `None` where only the number of unstable directions changed.
    pub kind: Option<K>,
    /// Values of the bounded parameters between which it changed.
    pub between: [Vec<f64>; 2],
}
