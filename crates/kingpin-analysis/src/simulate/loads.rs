//! What king pin and ground bear and the dampers take along a motion, and how much of the friction it uses.

use kingpin::{RollingLoad, Wheel};
use kingpin_report::Columns;

/// The largest of some friction forces over `mu_s N`; nothing where nothing presses the wheel down.
pub(super) fn largest_ratio(wheel: &Wheel, friction_force: &[f64]) -> Option<f64> {
    let limit = wheel.static_limit();
    let largest = friction_force.iter().copied().fold(0.0, f64::max);
    (limit > 0.0).then_some(largest / limit)
}

/// Columns of the force on the king pin and the power of the dampers.
pub(super) fn loads(columns: Columns, force: &[f64], damper_power: &[f64]) -> Columns {
    columns
        .numbers("king_pin_force", force.iter().copied())
        .unit("N")
        .numbers("damper_power", damper_power.iter().copied())
        .unit("W")
}

/// Forces in N, one for each time, forwards and towards the centre of the circle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForcesFromAbove {
    /// Of springs and dampers on the king pin.
    pub king_pin: Vec<[f64; 2]>,
    /// Of the ground on the wheel.
    pub ground: Vec<[f64; 2]>,
}

impl ForcesFromAbove {
    /// Those of a motion that rolls.
    pub(crate) fn of_rolling(loads: &[RollingLoad]) -> Self {
        Self {
            king_pin: loads.iter().map(|load| load.king_pin.components).collect(),
            ground: loads.iter().map(|load| load.ground).collect(),
        }
    }
}
