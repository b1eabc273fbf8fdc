//! The wheel against closed forms, second formulations and random wheels.
//!
//! One program for all of them: to build one for each would take longer than to run them.

mod charts;
mod contact;
mod control;
mod cycles;
mod dry_friction;
mod ends_of_motions;
mod forces;
mod identification;
mod judge;
mod lateral;
mod lateral_branches;
mod linear_stability;
mod paper_form;
mod plausibility;
mod random_wheels;
mod slow_wheels;
mod stability_over_speed;
mod stiff_motions;
mod tyre;
mod tyre_equations;
mod tyre_kicks;
mod tyres;
mod uniform_motion;
mod wheel;
