//! A time history of a model.

mod accuracy;
mod analysis;
mod condition;
mod events;
mod flow;
mod motion;
mod phase;
mod picture;
mod plot;
mod request;
mod result;
mod samples;
mod section;
mod settled;
mod small_states;
mod smooth;

pub use analysis::SimulateAnalysis;
pub use plot::{PlotError, PlotRequest};
pub use request::{IntegrationMethod, SimulateRequest};
pub use result::{Histories, HistoryResult};
pub use section::{SectionDirection, SectionError, SectionRequest};
pub(crate) use settled::settled_orbit;
