//! The smallest dampers with which no shimmy is born up to a speed, and with which no large one is found.

mod kicks;
mod large_cycles;
mod request;
mod result;

pub use kicks::KickedWheels;
pub use request::DamperRequest;
pub use result::{Corner, DamperResult, Front, IsolaFree, LastCycleResult, WithoutCycles};
