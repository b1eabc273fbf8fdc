//! Everything that takes long stops soon after it is asked to, and says so.

use arclength::control::{Control, Interrupted, Progress};
use kingpin::basin::{
    Axis as StateAxis, BasinMap, ClassificationSettings, ContactModel, Destinations, Disturbance, SafeKick,
};
use kingpin::branches::Along;
use kingpin::ensemble::Ensemble;
use kingpin::shimmy::{ShimmyError, SlidingBranchEnd, SlidingBranchOptions, SlidingMotionSearch};
use kingpin::simulation::SimulationError;
use kingpin::{Axis, Key, KingpinError, Plane, Wheel};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Long before any of the computations below would be done by itself, long after a computation that looks at its control.
const SOON: Duration = Duration::from_secs(3);

/// Runs a computation that takes minutes and asks it to stop a little later.
fn interrupted<T: Send>(computation: impl FnOnce(&Control<'_>) -> T + Send) -> T {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let running = scope.spawn(|| computation(&Control::unobserved(&stop)));
        std::thread::sleep(Duration::from_millis(100));
        assert!(!running.is_finished(), "done before it was interrupted: the test shows nothing");
        let asked = Instant::now();
        stop.store(true, Ordering::Relaxed);
        let result = running.join().unwrap();
        assert!(asked.elapsed() < SOON, "it went on for {:?}", asked.elapsed());
        result
    })
}

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    settings.iter().fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// A wheel so near its limit of stability that small disturbances make it tumble for ever.
fn tumbling(settings: &[(Key, f64)]) -> Wheel {
    settings.iter().fold(wheel(&[(Key::V, 8.43)]), |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// A wheel that may slide and shimmies by itself.
fn shimmying() -> Wheel {
    wheel(&[(Key::L, 0.03), (Key::V, 0.5), (Key::Curvature, 0.0), (Key::CU, 0.1), (Key::CQ, 0.1)])
}

fn is_interrupted<T>(result: Result<T, SimulationError>) -> bool {
    matches!(result, Err(SimulationError::Interrupted(Interrupted)))
}

#[test]
fn time_histories_are_interrupted() {
    // One that comes to rest takes long steps there.
    let tumbling = tumbling(&[]);
    let rolling = interrupted(|control| tumbling.simulate(1e6, &[("psi", 0.1)], 11, control));
    assert!(is_interrupted(rolling));
    let sliding = shimmying().sliding().unwrap();
    let start = shimmying().perturbed_uniform_motion(&[("psi", 0.2)]).unwrap();
    assert!(is_interrupted(interrupted(|control| sliding.simulate(&start, 1e5, 11, control))));
    let history = interrupted(|control| {
        Disturbance::ReleaseAngle.history(&tumbling, ContactModel::Rolling, 0.1, 1e6, 11, control)
    });
    assert!(is_interrupted(history));
}

#[test]
fn ensembles_are_interrupted() {
    let start = Wheel::default().perturbed_uniform_motion(&[("psi", 0.1)]).unwrap();
    let ensemble = Ensemble::new(&Wheel::default()).unwrap().maximum_steps(u32::MAX);
    assert!(is_interrupted(interrupted(|control| ensemble.integrate(&[start; 8], 1e6, control))));
}

#[test]
fn basins_are_interrupted_inside_a_tile() {
    for (wheel, model) in [
        (tumbling(&[]), ContactModel::Rolling),
        // Damped in one direction only it has no quadratic form, so that its motions are followed one by one.
        (tumbling(&[(Key::CU, 1e-9)]), ContactModel::Rolling),
        (tumbling(&[(Key::FAz, -1e4)]), ContactModel::Sliding),
    ] {
        let settings = ClassificationSettings::with_duration(1e5);
        let destinations = Destinations::new(&wheel, model, settings).unwrap();
        let axes = [StateAxis::new("psi", 0.3, 0.5).unwrap(), StateAxis::new("Omega", 1.0, 9.0).unwrap()];
        let map = BasinMap::grid(&destinations, &axes, [2, 2]).unwrap();
        let tiles = interrupted(|control| map.run(control, |_| false, |_| {})).unwrap();
        assert!(tiles.is_empty(), "{model:?}: a tile that was not finished is not told");
        let states: Vec<[f64; 5]> = map
            .initial_states()
            .iter()
            .map(|&[u, q, psi, speed, _, yaw, _]| [u, q, psi, speed, yaw])
            .collect();
        assert!(is_interrupted(interrupted(|control| destinations.of(&states, control))));
    }
}

#[test]
fn the_search_for_a_safe_kick_is_interrupted() {
    let settings = ClassificationSettings::with_duration(1e5);
    let search = |control: &Control<'_>| {
        SafeKick::find(
            &tumbling(&[]),
            ContactModel::Rolling,
            settings,
            Disturbance::ReleaseAngle,
            1.0,
            control,
        )
    };
    assert!(is_interrupted(interrupted(search)));
}

#[test]
fn charts_and_boundaries_are_interrupted() {
    let plane = Plane::new(Axis::new(Key::V, 0.1..=10.0).unwrap(), Axis::new(Key::CQ, 0.0..=1.0).unwrap());
    let plane = plane.unwrap();
    let growth = interrupted(|control| Wheel::default().growth_rate_chart(&plane, [3000, 3000], control));
    assert!(matches!(growth, Err(KingpinError::Interrupted(_))));
    // A boundary takes milliseconds: stopped before it starts.
    let stopped = AtomicBool::new(true);
    let control = Control::unobserved(&stopped);
    assert_eq!(Wheel::default().stability_boundary(&plane, &control), Err(Interrupted));
    assert_eq!(Wheel::default().rolling_limit(&plane, &control), Err(Interrupted));
    let along = Along::new(Key::V, 1.0, 12.0).unwrap();
    let search = Wheel::default().hopf_points(along, &control);
    assert!(matches!(search, Err(KingpinError::Interrupted(_))));
}

#[test]
fn shimmy_is_interrupted_while_it_settles_and_along_its_branch() {
    let wheel = shimmying();
    let start = wheel.perturbed_uniform_motion(&[("psi", 0.2)]).unwrap();
    let search = SlidingMotionSearch { settling_time: 1e5, ..SlidingMotionSearch::default() };
    let settling = interrupted(|control| wheel.sliding_motion(&start, &search, control));
    assert!(matches!(settling, Err(ShimmyError::Interrupted(Interrupted))));

    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    let motion = wheel.sliding_motion(&start, &search, &Control::none()).unwrap();
    let stop = AtomicBool::new(false);
    let mut told = 0;
    let third = |_: f64, _: &_| {
        told += 1;
        stop.store(told >= 3, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let along = Along::new(Key::V, 0.1, 2.0).unwrap();
    let options = SlidingBranchOptions::default();
    let branch = motion.along(along, &options, &Control::unobserved(&stop), third).unwrap();
    assert!(branch.ends.iter().all(|end| {
        matches!(end, SlidingBranchEnd::Continuation(arclength::continuation::Stop::Interrupted))
    }));
    assert_eq!(branch.points.len(), 3);
}

#[test]
fn progress_runs_from_nothing_to_everything() {
    let told = Mutex::new(Vec::new());
    let stop = AtomicBool::new(false);
    let observer = |progress: Progress<'_>| {
        if let Progress::Done(part) = progress {
            told.lock().unwrap().push(part);
        }
    };
    let control = Control::new(&stop, &observer);
    let settings = ClassificationSettings::default();
    let (wheel, model) = (Wheel::default(), ContactModel::Rolling);
    SafeKick::find(&wheel, model, settings, Disturbance::Impulse, 1.0, &control).unwrap().unwrap();
    wheel.simulate(10.0, &[("psi", 0.1)], 11, &control).unwrap();
    let told = told.into_inner().unwrap();
    assert!(told.len() > 100 && told.iter().all(|part| (0.0..=1.0).contains(part)), "{told:?}");
}
