//! A model as it is kept in a result.

use serde::{Deserialize, Serialize};

/// A model with its text, so that a result can be continued where the model's file is not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredModel {
    /// Name of the file that it was read from.
    pub name: String,
    /// The text of that file.
    pub source: String,
    /// The time at which its right-hand side is frozen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frozen_time: Option<f64>,
}
