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
//! assert!(motion.contact_force().lateral < 0.0);
//! # Ok::<(), kingpin::KingpinError>(())
//! ```

pub mod contact;
pub mod error;
pub mod parameters;
pub mod rolling;
pub mod simulation;
pub mod uniform_motion;
pub mod wheel;

pub use contact::ContactForce;
pub use error::{KingpinError, NoUniformMotion, Position};
pub use parameters::Key;
pub use rolling::RollingWheel;
pub use uniform_motion::UniformMotion;
pub use wheel::Wheel;
