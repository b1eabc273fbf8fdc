//! Eigenvalues of a real matrix: balancing, Hessenberg reduction, Francis's implicit double-shift QR
//! iteration.
//!
//! The deflation criterion is that of Ahues and Tisseur (1997), which keeps small eigenvalues of graded
//! matrices; the exceptional shifts and the test for two consecutive small subdiagonal entries follow
//! Wilkinson (1971) and LAPACK's `dlahqr`. The number of iterations is bounded: the iteration ends with
//! eigenvalues or with an error.

use num_complex::Complex64;

use super::balancing::{isolate, largest_exponent, power_of_two, scale};
use super::reflector::{SmallReflector, householder};
use super::strong_components::strong_components;

/// QR sweeps allowed for one window, per row of the matrix (at least ten rows are counted).
const SWEEPS_PER_ROW: usize = 30;
/// After this many sweeps without deflation an exceptional shift is tried.
const EXCEPTIONAL_SHIFT_INTERVAL: usize = 10;
/// Matrices whose largest entry lies outside `2^-200 .. 2^200` are scaled before anything is squared.
const UNSCALED_EXPONENT: i32 = 200;
/// Entries below this are negligible in a matrix of order one.
const NEGLIGIBLE: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Why eigenvalues, multipliers or their vectors could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EigenvalueError {
    /// The slice does not hold as many numbers as the dimensions say.
    #[error("expected {expected} numbers ({description}), found {found}")]
    Shape {
        /// Numbers needed.
        expected: usize,
        /// Numbers given.
        found: usize,
        /// How the needed number comes about.
        description: &'static str,
    },
    /// An entry is infinite or not a number. Indices count from zero; `factor` is zero for a single matrix.
    #[error("entry ({row}, {column}) of factor {factor} is {value}; all entries must be finite")]
    NotFinite {
        /// Factor of the product.
        factor: usize,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The eigenvalue or multiplier given is infinite or not a number.
    #[error("the eigenvalue {re} + {im} i is not finite")]
    EigenvalueNotFinite {
        /// Real part.
        re: f64,
        /// Imaginary part.
        im: f64,
    },
    /// The QR iteration did not separate the eigenvalues of rows `first..=last` within the allowed number of
    /// sweeps.
    #[error("no convergence of the QR iteration in rows {first} to {last} after {sweeps} sweeps")]
    NotConverged {
        /// First row of the remaining window.
        first: usize,
        /// Last row of the remaining window.
        last: usize,
        /// Sweeps spent on it.
        sweeps: usize,
    },
}

/// Checks that `matrices` holds `count` finite n-by-n matrices.
pub(super) fn check(matrices: &[f64], n: usize, count: usize) -> Result<(), EigenvalueError> {
    let expected = n * n * count;
    if matrices.len() != expected {
        let description = "count times n times n";
        return Err(EigenvalueError::Shape { expected, found: matrices.len(), description });
    }
    match matrices.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(EigenvalueError::NotFinite {
            factor: at / (n * n),
            row: at % n,
            column: at % (n * n) / n,
            value: matrices[at],
        }),
    }
}

/// Eigenvalues of the column-major n-by-n `matrix`, by descending real part, then by ascending imaginary
/// part.
///
/// Complex eigenvalues come in exactly conjugate pairs. For repeated use see [`EigenvalueWorkspace`].
///
/// # Errors
/// [`EigenvalueError`] when the shape is wrong, an entry is not finite, or the iteration does not converge.
///
/// # Examples
/// ```
/// use arclength::linear::eigenvalues::eigenvalues;
/// // The oscillator x'' + x = 0 as a first-order system, columns one after the other.
/// let eigenvalues = eigenvalues(&[0.0, -1.0, 1.0, 0.0], 2)?;
/// assert_eq!((eigenvalues[0].im, eigenvalues[1].im), (-1.0, 1.0));
/// # Ok::<(), arclength::linear::eigenvalues::EigenvalueError>(())
/// ```
pub fn eigenvalues(matrix: &[f64], n: usize) -> Result<Vec<Complex64>, EigenvalueError> {
    let mut workspace = EigenvalueWorkspace::new(n);
    workspace.eigenvalues(matrix)?;
    Ok(workspace.values)
}

/// Memory for eigenvalues of n-by-n matrices, so that repeated computations allocate nothing.
#[derive(Clone, Debug)]
pub struct EigenvalueWorkspace {
    n: usize,
    matrix: Vec<f64>,
    scales: Vec<f64>,
    values: Vec<Complex64>,
    sizes: Vec<f64>,
}

impl EigenvalueWorkspace {
    /// Memory for n-by-n matrices.
    pub fn new(n: usize) -> Self {
        EigenvalueWorkspace {
            n,
            matrix: vec![0.0; n * n],
            scales: vec![1.0; n],
            values: vec![Complex64::ZERO; n],
            sizes: vec![0.0; n],
        }
    }

    /// As the function [`eigenvalues`], without allocating unless the matrix is block triangular: then each block is on its own,
    /// so that fast ones do not spoil the digits of slow ones.
    ///
    /// # Errors
    /// As [`eigenvalues`].
    pub fn eigenvalues(&mut self, matrix: &[f64]) -> Result<&[Complex64], EigenvalueError> {
        let n = self.n;
        check(matrix, n, 1)?;
        let (group, groups) = strong_components(matrix, n);
        if groups <= 1 {
            self.of_one_block(matrix)?;
            let largest = self.values.iter().map(|value| value.norm()).fold(0.0, f64::max);
            self.sizes.fill(largest);
            return Ok(&self.values);
        }
        let mut found: Vec<(Complex64, f64)> = Vec::with_capacity(n);
        for block in 0..groups {
            let members: Vec<usize> = (0..n).filter(|&index| group[index] == block).collect();
            let entries = members.iter().flat_map(|column| members.iter().map(move |row| row + n * column));
            let part: Vec<f64> = entries.map(|entry| matrix[entry]).collect();
            let mut workspace = Self::new(members.len());
            workspace.of_one_block(&part)?;
            let largest = workspace.values.iter().map(|value| value.norm()).fold(0.0, f64::max);
            found.extend(workspace.values.iter().map(|value| (*value, largest)));
        }
        found.sort_by(|(a, _), (b, _)| b.re.total_cmp(&a.re).then(a.im.total_cmp(&b.im)));
        for ((value, size), (found, largest)) in self.values.iter_mut().zip(&mut self.sizes).zip(found) {
            (*value, *size) = (found, largest);
        }
        Ok(&self.values)
    }

    /// For each of the eigenvalues that were computed last the largest modulus in its block: its rounding error is a part of
    /// that.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// Eigenvalues of a matrix that is taken as a whole.
    fn of_one_block(&mut self, matrix: &[f64]) -> Result<(), EigenvalueError> {
        let n = self.n;
        self.matrix.copy_from_slice(matrix);
        let exponent = match largest_exponent(matrix) {
            Some(exponent) if exponent.abs() > UNSCALED_EXPONENT => exponent,
            _ => 0,
        };
        if exponent != 0 {
            let (a, b) = power_of_two(-exponent);
            self.matrix.iter_mut().for_each(|x| *x = *x * a * b);
        }
        let (low, high) = isolate(&mut self.matrix, n);
        for i in (0..low).chain(high..n) {
            self.values[i] = self.matrix[i + n * i].into();
        }
        if high > low {
            scale(&mut self.matrix, n, low, high, &mut self.scales);
            reduce_to_hessenberg(&mut self.matrix, n, low, high);
            francis(&mut self.matrix, n, low, high, &mut self.values)?;
        }
        if exponent != 0 {
            let (a, b) = power_of_two(exponent);
            self.values.iter_mut().for_each(|value| *value = *value * a * b);
        }
        // Adding zero turns -0 into 0, which the total order tells apart.
        self.values.iter_mut().for_each(|value| *value = Complex64::new(value.re + 0.0, value.im + 0.0));
        self.values.sort_unstable_by(|a, b| b.re.total_cmp(&a.re).then(a.im.total_cmp(&b.im)));
        Ok(())
    }
}

/// Householder reduction of the window `low..high` to upper Hessenberg form (the rest is not updated).
fn reduce_to_hessenberg(h: &mut [f64], n: usize, low: usize, high: usize) {
    for k in low..high.saturating_sub(2) {
        let (left, right) = h.split_at_mut(n * (k + 1));
        let vector = &mut left[n * k + k + 1..n * k + high];
        let tau = householder(vector);
        if tau == 0.0 {
            continue;
        }
        let beta = std::mem::replace(&mut vector[0], 1.0);
        for column in right.chunks_exact_mut(n).take(high - k - 1) {
            let column = &mut column[k + 1..high];
            let sum: f64 = tau * vector.iter().zip(&*column).map(|(v, x)| v * x).sum::<f64>();
            column.iter_mut().zip(&*vector).for_each(|(x, v)| *x -= sum * v);
        }
        for row in low..high {
            let mut sum = 0.0;
            for (column, v) in vector.iter().enumerate() {
                sum += right[row + n * column] * v;
            }
            sum *= tau;
            for (column, v) in vector.iter().enumerate() {
                right[row + n * column] -= sum * v;
            }
        }
        vector.fill(0.0);
        vector[0] = beta;
    }
}

/// First row of the unreduced window that ends in row `last`, found by a negligible subdiagonal entry.
fn window_start(h: &[f64], n: usize, low: usize, high: usize, first: usize, last: usize) -> usize {
    let at = |row: usize, column: usize| h[row + n * column];
    for k in (first + 1..=last).rev() {
        let below = at(k, k - 1).abs();
        if below <= NEGLIGIBLE {
            return k;
        }
        let mut size = at(k - 1, k - 1).abs() + at(k, k).abs();
        if size == 0.0 {
            if k >= low + 2 {
                size += at(k - 1, k - 2).abs();
            }
            if k + 1 < high {
                size += at(k + 1, k).abs();
            }
        }
        if below <= f64::EPSILON * size {
            // Ahues and Tisseur: compare with the 2-by-2 block made as diagonal as its entries allow.
            let above = at(k - 1, k).abs();
            let (ab, ba) = (below.max(above), below.min(above));
            let (d, e) = (at(k, k).abs(), (at(k - 1, k - 1) - at(k, k)).abs());
            let (aa, bb) = (d.max(e), d.min(e));
            let s = aa + ab;
            if ba * (ab / s) <= NEGLIGIBLE.max(f64::EPSILON * (bb * (aa / s))) {
                return k;
            }
        }
    }
    first
}

/// The two shifts of a double-shift sweep, both real or a conjugate pair with imaginary parts `im` and `-im`.
struct Shifts {
    re: [f64; 2],
    im: f64,
}

impl Shifts {
    /// Eigenvalues of `[a b; c d]`; when they are real, the one nearer to `d` twice.
    fn of(a: f64, b: f64, c: f64, d: f64) -> Self {
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        if size == 0.0 {
            return Shifts { re: [0.0; 2], im: 0.0 };
        }
        let (a, b, c, d) = (a / size, b / size, c / size, d / size);
        let middle = 0.5 * (a + d);
        let discriminant = (a - middle) * (d - middle) - b * c;
        let root = discriminant.abs().sqrt();
        if discriminant >= 0.0 {
            Shifts { re: [middle * size; 2], im: root * size }
        } else {
            let (one, other) = (middle + root, middle - root);
            let shift = if (one - d).abs() <= (other - d).abs() { one } else { other };
            Shifts { re: [shift * size; 2], im: 0.0 }
        }
    }
}

/// QR iteration on the window `low..high` of a Hessenberg matrix; writes `values[low..high]`.
fn francis(
    h: &mut [f64],
    n: usize,
    low: usize,
    high: usize,
    values: &mut [Complex64],
) -> Result<(), EigenvalueError> {
    let allowed = SWEEPS_PER_ROW * (high - low).max(10);
    let mut end = high;
    while end > low {
        let last = end - 1;
        let mut first = low;
        let mut sweeps = 0;
        loop {
            first = window_start(h, n, low, high, first, last);
            if first > low {
                h[first + n * (first - 1)] = 0.0;
            }
            if first + 1 >= last {
                break;
            }
            if sweeps == allowed {
                return Err(EigenvalueError::NotConverged { first, last, sweeps });
            }
            sweeps += 1;
            sweep(h, n, first, last, sweeps);
        }
        if first == last {
            values[last] = h[last + n * last].into();
        } else {
            let at = |row: usize, column: usize| h[row + n * column];
            let pair = block_eigenvalues(at(first, first), at(first, last), at(last, first), at(last, last));
            (values[first], values[last]) = pair;
        }
        end = first;
    }
    Ok(())
}

/// One double-shift sweep over rows `first..=last`, at least three of them.
fn sweep(h: &mut [f64], n: usize, first: usize, last: usize, count: usize) {
    let shifts = shifts(h, n, first, last, count);
    let Bulge { row: start, mut vector } = bulge(h, n, first, last, &shifts);
    for k in start..last {
        let three = k + 2 <= last;
        if k > start {
            let below = n * (k - 1) + k;
            vector = [h[below], h[below + 1], if three { h[below + 2] } else { 0.0 }];
        } else if !three {
            vector[2] = 0.0;
        }
        let reflector = SmallReflector::annihilating(vector);
        if k > start {
            let below = n * (k - 1) + k;
            h[below] = reflector.beta;
            h[below + 1] = 0.0;
            if three {
                h[below + 2] = 0.0;
            }
        } else if start > first {
            h[n * (k - 1) + k] *= 1.0 - reflector.tau;
        }
        if three {
            reflect_three(h, n, k, first, last, &reflector);
        } else {
            reflect_two(h, n, k, first, last, &reflector);
        }
    }
}

/// The shifts of the sweep of that number over rows `first..=last`: eigenvalues of the last two rows, now and then others.
#[inline]
fn shifts(h: &[f64], n: usize, first: usize, last: usize, count: usize) -> Shifts {
    let at = |row: usize, column: usize| h[row + n * column];
    let exceptional = |corner: f64, size: f64| {
        let diagonal = 0.75 * size + corner;
        Shifts::of(diagonal, -0.4375 * size, size, diagonal)
    };
    if count.is_multiple_of(2 * EXCEPTIONAL_SHIFT_INTERVAL) {
        exceptional(at(last, last), at(last, last - 1).abs() + at(last - 1, last - 2).abs())
    } else if count.is_multiple_of(EXCEPTIONAL_SHIFT_INTERVAL) {
        exceptional(at(first, first), at(first + 1, first).abs() + at(first + 2, first + 1).abs())
    } else {
        let (a, b) = (at(last - 1, last - 1), at(last - 1, last));
        Shifts::of(a, b, at(last, last - 1), at(last, last))
    }
}

/// Where a sweep starts.
struct Bulge {
    row: usize,
    /// The first column of the shifted square there, up to a factor.
    vector: [f64; 3],
}

/// Starts a sweep below two consecutive small subdiagonal entries, if there are any.
#[inline]
fn bulge(h: &[f64], n: usize, first: usize, last: usize, shifts: &Shifts) -> Bulge {
    let at = |row: usize, column: usize| h[row + n * column];
    let mut start = last - 2;
    loop {
        let (a, d) = (at(start, start), at(start + 1, start + 1));
        let below = at(start + 1, start);
        let size = (a - shifts.re[1]).abs() + shifts.im.abs() + below.abs();
        let ratio = below / size;
        let x = ratio * at(start, start + 1)
            + (a - shifts.re[0]) * ((a - shifts.re[1]) / size)
            + shifts.im * (shifts.im / size);
        let y = ratio * (a + d - shifts.re[0] - shifts.re[1]);
        let z = ratio * at(start + 2, start + 1);
        let size = x.abs() + y.abs() + z.abs();
        let vector = [x / size, y / size, z / size];
        if start == first {
            return Bulge { row: start, vector };
        }
        let neighbours = at(start - 1, start - 1).abs() + a.abs() + d.abs();
        let coupling = at(start, start - 1).abs() * (vector[1].abs() + vector[2].abs());
        if coupling <= f64::EPSILON * vector[0].abs() * neighbours {
            return Bulge { row: start, vector };
        }
        start -= 1;
    }
}

/// Applies a reflector from both sides to rows and columns `k..k + 3` of the rows `first..=last`.
#[inline]
fn reflect_three(h: &mut [f64], n: usize, k: usize, first: usize, last: usize, reflector: &SmallReflector) {
    for column in h.chunks_exact_mut(n).take(last + 1).skip(k) {
        let rows = &mut column[k..k + 3];
        [rows[0], rows[1], rows[2]] = reflector.apply([rows[0], rows[1], rows[2]]);
    }
    let rows = first..(k + 3).min(last) + 1;
    let (a, rest) = h[n * k..n * (k + 3)].split_at_mut(n);
    let (b, c) = rest.split_at_mut(n);
    let (a, b, c) = (&mut a[rows.clone()], &mut b[rows.clone()], &mut c[rows]);
    for ((x, y), z) in a.iter_mut().zip(b).zip(c) {
        [*x, *y, *z] = reflector.apply([*x, *y, *z]);
    }
}

/// The same for the last two rows and columns.
#[inline]
fn reflect_two(h: &mut [f64], n: usize, k: usize, first: usize, last: usize, reflector: &SmallReflector) {
    for column in h.chunks_exact_mut(n).take(last + 1).skip(k) {
        let rows = &mut column[k..k + 2];
        [rows[0], rows[1]] = reflector.apply_to_pair([rows[0], rows[1]]);
    }
    let (a, b) = h[n * k..n * (k + 2)].split_at_mut(n);
    for (x, y) in a[first..=last].iter_mut().zip(&mut b[first..=last]) {
        [*x, *y] = reflector.apply_to_pair([*x, *y]);
    }
}

/// Eigenvalues of `[a b; c d]` without cancellation, as LAPACK's `dlanv2` finds them.
fn block_eigenvalues(a: f64, b: f64, c: f64, d: f64) -> (Complex64, Complex64) {
    let real = |x: f64, y: f64| (Complex64::from(x), Complex64::from(y));
    if b == 0.0 || c == 0.0 {
        return real(a, d);
    }
    let difference = a - d;
    let half = 0.5 * difference;
    let larger = b.abs().max(c.abs());
    let smaller = b.abs().min(c.abs()) * b.signum() * c.signum();
    let size = half.abs().max(larger);
    let discriminant = half / size * half + larger / size * smaller;
    if discriminant >= 4.0 * f64::EPSILON * size {
        let z = half + (size.sqrt() * discriminant.sqrt()).copysign(half);
        return real(d + z, d - larger / z * smaller);
    }
    // Complex, or real and nearly equal: a rotation makes the diagonal entries equal.
    let sigma = b + c;
    let tau = sigma.hypot(difference);
    if tau == 0.0 {
        return (Complex64::new(a, -b.abs()), Complex64::new(a, b.abs()));
    }
    let cosine = (0.5 * (1.0 + sigma.abs() / tau)).sqrt();
    let sine = -(half / (tau * cosine)) * sigma.signum();
    let (aa, bb) = (a * cosine + b * sine, -a * sine + b * cosine);
    let (cc, dd) = (c * cosine + d * sine, -c * sine + d * cosine);
    let (b, c) = (bb * cosine + dd * sine, -aa * sine + cc * cosine);
    let middle = 0.5 * ((aa * cosine + cc * sine) + (-bb * sine + dd * cosine));
    let root = b.abs().sqrt() * c.abs().sqrt();
    if b * c.signum() >= 0.0 {
        real(middle + root, middle - root)
    } else {
        (Complex64::new(middle, -root), Complex64::new(middle, root))
    }
}
