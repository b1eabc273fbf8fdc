//! Requests and results of wheels.
//!
//! One program for all of them: to build one for each would take longer than to run them.

mod diagrams;
mod orbits;
mod requests;
mod result_files;
