//! The language of `.ode` models: what is read, refused, computed.
//!
//! One program for all of them: to build one for each would take longer than to run them.

mod evaluation;
mod global_events;
mod language;
mod refusals;
mod regions;
mod robustness;
mod switches;
