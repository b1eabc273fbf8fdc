//! The two sweeps of the periodic QR iteration: the double-shift sweep and the deflation of a singular
//! factor.
//!
//! `factors` holds an upper Hessenberg matrix and upper triangular ones, n-by-n, column-major, one after the
//! other. Only the window of rows and columns `first..=last` is transformed, because only eigenvalues are
//! wanted.

use super::reflector::SmallReflector;
use super::wide_range::WideRange;

/// After this many sweeps without deflation an exceptional shift is tried, after twice as many an unshifted
/// sweep.
const EXCEPTIONAL_SHIFT_INTERVAL: usize = 10;

/// Shifts that turn the first column by less than this would underflow on their way through the factors.
pub(super) const HOPELESS_SHIFT: f64 = 1e-100;

type Wide = WideRange<f64>;

/// The reflectors that pass from one factor to the next: the second acts one row below the first.
#[derive(Clone, Copy)]
struct Carried {
    first: SmallReflector,
    second: SmallReflector,
}

/// Upper triangle of the product of the triangular factors, rows and columns `start..start + 3`.
fn triangular_product(factors: &[f64], n: usize, start: usize) -> [[Wide; 3]; 3] {
    let (zero, one) = (Wide::new(0.0), Wide::new(1.0));
    let mut product = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    for factor in factors.chunks_exact(n * n).skip(1) {
        let a = |row: usize, column: usize| factor[start + row + n * (start + column)];
        let [[p, q, r], [_, s, t], [_, _, u]] = product;
        product[0] = [p * a(0, 0), p * a(0, 1) + q * a(1, 1), p * a(0, 2) + q * a(1, 2) + r * a(2, 2)];
        product[1] = [zero, s * a(1, 1), s * a(1, 2) + t * a(2, 2)];
        product[2] = [zero, zero, u * a(2, 2)];
    }
    product
}

/// The first column of `(P - a I)(P - b I)` up to a factor, where `a`, `b` are the shifts of the product `P`.
fn first_column(factors: &[f64], n: usize, first: usize, last: usize, sweeps: usize) -> [f64; 3] {
    let h = |row: usize, column: usize| factors[row + n * column];
    let top = triangular_product(factors, n, first);
    let bottom = if first + 2 == last { top } else { triangular_product(factors, n, last - 2) };
    // Sum and product of the shifts: trace and determinant of the last two rows and columns of the product.
    let [[_, t01, t02], [_, t11, t12], [_, _, t22]] = bottom;
    let (k, l) = (last - 1, last);
    let (mut trace, mut determinant);
    if sweeps.is_multiple_of(2 * EXCEPTIONAL_SHIFT_INTERVAL) {
        (trace, determinant) = (Wide::new(0.0), Wide::new(0.0));
    } else if sweeps.is_multiple_of(EXCEPTIONAL_SHIFT_INTERVAL) {
        let size = (t11 * h(l, k)).abs() + (bottom[0][0] * h(k, k - 1)).abs();
        (trace, determinant) = (size * 1.5, size * size);
    } else {
        let a = t01 * h(k, k - 1) + t11 * h(k, k);
        let b = t02 * h(k, k - 1) + t12 * h(k, k) + t22 * h(k, l);
        let (c, d) = (t11 * h(l, k), t12 * h(l, k) + t22 * h(l, l));
        (trace, determinant) = (a + d, a * d - b * c);
    }
    let [[t00, t01, _], [_, t11, _], _] = top;
    let (k, l) = (first, first + 1);
    let below = h(l, k);
    loop {
        let head = t00 * h(k, k) + t01 * below;
        let x = ((head - trace) * h(k, k) + t11 * h(k, l) * below + determinant / t00) / Wide::new(below);
        let y = head + t11 * h(l, l) - trace;
        let z = t11 * h(first + 2, l);
        let common = Wide::common_exponent(&[x, y, z]);
        let (x, y, z) = (x.relative_to(common), y.relative_to(common), z.relative_to(common));
        let size = x.abs() + y.abs() + z.abs();
        let turning = y.abs() + z.abs() > HOPELESS_SHIFT * size;
        if turning || (trace.is_zero() && determinant.is_zero()) {
            return [x / size, y / size, z / size];
        }
        (trace, determinant) = (Wide::new(0.0), Wide::new(0.0));
    }
}

/// One implicit double-shift sweep over a window of at least three rows.
pub(super) fn double_shift_sweep(factors: &mut [f64], n: usize, first: usize, last: usize, sweeps: usize) {
    let mut vector = first_column(factors, n, first, last, sweeps);
    for k in first..last {
        let (hessenberg, triangular) = factors.split_at_mut(n * n);
        let three = k + 2 <= last;
        if k > first {
            let below = n * (k - 1) + k;
            vector =
                [hessenberg[below], hessenberg[below + 1], if three { hessenberg[below + 2] } else { 0.0 }];
        }
        let start = SmallReflector::annihilating(vector);
        if k > first {
            let below = n * (k - 1) + k;
            hessenberg[below] = start.beta;
            hessenberg[below + 1] = 0.0;
            if three {
                hessenberg[below + 2] = 0.0;
            }
        }
        if three {
            for column in hessenberg.chunks_exact_mut(n).take(last + 1).skip(k) {
                let rows = &mut column[k..k + 3];
                [rows[0], rows[1], rows[2]] = start.apply([rows[0], rows[1], rows[2]]);
            }
            let nothing = SmallReflector { beta: 0.0, tau: 0.0, first: 0.0, second: 0.0 };
            let mut carried = Carried { first: start, second: nothing };
            for factor in triangular.chunks_exact_mut(n * n).rev() {
                apply_to_columns(factor, n, k, first, k + 2, carried);
                carried = restore(factor, n, k, last);
            }
            apply_to_columns(hessenberg, n, k, first, (k + 3).min(last), carried);
        } else {
            for column in hessenberg.chunks_exact_mut(n).take(last + 1).skip(k) {
                [column[k], column[k + 1]] = start.apply_to_pair([column[k], column[k + 1]]);
            }
            let mut carried = start;
            for factor in triangular.chunks_exact_mut(n * n).rev() {
                apply_to_two_columns(factor, n, k, first, last, carried);
                carried = SmallReflector::annihilating([factor[k + n * k], factor[k + 1 + n * k], 0.0]);
                factor[k + n * k] = carried.beta;
                factor[k + 1 + n * k] = 0.0;
                for column in factor.chunks_exact_mut(n).take(last + 1).skip(k + 1) {
                    [column[k], column[k + 1]] = carried.apply_to_pair([column[k], column[k + 1]]);
                }
            }
            apply_to_two_columns(hessenberg, n, k, first, last, carried);
        }
    }
}

/// Multiplies columns `k..k + 3`, rows `first..=last_row`, by the carried reflectors from the right.
#[inline]
fn apply_to_columns(matrix: &mut [f64], n: usize, k: usize, first: usize, last_row: usize, carried: Carried) {
    let (a, rest) = matrix[n * k..n * (k + 3)].split_at_mut(n);
    let (b, c) = rest.split_at_mut(n);
    let rows = first..last_row + 1;
    let (a, b, c) = (&mut a[rows.clone()], &mut b[rows.clone()], &mut c[rows]);
    for ((x, y), z) in a.iter_mut().zip(b).zip(c) {
        let [p, q, r] = carried.first.apply([*x, *y, *z]);
        *x = p;
        [*y, *z] = carried.second.apply_to_pair([q, r]);
    }
}

/// Multiplies columns `k` and `k + 1`, rows `first..=last`, by a reflector from the right.
#[inline]
fn apply_to_two_columns(
    matrix: &mut [f64],
    n: usize,
    k: usize,
    first: usize,
    last: usize,
    carried: SmallReflector,
) {
    let (a, b) = matrix[n * k..n * (k + 2)].split_at_mut(n);
    for (x, y) in a[first..=last].iter_mut().zip(&mut b[first..=last]) {
        [*x, *y] = carried.apply_to_pair([*x, *y]);
    }
}

/// Makes the bulge in rows and columns `k..k + 3` of a factor triangular again.
#[inline]
fn restore(factor: &mut [f64], n: usize, k: usize, last: usize) -> Carried {
    let (left, right) = factor[..n * (last + 1)].split_at_mut(n * (k + 2));
    let (column, next) = left[n * k..].split_at_mut(n);
    let rows = &mut column[k..k + 3];
    let first = SmallReflector::annihilating([rows[0], rows[1], rows[2]]);
    (rows[0], rows[1], rows[2]) = (first.beta, 0.0, 0.0);
    let rows = &mut next[k..k + 3];
    [rows[0], rows[1], rows[2]] = first.apply([rows[0], rows[1], rows[2]]);
    let second = SmallReflector::annihilating([rows[1], rows[2], 0.0]);
    (rows[1], rows[2]) = (second.beta, 0.0);
    for column in right.chunks_exact_mut(n) {
        let rows = &mut column[k..k + 3];
        let [x, y, z] = first.apply([rows[0], rows[1], rows[2]]);
        rows[0] = x;
        [rows[1], rows[2]] = second.apply_to_pair([y, z]);
    }
    Carried { first, second }
}

/// Cosine and sine of the rotation `[c s; -s c]` that maps `(x, y)` onto `(r, 0)`.
fn rotation(x: f64, y: f64) -> (f64, f64) {
    if y == 0.0 {
        return (1.0, 0.0);
    }
    let r = x.hypot(y);
    (x / r, y / r)
}

fn rotate_rows(
    matrix: &mut [f64],
    n: usize,
    k: usize,
    columns: std::ops::RangeInclusive<usize>,
    (c, s): (f64, f64),
) {
    for column in columns {
        let (x, y) = (matrix[k + n * column], matrix[k + 1 + n * column]);
        matrix[k + n * column] = c * x + s * y;
        matrix[k + 1 + n * column] = c * y - s * x;
    }
}

fn rotate_columns(
    matrix: &mut [f64],
    n: usize,
    k: usize,
    rows: std::ops::RangeInclusive<usize>,
    (c, s): (f64, f64),
) {
    for row in rows {
        let (x, y) = (matrix[row + n * k], matrix[row + n * (k + 1)]);
        matrix[row + n * k] = c * x + s * y;
        matrix[row + n * (k + 1)] = c * y - s * x;
    }
}

/// Splits the window at row `zero`, where the diagonal of triangular factor number `singular` is zero.
///
/// An unshifted QR sweep from the top stops at the zero and leaves a zero left of row `zero` of the
/// Hessenberg factor; an unshifted RQ sweep from the bottom stops there too and leaves a zero below it
/// (Bojanczyk, Golub and Van Dooren 1992; Kressner 2005, section 4.1.4).
pub(super) fn deflate_zero(
    factors: &mut [f64],
    n: usize,
    first: usize,
    last: usize,
    singular: usize,
    zero: usize,
    rotations: &mut [(f64, f64)],
) {
    let (hessenberg, triangular) = factors.split_at_mut(n * n);
    for k in first..zero {
        let mut carried = rotation(hessenberg[k + n * k], hessenberg[k + 1 + n * k]);
        rotate_rows(hessenberg, n, k, k..=last, carried);
        hessenberg[k + 1 + n * k] = 0.0;
        for (i, factor) in triangular.chunks_exact_mut(n * n).enumerate().rev() {
            rotate_columns(factor, n, k, first..=k + 1, carried);
            if i + 1 == singular && k + 1 == zero {
                factor[zero + n * k] = 0.0;
            }
            carried = rotation(factor[k + n * k], factor[k + 1 + n * k]);
            rotate_rows(factor, n, k, k..=last, carried);
            factor[k + 1 + n * k] = 0.0;
        }
        rotations[k] = carried;
    }
    // Columns of the Hessenberg factor change only now: a rotation must not refill what the next one
    // annihilates.
    for (k, carried) in rotations.iter().enumerate().take(zero).skip(first) {
        rotate_columns(hessenberg, n, k, first..=k + 1, *carried);
    }
    for k in (zero..last).rev() {
        let (c, s) = rotation(hessenberg[k + 1 + n * (k + 1)], -hessenberg[k + 1 + n * k]);
        let mut carried = (c, s);
        rotate_columns(hessenberg, n, k, first..=k + 1, carried);
        hessenberg[k + 1 + n * k] = 0.0;
        for (i, factor) in triangular.chunks_exact_mut(n * n).enumerate() {
            rotate_rows(factor, n, k, k..=last, carried);
            if i + 1 == singular && k == zero {
                factor[k + 1 + n * k] = 0.0;
            }
            carried = rotation(factor[k + 1 + n * (k + 1)], -factor[k + 1 + n * k]);
            rotate_columns(factor, n, k, first..=k + 1, carried);
            factor[k + 1 + n * k] = 0.0;
        }
        rotations[k] = carried;
    }
    for k in (zero..last).rev() {
        rotate_rows(hessenberg, n, k, k..=last, rotations[k]);
    }
}
