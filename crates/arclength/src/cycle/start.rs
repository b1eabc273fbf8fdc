//! Asking for a branch of limit cycles: where it starts, and the run from there.

use super::asked::Asked;
use super::branch::{CycleBranch, CyclePoint, FollowedParameter};
use super::curve::CycleInspection;
use super::end::CycleEnd;
use super::hopf_start::HopfStart;
use super::orbit::Orbit;
use super::switching::Branching;
use crate::branch::{
    Branch, Continuation, Criticality, Label, Problem, SpecialKind, invalid, observer, request,
};
use crate::collocation::resolution::Resolution;
use crate::continuation::{
    BothWays, Bound, Observer, Origin, Request, START_ROUNDING, Settings, Solution, Stop, both_ways,
};
use crate::equilibrium::HopfPoint;
use crate::error::Error;
use crate::field::VectorField;
use num_complex::Complex64;

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

impl Asked<'_> {
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
