//! Asking for a curve of special cycles.

use super::branch::{CycleLocusBranch, CycleLocusPoint};
use super::curve::{CycleLocusCurve, CycleLocusInspection, sizes_of_resting};
use super::end::CycleLocusEnd;
use super::hold::Hold;
use crate::branch::{
    Branch, Continuation, Label, Labelled, Problem, SpecialKind, check_length, invalid, observer, request,
};
use crate::collocation::equations::Collocation;
use crate::continuation::events::around_start;
use crate::continuation::{
    BothWays, Observer, Request, START_ROUNDING, Settings, Solution, both_ways, correct, exact_start, finish,
    follow,
};
use crate::cycle::curve::CycleCurve;
use crate::cycle::defining::Kind;
use crate::cycle::eigenfunctions::critical;
use crate::cycle::floquet::floquet;
use crate::cycle::limit_cycle::LimitCycle;
use crate::cycle::locating::{DefiningCurve, join};
use crate::cycle::sizes::StateSizes;
use crate::cycle::{CyclePoint, Orbit, Resolution};
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use crate::locus::held::Held;
use crate::locus::request::{TwoParameters, point_forward};
use std::ops::RangeInclusive;

/// What a curve of special cycles starts from and how finely the cycles are resolved.
#[derive(Clone, Debug, Default)]
pub struct CycleLocusProblem {
    pub(super) start: Option<(Option<SpecialKind>, Orbit)>,
    pub(super) held: Option<Held>,
    pub(super) resolution: Resolution,
}

impl Problem for CycleLocusProblem {
    type Point = CycleLocusPoint;

    fn settings() -> Settings {
        Settings::default()
    }
}

/// A curve of folds, period doublings or torus bifurcations of cycles, followed both ways from one of them while two
/// parameters vary over ranges.
///
/// ```
/// use arclength::branch::SpecialKind;
/// use arclength::equilibrium::Equilibria;
/// use arclength::{Scalar, VectorField};
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
/// let equilibria = Equilibria::of(&Bautin).parameters(&[-1.0, 1.0]).along("a", -1.0..=1.0).run()?;
/// let hopf = equilibria.hopf_points().next().expect("a Hopf point");
/// let branch = hopf.cycles(&Bautin).along("a", -1.0..=1.0).run()?;
/// let fold = branch.of_kind(SpecialKind::FoldOfCycles).next().expect("a fold of cycles");
/// let folds = fold.curve(&Bautin).expect("a curve").along("a", -1.0..=1.0).and("b", 0.5..=1.5).run()?;
/// assert!(folds.points.iter().all(|point| (point.values[0] + 0.25 * point.values[1].powi(2)).abs() < 1e-8));
/// # Ok::<(), arclength::Error>(())
/// ```
pub type CycleLocus<'a> = Continuation<'a, CycleLocusProblem>;

impl CyclePoint {
    /// The curve of special cycles through this one, in two parameters: of folds, period doublings or torus bifurcations; `None` where it
    /// is none of them.
    pub fn curve<'a, F: VectorField>(&self, field: &'a F) -> Option<CycleLocus<'a>> {
        let kind = self.special_kind().filter(|kind| defining_system(*kind).is_some())?;
        Some(CycleLocus::of(field).from_cycle(kind, &self.orbit, &self.parameters))
    }
}

/// The equations that define special cycles of a kind, if they make curves.
fn defining_system(kind: SpecialKind) -> Option<Kind> {
    match kind {
        SpecialKind::FoldOfCycles => Some(Kind::Fold),
        SpecialKind::PeriodDoubling => Some(Kind::Doubling),
        SpecialKind::Torus => Some(Kind::Torus),
        _ => None,
    }
}

impl<'a> CycleLocus<'a> {
    /// A curve of special cycles of `field`.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self::of_erased(field.erased(), CycleLocusProblem::default())
    }

    /// Starts at a special cycle: a fold (`FoldOfCycles`), a period doubling or a torus bifurcation, with all parameters there.
    pub fn from_cycle(mut self, kind: SpecialKind, orbit: &Orbit, parameters: &[f64]) -> Self {
        self.start.start = Some((Some(kind), orbit.clone()));
        self.parameters(parameters)
    }

    /// Starts at any cycle, with all parameters there, and follows the cycles on which a quantity keeps its value. Along curves
    /// on which the period keeps a large value homoclinic orbits are followed (Doedel and Kernevez, 1986).
    pub fn from_held_cycle(mut self, held: Held, orbit: &Orbit, parameters: &[f64]) -> Self {
        self.start.start = Some((None, orbit.clone()));
        self.start.held = Some(held);
        self.parameters(parameters)
    }

    /// Resolution of the cycles and their eigenfunctions.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.start.resolution = resolution;
        self
    }

    /// Follows the curve.
    ///
    /// # Errors
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when there is no special cycle of that
    /// kind near the start. What goes wrong later ends the curve with a [`Stop`](crate::continuation::Stop).
    pub fn run(mut self) -> Result<CycleLocusBranch, Error> {
        let Some((special, orbit)) = self.start.start.clone() else {
            return Err(invalid("start", "nothing", "a special cycle"));
        };
        let kind = match special {
            None => Kind::Cycle,
            Some(special) => defining_system(special).ok_or_else(|| {
                invalid("start", special.name(), "fold of cycles, period doubling, torus bifurcation")
            })?,
        };
        let (active, bounds) = self.active(2)?;
        let names = self.field.parameter_names();
        let parameters = self.parameters.clone().unwrap_or_default();
        check_length("parameters of the start", &parameters, names.len(), "the number of parameters")?;
        orbit.check(self.field.dimension())?;
        self.start.resolution.validate()?;
        let orbit = orbit.with_degree(self.start.resolution.degree);
        let asked = Asked {
            field: self.field,
            two: TwoParameters::checked(&active, &bounds, &names, &parameters)?,
            held: self.start.held.clone(),
            parameters,
            along: self.ranges.clone(),
            resolution: self.start.resolution,
            settings: self.settings,
        };
        let Continuation { at, monitors, observer: told, settings, .. } = &mut self;
        let bare =
            |solution: &Solution<CycleLocusInspection>| CycleLocusPoint::new(solution, None, orbit.degree);
        let point = |solution: &Solution<CycleLocusInspection>, label: Option<Label>| {
            let mut point = CycleLocusPoint::new(solution, label, orbit.degree);
            point.monitors =
                monitors.iter().map(|monitor| monitor.value(&point).unwrap_or(f64::NAN)).collect();
            point
        };
        let request = request(&bounds, at, monitors, *settings, &bare);
        let mut observe = observer(told.as_mut().map(|told| &mut **told as _), &point);
        let mut followed = asked.follow(kind, &orbit, &request, &mut *observe)?;
        drop(observe);
        followed.mark_requested(at, |solution| bounds[0].value(&solution.unknown));
        let place = (&asked.parameters[..], &active[..]);
        let branch =
            Branch::assemble(&asked.field, place, followed, |solution, label| point(&solution, label));
        let mut branch = Branch { kind: special, ..branch };
        asked.solve_for_ends(&mut branch);
        Ok(branch)
    }
}

/// A checked request.
pub(super) struct Asked<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    /// What keeps its value, on a curve of any cycles.
    pub held: Option<Held>,
    pub two: TwoParameters,
    /// Names and ranges of the two parameters.
    pub along: Vec<(String, RangeInclusive<f64>)>,
    pub resolution: Resolution,
    pub settings: Settings,
}

impl<'a> Asked<'a> {
    fn follow(
        &self,
        kind: Kind,
        orbit: &Orbit,
        request: &Request<'_, CycleLocusInspection>,
        observer: &mut Observer<'_, CycleLocusInspection, SpecialKind>,
    ) -> Result<BothWays<CycleLocusInspection, SpecialKind, CycleLocusEnd>, Error> {
        let mut forward: Vec<f64> = Vec::new();
        let directions = both_ways(|sign| {
            // Mesh and sizes move on along the way: every direction begins with those of the start.
            let (mut curve, unknown) = self.start(kind, orbit)?;
            let (unknown, mut tangent) = self.first(&mut curve, unknown)?;
            if sign > 0.0 {
                point_forward(&mut tangent, self.two.ranges());
                forward.clone_from(&tangent);
            } else if tangent.iter().zip(&forward).map(|(a, b)| a * b).sum::<f64>() > 0.0 {
                tangent.iter_mut().for_each(|entry| *entry = -*entry);
            }
            follow(&mut curve, unknown, tangent, request, observer)
        })?;
        let first = [0, 1].map(|side: usize| directions[side].first.clone());
        let mut followed = BothWays::join(directions, None);
        let (mut curve, unknown) = self.start(kind, orbit)?;
        let (unknown, _) = self.first(&mut curve, unknown)?;
        let start = exact_start(&mut curve, unknown, forward, request)?;
        let events = around_start(&mut curve, &start, first, &request.bounds, &self.settings)?;
        followed.insert_at_start(&curve, events);
        Ok(followed)
    }

    /// The curve and an approximate first solution.
    fn start(&self, kind: Kind, orbit: &Orbit) -> Result<(CycleLocusCurve<'a>, Vec<f64>), Error> {
        let (active, ranges, parameters) = (self.two.active, self.two.ranges(), &self.parameters);
        let mut cycle = orbit.states.clone();
        cycle.extend([orbit.period, parameters[active[0]]]);
        let problem = LimitCycle {
            field: self.field,
            parameters: parameters.clone(),
            active: active[0],
            scales: vec![1.0; orbit.dimension],
            segments: None,
        };
        let collocation = Collocation::new(problem, orbit.mesh.clone(), orbit.degree);
        let sizes = StateSizes::new(&collocation.problem, &cycle, ranges[0]);
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
        let eigenfunctions = critical(&mut base, (&cycle, false), &multipliers, kind)?.ok_or(none)?;
        let mut unknown = join(&cycle, orbit.dimension, &eigenfunctions);
        if let Some(last) = unknown.last_mut() {
            *last = parameters[active[1]];
        }
        let nodes = (orbit.mesh.clone(), orbit.degree);
        let system = DefiningCurve::new(&base.problem, kind, nodes, (Some(active[1]), ranges), &unknown);
        let control = (self.resolution, self.settings);
        let mut curve = CycleLocusCurve::new(system, base, sizes, active[1], control, least);
        if let Some(held) = &self.held {
            let value = held.value().or_else(|| held.of(orbit, parameters)).ok_or_else(|| {
                invalid(
                    held.name(),
                    "a quantity without a value where the curve starts",
                    "one that has a value",
                )
            })?;
            curve.hold = Some(Hold::new(held.clone(), value));
        }
        Ok((curve, unknown))
    }

    /// The first solution inside the ranges, corrected with one of the parameters fixed, and the tangent there.
    fn first(&self, curve: &mut CycleLocusCurve<'a>, start: Vec<f64>) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let sought = match self.held {
            Some(_) => "cycle on which the quantity to be held has its value",
            None => "special cycle",
        };
        let mut failure = None;
        for fixed in [1, 2] {
            let mut unknown = start.clone();
            let mut border = vec![0.0; unknown.len()];
            let place = unknown.len() - fixed;
            border[place] = 1.0;
            match correct(curve, &mut unknown, &border, &self.settings) {
                Ok(_) => match finish(curve, unknown, &border) {
                    Ok(solution) if self.is_inside(&solution.unknown) => {
                        return Ok((solution.unknown, solution.tangent));
                    }
                    Ok(_) => failure = failure.or(Some(self.outside(sought))),
                    Err(error) => failure = failure.or(Some(error)),
                },
                Err(cause) => failure = failure.or(Some(Error::NotFound { sought, cause })),
            }
        }
        Err(failure.unwrap_or(Error::Eigenvalues { quantity: "Floquet multipliers" }))
    }

    /// Whether both parameters are inside their ranges, but for rounding.
    fn is_inside(&self, unknown: &[f64]) -> bool {
        self.two.bounds.iter().all(|bound| bound.holds(bound.value(unknown), START_ROUNDING))
    }

    fn outside(&self, sought: &str) -> Error {
        let ranges = self
            .along
            .iter()
            .map(|(name, range)| format!("{name} from {} to {}", range.start(), range.end()));
        let ranges: Vec<String> = ranges.collect();
        invalid(
            "start",
            &format!("{sought}, outside the ranges"),
            &format!("one inside {}", ranges.join(", ")),
        )
    }
}
