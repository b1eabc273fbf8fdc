//! Requests as plain data: the defaults are those of the command line, and what makes no sense is refused.

use arclength_analysis::{AnalysisError, CycleSource, Interval, PointReference};
use kingpin_analysis::basin::BasinRequest;
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::cycles::CyclesRequest;
use kingpin_analysis::hopf::HopfRequest;
use kingpin_analysis::margin::MarginRequest;
use kingpin_analysis::safe_kick::SafeKickRequest;
use kingpin_analysis::simulate::SimulateRequest;
use kingpin_analysis::steady::SteadyRequest;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json, to_value};
use std::fmt::Debug;

fn check<R: Serialize + DeserializeOwned + PartialEq + Debug>(short: Value, request: &R) {
    assert_eq!(&from_value::<R>(short).unwrap(), request);
    assert_eq!(&from_value::<R>(to_value(request).unwrap()).unwrap(), request);
}

#[test]
fn what_is_not_given_has_its_default() {
    check(json!({}), &SteadyRequest::default());
    check(json!({}), &ChartRequest::default());
    check(json!({}), &BasinRequest::default());
    check(json!({}), &SafeKickRequest::default());
    check(json!({}), &MarginRequest::default());
    check(json!({"duration": 2.0}), &SimulateRequest::new(2.0));
    let along = json!({"key": "r", "start": 1.0, "end": "inf"});
    let straight = Interval::new("r", f64::INFINITY, 1.0);
    check(json!({"along": along}), &HopfRequest::new(straight.clone()));
    let mut cycles = CyclesRequest::new(straight);
    check(json!({"along": along}), &cycles);
    cycles.from = Some(PointReference { path: "a.json".into(), label: "AT1".to_owned() }.into());
    check(json!({"along": along, "from": {"path": "a.json", "label": "AT1"}}), &cycles);
    cycles.from = Some(CycleSource::Samples { samples: "o.csv".into() });
    check(json!({"along": along, "from": {"samples": "o.csv"}}), &cycles);
}

#[test]
fn charts_and_basins_have_points() {
    let mut chart = ChartRequest::default();
    chart.x.count = 1;
    assert!(chart.validate().unwrap_err().to_string().starts_with("x v=0.1:12:1: too few values"));
    let mut basin = BasinRequest { samples: Some(0), ..BasinRequest::default() };
    assert!(basin.validate().unwrap_err().to_string().starts_with("samples 0: "));
    basin.samples = None;
    basin.y.count = 0;
    assert!(basin.validate().unwrap_err().is_bad_request());
}

#[test]
fn a_wheel_is_set_by_key_and_value() {
    let request: SteadyRequest = from_value(json!({"set": [{"key": "r", "value": "inf"}]})).unwrap();
    // Straight towing with the paper's wheel.
    let result = request.run().unwrap();
    assert_eq!(to_value(&result).unwrap()["psi"], 0.0);
    let request: SteadyRequest = from_value(json!({"set": [{"key": "r", "value": "-1"}]})).unwrap();
    let error = request.run().unwrap_err();
    assert!(error.is_bad_request() && error.to_string().starts_with("set r=-1: "), "{error}");
    let request: SteadyRequest = from_value(json!({"set": [{"key": "v", "value": "0"}]})).unwrap();
    assert!(!request.run().unwrap_err().is_bad_request());
}
