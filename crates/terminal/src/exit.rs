//! How a program ends: what it says of a failure, and its exit code.

use crate::failure::Failure;
use crate::streams::say;
use std::error::Error;
use std::process::ExitCode;

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
    // The message of an analysis is that of its error, with other names.
    let mut cause = match failure {
        Failure::Analysis { source, .. } => source.source(),
        other => other.source(),
    };
    while let Some(error) = cause {
        let text = error.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = error.source();
    }
    say("error", &message);
}
