//! The branching equation at a branch point of equilibria: second-order terms along the null vector and across it.

use super::bordered_jacobian::BorderedJacobian;
use super::fold::{NullVectors, null_vectors};
use super::multilinear::MultilinearForms;
use super::problem::EquilibriumProblem;
use crate::algebraic::{Differentiator, length};
use crate::branch::Criticality;
use crate::error::Error;

/// A coefficient smaller than this, relative to the others, is zero at a pitchfork.
const PITCHFORK: f64 = 1e-6;
/// Part of its range by which the parameter changes along the other branch of a pitchfork below which it is rounding.
const VERTICAL: f64 = 1e-10;

/// The equation `quadratic alpha^2 + 2 mixed alpha beta + parametric beta^2 = 0` of the directions `alpha (q, 0) + beta (x1, 1)`.
pub(super) struct BranchingEquation<'a> {
    forms: MultilinearForms<'a>,
    bordered: BorderedJacobian,
    /// `p`.
    left: Vec<f64>,
    /// Whether `<p, q> = 1`: zero is a simple eigenvalue.
    pub is_simple: bool,
    /// `q`.
    pub null_vector: Vec<f64>,
    /// `(x1, 1)`, with an entry for every parameter.
    across: Vec<f64>,
    /// `B(q, q)`.
    square: Vec<f64>,
    pub quadratic: f64,
    pub mixed: f64,
    pub parametric: f64,
}

impl<'a> BranchingEquation<'a> {
    /// At the singular equilibrium `unknown`, at which the forms are; `None` where more than one direction is lost.
    pub(super) fn at(
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        forms: MultilinearForms<'a>,
        scales: &[f64],
    ) -> Result<Option<Self>, Error> {
        let n = problem.dimension;
        let NullVectors { right: null_vector, left, is_simple } = null_vectors(problem, unknown, scales)?;
        let mut jacobian = vec![0.0; n * (n + 1)];
        let mut residual = vec![0.0; n];
        Differentiator::default().jacobian(problem, unknown, &mut residual, &mut jacobian, n);
        let normal: Vec<f64> =
            null_vector.iter().zip(scales).map(|(entry, scale)| entry / (scale * scale)).collect();
        let Some(bordered) = BorderedJacobian::of(&jacobian[..n * n], &normal, &left, &scales[..n]) else {
            return Ok(None);
        };
        let slope: Vec<f64> = jacobian[n * n..].iter().map(|entry| -entry).collect();
        let mut across = bordered.solve(&slope);
        across.resize(n + forms.parameters.len(), 0.0);
        across[n + problem.active[0]] = 1.0;
        let project = |image: &[f64]| project(&left, image);
        let square = forms.real(&[&null_vector, &null_vector]);
        let quadratic = project(&square);
        let mixed = project(&forms.real(&[&null_vector, &across]));
        let parametric = project(&forms.real(&[&across, &across]));
        Ok(Some(Self {
            forms,
            bordered,
            left,
            is_simple,
            null_vector,
            across,
            square,
            quadratic,
            mixed,
            parametric,
        }))
    }

    /// The coefficient `<p, C(q, q, q) - 3 B(q, A^-1 B(q, q))>/6` of the flow on the centre manifold.
    pub(super) fn cubic(&self) -> f64 {
        let q = &self.null_vector;
        let correction = self.bordered.solve(&self.square.iter().map(|entry| -entry).collect::<Vec<_>>());
        let cubes = self.forms.real(&[q, q, q]);
        let mixed = self.forms.real(&[q, &correction]);
        (project(&self.left, &cubes) + 3.0 * project(&self.left, &mixed)) / 6.0
    }

    /// The equation in the sizes of states and parameter.
    pub(super) fn scaled(&self, scales: &[f64]) -> ScaledEquation {
        let n = self.null_vector.len();
        let null_size = length(&self.null_vector, &scales[..n]);
        let range = scales[n];
        ScaledEquation {
            quadratic: self.quadratic / (null_size * null_size),
            mixed: self.mixed * range / null_size,
            parametric: self.parametric * range * range,
            null_size,
            range,
        }
    }

    /// The directions (state, then parameter) of the two branches; of unit length after division by the sizes. `None` where the
    /// equation has not two real roots.
    pub(super) fn directions(&self, scales: &[f64]) -> Option<[Vec<f64>; 2]> {
        let scaled = self.scaled(scales);
        let roots = scaled.roots()?;
        Some(roots.map(|(alpha, beta)| {
            let (alpha, beta) = (alpha / scaled.null_size, beta * scaled.range);
            let states = self.null_vector.iter().zip(&self.across);
            let mut vector: Vec<f64> = states.map(|(null, across)| alpha * null + beta * across).collect();
            vector.push(beta);
            let size = length(&vector, scales);
            vector.iter_mut().for_each(|entry| *entry /= size);
            vector
        }))
    }
}

/// A branching equation whose coefficients compare: the null vector has unit size, the parameter moves by its range.
pub(super) struct ScaledEquation {
    quadratic: f64,
    mixed: f64,
    parametric: f64,
    /// Size of the null vector.
    null_size: f64,
    range: f64,
}

impl ScaledEquation {
    /// Roots `(alpha, beta)` of `quadratic alpha^2 + 2 mixed alpha beta + parametric beta^2` without cancellation.
    fn roots(&self) -> Option<[(f64, f64); 2]> {
        let (a, b, c) = (self.quadratic, self.mixed, self.parametric);
        let discriminant = b * b - a * c;
        if !(discriminant > 0.0 && discriminant.is_finite()) {
            return None;
        }
        let stable = -(b + discriminant.sqrt().copysign(b));
        Some([(stable, a), (c, stable)])
    }

    /// Whether one branch is tangential to the parameter's value.
    pub(super) fn is_pitchfork(&self) -> bool {
        self.quadratic.abs() < PITCHFORK * self.mixed.abs()
    }

    /// The sense of a pitchfork with that cubic coefficient.
    pub(super) fn criticality(&self, cubic: f64) -> Criticality {
        // Along the other branch the parameter changes by this part of its range while the state changes by its size.
        let curvature = cubic / self.null_size.powi(3) / self.mixed;
        match cubic {
            _ if curvature.abs() < VERTICAL || curvature.is_nan() => Criticality::Degenerate,
            _ if cubic < 0.0 => Criticality::Supercritical,
            _ => Criticality::Subcritical,
        }
    }
}

fn project(left: &[f64], image: &[f64]) -> f64 {
    image.iter().zip(left).map(|(value, p)| value * p).sum()
}
