//! The curve of solutions of an algebraic problem along a parameter, with special points by test functions.

use super::fold::fold_near;
use super::{AlgebraicProblem, DenseSystem};
use crate::branch::SpecialKind;
use crate::continuation::events::{Location, Reading, Spectrum, TestFunction};
use crate::continuation::{Adaptation, Curve, Discretised, Settings, Solution, locate_by_defining_system};
use crate::error::Error;
use std::borrow::Cow;
use std::convert::Infallible;

/// Folds, at which the parameter turns, are located; branch points, at which the orientation changes, are noticed.
const TEST_FUNCTIONS: [TestFunction<SpecialKind>; 2] = [
    TestFunction::new(SpecialKind::BranchPoint).changing(&[0, 1]),
    TestFunction::new(SpecialKind::Fold).changing(&[1]).turning(),
];
/// A rate of change of the parameter along the curve that may be rounding error, and one below which a solution may be a fold
/// itself.
const UNDECIDED_FOLD: f64 = 1e-13;
const NEARLY_FOLD: f64 = 1e-9;

/// What is known about a solution.
#[derive(Clone, Debug)]
pub struct AlgebraicPoint {
    /// Derivatives of the `n` equations with respect to the unknowns, the parameter among them: `n` by `n + 1`, column-major.
    pub jacobian: Vec<f64>,
    /// Growth exponents, where [`AlgebraicCurve::spectrum`] tells them.
    pub spectrum: Spectrum,
}

type Value<'a> = dyn Fn(&Solution<AlgebraicPoint>) -> f64 + 'a;
type Locate<'a> = dyn Fn(&Solution<AlgebraicPoint>) -> Result<Vec<f64>, Error> + 'a;
type SpectrumOf<'a> = dyn Fn(&[f64]) -> Result<Spectrum, Error> + 'a;

/// A test function of a user's own and how its points are located.
struct OwnTest<'a> {
    kind: SpecialKind,
    value: Box<Value<'a>>,
    locate: Box<Locate<'a>>,
}

/// The solutions of a problem with one unknown more than equations, the last being the parameter, as
/// [`follow`](crate::continuation::follow) can trace them. Folds are located always, other special points by
/// [test functions](Self::test_function); branch points are noticed and told among what was not located.
///
/// ```
/// use arclength::Scalar;
/// use arclength::algebraic::{AlgebraicCurve, AlgebraicProblem};
/// use arclength::branch::SpecialKind;
/// use arclength::continuation::{Bound, Origin, Request, Settings, follow};
/// use std::ops::ControlFlow;
///
/// /// A circle: x^2 + p^2 = 1.
/// struct Circle;
/// impl AlgebraicProblem for Circle {
///     fn unknowns(&self) -> usize { 2 }
///     fn equations(&self) -> usize { 1 }
///     fn evaluate<T: Scalar>(&self, z: &[T], residual: &mut [T]) {
///         residual[0] = z[0] * z[0] + z[1] * z[1] - 1.0;
///     }
/// }
///
/// let mut curve = AlgebraicCurve::new(Circle, &[1.0, 4.0])?;
/// let bounds = [Bound { from_end: 1, lower: -2.0, upper: 2.0 }];
/// let request = Request::within(&bounds, Settings::default());
/// let all = follow(&mut curve, vec![1.0, 0.0], vec![0.0, 1.0], &request, &mut |_, _| ControlFlow::Continue(()))?;
/// let special = all.solutions.iter().filter(|(_, origin)| *origin == Origin::Special(SpecialKind::Fold));
/// let folds: Vec<f64> = special.map(|(solution, _)| solution.unknown[1]).collect();
/// assert_eq!(folds, [1.0, -1.0]);
/// # Ok::<(), arclength::Error>(())
/// ```
pub struct AlgebraicCurve<'a, P> {
    system: DenseSystem<P>,
    settings: Settings,
    tests: Vec<TestFunction<SpecialKind>>,
    own: Vec<OwnTest<'a>>,
    spectrum: Option<Box<SpectrumOf<'a>>>,
}

impl<'a, P: AlgebraicProblem> AlgebraicCurve<'a, P> {
    /// The curve of solutions of `problem`; `scales` are the sizes of its unknowns, the last the length of the parameter's
    /// range. Those of the other unknowns grow to the ranges that are covered.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the numbers of unknowns, equations and scales do not fit, or a scale is not positive.
    pub fn new(problem: P, scales: &[f64]) -> Result<Self, Error> {
        let invalid = |name: &str, value: String, allowed: String| {
            Err(Error::Invalid { name: name.into(), value, allowed })
        };
        let unknowns = problem.unknowns();
        if problem.equations() + 1 != unknowns {
            let allowed = format!("one fewer than the {unknowns} unknowns");
            return invalid("number of equations", problem.equations().to_string(), allowed);
        }
        if scales.len() != unknowns {
            return invalid(
                "scales",
                format!("{} numbers", scales.len()),
                format!("{unknowns}, one for every unknown"),
            );
        }
        if let Some(scale) = scales.iter().find(|scale| !(**scale > 0.0 && scale.is_finite())) {
            return invalid("scale", scale.to_string(), "a positive number".into());
        }
        let system = DenseSystem::new(problem, scales.to_vec());
        let (settings, tests) = (Settings::default(), TEST_FUNCTIONS.to_vec());
        Ok(Self { system, settings, tests, own: Vec::new(), spectrum: None })
    }

    /// Locates special points of another kind, too, or of a known kind in another way: `value` changes its sign at them, and from a solution near one `locate`
    /// computes the unknowns there, as a rule by [`solve_square`](super::solve_square) on a defining system that is regular at
    /// the point.
    pub fn test_function(
        mut self,
        test: TestFunction<SpecialKind>,
        value: impl Fn(&Solution<AlgebraicPoint>) -> f64 + 'a,
        locate: impl Fn(&Solution<AlgebraicPoint>) -> Result<Vec<f64>, Error> + 'a,
    ) -> Self {
        self.tests.retain(|known| known.kind != test.kind);
        self.tests.push(test);
        self.own.retain(|known| known.kind != test.kind);
        self.own.push(OwnTest { kind: test.kind, value: Box::new(value), locate: Box::new(locate) });
        self
    }

    /// Tells the growth exponents of a solution from its Jacobian ([`AlgebraicPoint::jacobian`]): the labels along the curve then
    /// have to explain every change of the number of unstable ones.
    pub fn spectrum(mut self, of: impl Fn(&[f64]) -> Result<Spectrum, Error> + 'a) -> Self {
        self.spectrum = Some(Box::new(of));
        self
    }

    fn own_test(&self, kind: SpecialKind) -> Option<&OwnTest<'a>> {
        self.own.iter().find(|own| own.kind == kind)
    }

    /// Rate of change of the parameter along the curve, as part of its range: zero at a fold.
    fn turn(&self, tangent: &[f64]) -> f64 {
        tangent.last().zip(self.system.scales.last()).map_or(0.0, |(rate, range)| rate / range)
    }
}

impl<P: AlgebraicProblem> Discretised for AlgebraicCurve<'_, P> {
    type System = DenseSystem<P>;

    fn system(&self) -> &Self::System {
        &self.system
    }

    fn system_mut(&mut self) -> &mut Self::System {
        &mut self.system
    }
}

impl<P: AlgebraicProblem> Curve for AlgebraicCurve<'_, P> {
    type Point = AlgebraicPoint;
    type Kind = SpecialKind;
    type Reason = Infallible;

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        self.system.apply_metric(vector, image);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, _vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        self.system.grow_scales(unknown, unknown.len() - 1);
        Ok(Adaptation::Unchanged)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        _tangent: &[f64],
        _orientation: f64,
    ) -> Result<AlgebraicPoint, Error> {
        let n = unknown.len() - 1;
        let jacobian: Vec<f64> =
            self.system.matrix.chunks_exact(n + 1).flat_map(|column| column[..n].iter().copied()).collect();
        let spectrum = self.spectrum.as_ref().map_or_else(|| Ok(Spectrum::default()), |of| of(&jacobian))?;
        Ok(AlgebraicPoint { jacobian, spectrum })
    }

    fn test_functions(&self) -> Cow<'static, [TestFunction<SpecialKind>]> {
        Cow::Owned(self.tests.clone())
    }

    fn test(&self, kind: SpecialKind, solution: &Solution<AlgebraicPoint>) -> Option<Reading> {
        if let Some(own) = self.own_test(kind) {
            return Some(Reading::exact((own.value)(solution)));
        }
        match kind {
            SpecialKind::BranchPoint => Some(Reading::exact(solution.orientation)),
            SpecialKind::Fold => {
                Some(Reading::exact(self.turn(&solution.tangent)).with_noise(UNDECIDED_FOLD))
            }
            _ => None,
        }
    }

    fn spectrum(&self, solution: &Solution<AlgebraicPoint>) -> Spectrum {
        solution.point.spectrum.clone()
    }

    fn undecided(&self, solution: &Solution<AlgebraicPoint>) -> usize {
        usize::from(self.turn(&solution.tangent).abs() < NEARLY_FOLD)
    }

    fn locate(
        &mut self,
        kind: SpecialKind,
        between: [&Solution<AlgebraicPoint>; 2],
    ) -> Result<Location<AlgebraicPoint>, Error> {
        let settings = self.settings;
        let test = |curve: &mut Self, solution: &Solution<AlgebraicPoint>| {
            curve.test(kind, solution).map(|reading| reading.value)
        };
        if self.own_test(kind).is_none() && kind != SpecialKind::Fold {
            return Ok(Location::Missed);
        }
        locate_by_defining_system(self, between, &settings, test, |curve, near| match curve.own_test(kind) {
            Some(own) => (own.locate)(near),
            None => fold_near(&curve.system.problem, &near.unknown, &near.tangent, &curve.system.scales),
        })
    }

    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)> {
        let states = unknown.iter().copied().zip(self.system.scales.iter().copied());
        states.take(unknown.len() - 1).collect()
    }
}
