//! Asking for a branch of limit cycles: where it starts, how it is followed.

use super::borders::tell_borders_apart;
use super::branch::{CycleBranch, CyclePoint, FollowedParameter};
use super::curve::{Birth, CycleCurve, CycleInspection};
use super::end::CycleEnd;
use super::expansion::Expansion;
use super::floquet::UnstableCount;
use super::hopf_start::HopfStart;
use super::limit_cycle::LimitCycle;
use super::orbit::Orbit;
use super::switching::{Branching, Departure};
use crate::algebraic::Differentiator;
use crate::algebraic::scales::natural_scales_along;
use crate::branch::{
    Branch, Continuation, Criticality, Label, Problem, SpecialKind, invalid, observer, request,
};
use crate::collocation::equations::Collocation;
use crate::collocation::resolution::Resolution;
use crate::continuation::events::around_start;
use crate::continuation::{
    BothWays, Bound, Curve, Equations, Followed, Observer, Origin, Request, START_ROUNDING, Settings,
    Solution, Stop, both_ways, exact_start, follow,
};
use crate::equilibrium::HopfPoint;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::spectrum::without;
use crate::erased::ErasedField;
use crate::error::{CorrectionFailure, Error};
use crate::field::VectorField;
use crate::linear::eigenvalues::eigenvalues;
use num_complex::Complex64;

/// Distance of the first cycle of a new branch from the bifurcation, as part of the size of the cycle there.
const FIRST_DISTANCE: f64 = 0.02;
/// Times that this distance is reduced before a start is given up.
const MOST_REDUCTIONS: usize = 6;
/// Reductions of the first amplitude next to a Hopf point, and of that distance.
const AMPLITUDE_REDUCTION: f64 = 0.25;
const DISTANCE_REDUCTION: f64 = 0.5;

/// Distance of the first cycle from a Hopf point in the parameter, in multiples of what the normal form gives, beyond which it is
/// no cycle that is born there.
const FARTHEST_FIRST: f64 = 3.0;

/// Growth rate beside the frequency of a Hopf point above which it is certain that the cycles are born with its sign.
const CERTAIN_RATE: f64 = 1e-6;

/// Turns of a cycle agree where they differ by less than this many errors of it, at least and at most by these parts of its size; those of
/// an orbit that is only near to one may where they differ by less than the last.
const AGREE_WITHIN: f64 = 10.0;
const TURNS_AGREE: [f64; 2] = [1e-7, 1e-3];
const TURNS_MAY_AGREE: f64 = 0.3;

/// Error of a cycle, relative to its amplitude, beyond which it is so small that its multipliers say nothing.
const RESOLVED: f64 = 1e-3;

/// Distance from one of multipliers of an orbit near a cycle that may be one of a family.
const OF_A_FAMILY: f64 = 1e-2;

/// Part of the range of the parameter by which the first cycle may lie from a given one that is a fold.
const AT_FOLD: f64 = 1e-3;

/// What a branch of cycles starts from.
#[derive(Clone, Debug)]
pub enum CycleStart {
    /// A Hopf point.
    Hopf {
        /// Equilibrium.
        state: Vec<f64>,
        /// Angular frequency.
        frequency: f64,
        /// Critical right eigenvector.
        eigenvector: Vec<Complex64>,
        /// Rate at which the real part of the critical eigenvalue changes with the parameter.
        crossing_speed: f64,
        /// Real part of the cubic coefficient of the normal form, `first_lyapunov * frequency`.
        cubic_coefficient: f64,
    },
    /// A cycle.
    Orbit(Orbit),
    /// The branch that leaves another one at a bifurcation.
    Branching(Branching),
}

impl From<&HopfPoint> for CycleStart {
    fn from(point: &HopfPoint) -> Self {
        Self::Hopf {
            state: point.state.clone(),
            frequency: point.frequency,
            eigenvector: point.eigenvector.clone(),
            // They set the size of the first cycle, and what its stability has to be.
            crossing_speed: point.crossing_speed.unwrap_or(0.0),
            cubic_coefficient: point
                .c1_real
                .filter(|_| point.criticality != Criticality::Degenerate)
                .unwrap_or(0.0),
        }
    }
}

impl HopfPoint {
    /// The cycles of the field that are born here; see the example of [`Cycles`].
    pub fn cycles<'a, F: VectorField>(&self, field: &'a F) -> Cycles<'a> {
        Cycles::of(field, CycleStart::from(self)).parameters(&self.parameters)
    }
}

impl CyclePoint {
    /// The branch through this cycle, along any parameter.
    pub fn cycles<'a, F: VectorField>(&self, field: &'a F) -> Cycles<'a> {
        Cycles::of(field, CycleStart::Orbit(self.orbit.clone())).parameters(&self.parameters)
    }

    /// At a period doubling the branch of the doubled cycles; `None` elsewhere.
    pub fn doubled<'a, F: VectorField>(&self, field: &'a F) -> Option<Cycles<'a>> {
        self.leaving(field, true)
    }

    /// At a branch point of cycles the other branch; `None` elsewhere.
    pub fn other<'a, F: VectorField>(&self, field: &'a F) -> Option<Cycles<'a>> {
        self.leaving(field, false)
    }

    fn leaving<'a, F: VectorField>(&self, field: &'a F, doubled: bool) -> Option<Cycles<'a>> {
        let branching = self.branching.as_ref().filter(|branching| branching.doubled == doubled)?;
        Some(Cycles::of(field, CycleStart::Branching(branching.clone())).parameters(&self.parameters))
    }
}

/// What a branch of cycles starts from and how finely the cycles are resolved.
#[derive(Clone, Debug)]
pub struct CycleProblem {
    pub(super) start: CycleStart,
    pub(super) resolution: Resolution,
}

impl Problem for CycleProblem {
    type Point = CyclePoint;

    fn settings() -> Settings {
        Settings::default()
    }
}

type FollowedCycles = Followed<CycleInspection, SpecialKind, CycleEnd>;

/// A branch of limit cycles to be followed.
///
/// ```
/// use arclength::equilibrium::Equilibria;
/// use arclength::{Scalar, VectorField};
///
/// /// x' = rho x - y - x (x^2 + y^2), y' = x + rho y - y (x^2 + y^2): circles of radius sqrt(rho).
/// struct Circle;
/// impl VectorField for Circle {
///     fn state_names(&self) -> Vec<String> { vec!["x".into(), "y".into()] }
///     fn parameter_names(&self) -> Vec<String> { vec!["rho".into()] }
///     fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
///         let growth = p[0] - s[0] * s[0] - s[1] * s[1];
///         d[0] = growth * s[0] - s[1];
///         d[1] = s[0] + growth * s[1];
///     }
/// }
///
/// let equilibria = Equilibria::of(&Circle).parameters(&[-1.0]).along("rho", -1.0..=1.0).run()?;
/// let hopf = equilibria.hopf_points().next().expect("a Hopf point");
/// let branch = hopf.cycles(&Circle).along("rho", 0.0..=1.0).at(&[0.25]).run()?;
/// let quarter = branch.points.iter().find(|cycle| cycle.value == 0.25).expect("asked for");
/// assert!((quarter.max[0] - 0.5).abs() < 1e-8);
/// assert_eq!(quarter.stable, Some(true));
/// # Ok::<(), arclength::Error>(())
/// ```
pub type Cycles<'a> = Continuation<'a, CycleProblem>;

impl<'a> Cycles<'a> {
    /// Cycles of the field, from a start.
    pub fn of<F: VectorField>(field: &'a F, start: CycleStart) -> Self {
        Self::of_erased(field.erased(), CycleProblem { start, resolution: Resolution::default() })
    }

    /// Resolution of the cycles.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.start.resolution = resolution;
        self
    }

    /// Follows the branch: from a Hopf point the one way there is, from a cycle both ways.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a start or range that makes no sense, [`Error::NotFound`] when no cycle is found
    /// near the start.
    pub fn run(mut self) -> Result<CycleBranch, Error> {
        let (active, bounds) = self.active(1)?;
        let parameters = self.checked_parameters()?;
        let asked = Asked {
            field: self.field,
            parameters,
            active: active[0],
            bound: bounds[0],
            resolution: self.start.resolution,
            settings: self.settings,
        };
        asked.validate(&self.start.start)?;
        let degree = match &self.start.start {
            CycleStart::Hopf { .. } => self.start.resolution.degree,
            CycleStart::Orbit(orbit) => orbit.degree,
            CycleStart::Branching(branching) => branching.orbit.degree,
        };
        let Continuation { start, at, monitors, observer: told, settings, .. } = &mut self;
        let followed = FollowedParameter {
            parameters: &asked.parameters,
            active: asked.active,
            range: asked.bound.width(),
            degree,
        };
        let bare = |solution: &Solution<CycleInspection>| CyclePoint::new(solution, None, &followed);
        let point = |solution: &Solution<CycleInspection>, label: Option<Label>| {
            let mut point = CyclePoint::new(solution, label, &followed);
            point.monitors =
                monitors.iter().map(|monitor| monitor.value(&point).unwrap_or(f64::NAN)).collect();
            point
        };
        let request = request(&bounds, at, monitors, *settings, &bare);
        let mut observe = observer(told.as_mut().map(|told| &mut **told as _), &point);
        let mut followed = asked.follow_from(&start.start, &request, &mut *observe)?;
        drop(observe);
        followed.mark_requested(at, |solution| bounds[0].value(&solution.unknown));
        let active = [asked.active];
        let mut branch =
            Branch::assemble(&asked.field, (&asked.parameters, &active), followed, |solution, label| {
                point(&solution, label)
            });
        keep_neutral_families(&mut branch);
        asked.refine_ends(&mut branch);
        asked.confirm(&mut branch, at, &mut |point| {
            point.monitors =
                monitors.iter().map(|monitor| monitor.value(point).unwrap_or(f64::NAN)).collect();
        });
        Ok(branch)
    }
}

/// A family has more than one cycle: a single one at which the parameter stands still is next to a fold.
fn keep_neutral_families(branch: &mut CycleBranch) {
    let neutral: Vec<bool> = branch.points.iter().map(|point| point.neutral).collect();
    for (index, point) in branch.points.iter_mut().enumerate() {
        let neighbours = [index.checked_sub(1), Some(index + 1)];
        let has_neutral_neighbour =
            neighbours.into_iter().flatten().any(|place| neutral.get(place) == Some(&true));
        point.neutral = point.neutral && has_neutral_neighbour;
    }
}

/// A checked request.
pub(super) struct Asked<'a> {
    pub field: ErasedField<'a>,
    pub parameters: Vec<f64>,
    pub active: usize,
    pub bound: Bound,
    pub resolution: Resolution,
    pub settings: Settings,
}

impl<'a> Asked<'a> {
    fn follow_from(
        &self,
        start: &CycleStart,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<BothWays<CycleInspection, SpecialKind, CycleEnd>, Error> {
        match start {
            CycleStart::Hopf { state, frequency, eigenvector, crossing_speed, cubic_coefficient } => {
                let hopf = HopfStart {
                    state,
                    frequency: *frequency,
                    eigenvector,
                    crossing_speed: *crossing_speed,
                    cubic_coefficient: *cubic_coefficient,
                };
                Ok(BothWays::one_way(self.be_born(&hopf, request, observer)?, None))
            }
            CycleStart::Orbit(orbit) => {
                let once = self.traversed_once(orbit, request);
                let orbit = once.as_ref().unwrap_or(orbit);
                self.pass_through(orbit, request, observer).map_err(|error| match error {
                    Error::NotFound { sought, cause } => self.in_a_family(orbit, sought, cause),
                    error => error,
                })
            }
            CycleStart::Branching(branching) if branching.doubled => {
                Ok(BothWays::one_way(self.leave(branching, 1.0, request, observer)?, None))
            }
            CycleStart::Branching(branching) => {
                let [backward, forward] = both_ways(|sign| self.leave(branching, sign, request, observer))?;
                let middle =
                    (self.branch_point(branching)?, Origin::Special(SpecialKind::BranchPointOfCycles));
                if matches!(forward.stop, Stop::Closed | Stop::Interrupted) {
                    return Ok(BothWays::one_way(forward, Some(middle)));
                }
                Ok(BothWays::join([backward, forward], Some(middle)))
            }
        }
    }

    pub(super) fn problem(&self) -> LimitCycle<'a> {
        LimitCycle {
            field: self.field,
            parameters: self.parameters.clone(),
            active: self.active,
            scales: vec![1.0; self.field.dimension()],
            segments: None,
        }
    }

    fn curve(&self, start: &Departure) -> CycleCurve<'a> {
        let collocation = Collocation::new(self.problem(), start.mesh.clone(), start.degree);
        let mut curve = CycleCurve::new(collocation, self.resolution, self.bound.width(), &start.unknown);
        curve.settings = self.settings.for_locating();
        curve
    }

    /// Follows the branch from a start in the direction of its tangent.
    fn follow(
        &self,
        start: &Departure,
        birth: Birth,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        let mut curve = self.curve(start);
        curve.birth = birth;
        let mut followed =
            follow(&mut curve, start.unknown.clone(), start.tangent.clone(), request, observer)?;
        if matches!(followed.stop, Stop::StepTooSmall { .. }) {
            let solutions: Vec<_> = followed.solutions.iter().map(|(solution, _)| solution).collect();
            if let Some(grazing) = curve.grazing_ahead(&solutions) {
                followed.stop = Stop::Problem(grazing);
            }
        }
        Ok(followed)
    }

    /// The cycle of an orbit that turns out to be one traversed several times: the turns of the cycle that is found from it agree
    /// within its error, and the cycle that is found from the first of them is the same.
    fn traversed_once(&self, orbit: &Orbit, request: &Request<'_, CycleInspection>) -> Option<Orbit> {
        let solved = |orbit: &Orbit| {
            let start = self.through(orbit);
            let mut curve = self.curve(&start);
            let found = exact_start(&mut curve, start.unknown, start.tangent, request).ok()?;
            let closeness = (AGREE_WITHIN * found.point.error_estimate).clamp(TURNS_AGREE[0], TURNS_AGREE[1]);
            let end = found.unknown.len() - 2;
            let orbit = Orbit {
                mesh: curve.collocation.mesh().to_vec(),
                degree: start.degree,
                dimension: self.field.dimension(),
                states: found.unknown[..end].to_vec(),
                period: found.unknown[end],
            };
            Some((orbit, closeness))
        };
        // To solve for it twice is for those that may be.
        orbit.traversed_once(TURNS_MAY_AGREE)?;
        let (several, closeness) = solved(orbit)?;
        let first = several.traversed_once(closeness)?;
        let (once, _) = solved(&first)?;
        let turns = (several.period / first.period).round();
        ((once.period * turns - several.period).abs() < closeness * several.period).then_some(once)
    }

    /// Departure from an orbit along the parameter.
    fn through(&self, orbit: &Orbit) -> Departure {
        let mut unknown = orbit.states.clone();
        unknown.extend([orbit.period, self.parameters[self.active]]);
        let mut tangent = vec![0.0; unknown.len()];
        tangent[unknown.len() - 1] = self.bound.width();
        let mut collocation = Collocation::new(self.problem(), orbit.mesh.clone(), orbit.degree);
        // Where that fails the search for segments fails again, and says why.
        let mesh = match tell_borders_apart(&mut collocation, &mut unknown, &mut tangent) {
            Ok(()) => collocation.mesh().to_vec(),
            Err(_) => orbit.mesh.clone(),
        };
        Departure { unknown, tangent, mesh, degree: orbit.degree }
    }

    /// Follows the branch through a cycle both ways.
    fn pass_through(
        &self,
        orbit: &Orbit,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<BothWays<CycleInspection, SpecialKind, CycleEnd>, Error> {
        let mut start = self.through(orbit);
        let given = self.parameters[self.active];
        let directions = both_ways(|sign| {
            if sign < 0.0 {
                start.tangent.iter_mut().for_each(|entry| *entry = -*entry);
                return self.follow(&start, Birth::Unknown, request, observer);
            }
            match self.follow(&start, Birth::Unknown, request, observer) {
                // At a fold the parameter stands still: the size of the cycle changes.
                Err(Error::NotFound { sought, cause }) => {
                    let end = start.unknown.len() - 2;
                    let states = start.unknown[..end].to_vec();
                    start.tangent = Orbit { mesh: start.mesh.clone(), states, ..orbit.clone() }.deviation();
                    start.tangent.extend([0.0, 0.0]);
                    // A cycle elsewhere is not the one that was given.
                    let is_there = |followed: &FollowedCycles| {
                        let first =
                            followed.solutions.first().map(|(first, _)| self.bound.value(&first.unknown));
                        first.is_some_and(|value| {
                            (value - given).abs() <= AT_FOLD * self.bound.width()
                                && self.bound.holds(value, START_ROUNDING)
                        })
                    };
                    match self.follow(&start, Birth::Unknown, request, observer) {
                        Ok(followed) if is_there(&followed) => Ok(followed),
                        _ => Err(Error::NotFound { sought, cause }),
                    }
                }
                result => result,
            }
        })?;
        let first = [0, 1].map(|side: usize| directions[side].first.clone());
        let mut followed = BothWays::join(directions, None);
        // The mesh has moved on: the start once more, on its own.
        let mut curve = self.curve(&start);
        let forward: Vec<f64> =
            followed.solutions.get(followed.start).map_or(Vec::new(), |(start, _)| start.tangent.clone());
        let there = exact_start(&mut curve, start.unknown, start.tangent, request)?;
        let points_forward = there.tangent.len() == forward.len()
            && there.tangent.last().zip(forward.last()).is_some_and(|(a, b)| a * b >= 0.0);
        let there = if points_forward { there } else { there.reversed() };
        let events = around_start(&mut curve, &there, first, &request.bounds, &self.settings)?;
        followed.insert_at_start(&curve, events);
        Ok(followed)
    }

    /// Why no cycle is found from an orbit: cycles of a family, of which more than one multiplier is one, are not alone.
    fn in_a_family(&self, orbit: &Orbit, sought: &'static str, cause: CorrectionFailure) -> Error {
        let near_one = self.unsolved(&self.through(orbit)).map_or(0, |solution| {
            let multipliers = solution.point.floquet.nontrivial.iter();
            multipliers.filter(|multiplier| (multiplier.to_complex() - 1.0).norm() < OF_A_FAMILY).count()
        });
        match near_one {
            0 => Error::NotFound { sought, cause },
            count => Error::FamilyOfCycles { cause, count, distance: OF_A_FAMILY },
        }
    }

    /// Follows the branch from a Hopf point, from a smaller first cycle where there is none near that of the normal form.
    fn be_born(
        &self,
        hopf: &HopfStart<'_>,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        // Shorter steps asked for mean a shorter first one.
        let share = (self.settings.initial_step / Settings::default().initial_step).min(1.0);
        let range = (self.active, self.bound.width());
        let scales = natural_scales_along(&self.field, hopf.state, &self.parameters, range);
        let mut amplitude = share * hopf.first_amplitude(self.bound.width(), &scales);
        // A first cycle of another stability than the normal form gives lies behind a fold, or behind another bifurcation, and so does
        // one whose parameter is elsewhere.
        if hopf.cubic_coefficient.is_normal() {
            let expected = self.unstable_at_birth(hopf);
            let reduced = std::iter::successors(Some(amplitude), |last| Some(last * AMPLITUDE_REDUCTION));
            let fits = |amplitude: &f64| self.is_as_born(hopf, *amplitude, expected, request);
            amplitude = reduced.take(MOST_REDUCTIONS).find(fits).unwrap_or(amplitude);
        }
        let place = self.parameters[self.active];
        let expansion = Expansion::at(hopf, self.field, &self.parameters, self.active, &scales);
        self.first_of(amplitude, AMPLITUDE_REDUCTION, |amplitude| {
            let mut first = |expansion: Option<&Expansion>| {
                let start = hopf.cycle(place, amplitude, expansion, self.resolution.degree);
                let is_certain = hopf.cubic_coefficient.is_normal();
                let birth = if is_certain { Birth::OfCertainSense } else { Birth::Unknown };
                let followed = self.follow(&start, birth, request, observer)?;
                let expected = amplitude * amplitude * hopf.cubic_coefficient / hopf.crossing_speed;
                if self.is_stray(&followed, FARTHEST_FIRST * expected.abs()) {
                    return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
                }
                Ok(followed)
            };
            match first(None) {
                Err(Error::NotFound { .. }) if expansion.is_some() => first(expansion.as_ref()),
                result => result,
            }
        })
    }

    /// Whether a branch that is to start at the parameter's value starts outside its range and farther away than `expected`:
    /// then Newton's method has gone elsewhere.
    fn is_stray(&self, followed: &FollowedCycles, expected: f64) -> bool {
        let first = followed.solutions.first().and_then(|(solution, _)| solution.unknown.last());
        first.is_some_and(|&value| {
            let outside = !(self.bound.lower..=self.bound.upper).contains(&value);
            outside && (value - self.parameters[self.active]).abs() > expected
        })
    }

    /// Number of multipliers outside the unit circle with which the cycles are born; `None` where it is not certain.
    fn unstable_at_birth(&self, hopf: &HopfStart<'_>) -> Option<usize> {
        let n = hopf.state.len();
        let problem = EquilibriumProblem::new(self.field, &self.parameters, &[]);
        let (mut residual, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
        Differentiator::default().jacobian(&problem, hopf.state, &mut residual, &mut matrix, n);
        let pair = Complex64::new(0.0, hopf.frequency);
        let rest = without(&eigenvalues(&matrix, n).ok()?, &[pair, pair.conj()]);
        let certain = hopf.cubic_coefficient.is_normal()
            && rest.iter().all(|value| value.re.abs() > CERTAIN_RATE * hopf.frequency);
        let unstable = rest.iter().filter(|value| value.re > 0.0).count();
        certain.then_some(unstable + usize::from(hopf.cubic_coefficient > 0.0))
    }

    /// Whether the cycle near a Hopf point that has an amplitude has as many multipliers outside the unit circle as those that are
    /// born there; where that number is not certain, whether its parameter is about where the normal form says.
    fn is_as_born(
        &self,
        hopf: &HopfStart<'_>,
        amplitude: f64,
        unstable_at_birth: Option<usize>,
        request: &Request<'_, CycleInspection>,
    ) -> bool {
        let place = self.parameters[self.active];
        let start = hopf.cycle(place, amplitude, None, self.resolution.degree);
        let mut curve = self.curve(&start);
        let Ok(found) = exact_start(&mut curve, start.unknown, start.tangent, request) else { return false };
        if found.point.error_estimate > RESOLVED {
            return false;
        }
        if let Some(expected) = unstable_at_birth {
            return found.point.floquet.unstable() == UnstableCount { count: expected, is_certain: true };
        }
        let expected = -amplitude * amplitude * hopf.cubic_coefficient / hopf.crossing_speed;
        let ratio = (found.unknown[found.unknown.len() - 1] - place) / expected;
        (FARTHEST_FIRST.recip()..=FARTHEST_FIRST).contains(&ratio)
    }

    /// The first run that finds a cycle, at ever smaller distances.
    fn first_of(
        &self,
        mut distance: f64,
        reduction: f64,
        mut run: impl FnMut(f64) -> Result<FollowedCycles, Error>,
    ) -> Result<FollowedCycles, Error> {
        let mut failure = None;
        for _ in 0..MOST_REDUCTIONS {
            match run(distance) {
                Err(Error::NotFound { sought, cause }) => {
                    failure.get_or_insert(Error::NotFound { sought, cause });
                    distance *= reduction;
                }
                result => return result,
            }
        }
        Err(failure.unwrap_or(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged }))
    }

    /// The bifurcation itself and the direction of the new branch.
    fn departure(&self, branching: &Branching) -> Departure {
        let Branching { orbit, direction, .. } = branching;
        let mut start = Departure {
            unknown: orbit.states.clone(),
            tangent: direction.clone(),
            mesh: orbit.mesh.clone(),
            degree: orbit.degree,
        };
        start.unknown.extend([orbit.period, self.parameters[self.active]]);
        start.tangent.extend([branching.period, branching.parameter]);
        start
    }

    /// The branch point as a cycle of the branch that leaves there.
    fn branch_point(&self, branching: &Branching) -> Result<Solution<CycleInspection>, Error> {
        let start = self.departure(branching);
        let mut solution = self.unsolved(&start)?;
        solution.point.branching = branching.known_branch();
        Ok(solution)
    }

    /// A start as it is given, with its multipliers.
    fn unsolved(&self, start: &Departure) -> Result<Solution<CycleInspection>, Error> {
        let mut curve = self.curve(start);
        let mut border = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut border);
        let mut residual = vec![0.0; start.tangent.len()];
        curve.estimate_error(&start.unknown);
        // It may be singular there, but the multipliers do not need the border.
        curve.factorize(&start.unknown, &border, &mut residual);
        let point = curve.inspect(&start.unknown, &start.tangent, 0.0)?;
        Ok(Solution {
            unknown: start.unknown.clone(),
            tangent: start.tangent.clone(),
            orientation: 0.0,
            point,
        })
    }

    /// Follows the branch that leaves another one at a bifurcation, in one of its two directions.
    fn leave(
        &self,
        branching: &Branching,
        sign: f64,
        request: &Request<'_, CycleInspection>,
        observer: &mut Observer<'_, CycleInspection, SpecialKind>,
    ) -> Result<FollowedCycles, Error> {
        let mut start = self.departure(branching);
        let mut curve = self.curve(&start);
        curve.count_resting_states_fully();
        let mut image = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut image);
        let size = start.tangent.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>().sqrt();
        start.tangent.iter_mut().for_each(|entry| *entry *= sign / size);
        let origin = start.unknown.clone();
        let birth = if branching.doubled { Birth::Doubled } else { Birth::Unknown };
        self.first_of(FIRST_DISTANCE, DISTANCE_REDUCTION, |distance| {
            let ahead = origin.iter().zip(&start.tangent).map(|(value, slope)| value + distance * slope);
            start.unknown = ahead.collect();
            self.follow(&start, birth, request, observer)
        })
    }

    fn validate(&self, start: &CycleStart) -> Result<(), Error> {
        match start {
            CycleStart::Orbit(orbit) => orbit.check(self.field.dimension())?,
            CycleStart::Branching(branching) => branching.check(self.field.dimension())?,
            CycleStart::Hopf { .. } => {}
        }
        let value = self.parameters[self.active];
        let Bound { lower, upper, .. } = self.bound;
        if !self.bound.holds(value, START_ROUNDING) {
            return Err(invalid(
                "start value",
                &value.to_string(),
                &format!("{lower} to {upper}, inside the range"),
            ));
        }
        self.resolution.validate()
    }
}
