//! Models of the literature: a reaction, the towed wheel, predator and prey, a nerve.

use super::{labels, only, reaches_range_ends};
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::equilibrium::{Equilibria, EquilibriumBranch};
use arclength::locus::{CodimensionTwoPoint, EquilibriumLocus, EquilibriumLocusBranch};
use arclength::{Scalar, VectorField};

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
