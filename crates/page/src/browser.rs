//! Shows a page in the user's browser.

use std::io;
use std::process::{Command, Stdio};

/// Opens an address in the browser that the system prefers.
///
/// # Errors
/// The program that does so is missing.
pub fn open(url: &str) -> io::Result<()> {
    let mut command = if cfg!(target_os = "windows") {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        command
    } else if cfg!(target_os = "macos") {
        Command::new("open")
    } else {
        Command::new("xdg-open")
    };
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().map(|_| ())
}
