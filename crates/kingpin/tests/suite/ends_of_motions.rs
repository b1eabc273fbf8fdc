//! Where the uniform motion ends inside an interval, and what is known of it up to there.

use arclength::continuation::Stop;
use arclength::control::Control;
use kingpin::branches::{Along, MotionBranch, MotionOptions};
use kingpin::{Key, Wheel};
use std::ops::ControlFlow;

fn followed(toml: &str, from: f64, to: f64) -> MotionBranch {
    let wheel = Wheel::from_toml(toml).unwrap();
    let along = Along::new(Key::V, from, to).unwrap();
    wheel.motion_branch(along, &MotionOptions::default(), |_| ControlFlow::Continue(())).unwrap()
}

/// Behind the fold at 1.0965 m/s the equations have motions with `V1 < 0`, which are none of a tyre.
#[test]
fn motions_of_a_tyre_end_where_the_wheel_stops_rolling_forwards() {
    let branch = followed(include_str!("../wheels/turns_backwards.toml"), 0.05, 2.0);
    let speeds: Vec<f64> = branch.motions.iter().map(|motion| motion.state[3]).collect();
    assert!(speeds.iter().all(|speed| *speed > -1e-12), "{speeds:?}");
    let [lowest, highest] = branch.searched();
    assert!(lowest == 0.05 && (highest - 1.096_545_4).abs() < 1e-6, "{lowest} {highest}");
    assert!(branch.hopf_points.iter().all(|hopf| hopf.motion().forward_speed() > 0.0));
    let values: Vec<f64> = branch.hopf_points.iter().map(|hopf| hopf.value).collect();
    assert!((values[0] - 0.061_635_125).abs() < 1e-8, "{values:?}");
    assert!(values.iter().all(|value| (value - 0.654_326).abs() > 1e-3), "{values:?}");
    assert!(matches!(branch.stops[1], Some(Stop::Monitor { .. })), "{:?}", branch.stops);
    let words = branch.end_in_words(1).unwrap();
    assert!(words.starts_with("V1/v of the uniform motion") && words.contains("the value 0"), "{words}");
}

/// What is found does not depend on how far beyond its end the motion is asked for.
#[test]
fn hopf_points_up_to_the_end_of_the_motion_are_found() {
    let toml = include_str!("../wheels/ends_on_the_circle.toml");
    let published = [0.591_390_26, 3.116_848_6, 3.739_919_4];
    for fastest in [4.0, 5.0, 20.0, 60.0] {
        let wheel = Wheel::from_toml(toml).unwrap();
        let search = wheel.hopf_points(Along::new(Key::V, 0.1, fastest).unwrap(), &Control::none()).unwrap();
        for expected in published {
            assert!(
                search.points.iter().any(|hopf| (hopf.value - expected).abs() < 1e-7),
                "{fastest}: {expected}"
            );
        }
        for hopf in &search.points {
            let motion = hopf.motion();
            assert!(motion.residual() < 1e-8 && motion.forward_speed() > 0.0, "{fastest}: {}", hopf.value);
            assert!(motion.forces().is_ok());
        }
    }
}
