//! Asking for a curve of special equilibria.

use super::branch::{EquilibriumLocusBranch, LocusPoint};
use super::curve::{EquilibriumLocusInspection, LocusCurve};
use super::held::Held;
use super::held_equilibria::HeldSystem;
use super::request::{TwoParameters, point_forward};
use super::system::LocusSystem;
use crate::algebraic::Differentiator;
use crate::algebraic::scales::natural_scales;
use crate::branch::{
    Branch, Continuation, Label, Problem, SpecialKind, check_length, invalid, observer, request,
};
use crate::continuation::events::around_start;
use crate::continuation::{
    BothWays, Observer, Request, Settings, Solution, Stop, both_ways, correct, exact_start, follow,
    metric_image,
};
use crate::equilibrium::defining::{BranchPointSystem, FoldSystem, HopfSystem};
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::{BranchPoint, FoldPoint, HopfPoint, equilibrium_settings};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use crate::linear::eigenvectors::left_eigenvector;
use num_complex::Complex64;
use std::convert::Infallible;

/// Part of its range by which a parameter may lie outside by rounding where the curve starts.
const START_ROUNDING: f64 = 1e-12;

/// Where a curve of special equilibria starts.
#[derive(Clone, Debug)]
pub enum EquilibriumLocusStart {
    /// A fold.
    Fold(Box<FoldPoint>),
    /// A Hopf point.
    Hopf(Box<HopfPoint>),
    /// A branch point.
    BranchPoint(Box<BranchPoint>),
    /// Any equilibrium, a state with all parameters, on which a quantity keeps its value.
    Held(Held<[f64]>, Vec<f64>, Vec<f64>),
}

impl EquilibriumLocusStart {
    /// What the curve consists of; `None` for any equilibria.
    fn kind(&self) -> Option<SpecialKind> {
        match self {
            Self::Fold(_) => Some(SpecialKind::Fold),
            Self::Hopf(_) => Some(SpecialKind::Hopf),
            Self::BranchPoint(_) => Some(SpecialKind::BranchPoint),
            Self::Held(..) => None,
        }
    }

    /// The state and all parameters.
    fn equilibrium(&self) -> (&[f64], &[f64]) {
        match self {
            Self::Fold(point) => (&point.state, &point.parameters),
            Self::Hopf(point) => (&point.state, &point.parameters),
            Self::BranchPoint(point) => (&point.state, &point.parameters),
            Self::Held(_, state, parameters) => (state, parameters),
        }
    }
}

impl Problem for Option<EquilibriumLocusStart> {
    type Point = LocusPoint;

    fn settings() -> Settings {
        equilibrium_settings()
    }
}

/// A curve of folds, Hopf points or branch points of equilibria, or of any equilibria on which a quantity keeps its value, followed both ways from one of them while two parameters
/// vary over ranges.
///
/// ```
/// use arclength::{Scalar, VectorField, equilibrium::Equilibria};
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
/// let folds = fold.curve(&Cusp).along("a", -2.0..=2.0).and("b", -1.0..=2.0).run()?;
/// let cusp = folds.special_points().next().expect("a cusp");
/// assert!(cusp.values.iter().all(|value| value.abs() < 1e-12));
/// # Ok::<(), arclength::Error>(())
/// ```
pub type EquilibriumLocus<'a> = Continuation<'a, Option<EquilibriumLocusStart>>;

impl FoldPoint {
    /// The curve of folds through this one, in two parameters.
    pub fn curve<'a, F: VectorField>(&self, field: &'a F) -> EquilibriumLocus<'a> {
        EquilibriumLocus::of(field).from_fold(self)
    }
}

impl HopfPoint {
    /// The curve of Hopf points through this one, in two parameters.
    pub fn curve<'a, F: VectorField>(&self, field: &'a F) -> EquilibriumLocus<'a> {
        EquilibriumLocus::of(field).from_hopf(self)
    }
}

impl BranchPoint {
    /// The curve of branch points through this one, in two parameters. There is one only if branch points persist, by symmetry or because
    /// a state stays zero.
    pub fn curve<'a, F: VectorField>(&self, field: &'a F) -> EquilibriumLocus<'a> {
        EquilibriumLocus::of(field).from_branch_point(self)
    }
}

type FollowedLocus = BothWays<EquilibriumLocusInspection, SpecialKind, Infallible>;

impl<'a> EquilibriumLocus<'a> {
    /// A curve of special equilibria of `field`.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self::of_erased(field.erased(), None)
    }

    /// Starts at a fold.
    pub fn from_fold(mut self, fold: &FoldPoint) -> Self {
        self.start = Some(EquilibriumLocusStart::Fold(Box::new(fold.clone())));
        self
    }

    /// Starts at a Hopf point. The curve goes on through Bogdanov-Takens points as one of neutral saddles.
    pub fn from_hopf(mut self, hopf: &HopfPoint) -> Self {
        self.start = Some(EquilibriumLocusStart::Hopf(Box::new(hopf.clone())));
        self
    }

    /// Starts at a branch point. There is a curve only if branch points persist, by symmetry or because a state stays zero.
    pub fn from_branch_point(mut self, branch_point: &BranchPoint) -> Self {
        self.start = Some(EquilibriumLocusStart::BranchPoint(Box::new(branch_point.clone())));
        self
    }

    /// Starts at any equilibrium, with all parameters there, and follows the equilibria on which a quantity keeps its value.
    pub fn from_held_equilibrium(mut self, held: Held<[f64]>, state: &[f64], parameters: &[f64]) -> Self {
        self.start = Some(EquilibriumLocusStart::Held(held, state.to_vec(), parameters.to_vec()));
        self
    }

    /// Follows the curve.
    ///
    /// # Errors
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when the curve cannot be started. What
    /// goes wrong later ends the curve with a [`Stop`](crate::continuation::Stop).
    pub fn run(mut self) -> Result<EquilibriumLocusBranch, Error> {
        let (active, bounds) = self.active(2)?;
        let start = self.start.clone();
        let start = start.ok_or_else(|| {
            invalid(
                "start",
                "nothing",
                "a fold, a Hopf point, a branch point or an equilibrium with a held quantity",
            )
        })?;
        let (state, parameters) = start.equilibrium();
        let n = self.field.dimension();
        let names = self.field.parameter_names();
        check_length("state of the start", state, n, "the dimension of the field")?;
        check_length("parameters of the start", parameters, names.len(), "the number of parameters")?;
        let asked = TwoParameters::checked(&active, &bounds, &names, parameters)?;
        // The branch point's own parameter is the one along which the branches cross; where it is not varied one of the two is, and
        // they may not cross along the other.
        let own = match &start {
            EquilibriumLocusStart::BranchPoint(point) => Some(point.active),
            _ => None,
        };
        match own {
            Some(own) if own == asked.active[1] => self.run_in_order(&start, asked.swapped(), &active),
            Some(own) if own != asked.active[0] => self
                .run_in_order(&start, asked, &active)
                .or_else(|_| self.run_in_order(&start, asked.swapped(), &active)),
            _ => self.run_in_order(&start, asked, &active),
        }
    }

    /// Follows the curve with the parameters in an order.
    fn run_in_order(
        &mut self,
        start: &EquilibriumLocusStart,
        ordered: TwoParameters,
        active: &[usize],
    ) -> Result<EquilibriumLocusBranch, Error> {
        let (state, parameters) = start.equilibrium();
        let n = state.len();
        let run =
            Run { field: self.field, parameters: parameters.to_vec(), ordered, settings: self.settings };

        let Continuation { at, monitors, observer: told, settings, .. } = self;
        let bare = |solution: &Solution<EquilibriumLocusInspection>| {
            LocusPoint::new(solution, None, (n, ordered.swapped))
        };
        let point = |solution: &Solution<EquilibriumLocusInspection>, label: Option<Label>| {
            let mut point = LocusPoint::new(solution, label, (n, ordered.swapped));
            point.monitors =
                monitors.iter().map(|monitor| monitor.value(&point).unwrap_or(f64::NAN)).collect();
            point
        };
        let request = request(&ordered.bounds, at, monitors, *settings, &bare);
        let mut observe = observer(told.as_mut().map(|told| &mut **told as _), &point);
        let mut followed = run.from(start, state, &request, &mut *observe)?;
        drop(observe);
        followed.mark_requested(at, |solution| ordered.bounds[0].value(&solution.unknown));
        let place = (&run.parameters[..], active);
        let branch = Branch::assemble(&run.field, place, followed, |solution, label| point(&solution, label));
        Ok(Branch { kind: start.kind(), ..branch })
    }
}

/// A checked request.
struct Run<'a> {
    field: ErasedField<'a>,
    parameters: Vec<f64>,
    ordered: TwoParameters,
    settings: Settings,
}

impl<'a> Run<'a> {
    fn from(
        &self,
        start: &EquilibriumLocusStart,
        state: &[f64],
        request: &Request<'_, EquilibriumLocusInspection>,
        observer: &mut Observer<'_, EquilibriumLocusInspection, SpecialKind>,
    ) -> Result<FollowedLocus, Error> {
        let n = state.len();
        let ranges = self.ordered.ranges();
        let equilibria = EquilibriumProblem::new(self.field, &self.parameters, &self.ordered.active);
        let values = self.ordered.active.map(|index| self.parameters[index]);
        let point = [state, &values].concat();
        let mut jacobian = vec![0.0; n * (n + 2)];
        let mut residual = vec![0.0; n];
        Differentiator::default().jacobian(&equilibria, &point, &mut residual, &mut jacobian, n);
        let speed: Vec<f64> = (0..n)
            .map(|row| {
                (jacobian[row + n * n] * ranges[0]).abs() + (jacobian[row + n * (n + 1)] * ranges[1]).abs()
            })
            .collect();
        let matrix = &jacobian[..n * n];
        let scales = natural_scales(&self.field, state, &self.parameters, &speed);
        match start {
            EquilibriumLocusStart::Fold(fold) => {
                check_length("null vector", &fold.null_vector, n, "the dimension of the field")?;
                let unknown = [state, &fold.null_vector, &values].concat();
                let kind = FoldSystem { equilibria, normal: fold.null_vector.clone(), left: Vec::new() };
                self.follow(LocusSystem::Fold(kind), unknown, scales, request, observer)
            }
            EquilibriumLocusStart::Hopf(hopf) => {
                let pair = [1.0, -1.0].map(|sign| Complex64::new(0.0, sign * hopf.frequency));
                let (kind, unknown) = HopfSystem::from_pair(equilibria, &point, matrix, pair, &scales)?
                    .ok_or_else(|| Error::Invalid {
                        name: "frequency of the Hopf point".into(),
                        value: hopf.frequency.to_string(),
                        allowed: "a positive number".into(),
                    })?;
                self.follow(LocusSystem::Hopf(kind), unknown, scales, request, observer)
            }
            EquilibriumLocusStart::BranchPoint(_) => {
                let failed = |_| Error::Eigenvalues { quantity: "null vector of the branch point" };
                let left = left_eigenvector(matrix, n, Complex64::ZERO).map_err(failed)?.vector;
                let left: Vec<f64> = left.iter().map(|entry| entry.re).collect();
                let unknown = [state, &left, &[0.0], &values].concat();
                let kind = BranchPointSystem { equilibria, normal: left, scales: scales.clone(), rate: 1.0 };
                self.follow(LocusSystem::BranchPoint(kind), unknown, scales, request, observer)
            }
            EquilibriumLocusStart::Held(held, ..) => {
                let value = held.value().or_else(|| held.of(state, &self.parameters)).ok_or_else(|| {
                    invalid(
                        held.name(),
                        "a quantity without a value where the curve starts",
                        "one that has a value",
                    )
                })?;
                let sizes = [&scales[..], &ranges].concat();
                let held = HeldSystem { equilibria, held: held.clone(), value, sizes, fastest: 0.0 };
                let kind = LocusSystem::Held(held);
                let unknown = self.with_held_value(&kind, point, &scales)?;
                self.follow(kind, unknown, scales, request, observer)
            }
        }
    }

    /// The equilibrium near the start on which the quantity to be held has its value, with one of the parameters fixed where
    /// that is possible, and both inside their ranges.
    fn with_held_value(
        &self,
        kind: &LocusSystem<'a>,
        start: Vec<f64>,
        scales: &[f64],
    ) -> Result<Vec<f64>, Error> {
        const SOUGHT: &str = "equilibrium on which the quantity to be held has its value";
        let mut curve = LocusCurve::new(kind.clone(), scales.to_vec(), self.ordered.ranges(), self.settings);
        let bounds = &self.ordered.bounds;
        let is_inside =
            |unknown: &[f64]| bounds.iter().all(|bound| bound.holds(bound.value(unknown), START_ROUNDING));
        let fixed = [1, 2].map(|from_end| {
            let mut border = vec![0.0; start.len()];
            border[start.len() - from_end] = 1.0;
            border
        });
        // At a fold on the curve neither parameter may be fixed: across the curve, then.
        let across = curve.system.tangent(&start).map(|tangent| metric_image(&curve, &tangent)).ok();
        let mut failure = None;
        for border in fixed.into_iter().chain(across) {
            let mut unknown = start.clone();
            match correct(&mut curve, &mut unknown, &border, &self.settings) {
                Ok(_) if is_inside(&unknown) => return Ok(unknown),
                Ok(_) => {
                    failure = Some(invalid(
                        "start",
                        &format!("{SOUGHT}, outside the ranges"),
                        "one inside the ranges of both parameters",
                    ));
                }
                Err(cause) => failure = failure.or(Some(Error::NotFound { sought: SOUGHT, cause })),
            }
        }
        Err(failure.unwrap_or(Error::Eigenvalues { quantity: "eigenvalues" }))
    }

    fn follow(
        &self,
        kind: LocusSystem<'a>,
        mut unknown: Vec<f64>,
        scales: Vec<f64>,
        request: &Request<'_, EquilibriumLocusInspection>,
        observer: &mut Observer<'_, EquilibriumLocusInspection, SpecialKind>,
    ) -> Result<FollowedLocus, Error> {
        let ranges = self.ordered.ranges();
        let mut curve = LocusCurve::new(kind, scales, ranges, self.settings);
        curve.renormalize(&mut unknown, &mut [])?;
        let mut tangent = curve.system.tangent(&unknown)?;
        let normalised = curve.system.problem.clone();
        point_forward(&mut tangent, ranges);
        let directions = both_ways(|sign| {
            if sign < 0.0 {
                // The normalisations and sizes have moved on: back to those of the start.
                curve.system.problem = normalised.clone();
                curve.restart();
                curve.renormalize(&mut unknown, &mut [&mut tangent])?;
                tangent.iter_mut().for_each(|entry| *entry = -*entry);
            }
            follow(&mut curve, unknown.clone(), tangent.clone(), request, observer)
        })?;
        let first = [0, 1].map(|side: usize| directions[side].first.clone());
        let is_closed = matches!(directions[1].stop, Stop::Closed);
        let mut followed = BothWays::join(directions, None);
        curve.system.problem = normalised;
        curve.renormalize(&mut unknown, &mut [&mut tangent])?;
        if !is_closed {
            tangent.iter_mut().for_each(|entry| *entry = -*entry);
        }
        let start = exact_start(&mut curve, unknown, tangent, request)?;
        let events = around_start(&mut curve, &start, first, &request.bounds, &self.settings)?;
        followed.insert_at_start(&curve, events);
        Ok(followed)
    }
}
