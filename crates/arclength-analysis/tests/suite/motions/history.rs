//! Histories of models, for tests.

use arclength_analysis::simulate::SimulateRequest;
use arclength_analysis::{ModelRequest, ModelSource, StoredModel};
use arclength_ode::Model;
use serde_json::{Value, to_value};

pub(crate) fn model(text: &str) -> ModelRequest {
    ModelRequest::new(ModelSource::Text(StoredModel {
        name: "model.ode".to_owned(),
        source: text.to_owned(),
        frozen_time: None,
    }))
}

/// A history as columns, the time first.
pub(crate) struct History {
    pub columns: Vec<Vec<f64>>,
    pub warnings: Vec<String>,
}

impl History {
    pub(crate) fn of(text: &str, duration: f64, points: u64) -> Self {
        let mut request = SimulateRequest::new(model(text), duration);
        request.points = Some(points);
        let analysis = request.validate().unwrap_or_else(|error| panic!("{error}"));
        let result = analysis.run().unwrap_or_else(|error| panic!("{text}: {error}"));
        let result = to_value(result).unwrap();
        let numbers = |list: &Value| -> Vec<f64> {
            list.as_array().unwrap().iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
        };
        let names = Model::parse(text).unwrap();
        let states = names.states().iter().map(|name| &result["states"][name]);
        let columns = std::iter::once(&result["t"]).chain(states);
        let warnings = result["warnings"].as_array().into_iter().flatten();
        Self {
            columns: columns.map(numbers).collect(),
            warnings: warnings.map(|warning| warning.as_str().unwrap().to_owned()).collect(),
        }
    }

    pub(crate) fn row(&self, index: usize) -> Vec<f64> {
        self.columns.iter().map(|column| column[index]).collect()
    }

    pub(crate) fn end(&self) -> Vec<f64> {
        self.row(self.columns[0].len() - 1)
    }

    /// The two rows of every time at which a state jumps.
    pub(crate) fn jumps(&self) -> Vec<[Vec<f64>; 2]> {
        let times = &self.columns[0];
        let twice = (1..times.len()).filter(|index| times[*index] == times[index - 1]);
        twice.map(|index| [self.row(index - 1), self.row(index)]).collect()
    }
}

#[track_caller]
pub(crate) fn close(found: &[f64], right: &[f64], error: f64) {
    let is_close = |(found, right): (&f64, &f64)| (found - right).abs() <= error * right.abs().max(1.0);
    assert!(
        found.len() == right.len() && found.iter().zip(right).all(is_close),
        "{found:?}, right {right:?}"
    );
}
