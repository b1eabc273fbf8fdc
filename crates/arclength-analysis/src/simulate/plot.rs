//! What of a motion is drawn: quantities over the time, or one against another.

use crate::error::Error;
use crate::interval::Interval;
use crate::model::ChosenModel;
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
    pub(super) fn resolve(&self, chosen: &ChosenModel) -> Result<Plot, Error> {
        match self {
            Self::Against(pair) => Ok(Plot::Against(against(chosen, pair)?)),
            Self::Listed(names) => {
                let listed: Vec<Plotted> =
                    names.iter().map(|name| plotted(chosen, &["plot"], name)).collect::<Result<_, _>>()?;
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

fn against(chosen: &ChosenModel, [x, y]: &[String; 2]) -> Result<[Plotted; 2], Error> {
    different([plotted(chosen, &["plot"], x)?, plotted(chosen, &["plot"], y)?])
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

/// The quantity of that name.
fn plotted(chosen: &ChosenModel, fields: &'static [&'static str], name: &str) -> Result<Plotted, Error> {
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
    let names: Vec<&str> = ["t"]
        .into_iter()
        .chain(chosen.model.states().iter().chain(&auxiliaries).map(String::as_str))
        .collect();
    Err(Error::invalid(fields, name, "the model has no such quantity", names.join(", ")))
}

/// Limits of the axes of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Windows(Vec<(Variable, [f64; 2])>);

impl Windows {
    /// Those that are asked for, and those that the model has for the axes of its own picture.
    ///
    /// # Errors
    /// The field `window` with a name that the model does not have or an infinite interval.
    pub(super) fn new(chosen: &ChosenModel, asked: &[Interval]) -> Result<Self, Error> {
        let mut windows = Vec::new();
        for interval in asked {
            let plotted = plotted(chosen, &["window"], &interval.key)?;
            if !(interval.start.is_finite() && interval.end.is_finite()) {
                let problem = "the interval is infinite";
                return Err(Error::invalid(&["window"], interval.to_string(), problem, "two finite ends"));
            }
            windows.push((plotted.variable, [interval.start, interval.end]));
        }
        let options = chosen.model.options();
        let own = [(&options.xp, options.xlo, options.xhi), (&options.yp, options.ylo, options.yhi)];
        for (name, low, high) in own {
            let (Some(name), Some(low), Some(high)) = (name, low, high) else { continue };
            if let Some(plotted) = plotted(chosen, &["window"], name).ok().filter(|_| low < high) {
                windows.push((plotted.variable, [low, high]));
            }
        }
        Ok(Self(windows))
    }

    /// The limits of a quantity.
    pub(super) fn of(&self, variable: Variable) -> Option<[f64; 2]> {
        self.0.iter().find(|(known, _)| *known == variable).map(|(_, limits)| *limits)
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
