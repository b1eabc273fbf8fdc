//! Tests of the page without a browser: a server on a port of its own, asked over plain connections.

mod analyses;
mod client;
mod refusals;
mod stopping;
