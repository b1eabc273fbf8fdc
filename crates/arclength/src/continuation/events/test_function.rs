//! Test functions as values: what lies where one changes its sign, and what that says about everything else.

use crate::continuation::Solution;

/// A test function of a curve.
#[derive(Clone, Copy, Debug)]
pub struct TestFunction<K: 'static> {
    /// The kind of special point at which it changes its sign.
    pub kind: K,
    /// By how much the number of unstable directions may change at such a point; empty where that says nothing.
    pub changes: &'static [usize],
    /// Kinds whose test functions vanish at such a point without a point of their own, or at which two in one place are one.
    pub absorbs: &'static [K],
    /// Whether its sign is a function of the growth exponents, which are followed one by one.
    pub of_spectrum: bool,
    /// Whether it is the rate of change of the parameter along the curve.
    pub is_turn: bool,
    /// Whether it is the orientation of the curve, which changes at every simple branch point and nowhere else.
    pub is_orientation: bool,
    /// Whether it is undefined on some stretches, at whose ends it may have any value.
    pub is_partial: bool,
}

impl<K: Copy> TestFunction<K> {
    /// A test function of which nothing but its sign is known.
    pub const fn new(kind: K) -> Self {
        Self {
            kind,
            changes: &[],
            absorbs: &[],
            of_spectrum: false,
            is_turn: false,
            is_orientation: false,
            is_partial: false,
        }
    }

    /// The same with the changes of the number of unstable directions that its points allow.
    pub const fn changing(self, changes: &'static [usize]) -> Self {
        Self { changes, ..self }
    }

    /// The same for points at which the test functions of other kinds vanish too.
    pub const fn absorbing(self, absorbs: &'static [K]) -> Self {
        Self { absorbs, ..self }
    }

    /// The same for a function of the growth exponents.
    pub const fn of_spectrum(self) -> Self {
        Self { of_spectrum: true, ..self }
    }

    /// The same for the orientation of the curve.
    pub const fn orienting(self) -> Self {
        Self { is_orientation: true, ..self }
    }

    /// The same for a function that is not defined everywhere: a step in which it begins or ceases to be is divided, lest a zero next to
    /// that place be lost.
    pub const fn partial(self) -> Self {
        Self { is_partial: true, ..self }
    }

    /// The same for the rate of change of the first bounded parameter.
    pub const fn turning(self) -> Self {
        Self { is_turn: true, ..self }
    }
}

/// The value of a test function at a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The value.
    pub value: f64,
    /// Values below this may be rounding.
    pub noise: f64,
    /// Signs are compared between solutions of the same class only, for instance with the same number of pairs of eigenvalues
    /// that stay on the axis.
    pub class: usize,
    /// Whether what the value is made of is resolved; a change of sign of one that is not is only noted.
    pub resolved: bool,
}

impl Reading {
    /// A value that is known to rounding.
    pub fn exact(value: f64) -> Self {
        Self { value, noise: 0.0, class: 0, resolved: true }
    }

    /// The same with a size below which values may be rounding.
    pub fn with_noise(self, noise: f64) -> Self {
        Self { noise, ..self }
    }

    /// The same in a class of its own.
    pub fn in_class(self, class: usize) -> Self {
        Self { class, ..self }
    }

    /// Whether the sign changes from one solution to the next.
    pub(super) fn changes_to(self, other: Self) -> bool {
        (self.value > 0.0) != (other.value > 0.0)
            && self.class == other.class
            && self.is_decided()
            && other.is_decided()
    }

    /// Whether the sign is more than rounding.
    pub(super) fn is_decided(self) -> bool {
        self.value.abs() > self.noise
    }
}

/// What became of the search for a special point of one kind between two solutions.
#[derive(Debug)]
pub enum Location<P> {
    /// A point that satisfies its defining system.
    At(Solution<P>),
    /// A point that was bracketed and whose defining system is not regular.
    Bracketed(Solution<P>),
    /// The change of sign belongs to no point of the kind: the test function has a pole, or vanishes at something else.
    Nothing,
    /// No point was located.
    Missed,
}
