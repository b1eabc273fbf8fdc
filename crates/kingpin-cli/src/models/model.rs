//! A model with values of its parameters, from a file or from an earlier result.

use crate::document::NamedNumbers;
use crate::failure::Failure;
use crate::output::Output;
use crate::range::{Assignment, Range, Values};
use crate::stored::StoredModel;
use arclength_ode::Model;
use clap::Args;
use std::path::{Path, PathBuf};

/// Which model, with which parameters.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Model")]
pub struct ModelOptions {
    /// File of the model
    #[arg(value_name = "MODEL.ode")]
    model: PathBuf,

    #[command(flatten)]
    parameters: ParameterOptions,

    /// Initial values of states in place of those of the file, for example x=1,y=2
    #[arg(long, value_name = "KEY=VALUE,..", value_delimiter = ',')]
    start: Vec<Assignment>,
}

/// Values of parameters.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Model")]
pub struct ParameterOptions {
    /// Set a parameter; repeatable
    #[arg(short, long, value_name = "KEY=VALUE")]
    set: Vec<Assignment>,
}

/// A model with a value for every parameter and an initial value for every state.
#[derive(Clone, Debug)]
pub struct ChosenModel {
    /// Where it came from.
    pub stored: StoredModel,
    /// The model.
    pub model: Model,
    /// Values of all parameters.
    pub parameters: Vec<f64>,
    /// Initial state.
    pub start: Vec<f64>,
}

impl ModelOptions {
    /// Reads the model and sets its parameters and initial state.
    ///
    /// # Errors
    /// A file that cannot be read, a model that makes no sense, an unknown name or a value that is no number.
    pub fn choose(&self, output: &Output) -> Result<ChosenModel, Failure> {
        let unreadable = |source| Failure::Unreadable { path: self.model.clone(), source };
        let bytes = std::fs::read(&self.model).map_err(unreadable)?;
        let model = Model::parse_bytes(&bytes)
            .map_err(|source| Failure::Model { path: self.model.clone(), source: source.into() })?;
        for warning in model.warnings() {
            output.warn(&format!("{}: {warning}", self.model.display()));
        }
        let name = self.model.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let stored = StoredModel { name, source: model.source().to_owned() };
        let mut chosen = ChosenModel::new(stored, model);
        chosen.set(&self.parameters)?;
        chosen.start = chosen.model.initial_state(&chosen.parameters);
        for Assignment { key, value } in &self.start {
            let index = chosen.model.state_index(key);
            let index = index.ok_or_else(|| unknown("--start", key, "state", chosen.model.states()))?;
            chosen.start[index] = number("--start", key, value)?;
        }
        Ok(chosen)
    }
}

impl ChosenModel {
    fn new(stored: StoredModel, model: Model) -> Self {
        let parameters = model.default_parameters().to_vec();
        let start = model.initial_state(&parameters);
        Self { stored, model, parameters, start }
    }

    /// The model of an earlier result, with the parameters there.
    ///
    /// # Errors
    /// A text that is no model, or parameters that are not its own.
    pub fn stored(path: &Path, stored: StoredModel, parameters: &[(String, f64)]) -> Result<Self, Failure> {
        let model = Model::parse(&stored.source)
            .map_err(|source| Failure::Model { path: path.to_owned(), source: source.into() })?;
        let mut chosen = Self::new(stored, model);
        for (name, value) in parameters {
            let index = chosen.model.parameter_index(name).ok_or_else(|| Failure::ResultFile {
                path: path.to_owned(),
                problem: format!("its model has no parameter `{name}`"),
            })?;
            chosen.parameters[index] = *value;
        }
        Ok(chosen)
    }

    /// Sets parameters.
    ///
    /// # Errors
    /// An unknown name or a value that is no number.
    pub fn set(&mut self, options: &ParameterOptions) -> Result<(), Failure> {
        for Assignment { key, value } in &options.set {
            let index = self.parameter("--set", key)?;
            self.parameters[index] = number("--set", key, value)?;
        }
        Ok(())
    }

    /// Index of the parameter along which something is followed.
    ///
    /// # Errors
    /// An unknown name; a field that depends on the time, which has neither equilibria nor cycles of its own.
    pub fn along(&self, range: &Range) -> Result<usize, Failure> {
        if let Some(place) = self.model.time_dependence() {
            return Err(Failure::ResultFile {
                path: self.stored.name.clone().into(),
                problem: format!(
                    "the right-hand side depends on the time: it has no equilibria and no cycles of its own\n{}",
                    place.snippet()
                ),
            });
        }
        self.parameter("--along", &range.key)
    }

    fn parameter(&self, option: &'static str, key: &str) -> Result<usize, Failure> {
        let index = self.model.parameter_index(key);
        index.ok_or_else(|| unknown(option, key, "parameter", self.model.parameters()))
    }

    /// Values of the parameter that varies.
    ///
    /// # Errors
    /// Another parameter.
    pub fn values(&self, along: usize, range: &Range, given: &[Values]) -> Result<Vec<f64>, Failure> {
        let mut all = Vec::new();
        for Values { key, values } in given {
            if key.as_ref().is_some_and(|key| self.model.parameter_index(key) != Some(along)) {
                return Err(Failure::Option {
                    option: "--at",
                    given: key.clone().unwrap_or_default(),
                    problem: "this parameter does not vary here".to_owned(),
                    allowed: format!("values of {}", range.key),
                });
            }
            all.extend(values);
        }
        match all.iter().find(|value| !(range.start..=range.end).contains(*value)) {
            Some(outside) => Err(Failure::Option {
                option: "--at",
                given: outside.to_string(),
                problem: "outside the interval".to_owned(),
                allowed: format!("{} to {}", range.start, range.end),
            }),
            None => Ok(all),
        }
    }

    /// All parameters by name, without the one that varies.
    pub fn named_parameters(&self, varying: Option<usize>) -> NamedNumbers {
        let named = self.model.parameters().iter().cloned().zip(self.parameters.iter().copied());
        let fixed = named.enumerate().filter(|(index, _)| Some(*index) != varying);
        NamedNumbers(fixed.map(|(_, entry)| entry).collect())
    }

    /// A state by name.
    pub fn named_state(&self, state: &[f64]) -> NamedNumbers {
        NamedNumbers(self.model.states().iter().cloned().zip(state.iter().copied()).collect())
    }
}

fn number(option: &'static str, key: &str, value: &str) -> Result<f64, Failure> {
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(Failure::Option {
            option,
            given: format!("{key}={value}"),
            problem: "not a finite number".to_owned(),
            allowed: "a finite number".to_owned(),
        }),
    }
}

fn unknown(option: &'static str, key: &str, what: &str, names: &[String]) -> Failure {
    let allowed = if names.is_empty() { "none, there is no such thing".to_owned() } else { names.join(", ") };
    Failure::Option {
        option,
        given: key.to_owned(),
        problem: format!("the model has no such {what}"),
        allowed,
    }
}
