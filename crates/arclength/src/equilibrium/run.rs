//! Asking for a branch of equilibria.

use super::branch::{BetweenDirections, BranchDirection, EquilibriumBranch};
use super::branch_point::BranchPoint;
use super::curve::{EquilibriumCurve, Inspection};
use super::departure::{at_start, branch_point_along, is_branching};
use super::newton::{check_length, find_erased};
use super::problem::EquilibriumProblem;
use crate::algebraic::scales::natural_scales;
use crate::algebraic::{Differentiator, length};
use crate::continuation::{Bound, Followed, Origin, Request, Settings, Solution, Stop, follow};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use std::ops::{ControlFlow, RangeInclusive};

/// Distance from a branch point, in the metric, of the first point on the other branch.
const DEPARTURE: f64 = 1e-3;

/// The settings that suit equilibria, where steps cost little: short ones, so that nothing is jumped over.
pub fn equilibrium_settings() -> Settings {
    Settings {
        initial_step: 0.005,
        largest_step: 0.1,
        predictor_error: 1e-3,
        corrector_tolerance: 1e-12,
        ..Settings::default()
    }
}

/// Where a branch starts.
#[derive(Clone, Debug)]
enum Start {
    State(Vec<f64>),
    Equilibrium(Vec<f64>),
    OtherBranch { branch_point: Box<BranchPoint>, tangent: Vec<f64> },
}

/// A branch of equilibria to be followed both ways from a start, over a range of one parameter.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::Equilibria};
/// struct Fold;
/// impl VectorField for Fold {
///     fn state_names(&self) -> Vec<String> { vec!["x".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["p".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
///         derivative[0] = p[0] - x[0] * x[0];
///     }
/// }
/// let branch = Equilibria::of(&Fold).start(&[1.0]).parameters(&[1.0]).along("p", -1.0..=2.0).run()?;
/// let folds: Vec<_> = branch.folds().collect();
/// assert!(folds.len() == 1 && folds[0].parameter.abs() < 1e-15);
/// # Ok::<(), arclength::Error>(())
/// ```
#[derive(Debug)]
pub struct Equilibria<'a> {
    field: ErasedField<'a>,
    start: Start,
    parameters: Option<Vec<f64>>,
    along: Option<(String, RangeInclusive<f64>)>,
    at: Vec<f64>,
    settings: Settings,
}

impl<'a> Equilibria<'a> {
    /// Equilibria of `field`, by default from the start zero.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        let field = ErasedField::of(field);
        Self {
            field,
            start: Start::State(vec![0.0; field.dimension()]),
            parameters: None,
            along: None,
            at: Vec::new(),
            settings: equilibrium_settings(),
        }
    }

    /// State from which the first equilibrium is sought; it need not be one.
    pub fn start(mut self, state: &[f64]) -> Self {
        self.start = Start::State(state.to_vec());
        self
    }

    /// Starts at a state that is an equilibrium, perhaps a singular one such as a fold, to which Newton's method would not
    /// converge.
    pub fn through(mut self, equilibrium: &[f64]) -> Self {
        self.start = Start::Equilibrium(equilibrium.to_vec());
        self
    }

    /// Values of all parameters, in the field's order. That of the parameter to vary says where to start; outside its
    /// range the nearer end does.
    pub fn parameters(mut self, values: &[f64]) -> Self {
        self.parameters = Some(values.to_vec());
        self
    }

    /// Starts on the other branch through a branch point, with its parameters.
    pub fn from_branch_point(mut self, branch_point: &BranchPoint) -> Self {
        self.parameters = Some(branch_point.parameters.clone());
        self.start = Start::OtherBranch {
            branch_point: Box::new(branch_point.clone()),
            tangent: branch_point.tangents[1].clone(),
        };
        self
    }

    /// The parameter to vary and its range.
    pub fn along(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.along = Some((parameter.to_owned(), range));
        self
    }

    /// Values of the parameter at which equilibria are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// Step control and tolerances.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Follows the branch.
    ///
    /// # Errors
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when there is no equilibrium near
    /// the start. What goes wrong later ends the branch with a [`Stop`].
    pub fn run(self) -> Result<EquilibriumBranch, Error> {
        self.observed(&mut |_, _| ControlFlow::Continue(()))
    }

    /// As [`run`](Self::run); `observer` is told the parameter value and the state of every solution and may end a
    /// direction.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn observed(
        mut self,
        observer: &mut dyn FnMut(f64, &[f64]) -> ControlFlow<()>,
    ) -> Result<EquilibriumBranch, Error> {
        let names = self.field.parameter_names();
        let (name, range) =
            self.along.clone().ok_or_else(|| missing("along", "a parameter and its range"))?;
        let parameters =
            self.parameters.clone().ok_or_else(|| missing("parameters", "a value for each parameter"))?;
        check_length("parameters", &parameters, names.len(), "the number of parameters")?;
        let active = names.iter().position(|candidate| *candidate == name).ok_or_else(|| Error::Invalid {
            name: "along".into(),
            value: name.clone(),
            allowed: format!("one of {}", names.join(", ")),
        })?;
        let bound = check_range(&name, &range)?;
        if let Some(value) = self.at.iter().find(|value| !range.contains(value)) {
            return Err(Error::Invalid {
                name: "at".into(),
                value: value.to_string(),
                allowed: format!("{} to {}", bound.lower, bound.upper),
            });
        }
        let n = self.field.dimension();
        let problem = EquilibriumProblem::new(self.field, &parameters, &[active]);
        let request = Request { bounds: vec![bound], values: self.at.clone(), settings: self.settings };

        let (unknown, tangent, departure) = match &self.start {
            Start::State(state) => {
                check_length("start", state, n, "the dimension of the field")?;
                let value = parameters[active].clamp(bound.lower, bound.upper);
                let mut unknown = find_erased(self.field, state, &problem.parameters_at(&[value]))?;
                unknown.push(value);
                (unknown, None, 0.0)
            }
            Start::Equilibrium(state) => {
                check_length("start", state, n, "the dimension of the field")?;
                let value = parameters[active];
                if !range.contains(&value) {
                    return Err(Error::Invalid {
                        name: format!("{name} at the start"),
                        value: value.to_string(),
                        allowed: format!("{} to {}", bound.lower, bound.upper),
                    });
                }
                ([&state[..], &[value]].concat(), None, 0.0)
            }
            Start::OtherBranch { branch_point, tangent } => {
                check_length("branch point", &branch_point.state, n, "the dimension of the field")?;
                let mut unknown = branch_point.state.clone();
                unknown.push(parameters[active]);
                let same = branch_point.active == active;
                (unknown, same.then(|| tangent.clone()), if same { DEPARTURE } else { 0.0 })
            }
        };
        let scales = scales(&problem, &unknown, bound.upper - bound.lower);
        let (mut tangent, mut departure) = (tangent, departure);
        if tangent.is_none() && is_branching(&problem, &unknown, &scales)? {
            // From a branch point found along another parameter the other branch is followed here too.
            let point = match &self.start {
                Start::OtherBranch { branch_point, .. } => {
                    branch_point_along(&problem, &unknown, branch_point, &scales)?
                }
                _ => None,
            };
            let Some(point) = point else {
                return Err(Error::Invalid {
                    name: format!("start at {name}"),
                    value: unknown[n].to_string(),
                    allowed: format!(
                        "the equilibrium there is a branch point, or degenerate, and no single branch passes through \
                         it; start beside it, at a slightly different {name}"
                    ),
                });
            };
            let tangent_there = point.tangents[1].clone();
            self.start = Start::OtherBranch { branch_point: Box::new(point), tangent: tangent_there.clone() };
            (tangent, departure) = (Some(tangent_there), DEPARTURE);
        }
        let mut curve = EquilibriumCurve::new(problem, scales, bound, self.settings);
        let mut tangent = match tangent {
            Some(tangent) => tangent,
            None => curve.system.tangent(&unknown)?,
        };
        let size = length(&tangent, &curve.system.scales);
        // The forward direction is that of a growing parameter; of two vertical ones it is that of a growing state.
        let vertical = (tangent[n] / curve.system.scales[n]).abs() < 1e-6 * size;
        let lead = if vertical { tangent.iter().find(|entry| **entry != 0.0) } else { tangent.last() };
        let sign = if lead.is_some_and(|entry| *entry < 0.0) { -1.0 } else { 1.0 } / size;
        tangent.iter_mut().for_each(|entry| *entry *= sign);

        let mut observe =
            |solution: &Solution<Inspection>| observer(solution.unknown[n], &solution.unknown[..n]);
        let mut run = |curve: &mut EquilibriumCurve<'_>, sign: f64| -> Result<Followed<Inspection>, Error> {
            let tangent: Vec<f64> = tangent.iter().map(|entry| sign * entry).collect();
            let leaves = |end: f64| (unknown[n] - end).abs() <= f64::EPSILON * end.abs() && departure == 0.0;
            if !vertical && leaves(if sign > 0.0 { bound.upper } else { bound.lower }) {
                let value = unknown[n];
                return Ok(Followed { solutions: Vec::new(), stop: Stop::RangeEnd { bound: 0, value } });
            }
            let start =
                unknown.iter().zip(&tangent).map(|(value, slope)| value + departure * slope).collect();
            curve.restart();
            follow(curve, start, tangent, &request, &mut observe)
        };
        let mut forward = run(&mut curve, 1.0)?;
        let forward_beyond = curve.first_beyond.take();
        let backward = if matches!(forward.stop, Stop::Closed) {
            Followed { solutions: Vec::new(), stop: Stop::Closed }
        } else {
            run(&mut curve, -1.0)?
        };
        let backward_beyond = curve.first_beyond.take();
        let middle = match self.start {
            Start::OtherBranch { mut branch_point, .. } if departure > 0.0 => {
                branch_point.tangents.swap(0, 1);
                let middle = curve.at_branch_point(unknown, *branch_point)?;
                if matches!(forward.stop, Stop::Closed) {
                    end_at(&middle, &mut forward.solutions, 2.0 * departure, &curve.system.scales);
                }
                Some((middle, Origin::Special))
            }
            _ => None,
        };
        let directions = [backward, forward]
            .map(|followed| BranchDirection { solutions: followed.solutions, stop: followed.stop });
        let special = at_start(&mut curve, &directions, [backward_beyond, forward_beyond])?;
        let between = BetweenDirections { middle, special, scales: &curve.system.scales };
        Ok(EquilibriumBranch::assemble(self.field, active, parameters, &self.at, directions, between))
    }
}

/// Has a closed branch end at the branch point from which it started, which it finds again, and not the distance of the
/// departure behind it.
fn end_at(
    branch_point: &Solution<Inspection>,
    solutions: &mut Vec<(Solution<Inspection>, Origin)>,
    reach: f64,
    scales: &[f64],
) {
    solutions.pop();
    solutions.pop_if(|(last, origin)| {
        let difference = last.unknown.iter().zip(&branch_point.unknown).map(|(a, b)| a - b);
        *origin == Origin::Special && length(&difference.collect::<Vec<_>>(), scales) < reach
    });
    let mut end = branch_point.clone();
    end.point.special = None;
    solutions.push((end, Origin::End));
}

/// Sizes of the states and of the parameter.
fn scales(problem: &EquilibriumProblem<'_>, unknown: &[f64], range: f64) -> Vec<f64> {
    let n = problem.dimension;
    let mut matrix = vec![0.0; n * (n + 1)];
    let mut residual = vec![0.0; n];
    Differentiator::default().jacobian(problem, unknown, &mut residual, &mut matrix, n);
    let speed: Vec<f64> = matrix[n * n..].iter().map(|entry| entry * range).collect();
    let mut scales =
        natural_scales(&problem.field, &unknown[..n], &problem.parameters_at(&unknown[n..]), &speed);
    scales.push(range);
    scales
}

fn missing(name: &str, allowed: &str) -> Error {
    Error::Invalid { name: name.into(), value: "nothing".into(), allowed: allowed.into() }
}

/// The range of a parameter as a bound of the last unknown.
pub(crate) fn check_range(name: &str, range: &RangeInclusive<f64>) -> Result<Bound, Error> {
    let (lower, upper) = (*range.start(), *range.end());
    if lower < upper && (upper - lower).is_finite() {
        Ok(Bound { from_end: 1, lower, upper })
    } else {
        Err(Error::Invalid {
            name: format!("range of {name}"),
            value: format!("{lower} to {upper}"),
            allowed: "two finite numbers, the smaller one first".into(),
        })
    }
}
