//! Cycles of random fields from random starts: whatever comes out is finite and within its tolerance, or a clear error.

use arclength::continuation::{Settings, Stop};
use arclength::cycle::{CycleBranch, CycleEnd, CycleStart, Cycles, Orbit, Resolution};
use arclength::equilibrium::Equilibria;
use arclength::{Error, Scalar, VectorField};
use num_complex::Complex64;
use proptest::prelude::*;

/// Cubic polynomials in three states and one parameter.
#[derive(Debug)]
struct Polynomial {
    coefficients: Vec<f64>,
}

const TERMS: usize = 13;

impl VectorField for Polynomial {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let ([x, y, z], p) = ([state[0], state[1], state[2]], parameters[0]);
        let terms =
            [T::one(), x, y, z, p * x, p * y, x * x, x * y, x * z, y * z, x * x * x, x * x * y, z * z * z];
        for (entry, row) in derivative.iter_mut().zip(self.coefficients.chunks_exact(TERMS)) {
            *entry = terms.iter().zip(row).map(|(term, coefficient)| *term * *coefficient).sum();
        }
    }
}

fn check(field: &Polynomial, start: CycleStart) -> Result<(), TestCaseError> {
    let resolution = Resolution { tolerance: 1e-5, most_intervals: 60, ..Resolution::default() };
    let settings = Settings::default().most_steps(15);
    let run = Cycles::of(field, start)
        .parameters(&[0.1])
        .along("p", -1.0..=1.0)
        .resolution(resolution)
        .settings(settings)
        .run();
    match run {
        Ok(CycleBranch { points, .. }) => {
            prop_assert!(!points.is_empty());
            for point in &points {
                prop_assert!(point.period.is_finite() && point.value.is_finite());
                prop_assert!(point.max.iter().chain(&point.min).all(|value| value.is_finite()));
                prop_assert!(point.error_estimate <= resolution.tolerance, "{}", point.error_estimate);
                prop_assert_eq!(point.multipliers.len(), 3);
            }
        }
        Err(error) => prop_assert!(!error.to_string().is_empty()),
    }
    Ok(())
}

fn coefficients() -> impl Strategy<Value = Polynomial> {
    proptest::collection::vec(-2.0..2.0_f64, 3 * TERMS).prop_map(|coefficients| Polynomial { coefficients })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn starts_at_points_that_are_no_hopf_points(
        field in coefficients(),
        state in proptest::collection::vec(-1.0..1.0_f64, 3),
        parts in proptest::collection::vec(-1.0..1.0_f64, 6),
        frequency in 0.1..10.0_f64,
    ) {
        let eigenvector = parts.chunks(2).map(|pair| Complex64::new(pair[0], pair[1])).collect();
        check(&field, CycleStart::Hopf { state, frequency, eigenvector, crossing_speed: 1.0, cubic_coefficient: 1.0 })?;
    }

    #[test]
    fn starts_at_orbits_that_are_none(
        field in coefficients(),
        states in proptest::collection::vec(-3.0..3.0_f64, 3 * 4 * 3),
        period in 0.01..100.0_f64,
    ) {
        let mesh = vec![0.0, 0.2, 0.7, 1.0];
        check(&field, CycleStart::Orbit(Orbit { mesh, degree: 3, dimension: 3, states, period }))?;
    }
}

#[test]
fn orbits_that_do_not_fit_are_refused() {
    let field = Polynomial { coefficients: vec![1.0; 3 * TERMS] };
    let orbit =
        Orbit { mesh: vec![0.0, 0.5, 1.0], degree: 3, dimension: 3, states: vec![0.0; 24], period: 1.0 };
    let run = |orbit: Orbit| {
        let cycles = Cycles::of(&field, CycleStart::Orbit(orbit)).parameters(&[0.0]).along("p", -1.0..=1.0);
        matches!(cycles.run(), Err(Error::Invalid { .. }))
    };
    for wrong in [
        Orbit { mesh: vec![0.0, 0.5], ..orbit.clone() },
        Orbit { mesh: vec![0.0, 0.5, 0.5, 1.0], ..orbit.clone() },
        Orbit { mesh: vec![], ..orbit.clone() },
        Orbit { degree: 0, ..orbit.clone() },
        Orbit { degree: 99, ..orbit.clone() },
        Orbit { dimension: 2, ..orbit.clone() },
        Orbit { states: vec![0.0; 23], ..orbit.clone() },
        Orbit { states: vec![f64::NAN; 24], ..orbit.clone() },
        Orbit { period: -1.0, ..orbit.clone() },
        Orbit { period: f64::INFINITY, ..orbit.clone() },
    ] {
        assert!(run(wrong.clone()), "{wrong:?}");
    }
}

/// A Hopf point whose state is zero but for rounding starts its cycles, in any units.
#[test]
fn first_cycles_are_sized_by_the_field_and_not_by_rounding() {
    for (unit, rest) in [(1.0, 1e-17), (1.0, 0.0), (1e3, 1e-17), (1e-6, 0.0)] {
        struct Circle(f64);
        impl VectorField for Circle {
            fn state_names(&self) -> Vec<String> {
                vec!["x".into(), "y".into()]
            }
            fn parameter_names(&self) -> Vec<String> {
                vec!["m".into()]
            }
            fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
                let square = (s[0] * s[0] + s[1] * s[1]) / (self.0 * self.0);
                d[0] = (p[0] - square) * s[0] - s[1] * 0.8;
                d[1] = (p[0] - square) * s[1] + s[0] * 0.8;
            }
        }
        let half = 0.5_f64.sqrt();
        let start = CycleStart::Hopf {
            state: vec![rest, 0.0],
            frequency: 0.8,
            eigenvector: vec![Complex64::new(half, 0.0), Complex64::new(0.0, -half)],
            crossing_speed: 1.0,
            cubic_coefficient: -1.0 / (unit * unit),
        };
        let field = Circle(unit);
        let branch =
            Cycles::of(&field, start).parameters(&[0.0]).along("m", -0.5..=0.2).at(&[0.01]).run().unwrap();
        let found = branch.points.iter().find(|cycle| cycle.value == 0.01).unwrap();
        assert!((found.max[0] / (0.1 * unit) - 1.0).abs() < 1e-8, "{unit}: {}", found.max[0]);
    }
}

/// Predator and prey with an Allee effect: its cycles come ever nearer to a heteroclinic one, on which the predator is zero.
struct AlleeEffect;

impl VectorField for AlleeEffect {
    fn state_names(&self) -> Vec<String> {
        vec!["prey".into(), "predator".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["mortality".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let square = s[0] * s[0];
        let eaten = square * s[1] / (square + 0.09);
        d[0] = s[0] * (s[0] - 0.1) * (-s[0] + 1.0) - eaten;
        d[1] = eaten * 0.6 - p[0] * s[1];
    }
}

#[test]
fn a_branch_does_not_creep_on_for_ever_where_a_state_comes_too_near_to_zero() {
    let equilibria = Equilibria::of(&AlleeEffect)
        .start(&[0.4, 0.2])
        .parameters(&[0.4])
        .along("mortality", 0.02..=0.6)
        .run()
        .unwrap();
    let hopf = equilibria.hopf_points().next().expect("a Hopf point");
    let branch = hopf.cycles(&AlleeEffect).along("mortality", 0.02..=0.6).run().unwrap();
    assert!(branch.points.len() < 400, "{} points", branch.points.len());
    let last = branch.points.last().unwrap();
    assert!(last.min[1] > 0.0);
    match &branch.stops[1] {
        Some(Stop::Problem(CycleEnd::NearZero { state, smallest, .. })) => {
            assert_eq!(state, "predator");
            // The last cycle is told as it is on a finer mesh.
            assert!((smallest / last.min[1] - 1.0).abs() < 0.1);
        }
        // Where the last digits allow, the heteroclinic orbit is seen before.
        Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. })) => {}
        other => panic!("{other:?}"),
    }
}

/// `r' = r (a - r^2)` with a turn of one: cycles of radius `sqrt(a)` where a is positive.
struct StuartLandau;

impl VectorField for StuartLandau {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["a".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let square = s[0] * s[0] + s[1] * s[1];
        d[0] = s[0] * (p[0] - square) - s[1];
        d[1] = s[1] * (p[0] - square) + s[0];
    }
}

#[test]
fn a_motion_that_comes_to_rest_is_told_so() {
    for (a, radius, duration) in
        [(-0.01, 4e-5, 1000.0), (-1.0, 1e-3, 20.0), (-1.0, 1e-40, 1000.0), (-0.3, 0.0, 10.0)]
    {
        let found = Orbit::from_time_history(&StuartLandau, &[a], &[radius, 0.0], duration);
        let Err(Error::Resting { equilibrium }) = found else { panic!("a = {a}: {found:?}") };
        assert!(equilibrium.iter().all(|value| value.abs() < 1e-12));
    }
    let orbit = Orbit::from_time_history(&StuartLandau, &[0.25], &[0.5, 0.0], 7.0).unwrap();
    assert!((orbit.period / std::f64::consts::TAU - 1.0).abs() < 1e-8);
}

#[test]
fn a_start_that_is_no_cycle_does_not_lead_to_one_elsewhere() {
    // Nearly a circle of the linear motion: there are cycles of that radius at a = 1e-12, beyond the range.
    let circle = |angle: f64| vec![1e-6 * angle.cos(), 1e-6 * angle.sin()];
    let count = 41;
    let times: Vec<f64> = (0..count).map(|index| std::f64::consts::TAU * index as f64 / 40.0).collect();
    let states: Vec<Vec<f64>> = (0..count).map(|index| circle(times[index % 40])).collect();
    let orbit = Orbit::from_samples(&times, &states).unwrap();
    for range in [-2.0..=-0.005, -2.0..=1.0] {
        let branch = Cycles::of(&StuartLandau, CycleStart::Orbit(orbit.clone()))
            .parameters(&[-0.01])
            .along("a", range)
            .run();
        assert!(matches!(branch, Err(Error::NotFound { .. })), "{branch:?}");
    }
}
