//! A solution as the event engine sees it: values of the test functions, growth exponents and their rates along the curve.

use super::path::partners;
use super::spectrum::Spectrum;
use super::test_function::Reading;
use crate::continuation::corrector::across;
use crate::continuation::metric::{distance, norm};
use crate::continuation::{Curve, Settings, Solution};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A solution with what is known of it.
#[derive(Debug)]
pub(super) struct Node<C: Curve + ?Sized> {
    pub solution: Solution<C::Point>,
    /// Values in the order of the curve's test functions.
    pub readings: Vec<Option<Reading>>,
    pub spectrum: Spectrum,
    /// Number of signs that may be rounding error.
    pub undecided: usize,
    rates: Option<Option<Rates>>,
}

/// Rates at a solution that the next step begins with.
#[derive(Debug)]
pub(super) struct Known {
    unknown: Vec<f64>,
    /// Length that the tangent had in the metric.
    stretch: f64,
    rates: Rates,
}

/// How many of the signs at a solution may be rounding error.
pub(super) fn undecided<C: Curve>(curve: &C, solution: &Solution<C::Point>) -> usize {
    let tests = curve.test_functions();
    let readings = tests.iter().filter_map(|test| curve.test(test.kind, solution));
    curve.undecided(solution) + readings.filter(|reading| !reading.is_decided()).count()
}

/// Rates of change per length of the curve.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    pub exponents: Vec<Complex64>,
    pub readings: Vec<Option<f64>>,
}

/// Displacement along the tangent, as part of a step, from which rates are computed: the solution itself may be known on an
/// older mesh, whose error must not count against the difference.
const DISPLACEMENT: f64 = 0.05;

impl<C: Curve> Node<C> {
    pub(super) fn new(curve: &C, solution: Solution<C::Point>) -> Self {
        let readings = curve.test_functions().iter().map(|test| curve.test(test.kind, &solution)).collect();
        Self {
            readings,
            spectrum: curve.spectrum(&solution),
            undecided: curve.undecided(&solution),
            rates: None,
            solution,
        }
    }

    /// Rates along the curve, computed once; `step` is a length on which the solution is resolved.
    pub(super) fn rates(&mut self, curve: &mut C, step: f64, settings: &Settings) -> Option<&Rates> {
        if self.rates.is_none() {
            self.rates = Some(match curve.exponent_rates(&self.solution) {
                Some(mut exponents) => {
                    // The metric may have changed since the tangent had the length one.
                    let stretch = self.stretch(curve);
                    exponents.iter_mut().for_each(|rate| *rate /= stretch);
                    Some(Rates { exponents, readings: vec![None; self.readings.len()] })
                }
                None => self.differences(curve, step, settings),
            });
        }
        self.rates.as_ref().and_then(Option::as_ref)
    }

    /// Rate of a test function, where the curve knows it without further solutions.
    pub(super) fn known_rate(&self, curve: &C, index: usize) -> Option<f64> {
        let rate = curve.test_rate(curve.test_functions()[index].kind, &self.solution)?;
        Some(rate / self.stretch(curve))
    }

    /// Takes over rates that were computed at the same solution in the step before.
    pub(super) fn recall(&mut self, known: Option<Known>, curve: &C) {
        let Some(Known { unknown, stretch, mut rates }) = known else { return };
        if unknown == self.solution.unknown {
            let factor = stretch / self.stretch(curve);
            rates.exponents.iter_mut().for_each(|rate| *rate *= factor);
            rates.readings.iter_mut().flatten().for_each(|rate| *rate *= factor);
            self.rates = Some(Some(rates));
        }
    }

    /// The rates for the step that begins here, if they were computed.
    pub(super) fn into_known(self, curve: &C) -> Option<Known> {
        let stretch = self.stretch(curve);
        let rates = self.rates.flatten()?;
        Some(Known { unknown: self.solution.unknown, stretch, rates })
    }

    /// Length of the tangent in the metric as it is now.
    pub(super) fn stretch(&self, curve: &C) -> f64 {
        let tangent = &self.solution.tangent;
        norm(curve, tangent, &mut vec![0.0; tangent.len()])
    }

    fn differences(&self, curve: &mut C, step: f64, settings: &Settings) -> Option<Rates> {
        let there = across(curve, &self.solution, self.solution.ahead(DISPLACEMENT * step), settings).ok()?;
        let length = distance(curve, &self.solution.unknown, &there.unknown);
        let there = Node::new(curve, there);
        let partners = partners(&self.spectrum, &there.spectrum, None);
        let exponents = self.spectrum.exponents.iter().zip(partners).map(|(here, partner)| {
            let mut change = there.spectrum.exponents[partner] - here;
            if self.spectrum.is_periodic {
                change.im -= (change.im / TAU).round() * TAU;
            }
            change / length
        });
        let readings = self.readings.iter().zip(&there.readings).map(|(here, there)| match (here, there) {
            (Some(here), Some(there)) if here.class == there.class => {
                Some((there.value - here.value) / length)
            }
            _ => None,
        });
        Some(Rates { exponents: exponents.collect(), readings: readings.collect() })
    }
}
