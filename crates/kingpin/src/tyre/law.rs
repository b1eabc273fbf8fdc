//! The lateral force of the ground on the tyre and its moment about the vertical, as functions of the slip `s = y_t/sigma`.
//!
//! ```text
//! linear  F = C_alpha s,                        M = -t_p C_alpha s
//! brush   F = C_alpha s (1 - z + z^2/3),        M = -t_p C_alpha s (1 - z)^3      where z = theta |s| < 1
//!         F = mu_s N sign(s),                   M = 0                             beyond
//! ```
//!
//! with `theta = C_alpha/(3 mu_s N)`. The brush law has a continuous slope everywhere; its curvature jumps at `s = 0`. Its pieces are
//! told apart by two switch functions, the slip and `1 - z`.

use arclength::Scalar;
use std::ops::Mul;

/// In which piece of the brush law the slip is: its sign, and whether any of the bristles hold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<T> {
    pub sign: T,
    pub holds: bool,
}

/// What the laws need of the parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness<C> {
    /// `C_alpha` in N/rad.
    pub cornering: C,
    /// `t_p` in m.
    pub trail: C,
    /// `theta`.
    pub slip_ratio: C,
}

/// Force in N and moment in N m of the linear law.
#[inline(always)]
pub(super) fn linear<T, C>(tyre: &Stiffness<C>, slip: T) -> [T; 2]
where
    T: Scalar + Mul<C, Output = T>,
    C: Copy,
{
    let force = slip * tyre.cornering;
    [force, -(force * tyre.trail)]
}

/// Force in N and moment in N m of the brush law, and the part `1 - z` of the bristles that hold.
#[inline(always)]
pub(super) fn brush<T, C>(tyre: &Stiffness<C>, slip: T, piece: Option<Piece<T>>) -> ([T; 2], T)
where
    T: Scalar + Mul<C, Output = T>,
    C: Copy,
{
    let size = match piece {
        Some(piece) => slip * piece.sign,
        None => slip.abs(),
    };
    let used = size * tyre.slip_ratio;
    let held = T::one() - used;
    let holds = piece.map_or(held.value() >= 0.0, |piece| piece.holds);
    if holds {
        let force = slip * tyre.cornering * (held + used * used / 3.0);
        let moment = -(slip * tyre.cornering * tyre.trail * held * held * held);
        return ([force, moment], held);
    }
    let sign = piece.map_or(slip.signum(), |piece| piece.sign);
    // mu_s N = C_alpha/(3 theta)
    let limit = T::one() * tyre.cornering / (T::from(3.0) * tyre.slip_ratio);
    ([sign * limit, T::zero()], held)
}
