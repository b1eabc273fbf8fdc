//! Limit cycles against closed forms and published values.

use crate::common::wheel::{Wheel, wheel_start};
use approx::assert_relative_eq;
use arclength::branch::Monitor;
use arclength::continuation::Stop;
use arclength::cycle::{CyclePoint, Cycles};
use num_complex::Complex64;
use std::cell::Cell;

/// A cycle from single shooting with a tolerance of 3e-14.
struct Reference {
    v: f64,
    period: f64,
    psi_max: f64,
    psi_min: f64,
    multipliers: [(f64, f64); 5],
}

const REFERENCES: [Reference; 5] = [
    Reference {
        v: 8.0,
        period: 0.14612684668050366,
        psi_max: 0.2701391504417376,
        psi_min: -0.12019038629884853,
        multipliers: [
            (1.0138325182041084, 0.0),
            (0.9999999999999963, 0.0),
            (-0.5016865337385307, -0.8146782443014935),
            (-0.5016865337385307, 0.8146782443014935),
            (7.175868173908287e-08, 0.0),
        ],
    },
    Reference {
        v: 6.0,
        period: 0.1498182585503941,
        psi_max: 0.5130785057286356,
        psi_min: -0.3763047240963389,
        multipliers: [
            (1.0643648931772707, 0.0),
            (1.0000000000000109, 0.0),
            (-0.7714185444147086, -0.5946214697375807),
            (-0.7714185444147086, 0.5946214697375807),
            (2.1011417807292386e-06, 0.0),
        ],
    },
    Reference {
        v: 4.0,
        period: 0.15274192836201247,
        psi_max: 0.6351645637341435,
        psi_min: -0.5003383285676317,
        multipliers: [
            (1.1137826096822392, 0.0),
            (0.9999999999999861, 0.0),
            (-0.8756735799692812, -0.4296369714753791),
            (-0.8756735799692812, 0.4296369714753791),
            (0.0001096174639132885, 0.0),
        ],
    },
    Reference {
        v: 2.0,
        period: 0.15469423899444815,
        psi_max: 0.7098150349910172,
        psi_min: -0.5648677576526538,
        multipliers: [
            (1.160425345177388, 0.0),
            (0.9999999999999696, 0.0),
            (-0.7795610686932662, -0.4348475840276132),
            (-0.7795610686932662, 0.4348475840276132),
            (0.010349278582518067, 0.0),
        ],
    },
    Reference {
        v: 1.0,
        period: 0.15522951404204402,
        psi_max: 0.7307800097444889,
        psi_min: -0.5801477894905818,
        multipliers: [
            (1.1325484248532904, 0.0),
            (1.0000000000011307, 0.0),
            (-0.6410755017822227, -0.5612690991230184),
            (-0.6410755017822227, 0.5612690991230184),
            (0.11699204049622661, 0.0),
        ],
    },
];

#[test]
fn wheel_branch_agrees_with_single_shooting() {
    let (start, v) = wheel_start();
    let branch = Cycles::of(&Wheel, start)
        .parameters(&[v])
        .along("v", 0.2..=9.0)
        .at(&[1.0, 2.0, 4.0, 6.0, 8.0])
        .run()
        .expect("the branch exists");
    for reference in &REFERENCES {
        let cycle = branch.points.iter().find(|cycle| cycle.value == reference.v).expect("asked for");
        assert_relative_eq!(cycle.period, reference.period, max_relative = 1e-9);
        assert_relative_eq!(cycle.max[2], reference.psi_max, max_relative = 1e-7);
        assert_relative_eq!(cycle.min[2], reference.psi_min, max_relative = 1e-7);
        for (re, im) in reference.multipliers {
            let exact = Complex64::new(re, im);
            let distance =
                cycle.multipliers.iter().map(|mu| (mu - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(distance < 1e-5 * exact.norm(), "{exact} at v = {}: {distance:e}", reference.v);
        }
        assert!(cycle.error_estimate < 1e-8);
        assert_eq!(cycle.stable, Some(false));
    }
    assert!(branch.special().next().is_none(), "{:?}", branch.special().next());
    assert!(matches!(branch.stops[1], Some(Stop::RangeEnd { value: 0.2, .. })));
    assert!(branch.points.len() < 60);
}

/// Monitors may be expensive: each is computed once where the curve is searched and once for the branch that is told, once more for the
/// cycles that are confirmed, here both ends, and a few times where its value is located.
#[test]
fn monitors_are_computed_no_more_often_than_needed() {
    let calls = Cell::new(0);
    let swing = |cycle: &CyclePoint| {
        calls.set(calls.get() + 1);
        Some(cycle.max[2] - cycle.min[2])
    };
    let (start, v) = wheel_start();
    let branch = Cycles::of(&Wheel, start)
        .parameters(&[v])
        .along("v", 4.0..=9.0)
        .monitor(Monitor::new("swing", swing).at(&[0.8]))
        .run()
        .expect("the branch exists");
    let found: Vec<_> = branch.points.iter().filter(|cycle| cycle.label.is_some()).collect();
    assert_eq!(found.len(), 1);
    assert!((found[0].monitors[0] - 0.8).abs() < 1e-11);
    assert!(
        calls.get() <= 2 * branch.points.len() + 2 + 15,
        "{} for {} points",
        calls.get(),
        branch.points.len()
    );
}
