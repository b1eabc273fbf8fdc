//! Householder reflectors, the building block of every reduction in this folder.
//!
//! A reflector is `I - tau v v^T` with `v = (1, ...)`, chosen so that it maps a given vector onto a multiple
//! of the first unit vector (Golub and Van Loan 2013, section 5.1). Squares of tiny components underflow and
//! would spoil the orthogonality of the reflector, so tiny vectors are scaled up first.

/// Below this square of a norm a vector is scaled up before its norm is taken.
const TINY_SQUARE: f64 = 1e-200;
/// The factor by which tiny vectors are scaled up: 2^600.
const SCALE_UP: f64 = f64::from_bits((600 + 1023) << 52);
const SCALE_DOWN: f64 = 1.0 / SCALE_UP;

/// A reflector of three components (of two when `second` is zero): `I - tau v v^T`, `v = (1, first, second)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmallReflector {
    /// What the first component of the given vector becomes; the others become zero.
    pub beta: f64,
    pub tau: f64,
    pub first: f64,
    pub second: f64,
}

impl SmallReflector {
    /// The reflector that maps `(x, y, z)` onto `(beta, 0, 0)`. Components must not exceed about 1e150.
    #[inline]
    pub(super) fn annihilating([x, y, z]: [f64; 3]) -> Self {
        let tail = y * y + z * z;
        let square = x * x + tail;
        if square < TINY_SQUARE {
            if y == 0.0 && z == 0.0 {
                return SmallReflector { beta: x, tau: 0.0, first: 0.0, second: 0.0 };
            }
            let mut scaled = Self::annihilating_scaled(x, y, z);
            scaled.beta *= SCALE_DOWN;
            return scaled;
        }
        if tail == 0.0 {
            return SmallReflector { beta: x, tau: 0.0, first: 0.0, second: 0.0 };
        }
        Self::with_norm(x, y, z, square.sqrt())
    }

    #[cold]
    fn annihilating_scaled(x: f64, y: f64, z: f64) -> Self {
        let (x, y, z) = (x * SCALE_UP, y * SCALE_UP, z * SCALE_UP);
        Self::with_norm(x, y, z, (x * x + y * y + z * z).sqrt())
    }

    #[inline]
    fn with_norm(x: f64, y: f64, z: f64, norm: f64) -> Self {
        let beta = -norm.copysign(x);
        let reciprocal = 1.0 / (x - beta);
        SmallReflector { beta, tau: (beta - x) / beta, first: y * reciprocal, second: z * reciprocal }
    }

    /// Applies the reflector to `(x, y, z)`.
    #[inline(always)]
    pub(super) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let sum = self.tau * (x + self.first * y + self.second * z);
        [x - sum, y - sum * self.first, z - sum * self.second]
    }

    /// Applies the reflector to `(x, y)`; `second` must be zero.
    #[inline(always)]
    pub(super) fn apply_to_pair(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let sum = self.tau * (x + self.first * y);
        [x - sum, y - sum * self.first]
    }
}

/// Turns `vector` into the tail of the reflector that annihilates all but its first component, in place: on
/// return `vector[0]` is `beta` and `vector[1..]` is `v[1..]`. Returns `tau`, zero when there is nothing to
/// annihilate.
pub(super) fn householder(vector: &mut [f64]) -> f64 {
    let Some((first, tail)) = vector.split_first_mut() else { return 0.0 };
    if tail.iter().all(|x| *x == 0.0) {
        return 0.0;
    }
    let mut square: f64 = tail.iter().map(|x| x * x).sum::<f64>() + *first * *first;
    let mut unscale = 1.0;
    if square < TINY_SQUARE {
        *first *= SCALE_UP;
        tail.iter_mut().for_each(|x| *x *= SCALE_UP);
        square = tail.iter().map(|x| x * x).sum::<f64>() + *first * *first;
        unscale = SCALE_DOWN;
    }
    let beta = -square.sqrt().copysign(*first);
    let tau = (beta - *first) / beta;
    let reciprocal = 1.0 / (*first - beta);
    tail.iter_mut().for_each(|x| *x *= reciprocal);
    *first = beta * unscale;
    tau
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflector_of_tiny_vector_is_orthogonal() {
        for scale in [1.0, 1e-150, 1e-170, 1e-250, 1e-300] {
            let given = [0.3 * scale, -0.8 * scale, 0.1 * scale];
            let reflector = SmallReflector::annihilating(given);
            let image = reflector.apply(given);
            assert!((image[0] - reflector.beta).abs() < 1e-15 * scale);
            assert!(image[1].abs() < 1e-15 * scale && image[2].abs() < 1e-15 * scale);
            let square = 1.0 + reflector.first * reflector.first + reflector.second * reflector.second;
            assert!((reflector.tau * square - 2.0).abs() < 1e-14, "I - tau v v^T is orthogonal");

            let mut vector = given;
            let tau = householder(&mut vector);
            assert!((vector[0] - reflector.beta).abs() < 1e-15 * scale);
            assert!((tau - reflector.tau).abs() < 1e-15);
        }
    }
}
