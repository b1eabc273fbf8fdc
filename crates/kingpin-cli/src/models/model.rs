//! A model with values of its parameters, from a file or from an earlier result.

use super::branch::StoredModel;
use super::start::{LabelledPoint, read};
use crate::document::NamedNumbers;
use crate::failure::Failure;
use crate::output::Output;
use crate::range::{Assignment, Range, Values};
use crate::stored::PointReference;
use arclength_ode::Model;
use clap::Args;
use std::path::{Path, PathBuf};

/// Which model, with which parameters, from which state.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Model")]
pub struct ModelOptions {
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
    /// Reads the model, or the labelled point with its model, and sets parameters and initial state.
    ///
    /// # Errors
    /// A file that cannot be read, a model that makes no sense, an unknown name or a value that is no number.
    pub fn choose(&self, output: &Output) -> Result<(ChosenModel, Option<LabelledPoint>), Failure> {
        let (mut chosen, point) = match (&self.from, &self.model) {
            (Some(reference), _) => {
                let point = read(reference)?;
                (point.chosen.clone(), Some(point))
            }
            (None, Some(path)) => (read_model(path, output)?, None),
            (None, None) => {
                return Err(Failure::Option {
                    option: "MODEL.ode",
                    given: "nothing".to_owned(),
                    problem: "there is no model".to_owned(),
                    allowed: "the file of a model, or --from FILE.json:LABEL".to_owned(),
                });
            }
        };
        let mut initial = Vec::new();
        if let Some(name) = &self.named_set {
            let set = chosen.model.set(name).ok_or_else(|| {
                let names: Vec<String> = chosen.model.sets().iter().map(|set| set.name.clone()).collect();
                unknown("--named-set", name, "named set", &names)
            })?;
            initial.clone_from(&set.states);
            set.parameters.iter().for_each(|&(index, value)| chosen.parameters[index] = value);
        }
        chosen.set(&self.parameters)?;
        if point.is_none() {
            chosen.start = chosen.model.initial_state(&chosen.parameters);
        }
        for Assignment { key, value } in &self.start {
            let index = chosen.model.state_index(key);
            let index = index.ok_or_else(|| unknown("--start", key, "state", chosen.model.states()))?;
            initial.push((index, number("--start", key, value)?));
        }
        initial.into_iter().for_each(|(index, value)| chosen.start[index] = value);
        Ok((chosen, point))
    }

    /// Whether parameters or states are not those of the file that was read.
    pub fn changes_anything(&self) -> bool {
        self.named_set.is_some() || !self.parameters.set.is_empty() || !self.start.is_empty()
    }
}

/// Reads the file of a model.
///
/// # Errors
/// A file that cannot be read or a model that makes no sense.
pub fn read_model(path: &Path, output: &Output) -> Result<ChosenModel, Failure> {
    let unreadable = |source| Failure::Unreadable { path: path.to_owned(), source };
    let bytes = std::fs::read(path).map_err(unreadable)?;
    if bytes.trim_ascii_start().starts_with(b"{") {
        let problem = format!("this is a result, not a model; try: --from {}:LABEL", path.display());
        return Err(Failure::ResultFile { path: path.to_owned(), problem });
    }
    let model = Model::parse_bytes(&bytes)
        .map_err(|source| Failure::Model { path: path.to_owned(), source: source.into() })?;
    for warning in model.warnings() {
        output.warn(&format!("{}: {warning}", path.display()));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(ChosenModel::new(StoredModel { name, source: model.source().to_owned() }, model))
}

impl ChosenModel {
    /// A model with the parameters and the initial state of its text.
    pub fn new(stored: StoredModel, model: Model) -> Self {
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

    /// Index of the parameter along which something is followed; `option` is where it was given.
    ///
    /// # Errors
    /// An unknown name; an infinite interval; a field that depends on the time, which has neither equilibria nor cycles of
    /// its own.
    pub fn along(&self, option: &'static str, range: &Range) -> Result<usize, Failure> {
        if let Some(place) = self.model.time_dependence() {
            return Err(Failure::ResultFile {
                path: self.stored.name.clone().into(),
                problem: format!(
                    "the right-hand side depends on the time: it has no equilibria and no cycles of its own\n{}",
                    place.snippet()
                ),
            });
        }
        let index = self.parameter(option, &range.key)?;
        if !(range.start.is_finite() && range.end.is_finite()) {
            return Err(Failure::Option {
                option,
                given: format!("{}={}:{}", range.key, range.start, range.end),
                problem: "the interval is infinite".to_owned(),
                allowed: "two finite ends".to_owned(),
            });
        }
        Ok(index)
    }

    /// That the interval contains the value of the parameter where a computation starts.
    ///
    /// # Errors
    /// It does not.
    pub fn starts_within(&self, option: &'static str, range: &Range, label: &str) -> Result<(), Failure> {
        let value = self.model.parameter_index(&range.key).and_then(|index| self.parameters.get(index));
        match value {
            Some(value) if !(range.start..=range.end).contains(value) => Err(Failure::Option {
                option,
                given: format!("{}={}:{}", range.key, range.start, range.end),
                problem: format!("{label} is outside the interval, {} = {value} there", range.key),
                allowed: format!("an interval that contains {value}"),
            }),
            _ => Ok(()),
        }
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
    let alike = |name: &&String| strsim::jaro_winkler(&name.to_lowercase(), &key.to_lowercase());
    let nearest = names.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
    let guess = nearest.map_or(String::new(), |name| format!("; the nearest is `{name}`"));
    Failure::Option {
        option,
        given: key.to_owned(),
        problem: format!("the model has no such {what}{guess}"),
        allowed,
    }
}
