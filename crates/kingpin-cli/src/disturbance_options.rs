//! Options that say which disturbance, and how large at most.

use clap::{Args, ValueEnum};
use kingpin_analysis::{DisturbanceKind, DisturbanceRequest};

/// Kinds of disturbances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum KindOption {
    /// A sideways blow in N s on the rim of the wheel, R ahead of its centre
    #[default]
    Impulse,
    /// The caster is released at an angle in rad from the uniform motion
    ReleaseAngle,
    /// The towing speed rises at once by so many m/s to v
    Jolt,
    /// From straight towing the path turns at once to a curvature in 1/m
    StepSteer,
}

impl From<KindOption> for DisturbanceKind {
    fn from(kind: KindOption) -> Self {
        match kind {
            KindOption::Impulse => Self::Impulse,
            KindOption::ReleaseAngle => Self::ReleaseAngle,
            KindOption::Jolt => Self::Jolt,
            KindOption::StepSteer => Self::StepSteer,
        }
    }
}

/// Which disturbance, and how large at most.
#[derive(Args, Clone, Debug)]
pub struct DisturbanceOptions {
    /// Kind of disturbance
    #[arg(long, value_enum, default_value_t)]
    kind: KindOption,

    /// Largest magnitude that is tried [default: a blow that would change the speed of wheel and caster by v, 1.5 rad, 0.9 v, 0.4/l]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    largest: Option<f64>,
}

impl From<&DisturbanceOptions> for DisturbanceRequest {
    fn from(options: &DisturbanceOptions) -> Self {
        Self { kind: options.kind.into(), largest: options.largest }
    }
}
