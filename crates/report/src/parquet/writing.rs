//! Results as Parquet files with typed columns; schema, parameters and units stand in the file's metadata.

use crate::columns::{Columns, Entries};
use crate::error::ReportError;
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::io::{self, Write};
use std::sync::Arc;

/// Writes columns, and key-value metadata, as one Parquet file.
///
/// # Errors
/// [`ReportError::Encoding`] where the writer fails.
pub fn write(
    columns: &Columns,
    metadata: &[(&str, String)],
    out: &mut (dyn Write + Send),
) -> Result<(), ReportError> {
    write_file(columns, metadata, out).map_err(io::Error::other).map_err(ReportError::encoding("Parquet"))
}

fn write_file(
    columns: &Columns,
    metadata: &[(&str, String)],
    out: &mut (dyn Write + Send),
) -> Result<(), ParquetError> {
    let fields: Vec<TypePtr> =
        columns.iter().map(|column| field(&column.name, &column.entries)).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("result").with_fields(fields).build()?;
    let entries = metadata.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(entries.collect()))
        .build();
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for column in columns.iter() {
        match &column.entries {
            Entries::Numbers(entries) => write_column::<DoubleType>(&mut rows, entries.iter().copied()),
            Entries::Booleans(entries) => write_column::<BoolType>(&mut rows, entries.iter().copied()),
            // Counts are far below the largest signed number.
            Entries::Counts(entries) => {
                write_column::<Int64Type>(&mut rows, entries.iter().map(|count| Some(*count as i64)))
            }
            Entries::Texts(entries) => {
                let bytes = |text: &Option<String>| text.as_deref().map(ByteArray::from);
                write_column::<ByteArrayType>(&mut rows, entries.iter().map(bytes))
            }
        }?;
    }
    rows.close()?;
    writer.close()?;
    Ok(())
}

fn field(name: &str, entries: &Entries) -> Result<TypePtr, ParquetError> {
    let (physical, logical) = match entries {
        Entries::Numbers(_) => (PhysicalType::DOUBLE, None),
        Entries::Counts(_) => (PhysicalType::INT64, None),
        Entries::Booleans(_) => (PhysicalType::BOOLEAN, None),
        Entries::Texts(_) => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let builder = Type::primitive_type_builder(name, physical)
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(logical);
    builder.build().map(Arc::new)
}

/// Writes the values that there are, and for every row whether there is one.
fn write_column<D: DataType>(
    rows: &mut SerializedRowGroupWriter<'_, &mut (dyn Write + Send)>,
    entries: impl Iterator<Item = Option<D::T>>,
) -> Result<(), ParquetError> {
    let mut column = rows.next_column()?.ok_or_else(|| ParquetError::General("no such column".to_owned()))?;
    let (mut present, mut values) = (Vec::new(), Vec::new());
    for entry in entries {
        present.push(i16::from(entry.is_some()));
        values.extend(entry);
    }
    column.typed::<D>().write_batch(&values, Some(&present), None)?;
    column.close()
}
