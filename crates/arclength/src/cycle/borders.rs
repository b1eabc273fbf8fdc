//! The mesh points of a cycle at the borders and events that it passes: they follow these along a branch, the period is counted from
//! elsewhere before one of them leaves the unit time, and a cycle that is told has them where it passes the borders.

use super::curve::{CycleCurve, Fitted, find_exact_segments};
use super::extrema::{Extremes, extremes};
use super::gate::GateFunction;
use super::limit_cycle::LimitCycle;
use super::passages::Touch;
use super::segments::Segments;
use crate::collocation::equations::Collocation;
use crate::collocation::mesh::{SAME_TIME, fit_jumps, jump_times, widen_beside_jumps};
use crate::collocation::problem::BoundaryValueEquations;
use crate::continuation::{Adaptation, Curve, Equations, correct};
use crate::error::{CorrectionFailure, Error};

/// A cycle with mesh points at its borders, its extremes, and its errors as [`CycleCurve::errors`] tells them.
pub(super) struct Refitted {
    pub fitted: Fitted,
    pub extremes: Vec<Extremes>,
    pub errors: [f64; 2],
}

/// Times that mesh points are moved to the borders that a cycle passes, at most.
pub(super) const MOST_FITS: usize = 6;

impl CycleCurve<'_> {
    /// Has mesh points be the gates that the cycle passes, and the segments those that it goes through.
    ///
    /// # Errors
    /// [`Error::TooManyBorders`]; [`Error::NotFound`] where an event does not happen that has to, or not with the same others;
    /// [`Error::EventWithoutJump`] for a start that passes an event without the jump.
    pub(super) fn fit_segments(
        &mut self,
        unknown: &mut Vec<f64>,
        vectors: &mut [&mut Vec<f64>],
    ) -> Result<Adaptation, Error> {
        if let Some(error) = self.segments_error.take() {
            return Err(error);
        }
        if self.collocation.problem.segments.is_none() {
            return Ok(Adaptation::Unchanged);
        }
        let is_turned = self.passes_borders_outside(unknown) && self.keep_borders_inside(unknown, vectors);
        let moved = fit_jumps(&mut self.collocation, unknown, vectors);
        if let Some(event) = self.lost_event(unknown, moved) {
            self.lost = Some(event);
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        let has_jumps = self.collocation.problem.segments.as_ref().is_some_and(Segments::has_jumps);
        if moved.is_none() && has_jumps {
            // The polynomials would go on beyond an event.
            return Err(Error::NotFound { sought: "cycle", cause: CorrectionFailure::Diverged });
        }
        let collocation = &mut self.collocation;
        let known = collocation.problem.segments.clone();
        let mesh = collocation.mesh().to_vec();
        find_exact_segments(collocation, unknown)?;
        let found = &mut collocation.problem.segments;
        match found.as_ref().and_then(|found| found.touched) {
            Some(Touch { function: GateFunction::Condition { event }, .. }) if !self.is_clear => {
                return Err(Error::EventWithoutJump { event: event + 1 });
            }
            touched => self.is_clear |= touched.is_none(),
        }
        let is_same = found.as_ref().zip(known.as_ref()).is_some_and(|(found, known)| found.are_like(known));
        let touches = found.as_ref().is_some_and(|found| found.touched.is_some());
        if moved.is_some() && (is_same || touches) {
            // Beyond a grazing the cycle is still that of before, as far as its end is located.
            *found = known;
        } else if let Some(segments) = found {
            let finer = with_points(&mesh, &segments.times);
            collocation.move_to_mesh(finer, unknown, vectors);
        }
        let is_turned = self.keep_borders_inside(unknown, vectors) || is_turned;
        let is_moved = !(is_same || touches) || moved.is_none_or(|moved| moved > SAME_TIME);
        Ok(if is_moved || is_turned { Adaptation::Changed } else { Adaptation::Unchanged })
    }

    /// Whether a border whose mesh point is inside the unit time is passed outside.
    fn passes_borders_outside(&self, unknown: &[f64]) -> bool {
        let passed = jump_times(&self.collocation, unknown).unwrap_or_default();
        passed.iter().any(|time| *time <= 0.0 || *time >= 1.0)
    }

    /// Counts the unit time from elsewhere where a border comes close to where it is counted from, or is passed beyond; whether it did.
    fn keep_borders_inside(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> bool {
        let collocation = &self.collocation;
        let Some(segments) = &collocation.problem.segments else { return false };
        let passed = jump_times(collocation, unknown);
        let passed = passed.as_deref().unwrap_or(&segments.times);
        let Some(origin) = segments.better_origin(collocation.mesh(), passed) else { return false };
        if !collocation.mesh().contains(&origin) {
            let mut finer = collocation.mesh().to_vec();
            finer.insert(finer.partition_point(|time| *time < origin), origin);
            self.collocation.move_to_mesh(finer, unknown, vectors);
        }
        let origin = self.collocation.mesh().partition_point(|time| *time < origin);
        self.count_from(origin, unknown, vectors);
        true
    }

    /// Whether a cycle comes to every event at which it jumps, in their order: where it does not, the equations have no meaning.
    pub(super) fn comes_to_its_events(&self, unknown: &[f64]) -> bool {
        if !self.collocation.problem.segments.as_ref().is_some_and(Segments::has_jumps) {
            return true;
        }
        let times = jump_times(&self.collocation, unknown);
        times.is_some_and(|times| times.windows(2).all(|pair| pair[0] < pair[1]))
    }

    /// Whether a cycle crosses only borders that the fields beside them let it cross.
    pub(super) fn crosses_where_it_may(&self, unknown: &[f64]) -> bool {
        let problem = &self.collocation.problem;
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = unknown[unknown.len() - 1];
        let polynomials = self.collocation.polynomials(unknown);
        let segments = problem.segments.as_ref();
        segments.is_none_or(|segments| segments.crossings_hold(problem.field, polynomials, &parameters))
    }

    /// Whether a cycle passes its borders and events close to their mesh points.
    pub(super) fn passes_its_gates(&self, unknown: &[f64]) -> bool {
        self.collocation.problem.segments.is_none()
            || !unknown.iter().all(|value| value.is_finite())
            || jump_times(&self.collocation, unknown).is_some()
    }

    /// The event that a cycle does not come to where it has to, or with other events than known; `moved` is how far mesh points were
    /// moved to the gates.
    fn lost_event(&self, unknown: &[f64], moved: Option<f64>) -> Option<usize> {
        let collocation = &self.collocation;
        let problem = &collocation.problem;
        let segments = problem.segments.as_ref().filter(|segments| segments.has_jumps())?;
        let (states, scalars) = unknown.split_at(unknown.len() - 2);
        let is_lost = |(index, point): (usize, usize)| {
            let before = collocation.end_of(states, point - 1);
            let event = segments.event_of(index)?;
            problem.delay(index, &before, scalars).is_none().then_some(event)
        };
        if moved.is_none() {
            return collocation.jump_points().into_iter().enumerate().find_map(is_lost);
        }
        let is_there = moved.is_some_and(|moved| moved <= SAME_TIME);
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = scalars[1];
        let polynomials = collocation.polynomials(unknown);
        let holds = !is_there || segments.jumps_hold(problem.field, polynomials, &parameters);
        let first = (0..segments.times.len()).find_map(|index| segments.event_of(index));
        first.filter(|_| !holds)
    }

    /// The same cycle with mesh points at the borders; `None` where the mesh has them. The curve stays as it is.
    ///
    /// # Errors
    /// [`Error::NotFound`] where the cycle is not found with such mesh points.
    pub(super) fn fitted(&mut self, unknown: &[f64], tangent: &[f64]) -> Result<Option<Refitted>, Error> {
        if !self.collocation.problem.has_borders() {
            return Ok(None);
        }
        let kept = (self.collocation.mesh().to_vec(), self.collocation.problem.segments.clone());
        let mut fitted = self.refitted(unknown, tangent, false);
        let across = |found: &Result<Option<Refitted>, CorrectionFailure>| match found {
            Ok(found) => found.as_ref().map_or(0.0, |refitted| refitted.errors[1]),
            Err(_) => f64::INFINITY,
        };
        if across(&fitted) > self.resolution.tolerance {
            self.collocation.problem.segments.clone_from(&kept.1);
            self.collocation.set_mesh(kept.0.clone(), unknown);
            let widened = self.refitted(unknown, tangent, true);
            if across(&widened) < across(&fitted) {
                fitted = widened;
            }
        }
        self.collocation.problem.segments = kept.1;
        self.collocation.set_mesh(kept.0, unknown);
        fitted.map_err(|cause| Error::NotFound { sought: "cycle with mesh points at its borders", cause })
    }

    /// As [`fitted`](Self::fitted), on the mesh as it is or, if `widened`, on one without narrow intervals beside borders. The mesh is left
    /// where it ends.
    fn refitted(
        &mut self,
        unknown: &[f64],
        tangent: &[f64],
        widened: bool,
    ) -> Result<Option<Refitted>, CorrectionFailure> {
        let (mut moved, mut direction) = (unknown.to_vec(), tangent.to_vec());
        let mut border = vec![0.0; direction.len()];
        let settings = self.settings;
        if self.passes_borders_outside(unknown) {
            self.keep_borders_inside(&mut moved, &mut [&mut direction]);
        }
        if widened {
            let amplitudes = self.amplitudes.clone();
            widen_beside_jumps(&mut self.collocation, &amplitudes, &mut moved, &mut [&mut direction]);
        }
        let mut fits = 0;
        loop {
            match fit_jumps(&mut self.collocation, &mut moved, &mut [&mut direction]) {
                Some(distance) if distance <= SAME_TIME => break,
                Some(_) if fits < MOST_FITS => fits += 1,
                _ => return Err(CorrectionFailure::Diverged),
            }
            border.resize(direction.len(), 0.0);
            self.apply_metric(&direction, &mut border);
            correct(self, &mut moved, &border, &settings)?;
        }
        if fits == 0 {
            return Ok(None);
        }
        let mut residual = vec![0.0; moved.len()];
        if self.factorize(&moved, &border, &mut residual) == 0.0 {
            return Err(CorrectionFailure::Singular);
        }
        let errors = self.errors(&moved, &direction);
        let extremes = extremes(&self.collocation, &moved, self.collocation.problem.dimension());
        moved.truncate(moved.len() - 2);
        let fitted = Fitted { mesh: self.collocation.mesh().to_vec(), states: moved };
        Ok(Some(Refitted { fitted, extremes, errors }))
    }

    /// Counts the unit time from a mesh point on.
    fn count_from(&mut self, origin: usize, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) {
        let collocation = &mut self.collocation;
        let size = collocation.interval_size();
        let intervals = collocation.intervals();
        let old = collocation.mesh().to_vec();
        let start = old[origin];
        let mut mesh: Vec<f64> = old[origin..intervals].iter().map(|time| time - start).collect();
        mesh.extend(old[..origin].iter().map(|time| time + (1.0 - start)));
        mesh.push(1.0);
        let points = collocation.jump_points();
        if let Some(segments) = &mut collocation.problem.segments {
            segments.count_from(start, intervals - origin, &points, &mesh);
        }
        let turn = |vector: &mut Vec<f64>| vector[..intervals * size].rotate_left(origin * size);
        turn(unknown);
        vectors.iter_mut().for_each(|vector| turn(vector));
        collocation.set_mesh(mesh, unknown);
    }
}

/// Gives an orbit whose mesh does not tell the borders apart that it passes mesh points at them; `vector` is carried over.
///
/// # Errors
/// [`Error::TooManyBorders`].
pub(super) fn tell_borders_apart(
    collocation: &mut Collocation<LimitCycle<'_>>,
    unknown: &mut Vec<f64>,
    vector: &mut Vec<f64>,
) -> Result<(), Error> {
    find_exact_segments(collocation, unknown)?;
    let Some(segments) = collocation.problem.segments.take() else { return Ok(()) };
    // At a jump there are two mesh points.
    if !segments.has_jumps() && segments.crowd_on(collocation.mesh()) {
        let finer = with_points(collocation.mesh(), &segments.times);
        collocation.move_to_mesh(finer, unknown, &mut [vector]);
    }
    Ok(())
}

/// A mesh with more points; those of before that are close to one of them give way.
fn with_points(mesh: &[f64], times: &[f64]) -> Vec<f64> {
    let is_apart = |(index, point): &(usize, &f64)| {
        if *index == 0 || *index + 1 == mesh.len() {
            return true;
        }
        let gap = GIVES_WAY * (mesh[index + 1] - mesh[index - 1]);
        times.iter().all(|time| (time - **point).abs() > gap)
    };
    let kept = mesh.iter().enumerate().filter(is_apart).map(|(_, point)| *point);
    let mut all: Vec<f64> = kept.chain(times.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// A mesh point that is this close to a border, as part of its two intervals, gives way to it.
const GIVES_WAY: f64 = 0.1;
