//! Options that say how motions are followed and told apart.

use clap::{Args, ValueEnum};
use kingpin_analysis::{Classification, Contact};

/// Whether the wheel may slide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ContactOption {
    /// Ideal rolling, as in the paper and in `cycles`: the ground supplies whatever force that takes
    #[default]
    Rolling,
    /// Coulomb friction: the wheel slides where rolling takes more than the static friction
    Sliding,
}

impl From<ContactOption> for Contact {
    fn from(contact: ContactOption) -> Self {
        match contact {
            ContactOption::Rolling => Self::Rolling,
            ContactOption::Sliding => Self::Sliding,
        }
    }
}

/// How motions are followed.
#[derive(Args, Clone, Debug)]
pub struct ClassificationOptions {
    /// Whether the wheel may slide [default: rolling; in safe-kick and margin sliding where a load F_Az is set, and where none is
    /// safe-kick tells both]
    #[arg(long, value_enum)]
    contact: Option<ContactOption>,

    /// Time in s for which motions are followed, up to ten times as long while they swing to and fro unsettled [default: 12 times the
    /// decay time of small disturbances, 30 to 300]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
}

impl From<&ClassificationOptions> for Classification {
    fn from(options: &ClassificationOptions) -> Self {
        Self { contact: options.contact.map(Contact::from), duration: options.duration }
    }
}
