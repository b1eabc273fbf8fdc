//! What any result is, whatever was computed: columns with units, a JSON document, a table for people, a picture, a story.
//!
//! Whoever computes something describes its result once, by the trait [`Report`]. Everything else follows: [`json`], CSV by
//! [`Columns`], [`parquet`], pictures, and [`files`] that appear whole or not at all. Nothing here knows a model, an option or
//! a terminal.

pub mod chunks;
mod columns;
mod destination;
mod error;
pub mod files;
pub mod history;
pub mod json;
mod named_numbers;
mod parameters;
pub mod parquet;
mod report;
mod schema;
mod stoppable;
mod story;
mod table;
mod unfinished;

pub use arclength_numbers as numbers;
pub use columns::{Column, Columns, Entries};
pub use error::ReportError;
pub use files::{FileFormat, PictureFormat};
pub use named_numbers::{NamedNumbers, Number, number};
pub use parameters::Parameters;
pub use report::Report;
pub use schema::Schema;
pub use stoppable::Stoppable;
pub use story::Story;
pub use table::{Cell, Table};
pub use unfinished::{Abandoned, UnfinishedFile, abandon_unfinished};

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
