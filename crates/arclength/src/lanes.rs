//! Several numbers at once, so that the compiler makes vector instructions of plain arithmetic.
//!
//! [`Lanes`] are operated on lane by lane; no operation crosses lanes, so a number does not depend on its neighbours. What
//! is to be run with the vector instructions of the processor at hand is a [`Kernel`]: [`run`] compiles it with and without
//! them and is the only place that asks what the processor has.
//!
//! ```
//! use arclength::lanes::{Kernel, Lanes, run};
//!
//! /// Adds multiples of some numbers to others.
//! struct AddMultiples<'a>(&'a mut [f64], &'a [f64], f64);
//!
//! impl Kernel for AddMultiples<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<const FUSED: bool>(self) {
//!         let (sums, _) = self.0.as_chunks_mut::<4>();
//!         let (terms, _) = self.1.as_chunks::<4>();
//!         for (sum, term) in sums.iter_mut().zip(terms) {
//!             *sum = Lanes(*sum).plus::<FUSED>(Lanes(*term), Lanes::from(self.2)).0;
//!         }
//!     }
//! }
//!
//! let mut sums = [1.0; 8];
//! run(AddMultiples(&mut sums, &[10.0; 8], 2.0));
//! assert_eq!(sums, [21.0; 8]);
//! ```

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `N` numbers side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    /// Zero in every lane.
    pub const ZERO: Self = Self([0.0; N]);
    /// One in every lane.
    pub const ONE: Self = Self([1.0; N]);

    /// Applies a function to every lane.
    #[inline(always)]
    pub fn map(self, function: impl Fn(f64) -> f64) -> Self {
        Self(from_fn(|lane| function(self.0[lane])))
    }

    /// Joins two numbers lane by lane.
    #[inline(always)]
    pub fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        Self(from_fn(|lane| operation(self.0[lane], other.0[lane])))
    }

    /// The smaller number of every lane; `other` where they cannot be compared.
    #[inline(always)]
    pub fn smaller(self, other: Self) -> Self {
        self.zip(other, |one, other| if one < other { one } else { other })
    }

    /// `self + a b`, rounded once if `FUSED`, which is only for processors that can.
    #[inline(always)]
    pub fn plus<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        Self(from_fn(|lane| {
            if FUSED {
                a.0[lane].mul_add(b.0[lane], self.0[lane])
            } else {
                self.0[lane] + a.0[lane] * b.0[lane]
            }
        }))
    }

    /// `self - a b`, as [`plus`](Self::plus).
    #[inline(always)]
    pub fn minus<const FUSED: bool>(self, a: Self, b: Self) -> Self {
        self.plus::<FUSED>(-a, b)
    }
}

impl<const N: usize> Default for Lanes<N> {
    #[inline(always)]
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const N: usize> From<f64> for Lanes<N> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self([value; N])
    }
}

impl<const N: usize> From<[f64; N]> for Lanes<N> {
    #[inline(always)]
    fn from(numbers: [f64; N]) -> Self {
        Self(numbers)
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $method:ident $symbol:tt),*) => {$(
        impl<const N: usize> $operator for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |one, other| one $symbol other)
            }
        }
    )*};
}

lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|number| -number)
    }
}

/// A computation that is compiled with and without vector instructions.
pub trait Kernel {
    /// What it gives.
    type Output;

    /// Computes. To be marked `#[inline(always)]`: what is not inlined has no vector instructions. `FUSED` says that the
    /// processor rounds `a b + c` once, see [`Lanes::plus`].
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs a kernel with vectors of four numbers and fused operations where the processor has them.
///
/// Vectors of eight were tried: systems of equations are solved 14 % slower with them, charts as fast.
#[inline(always)]
pub fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        // SAFETY: the processor has these instructions.
        return unsafe { vectorized(kernel) };
    }
    kernel.run::<false>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn vectorized<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<true>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_do_not_mix() {
        let (a, b) = (Lanes([1.0, -2.0, 3.0]), Lanes([4.0, 0.5, -3.0]));
        assert_eq!(((a + b) * a - b / b).0, [4.0, 2.0, -1.0]);
        assert_eq!(a.smaller(b).0, [1.0, -2.0, -3.0]);
        assert_eq!(a.plus::<true>(a, b), a + a * b);
        assert_eq!(a.minus::<false>(a, b), a - a * b);
    }

    /// Divides numbers by their index plus one, four at a time and the rest one by one, in place.
    struct DividedByPlace<'a>(&'a mut Vec<f64>);

    impl Kernel for DividedByPlace<'_> {
        type Output = usize;
        #[inline(always)]
        fn run<const FUSED: bool>(self) -> usize {
            let (vectors, rest) = self.0.as_chunks_mut::<4>();
            for (index, numbers) in vectors.iter_mut().enumerate() {
                let first = (4 * index) as f64;
                *numbers = (Lanes(*numbers) / Lanes([1.0, 2.0, 3.0, 4.0].map(|place| first + place))).0;
            }
            let done = 4 * vectors.len();
            rest.iter_mut().enumerate().for_each(|(index, number)| *number /= (done + index + 1) as f64);
            done + rest.len()
        }
    }

    #[test]
    fn a_kernel_writes_through_what_it_borrows() {
        for count in [0, 3, 4, 11] {
            let mut numbers: Vec<f64> = (1..=count).map(|index| 2.0 * f64::from(index)).collect();
            assert_eq!(run(DividedByPlace(&mut numbers)), numbers.len());
            assert!(numbers.iter().all(|number| *number == 2.0), "{numbers:?}");
        }
    }

    /// The error of a product, which only a fused operation shows.
    struct RoundingError(f64);

    impl Kernel for RoundingError {
        type Output = Option<f64>;
        #[inline(always)]
        fn run<const FUSED: bool>(self) -> Option<f64> {
            let factor = Lanes([self.0; 4]);
            FUSED.then(|| (-(factor * factor)).plus::<true>(factor, factor).0[3])
        }
    }

    #[test]
    fn fused_kernels_round_once() {
        if let Some(error) = run(RoundingError(1.0 + f64::EPSILON)) {
            assert_eq!(error, f64::EPSILON * f64::EPSILON);
        }
    }
}
