//! Families of cycles at one parameter value, as conserved quantities make them, against closed forms.

use arclength::continuation::Stop;
use arclength::cycle::{CycleBranch, CycleEnd, CycleStart, Cycles};
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};
use std::f64::consts::TAU;

/// `u'' = -u - c u^3 - damping u'`: an oscillator with a dummy damping, hardening or softening.
struct Spring(f64);

impl VectorField for Spring {
    fn state_names(&self) -> Vec<String> {
        vec!["u".into(), "v".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["damping".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        d[0] = s[1];
        d[1] = -(s[0] + s[0] * s[0] * s[0] * self.0 + p[0] * s[1]);
    }
}

fn family(spring: &Spring) -> CycleBranch {
    let equilibria = Equilibria::of(spring).parameters(&[0.1]).along("damping", -1.0..=1.0).run().unwrap();
    let hopf = equilibria.hopf_points().next().unwrap().clone();
    assert!(hopf.value.abs() < 1e-15);
    Cycles::of(spring, CycleStart::from(&hopf))
        .parameters(&[hopf.value])
        .along("damping", -1.0..=1.0)
        .run()
        .unwrap()
}

/// Period of `u'' = -u - c u^3` with the amplitude `a`, by the arithmetic-geometric mean: `4 K(m)/sqrt(1 + c a^2)` with
/// `m = c a^2/(2 (1 + c a^2))` (Byrd and Friedman, *Handbook of Elliptic Integrals* (1971)).
fn period(c: f64, a: f64) -> f64 {
    let rate = 1.0 + c * a * a;
    let m = c * a * a / (2.0 * rate);
    let (mut one, mut other) = (1.0_f64, (1.0 - m).sqrt());
    for _ in 0..60 {
        (one, other) = (0.5 * (one + other), (one * other).sqrt());
    }
    TAU / (one * rate.sqrt())
}

#[test]
fn a_hardening_spring_has_one_neutral_family_without_folds() {
    let branch = family(&Spring(1.0));
    assert!(branch.points.iter().all(|point| point.neutral && point.stable.is_none()));
    assert!(branch.points.iter().all(|point| point.label.is_none()));
    assert!(branch.unlocated.is_empty());
    assert!((branch.points[0].period / TAU - 1.0).abs() < 1e-4);
    for point in &branch.points {
        let error = (point.period / period(1.0, point.max[0]) - 1.0).abs();
        assert!(
            error <= (3.0 * point.error_estimate).max(1e-9),
            "{error:e}, told {:e}",
            point.error_estimate
        );
    }
    let end = branch.stops[1].as_ref();
    assert!(matches!(end, Some(Stop::Problem(CycleEnd::AmplitudeUnbounded { .. }))), "{end:?}");
}

#[test]
fn a_softening_spring_has_a_neutral_family_up_to_the_saddles() {
    let branch = family(&Spring(-1.0));
    assert!(branch.points.iter().all(|point| point.neutral));
    let end = branch.stops[1].as_ref();
    assert!(matches!(end, Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. }))), "{end:?}");
    let last = branch.points.last().unwrap();
    assert!((last.max[0] - 1.0).abs() < 1e-3 && last.max[0] < 1.0);
}
