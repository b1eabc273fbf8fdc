//! What the eigenvalues of an equilibrium say: stability and the test function of Hopf points.

use crate::branch::Stability;
use crate::continuation::events;
use crate::error::Error;
use crate::linear::eigenvalues::EigenvalueWorkspace;
use num_complex::Complex64;

/// A real part smaller than this part of the largest modulus is rounding error.
pub(super) const UNDECIDED: f64 = 1e-13;
/// A sum of two eigenvalues smaller than this part of their moduli may be rounding error.
const UNDECIDED_SUM: f64 = 1e-12;
/// Agreement, relative to the largest modulus, of eigenvalues computed in two ways. Defective ones are accurate to the
/// square root of rounding only.
const PAIR_TOLERANCE: f64 = 1e-6;
/// The same relative to the modulus of the pair that is sought, so that it is told from eigenvalues that are zero.
const OWN_TOLERANCE: f64 = 0.1;
/// Ratio of the sum of two eigenvalues to their moduli above which the test function saturates.
const SATURATION: f64 = 0.1;

/// Eigenvalues of an equilibrium.
#[derive(Clone, Debug)]
pub(crate) struct Spectrum {
    pub eigenvalues: Vec<Complex64>,
    /// For each the largest modulus in its block of the Jacobian: rounding errors are parts of it.
    pub sizes: Vec<f64>,
    pub stability: Stability,
    /// Number with positive real part, decided or not.
    pub unstable: usize,
    /// Product over all pairs of `(a + b)/(|a| + |b|)`, each saturating at +-1: changes sign where two eigenvalues have
    /// the sum zero. Continuous, independent of the unit of time. Pairs whose sum may be rounding do not count.
    pub hopf_test: f64,
    /// The sum closest to zero, relative to the moduli, with the sign of the product. Where many pairs are close to the
    /// axis the product is small between its zeros too; this is not.
    pub hopf_closest: f64,
    /// Number of sums so small that their sign is rounding error. An oscillation without damping has one all along a branch.
    pub hopf_undecided: usize,
}

impl Spectrum {
    /// Of the column-major Jacobian `matrix`.
    pub(crate) fn of(matrix: &[f64], workspace: &mut EigenvalueWorkspace) -> Result<Self, Error> {
        let eigenvalues = workspace
            .eigenvalues(matrix)
            .map_err(|_| Error::Eigenvalues { quantity: "eigenvalues" })?
            .to_vec();
        let sizes = workspace.sizes().to_vec();
        let hopf = HopfTest::of(&eigenvalues, &sizes);
        Ok(Self::from_eigenvalues(eigenvalues, sizes, hopf))
    }

    fn from_eigenvalues(eigenvalues: Vec<Complex64>, sizes: Vec<f64>, hopf: HopfTest) -> Self {
        let unstable = eigenvalues.iter().filter(|value| value.re > 0.0).count();
        let stability = stability_of(&eigenvalues, &sizes);
        let HopfTest { product: hopf_test, closest, undecided: hopf_undecided } = hopf;
        let hopf_closest = closest.copysign(hopf_test);
        Self { eigenvalues, sizes, stability, unstable, hopf_test, hopf_closest, hopf_undecided }
    }

    /// The spectrum where the branch is a line of equilibria for one value of the parameter: the eigenvalue along it, the one closest to
    /// zero, is zero, and what was computed is the error of the solution. Its sums with others say nothing of oscillations.
    pub(crate) fn along_a_line(mut self) -> Self {
        let moduli = self.eigenvalues.iter().map(|value| value.norm()).enumerate();
        let Some((nearest, _)) = moduli.min_by(|one, other| one.1.total_cmp(&other.1)) else { return self };
        self.eigenvalues[nearest] = Complex64::ZERO;
        let (mut across, mut sizes) = (self.eigenvalues.clone(), self.sizes.clone());
        across.remove(nearest);
        sizes.remove(nearest);
        Self::from_eigenvalues(self.eigenvalues, self.sizes, HopfTest::of(&across, &sizes))
    }

    /// What the search for special points compares from solution to solution.
    pub(crate) fn growth(&self) -> events::Spectrum {
        let beyond_rounding = |(value, size): (&Complex64, &f64)| {
            let real = if value.re.abs() <= UNDECIDED * size { 0.0 } else { value.re };
            Complex64::new(real, value.im)
        };
        events::Spectrum {
            exponents: self.eigenvalues.iter().zip(&self.sizes).map(beyond_rounding).collect(),
            unstable: self.unstable,
            decided: self.stability.is_decided(),
            noise: 0.0,
            is_periodic: false,
        }
    }

    /// What the eigenvalues other than the critical ones of a special point, zero or `+-i frequency`, say of its stability: it is
    /// unstable where one of them surely is, and undecided otherwise.
    pub(crate) fn stability_beside(&self, critical: &[Complex64]) -> Stability {
        let others = without(&self.eigenvalues, critical);
        let largest = self.sizes.iter().copied().fold(0.0, f64::max);
        if others.iter().any(|value| value.re > PAIR_TOLERANCE * largest) {
            Stability::Unstable { dimension: None }
        } else {
            Stability::Undecided
        }
    }

    /// Whether `+-modulus` (real) or `+-i modulus` (imaginary) are eigenvalues. The defining system of Hopf points also has
    /// solutions that consist of one eigenvector only, and two eigenvalues that are zero together are no pair.
    pub(crate) fn has_pair(&self, modulus: f64, imaginary: bool) -> bool {
        let largest = self.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let tolerance = (PAIR_TOLERANCE * largest).min(OWN_TOLERANCE * modulus);
        let target = if imaginary { Complex64::new(0.0, modulus) } else { Complex64::new(modulus, 0.0) };
        let near =
            |target: Complex64| self.eigenvalues.iter().any(|value| (value - target).norm() <= tolerance);
        near(target) && near(-target)
    }
}

/// Stability as far as the real parts are beyond their rounding errors.
fn stability_of(eigenvalues: &[Complex64], sizes: &[f64]) -> Stability {
    let mut unstable = 0;
    let mut is_decided = true;
    for (value, size) in eigenvalues.iter().zip(sizes) {
        if value.re.abs() <= UNDECIDED * size {
            is_decided = false;
        } else if value.re > 0.0 {
            unstable += 1;
        }
    }
    match (unstable, is_decided) {
        (0, true) => Stability::Stable,
        (0, false) => Stability::Undecided,
        _ => Stability::Unstable { dimension: is_decided.then_some(unstable) },
    }
}

/// See [`Spectrum::hopf_test`] and the fields that follow it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HopfTest {
    pub product: f64,
    /// Modulus of the sum closest to zero, of complex conjugate or real eigenvalues.
    pub closest: f64,
    pub undecided: usize,
}

impl HopfTest {
    /// `sizes` are those of which rounding errors are parts.
    pub(crate) fn of(eigenvalues: &[Complex64], sizes: &[f64]) -> Self {
        let mut test = Self { product: 1.0, closest: 1.0, undecided: 0 };
        for_each_pair(eigenvalues, |[first, second], one, other| {
            let ratio = sum_ratio(one, other);
            // Of slow eigenvalues beside fast ones the real parts are rounding long before their sum is small beside them.
            let rounding = UNDECIDED * (sizes[first] + sizes[second]);
            if ratio.abs() <= UNDECIDED_SUM || ratio.abs() * (one.norm() + other.norm()) <= rounding {
                test.undecided += 1;
                return;
            }
            test.product *= ratio / ratio.hypot(SATURATION);
            if belong_together(one, other) {
                test.closest = test.closest.min(ratio.abs());
            }
        });
        test
    }

    /// Of eigenvalues of one block.
    pub(crate) fn of_one_block(eigenvalues: &[Complex64]) -> Self {
        let largest = eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max);
        Self::of(eigenvalues, &vec![largest; eigenvalues.len()])
    }
}

/// The two eigenvalues, complex conjugate or both real, whose sum is closest to zero.
pub(crate) fn critical_pair(eigenvalues: &[Complex64]) -> Option<[Complex64; 2]> {
    critical_pairs(eigenvalues).into_iter().next()
}

/// All pairs that are complex conjugate or both real, the sum closest to zero first.
pub(crate) fn critical_pairs(eigenvalues: &[Complex64]) -> Vec<[Complex64; 2]> {
    let mut pairs = Vec::new();
    for_each_pair(eigenvalues, |_, one, other| {
        if belong_together(one, other) {
            pairs.push((sum_ratio(one, other).abs(), [one, other]));
        }
    });
    pairs.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    pairs.into_iter().map(|(_, pair)| pair).collect()
}

/// The eigenvalues without those closest to the ones given.
pub(crate) fn without(eigenvalues: &[Complex64], removed: &[Complex64]) -> Vec<Complex64> {
    let mut rest = eigenvalues.to_vec();
    for target in removed {
        let nearest =
            (0..rest.len()).min_by(|&a, &b| (rest[a] - target).norm().total_cmp(&(rest[b] - target).norm()));
        if let Some(index) = nearest {
            rest.remove(index);
        }
    }
    rest
}

/// `(a + b)/(|a| + |b|)` where that is real, the modulus otherwise; zero for a double zero.
fn sum_ratio(one: Complex64, other: Complex64) -> f64 {
    let size = one.norm() + other.norm();
    if size == 0.0 {
        return 0.0;
    }
    let sum = one + other;
    if belong_together(one, other) { sum.re / size } else { sum.norm() / size }
}

/// Whether two eigenvalues are complex conjugate or both real. Members of two equal pairs, which symmetry makes, are not
/// conjugate although rounding may give them opposite imaginary parts.
fn belong_together(one: Complex64, other: Complex64) -> bool {
    one.im == -other.im && (one.im == 0.0 || one.re == other.re)
}

fn for_each_pair(eigenvalues: &[Complex64], mut visit: impl FnMut([usize; 2], Complex64, Complex64)) {
    for (first, &one) in eigenvalues.iter().enumerate() {
        for (offset, &other) in eigenvalues[first + 1..].iter().enumerate() {
            visit([first, first + 1 + offset], one, other);
        }
    }
}
