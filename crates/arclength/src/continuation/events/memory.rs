//! How much test functions and exponents change from step to step.

use super::spectrum::Spectrum;
use crate::continuation::{Curve, Solution};

/// Values and exponents at the solution before the last: how much they change from step to step.
#[derive(Debug, Default)]
pub(super) struct Memory {
    readings: Vec<Option<f64>>,
    spectrum: Option<Spectrum>,
}

impl Memory {
    pub(super) fn of<C: Curve>(curve: &C, solution: &Solution<C::Point>) -> Self {
        let tests = curve.test_functions();
        let readings = tests.iter().map(|test| Some(curve.test(test.kind, solution)?.value));
        Self { readings: readings.collect(), spectrum: Some(curve.spectrum(solution)) }
    }

    /// Change of the real part of an exponent; infinite where there is nothing to compare with.
    pub(super) fn change_of_exponent(&self, spectrum: &Spectrum, index: usize) -> f64 {
        let Some(previous) = &self.spectrum else { return f64::INFINITY };
        let here = spectrum.exponents[index];
        let nearest = previous.exponents.iter().min_by(|one, other| {
            previous.separation(here, **one).total_cmp(&previous.separation(here, **other))
        });
        nearest.map_or(f64::INFINITY, |value| (value.re - here.re).abs())
    }

    /// Change of a test function.
    pub(super) fn change_of_reading(&self, index: usize, value: f64) -> f64 {
        self.readings.get(index).map_or(f64::INFINITY, |previous| {
            previous.map_or(f64::INFINITY, |previous| (value - previous).abs())
        })
    }
}
