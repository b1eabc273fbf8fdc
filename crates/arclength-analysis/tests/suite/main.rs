//! Requests, results and motions of any model.
//!
//! One program for all of them: to build one for each would take longer than to run them.

mod motions;
mod requests;
mod result_files;
