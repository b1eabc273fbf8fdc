//! The curve of limit cycles of one parameter: mesh adaptation, metric, stability along the way.

use super::collocation::Collocation;
use super::extrema::{Range, ranges};
use super::floquet::{Floquet, floquet};
use super::limit_cycle::LimitCycle;
use super::mesh::{equidistribute, error_profile, intervals_needed};
use super::problem::PeriodicProblem;
use super::special;
use crate::continuation::{Adaptation, Curve, Ending, Settings, Solution, Stop};
use crate::error::Error;
use crate::linear::periodic_schur::PeriodicSchur;

/// How finely cycles are resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Error estimate, relative to the amplitude of each state variable, that no reported cycle exceeds.
    pub tolerance: f64,
    /// Degree of the polynomials, 2 to 16.
    pub degree: usize,
    /// Most mesh intervals.
    pub most_intervals: usize,
}

impl Default for Resolution {
    fn default() -> Self {
        Self { tolerance: 1e-8, degree: 7, most_intervals: 2000 }
    }
}

/// Fewest mesh intervals.
const FEWEST_INTERVALS: usize = 4;
/// A new mesh aims at this part of the tolerance.
const TARGET: f64 = 0.2;
/// The mesh is made coarser when it has this many times the intervals needed.
const EXCESS: f64 = 1.6;
/// Part of its mean below which the amplitude of a state does not count as its size.
const MEAN_PART: f64 = 0.01;
/// Noise floor of the error estimate: part of the mean that is rounding.
const ROUNDING_PART: f64 = 1e-6;
/// The period has to grow to this many times its start, and its rate of change in the parameter beyond
/// [`HOMOCLINIC_SENSITIVITY`], to count as unbounded.
const HOMOCLINIC_GROWTH: f64 = 5.0;
const HOMOCLINIC_SENSITIVITY: f64 = 1e7;

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
    first_period: Option<f64>,
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
        let mut curve = Self {
            collocation,
            resolution,
            settings: Settings::default(),
            parameter_scale,
            unlocated: Vec::new(),
            period_scale: 1.0,
            amplitudes: vec![1.0; n],
            largest: vec![0.0; n],
            first_period: None,
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
            let positive = |size: f64| if size > 0.0 && size.is_finite() { size } else { 1.0 };
            self.amplitudes[component] = positive(amplitude.max(ROUNDING_PART * mean));
            self.collocation.problem.scales[component] =
                positive(amplitude.max(MEAN_PART * mean).max(0.1 * self.largest[component]));
        }
        self.period_scale = unknown[unknown.len() - 2].abs();
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
            let scale = self.largest[component];
            if scale == 0.0 {
                continue;
            }
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
        let wanted = (needed.ceil() as usize).max(FEWEST_INTERVALS);
        let too_coarse = worst > self.resolution.tolerance;
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
        for (range, scale) in ranges(&self.collocation, unknown, n).iter().zip(&self.largest) {
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
        // Through amplitude zero the curve goes on to the same cycles half a period later.
        let (size_before, size_after, product) = self.deviation_products(&before.unknown, &after.unknown);
        if product < 0.0 {
            let (a, b) = (before.unknown[end + 1], parameter);
            // The squared amplitude is linear in the parameter next to a Hopf point.
            let parameter = if size_before == size_after {
                0.5 * (a + b)
            } else {
                (a * size_after - b * size_before) / (size_after - size_before)
            };
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
