//! Cycles of the wheel that start from samples of an orbit.

use arclength::cycle::Orbit;
use arclength_analysis::{Assignment, Control, CycleSource, Interval};
use kingpin_analysis::WheelRequest;
use kingpin_analysis::cycles::{CyclePointResult, CyclesRequest, CyclesResult};
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn run(request: &CyclesRequest) -> CyclesResult {
    let stop = AtomicBool::new(false);
    request.validate().unwrap().run(&Control::unobserved(&stop)).unwrap()
}

fn asked(result: &CyclesResult) -> &CyclePointResult {
    let is_asked = |point: &&CyclePointResult| point.cycle.label.as_deref() == Some("AT1");
    result.points.iter().find(is_asked).unwrap()
}

fn write(path: &Path, states: &[&str], orbit: &Orbit) {
    let mut text = format!("friction_force,{},t\n", states.join(","));
    for row in 0..=200 {
        let time = orbit.period * f64::from(row) / 200.0;
        let state: Vec<String> = orbit.state_at(time).iter().map(f64::to_string).collect();
        writeln!(text, ",{},{time}", state.join(",")).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

#[track_caller]
fn the_same_cycle_is_found_again(set: &[(&str, &str)], along: Interval, at: f64, states: &[&str]) {
    let set =
        set.iter().map(|(key, value)| Assignment { key: (*key).to_owned(), value: (*value).to_owned() });
    let wheel = WheelRequest { set: set.collect(), ..WheelRequest::default() };
    let mut request = CyclesRequest::new(along.clone());
    request.at = vec![at];
    request.wheel = wheel.clone();
    let first = run(&request);
    let cycle = &asked(&first).cycle;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("orbit.csv");
    write(&path, states, cycle.orbit.as_ref().unwrap());
    request.wheel.set.push(Assignment { key: along.key, value: at.to_string() });
    request.along = Interval::new("v", 0.9 * at, 1.1 * at);
    request.from = Some(CycleSource::Samples { samples: path.clone() });
    let second = run(&request);
    let again = &asked(&second).cycle;
    let close = |one: f64, other: f64| (one - other).abs() <= 1e-8 * one.abs();
    assert!(close(cycle.period, again.period), "{} {}", cycle.period, again.period);
    for ((name, one), (_, other)) in cycle.max.0.iter().zip(&again.max.0) {
        assert!(close(*one, *other), "{name}: {one} {other}");
    }
    assert_eq!((cycle.stable, "the orbit in orbit.csv"), (again.stable, second.branches[0].from.as_str()));

    write(&path, &states[1..], cycle.orbit.as_ref().unwrap());
    let error = request.validate().unwrap_err().to_string();
    assert!(
        error.contains(&format!("orbit.csv: line 1, column {}: there is no such column", states[0])),
        "{error}"
    );
}

#[test]
fn an_unstable_cycle_of_the_paper() {
    let along = Interval::new("v", 2.0, 9.0);
    the_same_cycle_is_found_again(&[], along, 4.0, &["u", "q", "psi", "V", "Omega"]);
}

#[test]
fn a_cycle_of_a_wheel_with_lateral_elasticity_only() {
    let along = Interval::new("v", 0.015, 60.0);
    let set = [("k_u", "inf"), ("l", "0.04"), ("r", "inf"), ("c_q", "0.05")];
    the_same_cycle_is_found_again(&set, along, 10.0, &["q", "psi", "Omega"]);
}
