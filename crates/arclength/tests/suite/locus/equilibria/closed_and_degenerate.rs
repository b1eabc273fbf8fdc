//! Curves that close, that lie on the end of a range, and whose coefficients vanish or have poles, all known in closed form.

use super::reaches_range_ends;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::equilibrium::Equilibria;
use arclength::locus::{EquilibriumLocusBranch, LocusPoint};
use arclength::{Scalar, VectorField};

field!(FlatEllipse, ["x", "y"], ["p", "q"], |x, p, d| {
    let growth = -(p[0] * p[0] + p[1] * p[1] * 1e4) + 1.0;
    let square = x[0] * x[0] + x[1] * x[1];
    let radial = growth + (p[0] - 0.3) * square - square * square;
    d[0] = radial * x[0] - x[1];
    d[1] = x[0] + radial * x[1];
});

field!(SmallCircle, ["x"], ["p", "q"], |x, p, d| {
    d[0] = x[0] * x[0] + x[0].powi(3) + p[0] * p[0] + p[1] * p[1] - 9e-4;
});

field!(LinearOscillator, ["e", "f", "g"], ["p", "q"], |x, p, d| {
    let (e, f) = (x[0] - x[2].sin(), x[1] - x[2] * x[2]);
    let growth = p[0] + p[1] * p[1] - 0.1;
    d[0] = growth * e - f * 3.7;
    d[1] = e * 3.7 + growth * f;
    d[2] = p[0] * 0.2 + 0.3 - x[2] - x[2].powi(3);
});

field!(PoleBesideZero, ["x", "y", "z"], ["p", "q"], |x, p, d| {
    let square = x[0] * x[0] + x[1] * x[1];
    let growth = p[0] + x[2] - square;
    d[0] = growth * x[0] - x[1];
    d[1] = x[0] + growth * x[1];
    d[2] = p[1] * x[2] + square * 0.001 + square * x[2] * 0.3 - x[2].powi(3);
});

field!(DoubleZero, ["x", "y"], ["p", "q"], |x, p, d| {
    d[0] = x[1];
    d[1] = p[0] * x[0] + p[1] * x[1] - x[0].powi(3) - x[0] * x[0] * x[1];
});

field!(CompetingSpecies, ["x", "y"], ["p", "q", "r"], |x, p, d| {
    d[0] = x[0] * (p[0] - p[1] - x[0] - x[1]);
    d[1] = x[1] * (p[2] - x[1] - x[0]) + x[0] * p[1];
});

fn kinds(curve: &EquilibriumLocusBranch) -> Vec<SpecialKind> {
    curve.points.iter().filter_map(|point| point.label).map(|label| label.kind).collect()
}

fn labelled(curve: &EquilibriumLocusBranch, kind: SpecialKind) -> Vec<&LocusPoint> {
    curve.points.iter().filter(|point| point.label.is_some_and(|label| label.kind == kind)).collect()
}

#[test]
fn a_flat_closed_curve_is_followed_once() {
    let branch = Equilibria::of(&FlatEllipse).parameters(&[-1.5, 0.0]).along("p", -2.0..=2.0).run().unwrap();
    let hopf = branch.hopf_points().next().unwrap();
    let curve = hopf.curve(&FlatEllipse).along("p", -2.0..=2.0).and("q", -2.0..=2.0).run().unwrap();
    assert!(curve.stops.iter().flatten().any(|stop| matches!(stop, Stop::Closed)), "{:?}", curve.stops);
    let points = labelled(&curve, SpecialKind::GeneralizedHopf);
    assert_eq!(points.len(), 2, "{:?}", kinds(&curve));
    for point in points {
        let [p, q] = point.values;
        assert!((p - 0.3).abs() < 1e-9 && (q.abs() - (0.91_f64).sqrt() * 1e-2).abs() < 1e-9);
    }
}

#[test]
fn a_closed_branch_that_is_small_beside_the_range_is_followed_once() {
    let start = Equilibria::of(&SmallCircle).start(&[0.03]).parameters(&[0.0, 0.0]);
    let branch = start.along("p", -2.0..=2.0).run().unwrap();
    let folds: Vec<f64> = branch.folds().map(|fold| fold.value).collect();
    assert_eq!(folds.len(), 2, "{folds:?}");
    assert!(folds.iter().all(|value| (value.abs() - 0.03).abs() < 1e-12), "{folds:?}");
    assert_eq!(branch.branch_points().count(), 0);
}

#[test]
fn a_coefficient_that_vanishes_everywhere_has_no_zeros() {
    let start = Equilibria::of(&LinearOscillator).start(&[0.1, 0.0, 0.2]).parameters(&[-0.5, 0.45]);
    let branch = start.along("p", -0.5..=1.0).run().unwrap();
    let hopf = branch.hopf_points().next().unwrap();
    let curve = hopf.curve(&LinearOscillator).along("p", -1.0..=1.0).and("q", -1.0..=1.0).run().unwrap();
    assert!(labelled(&curve, SpecialKind::GeneralizedHopf).is_empty(), "{:?}", kinds(&curve));
    assert!(curve.unlocated.is_empty(), "{:?}", curve.unlocated);
}

#[test]
fn a_generalised_hopf_point_beside_a_zero_hopf_point_is_found() {
    let branch =
        Equilibria::of(&PoleBesideZero).parameters(&[-1.0, 0.5]).along("p", -1.0..=1.0).run().unwrap();
    let hopf = branch.hopf_points().next().unwrap();
    for ends in [1.0, 0.51, 0.1] {
        let range = -ends..=0.5;
        let curve = hopf.curve(&PoleBesideZero).along("p", -1.0..=1.0).and("q", range).run().unwrap();
        // l1 = -2 (1 + 0.001/q).
        let [generalised] = labelled(&curve, SpecialKind::GeneralizedHopf)[..] else {
            panic!("{:?}", kinds(&curve))
        };
        assert!((generalised.values[1] + 1e-3).abs() < 1e-9, "{:?}", generalised.values);
        let [zero_hopf] = labelled(&curve, SpecialKind::ZeroHopf)[..] else { panic!("{:?}", kinds(&curve)) };
        assert!(zero_hopf.values[1].abs() < 1e-9);
    }
}

#[test]
fn a_curve_may_lie_on_the_end_of_a_range() {
    let branch = Equilibria::of(&DoubleZero).parameters(&[-1.5, 0.3]).along("p", -2.0..=2.0).run().unwrap();
    let point = branch.branch_points().next().unwrap();
    for (first, start) in [(0.0..=2.0, point), (-2.0..=0.0, point), (-2.0..=2.0, point)] {
        let curve = start.curve(&DoubleZero).along("p", first).and("q", -1.0..=1.0).run().unwrap();
        reaches_range_ends(&curve);
        assert!(curve.points.iter().all(|point| point.values[0].abs() < 1e-12));
        // The only other eigenvalue is q.
        let [double] = labelled(&curve, SpecialKind::BogdanovTakens)[..] else {
            panic!("{:?}", kinds(&curve))
        };
        assert!(double.values[1].abs() < 1e-9, "{:?}", double.values);
    }
}

#[test]
fn the_order_of_two_parameters_does_not_matter_where_branches_cross_along_a_third() {
    let branch = Equilibria::of(&CompetingSpecies)
        .parameters(&[-1.5, -0.5, 0.3])
        .along("p", -2.0..=2.0)
        .run()
        .unwrap();
    let point = branch.branch_points().next().unwrap();
    for order in [[1, 0], [0, 1]] {
        let named = [("q", -1.0..=1.0), ("r", -2.0..=2.0)];
        let [first, second] = order.map(|index| named[index].clone());
        let curve = point.curve(&CompetingSpecies).along(first.0, first.1).and(second.0, second.1);
        let curve = curve.run().unwrap();
        reaches_range_ends(&curve);
        let q = order.iter().position(|&index| index == 0).unwrap();
        assert!(curve.points.iter().all(|point| (point.values[q] + 0.5).abs() < 1e-9));
    }
}
