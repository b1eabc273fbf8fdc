//! Branch points of equilibria: the coefficients of the bifurcation equation and the other branch.

use super::branching_equation::BranchingEquation;
use super::coefficient_error::{self, UncertainEquilibrium};
use super::multilinear::MultilinearForms;
use super::problem::EquilibriumProblem;
use crate::branch::Criticality;
use crate::error::Error;
use serde::{Deserialize, Serialize};

/// How two branches cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Crossing {
    /// Both branches exist on both sides of the parameter value.
    Transcritical,
    /// One branch lies on one side only, tangential to the parameter's value.
    Pitchfork,
}

/// A branch point, located by Newton's method on its defining system.
///
/// The branches leave it in the directions `alpha (q, 0) + beta (x1, 1)` with
/// `quadratic alpha^2 + 2 mixed alpha beta + parametric beta^2 = 0` (Keller 1977).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BranchPoint {
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Index of the parameter along which it was found.
    pub active: usize,
    /// Value of that parameter.
    #[serde(rename = "parameter")]
    pub value: f64,
    /// Error estimate of that value.
    pub location_error: f64,
    /// The equilibrium.
    pub state: Vec<f64>,
    /// Null vector `q` of the Jacobian, `<q, q> = 1`.
    pub null_vector: Vec<f64>,
    /// `<p, B(q, q)>`, with `<p, q> = 1`; `None`, as the other coefficients, where zero is a double eigenvalue, so that `<p, q> = 0`.
    pub quadratic: Option<f64>,
    /// `<p, B(q, x1) + f_xp q>`, where `x1` is the slope of a branch in the parameter, orthogonal to `q` after
    /// division by the sizes of the states.
    pub mixed: Option<f64>,
    /// The second derivative of `<p, f>` along `(x1, 1)`.
    pub parametric: Option<f64>,
    /// Errors of `quadratic`, `mixed` and `parametric`: how much they change where the equilibrium moves by its own error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quadratic_errors: Option<[f64; 3]>,
    /// At a pitchfork, the cubic coefficient of the flow on the centre manifold, `<p, C(q, q, q) - 3 B(q, A^-1 B(q, q))>/6`:
    /// negative if the pitchfork is supercritical. `None` where zero is a double eigenvalue.
    pub cubic: Option<f64>,
    /// Error of that coefficient, as of the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cubic_error: Option<f64>,
    /// The sense of a pitchfork; degenerate where the other branch is vertical within rounding, or the coefficient zero within its
    /// error. `None` where there is no coefficient.
    #[serde(default)]
    pub criticality: Option<Criticality>,
    /// How the branches cross.
    pub crossing: Crossing,
    /// Tangents (state, then parameter) of the branch on which the point was found and of the other one; of unit length
    /// after division by the sizes of states and parameter.
    pub tangents: [Vec<f64>; 2],
}

impl BranchPoint {
    /// Whether the parameter turns on the branch on which the point was found: it is the one that leaves a pitchfork to one side.
    pub(crate) fn turns(&self) -> bool {
        let rate = |tangent: &[f64]| tangent.last().map_or(0.0, |rate| rate.abs());
        let [own, other] = &self.tangents;
        self.crossing == Crossing::Pitchfork && rate(own) < rate(other)
    }

    /// The branch point at a located singular equilibrium on a branch with the direction `tangent`.
    pub(crate) fn at(
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        tangent: &[f64],
        scales: &[f64],
        location_error: f64,
    ) -> Result<Option<Self>, Error> {
        let found = Self::without_errors(problem, unknown, tangent, scales, location_error)?;
        Ok(found.map(|point| point.with_errors(problem, tangent, scales)))
    }

    /// The same with the errors of its coefficients.
    fn with_errors(self, problem: &EquilibriumProblem<'_>, tangent: &[f64], scales: &[f64]) -> Self {
        let (Some(quadratic), Some(mixed), Some(parametric)) = (self.quadratic, self.mixed, self.parametric)
        else {
            return self;
        };
        let known = [quadratic, mixed, parametric, self.cubic.unwrap_or(0.0)];
        let equilibrium = UncertainEquilibrium::on_branch(
            problem,
            (&self.state, &self.parameters),
            scales,
            self.location_error,
        );
        let errors = coefficient_error::errors(known, equilibrium, |state, parameters| {
            let moved = EquilibriumProblem::new(problem.field, parameters, &problem.active);
            let unknown = [state, &[parameters[self.active]]].concat();
            let near = Self::without_errors(&moved, &unknown, tangent, scales, 0.0).ok()??;
            // A null vector may have either sign.
            let product = near.null_vector.iter().zip(&self.null_vector).map(|(one, other)| one * other);
            let sign = product.sum::<f64>().signum();
            let cubic = if self.cubic.is_some() { near.cubic? } else { 0.0 };
            Some([sign * near.quadratic?, near.mixed?, sign * near.parametric?, cubic])
        });
        let quadratic_errors = errors.map(|[quadratic, mixed, parametric, _]| [quadratic, mixed, parametric]);
        let cubic_error = self.cubic.and(errors).map(|errors| errors[3]);
        let is_certain =
            matches!((self.cubic, cubic_error), (Some(cubic), Some(error)) if cubic.abs() > error);
        let criticality =
            self.criticality.map(|sense| if is_certain { sense } else { Criticality::Degenerate });
        Self { quadratic_errors, cubic_error, criticality, ..self }
    }

    fn without_errors(
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        tangent: &[f64],
        scales: &[f64],
        location_error: f64,
    ) -> Result<Option<Self>, Error> {
        let n = problem.dimension;
        let state = unknown[..n].to_vec();
        let parameters = problem.parameters_at(&unknown[n..]);
        let active = problem.active[0];
        let forms = MultilinearForms { field: problem.field, state: &state, parameters: &parameters };
        let Some(equation) = BranchingEquation::at(problem, unknown, forms, scales)? else {
            return Ok(None);
        };
        let Some(directions) = equation.directions(scales) else { return Ok(None) };
        let scaled = equation.scaled(scales);
        let crossing = if scaled.is_pitchfork() { Crossing::Pitchfork } else { Crossing::Transcritical };
        let cubic = (crossing == Crossing::Pitchfork && equation.is_simple).then(|| equation.cubic());
        let BranchingEquation { null_vector, quadratic, mixed, parametric, is_simple, .. } = equation;
        let [quadratic, mixed, parametric] =
            [quadratic, mixed, parametric].map(|coefficient| is_simple.then_some(coefficient));
        Ok(Some(Self {
            criticality: cubic.map(|cubic| scaled.criticality(cubic)),
            quadratic_errors: None,
            cubic_error: None,
            value: parameters[active],
            parameters,
            active,
            location_error,
            state,
            null_vector,
            quadratic,
            mixed,
            parametric,
            cubic,
            crossing,
            tangents: known_first(directions, tangent, scales),
        }))
    }
}

/// The directions of two branches, first that of the one with the direction `tangent`, in the sense of that.
fn known_first([mut own, mut other]: [Vec<f64>; 2], tangent: &[f64], scales: &[f64]) -> [Vec<f64>; 2] {
    let along = |vector: &[f64]| {
        vector.iter().zip(tangent).zip(scales).map(|((x, y), s)| x / s * (y / s)).sum::<f64>()
    };
    if along(&own).abs() < along(&other).abs() {
        std::mem::swap(&mut own, &mut other);
    }
    if along(&own) < 0.0 {
        own.iter_mut().for_each(|entry| *entry = -*entry);
    }
    [own, other]
}
