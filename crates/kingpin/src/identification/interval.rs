//! 95 per cent confidence intervals of the parameters.
//!
//! The sum of squares beyond its smallest value, in units of the variance of the noise, is `tau^2` where one parameter is held at
//! another value and all other unknowns are fitted again (Bates and Watts, *Nonlinear Regression Analysis and Its Applications*,
//! 1988, chapter 6); the interval has `tau` up to the quantile of Student's t. Where the model is nearly linear, its ends are the
//! estimate and so many standard errors on both sides. Where it is not, where a bound is near or holds another unknown, where there is no
//! standard error and where dry friction makes the sum of squares one with kinks, the ends are sought. An interval that reaches the bound of its parameter is one-sided; its other end stays that of the interval with
//! two, so that it holds the truth at least as often as it says.

use super::information::Information;
use super::least_squares::{Limits, Minimum, Residuals, minimise};
use super::problem::Problem;
use crate::parallel;
use crate::simulation::SimulationError;
use arclength::control::{Control, Interrupted};

/// Deviation of tau from that of a linear model up to which it is taken as linear.
const NEARLY_LINEAR: f64 = 0.05;
/// Standard errors between an estimate and a bound from which on the bound is not felt, in half widths.
const FAR_FROM_BOUND: f64 = 1.5;
/// Relative standard error below which any model is linear.
const WELL_KNOWN: f64 = 1e-6;
/// Doublings of the distance in which an end is sought.
const MOST_DOUBLINGS: usize = 30;
/// Steps by which an end is narrowed down, and how exactly.
const MOST_STEPS: usize = 25;
const TAU_TOLERANCE: f64 = 5e-3;
/// Difference of sums of squares, in units of the variance of the noise, by which one is smaller than the other.
const CLEARLY_BETTER: f64 = 1e-3;
/// Steps of every fit.
const STEPS_OF_A_FIT: usize = 60;
/// Relative reduction of the sum of squares that is not worth a step of them.
const TOLERANCE_OF_A_FIT: f64 = 1e-7;

/// How an interval was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntervalMethod {
    /// By the standard error.
    Linear,
    /// By fits with the parameter held.
    Profile,
}

impl IntervalMethod {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Profile => "profile",
        }
    }
}

/// A 95 per cent confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its lower end; nothing where none was found.
    pub lower: Option<f64>,
    /// Its upper end; nothing where none was found.
    pub upper: Option<f64>,
    /// Whether the lower end is the smallest value that the parameter may have.
    pub reaches_lower_bound: bool,
    /// How it was found.
    pub method: IntervalMethod,
}

/// The intervals of all parameters, and the smallest sum of squares that was found on the way, where that is smaller than the one to
/// start from.
///
/// # Errors
/// An interruption.
pub(super) fn intervals(
    problem: &Problem<'_>,
    minimum: &Minimum,
    bounds: &[[f64; 2]],
    half_width: f64,
    control: &Control<'_>,
) -> Result<(Vec<Interval>, Option<Minimum>), Interrupted> {
    let count = problem.keys.len();
    let information = Information::of(minimum, &minimum.free(bounds));
    let counter = control.count(count);
    let of = |index: usize| -> Result<(Interval, Option<Minimum>), Interrupted> {
        let error = information.covariance(index, index).map(f64::sqrt);
        let linear = error.map(|error| {
            let change = |other| information.covariance(index, other).unwrap_or(0.0) / error;
            (error, (0..minimum.unknowns.len()).map(change).collect())
        });
        let scale = problem.scale(problem.unknowns[index], minimum.unknowns[index]);
        let mut profile =
            Profile { problem, minimum, bounds, index, linear, scale, half_width, better: None };
        let interval = profile.interval(control)?;
        counter.advance(1);
        Ok((interval, profile.better))
    };
    let found: Vec<(Interval, Option<Minimum>)> = parallel::try_map_indices(count, of)?;
    let (intervals, better): (Vec<Interval>, Vec<Option<Minimum>>) = found.into_iter().unzip();
    let sum = |minimum: &Minimum| minimum.sum_of_squares();
    Ok((intervals, better.into_iter().flatten().min_by(|one, other| sum(one).total_cmp(&sum(other)))))
}

/// The interval of an unknown of a problem.
#[derive(Clone, Debug)]
struct Profile<'a> {
    problem: &'a Problem<'a>,
    minimum: &'a Minimum,
    bounds: &'a [[f64; 2]],
    /// Index of the unknown.
    index: usize,
    /// Its standard error with the changes of all unknowns that go with it; nothing where it is at a bound or not determined.
    linear: Option<(f64, Vec<f64>)>,
    /// Size of a first step where there is no standard error.
    scale: f64,
    /// Half width in standard errors.
    half_width: f64,
    /// A smaller sum of squares that was found on the way.
    better: Option<Minimum>,
}

impl Profile<'_> {
    /// The interval.
    ///
    /// # Errors
    /// An interruption.
    fn interval(&mut self, control: &Control<'_>) -> Result<Interval, Interrupted> {
        let value = self.minimum.unknowns[self.index];
        let [low, high] = self.bounds[self.index];
        if let Some((error, changes)) = &self.linear {
            let half = self.half_width * error;
            let far = value - FAR_FROM_BOUND * half > low && value + FAR_FROM_BOUND * half < high;
            // An unknown that its bound holds may leave it where this one has another value, which its standard error says nothing of.
            let is_held = self.minimum.free(self.bounds).len() < self.minimum.unknowns.len();
            let is_linear = || {
                Ok::<_, Interrupted>(!self.problem.has_dry_friction() && self.is_linear(changes, control)?)
            };
            if far && !is_held && (*error < WELL_KNOWN * value.abs() || is_linear()?) {
                let (lower, upper) = (Some(value - half), Some(value + half));
                return Ok(Interval {
                    lower,
                    upper,
                    reaches_lower_bound: false,
                    method: IntervalMethod::Linear,
                });
            }
        }
        let lower = self.end(-1.0, control)?;
        let upper = self.end(1.0, control)?;
        let reaches_lower_bound = lower == Some(low);
        Ok(Interval { lower, upper, reaches_lower_bound, method: IntervalMethod::Profile })
    }

    /// Whether tau is that of a linear model at both ends.
    fn is_linear(&self, changes: &[f64], control: &Control<'_>) -> Result<bool, Interrupted> {
        for side in [-1.0, 1.0] {
            let mut values = self.minimum.unknowns.clone();
            for ((value, change), [low, high]) in values.iter_mut().zip(changes).zip(self.bounds) {
                *value = (*value + side * self.half_width * change).clamp(*low, *high);
            }
            let residuals = self.problem.residuals(&values, control);
            control.check()?;
            let tau = residuals.map_or(f64::INFINITY, |residuals| self.tau_of(&residuals));
            // tau falls when the other unknowns are fitted again, by an amount of the same order.
            if (tau / self.half_width - 1.0).abs() > NEARLY_LINEAR {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn tau_of(&self, residuals: &[f64]) -> f64 {
        let sum = residuals.iter().map(|residual| residual * residual).sum::<f64>();
        (sum - self.minimum.sum_of_squares()).max(0.0).sqrt()
    }

    /// tau with the unknown held at a value, and the other unknowns that were fitted.
    fn tau(
        &mut self,
        value: f64,
        start: &[f64],
        control: &Control<'_>,
    ) -> Result<(f64, Vec<f64>), Interrupted> {
        let mut bounds = self.bounds.to_vec();
        bounds[self.index] = [value, value];
        let limits = Limits { bounds: &bounds, steps: STEPS_OF_A_FIT, tolerance: TOLERANCE_OF_A_FIT };
        let found: Result<Minimum, SimulationError> =
            minimise(self.problem, start, &limits, &control.quiet());
        control.check()?;
        Ok(match found {
            Ok(minimum) => {
                let smallest = self.better.as_ref().unwrap_or(self.minimum).sum_of_squares();
                let tau = self.tau_of(&minimum.residuals);
                let unknowns = minimum.unknowns.clone();
                if minimum.sum_of_squares() < smallest - CLEARLY_BETTER {
                    self.better = Some(minimum);
                }
                (tau, unknowns)
            }
            // No motion with this value fits at all.
            Err(_) => (f64::INFINITY, start.to_vec()),
        })
    }

    /// The end on one side: where tau is the half width, or the bound.
    fn end(&mut self, side: f64, control: &Control<'_>) -> Result<Option<f64>, Interrupted> {
        let value = self.minimum.unknowns[self.index];
        let bound = self.bounds[self.index][if side < 0.0 { 0 } else { 1 }];
        let mut step = self.linear.as_ref().map_or(0.1 * self.scale, |(error, _)| self.half_width * error);
        let (mut inside, mut inside_tau, mut start) = (value, 0.0, self.minimum.unknowns.clone());
        if let Some((_, changes)) = &self.linear {
            // Where the other unknowns would be if the model were linear.
            for (start, change) in start.iter_mut().zip(changes) {
                *start += side * self.half_width * change;
            }
        }
        let mut outside = None;
        for _ in 0..MOST_DOUBLINGS {
            let trial = (value + side * step).clamp(self.bounds[self.index][0], self.bounds[self.index][1]);
            if trial == inside {
                return Ok(Some(bound));
            }
            let (tau, fitted) = self.tau(trial, &start, control)?;
            if tau > self.half_width {
                outside = Some((trial, tau));
                break;
            }
            (inside, inside_tau, start) = (trial, tau, fitted);
            step *= 2.0;
        }
        let Some((mut outside, mut outside_tau)) = outside else { return Ok(None) };
        for _ in 0..MOST_STEPS {
            // Nearly a straight line where the model is nearly linear; never too close to an end.
            let part = (self.half_width - inside_tau) / (outside_tau - inside_tau);
            let part = if part.is_finite() { part.clamp(0.1, 0.9) } else { 0.5 };
            let trial = inside + part * (outside - inside);
            let (tau, fitted) = self.tau(trial, &start, control)?;
            if (tau - self.half_width).abs() < TAU_TOLERANCE * self.half_width {
                return Ok(Some(trial));
            }
            if tau > self.half_width {
                (outside, outside_tau) = (trial, tau);
            } else {
                (inside, inside_tau, start) = (trial, tau, fitted);
            }
        }
        Ok(Some(0.5 * (inside + outside)))
    }
}
