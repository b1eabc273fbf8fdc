//! Which model an analysis is asked for, with which parameters and from which state.

use crate::error::Error;
use crate::files::{Disk, Files};
use crate::model::ChosenModel;
use crate::point_reference::PointReference;
use crate::start::LabelledPoint;
use crate::stored_model::StoredModel;
use arclength_ode::Model;
use kingpin_report::NamedNumbers;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelSource {
    /// The file of a model.
    File(PathBuf),
    /// The text of a model, with a name for it.
    Text(StoredModel),
    /// A labelled point of an earlier result, with its model and parameters.
    Point(PointReference),
}

/// Which model, with which parameters, from which state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelRequest {
    /// Where the model comes from.
    pub source: ModelSource,
    /// One of the model's named sets of values, taken before those below.
    #[serde(default)]
    pub named_set: Option<String>,
    /// Values of parameters.
    #[serde(default)]
    pub set: NamedNumbers,
    /// Initial values of states.
    #[serde(default)]
    pub start: NamedNumbers,
    /// The time at which a right-hand side that depends on it is frozen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub freeze: Option<f64>,
}

/// A model that was read, with the labelled point that it comes from, if it is one, and what the reader warns of.
#[derive(Clone, Debug)]
pub struct OpenedModel {
    /// The model with its parameters and the initial state.
    pub chosen: ChosenModel,
    /// The labelled point.
    pub point: Option<LabelledPoint>,
    /// What the reader of the model warns of.
    pub warnings: Vec<String>,
}

impl ModelRequest {
    /// A model as it is.
    pub fn new(source: ModelSource) -> Self {
        Self {
            source,
            named_set: None,
            set: NamedNumbers::default(),
            start: NamedNumbers::default(),
            freeze: None,
        }
    }

    /// Reads the model, or the labelled point with its model, and sets parameters and initial state.
    ///
    /// # Errors
    /// A file that cannot be read, a model that makes no sense, an unknown name or a value that is no number.
    pub fn open(&self) -> Result<OpenedModel, Error> {
        self.open_among(&Disk)
    }

    /// The same with other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`open`](Self::open).
    pub fn open_among(&self, files: &dyn Files) -> Result<OpenedModel, Error> {
        let (mut chosen, point, warnings) = match &self.source {
            ModelSource::Point(reference) => {
                let point = LabelledPoint::read(reference, files)?;
                (point.chosen.clone(), Some(point), Vec::new())
            }
            ModelSource::File(path) => {
                let (chosen, warnings) = read(path, files)?;
                (chosen, None, warnings)
            }
            ModelSource::Text(stored) => {
                let chosen = ChosenModel::stored(Path::new(&stored.name), stored.clone(), &[])?;
                let warnings = warnings(Path::new(&stored.name), &chosen.model);
                (chosen, None, warnings)
            }
        };
        if let Some(time) = self.freeze {
            chosen.freeze(time)?;
        }
        let mut initial = Vec::new();
        if let Some(name) = &self.named_set {
            let set = chosen.named_set(name)?.clone();
            initial.clone_from(&set.states);
            set.parameters.iter().for_each(|&(index, value)| chosen.parameters[index] = value);
        }
        chosen.set(&self.set)?;
        if point.is_none() {
            chosen.start = chosen.model.initial_state(&chosen.parameters);
        }
        initial.extend(chosen.states(&self.start)?);
        initial.into_iter().for_each(|(index, value)| chosen.start[index] = value);
        Ok(OpenedModel { chosen, point, warnings })
    }

    /// Whether parameters or states are not those of the source.
    pub fn changes_anything(&self) -> bool {
        self.named_set.is_some() || !self.set.is_empty() || !self.start.is_empty() || self.freeze.is_some()
    }
}

/// Reads the file of a model, with what the reader warns of.
fn read(path: &Path, files: &dyn Files) -> Result<(ChosenModel, Vec<String>), Error> {
    let unreadable = |source| Error::Unreadable { path: path.to_owned(), source };
    let bytes = files.read(path).map_err(unreadable)?;
    if bytes.trim_ascii_start().starts_with(b"{") {
        let problem = format!("this is a result, not a model; try: --from {}:LABEL", path.display());
        return Err(Error::ResultFile { path: path.to_owned(), problem });
    }
    let model = Model::parse_bytes(&bytes)
        .map_err(|source| Error::Model { path: path.to_owned(), source: source.into() })?;
    let warnings = warnings(path, &model);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stored = StoredModel { name, source: model.source().to_owned(), frozen_time: None };
    Ok((ChosenModel::new(stored, model), warnings))
}

fn warnings(path: &Path, model: &Model) -> Vec<String> {
    model.warnings().iter().map(|warning| format!("{}: {warning}", path.display())).collect()
}
