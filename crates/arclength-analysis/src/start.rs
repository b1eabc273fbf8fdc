//! Labelled points of earlier results from which computations start, checked to be what they claim.

use crate::error::Error;
use crate::files::Files;
use crate::model::ChosenModel;
use crate::point_reference::PointReference;
use crate::result_file::ResultFile;
use crate::simulate::HistoryResult;
use crate::stored_model::StoredModel;
use arclength::cycle::{Branching, Orbit};
use arclength::equilibrium::SpecialPoint;
use kingpin_report::NamedNumbers;

/// A labelled point with its model.
#[derive(Clone, Debug)]
pub struct LabelledPoint {
    /// Its label.
    pub label: String,
    /// The model with the parameters and a state there.
    pub chosen: ChosenModel,
    /// What it is.
    pub solution: LabelledSolution,
}

/// What a labelled point is.
#[derive(Clone, Debug)]
pub enum LabelledSolution {
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
        /// The time at which it ended.
        end: f64,
    },
}

impl LabelledPoint {
    /// Reads a labelled point from its file, which is one of `files`.
    ///
    /// # Errors
    /// [`Error::ResultFile`]: no such file, no such label, or a point that does not fit its model.
    pub fn read(reference: &PointReference, files: &dyn Files) -> Result<Self, Error> {
        let file =
            ResultFile::read_among(files, &reference.path).map_err(|problem| reference.failure(problem))?;
        let labels = file.labels();
        let missing = || reference.no_such_label(&labels);
        let is_wanted = |label: &Option<String>| label.as_ref() == Some(&reference.label);
        match file {
            ResultFile::Equilibria(result) => {
                let point = result.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
                let parameters = at(&result.parameters, &[(&result.along.key, point.value)]);
                let chosen = choose(reference, result.model, &parameters, Some(&point.state))?;
                if let Some(special) = &point.special {
                    check(special, &chosen).map_err(|problem| reference.failure(problem))?;
                }
                Ok(Self::new(reference, chosen, LabelledSolution::Equilibrium(point.special.clone())))
            }
            ResultFile::Locus(result) => {
                let point =
                    result.curve.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
                let [one, two] = result.curve.keys();
                let parameters = at(&result.parameters, &[(one, point.values[0]), (two, point.values[1])]);
                let chosen = choose(reference, result.model.clone(), &parameters, Some(&point.state))?;
                Ok(Self::new(reference, chosen, LabelledSolution::Equilibrium(None)))
            }
            ResultFile::Cycles(result) => {
                let point = result.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
                let parameters = at(&result.parameters, &[(&result.along.key, point.value)]);
                let chosen = choose(reference, result.model.clone(), &parameters, None)?;
                let branching = point.branching.clone();
                if let Some(branching) = &branching {
                    branching.check(chosen.model.states().len())?;
                }
                let branching = branching.map(|branching| (branching, result.along.key.clone()));
                Self::cycle(reference, chosen, point.orbit.as_ref(), branching)
            }
            ResultFile::CycleLocus(result) => {
                let point =
                    result.curve.points.iter().find(|point| is_wanted(&point.label)).ok_or_else(missing)?;
                let [one, two] = result.curve.keys();
                let parameters = at(&result.parameters, &[(one, point.values[0]), (two, point.values[1])]);
                let chosen = choose(reference, result.model.clone(), &parameters, None)?;
                Self::cycle(reference, chosen, point.orbit.as_ref(), None)
            }
            ResultFile::History(result) => {
                if reference.label != HistoryResult::END {
                    return Err(missing());
                }
                let (duration, state) = result.end();
                let end = result.t.last().copied().unwrap_or(0.0);
                let chosen = choose(reference, result.model, &result.parameters.0, Some(&state))?;
                Ok(Self::new(reference, chosen, LabelledSolution::Motion { duration, end }))
            }
        }
    }

    fn new(reference: &PointReference, chosen: ChosenModel, solution: LabelledSolution) -> Self {
        Self { label: reference.label.clone(), chosen, solution }
    }

    fn cycle(
        reference: &PointReference,
        mut chosen: ChosenModel,
        orbit: Option<&Orbit>,
        branching: Option<(Branching, String)>,
    ) -> Result<Self, Error> {
        let orbit = orbit
            .cloned()
            .ok_or_else(|| reference.failure(format!("{} is stored without its orbit", reference.label)))?;
        reference.check(&orbit, chosen.model.states().len())?;
        chosen.start = orbit.state_at(0.0);
        Ok(Self::new(reference, chosen, LabelledSolution::Cycle { orbit, branching }))
    }
}

/// All parameters at a point: those that are fixed and those that vary.
fn at(fixed: &NamedNumbers, varying: &[(&str, f64)]) -> Vec<(String, f64)> {
    let varying = varying.iter().map(|(name, value)| ((*name).to_owned(), *value));
    fixed.0.iter().cloned().chain(varying).collect()
}

/// The model of a result file with parameters and a state.
fn choose(
    reference: &PointReference,
    stored: StoredModel,
    parameters: &[(String, f64)],
    state: Option<&NamedNumbers>,
) -> Result<ChosenModel, Error> {
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
