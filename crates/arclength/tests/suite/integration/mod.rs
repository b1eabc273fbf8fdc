//! Motions in time.

mod stiff;
