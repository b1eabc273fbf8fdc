//! Columns read back from the files that [`write`](super::write()) writes.

use crate::columns::{Columns, Entries};
use bytes::Bytes;
use parquet::basic::Type as PhysicalType;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Stored {
    /// Its columns, without units.
    pub columns: Columns,
    /// Its metadata: keys with their values.
    pub metadata: Vec<(String, Option<String>)>,
}

/// Reads the content of a file.
///
/// # Errors
/// It is no Parquet file, or holds types that are not written here.
pub(crate) fn read(content: Vec<u8>) -> Result<Stored, ParquetError> {
    let file = SerializedFileReader::new(Bytes::from(content))?;
    let about = file.metadata().file_metadata();
    let metadata = about.key_value_metadata().into_iter().flatten();
    let metadata = metadata.map(|entry| (entry.key.clone(), entry.value.clone())).collect();
    let mut columns = Columns::new();
    for (index, column) in about.schema_descr().columns().iter().enumerate() {
        let mut entries = match column.physical_type() {
            PhysicalType::DOUBLE => Entries::Numbers(Vec::new()),
            PhysicalType::INT64 => Entries::Counts(Vec::new()),
            PhysicalType::BOOLEAN => Entries::Booleans(Vec::new()),
            PhysicalType::BYTE_ARRAY => Entries::Texts(Vec::new()),
            other => return Err(ParquetError::General(format!("column {}: {other}", column.name()))),
        };
        for group in 0..file.num_row_groups() {
            append(&mut entries, &*file.get_row_group(group)?, index)?;
        }
        columns = columns.add(column.name().to_owned(), entries);
    }
    Ok(Stored { columns, metadata })
}

/// Appends what a row group has of a column.
fn append(entries: &mut Entries, group: &dyn RowGroupReader, column: usize) -> Result<(), ParquetError> {
    let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
    match (entries, group.get_column_reader(column)?) {
        (Entries::Numbers(entries), ColumnReader::DoubleColumnReader(reader)) => {
            entries.extend(values(reader, rows)?);
        }
        (Entries::Counts(entries), ColumnReader::Int64ColumnReader(reader)) => {
            // Counts are written as signed numbers and are never absent.
            entries.extend(values(reader, rows)?.into_iter().map(|count| count.unwrap_or(0) as u64));
        }
        (Entries::Booleans(entries), ColumnReader::BoolColumnReader(reader)) => {
            entries.extend(values(reader, rows)?);
        }
        (Entries::Texts(entries), ColumnReader::ByteArrayColumnReader(reader)) => {
            let text = |bytes: ByteArray| Ok::<_, ParquetError>(bytes.as_utf8()?.to_owned());
            for entry in values(reader, rows)? {
                entries.push(entry.map(text).transpose()?);
            }
        }
        _ => return Err(ParquetError::General(format!("column {column} has another type than its schema"))),
    }
    Ok(())
}

/// The values of a column, nothing where there is none.
fn values<D: DataType>(
    mut reader: ColumnReaderImpl<D>,
    rows: usize,
) -> Result<Vec<Option<D::T>>, ParquetError> {
    let (mut present, mut there) = (Vec::new(), Vec::new());
    while present.len() < rows {
        let (records, ..) =
            reader.read_records(rows - present.len(), Some(&mut present), None, &mut there)?;
        if records == 0 {
            return Err(ParquetError::General(format!("{} of {rows} rows", present.len())));
        }
    }
    let mut there = there.into_iter();
    Ok(present.into_iter().map(|present| if present > 0 { there.next() } else { None }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_back() {
        let columns = Columns::new()
            .optional_numbers("x", [Some(0.1), None, Some(-0.0), Some(f64::INFINITY)])
            .booleans("stable", [Some(true), None, Some(false), None])
            .counts("branch", [1, 2, 3, 4])
            .texts("fate", ["a", "b"].into_iter().cycle().take(4).map(|text| Some(text.to_owned())));
        let mut content = Vec::new();
        crate::parquet::write(&columns, &[("key", "value".to_owned())], &mut content).unwrap();
        let stored = read(content).unwrap();
        assert_eq!(stored.columns, columns);
        assert_eq!(stored.metadata[0], ("key".to_owned(), Some("value".to_owned())));
        assert!(read(b"no such file".to_vec()).is_err());
    }
}
