//! Tests of the page for wheels without a browser: what is said of its routes is true, and nothing that is asked breaks it.

#[path = "../../../page/tests/suite/client.rs"]
mod client;
mod description;
mod fuzzed;
mod samples;
mod schema;
