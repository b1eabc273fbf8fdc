//! Limit cycles of random wheels: the promise of the error estimate, and agreement with integration.

use arclength::control::Control;
use arclength::cycle::Resolution;
use arclength::integration::{Integrator, autonomous};
use kingpin::branches::{Along, CycleOptions, WheelCycles};
use kingpin::{Key, Wheel};
use proptest::prelude::*;
use std::ops::ControlFlow;

/// The branch from the first Hopf point above v = 0.5 m/s down to half the speed there, and that half speed.
fn branch(wheel: &Wheel, tolerance: f64, degree: usize) -> Option<(WheelCycles, f64)> {
    let radius = wheel.get(Key::TurningRadius);
    let along = Along::new(Key::V, 0.5, 12.0 * radius).ok()?;
    let hopf = wheel.hopf_points(along, &Control::none()).ok()?.points.into_iter().next()?;
    let half = 0.5 * (0.5 + hopf.value);
    let options = CycleOptions::default().at(&[half]).resolution(Resolution {
        tolerance,
        degree,
        ..Resolution::default()
    });
    Some((hopf.cycles(along, &options, |_| ControlFlow::Continue(())).ok()?, half))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn error_estimate_bounds_the_error(
        length in 0.055..0.2f64, radius in 0.5..3.0f64, stiffness in 50.0..400.0f64, caster_mass in 0.03..0.15f64,
        degree in 4usize..8,
    ) {
        let wheel = Wheel::default()
            .with(Key::L, length)?
            .with(Key::TurningRadius, radius)?
            .with(Key::K, stiffness)?
            .with(Key::MC, caster_mass)?;
        let Some((coarse, value)) = branch(&wheel, 1e-5, degree) else { return Ok(()) };
        let Some((fine, _)) = branch(&wheel, 1e-11, 8) else { return Ok(()) };
        let at = |branch: &WheelCycles| branch.points.iter().find(|cycle| cycle.value == value).cloned();
        let (Some(rough), Some(exact)) = (at(&coarse), at(&fine)) else { return Ok(()) };
        let allowed = (3.0 * rough.error_estimate).max(1e-9);
        prop_assert!((rough.period / exact.period - 1.0).abs() <= allowed);
        let there = wheel.with(Key::V, value)?;
        let [found, truth] = [there.cycle_forces(&rough.orbit)?, there.cycle_forces(&exact.orbit)?];
        prop_assert!((found.friction_max / truth.friction_max - 1.0).abs() <= allowed);
        prop_assert!((found.king_pin_force_max / truth.king_pin_force_max - 1.0).abs() <= allowed);
        for component in 0..5 {
            let size = 0.5 * (exact.max[component] - exact.min[component]);
            for (computed, truth) in
                [(rough.max[component], exact.max[component]), (rough.min[component], exact.min[component])]
            {
                prop_assert!(
                    (computed - truth).abs() <= allowed * size.max(truth.abs()),
                    "component {component}: {computed} against {truth}, estimate {:e}", rough.error_estimate
                );
            }
        }
    }
}

#[test]
fn cycle_returns_to_itself_when_integrated() {
    let (branch, value) = branch(&Wheel::default(), 1e-9, 7).expect("the paper's wheel has the branch");
    let cycle = branch.points.iter().find(|cycle| cycle.value == value).expect("asked for");
    let wheel = branch.wheel.with(Key::V, value).expect("allowed");
    let field = wheel.rolling(&[Key::V]).expect("finite stiffness");
    let start = cycle.orbit.state_at(0.0);
    let integrator = Integrator::with_tolerance(1e-12);
    let end = integrator.integrate(autonomous(&field, &[value]), 0.0, &start, cycle.period).expect("smooth");
    for (a, b) in start.iter().zip(&end.state) {
        assert!((a - b).abs() < 1e-7 * (1.0 + a.abs()), "{start:?} {end:?}");
    }
}
