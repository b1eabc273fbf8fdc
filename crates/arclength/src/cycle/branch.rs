//! Points of a branch of limit cycles as plain data.

use super::curve::CycleInspection;
use super::end::CycleEnd;
use super::orbit::Orbit;
use super::switching::Branching;
use crate::branch::{Branch, Label, Labelled, SpecialKind};
use crate::continuation::Solution;
use num_complex::Complex64;
use std::borrow::Cow;

/// A limit cycle of a branch.
#[derive(Clone, Debug)]
pub struct CyclePoint {
    /// Value of the parameter.
    pub value: f64,
    /// All parameters.
    pub parameters: Vec<f64>,
    /// Period.
    pub period: f64,
    /// Largest value of each state, of the interpolating polynomial.
    pub max: Vec<f64>,
    /// Smallest value of each state.
    pub min: Vec<f64>,
    /// Floquet multipliers, largest modulus first, the trivial one among them.
    pub multipliers: Vec<Complex64>,
    /// Relative errors of the multipliers in the same order, measured on two meshes; empty where they were not.
    pub multiplier_errors: Vec<f64>,
    /// Distance of the computed trivial multiplier from 1.
    pub trivial_multiplier_error: f64,
    /// Number of nontrivial multipliers outside the unit circle.
    pub unstable_multipliers: usize,
    /// Whether the cycle is stable; `None` when a multiplier is closer to the unit circle than the error.
    pub stable: Option<bool>,
    /// Whether it is one of a family of cycles at one parameter value, as conserved quantities make them: the parameter stands
    /// still and a nontrivial multiplier is one.
    pub neutral: bool,
    /// Error of period and extremes of the cycle with this parameter value, relative to the period and to the amplitudes: what
    /// the defect of the polynomials does through the linearised equations, or the difference from a finer mesh.
    pub error_estimate: f64,
    /// Error of the parameter value of a special cycle that comes of the mesh.
    pub value_error: Option<f64>,
    /// Label of a special or requested cycle.
    pub label: Option<Label>,
    /// Coefficients of the normal form of a special cycle by name. Fold: `quadratic_coefficient` `b` of `dxi/dt = b xi^2`;
    /// period doubling: `cubic_coefficient` `c` of `dxi/dt = c xi^3`; torus bifurcation: `argument` of the multipliers and
    /// `cubic_coefficient`, the real part of `d` of `dxi/dt = i omega xi + d xi |xi|^2`, with its imaginary part. Negative
    /// cubic coefficients mean that the new solutions are stable within the centre manifold. Behind each coefficient stands its
    /// error under its name with `_error`, the difference from a mesh with intervals half as wide, where that could be measured.
    pub normal_form: Vec<(&'static str, f64)>,
    /// Start of the branch that leaves here: doubled cycles at a period doubling, the other branch at a branch point.
    pub branching: Option<Branching>,
    /// Values of the test functions by the label of the special cycle at which each changes sign.
    pub tests: Vec<(Cow<'static, str>, f64)>,
    /// Values of the monitors, in the order in which they were asked for; not a number where one does not exist.
    pub monitors: Vec<f64>,
    /// The cycle itself.
    pub orbit: Orbit,
}

/// A branch of limit cycles in the order in which it is traversed.
pub type CycleBranch = Branch<CyclePoint, CycleEnd>;

impl Labelled for CyclePoint {
    fn label(&self) -> Option<Label> {
        self.label
    }

    fn values(&self) -> Vec<f64> {
        vec![self.value]
    }
}

/// What all cycles of a branch have in common.
pub(super) struct FollowedParameter<'a> {
    /// All parameters.
    pub parameters: &'a [f64],
    /// Index of the one that is followed.
    pub active: usize,
    /// Length of its range.
    pub range: f64,
    /// Degree of the polynomials.
    pub degree: usize,
}

impl CyclePoint {
    /// A solution of the curve as plain data.
    pub(super) fn new(
        solution: &Solution<CycleInspection>,
        label: Option<Label>,
        along: &FollowedParameter<'_>,
    ) -> Self {
        let FollowedParameter { parameters, active, range, degree } = *along;
        let mut parameters = parameters.to_vec();
        let inspection = &solution.point;
        let (states, scalars) = solution.unknown.split_at(solution.unknown.len() - 2);
        let [period, value] = inspection.place.unwrap_or([scalars[0], scalars[1]]);
        parameters[active] = value;
        let (mesh, states) = inspection
            .fitted
            .as_ref()
            .map_or((&inspection.mesh[..], states), |fitted| (&fitted.mesh, &fitted.states));
        let is_special = label.is_some_and(|label| label.kind != SpecialKind::Requested);
        let turn = solution.tangent.last().map_or(0.0, |rate| rate / range);
        let test = |kind: SpecialKind, value: f64| (Cow::Borrowed(kind.label()), value);
        Self {
            value,
            parameters,
            period,
            max: inspection.extremes.iter().map(|extremes| extremes.largest).collect(),
            min: inspection.extremes.iter().map(|extremes| extremes.smallest).collect(),
            multipliers: inspection.floquet.multipliers(),
            multiplier_errors: inspection.multiplier_errors.clone(),
            trivial_multiplier_error: inspection.floquet.trivial_error,
            unstable_multipliers: inspection.floquet.unstable().count,
            // At a bifurcation a multiplier is on the unit circle by definition.
            stable: if is_special || inspection.is_neutral { None } else { inspection.floquet.is_stable() },
            neutral: inspection.is_neutral,
            error_estimate: inspection.error_estimate,
            value_error: inspection.parameter_error,
            label,
            normal_form: inspection.normal_form.clone(),
            branching: inspection.branching.clone(),
            tests: vec![
                test(SpecialKind::FoldOfCycles, turn),
                test(SpecialKind::BranchPointOfCycles, solution.orientation),
                test(SpecialKind::PeriodDoubling, inspection.doubling_test()),
                test(SpecialKind::Torus, inspection.floquet.torus_test().product),
            ],
            monitors: Vec::new(),
            orbit: Orbit {
                mesh: mesh.to_vec(),
                degree,
                states: states.to_vec(),
                period,
                dimension: inspection.extremes.len(),
            },
        }
    }
}
