//! What the smallest disturbance that does not return is asked for by, and how it is found.

use super::result::{SafeKickResult, Search};
use crate::classification::{Classification, Contact, may_slide};
use crate::disturbance::{DisturbanceKind, DisturbanceRequest, Edge, natural_period, nearest};
use crate::error::Error;
use crate::margin::Found;
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin::basin::{ClassificationSettings, DisturbedMotion, Fate};
use kingpin::{Key, Wheel};
use serde::{Deserialize, Serialize};

/// What the search is of the whole time, roughly.
const PART_OF_SEARCH: f64 = 0.9;
/// Samples of a history in one natural period of the springs.
const SAMPLES_PER_PERIOD: f64 = 40.0;
/// Most samples of a history.
const MOST_SAMPLES: f64 = 40_000.0;
/// The two motions at the edge have parted where their caster angles differ by this, in rad, and are then shown for so much
/// longer.
const PARTED: f64 = 0.5;
const AFTER_PARTING: f64 = 1.25;
/// The end of the model is sought for up to so many times the duration, for which motions are followed at most.
const LONGEST: f64 = 10.0;

/// The smallest disturbance of a kind from which the wheel does not return to its uniform motion, in both directions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SafeKickRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// Which disturbance.
    #[serde(flatten)]
    pub disturbance: DisturbanceRequest,
    /// How motions are followed.
    #[serde(flatten)]
    pub classification: Classification,
}

/// A request that makes sense, with its wheel.
#[derive(Clone, Debug)]
pub struct SafeKickAnalysis {
    wheel: Wheel,
    /// How the wheel was asked for.
    asked: WheelRequest,
    disturbance: DisturbanceRequest,
    classification: Classification,
    contact: Contact,
    settings: ClassificationSettings,
    warnings: Vec<String>,
}

impl SafeKickRequest {
    /// Reads the wheel and checks every field.
    ///
    /// # Errors
    /// What is wrong with the wheel or a field; no uniform motion.
    pub fn validate(&self) -> Result<SafeKickAnalysis, Error> {
        let wheel = self.wheel.read()?;
        let settings = self.classification.settings(&wheel)?;
        self.disturbance.check(&wheel)?;
        let contact = self.classification.contact_by_load(&wheel);
        let mut warnings = self.classification.warnings(&wheel, contact)?;
        if self.disturbance.kind == DisturbanceKind::StepSteer && wheel.get(Key::CU) == 0.0 {
            warnings.push(
                "without c_u the longitudinal motion hardly decays on a slightly curved path, which leaves small steps \
                 undecided: set a small c_u"
                    .to_owned(),
            );
        }
        let (disturbance, classification) = (self.disturbance, self.classification);
        Ok(SafeKickAnalysis {
            wheel,
            asked: self.wheel.clone(),
            disturbance,
            classification,
            contact,
            settings,
            warnings,
        })
    }
}

impl SafeKickAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Finds the edges in both directions, and the motions on both sides of the nearer one. Where neither the contact nor the load is
    /// said, those of a wheel that may slide under its weight are found besides.
    ///
    /// # Errors
    /// [`Error::Simulation`], and [`Error::Stopped`] where the control stops it.
    pub fn run(&self, control: &Control<'_>) -> Result<SafeKickResult, Error> {
        // A wheel that may slide rolls by default only where no load is said.
        let rolls_by_default = self.classification.contact.is_none() && self.contact == Contact::Rolling;
        let neither_is_said = rolls_by_default && may_slide(&self.wheel);
        let (search, control) = (control.part(0.0..PART_OF_SEARCH), &control.quiet());
        let model = self.contact.model();
        let edges = self.disturbance.edges(&self.wheel, model, self.settings, &search)?;
        let sliding = match neither_is_said {
            true => {
                let (disturbance, classification) = (&self.disturbance, &self.classification);
                Some(Found::seek(&self.wheel, disturbance, classification, Contact::Sliding, control)?)
            }
            false => None,
        };
        // Where nothing returns, and where nothing was found beyond, there are no two sides.
        let sided = |edge: &Edge| !edge.is_unstable() && !edge.is_open();
        let motions = match nearest(edges).filter(sided) {
            Some(edge) => Some(self.motions(&edge, self.settings.duration, control)?),
            None => None,
        };
        Ok(SafeKickResult::new(
            self.wheel,
            self.disturbance.disturbance(),
            model,
            self.settings,
            self.disturbance.largest(&self.wheel),
            Search { edges, sliding, motions, asked: self.asked.clone() },
        ))
    }

    /// The motions on both sides of the edge, until they have parted, and until the model ends where it does beyond the edge.
    fn motions(
        &self,
        edge: &Edge,
        duration: f64,
        control: &Control<'_>,
    ) -> Result<[DisturbedMotion; 2], Error> {
        let period = natural_period(&self.wheel);
        let history = |magnitude: f64, duration: f64| {
            let samples = (SAMPLES_PER_PERIOD * duration / period).clamp(2.0, MOST_SAMPLES) as usize;
            let (kind, model) = (self.disturbance.disturbance(), self.contact.model());
            kind.history(&self.wheel, model, magnitude, duration, samples, control)
        };
        let pair = |shown| Ok::<_, Error>([history(edge.returns, shown)?, history(edge.fails, shown)?]);
        let sides = pair(duration)?;
        let (one, other) = (&sides[0], &sides[1]);
        let mut both = one.states.iter().zip(&other.states).zip(&other.times);
        let parting = both.find(|((returns, fails), _)| (returns[2] - fails[2]).abs() > PARTED);
        let mut shown = parting.map_or(duration, |(_, &time)| AFTER_PARTING * time.max(period)).min(duration);
        if edge.fate.is_some_and(|fate| fate.0 == Fate::ModelEnds) {
            // Motions are followed for longer than the duration where they are slow to settle.
            let (mut end, mut reach) = (other.model_ends_at, duration);
            while end.is_none() && reach < LONGEST * duration {
                reach = (2.0 * reach).min(LONGEST * duration);
                end = history(edge.fails, reach)?.model_ends_at;
            }
            shown = shown.max(AFTER_PARTING * end.unwrap_or(reach));
        }
        if shown == duration { Ok(sides) } else { pair(shown) }
    }
}
