//! Requests as plain data: what they stand for, what is refused, and how a control stops them.

use arclength_analysis::cycles::CyclesRequest;
use arclength_analysis::equilibria::EquilibriaRequest;
use arclength_analysis::locus::LocusRequest;
use arclength_analysis::simulate::SimulateRequest;
use arclength_analysis::{
    AnalysisError, Control, CycleSource, FilesInMemory, Interval, ModelRequest, ModelSource, PointReference,
    Progress, StoredModel,
};
use kingpin_report::NamedNumbers;
use serde_json::{from_value, json, to_value};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

fn model() -> ModelRequest {
    let source = "x' = p - x^2\npar p=1\ninit x=1\n".to_owned();
    ModelRequest::new(ModelSource::Text(StoredModel {
        name: "fold.ode".to_owned(),
        source,
        frozen_time: None,
    }))
}

#[test]
fn what_is_not_given_has_its_default() {
    let reference = PointReference { path: "a.json".into(), label: "HB1".to_owned() };
    let from = json!({"path": "a.json", "label": "HB1"});
    let [alpha, beta] =
        [("alpha", 0.0, 1.0), ("beta", 2.0, 3.0)].map(|(key, start, end)| Interval::new(key, start, end));
    let interval = |key: &str, start: f64, end: f64| json!({"key": key, "start": start, "end": end});

    let short = json!({"from": from, "along": interval("alpha", 0.0, 1.0)});
    let request = CyclesRequest::new(reference.clone(), alpha.clone());
    assert_eq!(from_value::<CyclesRequest>(short).unwrap(), request);
    let whole = to_value(&request).unwrap();
    for (field, value) in [("steps", json!(10_000)), ("finer", json!(1)), ("tolerance", json!(1e-8))] {
        assert_eq!(whole[field], value);
    }
    assert_eq!(from_value::<CyclesRequest>(whole).unwrap(), request);

    let short = json!({"from": {"samples": "o.csv"}, "model": {"file": "m.ode"}, "along": interval("alpha", 0.0, 1.0)});
    let samples = CycleSource::Samples { samples: "o.csv".into() };
    let mut request = CyclesRequest::new(samples, alpha.clone());
    request.model = Some(ModelSource::File("m.ode".into()));
    assert_eq!(from_value::<CyclesRequest>(short).unwrap(), request);
    assert_eq!(from_value::<CyclesRequest>(to_value(&request).unwrap()).unwrap(), request);

    let short = json!({"from": from, "in": [interval("alpha", 0.0, 1.0), interval("beta", 2.0, 3.0)]});
    assert_eq!(from_value::<LocusRequest>(short).unwrap(), LocusRequest::new(reference, [alpha, beta]));

    let short = json!({"model": {"source": {"file": "m.ode"}}, "duration": 2.0});
    let file = ModelRequest::new(ModelSource::File("m.ode".into()));
    assert_eq!(from_value::<SimulateRequest>(short).unwrap(), SimulateRequest::new(file, 2.0));
}

#[test]
fn what_makes_no_sense_is_refused_by_the_name_of_its_field() {
    let along = Interval::new("q", 0.0, 1.0);
    let error = EquilibriaRequest::new(model(), along).validate().unwrap_err();
    assert!(error.is_bad_request());
    assert!(error.to_string().starts_with("along q: the model has no such parameter"), "{error}");
    assert!(error.message(&|field| format!("<{field}>")).starts_with("<along> q: "));

    let mut request = EquilibriaRequest::new(model(), Interval::new("p", 0.0, 1.0));
    request.at = vec![2.0];
    assert_eq!(request.validate().unwrap_err().to_string(), "at 2: outside the interval; allowed: 0 to 1");
    request.at.clear();
    request.model.set = NamedNumbers(vec![("p".to_owned(), f64::NAN)]);
    assert!(request.validate().unwrap_err().to_string().contains("not a finite number"));
    request.model.set = NamedNumbers::default();
    request.steps.finer = 0;
    assert_eq!(request.validate().unwrap_err().to_string(), "finer 0: out of range; allowed: 1 to 100000");
    let reference = PointReference { path: "a.json".into(), label: "HB1".to_owned() };
    let mut request = CyclesRequest::new(reference, Interval::new("p", 0.0, 1.0));
    request.mesh.tolerance = f64::NAN;
    let error = request.validate().unwrap_err().to_string();
    assert_eq!(error, "tolerance NaN: out of range; allowed: 1e-13 to 0.1");
    assert!(SimulateRequest::new(model(), -1.0).validate().unwrap_err().is_bad_request());
}

#[test]
fn a_control_is_told_the_way_and_stops_it() {
    let request = EquilibriaRequest::new(model(), Interval::new("p", -1.0, 4.0));
    let analysis = request.validate().unwrap();
    let stop = AtomicBool::new(false);
    let told = Mutex::new(Vec::new());
    let observer = |progress: Progress<'_>| {
        let Progress::At(place) = progress else { panic!("{progress:?}") };
        let mut told = told.lock().unwrap();
        told.push(place.to_owned());
        stop.store(told.len() == 3, Ordering::Relaxed);
    };
    let stopped = analysis.run(&Control::new(&stop, &observer)).unwrap();
    assert!(stopped.ends.iter().any(|end| end.cause == "interrupted"), "{:?}", stopped.ends);
    assert!(told.lock().unwrap()[0].starts_with("equilibria, p = "));

    stop.store(false, Ordering::Relaxed);
    let whole = analysis.run(&Control::unobserved(&stop)).unwrap();
    assert!(whole.points.len() > stopped.points.len());
    // x' = p - x^2 has its fold at the origin.
    let fold = whole.points.iter().find(|point| point.label.as_deref() == Some("LP1")).unwrap();
    assert!(fold.value.abs() < 1e-12);
}

#[test]
fn a_motion_is_stopped_where_it_is() {
    let stop = AtomicBool::new(true);
    let analysis = SimulateRequest::new(model(), 1e6).validate().unwrap();
    let result = analysis.run_under(&Control::unobserved(&stop)).unwrap();
    assert!(result.t.first() == Some(&0.0) && result.t.len() < 1001, "{} samples", result.t.len());
    assert!(result.warnings.iter().any(|warning| warning.starts_with("interrupted at t = ")));
    assert_eq!(analysis.run_under(&Control::none()).unwrap().t, analysis.run().unwrap().t);
}

#[test]
fn files_in_memory_are_the_only_ones_there_are() {
    let from: PointReference = "equilibria.json:LP1".parse().unwrap();
    let along = Interval::new("p", -1.0, 1.0);
    let result =
        EquilibriaRequest::new(model(), along.clone()).validate().unwrap().run(&Control::none()).unwrap();
    let mut text = Vec::new();
    kingpin_report::json::write(&result, &mut text).unwrap();
    let files = FilesInMemory::from_iter([("equilibria.json".to_owned(), text)]);
    let request = EquilibriaRequest::new(ModelRequest::new(ModelSource::Point(from.clone())), along);
    let mut found = 0;
    let again = request.validate_among(&files).unwrap();
    let again = again.run_watched(&Control::none(), &mut |point| {
        assert_eq!(point.max, point.min);
        found += 1;
    });
    assert!(found >= again.unwrap().points.len());
    // Neither is on the disk.
    assert!(request.validate().is_err());
    assert!(request.validate_among(&FilesInMemory::default()).is_err());
}
