//! Requests in which everything is said that can be said, each for its route.

use arclength_analysis::cycles::CyclesRequest;
use arclength_analysis::equilibria::EquilibriaRequest;
use arclength_analysis::locus::LocusRequest;
use arclength_analysis::simulate::{PlotRequest, SectionRequest, SimulateRequest};
use arclength_analysis::{
    Assignment, CycleSource, Interval, ModelRequest, ModelSource, Monitored, PointReference, StoredModel,
};
use kingpin_analysis::basin::BasinRequest;
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::report::ReportRequest;
use kingpin_analysis::shimmy::ShimmyRequest;
use kingpin_analysis::{Contact, WheelRequest, cycles, simulate};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// A request with its route.
pub(crate) struct Sample {
    pub path: &'static str,
    pub request: Value,
    /// Whether it can be read.
    pub reads: fn(Value) -> bool,
}

fn sample<R: Serialize + DeserializeOwned>(path: &'static str, request: &R) -> Sample {
    Sample {
        path,
        request: serde_json::to_value(request).unwrap(),
        reads: |value| serde_json::from_value::<R>(value).is_ok(),
    }
}

fn interval(key: &str) -> Interval {
    Interval::new(key, 0.25, 2.0)
}

fn model(source: ModelSource) -> ModelRequest {
    let mut request = ModelRequest::new(source);
    request.named_set = Some("first".to_owned());
    request.set.0.push(("p".to_owned(), 0.5));
    request.start.0.push(("x".to_owned(), 0.5));
    request.freeze = Some(0.0);
    request
}

fn text() -> ModelSource {
    let source = crate::client::RADIAL.to_owned();
    ModelSource::Text(StoredModel { name: "radial.ode".to_owned(), source, frozen_time: Some(0.0) })
}

fn point() -> PointReference {
    PointReference { path: "equilibria.json".into(), label: "HB1".to_owned() }
}

fn monitored() -> Monitored {
    Monitored { expression: "period".to_owned(), at: vec![6.0], until: vec![7.0] }
}

fn wheel() -> WheelRequest {
    WheelRequest { wheel: None, set: vec![Assignment { key: "v".to_owned(), value: "3".to_owned() }] }
}

/// All of them.
pub(crate) fn samples() -> Vec<Sample> {
    let mut equilibria = EquilibriaRequest::new(model(text()), interval("p"));
    equilibria.at = vec![1.0];
    equilibria.monitors = vec![monitored()];
    let mut of_cycles = CyclesRequest::new(CycleSource::Point(point()), interval("p"));
    of_cycles.model = Some(text());
    of_cycles.set.0.push(("p".to_owned(), 0.5));
    of_cycles.at = vec![1.0];
    of_cycles.monitors = vec![monitored()];
    let mut locus = LocusRequest::new(point(), [interval("p"), interval("b")]);
    locus.at = vec![1.0];
    locus.hold = Some(monitored());
    locus.monitors = vec![monitored()];
    let mut motion = SimulateRequest::new(model(text()), 2.0);
    motion.points = Some(11);
    motion.t0 = Some(0.0);
    motion.transient = Some(0.5);
    motion.bound = Some(100.0);
    motion.tolerance = Some(1e-8);
    motion.max_step = Some(0.1);
    motion.plots = vec![PlotRequest::Listed(vec!["x".to_owned()])];
    motion.window = vec![interval("x")];
    motion.section = Some(SectionRequest { expression: "x".to_owned(), direction: Default::default() });

    let mut of_wheel = cycles::CyclesRequest::new(interval("v"));
    of_wheel.wheel = wheel();
    of_wheel.at = vec![1.0];
    of_wheel.from = Some(CycleSource::Point(point()));
    of_wheel.monitors = vec![monitored()];
    let mut curve = kingpin_analysis::locus::LocusRequest::new(point(), [interval("v"), interval("l")]);
    curve.at = vec![1.0];
    curve.hold = Some(monitored());
    curve.monitors = vec![monitored()];
    let mut shimmy = ShimmyRequest::new(interval("v"));
    shimmy.wheel = wheel();
    shimmy.at = vec![1.0];
    let mut history = simulate::SimulateRequest::new(0.5);
    history.wheel = wheel();
    history.perturb.0.push(("psi".to_owned(), 0.1));
    let mut basin = BasinRequest { wheel: wheel(), samples: Some(3), ..BasinRequest::default() };
    basin.classification.contact = Some(Contact::Rolling);
    basin.classification.duration = Some(1.0);
    let overlay = vec![Assignment { key: "r".to_owned(), value: "1,2".to_owned() }];
    let report = ReportRequest {
        wheel: wheel(),
        up_to: Some(Assignment { key: "v".to_owned(), value: "5".to_owned() }),
        ..ReportRequest::default()
    };
    vec![
        sample("/api/equilibria", &equilibria),
        sample("/api/cycles", &of_cycles),
        sample("/api/locus", &locus),
        sample("/api/simulate", &motion),
        sample("/api/wheel/verdict", &wheel()),
        sample("/api/wheel/report", &report),
        sample("/api/wheel/chart", &ChartRequest { wheel: wheel(), overlay, ..ChartRequest::default() }),
        sample("/api/wheel/cycles", &of_wheel),
        sample("/api/wheel/locus", &curve),
        sample("/api/wheel/shimmy", &shimmy),
        sample("/api/wheel/simulate", &history),
        sample("/api/wheel/basin", &basin),
    ]
}

/// A drawing of every kind of shape.
fn drawing() -> Value {
    let stroke = json!({"color": [0, 0, 0, 1], "width": 1, "dashed": true});
    json!({"width": 90, "height": 60, "title": "all", "paper": [255, 255, 255, 1], "items": [
        {"kind": "raster", "frame": [10, 10, 80, 50], "columns": 2, "pixels": [0, 0, 0, 255, 9, 9, 9, 120]},
        {"kind": "lines", "lines": [[[0, 0], [90, 60]]], "stroke": stroke, "clip": [10, 10, 80, 50]},
        {"kind": "polygon", "corners": [[10, 10], [20, 10], [10, 20]], "fill": [200, 0, 0, 0.5]},
        {"kind": "circle", "center": [45, 30], "radius": 5, "stroke": stroke},
        {"kind": "text", "text": "\u{3c8} (rad)", "at": [45, 55], "size": 8, "anchor": 0.5, "degrees": 0, "color": [0, 0, 0, 1]},
    ]})
}

/// The bodies of all routes that take one; of those whose request is asked under `request`, the samples.
pub(crate) fn bodies() -> Vec<(&'static str, Value)> {
    let mut bodies: Vec<(&str, Value)> =
        samples().into_iter().map(|sample| (sample.path, json!({"request": sample.request}))).collect();
    let chart = json!({"set": [], "x": {"key": "v", "start": 1, "end": 5, "count": 4}, "y": {"key": "l", "start": 0.05, "end": 0.1, "count": 3}});
    bodies.extend([
        ("/api/stop", json!({"run": 7})),
        ("/api/model", json!({"name": "radial.ode", "source": crate::client::RADIAL})),
        (
            "/api/diagram",
            json!({"request": {"results": ["a.json"], "states": ["x"], "format": "page", "colors": {"a.json": "green"}}, "files": {"a.json": "{}"}}),
        ),
        (
            "/api/wheel/diagram",
            json!({"request": {"results": ["a.json"], "format": "page", "window": {"x": [1.0, 2.0]}, "dark": true, "colors": {"a.json": "sky"}}, "files": {"a.json": "{}"}}),
        ),
        ("/api/drawing", drawing()),
        ("/api/wheel", json!({"text": "v = 3\n"})),
        ("/api/wheel/save", json!({"analysis": "chart", "request": chart, "format": "csv"})),
    ]);
    bodies
}
