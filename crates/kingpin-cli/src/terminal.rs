//! Standard output, which may be closed at any time, and standard error.

use crate::failure::Failure;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

/// Hands a buffered standard output to a writer of results.
///
/// # Errors
/// [`Failure::OutputClosed`] where nobody reads it any more, and those of the writer.
pub fn print(write: impl FnOnce(&mut (dyn Write + Send)) -> Result<(), Failure>) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout());
    write(&mut out)?;
    out.flush().map_err(|error| output_failure(error, "text"))
}

/// What an error of a writer means: a closed standard output is no failure.
pub fn output_failure(error: io::Error, format: &'static str) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Failure::OutputClosed;
    }
    Failure::Encoding { format, cause: error.to_string() }
}

/// Says something beside the result, on standard error.
pub fn say(kind: &str, message: &str) {
    // Where standard error is closed there is nobody left to tell.
    let _ = writeln!(io::stderr(), "{kind}: {message}");
}

/// The exit code of a command, after saying why it failed.
pub fn exit_code(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) | Err(Failure::OutputClosed) => ExitCode::SUCCESS,
        Err(failure) => {
            say_failure(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Says why the command failed, with the causes that the message itself does not name.
fn say_failure(failure: &Failure) {
    let mut message = failure.to_string();
    let mut cause = std::error::Error::source(failure);
    while let Some(error) = cause {
        let text = error.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = error.source();
    }
    say("error", &message);
}
