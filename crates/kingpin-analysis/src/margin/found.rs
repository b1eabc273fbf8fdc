//! What is found at one value of the parameter: a part of the journal and of the result.

use crate::classification::Classification;
use crate::disturbance::{DisturbanceRequest, Edge};
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::simulation::SimulationError;
use kingpin::{KingpinError, Wheel};
use serde::{Deserialize, Serialize};

/// What was found at one value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The edge in the positive direction.
    pub positive: Option<Edge>,
    /// The edge in the negative direction.
    pub negative: Option<Edge>,
    /// Why no edge was sought.
    pub problem: Option<String>,
}

impl Found {
    /// Seeks the edges of a wheel.
    ///
    /// # Errors
    /// A motion that cannot be followed; [`Error::Stopped`].
    pub(super) fn seek(
        wheel: &Wheel,
        disturbance: &DisturbanceRequest,
        classification: &Classification,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let without =
            |problem: &str| Ok(Self { positive: None, negative: None, problem: Some(problem.to_owned()) });
        let settings = match classification.settings(wheel) {
            Err(Error::Simulation(SimulationError::Wheel(KingpinError::NoUniformMotion { .. }))) => {
                return without("no uniform motion");
            }
            settings => settings?,
        };
        match disturbance.edges(wheel, classification.model(), settings, control) {
            Ok([positive, negative]) => Ok(Self { positive, negative, problem: None }),
            Err(SimulationError::UniformMotionSlides { .. }) => without("the uniform motion slides"),
            Err(error) => Err(error.into()),
        }
    }
}
