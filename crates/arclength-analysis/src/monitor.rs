//! Monitors: expressions that are recorded along a branch, with values at which a point is wanted or the branch ends.
//!
//! On equilibria an expression has a value. On a cycle a state has none, but `max(..)`, `min(..)` and `mean(..)` of an expression
//! have, and its value `at(.., PHASE)`, and so have the `period` and the parameters. A phase is a part of the period, counted
//! from the place where the first state is largest.

use crate::calls::{Call, Part, arguments_of, divide, mentions, part_name};
use crate::error::Error;
use crate::vocabulary::Vocabulary;
use arclength::cycle::Orbit;
use arclength_ode::{OdeError, Quantity};
use kingpin_report::NamedNumbers;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// An expression to be monitored, `EXPRESSION` or `EXPRESSION=A,B,..`.
///
/// ```
/// use arclength_analysis::Monitored;
/// let monitored: Monitored = "max(x)-min(x)=1,2".parse()?;
/// assert_eq!((monitored.expression.as_str(), monitored.at), ("max(x)-min(x)", vec![1.0, 2.0]));
/// # Ok::<(), arclength_analysis::MonitorError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Monitored {
    /// The expression.
    pub expression: String,
    /// Values at which a point is wanted.
    #[serde(default)]
    pub at: Vec<f64>,
    /// Values at which the branch ends.
    #[serde(default)]
    pub until: Vec<f64>,
}

/// Why a text is no monitor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must have the form EXPRESSION or EXPRESSION=A,B,.. with finite numbers, such as max(x)=1.5")]
pub struct MonitorError;

impl FromStr for Monitored {
    type Err = MonitorError;

    fn from_str(text: &str) -> Result<Self, MonitorError> {
        let numbers = |list: &str| -> Option<Vec<f64>> {
            list.split(',')
                .map(|number| number.trim().parse::<f64>().ok().filter(|number| number.is_finite()))
                .collect()
        };
        // The last sign of equality, if it is no part of a comparison.
        let split = text.rsplit_once('=').filter(|(left, _)| !left.ends_with(['=', '<', '>', '!']));
        let (expression, at) = match split {
            Some((expression, list)) => (expression, numbers(list).ok_or(MonitorError)?),
            None => (text, Vec::new()),
        };
        if expression.trim().is_empty() {
            return Err(MonitorError);
        }
        Ok(Self { expression: expression.trim().to_owned(), at, until: Vec::new() })
    }
}

impl Monitored {
    /// The same with the branch ending at its values.
    pub fn ending(self) -> Self {
        Self { until: self.at, at: Vec::new(), ..self }
    }

    fn wrong(&self, problem: String, allowed: &str) -> Error {
        let field: &[_] = if self.until.is_empty() { &["monitor"] } else { &["until"] };
        Error::invalid(field, self.expression.clone(), problem, allowed)
    }

    /// The monitor on equilibria.
    ///
    /// # Errors
    /// An expression that cannot be read, or that depends on the time.
    pub fn on_equilibria(&self, vocabulary: &Vocabulary<'_>) -> Result<Quantity, Error> {
        let allowed = || match vocabulary.sizes()[2] {
            0 => EQUILIBRIA.to_owned(),
            _ => format!("an expression in {}", vocabulary.names().collect::<Vec<_>>().join(", ")),
        };
        let expression = vocabulary.translate(&self.expression);
        let expression = expression.map_err(|problem| self.wrong(problem, &allowed()))?;
        let quantity = vocabulary.quantity(&expression, &[]);
        let quantity = quantity.map_err(|error| self.wrong(reason(&error), &allowed()))?;
        if mentions(&expression, |name| name == "t") {
            return Err(self.wrong("the time has no value on a branch".to_owned(), &allowed()));
        }
        Ok(quantity)
    }

    /// The monitor on cycles.
    ///
    /// # Errors
    /// An expression that cannot be read, or in which a state stands that has no value of its own on a cycle.
    pub fn on_cycles(&self, vocabulary: &Vocabulary<'_>) -> Result<CycleMonitor, Error> {
        let expression = vocabulary.translate(&self.expression);
        let expression = expression.map_err(|problem| self.wrong(problem, CYCLES))?;
        // A model may have a function of its own by that name.
        let phases = vocabulary.quantity("at(0, 0)", &[]).is_err();
        let (outer, parts) = divide(&expression, phases);
        let state =
            vocabulary.varying().find(|(state, _)| mentions(&outer, |name| state.eq_ignore_ascii_case(name)));
        if let Some((_, state)) = state {
            return Err(self.wrong(
                format!("the state {state} has no single value on a cycle"),
                &format!(
                    "max({state}), min({state}), mean({state}), at({state}, PHASE), of expressions too, parameters and period"
                ),
            ));
        }
        if mentions(&expression, |name| name == "t") {
            return Err(self.wrong("the time has no value on a branch".to_owned(), CYCLES));
        }
        let names: Vec<String> = (1..=parts.len()).map(part_name).collect();
        let mut others: Vec<&str> = names.iter().map(String::as_str).collect();
        others.push(PERIOD);
        let read = vocabulary.quantity(&outer, &others);
        let (outer, has_period) = match read {
            // The model has something of its own by that name.
            Err(OdeError::NameTaken { name, .. }) if name.eq_ignore_ascii_case(PERIOD) => {
                others.pop();
                (vocabulary.quantity(&outer, &others), false)
            }
            read => (read, true),
        };
        let outer = outer.map_err(|error| self.wrong(reason(&error), CYCLES))?;
        let parts = parts.into_iter().map(|Part { call, argument }| {
            let (taken, expression) = match call {
                Call::Largest => (Taken::Largest, argument),
                Call::Smallest => (Taken::Smallest, argument),
                Call::Mean => (Taken::Mean, argument),
                Call::At => {
                    let (expression, phase) = self.phase(&argument, vocabulary)?;
                    (Taken::At(phase), expression)
                }
            };
            let quantity = vocabulary.quantity(&expression, &[]);
            Ok((taken, quantity.map_err(|error| self.wrong(reason(&error), CYCLES))?))
        });
        let [states, _, further] = vocabulary.sizes();
        let parts = parts.collect::<Result<_, Error>>()?;
        Ok(CycleMonitor { outer, states, further, parts, has_period })
    }

    /// The value to be held: the one that is given, or the one `here`, where the curve starts at a label.
    ///
    /// # Errors
    /// No value there, or several values given.
    pub fn value_to_hold(&self, here: Option<f64>, label: &str) -> Result<f64, Error> {
        let wrong = |problem: String, allowed: &str| {
            Error::invalid(&["hold"], self.expression.clone(), problem, allowed)
        };
        match (&self.at[..], here) {
            (_, None) => {
                Err(wrong(format!("it has no value at {label}"), "an expression that has a value there"))
            }
            ([], Some(here)) => Ok(here),
            ([value], Some(_)) => Ok(*value),
            _ => Err(wrong(
                "several values are given".to_owned(),
                "one value, or none for the one where the curve starts",
            )),
        }
    }

    /// The expression and the phase of a call of `at`.
    fn phase(&self, arguments: &str, vocabulary: &Vocabulary<'_>) -> Result<(String, f64), Error> {
        let wrong = |problem: String| self.wrong(problem, PHASES);
        let [expression, phase] = arguments_of(arguments)[..] else {
            return Err(wrong(format!("at({arguments}) does not have an expression and a phase")));
        };
        let phase = phase.trim();
        let quantity = vocabulary.quantity(phase, &[]).map_err(|error| wrong(reason(&error)))?;
        // What is not constant is not a number here.
        let [states, parameters, further] = vocabulary.sizes().map(|count| vec![f64::NAN; count]);
        let value = quantity.value(&states, &parameters, &further);
        let varies =
            vocabulary.variables().any(|name| mentions(phase, |word| name.eq_ignore_ascii_case(word)));
        if varies || value.is_nan() {
            return Err(wrong(format!("the phase {phase} is not constant")));
        }
        if !(0.0..1.0).contains(&value) {
            return Err(wrong(format!("the phase {phase} is outside one period")));
        }
        Ok((expression.to_owned(), value))
    }
}

const EQUILIBRIA: &str = "an expression in the names of the model";
const CYCLES: &str = "max(..), min(..), mean(..) and at(.., PHASE) of expressions in the names of the model, parameters and period";
const PHASES: &str = "at(EXPRESSION, PHASE), such as at(x, 0.25), where the phase is a constant from 0 to below 1: a part of the \
                      period, counted from the place where the first state is largest";
const PERIOD: &str = "period";

/// Values of monitors by name, where they exist.
pub fn named(names: &[String], values: &[f64]) -> NamedNumbers {
    let known = names.iter().cloned().zip(values.iter().copied());
    NamedNumbers(known.filter(|(_, value)| value.is_finite()).collect())
}

/// Names of the monitors that exist anywhere, in their order.
pub fn monitored<'a>(points: impl Iterator<Item = &'a NamedNumbers>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in points.flat_map(|monitors| &monitors.0) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// What is wrong with an expression, without the place in the line that declares it, which nobody wrote.
pub(crate) fn reason(error: &OdeError) -> String {
    let text = error.to_string();
    match (error.place(), text.split_once(": ")) {
        (Some(_), Some((_, message))) => message.to_owned(),
        _ => text,
    }
}

/// What is taken of an expression along a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Taken {
    Largest,
    Smallest,
    Mean,
    /// The value at a phase.
    At(f64),
}

/// A monitor on cycles.
#[derive(Clone, Debug)]
pub struct CycleMonitor {
    outer: Quantity,
    /// Number of states of what the expression is about.
    states: usize,
    /// Number of further quantities.
    further: usize,
    parts: Vec<(Taken, Quantity)>,
    has_period: bool,
}

impl CycleMonitor {
    /// Its value on a cycle of a model.
    pub fn value(&self, orbit: &Orbit, parameters: &[f64]) -> f64 {
        self.value_by(orbit, parameters, &|quantity, state| quantity.value(state, parameters, &[]))
    }

    /// Its value on a cycle, where `value_at` gives the value of a quantity at a state of the orbit.
    pub fn value_by(
        &self,
        orbit: &Orbit,
        parameters: &[f64],
        value_at: &dyn Fn(&Quantity, &[f64]) -> f64,
    ) -> f64 {
        let mut others = vec![f64::NAN; self.further];
        others.extend(self.parts.iter().map(|(taken, quantity)| {
            let function = |state: &[f64]| value_at(quantity, state);
            match taken {
                Taken::Largest => orbit.maximum(function),
                Taken::Smallest => orbit.minimum(function),
                Taken::Mean => orbit.mean(function),
                Taken::At(phase) => orbit.at_phase(*phase, function),
            }
        }));
        others.extend(self.has_period.then_some(orbit.period));
        // What depends on a state in the end, through a quantity of the model, is not a number.
        self.outer.value(&vec![f64::NAN; self.states], parameters, &others)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_monitor_is_refused() {
        for wrong in ["", "=1", "x=", "x=1,,2", "x=y", "x=inf"] {
            assert!(wrong.parse::<Monitored>().is_err(), "{wrong}");
        }
        assert_eq!("x>=1".parse::<Monitored>().unwrap().expression, "x>=1");
        assert_eq!("x==1=0,1".parse::<Monitored>().unwrap().at, [0.0, 1.0]);
    }
}
