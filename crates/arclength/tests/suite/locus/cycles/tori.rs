//! Curves of torus bifurcations, their strong resonances, and where they end.

use super::fields::{CirclesOfPlane, DoublingBand, Resonances, along_p, assert_at, found};
use crate::common;
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{Cycles, Orbit};
use arclength::locus::{CycleLocus, CycleLocusBranch, CycleLocusEnd};
use arclength::{Scalar, VectorField};

#[test]
fn strong_resonances_of_tori() {
    let mu = 1e-3_f64;
    let parameters = [mu, 0.5 * mu.sqrt()];
    let orbit = Orbit::from_time_history(&Resonances, &parameters, &[1.0, 0.0, 0.3 + mu.sqrt(), 0.0], 7.0)
        .expect("a cycle");
    let tori = CycleLocus::of(&Resonances)
        .from_cycle(SpecialKind::Torus, &orbit, &parameters)
        .along("mu", -0.01..=0.01)
        .and("nu", -0.1..=0.1)
        .run()
        .expect("exists");
    for point in &tori.points {
        let [mu, nu] = point.values;
        assert!((nu * nu - 0.25 * mu).abs() < 1e-8, "{mu} {nu}");
    }
    // The normal form of the planar Hopf point with the square of the frequency 2 s: a = 1 / (16 s).
    for point in tori.points.iter().filter(|point| point.values[0] > 1e-5) {
        let s = point.values[0].sqrt();
        let exact = 1.0 / (8.0 * s * (1.0 + 2.0 * s));
        assert_relative_eq!(point.coefficient.expect("a coefficient"), exact, max_relative = 1e-6);
    }
    assert!(
        matches!(tori.stops[0], Some(Stop::Problem(CycleLocusEnd::StrongResonance { order: 1 }))),
        "{:?}",
        tori.stops
    );
    let at = |angle: f64| {
        let root = 0.5 * (angle / (2.0 * std::f64::consts::PI)).powi(2);
        [root * root, 0.5 * root]
    };
    use std::f64::consts::PI;
    assert_at(&tori, SpecialKind::Resonance1, [0.0, 0.0], 1e-8);
    assert_at(&tori, SpecialKind::Resonance3, at(2.0 * PI / 3.0), 1e-8);
    assert_at(&tori, SpecialKind::Resonance4, at(0.5 * PI), 1e-8);
    assert_eq!(found(&tori).len(), 3, "{:?}", found(&tori));
}

#[test]
fn tori_of_a_moebius_band_end_at_the_one_to_two_resonance() {
    // Torus bifurcations at nu = 0 with the angle pi - 2 pi sqrt(-mu).
    let parameters = [-0.04, 0.0, -1.0];
    let orbit = Orbit::from_time_history(&DoublingBand, &parameters, &[1.0, 0.0, 0.0], 7.0).expect("a cycle");
    let tori = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::Torus, &orbit, &parameters)
        .along("mu", -0.1..=0.1)
        .and("nu", -0.1..=0.1)
        .run()
        .expect("exists");
    assert!(
        matches!(tori.stops[1], Some(Stop::Problem(CycleLocusEnd::StrongResonance { order: 2 }))),
        "{:?}",
        tori.stops
    );
    assert_at(&tori, SpecialKind::Resonance2, [0.0, 0.0], 1e-8);
    assert_at(&tori, SpecialKind::Resonance3, [-1.0 / 36.0, 0.0], 1e-8);
    assert_at(&tori, SpecialKind::Resonance4, [-1.0 / 16.0, 0.0], 1e-8);
}

/// The peroxidase-oxidase reaction of Steinmetz and Larter (1991).
struct Peroxidase;

impl VectorField for Peroxidase {
    fn state_names(&self) -> Vec<String> {
        names!["A", "B", "X", "Y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["k7", "k8"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [a, b, x, y] = [state[0], state[1], state[2], state[3]];
        let (first, third) = (a * b * x * 0.1631021, a * b * y * 0.046875);
        derivative[0] = parameters[0] - first - third - a * 0.1175;
        derivative[1] = parameters[1] - first - third;
        derivative[2] = first - x * x * 2500.0 + third * 2.0 - x * 20.0 + 0.001;
        derivative[3] = x * x * 2500.0 - third - y * 1.104;
    }
}

#[test]
fn folds_and_tori_of_a_reaction_meet_in_the_same_resonance() {
    let parameters = [0.712475372576, 0.5];
    let start = common::hopf_start(&Peroxidase, &[1.808301, 25.573303, 0.015245858, 0.17761127], &parameters);
    let branch =
        Cycles::of(&Peroxidase, start).parameters(&parameters).along("k7", 0.5..=10.0).run().expect("exists");
    let follow = |kind: SpecialKind, sought: fn(SpecialKind) -> bool| {
        let (_, cycle) = branch.special().find(|(special, _)| sought(*special)).expect("a special cycle");
        CycleLocus::of(&Peroxidase)
            .from_cycle(kind, &cycle.orbit, &[cycle.value, 0.5])
            .along("k7", 0.5..=10.0)
            .and("k8", 0.1..=3.0)
            .run()
            .expect("exists")
    };
    let folds = follow(SpecialKind::FoldOfCycles, |special| special == SpecialKind::FoldOfCycles);
    let tori = follow(SpecialKind::Torus, |special| special == SpecialKind::Torus);
    let resonances = |curve: &CycleLocusBranch| -> Vec<[f64; 2]> {
        found(curve)
            .into_iter()
            .filter(|(kind, _)| *kind == SpecialKind::Resonance1)
            .map(|(_, at)| at)
            .collect()
    };
    let (on_folds, on_tori) = (resonances(&folds), resonances(&tori));
    assert_eq!(on_tori.len(), 1);
    assert!(
        on_folds.iter().any(|at| (0..2).all(|k| (at[k] - on_tori[0][k]).abs() < 1e-8)),
        "{on_folds:?} {on_tori:?}"
    );
}

/// A circle and beside it a linear oscillator that grows at the rate `a - b`: the coefficient of its torus bifurcations is zero.
struct LinearBeside;

impl VectorField for LinearBeside {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "u", "v"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["a", "b"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y, u, v] = [state[0], state[1], state[2], state[3]];
        let growth = T::one() - x * x - y * y;
        derivative[0] = growth * x - y;
        derivative[1] = growth * y + x;
        let rate = parameters[0] - parameters[1];
        // The circle modulates the oscillator, so that its coefficient comes out as noise and not as zero.
        let speed = x * 0.1 + 0.3;
        derivative[2] = rate * u - speed * v;
        derivative[3] = rate * v + speed * u;
    }
}

#[test]
fn a_coefficient_that_is_zero_all_along_has_no_chenciner_points() {
    let parameters = [0.1, 0.1];
    let orbit =
        Orbit::from_time_history(&LinearBeside, &parameters, &[1.0, 0.0, 0.0, 0.0], 7.0).expect("a cycle");
    let tori = CycleLocus::of(&LinearBeside)
        .from_cycle(SpecialKind::Torus, &orbit, &parameters)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=1.0)
        .run()
        .expect("exists");
    assert!(tori.points.iter().any(|point| point.coefficient.is_some_and(|value| value != 0.0)));
    assert_eq!(found(&tori), []);
}

// Torus bifurcations at rho = 0 with the argument 2 pi w, that of a double multiplier -1 without a Jordan block at w = 1/2.
beside_a_circle!(TurnedBeside, ["x", "y"], ["rho", "w"], |s, p, d| {
    let square = s[2] * s[2] + s[3] * s[3];
    d[2] = (p[0] - square) * s[2] - p[1] * s[3];
    d[3] = (p[0] - square) * s[3] + p[1] * s[2];
});

#[test]
fn tori_go_on_where_their_multipliers_pass_through_minus_one() {
    let parameters = [0.0, 0.37];
    let orbit = Orbit::from_time_history(&TurnedBeside, &parameters, &[1.0, 0.0, 0.0, 0.0], 7.0);
    let tori = CycleLocus::of(&TurnedBeside)
        .from_cycle(SpecialKind::Torus, &orbit.expect("a cycle"), &parameters)
        .along("rho", -1.0..=1.0)
        .and("w", 0.2..=0.9)
        .run()
        .expect("exists");
    for stop in tori.stops.iter().flatten() {
        assert!(matches!(stop, Stop::RangeEnd { .. }), "{stop}");
    }
    for point in &tori.points {
        let exact = (2.0 * std::f64::consts::PI * point.values[1]).cos().acos();
        assert!(point.values[0].abs() < 1e-8);
        assert_relative_eq!(point.argument.expect("an argument"), exact, epsilon = 1e-6);
    }
    assert!(tori.points.iter().any(|point| point.values[1] > 0.89));
}

/// Circles whose torus bifurcations end in two Bogdanov-Takens points of the plane, next to one of which the angle changes fast.
const TWO_ENDS: CirclesOfPlane = CirclesOfPlane([
    [0.844, 0.127, 0.52, 0.365, -0.181, -0.035, -0.155, 0.42, -0.333, 0.524, -0.638, 0.689],
    [0.761, -0.439, -0.566, 0.236, 0.528, 0.321, -0.447, 0.14, 0.277, -0.168, -0.496, 0.421],
]);

#[test]
fn a_curve_that_steps_over_a_resonance_ends_there() {
    let branch = along_p(&TWO_ENDS);
    let special = branch.special().find(|(kind, _)| *kind == SpecialKind::Torus);
    let (_, start) = special.expect("a torus bifurcation");
    let tori = CycleLocus::of(&TWO_ENDS)
        .from_cycle(SpecialKind::Torus, &start.orbit, &[start.value, 0.0])
        .along("p", -2.0..=2.0)
        .and("q", -2.0..=2.0)
        .run()
        .expect("exists");
    for stop in tori.stops.iter().flatten() {
        let is_resonance = matches!(stop, Stop::Problem(CycleLocusEnd::StrongResonance { order: 1 }));
        assert!(is_resonance, "{stop}");
    }
    // By Newton's method on the plane.
    assert_at(&tori, SpecialKind::Resonance1, [-0.0775285131, -1.4633742542], 1e-8);
    let resonances = found(&tori).into_iter().filter(|(kind, _)| *kind == SpecialKind::Resonance1);
    assert_eq!(resonances.count(), 2);
    // Next to them the coefficient is rounding.
    assert!(found(&tori).iter().all(|(kind, _)| *kind != SpecialKind::Chenciner), "{:?}", found(&tori));
    assert!(tori.unlocated.is_empty(), "{:?}", tori.unlocated);
}

/// Circles `s = u + i v` of radius `sqrt(p)` and an oscillator `c` beside them that grows at the rate `q - p / 2`, in the coordinate
/// `s + c / 2`: torus bifurcations at `q = p / 2`, with the argument of `c` in the plane of the cycle.
struct Mixed;

impl VectorField for Mixed {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "c", "d"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["p", "q"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [c, d] = [state[2], state[3]];
        let [u, v] = [state[0] - c * 0.5, state[1] - d * 0.5];
        let (square, other) = (u * u + v * v, c * c + d * d);
        let growth = parameters[0] - square + other * 0.4;
        let rate = parameters[1] - square * 0.5 - other * 0.6;
        let speed = square * 0.1 + 0.88;
        let [du, dv] = [growth * u - speed * v, growth * v + speed * u];
        let [dc, dd] = [rate * c - d * 0.586, rate * d + c * 0.586];
        derivative[0] = du + dc * 0.5;
        derivative[1] = dv + dd * 0.5;
        derivative[2] = dc;
        derivative[3] = dd;
    }
}

#[test]
fn tori_that_shrink_end_at_a_hopf_hopf_point() {
    let parameters = [0.64, 0.32];
    let orbit = Orbit::from_time_history(&Mixed, &parameters, &[0.8, 0.0, 0.0, 0.0], 7.0);
    let tori = CycleLocus::of(&Mixed)
        .from_cycle(SpecialKind::Torus, &orbit.expect("a cycle"), &parameters)
        .along("p", -1.0..=2.0)
        .and("q", -1.0..=2.0)
        .run()
        .expect("exists");
    let Some(Stop::Problem(CycleLocusEnd::HopfHopfPoint { values, frequency })) = &tori.stops[0] else {
        panic!("{:?}", tori.stops);
    };
    assert!(values.iter().all(|value| value.abs() < 1e-12), "{values:?}");
    assert_relative_eq!(*frequency, 0.88, max_relative = 1e-9);
    assert_eq!(found(&tori).len(), 1, "{:?}", found(&tori));
    let end = tori.points[0].argument.expect("an argument");
    let turned = std::f64::consts::TAU * (1.0 - 0.586 / 0.88);
    assert_relative_eq!(end, turned, max_relative = 1e-9);
    assert!(tori.points.len() < 60, "{}", tori.points.len());
    for point in &tori.points {
        assert!((point.values[1] - 0.5 * point.values[0]).abs() < 1e-9);
    }
}

/// `r' = r (p - z + z^2)`, `z' = q + z^2 + r^2` in a coordinate that mixes them: torus bifurcations at `p = 0`, `q < 0`, from the
/// zero-Hopf point at the origin on.
struct ZeroHopf;

impl VectorField for ZeroHopf {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "z"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["p", "q"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [u, v] = [state[0], state[1]];
        let z = state[2] - u * 0.3;
        let growth = parameters[0] - z + z * z;
        let speed = z * 0.3 + 1.1;
        let du = growth * u - speed * v;
        derivative[0] = du;
        derivative[1] = growth * v + speed * u;
        derivative[2] = parameters[1] + z * z + u * u + v * v + du * 0.3;
    }
}

#[test]
fn tori_that_shrink_end_at_a_zero_hopf_point() {
    let parameters = [0.0, -0.04];
    let period = std::f64::consts::TAU / 1.1;
    let orbit = Orbit::from_time_history(&ZeroHopf, &parameters, &[0.2, 0.0, 0.06], 6.0);
    let tori = CycleLocus::of(&ZeroHopf)
        .from_cycle(SpecialKind::Torus, &orbit.expect("a cycle"), &parameters)
        .along("q", -0.1..=1.0)
        .and("p", -1.0..=1.0)
        .run()
        .expect("exists");
    let Some(Stop::Problem(CycleLocusEnd::ZeroHopfPoint { values, frequency })) = &tori.stops[1] else {
        panic!("{:?}", tori.stops);
    };
    assert!(values.iter().all(|value| value.abs() < 1e-10), "{values:?}");
    assert_relative_eq!(*frequency, 1.1, max_relative = 1e-8);
    for point in &tori.points {
        assert!(point.values[1].abs() < 1e-9);
        let exact = (-2.0 * point.values[0].min(0.0)).sqrt() * period;
        assert_relative_eq!(point.argument.expect("an argument"), exact, epsilon = 1e-6);
    }
}
