//! The statements of the paper's text, each beside what was computed.
//!
//! A statement is paraphrased by hand; its verdict and the evidence are computed in the run. The statements are those
//! about the equations, the uniform motion and its stability, the contact force, the limit cycles, and large disturbances.

mod claim;
mod contact;
mod cycles;
mod equations;
mod friction_of_cycles;
mod large_motions;
mod linear;
mod mechanics;
mod random;

pub use claim::{Claim, Verdict};

use super::branches::Branches;
use super::rolling_limit::RollingLimits;
use super::stability_chart::StabilityChart;
use super::tasks::Tasks;
use super::uniform_motion::UniformMotions;
use crate::error::Error;
use kingpin::parallel;

/// What the figures have computed already.
pub(super) struct Computed<'a> {
    pub motions: &'a UniformMotions,
    pub chart: &'a StabilityChart,
    pub limits: &'a RollingLimits,
    pub branches: &'a Branches,
}

/// All statements in the order of the paper.
pub(super) fn all(computed: &Computed, tasks: &Tasks<'_>) -> Result<Vec<Claim>, Error> {
    type Group<'a> = Box<dyn Fn() -> Result<Vec<Claim>, Error> + Sync + 'a>;
    let groups: [Group; GROUPS] = [
        Box::new(large_motions::sudden_changes),
        Box::new(mechanics::claims),
        Box::new(equations::claims),
        Box::new(|| linear::of_the_uniform_motion(computed.motions)),
        Box::new(|| linear::of_its_stability(computed.chart)),
        Box::new(|| contact::claims(computed.limits)),
        Box::new(cycles::of_the_hopf_points),
        Box::new(|| cycles::of_the_basin(computed.branches)),
        Box::new(large_motions::beyond_the_cycles),
        Box::new(|| cycles::of_the_radius(computed.branches)),
        Box::new(|| large_motions::directions(computed.branches)),
        Box::new(|| friction_of_cycles::claims(computed.branches)),
    ];
    let found: Vec<Vec<Claim>> = parallel::try_map(&groups, |group| {
        let claims = group()?;
        tasks.step()?;
        Ok::<_, Error>(claims)
    })?;
    Ok(found.into_iter().flatten().collect())
}

/// Groups of statements that are computed side by side.
pub(super) const GROUPS: usize = 12;
