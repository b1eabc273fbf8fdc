//! Newton's method on the defining systems of points of codimension two, from a solution of the curve close by.

use super::codimension_two::{BogdanovTakensSystem, CuspSystem, HopfHopfSystem, ZeroHopfSystem};
use super::curve::{EquilibriumLocusInspection, LocusCurve};
use crate::algebraic::{AlgebraicEquations, Solved, length, solve_square};
use crate::branch::SpecialKind;
use crate::continuation::Solution;
use crate::equilibrium::bordered_jacobian::BorderedJacobian;
use crate::equilibrium::defining::{FoldSystem, HopfSystem};
use crate::equilibrium::locating::normals;
use crate::equilibrium::multilinear::MultilinearForms;
use crate::equilibrium::problem::EquilibriumProblem;
use crate::equilibrium::spectrum::{critical_pair, without};
use crate::error::Error;
use crate::linear::eigenvectors::{left_eigenvector, right_eigenvector};
use num_complex::Complex64;

/// What Newton's method found.
pub(super) enum Newton {
    /// A solution of the defining system and the frequencies at which it claims eigenvalues on the imaginary axis.
    Solved(Solved, Vec<f64>),
    /// The eigenvalues next to the axis are not those that the kind asks for.
    OtherKind,
    Failed,
}

impl Newton {
    /// `squares` are the places among the unknowns and the units of the squares of frequencies.
    fn on<P: AlgebraicEquations>(system: &P, start: &[f64], sizes: &[f64], squares: &[(usize, f64)]) -> Self {
        let Ok(solved) = solve_square(system, start, sizes) else { return Self::Failed };
        if squares.iter().any(|&(index, _)| solved.unknown[index] <= 0.0) {
            return Self::OtherKind;
        }
        let frequencies = squares.iter().map(|&(index, rate)| rate * solved.unknown[index].sqrt()).collect();
        Self::Solved(solved, frequencies)
    }
}

/// Newton's method from a point close by.
pub(super) fn newton(
    curve: &mut LocusCurve<'_>,
    near: &Solution<EquilibriumLocusInspection>,
    kind: SpecialKind,
) -> Result<Newton, Error> {
    let jacobian = curve.jacobian(&near.unknown).to_vec();
    let close = CloseBy {
        problem: curve.system.problem.equilibria(),
        point: curve.equilibrium(&near.unknown),
        jacobian,
        scales: &curve.states,
        ranges: &curve.system.scales[curve.system.scales.len() - 2..],
    };
    let eigenvalues = &near.point.spectrum.eigenvalues;
    match kind {
        SpecialKind::Cusp => close.cusp(),
        SpecialKind::BogdanovTakens => close.bogdanov_takens(),
        SpecialKind::ZeroHopf => close.zero_hopf(eigenvalues),
        SpecialKind::HopfHopf => {
            close.hopf_hopf(eigenvalues, &curve.system.problem.critical_eigenvalues(&near.unknown))
        }
        _ => Ok(Newton::Failed),
    }
}

/// An equilibrium close to the point sought.
struct CloseBy<'a, 'f> {
    problem: &'a EquilibriumProblem<'f>,
    /// State and both parameters.
    point: Vec<f64>,
    /// With respect to the state, column-major.
    jacobian: Vec<f64>,
    /// Sizes of the states.
    scales: &'a [f64],
    /// Sizes of the parameters.
    ranges: &'a [f64],
}

impl<'f> CloseBy<'_, 'f> {
    fn cusp(&self) -> Result<Newton, Error> {
        let (state, values) = self.point.split_at(self.scales.len());
        let scales = self.scales;
        let null = self.null_vector(Complex64::ZERO)?;
        let forms = MultilinearForms {
            field: self.problem.field,
            state,
            parameters: &self.problem.parameters_at(values),
        };
        let square: Vec<f64> = forms.real(&[&null, &null]).iter().map(|entry| -entry).collect();
        let Some(second) = self.solve_beside(&null, &square)? else { return Ok(Newton::Failed) };
        let fold =
            FoldSystem { equilibria: self.problem.clone(), normal: self.covector(&null), left: Vec::new() };
        let start = [state, &null, &second, values].concat();
        let second_sizes: Vec<f64> =
            scales.iter().map(|scale| scale * length(&second, scales).max(1.0)).collect();
        let sizes = [scales, scales, &second_sizes, self.ranges].concat();
        Ok(Newton::on(&CuspSystem { fold }, &start, &sizes, &[]))
    }

    fn bogdanov_takens(&self) -> Result<Newton, Error> {
        let (state, values) = self.point.split_at(self.scales.len());
        let scales = self.scales;
        let null = self.null_vector(Complex64::ZERO)?;
        let Some(generalized) = self.solve_beside(&null, &null)? else { return Ok(Newton::Failed) };
        // f_x v = rate w with v of unit size and w the null vector.
        let size = length(&generalized, scales);
        let first: Vec<f64> = generalized.iter().map(|entry| entry / size).collect();
        let rate = size.recip();
        let Some((normal, conormal)) = normals(&first, &null, scales) else { return Ok(Newton::Failed) };
        let hopf = HopfSystem { equilibria: self.problem.clone(), normal, conormal, rate };
        let start = [state, &first, &null, values].concat();
        let sizes = [scales, scales, scales, self.ranges].concat();
        Ok(Newton::on(&BogdanovTakensSystem { hopf }, &start, &sizes, &[]))
    }

    fn zero_hopf(&self, eigenvalues: &[Complex64]) -> Result<Newton, Error> {
        let (n, scales) = (self.scales.len(), self.scales);
        let real = eigenvalues.iter().filter(|value| value.im == 0.0);
        let Some(&zero) = real.min_by(|a, b| a.norm().total_cmp(&b.norm())) else {
            return Ok(Newton::Failed);
        };
        let Some(pair) = critical_pair(&without(eigenvalues, &[zero])) else { return Ok(Newton::Failed) };
        if pair[0].im == 0.0 {
            return Ok(Newton::OtherKind);
        }
        let null = self.null_vector(zero)?;
        let Some((hopf, start)) = self.hopf_system(pair)? else { return Ok(Newton::Failed) };
        let (own, values) = start.split_at(3 * n + 1);
        let squares = [(3 * n, hopf.rate)];
        let system = ZeroHopfSystem { hopf, null_normal: self.covector(&null) };
        let sizes = [scales, scales, scales, &[1.0], scales, self.ranges].concat();
        Ok(Newton::on(&system, &[own, &null, values].concat(), &sizes, &squares))
    }

    /// `own` are the eigenvalues that the curve keeps on the imaginary axis.
    fn hopf_hopf(&self, eigenvalues: &[Complex64], own: &[Complex64]) -> Result<Newton, Error> {
        let (n, scales) = (self.scales.len(), self.scales);
        let (Some(first), Some(second)) =
            (nearest_pair(eigenvalues, own), critical_pair(&without(eigenvalues, own)))
        else {
            return Ok(Newton::Failed);
        };
        if first[0].im == 0.0 || second[0].im == 0.0 {
            return Ok(Newton::OtherKind);
        }
        let (Some((one, start)), Some((other, other_start))) =
            (self.hopf_system(first)?, self.hopf_system(second)?)
        else {
            return Ok(Newton::Failed);
        };
        let m = 3 * n + 1;
        let start = [&start[..m], &other_start[n..m], &start[m..]].concat();
        let sizes = [scales, scales, scales, &[1.0], scales, scales, &[1.0], self.ranges].concat();
        let squares = [(3 * n, one.rate), (5 * n + 1, other.rate)];
        Ok(Newton::on(&HopfHopfSystem { pairs: [one, other] }, &start, &sizes, &squares))
    }

    /// The defining system of Hopf points for that pair of eigenvalues, with its start.
    fn hopf_system(&self, pair: [Complex64; 2]) -> Result<Option<(HopfSystem<'f>, Vec<f64>)>, Error> {
        HopfSystem::from_pair(self.problem.clone(), &self.point, &self.jacobian, pair, self.scales)
    }

    /// The eigenvector of a real eigenvalue, of unit size.
    fn null_vector(&self, eigenvalue: Complex64) -> Result<Vec<f64>, Error> {
        let found = right_eigenvector(&self.jacobian, self.scales.len(), eigenvalue).map_err(failed)?;
        let mut vector = real(found.vector);
        let size = length(&vector, self.scales);
        vector.iter_mut().for_each(|entry| *entry /= size);
        Ok(vector)
    }

    /// The vector y, orthogonal to the null vector, with f_x y = right-hand side up to the part that cannot be reached.
    fn solve_beside(&self, null: &[f64], right_hand_side: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let found = left_eigenvector(&self.jacobian, self.scales.len(), Complex64::ZERO).map_err(failed)?;
        let (left, normal) = (real(found.vector), self.covector(null));
        let solution = BorderedJacobian::of(&self.jacobian, &normal, &left, self.scales)
            .map(|bordered| bordered.solve(right_hand_side));
        Ok(solution.filter(|vector| vector.iter().all(|entry| entry.is_finite())))
    }

    /// The covector that measures the part of other vectors along `vector`.
    fn covector(&self, vector: &[f64]) -> Vec<f64> {
        let square = length(vector, self.scales).powi(2);
        vector.iter().zip(self.scales).map(|(entry, scale)| entry / (scale * scale) / square).collect()
    }
}

fn failed<E>(_: E) -> Error {
    Error::Eigenvalues { quantity: "null vectors" }
}

fn real(vector: Vec<Complex64>) -> Vec<f64> {
    vector.into_iter().map(|entry| entry.re).collect()
}

/// The two eigenvalues closest to those given.
fn nearest_pair(eigenvalues: &[Complex64], targets: &[Complex64]) -> Option<[Complex64; 2]> {
    let nearest = |target: &Complex64| {
        eigenvalues.iter().copied().min_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()))
    };
    Some([nearest(targets.first()?)?, nearest(targets.get(1)?)?])
}
