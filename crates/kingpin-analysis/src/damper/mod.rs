//! The smallest dampers with which no shimmy is born up to a speed, and with which no large one is found.

mod condition;
mod kicks;
mod large_cycles;
mod request;
mod result;

pub use condition::{Range, Value};
pub use kicks::KickedWheels;
pub use request::DamperRequest;
pub use result::{Conditions, Corner, DamperResult, Front, IsolaFree, LastCycleResult, WithoutCycles};
