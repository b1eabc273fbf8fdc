//! The implicit Runge-Kutta method Radau IIA of order 5, for stiff problems.
//!
//! It is stable however fast a state decays (L-stable), so that its steps follow the motion and not the fastest rate. The stages solve
//! a nonlinear system by simplified Newton steps, which a similarity transformation splits into one real and one complex system of
//! the size of the state (Hairer and Wanner, *Solving Ordinary Differential Equations II*, 2nd edition, 1996, section IV.8). The
//! collocation polynomial is the dense output. Its order is 3, that of the error estimate, which is therefore held to the tolerances
//! themselves: states between the steps are then as exact as asked for, and those at the steps more so.

use super::system::difference_quotients;
use super::{Integrator, System};
use crate::linear::complex_lu::ComplexLu;
use crate::linear::lu;
use num_complex::Complex64;

/// Most Newton steps.
const NEWTON_STEPS: i32 = 7;
/// Smallest and largest factor between steps that follow each other.
const STEP_RATIO: (f64, f64) = (0.2, 8.0);
/// A step that would grow by less is kept, with its factors.
const WORTH_GROWING: f64 = 1.2;
/// Rate of convergence up to which a Jacobian is kept.
const FAST_CONVERGENCE: f64 = 1e-3;
/// Factor on a step whose stages were not found.
const NOT_FOUND_RATIO: f64 = 0.5;
/// Iterations of the power method for the largest eigenvalue.
const POWER_ITERATIONS: usize = 8;

const ROOT_6: f64 = 2.449_489_742_783_178;
const NODES: [f64; 3] = [(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0];
/// Weights of the stages in the error estimate.
const ERROR: [f64; 3] = [(-13.0 - 7.0 * ROOT_6) / 3.0, (-13.0 + 7.0 * ROOT_6) / 3.0, -1.0 / 3.0];
/// Largest product of the distances of a place in a step from its start and from the stages.
const LARGEST_PRODUCT: f64 = 0.0184;
/// The eigenvalues of the inverse of the matrix of the method.
const REAL: f64 = 3.637_834_252_744_496;
const COMPLEX: Complex64 = Complex64::new(2.681_082_873_627_752, -3.050_430_199_247_410_5);
/// Their eigenvectors, and the inverse of that matrix.
const VECTORS: [[f64; 3]; 3] = [
    [0.094_438_762_488_975_24, -0.141_255_295_020_954_2, 0.030_029_194_105_147_42],
    [0.250_213_122_965_333_3, 0.204_129_352_293_799_94, -0.382_942_112_757_261_9],
    [1.0, 1.0, 0.0],
];
const INVERSE_VECTORS: [[f64; 3]; 3] = [
    [4.178_718_591_551_905, 0.327_682_820_761_062_4, 0.523_376_445_499_449_5],
    [-4.178_718_591_551_905, -0.327_682_820_761_062_4, 0.476_623_554_500_550_5],
    [0.502_872_634_945_786_8, -2.571_926_949_855_605, 0.596_039_204_828_224_9],
];
/// Coefficients of the collocation polynomial from the stages.
const POLYNOMIAL: [[f64; 3]; 3] = [
    [(13.0 + 7.0 * ROOT_6) / 3.0, (-23.0 - 22.0 * ROOT_6) / 3.0, 10.0 / 3.0 + 5.0 * ROOT_6],
    [(13.0 - 7.0 * ROOT_6) / 3.0, (-23.0 + 22.0 * ROOT_6) / 3.0, 10.0 / 3.0 - 5.0 * ROOT_6],
    [1.0 / 3.0, -8.0 / 3.0, 10.0 / 3.0],
];

/// What came of a step that was tried.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    /// The error in units of the tolerance; not finite where the stages were not found.
    pub error: f64,
    /// The factor on the step that the error and the work ask for.
    pub factor: f64,
    /// Evaluations of the right-hand side.
    pub evaluations: usize,
}

/// The state before a step, with its slope, and the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin<'a> {
    pub time: f64,
    pub state: &'a [f64],
    pub slope: &'a [f64],
    /// Signed.
    pub step: f64,
}

/// Workspace of the method, and what it keeps from step to step.
#[derive(Debug)]
pub(super) struct Radau {
    n: usize,
    jacobian: Vec<f64>,
    /// Whether the Jacobian is that at the present state.
    jacobian_is_current: bool,
    has_jacobian: bool,
    real: Vec<f64>,
    pivots: Vec<usize>,
    complex: Option<ComplexLu>,
    /// The step with which the matrices were factorised.
    factorized_step: f64,
    /// Differences of the stages from the state before the step, one stage after the other.
    stages: Vec<f64>,
    transformed: Vec<f64>,
    slopes: Vec<f64>,
    increment: Vec<f64>,
    complex_increment: Vec<Complex64>,
    point: Vec<f64>,
    error: Vec<f64>,
    /// Coefficients of the collocation polynomial of the last accepted step.
    polynomial: Vec<f64>,
    origin: Vec<f64>,
    start: f64,
    step: f64,
    has_polynomial: bool,
    previous: Option<(f64, f64)>,
    newton_steps: i32,
    rate: f64,
}

impl Radau {
    pub(super) fn new(n: usize) -> Self {
        Self {
            n,
            jacobian: vec![0.0; n * n],
            jacobian_is_current: false,
            has_jacobian: false,
            real: vec![0.0; n * n],
            pivots: vec![0; n],
            complex: None,
            factorized_step: f64::NAN,
            stages: vec![0.0; 3 * n],
            transformed: vec![0.0; 3 * n],
            slopes: vec![0.0; 3 * n],
            increment: vec![0.0; n],
            complex_increment: vec![Complex64::ZERO; n],
            point: vec![0.0; n],
            error: vec![0.0; n],
            polynomial: vec![0.0; 3 * n],
            origin: vec![0.0; n],
            start: 0.0,
            step: 0.0,
            has_polynomial: false,
            previous: None,
            newton_steps: 0,
            rate: 0.0,
        }
    }

    /// Forgets everything that comes from earlier steps.
    pub(super) fn restart(&mut self) {
        self.has_jacobian = false;
        self.jacobian_is_current = false;
        self.factorized_step = f64::NAN;
        self.has_polynomial = false;
        self.previous = None;
    }

    /// Tries a step; `end` becomes the state behind it.
    pub(super) fn try_step(
        &mut self,
        system: &mut dyn System,
        settings: &Integrator,
        from: Origin<'_>,
        was_rejected: bool,
        end: &mut [f64],
    ) -> Trial {
        let failed = |evaluations| Trial { error: f64::NAN, factor: NOT_FOUND_RATIO, evaluations };
        let mut evaluations = 0;
        if !self.has_jacobian {
            self.differentiate(system, from);
        }
        loop {
            self.predict(from);
            let found =
                self.factorize(from.step) && self.find_stages(system, settings, from, &mut evaluations);
            if found {
                break;
            }
            if self.jacobian_is_current {
                return failed(evaluations);
            }
            self.differentiate(system, from);
        }
        for (index, end) in end.iter_mut().enumerate() {
            *end = from.state[index] + self.stages[2 * self.n + index];
        }
        let mut error = self.estimate(settings, from, end, from.slope);
        if was_rejected && error > 1.0 {
            for (point, (state, error)) in self.point.iter_mut().zip(from.state.iter().zip(&self.error)) {
                *point = state + error;
            }
            let mut slope = std::mem::take(&mut self.increment);
            system.evaluate(from.time, &self.point, &mut slope);
            evaluations += 1;
            error = self.estimate(settings, from, end, &slope);
            self.increment = slope;
        }
        error = error.max(self.interpolation_error(settings, from, end));
        if !error.is_finite() {
            return failed(evaluations);
        }
        let work = f64::from(2 * NEWTON_STEPS + 1) / f64::from(2 * NEWTON_STEPS + self.newton_steps);
        let size = error.max(1e-30);
        let trend = self
            .previous
            .map_or(1.0, |(step, before)| (from.step.abs() / step * (before / size).powf(0.25)).min(1.0));
        let factor = (0.9 * work * trend * size.powf(-0.25)).clamp(STEP_RATIO.0, STEP_RATIO.1);
        Trial { error, factor, evaluations }
    }

    /// Keeps the step that was tried, from a state whose slope at the end is known; gives the factor on the next step.
    pub(super) fn accept(&mut self, from: Origin<'_>, trial: Trial) -> f64 {
        let n = self.n;
        for (power, coefficients) in self.polynomial.chunks_exact_mut(n).enumerate() {
            for (index, coefficient) in coefficients.iter_mut().enumerate() {
                let terms = POLYNOMIAL.iter().enumerate();
                *coefficient = terms.map(|(stage, row)| self.stages[stage * n + index] * row[power]).sum();
            }
        }
        self.origin.copy_from_slice(from.state);
        (self.start, self.step) = (from.time, from.step);
        self.has_polynomial = true;
        self.previous = Some((from.step.abs(), trial.error.max(1e-2)));
        self.jacobian_is_current = false;
        if self.newton_steps > 2 && self.rate > FAST_CONVERGENCE {
            self.has_jacobian = false;
            trial.factor
        } else if (1.0..WORTH_GROWING).contains(&trial.factor) {
            1.0
        } else {
            trial.factor
        }
    }

    /// Lets the clock on which times are told begin anew after some time.
    pub(super) fn wind_clock(&mut self, elapsed: f64) {
        self.start -= elapsed;
    }

    /// State at a time in the last accepted step.
    pub(super) fn interpolate(&self, time: f64, state: &mut [f64]) {
        let (n, x) = (self.n, (time - self.start) / self.step);
        for (index, state) in state.iter_mut().enumerate() {
            let [a, b, c] = [0, 1, 2].map(|power| self.polynomial[power * n + index]);
            *state = self.origin[index] + x * (a + x * (b + x * c));
        }
    }

    /// The largest magnitude of an eigenvalue of the last Jacobian, by the power method.
    pub(super) fn spectral_radius(&mut self) -> f64 {
        let n = self.n;
        self.increment.iter_mut().enumerate().for_each(|(index, x)| *x = 1.0 + (index as f64).sin());
        let (mut growth, mut counted) = (0.0, 0);
        for iteration in 0..POWER_ITERATIONS {
            let size = self.increment.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size == 0.0 || !size.is_finite() {
                return 0.0;
            }
            self.point.fill(0.0);
            for (column, factor) in self.jacobian.chunks_exact(n).zip(&self.increment) {
                self.point.iter_mut().zip(column).for_each(|(sum, entry)| *sum += entry * factor / size);
            }
            let next = self.point.iter().map(|x| x * x).sum::<f64>().sqrt();
            // The first half turns the vector, the second measures.
            if iteration >= POWER_ITERATIONS / 2 {
                growth += next.max(f64::MIN_POSITIVE).ln();
                counted += 1;
            }
            std::mem::swap(&mut self.increment, &mut self.point);
        }
        (growth / f64::from(counted)).exp()
    }

    fn differentiate(&mut self, system: &mut dyn System, from: Origin<'_>) {
        system.jacobian(from.time, from.state, &mut self.jacobian);
        if !self.jacobian.iter().all(|entry| entry.is_finite()) {
            // Where a derivative is lost in an overflow, or infinite at a root of zero, an approximation does for Newton's method.
            difference_quotients(system, from.time, from.state, &mut self.jacobian);
        }
        self.has_jacobian = true;
        self.jacobian_is_current = true;
        self.factorized_step = f64::NAN;
    }

    /// First values of the stages: the polynomial of the last step goes on.
    fn predict(&mut self, from: Origin<'_>) {
        let n = self.n;
        self.stages.fill(0.0);
        // It must begin where that step ended.
        if self.goes_on(from) {
            let mut stages = std::mem::take(&mut self.stages);
            for (stage, node) in stages.chunks_exact_mut(n).zip(NODES) {
                self.interpolate(from.time + node * from.step, stage);
                stage.iter_mut().zip(from.state).for_each(|(stage, state)| *stage -= state);
            }
            self.stages = stages;
        }
        self.transform();
    }

    /// The stages in the basis of the eigenvectors.
    fn transform(&mut self) {
        let n = self.n;
        for index in 0..n {
            let stages = [0, 1, 2].map(|stage| self.stages[stage * n + index]);
            for (row, weights) in INVERSE_VECTORS.iter().enumerate() {
                self.transformed[row * n + index] = dot(weights, &stages);
            }
        }
    }

    fn factorize(&mut self, step: f64) -> bool {
        if self.factorized_step == step {
            return true;
        }
        let n = self.n;
        if !self.jacobian.iter().all(|entry| entry.is_finite()) {
            return false;
        }
        self.real.iter_mut().zip(&self.jacobian).for_each(|(real, entry)| *real = -entry);
        let mut complex: Vec<Complex64> = self.jacobian.iter().map(|entry| Complex64::from(-entry)).collect();
        for index in 0..n {
            self.real[index * (n + 1)] += REAL / step;
            complex[index * (n + 1)] += COMPLEX / step;
        }
        if n > 0 && lu::factorize(&mut self.real, n, &mut self.pivots) == 0.0 {
            return false;
        }
        self.complex = Some(ComplexLu::of(n, complex, f64::MIN_POSITIVE));
        self.factorized_step = step;
        true
    }

    /// Simplified Newton steps for the stages; says whether they converge.
    fn find_stages(
        &mut self,
        system: &mut dyn System,
        settings: &Integrator,
        from: Origin<'_>,
        evaluations: &mut usize,
    ) -> bool {
        let n = self.n;
        let tolerance = settings.newton_tolerance();
        let mut before: Option<f64> = None;
        self.rate = 0.0;
        for iteration in 0..NEWTON_STEPS {
            for (stage, node) in NODES.iter().enumerate() {
                let values = self.stages[stage * n..(stage + 1) * n].iter().zip(from.state);
                self.point.iter_mut().zip(values).for_each(|(point, (stage, state))| *point = state + stage);
                let slope = &mut self.slopes[stage * n..(stage + 1) * n];
                system.evaluate(from.time + node * from.step, &self.point, slope);
            }
            *evaluations += 3;
            if !self.slopes.iter().all(|slope| slope.is_finite()) {
                return false;
            }
            for index in 0..n {
                let slopes = [0, 1, 2].map(|stage| self.slopes[stage * n + index]);
                let [real, one, other] = [0, 1, 2].map(|row| self.transformed[row * n + index]);
                self.increment[index] = dot(&INVERSE_VECTORS[0], &slopes) - REAL / from.step * real;
                let slope =
                    Complex64::new(dot(&INVERSE_VECTORS[1], &slopes), dot(&INVERSE_VECTORS[2], &slopes));
                self.complex_increment[index] = slope - COMPLEX / from.step * Complex64::new(one, other);
            }
            lu::solve(&self.real, n, &self.pivots, &mut self.increment);
            if let Some(complex) = &self.complex {
                complex.solve(&mut self.complex_increment);
            }
            let mut squares = 0.0;
            for index in 0..n {
                let increments = [
                    self.increment[index],
                    self.complex_increment[index].re,
                    self.complex_increment[index].im,
                ];
                let scale = settings.scale(index, from.state[index].abs());
                for (row, increment) in increments.into_iter().enumerate() {
                    squares += (increment / scale).powi(2);
                    self.transformed[row * n + index] += increment;
                }
                let transformed = [0, 1, 2].map(|row| self.transformed[row * n + index]);
                for (stage, weights) in VECTORS.iter().enumerate() {
                    self.stages[stage * n + index] = dot(weights, &transformed);
                }
            }
            let size = (squares / (3 * n).max(1) as f64).sqrt();
            if !size.is_finite() {
                return false;
            }
            self.newton_steps = iteration + 1;
            if let Some(before) = before {
                self.rate = size / before;
                let left = self.rate.powi(NEWTON_STEPS - 1 - iteration) / (1.0 - self.rate) * size;
                // Increments that are rounding do not shrink.
                if self.rate >= 1.0 && size > tolerance || self.rate < 1.0 && left > tolerance {
                    return false;
                }
            }
            let settled =
                before.is_some() && (self.rate >= 1.0 || self.rate / (1.0 - self.rate) * size < tolerance);
            if size == 0.0 || settled {
                return true;
            }
            before = Some(size);
        }
        false
    }

    /// The error of the collocation polynomial between the stages, in units of the tolerance.
    ///
    /// The estimate of the step does not see it in states that decay fast. It is the divided difference over the state before the step, the
    /// three stages and a stage of the step before, times the product of the distances.
    fn interpolation_error(&self, settings: &Integrator, from: Origin<'_>, end: &[f64]) -> f64 {
        if !self.goes_on(from) {
            return 0.0;
        }
        let n = self.n;
        let before = (1.0 - NODES[1]) * self.step / from.step;
        let nodes = [-before, 0.0, NODES[0], NODES[1], NODES[2]];
        let weights: [f64; 5] = std::array::from_fn(|one| {
            let others = (0..5).filter(|other| *other != one);
            others.map(|other| nodes[one] - nodes[other]).product::<f64>().recip()
        });
        let squares = (0..n).map(|index| {
            let [a, b, c] = [0, 1, 2].map(|power| self.polynomial[power * n + index]);
            let x = NODES[1];
            // All as differences from the state before the step, which lose fewer digits.
            let earlier = self.origin[index] + x * (a + x * (b + x * c)) - from.state[index];
            let stages = (0..3).map(|stage| weights[stage + 2] * self.stages[stage * n + index]);
            let difference = weights[0] * earlier + stages.sum::<f64>();
            let size = from.state[index].abs().max(end[index].abs());
            (LARGEST_PRODUCT * difference / settings.scale(index, size)).powi(2)
        });
        (squares.sum::<f64>() / n.max(1) as f64).sqrt()
    }

    /// Whether a step begins where the last one ended.
    fn goes_on(&self, from: Origin<'_>) -> bool {
        self.has_polynomial && (from.time - self.start - self.step).abs() <= 1e-9 * self.step.abs()
    }

    /// The error of the step in units of the tolerance, by the slope before it.
    fn estimate(&mut self, settings: &Integrator, from: Origin<'_>, end: &[f64], slope: &[f64]) -> f64 {
        let n = self.n;
        for (index, (error, slope)) in self.error.iter_mut().zip(slope).enumerate() {
            let stages = [0, 1, 2].map(|stage| self.stages[stage * n + index]);
            *error = slope + dot(&ERROR, &stages) / from.step;
        }
        lu::solve(&self.real, n, &self.pivots, &mut self.error);
        let squares = (0..n).map(|index| {
            let size = from.state[index].abs().max(end[index].abs());
            (self.error[index] / settings.scale(index, size)).powi(2)
        });
        (squares.sum::<f64>() / n.max(1) as f64).sqrt()
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
