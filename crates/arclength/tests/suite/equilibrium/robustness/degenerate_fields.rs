//! Fields with points that are not generic, and closed branches.

use super::kinds;
use approx::assert_relative_eq;
use arclength::branch::{SpecialKind, Stability};
use arclength::continuation::Stop;
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};

field!(ZeroHopf, ["x", "y", "z"], ["p"], |x, p, d| {
    let growth = p[0] + x[2] * 0.5;
    d[0] = growth * x[0] - x[1];
    d[1] = x[0] + growth * x[1];
    d[2] = p[0] - x[2] * x[2] - x[0] * x[0] - x[1] * x[1];
});

field!(Pendulum, ["angle", "rate"], ["p"], |x, p, d| {
    d[0] = x[1];
    d[1] = p[0] - x[0].sin();
});

field!(Circle, ["x"], ["p"], |x, p, d| {
    d[0] = p[0] * p[0] + x[0] * x[0] - 1.0;
});

// Two patches that nothing connects.
field!(Patches, ["x", "y"], ["harvest"], |x, p, d| {
    d[0] = x[0] * (-x[0] + 1.0) - p[0];
    d[1] = x[1] * (-x[1] + 1.0) - p[0];
});

// Rabinovich and Fabrikant (1979): at p = 0 every (1, y, 0) is an equilibrium, with the eigenvalues 2y, 0 and -2(1.1 + y).
field!(Line, ["x", "y", "z"], ["p"], |x, p, d| {
    d[0] = x[1] * (x[2] - 1.0 + x[0] * x[0]) + p[0] * x[0];
    d[1] = x[0] * (x[2] * 3.0 + 1.0 - x[0] * x[0]) + p[0] * x[1];
    d[2] = x[2] * (x[0] * x[1] + 1.1) * (-2.0);
});

field!(Pitchfork, ["x", "y"], ["p"], |x, p, d| {
    d[0] = p[0] * x[0] - x[0].powi(3) + x[1] * x[0];
    d[1] = -x[1];
});

#[test]
fn a_zero_hopf_point_on_the_way_is_survived() {
    let branch = Equilibria::of(&ZeroHopf).start(&[0.0, 0.0, 1.0]).parameters(&[1.0]).along("p", -1.0..=1.0);
    let branch = branch.run().unwrap();
    assert!(branch.folds().any(|fold| fold.value.abs() < 1e-10) || branch.special_points().count() > 0);
    assert!(branch.points.iter().all(|point| point.state.iter().all(|entry| entry.is_finite())));
}

#[test]
fn centres_are_neither_stable_nor_hopf_points() {
    let branch = Equilibria::of(&Pendulum).parameters(&[0.0]).along("p", -2.0..=2.0).run().unwrap();
    assert!(branch.hopf_points().next().is_none());
    for point in branch.points.iter().filter(|point| point.state[0].cos() > 0.1) {
        assert_eq!(point.stability, Stability::Undecided);
    }
    let folds: Vec<_> = branch.folds().collect();
    assert!(folds.iter().all(|fold| (fold.value.abs() - 1.0).abs() < 1e-12));
    assert!(folds.len() > 1);
}

/// Wherever on the circle it starts: on a fold, next to it before or behind it, or far from it.
#[test]
fn a_closed_branch_ends_after_one_lap() {
    for angle in [0.0, 1e-6, -1e-6, 1e-3, -1e-3, 0.04, -0.04, 1.0, 2.0, 3.0, 3.1, -3.1, std::f64::consts::PI]
    {
        let (state, parameter) = (f64::sin(angle), f64::cos(angle));
        let branch = Equilibria::of(&Circle)
            .start(&[state])
            .parameters(&[parameter])
            .along("p", -2.0..=2.0)
            .run()
            .unwrap();
        assert!(
            matches!(branch.stops[1], Some(Stop::Closed)) && matches!(branch.stops[0], Some(Stop::Closed))
        );
        let folds: Vec<f64> = branch.folds().map(|fold| fold.value).collect();
        assert_eq!(folds.len(), 2, "{angle}: {folds:?}");
        assert_relative_eq!(folds[0] * folds[1], -1.0, epsilon = 1e-12);
        assert_eq!(kinds(&branch).len(), 2);
        let length: f64 = branch
            .points
            .windows(2)
            .map(|pair| (pair[1].value - pair[0].value).hypot(pair[1].state[0] - pair[0].state[0]))
            .sum();
        assert!((length - std::f64::consts::TAU).abs() < 0.02, "{angle}: {length}");
    }
}

#[test]
fn two_folds_at_once_are_one_degenerate_point_on_the_way() {
    let branch = Equilibria::of(&Patches).start(&[0.8, 0.8]).parameters(&[0.1]).along("harvest", 0.0..=0.4);
    let branch = branch.run().unwrap();
    assert!(branch.unlocated.is_empty());
    assert_eq!(kinds(&branch), ["BP1"]);
    let special = branch.special_points().next().unwrap();
    assert!((special.value() - 0.25).abs() <= special.location_error().max(1e-12), "{special:?}");
    // Both ways along the diagonal: from (1, 1) to the origin.
    let last = branch.points.last().unwrap();
    assert!(last.value == 0.0 && last.state.iter().all(|entry| entry.abs() < 1e-10), "{last:?}");
    for point in branch.points.iter().filter(|point| (point.state[0] - 0.5).abs() > 1e-3) {
        let expected = if point.state[0] > 0.5 { Some(true) } else { Some(false) };
        assert_eq!(point.stability.is_stable(), expected, "{point:?}");
    }
}

#[test]
fn a_line_of_equilibria_has_no_branch_points_of_rounding() {
    let branch = Equilibria::of(&Line).start(&[1.0, -1.0, -0.1]).parameters(&[0.2]).along("p", -0.2..=1.0);
    let branch = branch.run().unwrap();
    let crossing = branch.branch_points().find(|point| point.value.abs() < 1e-9).unwrap();
    assert!((crossing.state[1] + 1.1).abs() < 1e-9);
    let line = crossing.other(&Line).along("p", -0.2..=1.0).run().unwrap();
    assert!(line.special_points().all(|special| special.kind() == SpecialKind::BranchPoint));
    assert!(line.special_points().count() == 1, "{:?}", kinds(&line));
    for point in &line.points {
        assert!(point.value.abs() < 1e-12);
        // Zero is an eigenvalue everywhere, and one of the others is positive but between -1.1 and 0.
        assert_ne!(point.stability.is_stable(), Some(true), "{point:?}");
        if point.state[1] > 1e-3 || point.state[1] < -1.101 {
            assert_eq!(point.stability.is_stable(), Some(false), "{point:?}");
        }
    }
}

#[test]
fn both_branches_of_a_pitchfork_are_found_from_either() {
    let branch = Equilibria::of(&Pitchfork).parameters(&[-1.0]).along("p", -1.0..=0.9).run().unwrap();
    assert_eq!(kinds(&branch), ["BP1"]);
    let side = Equilibria::of(&Pitchfork)
        .start(&[1.0, 0.0])
        .parameters(&[1.0])
        .along("p", -1.0..=2.0)
        .run()
        .unwrap();
    assert_eq!(kinds(&side), ["BP1"], "the turning branch has no fold at the pitchfork");
    let point = side.branch_points().next().unwrap();
    assert!(point.value.abs() < 1e-14);
    let back = Equilibria::of(&Pitchfork).from_branch_point(point).along("p", -1.0..=2.0).run().unwrap();
    assert!(back.points.iter().all(|point| point.state[0] == 0.0));
    assert_eq!((back.points[0].value, back.points[back.points.len() - 1].value), (-1.0, 2.0));
}

// A Hopf point at p = 0 beside a state that grows.
field!(HopfBesideGrowth, ["x", "y", "z"], ["p"], |x, p, d| {
    let square = x[0] * x[0] + x[1] * x[1];
    d[0] = p[0] * x[0] - x[1] - x[0] * square;
    d[1] = x[0] + p[0] * x[1] - x[1] * square;
    d[2] = x[2] * 3.0;
});

#[test]
fn what_grows_beside_a_critical_pair_is_unstable() {
    let branch = Equilibria::of(&HopfBesideGrowth)
        .start(&[0.0; 3])
        .parameters(&[-1.0])
        .along("p", -1.0..=1.0)
        .run()
        .unwrap();
    let hopf = branch.points.iter().find(|point| point.label.is_some()).unwrap();
    assert!(hopf.value.abs() < 1e-12);
    assert_eq!(hopf.stability, Stability::Unstable { dimension: None });
}
