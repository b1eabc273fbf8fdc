//! A second witness for the cycles that are shown: each is solved for once more on meshes that are twice as fine.
//!
//! The estimate that adapts the mesh along a branch is a local one: it knows neither how errors are multiplied by the cycle's own
//! sensitivity nor what the mesh does to the multipliers. Here period, extremes and multipliers of one cycle are compared between
//! meshes, the parameter being the same, until they agree; the finest solution is the one that is told, with an error that was
//! measured. What rounding leaves is measured too, by one more step of Newton's method.

use super::asked::Asked;
use super::borders::MOST_FITS;
use super::branch::{CycleBranch, CyclePoint};
use super::curve::CycleCurve;
use super::floquet::{Floquet, multiplier_changes};
use super::limit_cycle::LimitCycle;
use super::orbit::Orbit;
use super::sizes::StateSizes;
use super::variational::{KnownOrbit, resolved_multipliers};
use crate::branch::SpecialKind;
use crate::collocation::equations::Collocation;
use crate::collocation::global_error::NOTHING_KNOWN;
use crate::collocation::mesh::halved;
use crate::continuation::{Adaptation, Curve, Equations, Settings, Stop, correct};
use crate::linear::multiplier::Multiplier;

/// Times that the intervals are halved at most.
const MOST_HALVINGS: usize = 6;
/// Halving goes on until period and extremes change by less than this, relative to themselves and to the amplitudes,
const CHANGE: f64 = 1e-6;
/// or than this many times the tolerance asked for,
const ACCEPTED: f64 = 100.0;
/// and the multipliers, as far as their logarithms are above `LOGARITHM`, by less than this part of themselves.
const MULTIPLIER_CHANGE: f64 = 1e-2;
const LOGARITHM: f64 = -18.0;
/// Part of the change that is left as the error on the finer mesh, where it is not measured: polynomials of degree 3 leave a
/// sixteenth, others less.
const LEFT: f64 = 1.0 / 16.0;
/// A change of a solution from mesh to mesh that is at most this many times the estimate of its error confirms it.
const AS_ESTIMATED: f64 = 3.0;
/// Newton's method is at its end where its last step is rounding; its size counts this many times.
const ROUNDING: f64 = 3.0;
/// Nothing is told to be more exact than this.
const LEAST_ERROR: f64 = 1e-13;
/// A solution this close to where Newton's method started, in the metric, has the multipliers of the Jacobian there: they are wrong by
/// about as much, on both meshes alike.
const CLOSE: f64 = 1e-13;
/// Updates of Newton's method are to become this small.
const TOLERANCE: f64 = 1e-12;

/// Margin, in errors, within which a multiplier counts as on the unit circle.
const MARGIN: f64 = 3.0;

/// What is told of a cycle and compared between meshes.
struct Told {
    period: f64,
    /// Largest and smallest value of every state.
    extremes: Vec<[f64; 2]>,
    /// The multipliers other than the trivial one, the largest modulus first.
    multipliers: Vec<Multiplier>,
}

/// A cycle on one of the meshes.
struct Level<'a> {
    mesh: Vec<f64>,
    unknown: Vec<f64>,
    told: Told,
    floquet: Floquet,
    problem: LimitCycle<'a>,
    /// What extremes count against.
    sizes: Vec<f64>,
    /// Part of period and extremes that is rounding.
    rounding: f64,
    /// What the defect says of the error.
    estimate: f64,
}

impl<'a> Asked<'a> {
    /// Confirms the cycles at the parameter values that were asked for, and those at the ends, as far as they can be. (Where a
    /// monitor has a value the parameter may be more sensitive than the cycle.) `renew` computes what depends on a cycle that became finer.
    pub(super) fn confirm(
        &self,
        branch: &mut CycleBranch,
        at: &[f64],
        renew: &mut dyn FnMut(&mut CyclePoint),
    ) {
        if branch.stops.iter().flatten().any(|stop| matches!(stop, Stop::Interrupted)) {
            return;
        }
        let last = branch.points.len().saturating_sub(1);
        let mut sizes = None;
        for (index, point) in branch.points.iter_mut().enumerate() {
            let is_shown = match point.label {
                None => index == 0 || index == last,
                Some(label) => label.kind == SpecialKind::Requested && at.contains(&point.value),
            };
            if is_shown && point.orbit.mesh.len() > 1 {
                self.confirm_cycle(point, &mut sizes);
                renew(point);
            }
        }
    }

    /// Replaces a cycle by the finest solution and its errors by those that were measured. Of one for which a finer mesh has no
    /// solution at the same parameter value nothing is certain: its error is told to be the whole. What the nonlinearity of the field says
    /// of `sizes` is computed for the first cycle.
    fn confirm_cycle(&self, point: &mut CyclePoint, sizes: &mut Option<StateSizes>) {
        let degree = point.orbit.degree;
        let mut unknown = point.orbit.states.clone();
        unknown.extend([point.period, point.value]);
        let mut mesh = point.orbit.mesh.clone();
        let mut before = Told::of(point);
        let mut estimated = point.error_estimate;
        let mut last_change = None;
        let enough = CHANGE.max(ACCEPTED * self.resolution.tolerance);
        for _ in 0..MOST_HALVINGS {
            if mesh.len() - 1 > self.resolution.most_intervals {
                break;
            }
            let level = self.solve_on_halves((&mesh, &unknown), degree, point.neutral, sizes);
            // One that differs by its whole size is another cycle.
            let level = level.filter(|level| level.change_from(&before) < NOTHING_KNOWN);
            let Some(mut level) = level else {
                if last_change.is_none() {
                    (point.error_estimate, point.stable) = (NOTHING_KNOWN, None);
                }
                break;
            };
            let change = level.change_from(&before);
            let mut errors = multiplier_changes(&level.told.multipliers, &before.multipliers);
            errors.iter_mut().for_each(|error| *error = error.max(level.floquet.measured_error));
            // Where the change is what was estimated the estimate on the finer mesh holds too, else what the change leaves.
            let error = if change <= AS_ESTIMATED * estimated {
                level.estimate
            } else {
                change * last_change.map_or(LEFT, |last: f64| (change / last).clamp(LEFT, 1.0))
            };
            let error = error.max(ROUNDING * level.rounding).max(LEAST_ERROR);
            estimated = level.estimate;
            let mut ends = change < enough && are_resolved(&level.floquet, &errors);
            if change < enough && !ends {
                let orbits = [(&mesh, &unknown), (&level.mesh, &level.unknown)];
                let orbits = orbits.map(|(mesh, unknown)| KnownOrbit { mesh, degree, unknown });
                let changes =
                    |now: &Floquet, then: &Floquet| multiplier_changes(&now.nontrivial, &then.nontrivial);
                let resolved = resolved_multipliers(&level.problem, orbits, changes, are_resolved);
                if let Some((floquet, changes)) = resolved {
                    level.told.multipliers = floquet.nontrivial.clone();
                    (level.floquet, errors, ends) = (floquet, changes, true);
                } else if level.floquet.measured_error > 0.0 {
                    // Exponentials have settled already.
                    ends = true;
                }
            }
            level.tell(point, error, &errors, &before.multipliers);
            if ends {
                break;
            }
            last_change = Some(change);
            Level { mesh, unknown, told: before, .. } = level;
        }
    }

    /// The cycle at the same parameter value, or the one of a neutral family that is as large, with every interval of the mesh
    /// halved.
    fn solve_on_halves(
        &self,
        (mesh, unknown): (&[f64], &[f64]),
        degree: usize,
        neutral: bool,
        sizes: &mut Option<StateSizes>,
    ) -> Option<Level<'a>> {
        let halves = halved(mesh);
        let coarse = Collocation::new(self.problem(), mesh.to_vec(), degree);
        let mut unknown = coarse.carry(unknown, &halves);
        let fine = Collocation::new(self.problem(), halves.clone(), degree);
        let width = self.bound.width();
        let sizes = sizes.get_or_insert_with(|| StateSizes::new(&fine.problem, &unknown, width)).anew();
        let mut curve = CycleCurve::with_sizes(fine, (self.resolution, width), &unknown, sizes);
        let mut border = vec![0.0; unknown.len()];
        if neutral {
            let [end, dimension] = [unknown.len() - 2, self.field.dimension()];
            let states = unknown[..end].to_vec();
            let orbit = Orbit { mesh: halves.clone(), degree, dimension, states, period: unknown[end] };
            let mut growth = orbit.deviation();
            growth.extend([0.0, 0.0]);
            curve.apply_metric(&growth, &mut border);
        } else {
            *border.last_mut()? = 1.0;
        }
        let settings = Settings { corrector_tolerance: TOLERANCE, ..self.settings };
        let mut correction = correct(&mut curve, &mut unknown, &border, &settings).ok()?;
        // A cycle between two steps still has the borders of one of these.
        let mut fits = 0;
        while curve.fit_segments(&mut unknown, &mut [&mut border]).ok()? != Adaptation::Unchanged {
            fits += 1;
            (fits <= MOST_FITS).then_some(())?;
            correct(&mut curve, &mut unknown, &border, &settings).ok()?;
            correction.distance = f64::INFINITY;
        }
        // Without the guard of a step along the branch Newton's method may come to what is no cycle.
        curve.holds(&unknown).then_some(())?;
        let mut update = vec![0.0; unknown.len()];
        if correction.distance < CLOSE {
            curve.residual(&unknown, &mut update);
        } else if curve.factorize(&unknown, &border, &mut update) == 0.0 {
            return None;
        }
        *update.last_mut()? = 0.0;
        curve.solve(&mut update);
        let inspection = curve.inspect(&unknown, &border, 0.0).ok()?;
        // The border of a parameter that is held stands for a tangent along which nothing else changes.
        let [fixed, across] = curve.errors(&unknown, &border);
        let estimate = if neutral { across } else { fixed };
        let extremes: Vec<[f64; 2]> =
            inspection.extremes.iter().map(|extremes| [extremes.largest, extremes.smallest]).collect();
        // A state counts as what it is, or as its amplitude where that is more.
        let sizes: Vec<f64> = extremes
            .iter()
            .zip(&curve.amplitudes)
            .map(|([max, min], amplitude)| (max - min).max(max.abs()).max(min.abs()).max(*amplitude))
            .collect();
        let (states, scalars) = update.split_at(update.len() - 2);
        let period = unknown[unknown.len() - 2];
        let noise = states.iter().zip(sizes.iter().cycle()).map(|(value, size)| (value / size).abs());
        let rounding = noise.fold((scalars[0] / period).abs(), f64::max);
        rounding.is_finite().then_some(())?;
        let multipliers = inspection.floquet.nontrivial.clone();
        Some(Level {
            mesh: curve.collocation.mesh().to_vec(),
            told: Told { period, extremes, multipliers },
            unknown,
            floquet: inspection.floquet,
            problem: curve.collocation.problem,
            sizes,
            rounding,
            estimate,
        })
    }
}

impl Told {
    fn of(point: &CyclePoint) -> Self {
        let mut multipliers: Vec<Multiplier> =
            point.multipliers.iter().copied().map(Multiplier::from).collect();
        let from_one = |multiplier: &Multiplier| (multiplier.to_complex() - 1.0).norm();
        let trivial = (0..multipliers.len())
            .min_by(|&a, &b| from_one(&multipliers[a]).total_cmp(&from_one(&multipliers[b])));
        if let Some(trivial) = trivial {
            multipliers.remove(trivial);
        }
        Self {
            period: point.period,
            extremes: point.max.iter().zip(&point.min).map(|(max, min)| [*max, *min]).collect(),
            multipliers,
        }
    }
}

impl Level<'_> {
    /// Largest change of period and extremes, relative to the period and to the sizes of the states.
    fn change_from(&self, before: &Told) -> f64 {
        let states = self.told.extremes.iter().zip(&before.extremes).zip(&self.sizes);
        let extremes =
            states.flat_map(|((now, then), size)| [0, 1].map(|end| ((now[end] - then[end]) / size).abs()));
        extremes.fold((self.told.period / before.period - 1.0).abs(), f64::max)
    }

    /// Tells the point what was found on this mesh, with the errors that were measured.
    fn tell(&self, point: &mut CyclePoint, error: f64, errors: &[f64], before: &[Multiplier]) {
        point.period = self.told.period;
        point.max = self.told.extremes.iter().map(|[max, _]| *max).collect();
        point.min = self.told.extremes.iter().map(|[_, min]| *min).collect();
        point.error_estimate = error;
        point.multipliers = self.floquet.multipliers();
        point.trivial_multiplier_error = self.floquet.trivial_error;
        point.unstable_multipliers = self.floquet.unstable().count;
        let sides = self.told.multipliers.iter().zip(before).zip(errors).map(|((now, then), error)| {
            let [now, then] = [now.log_modulus, then.log_modulus];
            // One that moves away from the circle as the mesh gets finer is on its side of it, and so is one that dies out.
            let is_decided = now.abs() > MARGIN * error
                || (now * then > 0.0 && now.abs() >= then.abs())
                || now.max(then) < LOGARITHM;
            is_decided.then_some(now < 0.0)
        });
        point.stable = self.floquet.verdict(sides).filter(|_| !point.neutral);
        point.multiplier_errors = self.floquet.errors(errors);
        point.orbit.mesh = self.mesh.clone();
        point.orbit.states = self.unknown[..self.unknown.len() - 2].to_vec();
        point.orbit.period = self.told.period;
    }
}

/// Whether multipliers change little from mesh to mesh, as far as they count, and do not contradict Liouville's formula.
fn are_resolved(floquet: &Floquet, changes: &[f64]) -> bool {
    let counted = changes.iter().zip(&floquet.nontrivial);
    let mut counted = counted.filter(|(_, multiplier)| multiplier.log_modulus > LOGARITHM);
    // Exponentials on parts of the same width, as they may take on both meshes, do not witness each other.
    floquet.measured_error == 0.0
        && floquet.defect() < MULTIPLIER_CHANGE
        && counted.all(|(change, _)| *change < MULTIPLIER_CHANGE)
}
