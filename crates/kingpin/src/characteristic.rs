//! The characteristic polynomial of a 5 x 5 matrix, and the roots of a polynomial of degree 3 to 5.
//!
//! The matrix is balanced (Parlett and Reinsch 1969), reduced to Hessenberg form by stabilised elimination (Martin and
//! Wilkinson 1968) and expanded by La Budde's recurrence (1956; Rehman and Ipsen 2011). The roots come from Laguerre's
//! iteration with deflation, and are polished on the undeflated polynomial.

use num_complex::Complex64;

/// Balancing stops when a scaling by two no longer lowers the norms of a row and its column by this factor.
const BALANCING_GAIN: f64 = 0.95;
/// More sweeps than balancing takes at entries within the range of doubles.
const BALANCING_SWEEPS: usize = 100;
/// Laguerre's iteration converges cubically to a simple root: a relative step below this leaves an error at the level of
/// rounding even where another root is near.
const LAGUERRE_TOLERANCE: f64 = 1e-10;
/// Laguerre's iteration takes four or five steps; every tenth is halved, which breaks cycles.
const LAGUERRE_STEPS: usize = 60;
/// Newton's method converges quadratically to a simple root of a cubic: a relative step below this leaves an error at the
/// level of rounding. A double root takes up to twenty-seven steps to it, each of which halves the error.
const CUBIC_TOLERANCE: f64 = 1e-8;
const CUBIC_STEPS: usize = 40;
/// Roots with a smaller imaginary part than this, relative to the modulus, may be real.
const NEAR_REAL_AXIS: f64 = 1e-4;
/// Newton's method polishes a root by at most this part of its distance from the others.
const LARGEST_POLISHING_STEP: f64 = 1e-4;

/// The coefficients `c1 ... c5` of `det(s I - A) = s^5 + c1 s^4 + ... + c5`.
pub fn characteristic_polynomial(matrix: &[[f64; 5]; 5]) -> [f64; 5] {
    let mut hessenberg = *matrix;
    balance(&mut hessenberg);
    reduce_to_hessenberg(&mut hessenberg);
    // polynomials[i] has degree i, lowest power first: the characteristic polynomial of the leading i x i block.
    let mut polynomials = [[0.0; 6]; 6];
    polynomials[0][0] = 1.0;
    for order in 1..=5 {
        let column = order - 1;
        let mut next = [0.0; 6];
        next[1..].copy_from_slice(&polynomials[order - 1][..5]);
        let mut subdiagonals = 1.0;
        for row in (0..order).rev() {
            let factor = hessenberg[row][column] * subdiagonals;
            for (coefficient, lower) in next.iter_mut().zip(polynomials[row]) {
                *coefficient -= factor * lower;
            }
            if row > 0 {
                subdiagonals *= hessenberg[row][row - 1];
            }
        }
        polynomials[order] = next;
    }
    let [c5, c4, c3, c2, c1, _] = polynomials[5];
    [c1, c2, c3, c4, c5]
}

fn balance(matrix: &mut [[f64; 5]; 5]) {
    for _ in 0..BALANCING_SWEEPS {
        let mut balanced = true;
        for index in 0..5 {
            let others = || (0..5).filter(|&other| other != index);
            let row: f64 = others().map(|other| matrix[index][other].abs()).sum();
            let mut column: f64 = others().map(|other| matrix[other][index].abs()).sum();
            if row == 0.0 || column == 0.0 || !(row + column).is_finite() {
                continue;
            }
            let sum = row + column;
            let mut factor = 1.0;
            while column < row / 2.0 {
                factor *= 2.0;
                column *= 4.0;
            }
            while column > row * 2.0 {
                factor /= 2.0;
                column /= 4.0;
            }
            if (column + row) / factor < BALANCING_GAIN * sum {
                balanced = false;
                matrix[index] = matrix[index].map(|element| element / factor);
                matrix.iter_mut().for_each(|row| row[index] *= factor);
            }
        }
        if balanced {
            break;
        }
    }
}

fn reduce_to_hessenberg(matrix: &mut [[f64; 5]; 5]) {
    for column in 0..3 {
        let below = column + 1;
        let pivot = (below..5).fold(below, |pivot, row| {
            if matrix[row][column].abs() > matrix[pivot][column].abs() { row } else { pivot }
        });
        if matrix[pivot][column] == 0.0 {
            continue;
        }
        matrix.swap(pivot, below);
        matrix.iter_mut().for_each(|row| row.swap(pivot, below));
        for row in below + 1..5 {
            // The similarity changes the pivot row too: read it anew.
            let pivot_row = matrix[below];
            let factor = matrix[row][column] / pivot_row[column];
            if factor == 0.0 {
                continue;
            }
            for (element, above) in matrix[row].iter_mut().zip(pivot_row) {
                *element -= factor * above;
            }
            matrix.iter_mut().for_each(|line| line[below] += factor * line[row]);
        }
    }
}

/// The roots of `s^n + c1 s^(n-1) + ... + cn` for `n` up to 5, largest real part first, of a conjugate pair the upper
/// first.
pub fn roots<const N: usize>(coefficients: &[f64; N]) -> [Complex64; N] {
    const { assert!(N >= 2 && N <= 5) };
    let mut whole = [0.0; 6];
    whole[N] = 1.0;
    for (coefficient, &given) in whole[..N].iter_mut().zip(coefficients.iter().rev()) {
        *coefficient = given;
    }
    let mut rest = whole;
    let mut degree = N;
    let mut found = [Complex64::ZERO; N];
    while degree > 3 {
        let root = laguerre(&rest, degree);
        if is_real(&rest, degree, root) {
            found[N - degree] = Complex64::new(root.re, 0.0);
            deflate_linear(&mut rest, degree, root.re);
            degree -= 1;
        } else {
            let upper = Complex64::new(root.re, root.im.abs());
            (found[N - degree], found[N + 1 - degree]) = (upper, upper.conj());
            deflate_quadratic(&mut rest, degree, 2.0 * root.re, -root.norm_sqr());
            degree -= 2;
        }
    }
    if degree == 3 {
        let root = real_root_of_cubic(rest[2], rest[1], rest[0]);
        found[N - 3] = Complex64::new(root, 0.0);
        deflate_cubic(&mut rest, root);
    }
    [found[N - 2], found[N - 1]] = quadratic_roots(rest[1], rest[0]);
    let mut found = polish(&whole[..=N], &found);
    found.sort_unstable_by(largest_real_part_first);
    found
}

/// The order in which eigenvalues are given.
pub(crate) fn largest_real_part_first(one: &Complex64, other: &Complex64) -> std::cmp::Ordering {
    other.re.total_cmp(&one.re).then(other.im.total_cmp(&one.im))
}

/// Laguerre's iteration from the origin, which as a rule leads to one of the smallest roots.
#[inline]
fn laguerre(polynomial: &[f64; 6], degree: usize) -> Complex64 {
    let n = degree as f64;
    let mut root = Complex64::ZERO;
    for step in 1..=LAGUERRE_STEPS {
        let (mut value, mut slope, mut curvature) = (Complex64::ZERO, Complex64::ZERO, Complex64::ZERO);
        let (mut rounding, modulus) = (0.0, root.norm_sqr().sqrt());
        for &coefficient in polynomial[..=degree].iter().rev() {
            curvature = curvature * root + slope;
            slope = slope * root + value;
            value = value * root + coefficient;
            rounding = rounding * modulus + f64::abs(coefficient);
        }
        rounding *= f64::EPSILON;
        // `curvature` is half the second derivative. Root of the quadratic model, multiplied through by the value.
        let discriminant =
            slope * slope * ((n - 1.0) * (n - 1.0)) - value * curvature * (2.0 * n * (n - 1.0));
        let square_root = principal_square_root(discriminant);
        let same_side = slope.re * square_root.re + slope.im * square_root.im >= 0.0;
        let denominator = if same_side { slope + square_root } else { slope - square_root };
        let size = denominator.norm_sqr();
        if value.norm_sqr() <= rounding * rounding {
            break;
        }
        if size == 0.0 {
            // As at the origin of s^5 + c5: both derivatives vanish, any direction is as good.
            root += Complex64::new(1.0, 0.5) * value.norm().powf(n.recip());
            continue;
        }
        let mut change = value * denominator.conj() * (n / size);
        if step % 10 == 0 {
            change *= 0.5;
        }
        root -= change;
        if change.norm_sqr() <= LAGUERRE_TOLERANCE * LAGUERRE_TOLERANCE * root.norm_sqr() {
            break;
        }
    }
    root
}

#[inline]
fn principal_square_root(number: Complex64) -> Complex64 {
    if number.im == 0.0 {
        let root = number.re.abs().sqrt();
        return if number.re < 0.0 { Complex64::new(0.0, root) } else { Complex64::new(root, 0.0) };
    }
    let modulus = number.norm_sqr().sqrt();
    let larger = (0.5 * (modulus + number.re.abs())).sqrt();
    let smaller = 0.5 * number.im.abs() / larger;
    let (re, im) = if number.re >= 0.0 { (larger, smaller) } else { (smaller, larger) };
    Complex64::new(re, im.copysign(number.im))
}

/// Whether a root found in complex arithmetic is real but for rounding: it lies near the real axis, and the parabola that
/// touches the polynomial below it meets the axis.
fn is_real(polynomial: &[f64; 6], degree: usize, root: Complex64) -> bool {
    if root.im * root.im > NEAR_REAL_AXIS * NEAR_REAL_AXIS * root.norm_sqr() {
        return false;
    }
    let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
    for &coefficient in polynomial[..=degree].iter().rev() {
        curvature = curvature * root.re + slope;
        slope = slope * root.re + value;
        value = value * root.re + coefficient;
    }
    slope * slope >= 4.0 * value * curvature
}

/// Divides by `s - root`.
fn deflate_linear(polynomial: &mut [f64; 6], degree: usize, root: f64) {
    let mut carried = 0.0;
    for coefficient in polynomial[..=degree].iter_mut().rev() {
        let kept = carried;
        carried = carried * root + *coefficient;
        *coefficient = kept;
    }
}

/// Divides by `s^2 - linear s - constant`.
fn deflate_quadratic(polynomial: &mut [f64; 6], degree: usize, linear: f64, constant: f64) {
    let (mut last, mut before) = (0.0, 0.0);
    for coefficient in polynomial[..=degree].iter_mut().rev() {
        let kept = before;
        (before, last) = (last, *coefficient + linear * last + constant * before);
        *coefficient = kept;
    }
}

/// The real root of `s^3 + a s^2 + b s + c` that lies beyond the inflection and both extrema, if there are any: from a
/// bound on it Newton's method converges monotonically.
fn real_root_of_cubic(a: f64, b: f64, c: f64) -> f64 {
    let inflection = -a / 3.0;
    let slope = b + a * inflection;
    let value = c + inflection * (b + inflection * (a + inflection));
    let mut offset = -(value.abs().cbrt() + f64::max(-slope, 0.0).sqrt()).copysign(value);
    for _ in 0..CUBIC_STEPS {
        let derivative = 3.0 * offset * offset + slope;
        if derivative <= 0.0 {
            break;
        }
        let step = (offset * (offset * offset + slope) + value) / derivative;
        offset -= step;
        if step.abs() <= CUBIC_TOLERANCE * offset.abs() {
            break;
        }
    }
    inflection + offset
}

/// Divides a cubic by `s - root`, in the direction that does not amplify the error of the root.
fn deflate_cubic(polynomial: &mut [f64; 6], root: f64) {
    let [c, b, a, ..] = *polynomial;
    if root.abs().powi(3) > c.abs() {
        let constant = -c / root;
        (polynomial[0], polynomial[1]) = (constant, (constant - b) / root);
    } else {
        let linear = a + root;
        (polynomial[0], polynomial[1]) = (b + root * linear, linear);
    }
}

/// The roots of `s^2 + linear s + constant`, without cancellation.
fn quadratic_roots(linear: f64, constant: f64) -> [Complex64; 2] {
    let half = -0.5 * linear;
    let discriminant = half * half - constant;
    if discriminant < 0.0 {
        let root = Complex64::new(half, (-discriminant).sqrt());
        return [root, root.conj()];
    }
    let larger = half + discriminant.sqrt().copysign(half);
    let smaller = if larger == 0.0 { 0.0 } else { constant / larger };
    [Complex64::new(larger, 0.0), Complex64::new(smaller, 0.0)]
}

/// One step of Newton's method for each root, on the polynomial that was not deflated; a root that has another near it
/// keeps its place, for there the error of the one makes up for that of the other.
#[inline]
fn polish<const N: usize>(polynomial: &[f64], roots: &[Complex64; N]) -> [Complex64; N] {
    let mut polished = *roots;
    for (index, root) in roots.iter().enumerate() {
        if root.im < 0.0 {
            // The lower root of a pair follows the upper.
            polished[index] = polished[index - 1].conj();
            continue;
        }
        let (mut value, mut slope) = (Complex64::ZERO, Complex64::ZERO);
        for &coefficient in polynomial.iter().rev() {
            slope = slope * root + value;
            value = value * root + coefficient;
        }
        let step = value * slope.conj() / slope.norm_sqr();
        let others = roots.iter().enumerate().filter(|(other, _)| *other != index);
        let separation = others.fold(f64::INFINITY, |least, (_, other)| least.min((other - root).norm_sqr()));
        if step.norm_sqr() <= LARGEST_POLISHING_STEP * LARGEST_POLISHING_STEP * separation {
            polished[index] -= step;
        }
    }
    polished
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The monic quintic with these real factors, `s + real` and `s^2 + linear s + constant` twice.
    fn expand(real: f64, quadratics: [[f64; 2]; 2]) -> [f64; 5] {
        let mut polynomial = vec![1.0, real];
        for [linear, constant] in quadratics {
            let mut product = vec![0.0; polynomial.len() + 2];
            for (index, coefficient) in polynomial.iter().enumerate() {
                product[index] += coefficient;
                product[index + 1] += coefficient * linear;
                product[index + 2] += coefficient * constant;
            }
            polynomial = product;
        }
        std::array::from_fn(|index| polynomial[index + 1])
    }

    proptest! {
        #[test]
        fn roots_make_the_polynomial(
            scale in -3.0_f64..3.0, real in -3.0..3.0_f64, a in -3.0..3.0_f64, b in -4.0..4.0_f64, c in -3.0..3.0_f64,
            d in -4.0..4.0_f64,
        ) {
            let unit = 10.0_f64.powf(scale);
            let coefficients =
                expand(real * unit, [[a * unit, b * unit * unit], [c * unit, d * unit * unit]]);
            let found = roots(&coefficients);
            // Each is a root of a polynomial that differs by rounding only.
            for root in found {
                let (mut value, mut terms) = (Complex64::ONE, 1.0);
                for coefficient in coefficients {
                    value = value * root + coefficient;
                    terms = terms * root.norm() + coefficient.abs();
                }
                prop_assert!(value.norm() <= 1e-13 * terms, "{root} {coefficients:?} {found:?}");
            }
            // None is found twice: together they make the polynomial, near roots with correlated errors.
            let mut product = [Complex64::ZERO; 6];
            product[0] = Complex64::ONE;
            for (degree, root) in found.iter().enumerate() {
                for index in (0..=degree).rev() {
                    let lower = product[index];
                    product[index + 1] -= lower * root;
                }
            }
            let size = found.iter().map(|root| root.norm()).fold(0.0, f64::max);
            for (index, coefficient) in coefficients.into_iter().enumerate() {
                let error = (product[index + 1] - coefficient).norm() / size.powi(index as i32 + 1);
                prop_assert!(error < 1e-8, "{index} {error:e} {coefficients:?} {found:?}");
            }
        }
    }

    #[test]
    fn known_roots() {
        let found = roots(&expand(3.0, [[2.0, 2.0], [0.0, 25.0]]));
        let expected = [(0.0, 5.0), (0.0, -5.0), (-1.0, 1.0), (-1.0, -1.0), (-3.0, 0.0)];
        for (found, (re, im)) in found.into_iter().zip(expected) {
            assert!((found - Complex64::new(re, im)).norm() < 1e-13, "{found}");
        }
        assert_eq!(roots(&[0.0; 5]), [Complex64::ZERO; 5]);
        assert!(roots(&[0.0, 0.0, 0.0, 0.0, -32.0]).iter().all(|root| (root.norm() - 2.0).abs() < 1e-14));
        let cubic = roots(&[4.0, 6.0, 4.0]);
        for (found, (re, im)) in cubic.into_iter().zip([(-1.0, 1.0), (-1.0, -1.0), (-2.0, 0.0)]) {
            assert!((found - Complex64::new(re, im)).norm() < 1e-14, "{cubic:?}");
        }
        let multiple = roots(&[5.0, 10.0, 10.0, 5.0, 1.0]);
        assert!(multiple.iter().all(|root| (root + 1.0).norm() < 5e-3), "{multiple:?}");
    }

    #[test]
    fn characteristic_polynomial_of_a_badly_scaled_companion_matrix() {
        let coefficients = [-15.0, 85.0, -225.0, 274.0, -120.0];
        let scale = [1.0, 1e6, 1e-5, 1e3, 1e-8];
        let mut matrix = [[0.0; 5]; 5];
        for index in 0..5 {
            matrix[0][index] = -coefficients[index] * scale[0] / scale[index];
        }
        for index in 0..4 {
            matrix[index + 1][index] = scale[index + 1] / scale[index];
        }
        for (found, expected) in characteristic_polynomial(&matrix).into_iter().zip(coefficients) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
}
