//! `kingpin serve`: the page for a wheel.

use crate::wheel_options::WheelOptions;
use clap::Args;
use kingpin_page::wheel_site;
use kingpin_terminal::{Failure, ServeOptions};

/// The page: a wheel, its stability chart, cycles and motions in the browser
///
/// Opens on 127.0.0.1 and nowhere else, needs no connection to the outside, and keeps nothing. Its address is printed; --open shows it.
/// Everything on the page is computed as the other commands do, which it shows to copy.
#[derive(Args, Debug)]
#[command(after_help = "Example: kingpin serve --wheel trolley.toml --open")]
pub(crate) struct Serve {
    #[command(flatten)]
    wheel: WheelOptions,

    #[command(flatten)]
    server: ServeOptions,
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.server.serve(wheel_site(&self.wheel.request().read()?))
    }
}
