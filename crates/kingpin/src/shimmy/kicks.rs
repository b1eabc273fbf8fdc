//! Strong disturbances from which shimmy is sought, and how long it is waited for, by the scales of the wheel.

use super::{MOTION_TOLERANCE, SlidingMotionSearch};
use crate::parameters::{Key, Tyre};
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use std::f64::consts::TAU;

/// Angles in rad at which the caster is released.
const RELEASE_ANGLES: [f64; 3] = [1.2, 0.6, 0.2];
const SMALL_RELEASE_ANGLE: f64 = 0.05;
/// Caster angle in rad to which a blow turns the wheel against the lateral spring alone.
const BLOW_ANGLE: f64 = 1.5;
/// Time for which a motion is left to settle, and its longest period, in periods of the slowest oscillation.
const SETTLING_PERIODS: f64 = 150.0;
const LONGEST_PERIODS: f64 = 12.0;

/// A disturbance of the uniform motion: one of its states is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// The state, one of [`STATE_NAMES`](crate::rolling::STATE_NAMES).
    pub state: &'static str,
    /// By how much, in its SI unit.
    pub change: f64,
}

impl Wheel {
    /// That shimmy can be sought: of a wheel that may slide, or has a tyre.
    ///
    /// # Errors
    /// What [`sliding`](Self::sliding) refuses, of a rigid wheel; dry friction about the king pin of one with a tyre.
    pub fn check_shimmy(&self) -> Result<(), SimulationError> {
        if self.tyre() == Tyre::Rigid {
            return self.sliding().map(drop);
        }
        self.check_without_dry_friction(
            "shimmy with a tyre",
            "set M_f = 0, or see what `simulate` settles on",
        )?;
        Ok(self.rolling_model(&[]).map(drop)?)
    }

    /// Strong disturbances, the strongest first: the caster is released at an angle, or turned by a blow that takes the wheel as far. Of a
    /// wheel with a tyre, which may shimmy in several ways, a small one too.
    pub fn strong_kicks(&self) -> Vec<Kick> {
        let releases = RELEASE_ANGLES.map(|change| Kick { state: "psi", change });
        let blow = Kick { state: "Omega", change: BLOW_ANGLE * self.lateral_frequency() };
        let [strongest, others @ ..] = releases;
        let small = Kick { state: "psi", change: SMALL_RELEASE_ANGLE };
        let small = Some(small).filter(|_| self.tyre() != Tyre::Rigid);
        [strongest, blow].into_iter().chain(others).chain(small).collect()
    }

    /// The search for a periodic motion that waits as long as the oscillations of this wheel take to settle.
    pub fn settling_search(&self) -> SlidingMotionSearch {
        let longitudinal = (self.get(Key::KU) / self.body().rolling_mass).sqrt();
        let slowest = TAU / longitudinal.min(self.lateral_frequency());
        SlidingMotionSearch {
            settling_time: SETTLING_PERIODS * slowest,
            longest_period: LONGEST_PERIODS * slowest,
            tolerance: MOTION_TOLERANCE,
        }
    }

    /// Angular frequency in rad/s of the caster that turns about the wheel centre against the lateral spring, and about the ground against
    /// the tyre behind it.
    fn lateral_frequency(&self) -> f64 {
        let body = self.body();
        let stiffness = match self.tyre() {
            Tyre::Rigid => body.lateral_stiffness,
            _ => {
                let of_tyre = self.get(Key::CAlpha) / self.get(Key::Sigma);
                (body.lateral_stiffness.recip() + of_tyre.recip()).recip()
            }
        };
        body.caster_length * (stiffness * body.inverse_yaw_inertia).sqrt()
    }
}
