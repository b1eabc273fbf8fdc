//! Asking for a curve of special cycles.

use super::branch::{CycleLocusBranch, UnlocatedChange};
use super::curve::{CycleLocusCurve, Inspection, sizes_of_resting};
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::continuation::{Followed, Origin, Request, Settings, Solution, Stop, correct, finish, follow};
use crate::cycle::curve::CycleCurve;
use crate::cycle::defining::Kind;
use crate::cycle::eigenfunctions::critical;
use crate::cycle::floquet::floquet;
use crate::cycle::limit_cycle::LimitCycle;
use crate::cycle::locating::{DefiningCurve, join};
use crate::cycle::sizes::StateSizes;
use crate::cycle::{Orbit, Resolution};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use crate::locus::LocusObserver;
use crate::locus::request::{Range, TwoParameters, invalid, point_forward};
use std::ops::{ControlFlow, RangeInclusive};

/// A curve of folds, period doublings or torus bifurcations of cycles, followed both ways from one of them while two
/// parameters vary over ranges.
///
/// ```
/// use arclength::branch::SpecialKind;
/// use arclength::cycle::{CycleStart, Cycles, Special};
/// use arclength::locus::CycleLocus;
/// use arclength::{Scalar, VectorField};
/// use num_complex::Complex64;
///
/// /// Circles of radius s with a + b s^2 - s^4 = 0: folds at a = -b^2/4.
/// struct Bautin;
/// impl VectorField for Bautin {
///     fn state_names(&self) -> Vec<String> { vec!["x".into(), "y".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["a".into(), "b".into()] }
///     fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
///         let square = s[0] * s[0] + s[1] * s[1];
///         let growth = p[0] + p[1] * square - square * square;
///         d[0] = growth * s[0] - s[1];
///         d[1] = s[0] + growth * s[1];
///     }
/// }
///
/// let half = 0.5_f64.sqrt();
/// let start = CycleStart::Hopf {
///     state: vec![0.0; 2],
///     frequency: 1.0,
///     eigenvector: vec![Complex64::new(half, 0.0), Complex64::new(0.0, -half)],
///     crossing_speed: 1.0,
///     cubic_coefficient: 1.0,
/// };
/// let branch = Cycles::of(&Bautin, start).parameters(&[0.0, 1.0]).along(0, -1.0..=1.0).run()?;
/// let (_, fold) = branch.special_points().find(|(special, _)| *special == Special::Fold).unwrap();
/// let folds = CycleLocus::of(&Bautin)
///     .from_cycle(SpecialKind::FoldOfCycles, &fold.orbit, &[fold.value, 1.0])
///     .along("a", -1.0..=1.0)
///     .and("b", 0.5..=1.5)
///     .run()?;
/// assert!(folds.points.iter().all(|point| (point.values[0] + 0.25 * point.values[1].powi(2)).abs() < 1e-8));
/// # Ok::<(), arclength::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CycleLocus<'a> {
    pub(super) field: ErasedField<'a>,
    pub(super) start: Option<(SpecialKind, Orbit, Vec<f64>)>,
    pub(super) along: [Option<Range>; 2],
    pub(super) at: Vec<f64>,
    pub(super) resolution: Resolution,
    pub(super) settings: Settings,
}

impl<'a> CycleLocus<'a> {
    /// A curve of special cycles of `field`.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self {
            field: ErasedField::of(field),
            start: None,
            along: [None, None],
            at: Vec::new(),
            resolution: Resolution::default(),
            settings: Settings::default(),
        }
    }

    /// Starts at a special cycle: a fold (`FoldOfCycles`), a period doubling or a torus bifurcation, with all parameters there.
    pub fn from_cycle(mut self, kind: SpecialKind, orbit: &Orbit, parameters: &[f64]) -> Self {
        self.start = Some((kind, orbit.clone(), parameters.to_vec()));
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

    /// Values of the first parameter at which cycles are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// Resolution of the cycles and their eigenfunctions.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
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
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when there is no special cycle of that
    /// kind near the start. What goes wrong later ends the curve with a [`Stop`].
    pub fn run(self) -> Result<CycleLocusBranch, Error> {
        self.observed(&mut |_, _| ControlFlow::Continue(()))
    }

    /// As [`run`](Self::run); `observer` is told the two parameter values and the period of every cycle and may end a
    /// direction.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn observed(self, observer: &mut LocusObserver<'_>) -> Result<CycleLocusBranch, Error> {
        let Some((special, orbit, parameters)) = &self.start else {
            return Err(invalid("start", "nothing", "a special cycle"));
        };
        let kind = match special {
            SpecialKind::FoldOfCycles => Kind::Fold,
            SpecialKind::PeriodDoubling => Kind::Doubling,
            SpecialKind::Torus => Kind::Torus,
            other => {
                return Err(invalid(
                    "start",
                    other.name(),
                    "fold of cycles, period doubling, torus bifurcation",
                ));
            }
        };
        orbit.check(self.field.dimension())?;
        let asked = TwoParameters::checked(&self.field, &self.along, parameters)?;
        let TwoParameters { active, bounds } = asked;
        let ranges = asked.ranges();
        let request = Request { bounds: bounds.to_vec(), values: self.at.clone(), settings: self.settings };
        let (mut curve, unknown) = self.start(kind, orbit, parameters, active, ranges)?;
        let (unknown, mut tangent) = self.first(&mut curve, unknown)?;
        point_forward(&mut tangent, ranges);
        let scalars = 3 + kind.own_scalars();
        let mut observe = |solution: &Solution<Inspection>| {
            let end = solution.unknown.len();
            let values = [solution.unknown[end - 2], solution.unknown[end - 1]];
            observer(values, &solution.unknown[end - scalars..=end - scalars])
        };
        let degree = orbit.degree;
        let mut unlocated = Vec::new();
        let mut forward = follow(&mut curve, unknown.clone(), tangent.clone(), &request, &mut observe)?;
        close(&mut forward, &mut curve, &mut unlocated);
        let backward = if matches!(forward.stop, Stop::Closed) {
            Followed { solutions: Vec::new(), stop: Stop::Closed }
        } else {
            // Mesh and sizes have moved on: back to those of the start.
            let (mut curve, start) = self.start(kind, orbit, parameters, active, ranges)?;
            let (unknown, mut backward) = self.first(&mut curve, start)?;
            let product: f64 = backward.iter().zip(&tangent).map(|(a, b)| a * b).sum();
            if product > 0.0 {
                backward.iter_mut().for_each(|entry| *entry = -*entry);
            }
            let mut followed = follow(&mut curve, unknown, backward, &request, &mut observe)?;
            close(&mut followed, &mut curve, &mut unlocated);
            followed
        };
        let mut branch = CycleLocusBranch::assemble(*special, active, degree, [backward, forward], unlocated);
        self.solve_for_ends(&mut branch, parameters, ranges);
        Ok(branch)
    }

    /// The curve and an approximate first solution.
    fn start(
        &self,
        kind: Kind,
        orbit: &Orbit,
        parameters: &[f64],
        active: [usize; 2],
        ranges: [f64; 2],
    ) -> Result<(CycleLocusCurve<'a>, Vec<f64>), Error> {
        let mut cycle = orbit.states.clone();
        cycle.extend([orbit.period, parameters[active[0]]]);
        let problem = LimitCycle {
            field: self.field,
            parameters: parameters.to_vec(),
            active: active[0],
            scales: vec![1.0; orbit.dimension],
        };
        let collocation = Collocation::new(problem, orbit.mesh.clone(), orbit.degree);
        let sizes = StateSizes::new(&collocation.problem, &cycle);
        let mut base = CycleCurve::new(collocation, self.resolution, ranges[0], &cycle).collocation;
        let least = sizes_of_resting(&sizes, &orbit.states);
        for (scale, least) in base.problem.scales.iter_mut().zip(&least) {
            *scale = scale.max(*least);
        }
        let mut border = vec![0.0; cycle.len()];
        border[cycle.len() - 1] = 1.0;
        let mut residual = vec![0.0; cycle.len()];
        base.factorize(&cycle, &border, &mut residual);
        let multipliers = floquet(&base, &cycle, &base.problem.scales, &mut None)?.multipliers();
        let none = Error::Invalid {
            name: "start".into(),
            value: "a cycle without a critical multiplier".into(),
            allowed: "a special cycle".into(),
        };
        let eigenfunctions = critical(&mut base, &cycle, &multipliers, kind)?.ok_or(none)?;
        let mut unknown = join(&cycle, orbit.dimension, &eigenfunctions);
        if let Some(last) = unknown.last_mut() {
            *last = parameters[active[1]];
        }
        let nodes = (orbit.mesh.clone(), orbit.degree);
        let system = DefiningCurve::new(&base.problem, kind, nodes, (Some(active[1]), ranges), &unknown);
        let control = (self.resolution, self.settings);
        Ok((CycleLocusCurve::new(system, base, sizes, active[1], control, least), unknown))
    }

    /// The first solution, corrected with one of the parameters fixed, and the tangent there.
    fn first(&self, curve: &mut CycleLocusCurve<'a>, start: Vec<f64>) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let mut failure = None;
        for fixed in [1, 2] {
            let mut unknown = start.clone();
            let mut border = vec![0.0; unknown.len()];
            let place = unknown.len() - fixed;
            border[place] = 1.0;
            match correct(curve, &mut unknown, &border, &self.settings) {
                Ok(_) => match finish(curve, unknown, &border) {
                    Ok(solution) => return Ok((solution.unknown, solution.tangent)),
                    Err(error) => failure = failure.or(Some(error)),
                },
                Err(cause) => failure = failure.or(Some(Error::NotFound { sought: "special cycle", cause })),
            }
        }
        Err(failure.unwrap_or(Error::Eigenvalues { quantity: "Floquet multipliers" }))
    }
}

/// Adds what the curve itself has noted to a run: solutions behind the last step, and what was not located.
fn close(
    followed: &mut Followed<Inspection>,
    curve: &mut CycleLocusCurve<'_>,
    unlocated: &mut Vec<UnlocatedChange>,
) {
    let last = std::mem::take(&mut curve.last);
    followed.solutions.extend(last.into_iter().map(|solution| {
        let origin = if solution.point.special.is_some() { Origin::Special } else { Origin::Step };
        (solution, origin)
    }));
    unlocated.append(&mut curve.unlocated);
}
