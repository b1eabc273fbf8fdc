//! Analyses of any model in XPPAUT's `.ode` format.
//!
//! An analysis is asked for by a **request**: plain data in which every default stands. It is checked once, runs under a
//! [`Control`], which is told how far it has come and can stop it, and gives a **result**: plain data again, which implements
//! [`Report`](kingpin_report::Report), is written to files and read back from them ([`ResultFile`]). Every labelled point of a
//! result file can be the start of the next analysis. Nothing here knows options or a terminal: every face asks with the same
//! requests.

pub mod branch;
mod calls;
pub mod course;
mod cycle_source;
pub mod cycles;
pub mod diagram;
mod end;
pub mod equilibria;
mod error;
mod files;
mod found_point;
mod interval;
pub mod labels;
pub mod locus;
mod model;
mod model_request;
pub mod monitor;
pub mod normal_form;
mod orbit_file;
pub mod phase_plane;
pub mod picture;
mod point_reference;
mod result_file;
pub mod simulate;
mod start;
mod steps;
mod stored_model;
mod unlocated;
mod varying_parameter;
mod vocabulary;

pub use arclength::control::{Control, Progress};
pub use branch::Origin;
pub use cycle_source::CycleSource;
pub use end::End;
pub use error::{AnalysisError, Error, InvalidField};
pub use files::{Disk, Files, FilesInMemory};
pub use found_point::FoundPoint;
pub use interval::{Along, Assignment, Interval, IntervalError, SampledInterval, Values};
pub use model::ChosenModel;
pub use model_request::{ModelRequest, ModelSource, OpenedModel};
pub use monitor::{CycleMonitor, MonitorError, Monitored};
pub use orbit_file::read_orbit;
pub use point_reference::PointReference;
pub use result_file::ResultFile;
pub use start::{LabelledPoint, LabelledSolution};
pub use steps::{Mesh, Steps};
pub use stored_model::StoredModel;
pub use unlocated::UnlocatedResult;
pub use varying_parameter::VaryingParameter;
pub use vocabulary::Vocabulary;
