//! Normal forms of special cycles against systems whose normal form is known.

use crate::common::{Lure, hopf_start};
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::cycle::{CycleBranch, CyclePoint, CycleStart, Cycles, Orbit};
use arclength::{Scalar, VectorField};

macro_rules! names {
    ($($name:literal),*) => { vec![$($name.into()),*] };
}

/// Amplitude `r' = r (rho + r^2 - r^4)` with the angular velocity `1 + shear r^2`: a fold of cycles at `rho = -1/4`,
/// `r^2 = 1/2`.
struct ShearedFold;

impl VectorField for ShearedFold {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["rho", "shear"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let ([x, y], [rho, shear]) = ([state[0], state[1]], [parameters[0], parameters[1]]);
        let square = x * x + y * y;
        let (growth, speed) = (rho + square - square * square, shear * square + 1.0);
        derivative[0] = growth * x - speed * y;
        derivative[1] = growth * y + speed * x;
    }
}

fn special(branch: &CycleBranch, sought: impl Fn(SpecialKind) -> bool) -> &CyclePoint {
    branch.special().find(|(special, _)| sought(*special)).expect("a special cycle").1
}

fn coefficient(point: &CyclePoint, name: &str) -> f64 {
    point.normal_form.iter().find(|(candidate, _)| *candidate == name).expect("a coefficient").1
}

/// That a coefficient is what it is to be, within three times the error that is told with it.
fn holds_within_its_error(point: &CyclePoint, name: &str, exact: f64) {
    let error = coefficient(point, &format!("{name}_error"));
    let off = (coefficient(point, name) - exact).abs();
    assert!(error < 1e-4 * exact.abs().max(1e-3), "{name}: told error {error}");
    assert!(off <= (3.0 * error).max(1e-9 * exact.abs()), "{name}: off by {off}, told error {error}");
}

#[test]
fn fold_of_a_sheared_rotation() {
    for shear in [0.3, -0.2] {
        let start = hopf_start(&ShearedFold, &[0.0, 0.0], &[0.0, shear]);
        let branch = Cycles::of(&ShearedFold, start)
            .parameters(&[0.0, shear])
            .along("rho", -1.0..=0.5)
            .run()
            .expect("exists");
        let fold = special(&branch, |special| special == SpecialKind::FoldOfCycles);
        assert_relative_eq!(fold.value, -0.25, max_relative = 1e-9);
        // r'' = 3 * 2 r - 20 r^3 at r^2 = 1/2, and d tau/dt = speed(r) / speed(r0).
        let r = 0.5_f64.sqrt();
        let curvature = 6.0 * r - 20.0 * r.powi(3);
        let exact = 0.5 * curvature * (1.0 + shear * r * r) / (2.0 * shear * r);
        assert_relative_eq!(coefficient(fold, "quadratic_coefficient"), exact, max_relative = 1e-6);
        holds_within_its_error(fold, "quadratic_coefficient", exact);
    }
}

/// A cycle of radius one that attracts, with a plane `w = r - 1 + i z` that turns half round per revolution: in the turning
/// frame `xi' = mu xi + c xi^3`, `eta' = -eta`, and `phi' = 1 + s xi^2`.
struct Moebius;

impl VectorField for Moebius {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "z"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "c", "s"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y, z] = [state[0], state[1], state[2]];
        let [mu, c, s] = [parameters[0], parameters[1], parameters[2]];
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = (x / r, y / r);
        let a = r - 1.0;
        // P = (w + conj(w) e^(i phi)) / 2 is xi times e^(i phi / 2), Q = w - P the same for i eta.
        let p = [(a + a * cos + z * sin) * 0.5, (z + a * sin - z * cos) * 0.5];
        let q = [a - p[0], z - p[1]];
        let square = p[0] * p[0] + p[1] * p[1];
        let speed = s * square + 1.0;
        let along = mu + c * square;
        let radial = along * p[0] - q[0] - speed * z * 0.5;
        let vertical = along * p[1] - q[1] + speed * a * 0.5;
        derivative[0] = radial * cos - speed * y;
        derivative[1] = radial * sin + speed * x;
        derivative[2] = vertical;
    }
}

#[test]
fn doubling_of_a_moebius_band() {
    for (c, s) in [(-0.7, 0.4), (0.5, -0.3)] {
        let parameters = [-0.2, c, s];
        let orbit = Orbit::from_time_history(&Moebius, &parameters, &[1.0, 0.0, 0.0], 7.0).expect("a cycle");
        let branch = Cycles::of(&Moebius, CycleStart::Orbit(orbit))
            .parameters(&parameters)
            .along("mu", -0.5..=0.5)
            .run()
            .expect("exists");
        let doubling = special(&branch, |special| special == SpecialKind::PeriodDoubling);
        assert!(doubling.value.abs() < 1e-9, "{}", doubling.value);
        assert_relative_eq!(coefficient(doubling, "cubic_coefficient"), c, max_relative = 1e-6);
        holds_within_its_error(doubling, "cubic_coefficient", c);
        // Both directions across the cycle turn half round; the other one dies out at the rate 1.
        let exact = [1.0, -1.0, -(-std::f64::consts::TAU).exp()];
        assert_eq!(doubling.multiplier_errors.len(), exact.len());
        for (multiplier, error) in doubling.multipliers.iter().zip(&doubling.multiplier_errors) {
            let off = exact.map(|exact| (multiplier / exact - 1.0).norm()).into_iter().fold(1.0, f64::min);
            assert!(
                off <= (3.0 * error).max(1e-9) && *error < 1e-4,
                "{multiplier}: off by {off:e}, told {error:e}"
            );
        }
        // The doubled cycles have xi^2 = -mu / c and the period 4 pi / (1 + s xi^2).
        let mu = -0.1 * c.signum();
        let doubled = doubling
            .doubled(&Moebius)
            .expect("a branch")
            .along("mu", -0.5..=0.5)
            .at(&[mu])
            .run()
            .expect("exists");
        let point = doubled.points.iter().find(|point| point.value == mu).expect("asked for");
        let period = 4.0 * std::f64::consts::PI / (1.0 - s * mu / c);
        assert_relative_eq!(point.period, period, max_relative = 1e-8);
        assert_eq!(point.stable, Some(c < 0.0));
    }
}

#[test]
fn doubling_of_the_lure_system_agrees_with_its_branches() {
    // Near the doubling xi' = lambda xi + c xi^3: the doubled cycles have xi^2 = -lambda / c, where lambda is the logarithm
    // of the single cycle's multiplier over its period.
    let values = [0.624, 0.627];
    let start = hopf_start(&Lure, &[0.0; 3], &[1.0, 1.0]);
    let branch = Cycles::of(&Lure, start)
        .parameters(&[1.0, 1.0])
        .along("alpha", -1.1..=1.1)
        .at(&values)
        .run()
        .expect("exists");
    let doubling = special(&branch, |special| special == SpecialKind::PeriodDoubling);
    let doubled = doubling
        .doubled(&Lure)
        .expect("a branch")
        .along("alpha", 0.5..=0.7)
        .at(&values)
        .run()
        .expect("exists");
    let ratio = |value: f64| {
        let at = |branch: &CycleBranch| {
            branch.points.iter().find(|point| point.value == value).expect("asked for").clone()
        };
        let (single, cycle) = (at(&branch), at(&doubled));
        let critical = single.multipliers.iter().map(|value| value.re).fold(0.0, f64::min);
        let rate = (-critical).ln() / single.period;
        // Mean square of half the difference of two points half a period apart.
        let samples = cycle.orbit.sample(512);
        let square: f64 = (0..256)
            .map(|index| {
                let (one, other) = (&samples[index].1, &samples[index + 256].1);
                one.iter().zip(other).map(|(a, b)| (0.5 * (a - b)).powi(2)).sum::<f64>()
            })
            .sum::<f64>()
            / 256.0;
        -rate / square
    };
    let [far, near] = values.map(|value| (value - doubling.value, ratio(value)));
    let extrapolated = near.1 - near.0 * (far.1 - near.1) / (far.0 - near.0);
    assert_relative_eq!(coefficient(doubling, "cubic_coefficient"), extrapolated, max_relative = 2e-3);
}

/// A cycle of radius one with an oscillator `w' = (mu + i 0.3) w + (g + i h) |w|^2 w + k (r - 1) w`, where `r' = r (1 - r^2)
/// + e |w|^2` and `phi' = 1 + m |w|^2`.
struct TwoOscillators;

const OSCILLATORS: [f64; 5] = [-0.4, 0.15, 0.9, 0.5, 0.2];

impl VectorField for TwoOscillators {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "p", "q"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [g, h, k, e, m] = OSCILLATORS;
        let [x, y] = [state[0], state[1]];
        // Seen in sheared coordinates, so that nothing decouples by chance.
        let (u, v) = (state[2] - x * 0.3, state[3] - x * y * 0.2);
        let r = (x * x + y * y).sqrt();
        let square = u * u + v * v;
        let growth = -(r * r) + 1.0 + square / r * e;
        let speed = square * m + 1.0;
        let (dx, dy) = (growth * x - speed * y, growth * y + speed * x);
        let (real, imaginary) = (parameters[0] + square * g + (r - 1.0) * k, square * h + 0.3);
        let (du, dv) = (real * u - imaginary * v, real * v + imaginary * u);
        derivative[0] = dx;
        derivative[1] = dy;
        derivative[2] = du + dx * 0.3;
        derivative[3] = dv + (dx * y + dy * x) * 0.2;
    }
}

#[test]
fn torus_of_two_oscillators() {
    let orbit =
        Orbit::from_time_history(&TwoOscillators, &[-0.1], &[1.0, 0.0, 0.3, 0.0], 7.0).expect("a cycle");
    let branch = Cycles::of(&TwoOscillators, CycleStart::Orbit(orbit))
        .parameters(&[-0.1])
        .along("mu", -0.3..=0.3)
        .run()
        .expect("exists");
    let torus = special(&branch, |special| special == SpecialKind::Torus);
    assert!(torus.value.abs() < 1e-9);
    let angle = 2.0 * std::f64::consts::PI * 0.3;
    assert_relative_eq!(coefficient(torus, "argument"), angle, max_relative = 1e-9);
    holds_within_its_error(torus, "argument", angle);
    // The radius follows slowly: (r - 1) = e |w|^2 / 2. The eigenfunction of unit size makes |w|^2 = 2 |xi|^2.
    let [g, h, k, e, _] = OSCILLATORS;
    assert_relative_eq!(
        coefficient(torus, "cubic_coefficient"),
        2.0 * (g + 0.5 * k * e),
        max_relative = 1e-6
    );
    assert_relative_eq!(coefficient(torus, "cubic_coefficient_imaginary"), 2.0 * h, max_relative = 1e-6);
}

/// Cycles in the plane `z = 0` with the symmetry `z -> -z` that they lose at `mu = 0`: `z' = mu z - z^3 + q z^2`.
struct Symmetric;

impl VectorField for Symmetric {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "z"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "q"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y, z] = [state[0], state[1], state[2]];
        let growth = -(x * x + y * y) + 1.0;
        derivative[0] = growth * x - y * (z * 0.1 + 1.0);
        derivative[1] = growth * y + x * (z * 0.1 + 1.0);
        derivative[2] = parameters[0] * z - z * z * z + parameters[1] * z * z;
    }
}

#[test]
fn branch_points_and_the_other_branch() {
    // A pitchfork with q = 0, a transcritical crossing otherwise: the other branch has mu = z^2 - q z.
    for q in [0.0, 0.8] {
        let parameters = [-0.2, q];
        let orbit =
            Orbit::from_time_history(&Symmetric, &parameters, &[1.0, 0.0, 0.0], 7.0).expect("a cycle");
        let branch = Cycles::of(&Symmetric, CycleStart::Orbit(orbit))
            .parameters(&parameters)
            .along("mu", -0.5..=0.5)
            .run()
            .expect("exists");
        let point = special(&branch, |special| special == SpecialKind::BranchPointOfCycles);
        assert!(point.value.abs() < 1e-9, "{}", point.value);
        let other = point.other(&Symmetric).expect("a branch").along("mu", -0.5..=0.5).run().expect("exists");
        let heights: Vec<f64> = other.points.iter().map(|point| point.max[2]).collect();
        assert!(heights.iter().any(|&z| z > 0.1) && heights.iter().any(|&z| z < -0.1), "{heights:?}");
        for point in &other.points {
            let z = point.max[2];
            assert!((point.value - z * z + q * z).abs() < 1e-7, "{} {z}", point.value);
        }
    }
}
