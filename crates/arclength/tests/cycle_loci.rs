//! Curves of special cycles in two parameters against systems in which they are known.

mod common;

use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CycleStart, Cycles, Orbit};
use arclength::locus::{CycleLocus, CycleLocusBranch, CycleLocusEnd};
use arclength::{Scalar, VectorField};

macro_rules! names {
    ($($name:literal),*) => { vec![$($name.into()),*] };
}

/// Circles of radius `sqrt(1 + s)` with `a + b s - s^3 = 0`: folds at `a = -2 s^3`, `b = 3 s^2` with a cusp at the origin.
struct CuspOfCycles;

impl VectorField for CuspOfCycles {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["a", "b"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y] = [state[0], state[1]];
        let s = x * x + y * y - 1.0;
        let growth = parameters[0] + parameters[1] * s - s * s * s;
        let speed = s * 0.4 + 1.0;
        derivative[0] = growth * x - speed * y;
        derivative[1] = growth * y + speed * x;
    }
}

fn found(branch: &CycleLocusBranch) -> Vec<(SpecialKind, [f64; 2])> {
    branch.special().map(|(kind, point)| (kind, point.values)).collect()
}

fn assert_at(branch: &CycleLocusBranch, kind: SpecialKind, exact: [f64; 2], tolerance: f64) {
    let points = found(branch);
    let near = points
        .iter()
        .any(|(other, values)| *other == kind && (0..2).all(|k| (values[k] - exact[k]).abs() < tolerance));
    assert!(near, "{kind:?} at {exact:?} among {points:?}");
}

#[test]
fn cusp_of_cycles() {
    // Three cycles at a = 0, b = 0.27: s = 0 and +-0.3 sqrt(3).
    let s = 0.27_f64.sqrt();
    let parameters = [0.0, 0.27];
    let orbit =
        Orbit::from_time_history(&CuspOfCycles, &parameters, &[(1.0 + s).sqrt(), 0.0], 7.0).expect("a cycle");
    let branch = Cycles::of(&CuspOfCycles, CycleStart::Orbit(orbit))
        .parameters(&parameters)
        .along("a", -0.2..=0.2)
        .run()
        .expect("exists");
    let (_, fold) =
        branch.special().find(|(special, _)| *special == SpecialKind::FoldOfCycles).expect("a fold");
    let folds = CycleLocus::of(&CuspOfCycles)
        .from_cycle(SpecialKind::FoldOfCycles, &fold.orbit, &[fold.value, 0.27])
        .along("a", -0.2..=0.2)
        .and("b", -0.1..=0.4)
        .run()
        .expect("exists");
    for point in &folds.points {
        let s = point.max[0].powi(2) - 1.0;
        assert!(
            (point.values[0] + 2.0 * s.powi(3)).abs() < 1e-8 && (point.values[1] - 3.0 * s * s).abs() < 1e-8
        );
    }
    assert_at(&folds, SpecialKind::CuspOfCycles, [0.0, 0.0], 1e-9);
}

/// A revolution with `xi' = eta`, `eta' = mu + nu eta - xi^2 - xi eta / 2` beside it: folds at `mu = 0`; torus bifurcations at
/// `nu = sqrt(mu) / 2`, `xi = sqrt(mu)` with the angle `2 pi sqrt(2 sqrt(mu))`; both meet in a 1:1 resonance.
struct Resonances;

impl VectorField for Resonances {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "p", "q"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "nu"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y] = [state[0], state[1]];
        let (xi, eta) = (state[2] - x * 0.3, state[3] - x * y * 0.2);
        let growth = -(x * x + y * y) + 1.0;
        let (dx, dy) = (growth * x - y, growth * y + x);
        let curved = parameters[0] + parameters[1] * eta - xi * xi - xi * eta * 0.5;
        derivative[0] = dx;
        derivative[1] = dy;
        derivative[2] = eta + dx * 0.3;
        derivative[3] = curved + (dx * y + dy * x) * 0.2;
    }
}

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
fn the_one_to_one_resonance_on_the_folds() {
    let mu = 0.01_f64;
    let parameters = [mu, 0.05];
    let orbit = Orbit::from_time_history(&Resonances, &parameters, &[1.0, 0.0, 0.3 + mu.sqrt(), 0.0], 7.0)
        .expect("a cycle");
    let branch = Cycles::of(&Resonances, CycleStart::Orbit(orbit))
        .parameters(&parameters)
        .along("mu", -0.1..=0.1)
        .run()
        .expect("exists");
    let (_, fold) =
        branch.special().find(|(special, _)| *special == SpecialKind::FoldOfCycles).expect("a fold");
    let folds = CycleLocus::of(&Resonances)
        .from_cycle(SpecialKind::FoldOfCycles, &fold.orbit, &[fold.value, 0.05])
        .along("mu", -0.1..=0.1)
        .and("nu", -0.1..=0.1)
        .run()
        .expect("exists");
    assert!(folds.points.iter().all(|point| point.values[0].abs() < 1e-8));
    assert_at(&folds, SpecialKind::Resonance1, [0.0, 0.0], 1e-8);
}

/// The turning frame of a Moebius band with `xi' = eta + k xi`, `eta' = mu xi + (nu - k) eta + c xi^3 - xi^5`: period
/// doublings where the determinant `-mu + k (nu - k)` vanishes.
struct DoublingBand;

impl VectorField for DoublingBand {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "z"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "nu", "c"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y, z] = [state[0], state[1], state[2]];
        let [mu, nu, c] = [parameters[0], parameters[1], parameters[2]];
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = (x / r, y / r);
        let a = r - 1.0;
        // xi e^(i phi/2) and eta e^(i phi/2); the latter is -i times the part of w against the turning axis.
        let p = [(a + a * cos + z * sin) * 0.5, (z + a * sin - z * cos) * 0.5];
        let q = [z - p[1], -(a - p[0])];
        let square = p[0] * p[0] + p[1] * p[1];
        let stiffness = mu + c * square - square * square;
        let first = q;
        let second = [stiffness * p[0] + nu * q[0], stiffness * p[1] + nu * q[1]];
        // w' = (xi' + i eta') e^(i phi/2) + (i/2) w
        let radial = first[0] - second[1] - z * 0.5;
        let vertical = first[1] + second[0] + a * 0.5;
        derivative[0] = radial * cos - y;
        derivative[1] = radial * sin + x;
        derivative[2] = vertical;
    }
}

#[test]
fn resonance_and_degenerate_doubling_on_doublings() {
    let orbit = |parameters: &[f64]| {
        Orbit::from_time_history(&DoublingBand, parameters, &[1.0, 0.0, 0.0], 7.0).expect("a cycle")
    };
    // Doublings at mu = 0; a second multiplier -1 at nu = 0.
    let parameters = [0.0, -0.3, -1.0];
    let doublings = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit(&parameters), &parameters)
        .along("mu", -0.2..=0.2)
        .and("nu", -0.5..=0.5)
        .run()
        .expect("exists");
    assert!(doublings.points.iter().all(|point| point.values[0].abs() < 1e-8));
    assert_at(&doublings, SpecialKind::Resonance2, [0.0, 0.0], 1e-8);
    // The cubic coefficient vanishes with c.
    let doublings = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit(&parameters), &parameters)
        .along("mu", -0.2..=0.2)
        .and("c", -1.5..=1.5)
        .run()
        .expect("exists");
    assert_at(&doublings, SpecialKind::GeneralizedPeriodDoubling, [0.0, 0.0], 1e-8);
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

#[test]
fn the_doublings_of_lure_form_a_closed_curve() {
    let start = common::hopf_start(&common::Lure, &[0.0; 3], &[1.0, 1.0]);
    let branch = Cycles::of(&common::Lure, start)
        .parameters(&[1.0, 1.0])
        .along("alpha", 0.0..=1.1)
        .run()
        .expect("exists");
    let (_, doubling) =
        branch.special().find(|(special, _)| *special == SpecialKind::PeriodDoubling).expect("a doubling");
    let doublings = CycleLocus::of(&common::Lure)
        .from_cycle(SpecialKind::PeriodDoubling, &doubling.orbit, &[doubling.value, 1.0])
        .along("alpha", -2.0..=2.0)
        .and("beta", 0.2..=2.0)
        .run()
        .expect("exists");
    assert!(matches!(doublings.stops[1], Some(Stop::Closed)), "{:?}", doublings.stops);
    // With alpha = 0 the system is reversible and multipliers come in reciprocal pairs: two of them are -1.
    let points = found(&doublings);
    assert_eq!(points.len(), 2, "{points:?}");
    for (kind, values) in points {
        assert!(kind == SpecialKind::Resonance2 && values[0].abs() < 1e-8);
    }
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

/// Circles of radius `s` with `a + b s^2 - s^4 = 0`: folds at `a = -b^2/4`, `b > 0`, that shrink to the generalised Hopf point at
/// the origin; the angular velocity is `2 + s^2`.
struct Bautin;

impl VectorField for Bautin {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["a", "b"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y] = [state[0], state[1]];
        let square = x * x + y * y;
        let growth = parameters[0] + parameters[1] * square - square * square;
        let speed = square + 2.0;
        derivative[0] = growth * x - speed * y;
        derivative[1] = growth * y + speed * x;
    }
}

/// The fold at `b = 1`, with its parameters: a circle with the angular velocity 2.5.
fn fold_of_bautin() -> (Orbit, [f64; 2]) {
    let parameters = [-0.25, 1.0];
    let period = 2.0 * std::f64::consts::PI / 2.5;
    let orbit = Orbit::from_time_history(&Bautin, &parameters, &[0.5_f64.sqrt(), 0.0], 1.1 * period);
    (orbit.expect("a cycle"), parameters)
}

#[test]
fn folds_of_cycles_end_at_a_generalised_hopf_point() {
    let (orbit, parameters) = fold_of_bautin();
    let folds = CycleLocus::of(&Bautin)
        .from_cycle(SpecialKind::FoldOfCycles, &orbit, &parameters)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=1.5)
        .run()
        .expect("exists");
    let ends =
        [(folds.stops[0].as_ref(), folds.points.first()), (folds.stops[1].as_ref(), folds.points.last())];
    let (stop, point) = ends
        .into_iter()
        .find(|(stop, _)| matches!(stop, Some(Stop::Problem(CycleLocusEnd::GeneralizedHopfPoint { .. }))))
        .unwrap_or_else(|| panic!("a generalised Hopf point: {:?} {:?}", folds.stops, folds.unlocated));
    let Some(Stop::Problem(CycleLocusEnd::GeneralizedHopfPoint { values, frequency })) = stop else {
        unreachable!()
    };
    assert!(values.iter().all(|value| value.abs() < 1e-10), "{values:?}");
    assert_relative_eq!(*frequency, 2.0, max_relative = 1e-10);
    let point = point.expect("not empty");
    assert_eq!(point.label.map(|label| label.kind), Some(SpecialKind::GeneralizedHopf));
    assert!(point.max.iter().chain(&point.min).all(|value| value.abs() < 1e-10));
    for point in &folds.points {
        assert!((point.values[0] + 0.25 * point.values[1].powi(2)).abs() < 1e-8, "{:?}", point.values);
    }
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

#[test]
fn a_branch_of_cycles_starts_at_its_fold() {
    let (orbit, parameters) = fold_of_bautin();
    let branch = |orbit: &Orbit, value: f64| {
        Cycles::of(&Bautin, CycleStart::Orbit(orbit.clone()))
            .parameters(&[value, parameters[1]])
            .along("a", -1.0..=1.0)
            .run()
            .expect("exists")
    };
    let first = branch(&orbit, parameters[0]);
    let (_, fold) =
        first.special().find(|(special, _)| *special == SpecialKind::FoldOfCycles).expect("a fold");
    assert!((fold.value + 0.25).abs() < 1e-10);
    let second = branch(&fold.orbit, fold.value);
    let stops = &second.stops;
    assert!(
        stops
            .iter()
            .any(|stop| matches!(stop, Some(Stop::Problem(CycleEnd::HopfPoint { located: true, .. })))),
        "{stops:?}"
    );
    assert!(stops.iter().any(|stop| matches!(stop, Some(Stop::RangeEnd { .. }))), "{stops:?}");
    assert!(second.points.iter().all(|point| {
        let square = point.max[0].powi(2);
        (point.value + square - square * square).abs() < 1e-7
    }));
}

#[test]
fn an_observer_ends_a_branch_and_what_there_is_stays() {
    let (orbit, parameters) = fold_of_bautin();
    let mut told = 0;
    let branch = Cycles::of(&Bautin, CycleStart::Orbit(orbit))
        .parameters(&parameters)
        .along("a", -1.0..=1.0)
        .observer(|_| {
            told += 1;
            if told < 5 { std::ops::ControlFlow::Continue(()) } else { std::ops::ControlFlow::Break(()) }
        })
        .run()
        .expect("exists");
    assert!(matches!(branch.stops, [Some(Stop::Interrupted), Some(Stop::Interrupted)]), "{:?}", branch.stops);
    assert_eq!(branch.points.len(), 5);
}

/// The unit circle with the rotation speed one, and beside it states of their own with the right-hand sides `rest`.
macro_rules! beside_a_circle {
    ($name:ident, [$($state:literal),*], [$($parameter:literal),*], |$s:ident, $p:ident, $d:ident| $rest:block) => {
        struct $name;

        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                names!["u", "v", $($state),*]
            }
            fn parameter_names(&self) -> Vec<String> {
                names![$($parameter),*]
            }
            fn evaluate<T: Scalar>(&self, $s: &[T], $p: &[T], $d: &mut [T]) {
                let growth = T::one() - $s[0] * $s[0] - $s[1] * $s[1];
                $d[0] = growth * $s[0] - $s[1];
                $d[1] = growth * $s[1] + $s[0];
                $rest
            }
        }
    };
}

// Folds at a = 3 z^2, c = -2 z^3 with a cusp at the origin; z is constant on the cycles.
beside_a_circle!(RestingCusp, ["z"], ["a", "c"], |s, p, d| {
    d[2] = p[0] * s[2] + p[1] - s[2] * s[2] * s[2];
});

#[test]
fn a_cusp_of_cycles_on_which_a_state_rests() {
    for (z, finer) in [(0.3_f64, 1.0), (0.3, 3.0), (-0.45, 1.0), (0.57, 1.0)] {
        let parameters = [3.0 * z * z, -2.0 * z.powi(3)];
        let orbit =
            Orbit::from_time_history(&RestingCusp, &parameters, &[1.0, 0.0, z], 7.0).expect("a cycle");
        let settings = arclength::continuation::Settings::default();
        let folds = CycleLocus::of(&RestingCusp)
            .from_cycle(SpecialKind::FoldOfCycles, &orbit, &parameters)
            .along("c", -1.0..=1.0)
            .and("a", -1.0..=2.0)
            .settings(arclength::continuation::Settings {
                largest_step: settings.largest_step / finer,
                ..settings
            })
            .run()
            .expect("exists");
        assert_at(&folds, SpecialKind::CuspOfCycles, [0.0, 0.0], 1e-7);
        assert_eq!(found(&folds).len(), 1, "{:?}", found(&folds));
        // Steps in units of what the state does, not of what it would do at rest.
        assert!(folds.points.len() < 120, "{} points", folds.points.len());
    }
}

#[test]
fn folds_of_doubled_cycles_end_at_the_generalised_period_doubling() {
    // Doubled cycles with mu + c s - s^2 = 0, s = xi^2: folds at s = c / 2, mu = -c^2 / 4.
    let parameters = [-0.25, -0.3, 1.0];
    let orbit = Orbit::from_time_history(&DoublingBand, &parameters, &[1.0 + 0.5_f64.sqrt(), 0.0, 0.0], 13.0);
    let folds = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::FoldOfCycles, &orbit.expect("a cycle"), &parameters)
        .along("mu", -1.0..=1.0)
        .and("c", -1.5..=1.5)
        .run()
        .expect("exists");
    let ends =
        [(folds.stops[0].as_ref(), folds.points.first()), (folds.stops[1].as_ref(), folds.points.last())];
    let (stop, end) = ends
        .into_iter()
        .find(|(stop, _)| {
            matches!(stop, Some(Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::PeriodDoubling { .. }))))
        })
        .unwrap_or_else(|| panic!("{:?}", folds.stops));
    let Some(Stop::Problem(CycleLocusEnd::Cycle(CycleEnd::PeriodDoubling { parameter, period }))) = stop
    else {
        unreachable!()
    };
    assert!(parameter.abs() < 1e-8, "{parameter}");
    assert_relative_eq!(*period, 2.0 * std::f64::consts::PI, max_relative = 1e-8);
    let end = end.expect("not empty");
    assert_eq!(end.label.map(|label| label.kind), Some(SpecialKind::GeneralizedPeriodDoubling));
    assert!(end.values.iter().all(|value| value.abs() < 1e-8), "{:?}", end.values);
    assert_relative_eq!(end.period, 4.0 * std::f64::consts::PI, max_relative = 1e-8);
    assert_eq!(found(&folds).len(), 1, "{:?}", found(&folds));
    assert!(folds.points.iter().all(|point| (point.values[0] + 0.25 * point.values[1].powi(2)).abs() < 1e-8));
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

#[test]
fn the_coefficient_of_folds_is_that_of_the_null_function_of_unit_size() {
    // r' = r (a + b r^2 - r^4): half the second derivative at r^2 = b / 2 is -2 b r, with the radial unit vector.
    for (b, intervals) in [(1.0_f64, 0), (0.8, 0), (1.0, 1)] {
        let parameters = [-0.25 * b * b, b];
        let start = [(0.5 * b).sqrt(), 0.0];
        let period = 2.0 * std::f64::consts::PI / (2.0 + 0.5 * b);
        let orbit = Orbit::from_time_history(&Bautin, &parameters, &start, 1.1 * period).expect("a cycle");
        let resolution = arclength::cycle::Resolution::default();
        let resolution = if intervals == 0 {
            resolution
        } else {
            arclength::cycle::Resolution { tolerance: 0.01 * resolution.tolerance, ..resolution }
        };
        let folds = CycleLocus::of(&Bautin)
            .from_cycle(SpecialKind::FoldOfCycles, &orbit, &parameters)
            .along("a", -1.0..=1.0)
            .and("b", 0.3..=1.5)
            .resolution(resolution)
            .run()
            .expect("exists");
        for point in &folds.points {
            let exact = 2.0 * point.values[1] * (0.5 * point.values[1]).sqrt();
            assert_relative_eq!(point.coefficient.expect("exists"), exact, max_relative = 1e-5);
        }
    }
}

// The circle with the plane (x, y) that turns half round: period doublings at a = 0 and at b = 0, which cross in a 1:2 resonance
// that is regular on neither curve.
beside_a_circle!(CrossingDoublings, ["x", "y"], ["a", "b"], |s, p, d| {
    let (u, v, x, y, a, b) = (s[0], s[1], s[2], s[3], p[0], p[1]);
    let square = x * x + y * y;
    let growth = -square - square * square;
    let (even, odd) = ((u + 1.0) * 0.5, (-u + 1.0) * 0.5);
    let (half, e) = (v * 0.5, 0.5);
    d[2] = (a * even - b * odd - half * e) * x + ((a + b) * half + even * e) * y - y * 0.5 + growth * x;
    d[3] = ((a + b) * half - odd * e) * x + (a * odd - b * even + half * e) * y + x * 0.5 + growth * y;
});

#[test]
fn a_test_function_that_changes_its_sign_without_a_point_is_named() {
    let parameters = [0.0, 0.7];
    let orbit = Orbit::from_time_history(&CrossingDoublings, &parameters, &[1.0, 0.0, 0.0, 0.0], 7.0);
    let doublings = CycleLocus::of(&CrossingDoublings)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit.expect("a cycle"), &parameters)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=1.0)
        .run()
        .expect("exists");
    // Wherever the sign of a test function changes from one point to the next, there is a labelled point or a note.
    let resonance = |point: &arclength::locus::CycleLocusPoint| {
        point.tests.iter().find(|(name, _)| name == "R2").map(|(_, value)| *value)
    };
    let changes = doublings.points.windows(2).filter(
        |pair| matches!((resonance(&pair[0]), resonance(&pair[1])), (Some(a), Some(b)) if a * b < 0.0),
    );
    let named =
        doublings.unlocated.iter().filter(|change| change.kind == Some(SpecialKind::Resonance2)).count();
    let located = found(&doublings).len();
    assert!(changes.count() > 0);
    assert!(named + located > 0, "{:?}", doublings.unlocated);
}
