//! Result files of the first version: they are read as they were written, and computations start from them.

use arclength_analysis::cycles::CyclesRequest;
use arclength_analysis::{Control, Interval, PointReference, ResultFile};
use kingpin_report::{Report, json};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/files/version_1").join(name)
}

fn written<R: Report>(result: &R) -> Value {
    let mut text = Vec::new();
    json::write(result, &mut text).unwrap();
    serde_json::from_slice(&text).unwrap()
}

#[test]
fn files_are_written_again_as_they_were_read() {
    for (name, labels) in [
        ("equilibria.json", vec!["EP1", "HB1", "EP2"]),
        ("cycles.json", vec!["EP1", "PD1", "EP2"]),
        ("locus.json", vec!["EP1", "EP2"]),
        ("cycle_locus.json", vec!["EP1", "EP2"]),
        ("simulate.json", vec!["END"]),
    ] {
        let file = ResultFile::read(&path(name)).unwrap();
        assert_eq!(file.labels(), labels, "{name}");
        let again = match &file {
            ResultFile::Equilibria(result) => written(result),
            ResultFile::Cycles(result) => written(result),
            ResultFile::Locus(result) => written(result),
            ResultFile::CycleLocus(result) => written(result),
            ResultFile::History(result) => written(result),
        };
        let before: Value = serde_json::from_slice(&std::fs::read(path(name)).unwrap()).unwrap();
        assert_eq!(again, before, "{name}");
    }
}

#[test]
fn cycles_start_from_them() {
    for (file, label, how) in [
        ("equilibria.json", "HB1", "the cycles that are born there"),
        ("cycles.json", "PD1", "the doubled cycles"),
        ("cycle_locus.json", "EP1", "the branch through it"),
    ] {
        let from = PointReference { path: path(file), label: label.to_owned() };
        let mut request = CyclesRequest::new(from, Interval::new("alpha", -2.0, 2.0));
        request.steps.steps = 3;
        request.mesh.tolerance = 1e-4;
        let stop = AtomicBool::new(false);
        let result = request.validate().unwrap().run(&Control::unobserved(&stop)).unwrap();
        assert_eq!(result.from.how, how);
        assert!(result.points.len() > 3 && result.points.iter().all(|point| point.error_estimate < 1e-4));
    }
}
