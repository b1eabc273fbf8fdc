//! Result files of the first version: every field is read as it was written, and computations start from them.

use arclength_analysis::{Control, Interval, PointReference};
use kingpin_analysis::cycles::{CyclesRequest, CyclesResult};
use kingpin_analysis::hopf::HopfResult;
use kingpin_analysis::locus::{LocusRequest, LocusResult};
use kingpin_report::{Report, json};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/files/version_1").join(name)
}

fn read(name: &str) -> Vec<u8> {
    std::fs::read(path(name)).unwrap()
}

fn point(file: &str, label: &str) -> PointReference {
    PointReference { path: path(file), label: label.to_owned() }
}

/// That every field of one value is in the other one; fields may have been added.
#[track_caller]
fn assert_contains(new: &Value, old: &Value) {
    match (new, old) {
        (Value::Object(new), Value::Object(old)) => {
            old.iter().for_each(|(field, value)| assert_contains(&new[field], value));
        }
        (Value::Array(new), Value::Array(old)) => {
            assert_eq!(new.len(), old.len());
            new.iter().zip(old).for_each(|(new, old)| assert_contains(new, old));
        }
        _ => assert_eq!(new, old),
    }
}

#[test]
fn files_are_written_again_with_every_field() {
    fn check<R: Report>(result: &R, file: &[u8]) {
        let mut text = Vec::new();
        json::write(result, &mut text).unwrap();
        assert_contains(&serde_json::from_slice(&text).unwrap(), &serde_json::from_slice(file).unwrap());
    }
    let (hopf, cycles) = (read("hopf.json"), read("cycles.json"));
    check(&serde_json::from_slice::<HopfResult>(&hopf).unwrap(), &hopf);
    check(&serde_json::from_slice::<CyclesResult>(&cycles).unwrap(), &cycles);
}

#[test]
fn cycles_and_curves_start_from_them() {
    let stop = AtomicBool::new(false);
    let control = Control::unobserved(&stop);
    for (file, label) in [("hopf.json", "HB1"), ("cycles.json", "HB1"), ("cycles.json", "AT1")] {
        let mut request = CyclesRequest::new(Interval::new("v", 8.0, 9.0));
        request.from = Some(point(file, label).into());
        let result = request.validate().unwrap().run(&control).unwrap();
        assert!(result.points.len() > 5, "{file}:{label}");
    }
    for file in ["hopf.json", "cycles.json"] {
        let plane = [Interval::new("l", 0.07, 0.09), Interval::new("v", 1.0, 12.0)];
        let mut request = LocusRequest::new(point(file, "HB1"), plane);
        request.at = vec![0.08];
        let LocusResult::Motions(result) = request.validate().unwrap().run(&control).unwrap() else {
            panic!("no curve of Hopf points from {file}")
        };
        let start = result.curve.points.iter().find(|point| point.values[0] == 0.08).unwrap();
        assert!((start.values[1] / 8.431036970142921 - 1.0).abs() < 1e-10, "{file}: {:?}", start.values);
    }
}

#[test]
fn what_was_not_located_is_warned_of_once() {
    let mut file: Value = serde_json::from_slice(&read("cycles.json")).unwrap();
    let change = serde_json::json!({"test": "period doubling", "between": [2.5, 2.6]});
    file["branches"][0]["unlocated"] = serde_json::json!([change, change]);
    let result: CyclesResult = serde_json::from_value(file).unwrap();
    let expected = "the test for a period doubling changes between v = 2.5 m/s and 2.6 m/s, but no such point was located \
                    there; try: shorter steps (--finer 10)";
    assert_eq!(result.warnings(), [expected]);
    let mut story = Vec::new();
    result.story().unwrap().write(&mut story).unwrap();
    assert!(String::from_utf8(story).unwrap().contains(expected));
}
