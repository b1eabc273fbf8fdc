//! Smooth curves through few points: a cubic between two points whose directions are known.
//!
//! The direction of a curve is known at points at which it is said to be upright, as a branch is where it turns or where cycles are born,
//! and at points at which the parabola through it and its neighbours turns evenly. At a kink, where it turns much more than beside it, no
//! direction is known: the curve keeps its corner, and what leads there does not swing beyond it.

use crate::geometry::Point;

/// The largest turn in radians at a point that may belong to a smooth curve.
const LARGEST_TURN: f64 = 0.9;
/// A smooth curve turns at a point at most so many times as at the one of its neighbours where it turns more, beyond this allowance.
const UNEVEN: f64 = 2.5;
const ALLOWANCE: f64 = 0.06;
/// Largest angle between the direction at a point and the chord to the next, and the length of the handles in chords.
const LARGEST_ANGLE: f64 = 1.0;
const HANDLE: f64 = 1.0 / 3.0;
/// Length in points of the pieces of a cubic, and most of them.
const PIECE: f64 = 1.5;
const MOST_PIECES: usize = 40;

/// A direction of length 1.
type Direction = (f64, f64);

fn direction(from: Point, to: Point) -> Option<Direction> {
    let length = from.distance(to);
    (length > 0.0 && length.is_finite()).then(|| ((to.x - from.x) / length, (to.y - from.y) / length))
}

/// The angle from one direction to another, between -pi and pi.
fn turn(from: Direction, to: Direction) -> f64 {
    (from.0 * to.1 - from.1 * to.0).atan2(from.0 * to.0 + from.1 * to.1)
}

/// The turn of the line at a point; nothing at its ends and beside gaps.
fn turn_at(points: &[Point], index: usize) -> Option<f64> {
    let before = direction(*points.get(index.checked_sub(1)?)?, points[index])?;
    let after = direction(points[index], *points.get(index + 1)?)?;
    Some(turn(before, after))
}

/// The direction at a point of a smooth curve: that of the parabola through it and its neighbours, by the lengths of the chords.
fn of_parabola(points: &[Point], index: usize) -> Option<Direction> {
    let own = turn_at(points, index)?.abs();
    let beside = [index.checked_sub(1), Some(index + 1)];
    let beside = beside.into_iter().flatten().filter_map(|other| turn_at(points, other)).map(f64::abs);
    let most = beside.fold(0.0, f64::max);
    if own > LARGEST_TURN || own > UNEVEN * most + ALLOWANCE {
        return None;
    }
    let (before, here, after) = (points[index - 1], points[index], points[index + 1]);
    let (first, second) = (before.distance(here), here.distance(after));
    let slope = |before: f64, here: f64, after: f64| {
        ((here - before) / first * second + (after - here) / second * first) / (first + second)
    };
    let tangent = (slope(before.x, here.x, after.x), slope(before.y, here.y, after.y));
    let length = tangent.0.hypot(tangent.1);
    (length > 0.0).then(|| (tangent.0 / length, tangent.1 / length))
}

/// The upright direction that leads on from a point, up or down as its neighbour says.
fn upright(points: &[Point], index: usize) -> Option<Direction> {
    let rise = |from: Point, to: Point| to.y - from.y;
    let on = points.get(index + 1).filter(|next| next.is_finite()).map(|next| rise(points[index], *next));
    let back = || Some(rise(points[index.checked_sub(1)?], points[index]));
    let rise = on.or_else(back)?;
    (rise != 0.0).then(|| (0.0, rise.signum()))
}

/// The points of smooth curves between the given ones: for every two neighbours those from one to the other, both included. `is_upright`
/// says where the curve is known to be upright.
pub(crate) fn smoothed(points: &[Point], is_upright: &[bool]) -> Vec<Vec<Point>> {
    let known: Vec<Option<Direction>> = (0..points.len())
        .map(|index| {
            let is_upright = is_upright.get(index) == Some(&true);
            if is_upright { upright(points, index) } else { of_parabola(points, index) }
        })
        .collect();
    points
        .windows(2)
        .zip(known.windows(2))
        .map(|(ends, known)| cubic(ends[0], ends[1], known[0], known[1]))
        .collect()
}

/// The points of the cubic between two points, or the points alone where it is straight.
fn cubic(from: Point, to: Point, leaving: Option<Direction>, arriving: Option<Direction>) -> Vec<Point> {
    let straight = vec![from, to];
    let Some(chord) = direction(from, to) else { return straight };
    let near = |known: Option<Direction>| known.filter(|known| turn(chord, *known).abs() <= LARGEST_ANGLE);
    let (leaving, arriving) = match (near(leaving), near(arriving)) {
        (None, None) => return straight,
        // The arc that has the known direction at one end, where the other is a kink or an end.
        (Some(leaving), None) => (leaving, mirrored(leaving, chord)),
        (None, Some(arriving)) => (mirrored(arriving, chord), arriving),
        (Some(leaving), Some(arriving)) => (leaving, arriving),
    };
    let length = from.distance(to);
    let handle = HANDLE * length;
    let first = from.offset(handle * leaving.0, handle * leaving.1);
    let second = to.offset(-handle * arriving.0, -handle * arriving.1);
    let count = ((length / PIECE).ceil() as usize).clamp(1, MOST_PIECES);
    (0..=count)
        .map(|piece| match piece {
            0 => from,
            _ if piece == count => to,
            _ => {
                let t = piece as f64 / count as f64;
                let (one, two, three) = (from.lerp(first, t), first.lerp(second, t), second.lerp(to, t));
                one.lerp(two, t).lerp(two.lerp(three, t), t)
            }
        })
        .collect()
}

/// A direction on the other side of a chord.
fn mirrored(known: Direction, chord: Direction) -> Direction {
    let along = known.0 * chord.0 + known.1 * chord.1;
    (2.0 * along * chord.0 - known.0, 2.0 * along * chord.1 - known.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all(points: &[Point], is_upright: &[bool]) -> Vec<Point> {
        smoothed(points, is_upright).concat()
    }

    #[test]
    fn a_circle_through_few_points_is_round() {
        let circle: Vec<Point> = (0..13)
            .map(|index| {
                let (sine, cosine) = (f64::from(index) * std::f64::consts::TAU / 12.0).sin_cos();
                Point::new(100.0 * cosine, 100.0 * sine)
            })
            .collect();
        let center = Point::new(0.0, 0.0);
        // The ends have one neighbour each, so that less is known there.
        let inner: Vec<Point> = smoothed(&circle, &[])[1..11].concat();
        assert!(inner.len() > 300);
        for point in &inner {
            assert!((point.distance(center) - 100.0).abs() < 0.2, "{point:?}");
        }
        // The polyline is off by 3.4.
        assert!((circle[0].lerp(circle[1], 0.5).distance(center) - 100.0).abs() > 3.0);
    }

    #[test]
    fn a_branch_that_is_born_upright_is_a_parabola() {
        // x = y^2, as the amplitude of cycles by a Hopf point: y over x is a root.
        let root: Vec<Point> =
            [0.0, 1.0, 2.0, 3.5, 5.0, 7.0, 9.0].map(|y: f64| Point::new(y * y, 10.0 * y)).to_vec();
        let mut is_upright = vec![false; root.len()];
        is_upright[0] = true;
        for point in all(&root, &is_upright) {
            assert!((point.y - 10.0 * point.x.max(0.0).sqrt()).abs() < 0.6, "{point:?}");
        }
    }

    #[test]
    fn a_kink_keeps_its_corner_and_is_not_passed() {
        // Two straight lines that meet, and a step.
        for corner in [
            [(0.0, 0.0), (10.0, 10.0), (20.0, 20.0), (30.0, 10.0), (40.0, 0.0)],
            [(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (20.0, 30.0), (30.0, 30.0)],
        ] {
            let points = corner.map(Point::from);
            for (ends, piece) in points.windows(2).zip(smoothed(&points, &[])) {
                for point in piece {
                    let way = ends[0].distance(point) + point.distance(ends[1]);
                    assert!((way - ends[0].distance(ends[1])).abs() < 1e-9, "{point:?}");
                }
            }
        }
        // A curve that bends evenly up to a kink stays below it.
        let cusp: Vec<Point> = (-6..=6)
            .map(|index| Point::new(10.0 * f64::from(index), -f64::from(index).abs().powi(2)))
            .map(|point| Point::new(point.x, -(point.y + 8.0 * (point.x / 10.0).abs())))
            .collect();
        let highest = cusp.iter().map(|point| point.y).fold(f64::NEG_INFINITY, f64::max);
        let lowest = cusp.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
        for point in all(&cusp, &[]) {
            assert!(point.y <= highest + 0.3 && point.y >= lowest - 0.3, "{point:?}");
        }
    }

    #[test]
    fn gaps_and_single_points_stay_what_they_are() {
        let points = [(0.0, 0.0), (1.0, 1.0), (f64::NAN, 2.0), (3.0, 3.0)].map(Point::from);
        let pieces = smoothed(&points, &[true, false, true, false]);
        assert_eq!(pieces.len(), 3);
        assert!(pieces[1].iter().any(|point| !point.is_finite()));
        assert!(smoothed(&points[..1], &[]).is_empty());
        let same = [(1.0, 1.0), (1.0, 1.0)].map(Point::from);
        assert_eq!(smoothed(&same, &[true, true]), [same.to_vec()]);
    }

    proptest! {
        /// Near the chord: a cubic leaves it by no more than its handles do.
        #[test]
        fn nothing_swings_far(points in proptest::collection::vec((0.0..100.0_f64, 0.0..100.0_f64).prop_map(Point::from), 2..20)) {
            for (ends, piece) in points.windows(2).zip(smoothed(&points, &[])) {
                let [from, to] = [ends[0], ends[1]];
                let length = from.distance(to);
                prop_assert_eq!((piece[0], piece[piece.len() - 1]), (from, to));
                for point in piece {
                    prop_assert!(from.distance(point) + point.distance(to) <= 1.25 * length + 1e-9);
                }
            }
        }
    }
}
