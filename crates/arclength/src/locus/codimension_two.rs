//! Defining systems of points of codimension two, and what is known about such a point.
//!
//! All systems are square and regular at generic points. Cusp: Spence and Werner, *IMA J. Numer. Anal.* 2 (1982). The
//! others combine the systems of the curves that meet there.

use crate::algebraic::AlgebraicEquations;
use crate::branch::SpecialKind;
use crate::differentiation::Dual;
use crate::equilibrium::defining::{FoldSystem, HopfSystem, against, equilibrium, parts};
use crate::erased::NarrowScalar;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A point of codimension two on a curve of special equilibria.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CodimensionTwoPoint {
    /// What it is.
    pub kind: SpecialKind,
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Indices of the two parameters that vary.
    pub active: [usize; 2],
    /// Values of these.
    pub values: [f64; 2],
    /// Error estimates of these.
    pub location_error: [f64; 2],
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Its eigenvalues.
    pub eigenvalues: Vec<Complex64>,
    /// Coefficients of the normal form by name. Cusp: `c` of `w' = c w^3`; Bogdanov-Takens: `a` and `b` of
    /// `w0' = w1, w1' = a w0^2 + b w0 w1`; generalised Hopf: `second_lyapunov`, `Re(c2)/omega` with `<q, q> = 1`. Behind each stands its error, under its name with `_error`, where it could be measured.
    pub coefficients: Vec<(Cow<'static, str>, f64)>,
    /// Whether Newton's method on the defining system, or the secant method on the curve, located the point; if not, it is
    /// degenerate and was only bracketed.
    pub regular: bool,
}

/// Cusps: a fold with `f_x z + f_xx(v, v) = 0` for some `z`, `<normal, z> = 0`; unknowns `(x, v, z, parameters)`.
pub(super) struct CuspSystem<'a> {
    pub fold: FoldSystem<'a>,
}

impl AlgebraicEquations for CuspSystem<'_> {
    fn unknowns(&self) -> usize {
        3 * self.fold.equilibria.dimension + 2
    }

    fn equations(&self) -> usize {
        self.unknowns()
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let problem = &self.fold.equilibria;
        let n = problem.dimension;
        let ([state, null, second], values) = parts(unknown, [n, n, n]);
        let point = equilibrium(state, values);
        let (field, rest) = residual.split_at_mut(n);
        let (image, rest) = rest.split_at_mut(n);
        let (last, rest) = rest.split_at_mut(n);
        problem.derivative_along(&point, second, field, last);
        // The derivative of f_x v along v.
        let lifted: Vec<Dual<T, 1>> = point
            .iter()
            .enumerate()
            .map(|(index, &value)| Dual {
                value,
                derivatives: [null.get(index).copied().unwrap_or_else(T::zero)],
            })
            .collect();
        let direction: Vec<Dual<T, 1>> = null.iter().map(|&entry| Dual::constant(entry)).collect();
        let mut value = vec![Dual::constant(T::zero()); n];
        let mut slope = vec![Dual::constant(T::zero()); n];
        problem.derivative_along(&lifted, &direction, &mut value, &mut slope);
        for index in 0..n {
            image[index] = slope[index].value;
            last[index] += slope[index].derivatives[0];
        }
        rest[0] = against(&self.fold.normal, null) - 1.0;
        rest[1] = against(&self.fold.normal, second);
    }
}

/// Bogdanov-Takens points: a Hopf point with `kappa = 0`; unknowns `(x, v, w, parameters)`.
pub(super) struct BogdanovTakensSystem<'a> {
    pub hopf: HopfSystem<'a>,
}

impl AlgebraicEquations for BogdanovTakensSystem<'_> {
    fn unknowns(&self) -> usize {
        3 * self.hopf.equilibria.dimension + 2
    }

    fn equations(&self) -> usize {
        self.unknowns()
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.hopf.equilibria.dimension;
        let mut inner = unknown.to_vec();
        inner.insert(3 * n, T::zero());
        self.hopf.evaluate(&inner, residual);
    }
}

/// Zero-Hopf points: a Hopf point with `f_x z = 0`, `<null_normal, z> = 1`; unknowns `(x, v, w, kappa, z, parameters)`.
pub(super) struct ZeroHopfSystem<'a> {
    pub hopf: HopfSystem<'a>,
    pub null_normal: Vec<f64>,
}

impl AlgebraicEquations for ZeroHopfSystem<'_> {
    fn unknowns(&self) -> usize {
        4 * self.hopf.equilibria.dimension + 3
    }

    fn equations(&self) -> usize {
        self.unknowns()
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.hopf.equilibria.dimension;
        let ([first, null], values) = parts(unknown, [3 * n + 1, n]);
        let (own, rest) = residual.split_at_mut(3 * n + 2);
        self.hopf.evaluate(&[first, values].concat(), own);
        let (image, rest) = rest.split_at_mut(n);
        let point = equilibrium(&first[..n], values);
        self.hopf.equilibria.derivative_along(&point, null, &mut own[..n], image);
        rest[0] = against(&self.null_normal, null) - 1.0;
    }
}

/// Hopf-Hopf points: two Hopf points at once; unknowns `(x, v, w, kappa, v', w', kappa', parameters)`.
pub(super) struct HopfHopfSystem<'a> {
    pub pairs: [HopfSystem<'a>; 2],
}

impl AlgebraicEquations for HopfHopfSystem<'_> {
    fn unknowns(&self) -> usize {
        5 * self.pairs[0].equilibria.dimension + 4
    }

    fn equations(&self) -> usize {
        self.unknowns()
    }

    fn evaluate<T: NarrowScalar>(&self, unknown: &[T], residual: &mut [T]) {
        let n = self.pairs[0].equilibria.dimension;
        let ([state, one, other], values) = parts(unknown, [n, 2 * n + 1, 2 * n + 1]);
        let mut second = vec![T::zero(); 3 * n + 2];
        self.pairs[1].evaluate(&[state, other, values].concat(), &mut second);
        let (first, rest) = residual.split_at_mut(3 * n + 2);
        self.pairs[0].evaluate(&[state, one, values].concat(), first);
        rest.copy_from_slice(&second[n..]);
    }
}
