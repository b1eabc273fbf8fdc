//! 95 per cent confidence intervals of what follows from the parameters.
//!
//! They are those of the profile, as for a parameter: something that follows is held at a value, all unknowns are fitted again, and the
//! interval has the values for which the sum of squares is not more than `tau^2` beyond its smallest, `tau` being the quantile of
//! Student's t (Bates and Watts, *Nonlinear Regression Analysis and Its Applications*, 1988, chapter 6). So it is the range of what
//! follows over all parameters that the interval of a parameter takes as likely, those at bounds included, and goes with these intervals.
//!
//! What follows is held by one more residual, the distance from the value over a small part of its standard error. Parameters that may be
//! at their bounds are held there, too, in all combinations, and the ends sought among the others: where fits come to a bound, and where dry
//! friction makes the sum of squares one with kinks, they do not always get on. What follows may jump, and there may be none, which is a
//! value beyond all others: so parameters that are drawn from the joint distribution are tried besides, and an end that one of them
//! lies beyond is sought from there.

use super::Identification;
use super::error::IdentificationError;
use super::identified::Identified;
use super::information::Information;
use super::least_squares::{Limits, Minimum, Residuals, minimise};
use super::problem::{Problem, bounds, unknowns};
use crate::parallel;
use crate::simulation::SimulationError;
use crate::wheel::Wheel;
use arclength::control::{Control, Interrupted};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Part of its standard error by which what is held may be off for one unit of the sum of squares.
const HELD_WITHIN: f64 = 0.03;
/// Part of the size of a parameter over which differences are taken.
const DIFFERENCE: f64 = 1e-5;
/// Doublings of the distance in which an end is sought, and how often it is halved where no fit comes near.
const MOST_DOUBLINGS: usize = 16;
const MOST_HALVINGS: usize = 4;
/// Part of the way to a value that a fit has to come.
const NEAR: f64 = 0.5;
/// Steps by which an end is narrowed down, and how exactly, as a part of the half width.
const MOST_STEPS: usize = 10;
const TAU_TOLERANCE: f64 = 0.02;
/// Steps of every fit, and the relative reduction of the sum of squares that is not worth one.
const STEPS_OF_A_FIT: usize = 40;
const TOLERANCE_OF_A_FIT: f64 = 1e-6;
/// Wheels that are drawn, how many of them beyond an end are fitted, and by which part of the end they have to be beyond.
const DRAWS: usize = 250;
const DRAWS_THAT_ARE_FITTED: usize = 8;
const BEYOND: f64 = 0.02;
/// Most parameters that are held at their bounds in all combinations.
const MOST_AT_BOUNDS: usize = 3;
/// So many likely wheels without such a value are no accident of rounding.
const FEWEST_WITHOUT: usize = 3;

/// The 95 per cent confidence interval of something that follows from the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConsequenceInterval {
    /// Its lower end; infinite where there is no such value for any likely parameters.
    pub lower: f64,
    /// Its upper end; infinite where there may be no such value.
    pub upper: f64,
    /// Part of the wheels that were drawn from the joint distribution which have no such value.
    pub without: f64,
}

impl Identification {
    /// The 95 per cent confidence interval of something positive that follows from the parameters of a wheel: its range over all
    /// parameters that are as likely as those within the interval of a parameter. Where there is no such value `of` is infinite. Nothing
    /// where some parameters are not determined, and where hardly any parameters that are likely are allowed.
    ///
    /// # Errors
    /// An interruption, and motions that cannot be followed with the estimates.
    pub fn interval_of(
        &self,
        identified: &Identified,
        wheel: &Wheel,
        of: &(dyn Fn(&Wheel) -> f64 + Sync),
        control: &Control<'_>,
    ) -> Result<Option<ConsequenceInterval>, IdentificationError> {
        let Some(distribution) = &identified.distribution else { return Ok(None) };
        let drawn: Vec<Vec<f64>> = distribution
            .wheels(wheel, DRAWS)
            .iter()
            .map(|drawn| self.keys.iter().map(|&key| drawn.get(key)).collect())
            .collect();
        if drawn.len() < DRAWS {
            return Ok(None);
        }
        let unknowns = unknowns(&self.records, &self.keys, &self.starts, &self.offsets)?;
        let problem = self.problem(&unknowns, identified.fit.deviations.clone());
        let limits: Vec<[f64; 2]> = unknowns.iter().map(|&unknown| bounds(unknown)).collect();
        let values = &identified.fit.unknowns;
        let estimate = Minimum {
            residuals: problem.residuals(values, control)?,
            jacobian: problem.jacobian(values, control)?,
            unknowns: values.clone(),
            converged: true,
        };
        let half_width = identified.fit.half_width;
        let may_be_at_bound = |&index: &usize| {
            let estimate = &identified.estimates[index];
            estimate.interval.reaches_lower_bound || estimate.value == Some(limits[index][0])
        };
        let at_bounds: Vec<usize> =
            (0..self.keys.len()).filter(may_be_at_bound).take(MOST_AT_BOUNDS).collect();
        let profile = Profile {
            problem: &problem,
            estimate: &estimate,
            at_bounds: &at_bounds,
            bounds: &limits,
            wheel,
            of,
            half_width,
            none: AtomicUsize::new(0),
            without: AtomicUsize::new(0),
        };
        Ok(Some(profile.interval(&drawn, control)?))
    }
}

/// The profile of something that follows from the parameters.
struct Profile<'a> {
    problem: &'a Problem<'a>,
    estimate: &'a Minimum,
    /// Parameters that may be at their lower bound.
    at_bounds: &'a [usize],
    bounds: &'a [[f64; 2]],
    /// The wheel whose parameters are replaced.
    wheel: &'a Wheel,
    of: &'a (dyn Fn(&Wheel) -> f64 + Sync),
    half_width: f64,
    /// How many likely wheels were met in which what follows is zero, and for which there is none.
    none: AtomicUsize,
    without: AtomicUsize,
}

/// Unknowns with what follows from them, and how likely they are.
#[derive(Clone, Debug)]
struct Fitted {
    unknowns: Vec<f64>,
    value: f64,
    tau: f64,
}

impl Profile<'_> {
    fn interval(
        &self,
        drawn: &[Vec<f64>],
        control: &Control<'_>,
    ) -> Result<ConsequenceInterval, Interrupted> {
        let values: Vec<f64> = parallel::map(drawn, |drawn| self.value(drawn));
        control.check()?;
        // Every combination of parameters at their bounds is the binary digits of a number.
        let faces = 1_usize << self.at_bounds.len();
        let of = |index: usize| self.ends_on(&self.face(index), control);
        let found: Vec<Option<[f64; 2]>> = parallel::try_map_indices(faces, of)?;
        let nowhere = [f64::INFINITY, f64::NEG_INFINITY];
        let widest = |one: [f64; 2], other: [f64; 2]| [one[0].min(other[0]), one[1].max(other[1])];
        let sought = found.into_iter().flatten().fold(nowhere, widest);
        let of = |side: usize| self.beyond([-1.0, 1.0][side], sought[side], drawn, &values, control);
        let mut ends: Vec<f64> = parallel::try_map_indices(2, of)?;
        if self.none.load(Ordering::Relaxed) >= FEWEST_WITHOUT {
            ends[0] = 0.0;
        }
        if self.without.load(Ordering::Relaxed) >= FEWEST_WITHOUT {
            ends[1] = f64::INFINITY;
        }
        let without = values.iter().filter(|value| !value.is_finite()).count();
        Ok(ConsequenceInterval {
            lower: ends[0],
            upper: ends[1],
            without: without as f64 / values.len() as f64,
        })
    }

    /// What follows from parameters, which come first; infinite where there is no such value.
    fn value(&self, unknowns: &[f64]) -> f64 {
        let mut settings = self.problem.keys.iter().zip(unknowns);
        let wheel = settings.try_fold(*self.wheel, |wheel, (&key, &value)| wheel.with(key, value));
        wheel.map_or(f64::INFINITY, |wheel| (self.of)(&wheel))
    }

    /// Its derivatives by the parameters, by differences to the side that is allowed; zero where it jumps to none.
    fn slopes(&self, unknowns: &[f64], value: f64) -> Vec<f64> {
        let slope = |index: usize| {
            let scale = self.problem.scale(self.problem.unknowns[index], unknowns[index]);
            let mut moved = unknowns.to_vec();
            moved[index] += DIFFERENCE * scale;
            if moved[index] > self.bounds[index][1] {
                moved[index] = unknowns[index] - DIFFERENCE * scale;
            }
            let slope = (self.value(&moved) - value) / (moved[index] - unknowns[index]);
            if slope.is_finite() { slope } else { 0.0 }
        };
        (0..self.problem.keys.len()).map(slope).collect()
    }

    /// The bounds of all unknowns where some of the parameters are held at their own.
    fn face(&self, index: usize) -> Vec<[f64; 2]> {
        let mut bounds = self.bounds.to_vec();
        for (digit, &parameter) in self.at_bounds.iter().enumerate() {
            if (index >> digit) & 1 == 1 {
                bounds[parameter][1] = bounds[parameter][0];
            }
        }
        bounds
    }

    /// The ends that are reached within some bounds; nothing where no parameters within them are likely.
    fn ends_on(&self, bounds: &[[f64; 2]], control: &Control<'_>) -> Result<Option<[f64; 2]>, Interrupted> {
        let is_whole = bounds == self.bounds;
        let start = if is_whole {
            let unknowns = self.estimate.unknowns.clone();
            Fitted { value: self.value(&unknowns), unknowns, tau: 0.0 }
        } else {
            self.within(bounds, &self.estimate.unknowns, control)?
        };
        if start.tau > self.half_width {
            return Ok(None);
        }
        let [lower, upper] = [-1.0, 1.0].map(|side| self.sought(side, &start, bounds, control));
        Ok(Some([lower?, upper?]))
    }

    /// The standard error of what follows where it has these derivatives, within some bounds; nothing where it is not known.
    fn standard_error(&self, slopes: &[f64], bounds: &[[f64; 2]]) -> Option<f64> {
        let free: Vec<usize> =
            (0..bounds.len()).filter(|&index| bounds[index][0] < bounds[index][1]).collect();
        let information = Information::of(self.estimate, &free);
        let varying: Vec<usize> = free.into_iter().filter(|&index| index < slopes.len()).collect();
        let mut variance = 0.0;
        for &row in &varying {
            for &column in &varying {
                variance += slopes[row] * slopes[column] * information.covariance(row, column)?;
            }
        }
        Some(variance.sqrt()).filter(|error| error.is_finite() && *error > 0.0)
    }

    fn tau_of(&self, sum: f64) -> f64 {
        (sum - self.estimate.sum_of_squares()).max(0.0).sqrt()
    }

    /// The end on one side, or a farther one that is reached from parameters that were drawn.
    fn beyond(
        &self,
        side: f64,
        mut end: f64,
        drawn: &[Vec<f64>],
        values: &[f64],
        control: &Control<'_>,
    ) -> Result<f64, Interrupted> {
        // What is drawn may lie beyond a jump that no fit passes.
        let is_beyond = |value: f64| match (value.is_finite(), end.is_finite()) {
            (true, true) => side * (value - end) > BEYOND * end.abs(),
            (finite, _) => finite != end.is_finite() && (side < 0.0) == finite,
        };
        let beyond: Vec<usize> = (0..drawn.len()).filter(|&index| is_beyond(values[index])).collect();
        let mut farthest: Option<Fitted> = None;
        for index in beyond.into_iter().take(DRAWS_THAT_ARE_FITTED) {
            let fitted = self.with_parameters(&drawn[index], values[index], control)?;
            let is_farther = |other: &Fitted| side * (fitted.value - other.value) > 0.0;
            if fitted.tau <= self.half_width && farthest.as_ref().is_none_or(is_farther) {
                farthest = Some(fitted);
            }
        }
        if let Some(farthest) = farthest {
            let beyond = self.sought(side, &farthest, self.bounds, control)?;
            end = if side < 0.0 { end.min(beyond) } else { end.max(beyond) };
        }
        Ok(end)
    }

    /// Given parameters with all other unknowns fitted.
    fn with_parameters(
        &self,
        parameters: &[f64],
        value: f64,
        control: &Control<'_>,
    ) -> Result<Fitted, Interrupted> {
        let mut bounds = self.bounds.to_vec();
        for (bounds, &parameter) in bounds.iter_mut().zip(parameters) {
            *bounds = [parameter, parameter];
        }
        Ok(Fitted { value, ..self.within(&bounds, &self.estimate.unknowns, control)? })
    }

    /// What fits best within some bounds.
    fn within(
        &self,
        bounds: &[[f64; 2]],
        start: &[f64],
        control: &Control<'_>,
    ) -> Result<Fitted, Interrupted> {
        let limits = Limits { bounds, steps: STEPS_OF_A_FIT, tolerance: TOLERANCE_OF_A_FIT };
        let found: Result<Minimum, SimulationError> =
            minimise(self.problem, start, &limits, &control.quiet());
        control.check()?;
        Ok(match found {
            Ok(minimum) => Fitted {
                value: self.value(&minimum.unknowns),
                tau: self.tau_of(minimum.sum_of_squares()),
                unknowns: minimum.unknowns,
            },
            Err(_) => Fitted { value: f64::NAN, tau: f64::INFINITY, unknowns: start.to_vec() },
        })
    }

    /// The end on one side as it is reached by fits, from likely parameters on.
    fn sought(
        &self,
        side: f64,
        from: &Fitted,
        bounds: &[[f64; 2]],
        control: &Control<'_>,
    ) -> Result<f64, Interrupted> {
        let mut inside = from.clone();
        if !inside.value.is_finite() || (side < 0.0 && inside.value <= 0.0) {
            return Ok(inside.value);
        }
        let Some(error) = self.standard_error(&self.slopes(&inside.unknowns, inside.value), bounds) else {
            return Ok(inside.value);
        };
        let mut step = (self.half_width - inside.tau).max(TAU_TOLERANCE) * error;
        let mut halvings = 0;
        let mut outside: Option<Fitted> = None;
        for _ in 0..MOST_DOUBLINGS {
            let target = (inside.value + side * step).max(0.0);
            let fitted = self.held([target, error], &inside, bounds, control)?;
            if fitted.tau > self.half_width && side * (fitted.value - inside.value) > 0.0 {
                outside = Some(fitted);
                break;
            }
            let part = (fitted.value - inside.value) / (target - inside.value);
            if fitted.tau <= self.half_width && part > NEAR {
                inside = fitted;
                if inside.value <= HELD_WITHIN * error && side < 0.0 {
                    return Ok(0.0);
                }
                step *= 2.0;
                continue;
            }
            if fitted.tau <= self.half_width && part > 0.0 {
                inside = fitted;
            }
            if halvings == MOST_HALVINGS {
                break;
            }
            halvings += 1;
            step *= 0.5;
        }
        // Where no fit goes farther there is a jump, or the largest value.
        let Some(mut outside) = outside else { return Ok(inside.value) };
        for _ in 0..MOST_STEPS {
            let part = (self.half_width - inside.tau) / (outside.tau - inside.tau);
            let part = if part.is_finite() { part.clamp(0.1, 0.9) } else { 0.5 };
            let target = inside.value + part * (outside.value - inside.value);
            let fitted = self.held([target, error], &inside, bounds, control)?;
            if (fitted.tau - self.half_width).abs() < TAU_TOLERANCE * self.half_width {
                return Ok(fitted.value);
            }
            let is_between =
                side * (fitted.value - inside.value) > 0.0 && side * (outside.value - fitted.value) > 0.0;
            if fitted.tau > self.half_width || !is_between {
                outside = Fitted { value: if is_between { fitted.value } else { target }, ..fitted };
            } else {
                inside = fitted;
            }
        }
        Ok(inside.value)
    }

    /// All unknowns fitted with what follows held at a value.
    fn held(
        &self,
        [target, error]: [f64; 2],
        start: &Fitted,
        bounds: &[[f64; 2]],
        control: &Control<'_>,
    ) -> Result<Fitted, Interrupted> {
        let held = Held { profile: self, target, weight: (HELD_WITHIN * error).recip() };
        let limits = Limits { bounds, steps: STEPS_OF_A_FIT, tolerance: TOLERANCE_OF_A_FIT };
        let found: Result<Minimum, SimulationError> =
            minimise(&held, &start.unknowns, &limits, &control.quiet());
        control.check()?;
        Ok(match found {
            Ok(minimum) => {
                let own = &minimum.residuals[..minimum.residuals.len() - 1];
                let sum = own.iter().map(|residual| residual * residual).sum();
                Fitted {
                    value: self.value(&minimum.unknowns),
                    tau: self.tau_of(sum),
                    unknowns: minimum.unknowns,
                }
            }
            Err(_) => Fitted { tau: f64::INFINITY, ..start.clone() },
        })
    }
}

/// The residuals of the records, and how far what follows is from a value.
struct Held<'a> {
    profile: &'a Profile<'a>,
    target: f64,
    weight: f64,
}

impl Residuals for Held<'_> {
    type Error = SimulationError;

    fn residuals(&self, unknowns: &[f64], control: &Control<'_>) -> Result<Vec<f64>, SimulationError> {
        let profile = self.profile;
        let mut residuals = profile.problem.residuals(unknowns, control)?;
        let value = profile.value(unknowns);
        if value == 0.0 || !value.is_finite() {
            let sum = residuals.iter().map(|residual| residual * residual).sum();
            if profile.tau_of(sum) <= profile.half_width {
                let met = if value == 0.0 { &profile.none } else { &profile.without };
                met.fetch_add(1, Ordering::Relaxed);
            }
        }
        if !value.is_finite() {
            let name = "what is held".to_owned();
            return Err(SimulationError::OutOfRange { name, value, allowed: "finite" });
        }
        residuals.push(self.weight * (value - self.target));
        Ok(residuals)
    }

    fn jacobian(&self, unknowns: &[f64], control: &Control<'_>) -> Result<Vec<Vec<f64>>, SimulationError> {
        let mut jacobian = self.profile.problem.jacobian(unknowns, control)?;
        let slopes = self.profile.slopes(unknowns, self.profile.value(unknowns));
        for (index, column) in jacobian.iter_mut().enumerate() {
            column.push(self.weight * slopes.get(index).copied().unwrap_or(0.0));
        }
        Ok(jacobian)
    }
}
