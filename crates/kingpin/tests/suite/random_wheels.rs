//! Claims about the uniform motion of random wheels, extreme ones included, against a judge that shares nothing with the program:
//! the equations of motion and their derivatives written out by hand, in numbers of twice the digits.
//!
//! A few hundred wheels of each kind are tried; `KINGPIN_RANDOM_WHEELS=10000` tries as many.

use crate::judge::{self, Judgement};
use arclength::branch::Stability;
use arclength::control::Control;
use kingpin::branches::{Along, MotionOptions};
use kingpin::{Axis, Key, Plane, Wheel};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use std::ops::ControlFlow;

/// Wheels of each kind that are tried.
fn wheels() -> usize {
    std::env::var("KINGPIN_RANDOM_WHEELS").ok().and_then(|count| count.parse().ok()).unwrap_or(300)
}

/// Keys with the powers of ten between which their values lie: those of casters and landing gears, and extreme ones.
const RANGES: [(Key, [f64; 2], [f64; 2]); 9] = [
    (Key::V, [-1.0, 1.5], [-3.0, 3.5]),
    (Key::L, [-1.7, -0.3], [-3.0, 1.0]),
    (Key::MW, [-1.3, 1.2], [-6.0, 5.0]),
    (Key::MC, [-1.3, 1.2], [-6.0, 5.0]),
    (Key::JWxi, [-5.0, 0.0], [-9.0, 3.0]),
    (Key::JWzeta, [-5.0, 0.0], [-9.0, 3.0]),
    (Key::JCz, [-5.5, -0.5], [-9.0, 3.0]),
    (Key::WheelRadius, [-1.7, -0.5], [-3.0, 1.0]),
    (Key::KQ, [1.5, 5.0], [-2.0, 8.5]),
];

/// What a wheel has beside springs of one stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Plain,
    Anisotropic,
    Damped,
    LateralDamper,
    RotationalSpring,
}

const KINDS: [Kind; 5] =
    [Kind::Plain, Kind::Anisotropic, Kind::Damped, Kind::LateralDamper, Kind::RotationalSpring];

/// Numbers between 0 and 1.
fn parts() -> impl Strategy<Value = [f64; 16]> {
    proptest::array::uniform16(0.0..1.0_f64)
}

fn power(part: f64, [low, high]: [f64; 2]) -> f64 {
    10_f64.powf(low + (high - low) * part)
}

/// A wheel from numbers between 0 and 1.
fn wheel(kind: Kind, extreme: bool, straight: bool, parts: &[f64; 16]) -> Wheel {
    let mut wheel = Wheel::default();
    let mut set = |key: Key, value: f64| {
        let allowed = key.allowed();
        let value = if value.is_infinite() { value } else { value.clamp(allowed.lowest, allowed.highest) };
        wheel = wheel.with(key, value).expect("an allowed value");
    };
    for ((key, usual, far), part) in RANGES.into_iter().zip(parts) {
        set(key, power(*part, if extreme { far } else { usual }));
    }
    set(Key::KU, power(parts[8], if extreme { RANGES[8].2 } else { RANGES[8].1 }));
    let length = power(parts[1], if extreme { RANGES[1].2 } else { RANGES[1].1 });
    set(Key::LC, length * (1.3 * parts[9] - 0.2));
    set(
        Key::TurningRadius,
        if straight {
            f64::INFINITY
        } else {
            power(parts[10], if extreme { [-2.0, 9.0] } else { [-0.3, 2.0] })
        },
    );
    let spread = |part: f64| power(part, if extreme { [-9.0, 5.0] } else { [-3.0, 1.5] });
    match kind {
        Kind::Plain => {}
        Kind::Anisotropic => set(Key::KU, power(parts[11], if extreme { RANGES[8].2 } else { RANGES[8].1 })),
        Kind::Damped => {
            set(Key::CU, spread(parts[11]));
            set(Key::CQ, spread(parts[12]));
            set(Key::CPsi, 1e-2 * spread(parts[13]));
        }
        Kind::LateralDamper => set(Key::CQ, spread(parts[11])),
        Kind::RotationalSpring => {
            set(Key::KPsi, spread(parts[11]));
            set(Key::CQ, spread(parts[12]));
            set(Key::KU, power(parts[13], if extreme { RANGES[8].2 } else { RANGES[8].1 }));
        }
    }
    wheel
}

/// All kinds, usual and extreme, on circles and straight.
fn cases() -> impl Iterator<Item = (Kind, bool, bool)> {
    KINDS.into_iter().flat_map(|kind| {
        [false, true]
            .into_iter()
            .flat_map(move |extreme| [false, true].into_iter().map(move |straight| (kind, extreme, straight)))
    })
}

/// What became of the claims of one kind.
#[derive(Debug, Default)]
struct Count {
    claims: usize,
    undecided: usize,
    judged: usize,
}

#[test]
fn stability_is_right_or_undecided() {
    let mut runner = TestRunner::deterministic();
    for (kind, extreme, straight) in cases() {
        let mut count = Count::default();
        for _ in 0..wheels() {
            let parts = parts().new_tree(&mut runner).unwrap().current();
            let wheel = wheel(kind, extreme, straight, &parts);
            let Ok(motion) = wheel.uniform_motion() else { continue };
            let stability = motion.stability();
            let claims = stability != Stability::Undecided;
            count.claims += usize::from(claims);
            count.undecided += usize::from(!claims);
            assert_eq!(motion.is_stable(), stability.is_stable());
            let Some(stable) = judge::of(&motion).map(|judgement: Judgement| judgement.stable) else {
                continue;
            };
            count.judged += usize::from(claims && stable.is_some());
            if let (Some(claimed), Some(stable)) = (stability.is_stable(), stable) {
                assert_eq!(claimed, stable, "{kind:?} {extreme} {straight} {wheel:?}");
                assert_eq!(motion.growth_rate() < 0.0, stable, "{wheel:?}");
            }
        }
        println!("{kind:?}, extreme {extreme}, straight {straight}: {count:?}");
        // What is usual is decided, and the judge decides too.
        if !extreme {
            assert!(200 * count.undecided <= count.claims, "{kind:?} {straight} {count:?}");
            assert!(100 * count.judged >= 95 * count.claims, "{kind:?} {straight} {count:?}");
        }
    }
}

#[test]
fn uniform_motions_solve_the_equations() {
    let mut runner = TestRunner::deterministic();
    for (kind, extreme, straight) in cases() {
        for _ in 0..wheels() {
            let parts = parts().new_tree(&mut runner).unwrap().current();
            let wheel = wheel(kind, extreme, straight, &parts);
            let Ok(motion) = wheel.uniform_motion() else { continue };
            let Some(judgement) = judge::of(&motion) else { continue };
            assert!(judgement.state_error < 1e-6, "{kind:?} {} {wheel:?}", judgement.state_error);
        }
    }
}

#[test]
fn stability_changes_at_critical_speeds() {
    let mut runner = TestRunner::deterministic();
    let mut found = 0;
    for (kind, extreme, straight) in cases() {
        for _ in 0..wheels().div_ceil(10) {
            let parts = parts().new_tree(&mut runner).unwrap().current();
            let wheel = wheel(kind, extreme, straight, &parts);
            let Some(critical) = wheel.critical_speed() else { continue };
            let stable = |part: f64| {
                let motion = wheel.with(Key::V, critical.speed * (1.0 + part)).ok()?.uniform_motion().ok()?;
                judge::of(&motion)?.stable
            };
            let sides = [1e-7, 2e-6].into_iter().find_map(|part| stable(-part).zip(stable(part)));
            if let Some((below, above)) = sides {
                assert_ne!(below, above, "{kind:?} {critical:?} {wheel:?}");
                found += 1;
            }
        }
    }
    assert!(found > 20, "{found}");
}

/// In rectilinear towing too, where the longitudinal motion is neutral: the stability that the search tells is that of the judge, and
/// the Hopf points explain every change of it.
#[test]
fn hopf_points_explain_the_changes_of_stability() {
    let mut runner = TestRunner::deterministic();
    let (mut found, mut ends) = (0, 0);
    for (kind, _, straight) in cases().filter(|(_, extreme, _)| !extreme) {
        for _ in 0..wheels().div_ceil(20) {
            let parts = parts().new_tree(&mut runner).unwrap().current();
            let wheel = wheel(kind, false, straight, &parts);
            let v = wheel.get(Key::V);
            let along = Along::new(Key::V, 0.3 * v, 3.0 * v).unwrap();
            let branch = wheel.motion_branch(along, &MotionOptions::default(), |_| ControlFlow::Continue(()));
            let Ok(branch) = branch else { continue };
            let [low, high] = [branch.motions.first(), branch.motions.last()].map(|motion| motion.unwrap());
            let judged =
                |speed: f64| judge::of(&wheel.with(Key::V, speed).ok()?.uniform_motion().ok()?)?.stable;
            for motion in [low, high] {
                // The branch may be that of another uniform motion than the one that a single wheel is given.
                let there = wheel.with(Key::V, motion.value).unwrap();
                let state: [f64; 5] = motion.state.clone().try_into().unwrap();
                let near = there.uniform_motion_near(&state);
                let stable = near.and_then(|motion| judge::of(&motion)?.stable);
                if let Some((claimed, stable)) = motion.stability.is_stable().zip(stable) {
                    assert_eq!(claimed, stable, "{kind:?} {} {wheel:?}", motion.value);
                    ends += 1;
                }
            }
            // Stability changes only where there is a Hopf point, or a branch point where the longitudinal spring is soft.
            let speeds: Vec<f64> =
                (0..=400).map(|index| v * 0.3 * 10_f64.powf(f64::from(index) / 400.0)).collect();
            for pair in speeds.windows(2) {
                let (Some(one), Some(other)) = (judged(pair[0]), judged(pair[1])) else { continue };
                let mut special = branch.motions.iter().filter(|motion| motion.special.is_some());
                let explained = special.any(|motion| (pair[0]..=pair[1]).contains(&motion.value));
                let inside = low.value <= pair[0] && pair[1] <= high.value;
                assert!(one == other || explained || !inside, "{kind:?} {straight} {pair:?} {wheel:?}");
                found += usize::from(one != other && explained);
            }
        }
    }
    assert!(found > 10 && ends > 100, "{found} {ends}");
}

/// Every curve that a chart draws as a limit of stability separates stable from unstable motions.
#[test]
fn stability_changes_across_its_limits() {
    let mut runner = TestRunner::deterministic();
    let (mut points, mut curves) = (0, 0);
    for (kind, _, straight) in cases().filter(|(_, extreme, _)| !extreme) {
        for _ in 0..wheels().div_ceil(20) {
            let parts = parts().new_tree(&mut runner).unwrap().current();
            let wheel = wheel(kind, false, straight, &parts);
            let [v, l] = [Key::V, Key::L].map(|key| wheel.get(key));
            let axes = [Axis::new(Key::V, 0.2 * v..=4.0 * v), Axis::new(Key::L, 0.2 * l..=5.0 * l)];
            let [x, y] = axes.map(|axis| axis.unwrap());
            let plane = Plane::new(x, y).unwrap();
            for curve in wheel.stability_boundary(&plane, &Control::none()).unwrap() {
                curves += 1;
                // Curves end at corners of the stable region, where it is narrower than any step.
                let ends = [curve.points[0], curve.points[curve.points.len() - 1]];
                let near = |[x, y]: [f64; 2], end: [f64; 2]| {
                    ((x - end[0]) / (3.8 * v)).hypot((y - end[1]) / (4.8 * l)) < 1e-4
                };
                let within = curve.points.iter().filter(|&&point| !ends.iter().any(|&end| near(point, end)));
                for &[x, y] in within.step_by(3) {
                    // In units of the plane. Along one of the axes it goes across the curve.
                    let judged = |[across, up]: [f64; 2]| {
                        let there = wheel.with(Key::V, x + across * 3.8 * v).ok()?;
                        let there = there.with(Key::L, y + up * 4.8 * l).ok()?;
                        judge::of(&there.uniform_motion().ok()?)?.stable
                    };
                    let offsets =
                        [1e-4, 1e-5, 1e-6, 1e-7].into_iter().flat_map(|step| [[step, 0.0], [0.0, step]]);
                    let sides =
                        offsets.filter_map(|[across, up]| judged([-across, -up]).zip(judged([across, up])));
                    let sides: Vec<(bool, bool)> = sides.collect();
                    let changes = sides.iter().any(|(one, other)| one != other);
                    // At a corner even the judge may not tell.
                    assert!(changes || sides.len() < 8, "{kind:?} {straight} {x} {y} {wheel:?}");
                    points += usize::from(changes);
                }
            }
        }
    }
    assert!(points > 200 && curves > 10, "{points} {curves}");
}

/// Wheels at the very edge of stability: a damper so weak, or a circle so wide, that rounding decides.
#[test]
fn what_rounding_decides_is_undecided() {
    let wheel = |settings: &[(Key, f64)]| {
        settings.iter().fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value).unwrap())
    };
    let wide = wheel(&[(Key::CQ, 0.1), (Key::KPsi, 0.1), (Key::TurningRadius, 1e8)]);
    assert_eq!(wide.uniform_motion().unwrap().is_stable(), None);
    // At the critical caster length of straight towing, rounded.
    let critical = Wheel::default().critical_caster_length().unwrap();
    let edge = wheel(&[(Key::L, critical), (Key::TurningRadius, f64::INFINITY)]);
    assert_eq!(edge.uniform_motion().unwrap().is_stable(), None);
    // Without static moment nothing damps a lateral motion at all.
    let balanced = wheel(&[(Key::LC, 0.08), (Key::TurningRadius, f64::INFINITY)]);
    assert_eq!(balanced.uniform_motion().unwrap().is_stable(), Some(false));
}
