//! The error that a solution on a mesh has, to leading order, everywhere: what its defect does through the linearised equations.
//!
//! The defect `d = g(t, u, s) - u'` of a collocation polynomial vanishes at the Gauss points, but not between them. The true
//! solution `u + e` with the scalars `s + sigma` satisfies `e' = A e + B sigma + d` to first order. Let `D` be the integral of
//! `d` from the left end of every interval: what is left, `z = e - D`, obeys `z' = A z + B sigma + A D`, whose right-hand side is smooth, so
//! that the factors of the last linearisation solve for it. Multiplied by `A` and by what the linear flow makes of it, only the
//! part of `D` that polynomials of degree `m - 1` represent counts to leading order, and quadrature at the Gauss points is exact
//! for that. Unlike the local estimate that places mesh points, this one knows the conditioning of the problem: it includes
//! the errors of the scalars and those at the mesh points. Sources: Zadunaisky, "On the estimation of errors propagated
//! in the numerical integration of ordinary differential equations" (1976); Ascher, Mattheij and Russell, *Numerical Solution of
//! Boundary Value Problems* (1995), sections 5.5 and 9.4 (the residual's part in the error and in conditioning).

use super::equations::Collocation;
use super::gauss::Gauss;
use super::polynomials::{MOST_NODES, combine};
use super::problem::BoundaryValueEquations;
use std::borrow::Cow;

/// Evaluates errors of solutions with polynomials of one degree.
#[derive(Clone, Debug)]
pub(crate) struct GlobalError {
    /// The rule at whose points the defect is sampled: one point more than the polynomials have.
    fine: Cow<'static, Gauss>,
    /// For every point of that rule, values and slopes there of the Lagrange polynomials of the nodes.
    bases: Vec<[f64; MOST_NODES]>,
    slopes: Vec<[f64; MOST_NODES]>,
    /// Integrals of the defect up to the Gauss points from its samples, row by row.
    integrals: Vec<f64>,
    /// The same for the part of the integral that polynomials of degree `m - 1` represent.
    smooth: Vec<f64>,
}

impl GlobalError {
    pub(crate) fn new(gauss: &Gauss) -> Self {
        let degree = gauss.degree();
        let fine = Gauss::of(degree + 1);
        let samples = degree + 1;
        let at_samples = |write: &dyn Fn(f64, &mut [f64])| -> Vec<[f64; MOST_NODES]> {
            let mut rows = vec![[0.0; MOST_NODES]; samples];
            for (row, point) in rows.iter_mut().zip(&fine.points) {
                write(*point, &mut row[..degree + 1]);
            }
            rows
        };
        let bases = at_samples(&|point, row| gauss.basis(point, row));
        let slopes = at_samples(&|point, row| gauss.basis_slopes(point, row));
        // The integral is a polynomial that vanishes at the left end and is known at the points of the fine rule.
        let mut integrals = vec![0.0; degree * samples];
        let mut basis = vec![0.0; samples + 1];
        for (row, point) in integrals.chunks_exact_mut(samples).zip(&gauss.points) {
            fine.basis(*point, &mut basis);
            for (value, integral) in basis[1..].iter().zip(fine.integration.chunks_exact(samples)) {
                row.iter_mut().zip(integral).for_each(|(entry, part)| *entry += value * part);
            }
        }
        let mut smooth = vec![0.0; degree * samples];
        for (row, point) in smooth.chunks_exact_mut(samples).zip(&gauss.points) {
            let here = legendre(degree, *point);
            for ((there, weight), integral) in
                fine.points.iter().zip(&fine.weights).zip(fine.integration.chunks_exact(samples))
            {
                let there = legendre(degree, *there);
                let kernel: f64 = here
                    .iter()
                    .zip(&there)
                    .enumerate()
                    .map(|(power, (a, b))| (2 * power + 1) as f64 * a * b)
                    .sum();
                row.iter_mut().zip(integral).for_each(|(entry, part)| *entry += weight * kernel * part);
            }
        }
        Self { fine, bases, slopes, integrals, smooth }
    }

    /// The error of the solution `unknown`, at which the collocation was linearised last: at the nodes, as the unknowns are
    /// stored, then of the scalars. It is orthogonal to the border of that factorisation.
    pub(crate) fn of<P: BoundaryValueEquations>(
        &self,
        collocation: &mut Collocation<P>,
        unknown: &[f64],
    ) -> Vec<f64> {
        let n = collocation.problem.dimension();
        let degree = collocation.gauss().degree();
        let (size, intervals) = (collocation.interval_size(), collocation.intervals());
        let (first_conditions, integral_conditions) =
            (collocation.boundary_conditions(), collocation.problem.integral_conditions());
        let mut error = vec![0.0; unknown.len()];
        let mut integrals = vec![0.0; intervals * degree * n];
        let mut conditions = vec![0.0; first_conditions + integral_conditions];
        let mut defect = Defect::new(n, degree);
        for (interval, here) in integrals.chunks_exact_mut(degree * n).enumerate() {
            self.sample(collocation, unknown, interval, &mut defect);
            apply(&self.integrals, n, &defect.samples, here);
            apply(&self.smooth, n, &defect.samples, &mut defect.smooth);
            let row = &mut error[interval * size..(interval + 1) * size];
            defect.write_forcing(collocation, interval, &mut row[n..]);
            let condensation = &collocation.condensation;
            if interval + 1 < intervals {
                row[..n].copy_from_slice(&defect.integral);
                if let Some(jump) = condensation.jumps.iter().find(|jump| jump.interval == interval) {
                    jump.apply(&mut row[..n]);
                }
            }
            for (integral, condition) in conditions[first_conditions..].iter_mut().enumerate() {
                let gradient = &condensation.gradients[(integral * intervals + interval) * size + n..];
                *condition -= gradient.iter().zip(&defect.smooth).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        // What the defect of the last interval does to the boundary conditions.
        let columns = collocation.condensation.boundary.chunks_exact(first_conditions);
        for (value, column) in defect.integral.iter().zip(columns) {
            for (condition, derivative) in conditions.iter_mut().zip(column) {
                *condition -= derivative * value;
            }
        }
        for (condition, value) in conditions.iter().enumerate() {
            error[collocation.condensation.place_of_condition(condition)] = *value;
        }
        collocation.solve(&mut error);
        for (row, integral) in error.chunks_exact_mut(size).zip(integrals.chunks_exact(degree * n)) {
            row[n..].iter_mut().zip(integral).for_each(|(entry, part)| *entry += part);
        }
        error
    }

    /// Samples the defect of an interval and integrates it over the interval.
    fn sample<P: BoundaryValueEquations>(
        &self,
        collocation: &Collocation<P>,
        unknown: &[f64],
        interval: usize,
        defect: &mut Defect,
    ) {
        let Defect { samples, integral, state, slope, .. } = defect;
        let n = integral.len();
        let degree = collocation.gauss().degree();
        let scalars = &unknown[collocation.intervals() * collocation.interval_size()..];
        let values = collocation.interval(unknown, interval);
        let (left, right) = (collocation.mesh()[interval], collocation.mesh()[interval + 1]);
        let width = right - left;
        integral.fill(0.0);
        for (sample, target) in samples.chunks_exact_mut(n).enumerate() {
            combine(values, &self.bases[sample][..=degree], state);
            combine(values, &self.slopes[sample][..=degree], slope);
            let time = left + self.fine.points[sample] * width;
            collocation.problem.field(time, state, scalars, target);
            let weight = self.fine.weights[sample];
            for ((entry, slope), end) in target.iter_mut().zip(&*slope).zip(&mut *integral) {
                *entry = width * *entry - slope;
                *end += weight * *entry;
            }
        }
    }
}

/// The defect of one interval.
struct Defect {
    samples: Vec<f64>,
    /// Its integral over the interval.
    integral: Vec<f64>,
    /// The smooth part of the integral up to the Gauss points.
    smooth: Vec<f64>,
    /// The matrices `A` at the Gauss points times that.
    forcing: Vec<f64>,
    /// Room for state and slope at a sample.
    state: Vec<f64>,
    slope: Vec<f64>,
}

impl Defect {
    fn new(n: usize, degree: usize) -> Self {
        let zeros = |count: usize| vec![0.0; count * n];
        Self {
            samples: zeros(degree + 1),
            integral: zeros(1),
            smooth: zeros(degree),
            forcing: zeros(degree),
            state: zeros(1),
            slope: zeros(1),
        }
    }

    /// Writes what the linearised equations make of the smooth part up to the Gauss points.
    fn write_forcing<P: BoundaryValueEquations>(
        &mut self,
        collocation: &Collocation<P>,
        interval: usize,
        targets: &mut [f64],
    ) {
        let n = self.integral.len();
        let gauss = collocation.gauss();
        let degree = gauss.degree();
        let columns = n + collocation.problem.scalars();
        for point in 0..degree {
            let node = interval * degree + point;
            let derivative = &collocation.derivatives()[node * columns * n..][..n * n];
            let target = &mut self.forcing[point * n..(point + 1) * n];
            combine(derivative, &self.smooth[point * n..(point + 1) * n], target);
        }
        let width = collocation.mesh()[interval + 1] - collocation.mesh()[interval];
        for (point, target) in targets.chunks_exact_mut(n).enumerate() {
            combine(&self.forcing, &gauss.integration[point * degree..(point + 1) * degree], target);
            target.iter_mut().for_each(|entry| *entry *= width);
        }
    }
}

/// The relative error that is told where nothing is known.
pub(crate) const NOTHING_KNOWN: f64 = 1.0;

/// The largest of some relative errors; one where a linear system was singular, so that nothing is known, and at most that.
pub(crate) fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    let mut largest = 0.0;
    for error in errors {
        if error.is_nan() || error > NOTHING_KNOWN {
            return NOTHING_KNOWN;
        }
        largest = error.max(largest);
    }
    largest
}

/// Values on the unit interval of the Legendre polynomials of degrees below `count`.
fn legendre(count: usize, position: f64) -> Vec<f64> {
    let x = 2.0 * position - 1.0;
    let mut values = vec![1.0, x];
    for degree in 2..count {
        let degree_of = degree as f64;
        values.push(
            ((2.0 * degree_of - 1.0) * x * values[degree - 1] - (degree_of - 1.0) * values[degree - 2])
                / degree_of,
        );
    }
    values.truncate(count);
    values
}

/// Applies a matrix with a column for every sample, row by row, to samples of `n` components.
fn apply(matrix: &[f64], n: usize, samples: &[f64], target: &mut [f64]) {
    for (row, target) in matrix.chunks_exact(samples.len() / n).zip(target.chunks_exact_mut(n)) {
        combine(samples, row, target);
    }
}
