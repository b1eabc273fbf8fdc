//! What a time history is asked for by, and how it is computed.

use super::result::HistoryResult;
use super::rolling_result::RollingHistory;
use super::sliding_result::SlidingHistory;
use super::tyre_result::TyreHistoryResult;
use crate::classification::Contact;
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin::{Tyre, Wheel};
use kingpin_report::NamedNumbers;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// A time history from the perturbed uniform motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulateRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Time in s.
    pub duration: f64,
    /// Changes of states (u, q, psi, V, Omega; with k_u = inf q, psi, Omega; with a tyre u, q, psi, V1, V2, Omega, y_t) at the start.
    #[serde(default)]
    pub perturb: NamedNumbers,
    /// A sideways blow in N s on the rim of the wheel, R ahead of its centre, at the start.
    #[serde(default)]
    pub blow: f64,
    /// Number of samples, at equal distances from 0 to the end.
    #[serde(default = "SimulateRequest::default_points")]
    pub points: u64,
    /// Whether the wheel may slide; then the states are u, q, psi, V1, V2, Omega, W, and V changes V1 and W.
    #[serde(default)]
    pub contact: Contact,
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct SimulateAnalysis {
    wheel: Wheel,
    duration: f64,
    perturb: NamedNumbers,
    blow: f64,
    points: usize,
    contact: Contact,
}

impl SimulateRequest {
    /// Numbers of samples that are allowed.
    pub const POINTS: RangeInclusive<u64> = 2..=1_000_000;

    /// Number of samples where none was given.
    pub const fn default_points() -> u64 {
        1001
    }

    /// A request for the paper's wheel with the default of everything else.
    pub fn new(duration: f64) -> Self {
        Self {
            wheel: WheelRequest::default(),
            duration,
            perturb: NamedNumbers::default(),
            blow: 0.0,
            points: Self::default_points(),
            contact: Contact::default(),
        }
    }

    /// Reads the wheel and checks the number of samples; the rest is checked by the simulation.
    ///
    /// # Errors
    /// What is wrong with the wheel; too few or too many samples.
    pub fn validate(&self) -> Result<SimulateAnalysis, Error> {
        if !Self::POINTS.contains(&self.points) {
            let allowed = format!("{} to {}", Self::POINTS.start(), Self::POINTS.end());
            return Err(Error::invalid(&["points"], self.points.to_string(), "too few or too many", allowed));
        }
        let wheel = self.wheel.read()?;
        if !self.blow.is_finite() {
            let allowed = "finite, in N s; negative from the other side";
            return Err(Error::invalid(&["blow"], self.blow.to_string(), "no blow", allowed));
        }
        Ok(SimulateAnalysis {
            wheel,
            duration: self.duration,
            perturb: self.perturb.clone(),
            blow: self.blow,
            points: self.points as usize,
            contact: self.contact,
        })
    }
}

impl SimulateAnalysis {
    /// Computes the motion.
    ///
    /// # Errors
    /// [`Error::Simulation`]: a duration that is none, an unknown state, no uniform motion, a motion that cannot be followed;
    /// [`Error::Stopped`] where the control stops it.
    pub fn run(&self, control: &Control<'_>) -> Result<HistoryResult, Error> {
        let wheel = self.wheel;
        let mut perturbations: Vec<(&str, f64)> =
            self.perturb.0.iter().map(|(name, change)| (name.as_str(), *change)).collect();
        if self.blow != 0.0 {
            let [lateral, yaw] = wheel.velocity_change(self.blow, self.contact.model())?;
            perturbations.push(("Omega", yaw));
            if wheel.free_states().contains(&"V2") || self.contact == Contact::Sliding {
                perturbations.push(("V2", lateral));
            }
        }
        match self.contact {
            Contact::Sliding => {
                let start = wheel.perturbed_sliding_motion(&perturbations)?;
                let history = wheel.sliding()?.simulate_from(&start, self.duration, self.points, control)?;
                Ok(HistoryResult::Sliding(SlidingHistory::new(wheel, history)))
            }
            Contact::Rolling if wheel.tyre() != Tyre::Rigid => {
                let history =
                    wheel.simulate_with_tyre(self.duration, &perturbations, self.points, control)?;
                Ok(HistoryResult::Tyre(TyreHistoryResult::new(wheel, self.duration, history)?))
            }
            Contact::Rolling => {
                let history = wheel.simulate(self.duration, &perturbations, self.points, control)?;
                Ok(HistoryResult::Rolling(RollingHistory::new(wheel, &history)?))
            }
        }
    }
}
