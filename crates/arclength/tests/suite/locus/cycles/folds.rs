//! Curves of folds of cycles, their cusps, and where they end.

use super::fields::{CirclesOfPlane, DoublingBand, Resonances, along_p, assert_at, found};
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CycleStart, Cycles, Orbit};
use arclength::locus::{CycleLocus, CycleLocusEnd};
use arclength::{Scalar, VectorField};

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
            .settings(settings.largest_step(settings.largest_step / finer))
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

/// Circles with folds at `p = -q^2 / 4`, and beside them an oscillator that grows at the rate `0.4 q - 0.2` and turns slowly: its
/// multipliers leave the unit circle at `q = 1 / 2`, and their real part passes one where they are elsewhere.
struct SlowBeside;

impl VectorField for SlowBeside {
    fn state_names(&self) -> Vec<String> {
        names!["u", "v", "x", "y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["p", "q"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [u, v, x, y] = [state[0], state[1], state[2], state[3]];
        let square = u * u + v * v;
        let growth = parameters[0] + parameters[1] * square - square * square;
        let rate = parameters[1] * 0.4 - 0.2 - (x * x + y * y);
        derivative[0] = growth * u - v;
        derivative[1] = growth * v + u;
        derivative[2] = rate * x - y * 0.1;
        derivative[3] = rate * y + x * 0.1;
    }
}

#[test]
fn a_pair_of_multipliers_with_the_real_part_one_is_no_resonance() {
    let radius = 0.5_f64.sqrt();
    let parameters = [-0.25, 1.0];
    let orbit = Orbit::from_time_history(&SlowBeside, &parameters, &[radius, 0.0, 0.0, 0.0], 6.3);
    let folds = CycleLocus::of(&SlowBeside)
        .from_cycle(SpecialKind::FoldOfCycles, &orbit.expect("a cycle"), &parameters)
        .along("p", -2.0..=1.0)
        .and("q", -1.0..=2.0)
        .run()
        .expect("exists");
    assert_at(&folds, SpecialKind::FoldTorus, [-0.0625, 0.5], 1e-8);
    assert_at(&folds, SpecialKind::GeneralizedHopf, [0.0, 0.0], 1e-8);
    assert_eq!(found(&folds).len(), 2, "{:?}", found(&folds));
    assert!(folds.unlocated.is_empty(), "{:?}", folds.unlocated);
}

/// Circles with a cusp next to a 1:1 resonance, at which the coefficient of the folds goes through infinity.
const CUSP_BESIDE_RESONANCE: CirclesOfPlane = CirclesOfPlane([
    [-0.83, 0.943, 0.514, 0.421, -0.371, 0.883, 0.418, -0.669, 0.202, -1.14, -0.024, 0.527],
    [-0.459, -0.48, 0.185, 0.199, -0.519, -0.362, 0.235, -0.528, -0.159 * 2.0, 1.043, 0.653, 0.539],
]);

#[test]
fn a_cusp_next_to_a_resonance_is_found() {
    let branch = along_p(&CUSP_BESIDE_RESONANCE);
    let folds: Vec<_> = branch
        .special()
        .filter(|(kind, _)| *kind == SpecialKind::FoldOfCycles)
        .map(|(_, point)| point)
        .collect();
    // By Newton's method on the plane.
    let cusp = [0.2067155279, -0.1095549089];
    let curves = folds.into_iter().map(|fold| {
        CycleLocus::of(&CUSP_BESIDE_RESONANCE)
            .from_cycle(SpecialKind::FoldOfCycles, &fold.orbit, &[fold.value, 0.0])
            .along("p", -2.0..=2.0)
            .and("q", -2.0..=2.0)
            .run()
            .expect("exists")
    });
    let with_resonance = curves
        .filter(|curve| {
            found(curve)
                .iter()
                .any(|(kind, values)| *kind == SpecialKind::Resonance1 && (values[0] - cusp[0]).abs() < 1e-3)
        })
        .collect::<Vec<_>>();
    assert!(!with_resonance.is_empty());
    for curve in &with_resonance {
        assert_at(curve, SpecialKind::CuspOfCycles, cusp, 1e-8);
    }
}
