//! Asking for a branch of equilibria.

use super::branch::{EquilibriumBranch, EquilibriumPoint};
use super::branch_point::BranchPoint;
use super::corner::{HalfBranch, Piece};
use super::curve::{EquilibriumCurve, EquilibriumInspection};
use super::departure::{branch_point_along, is_branching, line_through};
use super::end::EquilibriumEnd;
use super::first::{FoundBy, FoundEquilibrium, seek_erased};
use super::newton::find_erased;
use super::problem::EquilibriumProblem;
use crate::algebraic::scales::natural_scales;
use crate::algebraic::{Differentiator, length};
use crate::branch::{Branch, Continuation, Label, SpecialKind, check_length, invalid, observer, request};
use crate::continuation::events::{Event, Events, around_start};
use crate::continuation::{
    BothWays, BothWaysOf, Bound, Curve, Followed, FollowedCurve, Origin, Request, Settings, Solution, Stop,
    both_ways, follow,
};
use crate::error::Error;
use crate::field::VectorField;
use crate::numbers::readable;

/// Distance from a branch point, in the metric, of the first point on the other branch.
const DEPARTURE: f64 = 1e-3;

/// Rate of change of the parameter along the branch, as part of its range, below which it stands still at the start.
const VERTICAL_START: f64 = 1e-6;

/// Part of the largest one by which a state moves along a line of equilibria.
const MOVED: f64 = 1e-6;

/// States that a message names at most.
const NAMED_STATES: usize = 6;

/// The settings that suit equilibria, where steps cost little: short ones, so that nothing is jumped over.
pub fn equilibrium_settings() -> Settings {
    Settings {
        initial_step: 0.005,
        largest_step: 0.1,
        predictor_error: 1e-3,
        largest_correction: 3.0,
        corrector_tolerance: 1e-12,
        smallest_part: 1e-7,
        most_trials: 400,
        shortest_jump: 1e-6,
        shortest_bracket: 1e-10,
        ..Settings::default()
    }
}

/// Where a branch of equilibria starts.
#[derive(Clone, Debug, Default)]
pub enum EquilibriumStart {
    /// The origin, from which the first equilibrium is sought.
    #[default]
    Origin,
    /// A state from which the first equilibrium is sought.
    State(Vec<f64>),
    /// A state that is an equilibrium.
    Equilibrium(Vec<f64>),
    /// A branch point, on the other branch through it.
    OtherBranch(Box<BranchPoint>),
}

impl crate::branch::Problem for EquilibriumStart {
    type Point = EquilibriumPoint;

    fn settings() -> Settings {
        equilibrium_settings()
    }
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
/// assert!(folds.len() == 1 && folds[0].value.abs() < 1e-15);
/// # Ok::<(), arclength::Error>(())
/// ```
pub type Equilibria<'a> = Continuation<'a, EquilibriumStart>;

impl BranchPoint {
    /// The other branch through this point.
    pub fn other<'a, F: VectorField>(&self, field: &'a F) -> Equilibria<'a> {
        Equilibria::of(field).from_branch_point(self)
    }
}

/// A start in the space of the states and the parameter, with the directions in which the branch leaves it.
struct Departure {
    unknown: Vec<f64>,
    /// Points forward.
    tangent: Vec<f64>,
    /// Whether the parameter stands still there.
    is_vertical: bool,
    /// The branch point from which the branch leaves, with its own branch second.
    branch_point: Option<BranchPoint>,
    /// How the branch leaves a start on a border between two pieces of the field, backward and forward.
    halves: Option<[Option<HalfBranch>; 2]>,
}

impl<'a> Equilibria<'a> {
    /// Equilibria of `field`, by default from the start zero. The value of the parameter to vary says where to start; outside its
    /// range the nearer end does.
    pub fn of<F: VectorField>(field: &'a F) -> Self {
        Self::of_erased(field.erased(), EquilibriumStart::default())
    }

    /// State from which the first equilibrium is sought; it need not be one.
    pub fn start(mut self, state: &[f64]) -> Self {
        self.start = EquilibriumStart::State(state.to_vec());
        self
    }

    /// Starts at a state that is an equilibrium, perhaps a singular one such as a fold, to which Newton's method would not
    /// converge.
    pub fn through(mut self, equilibrium: &[f64]) -> Self {
        self.start = EquilibriumStart::Equilibrium(equilibrium.to_vec());
        self
    }

    /// Starts on the other branch through a branch point, with its parameters.
    pub fn from_branch_point(mut self, branch_point: &BranchPoint) -> Self {
        self.parameters = Some(branch_point.parameters.clone());
        self.start = EquilibriumStart::OtherBranch(Box::new(branch_point.clone()));
        self
    }

    /// Seeks the first equilibrium as [`seek_equilibrium`](super::seek_equilibrium) does and starts there, where a state is given
    /// that need not be one. Says how it was found.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn seek(mut self) -> Result<(Self, FoundBy), Error> {
        let (active, bounds) = self.active(1)?;
        let mut parameters = self.checked_parameters()?;
        let state = match &self.start {
            EquilibriumStart::Origin => vec![0.0; self.field.dimension()],
            EquilibriumStart::State(state) => state.clone(),
            EquilibriumStart::Equilibrium(_) | EquilibriumStart::OtherBranch(_) => {
                return Ok((self, FoundBy::Newton));
            }
        };
        let value = &mut parameters[active[0]];
        *value = value.clamp(bounds[0].lower, bounds[0].upper);
        let FoundEquilibrium { state, by } = seek_erased(self.field, &state, &parameters)?;
        self.start = EquilibriumStart::State(state);
        Ok((self, by))
    }

    /// Follows the branch.
    ///
    /// # Errors
    /// [`Error::Invalid`] when what was asked for makes no sense, [`Error::NotFound`] when there is no equilibrium near
    /// the start. What goes wrong later ends the branch with a [`Stop`].
    pub fn run(mut self) -> Result<EquilibriumBranch, Error> {
        let (active, bounds) = self.active(1)?;
        let (index, bound) = (active[0], bounds[0]);
        let parameters = self.checked_parameters()?;
        let n = self.field.dimension();
        let problem = EquilibriumProblem::new(self.field, &parameters, &active);
        let (unknown, leaving) = self.first_equilibrium(&problem, (index, bound))?;
        let scales = scales(&problem, &unknown, bound.width());
        let departure = self.departure(&problem, unknown, leaving, (&scales, index))?;
        let mut curve = EquilibriumCurve::new(problem, scales, bound, self.settings);
        let departure = departure.directed(&mut curve)?;

        let Continuation { field, at, monitors, observer: told, settings, .. } = &mut self;
        let bare =
            |solution: &Solution<EquilibriumInspection>| EquilibriumPoint::new(solution, None, bound.width());
        let point = |solution: &Solution<EquilibriumInspection>, label: Option<Label>| {
            let mut point = EquilibriumPoint::new(solution, label, bound.width());
            point.monitors =
                monitors.iter().map(|monitor| monitor.value(&point).unwrap_or(f64::NAN)).collect();
            point
        };
        let request = request(&bounds, at, monitors, *settings, &bare);
        let mut observe = observer(told.as_mut().map(|told| &mut **told as _), &point);
        let directions = both_ways(|sign| departure.follow(&mut curve, sign, &request, &mut *observe))?;
        drop(observe);
        let mut followed = departure.join(&mut curve, directions, (bound, settings))?;
        followed.mark_requested(at, |solution| solution.unknown[n]);
        let point = |solution: Solution<EquilibriumInspection>, label| point(&solution, label);
        Ok(Branch::assemble(field, (&parameters, &active), followed, point))
    }

    /// The first equilibrium with the value of the parameter, and the branch point that it is.
    fn first_equilibrium(
        &self,
        problem: &EquilibriumProblem<'_>,
        (index, bound): (usize, Bound),
    ) -> Result<(Vec<f64>, Option<BranchPoint>), Error> {
        let n = self.field.dimension();
        let value = problem.parameters[index];
        let sought = |state: &[f64]| -> Result<Vec<f64>, Error> {
            let value = value.clamp(bound.lower, bound.upper);
            let mut unknown = find_erased(self.field, state, &problem.parameters_at(&[value]))?;
            unknown.push(value);
            Ok(unknown)
        };
        match &self.start {
            EquilibriumStart::Origin => Ok((sought(&vec![0.0; n])?, None)),
            EquilibriumStart::State(state) => {
                check_length("start", state, n, "the dimension of the field")?;
                Ok((sought(state)?, None))
            }
            EquilibriumStart::Equilibrium(state) => {
                check_length("start", state, n, "the dimension of the field")?;
                if !(bound.lower..=bound.upper).contains(&value) {
                    let name = &self.field.parameter_names()[index];
                    let allowed = format!("{} to {}", bound.lower, bound.upper);
                    return Err(invalid(&format!("{name} at the start"), &value.to_string(), &allowed));
                }
                Ok(([&state[..], &[value]].concat(), None))
            }
            EquilibriumStart::OtherBranch(point) => {
                check_length("branch point", &point.state, n, "the dimension of the field")?;
                Ok(([&point.state[..], &[value]].concat(), Some((**point).clone())))
            }
        }
    }

    /// How the branch leaves its start, where more than one branch passes through it.
    fn departure(
        &self,
        problem: &EquilibriumProblem<'_>,
        unknown: Vec<f64>,
        known: Option<BranchPoint>,
        (scales, index): (&[f64], usize),
    ) -> Result<Departure, Error> {
        let leaves = |unknown: Vec<f64>, point: BranchPoint| Departure {
            tangent: point.tangents[1].clone(),
            unknown,
            is_vertical: false,
            branch_point: Some(point),
            halves: None,
        };
        let known = match known {
            Some(point) if point.active == index => return Ok(leaves(unknown, point)),
            known => known,
        };
        if !is_branching(problem, &unknown, scales)? {
            let tangent = Vec::new();
            return Ok(Departure { unknown, tangent, is_vertical: false, branch_point: None, halves: None });
        }
        // From a branch point found along another parameter the other branch is followed here too.
        let point = match &known {
            Some(point) => branch_point_along(problem, &unknown, point, scales)?,
            None => None,
        };
        match point {
            Some(point) => Ok(leaves(unknown, point)),
            None => Err(self.no_single_branch(problem, &unknown, scales, index)),
        }
    }

    /// Why no single branch leaves an equilibrium.
    fn no_single_branch(
        &self,
        problem: &EquilibriumProblem<'_>,
        unknown: &[f64],
        scales: &[f64],
        index: usize,
    ) -> Error {
        let n = problem.dimension;
        let name = &self.field.parameter_names()[index];
        let names = self.field.state_names();
        let some = names.iter().zip(unknown).take(NAMED_STATES);
        let place: Vec<String> = some.map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
        let place = place.join(", ");
        let more = if n > NAMED_STATES { ", .." } else { "" };
        let allowed = match line_through(problem, unknown, scales) {
            Some(direction) => {
                let largest = direction.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
                let moves = |entry: f64| entry.abs() > MOVED * largest;
                let moved = names.iter().zip(&direction).filter(|(_, entry)| moves(**entry));
                let moved: Vec<&str> = moved.map(|(name, _)| name.as_str()).collect();
                format!(
                    "the equilibrium that was found there, {place}{more}, is one of a whole line of them for the same {name}, along \
                     which {} move: take states that stay, such as differences of phases, or hold one of them fixed",
                    moved.join(", ")
                )
            }
            None => format!(
                "the equilibrium that was found there, {place}{more}, is a branch point, or degenerate, and no single branch passes \
                 through it; start beside it, at a slightly different {name}, or where another equilibrium is nearer"
            ),
        };
        invalid(&format!("start at {name}"), &unknown[n].to_string(), &allowed)
    }
}

impl Departure {
    /// With a unit tangent that points forward: the parameter grows, or where it stands still the first state that moves.
    fn directed(mut self, curve: &mut EquilibriumCurve<'_>) -> Result<Self, Error> {
        if self.branch_point.is_none() {
            self.halves = leaving_border(curve, &self.unknown);
            let forward = self.halves.iter().flatten().flatten().last();
            self.tangent = match forward {
                Some(half) => half.tangent.clone(),
                None => curve.system.tangent(&self.unknown)?,
            };
        }
        let size = length(&self.tangent, &curve.system.scales);
        self.is_vertical = curve.turn(&self.tangent).abs() < VERTICAL_START * size;
        let lead = if self.is_vertical {
            self.tangent.iter().find(|entry| **entry != 0.0)
        } else {
            self.tangent.last()
        };
        let sign = if lead.is_some_and(|entry| *entry < 0.0) { -1.0 } else { 1.0 } / size;
        self.tangent.iter_mut().for_each(|entry| *entry *= sign);
        Ok(self)
    }

    /// Distance from the start of the first point.
    fn distance(&self) -> f64 {
        if self.branch_point.is_some() { DEPARTURE } else { 0.0 }
    }

    /// Follows the branch in one direction.
    fn follow(
        &self,
        curve: &mut EquilibriumCurve<'_>,
        sign: f64,
        request: &Request<'_, EquilibriumInspection>,
        observer: &mut crate::continuation::Observer<'_, EquilibriumInspection, SpecialKind>,
    ) -> Result<FollowedCurve<EquilibriumCurve<'static>>, Error> {
        let bound = request.bounds[0];
        let value = bound.value(&self.unknown);
        let (mut tangent, mut cells): (Vec<f64>, _) =
            (self.tangent.iter().map(|entry| sign * entry).collect(), Vec::new());
        if let Some(halves) = &self.halves {
            let Some(half) = &halves[usize::from(sign > 0.0)] else {
                return Ok(Followed::nothing(Stop::Problem(EquilibriumEnd::Border { parameter: value })));
            };
            (tangent, cells) = (half.tangent.clone(), half.cells.clone());
        }
        let end = if tangent.last().is_some_and(|rate| *rate > 0.0) { bound.upper } else { bound.lower };
        let is_at_end = (value - end).abs() <= f64::EPSILON * end.abs().max(bound.width());
        if !self.is_vertical && is_at_end {
            return Ok(Followed::nothing(Stop::RangeEnd { bound: 0, value }));
        }
        let start = self.unknown.iter().zip(&tangent).map(|(value, slope)| value + self.distance() * slope);
        let start: Vec<f64> = start.collect();
        curve.restart();
        if cells.is_empty() {
            cells = curve.piece_at(&start).map_or(Vec::new(), |piece| piece.cells);
        }
        curve.system.problem.enter(&cells);
        follow(curve, start, tangent, request, observer)
    }

    /// Both directions with the branch point between them, or the special points at and around the start.
    fn join(
        self,
        curve: &mut EquilibriumCurve<'_>,
        directions: [FollowedCurve<EquilibriumCurve<'static>>; 2],
        (bound, settings): (Bound, &Settings),
    ) -> Result<BothWaysOf<EquilibriumCurve<'static>>, Error> {
        let distance = self.distance();
        let [backward, mut forward] = directions;
        let Some(mut point) = self.branch_point else {
            let first = [&backward, &forward].map(|direction| direction.first.clone());
            let starts = [&backward, &forward].map(|direction| direction.solutions.first().cloned());
            let mut followed = BothWays::join([backward, forward], None);
            let Some((start, _)) = followed.solutions.get(followed.start).cloned() else {
                return Ok(followed);
            };
            let events = match (self.halves.is_some(), starts) {
                (true, [Some((backward, _)), Some((forward, _))]) => {
                    let special = curve.special_at_border([&backward.reversed(), &forward], false, 0.0);
                    let event = |(kind, solution)| Event { kind, is_located: false, solution };
                    Events { found: special.into_iter().map(event).collect(), unlocated: Vec::new() }
                }
                (true, _) => Events::default(),
                (false, _) => {
                    curve.enter(&start);
                    around_start(curve, &start, first, &[bound], settings)?
                }
            };
            followed.insert_at_start(curve, events);
            return Ok(followed);
        };
        point.tangents.swap(0, 1);
        let middle = curve.at_branch_point(self.unknown, point)?;
        if matches!(forward.stop, Stop::Closed) {
            end_at(&middle, &mut forward.solutions, 2.0 * distance, &curve.system.scales);
        }
        let middle = (middle, Origin::Special(SpecialKind::BranchPoint));
        Ok(BothWays::join([backward, forward], Some(middle)))
    }
}

/// How a branch leaves a start on a border between two pieces of the field, backward and forward; `None` where the start is on none.
fn leaving_border(curve: &mut EquilibriumCurve<'_>, start: &[f64]) -> Option<[Option<HalfBranch>; 2]> {
    let Piece { cells, is_on_border: true } = curve.piece_at(start)? else { return None };
    let mut halves = curve.half_branches(start, &cells);
    let rate = |half: &HalfBranch| half.tangent.last().copied().unwrap_or(0.0);
    halves.sort_by(|one, other| rate(one).total_cmp(&rate(other)));
    // Of several branches the one on which the parameter changes fastest.
    let forward = halves.pop()?;
    let backward = if halves.is_empty() { None } else { Some(halves.swap_remove(0)) };
    Some([backward, Some(forward)])
}

/// Has a closed branch end at the branch point from which it started, which it finds again, and not the distance of the
/// departure behind it.
fn end_at(
    branch_point: &Solution<EquilibriumInspection>,
    solutions: &mut Vec<(Solution<EquilibriumInspection>, Origin<SpecialKind>)>,
    reach: f64,
    scales: &[f64],
) {
    solutions.pop();
    solutions.pop_if(|(last, origin)| {
        let difference = last.unknown.iter().zip(&branch_point.unknown).map(|(a, b)| a - b);
        matches!(origin, Origin::Special(_)) && length(&difference.collect::<Vec<_>>(), scales) < reach
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
