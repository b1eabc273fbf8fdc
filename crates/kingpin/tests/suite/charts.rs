//! Charts and traced boundaries against the closed form, and against each other.

use arclength::control::{Control, Progress};
use kingpin::{Axis, Key, KingpinError, Plane, Wheel};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

fn plane(x: (Key, f64, f64), y: (Key, f64, f64)) -> Plane {
    Plane::new(Axis::new(x.0, x.1..=x.2).unwrap(), Axis::new(y.0, y.1..=y.2).unwrap()).unwrap()
}

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    settings.iter().fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

const SPEED_AND_LENGTH: ((Key, f64, f64), (Key, f64, f64)) = ((Key::V, 0.0, 12.0), (Key::L, 0.02, 0.2));

/// The vector path, the roots and the definition agree at every point, along any two keys.
#[test]
fn both_charts_agree_with_single_points() {
    for (x, y, settings) in [
        (SPEED_AND_LENGTH.0, SPEED_AND_LENGTH.1, &[][..]),
        ((Key::L, 0.02, 0.2), (Key::Curvature, 0.0, 3.0), &[]),
        ((Key::TurningRadius, 0.2, 3.0), (Key::K, 10.0, 200.0), &[(Key::KU, 3.0)]),
        ((Key::K, 10.0, 200.0), (Key::JWxi, 1e-5, 1e-3), &[(Key::FAz, -3.0)]),
        ((Key::FAz, -20.0, 6.0), (Key::MuS, 0.0, 2.0), &[]),
        ((Key::LC, -0.1, 0.2), (Key::MC, 0.01, 0.3), &[(Key::FAz, -1.0)]),
        ((Key::V, 0.5, 9.0), (Key::CQ, 0.0, 0.3), &[]),
        ((Key::KU, 20.0, 300.0), (Key::V, 0.5, 9.0), &[]),
    ] {
        let wheel = wheel(settings);
        let plane = plane(x, y);
        let growth = wheel.growth_rate_chart(&plane, [45, 31], &Control::none()).unwrap();
        let stability = wheel.stability_chart(&plane, [45, 31], &Control::none()).unwrap();
        assert_eq!((&growth.x, &growth.y), (&stability.x, &stability.y));
        let mut kinds = [0; 2];
        for (index, rate) in growth.growth_rate.iter().enumerate() {
            let (x, y) = (growth.x[index % 45], growth.y[index / 45]);
            let here = wheel.with(plane.y().key(), y).unwrap().with(plane.x().key(), x).unwrap();
            match here.uniform_motion() {
                Err(_) => assert!(rate.is_none() && !stability.stable[index] && !stability.rolls[index]),
                Ok(motion) => {
                    assert_eq!(*rate, Some(motion.growth_rate()));
                    let force = motion.contact_force();
                    if (force.friction() / force.limit - 1.0).abs() > 1e-12 {
                        assert_eq!(
                            [growth.rolls[index], stability.rolls[index]],
                            [motion.rolls(); 2],
                            "{x} {y}"
                        );
                    }
                    if motion.growth_rate().abs() > 1e-9 {
                        assert_eq!(
                            [growth.stable[index], Some(stability.stable[index])],
                            [motion.is_stable(), motion.is_stable()],
                            "{x} {y}"
                        );
                    }
                    kinds[usize::from(motion.is_stable() == Some(true))] += 1;
                }
            }
        }
        assert!(kinds.iter().sum::<i32>() > 200, "{kinds:?}");
    }
}

#[test]
fn charts_do_not_depend_on_the_number_of_threads() {
    let plane = plane(SPEED_AND_LENGTH.0, SPEED_AND_LENGTH.1);
    let compute = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let wheel = Wheel::default();
            (
                wheel.growth_rate_chart(&plane, [301, 77], &Control::none()).unwrap(),
                wheel.stability_chart(&plane, [301, 77], &Control::none()).unwrap(),
            )
        })
    };
    let alone = compute(1);
    assert!(alone == compute(2) && alone == compute(5));
}

#[test]
fn the_observer_sees_progress_and_stops() {
    let plane = plane(SPEED_AND_LENGTH.0, SPEED_AND_LENGTH.1);
    let seen = Mutex::new(Vec::new());
    let record = |progress: Progress<'_>| {
        let Progress::Done(part) = progress else { panic!("{progress:?}") };
        seen.lock().unwrap().push(part);
    };
    let stop = AtomicBool::new(false);
    Wheel::default().growth_rate_chart(&plane, [500, 40], &Control::new(&stop, &record)).unwrap();
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 2 && seen.iter().all(|part| (0.0..=1.0).contains(part)) && seen.contains(&1.0));
    let at_once = |_: Progress<'_>| stop.store(true, Ordering::Relaxed);
    let stopped = Wheel::default().stability_chart(&plane, [500, 40], &Control::new(&stop, &at_once));
    assert!(matches!(stopped, Err(KingpinError::Interrupted(_))));
}

#[test]
fn bad_axes_and_grids_are_refused() {
    let message = |key: Key, start: f64, end: f64| Axis::new(key, start..=end).unwrap_err().to_string();
    assert!(message(Key::V, 3.0, 2.0).contains("v = 3:2: empty interval"));
    assert!(message(Key::V, -1.0, 2.0).contains("v = -1: out of range; allowed: 0 to 1e4 m/s"));
    assert!(message(Key::V, 0.0, f64::NAN).contains("v = NaN: out of range"));
    assert!(message(Key::TurningRadius, 1.0, f64::INFINITY).contains("`curvature`"));
    assert!(message(Key::KU, 1.0, f64::INFINITY).contains("a finite end"));
    let plane = plane(SPEED_AND_LENGTH.0, SPEED_AND_LENGTH.1);
    for points in [[1, 5], [5, 0], [usize::MAX, 2], [100_000, 100_000]] {
        let refused = Wheel::default().growth_rate_chart(&plane, points, &Control::none());
        assert!(matches!(refused, Err(KingpinError::GridSize { .. })));
    }
}

/// Figure 3: one curve for each radius, v = r w_crit(l).
#[test]
fn stability_boundary_is_the_closed_form() {
    for r in [0.5, 1.0, 2.0, 5.0] {
        let wheel = wheel(&[(Key::TurningRadius, r)]);
        let plane = plane((Key::V, 0.0, 12.0), (Key::L, 0.02, 0.2));
        let curves = wheel.stability_boundary(&plane, &Control::none()).unwrap();
        // At r = 5 m the boundary leaves the plane at v = 12 m/s.
        assert_eq!(curves.len(), 1, "r = {r}");
        for curve in &curves {
            assert!(!curve.closed && curve.points.len() > 20);
            for &[v, l] in &curve.points {
                let closed = r * wheel.with(Key::L, l).unwrap().critical_yaw_rate().unwrap();
                // The square, for the curve starts upright at l_crit.
                assert!((v * v - closed * closed).abs() < 1e-8, "{l}: {v} {closed}");
            }
        }
        let (first, last) = (curves[0].points[0], curves[0].points[curves[0].points.len() - 1]);
        for [v, l] in [first, last] {
            // On the axis v = 0 the wheel stands still: the curve ends a hundred-thousandth of the plane before it.
            let on_an_edge = v < 1.2e-4 || (12.0 - v).min(0.2 - l) < 2e-7;
            assert!(on_an_edge, "r = {r}: {v} {l}");
        }
    }
}

#[test]
fn rectilinear_boundary_is_the_critical_caster_length() {
    let wheel = wheel(&[(Key::TurningRadius, f64::INFINITY)]);
    let critical = wheel.critical_caster_length().unwrap();
    let curves =
        wheel.stability_boundary(&plane((Key::L, 0.02, 0.2), (Key::V, 0.0, 12.0)), &Control::none()).unwrap();
    assert_eq!(curves.len(), 1);
    let points = &curves[0].points;
    assert!(points.iter().all(|[l, _]| (l - critical).abs() < 1e-9));
    let (lowest, highest) = points
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high), &[_, v]| (f64::min(low, v), f64::max(high, v)));
    assert!(lowest < 1e-5 && highest > 12.0 - 1e-5, "{lowest} {highest}");
}

/// With damping there is no closed form: points on the curve are zeros of the growth rate, and sides differ.
#[test]
fn boundary_of_a_damped_wheel() {
    let wheel = wheel(&[(Key::CQ, 0.05), (Key::CU, 0.05)]);
    for axes in [((Key::V, 0.1, 12.0), (Key::L, 0.02, 0.2)), ((Key::V, 0.1, 12.0), (Key::CQ, 0.0, 0.5))] {
        let plane = plane(axes.0, axes.1);
        let curves = wheel.stability_boundary(&plane, &Control::none()).unwrap();
        assert!(!curves.is_empty());
        for &[x, y] in curves.iter().flat_map(|curve| &curve.points) {
            let here = wheel.with(axes.0.0, x).unwrap().with(axes.1.0, y).unwrap();
            let growth_rate = here.uniform_motion().unwrap().growth_rate();
            assert!(growth_rate.abs() < 1e-8, "{x} {y} {growth_rate}");
        }
    }
}

/// Figure 4: F_f = mu_s N along the curve, with the closed form of F_f; more load, wider curve.
#[test]
fn rolling_limit_for_several_loads() {
    let mut fastest = 0.0;
    for load in [0.0, -10.0, -20.0, -50.0] {
        let wheel = wheel(&[(Key::FAz, load)]);
        let curves =
            wheel.rolling_limit(&plane((Key::V, 0.0, 14.0), (Key::L, 0.02, 0.2)), &Control::none()).unwrap();
        assert_eq!(curves.len(), 1, "{load}");
        let mut at_8_centimetres: f64 = 0.0;
        for &[v, l] in &curves[0].points {
            let (m, d, omega) = (0.0668 * (l - 0.012), l - 0.012, v);
            let a0 = m * omega * omega / 100.0;
            let forward_speed = omega * (1.0 - (l - a0).powi(2)).sqrt() / (1.0 - a0 / l);
            let friction = (0.3519 + 0.0668 * (l - d) / l) * forward_speed * omega;
            let limit = -load + 0.4187 * 9.81;
            assert!((friction - limit).abs() < 1e-9 * limit, "{v} {l}");
            if (l - 0.08).abs() < 0.005 {
                at_8_centimetres = at_8_centimetres.max(v);
            }
        }
        assert!(at_8_centimetres > fastest);
        fastest = at_8_centimetres;
    }
}
