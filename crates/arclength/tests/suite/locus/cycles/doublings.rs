//! Curves of period doublings and their points of codimension two.

use super::fields::{DoublingBand, assert_at, found};
use crate::common;
use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{Cycles, Orbit};
use arclength::locus::CycleLocus;
use arclength::{Scalar, VectorField};

#[test]
fn resonance_and_degenerate_doubling_on_doublings() {
    let orbit = |parameters: &[f64]| {
        Orbit::from_time_history(&DoublingBand, parameters, &[1.0, 0.0, 0.0], 7.0).expect("a cycle")
    };
    // Doublings at mu = 0; a second multiplier -1 at nu = 0.
    let parameters = [0.0, -0.3, -1.0];
    let doublings = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit(&parameters), &parameters)
        .along("mu", -0.2..=0.2)
        .and("nu", -0.5..=0.5)
        .run()
        .expect("exists");
    assert!(doublings.points.iter().all(|point| point.values[0].abs() < 1e-8));
    assert_at(&doublings, SpecialKind::Resonance2, [0.0, 0.0], 1e-8);
    // The cubic coefficient vanishes with c.
    let doublings = CycleLocus::of(&DoublingBand)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit(&parameters), &parameters)
        .along("mu", -0.2..=0.2)
        .and("c", -1.5..=1.5)
        .run()
        .expect("exists");
    assert_at(&doublings, SpecialKind::GeneralizedPeriodDoubling, [0.0, 0.0], 1e-8);
}

#[test]
fn the_doublings_of_lure_form_a_closed_curve() {
    let start = common::hopf_start(&common::Lure, &[0.0; 3], &[1.0, 1.0]);
    let branch = Cycles::of(&common::Lure, start)
        .parameters(&[1.0, 1.0])
        .along("alpha", 0.0..=1.1)
        .run()
        .expect("exists");
    let (_, doubling) =
        branch.special().find(|(special, _)| *special == SpecialKind::PeriodDoubling).expect("a doubling");
    let doublings = CycleLocus::of(&common::Lure)
        .from_cycle(SpecialKind::PeriodDoubling, &doubling.orbit, &[doubling.value, 1.0])
        .along("alpha", -2.0..=2.0)
        .and("beta", 0.2..=2.0)
        .run()
        .expect("exists");
    assert!(matches!(doublings.stops[1], Some(Stop::Closed)), "{:?}", doublings.stops);
    // With alpha = 0 the system is reversible and multipliers come in reciprocal pairs: two of them are -1.
    let points = found(&doublings);
    assert_eq!(points.len(), 2, "{points:?}");
    for (kind, values) in points {
        assert!(kind == SpecialKind::Resonance2 && values[0].abs() < 1e-8);
    }
}

// The circle with the plane (x, y) that turns half round: period doublings at a = 0 and at b = 0, which cross in a 1:2 resonance
// that is regular on neither curve.
beside_a_circle!(CrossingDoublings, ["x", "y"], ["a", "b"], |s, p, d| {
    let (u, v, x, y, a, b) = (s[0], s[1], s[2], s[3], p[0], p[1]);
    let square = x * x + y * y;
    let growth = -square - square * square;
    let (even, odd) = ((u + 1.0) * 0.5, (-u + 1.0) * 0.5);
    let (half, e) = (v * 0.5, 0.5);
    d[2] = (a * even - b * odd - half * e) * x + ((a + b) * half + even * e) * y - y * 0.5 + growth * x;
    d[3] = ((a + b) * half - odd * e) * x + (a * odd - b * even + half * e) * y + x * 0.5 + growth * y;
});

#[test]
fn a_test_function_that_changes_its_sign_without_a_point_is_named() {
    let parameters = [0.0, 0.7];
    let orbit = Orbit::from_time_history(&CrossingDoublings, &parameters, &[1.0, 0.0, 0.0, 0.0], 7.0);
    let doublings = CycleLocus::of(&CrossingDoublings)
        .from_cycle(SpecialKind::PeriodDoubling, &orbit.expect("a cycle"), &parameters)
        .along("a", -1.0..=1.0)
        .and("b", -1.0..=1.0)
        .run()
        .expect("exists");
    // Wherever the sign of a test function changes from one point to the next, there is a labelled point or a note.
    let resonance = |point: &arclength::locus::CycleLocusPoint| {
        point.tests.iter().find(|(name, _)| name == "R2").map(|(_, value)| *value)
    };
    let changes = doublings.points.windows(2).filter(
        |pair| matches!((resonance(&pair[0]), resonance(&pair[1])), (Some(a), Some(b)) if a * b < 0.0),
    );
    let named =
        doublings.unlocated.iter().filter(|change| change.kind == Some(SpecialKind::Resonance2)).count();
    let located = found(&doublings).len();
    assert!(changes.count() > 0);
    assert!(named + located > 0, "{:?}", doublings.unlocated);
}
