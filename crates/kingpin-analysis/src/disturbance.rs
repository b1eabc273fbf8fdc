//! Which disturbance, and the edges of what the wheel returns from.

use crate::classification::NamedFate;
use crate::error::Error;
use arclength_analysis::Control;
use kingpin::basin::{ClassificationSettings, ContactModel, Disturbance, Fate, SafeKick};
use kingpin::simulation::SimulationError;
use kingpin::{Key, Wheel};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The largest curvature that is tried lays the caster of a stiff wheel at about so many rad.
const CASTER_ANGLE: f64 = 0.4;

/// Kinds of disturbances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DisturbanceKind {
    /// A sideways blow in N s on the rim of the wheel, R ahead of its centre.
    #[default]
    Impulse,
    /// The caster is released at an angle in rad from the uniform motion.
    ReleaseAngle,
    /// The towing speed rises at once by so many m/s to v.
    Jolt,
    /// From straight towing the path turns at once to a curvature in 1/m.
    StepSteer,
}

/// Which disturbance, and how large at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DisturbanceRequest {
    /// The kind.
    pub kind: DisturbanceKind,
    /// Largest magnitude that is tried. Where it is not given, a blow that would change the speed of wheel and caster together by v,
    /// an angle of 1.5 rad, a jolt of 0.9 v, or a curvature of 0.4/l.
    pub largest: Option<f64>,
}

/// An edge: the largest disturbance that returned and the smallest that did not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Edge {
    /// Largest magnitude that returned before the first that did not.
    pub returns: f64,
    /// Smallest magnitude that did not.
    pub fails: f64,
    /// Where that one ends; nothing where no uniform motion is left to return to.
    pub fate: Option<NamedFate>,
    /// Whether it is not known of smaller ones whether they return: with dry friction about the king pin on a circle on which small motions
    /// grow without it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub smaller_are_undecided: bool,
}

impl Edge {
    /// Whether this is no edge, but where the patience ends: the motions beyond did nothing that can be told, or it is not known of the
    /// smaller ones whether they return. Beyond an edge motions may swing irregularly to the end, or come to the end of the model.
    pub fn is_undecided(&self) -> bool {
        !self.is_unstable() && (!self.is_found() || self.smaller_are_undecided)
    }

    /// Whether no disturbance was found to return, however small, though the uniform motion is stable.
    pub fn none_returns(&self) -> bool {
        self.returns == 0.0 && !self.is_unstable() && !self.smaller_are_undecided
    }

    /// Whether a motion was found beyond that ends elsewhere than in the uniform motion.
    pub fn is_found(&self) -> bool {
        self.fate.is_none_or(|fate| fate.0 != Fate::Undecided)
    }

    /// Whether none that was tried was found to end elsewhere, though none is known to return either: then there is no edge, and `fails` is the
    /// largest that was tried.
    pub fn is_open(&self) -> bool {
        self.smaller_are_undecided && !self.is_found()
    }

    /// Whether nothing returns, since the uniform motion is unstable.
    pub fn is_unstable(&self) -> bool {
        self.fails == 0.0
    }

    /// Where the motion beyond the edge ends, in words.
    pub fn ending(&self) -> &'static str {
        self.fate.map_or("no rolling uniform motion", |fate| fate.0.name())
    }
}

/// Period in s of wheel and caster on the lateral spring: that of the king pin or, where it is rigid, of the tyre.
pub(crate) fn natural_period(wheel: &Wheel) -> f64 {
    let king_pin = wheel.get(Key::KQ);
    let of_tyre = || wheel.get(Key::CAlpha) / wheel.get(Key::Sigma);
    let stiffness = if king_pin.is_finite() { king_pin } else { of_tyre() };
    TAU * (wheel.mass() / stiffness).sqrt()
}

/// How far magnitudes were tried in the directions of these edges: to the edge, or to the largest magnitude where there is none or where
/// nothing returns.
pub(crate) fn reached(edges: impl IntoIterator<Item = Option<Edge>>, largest: f64) -> f64 {
    let tried = |edge: Option<Edge>| match edge {
        Some(edge) if edge.smaller_are_undecided => edge.fails,
        Some(edge) if !edge.is_unstable() => edge.returns,
        _ => largest,
    };
    edges.into_iter().map(|edge| tried(edge).abs()).fold(0.0, f64::max)
}

/// The edge that is nearest to the uniform motion.
pub(crate) fn nearest(edges: impl IntoIterator<Item = Option<Edge>>) -> Option<Edge> {
    edges.into_iter().flatten().min_by(|a, b| a.fails.abs().total_cmp(&b.fails.abs()))
}

impl DisturbanceRequest {
    /// The disturbance.
    pub fn disturbance(&self) -> Disturbance {
        match self.kind {
            DisturbanceKind::Impulse => Disturbance::Impulse,
            DisturbanceKind::ReleaseAngle => Disturbance::ReleaseAngle,
            DisturbanceKind::Jolt => Disturbance::Jolt,
            DisturbanceKind::StepSteer => Disturbance::StepSteer,
        }
    }

    /// The largest magnitude.
    pub fn largest(&self, wheel: &Wheel) -> f64 {
        self.largest.unwrap_or(match self.kind {
            DisturbanceKind::Impulse => {
                let mass = wheel.mass();
                let natural_speed = wheel.get(Key::L) * (wheel.get(Key::KQ) / mass).sqrt();
                mass * if wheel.get(Key::V) > 0.0 { wheel.get(Key::V) } else { natural_speed }
            }
            DisturbanceKind::ReleaseAngle => 1.5,
            DisturbanceKind::Jolt => 0.9 * wheel.get(Key::V),
            DisturbanceKind::StepSteer => CASTER_ANGLE / wheel.get(Key::L),
        })
    }

    /// That the largest magnitude makes sense.
    ///
    /// # Errors
    /// [`Error::Invalid`].
    pub fn check(&self, wheel: &Wheel) -> Result<(), Error> {
        let largest = self.largest(wheel);
        let stands = self.kind == DisturbanceKind::Jolt && largest >= wheel.get(Key::V);
        if largest > 0.0 && largest.is_finite() && !stands {
            return Ok(());
        }
        let unit = self.disturbance().unit();
        Err(Error::invalid(
            &["largest"],
            largest.to_string(),
            if stands { "the wheel would stand before the jolt" } else { "no magnitude" }.to_owned(),
            match self.kind {
                DisturbanceKind::Jolt => format!("above 0 and below v = {} {unit}", wheel.get(Key::V)),
                _ => format!("positive and finite, in {unit}"),
            },
        ))
    }

    /// The edges in the positive and in the negative direction, where there are any. A step of the curvature has one direction.
    ///
    /// # Errors
    /// A motion that cannot be followed, [`SimulationError::Interrupted`].
    pub fn edges(
        &self,
        wheel: &Wheel,
        model: ContactModel,
        settings: ClassificationSettings,
        control: &Control<'_>,
    ) -> Result<[Option<Edge>; 2], SimulationError> {
        let largest = self.largest(wheel);
        let edge = |largest: f64, control: &Control<'_>| -> Result<Option<Edge>, SimulationError> {
            let kick = SafeKick::find(wheel, model, settings, self.disturbance(), largest, control)?;
            Ok(kick.map(|kick| Edge {
                returns: kick.returns,
                fails: kick.fails,
                fate: kick.fate.map(NamedFate),
                smaller_are_undecided: kick.smaller_are_undecided,
            }))
        };
        if self.kind == DisturbanceKind::StepSteer {
            return Ok([edge(largest, control)?, None]);
        }
        let negative = edge(-largest, &control.part(0.0..0.5))?;
        Ok([edge(largest, &control.part(0.5..1.0))?, negative])
    }
}
