//! Special cycles and periods of published models.

use crate::common::{Brusselator, Lorenz, Lure, RadialCycle, VanDerPol, hopf_start};
use approx::assert_relative_eq;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleEnd, CycleStart, Cycles, Orbit};
use arclength::integration::{Integrator, autonomous};

#[test]
fn van_der_pol_periods() {
    // The Hopf point at mu = 0 is degenerate, so the branch starts from a cycle found by integration.
    let integrator = Integrator::with_tolerance(1e-12);
    let parameters = [1.0];
    let settled =
        integrator.integrate(autonomous(&VanDerPol, &parameters), 0.0, &[2.0, 0.0], 60.0).expect("smooth");
    let orbit = Orbit::from_time_history(&VanDerPol, &parameters, &settled.state, 20.0).expect("a cycle");
    let branch = Cycles::of(&VanDerPol, CycleStart::Orbit(orbit))
        .parameters(&parameters)
        .along("mu", 0.5..=5.0)
        .at(&[1.0, 5.0])
        .run()
        .expect("exists");
    let period = |mu: f64| branch.points.iter().find(|cycle| cycle.value == mu).expect("asked for").period;
    assert_relative_eq!(period(1.0), 6.663286859323, max_relative = 1e-11);
    assert_relative_eq!(period(5.0), 11.612230668, max_relative = 1e-9);
}

#[test]
fn radial_cycle_has_its_exact_multiplier() {
    let start = hopf_start(&RadialCycle, &[0.0, 0.0], &[0.0]);
    let branch = Cycles::of(&RadialCycle, start)
        .parameters(&[0.0])
        .along("rho", 0.0..=2.0)
        .at(&[0.5, 2.0])
        .run()
        .expect("exists");
    for rho in [0.5, 2.0] {
        let cycle = branch.points.iter().find(|cycle| cycle.value == rho).expect("asked for");
        let exact = (-4.0 * std::f64::consts::PI * rho).exp();
        assert_relative_eq!(cycle.multipliers[1].re, exact, max_relative = 1e-6);
        assert_relative_eq!(cycle.max[0], rho.sqrt(), max_relative = 1e-8);
        assert_eq!(cycle.stable, Some(true));
    }
}

#[test]
fn lure_period_doubling() {
    let start = hopf_start(&Lure, &[0.0, 0.0, 0.0], &[1.0, 1.0]);
    let branch =
        Cycles::of(&Lure, start).parameters(&[1.0, 1.0]).along("alpha", -1.1..=1.1).run().expect("exists");
    let doublings: Vec<_> =
        branch.special().filter(|(special, _)| *special == SpecialKind::PeriodDoubling).collect();
    assert_eq!(doublings.len(), 2);
    for (_, cycle) in doublings {
        assert_relative_eq!(cycle.value.abs(), 0.6303020062, max_relative = 1e-9);
        assert_relative_eq!(cycle.period, 6.364071339, max_relative = 1e-9);
    }
    let Some(Stop::Problem(CycleEnd::HopfPoint { parameter, frequency, located: true })) = branch.stops[1]
    else {
        panic!("{:?}", branch.stops)
    };
    assert_relative_eq!(parameter, -1.0, max_relative = 1e-12);
    assert_relative_eq!(frequency, 1.0, max_relative = 1e-12);
}

#[test]
fn lure_doubled_branch() {
    let start = hopf_start(&Lure, &[0.0, 0.0, 0.0], &[1.0, 1.0]);
    let branch =
        Cycles::of(&Lure, start).parameters(&[1.0, 1.0]).along("alpha", -1.1..=1.1).run().expect("exists");
    let (_, doubling) =
        branch.special().find(|(special, _)| *special == SpecialKind::PeriodDoubling).expect("a doubling");
    let doubled =
        doubling.doubled(&Lure).expect("a branch").along("alpha", -1.1..=1.1).run().expect("exists");
    let found = |sought: SpecialKind| -> Vec<(f64, f64)> {
        let points = doubled.special().filter(|(special, _)| *special == sought);
        points.map(|(_, cycle)| (cycle.value, cycle.period)).collect()
    };
    let folds = found(SpecialKind::FoldOfCycles);
    assert_eq!(folds.len(), 2);
    for (value, _) in &folds {
        assert_relative_eq!(value.abs(), 0.0449491239, max_relative = 1e-8);
    }
    let doublings = found(SpecialKind::PeriodDoubling);
    assert!(
        doublings.iter().any(
            |(value, period)| (value + 0.0447196616).abs() < 1e-9 && (period - 11.062836564).abs() < 1e-8
        ),
        "{doublings:?}"
    );
    // The other end is the doubling on the other side: reversing time mirrors the system.
    let Some(Stop::Problem(CycleEnd::PeriodDoubling { parameter, period })) = doubled.stops[1] else {
        panic!("{:?}", doubled.stops)
    };
    assert_relative_eq!(parameter, -doubling.value, max_relative = 1e-9);
    assert_relative_eq!(period, doubling.period, max_relative = 1e-9);
    assert!(doubled.unlocated.is_empty(), "{:?}", doubled.unlocated);
}

#[test]
fn lorenz_subcritical_branch_and_homoclinic() {
    let rho: f64 = 470.0 / 19.0;
    let x = (8.0 / 3.0 * (rho - 1.0)).sqrt();
    let start = hopf_start(&Lorenz, &[x, x, rho - 1.0], &[rho]);
    let branch =
        Cycles::of(&Lorenz, start).parameters(&[rho]).along("rho", 5.0..=30.0).run().expect("exists");
    assert!(
        matches!(branch.stops[1], Some(Stop::Problem(CycleEnd::PeriodUnbounded { .. }))),
        "{:?}",
        branch.stops
    );
    let last = branch.points.last().expect("points");
    assert_relative_eq!(last.value, 13.926557, max_relative = 1e-5);
}

#[test]
fn brusselator_branch_reaches_its_end() {
    let start = hopf_start(&Brusselator, &[1.0, 2.0], &[1.0, 2.0]);
    let branch =
        Cycles::of(&Brusselator, start).parameters(&[1.0, 2.0]).along("b", 1.5..=5.0).run().expect("exists");
    assert!(matches!(branch.stops[1], Some(Stop::RangeEnd { value: 5.0, .. })));
    assert!(branch.points.iter().all(|cycle| cycle.stable == Some(true) && cycle.error_estimate < 1e-8));
    // With a = 1, b = 5 integration gives a relaxation oscillation.
    let last = branch.points.last().expect("points");
    let field = autonomous(&Brusselator, &[1.0, 5.0]);
    let initial = last.orbit.state_at(0.0);
    let end = Integrator::with_tolerance(1e-12).integrate(field, 0.0, &initial, last.period).expect("smooth");
    for (a, b) in initial.iter().zip(&end.state) {
        assert_relative_eq!(a, b, max_relative = 1e-6);
    }
}
