//! Analyses of towed wheels.
//!
//! As in [`arclength_analysis`], an analysis is asked for by a **request**, plain data in which every default stands; it is
//! checked once, runs under a [`Control`](arclength_analysis::Control) and gives a **result**, plain data that implements
//! [`Report`](kingpin_report::Report). Nothing here knows options or a terminal.

mod along;
pub mod axis;
mod axis_label;
pub mod basin;
mod blow_out_of_rest;
mod by_chunks;
pub mod chart;
mod classification;
mod computation;
pub mod cycles;
pub mod damper;
mod description;
pub mod diagram;
mod disturbance;
mod error;
pub mod fit;
mod folder;
mod forces;
pub mod hopf;
mod journal;
mod last_fold;
pub mod locus;
pub mod margin;
mod monitors;
mod neglected_dry_friction;
mod page;
pub mod paper;
mod parameters;
pub mod report;
mod result_file;
pub mod safe_kick;
mod seen_from_above;
pub mod sharded;
pub mod shimmy;
pub mod simulate;
pub mod stability;
mod start;
mod states;
pub mod steady;
pub mod steady_along;
pub mod studies;
mod uniform_curve;
mod up_to;
mod wheel_request;

pub use blow_out_of_rest::BlowOutOfRestResult;
pub use classification::{Classification, Contact, NamedFate};
pub use disturbance::{DisturbanceKind, DisturbanceRequest, Edge};
pub use error::Error;
pub use forces::ForcesResult;
pub use journal::Journal;
pub use neglected_dry_friction::NeglectedDryFriction;
pub use result_file::ResultFile;
pub use seen_from_above::SeenFromAbove;
pub use wheel_request::WheelRequest;

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
