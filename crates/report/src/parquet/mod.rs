//! Parquet files with typed columns; what belongs to all of them stands in the metadata of the file.

mod reading;
mod writing;

pub(crate) use reading::read;
pub use writing::write;
