//! What closed forms are written over: one number, or several side by side.

use std::ops::{Add, Div, Mul, Sub};

/// `f64`, the scalars of automatic differentiation, or [`Lanes`](arclength::lanes::Lanes).
pub(crate) trait Arithmetic:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
}

impl<T> Arithmetic for T where
    T: Copy + From<f64> + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Div<Output = T>
{
}
