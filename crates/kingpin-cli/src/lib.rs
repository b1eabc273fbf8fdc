//! What the program `kingpin` is made of.

pub mod along;
pub mod axis_label;
pub mod commands;
pub mod description;
pub mod error;
pub mod journal;
pub mod paper;
pub mod stored;
pub mod studies;
pub mod wheel_options;
