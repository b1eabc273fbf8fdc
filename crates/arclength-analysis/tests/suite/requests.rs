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
    of_text("x' = p - x^2\npar p=1\ninit x=1\n")
}

fn of_text(source: &str) -> ModelRequest {
    ModelRequest::new(ModelSource::Text(StoredModel {
        name: "model.ode".to_owned(),
        source: source.to_owned(),
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

#[test]
fn an_infinite_parameter_is_refused_by_its_name() {
    let text = "x' = p - x^2\npar p=1\npar it2=inf\ninit x=1\nx2'=-x2*heav(it2-1)\n";
    let request = EquilibriaRequest::new(of_text(text), Interval::new("p", 0.0, 1.0));
    let error = request.validate().unwrap_err();
    assert!(error.is_bad_request());
    let right = "set it2=inf: not a finite number, and the model has it in line 3; allowed: a finite number";
    assert_eq!(error.to_string(), right);
}

#[test]
fn a_start_without_right_hand_side_is_told_by_equation_cause_and_remedy() {
    let request = SimulateRequest::new(of_text("par a=1\nphase'=0\nk=a/phase\nx'=sin(k)\n"), 1.0);
    let error = request.validate().unwrap().run().unwrap_err();
    assert!(!error.is_bad_request());
    let error = error.to_string();
    let right = "the motion cannot be followed: at t = 0 the right-hand side of x is not finite: a division by zero in k (line 3); start";
    assert!(error.starts_with(right), "{error}");
    assert!(error.ends_with("3 | k=a/phase\n  | ^"), "{error}");
}

#[test]
fn there_is_a_sample_for_every_dt_and_one_at_the_end() {
    let times = |options: &str| {
        let model = of_text(&format!("x'=1\n@ {options}\n"));
        let result = SimulateRequest::of(model).validate().unwrap().run().unwrap();
        let times = to_value(result).unwrap()["t"].clone();
        from_value::<Vec<f64>>(times).unwrap()
    };
    let near = |found: &[f64], right: &[f64]| {
        assert_eq!(found.len(), right.len(), "{found:?}");
        assert!(found.iter().zip(right).all(|(found, right)| (found - right).abs() < 1e-12), "{found:?}");
    };
    near(&times("total=2,dt=.3"), &[0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.0]);
    near(&times("total=2,dt=.1,nout=8"), &[0.0, 0.8, 1.6, 2.0]);
    near(&times("total=1,dt=.1,nout=5"), &[0.0, 0.5, 1.0]);
    near(&times("total=1,dt=.7,trans=.3"), &[0.3, 1.0]);
    // As many as without dt where that is beyond the motion.
    assert_eq!(times("total=1,dt=5").len(), 1001);
    let error = SimulateRequest::of(of_text("x'=1\n@ total=0\n")).validate().unwrap_err().to_string();
    assert_eq!(error, "duration (@ total=0): that is the start alone; allowed: a positive time");
}

fn hopf_points(text: &str) -> Vec<serde_json::Value> {
    let mut model = of_text(text);
    model.start = NamedNumbers(vec![("x".to_owned(), 0.0), ("y".to_owned(), 0.0)]);
    let request = EquilibriaRequest::new(model, Interval::new("l", -1.0, 1.0));
    let stop = AtomicBool::new(false);
    let result = request.validate().unwrap().run(&Control::unobserved(&stop)).unwrap();
    let result = to_value(result).unwrap();
    let points = result["points"].as_array().unwrap_or_else(|| panic!("{result}")).clone();
    points
        .into_iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("HB")))
        .collect()
}

#[test]
fn a_radius_has_the_hopf_point_of_its_square() {
    let of = |quantity: &str, growth: &str| {
        hopf_points(&format!(
            "par l=.5,w=1\n{quantity}\nx'=x*({growth})-w*y\ny'=y*({growth})+w*x\ninit x=.2,y=.1\n"
        ))
    };
    let plain = of("r2=x^2+y^2", "l-r2");
    assert_eq!(plain.len(), 1);
    for radius in ["r=sqrt(x^2+y^2)", "r=(x^2+y^2)^.5"] {
        assert_eq!(of(radius, "l-r^2"), plain);
    }
    // Where the field has no second derivatives there is no Lyapunov coefficient, and no sense is made up.
    let [point] = &of("r=sqrt(x^2+y^2)", "l-r")[..] else { panic!("one Hopf point") };
    assert!(point["value"].as_f64().unwrap().abs() < 1e-12);
    for (eigenvalue, right) in
        from_value::<Vec<[f64; 2]>>(point["eigenvalues"].clone()).unwrap().iter().zip([-1.0, 1.0])
    {
        assert!(eigenvalue[0].abs() < 1e-12 && (eigenvalue[1] - right).abs() < 1e-12, "{point}");
    }
    for claim in ["first_lyapunov", "c1_real", "criticality"] {
        assert!(point["special"][claim].is_null(), "{point}");
    }
    assert_eq!(point["special"]["kind"], "degenerate", "{point}");
}

#[test]
fn a_tip_of_a_cone_is_told_as_one() {
    let mut model = of_text("par l=.5\nr=sqrt(x^2+y^2)\nx'=-x-l*r\ny'=-y-l*r\n");
    model.start = NamedNumbers(vec![("x".to_owned(), 0.0), ("y".to_owned(), 0.0)]);
    let request = EquilibriaRequest::new(model, Interval::new("l", 0.0, 1.0));
    let stop = AtomicBool::new(false);
    let error = request.validate().unwrap().run(&Control::unobserved(&stop)).unwrap_err().to_string();
    assert!(error.contains("has no derivatives there"), "{error}");
}
