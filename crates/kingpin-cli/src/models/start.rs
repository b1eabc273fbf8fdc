//! Labelled points of earlier results from which computations start, checked to be what they claim.

use super::branch::StoredModel;
use super::model::ChosenModel;
use super::result_file::ResultFile;
use super::simulate::HistoryReport;
use crate::document::NamedNumbers;
use crate::failure::Failure;
use crate::stored::PointReference;
use arclength::cycle::{Branching, Orbit};
use arclength::equilibrium::SpecialPoint;

/// A labelled point with its model.
#[derive(Clone, Debug)]
pub struct LabelledPoint {
    /// Its label.
    pub label: String,
    /// The model with the parameters and a state there.
    pub chosen: ChosenModel,
    /// What it is.
    pub what: What,
}

/// What a labelled point is.
#[derive(Clone, Debug)]
pub enum What {
    /// An equilibrium, special or not.
    Equilibrium(Option<SpecialPoint>),
    /// A cycle.
    Cycle {
        /// The cycle itself.
        orbit: Orbit,
        /// The start of the branch that leaves there, with the parameter along which it was found.
        branching: Option<(Branching, String)>,
    },
    /// The end of a time history.
    Motion {
        /// How long it lasted.
        duration: f64,
    },
}

/// Reads a labelled point from its file.
///
/// # Errors
/// [`Failure::ResultFile`]: no such file, no such label, or a point that does not fit its model.
pub fn read(reference: &PointReference) -> Result<LabelledPoint, Failure> {
    let file = ResultFile::read(&reference.path).map_err(|problem| reference.failure(problem))?;
    let labels = file.labels();
    let missing = || reference.no_such_label(&labels);
    let is_wanted = |label: &Option<String>| label.as_ref() == Some(&reference.label);
    let at = |fixed: &NamedNumbers, varying: &[(&str, f64)]| -> Vec<(String, f64)> {
        let varying = varying.iter().map(|(name, value)| ((*name).to_owned(), *value));
        fixed.0.iter().cloned().chain(varying).collect()
    };
    match file {
        ResultFile::Equilibria(report) => {
            let point = report.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
            let parameters = at(&report.parameters, &[(&report.along.key, point.value)]);
            let chosen = choose(reference, report.model, &parameters, Some(&point.state))?;
            if let Some(special) = &point.special {
                check(special, &chosen).map_err(|problem| reference.failure(problem))?;
            }
            let what = What::Equilibrium(point.special.clone());
            Ok(LabelledPoint { label: reference.label.clone(), chosen, what })
        }
        ResultFile::Locus(report) => {
            let point = report.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
            let [one, two] = report.keys();
            let parameters = at(&report.parameters, &[(one, point.values[0]), (two, point.values[1])]);
            let chosen = choose(reference, report.model.clone(), &parameters, Some(&point.state))?;
            Ok(LabelledPoint { label: reference.label.clone(), chosen, what: What::Equilibrium(None) })
        }
        ResultFile::Cycles(report) => {
            let point = report.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
            let parameters = at(&report.parameters, &[(&report.along.key, point.value)]);
            let mut chosen = choose(reference, report.model.clone(), &parameters, None)?;
            let orbit = point.orbit.clone().ok_or_else(|| {
                reference.failure(format!("{} is stored without its orbit", reference.label))
            })?;
            reference.check(&orbit, chosen.model.states().len())?;
            chosen.start = orbit.state_at(0.0);
            let branching = point.branching.clone();
            if let Some(branching) = &branching {
                branching.check(chosen.model.states().len())?;
            }
            let branching = branching.map(|branching| (branching, report.along.key.clone()));
            Ok(LabelledPoint {
                label: reference.label.clone(),
                chosen,
                what: What::Cycle { orbit, branching },
            })
        }
        ResultFile::CycleLocus(report) => {
            let point = report.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
            let [one, two] = report.keys();
            let parameters = at(&report.parameters, &[(one, point.values[0]), (two, point.values[1])]);
            let mut chosen = choose(reference, report.model.clone(), &parameters, None)?;
            let orbit = point.orbit.clone().ok_or_else(|| {
                reference.failure(format!("{} is stored without its orbit", reference.label))
            })?;
            reference.check(&orbit, chosen.model.states().len())?;
            chosen.start = orbit.state_at(0.0);
            let what = What::Cycle { orbit, branching: None };
            Ok(LabelledPoint { label: reference.label.clone(), chosen, what })
        }
        ResultFile::History(report) => {
            if reference.label != HistoryReport::END {
                return Err(missing());
            }
            let (duration, state) = report.end();
            let chosen = choose(reference, report.model, &report.parameters.0, Some(&state))?;
            Ok(LabelledPoint { label: reference.label.clone(), chosen, what: What::Motion { duration } })
        }
    }
}

/// The model of a result file with parameters and a state.
fn choose(
    reference: &PointReference,
    stored: StoredModel,
    parameters: &[(String, f64)],
    state: Option<&NamedNumbers>,
) -> Result<ChosenModel, Failure> {
    let mut chosen = ChosenModel::stored(&reference.path, stored, parameters)?;
    if let Some(state) = state {
        let value = |name: &String| state.named(name).filter(|value| value.is_finite());
        let values: Option<Vec<f64>> = chosen.model.states().iter().map(value).collect();
        chosen.start = values.ok_or_else(|| {
            reference.failure(format!(
                "{} has no finite value for every state of its model; its states are {}",
                reference.label,
                chosen.model.states().join(", ")
            ))
        })?;
    }
    Ok(chosen)
}

/// That a special point is one of the model: lists of the right lengths, finite numbers.
fn check(special: &SpecialPoint, chosen: &ChosenModel) -> Result<(), String> {
    let states = chosen.model.states().len();
    let parameters = chosen.model.parameters().len();
    let fits = |values: &[f64], length: usize| {
        values.len() == length && values.iter().all(|value| value.is_finite())
    };
    let ok = match special {
        SpecialPoint::Hopf(point) => {
            fits(&point.state, states)
                && fits(&point.parameters, parameters)
                && point.eigenvector.len() == states
                && point.eigenvector.iter().all(|value| value.is_finite())
                && point.frequency.is_finite()
                && point.frequency > 0.0
        }
        SpecialPoint::Fold(point) => {
            fits(&point.state, states)
                && fits(&point.parameters, parameters)
                && fits(&point.null_vector, states)
        }
        SpecialPoint::BranchPoint(point) => {
            fits(&point.state, states)
                && fits(&point.parameters, parameters)
                && fits(&point.null_vector, states)
                && point.tangents.iter().all(|tangent| fits(tangent, states + 1))
        }
        _ => true,
    };
    if ok {
        return Ok(());
    }
    Err(format!("its special point is none of a model with {states} states and {parameters} parameters"))
}
