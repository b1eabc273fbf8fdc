//! What the curves of folds, of Hopf points and of branch points have in common, and how they differ.

use super::gauge::{PlaneGauge, combine, rewrite_vector};
use crate::algebraic::length;
use crate::branch::SpecialKind;
use crate::continuation::events::{Reading, TestFunction};
use crate::equilibrium::defining::{BranchPointSystem, FoldSystem, HopfSystem};
use crate::equilibrium::hopf::CriticalPair;
use crate::equilibrium::locating::normals;
use crate::equilibrium::multilinear::MultilinearForms;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::spectrum::{HopfTest, without};
use crate::error::Error;
use crate::linear::eigenvectors::left_eigenvector;
use num_complex::Complex64;

/// Sizes of eigenvectors in the metric, so that they count less than states and parameters.
const VECTOR_WEIGHT: f64 = 10.0;
/// The vectors that span the critical plane are chosen anew when the Jacobian turns the first one this much less than it
/// turns the best of the candidates.
const SMALLEST_TURN: f64 = 0.5;
/// Part of the terms of the first Lyapunov coefficient below which their sum may be rounding.
const CANCELLATION: f64 = 1e-10;
/// Candidates.
const ANGLES: usize = 32;

/// An equilibrium on the curve with its linearisation.
pub(super) struct Linearized<'u> {
    pub unknown: &'u [f64],
    /// Column-major Jacobian with respect to the state.
    pub matrix: &'u [f64],
    pub eigenvalues: &'u [Complex64],
    /// Sizes of the states.
    pub scales: &'u [f64],
}

/// Test functions and other quantities at a point of a curve.
#[derive(Clone, Debug, Default)]
pub(super) struct Monitor {
    /// Test functions that are defined here, by what happens where they change sign.
    pub tests: Vec<(SpecialKind, Reading)>,
    pub frequency: Option<f64>,
    pub first_lyapunov: Option<f64>,
}

impl Monitor {
    /// The value of a test function, where it is defined.
    pub(super) fn test(&self, kind: SpecialKind) -> Option<f64> {
        self.reading(kind).map(|reading| reading.value)
    }

    /// The same with what may be rounding of it.
    pub(super) fn reading(&self, kind: SpecialKind) -> Option<Reading> {
        self.tests.iter().find(|(candidate, _)| *candidate == kind).map(|(_, reading)| *reading)
    }

    pub(super) fn add(&mut self, kind: SpecialKind, value: f64) {
        self.tests.push((kind, Reading::exact(value)));
    }
}

/// A kind of equilibria of which there are curves in two parameters.
pub(super) trait LocusKind<'a> {
    /// What the curve consists of; `None` for any equilibria.
    fn kind(&self) -> Option<SpecialKind>;

    /// Test functions of the points of codimension two on the curve; the directions counted are those of the eigenvalues that
    /// are not critical.
    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>];

    /// The equilibrium problem in two parameters.
    fn equilibria(&self) -> &EquilibriumProblem<'a>;

    /// Sizes of the unknowns; `states` are those of the states.
    fn sizes(&self, states: &[f64], ranges: [f64; 2]) -> Vec<f64>;

    /// Chooses normalisations that suit `unknown` and rewrites it and `vectors` for them. `largest` is the largest modulus of
    /// an eigenvalue.
    fn renormalize(
        &mut self,
        unknown: &mut [f64],
        vectors: &mut [&mut Vec<f64>],
        states: &[f64],
        largest: f64,
    );

    /// Test functions and so on.
    fn monitor(&mut self, point: &Linearized<'_>) -> Result<Monitor, Error>;

    /// The problem of the codimension-two points that involve Hopf points: the frequency and `v`, `w`, `kappa`.
    fn critical_eigenvalues(&self, unknown: &[f64]) -> Vec<Complex64>;
}

fn weighted(states: &[f64]) -> impl Iterator<Item = f64> + '_ {
    states.iter().map(|scale| VECTOR_WEIGHT * scale)
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn dual(vector: &[f64], scales: &[f64]) -> Vec<f64> {
    vector.iter().zip(scales).map(|(entry, scale)| entry / (scale * scale)).collect()
}

/// Product of the real eigenvalues, each divided by its modulus plus a tenth of the largest one: changes sign where one of
/// them passes zero.
pub(super) fn zero_test(eigenvalues: &[Complex64], largest: f64) -> f64 {
    eigenvalues
        .iter()
        .filter(|value| value.im >= 0.0)
        .map(|value| {
            let size = value.norm();
            let sign = if value.im == 0.0 { value.re.signum() } else { 1.0 };
            sign * size / size.hypot(0.1 * largest)
        })
        .product()
}

impl<'a> LocusKind<'a> for FoldSystem<'a> {
    fn kind(&self) -> Option<SpecialKind> {
        Some(SpecialKind::Fold)
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        const {
            &[
                TestFunction::new(SpecialKind::Cusp).changing(&[0]),
                TestFunction::new(SpecialKind::BogdanovTakens).changing(&[1]).of_spectrum(),
                TestFunction::new(SpecialKind::ZeroHopf).changing(&[0, 2]).of_spectrum(),
            ]
        }
    }

    fn equilibria(&self) -> &EquilibriumProblem<'a> {
        &self.equilibria
    }

    fn sizes(&self, states: &[f64], ranges: [f64; 2]) -> Vec<f64> {
        states.iter().copied().chain(weighted(states)).chain(ranges).collect()
    }

    fn renormalize(
        &mut self,
        unknown: &mut [f64],
        vectors: &mut [&mut Vec<f64>],
        states: &[f64],
        _largest: f64,
    ) {
        let n = states.len();
        let size = length(&unknown[n..2 * n], states);
        let normal: Vec<f64> = dual(&unknown[n..2 * n], states).iter().map(|entry| entry / size).collect();
        rewrite_vector(n, &self.normal, &normal, unknown, vectors);
        self.normal = normal;
    }

    fn monitor(&mut self, point: &Linearized<'_>) -> Result<Monitor, Error> {
        let n = point.scales.len();
        let failed = |_| Error::Eigenvalues { quantity: "null vectors" };
        let vector = &point.unknown[n..2 * n];
        let mut left: Vec<f64> = left_eigenvector(point.matrix, n, Complex64::ZERO)
            .map_err(failed)?
            .vector
            .iter()
            .map(|entry| entry.re)
            .collect();
        let size =
            left.iter().zip(point.scales).map(|(entry, scale)| (entry * scale).powi(2)).sum::<f64>().sqrt();
        // The sign that goes on continuously.
        let sign =
            if self.left.is_empty() || products(&left, &self.left, point.scales) >= 0.0 { 1.0 } else { -1.0 };
        left.iter_mut().for_each(|entry| *entry *= sign / size);
        let parameters = self.equilibria.parameters_at(&point.unknown[2 * n..]);
        let forms = MultilinearForms {
            field: self.equilibria.field,
            state: &point.unknown[..n],
            parameters: &parameters,
        };
        let curvature = forms.real(&[vector, vector]);
        let vector_size = length(vector, point.scales);
        let terms = inner(&left, &curvature) / (vector_size * vector_size);
        // A single eigenvalue is zero here.
        let rate =
            if n > 1 { point.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max) } else { 0.0 };
        let quadratic = if rate > 0.0 { terms / rate } else { terms };
        let double = inner(&left, vector) / vector_size;
        let rest = without(point.eigenvalues, &[Complex64::ZERO]);
        let mut monitor = Monitor::default();
        monitor.add(SpecialKind::Cusp, quadratic);
        if n > 1 {
            monitor.add(SpecialKind::BogdanovTakens, double);
        }
        let pairs = HopfTest::of_one_block(&rest);
        if n > 2 && pairs.undecided == 0 {
            monitor.add(SpecialKind::ZeroHopf, pairs.closest.copysign(pairs.product));
        }
        self.left = left;
        Ok(monitor)
    }

    fn critical_eigenvalues(&self, _unknown: &[f64]) -> Vec<Complex64> {
        vec![Complex64::ZERO]
    }
}

/// Largest entry of the Jacobian in units of the states: not zero where all eigenvalues are.
fn scaled_norm(point: &Linearized<'_>) -> f64 {
    let n = point.scales.len();
    let entry = |index: usize| point.matrix[index] * point.scales[index / n] / point.scales[index % n];
    (0..n * n).map(|index| entry(index).abs()).fold(0.0, f64::max)
}

/// Inner product of covectors.
fn products(one: &[f64], other: &[f64], scales: &[f64]) -> f64 {
    one.iter().zip(other).zip(scales).map(|((a, b), scale)| a * scale * (b * scale)).sum()
}

impl<'a> LocusKind<'a> for HopfSystem<'a> {
    fn kind(&self) -> Option<SpecialKind> {
        Some(SpecialKind::Hopf)
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        const {
            &[
                TestFunction::new(SpecialKind::BogdanovTakens).changing(&[0]),
                TestFunction::new(SpecialKind::ZeroHopf).changing(&[1]).of_spectrum(),
                TestFunction::new(SpecialKind::HopfHopf).changing(&[0, 2]).of_spectrum(),
                TestFunction::new(SpecialKind::GeneralizedHopf).changing(&[0]).partial(),
            ]
        }
    }

    fn equilibria(&self) -> &EquilibriumProblem<'a> {
        &self.equilibria
    }

    fn sizes(&self, states: &[f64], ranges: [f64; 2]) -> Vec<f64> {
        let vectors = weighted(states).chain(weighted(states));
        states.iter().copied().chain(vectors).chain([VECTOR_WEIGHT]).chain(ranges).collect()
    }

    fn renormalize(
        &mut self,
        unknown: &mut [f64],
        vectors: &mut [&mut Vec<f64>],
        states: &[f64],
        _largest: f64,
    ) {
        let n = states.len();
        // Another vector of the critical plane: v -> a v + b w, w -> a w - b kappa v. The best one is turned most by the
        // Jacobian: v and w are then orthogonal, also at a Bogdanov-Takens point, where w is the null vector.
        let kappa = unknown[3 * n];
        let product = |one: &[f64], other: &[f64]| -> f64 {
            one.iter().zip(other).zip(states).map(|((x, y), scale)| x / scale * (y / scale)).sum()
        };
        // Area that v and w span, divided by the square of v.
        let turned = |first: &[f64], second: &[f64]| {
            let (square, other, shared) =
                (product(first, first), product(second, second), product(first, second));
            (square * other - shared * shared).max(0.0).sqrt() / square
        };
        let (first, second) = (unknown[n..2 * n].to_vec(), unknown[2 * n..3 * n].to_vec());
        let sizes = (length(&first, states), length(&second, states));
        let best = (0..ANGLES)
            .map(|index| {
                let (sin, cos) = (std::f64::consts::PI * index as f64 / ANGLES as f64).sin_cos();
                combine(&first, &second, kappa, cos / sizes.0, sin / sizes.1)
            })
            .max_by(|one, other| turned(&one.0, &one.1).total_cmp(&turned(&other.0, &other.1)));
        let (one, other) = match best {
            Some((one, other)) if turned(&first, &second) < SMALLEST_TURN * turned(&one, &other) => {
                (one, other)
            }
            _ => (first, second),
        };
        // The unit of frequencies makes v and w equally long.
        let rate_ratio = length(&one, states) / length(&other, states);
        let rate_ratio = if rate_ratio.is_finite() && rate_ratio > 0.0 { rate_ratio } else { 1.0 };
        let size = length(&one, states);
        let [one, other] =
            [one, other].map(|vector| vector.iter().map(|entry| entry / size).collect::<Vec<f64>>());
        if let Some((normal, conormal)) = normals(&one, &other, states) {
            let gauge = PlaneGauge { normal, conormal, rate_ratio };
            gauge.rewrite(n, &self.normal, unknown, vectors);
            self.rate /= rate_ratio;
            (self.normal, self.conormal) = (gauge.normal, gauge.conormal);
        }
    }

    fn monitor(&mut self, point: &Linearized<'_>) -> Result<Monitor, Error> {
        let n = point.scales.len();
        let kappa = point.unknown[3 * n];
        let largest = point.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let mut monitor = Monitor::default();
        monitor.add(SpecialKind::BogdanovTakens, kappa);
        if kappa <= 0.0 {
            return Ok(monitor);
        }
        let frequency = self.rate * kappa.sqrt();
        monitor.frequency = Some(frequency);
        let rest = without(point.eigenvalues, &self.critical_eigenvalues(point.unknown));
        if n > 2 {
            monitor.add(SpecialKind::ZeroHopf, zero_test(&rest, largest));
        }
        let pairs = HopfTest::of_one_block(&rest);
        if n > 3 && pairs.undecided == 0 {
            monitor.add(SpecialKind::HopfHopf, pairs.closest.copysign(pairs.product));
        }
        let parameters = self.equilibria.parameters_at(&point.unknown[3 * n + 1..]);
        let state = &point.unknown[..n];
        let local = CriticalPair::at(self.equilibria.field, state, &parameters, frequency, point.scales)?;
        if let Some((value, size)) = local.first_lyapunov() {
            monitor.first_lyapunov = Some(value);
            // With the eigenvector of unit length in the metric, so that units do not matter; and without the pole that the coefficient has
            // at a zero-Hopf point.
            let square = local
                .right
                .iter()
                .zip(point.scales)
                .map(|(entry, scale)| (entry / scale).norm_sqr())
                .sum::<f64>();
            let factor = zero_test(&rest, largest) / square;
            let reading = Reading::exact(factor * value).with_noise(CANCELLATION * (factor * size).abs());
            monitor.tests.push((SpecialKind::GeneralizedHopf, reading));
        }
        Ok(monitor)
    }

    fn critical_eigenvalues(&self, unknown: &[f64]) -> Vec<Complex64> {
        let kappa = unknown[3 * self.equilibria.dimension];
        let modulus = self.rate * kappa.abs().sqrt();
        let value = if kappa > 0.0 { Complex64::new(0.0, modulus) } else { Complex64::new(modulus, 0.0) };
        vec![value, -value]
    }
}

impl<'a> LocusKind<'a> for BranchPointSystem<'a> {
    fn kind(&self) -> Option<SpecialKind> {
        Some(SpecialKind::BranchPoint)
    }

    fn test_functions(&self) -> &'static [TestFunction<SpecialKind>] {
        const {
            &[
                TestFunction::new(SpecialKind::BogdanovTakens).changing(&[1]).of_spectrum(),
                TestFunction::new(SpecialKind::ZeroHopf).changing(&[0, 2]).of_spectrum(),
            ]
        }
    }

    fn equilibria(&self) -> &EquilibriumProblem<'a> {
        &self.equilibria
    }

    fn sizes(&self, states: &[f64], ranges: [f64; 2]) -> Vec<f64> {
        let covectors = states.iter().map(|scale| VECTOR_WEIGHT / scale);
        states.iter().copied().chain(covectors).chain([self.rate]).chain(ranges).collect()
    }

    fn renormalize(
        &mut self,
        unknown: &mut [f64],
        vectors: &mut [&mut Vec<f64>],
        states: &[f64],
        largest: f64,
    ) {
        let n = states.len();
        if largest > 0.0 {
            self.rate = largest;
        }
        let size = products(&unknown[n..2 * n], &unknown[n..2 * n], states).sqrt();
        let normal: Vec<f64> =
            unknown[n..2 * n].iter().zip(states).map(|(entry, scale)| entry * scale * scale / size).collect();
        rewrite_vector(n, &self.normal, &normal, unknown, vectors);
        self.scales = states.to_vec();
        self.normal = normal;
    }

    fn monitor(&mut self, point: &Linearized<'_>) -> Result<Monitor, Error> {
        let n = point.scales.len();
        let largest = point.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let rest = without(point.eigenvalues, &[Complex64::ZERO]);
        let mut monitor = Monitor::default();
        if n > 1 {
            monitor.add(SpecialKind::BogdanovTakens, zero_test(&rest, largest.max(scaled_norm(point))));
        }
        let pairs = HopfTest::of_one_block(&rest);
        if n > 2 {
            // The secant method may hit the point itself.
            let value = if pairs.undecided == 0 { pairs.closest.copysign(pairs.product) } else { 0.0 };
            monitor.add(SpecialKind::ZeroHopf, value);
        }
        Ok(monitor)
    }

    fn critical_eigenvalues(&self, _unknown: &[f64]) -> Vec<Complex64> {
        vec![Complex64::ZERO]
    }
}
