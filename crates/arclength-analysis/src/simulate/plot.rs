//! What of a motion is drawn: quantities over the time, or one against another.

use crate::error::Error;
use crate::interval::Interval;
use crate::model::ChosenModel;
use crate::monitor::reason;
use arclength_ode::Quantity;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// What a picture shows of a motion.
///
/// ```
/// use arclength_analysis::simulate::PlotRequest;
/// assert_eq!("v,ica".parse(), Ok(PlotRequest::Listed(vec!["v".into(), "ica".into()])));
/// assert_eq!("v:ica".parse(), Ok(PlotRequest::Against(["v".into(), "ica".into()])));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PlotRequest {
    /// Two states: their phase plane. Anything else: each of these over the time.
    Listed(Vec<String>),
    /// The second against the first.
    Against([String; 2]),
}

/// Why a text does not say what to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "it must have the form x,y (phase plane of two states), v,ica,.. (over the time) or x:y (y against x)"
)]
pub struct PlotError;

impl FromStr for PlotRequest {
    type Err = PlotError;

    fn from_str(text: &str) -> Result<Self, PlotError> {
        let names = |separator: char| -> Vec<String> {
            text.split(separator).map(|name| name.trim().to_owned()).collect()
        };
        let (against, listed) = (names(':'), names(','));
        if against.iter().chain(&listed).any(String::is_empty) {
            return Err(PlotError);
        }
        match <[String; 2]>::try_from(against) {
            Ok(pair) if listed.len() == 1 => Ok(Self::Against(pair)),
            Err(one) if one.len() == 1 => Ok(Self::Listed(listed)),
            _ => Err(PlotError),
        }
    }
}

/// What has a value at every time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Time,
    State(usize),
    Auxiliary(usize),
    /// One of the [`Expressions`].
    Expression(usize),
}

/// Other expressions in the names of a model that are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Expressions(Vec<(String, Quantity)>);

impl Expressions {
    /// The value of one.
    pub(super) fn value(&self, index: usize, time: f64, state: &[f64], parameters: &[f64]) -> f64 {
        self.0[index].1.value_at(time, state, parameters, &[])
    }

    /// The index of an expression, which is read unless it is known.
    fn index(&mut self, chosen: &ChosenModel, text: &str) -> Result<usize, String> {
        if let Some(index) = self.0.iter().position(|(known, _)| known == text) {
            return Ok(index);
        }
        let quantity = chosen.model.quantity(text, &[]).map_err(|error| reason(&error))?;
        self.0.push((text.to_owned(), quantity));
        Ok(self.0.len() - 1)
    }
}

/// A named quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plotted {
    pub name: String,
    pub variable: Variable,
}

/// What is drawn, with names that the model has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Plot {
    /// Each over the time.
    Histories(Vec<Plotted>),
    /// The second against the first.
    Against([Plotted; 2]),
}

impl Plot {
    /// Horizontal and vertical quantity of every curve.
    pub(super) fn pairs(&self) -> Vec<[Variable; 2]> {
        match self {
            Self::Histories(listed) => {
                listed.iter().map(|plotted| [Variable::Time, plotted.variable]).collect()
            }
            Self::Against([x, y]) => vec![[x.variable, y.variable]],
        }
    }
}

impl PlotRequest {
    /// The same with the names of a model.
    ///
    /// # Errors
    /// The field `plot` with a name that the model does not have.
    pub(super) fn resolve(&self, chosen: &ChosenModel, expressions: &mut Expressions) -> Result<Plot, Error> {
        match self {
            Self::Against([x, y]) => {
                let mut plotted = |name: &String| plotted(chosen, expressions, &["plot"], name);
                Ok(Plot::Against(different([plotted(x)?, plotted(y)?])?))
            }
            Self::Listed(names) => {
                let mut plotted = |name: &String| plotted(chosen, expressions, &["plot"], name);
                let listed: Vec<Plotted> = names.iter().map(&mut plotted).collect::<Result<_, _>>()?;
                let is_state = |plotted: &Plotted| matches!(plotted.variable, Variable::State(_));
                match <[Plotted; 2]>::try_from(listed) {
                    Ok(pair) if pair.iter().all(is_state) => Ok(Plot::Against(different(pair)?)),
                    Ok(pair) => histories(pair.to_vec()),
                    Err(listed) => histories(listed),
                }
            }
        }
    }
}

fn different(pair: [Plotted; 2]) -> Result<[Plotted; 2], Error> {
    if pair[0].variable != pair[1].variable {
        return Ok(pair);
    }
    let given = format!("{}:{}", pair[0].name, pair[1].name);
    Err(Error::invalid(&["plot"], given, "the same on both axes", "two different quantities"))
}

/// Those listed over the time; the time itself need not be named.
fn histories(listed: Vec<Plotted>) -> Result<Plot, Error> {
    let others: Vec<Plotted> =
        listed.into_iter().filter(|plotted| plotted.variable != Variable::Time).collect();
    if others.is_empty() {
        return Err(Error::invalid(&["plot"], "t", "the time over itself", "other quantities with it"));
    }
    Ok(Plot::Histories(others))
}

/// The quantity of that name, or an expression.
fn plotted(
    chosen: &ChosenModel,
    expressions: &mut Expressions,
    fields: &'static [&'static str],
    name: &str,
) -> Result<Plotted, Error> {
    let is_named = |other: &String| other.eq_ignore_ascii_case(name);
    let auxiliaries = chosen.auxiliary_names();
    if let Some(index) = chosen.model.state_index(name) {
        let name = chosen.model.states()[index].clone();
        return Ok(Plotted { name, variable: Variable::State(index) });
    }
    if let Some(index) = auxiliaries.iter().position(is_named) {
        return Ok(Plotted { name: auxiliaries[index].clone(), variable: Variable::Auxiliary(index) });
    }
    if name.eq_ignore_ascii_case("t") {
        return Ok(Plotted { name: "t".to_owned(), variable: Variable::Time });
    }
    match expressions.index(chosen, name) {
        Ok(index) => Ok(Plotted { name: name.to_owned(), variable: Variable::Expression(index) }),
        Err(problem) => {
            let names = chosen.model.states().iter().chain(&auxiliaries).map(String::as_str);
            let names: Vec<&str> = ["t"].into_iter().chain(names).collect();
            let allowed = format!("{}, or an expression in the names of the model", names.join(", "));
            Err(Error::invalid(fields, name, problem, allowed))
        }
    }
}

/// Limits of the axes of a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Windows {
    asked: Vec<(Variable, [f64; 2])>,
    /// What is on the axes of the picture that the model itself describes, with their limits.
    own: Vec<(Variable, Option<[f64; 2]>)>,
}

impl Windows {
    /// Those that are asked for, and those that the model has for the axes of its own picture.
    ///
    /// # Errors
    /// The field `window` with a name that the model does not have or an infinite interval.
    pub(super) fn new(
        chosen: &ChosenModel,
        asked: &[Interval],
        expressions: &mut Expressions,
    ) -> Result<Self, Error> {
        let mut windows = Self::default();
        for interval in asked {
            let plotted = plotted(chosen, expressions, &["window"], &interval.key)?;
            if !(interval.start.is_finite() && interval.end.is_finite()) {
                let problem = "the interval is infinite";
                return Err(Error::invalid(&["window"], interval.to_string(), problem, "two finite ends"));
            }
            windows.asked.push((plotted.variable, [interval.start, interval.end]));
        }
        let options = chosen.model.options();
        let own = [(&options.xp, options.xlo, options.xhi), (&options.yp, options.ylo, options.yhi)];
        for (name, low, high) in own {
            let plotted = name.as_ref().and_then(|name| plotted(chosen, expressions, &["window"], name).ok());
            let limits = low.zip(high).filter(|(low, high)| low < high).map(|(low, high)| [low, high]);
            windows.own.extend(plotted.map(|plotted| (plotted.variable, limits)));
        }
        Ok(windows)
    }

    /// The limits of both axes of a curve. Those of the model are for the two quantities that it names itself, and not for the time.
    pub(super) fn of(&self, pair: [Variable; 2]) -> [Option<[f64; 2]>; 2] {
        let is_own = self.own.len() == 2 && self.own.iter().all(|(variable, _)| pair.contains(variable));
        pair.map(|wanted| {
            let asked =
                self.asked.iter().find(|(variable, _)| *variable == wanted).map(|(_, limits)| *limits);
            let own = self.own.iter().find(|(variable, _)| *variable == wanted && wanted != Variable::Time);
            asked.or_else(|| own.filter(|_| is_own)?.1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_say_what_to_draw_is_refused() {
        for wrong in ["", ",", "x,", ":", "x:", "x:y:z", "x:y,z", "x,,y"] {
            assert!(wrong.parse::<PlotRequest>().is_err(), "{wrong}");
        }
        assert_eq!("x".parse(), Ok(PlotRequest::Listed(vec!["x".to_owned()])));
    }
}
