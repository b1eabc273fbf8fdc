//! Entries of several matrices of one size side by side, real or complex, one in each lane of the processor's vectors.

use std::ops::{Add, Mul};

/// Matrices that are factorised together.
pub(crate) const LANES: usize = 4;
/// One number for each matrix.
pub(crate) type Lanes = crate::lanes::Lanes<LANES>;

/// An entry of the matrices: a real or a complex number for each.
pub(crate) trait Entry: Copy + From<Lanes> + Add<Output = Self> + Mul<Output = Self> {
    /// Zero in every lane.
    const ZERO: Self;

    /// `self - a b`, see [`Lanes::plus`].
    fn minus<const FUSED: bool>(self, a: Self, b: Self) -> Self;

    /// Sizes by which pivots are chosen.
    fn sizes(self) -> Lanes;

    /// `1 / self`.
    fn reciprocal(self) -> Self;

    /// The number in one lane becomes that of another entry.
    fn set_lane(&mut self, lane: usize, other: Self);
}

impl Entry for Lanes {
    const ZERO: Self = Self::ZERO;

    #[inline(always)]
    fn minus<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        self.plus::<FUSED>(-a, b)
    }

    #[inline(always)]
    fn sizes(self) -> Lanes {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.map(|entry| 1.0 / entry)
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, other: Self) {
        self.0[lane] = other.0[lane];
    }
}

/// One complex number for each matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ComplexLanes {
    pub re: Lanes,
    pub im: Lanes,
}

impl From<Lanes> for ComplexLanes {
    #[inline(always)]
    fn from(re: Lanes) -> Self {
        Self { re, im: Lanes::ZERO }
    }
}

impl Add for ComplexLanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Mul for ComplexLanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Entry for ComplexLanes {
    const ZERO: Self = Self { re: Lanes::ZERO, im: Lanes::ZERO };

    #[inline(always)]
    fn minus<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        Self {
            re: self.re.minus::<FUSED>(a.re, b.re).plus::<FUSED>(a.im, b.im),
            im: self.im.minus::<FUSED>(a.re, b.im).minus::<FUSED>(a.im, b.re),
        }
    }

    #[inline(always)]
    fn sizes(self) -> Lanes {
        self.re.map(f64::abs) + self.im.map(f64::abs)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let square = self.re * self.re + self.im * self.im;
        Self { re: self.re / square, im: -self.im / square }
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, other: Self) {
        self.re.0[lane] = other.re.0[lane];
        self.im.0[lane] = other.im.0[lane];
    }
}
