//! `serve` of every program: its page, until Ctrl-C.

use crate::failure::Failure;
use crate::interruption::Interruption;
use crate::options::start_threads;
use crate::streams::{print, say};
use arclength_page::{Server, Site, open};
use clap::Args;
use kingpin_report::ReportError;

/// Where the page is.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Server")]
pub struct ServeOptions {
    /// Port on 127.0.0.1; 0 is any free one
    #[arg(long, value_name = "PORT", default_value_t = 3141)]
    port: u16,

    /// Show the page in the browser
    #[arg(long)]
    open: bool,

    /// Number of threads; results do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=crate::MOST_THREADS))]
    threads: Option<u16>,
}

impl ServeOptions {
    /// Serves a page until Ctrl-C, which is its regular end. Its address is the one line of standard output.
    ///
    /// # Errors
    /// [`Failure::Server`] and [`Failure::Threads`].
    pub fn serve(&self, site: Site) -> Result<(), Failure> {
        start_threads(self.threads)?;
        let server = Server::listen(self.port).map_err(Failure::Server)?;
        let url = server.url();
        print(|out| {
            writeln!(out, "{url}").map_err(|source| ReportError::Encoding { format: "text", source })
        })?;
        say("note", "Ctrl-C ends it");
        if self.open
            && let Err(error) = open(&url)
        {
            say("warning", &format!("no browser could be started ({error}); the page is at {url}"));
        }
        Interruption::during(|flag| server.run(site, flag)).map_err(Failure::Server)
    }
}
