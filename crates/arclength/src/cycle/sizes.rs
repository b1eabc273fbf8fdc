//! Sizes of the states along a curve of cycles, and what they decide: where the amplitude passes zero, whether two cycles are the
//! same, whether the period grows without bound.

use super::extrema::Extremes;
use super::limit_cycle::LimitCycle;
use crate::algebraic::scales::natural_scales_along;
use crate::collocation::problem::BoundaryValueEquations;

/// Part of its mean below which the amplitude of a state does not count as its size.
const MEAN_PART: f64 = 0.01;
/// Part of the largest amplitude met that a state keeps as its size.
const LARGEST_PART: f64 = 0.1;
/// Part of the size that the nonlinearity of the field gives a state below which it rests.
const RESTING_PART: f64 = 1e-4;
/// Part of the largest amplitude met below which all states have to vary in an equilibrium.
const EQUILIBRIUM_PART: f64 = 1e-6;
/// Noise floor of the error estimate: part of the mean that is rounding.
const ROUNDING_PART: f64 = 1e-6;
/// The period has to grow to this many times its start, and its logarithm this much faster than the parameters over their
/// ranges, to count as unbounded; to tend to zero it has to shrink as much.
const HOMOCLINIC_GROWTH: f64 = 5.0;
const HOMOCLINIC_SENSITIVITY: f64 = 1e7;
/// Coarse cycles do not come that far: the parameter is wrong by about the tolerance, and this many times that suffices, though
/// never less than `LEAST_SENSITIVITY`, which the explosion of a canard hardly has together with that growth.
const RESOLVED_SENSITIVITY: f64 = 10.0;
pub(super) const LEAST_SENSITIVITY: f64 = 1e5;

/// A state below this part of the largest one all along the first cycle is zero but for rounding.
const ROUNDING_SIZE: f64 = 1e-15;

/// Sizes of the states met on a curve.
#[derive(Debug)]
pub(crate) struct StateSizes {
    /// Largest amplitudes met.
    largest: Vec<f64>,
    /// Smallest and largest values met.
    visited: Vec<Extremes>,
    /// Sizes below which a state counts as one that rests, from the nonlinearity of the field where the curve starts.
    resting: Vec<f64>,
    /// The period where the curve starts.
    first_period: Option<f64>,
}

/// A state of one cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateSize {
    /// What errors count against: the amplitude, as far as it is not rounding.
    pub amplitude: f64,
    /// What steps and conditions are measured in.
    pub scale: f64,
}

impl StateSizes {
    /// `start` holds the unknowns of the first cycle, `range` is the width of the parameter's range.
    pub(crate) fn new(problem: &LimitCycle<'_>, start: &[f64], range: f64) -> Self {
        let n = problem.dimension();
        let mut parameters = problem.parameters.clone();
        parameters[problem.active] = start[start.len() - 1];
        // What rounding leaves of a state that is zero, or that dies out, is no size.
        let states = &start[..start.len() - 2];
        let sizes: Vec<f64> = (0..n)
            .map(|component| {
                let (smallest, largest) = extent(states, n, component);
                smallest.abs().max(largest.abs())
            })
            .collect();
        let rounding = ROUNDING_SIZE * sizes.iter().copied().fold(0.0, f64::max);
        let state: Vec<f64> = start[..n]
            .iter()
            .zip(&sizes)
            .map(|(value, size)| if *size < rounding { 0.0 } else { *value })
            .collect();
        let natural = natural_scales_along(&problem.field, &state, &parameters, (problem.active, range));
        Self::resting_below(natural.iter().map(|size| RESTING_PART * size).collect())
    }

    fn resting_below(resting: Vec<f64>) -> Self {
        let n = resting.len();
        Self {
            largest: vec![0.0; n],
            visited: vec![Extremes { smallest: f64::INFINITY, largest: f64::NEG_INFINITY }; n],
            resting,
            first_period: None,
        }
    }

    /// Those of another part of the same curve, of which no cycle has been met.
    pub(crate) fn anew(&self) -> Self {
        Self::resting_below(self.resting.clone())
    }

    /// Sizes of the states of a cycle, given on its nodes.
    pub(crate) fn measure(&mut self, states: &[f64]) -> Vec<StateSize> {
        let n = self.largest.len();
        (0..n)
            .map(|component| {
                let (smallest, largest) = extent(states, n, component);
                let amplitude = 0.5 * (largest - smallest);
                let mean = 0.5 * (largest + smallest).abs();
                self.largest[component] = self.largest[component].max(amplitude);
                let visited = &mut self.visited[component];
                *visited = Extremes {
                    smallest: visited.smallest.min(smallest),
                    largest: visited.largest.max(largest),
                };
                let resting = self.resting[component];
                StateSize {
                    amplitude: amplitude.max(ROUNDING_PART * mean).max(resting),
                    scale: amplitude
                        .max(MEAN_PART * mean)
                        .max(LARGEST_PART * self.largest[component])
                        .max(resting),
                }
            })
            .collect()
    }

    /// Whether the states, given on nodes, all rest: an equilibrium, which solves the equations of a cycle with any period.
    pub(crate) fn is_equilibrium(&self, states: &[f64]) -> bool {
        let n = self.largest.len();
        (0..n).all(|component| {
            let (smallest, largest) = extent(states, n, component);
            0.5 * (largest - smallest)
                <= EQUILIBRIUM_PART * self.largest[component].max(self.resting[component])
        })
    }

    /// How many times its natural size the amplitude of a state has become at most.
    pub(crate) fn growth(&self) -> f64 {
        self.largest
            .iter()
            .zip(self.natural())
            .map(|(largest, natural)| largest / natural)
            .fold(0.0, f64::max)
    }

    /// Sizes that the nonlinearity of the field gives the states.
    pub(crate) fn natural(&self) -> impl Iterator<Item = f64> + '_ {
        self.resting.iter().map(|resting| resting / RESTING_PART)
    }

    fn met(&self) -> impl Iterator<Item = f64> + '_ {
        self.largest.iter().zip(&self.resting).map(|(largest, resting)| largest.max(*resting))
    }

    /// Parameter value at which the amplitude passes zero between two cycles on the same nodes with the parameter values `a`
    /// and `b`: behind it a curve goes on to the same cycles half a period later.
    pub(crate) fn amplitude_passes_zero(
        &self,
        (one, a): (&[f64], f64),
        (other, b): (&[f64], f64),
    ) -> Option<f64> {
        let n = self.largest.len();
        let nodes = (one.len() / n) as f64;
        let (mut first, mut second, mut mixed) = (0.0, 0.0, 0.0);
        for (component, scale) in self.met().enumerate() {
            let mean = |states: &[f64]| states.iter().skip(component).step_by(n).sum::<f64>() / nodes;
            let (mean_one, mean_other) = (mean(one), mean(other));
            for (a, b) in one.iter().zip(other).skip(component).step_by(n) {
                let (a, b) = ((a - mean_one) / scale, (b - mean_other) / scale);
                first += a * a;
                second += b * b;
                mixed += a * b;
            }
        }
        (mixed < 0.0).then(|| vanishing_point((a, first), (b, second)))
    }

    /// Extreme values with the sizes of the states, to tell whether two cycles are the same. A state that rests on every cycle
    /// may move along the curve.
    pub(crate) fn signature(&self, extremes: &[Extremes]) -> Vec<(f64, f64)> {
        let moved = self.visited.iter().map(|visited| 0.5 * (visited.largest - visited.smallest));
        let sized = extremes.iter().zip(self.met().zip(moved).map(|(met, moved)| met.max(moved)));
        sized.flat_map(|(range, size)| [(range.largest, size), (range.smallest, size)]).collect()
    }

    /// Whether the period grows without bound; `sensitivity` is the rate of its logarithm over that of the parameters in parts of
    /// their ranges, `tolerance` that of the cycles.
    pub(crate) fn period_is_unbounded(&mut self, period: f64, sensitivity: f64, tolerance: f64) -> bool {
        period > HOMOCLINIC_GROWTH * self.first_period(period) && is_steep(sensitivity, tolerance)
    }

    /// Whether the period tends to zero, in the same terms.
    pub(crate) fn period_vanishes(&mut self, period: f64, sensitivity: f64, tolerance: f64) -> bool {
        HOMOCLINIC_GROWTH * period < self.first_period(period) && is_steep(sensitivity, tolerance)
    }

    fn first_period(&mut self, period: f64) -> f64 {
        *self.first_period.get_or_insert(period)
    }
}

/// Whether the logarithm of the period changes so much faster than the parameter that it tends to a limit.
fn is_steep(sensitivity: f64, tolerance: f64) -> bool {
    sensitivity > (RESOLVED_SENSITIVITY / tolerance).clamp(LEAST_SENSITIVITY, HOMOCLINIC_SENSITIVITY)
}

/// Smallest and largest value of one of `n` components on the nodes of a cycle.
pub(super) fn extent(states: &[f64], n: usize, component: usize) -> (f64, f64) {
    let values = states.iter().skip(component).step_by(n);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(*value), b.max(*value)))
}

/// Parameter value at which an amplitude vanishes, from two values with the squared amplitudes there: close to a pitchfork
/// these are linear in the parameter.
pub(crate) fn vanishing_point((a, size_a): (f64, f64), (b, size_b): (f64, f64)) -> f64 {
    if size_a == size_b { 0.5 * (a + b) } else { (a * size_b - b * size_a) / (size_b - size_a) }
}
