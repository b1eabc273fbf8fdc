//! Curves of cycles on which a quantity keeps its value, against closed forms.

use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleStart, Cycles, Orbit};
use arclength::locus::{CycleLocus, Held};
use arclength::{Error, Scalar, VectorField};
use std::f64::consts::TAU;

/// Circles of radius s with a + b s^2 - s^4 = 0 and the angular frequency 1 + c s^2, and beside them a direction with the
/// growth rate a - 1/4.
struct Circles;

impl VectorField for Circles {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["a", "b", "c"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let square = s[0] * s[0] + s[1] * s[1];
        let growth = p[0] + p[1] * square - square * square;
        let frequency = p[2] * square + 1.0;
        d[0] = growth * s[0] - frequency * s[1];
        d[1] = frequency * s[0] + growth * s[1];
        d[2] = (p[0] - 0.25) * s[2];
    }
}

/// The cycle of radius s where b = 0, so that a = s^4.
fn circle(radius: f64, c: f64) -> (Orbit, Vec<f64>) {
    let period = TAU / (1.0 + c * radius * radius);
    let orbit = Orbit::from_function(period, |time| {
        let angle = TAU * time / period;
        vec![radius * angle.cos(), radius * angle.sin(), 0.0]
    });
    (orbit, vec![radius.powi(4), 0.0, c])
}

fn largest() -> Held {
    Held::new("max(x)", |orbit, _| Some(orbit.maximum(|state| state[0])))
}

#[test]
fn a_largest_value_is_kept() {
    let (orbit, parameters) = circle(0.8, 0.0);
    let curve = CycleLocus::of(&Circles)
        .from_held_cycle(largest(), &orbit, &parameters)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=2.0)
        .at(&[0.0])
        .run()
        .unwrap();
    assert!(curve.stops.iter().all(|stop| matches!(stop, Some(Stop::RangeEnd { .. }))), "{:?}", curve.stops);
    for point in &curve.points {
        let [a, b] = point.values;
        assert!((a + b * 0.64 - 0.8_f64.powi(4)).abs() < 1e-9, "{a} {b}");
        assert!((point.max[0] - 0.8).abs() < 1e-9);
    }
    // The direction beside the circles becomes unstable at a = 1/4, the circles at a = -s^4, where they fold.
    let folds: Vec<f64> = curve.of_kind(SpecialKind::FoldOfCycles).map(|point| point.values[0]).collect();
    let expected = [-(0.8_f64.powi(4)), 0.25];
    assert!(folds.len() == 2, "{folds:?}");
    let mut sorted = folds.clone();
    sorted.sort_by(f64::total_cmp);
    assert!(sorted.iter().zip(expected).all(|(found, value)| (found - value).abs() < 1e-8), "{folds:?}");
    assert!(curve.points.iter().any(|point| point.values[0] == 0.0));
}

#[test]
fn a_period_is_reached_and_kept() {
    let (orbit, parameters) = circle(0.7, 0.5);
    let period = Held::new("period", |orbit, _| Some(orbit.period)).at(5.0);
    let curve = CycleLocus::of(&Circles)
        .from_held_cycle(period, &orbit, &parameters)
        .along("a", 0.01..=1.0)
        .and("c", 0.01..=4.0)
        .run()
        .unwrap();
    assert!(curve.points.len() > 10);
    for point in &curve.points {
        let [a, c] = point.values;
        assert!((point.period - 5.0).abs() < 1e-12, "{}", point.period);
        assert!((1.0 + c * a.sqrt() - TAU / 5.0).abs() < 1e-9, "{a} {c}");
    }
}

/// Along a curve of large period the homoclinic orbits of the Bogdanov-Takens normal form: the branches of cycles at single values
/// of the second parameter reach the same period at the same place.
#[test]
fn a_large_period_follows_homoclinic_orbits() {
    struct BogdanovTakens;
    impl VectorField for BogdanovTakens {
        fn state_names(&self) -> Vec<String> {
            ["x", "y"].map(String::from).to_vec()
        }
        fn parameter_names(&self) -> Vec<String> {
            ["beta1", "beta2"].map(String::from).to_vec()
        }
        fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
            d[0] = s[1];
            d[1] = p[0] + p[1] * s[0] + s[0] * s[0] - s[0] * s[1];
        }
    }
    use arclength::branch::Monitor;
    use arclength::equilibrium::Equilibria;
    let until = |second: f64| {
        let equilibria = Equilibria::of(&BogdanovTakens)
            .start(&[-1.0, 0.0])
            .parameters(&[-0.3, second])
            .along("beta1", -1.0..=0.2)
            .run()
            .unwrap();
        let hopf = equilibria.hopf_points().next().unwrap().clone();
        let cycles = Cycles::of(&BogdanovTakens, CycleStart::from(&hopf))
            .parameters(&hopf.parameters)
            .along("beta1", -1.0..=0.2)
            .monitor(
                Monitor::new("period", |cycle: &arclength::cycle::CyclePoint| Some(cycle.period))
                    .until(&[30.0]),
            )
            .run()
            .unwrap();
        cycles.points.last().unwrap().clone()
    };
    let start = until(-1.0);
    assert!((start.period - 30.0).abs() < 1e-9);
    let curve = CycleLocus::of(&BogdanovTakens)
        .from_held_cycle(
            Held::new("period", |orbit, _| Some(orbit.period)),
            &start.orbit,
            &[start.value, -1.0],
        )
        .along("beta1", -1.0..=0.2)
        .and("beta2", -1.5..=-0.7)
        .run()
        .unwrap();
    assert!(curve.points.len() > 10);
    for end in [curve.points.first().unwrap(), curve.points.last().unwrap()] {
        let there = until(end.values[1]);
        assert!((there.value - end.values[0]).abs() < 1e-7, "{} {:?}", there.value, end.values);
    }
}

#[test]
fn a_quantity_without_a_value_is_refused() {
    let (orbit, parameters) = circle(0.7, 0.5);
    let nothing = Held::new("nothing", |_, _| None);
    let error = CycleLocus::of(&Circles)
        .from_held_cycle(nothing, &orbit, &parameters)
        .along("a", 0.01..=1.0)
        .and("c", 0.01..=4.0)
        .run()
        .unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
}

/// A monitor of the whole orbit sees every cycle on its own mesh, also where the next one needs a finer mesh.
#[test]
fn a_monitor_of_the_orbit_is_right_where_meshes_change() {
    use arclength::branch::Monitor;
    use arclength::cycle::CyclePoint;
    /// Van der Pol's equation: the slope reaches 1.6 beside mu = 0 and grows with mu.
    struct VanDerPol;
    impl VectorField for VanDerPol {
        fn state_names(&self) -> Vec<String> {
            ["x", "y"].map(String::from).to_vec()
        }
        fn parameter_names(&self) -> Vec<String> {
            vec!["mu".to_owned()]
        }
        fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
            d[0] = s[1];
            d[1] = p[0] * (-(s[0] * s[0]) + 1.0) * s[1] - s[0];
        }
    }
    let times: Vec<f64> = (0..=100).map(|index| TAU * f64::from(index) / 100.0).collect();
    let states: Vec<Vec<f64>> = times.iter().map(|time| vec![2.0 * time.cos(), -2.0 * time.sin()]).collect();
    let circle = Orbit::from_samples(&times, &states).unwrap();
    let largest = |cycle: &CyclePoint| Some(cycle.orbit.range_of(|state| state[1])[1]);
    let follow = |orbit: &Orbit, mu: f64, until: f64| {
        let branch = Cycles::of(&VanDerPol, CycleStart::Orbit(orbit.clone()))
            .parameters(&[mu])
            .along("mu", 0.1..=50.0)
            .monitor(Monitor::new("largest slope", largest).until(&[until]))
            .run()
            .unwrap();
        let meshes: Vec<usize> = branch.points.iter().map(|cycle| cycle.orbit.mesh.len()).collect();
        assert!(meshes.iter().max() > meshes.iter().min(), "{meshes:?}");
        for cycle in &branch.points {
            assert!((cycle.monitors[0] - cycle.max[1]).abs() < 1e-9 * cycle.max[1]);
        }
        branch
    };
    // To finer meshes, and back to coarser ones.
    let there = follow(&circle, 0.1, 15.0).points.last().unwrap().clone();
    assert!((there.max[1] - 15.0).abs() < 1e-7);
    let back = follow(&there.orbit, there.value, 3.0).points.first().unwrap().clone();
    assert!((back.max[1] - 3.0).abs() < 1e-7);
}
