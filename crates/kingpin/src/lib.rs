//! The towed wheel: a rigid caster with a rigid wheel, pulled round a circle by an elastic king pin.
//!
//! A [`Wheel`] holds named, validated SI parameters; [`Wheel::rolling`] makes it a vector field for the
//! continuation engine `arclength`; [`Wheel::uniform_motion`] finds the uniform motion, whose linear stability
//! and contact force follow from it.
//!
//! ```
//! use kingpin::Wheel;
//!
//! let mut wheel = Wheel::default();
//! wheel.set("v", "5")?;
//! let motion = wheel.uniform_motion()?;
//! assert_eq!(motion.u(), 0.0);
//! assert!(motion.is_stable() == Some(true) && !motion.rolls());
//! # Ok::<(), kingpin::KingpinError>(())
//! ```

#![warn(unreachable_pub)]

mod active;
mod arithmetic;
pub mod basin;
mod blow_out_of_rest;
mod body;
pub mod boundary;
mod bounded;
pub mod branches;
mod certain_jacobian;
mod certain_stability;
pub mod characteristic;
pub mod chart;
pub mod contact;
mod critical_speed;
mod damper;
mod dry_friction;
pub mod ensemble;
pub mod error;
mod forces;
mod hurwitz;
pub mod identification;
mod keys;
pub mod lateral;
pub mod linear_stability;
mod motion_integrator;
mod origin;
pub mod parallel;
pub mod parameters;
pub mod plane;
mod plausibility;
pub mod rolling;
pub mod rolling_model;
pub mod shimmy;
pub mod simulation;
pub mod sliding;
mod stability_over_speed;
mod swinging;
mod tracing;
pub mod tyre;
pub mod uniform_motion;
pub mod wheel;

pub use blow_out_of_rest::BlowOutOfRest;
pub use boundary::Curve;
pub use chart::{GrowthRateChart, GrowthRates, StabilityChart};
pub use contact::ContactForce;
pub use critical_speed::CriticalSpeed;
pub use damper::{Condition, SmallestDamper, is_slowest_speed};
pub use error::{KingpinError, NoUniformMotion, Position};
pub use forces::{CycleForces, KingPinLoad, RollingLoad, in_towing_frame};
pub use lateral::LateralWheel;
pub use parameters::{Key, Tyre};
pub use plane::{Axis, Plane};
pub use plausibility::{Implausible, Limit};
pub use rolling::RollingWheel;
pub use rolling_model::RollingModel;
pub use stability_over_speed::{SpeedPart, StabilityOverSpeed};
pub use tyre::TyreWheel;
pub use uniform_motion::UniformMotion;
pub use wheel::Wheel;

/// The code of the README, which is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The code of the README of the repository.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct ReadmeOfTheRepository;
