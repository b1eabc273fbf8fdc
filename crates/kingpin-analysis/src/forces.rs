//! Forces along a motion, in a result: the same fields on cycles, at Hopf points and on shimmy.

use kingpin::CycleForces;
use kingpin_report::numbers::significant;
use kingpin_report::{Cell, Columns};
use serde::{Deserialize, Serialize};

/// The largest forces along a periodic motion; at a Hopf point those of the uniform motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForcesResult {
    /// Largest friction force between wheel and ground in N; with `k_u = inf` unknown where the caster comes near pi/2.
    #[serde(default)]
    pub friction_max: Option<f64>,
    /// The same over mu_s N, below 1 where the wheel rolls all along; nothing where nothing presses the wheel down.
    #[serde(default)]
    pub friction_ratio_max: Option<f64>,
    /// Whether the ground can supply the friction all along.
    #[serde(default)]
    pub rolls: Option<bool>,
    /// Largest force on the king pin in N.
    #[serde(default)]
    pub king_pin_force_max: Option<f64>,
    /// What all dampers take, the mean over a period in W.
    #[serde(default)]
    pub damper_power: Option<f64>,
}

impl From<CycleForces> for ForcesResult {
    fn from(forces: CycleForces) -> Self {
        let known = |value: f64| Some(value).filter(|value| value.is_finite());
        Self {
            friction_max: known(forces.friction_max),
            friction_ratio_max: forces.friction_ratio_max().and_then(known),
            rolls: forces.rolls(),
            king_pin_force_max: known(forces.king_pin_force_max),
            damper_power: known(forces.damper_power),
        }
    }
}

impl ForcesResult {
    /// Heading of [`cell`](Self::cell).
    pub(crate) const HEADING: &'static str = "friction/mu_s N";

    /// The used part of the friction in a table.
    pub(crate) fn cell(&self) -> Cell {
        match self.friction_ratio_max {
            Some(ratio) => Cell::Text(significant(ratio, 4)),
            None => Cell::Text(String::new()),
        }
    }
}

/// Columns of the forces at the points of a result.
pub(crate) fn columns<'a>(
    columns: Columns,
    points: impl Iterator<Item = &'a ForcesResult> + Clone,
) -> Columns {
    columns
        .optional_numbers("friction_max", points.clone().map(|forces| forces.friction_max))
        .unit("N")
        .optional_numbers("friction_ratio_max", points.clone().map(|forces| forces.friction_ratio_max))
        .booleans("rolls", points.clone().map(|forces| forces.rolls))
        .optional_numbers("king_pin_force_max", points.clone().map(|forces| forces.king_pin_force_max))
        .unit("N")
        .optional_numbers("damper_power", points.map(|forces| forces.damper_power))
        .unit("W")
}
