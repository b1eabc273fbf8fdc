//! `arclength serve`: the page for any model.

use arclength_analysis::{ModelRequest, ModelSource};
use arclength_page::{StartModel, model_site};
use clap::Args;
use kingpin_terminal::{Failure, ServeOptions};
use std::path::PathBuf;

/// The page: models, branches and motions in the browser
///
/// Opens on 127.0.0.1 and nowhere else, needs no connection to the outside, and keeps nothing. Its address is printed; --open shows it.
/// Everything on the page is computed as the other commands do, which it shows to copy.
#[derive(Args, Debug)]
#[command(after_help = "Example: arclength serve model.ode --open")]
pub(crate) struct Serve {
    /// Model that the page begins with
    #[arg(value_name = "MODEL.ode")]
    model: Option<PathBuf>,

    #[command(flatten)]
    server: ServeOptions,
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let start = match &self.model {
            Some(path) => {
                let opened = ModelRequest::new(ModelSource::File(path.clone())).open()?;
                Some(StartModel { name: opened.chosen.stored.name, source: opened.chosen.stored.source })
            }
            None => None,
        };
        self.server.serve(model_site(start))
    }
}
