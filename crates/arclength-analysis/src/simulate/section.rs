//! Poincaré sections: where a motion crosses a surface in the space of its states, or in time.
//!
//! A crossing is located on the dense output of the step in which it lies and then corrected by steps of its own, so that it is as exact
//! as the end of a step.

use crate::error::Error;
use crate::model::ChosenModel;
use crate::monitor::reason;
use arclength::Direction;
use arclength::integration::{Event, EventLocator, IntegrationError, Stepper, System};
use arclength_ode::Quantity;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Part of a step over which the rate of the section function is measured.
const RATE: f64 = 1e-4;
/// A function that passes zero continuously leaves less than it changes in this part of a step.
const CONTINUOUS: f64 = 1e-8;
/// Corrections of the time of a crossing.
const CORRECTIONS: usize = 4;
/// States that differ by more than this part are not the same: there was a jump between them.
const SAME: f64 = 1e-9;

/// A section: where an expression has a value.
///
/// ```
/// use arclength_analysis::simulate::{SectionDirection, SectionRequest};
/// let section: SectionRequest = "x=0.3:+".parse()?;
/// assert_eq!((section.expression.as_str(), section.direction), ("x-(0.3)", SectionDirection::Rising));
/// assert_eq!("y-0.3".parse::<SectionRequest>()?.direction, SectionDirection::Both);
/// # Ok::<(), arclength_analysis::simulate::SectionError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SectionRequest {
    /// The expression that is zero on it.
    pub expression: String,
    /// In which direction it is crossed.
    #[serde(default)]
    pub direction: SectionDirection,
}

/// Which crossings count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SectionDirection {
    /// All.
    #[default]
    Both,
    /// Those where the expression grows.
    Rising,
    /// Those where it falls.
    Falling,
}

/// Why a text is no section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "it must have the form EXPRESSION, EXPRESSION=VALUE or one of these with :+ (rising) or :- (falling), such as x=0:+"
)]
pub struct SectionError;

impl FromStr for SectionRequest {
    type Err = SectionError;

    fn from_str(text: &str) -> Result<Self, SectionError> {
        let (text, direction) = match text.rsplit_once(':').map(|(rest, sign)| (rest, sign.trim())) {
            Some((rest, "+")) => (rest, SectionDirection::Rising),
            Some((rest, "-")) => (rest, SectionDirection::Falling),
            Some(_) => return Err(SectionError),
            None => (text, SectionDirection::Both),
        };
        let comparison = |left: &str| left.ends_with(['<', '>', '!', '=']);
        let expression = match text.split_once('=') {
            Some((left, right)) if !comparison(left) && !right.starts_with('=') => {
                if left.trim().is_empty() || right.trim().is_empty() {
                    return Err(SectionError);
                }
                format!("{}-({})", left.trim(), right.trim())
            }
            _ => text.trim().to_owned(),
        };
        if expression.is_empty() {
            return Err(SectionError);
        }
        Ok(Self { expression, direction })
    }
}

/// A section of a model.
#[derive(Clone, Debug)]
pub(super) struct Section {
    quantity: Quantity,
    parameters: Vec<f64>,
    direction: Direction,
}

impl From<SectionDirection> for Direction {
    fn from(direction: SectionDirection) -> Self {
        match direction {
            SectionDirection::Both => Self::Either,
            SectionDirection::Rising => Self::Rising,
            SectionDirection::Falling => Self::Falling,
        }
    }
}

impl SectionRequest {
    /// The section of a model.
    ///
    /// # Errors
    /// The field `section` with an expression that cannot be read.
    pub(super) fn of(&self, chosen: &ChosenModel) -> Result<Section, Error> {
        let quantity = chosen.model.quantity(&self.expression, &[]).map_err(|error| {
            let allowed = "an expression in the names of the model and t, such as x=0:+ or \"y-0.3\"";
            Error::invalid(&["section"], self.expression.clone(), reason(&error), allowed)
        })?;
        Ok(Section { quantity, parameters: chosen.parameters.clone(), direction: self.direction.into() })
    }
}

impl Section {
    fn value(&self, time: f64, state: &[f64]) -> f64 {
        self.quantity.value_at(time, state, &self.parameters, &[])
    }

    /// Watches a motion from its start on.
    pub(super) fn watch(&self, time: f64, state: &[f64]) -> SectionWatch {
        let mut watch = SectionWatch {
            section: self.clone(),
            side: None,
            last: (time, state.to_vec()),
            crossings: Vec::new(),
        };
        watch.side = watch.side_at(time, state);
        watch
    }
}

/// A section with the crossings of a motion.
#[derive(Debug)]
pub(super) struct SectionWatch {
    section: Section,
    /// The side on which the motion is, if it has been on one.
    side: Option<f64>,
    /// Time and state where the last step ended.
    last: (f64, Vec<f64>),
    /// Time and state of every crossing that counts.
    pub crossings: Vec<(f64, Vec<f64>)>,
}

impl SectionWatch {
    fn side_at(&self, time: f64, state: &[f64]) -> Option<f64> {
        let value = self.section.value(time, state);
        (value != 0.0 && !value.is_nan()).then(|| value.signum())
    }

    /// Adds the crossings in the last step up to a time in it; `step` gives the state at a time by a step of its own.
    ///
    /// # Errors
    /// Those of the steps.
    pub(super) fn record<S: System>(
        &mut self,
        stepper: &mut Stepper<S>,
        reached: f64,
        step: impl Fn((f64, &[f64]), f64) -> Result<Vec<f64>, IntegrationError>,
    ) -> Result<(), IntegrationError> {
        let (start, end) = (stepper.previous_time(), stepper.time());
        if start == end {
            return Ok(());
        }
        stepper.prepare_dense_output();
        let origin = interpolated(stepper, start);
        let jumped = origin.iter().zip(&self.last.1).any(|(now, before)| {
            (now - before).abs() > SAME * now.abs().max(before.abs()).max(f64::MIN_POSITIVE)
        });
        if jumped {
            self.side = self.side_at(start, &origin);
        }
        let section = self.section.clone();
        // From a side that is known, rounding at the start cannot hide a crossing.
        let side = self.side.unwrap_or(1.0);
        let mut events = [Event::new(|time, state: &[f64]| side * section.value(time, state))];
        let mut locator = match self.side {
            Some(_) => EventLocator::from_signs(vec![1.0], origin.len()),
            None => EventLocator::new(&mut events, start, &origin),
        };
        let mut passed = Vec::new();
        locator.locate(stepper, &mut events, &mut passed);
        passed.retain(|crossing| crossing.time <= reached);
        let mut side = self.side;
        for crossing in &passed {
            let far = side
                .map_or_else(|| self.section.value(crossing.time, &crossing.state).signum(), |side| -side);
            side = Some(far);
            let counts = self.section.direction.counts(-far, far);
            if let Some(exact) =
                self.corrected(stepper, (start, &origin), crossing.time, &step)?.filter(|_| counts)
            {
                self.crossings.push(exact);
            }
        }
        let state = interpolated(stepper, reached);
        self.side = side.or_else(|| self.side_at(reached, &state));
        self.last = (reached, state);
        Ok(())
    }

    /// The crossing near a time as exact as the end of a step; nothing where the function jumps over zero.
    fn corrected<S: System>(
        &self,
        stepper: &Stepper<S>,
        (start, origin): (f64, &[f64]),
        located: f64,
        step: &impl Fn((f64, &[f64]), f64) -> Result<Vec<f64>, IntegrationError>,
    ) -> Result<Option<(f64, Vec<f64>)>, IntegrationError> {
        let end = stepper.time();
        let value = |time: f64| self.section.value(time, &interpolated(stepper, time));
        let reach = RATE * (end - start);
        let (before, behind) = ((located - reach).max(start), (located + reach).min(end));
        let rate = (value(behind) - value(before)) / (behind - before);
        let rounding = 64.0 * f64::EPSILON * located.abs();
        if value(located).abs() > rate.abs() * (CONTINUOUS * (end - start) + rounding) {
            return Ok(None);
        }
        let mut time = located;
        let mut state = step((start, origin), time)?;
        for _ in 0..CORRECTIONS {
            let correction = self.section.value(time, &state) / rate;
            let corrected = time - correction;
            // Where the motion only touches the section there is nothing to be gained.
            if !(start < corrected && corrected <= end) || correction.abs() <= rounding / 16.0 {
                break;
            }
            time = corrected;
            state = step((start, origin), time)?;
        }
        Ok(Some((time, state)))
    }
}

fn interpolated<S: System>(stepper: &Stepper<S>, time: f64) -> Vec<f64> {
    let mut state = vec![0.0; stepper.state().len()];
    stepper.interpolate(time, &mut state);
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_section_is_refused() {
        for wrong in ["", "=0", "x=", ":+", "x=0:up", "x:", "=:+"] {
            assert!(wrong.parse::<SectionRequest>().is_err(), "{wrong}");
        }
        let read = |text: &str| text.parse::<SectionRequest>().unwrap().expression;
        assert_eq!(
            (read("x>=1"), read("x==1"), read(" y - 0.3 :-")),
            ("x>=1".into(), "x==1".into(), "y - 0.3".into())
        );
        assert_eq!(read("x = a*t"), "x-(a*t)");
    }
}
