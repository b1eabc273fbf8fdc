//! What a diagram shows of a point of shimmy.

use super::point::ShimmyPointResult;
use arclength_analysis::labels::is_bifurcation;
use kingpin_figure::Stability;
use serde::Deserialize;

/// A point as it is drawn.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct DrawnPoint {
    pub branch: u64,
    pub label: Option<String>,
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    pub psi_max: f64,
    pub psi_min: f64,
    pub stable: Option<bool>,
}

impl DrawnPoint {
    pub(super) fn stability(&self) -> Stability {
        if is_bifurcation(self.label.as_deref()) {
            Stability::Changes
        } else {
            Stability::from(self.stable == Some(true))
        }
    }
}

impl From<&ShimmyPointResult> for DrawnPoint {
    fn from(point: &ShimmyPointResult) -> Self {
        Self {
            branch: point.branch,
            label: point.label.clone(),
            value: point.value,
            psi_max: point.psi_max,
            psi_min: point.psi_min,
            stable: point.stable,
        }
    }
}
