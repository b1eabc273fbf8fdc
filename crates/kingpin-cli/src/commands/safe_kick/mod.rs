//! `kingpin safe-kick`: the smallest disturbance of the uniform motion that does not return.

pub mod edge;
mod report;

use crate::commands::basin::classification::Classification;
use crate::error::Error;
use crate::wheel_options::{WheelOptions, parameter_help};
use clap::Args;
use edge::{DisturbanceOptions, Edge};
use kingpin::basin::{Disturbance, DisturbedMotion};
use kingpin::{Key, Wheel};
use kingpin_terminal::OutputOptions;
use kingpin_terminal::Progress;
use report::SafeKickReport;

const EXAMPLE: &str = "kingpin safe-kick -s v=6 -o edge.svg
         kingpin safe-kick --kind step-steer --contact sliding -s v=2 -s r=inf -s c_u=0.1";
/// Samples of a history in one natural period of the springs.
const SAMPLES_PER_PERIOD: f64 = 40.0;
/// Most samples of a history.
const MOST_SAMPLES: f64 = 40_000.0;
/// The two motions at the edge have parted where their caster angles differ by this, in rad, and are then shown for so much
/// longer.
const PARTED: f64 = 0.5;
const AFTER_PARTING: f64 = 1.25;

/// Smallest disturbance of a kind from which the wheel does not return to its uniform motion
///
/// Both directions are tried. Magnitudes up to --largest are scanned at 64 equal distances for the first that does not
/// return, and the edge before it is narrowed down by bisection to a millionth of the largest one: with basins that have
/// fine structure there may be a smaller one between two that were tried. Files hold the motions on both sides of the
/// edge.
#[derive(Args, Debug)]
#[command(after_help = format!("Example: {EXAMPLE}"), after_long_help = parameter_help(EXAMPLE))]
pub struct SafeKick {
    #[command(flatten)]
    disturbance: DisturbanceOptions,
    #[command(flatten)]
    classification: Classification,
    #[command(flatten)]
    wheel: WheelOptions,
    #[command(flatten)]
    output: OutputOptions,
}

impl SafeKick {
    /// Runs the command.
    ///
    /// # Errors
    /// Why it failed.
    pub fn run(&self) -> Result<(), Error> {
        let output = self.output.prepare()?;
        let wheel = self.wheel.wheel()?;
        let settings = self.classification.settings(&wheel)?;
        let model = self.classification.model();
        self.disturbance.check(&wheel)?;
        self.classification.warn(&wheel, &output)?;
        if self.disturbance.kind() == Disturbance::StepSteer && wheel.get(Key::CU) == 0.0 {
            output.warn(
                "without c_u the longitudinal motion hardly decays on a slightly curved path, which leaves small steps \
                 undecided: set a small c_u",
            );
        }
        let progress = Progress::spinner("smallest disturbance that does not return", output.is_quiet());
        let edges = self.disturbance.edges(&wheel, model, settings)?;
        let smallest = edges.iter().copied().flatten().min_by(|a, b| a.fails.abs().total_cmp(&b.fails.abs()));
        let motions = match smallest {
            Some(edge) => Some(self.motions(&wheel, &edge, settings.duration)?),
            None => None,
        };
        drop(progress);
        let kind = self.disturbance.kind();
        let largest = self.disturbance.largest(&wheel);
        Ok(output.deliver(&SafeKickReport::new(wheel, kind, model, settings, largest, edges, motions))?)
    }

    /// The motions on both sides of the edge, until they have parted.
    fn motions(&self, wheel: &Wheel, edge: &Edge, duration: f64) -> Result<[DisturbedMotion; 2], Error> {
        let mass = wheel.get(Key::MW) + wheel.get(Key::MC);
        let period = std::f64::consts::TAU * (mass / wheel.get(Key::KQ)).sqrt();
        let history = |magnitude: f64, duration: f64| {
            let samples = (SAMPLES_PER_PERIOD * duration / period).clamp(2.0, MOST_SAMPLES) as usize;
            let model = self.classification.model();
            self.disturbance.kind().history(wheel, model, magnitude, duration, samples)
        };
        let motions = [history(edge.returns, duration)?, history(edge.fails, duration)?];
        let both = motions[0].states.iter().zip(&motions[1].states).zip(&motions[1].times);
        let parting = both.into_iter().find(|((returns, fails), _)| (returns[2] - fails[2]).abs() > PARTED);
        match parting {
            Some((_, &time)) if AFTER_PARTING * time < duration => {
                let shown = AFTER_PARTING * time.max(period);
                Ok([history(edge.returns, shown)?, history(edge.fails, shown)?])
            }
            _ => Ok(motions),
        }
    }
}
