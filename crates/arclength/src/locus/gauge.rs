//! Changes of the normalisation of eigenvectors, carried over to solutions and tangents exactly.
//!
//! A null vector is known up to a factor, a pair of vectors that spans a critical plane up to two. What normalisation is
//! chosen suits one solution; other solutions and their tangents are rewritten so that they solve the equations with the new
//! normalisation as they did with the old one.

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Whether a vector of unknowns is a solution: then its part `range` has the product one with the normal, otherwise (if it is
/// a tangent) zero.
fn is_solution(vector: &[f64], range: std::ops::Range<usize>, normal: &[f64]) -> bool {
    inner(&vector[range], normal) > 0.5
}

/// Rewrites solutions and tangents with a null vector in `n..2n` for the normalisation `<normal, v> = 1`.
pub(super) fn rewrite_vector(
    n: usize,
    old: &[f64],
    normal: &[f64],
    unknown: &mut [f64],
    vectors: &mut [&mut Vec<f64>],
) {
    let mut base = unknown[n..2 * n].to_vec();
    let rescale = |vector: &mut [f64], base: &[f64]| {
        let factor = inner(normal, base).recip();
        vector[n..2 * n].iter_mut().for_each(|entry| *entry *= factor);
        factor
    };
    rescale(unknown, &base);
    for vector in vectors {
        if is_solution(vector, n..2 * n, old) {
            base = vector[n..2 * n].to_vec();
            rescale(vector, &base);
        } else {
            let factor = rescale(vector, &base);
            let excess = inner(normal, &vector[n..2 * n]);
            for (entry, value) in vector[n..2 * n].iter_mut().zip(&base) {
                *entry -= excess * factor * value;
            }
        }
    }
}

/// A normalisation `<normal, v> = 1`, `<conormal, v> = 0` of the pair `(v, w)` in `n..2n` and `2n..3n`, where `f_x v = rate w`,
/// `f_x w = -kappa rate v` and `kappa` comes next.
#[derive(Clone, Debug)]
pub(super) struct PlaneGauge {
    pub normal: Vec<f64>,
    pub conormal: Vec<f64>,
    /// The old unit of frequencies divided by the new one.
    pub rate_ratio: f64,
}

/// The vector `a v + b w` and its partner `a w - b kappa v`.
pub(super) fn combine(first: &[f64], second: &[f64], kappa: f64, a: f64, b: f64) -> (Vec<f64>, Vec<f64>) {
    let mix = |x: &[f64], y: &[f64], p: f64, q: f64| x.iter().zip(y).map(|(x, y)| p * x + q * y).collect();
    (mix(first, second, a, b), mix(second, first, a, -b * kappa))
}

impl PlaneGauge {
    /// Coefficients with which a combination of `v` and `w` has the products `target` with normal and conormal.
    fn coefficients(&self, first: &[f64], second: &[f64], target: [f64; 2]) -> [f64; 2] {
        let [p, q] = [inner(&self.normal, first), inner(&self.normal, second)];
        let [r, s] = [inner(&self.conormal, first), inner(&self.conormal, second)];
        let determinant = p * s - q * r;
        [(target[0] * s - q * target[1]) / determinant, (p * target[1] - r * target[0]) / determinant]
    }

    /// Rewrites a solution and `vectors`, solutions or tangents at the solution before them; `old` is the normal so far.
    pub(super) fn rewrite(&self, n: usize, old: &[f64], unknown: &mut [f64], vectors: &mut [&mut Vec<f64>]) {
        let mut base = self.rewrite_solution(n, unknown);
        for vector in vectors {
            if is_solution(vector, n..2 * n, old) {
                base = self.rewrite_solution(n, vector);
            } else {
                self.rewrite_tangent(n, vector, &base);
            }
        }
    }

    fn rescale(&self, n: usize, vector: &mut [f64]) {
        vector[2 * n..3 * n].iter_mut().for_each(|entry| *entry *= self.rate_ratio);
        vector[3 * n] *= self.rate_ratio * self.rate_ratio;
    }

    fn rewrite_solution(&self, n: usize, unknown: &mut [f64]) -> Base {
        self.rescale(n, unknown);
        let (first, second, kappa) =
            (unknown[n..2 * n].to_vec(), unknown[2 * n..3 * n].to_vec(), unknown[3 * n]);
        let [a, b] = self.coefficients(&first, &second, [1.0, 0.0]);
        let (one, other) = combine(&first, &second, kappa, a, b);
        unknown[n..2 * n].copy_from_slice(&one);
        unknown[2 * n..3 * n].copy_from_slice(&other);
        Base { first, second, kappa, a, b }
    }

    fn rewrite_tangent(&self, n: usize, tangent: &mut [f64], base: &Base) {
        self.rescale(n, tangent);
        let (first, second) = (tangent[n..2 * n].to_vec(), tangent[2 * n..3 * n].to_vec());
        let (mut one, mut other) = combine(&first, &second, base.kappa, base.a, base.b);
        let target = [-inner(&self.normal, &one), -inner(&self.conormal, &one)];
        let [a, b] = self.coefficients(&base.first, &base.second, target);
        let (one_more, other_more) = combine(&base.first, &base.second, base.kappa, a, b);
        let change = base.b * tangent[3 * n];
        for index in 0..n {
            one[index] += one_more[index];
            other[index] += other_more[index] - change * base.first[index];
        }
        tangent[n..2 * n].copy_from_slice(&one);
        tangent[2 * n..3 * n].copy_from_slice(&other);
    }
}

/// A solution before it was rewritten, and how it was.
struct Base {
    first: Vec<f64>,
    second: Vec<f64>,
    kappa: f64,
    a: f64,
    b: f64,
}
