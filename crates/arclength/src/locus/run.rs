//! Asking for a curve of special equilibria.

use super::branch::EquilibriumLocusBranch;
use super::curve::{Inspection, LocusCurve};
use super::kind::LocusKind;
use super::request::{Range, TwoParameters, invalid, point_forward};
use crate::algebraic::Differentiator;
use crate::algebraic::scales::natural_scales;
use crate::continuation::{Followed, Request, Settings, Solution, Stop, follow};
use crate::equilibrium::defining::{BranchPointSystem, FoldSystem, HopfSystem};
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::{BranchPoint, FoldPoint, HopfPoint, check_length, equilibrium_settings};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use crate::linear::eigenvectors::left_eigenvector;
use num_complex::Complex64;
use std::ops::{ControlFlow, RangeInclusive};

/// Is told the two parameter values and the state of every point of a curve, and may end a direction.
pub type LocusObserver<'o> = dyn FnMut([f64; 2], &[f64]) -> ControlFlow<()> + 'o;

/// Where a curve starts.
#[derive(Clone, Debug)]
enum Start {
    Fold(FoldPoint),
    Hopf(HopfPoint),
    BranchPoint(BranchPoint),
}

/// A curve of folds, Hopf points or branch points of equilibria, followed both ways from one of them while two parameters
/// vary over ranges.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::Equilibria, locus::EquilibriumLocus};
/// struct Cusp;
/// impl VectorField for Cusp {
///     fn state_names(&self) -> Vec<String> { vec!["x".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["a".into(), "b".into()] }
///     fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], derivative: &mut [T]) {
///         derivative[0] = p[0] + p[1] * x[0] - x[0].powi(3);
///     }
/// }
/// let branch = Equilibria::of(&Cusp).start(&[-2.0]).parameters(&[-2.0, 1.0]).along("a", -2.0..=2.0).run()?;
/// let fold = branch.folds().next().expect("a fold");
/// let folds = EquilibriumLocus::of(&Cusp).from_fold(fold).along("a", -2.0..=2.0).and("b", -1.0..=2.0).run()?;
/// let cusp = folds.special_points().next().expect("a cusp");
/// assert!(cusp.values.iter().all(|value| value.abs() < 1e-12));
/// # Ok::<(), arclength::Error>(())
/// ```
#[derive(Debug)]
pub struct EquilibriumLocus<'a> {
    field: ErasedField<'a>,
    start: Option<Start>,
    along: [Option<Range>; 2],
    at: Vec<f64>,
    settings: Settings,
}

impl<'a> EquilibriumLocus<'a> {
    /// A curve of special equilibria of `field`.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self::of_erased(ErasedField::of(field))
    }

    pub(super) fn of_erased(field: ErasedField<'a>) -> Self {
        Self { field, start: None, along: [None, None], at: Vec::new(), settings: equilibrium_settings() }
    }

    /// Starts at a fold.
    pub fn from_fold(mut self, fold: &FoldPoint) -> Self {
        self.start = Some(Start::Fold(fold.clone()));
        self
    }

    /// Starts at a Hopf point. The curve goes on through Bogdanov-Takens points as one of neutral saddles.
    pub fn from_hopf(mut self, hopf: &HopfPoint) -> Self {
        self.start = Some(Start::Hopf(hopf.clone()));
        self
    }

    /// Starts at a branch point. There is a curve only if branch points persist, by symmetry or because a state stays zero.
    pub fn from_branch_point(mut self, branch_point: &BranchPoint) -> Self {
        self.start = Some(Start::BranchPoint(branch_point.clone()));
        self
    }

    /// The first parameter and its range.
    pub fn along(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.along[0] = Some((parameter.to_owned(), range));
        self
    }

    /// The second parameter and its range.
    pub fn and(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.along[1] = Some((parameter.to_owned(), range));
        self
    }

    /// Values of the first parameter at which points are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// Step control and tolerances.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Follows the curve.
    ///
    /// # Errors
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when the curve cannot be started. What
    /// goes wrong later ends the curve with a [`Stop`].
    pub fn run(self) -> Result<EquilibriumLocusBranch, Error> {
        self.observed(&mut |_, _| ControlFlow::Continue(()))
    }

    /// As [`run`](Self::run); `observer` is told the two parameter values and the state of every point and may end a direction.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn observed(self, observer: &mut LocusObserver<'_>) -> Result<EquilibriumLocusBranch, Error> {
        let Some(start) = &self.start else {
            return Err(invalid("start", "nothing", "a fold, a Hopf point or a branch point"));
        };
        let (state, parameters) = match start {
            Start::Fold(point) => (&point.state, &point.parameters),
            Start::Hopf(point) => (&point.state, &point.parameters),
            Start::BranchPoint(point) => (&point.state, &point.parameters),
        };
        check_length("state of the start", state, self.field.dimension(), "the dimension of the field")?;
        let asked = TwoParameters::checked(&self.field, &self.along, parameters)?;
        // The branch point's own parameter is the one along which the branches cross.
        let swapped = matches!(start, Start::BranchPoint(point) if point.active == asked.active[1]);
        let ordered = if swapped { asked.swapped() } else { asked };
        let run = Run {
            field: self.field,
            parameters: parameters.clone(),
            active: ordered.active,
            swapped,
            request: Request {
                bounds: ordered.bounds.to_vec(),
                values: self.at.clone(),
                settings: self.settings,
            },
            ranges: ordered.ranges(),
        };
        run.from(start, state, observer)
    }
}

/// A checked request.
struct Run<'a> {
    field: ErasedField<'a>,
    parameters: Vec<f64>,
    /// Parameters in the order of the unknowns.
    active: [usize; 2],
    /// Whether that order is not the order in which they were asked for.
    swapped: bool,
    request: Request,
    ranges: [f64; 2],
}

impl<'a> Run<'a> {
    fn from(
        &self,
        start: &Start,
        state: &[f64],
        observer: &mut LocusObserver<'_>,
    ) -> Result<EquilibriumLocusBranch, Error> {
        let n = state.len();
        let equilibria = EquilibriumProblem::new(self.field, &self.parameters, &self.active);
        let values = self.active.map(|index| self.parameters[index]);
        let point = [state, &values].concat();
        let mut jacobian = vec![0.0; n * (n + 2)];
        let mut residual = vec![0.0; n];
        Differentiator::default().jacobian(&equilibria, &point, &mut residual, &mut jacobian, n);
        let speed: Vec<f64> = (0..n)
            .map(|row| {
                (jacobian[row + n * n] * self.ranges[0]).abs()
                    + (jacobian[row + n * (n + 1)] * self.ranges[1]).abs()
            })
            .collect();
        let matrix = &jacobian[..n * n];
        let scales = natural_scales(&self.field, state, &self.parameters, &speed);
        match start {
            Start::Fold(fold) => {
                check_length("null vector", &fold.null_vector, n, "the dimension of the field")?;
                let unknown = [state, &fold.null_vector, &values].concat();
                let kind = FoldSystem { equilibria, normal: fold.null_vector.clone(), left: Vec::new() };
                self.follow(kind, unknown, scales, observer)
            }
            Start::Hopf(hopf) => {
                let pair = [1.0, -1.0].map(|sign| Complex64::new(0.0, sign * hopf.frequency));
                let (kind, unknown) = HopfSystem::from_pair(equilibria, &point, matrix, pair, &scales)?
                    .ok_or_else(|| Error::Invalid {
                        name: "frequency of the Hopf point".into(),
                        value: hopf.frequency.to_string(),
                        allowed: "a positive number".into(),
                    })?;
                self.follow(kind, unknown, scales, observer)
            }
            Start::BranchPoint(_) => {
                let failed = |_| Error::Eigenvalues { quantity: "null vector of the branch point" };
                let left = left_eigenvector(matrix, n, Complex64::ZERO).map_err(failed)?.vector;
                let left: Vec<f64> = left.iter().map(|entry| entry.re).collect();
                let unknown = [state, &left, &[0.0], &values].concat();
                let kind = BranchPointSystem { equilibria, normal: left, scales: scales.clone(), rate: 1.0 };
                self.follow(kind, unknown, scales, observer)
            }
        }
    }

    fn follow<K: LocusKind<'a> + Clone>(
        &self,
        kind: K,
        mut unknown: Vec<f64>,
        scales: Vec<f64>,
        observer: &mut LocusObserver<'_>,
    ) -> Result<EquilibriumLocusBranch, Error> {
        let n = scales.len();
        let mut curve = LocusCurve::new(kind, scales, self.ranges, self.request.settings);
        curve.renormalize(&mut unknown, &mut [])?;
        let mut tangent = curve.system.tangent(&unknown)?;
        let normalised = curve.system.problem.clone();
        point_forward(&mut tangent, self.ranges);
        let ordered =
            |values: &[f64]| if self.swapped { [values[1], values[0]] } else { [values[0], values[1]] };
        let mut observe = |solution: &Solution<Inspection>| {
            observer(ordered(&solution.unknown[solution.unknown.len() - 2..]), &solution.unknown[..n])
        };
        let forward = follow(&mut curve, unknown.clone(), tangent.clone(), &self.request, &mut observe)?;
        let backward = if matches!(forward.stop, Stop::Closed) {
            Followed { solutions: Vec::new(), stop: Stop::Closed }
        } else {
            // The normalisations have moved on: back to those of the start.
            curve.system.problem = normalised;
            curve.renormalize(&mut unknown, &mut [&mut tangent])?;
            tangent.iter_mut().for_each(|entry| *entry = -*entry);
            follow(&mut curve, unknown, tangent, &self.request, &mut observe)?
        };
        let mut directions = [backward, forward];
        if self.swapped {
            for followed in &mut directions {
                for (solution, _) in &mut followed.solutions {
                    let end = solution.unknown.len() - 2;
                    solution.unknown.swap(end, end + 1);
                    if let Some(special) = &mut solution.point.special {
                        special.values.swap(0, 1);
                        special.location_error.swap(0, 1);
                        special.active.swap(0, 1);
                    }
                }
            }
        }
        let active = if self.swapped { [self.active[1], self.active[0]] } else { self.active };
        Ok(EquilibriumLocusBranch::assemble(K::KIND, self.field, self.parameters.clone(), active, directions))
    }
}
