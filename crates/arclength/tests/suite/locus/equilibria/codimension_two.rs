//! Normal forms of points of codimension two, and what is reported at such points.

use super::{Cusp, coefficient, equilibria_of_the_cusp, labels, only, reaches_range_ends};
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::equilibrium::Equilibria;
use arclength::locus::EquilibriumLocus;
use arclength::{Scalar, VectorField};

#[test]
fn folds_of_the_cusp() {
    let branch = equilibria_of_the_cusp();
    let fold = branch.folds().next().unwrap();
    let locus = EquilibriumLocus::of(&Cusp)
        .from_fold(fold)
        .along("beta1", -2.0..=2.0)
        .and("beta2", -1.0..=2.0)
        .run()
        .unwrap();
    assert_eq!(labels(&locus), ["CP1"]);
    reaches_range_ends(&locus);
    for point in &locus.points {
        let [beta1, beta2] = point.values;
        assert!((27.0 * beta1 * beta1 - 4.0 * beta2.powi(3)).abs() < 1e-9, "{beta1} {beta2}");
    }
    let cusp = only(&locus, SpecialKind::Cusp);
    assert!(cusp.regular && cusp.values.iter().all(|value| value.abs() < 1e-14));
    assert_relative_eq!(coefficient(cusp, "c"), -1.0, max_relative = 1e-12);
}

field!(BogdanovTakens, ["x", "y"], ["beta1", "beta2"], |x, p, d| {
    d[0] = x[1];
    d[1] = p[0] + p[1] * x[0] + x[0] * x[0] - x[0] * x[1];
});

#[test]
fn folds_and_hopf_points_meet_at_bogdanov_takens() {
    let branch = Equilibria::of(&BogdanovTakens)
        .start(&[-0.5, 0.0])
        .parameters(&[-0.5, -1.0])
        .along("beta1", -1.0..=1.0);
    let branch = branch.run().unwrap();
    let folds = EquilibriumLocus::of(&BogdanovTakens).from_fold(branch.folds().next().unwrap());
    let folds = folds.along("beta1", -1.0..=1.0).and("beta2", -2.0..=2.0).run().unwrap();
    let hopf = EquilibriumLocus::of(&BogdanovTakens).from_hopf(branch.hopf_points().next().unwrap());
    let hopf = hopf.along("beta1", -1.0..=1.0).and("beta2", -2.0..=2.0).run().unwrap();
    for locus in [&folds, &hopf] {
        assert_eq!(labels(locus), ["BT1"]);
        reaches_range_ends(locus);
        let point = only(locus, SpecialKind::BogdanovTakens);
        assert!(point.regular && point.values.iter().all(|value| value.abs() < 1e-14), "{point:?}");
        assert_relative_eq!(coefficient(point, "a"), 1.0, max_relative = 1e-12);
        assert_relative_eq!(coefficient(point, "b"), -1.0, max_relative = 1e-12);
    }
    for point in &folds.points {
        assert!((4.0 * point.values[0] - point.values[1].powi(2)).abs() < 1e-9);
    }
    for point in hopf.points.iter().filter(|point| point.label.is_none()) {
        let beta2 = point.values[1];
        assert!(point.values[0].abs() < 1e-9);
        assert_eq!(point.frequency.is_some(), beta2 < 0.0, "at {beta2}");
        if let Some(frequency) = point.frequency {
            assert_relative_eq!(frequency, (-beta2).sqrt(), max_relative = 1e-8);
        }
    }
}

field!(Bautin, ["x", "y"], ["beta1", "beta2"], |x, p, d| {
    let rho = x[0] * x[0] + x[1] * x[1];
    let growth = p[0] + p[1] * rho - rho * rho;
    d[0] = growth * x[0] - x[1];
    d[1] = x[0] + growth * x[1];
});

/// Bautin's normal form seen through the nonlinear coordinates `u = x + x^2/3 + y z/5`, `v = y + x y/2 - x^3/4`, with a third
/// state `z` that is slaved to them: nothing vanishes in the multilinear forms.
struct CurvedBautin;

impl VectorField for CurvedBautin {
    fn state_names(&self) -> Vec<String> {
        ["u", "v", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["beta1", "beta2"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        // Here (x, y) are the coordinates of the computation and (u, v) those of the normal form.
        let [x, y, z] = [x[0], x[1], x[2]];
        let u = x + x * x / 3.0 + y * y / 5.0;
        let v = y + x * y / 2.0 - x.powi(3) / 4.0;
        let rho = u * u + v * v;
        let growth = p[0] + p[1] * rho - rho * rho;
        let (du, dv) = (growth * u - v, u + growth * v);
        // (du, dv) = M (x', y').
        let (a, b) = (x * (2.0 / 3.0) + 1.0, y * 0.4);
        let (c, e) = (y * 0.5 - x * x * 0.75, x * 0.5 + 1.0);
        let determinant = a * e - b * c;
        let (dx, dy) = ((e * du - b * dv) / determinant, (a * dv - c * du) / determinant);
        // Off the manifold w = 0 the motion is perturbed, on it not; w decays.
        let height = x * x * 0.7 - x * y * 0.3;
        let w = z - height;
        let slope = (x * 1.4 - y * 0.3) * dx - x * 0.3 * dy;
        d[0] = dx + w * (x * 0.5 + w * 0.2 + 0.3);
        d[1] = dy - w * (y * 0.25 + 0.1);
        d[2] = slope - w * 2.0 + w * w * 0.3;
    }
}

#[test]
fn generalized_hopf_points_have_the_second_lyapunov_coefficient_of_the_normal_form() {
    fn check<F: VectorField>(field: &F, tolerance: f64) {
        let branch = Equilibria::of(field).parameters(&[-0.5, 1.0]).along("beta1", -1.0..=1.0).run().unwrap();
        let hopf = branch.hopf_points().next().unwrap();
        let locus = EquilibriumLocus::of(field).from_hopf(hopf);
        let locus = locus.along("beta1", -1.0..=1.0).and("beta2", -1.0..=2.0).run().unwrap();
        assert_eq!(labels(&locus), ["GH1"]);
        reaches_range_ends(&locus);
        let point = only(&locus, SpecialKind::GeneralizedHopf);
        assert!(point.values.iter().all(|value| value.abs() < 1e-10), "{point:?}");
        // rho = 2 |z|^2 with <q, q> = 1 for q = (1, -i)/sqrt(2).
        assert_relative_eq!(coefficient(point, "second_lyapunov"), -4.0, max_relative = tolerance);
        for point in locus.points.iter().filter(|point| point.label.is_none()) {
            assert_relative_eq!(point.first_lyapunov.unwrap(), 2.0 * point.values[1], max_relative = 1e-8);
        }
    }
    check(&Bautin, 1e-12);
    check(&CurvedBautin, 1e-8);
}

field!(ZeroHopf, ["x", "y", "z"], ["p", "q"], |x, p, d| {
    let growth = p[1] + x[2] * 0.5;
    d[0] = growth * x[0] - x[1] * 2.0;
    d[1] = x[0] * 2.0 + growth * x[1];
    d[2] = p[0] - x[2] * x[2] - (x[0] * x[0] + x[1] * x[1]);
});

#[test]
fn zero_hopf_points_are_found_on_folds_and_on_hopf_points() {
    let branch =
        Equilibria::of(&ZeroHopf).start(&[0.0, 0.0, 1.0]).parameters(&[1.0, -0.3]).along("p", -0.5..=1.5);
    let branch = branch.run().unwrap();
    let folds = EquilibriumLocus::of(&ZeroHopf).from_fold(branch.folds().next().unwrap());
    let folds = folds.along("p", -1.0..=1.0).and("q", -1.0..=1.0).run().unwrap();
    let hopf = EquilibriumLocus::of(&ZeroHopf).from_hopf(branch.hopf_points().next().unwrap());
    let hopf = hopf.along("p", -1.0..=1.5).and("q", -0.4..=0.4).run().unwrap();
    for locus in [&folds, &hopf] {
        assert_eq!(labels(locus), ["ZH1"]);
        reaches_range_ends(locus);
        let point = only(locus, SpecialKind::ZeroHopf);
        assert!(point.regular && point.values.iter().all(|value| value.abs() < 1e-12), "{point:?}");
    }
    for point in &hopf.points {
        assert!((point.values[0] - 4.0 * point.values[1].powi(2)).abs() < 1e-9);
        assert_relative_eq!(point.frequency.unwrap(), 2.0, max_relative = 1e-9);
    }
}

field!(HopfHopf, ["x", "y", "u", "v"], ["p", "q"], |x, p, d| {
    let (first, second) = (x[0] * x[0] + x[1] * x[1], x[2] * x[2] + x[3] * x[3]);
    let (one, other) = (p[0] - first - second * 2.0, p[1] + p[0] * 0.5 - second - first * 3.0);
    d[0] = one * x[0] - x[1];
    d[1] = x[0] + one * x[1];
    d[2] = other * x[2] - x[3] * 3.0 + x[0] * x[1];
    d[3] = x[2] * 3.0 + other * x[3];
});

#[test]
fn hopf_hopf_points_are_found_from_either_curve() {
    let branch = Equilibria::of(&HopfHopf).parameters(&[-1.0, 0.2]).along("p", -1.0..=1.0).run().unwrap();
    let points: Vec<_> = branch.hopf_points().collect();
    assert_eq!(points.len(), 2);
    for hopf in points {
        let locus = EquilibriumLocus::of(&HopfHopf).from_hopf(hopf);
        let locus = locus.along("p", -1.0..=1.0).and("q", -0.4..=0.4).run().unwrap();
        assert_eq!(labels(&locus), ["HH1"]);
        reaches_range_ends(&locus);
        let point = only(&locus, SpecialKind::HopfHopf);
        assert!(point.regular && point.values.iter().all(|value| value.abs() < 1e-12), "{point:?}");
    }
}

field!(ShiftedFrequencies, ["x", "y", "u", "v", "z"], ["p", "q"], |x, p, d| {
    let growths = [p[0] + p[1] * p[1] * 0.3, p[1] + p[0] * 0.5];
    let frequencies = [p[0] * 0.4 + p[1] * 0.7 + 1.0, p[0] * 0.9 - p[1] * 0.2 + 3.0];
    d[0] = growths[0] * x[0] - frequencies[0] * x[1];
    d[1] = frequencies[0] * x[0] + growths[0] * x[1];
    d[2] = growths[1] * x[2] - frequencies[1] * x[3];
    d[3] = frequencies[1] * x[2] + growths[1] * x[3];
    d[4] = (p[1] - 0.15) * (p[0] * 0.1 + 1.0) * x[4];
});

#[test]
fn what_is_reported_at_a_point_of_codimension_two_is_its_own() {
    let branch =
        Equilibria::of(&ShiftedFrequencies).parameters(&[-1.0, 0.3]).along("p", -1.0..=1.0).run().unwrap();
    let mut seen = 0;
    for hopf in branch.hopf_points() {
        let locus = EquilibriumLocus::of(&ShiftedFrequencies).from_hopf(hopf);
        let locus = locus.along("p", -1.0..=1.0).and("q", -0.4..=0.4).run().unwrap();
        for point in locus.points.iter().filter(|point| point.special.is_some()) {
            let [p, q] = point.values;
            let kind = point.special.as_ref().map(|special| special.kind);
            let own = |exact: f64| (point.frequency.unwrap() - exact).abs() < 1e-11;
            let [one, other] = [p * 0.4 + q * 0.7 + 1.0, p * 0.9 - q * 0.2 + 3.0];
            assert!(own(one) || own(other), "{:?} {one} {other}", point.frequency);
            // The zero-Hopf point is a branch point too, so that the curve has no regular solution there.
            if kind == Some(SpecialKind::HopfHopf) {
                let own = point.tests.iter().find(|(test, _)| test == "HH");
                assert!(own.is_some_and(|(_, value)| value.abs() < 1e-11), "{:?}", point.tests);
            }
            seen += 1;
        }
    }
    assert!(seen >= 3, "{seen}");
}

// A Bogdanov-Takens point with a Hopf curve beyond which comes back past it so closely that signs next to it are rounding.
field!(CloseToBogdanovTakens, ["x", "y"], ["p", "q"], |x, p, d| {
    let m = p[0] * 1.7 - p[1] * 0.5;
    let n = p[0] * -0.6 - p[1];
    d[0] = x[1];
    d[1] = m + n * x[0] + x[0] * x[0] * 0.1 - x[0] * x[0] * x[0] * 0.5 + x[1] * (x[0] * 0.7 + 0.1);
});

#[test]
fn a_bogdanov_takens_point_is_told_once() {
    let branch = Equilibria::of(&CloseToBogdanovTakens)
        .start(&[0.0, 0.0])
        .parameters(&[-1.0, 0.9])
        .along("p", -1.0..=1.0)
        .run()
        .unwrap();
    let locus = EquilibriumLocus::of(&CloseToBogdanovTakens)
        .from_hopf(branch.hopf_points().next().unwrap())
        .along("p", -2.0..=2.0)
        .and("q", -2.0..=2.0)
        .run()
        .unwrap();
    let found: Vec<_> = locus
        .special_points()
        .filter(|point| point.kind == SpecialKind::BogdanovTakens)
        .map(|point| point.values)
        .collect();
    let [[p, q]] = found[..] else { panic!("{found:?}") };
    // y = 0, the trace 0.1 + 0.7 x = 0 and the determinant -(n + 0.2 x - 1.5 x^2) = 0.
    let x = -1.0 / 7.0;
    let n = -0.2 * x + 1.5 * x * x;
    let m = -(n * x + 0.1 * x * x - 0.5 * x * x * x);
    assert_relative_eq!(1.7 * p - 0.5 * q, m, epsilon = 1e-9);
    assert_relative_eq!(-0.6 * p - q, n, epsilon = 1e-9);
}
