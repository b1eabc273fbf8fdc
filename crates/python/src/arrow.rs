//! Columns as a stream of Arrow's C interface, which pandas, polars, pyarrow and others read without this package knowing them.

use crate::errors::Failure;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, RecordBatch, RecordBatchIterator, StringArray, UInt64Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use kingpin_report::{Column, Columns, Entries};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::HashMap;
use std::sync::Arc;

/// Key of the unit of a column in its metadata, as in Parquet files.
const UNIT: &str = "unit";

fn array(column: &Column, rows: usize) -> (DataType, ArrayRef) {
    match &column.entries {
        Entries::Numbers(entries) => {
            (DataType::Float64, Arc::new(entries[..rows].iter().copied().collect::<Float64Array>()))
        }
        Entries::Counts(entries) => {
            (DataType::UInt64, Arc::new(UInt64Array::from_iter_values(entries[..rows].iter().copied())))
        }
        Entries::Booleans(entries) => {
            (DataType::Boolean, Arc::new(entries[..rows].iter().copied().collect::<BooleanArray>()))
        }
        Entries::Texts(entries) => {
            (DataType::Utf8, Arc::new(entries[..rows].iter().map(Option::as_deref).collect::<StringArray>()))
        }
    }
}

fn batch(columns: &Columns) -> Result<RecordBatch, ArrowError> {
    let rows = columns.rows();
    let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns
        .iter()
        .map(|column| {
            let (kind, array) = array(column, rows);
            let unit = column.unit.iter().map(|unit| (UNIT.to_owned(), unit.clone()));
            (Field::new(&column.name, kind, true).with_metadata(unit.collect::<HashMap<_, _>>()), array)
        })
        .unzip();
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
}

/// The columns as a stream of one batch.
pub(crate) fn stream<'py>(py: Python<'py>, columns: &Columns) -> PyResult<Bound<'py, PyCapsule>> {
    let batch = batch(columns).map_err(|error| Failure::internal(error.to_string()))?;
    let schema = batch.schema();
    let reader = RecordBatchIterator::new([Ok(batch)], schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(reader));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}
