//! What `/api/openapi.json` says is true: every route is in it, and every request is described with all its fields.

use crate::client::Running;
use crate::samples::{bodies, samples};
use crate::schema::{mistake, resolved};
use arclength_page::Address;
use kingpin::Wheel;
use kingpin_page::wheel_site;
use serde_json::Value;
use std::collections::BTreeSet;

/// The schema of the body of a route.
fn body<'a>(document: &'a Value, path: &str) -> &'a Value {
    let schema = &document["paths"][path]["post"]["requestBody"]["content"]["application/json"]["schema"];
    assert!(schema.is_object(), "{path}");
    resolved(document, schema)
}

#[test]
fn every_route_is_described_and_no_other() {
    let site = wheel_site(&Wheel::default());
    let routes = site.all_routes();
    let known: BTreeSet<(&str, &str)> =
        routes.addresses().iter().map(|Address { method, path }| (*method, *path)).collect();
    assert_eq!(known.len(), routes.addresses().len());
    let paths = site.description["paths"].as_object().unwrap();
    let described: BTreeSet<(&str, &str)> = paths
        .iter()
        .flat_map(|(path, methods)| {
            methods.as_object().unwrap().keys().map(move |method| (method.as_str(), path.as_str()))
        })
        .collect();
    assert_eq!(described, known);
    // Every reference names something.
    fn follow(document: &Value, part: &Value) {
        resolved(document, part);
        match part {
            Value::Array(items) => items.iter().for_each(|item| follow(document, item)),
            Value::Object(fields) => fields.values().for_each(|field| follow(document, field)),
            _ => {}
        }
    }
    follow(&site.description, &site.description);
}

#[test]
fn it_is_served() {
    let site = wheel_site(&Wheel::default());
    let expected = site.description.clone();
    let server = Running::serve(site);
    assert_eq!(server.get("/api/openapi.json").json(), expected);
    assert_eq!(expected["info"]["title"], "kingpin");
}

#[test]
fn requests_are_described_with_all_their_fields() {
    let document = wheel_site(&Wheel::default()).description;
    for sample in samples() {
        let schema = resolved(&document, &body(&document, sample.path)["properties"]["request"]);
        assert_eq!(mistake(&document, schema, &sample.request), None, "{}", sample.path);
        // The sample says everything that is described.
        for name in schema["properties"].as_object().unwrap().keys() {
            assert!(sample.request.get(name).is_some(), "{} has no {name}", sample.path);
        }
        // What is required is missed, and nothing else.
        assert!((sample.reads)(sample.request.clone()), "{}", sample.path);
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        let required: BTreeSet<&str> = required.collect();
        for name in sample.request.as_object().unwrap().keys() {
            let mut without = sample.request.clone();
            without.as_object_mut().unwrap().remove(name);
            assert_eq!((sample.reads)(without), !required.contains(name.as_str()), "{} {name}", sample.path);
        }
    }
}

#[test]
fn bodies_are_described() {
    let document = wheel_site(&Wheel::default()).description;
    let bodies = bodies();
    for (path, sent) in &bodies {
        assert_eq!(mistake(&document, body(&document, path), sent), None, "{path}");
    }
    let tried: BTreeSet<&str> = bodies.iter().map(|(path, _)| *path).collect();
    let paths = document["paths"].as_object().unwrap();
    let asked = paths.iter().filter(|(_, methods)| methods.get("post").is_some());
    assert_eq!(tried, asked.map(|(path, _)| path.as_str()).collect());
}
