//! How a program runs and ends: its options, what it says of a failure, and its exit code.

use crate::failure::Failure;
use crate::interruption::Interruption;
use crate::shortened::shortened;
use crate::streams::say;
use clap::Parser;
use clap::error::ErrorKind;
use std::borrow::Cow;
use std::error::Error;
use std::ffi::OsString;
use std::io::{self, Write};

const HELP_WITHOUT_COMMAND: ErrorKind = ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
/// Exit code of options that cannot be read, as of other bad input.
const BAD_OPTIONS: u8 = 2;

/// Runs a program: listens to signals, reads the options, runs the command, says why it failed. The exit code is 0 when it is
/// done, 1 when the computation failed, 2 for bad input, 128 and its number where a signal stopped it.
///
/// `arguments` are those of the process, or what stands for them where the program is part of another; the first is its name.
pub fn run<Options: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    command: impl FnOnce(&Options) -> Result<(), Failure>,
) -> u8 {
    if let Err(failure) = Interruption::listen() {
        say_failure(&failure);
        return failure.exit_code();
    }
    let options = match Options::try_parse_from(arguments) {
        Ok(options) => options,
        Err(error) => return refuse(&error),
    };
    match command(&options) {
        Ok(()) | Err(Failure::OutputClosed) => 0,
        Err(failure) => {
            say_failure(&failure);
            // Whatever failed after a signal failed because of it.
            Interruption::exit_code().unwrap_or_else(|| failure.exit_code())
        }
    }
}

/// Says what is wrong with the options, or the help that was asked for.
fn refuse(error: &clap::Error) -> u8 {
    let text = error.render().to_string();
    match shortened(&text) {
        // Help is as long as it is; what need not be shortened a terminal shows in colours.
        Cow::Owned(text) if error.use_stderr() && error.kind() != HELP_WITHOUT_COMMAND => {
            // Where standard error is closed there is nobody left to tell.
            let _ = write!(io::stderr(), "{text}");
            BAD_OPTIONS
        }
        _ => error.exit(),
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
