//! A wheel whose tyre gives way: the straight-tangent theory with relaxation length (Pacejka, *Tyre and Vehicle Dynamics*; Somieski
//! 1997).
//!
//! The wheel rolls without longitudinal slip; sideways the leading point of its contact line is held by the ground and the tyre is
//! deflected there by `y_t`. Its states are `u q psi V1 V2 Omega y_t`, of which those that a rigid king pin forbids are
//! not free.

mod equations;
mod field;
mod history;
mod law;
mod onset;
mod resting;
mod uniform;

pub use field::{TYRE_STATE_NAMES, TyreWheel};
pub use history::TyreHistory;
pub(crate) use onset::Onset;
pub(crate) use resting::Rests;
pub(crate) use uniform::TyreLinearisation;
