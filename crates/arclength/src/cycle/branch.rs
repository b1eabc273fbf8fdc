//! Branches of limit cycles: where they start, how they are followed, what is kept of them.

use super::curve::{CycleCurve, CycleInspection, Resolution};
use super::limit_cycle::LimitCycle;
use super::locating::doubling_near;
use super::orbit::Orbit;
use super::special::{Special, Unlocated};
use super::switching::{Branching, HopfStart, Start};
use crate::algebraic::scales::natural_scales;
use crate::collocation::equations::Collocation;
use crate::continuation::{
    Bound, CorrectionFailure, Curve, Followed, Origin, Request, Settings, Solution, Stop, follow,
};
use crate::equilibrium::HopfPoint;
use crate::equilibrium::locating::hopf_point_near;
use crate::erased::ErasedField;
use crate::error::Error;
use crate::field::VectorField;
use num_complex::Complex64;
use std::f64::consts::PI;
use std::ops::{ControlFlow, RangeInclusive};

/// Distance of the first cycle of a new branch from the bifurcation, as part of the size of the cycle there.
const FIRST_DISTANCE: f64 = 0.02;
/// Part of the parameter's range, and of the states, within which a Hopf point may be the end that the last cycle points to.
const NEAR_END: f64 = 0.05;
/// Part of its natural size within which a state that rests on all cycles may be found there.
const RESTING: f64 = 1e-6;
/// The logarithm of its frequency differs from that of the last cycle by less than this.
const SAME_FREQUENCY: f64 = 0.5;
/// Times that this distance is reduced before a start is given up.
const MOST_HALVINGS: usize = 6;

/// A limit cycle of a branch.
#[derive(Clone, Debug)]
pub struct CyclePoint {
    /// Value of the parameter.
    pub value: f64,
    /// Period.
    pub period: f64,
    /// Largest value of each state, of the interpolating polynomial.
    pub max: Vec<f64>,
    /// Smallest value of each state.
    pub min: Vec<f64>,
    /// Floquet multipliers, largest modulus first, the trivial one among them.
    pub multipliers: Vec<Complex64>,
    /// Distance of the computed trivial multiplier from 1.
    pub trivial_multiplier_error: f64,
    /// Number of nontrivial multipliers outside the unit circle.
    pub unstable_multipliers: usize,
    /// Whether the cycle is stable; `None` when a multiplier is closer to the unit circle than the error.
    pub stable: Option<bool>,
    /// Error estimate relative to the amplitudes.
    pub error_estimate: f64,
    /// Why the cycle is part of the branch.
    pub role: Role,
    /// Coefficients of the normal form of a special cycle by name. Fold: `quadratic_coefficient` `b` of `dxi/dt = b xi^2`;
    /// period doubling: `cubic_coefficient` `c` of `dxi/dt = c xi^3`; torus bifurcation: `argument` of the multipliers and
    /// `cubic_coefficient`, the real part of `d` of `dxi/dt = i omega xi + d xi |xi|^2`, with its imaginary part. Negative
    /// cubic coefficients mean that the new solutions are stable within the centre manifold.
    pub normal_form: Vec<(&'static str, f64)>,
    /// Start of the branch that leaves here: doubled cycles at a period doubling, the other branch at a branch point.
    pub branching: Option<Branching>,
    /// Test functions by name: each changes sign at one kind of special cycle.
    pub tests: Vec<(&'static str, f64)>,
    /// The cycle itself.
    pub orbit: Orbit,
}

/// Why a cycle is part of a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// A step of the continuation, or an end of it.
    Step,
    /// Asked for by its parameter value.
    Requested,
    /// A bifurcation.
    Special(Special),
}

/// A branch of limit cycles in the order in which it is traversed.
#[derive(Debug)]
pub struct CycleBranch {
    /// Name of the parameter.
    pub parameter: String,
    /// The cycles.
    pub points: Vec<CyclePoint>,
    /// Why the branch ends, at its first and at its last point; the first is `None` where it starts at a
    /// Hopf point.
    pub stops: (Option<Stop>, Stop),
    /// Changes of test functions behind which no special cycle could be located: look there with smaller steps.
    pub unlocated: Vec<Unlocated>,
}

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
            // They only set the size of the first cycle.
            crossing_speed: point.crossing_speed.unwrap_or(0.0),
            cubic_coefficient: point.c1_real.unwrap_or(0.0),
        }
    }
}

/// A branch of limit cycles to be followed.
///
/// ```
/// use arclength::cycle::{CycleStart, Cycles};
/// use arclength::{Scalar, VectorField};
/// use num_complex::Complex64;
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
/// let half = 0.5_f64.sqrt();
/// let start = CycleStart::Hopf {
///     state: vec![0.0; 2],
///     frequency: 1.0,
///     eigenvector: vec![Complex64::new(half, 0.0), Complex64::new(0.0, -half)],
///     crossing_speed: 1.0,
///     cubic_coefficient: -1.0,
/// };
/// let branch = Cycles::of(&Circle, start).parameters(&[0.0]).along(0, 0.0..=1.0).at(&[0.25]).run()?;
/// let quarter = branch.points.iter().find(|cycle| cycle.value == 0.25).unwrap();
/// assert!((quarter.max[0] - 0.5).abs() < 1e-8);
/// assert_eq!(quarter.stable, Some(true));
/// # Ok::<(), arclength::Error>(())
/// ```
pub struct Cycles<'a> {
    field: ErasedField<'a>,
    start: CycleStart,
    parameters: Vec<f64>,
    active: usize,
    range: (f64, f64),
    values: Vec<f64>,
    resolution: Resolution,
    settings: Settings,
    observer: Box<Observer<'a>>,
}

/// Told every cycle of a branch as it is found; may end the run.
type Observer<'a> = dyn FnMut(f64, f64) -> ControlFlow<()> + 'a;

impl<'a> Cycles<'a> {
    /// Cycles of the field, from a start.
    pub fn of<F: VectorField>(field: &'a F, start: CycleStart) -> Self {
        Self {
            field: ErasedField::of(field),
            start,
            parameters: Vec::new(),
            active: 0,
            range: (f64::NEG_INFINITY, f64::INFINITY),
            values: Vec::new(),
            resolution: Resolution::default(),
            settings: Settings::default(),
            observer: Box::new(|_, _| ControlFlow::Continue(())),
        }
    }

    /// All parameter values at the start.
    pub fn parameters(mut self, parameters: &[f64]) -> Self {
        self.parameters = parameters.to_vec();
        self
    }

    /// The parameter to vary, by index, and its range.
    pub fn along(mut self, parameter: usize, range: RangeInclusive<f64>) -> Self {
        self.active = parameter;
        self.range = (*range.start(), *range.end());
        self
    }

    /// Parameter values at which cycles are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.values = values.to_vec();
        self
    }

    /// Resolution of the cycles.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }

    /// Settings of the continuation.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Somebody to tell parameter and period of every cycle found, who may end the run.
    pub fn observer(mut self, observer: impl FnMut(f64, f64) -> ControlFlow<()> + 'a) -> Self {
        self.observer = Box::new(observer);
        self
    }

    /// Follows the branch: from a Hopf point the one way there is, from a cycle both ways.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a start or range that makes no sense, [`Error::NotFound`] when no cycle is found
    /// near the start.
    pub fn run(mut self) -> Result<CycleBranch, Error> {
        self.validate()?;
        let parameter = self.field.parameter_names()[self.active].clone();
        let request = Request {
            bounds: vec![Bound { from_end: 1, lower: self.range.0, upper: self.range.1 }],
            values: self.values.clone(),
            settings: self.settings,
        };
        let width = self.range.1 - self.range.0;
        let mut unlocated = Vec::new();
        let degree = self.resolution.degree;
        let (points, stops) = match self.start.clone() {
            CycleStart::Hopf { state, frequency, eigenvector, crossing_speed, cubic_coefficient } => {
                let hopf = HopfStart {
                    state: &state,
                    frequency,
                    eigenvector: &eigenvector,
                    crossing_speed,
                    cubic_coefficient,
                };
                let forward = self.be_born(&hopf, &request, &mut unlocated)?;
                (points_of(&forward, degree), (None, forward.stop))
            }
            CycleStart::Orbit(orbit) => {
                let mut unknown = orbit.states.clone();
                unknown.extend([orbit.period, self.parameters[self.active]]);
                let mut tangent = vec![0.0; unknown.len()];
                tangent[unknown.len() - 1] = width;
                let mut start = Start { unknown, tangent, mesh: orbit.mesh.clone(), degree: orbit.degree };
                let forward = match self.follow(&start, &request, false, &mut unlocated) {
                    // At a fold the parameter stands still: the size of the cycle changes.
                    Err(Error::NotFound { sought, cause }) => {
                        start.tangent = orbit.deviation();
                        start.tangent.extend([0.0, 0.0]);
                        self.follow(&start, &request, false, &mut unlocated)
                            .map_err(|_| Error::NotFound { sought, cause })?
                    }
                    result => result?,
                };
                if matches!(forward.stop, Stop::Closed | Stop::Interrupted) {
                    let other =
                        if matches!(forward.stop, Stop::Closed) { Stop::Closed } else { Stop::Interrupted };
                    (points_of(&forward, start.degree), (Some(other), forward.stop))
                } else {
                    start.tangent.iter_mut().for_each(|entry| *entry = -*entry);
                    let backward = self.follow(&start, &request, false, &mut unlocated)?;
                    let mut points = points_of(&backward, start.degree);
                    points.reverse();
                    points.pop();
                    points.extend(points_of(&forward, start.degree));
                    (points, (Some(backward.stop), forward.stop))
                }
            }
            CycleStart::Branching(branching) => {
                let forward = self.leave(&branching, 1.0, &request, &mut unlocated)?;
                let degree = branching.orbit.degree;
                if branching.doubled {
                    (points_of(&forward, degree), (None, forward.stop))
                } else if matches!(forward.stop, Stop::Closed | Stop::Interrupted) {
                    let mut points = vec![self.branch_point(&branching)?];
                    points.extend(points_of(&forward, degree));
                    (points, (None, forward.stop))
                } else {
                    let backward = self.leave(&branching, -1.0, &request, &mut unlocated)?;
                    let mut points = points_of(&backward, degree);
                    points.reverse();
                    points.push(self.branch_point(&branching)?);
                    points.extend(points_of(&forward, degree));
                    (points, (Some(backward.stop), forward.stop))
                }
            }
        };
        let mut branch = CycleBranch { parameter, points, stops, unlocated };
        self.refine_ends(&mut branch);
        Ok(branch)
    }

    fn problem(&self) -> LimitCycle<'a> {
        LimitCycle {
            field: self.field,
            parameters: self.parameters.clone(),
            active: self.active,
            scales: vec![1.0; self.field.dimension()],
        }
    }

    fn curve(&self, start: &Start) -> CycleCurve<'a> {
        let collocation = Collocation::new(self.problem(), start.mesh.clone(), start.degree);
        let width = self.range.1 - self.range.0;
        let mut curve = CycleCurve::new(collocation, self.resolution, width, &start.unknown);
        curve.settings = self.settings;
        curve
    }

    /// Follows the branch from a start in the direction of its tangent.
    fn follow(
        &mut self,
        start: &Start,
        request: &Request,
        doubled: bool,
        unlocated: &mut Vec<Unlocated>,
    ) -> Result<Followed<CycleInspection>, Error> {
        let mut curve = self.curve(start);
        curve.doubled = doubled;
        let observer = &mut self.observer;
        let (unknown, tangent) = (start.unknown.clone(), start.tangent.clone());
        let followed = follow(&mut curve, unknown, tangent, request, &mut |solution| {
            let end = solution.unknown.len();
            observer(solution.unknown[end - 1], solution.unknown[end - 2])
        })?;
        unlocated.append(&mut curve.unlocated);
        Ok(followed)
    }

    /// Follows the branch from a Hopf point, from a smaller first cycle where there is none near that of the normal form.
    fn be_born(
        &mut self,
        hopf: &HopfStart<'_>,
        request: &Request,
        unlocated: &mut Vec<Unlocated>,
    ) -> Result<Followed<CycleInspection>, Error> {
        let width = self.range.1 - self.range.0;
        // Shorter steps asked for mean a shorter first one.
        let share = (self.settings.initial_step / Settings::default().initial_step).min(1.0);
        let mut amplitude = share * hopf.first_amplitude(width);
        let mut failure = None;
        for _ in 0..MOST_HALVINGS {
            let start = hopf.cycle(self.parameters[self.active], amplitude, self.resolution.degree);
            match self.follow(&start, request, false, unlocated) {
                Err(Error::NotFound { sought, cause }) => {
                    failure.get_or_insert(Error::NotFound { sought, cause });
                    amplitude *= 0.25;
                }
                result => return result,
            }
        }
        Err(failure.unwrap_or(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged }))
    }

    /// The bifurcation itself and the direction of the new branch.
    fn departure(&self, branching: &Branching) -> Start {
        let Branching { orbit, direction, .. } = branching;
        let mut start = Start {
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
    fn branch_point(&self, branching: &Branching) -> Result<CyclePoint, Error> {
        let start = self.departure(branching);
        let mut curve = self.curve(&start);
        let mut border = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut border);
        let mut residual = vec![0.0; start.tangent.len()];
        curve.estimate_error(&start.unknown);
        // Singular there, but the multipliers do not need the border.
        curve.factorize(&start.unknown, &border, &mut residual);
        let mut point = curve.inspect(&start.unknown, &start.tangent, 0.0)?;
        point.special = Some(Special::BranchPoint);
        point.branching = branching.known_branch();
        let solution = Solution { unknown: start.unknown, tangent: start.tangent, orientation: 0.0, point };
        Ok(point_of(&solution, Origin::Special, start.degree))
    }

    /// Follows the branch that leaves another one at a bifurcation, in one of its two directions.
    fn leave(
        &mut self,
        branching: &Branching,
        sign: f64,
        request: &Request,
        unlocated: &mut Vec<Unlocated>,
    ) -> Result<Followed<CycleInspection>, Error> {
        let mut start = self.departure(branching);
        let mut curve = self.curve(&start);
        curve.count_resting_states_fully();
        let mut image = vec![0.0; start.tangent.len()];
        curve.apply_metric(&start.tangent, &mut image);
        let size = start.tangent.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>().sqrt();
        start.tangent.iter_mut().for_each(|entry| *entry *= sign / size);
        let origin = start.unknown.clone();
        let mut distance = FIRST_DISTANCE;
        let mut failure = None;
        for _ in 0..=MOST_HALVINGS {
            start.unknown.clone_from(&origin);
            for (entry, slope) in start.unknown.iter_mut().zip(&start.tangent) {
                *entry += distance * slope;
            }
            match self.follow(&start, request, branching.doubled, unlocated) {
                Err(Error::NotFound { sought, cause }) => {
                    failure.get_or_insert(Error::NotFound { sought, cause });
                    distance *= 0.5;
                }
                result => return result,
            }
        }
        Err(failure.unwrap_or(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged }))
    }

    /// Replaces extrapolated ends of a branch, at Hopf points and period doublings, by the points themselves where Newton's
    /// method finds them.
    fn refine_ends(&self, branch: &mut CycleBranch) {
        let last = branch.points.len().saturating_sub(1);
        let ends = [(0, branch.stops.0.as_mut()), (last, Some(&mut branch.stops.1))];
        for (index, stop) in ends {
            let (Some(stop), Some(point)) = (stop, branch.points.get(index)) else { continue };
            match stop {
                Stop::HopfPoint { parameter, frequency, located } => {
                    let mean: Vec<f64> =
                        point.max.iter().zip(&point.min).map(|(max, min)| 0.5 * (max + min)).collect();
                    let mut parameters = self.parameters.clone();
                    parameters[self.active] = *parameter;
                    let found = hopf_point_near(self.field, &mean, &parameters, self.active, *frequency);
                    if let Some(found) = found.filter(|found| self.may_end_at(found, point, *parameter)) {
                        (*parameter, *frequency, *located) = (found.parameter, found.frequency, true);
                    }
                }
                Stop::PeriodDoubling { parameter, period } => {
                    let width = self.range.1 - self.range.0;
                    let problem = self.problem();
                    let found = doubling_near(&problem, &point.orbit, *parameter, width, &self.settings);
                    if let Some((value, exact)) = found
                        && (value - *parameter).abs() <= (point.value - *parameter).abs()
                    {
                        (*parameter, *period) = (value, exact);
                    }
                }
                _ => {}
            }
        }
    }

    /// Whether the branch whose last cycle is `last`, and which seems to end at the parameter value `estimate`, may end at this
    /// Hopf point.
    fn may_end_at(&self, hopf: &HopfPoint, last: &CyclePoint, estimate: f64) -> bool {
        let width = self.range.1 - self.range.0;
        let distance = (last.value - estimate).abs().max(NEAR_END * width);
        // A state that stays zero is so to rounding only.
        let natural =
            natural_scales(&self.field, &hopf.state, &hopf.parameters, &vec![0.0; hopf.state.len()]);
        let ranges = last.max.iter().zip(&last.min).zip(natural);
        let inside = hopf.state.iter().zip(ranges).all(|(value, ((max, min), natural))| {
            let margin = (max - min) + NEAR_END * max.abs().max(min.abs()) + RESTING * natural;
            (min - margin..=max + margin).contains(value)
        });
        let frequencies = (hopf.frequency * last.period / (2.0 * PI)).ln().abs();
        (hopf.parameter - estimate).abs() <= distance && inside && frequencies < SAME_FREQUENCY
    }

    fn validate(&self) -> Result<(), Error> {
        let invalid = |name: &str, value: String, allowed: &str| {
            Err(Error::Invalid { name: name.into(), value, allowed: allowed.into() })
        };
        let count = self.field.parameter_names().len();
        if self.parameters.len() != count {
            return invalid(
                "parameters",
                format!("{} values", self.parameters.len()),
                &format!("{count} values"),
            );
        }
        match &self.start {
            CycleStart::Orbit(orbit) => orbit.check(self.field.dimension())?,
            CycleStart::Branching(branching) => branching.check(self.field.dimension())?,
            CycleStart::Hopf { .. } => {}
        }
        if self.active >= count {
            return invalid(
                "parameter index",
                self.active.to_string(),
                &format!("0 to {}", count.saturating_sub(1)),
            );
        }
        let finite = self.range.0.is_finite() && self.range.1.is_finite();
        if !(finite && self.range.0 < self.range.1) {
            return invalid(
                "range",
                format!("{}..={}", self.range.0, self.range.1),
                "finite, start below end",
            );
        }
        let value = self.parameters[self.active];
        if !(self.range.0..=self.range.1).contains(&value) {
            return invalid("start value", value.to_string(), "inside the range");
        }
        if !(2..=16).contains(&self.resolution.degree) {
            return invalid("degree", self.resolution.degree.to_string(), "2 to 16");
        }
        let (fewest, most) = (self.resolution.fewest_intervals, self.resolution.most_intervals);
        if !(1 < fewest && fewest <= most) {
            return invalid(
                "fewest intervals",
                fewest.to_string(),
                &format!("2 to {most}, the most intervals"),
            );
        }
        if !(self.resolution.tolerance > 1e-13 && self.resolution.tolerance < 0.1) {
            return invalid("tolerance", self.resolution.tolerance.to_string(), "between 1e-13 and 0.1");
        }
        Ok(())
    }
}

/// Plain data of the solutions found.
fn points_of(followed: &Followed<CycleInspection>, degree: usize) -> Vec<CyclePoint> {
    followed.solutions.iter().map(|(solution, origin)| point_of(solution, *origin, degree)).collect()
}

fn point_of(solution: &Solution<CycleInspection>, origin: Origin, degree: usize) -> CyclePoint {
    let inspection = &solution.point;
    let (states, scalars) = solution.unknown.split_at(solution.unknown.len() - 2);
    let (outside, certain) = inspection.floquet.unstable();
    let special = inspection.special;
    CyclePoint {
        value: scalars[1],
        period: scalars[0],
        max: inspection.ranges.iter().map(|range| range.largest).collect(),
        min: inspection.ranges.iter().map(|range| range.smallest).collect(),
        multipliers: inspection.floquet.multipliers(),
        trivial_multiplier_error: inspection.floquet.trivial_error,
        unstable_multipliers: outside,
        // At a bifurcation a multiplier is on the unit circle by definition.
        stable: if special.is_some() || !certain { None } else { Some(outside == 0) },
        error_estimate: inspection.error_estimate,
        role: match (special, origin) {
            (Some(special), _) => Role::Special(special),
            (None, Origin::Requested) => Role::Requested,
            _ => Role::Step,
        },
        normal_form: inspection.normal_form.clone(),
        branching: inspection.branching.clone(),
        tests: vec![
            ("fold", inspection.fold_test),
            ("branch point", solution.orientation),
            ("period doubling", inspection.doubling_test()),
            ("torus", outside as f64),
        ],
        orbit: Orbit {
            mesh: inspection.mesh.clone(),
            degree,
            states: states.to_vec(),
            period: scalars[0],
            dimension: inspection.ranges.len(),
        },
    }
}

impl CycleBranch {
    /// The bifurcations of the branch.
    pub fn special_points(&self) -> impl Iterator<Item = (Special, &CyclePoint)> {
        self.points.iter().filter_map(|point| match point.role {
            Role::Special(special) => Some((special, point)),
            _ => None,
        })
    }
}
