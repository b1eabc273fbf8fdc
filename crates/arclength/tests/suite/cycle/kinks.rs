//! Cycles of fields that are smooth only piece by piece, against return maps made of smooth pieces (SciPy's DOP853 at 1e-13 with
//! events, Newton's method on the return map) and against closed forms.

use arclength::branch::SpecialKind;
use arclength::cycle::{CycleBranch, CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::{Equilibria, HopfPoint};
use arclength::integration::{Integrator, autonomous};
use arclength::locus::CycleLocus;
use arclength::{Scalar, Threshold, VectorField};
use std::f64::consts::PI;

/// A field whose switches are signs: `|sides, state, parameters, result|` writes the derivative and then the switch functions.
macro_rules! switched {
    ($name:ident, $states:expr, $parameters:expr, $switches:expr, |$side:ident, $x:ident, $p:ident, $d:ident| $body:block) => {
        struct $name;
        impl $name {
            #[allow(clippy::many_single_char_names)]
            fn in_region<T: Scalar>($side: &[f64], $x: &[T], $p: &[T], $d: &mut [T]) {
                $body
            }
        }
        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                $states.iter().map(|name| name.to_string()).collect()
            }
            fn parameter_names(&self) -> Vec<String> {
                $parameters.iter().map(|name| name.to_string()).collect()
            }
            fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
                let (n, count) = ($states.len(), $parameters.len());
                let mut all = vec![T::zero(); n + $switches];
                let side = match p.get(count..count + $switches) {
                    Some(cells) => cells.iter().map(Scalar::value).collect(),
                    None => {
                        let mut side = vec![1.0; $switches];
                        for _ in 0..$switches {
                            Self::in_region(&side, x, p, &mut all);
                            side = all[n..]
                                .iter()
                                .map(|value| if value.value() < 0.0 { -1.0 } else { 1.0 })
                                .collect();
                        }
                        side
                    }
                };
                Self::in_region(&side, x, p, &mut all);
                let length = result.len();
                result.copy_from_slice(&all[..length]);
            }
            fn thresholds(&self) -> Vec<Threshold> {
                vec![Threshold::Zero; $switches]
            }
        }
    };
}

// `y' = m (1 - |x|) y - x`: the field has a kink.
switched!(VanDerPolWithKink, ["x", "y"], ["m"], 1, |side, x, p, d| {
    d[0] = x[1];
    d[1] = p[0] * (T::one() - x[0] * side[0]) * x[1] - x[0];
    d[2] = x[0];
});

// An oscillator that a relay drives: the field jumps at `y = -0.1`.
switched!(Relay, ["x", "y"], ["m"], 1, |side, x, p, d| {
    d[0] = x[1];
    d[1] = -x[0] - x[1] * 0.2 + p[0] * (0.5 + 0.5 * side[0]);
    d[2] = x[1] + 0.1;
});

// Somieski's nose gear (1997): torsion angle, its rate, lateral deflection of the tyre, whose force and moment saturate.
switched!(NoseGear, ["psi", "omega", "y"], ["V", "k"], 3, |side, x, p, d| {
    let degree = PI / 180.0;
    let (c, e, a, load, sigma) = (-1e5, 0.1, 0.1, 9000.0, 0.3);
    let (force_limit, moment_limit) = (5.0 * degree, 10.0 * degree);
    let slip = (x[2] / sigma).atan();
    let magnitude = slip * side[0];
    let force = if side[1] < 0.0 { slip } else { T::from(force_limit * side[0]) } * (20.0 * load);
    let moment = if side[2] < 0.0 {
        (slip * (PI / moment_limit)).sin() * (-2.0 * load * moment_limit / PI)
    } else {
        T::zero()
    };
    d[0] = x[1];
    d[1] = x[0] * c + p[1] * x[1] + moment - force * e + x[1] * -270.0 / p[0];
    d[2] = p[0] * x[0] + x[1] * (e - a) - p[0] / sigma * x[2];
    d[3] = slip;
    d[4] = magnitude - force_limit;
    d[5] = magnitude - moment_limit;
});

fn along<F: VectorField>(
    field: &F,
    start: CycleStart,
    value: f64,
    name: &str,
    range: [f64; 2],
    at: &[f64],
) -> CycleBranch {
    let parameters: Vec<f64> =
        field.parameter_names().iter().map(|known| if known == name { value } else { 0.0 }).collect();
    Cycles::of(field, start).parameters(&parameters).along(name, range[0]..=range[1]).at(at).run().unwrap()
}

fn settled<F: VectorField>(field: &F, parameters: &[f64], initial: &[f64], longest: f64) -> CycleStart {
    CycleStart::Orbit(Orbit::from_time_history(field, parameters, initial, longest).unwrap())
}

/// Period and extremes of the first state within three times the error that is told, and the multiplier farthest from one.
#[track_caller]
fn check(point: &CyclePoint, period: f64, max: f64, min: f64, multiplier: f64) {
    let allowed = (3.0 * point.error_estimate).max(1e-9);
    assert!(point.error_estimate < 1e-8, "error {:e}", point.error_estimate);
    assert!((point.period / period - 1.0).abs() < allowed, "period {} instead of {period}", point.period);
    assert!((point.max[0] - max).abs() < allowed * (max - min), "max {} instead of {max}", point.max[0]);
    assert!((point.min[0] - min).abs() < allowed * (max - min), "min {} instead of {min}", point.min[0]);
    let farthest =
        point.multipliers.iter().max_by(|a, b| (**a - 1.0).norm().total_cmp(&(**b - 1.0).norm())).unwrap();
    assert!(
        (farthest.re - multiplier).abs() < 1e-6 * multiplier.abs().max(1e-2),
        "multiplier {farthest} instead of {multiplier}"
    );
    assert_eq!(point.stable, Some(multiplier.abs() < 1.0));
}

fn at(branch: &CycleBranch, value: f64) -> &CyclePoint {
    let found = branch.points.iter().find(|point| point.value == value);
    found.unwrap_or_else(|| panic!("no cycle at {value}: {:?}", branch.stops))
}

#[test]
fn a_kink() {
    let start = settled(&VanDerPolWithKink, &[1.0], &[2.362, 0.0], 20.0);
    let branch = along(&VanDerPolWithKink, start, 1.0, "m", [0.3, 6.0], &[0.3, 0.5, 1.0, 2.0, 4.0, 6.0]);
    for (m, max, period, multiplier) in [
        (0.3, 2.356740701384909, 6.296180004763841, 0.3883343513627832),
        (0.5, 2.357703762573947, 6.319264073294581, 0.20461903438778706),
        (1.0, 2.362078437564076, 6.427085678657411, 0.038057786132448077),
        (2.0, 2.377167269532259, 6.847531630305399, 0.0006719272629698462),
        (4.0, 2.4078523809987247, 8.271674417925418, 1.862818952123301e-09),
        (6.0, 2.4217327532295925, 10.027060738850901, 0.0),
    ] {
        check(at(&branch, m), period, max, -max, multiplier);
    }
    assert!(branch.unlocated.is_empty());
}

#[test]
fn a_jump() {
    let start = settled(&Relay, &[1.0], &[3.69, 0.0], 20.0);
    let branch = along(&Relay, start, 1.0, "m", [0.5, 2.0], &[0.5, 0.7, 1.0, 1.5, 2.0]);
    for (m, period, max, min, multiplier) in [
        (0.5, 6.3153588718686, 1.8439909056078503, -1.3429829310209136, 0.5331889187720762),
        (0.7, 6.315103224115957, 2.5834525592325983, -1.882733933314586, 0.5325061453342883),
        (1.0, 6.314968143512116, 3.692057825015984, -2.691555203270932, 0.5321461692631146),
        (1.5, 6.314896247796387, 5.539215147804485, -4.038880167316093, 0.5319547949689252),
        (2.0, 6.314871118039282, 7.386146529650458, -5.38589530365707, 0.5318879424009992),
    ] {
        check(at(&branch, m), period, max, min, multiplier);
    }
}

/// The cycles of the nose gear that are born at a Hopf point.
fn born(hopf: &HopfPoint, damping: f64, range: [f64; 2], at: &[f64]) -> CycleBranch {
    let cycles = Cycles::of(&NoseGear, CycleStart::from(hopf)).parameters(&[hopf.value, damping]);
    cycles.along("V", range[0]..=range[1]).at(at).run().unwrap()
}

#[test]
fn kinks_that_a_growing_cycle_reaches() {
    for range in [[5.0, 300.0], [10.0, 250.0], [15.0, 220.0]] {
        let equilibria = Equilibria::of(&NoseGear)
            .parameters(&[20.0, -10.0])
            .along("V", range[0]..=range[1])
            .run()
            .unwrap();
        let hopf = equilibria.hopf_points().next().unwrap();
        assert!((hopf.value - 20.511049179).abs() < 1e-8);
        let branch = born(hopf, -10.0, range, &[200.0]);
        let cycle = at(&branch, 200.0);
        assert!((cycle.max[0] - 0.263626087).abs() < 1e-9, "{}", cycle.max[0]);
        assert!(cycle.error_estimate < 1e-9);
    }
}

#[test]
fn the_nose_gear_without_damper() {
    let equilibria =
        Equilibria::of(&NoseGear).parameters(&[10.0, 0.0]).along("V", 1.0..=100.0).run().unwrap();
    let hopf = equilibria.hopf_points().next().unwrap();
    assert!((hopf.value - 15.259297292).abs() < 1e-8);
    let branch = born(hopf, 0.0, [1.0, 100.0], &[100.0]);
    let cycle = at(&branch, 100.0);
    assert!((cycle.max[0] / 1.6155481564 - 1.0).abs() < 1e-9, "{}", cycle.max[0]);
    assert!((cycle.period / 0.0197804150 - 1.0).abs() < 1e-8, "{}", cycle.period);
}

// An oscillator whose damping has another slope beyond `|y| = 1`, 2 and 3.
switched!(PiecewiseDamping, ["x", "y"], ["m"], 4, |side, x, p, d| {
    let magnitude = x[1] * side[0];
    let beyond = |index: usize, limit: f64| {
        if side[index] > 0.0 { magnitude - limit } else { T::zero() }
    };
    let (first, second, third) = (beyond(1, 1.0), beyond(2, 2.0), beyond(3, 3.0));
    let force = p[0] * (magnitude - first) - (first - second) + (second - third) * 0.5 - third * 2.0;
    d[0] = x[1];
    d[1] = force * side[0] - x[0];
    d[2] = x[1];
    d[3] = magnitude - 1.0;
    d[4] = magnitude - 2.0;
    d[5] = magnitude - 3.0;
});

#[test]
fn folds_of_cycles_with_kinks() {
    let start = settled(&PiecewiseDamping, &[1.0], &[-3.68, 0.0], 10.0);
    let branch = along(&PiecewiseDamping, start, 1.0, "m", [0.1, 1.5], &[0.3]);
    let folds: Vec<&CyclePoint> =
        branch.points.iter().filter(|point| is_kind(point, SpecialKind::FoldOfCycles)).collect();
    // By Newton's method on the half return map, DOP853 at 3e-14.
    let expected = [(0.704858270074, 6.411620085), (0.610747470128, 6.329491140)];
    let found: Vec<f64> = folds.iter().map(|fold| fold.value).collect();
    assert_eq!(folds.len(), 2, "{found:?} {:?}", branch.unlocated);
    for (fold, (m, period)) in folds.iter().zip(expected) {
        assert!((fold.value - m).abs() < 1e-8, "{} instead of {m}", fold.value);
        assert!((fold.period - period).abs() < 1e-5);
    }
    // Amplitudes for which m is known.
    let small = at(&branch, 0.3);
    let known = [(0.26042536063904675, 1.5), (0.3240505858733326, 1.6)];
    assert!((known[0].1..known[1].1).contains(&small.max[0]) && small.stable == Some(true));
    assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
}

// `x''' = -a x'' - x' + m (|x| - 1)`.
switched!(JerkWithKink, ["x", "y", "z"], ["m", "a"], 1, |side, x, p, d| {
    d[0] = x[1];
    d[1] = x[2];
    d[2] = -p[1] * x[2] - x[1] + p[0] * (x[0] * side[0] - 1.0);
    d[3] = x[0];
});

/// Period doubling of the cycle at `a = 0.7`, by matrix exponentials of the two pieces: parameter and period.
const DOUBLING: (f64, f64) = (0.967_612_1, 6.334096665252388);

fn doubling_of_jerk() -> (CycleBranch, usize) {
    let parameters = [0.95, 0.7];
    let start = settled(&JerkWithKink, &parameters, &[0.0, 1.10230513, -0.94947711], 8.0);
    let cycles = Cycles::of(&JerkWithKink, start).parameters(&parameters);
    let branch = cycles.along("m", 0.8..=1.05).at(&[0.95]).run().unwrap();
    let doubling =
        branch.points.iter().position(|point| is_kind(point, SpecialKind::PeriodDoubling)).unwrap();
    (branch, doubling)
}

#[test]
fn a_period_doubling_with_kinks() {
    let (branch, doubling) = doubling_of_jerk();
    let cycle = at(&branch, 0.95);
    assert!((cycle.period - 6.328551041467042).abs() < 1e-8);
    assert!((cycle.multipliers[1].re + 0.92207504).abs() < 1e-7, "{:?}", cycle.multipliers);
    let doubling = &branch.points[doubling];
    assert!((doubling.value - DOUBLING.0).abs() < 1e-7 && (doubling.period - DOUBLING.1).abs() < 1e-7);
    // What kinks do to the coefficient is not computed.
    assert!(doubling.normal_form.is_empty());
    // The doubled cycles.
    let doubled = doubling.doubled(&JerkWithKink).unwrap().along("m", 0.8..=1.0).run().unwrap();
    let last = doubled.points.last().unwrap();
    assert!(
        (last.value - 1.0).abs() < 1e-12 && (last.period - 2.0 * DOUBLING.1).abs() < 0.5,
        "{:?}",
        doubled.stops
    );
}

#[test]
fn a_curve_of_period_doublings_with_kinks() {
    let (branch, doubling) = doubling_of_jerk();
    let point = &branch.points[doubling];
    let curve = CycleLocus::of(&JerkWithKink)
        .from_cycle(SpecialKind::PeriodDoubling, &point.orbit, &[point.value, 0.7])
        .along("m", 0.8..=1.1)
        .and("a", 0.65..=0.75)
        .run()
        .unwrap();
    let at = curve
        .points
        .iter()
        .min_by(|a, b| (a.values[1] - 0.7).abs().total_cmp(&(b.values[1] - 0.7).abs()))
        .unwrap();
    assert!((at.values[0] - DOUBLING.0).abs() < 1e-6 + 3.0 * (at.values[1] - 0.7).abs());
    assert!(curve.points.len() > 3);
}

fn is_kind(point: &CyclePoint, kind: SpecialKind) -> bool {
    point.label.is_some_and(|label| label.kind == kind)
}

// A mass between two springs of different stiffness, driven by a rotation: `x' = v`, `v' = -v/10 - (1 or 4) x + p`.
switched!(BilinearOscillator, ["x", "v", "p", "q"], ["w"], 1, |side, x, p, d| {
    let stiffness = if side[0] < 0.0 { 1.0 } else { 4.0 };
    let growth = T::one() - x[2] * x[2] - x[3] * x[3];
    d[0] = x[1];
    d[1] = x[1] * -0.1 - x[0] * stiffness + x[2];
    d[2] = x[2] * growth - p[0] * x[3];
    d[3] = x[3] * growth + p[0] * x[2];
    d[4] = x[0];
});

#[test]
fn a_motion_that_comes_nearer_after_two_turns_is_on_a_cycle_of_one() {
    // A multiplier is -0.956: after one turn the motion is on the other side of the cycle.
    let parameters = [0.9];
    let integrator = Integrator::with_tolerance(1e-10);
    let start = [0.1, 0.0, 1.0, 0.0];
    let state =
        integrator.integrate(autonomous(&BilinearOscillator, &parameters), 0.0, &start, 200.0).unwrap().state;
    let longest = 3.0 * 2.0 * PI / 0.9;
    let history = Orbit::from_time_history(&BilinearOscillator, &parameters, &state, longest).unwrap();
    assert!(
        (history.period / (2.0 * PI / 0.9) - 2.0).abs() < 1e-3,
        "the start is no longer one of two turns"
    );
    let branch = along(&BilinearOscillator, CycleStart::Orbit(history), 0.9, "w", [0.89, 0.92], &[0.9]);
    for point in &branch.points {
        assert!((point.period * point.value - 2.0 * PI).abs() < 1e-8, "{} at {}", point.period, point.value);
    }
    let doublings: Vec<f64> = branch
        .special()
        .filter(|(kind, _)| *kind == SpecialKind::PeriodDoubling)
        .map(|(_, point)| point.value)
        .collect();
    assert_eq!(doublings.len(), 1, "{doublings:?}");
    // Matrix exponentials of both pieces, Newton's method on the times of crossing.
    assert!((doublings[0] - 0.895_601_756_65).abs() < 1e-8, "{doublings:?}");
}
