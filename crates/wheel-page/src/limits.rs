//! What the page does not ask for: files of the machine, and what would take longer than anybody waits.

use arclength_analysis::CycleSource;
use arclength_page::Failure;
use axum::http::StatusCode;
use kingpin_analysis::WheelRequest;
use kingpin_analysis::basin::BasinRequest;
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::cycles::CyclesRequest;
use kingpin_analysis::locus::LocusRequest;
use kingpin_analysis::report::ReportRequest;
use kingpin_analysis::shimmy::ShimmyRequest;
use kingpin_analysis::simulate::SimulateRequest;

/// Most points of a chart.
const MOST_CHART_POINTS: usize = 250_000;
/// Most motions of a basin.
const MOST_MOTIONS: usize = 20_000;
/// Longest time in s for which a motion is followed.
const LONGEST_MOTION: f64 = 600.0;
/// Most samples of a motion.
const MOST_SAMPLES: u64 = 20_000;
/// Most steps of a branch in one direction.
const MOST_STEPS: u32 = 100_000;

/// A request that has limits on the page.
pub(crate) trait Limited {
    /// That the page waits for it, and that it names no file of the machine.
    fn check(&self) -> Result<(), Failure>;
}

fn refused(message: String) -> Result<(), Failure> {
    Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message))
}

fn at_most<N: PartialOrd + std::fmt::Display>(field: &str, given: N, most: N) -> Result<(), Failure> {
    if given <= most {
        return Ok(());
    }
    refused(format!("{field} {given}: too much for the page; allowed: up to {most}"))
}

impl Limited for WheelRequest {
    fn check(&self) -> Result<(), Failure> {
        match self.wheel {
            None => Ok(()),
            Some(_) => {
                refused("wheel: no files are read; allowed: set, a list of keys and values".to_owned())
            }
        }
    }
}

impl Limited for ReportRequest {
    /// Where it would be written does not matter: it is not.
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()
    }
}

impl Limited for ChartRequest {
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()?;
        at_most("points of x and y together:", self.x.count.saturating_mul(self.y.count), MOST_CHART_POINTS)
    }
}

impl Limited for CyclesRequest {
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()?;
        if let Some(CycleSource::Samples { .. }) = self.from {
            return refused(
                "from: no files are read; allowed: a labelled point of a result that came with the request"
                    .to_owned(),
            );
        }
        at_most("steps", self.steps.steps, MOST_STEPS)
    }
}

impl Limited for LocusRequest {
    fn check(&self) -> Result<(), Failure> {
        at_most("steps", self.steps.steps, MOST_STEPS)
    }
}

impl Limited for ShimmyRequest {
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()?;
        at_most("steps", self.steps, MOST_STEPS)
    }
}

impl Limited for SimulateRequest {
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()?;
        at_most("duration in s:", self.duration, LONGEST_MOTION)?;
        at_most("points", self.points, MOST_SAMPLES)
    }
}

impl Limited for BasinRequest {
    fn check(&self) -> Result<(), Failure> {
        self.wheel.check()?;
        let motions = self.samples.map_or(self.x.count.saturating_mul(self.y.count), |count| count as usize);
        at_most("motions:", motions, MOST_MOTIONS)?;
        at_most("duration in s:", self.classification.duration.unwrap_or(0.0), LONGEST_MOTION)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_request_names_a_file() {
        assert!(WheelRequest::default().check().is_ok());
        let named = WheelRequest { wheel: Some("/etc/hostname".into()), set: Vec::new() };
        assert!(named.check().is_err());
        assert!(ReportRequest { wheel: named.clone(), ..ReportRequest::default() }.check().is_err());
        assert!(BasinRequest { wheel: named, ..BasinRequest::default() }.check().is_err());
    }

    #[test]
    fn what_takes_too_long_says_what_is_allowed() {
        let mut basin = BasinRequest::default();
        assert!(basin.check().is_ok());
        basin.x.count = 1000;
        let Err(failure) = basin.check() else { panic!() };
        assert!(failure.json().contains("20000"), "{}", failure.json());
        assert!(SimulateRequest::new(1e9).check().is_err());
    }
}
