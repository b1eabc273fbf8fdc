//! The curve of solutions of a boundary value problem along its last scalar: mesh adaptation, metric, folds.

use super::equations::Collocation;
use super::fold::fold_near;
use super::global_error::{GlobalError, largest};
use super::mesh::{error_profile, fit_mesh};
use super::polynomials::PiecewisePolynomial;
use super::problem::BoundaryValueProblem;
use super::resolution::Resolution;
use crate::branch::SpecialKind;
use crate::continuation::events::{Location, Reading, TestFunction};
use crate::continuation::{Adaptation, Curve, Discretised, Settings, Solution, locate_by_defining_system};
use crate::error::Error;
use std::borrow::Cow;
use std::convert::Infallible;

/// Folds, at which the parameter turns, are located; branch points, at which the orientation changes, are noticed.
const TEST_FUNCTIONS: &[TestFunction<SpecialKind>] =
    &[TestFunction::new(SpecialKind::BranchPoint), TestFunction::new(SpecialKind::Fold).turning()];
/// A rate of change of the parameter along the curve that may be rounding error, and one below which a solution may be a fold
/// itself.
const UNDECIDED_FOLD: f64 = 1e-13;
const NEARLY_FOLD: f64 = 1e-9;

/// What is known about a solution.
#[derive(Clone, Debug)]
pub struct BoundaryValuePoint {
    /// The components as functions of the unit time.
    pub components: PiecewisePolynomial,
    /// The scalars.
    pub scalars: Vec<f64>,
    /// Error across the curve, relative to the sizes of the components and of the scalars: of the solution as far as a change of
    /// the parameter does not undo it.
    pub error_estimate: f64,
}

/// The solutions of a boundary value problem along its last scalar, the parameter, as
/// [`follow`](crate::continuation::follow) can trace them. Folds are located; branch points are noticed and told among what
/// was not located.
///
/// The mesh adapts to the solution, so that no error estimate exceeds the tolerance of the [`Resolution`].
///
/// ```
/// use arclength::Scalar;
/// use arclength::collocation::{BoundaryValueCurve, BoundaryValueProblem, Resolution};
/// use arclength::continuation::{Bound, Request, Settings, follow};
/// use std::ops::ControlFlow;
///
/// /// u'' + p u = 1, u(0) = u(1) = 0.
/// struct Rod;
/// impl BoundaryValueProblem for Rod {
///     fn dimension(&self) -> usize { 2 }
///     fn scalars(&self) -> usize { 1 }
///     fn field<T: Scalar>(&self, _time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
///         derivative[0] = state[1];
///         derivative[1] = -(scalars[0] * state[0]) + 1.0;
///     }
///     fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], _scalars: &[T], values: &mut [T]) {
///         values[0] = start[0];
///         values[1] = end[0];
///     }
/// }
///
/// let mut curve = BoundaryValueCurve::new(Rod, &[1.0, 1.0, 4.0], Resolution::default())?;
/// let start = curve.start(|t| vec![0.5 * t * (t - 1.0), t - 0.5], &[0.0]);
/// let mut tangent = vec![0.0; start.len()];
/// tangent[start.len() - 1] = 1.0;
/// let request = Request::within(&[Bound { from_end: 1, lower: 0.0, upper: 4.0 }], Settings::default());
/// let followed = follow(&mut curve, start, tangent, &request, &mut |_, _| ControlFlow::Continue(()))?;
/// let (last, _) = followed.solutions.last().unwrap();
/// let exact = 0.25 * (1.0 - 1.0 / 1.0_f64.cos());
/// assert!((last.point.components.at(0.5)[0] - exact).abs() < 1e-8);
/// # Ok::<(), arclength::Error>(())
/// ```
#[derive(Debug)]
pub struct BoundaryValueCurve<P> {
    collocation: Collocation<P>,
    resolution: Resolution,
    settings: Settings,
    /// Sizes of the components and of the scalars.
    sizes: Vec<f64>,
    /// Smallest and largest values met of these.
    visited: Vec<[f64; 2]>,
    error_estimate: f64,
    global_error: GlobalError,
}

impl<P: BoundaryValueProblem> BoundaryValueCurve<P> {
    /// The curve of solutions of `problem`; `sizes` are those of its components and of its scalars, the last the length of the
    /// parameter's range. The others grow to the ranges that are covered.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there are not as many sizes or one is not positive, and as [`Collocation::try_new`].
    pub fn new(problem: P, sizes: &[f64], resolution: Resolution) -> Result<Self, Error> {
        let invalid = |name: &str, value: String, allowed: String| {
            Err(Error::Invalid { name: name.into(), value, allowed })
        };
        let wanted = problem.dimension() + problem.scalars();
        if sizes.len() != wanted {
            let allowed = format!("{wanted}, one for every component and scalar");
            return invalid("sizes", format!("{} numbers", sizes.len()), allowed);
        }
        if let Some(size) = sizes.iter().find(|size| !(**size > 0.0 && size.is_finite())) {
            return invalid("size", size.to_string(), "a positive number".into());
        }
        let intervals = resolution.fewest_intervals.max(1);
        let mesh = (0..=intervals).map(|index| index as f64 / intervals as f64).collect();
        let collocation = Collocation::try_new(problem, mesh, resolution.degree)?;
        Ok(Self {
            global_error: GlobalError::new(collocation.gauss()),
            collocation,
            resolution,
            settings: Settings::default(),
            sizes: sizes.to_vec(),
            visited: vec![[f64::INFINITY, f64::NEG_INFINITY]; wanted],
            error_estimate: f64::INFINITY,
        })
    }

    /// The unknowns of a start, given by the components as functions of the unit time and by the scalars. Also makes it what
    /// conditions on integrals refer to.
    pub fn start(&mut self, components: impl Fn(f64) -> Vec<f64>, scalars: &[f64]) -> Vec<f64> {
        let times = self.collocation.polynomials(&[]).node_times();
        let mut unknown: Vec<f64> = times.into_iter().flat_map(components).collect();
        unknown.extend_from_slice(scalars);
        self.collocation.set_reference(&unknown);
        unknown
    }

    /// Rate of change of the parameter along the curve, as part of its range: zero at a fold.
    fn turn(&self, tangent: &[f64]) -> f64 {
        tangent.last().zip(self.sizes.last()).map_or(0.0, |(rate, range)| rate / range)
    }

    /// Sizes grow to the ranges met, that of the parameter excepted.
    fn grow_sizes(&mut self, unknown: &[f64]) {
        let n = self.collocation.problem.dimension();
        let (states, scalars) = unknown.split_at(unknown.len() - self.collocation.problem.scalars());
        let components = states.iter().enumerate().map(|(index, value)| (index % n, *value));
        let others =
            scalars[..scalars.len() - 1].iter().enumerate().map(|(index, value)| (n + index, *value));
        for (index, value) in components.chain(others) {
            let [smallest, largest] = &mut self.visited[index];
            *smallest = smallest.min(value);
            *largest = largest.max(value);
        }
        for (size, [smallest, largest]) in self.sizes.iter_mut().zip(&self.visited) {
            *size = size.max(largest - smallest);
        }
    }
}

impl<P: BoundaryValueProblem> Discretised for BoundaryValueCurve<P> {
    type System = Collocation<P>;

    fn system(&self) -> &Self::System {
        &self.collocation
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.collocation
    }
}

impl<P: BoundaryValueProblem> Curve for BoundaryValueCurve<P> {
    type Point = BoundaryValuePoint;
    type Kind = SpecialKind;
    type Reason = Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.collocation.apply_metric(&self.sizes, vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        self.grow_sizes(unknown);
        let components = &self.sizes[..self.collocation.problem.dimension()];
        let errors = error_profile(&self.collocation, unknown, components);
        let (adaptation, worst) =
            fit_mesh(&mut self.collocation, &errors, &self.resolution, unknown, vectors)?;
        self.error_estimate = worst;
        Ok(adaptation)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        _tangent: &[f64],
        _orientation: f64,
    ) -> Result<BoundaryValuePoint, Error> {
        let (states, scalars) = unknown.split_at(unknown.len() - self.collocation.problem.scalars());
        Ok(BoundaryValuePoint {
            components: PiecewisePolynomial {
                mesh: self.collocation.mesh().to_vec(),
                degree: self.collocation.gauss().degree(),
                dimension: self.collocation.problem.dimension(),
                states: states.to_vec(),
            },
            scalars: scalars.to_vec(),
            error_estimate: self.error_estimate,
        })
    }

    fn measure(&mut self, solution: &mut Solution<BoundaryValuePoint>) {
        let error = self.global_error.of(&mut self.collocation, &solution.unknown);
        let n = self.collocation.problem.dimension();
        let (states, scalars) = error.split_at(error.len() - self.collocation.problem.scalars());
        let states = states.iter().zip(self.sizes[..n].iter().cycle());
        let relative =
            states.chain(scalars.iter().zip(&self.sizes[n..])).map(|(error, size)| (error / size).abs());
        solution.point.error_estimate = largest(relative);
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Borrowed(TEST_FUNCTIONS)
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<BoundaryValuePoint>) -> Option<Reading> {
        match kind {
            SpecialKind::BranchPoint => Some(Reading::exact(solution.orientation)),
            _ => Some(Reading::exact(self.turn(&solution.tangent)).with_noise(UNDECIDED_FOLD)),
        }
    }

    fn undecided(&self, solution: &Solution<BoundaryValuePoint>) -> usize {
        usize::from(self.turn(&solution.tangent).abs() < NEARLY_FOLD)
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        between: [&Solution<BoundaryValuePoint>; 2],
    ) -> Result<Location<BoundaryValuePoint>, Error> {
        if kind == SpecialKind::BranchPoint {
            return Ok(Location::Missed);
        }
        let settings = self.settings;
        let turn =
            |curve: &mut Self, solution: &Solution<BoundaryValuePoint>| Some(curve.turn(&solution.tangent));
        locate_by_defining_system(self, between, &settings, turn, |curve, near| {
            fold_near(&curve.collocation, &near.unknown, &near.tangent, &curve.sizes, &settings)
        })
    }

    /// Values at both ends and in the middle, and the scalars other than the parameter.
    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let n = self.collocation.problem.dimension();
        let mut signature = Vec::new();
        let mut state = vec![0.0; n];
        for time in [0.0, 0.5, 1.0] {
            self.collocation.evaluate(unknown, time, &mut state);
            signature.extend(state.iter().copied().zip(self.sizes.iter().copied()));
        }
        let scalars = &unknown[unknown.len() - self.collocation.problem.scalars()..unknown.len() - 1];
        signature.extend(scalars.iter().copied().zip(self.sizes[n..].iter().copied()));
        signature
    }
}
