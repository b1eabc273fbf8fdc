//! Results as JSON: one object with `schema`, `parameters` and the fields of the result.
//!
//! One line holds one field, or one object of a list, so that files can be read, searched and compared.

use crate::error::ReportError;
use crate::parameters::Parameters;
use crate::report::Report;
use crate::schema::Schema;
use serde::Serialize;
use std::io::{self, Write};

#[derive(Serialize)]
struct Document<'a, R: ?Sized> {
    schema: Schema,
    parameters: Parameters,
    #[serde(flatten)]
    result: &'a R,
}

/// Writes a result as JSON.
///
/// # Errors
/// [`ReportError::Encoding`] where the writer fails.
pub fn write<R: Report + ?Sized>(result: &R, out: &mut dyn Write) -> Result<(), ReportError> {
    let document = Document { schema: result.schema(), parameters: result.parameters(), result };
    let mut serializer = serde_json::Serializer::with_formatter(&mut *out, Lines::default());
    let written = document.serialize(&mut serializer).map_err(io::Error::from);
    written.and_then(|()| out.write_all(b"\n")).map_err(ReportError::encoding("JSON"))
}

/// One field of the object, or one object of a list in it, on a line.
#[derive(Default)]
struct Lines {
    depth: usize,
    list_of_objects: bool,
}

impl serde_json::ser::Formatter for Lines {
    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.depth == 2 {
            self.list_of_objects = true;
            writer.write_all(b"\n    ")?;
        }
        self.depth += 1;
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        writer.write_all(if self.depth == 0 { b"\n}" } else { b"}" })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        match (self.depth, first) {
            (1, true) => writer.write_all(b"\n  "),
            (1, false) => writer.write_all(b",\n  "),
            (_, true) => Ok(()),
            (_, false) => writer.write_all(b", "),
        }
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        writer.write_all(b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if self.depth == 1 && std::mem::take(&mut self.list_of_objects) {
            writer.write_all(b"\n  ")?;
        }
        writer.write_all(b"]")
    }
}
