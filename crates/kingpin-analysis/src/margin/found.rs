//! What is found at one value of the parameter: a part of the journal and of the result.

use crate::classification::{Classification, Contact};
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
    /// [`Error::Stopped`], and what is wrong with the request at any value.
    pub(crate) fn seek(
        wheel: &Wheel,
        disturbance: &DisturbanceRequest,
        classification: &Classification,
        contact: Contact,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let without = |error: SimulationError| match error {
            SimulationError::Wheel(KingpinError::NoUniformMotion { .. })
            | SimulationError::UniformMotionSlides { .. }
            | SimulationError::Integration(_) => {
                Ok(Self { positive: None, negative: None, problem: Some(reason(&error)) })
            }
            error => Err(error.into()),
        };
        // What is wrong at this value only is no reason to throw away the others.
        let settings = match classification.settings(wheel) {
            Err(Error::Simulation(error)) => return without(error),
            settings => settings?,
        };
        match disturbance.edges(wheel, contact.model(), settings, control) {
            Ok([positive, negative]) => Ok(Self { positive, negative, problem: None }),
            Err(error) => without(error),
        }
    }
}

/// Why there is no edge at one value of the parameter, in words that fit into a table.
fn reason(error: &SimulationError) -> String {
    match error {
        SimulationError::Wheel(KingpinError::NoUniformMotion { .. }) => "no uniform motion".to_owned(),
        SimulationError::UniformMotionSlides { .. } => "the uniform motion slides".to_owned(),
        error => error.to_string(),
    }
}
