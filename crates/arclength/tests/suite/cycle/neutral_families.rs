//! Families of cycles at one parameter value, as conserved quantities make them, against closed forms.

use arclength::branch::{Criticality, SpecialKind};
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

/// `u'' = mu (1 - u^2) u' - u`: linear at its Hopf point, where the parameter is a factor of all that is not.
struct VanDerPol;

impl VectorField for VanDerPol {
    fn state_names(&self) -> Vec<String> {
        vec!["u".into(), "v".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["mu".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        d[0] = s[1];
        d[1] = p[0] * (-(s[0] * s[0]) + 1.0) * s[1] - s[0];
    }
}

#[test]
fn a_field_that_is_linear_at_its_hopf_point_has_a_family_that_van_der_pols_cycles_cross() {
    let equilibria = Equilibria::of(&VanDerPol).parameters(&[-1.0]).along("mu", -1.0..=1.0).run().unwrap();
    let hopf = equilibria.hopf_points().next().unwrap();
    assert_eq!(hopf.criticality, Criticality::Degenerate, "l1 = {:?}", hopf.first_lyapunov);
    let family = hopf.cycles(&VanDerPol).along("mu", -1.0..=1.0).run().unwrap();
    assert!(family.points.iter().all(|point| point.neutral));
    assert!(family.points[0].max[0] < 0.1, "{}", family.points[0].max[0]);
    let [(kind, crossing)] = family.special().collect::<Vec<_>>()[..] else { panic!("one branch point") };
    assert_eq!(kind, SpecialKind::BranchPointOfCycles);
    // The amplitude for small mu (van der Pol (1926)).
    assert!((crossing.max[0] - 2.0).abs() < 1e-8, "{}", crossing.max[0]);
    let cycles = crossing.other(&VanDerPol).unwrap().along("mu", -1.0..=1.0).run().unwrap();
    let ends = [&cycles.points[0], cycles.points.last().unwrap()];
    for end in ends {
        // T(1) = 6.6632868593231 (Strogatz gives 6.66).
        assert!((end.period - 6.663_286_859_32).abs() < 1e-8, "{}", end.period);
    }
    assert!(ends.iter().any(|end| end.value == 1.0 && end.stable == Some(true)));
    assert!(ends.iter().any(|end| end.value == -1.0 && end.stable == Some(false)));
}

/// Two springs with a quartic coupling and a dummy damping of both: `u'' = -u - u^3 - c u w^2`, `w'' = -1.69 w - w^3/2 - c u^2 w`.
struct CoupledSprings(f64);

impl VectorField for CoupledSprings {
    fn state_names(&self) -> Vec<String> {
        ["u", "u_rate", "w", "w_rate"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["damping".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let [u, w] = [s[0], s[2]];
        d[0] = s[1];
        d[1] = -(u + u * u * u + u * w * w * self.0 + p[0] * s[1]);
        d[2] = s[3];
        d[3] = -(w * 1.69 + w * w * w * 0.5 + u * u * w * self.0 + p[0] * s[3]);
    }
}

#[test]
fn branch_points_along_a_family_of_a_conservative_system_are_those_of_hills_equation() {
    // Amplitudes of w at which a multiplier of u'' = -(1 + c w^2) u is one: SciPy, DOP853, 1e-10.
    let cases: [(f64, &[f64]); 3] =
        [(1.2, &[1.147_481_56]), (2.0, &[0.782_518_92, 2.267_975_19]), (-0.2, &[3.303_827_26])];
    for (coupling, amplitudes) in cases {
        let springs = CoupledSprings(coupling);
        let equilibria =
            Equilibria::of(&springs).parameters(&[0.1]).along("damping", -0.5..=0.5).run().unwrap();
        let hopf = equilibria.hopf_points().find(|hopf| hopf.frequency > 1.2).unwrap();
        let family = Cycles::of(&springs, CycleStart::from(hopf))
            .parameters(&[hopf.value])
            .along("damping", -0.5..=0.5)
            .run()
            .unwrap();
        assert!(family.points.iter().all(|point| point.neutral));
        let found: Vec<f64> = family.special().map(|(_, point)| point.max[2]).collect();
        assert_eq!(found.len(), amplitudes.len(), "c = {coupling}: {found:?}");
        for (found, exact) in found.iter().zip(amplitudes) {
            assert!((found / exact - 1.0).abs() < 1e-6, "c = {coupling}: {found}, {exact}");
        }
        assert!(family.unlocated.is_empty(), "{:?}", family.unlocated);
    }
}

/// A circle with `r^2 = mu` beside which `z^2 = mu - 1/2` grows: a pitchfork of cycles, on which `z` does not vary along the cycle.
struct Pitchfork;

impl VectorField for Pitchfork {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(str::to_owned).into()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["mu".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let square = s[0] * s[0] + s[1] * s[1];
        d[0] = s[0] * (p[0] - square) - s[1];
        d[1] = s[1] * (p[0] - square) + s[0];
        d[2] = s[2] * (square - s[2] * s[2] - 0.5);
    }
}

#[test]
fn the_branch_that_leaves_a_pitchfork_of_cycles_is_no_neutral_family() {
    let range = -0.5..=1.0;
    let equilibria = Equilibria::of(&Pitchfork).parameters(&[-0.1]).along("mu", range.clone()).run().unwrap();
    let hopf = equilibria.hopf_points().next().unwrap();
    let circles = hopf.cycles(&Pitchfork).along("mu", range.clone()).run().unwrap();
    let branch_points: Vec<_> = circles
        .points
        .iter()
        .filter(|point| point.label.is_some_and(|label| label.kind == SpecialKind::BranchPointOfCycles))
        .collect();
    assert_eq!(branch_points.len(), 1);
    let other = branch_points[0].other(&Pitchfork).unwrap().along("mu", range).run().unwrap();
    for point in &other.points {
        assert!(!point.neutral, "mu = {}", point.value);
        assert!((point.max[2].powi(2) - (point.value - 0.5)).abs() < 1e-9);
        assert!(point.value < 0.501 || point.stable == Some(true), "mu = {}", point.value);
    }
    let [first, .., last] = &other.points[..] else { panic!("no branch") };
    assert!(first.value == 1.0 && last.value == 1.0 && first.max[2] * last.max[2] < 0.0);
}
