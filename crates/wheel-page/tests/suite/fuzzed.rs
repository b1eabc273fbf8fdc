//! Whatever is asked, the answer says what is wrong with it: never a failure of the server, never a panic.

use crate::client::{Answer, Running};
use crate::samples::bodies;
use kingpin::Wheel;
use kingpin_page::wheel_site;
use proptest::prelude::*;
use proptest::sample::Index;
use serde_json::{Map, Value, json};
use std::io::{ErrorKind, Read};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// How long is waited for the head of an answer: what is computed longer has been understood.
const PATIENCE: Duration = Duration::from_secs(1);

/// Panics in any thread.
static PANICS: AtomicUsize = AtomicUsize::new(0);

fn server() -> &'static Running {
    static SERVER: OnceLock<Running> = OnceLock::new();
    SERVER.get_or_init(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            PANICS.fetch_add(1, Ordering::Relaxed);
            before(panic);
        }));
        Running::serve(wheel_site(&Wheel::default()))
    })
}

/// Sends bytes and reads as much as tells the answer: the whole of a refusal, the head of everything else.
fn status(request: &[u8]) -> Option<Answer> {
    let mut stream = server().send_bytes(request);
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let mut answer = Vec::new();
    let mut part = [0; 4096];
    loop {
        match stream.read(&mut part) {
            Ok(0) => break,
            Ok(count) => answer.extend_from_slice(&part[..count]),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
            // What is left of the request was not read.
            Err(error) if error.kind() == ErrorKind::ConnectionReset => break,
            Err(error) => panic!("{error}"),
        }
        // What was understood is not read to its end.
        if answer.starts_with(b"HTTP/1.1 200") {
            return Some(Answer { status: 200, head: String::new(), body: String::new() });
        }
    }
    let text = String::from_utf8_lossy(&answer);
    text.contains("\r\n\r\n").then(|| Answer::of(&text))
}

/// Any JSON, with what programs stumble over.
fn anything() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        prop::sample::select(vec![
            json!(0),
            json!(-1),
            json!(1),
            json!(2),
            json!(1e308),
            json!(-1e308),
            json!(5e-324),
            json!(u64::MAX),
            json!(4294967295_u64),
            json!("inf"),
            json!("-inf"),
            json!("nan"),
            json!(""),
            json!("v"),
            json!("psi"),
            json!("/etc/hostname"),
            json!("../x"),
            json!("\u{0}"),
            json!("x' = "),
            json!("rolling"),
            json!([]),
            json!({}),
        ]),
        ".{0,12}".prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 12, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::btree_map("[a-z_]{0,6}", inner, 0..4)
                .prop_map(|fields| Value::Object(fields.into_iter().collect::<Map<_, _>>())),
        ]
    })
}

/// One change of a document: at a place, either something else or nothing.
fn change(document: &mut Value, place: Index, other: Option<Value>) {
    fn places(value: &Value, path: &str, list: &mut Vec<String>) {
        list.push(path.to_owned());
        match value {
            Value::Array(items) => {
                items
                    .iter()
                    .enumerate()
                    .for_each(|(index, item)| places(item, &format!("{path}/{index}"), list));
            }
            Value::Object(fields) => {
                fields.iter().for_each(|(name, field)| places(field, &format!("{path}/{name}"), list));
            }
            _ => {}
        }
    }
    let mut all = Vec::new();
    places(document, "", &mut all);
    let path = place.get(&all).clone();
    match other {
        Some(other) => {
            if let Some(value) = document.pointer_mut(&path) {
                *value = other;
            }
        }
        None => {
            let Some((parent, name)) = path.rsplit_once('/') else { return };
            if let Some(fields) = document.pointer_mut(parent).and_then(Value::as_object_mut) {
                fields.remove(name);
            }
        }
    }
}

fn judge(answer: Option<Answer>, has_told: bool) -> Result<(), TestCaseError> {
    prop_assert_eq!(PANICS.load(Ordering::Relaxed), 0);
    // Nothing: it is still computed, or the request never ended.
    let Some(answer) = answer else { return Ok(()) };
    prop_assert!(answer.status < 500, "{:?}", answer);
    if answer.status >= 400 && has_told {
        let told: Value = serde_json::from_str(&answer.body).unwrap_or_default();
        let message = told["error"]["message"].as_str().unwrap_or_default();
        prop_assert!(!message.is_empty(), "{:?}", answer);
    }
    Ok(())
}

#[test]
fn answers_are_seen() {
    let ask =
        |path: &str, body: &str| status(server().question(path, body).as_bytes()).map(|answer| answer.status);
    assert_eq!(ask("/api/stop", "{\"run\": 1}"), Some(200));
    assert_eq!(ask("/api/stop", "{"), Some(400));
    assert_eq!(
        ask(
            "/api/wheel/basin",
            "{\"request\": {\"x\": {\"key\": \"psi\", \"start\": 0, \"end\": 1, \"count\": 1}}}"
        ),
        Some(422)
    );
    assert_eq!(ask("/api/keys", "{}"), Some(405));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 160, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_requests_are_refused_clearly(
        route in any::<Index>(),
        changes in prop::collection::vec((any::<Index>(), prop::option::weighted(0.8, anything())), 0..4),
    ) {
        let (path, mut body) = route.get(&bodies()).clone();
        for (place, other) in changes {
            change(&mut body, place, other);
        }
        judge(status(server().question(path, &body.to_string()).as_bytes()), true)?;
    }

    #[test]
    fn bytes_that_are_no_request_are_refused_clearly(
        route in any::<Index>(),
        cut in any::<Index>(),
        bytes in prop::collection::vec(any::<u8>(), 0..40),
        replaces in any::<bool>(),
    ) {
        let (path, body) = route.get(&bodies()).clone();
        let text = body.to_string().into_bytes();
        let at = cut.index(text.len());
        let rest = if replaces { &text[(at + bytes.len()).min(text.len())..] } else { &text[..0] };
        let body = [&text[..at], &bytes, rest].concat();
        let mut request = server().question(path, "").replace("Content-Length: 0", &format!("Content-Length: {}", body.len())).into_bytes();
        request.extend(body);
        judge(status(&request), true)?;
    }

    #[test]
    fn strange_heads_are_refused(
        path in prop_oneof![Just("/api/wheel/verdict".to_owned()), Just("/".to_owned()), "/[ -~]{0,20}"],
        method in prop_oneof![Just("GET".to_owned()), Just("POST".to_owned()), Just("OPTIONS".to_owned()), "[A-Z]{1,8}"],
        host in prop_oneof![
            Just("127.0.0.1".to_owned()), Just("localhost".to_owned()), Just("[::1]".to_owned()), Just("rebound.example.org".to_owned()), "[!-~]{0,20}",
        ],
        origin in prop::option::of(prop_oneof![
            Just("null".to_owned()), Just("http://rebound.example.org".to_owned()), Just("https://127.0.0.1".to_owned()), "[!-~]{0,20}",
        ]),
        kind in prop_oneof![Just("application/json".to_owned()), Just("text/plain".to_owned()), "[!-~]{0,20}"],
        length in prop_oneof![Just("2".to_owned()), Just("-1".to_owned()), Just("99999999999999999999".to_owned()), "[!-~]{0,6}"],
    ) {
        let origin = origin.map_or_else(String::new, |origin| format!("Origin: {origin}\r\n"));
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}:{}\r\n{origin}Content-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{{}}",
            server().port
        );
        let answer = status(request.as_bytes());
        if let Some(answer) = &answer {
            let is_ours = ["127.0.0.1", "localhost", "[::1]"].contains(&host.to_lowercase().as_str());
            prop_assert!(is_ours || answer.status != 200, "{} {:?}", request, answer);
        }
        // What is no HTTP has no answer in words.
        judge(answer, false)?;
    }
}
