//! A curve of special equilibria of a model as a result.

use super::equilibrium_curve::EquilibriumCurve;
use super::quantities::Quantities;
use crate::branch::{Origin, at_parameters};
use crate::interval::Interval;
use crate::model::ChosenModel;
use crate::stored_model::StoredModel;
use crate::varying_parameter::VaryingParameter;
use arclength::locus::EquilibriumLocusBranch;
use kingpin_figure::{Figure, FigureError};
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Story};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// A curve of special equilibria of a model.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumLocusResult {
    /// The parameters that do not vary.
    #[serde(skip_serializing)]
    pub parameters: NamedNumbers,
    /// The model.
    pub model: StoredModel,
    /// The curve.
    #[serde(flatten)]
    pub curve: EquilibriumCurve,
}

impl EquilibriumLocusResult {
    /// Schema of the result file.
    pub const SCHEMA: &'static str = "arclength.locus";

    /// The result of a curve, with the names of its monitors.
    pub fn new(
        chosen: &ChosenModel,
        plane: [&Interval; 2],
        from: Origin,
        monitors: &[String],
        branch: &EquilibriumLocusBranch,
    ) -> Self {
        Self {
            parameters: chosen.named_parameters(&branch.active),
            model: chosen.stored.clone(),
            curve: EquilibriumCurve::new(
                branch.kind,
                Quantities { plane: plane.map(VaryingParameter::from), monitors, ends: None },
                from,
                &branch.points,
                &branch.stops,
                &branch.unlocated,
                |state| chosen.named_state(state),
            ),
        }
    }
}

impl EquilibriumLocusResult {
    /// The same with what keeps its value along it.
    pub(super) fn holding(self, name: &str, value: f64) -> Self {
        Self { curve: self.curve.holding(name, value), ..self }
    }
}

impl Report for EquilibriumLocusResult {
    fn schema(&self) -> Schema {
        Schema::first(Self::SCHEMA)
    }

    fn parameters(&self) -> Parameters {
        self.parameters.clone().into()
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let (what, model) = (self.curve.name(), &self.model.name);
        let heading = format!("curve of {what} of {model}{}", at_parameters(&self.parameters.0));
        self.curve.write_table(&heading, out)
    }

    fn columns(&self) -> Columns {
        self.curve.columns()
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let [one, two] = self.curve.keys();
        let description = format!("{} of {} in {one} and {two}", self.curve.name(), self.model.name);
        Ok(Some(self.curve.figure(&description, [one, two], [|value| value; 2])))
    }

    fn story(&self) -> Option<Story> {
        Some(self.curve.story())
    }
}
