//! Standard output, which may be closed at any time, and standard error.

use crate::failure::Failure;
use crate::shortened::shortened;
use kingpin_report::ReportError;
use std::io::{self, BufWriter, Write};

/// Hands a buffered standard output to a writer of results.
///
/// # Errors
/// [`Failure::OutputClosed`] where nobody reads it any more, and those of the writer.
pub fn print(write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), ReportError>) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout());
    write(&mut out)
        .and_then(|()| out.flush().map_err(|source| ReportError::Encoding { format: "text", source }))
        .map_err(Failure::of_output)
}

/// Says something beside the result, on standard error; the middle of what is too long to be read is left out.
pub fn say(kind: &str, message: &str) {
    // Where standard error is closed there is nobody left to tell.
    let _ = writeln!(io::stderr(), "{kind}: {}", shortened(message));
}
