//! Curves of branch points, which persist by symmetry only.

use super::reaches_range_ends;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::equilibrium::Equilibria;
use arclength::locus::EquilibriumLocus;
use arclength::{Scalar, VectorField};

field!(Lorenz, ["x", "y", "z"], ["rho", "sigma", "beta"], |x, p, d| {
    d[0] = p[1] * (x[1] - x[0]);
    d[1] = p[0] * x[0] - x[1] - x[0] * x[2];
    d[2] = x[0] * x[1] - p[2] * x[2];
});

field!(Imperfect, ["x"], ["p", "q"], |x, p, d| {
    d[0] = p[0] * x[0] - x[0].powi(3) + p[1];
});

#[test]
fn branch_points_persist_by_symmetry_only() {
    let branch =
        Equilibria::of(&Lorenz).parameters(&[0.0, 10.0, 8.0 / 3.0]).along("rho", 0.0..=2.0).run().unwrap();
    let pitchfork = branch.branch_points().next().unwrap();
    for (first, second) in [("rho", "sigma"), ("sigma", "rho")] {
        let range = |name: &str| if name == "rho" { 0.0..=2.0 } else { 1.0..=20.0 };
        let locus = EquilibriumLocus::of(&Lorenz).from_branch_point(pitchfork);
        let locus = locus.along(first, range(first)).and(second, range(second)).run().unwrap();
        reaches_range_ends(&locus);
        let rho = usize::from(first != "rho");
        assert!(locus.points.iter().all(|point| (point.values[rho] - 1.0).abs() < 1e-10));
        let sigma: Vec<f64> = locus.points.iter().map(|point| point.values[1 - rho]).collect();
        assert!(sigma.contains(&1.0) && sigma.contains(&20.0));
    }
    let branch = Equilibria::of(&Imperfect).parameters(&[-1.0, 0.0]).along("p", -1.0..=1.0).run().unwrap();
    let locus = EquilibriumLocus::of(&Imperfect).from_branch_point(branch.branch_points().next().unwrap());
    let locus = locus.along("p", -1.0..=1.0).and("q", -1.0..=1.0).run().unwrap();
    assert!(matches!(locus.stops[1], Some(Stop::Failed(_))), "{:?}", locus.stops);
    assert!(locus.stops[1].as_ref().is_some_and(|stop| stop.to_string().contains("breaks up")));
}

/// A pitchfork of `z` at `a = 0` beside an oscillator damped at the rate `b` and a state that decays at the rate `1 - 2 b`.
struct PitchforkBeside;

impl VectorField for PitchforkBeside {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z", "w"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["a".into(), "b".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        d[0] = -p[1] * s[0] - s[1] * 2.0 + s[2] * s[2];
        d[1] = s[0] * 2.0 - p[1] * s[1];
        d[2] = p[0] * s[2] - s[2] * s[2] * s[2];
        d[3] = (p[1] * 2.0 - 1.0) * s[3] + s[2] * s[2];
    }
}

#[test]
fn curves_of_branch_points_have_their_points_of_codimension_two() {
    let branch =
        Equilibria::of(&PitchforkBeside).parameters(&[-1.0, -0.4]).along("a", -1.0..=1.0).run().unwrap();
    let point = branch.branch_points().next().unwrap();
    let curve = EquilibriumLocus::of(&PitchforkBeside)
        .from_branch_point(point)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=1.0)
        .run()
        .unwrap();
    let found: Vec<_> = curve.special_points().map(|point| (point.kind, point.values)).collect();
    for (kind, b) in [(SpecialKind::ZeroHopf, 0.0), (SpecialKind::BogdanovTakens, 0.5)] {
        let near = found
            .iter()
            .any(|(other, values)| *other == kind && values[0].abs() < 1e-8 && (values[1] - b).abs() < 1e-8);
        assert!(near, "{kind:?} among {found:?}");
    }
}

/// `x' = x (1 - p - q^2 - x)`: branch points on a parabola, all at `x = 0`.
struct Parabola;

impl VectorField for Parabola {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into(), "q".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        d[0] = s[0] * (-p[0] - p[1] * p[1] - s[0] + 1.0);
    }
}

#[test]
fn a_curve_on_which_only_one_parameter_comes_back_is_not_closed() {
    let branch = Equilibria::of(&Parabola)
        .start(&[0.0])
        .parameters(&[0.5, -1.5])
        .along("q", -1.5..=1.5)
        .run()
        .unwrap();
    for point in branch.branch_points() {
        let curve = EquilibriumLocus::of(&Parabola)
            .from_branch_point(point)
            .along("p", -2.0..=2.0)
            .and("q", -2.0..=2.0)
            .run()
            .unwrap();
        for stop in &curve.stops {
            assert!(matches!(stop, Some(Stop::RangeEnd { bound: 0, value: -2.0 })), "{:?}", curve.stops);
        }
        let end = curve.points.last().unwrap();
        assert!((end.values[1].abs() - 3.0_f64.sqrt()).abs() < 1e-9, "{:?}", end.values);
    }
}
