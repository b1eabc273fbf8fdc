//! Wheels that took minutes.

use arclength::control::Control;
use kingpin::basin::ClassificationSettings;
use kingpin::branches::{Along, MotionOptions};
use kingpin::{Key, Wheel};
use std::ops::ControlFlow;

/// A damped wheel on a circle, the forward speed of which grows beyond all bounds at 76.373614 m/s.
const RACES: &str = "R = 0.128502\nl = 0.0298244\nm_w = 0.231623\nm_c = 0.618648\nJ_wxi = 0.0026071\nJ_wzeta = 0.0014793
J_Cz = 3.66903e-05\nl_c = 0.0269275\nk_q = 2804.08\nk_u = 185801\nc_q = 8.88565\nc_psi = 0.00569885\nv = 8.41295\nr = 0.35355\n";

/// A light one on a weak spring, whose longitudinal motion dies out in half an hour.
const RINGS: &str =
    "R = 0.0271488\nl = 0.0173831\nm_w = 0.042144\nm_c = 0.0424698\nJ_wxi = 2.4694e-05\nJ_wzeta = 1.57441e-05
J_Cz = 2.04294e-06\nl_c = 0.00642704\nk_q = 15132.7\nk_u = 266.601\nv = 0.577594\nr = 2\nc_psi = 0.000503583
F_Az = -129.24\nmu_s = 0.7\nmu_d = 0.6\n";

/// On the way to the place where the motion ends it is followed as far as it means anything, and every Hopf point is found.
#[test]
fn a_motion_whose_speed_grows_without_bound_is_not_followed_for_ever() {
    let wheel = Wheel::from_toml(RACES).unwrap();
    let along = Along::new(Key::V, 60.0, 76.373614).unwrap();
    let mut steps = 0;
    let branch = wheel.motion_branch(along, &MotionOptions::default(), |_| {
        steps += 1;
        ControlFlow::Continue(())
    });
    let branch = branch.unwrap();
    assert!(steps < 300, "{steps}");
    assert!((branch.hopf_points[0].value - 73.6688267819326).abs() < 1e-9);
    let [_, last] = branch.searched();
    assert!((76.36..76.3736).contains(&last), "{last}");
    let end = branch.end_in_words(1).unwrap();
    assert!(end.contains("grows without bound"), "{end}");
    let over_speed = wheel.stability_over_speed(&Control::none()).unwrap();
    let changes: Vec<String> = over_speed.changes.iter().map(|speed| format!("{speed:.4}")).collect();
    assert_eq!(changes, ["0.2852", "73.6688"]);
    assert_eq!(over_speed.not_followed, [[0.0; 2]; 0]);
}

/// Along any parameter: the end is where m omega^2 comes to k_q l.
#[test]
fn it_ends_along_a_radius_too() {
    let wheel = Wheel::from_toml(RACES).unwrap().with(Key::V, 20.0).unwrap();
    let along = Along::new(Key::TurningRadius, 0.01, 2.0).unwrap();
    let branch =
        wheel.motion_branch(along, &MotionOptions::default(), |_| ControlFlow::Continue(())).unwrap();
    assert!(branch.motions.len() < 600, "{}", branch.motions.len());
    let ends = [0, 1].map(|end| branch.end_in_words(end).unwrap());
    assert!(ends.iter().any(|end| end.contains("grows without bound")), "{ends:?}");
}

/// Where motions would have to be followed for longer than they ever are they are not followed for minutes.
#[test]
fn a_decay_that_nobody_waits_for_is_not_waited_for() {
    let seconds = |wheel: &Wheel| ClassificationSettings::for_wheel(wheel).unwrap().duration;
    let wheel = Wheel::from_toml(RINGS).unwrap();
    assert_eq!(seconds(&wheel), 30.0);
    // A decay time of some seconds, and one of a minute.
    assert!((40.0..50.0).contains(&seconds(&wheel.with(Key::CU, 0.3).unwrap())));
    let slow = wheel.with(Key::CU, 0.003).unwrap();
    let decay = -slow.uniform_motion().unwrap().growth_rate();
    assert!((0.01..0.04).contains(&decay), "{decay}");
    assert_eq!(seconds(&slow), 300.0);
}
