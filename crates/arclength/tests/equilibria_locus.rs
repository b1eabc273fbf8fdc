//! Curves of special equilibria in two parameters against closed forms and published values.

use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::equilibrium::{Equilibria, EquilibriumBranch};
use arclength::locus::{CodimensionTwoPoint, EquilibriumLocus, EquilibriumLocusBranch};
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

#[macro_use]
#[path = "common/field.rs"]
mod field;

fn labels(branch: &EquilibriumLocusBranch) -> Vec<String> {
    branch.points.iter().filter_map(|point| Some(point.label?.to_string())).collect()
}

fn coefficient(point: &CodimensionTwoPoint, name: &str) -> f64 {
    point.coefficients.iter().find(|(candidate, _)| candidate == name).expect("the coefficient").1
}

fn only(branch: &EquilibriumLocusBranch, kind: SpecialKind) -> &CodimensionTwoPoint {
    let found: Vec<_> = branch.special_points().filter(|point| point.kind == kind).collect();
    assert_eq!(found.len(), 1, "{:?}", labels(branch));
    found[0]
}

fn reaches_range_ends(branch: &EquilibriumLocusBranch) {
    for stop in branch.stops.iter().flatten() {
        assert!(matches!(stop, Stop::RangeEnd { .. }), "{stop}");
    }
}

field!(Cusp, ["x"], ["beta1", "beta2"], |x, p, d| {
    d[0] = p[0] + p[1] * x[0] - x[0].powi(3);
});

#[test]
fn folds_of_the_cusp() {
    let branch = Equilibria::of(&Cusp)
        .start(&[-2.0])
        .parameters(&[-2.0, 1.0])
        .along("beta1", -2.0..=2.0)
        .run()
        .unwrap();
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

/// The chemical reaction of AUTO's demo `ab` in other units.
struct Reaction([f64; 4]);

impl VectorField for Reaction {
    fn state_names(&self) -> Vec<String> {
        vec!["u1".into(), "u2".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["D".into(), "B".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let [a, b, c, e] = self.0;
        let (u1, u2) = (x[0] / a, x[1] / b);
        let rate = p[0] / c * (-u1 + 1.0) * u2.exp();
        d[0] = (rate - u1) * a;
        d[1] = (rate * (p[1] / e) - u2 * 4.0) * b;
    }
}

fn reaction_curves(units: [f64; 4]) -> (EquilibriumLocusBranch, EquilibriumLocusBranch) {
    let field = Reaction(units);
    let [_, _, d, b] = units;
    let branch: EquilibriumBranch =
        Equilibria::of(&field).parameters(&[0.0, 18.0 * b]).along("D", 0.0..=0.4 * d).run().unwrap();
    let folds = EquilibriumLocus::of(&field).from_fold(branch.folds().next().unwrap());
    let folds = folds.along("D", 0.0..=0.4 * d).and("B", 10.0 * b..=30.0 * b).run().unwrap();
    let hopf = EquilibriumLocus::of(&field).from_hopf(branch.hopf_points().next().unwrap());
    let hopf = hopf.along("D", 0.0..=0.4 * d).and("B", 10.0 * b..=30.0 * b).run().unwrap();
    (folds, hopf)
}

#[test]
fn the_reaction_has_its_cusp_and_bogdanov_takens_points() {
    let (folds, hopf) = reaction_curves([1.0; 4]);
    reaches_range_ends(&folds);
    // On the folds B = 4 u^2/(u - 1), D = (u - 1) exp(-u) with u = u2: a cusp at u = 2; the trace vanishes at u = 4/3.
    for point in &folds.points {
        let u = point.state[1];
        assert_relative_eq!(point.values[1], 4.0 * u * u / (u - 1.0), max_relative = 1e-9);
        assert_relative_eq!(point.values[0], (u - 1.0) * (-u).exp(), max_relative = 1e-9);
    }
    let cusp = only(&folds, SpecialKind::Cusp);
    assert_relative_eq!(cusp.values[0], (-2.0_f64).exp(), max_relative = 1e-12);
    assert_relative_eq!(cusp.values[1], 16.0, max_relative = 1e-12);
    for locus in [&folds, &hopf] {
        let point = only(locus, SpecialKind::BogdanovTakens);
        assert_relative_eq!(point.values[0], (-4.0_f64 / 3.0).exp() / 3.0, max_relative = 1e-12);
        assert_relative_eq!(point.values[1], 64.0 / 3.0, max_relative = 1e-12);
    }
    assert_eq!(labels(&folds), ["BT1", "CP1"]);
    assert_eq!(labels(&hopf), ["BT1", "GH1"]);
    // Hopf points: 4 u - 5 - u1/(1 - u1) = 0 with u1 = 4 u/B.
    for point in &hopf.points {
        let (u, b) = (point.state[1], point.values[1]);
        assert!((4.0 * u - 5.0 - 4.0 * u / (b - 4.0 * u)).abs() < 1e-7, "{u} {b}");
    }
}

#[test]
fn units_do_not_change_the_curves() {
    let (folds, hopf) = reaction_curves([1.0; 4]);
    for units in [[1e6, 1e-4, 1e-7, 1e3], [1e-9, 1e5, 1e8, 1e-2]] {
        let (scaled_folds, scaled_hopf) = reaction_curves(units);
        for (one, other) in [(&folds, &scaled_folds), (&hopf, &scaled_hopf)] {
            assert_eq!(labels(one), labels(other));
            assert!(one.points.len().abs_diff(other.points.len()) < 4);
            for (point, scaled) in one.special_points().zip(other.special_points()) {
                for index in 0..2 {
                    let value = scaled.values[index] / units[2 + index];
                    assert_relative_eq!(point.values[index], value, max_relative = 1e-9);
                }
            }
        }
    }
}

/// The towed wheel as a Chaplygin sleigh on springs.
struct Wheel;

impl VectorField for Wheel {
    fn state_names(&self) -> Vec<String> {
        ["u", "q", "psi", "V", "Omega"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["v", "l", "r"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let (v, l, omega) = (p[0], p[1], p[0] / p[2]);
        let [u, q, psi, speed, rate] = [x[0], x[1], x[2], x[3], x[4]];
        let arm = l - 0.012;
        let mass = 0.3519 + 0.0668 + 4.63e-5 / (0.04 * 0.04);
        let inertia = arm * arm * 0.0668 + (3.48e-6 + 2.38e-5);
        let moment = arm * 0.0668;
        let (sine, cosine) = psi.sin_cos();
        let forward = (u * cosine - q * sine) * -100.0;
        let sideways = (u * sine + q * cosine) * -100.0;
        d[0] = speed * cosine + l * rate * sine - v + omega * q;
        d[1] = l * rate * cosine - speed * sine - omega * u;
        d[2] = omega - rate;
        d[3] = (moment * rate * rate + forward) / mass;
        d[4] = (l * sideways - moment * speed * rate) / inertia;
    }
}

/// The yaw rate at which the uniform motion loses its stability.
fn critical_yaw_rate(l: f64) -> f64 {
    let d = l - 0.012;
    let mass = 0.3519 + 0.0668 + 4.63e-5 / (0.04 * 0.04);
    let j = 3.48e-6 + 2.38e-5 + 0.0668 * d * d;
    let (m, k) = (0.0668 * d, 100.0);
    let ml = mass * l;
    let n = -j * j * k * l * (ml + m) + j * k * l * l * (ml * ml + 3.0 * m * m)
        - k * l.powi(3) * m * (ml * ml - ml * m + 2.0 * m * m);
    let denominator = j * j * m * (ml + m)
        + j * l * m * (ml * ml - 5.0 * m * m)
        + l * l * m * m * (ml * ml - 5.0 * ml * m + 6.0 * m * m);
    (-n / denominator).sqrt()
}

#[test]
fn hopf_curve_of_the_wheel() {
    assert_relative_eq!(critical_yaw_rate(0.08), 8.43103697014, max_relative = 1e-11);
    let branch = Equilibria::of(&Wheel).start(&[0.0, 0.0, 0.08, 1.0, 1.0]).parameters(&[1.0, 0.08, 1.0]);
    let branch = branch.along("v", 0.1..=12.0).run().unwrap();
    let hopf = branch.hopf_points().next().unwrap();
    let locus = EquilibriumLocus::of(&Wheel).from_hopf(hopf).along("v", 0.1..=12.0).and("l", 0.05..=0.2);
    let locus = locus.run().unwrap();
    reaches_range_ends(&locus);
    let ends = [locus.points[0].values[1], locus.points[locus.points.len() - 1].values[1]];
    assert_eq!([ends[0].min(ends[1]), ends[0].max(ends[1])], [0.05, 0.2]);
    assert!(locus.points.len() < 100, "{}", locus.points.len());
    for point in &locus.points {
        assert_relative_eq!(point.values[0], critical_yaw_rate(point.values[1]), max_relative = 1e-9);
        assert!(point.first_lyapunov.unwrap() > 0.0);
    }
}

field!(Bazykin, ["prey", "predator"], ["alpha", "delta"], |x, p, d| {
    let eaten = x[0] * x[1] / (p[0] * x[0] + 1.0);
    d[0] = x[0] - eaten - x[0] * x[0] * 0.01;
    d[1] = eaten - x[1] - p[1] * x[1] * x[1];
});

#[test]
fn bazykin_has_its_published_bogdanov_takens_point() {
    let branch =
        Equilibria::of(&Bazykin).start(&[1.5, 1.1]).parameters(&[0.1, 0.2]).along("alpha", 0.0..=0.98);
    let branch = branch.run().unwrap();
    let fold = branch.folds().next().unwrap();
    let folds =
        EquilibriumLocus::of(&Bazykin).from_fold(fold).along("alpha", 0.0..=1.0).and("delta", 0.0..=1.0);
    let folds = folds.run().unwrap();
    let points: Vec<_> =
        folds.special_points().filter(|point| point.kind == SpecialKind::BogdanovTakens).collect();
    let published = [0.4536243277781295, 0.1751275929502174];
    let nearest = points
        .iter()
        .min_by(|a, b| (a.values[0] - published[0]).abs().total_cmp(&(b.values[0] - published[0]).abs()));
    for (value, expected) in nearest.unwrap().values.iter().zip(published) {
        assert_relative_eq!(*value, expected, max_relative = 1e-12);
    }
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

field!(MorrisLecar, ["v", "w"], ["iapp", "phi", "gca", "v3"], |x, p, d| {
    let m = (((x[0] + 1.2) / 18.0).tanh() + 1.0) * 0.5;
    let argument = (x[0] - p[3]) / 30.0;
    let w = (argument.tanh() + 1.0) * 0.5;
    let rate = (argument * 0.5).cosh();
    d[0] = (p[0] - (x[0] + 60.0) * 2.0 - x[1] * (x[0] + 84.0) * 8.0 - p[2] * m * (x[0] - 120.0)) / 20.0;
    d[1] = p[1] * (w - x[1]) * rate;
});

#[test]
fn morris_lecar_curves_meet_at_bogdanov_takens_points() {
    let run = |start: &[f64], v3: f64| {
        let ask = Equilibria::of(&MorrisLecar).start(start).parameters(&[0.0, 0.04, 4.4, v3]);
        ask.along("iapp", 0.0..=300.0).run().unwrap()
    };
    let resting = run(&[-60.855, 0.014915], 2.0);
    assert_eq!(resting.hopf_points().count(), 2);
    let hopf = EquilibriumLocus::of(&MorrisLecar).from_hopf(resting.hopf_points().next().unwrap());
    let hopf = hopf.along("iapp", -200.0..=400.0).and("v3", -20.0..=40.0).run().unwrap();
    let excitable = run(&[-60.0, 0.01], 30.0);
    let folds = EquilibriumLocus::of(&MorrisLecar).from_fold(excitable.folds().next().unwrap());
    let folds = folds.along("iapp", -200.0..=400.0).and("v3", -20.0..=40.0).run().unwrap();
    for locus in [&hopf, &folds] {
        reaches_range_ends(locus);
        for point in locus.special_points().filter(|point| point.kind == SpecialKind::BogdanovTakens) {
            let (sum, product) =
                (point.eigenvalues[0] + point.eigenvalues[1], point.eigenvalues[0] * point.eigenvalues[1]);
            assert!(sum.norm() < 1e-12 && product.norm() < 1e-13, "{point:?}");
        }
    }
    let one = only(&hopf, SpecialKind::BogdanovTakens);
    let same = |point: &CodimensionTwoPoint| (point.values[0] - one.values[0]).abs() < 1e-9;
    assert!(
        folds.special_points().any(|point| point.kind == one.kind && same(point)),
        "{:?}",
        labels(&folds)
    );
    let cusp = only(&folds, SpecialKind::Cusp);
    assert!(cusp.regular && cusp.location_error[0] < 1e-10);
}

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

#[test]
fn bad_requests_are_refused() {
    let branch = Equilibria::of(&Cusp)
        .start(&[-2.0])
        .parameters(&[-2.0, 1.0])
        .along("beta1", -2.0..=2.0)
        .run()
        .unwrap();
    let fold = branch.folds().next().unwrap();
    let message = |asked: EquilibriumLocus<'_>| asked.run().unwrap_err().to_string();
    let ask = || EquilibriumLocus::of(&Cusp).from_fold(fold);
    assert!(message(ask()).contains("two parameters"));
    assert!(message(ask().along("beta1", -1.0..=1.0)).contains("two parameters"));
    assert!(message(ask().along("beta1", -1.0..=1.0).and("beta1", -1.0..=2.0)).contains("different"));
    assert!(
        message(ask().along("beta1", -1.0..=1.0).and("gamma", -1.0..=2.0)).contains("one of beta1, beta2")
    );
    assert!(message(ask().along("beta1", -1.0..=1.0).and("beta2", 2.0..=3.0)).contains("contains 1"));
    let unstarted = EquilibriumLocus::of(&Cusp).along("beta1", -1.0..=1.0).and("beta2", -1.0..=2.0);
    assert!(message(unstarted).contains("a fold"));
}

/// A random polynomial field of degree three with two parameters.
#[derive(Debug)]
struct Polynomial {
    dimension: usize,
    coefficients: Vec<f64>,
}

impl VectorField for Polynomial {
    fn state_names(&self) -> Vec<String> {
        (0..self.dimension).map(|index| format!("x{index}")).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into(), "q".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], d: &mut [T]) {
        let n = self.dimension;
        let mut coefficients = self.coefficients.iter().copied();
        let mut next = || coefficients.next().unwrap_or(0.0);
        for row in 0..n {
            let mut sum = p[0] * next() + p[1] * next() + next() - x[row] * x[row] * x[row];
            for i in 0..n {
                sum += x[i] * next() + x[i] * p[0] * next() + x[i] * p[1] * next();
                for j in 0..n {
                    sum += x[i] * x[j] * next();
                }
            }
            d[row] = sum;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn curves_of_random_fields_run_to_their_ends(
        dimension in 1usize..5,
        coefficients in prop::collection::vec(-2.0..2.0f64, 4 * (3 + 4 * 7)),
    ) {
        let field = Polynomial { dimension, coefficients };
        let start = vec![0.3; dimension];
        let Ok(branch) = Equilibria::of(&field).start(&start).parameters(&[0.0; 2]).along("p", -1.0..=1.0).run() else {
            return Ok(());
        };
        let ask = || EquilibriumLocus::of(&field).along("p", -1.0..=1.0).and("q", -1.0..=1.0);
        let folds = branch.folds().take(1).map(|fold| ask().from_fold(fold));
        let curves = folds.chain(branch.hopf_points().take(1).map(|hopf| ask().from_hopf(hopf)));
        for curve in curves {
            let locus = curve.run().unwrap();
            for stop in locus.stops.iter().flatten() {
                prop_assert!(matches!(stop, Stop::RangeEnd { .. } | Stop::Closed), "{} {:?}", stop, labels(&locus));
            }
            for point in locus.special_points() {
                let largest = point.eigenvalues.iter().map(|value| value.norm()).fold(1.0, f64::max);
                let on_axis = point.eigenvalues.iter().filter(|value| value.re.abs() < 1e-5 * largest).count();
                let expected = match point.kind {
                    SpecialKind::Cusp => 1,
                    SpecialKind::BogdanovTakens | SpecialKind::GeneralizedHopf => 2,
                    SpecialKind::ZeroHopf => 3,
                    _ => 4,
                };
                prop_assert!(on_axis >= expected, "{:?}", point);
                prop_assert!(point.regular, "{:?}", point);
            }
            for pair in locus.points.windows(2) {
                let change = pair[0].values.iter().zip(pair[1].values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                prop_assert!(change < 0.3, "a jump of {}", change);
            }
        }
    }
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
