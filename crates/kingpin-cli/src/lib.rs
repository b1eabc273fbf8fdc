//! What the commands `kingpin` and `arclength` are made of.
//!
//! A command turns its options into a computation and the result into a [`report::Report`]; [`output`] delivers
//! reports as tables for people, JSON, CSV, Parquet or pictures, to the terminal or to files. The computations
//! themselves live in the libraries `kingpin` and `arclength`.

pub mod along;
pub mod axis_label;
pub mod columns;
pub mod commands;
pub mod description;
pub mod document;
pub mod failure;
pub mod history;
pub mod journal;
pub mod labels;
pub mod models;
pub mod numbers;
pub mod options;
pub mod output;
pub mod paper;
pub mod parquet;
pub mod progress;
pub mod range;
pub mod report;
pub mod stored;
pub mod studies;
pub mod table;
pub mod terminal;
