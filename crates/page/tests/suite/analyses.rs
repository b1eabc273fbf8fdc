//! What is computed on request: the same bytes as the analyses themselves give, and points as they are found.

use crate::client::{RADIAL, Running, equilibria};
use arclength_analysis::equilibria::EquilibriaRequest;
use arclength_analysis::{Control, ResultFile};
use kingpin_report::{Report, json};
use serde_json::{Value, json};

fn file<R: Report>(result: &R) -> String {
    let mut text = Vec::new();
    json::write(result, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

#[test]
fn a_branch_is_the_one_that_the_analysis_gives_and_its_points_came_before() {
    let server = Running::start();
    let answer = server.post("/api/equilibria", &json!({"request": equilibria()}));
    assert_eq!(answer.status, 200);
    let request: EquilibriaRequest = serde_json::from_value(equilibria()).unwrap();
    let expected = request.validate().unwrap().run(&Control::none()).unwrap();
    assert_eq!(answer.result(), file(&expected));

    let events = answer.events();
    assert_eq!(events[0].0, "run");
    let points = events.iter().filter(|(kind, _)| kind == "point");
    let points: Vec<Value> = points.map(|(_, text)| serde_json::from_str(text).unwrap()).collect();
    // Every point of the branch was told, with the same digits.
    for point in &expected.points {
        assert!(points.iter().any(|told| told["values"][0] == json!(point.value)), "{}", point.value);
    }
    assert!(
        points.iter().any(|told| told["label"] == "HB1" && told["values"][0].as_f64().unwrap().abs() < 1e-12)
    );
    assert!(
        points.iter().any(|told| told["stable"] == json!(true))
            && points.iter().any(|told| told["stable"] == json!(false))
    );
}

#[test]
fn cycles_start_from_a_result_that_came_with_the_request() {
    let server = Running::start();
    let first = server.post("/api/equilibria", &json!({"request": equilibria()})).result();
    let from = json!({"path": "equilibria.json", "label": "HB1"});
    let along = json!({"key": "p", "start": -1.0, "end": 1.0});
    let body = json!({"request": {"from": from, "along": along}, "files": {"equilibria.json": first}});
    let answer = server.post("/api/cycles", &body);
    let result: Value = serde_json::from_str(&answer.result()).unwrap();
    let last = result["points"].as_array().unwrap().last().unwrap().clone();
    // The closed form: at p = 1 the cycle is the unit circle, and turns once in 2 pi.
    assert!((last["max"]["x"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{last}");
    assert!((last["period"].as_f64().unwrap() - std::f64::consts::TAU).abs() < 1e-6, "{last}");
    // What is drawn of the last cycle is that circle.
    let mut points = answer.events().into_iter().filter(|(kind, _)| kind == "point");
    let point: Value = serde_json::from_str(&points.next_back().unwrap().1).unwrap();
    let [x, y] = [0, 1].map(|state| point["orbit"]["states"][state].as_array().unwrap().clone());
    let radius = point["values"][0].as_f64().unwrap().sqrt();
    assert!(x.len() >= 120 && x.len() == y.len());
    for (x, y) in x.iter().zip(&y) {
        assert!((x.as_f64().unwrap().hypot(y.as_f64().unwrap()) - radius).abs() < 1e-5);
    }
}

#[test]
fn a_diagram_says_where_its_axes_are() {
    let server = Running::start();
    let first = server.post("/api/equilibria", &json!({"request": equilibria()})).result();
    let request = json!({"results": ["equilibria.json"], "states": ["y"], "format": "page"});
    let files = json!({"equilibria.json": first});
    let picture = server.post("/api/diagram", &json!({"request": request, "files": files})).json();
    assert!(picture["svg"].as_str().unwrap().starts_with("<svg"));
    let panel = &picture["panels"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    assert!(
        number(&panel["left"]) < number(&panel["right"]) && number(&panel["top"]) < number(&panel["bottom"])
    );
    assert!(
        number(&panel["bottom"]) < number(&picture["height"])
            && number(&panel["right"]) <= number(&picture["width"])
    );
    assert!(number(&panel["x"]["low"]) <= -1.0 && number(&panel["x"]["high"]) >= 1.0);

    let ask = |format: &str| {
        let request = json!({"results": ["equilibria.json"], "format": format});
        server.post("/api/diagram", &json!({"request": request, "files": files}))
    };
    let text = files["equilibria.json"].as_str().unwrap().as_bytes().to_vec();
    let held = arclength_analysis::FilesInMemory::from_iter([("a.json".to_owned(), text)]);
    let Ok(ResultFile::Equilibria(result)) = ResultFile::read_among(&held, "a.json".as_ref()) else {
        panic!()
    };
    let mut table = Vec::new();
    result.columns().write_csv(&mut table).unwrap();
    assert_eq!(ask("csv").body.as_bytes(), table);
    assert_eq!(ask("svg").body, result.figure().unwrap().unwrap().to_svg().unwrap());
    assert!(ask("text").body.contains("HB1"));
    // A part of it, on dark paper, with text.
    let request = json!({"results": ["equilibria.json"], "states": ["y"], "format": "svg", "window": {"x": [-0.5, 0.25]}, "dark": true, "text": true});
    let part = server.post("/api/diagram", &json!({"request": request, "files": files})).body;
    assert!(
        part.contains("from -0.5 to 0.25") && part.contains("fill=\"#16181a\"") && part.contains("</text>")
    );
}

#[test]
fn the_text_of_a_model_is_understood_or_its_mistake_has_a_place() {
    let server = Running::start();
    let model = |source: &str| server.post("/api/model", &json!({"name": "m.ode", "source": source}));
    let answer = model(RADIAL).json();
    assert_eq!(answer["states"], json!({"x": 0.0, "y": 0.0}));
    assert_eq!(answer["parameters"], json!({"p": -0.5}));
    assert_eq!((answer["along"].clone(), answer["time"].clone()), (Value::Null, Value::Null));
    let answer = model("par p=1\n@ parmin=-2, parmax=3\nx' = p + sin(t)\n").json();
    assert_eq!(answer["along"], json!({"key": "p", "start": -2.0, "end": 3.0}));
    assert_eq!(answer["time"], json!({"line": 3, "column": 14, "length": 1}));

    let answer = model("par p=1\nx' = -p*x\ninit x=1\nset fast {p=2,x=3}\n").json();
    assert_eq!(
        answer["named_sets"],
        json!([{"name": "fast", "states": {"x": 3.0}, "parameters": {"p": 2.0}}])
    );

    let answer = model("par gamma=1\nx' = -gama*x\n");
    let error = &answer.json()["mistake"];
    assert_eq!(error["place"], json!({"line": 2, "column": 7, "length": 4}));
    assert!(error["message"].as_str().unwrap().contains("did you mean `gamma`?"));
}

#[test]
fn every_model_of_the_gallery_is_read() {
    let server = Running::start();
    let models = server.get("/api/gallery").json();
    assert!(models.as_array().unwrap().len() > 10);
    for model in models.as_array().unwrap() {
        let answer = server.post("/api/model", &json!({"name": model["name"], "source": model["source"]}));
        assert!(answer.json()["states"].is_object(), "{}", model["name"]);
    }
}
