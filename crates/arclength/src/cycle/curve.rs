//! The curve of limit cycles of one parameter: mesh adaptation, metric, stability along the way.

use super::collocation::Collocation;
use super::extrema::{Range, ranges};
use super::floquet::{Floquet, floquet};
use super::limit_cycle::LimitCycle;
use super::mesh::{equidistribute, error_profile, intervals_needed};
use super::problem::PeriodicProblem;
use super::special;
use super::switching::Branching;
use crate::algebraic::scales::natural_scales;
use crate::continuation::{Adaptation, Curve, Ending, Settings, Solution, Stop};
use crate::error::Error;
use crate::linear::periodic_schur::PeriodicSchur;
use std::cell::OnceCell;

/// How finely cycles are resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Error estimate, relative to the amplitude of each state variable, that no reported cycle exceeds.
    pub tolerance: f64,
    /// Degree of the polynomials, 2 to 16.
    pub degree: usize,
    /// Fewest mesh intervals.
    pub fewest_intervals: usize,
    /// Most mesh intervals.
    pub most_intervals: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self { tolerance: 1e-8, degree: 7, fewest_intervals: 4, most_intervals: 2000 }
    }
}

/// A new mesh aims at this part of the tolerance.
const TARGET: f64 = 0.2;
/// The mesh is made coarser when it has this many times the intervals needed.
const EXCESS: f64 = 1.6;
/// Part of its mean below which the amplitude of a state does not count as its size.
const MEAN_PART: f64 = 0.01;
/// Part of the size that the nonlinearity of the field gives a state below which it rests.
const RESTING_PART: f64 = 1e-4;
/// Noise floor of the error estimate: part of the mean that is rounding.
const ROUNDING_PART: f64 = 1e-6;
/// The period has to grow to this many times its start, and its rate of change in the parameter beyond
/// [`HOMOCLINIC_SENSITIVITY`], to count as unbounded.
const HOMOCLINIC_GROWTH: f64 = 5.0;
const HOMOCLINIC_SENSITIVITY: f64 = 1e7;
/// Samples for the difference of the halves of a doubled cycle.
const HALF_SAMPLES: usize = 64;

/// What is known about one cycle.
#[derive(Clone, Debug)]
pub struct CycleInspection {
    /// Error estimate relative to the amplitudes.
    pub error_estimate: f64,
    /// Multipliers.
    pub floquet: Floquet,
    /// Largest and smallest value of each state.
    pub(super) ranges: Vec<Range>,
    /// Mesh of this solution.
    pub mesh: Vec<f64>,
    /// Rate of change of the parameter along the curve: zero at a fold.
    pub fold_test: f64,
    /// What is special about the cycle.
    pub special: Option<special::Special>,
    /// Coefficients of its normal form by name.
    pub normal_form: Vec<(&'static str, f64)>,
    /// The branch that leaves here.
    pub branching: Option<Branching>,
}

impl CycleInspection {
    /// Product of `1 + mu` over the real nontrivial multipliers, scaled: zero at a period doubling.
    pub fn doubling_test(&self) -> f64 {
        let real = self.floquet.nontrivial.iter().filter(|multiplier| multiplier.is_real());
        real.map(|multiplier| {
            let value = multiplier.to_complex().re;
            if value.is_finite() { (1.0 + value) / (1.0 + value.abs()) } else { value.signum() }
        })
        .product()
    }
}

/// Limit cycles `u' = T f(u, p)` along one parameter.
#[derive(Debug)]
pub struct CycleCurve<'a> {
    /// The discretised problem.
    pub collocation: Collocation<LimitCycle<'a>>,
    /// Resolution asked for.
    pub resolution: Resolution,
    /// Settings of corrections made while special points are located.
    pub settings: Settings,
    /// Weight of the parameter in the metric: the length of its range.
    pub parameter_scale: f64,
    /// Changes of test functions behind which nothing could be located.
    pub unlocated: Vec<special::Unlocated>,
    period_scale: f64,
    /// Sizes that measure the error: amplitudes.
    amplitudes: Vec<f64>,
    /// Largest amplitudes met on the branch.
    largest: Vec<f64>,
    /// Sizes below which a state counts as one that rests.
    resting: Vec<f64>,
    /// Sizes of the states where the branch starts.
    signature_scales: OnceCell<Vec<f64>>,
    first_period: Option<f64>,
    /// Whether the branch is one of doubled cycles, which ends where they become single again.
    pub doubled: bool,
    error_estimate: f64,
    schur: Option<(usize, PeriodicSchur)>,
}

impl<'a> CycleCurve<'a> {
    /// The curve through a start that is given on the mesh of the collocation.
    pub fn new(
        mut collocation: Collocation<LimitCycle<'a>>,
        resolution: Resolution,
        parameter_scale: f64,
        start: &[f64],
    ) -> Self {
        collocation.set_reference(start);
        let n = collocation.problem.dimension();
        let resting = resting_sizes(&collocation.problem, start);
        let mut curve = Self {
            collocation,
            resolution,
            settings: Settings::default(),
            parameter_scale,
            unlocated: Vec::new(),
            period_scale: 1.0,
            amplitudes: vec![1.0; n],
            largest: vec![0.0; n],
            resting,
            signature_scales: OnceCell::new(),
            first_period: None,
            doubled: false,
            error_estimate: f64::INFINITY,
            schur: None,
        };
        curve.rescale(start);
        curve.collocation.set_reference(start);
        curve
    }

    /// Measures sizes on a solution.
    fn rescale(&mut self, unknown: &[f64]) {
        let n = self.collocation.problem.dimension();
        let states = &unknown[..unknown.len() - 2];
        for component in 0..n {
            let (mut smallest, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
            for value in states.iter().skip(component).step_by(n) {
                smallest = smallest.min(*value);
                largest = largest.max(*value);
            }
            let amplitude = 0.5 * (largest - smallest);
            let mean = 0.5 * (largest + smallest).abs();
            self.largest[component] = self.largest[component].max(amplitude);
            let resting = self.resting[component];
            self.amplitudes[component] = amplitude.max(ROUNDING_PART * mean).max(resting);
            self.collocation.problem.scales[component] =
                amplitude.max(MEAN_PART * mean).max(0.1 * self.largest[component]).max(resting);
        }
        self.period_scale = unknown[unknown.len() - 2].abs();
    }

    /// Gives states that rest the sizes that the nonlinearity of the field gives them, where a branch is left on which they do.
    pub(super) fn count_resting_states_fully(&mut self) {
        for (scale, resting) in self.collocation.problem.scales.iter_mut().zip(&self.resting) {
            *scale = scale.max(resting / RESTING_PART);
        }
    }

    /// Mean squares of the deviations of two solutions from their means, and the mean product of the two.
    fn deviation_products(&self, one: &[f64], other: &[f64]) -> (f64, f64, f64) {
        let n = self.collocation.problem.dimension();
        let end = one.len() - 2;
        let mean = |vector: &[f64], component: usize| {
            let nodes = end / n;
            vector[..end].iter().skip(component).step_by(n).sum::<f64>() / nodes as f64
        };
        let (mut first, mut second, mut mixed) = (0.0, 0.0, 0.0);
        for component in 0..n {
            let scale = self.largest[component].max(self.resting[component]);
            let (mean_one, mean_other) = (mean(one, component), mean(other, component));
            let values = one[..end].iter().zip(&other[..end]).skip(component).step_by(n);
            for (a, b) in values {
                let (a, b) = ((a - mean_one) / scale, (b - mean_other) / scale);
                first += a * a;
                second += b * b;
                mixed += a * b;
            }
        }
        (first, second, mixed)
    }
}

/// Sizes below which the amplitude of a state is as good as zero, from the nonlinearity of the field at the first point.
pub(crate) fn resting_sizes(problem: &LimitCycle<'_>, start: &[f64]) -> Vec<f64> {
    let n = problem.dimension();
    let mut parameters = problem.parameters.clone();
    parameters[problem.active] = start[start.len() - 1];
    let natural = natural_scales(&problem.field, &start[..n], &parameters, &vec![0.0; n]);
    natural.iter().map(|size| RESTING_PART * size).collect()
}

impl CycleCurve<'_> {
    /// Parameter value at which the two halves of a doubled cycle become equal between two solutions.
    fn single_again(&self, before: &[f64], after: &[f64]) -> Option<f64> {
        let n = self.collocation.problem.dimension();
        let half_difference = |unknown: &[f64]| -> Vec<f64> {
            let (mut one, mut other) = (vec![0.0; n], vec![0.0; n]);
            let mut differences = Vec::with_capacity(n * HALF_SAMPLES);
            for sample in 0..HALF_SAMPLES {
                let time = 0.5 * sample as f64 / HALF_SAMPLES as f64;
                self.collocation.evaluate(unknown, time, &mut one);
                self.collocation.evaluate(unknown, time + 0.5, &mut other);
                let scaled = one.iter().zip(&other).zip(&self.collocation.problem.scales);
                differences.extend(scaled.map(|((a, b), scale)| (a - b) / scale));
            }
            differences
        };
        let (one, other) = (half_difference(before), half_difference(after));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (size_before, size_after) = (product(&one, &one), product(&other, &other));
        if product(&one, &other) >= 0.0 {
            return None;
        }
        let (a, b) = (before[before.len() - 1], after[after.len() - 1]);
        Some(vanishing_point((a, size_before), (b, size_after)))
    }
}

/// Parameter value at which an amplitude vanishes, from two values with the squared amplitudes there: close to a pitchfork
/// these are linear in the parameter.
fn vanishing_point((a, size_a): (f64, f64), (b, size_b): (f64, f64)) -> f64 {
    if size_a == size_b { 0.5 * (a + b) } else { (a * size_b - b * size_a) / (size_b - size_a) }
}

impl Curve for CycleCurve<'_> {
    type Point = CycleInspection;

    fn unknowns(&self) -> usize {
        self.collocation.unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.collocation.residual(unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.collocation.factorize(unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.collocation.solve(right_hand_side);
    }

    fn apply_metric(&self, vector: &[f64], image: &mut [f64]) {
        let end = vector.len() - 2;
        state_metric(&self.collocation, &self.collocation.problem.scales, vector, image);
        image[end] = vector[end] / (self.period_scale * self.period_scale);
        image[end + 1] = vector[end + 1] / (self.parameter_scale * self.parameter_scale);
    }

    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error> {
        self.rescale(unknown);
        let errors = error_profile(&self.collocation, unknown, &self.amplitudes);
        let worst = errors.iter().copied().fold(0.0, f64::max);
        if !worst.is_finite() {
            return Err(Error::MeshLimit { limit: self.resolution.most_intervals, error_estimate: f64::MAX });
        }
        self.error_estimate = worst;
        let degree = self.collocation.gauss().degree();
        let intervals = self.collocation.intervals();
        let needed = intervals_needed(&errors, degree, TARGET * self.resolution.tolerance);
        let wanted = (needed.ceil() as usize).max(self.resolution.fewest_intervals);
        let too_coarse = worst > self.resolution.tolerance || intervals < self.resolution.fewest_intervals;
        if !too_coarse && (intervals as f64) < EXCESS * wanted as f64 {
            self.collocation.set_reference(unknown);
            return Ok(Adaptation::Unchanged);
        }
        if wanted > self.resolution.most_intervals {
            return Err(Error::MeshLimit { limit: self.resolution.most_intervals, error_estimate: worst });
        }
        // An estimate from a coarse mesh is not to be trusted far: at most double at a time.
        let count = wanted.min(2 * intervals);
        let count = if too_coarse { count.max(intervals + 1) } else { count };
        let mesh = equidistribute(self.collocation.mesh(), &errors, degree, count);
        *unknown = self.collocation.carry(unknown, &mesh);
        for vector in vectors.iter_mut() {
            **vector = self.collocation.carry(vector, &mesh);
        }
        self.collocation.set_mesh(mesh, unknown);
        Ok(Adaptation::Changed)
    }

    fn inspect(
        &mut self,
        unknown: &[f64],
        tangent: &[f64],
        _orientation: f64,
    ) -> Result<CycleInspection, Error> {
        let floquet = floquet(&self.collocation, unknown, &self.collocation.problem.scales, &mut self.schur)?;
        let n = self.collocation.problem.dimension();
        Ok(CycleInspection {
            error_estimate: self.error_estimate,
            floquet,
            ranges: ranges(&self.collocation, unknown, n),
            mesh: self.collocation.mesh().to_vec(),
            fold_test: tangent[tangent.len() - 1] / self.parameter_scale,
            special: None,
            normal_form: Vec::new(),
            branching: None,
        })
    }

    fn special_points(
        &mut self,
        before: &Solution<CycleInspection>,
        after: &Solution<CycleInspection>,
    ) -> Result<Vec<Solution<CycleInspection>>, Error> {
        special::between(self, before, after)
    }

    fn signature(&self, unknown: &[f64]) -> Vec<f64> {
        let n = self.collocation.problem.dimension();
        let mut signature = vec![unknown[unknown.len() - 2].ln()];
        // Sizes grow along the branch: signatures are compared in those of the first one.
        let scales = self.signature_scales.get_or_init(|| {
            self.largest.iter().zip(&self.resting).map(|(largest, resting)| largest.max(*resting)).collect()
        });
        for (range, scale) in ranges(&self.collocation, unknown, n).iter().zip(scales) {
            signature.extend([range.largest / scale, range.smallest / scale]);
        }
        signature
    }

    fn ending(
        &mut self,
        before: &Solution<CycleInspection>,
        after: &Solution<CycleInspection>,
    ) -> Option<Ending> {
        let end = after.unknown.len() - 2;
        let (period, parameter) = (after.unknown[end], after.unknown[end + 1]);
        let first = *self.first_period.get_or_insert(period);
        let rate = after.tangent[end] / self.period_scale;
        let sensitivity = (rate / after.point.fold_test).abs();
        if period > HOMOCLINIC_GROWTH * first && sensitivity > HOMOCLINIC_SENSITIVITY {
            return Some(Ending::After(Stop::PeriodUnbounded { period, parameter }));
        }
        if self.doubled
            && let Some(parameter) = self.single_again(&before.unknown, &after.unknown)
        {
            return Some(Ending::Between(Stop::PeriodDoubling { parameter, period: 0.5 * period }));
        }
        // Through amplitude zero the curve goes on to the same cycles half a period later.
        let (size_before, size_after, product) = self.deviation_products(&before.unknown, &after.unknown);
        if product < 0.0 {
            let parameter = vanishing_point((before.unknown[end + 1], size_before), (parameter, size_after));
            let frequency = 2.0 * std::f64::consts::PI / period;
            return Some(Ending::Between(Stop::HopfPoint { parameter, frequency }));
        }
        None
    }
}

/// Applies the metric of the states: mean square over the unit interval, each state in units of its scale.
/// Components beyond the scales have weight zero.
pub(super) fn state_metric<P: PeriodicProblem>(
    collocation: &Collocation<P>,
    scales: &[f64],
    vector: &[f64],
    image: &mut [f64],
) {
    let n = collocation.problem.dimension();
    let size = collocation.interval_size();
    for (interval, pair) in collocation.mesh().windows(2).enumerate() {
        let start = interval * size;
        image[start..start + n].fill(0.0);
        for (point, weight) in collocation.gauss().weights.iter().enumerate() {
            let start = start + (point + 1) * n;
            let weight = weight * (pair[1] - pair[0]);
            for component in 0..n {
                let scale = scales.get(component).copied().unwrap_or(f64::INFINITY);
                image[start + component] = weight * vector[start + component] / (scale * scale);
            }
        }
    }
}
