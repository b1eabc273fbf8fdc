//! What is refused, and how that is told.

use crate::client::{RADIAL, Running, equilibria};
use serde_json::json;

#[test]
fn motions_have_a_limit_of_samples() {
    let server = Running::start();
    let model = json!({"source": {"text": {"name": "radial.ode", "source": RADIAL}}});
    let body = |points: u64| json!({"request": {"model": model, "duration": 1.0, "points": points}});
    let answer = server.post("/api/simulate", &body(200_001));
    assert_eq!(answer.status, 422);
    assert!(answer.body.contains("allowed: up to 200000"), "{}", answer.body);
    assert_eq!(server.post("/api/simulate", &body(3)).status, 200);
}

#[test]
fn only_pages_of_this_server_are_answered() {
    let server = Running::start();
    let port = server.port;
    let ask = |host: &str, more: &str| {
        server.exchange(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n{more}Connection: close\r\n\r\n")).status
    };
    assert_eq!(ask(&format!("127.0.0.1:{port}"), ""), 200);
    assert_eq!(ask(&format!("localhost:{port}"), ""), 200);
    // Another server on this machine.
    assert_eq!(ask("localhost:1", ""), 403);
    assert_eq!(ask("localhost", ""), 403);
    // A name of another site that resolves to the loopback address, with and without saying so.
    assert_eq!(ask(&format!("rebound.example.org:{port}"), ""), 403);
    let other = format!("Origin: http://rebound.example.org:{port}\r\n");
    assert_eq!(ask(&format!("rebound.example.org:{port}"), &other), 403);
    assert_eq!(ask(&format!("127.0.0.1:{port}"), &other), 403);
    assert_eq!(ask(&format!("127.0.0.1:{port}"), &format!("Origin: http://localhost:{port}\r\n")), 200);
    // What a form of another site could send.
    let form = format!(
        "{}Content-Type: text/plain\r\nContent-Length: 2\r\n\r\n{{}}",
        server.head("POST", "/api/model")
    );
    assert_eq!(server.exchange(&form).status, 415);
}

#[test]
fn every_answer_says_what_its_page_may_load() {
    let server = Running::start();
    for path in ["/", "/model.js", "/style.css", "/api/gallery", "/nowhere"] {
        let answer = server.get(path);
        assert!(
            answer.head.contains("content-security-policy: default-src 'self'"),
            "{path}: {}",
            answer.head
        );
        assert!(answer.head.contains("x-content-type-options: nosniff"), "{path}");
    }
}

#[test]
fn a_diagram_of_nothing_is_refused() {
    let server = Running::start();
    for states in [json!([]), json!(["x"])] {
        let request = json!({"results": [], "states": states, "format": "svg"});
        let answer = server.post("/api/diagram", &json!({"request": request, "files": {}}));
        assert_eq!(answer.status, 400);
        assert!(answer.message().contains("results: none is named"), "{}", answer.message());
    }
}

#[test]
fn no_route_reaches_a_file_of_the_machine() {
    let server = Running::start();
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), "par p=1\nx' = p - x^2\n").unwrap();
    let mut request = equilibria();
    request["model"]["source"] = json!({"file": file.path()});
    let answer = server.post("/api/equilibria", &json!({"request": request}));
    assert_eq!(answer.status, 422);
    assert!(answer.message().contains("cannot be read"), "{}", answer.message());
    request["model"]["source"] = json!({"point": {"path": file.path(), "label": "HB1"}});
    assert_eq!(server.post("/api/equilibria", &json!({"request": request})).status, 422);
    let samples = json!({"from": {"samples": file.path()}, "model": {"file": file.path()}, "along": {"key": "p", "start": 0, "end": 1}});
    assert_eq!(server.post("/api/cycles", &json!({"request": samples})).status, 422);
    let results = json!({"results": [file.path()], "format": "svg"});
    assert_eq!(server.post("/api/diagram", &json!({"request": results})).status, 422);
    for path in ["/../Cargo.toml", "/%2e%2e/Cargo.toml", "//etc/hostname"] {
        assert_eq!(server.get(path).status, 404, "{path}");
    }
}

#[test]
fn what_cannot_be_understood_says_why() {
    let server = Running::start();
    for (body, words) in [
        ("", "EOF"),
        ("{", "EOF"),
        ("[]", "invalid"),
        ("{\"request\": {}}", "missing field `model`"),
        ("{\"request\": 1, \"file\": 2}", "invalid type"),
        ("\u{0}", "expected value"),
    ] {
        let answer = server.exchange(&server.question("/api/equilibria", body));
        assert_eq!(answer.status, 400, "{body}: {answer:?}");
        assert!(answer.message().contains(words), "{body}: {}", answer.message());
    }
    let mut request = equilibria();
    request["along"]["key"] = json!("q");
    let answer = server.post("/api/equilibria", &json!({"request": request}));
    let error = &answer.json()["error"];
    assert_eq!(answer.status, 422);
    assert_eq!(
        (&error["fields"], &error["given"], &error["allowed"]),
        (&json!(["along"]), &json!("q"), &json!("p"))
    );
    assert_eq!(server.get("/api/equilibria").status, 405);
    assert_eq!(server.get("/api/nothing").status, 404);
    let large = format!(
        "{}Content-Type: application/json\r\nContent-Length: 99999999999\r\n\r\n",
        server.head("POST", "/api/model")
    );
    assert_eq!(server.exchange(&large).status, 413);
}
