//! Derivatives of motions against differences, and records without noise.

use super::motion::{Direction, EstimatedWheel};
use super::{Column, Identification, IdentificationError, Record, Start};
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::control::Control;

fn wheel(values: &[(&str, &str)]) -> Wheel {
    let mut wheel = Wheel::default();
    for (key, value) in values {
        wheel.set(key, value).unwrap();
    }
    wheel
}

fn times(duration: f64, count: usize) -> Vec<f64> {
    (0..count).map(|index| duration * index as f64 / (count - 1) as f64).collect()
}

/// A record of some states of a motion without noise.
fn record(truth: &Wheel, start: &[f64], duration: f64, count: usize, states: &[&str]) -> Record {
    let times = times(duration, count);
    let motion = EstimatedWheel { wheel: *truth, keys: &[] };
    let samples = motion.states(start, &times, &Control::none()).unwrap();
    let column = |state: &&str| {
        let index = truth.free_states().iter().position(|name| name == state).unwrap();
        Column { state: (*state).to_owned(), values: samples.iter().map(|sample| sample[index]).collect() }
    };
    Record { wheel: *truth, columns: states.iter().map(column).collect(), times }
}

/// The same with a wheel to start from.
fn supposed(mut record: Record, values: &[(Key, f64)]) -> Record {
    for &(key, value) in values {
        record.wheel.set_value(key, value).unwrap();
    }
    record
}

/// Largest difference between the derivatives of a motion and differences of fourth order, relative to the size of each, at 41 times of
/// which those near some events are left out: there a difference has motions from both sides of the event.
fn error_of_derivatives(wheel: &Wheel, keys: &[Key], start: &[f64], duration: f64, events: &[f64]) -> f64 {
    const NEAR: f64 = 2e-3;
    const STEP: f64 = 1e-4;
    let n = start.len();
    let mut times = times(duration, 41);
    times.retain(|time| events.iter().all(|event| (event - time).abs() > NEAR));
    let estimated = EstimatedWheel { wheel: *wheel, keys };
    let scale = |key: Key| wheel.get(key).abs();
    let of_parameters = keys
        .iter()
        .enumerate()
        .map(|(index, &key)| Direction { parameter: Some((index, scale(key))), start: vec![0.0; n] });
    let of_states = (0..n).map(|index| {
        let mut change = vec![0.0; n];
        change[index] = start[index].abs().max(1e-3);
        Direction { parameter: None, start: change }
    });
    let directions: Vec<Direction> = of_parameters.chain(of_states).collect();
    let exact = estimated.derivatives(start, &directions, &times, &Control::none()).unwrap();
    let mut largest = 0.0_f64;
    for (number, direction) in directions.iter().enumerate() {
        let moved = |step: f64| {
            let wheel = match direction.parameter {
                Some((index, scale)) => {
                    wheel.with(keys[index], wheel.get(keys[index]) + step * scale).unwrap()
                }
                None => *wheel,
            };
            let start: Vec<f64> =
                start.iter().zip(&direction.start).map(|(x, change)| x + step * change).collect();
            EstimatedWheel { wheel, keys }.states(&start, &times, &Control::none()).unwrap()
        };
        let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(|steps| moved(steps * STEP));
        for state in 0..n {
            let size = exact.iter().map(|sample| sample[number][state].abs()).fold(1e-6, f64::max);
            for (time, exact) in exact.iter().enumerate() {
                let [one, two] = [(&above, &below), (&far_above, &far_below)]
                    .map(|(above, below)| above[time][state] - below[time][state]);
                let difference = (8.0 * one - two) / (12.0 * STEP);
                largest = largest.max((exact[number][state] - difference).abs() / size);
            }
        }
    }
    largest
}

#[test]
fn derivatives_of_smooth_motions_are_those_of_differences() {
    let keys = [Key::K, Key::CQ, Key::CPsi, Key::V, Key::L, Key::MC];
    let elastic = wheel(&[("c_q", "0.2"), ("c_psi", "0.002"), ("c_u", "0.3")]);
    let error = error_of_derivatives(&elastic, &keys, &[0.001, -0.002, 0.3, 4.0, 5.0], 0.4, &[]);
    assert!(error < 1e-5, "{error}");
    let lateral = wheel(&[("k_u", "inf"), ("r", "inf"), ("c_q", "0.2"), ("c_psi", "0.002")]);
    let error =
        error_of_derivatives(&lateral, &[Key::KQ, Key::CQ, Key::CPsi, Key::V], &[0.001, 0.2, 1.0], 0.4, &[]);
    assert!(error < 1e-5, "{error}");
    let tyre =
        wheel(&[("tyre", "linear"), ("sigma", "0.05"), ("C_alpha", "500"), ("r", "inf"), ("c_psi", "0.002")]);
    let start = [0.001, -0.002, 0.2, 4.0, 0.0, 1.0, 0.001];
    let error = error_of_derivatives(&tyre, &[Key::K, Key::Sigma, Key::CAlpha, Key::CPsi], &start, 0.4, &[]);
    assert!(error < 1e-5, "{error}");
}

#[test]
fn derivatives_hold_through_swings_and_rests() {
    let keys = [Key::K, Key::CQ, Key::CPsi, Key::MF, Key::V];
    // The caster swings and sticks by turns, straight and on a circle.
    for (path, moment, start) in
        [("inf", "0.05", [0.0, 0.001, 0.3, 1.0, -2.0]), ("2", "0.02", [0.0, -0.01, 0.3, 1.0, 2.0])]
    {
        let dry = wheel(&[("r", path), ("v", "1"), ("M_f", moment), ("c_q", "0.2"), ("c_psi", "0.0005")]);
        let phases = dry.simulate_from(&start, 1.0, 2, &Control::none()).unwrap().phases;
        let sticks =
            phases.iter().filter(|phase| phase.king_pin == crate::sliding::KingPin::Sticking).count();
        assert!(sticks >= 3, "{path}: {sticks} rests in {} phases", phases.len());
        let events: Vec<f64> = phases.iter().map(|phase| phase.end).collect();
        let error = error_of_derivatives(&dry, &keys, &start, 1.0, &events);
        assert!(error < 1e-5, "{path}: {error}");
    }
}

#[test]
fn a_record_without_noise_gives_back_the_truth() {
    let truth = wheel(&[("r", "inf"), ("v", "1.5"), ("k", "80"), ("c_q", "0.3"), ("c_psi", "0.003")]);
    let measured = record(&truth, &[0.0, 0.002, 0.3, 1.5, 3.0], 1.5, 151, &["psi"]);
    let guess = supposed(measured, &[(Key::K, 150.0), (Key::CQ, 0.0), (Key::CPsi, 0.0)]);
    let identification = Identification::new(vec![guess], &[Key::K, Key::CQ, Key::CPsi]).unwrap();
    let found = identification.run(&Control::none()).unwrap();
    for key in [Key::K, Key::CQ, Key::CPsi] {
        let error = found.wheel.get(key) / truth.get(key) - 1.0;
        assert!(error.abs() < 1e-8, "{key}: {error}");
    }
    assert!((found.records[0].start[4] - 3.0).abs() < 1e-7);
}

#[test]
fn dry_friction_is_found_in_a_record_without_noise() {
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("M_f", "0.02"), ("c_psi", "0.001")]);
    let measured = record(&truth, &[0.0, 0.0, 0.4, 1.0, 0.0], 2.0, 201, &["psi"]);
    let guess = supposed(measured, &[(Key::K, 130.0), (Key::MF, 0.0), (Key::CPsi, 0.0)]);
    let identification = Identification::new(vec![guess], &[Key::K, Key::CPsi, Key::MF]).unwrap();
    let found = identification.run(&Control::none()).unwrap();
    for key in [Key::K, Key::CPsi, Key::MF] {
        let error = found.wheel.get(key) / truth.get(key) - 1.0;
        assert!(error.abs() < 1e-7, "{key}: {error}");
    }
}

#[test]
fn stiffnesses_far_from_the_truth_lead_to_it() {
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("c_psi", "0.001")]);
    let measured = record(&truth, &[0.0, 0.0, 0.3, 1.0, 0.0], 2.0, 101, &["psi"]);
    for supposed_stiffness in [3.0, 3000.0] {
        let guess = supposed(measured.clone(), &[(Key::K, supposed_stiffness)]);
        let found =
            Identification::new(vec![guess], &[Key::K, Key::CPsi]).unwrap().run(&Control::none()).unwrap();
        assert!((found.wheel.get(Key::K) - 100.0).abs() < 1e-5, "{}", found.wheel.get(Key::K));
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let truth = wheel(&[("r", "inf"), ("v", "1")]);
    let good = record(&truth, &[0.0, 0.0, 0.3, 1.0, 0.0], 1.0, 21, &["psi"]);
    let message = |change: &dyn Fn(&mut Record), keys: &[Key]| {
        let mut record = good.clone();
        change(&mut record);
        Identification::new(vec![record], keys).unwrap_err().to_string()
    };
    assert_eq!(
        message(&|record| record.times[3] = 0.0, &[Key::K]),
        "record 1: the times do not grow from sample to sample"
    );
    assert!(
        message(&|record| record.columns[0].state = "phi".to_owned(), &[Key::K])
            .contains("allowed: u, q, psi, V, Omega")
    );
    assert!(message(&|record| record.columns[0].values[5] = f64::NAN, &[Key::K]).contains("not finite"));
    assert!(message(&|_| {}, &[Key::MuS]).contains("does not depend on it"));
    assert!(message(&|_| {}, &[Key::K, Key::KQ]).contains("k_q"));
    let few = record(&truth, &[0.0, 0.0, 0.3, 1.0, 0.0], 1.0, 5, &["psi"]);
    let error = Identification::new(vec![few], &[Key::K, Key::CQ, Key::CPsi]).unwrap().run(&Control::none());
    assert!(matches!(error, Err(IdentificationError::TooFewValues { values: 5, unknowns: 6, .. })));
    let still = supposed(record(&truth, &[0.0, 0.0, 0.0, 1.0, 0.0], 1.0, 21, &["psi"]), &[]);
    let error = Identification::new(vec![still], &[Key::K]).unwrap().run(&Control::none()).unwrap_err();
    assert!(error.to_string().contains("nothing moves"), "{error}");
}

#[test]
fn what_is_known_of_the_start_is_used() {
    let truth = wheel(&[("v", "1.5"), ("c_psi", "0.003"), ("c_u", "0.2"), ("c_q", "0.1")]);
    let [u, q, psi, speed, yaw] = truth.uniform_motion().unwrap().state();
    // Released at rest about the king pin.
    let measured = record(&truth, &[u, q, psi + 0.2, speed, yaw], 1.0, 101, &["psi"]);
    let guess = supposed(measured, &[(Key::K, 120.0)]);
    let identification = Identification::new(vec![guess], &[Key::K, Key::CPsi]).unwrap();
    let identification =
        identification.start("q", Start::Uniform).unwrap().start("Omega", Start::Uniform).unwrap();
    let found = identification.run(&Control::none()).unwrap();
    assert_eq!(found.unknowns, ["k", "c_psi", "psi at the start of record 1"]);
    assert!((found.wheel.get(Key::K) - 100.0).abs() < 1e-6);
    assert!((found.records[0].start[1] - q).abs() < 1e-9);
}
