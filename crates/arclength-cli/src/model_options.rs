//! Options that say which model, with which parameters, from which state.

use arclength_analysis::{Assignment, InvalidField, ModelRequest, ModelSource, PointReference};
use clap::Args;
use kingpin_report::NamedNumbers;
use kingpin_terminal::Failure;
use std::path::PathBuf;

/// Which model, with which parameters, from which state.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Model")]
pub(crate) struct ModelOptions {
    /// File of the model
    #[arg(value_name = "MODEL.ode", required_unless_present = "from")]
    model: Option<PathBuf>,

    /// Start from a labelled point of an earlier result, with its model and parameters
    #[arg(long, value_name = "FILE.json:LABEL", conflicts_with = "model")]
    from: Option<PointReference>,

    /// Take the values of one of the model's named sets
    #[arg(long, value_name = "NAME")]
    named_set: Option<String>,

    #[command(flatten)]
    parameters: ParameterOptions,

    /// Initial values of states, for example x=1,y=2
    #[arg(long, value_name = "KEY=VALUE,..", value_delimiter = ',')]
    start: Vec<Assignment>,
}

/// Values of parameters.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Model")]
pub(crate) struct ParameterOptions {
    /// Set a parameter; repeatable
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<Assignment>,
}

impl ModelOptions {
    /// The model that is asked for.
    ///
    /// # Errors
    /// A value that is no number.
    pub(crate) fn request(&self) -> Result<ModelRequest, Failure> {
        let source = match (&self.from, &self.model) {
            (Some(point), _) => ModelSource::Point(point.clone()),
            (None, Some(path)) => ModelSource::File(path.clone()),
            (None, None) => {
                return Err(Failure::Option {
                    option: "MODEL.ode",
                    given: "nothing".to_owned(),
                    problem: "there is no model".to_owned(),
                    allowed: "the file of a model, or --from FILE.json:LABEL".to_owned(),
                });
            }
        };
        Ok(ModelRequest {
            source,
            named_set: self.named_set.clone(),
            set: self.parameters.values()?,
            start: numbers(&self.start, &["start"])?,
            freeze: None,
        })
    }
}

impl ParameterOptions {
    /// The values that are set.
    ///
    /// # Errors
    /// One that is no number.
    pub(crate) fn values(&self) -> Result<NamedNumbers, Failure> {
        Ok(numbers(&self.set, &["set"])?)
    }
}

fn numbers(given: &[Assignment], fields: &'static [&'static str]) -> Result<NamedNumbers, InvalidField> {
    given.iter().map(|assignment| assignment.number(fields)).collect::<Result<_, _>>().map(NamedNumbers)
}
