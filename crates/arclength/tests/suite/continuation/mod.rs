//! What every curve has in common.

mod events;
