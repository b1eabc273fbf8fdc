//! The parabola through three points of a curve, whose vertex is a guess at its extremum.

/// Abscissa of the vertex of the parabola through three points.
pub(crate) fn vertex([[x0, y0], [x1, y1], [x2, y2]]: [[f64; 2]; 3]) -> Option<f64> {
    let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let place = 0.5 * (x0 + x1) - 0.5 * left * (x2 - x0) / (right - left);
    place.is_finite().then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertex_of_a_parabola() {
        let parabola = |x: f64| [x, 3.0 - 2.0 * (x - 0.3) * (x - 0.3)];
        assert!((vertex([parabola(-1.0), parabola(0.1), parabola(0.9)]).unwrap() - 0.3).abs() < 1e-15);
    }
}
