//! Monitors: expressions that are recorded along a branch, with values at which a point is wanted or the branch ends.
//!
//! On equilibria an expression has a value. On a cycle a state has none, but `max(..)`, `min(..)` and `mean(..)` of an expression
//! have, and so have the `period` and the parameters.

use crate::error::Error;
use crate::model::ChosenModel;
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
        Error::invalid(&["monitor"], self.expression.clone(), problem, allowed)
    }

    /// The monitor on equilibria.
    ///
    /// # Errors
    /// An expression that cannot be read, or that depends on the time.
    pub(crate) fn on_equilibria(&self, chosen: &ChosenModel) -> Result<Quantity, Error> {
        let quantity = chosen.model.quantity(&self.expression, &[]);
        let quantity = quantity.map_err(|error| self.wrong(reason(&error), EQUILIBRIA))?;
        if mentions(&self.expression, |name| name == "t") {
            return Err(self.wrong("the time has no value on a branch".to_owned(), EQUILIBRIA));
        }
        Ok(quantity)
    }

    /// The monitor on cycles.
    ///
    /// # Errors
    /// An expression that cannot be read, or in which a state stands that has no value of its own on a cycle.
    pub(crate) fn on_cycles(&self, chosen: &ChosenModel) -> Result<CycleMonitor, Error> {
        let (outer, parts) = divide(&self.expression);
        let state = chosen
            .model
            .states()
            .iter()
            .find(|state| mentions(&outer, |name| state.eq_ignore_ascii_case(name)));
        if let Some(state) = state {
            return Err(self.wrong(
                format!("the state {state} has no single value on a cycle"),
                &format!(
                    "max({state}), min({state}), mean({state}), of expressions too, parameters and period"
                ),
            ));
        }
        if mentions(&self.expression, |name| name == "t") {
            return Err(self.wrong("the time has no value on a branch".to_owned(), CYCLES));
        }
        let names: Vec<String> = (1..=parts.len()).map(part_name).collect();
        let mut others: Vec<&str> = names.iter().map(String::as_str).collect();
        others.push(PERIOD);
        let read = chosen.model.quantity(&outer, &others);
        let (outer, has_period) = match read {
            // The model has something of its own by that name.
            Err(OdeError::NameTaken { name, .. }) if name.eq_ignore_ascii_case(PERIOD) => {
                others.pop();
                (chosen.model.quantity(&outer, &others), false)
            }
            read => (read, true),
        };
        let outer = outer.map_err(|error| self.wrong(reason(&error), CYCLES))?;
        let parts = parts.into_iter().map(|(kind, expression)| {
            let quantity = chosen.model.quantity(&expression, &[]);
            Ok((kind, quantity.map_err(|error| self.wrong(reason(&error), CYCLES))?))
        });
        Ok(CycleMonitor { outer, parts: parts.collect::<Result<_, Error>>()?, has_period })
    }
}

const EQUILIBRIA: &str = "an expression in the names of the model";
const CYCLES: &str =
    "max(..), min(..) and mean(..) of expressions in the names of the model, parameters and period";
const PERIOD: &str = "period";

fn part_name(index: usize) -> String {
    format!("along_cycle_{index}")
}

/// Values of monitors by name, where they exist.
pub(crate) fn named(names: &[String], values: &[f64]) -> NamedNumbers {
    let known = names.iter().cloned().zip(values.iter().copied());
    NamedNumbers(known.filter(|(_, value)| value.is_finite()).collect())
}

/// Names of the monitors that exist anywhere, in their order.
pub(crate) fn monitored<'a>(points: impl Iterator<Item = &'a NamedNumbers>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in points.flat_map(|monitors| &monitors.0) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// What is wrong with an expression, without the place in the line that declares it, which nobody wrote.
fn reason(error: &OdeError) -> String {
    let text = error.to_string();
    match (error.place(), text.split_once(": ")) {
        (Some(_), Some((_, message))) => message.to_owned(),
        _ => text,
    }
}

/// What is taken of an expression along a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Largest,
    Smallest,
    Mean,
}

/// A monitor on cycles.
#[derive(Clone, Debug)]
pub(crate) struct CycleMonitor {
    outer: Quantity,
    parts: Vec<(Kind, Quantity)>,
    has_period: bool,
}

impl CycleMonitor {
    /// Its value on a cycle.
    pub fn value(&self, orbit: &Orbit, parameters: &[f64]) -> f64 {
        let mut others: Vec<f64> = self
            .parts
            .iter()
            .map(|(kind, quantity)| {
                let function = |state: &[f64]| quantity.value(state, parameters, &[]);
                match kind {
                    Kind::Largest => orbit.maximum(function),
                    Kind::Smallest => orbit.minimum(function),
                    Kind::Mean => orbit.mean(function),
                }
            })
            .collect();
        others.extend(self.has_period.then_some(orbit.period));
        // What depends on a state in the end, through a quantity of the model, is not a number.
        self.outer.value(&vec![f64::NAN; orbit.dimension], parameters, &others)
    }
}

/// The names in an expression, with where each ends.
fn names(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_part = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let mut rest = 0;
    std::iter::from_fn(move || {
        loop {
            let start = rest + text[rest..].find(is_part)?;
            let end =
                text[start..].find(|character| !is_part(character)).map_or(text.len(), |end| start + end);
            rest = end;
            if text[start..].starts_with(|first: char| !first.is_ascii_digit()) {
                return Some((start, &text[start..end]));
            }
        }
    })
}

fn mentions(text: &str, is_meant: impl Fn(&str) -> bool) -> bool {
    names(text).any(|(_, name)| is_meant(&name.to_ascii_lowercase()))
}

/// Takes calls of `max`, `min` and `mean` with one argument out of an expression: the expression with names in their place, and
/// what each stands for. (With two arguments `max` and `min` are functions of numbers.)
fn divide(text: &str) -> (String, Vec<(Kind, String)>) {
    let (mut outer, mut parts, mut copied) = (String::new(), Vec::new(), 0);
    for (start, name) in names(text) {
        let kind = match name.to_ascii_lowercase().as_str() {
            "max" => Kind::Largest,
            "min" => Kind::Smallest,
            "mean" => Kind::Mean,
            _ => continue,
        };
        let after = start + name.len();
        if start < copied {
            continue;
        }
        let Some((open, close)) = single_argument(text, after) else { continue };
        outer.push_str(&text[copied..start]);
        parts.push((kind, text[open..close].to_owned()));
        outer.push_str(&part_name(parts.len()));
        copied = close + 1;
    }
    outer.push_str(&text[copied..]);
    (outer, parts)
}

/// Where the only argument of a call lies whose name ends at `after`.
fn single_argument(text: &str, after: usize) -> Option<(usize, usize)> {
    let gap = text[after..].find(|character: char| !character.is_whitespace())?;
    let open = after + gap;
    if !text[open..].starts_with('(') {
        return None;
    }
    let mut depth = 0;
    for (index, character) in text[open..].char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 1 => return None,
            _ => {}
        }
        if depth == 0 {
            return Some((open + 1, open + index));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_along_the_cycle_are_told_from_functions_of_numbers() {
        let (outer, parts) = divide("max(x+y) - min( max(x, y) ) + max(a, 1) + mean(f(x))/2");
        assert_eq!(outer, "along_cycle_1 - along_cycle_2 + max(a, 1) + along_cycle_3/2");
        let expected = [(Kind::Largest, "x+y"), (Kind::Smallest, " max(x, y) "), (Kind::Mean, "f(x)")]
            .map(|(kind, text)| (kind, text.to_owned()));
        assert_eq!(parts, expected);
    }

    #[test]
    fn what_is_no_monitor_is_refused() {
        for wrong in ["", "=1", "x=", "x=1,,2", "x=y", "x=inf"] {
            assert!(wrong.parse::<Monitored>().is_err(), "{wrong}");
        }
        assert_eq!("x>=1".parse::<Monitored>().unwrap().expression, "x>=1");
        assert_eq!("x==1=0,1".parse::<Monitored>().unwrap().at, [0.0, 1.0]);
    }
}
