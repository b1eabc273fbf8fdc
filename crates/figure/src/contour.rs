//! Contour lines of values on a grid by marching squares, joined into polylines.

use std::collections::HashMap;

use crate::geometry::Point;

/// An edge of the grid: from the node (column, row) to the right, or upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Edge {
    column: usize,
    row: usize,
    upwards: bool,
}

/// The polylines on which the values, interpolated linearly along the edges of the grid, equal `level`. The values are those at
/// the nodes, row after row: the abscissae `x` at the first ordinate of `y`, and so on. A closed polyline ends where it starts. Cells
/// with a corner that is not finite are left out.
pub fn contour_lines(x: &[f64], y: &[f64], values: &[f64], level: f64) -> Vec<Vec<Point>> {
    let columns = x.len();
    let value = |column: usize, row: usize| values[row * columns + column] - level;
    let crossing = |edge: Edge| {
        let (column, row) = (edge.column, edge.row);
        let (next_column, next_row) = if edge.upwards { (column, row + 1) } else { (column + 1, row) };
        let (a, b) = (value(column, row), value(next_column, next_row));
        Point::new(x[column], y[row]).lerp(Point::new(x[next_column], y[next_row]), a / (a - b))
    };

    let mut segments: Vec<(Edge, Edge)> = Vec::new();
    for row in 0..y.len().saturating_sub(1) {
        for column in 0..columns.saturating_sub(1) {
            let corners = [
                value(column, row),
                value(column + 1, row),
                value(column + 1, row + 1),
                value(column, row + 1),
            ];
            if corners.iter().any(|corner| !corner.is_finite()) {
                continue;
            }
            let edges = [
                Edge { column, row, upwards: false },
                Edge { column: column + 1, row, upwards: true },
                Edge { column, row: row + 1, upwards: false },
                Edge { column, row, upwards: true },
            ];
            let crossed: Vec<Edge> = (0..4)
                .filter(|i| (corners[*i] > 0.0) != (corners[(*i + 1) % 4] > 0.0))
                .map(|i| edges[i])
                .collect();
            match crossed[..] {
                [a, b] => segments.push((a, b)),
                [a, b, c, d] => {
                    // A saddle: the mean of the corners says which pair of corners is connected.
                    let joined = corners.iter().sum::<f64>() > 0.0;
                    if joined == (corners[0] > 0.0) {
                        segments.extend([(a, b), (c, d)]);
                    } else {
                        segments.extend([(d, a), (b, c)]);
                    }
                }
                _ => {}
            }
        }
    }
    join(&segments).into_iter().map(|line| line.into_iter().map(crossing).collect()).collect()
}

/// Joins segments that share an edge; starts at loose ends first, so that only closed curves start in the middle.
fn join(segments: &[(Edge, Edge)]) -> Vec<Vec<Edge>> {
    let mut at_edge: HashMap<Edge, Vec<usize>> = HashMap::new();
    for (index, (a, b)) in segments.iter().enumerate() {
        at_edge.entry(*a).or_default().push(index);
        at_edge.entry(*b).or_default().push(index);
    }
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    let mut follow = |first: usize, start: Edge| {
        let mut line = vec![start];
        let (mut segment, mut at) = (first, start);
        while !used[segment] {
            used[segment] = true;
            let (a, b) = segments[segment];
            at = if a == at { b } else { a };
            line.push(at);
            match at_edge[&at].iter().find(|next| !used[**next]) {
                Some(next) => segment = *next,
                None => break,
            }
        }
        if line.len() > 1 {
            lines.push(line);
        }
    };
    for (index, (a, b)) in segments.iter().enumerate() {
        for end in [a, b] {
            if at_edge[end].len() == 1 {
                follow(index, *end);
            }
        }
    }
    for (index, (a, _)) in segments.iter().enumerate() {
        follow(index, *a);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(n: usize, f: impl Fn(f64, f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let nodes: Vec<f64> = (0..n).map(|i| -2.0 + 4.0 * i as f64 / (n - 1) as f64).collect();
        let values = nodes.iter().flat_map(|y| nodes.iter().map(|x| f(*x, *y)).collect::<Vec<_>>()).collect();
        (nodes, values)
    }

    #[test]
    fn the_contour_of_a_cone_is_one_closed_circle() {
        let (nodes, values) = sampled(41, f64::hypot);
        let lines = contour_lines(&nodes, &nodes, &values, 1.3);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for p in &lines[0] {
            assert!((p.x.hypot(p.y) - 1.3).abs() < 2e-3, "{p:?}");
        }
    }

    #[test]
    fn the_contour_of_a_plane_is_one_open_line() {
        let (nodes, values) = sampled(7, |x, y| x + 0.5 * y);
        let lines = contour_lines(&nodes, &nodes, &values, 0.1);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|p| (p.x + 0.5 * p.y - 0.1).abs() < 1e-12));
        let (first, last) = (lines[0][0], lines[0][lines[0].len() - 1]);
        assert!((first.y - last.y).abs() > 3.9);
    }

    #[test]
    fn cells_that_are_not_finite_are_left_out() {
        let (nodes, mut values) = sampled(5, |x, _| x - 0.1);
        values[12] = f64::NAN;
        assert_eq!(contour_lines(&nodes, &nodes, &values, 0.0).len(), 2);
        assert!(contour_lines(&[0.0], &[0.0], &[1.0], 0.0).is_empty());
    }
}
