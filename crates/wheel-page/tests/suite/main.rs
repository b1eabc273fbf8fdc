//! Tests of the page for wheels without a browser: what is said of its routes is true, and nothing that is asked breaks it.

// What only the tests of the page for any model use is not dead.
#[allow(dead_code)]
#[path = "../../../page/tests/suite/client.rs"]
mod client;
mod description;
mod fuzzed;
mod samples;
mod schema;
