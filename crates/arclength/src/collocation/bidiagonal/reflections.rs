//! Householder reflections of two neighbouring block rows: what eliminates an interior unknown of a block-bidiagonal system.

/// Inner product.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// QR factorisation of a 2n-by-n matrix in place: triangle above, reflectors below with the leading entry
/// of each kept in `factors` as `beta = 2 / v'v` after scaling `v` to leading entry one.
#[inline(always)]
pub(super) fn triangularize(matrix: &mut [f64], factors: &mut [f64], n: usize) -> bool {
    let rows = 2 * n;
    for step in 0..n {
        let (left, right) = matrix.split_at_mut((step + 1) * rows);
        let column = &mut left[step * rows..];
        let norm = dot(&column[step..], &column[step..]).sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            return false;
        }
        let alpha = if column[step] > 0.0 { -norm } else { norm };
        let leading = column[step] - alpha;
        let scale = 1.0 / leading;
        for entry in &mut column[step + 1..] {
            *entry *= scale;
        }
        factors[step] = -leading / alpha;
        column[step] = alpha;
        let reflector = &column[step + 1..];
        for other in right.chunks_exact_mut(rows) {
            let projection = factors[step] * (other[step] + dot(reflector, &other[step + 1..]));
            other[step] -= projection;
            for (entry, component) in other[step + 1..].iter_mut().zip(reflector) {
                *entry -= projection * component;
            }
        }
    }
    true
}

/// Applies the reflections to columns of length 2n.
#[inline(always)]
pub(super) fn reflect(reflectors: &[f64], factors: &[f64], n: usize, columns: &mut [f64]) {
    let rows = 2 * n;
    for other in columns.chunks_exact_mut(rows) {
        for step in 0..n {
            let reflector = &reflectors[step * rows + step + 1..(step + 1) * rows];
            let projection = factors[step] * (other[step] + dot(reflector, &other[step + 1..]));
            other[step] -= projection;
            for (entry, component) in other[step + 1..].iter_mut().zip(reflector) {
                *entry -= projection * component;
            }
        }
    }
}

/// Replaces the row `y` by `y U^-1`, `U` the triangle in the first n rows.
#[inline(always)]
pub(super) fn solve_triangle_from_left(reflectors: &[f64], n: usize, y: &mut [f64]) {
    for column in 0..n {
        let upper = &reflectors[column * 2 * n..column * 2 * n + column + 1];
        let sum = dot(&y[..column], upper);
        y[column] = (y[column] - sum) / upper[column];
    }
}
