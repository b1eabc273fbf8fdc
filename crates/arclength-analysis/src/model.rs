//! A model with values of its parameters and a state.

use crate::error::Error;
use crate::interval::{Along, Interval};
use crate::stored_model::StoredModel;
use arclength::equilibrium::WithTotals;
use arclength_ode::Model;
use kingpin_report::NamedNumbers;
use kingpin_report::numbers::{readable, significant};
use std::path::Path;

/// A model with a value for every parameter and an initial value for every state.
#[derive(Clone, Debug)]
pub struct ChosenModel {
    /// Where it came from.
    pub stored: StoredModel,
    /// The model.
    pub model: Model,
    /// Values of all parameters.
    pub parameters: Vec<f64>,
    /// Initial state.
    pub start: Vec<f64>,
}

impl ChosenModel {
    /// A model with the parameters and the initial state of its text.
    pub fn new(stored: StoredModel, mut model: Model) -> Self {
        if let Some(time) = stored.frozen_time {
            model.freeze(time);
        }
        let parameters = model.default_parameters().to_vec();
        let start = model.initial_state(&parameters);
        Self { stored, model, parameters, start }
    }

    /// The model of a text that was kept, with other values of parameters; `path` is where it was kept.
    ///
    /// # Errors
    /// A text that is no model, or parameters that are not its own.
    pub fn stored(path: &Path, stored: StoredModel, parameters: &[(String, f64)]) -> Result<Self, Error> {
        let model = Model::parse(&stored.source)
            .map_err(|source| Error::Model { path: path.to_owned(), source: source.into() })?;
        let mut chosen = Self::new(stored, model);
        for (name, value) in parameters {
            let index = chosen.model.parameter_index(name).ok_or_else(|| Error::ResultFile {
                path: path.to_owned(),
                problem: format!("its model has no parameter `{name}`"),
            })?;
            chosen.parameters[index] = *value;
        }
        Ok(chosen)
    }

    /// Freezes the time.
    ///
    /// # Errors
    /// The field `freeze` with a value that is not finite.
    pub fn freeze(&mut self, time: f64) -> Result<(), Error> {
        let time = finite(&["freeze"], "t", time)?;
        self.model.freeze(time);
        self.stored.frozen_time = Some(time);
        Ok(())
    }

    /// Takes the model as its branches are followed, with what switches on the one parameter that varies; what to say of that.
    pub fn prepare_for_continuation(&mut self, varying: Option<usize>) -> Option<String> {
        let (model, change) = self.model.for_continuation(&self.parameters, varying)?;
        self.model = model;
        change.map(|change| {
            format!(
                "the guards against 0/0 in the model are left out where branches are followed: the quotients are smooth, and differ from \
                 what the guards give by a part of {} at most",
                significant(change, 2)
            )
        })
    }

    /// The field that is continued: that of the model with the totals that it conserves at their values in the state, while the
    /// parameters with the indices `varying` vary.
    pub fn field(&self, varying: &[usize]) -> WithTotals<'_, Model> {
        WithTotals::at(&self.model, &self.start, &self.parameters, varying)
    }

    /// The same for cycles: where the state jumps at events totals do, too.
    pub fn field_of_cycles(&self, varying: &[usize]) -> WithTotals<'_, Model> {
        if self.model.global_events().is_empty() {
            self.field(varying)
        } else {
            WithTotals::none(&self.model)
        }
    }

    /// Sets parameters.
    ///
    /// # Errors
    /// The field `set` with an unknown name or a value that is not finite.
    pub fn set(&mut self, values: &NamedNumbers) -> Result<(), Error> {
        for (name, value) in &values.0 {
            let index = self.parameter(&["set"], name)?;
            self.parameters[index] = finite(&["set"], name, *value)?;
        }
        Ok(())
    }

    /// The states with these names and values.
    ///
    /// # Errors
    /// The field `start` with an unknown name or a value that is not finite.
    pub fn states(&self, values: &NamedNumbers) -> Result<Vec<(usize, f64)>, Error> {
        let state = |(name, value): &(String, f64)| {
            let index = self.model.state_index(name);
            let index = index.ok_or_else(|| unknown(&["start"], name, "state", self.model.states()))?;
            Ok((index, finite(&["start"], name, *value)?))
        };
        values.0.iter().map(state).collect()
    }

    /// The parameters and states of one of the model's named sets, by index.
    ///
    /// # Errors
    /// The field `named_set` where there is no such set.
    pub fn named_set(&self, name: &str) -> Result<&arclength_ode::NamedSet, Error> {
        self.model.set(name).ok_or_else(|| {
            let names: Vec<String> = self.model.sets().iter().map(|set| set.name.clone()).collect();
            unknown(&["named_set"], name, "named set", &names)
        })
    }

    /// The interval along which something is followed: what is asked for, or the model's `parmin` and `parmax`, or without these its
    /// `autoxmin` and `autoxmax`.
    ///
    /// # Errors
    /// The field `along` where neither says.
    pub fn interval(&self, along: &Along) -> Result<Interval, Error> {
        let key = match along {
            Along::Interval(interval) => return Ok(interval.clone()),
            Along::Parameter { key } => key,
        };
        let options = self.model.options();
        let pairs = [(options.parmin, options.parmax), (options.autoxmin, options.autoxmax)];
        let ends = pairs.into_iter().find_map(|(low, high)| low.zip(high)).filter(|(low, high)| low != high);
        let (low, high) = ends.ok_or_else(|| {
            let problem = "the model does not say from where to where: it has no @ parmin and parmax";
            Error::invalid(&["along"], key.as_str(), problem, format!("{key}=A:B"))
        })?;
        Ok(Interval::new(key, low, high))
    }

    /// Index of the parameter along which something is followed; `fields` is where it was given.
    ///
    /// # Errors
    /// An unknown name; an infinite interval; a field that depends on the time, which has neither equilibria nor cycles of
    /// its own.
    pub fn along(&self, fields: &'static [&'static str], interval: &Interval) -> Result<usize, Error> {
        if let Some(place) = self.model.time_dependence() {
            return Err(Error::TimeDependent { model: self.stored.name.clone(), snippet: place.snippet() });
        }
        let index = self.parameter(fields, &interval.key)?;
        self.check_parameters()?;
        if interval.start.is_finite() && interval.end.is_finite() {
            return Ok(index);
        }
        Err(Error::invalid(fields, interval.to_string(), "the interval is infinite", "two finite ends"))
    }

    /// That all parameters are finite, as equilibria and cycles need them.
    fn check_parameters(&self) -> Result<(), Error> {
        let Some(index) = self.parameters.iter().position(|value| !value.is_finite()) else { return Ok(()) };
        let (name, value) = (&self.model.parameters()[index], self.parameters[index]);
        let is_default = self.model.default_parameters().get(index) == Some(&value);
        let origin = match self.model.parameter_place(index).filter(|_| is_default) {
            Some(place) => format!("the model has it in line {}", place.line),
            None => "a named set or a result file has it".to_owned(),
        };
        let problem = format!("not a finite number, and {origin}");
        Err(Error::invalid(&["set"], format!("{name}={value}"), problem, "a finite number"))
    }

    /// That the interval contains the value of the parameter where a computation starts.
    ///
    /// # Errors
    /// It does not.
    pub fn starts_within(
        &self,
        fields: &'static [&'static str],
        interval: &Interval,
        label: &str,
    ) -> Result<(), Error> {
        let key = &interval.key;
        let value = self.model.parameter_index(key).and_then(|index| self.parameters.get(index));
        match value {
            Some(value) if !interval.contains_nearly(*value) => Err(Error::invalid(
                fields,
                interval.to_string(),
                format!("{label} is outside the interval, {key} = {} there", readable(*value)),
                format!("an interval that contains {}", readable(*value)),
            )),
            _ => Ok(()),
        }
    }

    /// Names of the auxiliary quantities as columns: one that a state, the time or an earlier one has is told by `aux_`.
    pub fn auxiliary_names(&self) -> Vec<String> {
        let mut taken: Vec<String> = self.model.states().to_vec();
        taken.push("t".to_owned());
        let states = taken.len();
        for name in self.model.auxiliary_names() {
            let mut name = name.clone();
            while taken.iter().any(|other| other.eq_ignore_ascii_case(&name)) {
                name.insert_str(0, "aux_");
            }
            taken.push(name);
        }
        taken.split_off(states)
    }

    /// The auxiliary quantities at a state, in the order of their names; not a number where they have no value.
    pub fn auxiliary(&self, time: f64, state: &[f64], parameters: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.model.auxiliary_names().len()];
        self.model.evaluate_auxiliary(time, state, parameters, &mut values);
        values
    }

    fn parameter(&self, fields: &'static [&'static str], key: &str) -> Result<usize, Error> {
        let index = self.model.parameter_index(key);
        index.ok_or_else(|| unknown(fields, key, "parameter", self.model.parameters()))
    }

    /// A state by name.
    pub fn named_state(&self, state: &[f64]) -> NamedNumbers {
        NamedNumbers(self.model.states().iter().cloned().zip(state.iter().copied()).collect())
    }

    /// The parameters by name, without those that vary.
    pub fn named_parameters(&self, varying: &[usize]) -> NamedNumbers {
        let named = self.model.parameters().iter().cloned().zip(self.parameters.iter().copied());
        let fixed = named.enumerate().filter(|(index, _)| !varying.contains(index));
        NamedNumbers(fixed.map(|(_, entry)| entry).collect())
    }
}

fn finite(fields: &'static [&'static str], key: &str, value: f64) -> Result<f64, Error> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(Error::invalid(fields, format!("{key}={value}"), "not a finite number", "a finite number"))
}

fn unknown(fields: &'static [&'static str], key: &str, what: &str, names: &[String]) -> Error {
    let allowed = if names.is_empty() { "none, there is no such thing".to_owned() } else { names.join(", ") };
    let alike = |name: &&String| strsim::jaro_winkler(&name.to_lowercase(), &key.to_lowercase());
    let nearest = names.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
    let guess = nearest.map_or(String::new(), |name| format!("; the nearest is `{name}`"));
    Error::invalid(fields, key, format!("the model has no such {what}{guess}"), allowed)
}
