//! What the king pin bears and the dampers take along a motion, and how much of the friction it uses.

use kingpin::Wheel;
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
