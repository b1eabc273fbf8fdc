//! Figures 2 to 6 of the paper, and every statement of its text beside what was computed.
//!
//! Each figure has a file here that computes and draws it. The statements are in [`claims`]; what is said of them follows from
//! numbers computed in the same run. [`PaperRequest::run`] does everything and writes the files when all are ready.

mod branches;
pub mod claims;
mod data;
mod diagrams_in_space;
mod drawing;
mod numbers;
mod page;
mod request;
mod result;
mod rolling_limit;
mod stability_chart;
mod tasks;
#[cfg(test)]
mod tests;
mod turning_radii;
mod uniform_motion;
mod wheel;

pub use request::PaperRequest;
pub use result::PaperResult;
