//! Cycles from Hopf points at which the growth rate hardly depends on the parameter.

use arclength::continuation::Settings;
use arclength::cycle::{CycleBranch, CycleStart, Cycles};
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};

/// The towed wheel of the project's theory on a circle, with springs of different stiffness: r, l, k_u, k_q.
struct Wheel([f64; 4]);

impl VectorField for Wheel {
    fn state_names(&self) -> Vec<String> {
        ["u", "q", "psi", "V", "Omega"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["v".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], out: &mut [T]) {
        let [r, l, k_u, k_q] = self.0;
        let (m_w, m_c, inertia_spin, inertia_wheel, inertia_caster) =
            (0.3519, 0.0668, 4.63e-5, 2.38e-5, 3.48e-6);
        let d = l - 0.012;
        let mass = m_w + m_c + inertia_spin / (0.04 * 0.04);
        let inertia = inertia_caster + inertia_wheel + m_c * d * d;
        let m = m_c * d;
        let (u, q, psi, forward, yaw) = (x[0], x[1], x[2], x[3], x[4]);
        let v = p[0];
        let omega = v / r;
        let (sine, cosine) = psi.sin_cos();
        out[0] = forward * cosine + yaw * sine * l - v + omega * q;
        out[1] = yaw * cosine * l - forward * sine - omega * u;
        out[2] = omega - yaw;
        out[3] = (yaw * yaw * m - (u * cosine * k_u - q * sine * k_q)) / mass;
        out[4] = (-(forward * yaw * m) - (u * sine * k_u + q * cosine * k_q) * l) / inertia;
    }
}

/// The branch of cycles from the one Hopf point of a wheel between v = 0.05 and 100 m/s, its first steps.
fn cycles(wheel: &Wheel, hopf: f64, at: &[f64]) -> CycleBranch {
    let [r, l, ..] = wheel.0;
    let v = 0.2;
    let start = [0.0, 0.0, (l / r).asin(), v, v / r];
    let branch = Equilibria::of(wheel).start(&start).parameters(&[v]).along("v", 0.05..=100.0).run().unwrap();
    let points: Vec<_> = branch.hopf_points().collect();
    assert!(points.iter().any(|point| (point.value - hopf).abs() < 1e-7), "{points:?}");
    Cycles::of(wheel, CycleStart::from(points[0]))
        .parameters(&[points[0].value])
        .along("v", 0.05..=100.0)
        .at(at)
        .settings(Settings::default().most_steps(30))
        .run()
        .unwrap()
}

/// Periods and multipliers by single shooting with DOP853 to 2e-14, the multipliers by differences to
/// 1e-7.
#[test]
fn cycles_start_where_the_growth_rate_hardly_depends_on_the_parameter() {
    let known = [
        (1.4796759107198358, 0.9396492380506212, 1.00003162),
        (5.036665654976483, 0.9390273226465601, 1.00199718),
    ];
    let branch = cycles(&Wheel([10.0, 0.3, 20.0, 1000.0]), 0.13225843, &known.map(|(value, ..)| value));
    for (value, period, multiplier) in known {
        let cycle = branch.points.iter().find(|cycle| cycle.value == value).expect("a cycle there");
        assert!((cycle.period / period - 1.0).abs() < 3e-9, "{} {period}", cycle.period);
        let largest = cycle.multipliers.iter().map(|multiplier| multiplier.norm()).fold(0.0, f64::max);
        assert!((largest - multiplier).abs() < 2e-7, "{largest} {multiplier}");
    }
}

/// The first order alone led Newton's method to v = 0, where nothing moves.
#[test]
fn a_first_cycle_far_from_its_hopf_point_is_none() {
    let branch = cycles(&Wheel([5.0, 0.4, 20.0, 2000.0]), 0.15741389, &[]);
    assert!(branch.points.len() > 20);
    let values: Vec<f64> = branch.points.iter().map(|cycle| cycle.value).collect();
    assert!(
        (values[1] - 0.157).abs() < 0.1 && values.iter().all(|value| (0.05..=100.0).contains(value)),
        "{values:?}"
    );
    assert!(values.last().unwrap() > &10.0);
}

/// A subcritical Hopf point with a fold close by, beside a pair of states that oscillates for ever: `r' = r (m + a r^2 - r^4)` has a
/// fold of cycles at `m = -a^2/4`.
struct BesideNeutral;

impl VectorField for BesideNeutral {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z", "w"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["m", "a"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let square = s[0] * s[0] + s[1] * s[1];
        let growth = p[0] + p[1] * square - square * square;
        d[0] = growth * s[0] - s[1];
        d[1] = growth * s[1] + s[0];
        d[2] = s[3] * 0.7;
        d[3] = s[2] * -0.7;
    }
}

#[test]
fn the_first_cycle_is_on_the_side_that_the_normal_form_says_whatever_rings_beside_it() {
    for a in [0.5, 0.1, 0.02] {
        let start = [0.0; 4];
        let equilibria = Equilibria::of(&BesideNeutral).start(&start).parameters(&[-1.0, a]);
        let branch = equilibria.along("m", -1.0..=1.0).run().unwrap();
        let hopf = branch.hopf_points().next().expect("a Hopf point");
        assert!(hopf.value.abs() < 1e-12 && hopf.first_lyapunov.is_some_and(|first| first > 0.0));
        let cycles = Cycles::of(&BesideNeutral, CycleStart::from(hopf)).parameters(&hopf.parameters);
        let branch = cycles.along("m", -1.0..=1.0).run().unwrap();
        assert!(branch.points[0].value < 0.0, "{a}: {}", branch.points[0].value);
        let fold = branch.points.iter().map(|point| point.value).fold(f64::INFINITY, f64::min);
        let size = 0.25 * a * a;
        assert!(fold < -0.5 * size && fold > -1.001 * size, "{a}: {fold}");
    }
}
