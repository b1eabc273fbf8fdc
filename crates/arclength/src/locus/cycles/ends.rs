//! The points in which curves of special cycles end: curves of torus bifurcations in strong resonances, Hopf-Hopf and zero-Hopf
//! points, curves of folds in generalised Hopf points and, of doubled cycles, in generalised period doublings. The continuation cannot reach them; other curves on which they are regular points pass them.

use super::branch::{CycleLocusBranch, CycleLocusPoint};
use super::end::CycleLocusEnd;
use super::monitor::NEXT_TO;
use super::run::{Asked, CycleLocus, CycleLocusProblem};
use crate::branch::{Label, SpecialKind};
use crate::collocation::equations::Collocation;
use crate::continuation::{Settings, Stop};
use crate::cycle::limit_cycle::LimitCycle;
use crate::cycle::{CycleEnd, Orbit};
use crate::equilibrium::locating::hopf_point_near;
use crate::error::CorrectionFailure;
use crate::locus::EquilibriumLocus;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Steps either way in which the end has to show on the other curve.
const STEPS: usize = 20;
/// Distance from the last point, in parts of the ranges and of the period, beyond which it is the end of something else.
const NEAR: f64 = 0.2;
/// Part of the largest amplitudes on the curve below which cycles may be about to vanish.
const VANISHING: f64 = 0.3;

impl Asked<'_> {
    /// Adds the ends of the curve that other curves lead to.
    pub(super) fn solve_for_ends(&self, branch: &mut CycleLocusBranch) {
        let ranges = self.two.ranges();
        let (kind, active) = (branch.kind, self.two.active);
        let mut largest: Vec<f64> = Vec::new();
        for point in &branch.points {
            largest.resize(point.max.len(), 0.0);
            largest
                .iter_mut()
                .zip(amplitudes(point))
                .for_each(|(largest, size)| *largest = largest.max(size));
        }
        let is_fold = kind == Some(SpecialKind::FoldOfCycles);
        // The points of codimension two on curves of Hopf points at which the curve may begin.
        let origins: &[SpecialKind] = match kind {
            Some(SpecialKind::FoldOfCycles) => &[SpecialKind::GeneralizedHopf],
            Some(SpecialKind::Torus) => &[SpecialKind::HopfHopf, SpecialKind::ZeroHopf],
            _ => &[],
        };
        let solve = |stop: &mut Stop<CycleLocusEnd>, last: &CycleLocusPoint| -> Option<CycleLocusPoint> {
            let mut parameters = self.parameters.clone();
            active.iter().zip(last.values).for_each(|(&index, value)| parameters[index] = value);
            match stop {
                Stop::Problem(CycleLocusEnd::StrongResonance { order }) => {
                    self.resonance(*order, last, parameters, ranges)
                }
                Stop::StepTooSmall { .. }
                | Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::HopfPoint { .. }))
                    if !origins.is_empty() =>
                {
                    let vanishing =
                        amplitudes(last).zip(&largest).all(|(size, largest)| size <= VANISHING * largest);
                    let (kind, found) = vanishing
                        .then(|| self.hopf_of_codimension_two(origins, last, &parameters, ranges))
                        .flatten()?;
                    let (values, frequency) = (found.values, TAU / found.period);
                    *stop = Stop::Problem(match kind {
                        SpecialKind::HopfHopf => CycleLocusEnd::HopfHopfPoint { values, frequency },
                        SpecialKind::ZeroHopf => CycleLocusEnd::ZeroHopfPoint { values, frequency },
                        _ => CycleLocusEnd::GeneralizedHopfPoint { values, frequency },
                    });
                    Some(found)
                }
                Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::PeriodDoubling { parameter, period }))
                    if is_fold =>
                {
                    let found = self.generalized_period_doubling(last, parameters, ranges)?;
                    (*parameter, *period) = (found.values[0], 0.5 * found.period);
                    Some(found)
                }
                _ => None,
            }
        };
        let mut ends = [None, None];
        let [backward, forward] = &mut branch.stops;
        if let (Some(stop), Some(point)) = (backward.as_mut(), branch.points.first()) {
            ends[0] = solve(stop, point);
        }
        if let (Some(stop), Some(point)) = (forward.as_mut(), branch.points.last()) {
            ends[1] = solve(stop, point);
        }
        if let (None, Some(stop)) = (&ends[0], backward) {
            label_resonance(stop, branch.points.iter_mut());
        }
        if let (None, Some(stop)) = (&ends[1], forward) {
            label_resonance(stop, branch.points.iter_mut().rev());
        }
        let [first, last] = ends;
        branch.extend(first, last);
    }

    /// The strong resonance in which a curve of torus bifurcations ends behind its point `last`. The curve of folds (1:1) or of
    /// period doublings (1:2) that ends there too passes it regularly, so it is located on that one.
    fn resonance(
        &self,
        order: u8,
        last: &CycleLocusPoint,
        parameters: Vec<f64>,
        ranges: [f64; 2],
    ) -> Option<CycleLocusPoint> {
        let (kind, sought, argument) = if order == 1 {
            (SpecialKind::FoldOfCycles, SpecialKind::Resonance1, 0.0)
        } else {
            (SpecialKind::PeriodDoubling, SpecialKind::Resonance2, PI)
        };
        let nearest = self.nearest_on(kind, last.orbit.clone(), parameters, sought, (last.values, ranges))?;
        Some(CycleLocusPoint { argument: Some(argument), coefficient: None, ..nearest })
    }

    /// The point of kind `sought` nearest to the values `from`, on the curve of special cycles `kind` through one near `orbit`.
    fn nearest_on(
        &self,
        kind: SpecialKind,
        orbit: Orbit,
        parameters: Vec<f64>,
        sought: SpecialKind,
        (from, ranges): ([f64; 2], [f64; 2]),
    ) -> Option<CycleLocusPoint> {
        let period = orbit.period;
        let problem =
            CycleLocusProblem { start: Some((Some(kind), orbit)), resolution: self.resolution, held: None };
        let [first, second] = &self.along[..] else { return None };
        let curve = CycleLocus::of_erased(self.field, problem)
            .parameters(&parameters)
            .along(&first.0, first.1.clone())
            .and(&second.0, second.1.clone())
            .settings(Settings { most_steps: STEPS, ..self.settings });
        let distance = |point: &CycleLocusPoint| distance(point.values, from, ranges);
        let found = curve.run().ok()?.points.into_iter();
        let nearest = found
            .filter(|point| point.label.is_some_and(|label| label.kind == sought))
            .min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        (distance(&nearest) < NEAR && (nearest.period / period).ln().abs() < NEAR).then_some(nearest)
    }

    /// The generalised period doubling in which a curve of folds of doubled cycles ends behind its point `last`, located on the
    /// curve of period doublings of the single cycle; as a doubled cycle.
    fn generalized_period_doubling(
        &self,
        last: &CycleLocusPoint,
        parameters: Vec<f64>,
        ranges: [f64; 2],
    ) -> Option<CycleLocusPoint> {
        let single = self.mean_of_halves(&last.orbit, &parameters);
        let kinds = (SpecialKind::PeriodDoubling, SpecialKind::GeneralizedPeriodDoubling);
        let nearest = self.nearest_on(kinds.0, single, parameters, kinds.1, (last.values, ranges))?;
        let once = &nearest.orbit;
        let half = |offset: f64| once.mesh.iter().map(move |time| 0.5 * (time + offset));
        let orbit = Orbit {
            mesh: half(0.0).chain(half(1.0).skip(1)).collect(),
            states: once.states.repeat(2),
            period: 2.0 * once.period,
            ..*once
        };
        Some(CycleLocusPoint {
            period: 2.0 * nearest.period,
            multipliers: nearest.multipliers.iter().map(|value| value * value).collect(),
            coefficient: None,
            tests: Vec::new(),
            orbit,
            ..nearest
        })
    }

    /// The single cycle next to a doubled one: the mean of its halves, on the same number of intervals.
    fn mean_of_halves(&self, orbit: &Orbit, parameters: &[f64]) -> Orbit {
        let problem = LimitCycle {
            field: self.field,
            parameters: parameters.to_vec(),
            active: 0,
            scales: vec![1.0; orbit.dimension],
            segments: None,
        };
        let collocation = Collocation::new(problem, orbit.mesh.clone(), orbit.degree);
        let mut states = Vec::with_capacity(orbit.states.len());
        for pair in orbit.mesh.windows(2) {
            let points = std::iter::once(0.0).chain(collocation.gauss().points.iter().copied());
            for time in points.map(|point| 0.5 * (pair[0] + point * (pair[1] - pair[0]))) {
                let [one, other] = [time, time + 0.5].map(|time| orbit.state_at(time * orbit.period));
                states.extend(one.iter().zip(&other).map(|(a, b)| 0.5 * (a + b)));
            }
        }
        Orbit { mesh: orbit.mesh.clone(), states, period: 0.5 * orbit.period, ..*orbit }
    }

    /// The point of one of some kinds in which a curve ends behind its point `last`, located on the curve of Hopf points of the
    /// frequency of the cycles.
    fn hopf_of_codimension_two(
        &self,
        kinds: &[SpecialKind],
        last: &CycleLocusPoint,
        parameters: &[f64],
        ranges: [f64; 2],
    ) -> Option<(SpecialKind, CycleLocusPoint)> {
        let mean: Vec<f64> = last.max.iter().zip(&last.min).map(|(max, min)| 0.5 * (max + min)).collect();
        let frequency = TAU / last.period;
        let mut near = self
            .two
            .active
            .iter()
            .filter_map(|&index| hopf_point_near(self.field, &mean, parameters, index, frequency));
        let hopf = near.next()?;
        let [first, second] = &self.along[..] else { return None };
        let curve = EquilibriumLocus::of_erased(self.field, None)
            .from_hopf(&hopf)
            .along(&first.0, first.1.clone())
            .and(&second.0, second.1.clone())
            .run()
            .ok()?;
        let distance = |values: [f64; 2]| distance(values, last.values, ranges);
        let found = curve
            .special_points()
            .filter(|point| kinds.contains(&point.kind) && point.regular)
            .min_by(|one, other| distance(one.values).total_cmp(&distance(other.values)))?;
        let critical = found.eigenvalues.iter().filter(|value| value.im > 0.0).min_by(|a, b| {
            let distance = |value: &Complex64| (value - Complex64::new(0.0, frequency)).norm();
            distance(a).total_cmp(&distance(b))
        })?;
        let period = TAU / critical.im;
        // The multipliers of the torus that the cycles are about to leave: of the other critical eigenvalues.
        let argument = match found.kind {
            SpecialKind::ZeroHopf => Some(0.0),
            SpecialKind::HopfHopf => {
                let others = found.eigenvalues.iter().filter(|value| value.im > 0.0 && *value != critical);
                let other = others.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
                let angle = (other.im * period).rem_euclid(TAU);
                Some(angle.min(TAU - angle))
            }
            _ => None,
        };
        if distance(found.values) > NEAR || (period / last.period).ln().abs() > NEAR {
            return None;
        }
        let mut multipliers: Vec<Complex64> =
            found.eigenvalues.iter().map(|value| (value * period).exp()).collect();
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let nearest = multipliers.iter().map(|multiplier| (multiplier - 1.0).norm());
        let point = CycleLocusPoint {
            values: found.values,
            period,
            max: found.state.clone(),
            min: found.state.clone(),
            trivial_multiplier_error: nearest.fold(f64::INFINITY, f64::min),
            multipliers,
            error_estimate: 0.0,
            argument,
            coefficient: None,
            label: Some(Label { kind: found.kind, number: 1 }),
            location_error: Some(found.location_error),
            tests: Vec::new(),
            monitors: Vec::new(),
            orbit: Orbit {
                states: found.state.iter().copied().cycle().take(last.orbit.states.len()).collect(),
                period,
                ..last.orbit.clone()
            },
        };
        Some((found.kind, point))
    }
}

/// Labels the first of `points` where it is next to a resonance that no other curve leads to. The parameters depend on the square
/// of the distance of the argument from that of the resonance: what is left of it gives the errors. A point that is not next to it
/// is no reason to call the end a resonance.
fn label_resonance<'p>(
    stop: &mut Stop<CycleLocusEnd>,
    mut points: impl Iterator<Item = &'p mut CycleLocusPoint>,
) {
    let Stop::Problem(CycleLocusEnd::StrongResonance { order }) = stop else { return };
    let (kind, resonance) =
        if *order == 1 { (SpecialKind::Resonance1, 0.0) } else { (SpecialKind::Resonance2, PI) };
    let (Some(end), Some(before)) = (points.next(), points.next()) else { return };
    let (Some(near), Some(far)) = (end.argument, before.argument) else { return };
    let (near, far) = ((near - resonance).powi(2), (far - resonance).powi(2));
    if near > NEXT_TO * NEXT_TO || far <= near {
        // The curve turned back behind this point, but where it did was not reached.
        *stop = Stop::StepTooSmall { cause: CorrectionFailure::Diverged };
        return;
    }
    if end.label.is_some() {
        return;
    }
    let error = |index: usize| ((end.values[index] - before.values[index]) * near / (far - near)).abs();
    end.location_error = Some([error(0), error(1)]);
    end.label = Some(Label { kind, number: 1 });
}

fn amplitudes(point: &CycleLocusPoint) -> impl Iterator<Item = f64> + '_ {
    point.max.iter().zip(&point.min).map(|(max, min)| 0.5 * (max - min))
}

/// Distance in parts of the ranges.
fn distance(one: [f64; 2], other: [f64; 2], ranges: [f64; 2]) -> f64 {
    let [first, second] = [0, 1].map(|index| (one[index] - other[index]) / ranges[index]);
    first.hypot(second)
}
