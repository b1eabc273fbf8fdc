//! What a branch of equilibria is asked for by, and how it is computed.

use super::result::{ConservedResult, EquilibriaResult};
use crate::branch::Origin;
use crate::error::Error;
use crate::files::{Disk, Files};
use crate::found_point::FoundPoint;
use crate::interval::{Along, Interval};
use crate::model::ChosenModel;
use crate::model_request::{ModelRequest, OpenedModel};
use crate::monitor::Monitored;
use crate::start::{LabelledPoint, LabelledSolution};
use crate::steps::Steps;
use crate::vocabulary::Vocabulary;
use arclength::branch::Monitor;
use arclength::control::Control;
use arclength::equilibrium::{BranchPoint, Equilibria, EquilibriumPoint, SpecialPoint, equilibrium_settings};
use arclength_ode::Quantity;
use kingpin_report::numbers::{readable, significant};
use serde::{Deserialize, Serialize};

/// A branch of equilibria along a parameter.
///
/// It starts at the equilibrium near the initial state of the model, or at a labelled point of an earlier result: from a branch
/// point the other branch is followed, from any other point the branch through it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriaRequest {
    /// The model, or the labelled point.
    pub model: ModelRequest,
    /// Parameter and its interval.
    pub along: Along,
    /// Values of the parameter at which equilibria are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// What is recorded along the branch.
    #[serde(default)]
    pub monitors: Vec<Monitored>,
    /// How steps are taken.
    #[serde(flatten)]
    pub steps: Steps,
}

/// A request that makes sense, with its model.
#[derive(Clone, Debug)]
pub struct EquilibriaAnalysis {
    chosen: ChosenModel,
    point: Option<LabelledPoint>,
    warnings: Vec<String>,
    /// Whether the model is as it was where the point was found.
    unchanged: bool,
    /// Name of the parameter as the model writes it.
    name: String,
    along: Interval,
    at: Vec<f64>,
    monitors: Vec<(Monitored, Quantity)>,
    active: usize,
    steps: Steps,
}

impl EquilibriaRequest {
    /// A request with the default of everything else.
    pub fn new(model: ModelRequest, along: impl Into<Along>) -> Self {
        Self { model, along: along.into(), at: Vec::new(), monitors: Vec::new(), steps: Steps::default() }
    }

    /// Reads the model and checks every field.
    ///
    /// # Errors
    /// What is wrong with the model or a field.
    pub fn validate(&self) -> Result<EquilibriaAnalysis, Error> {
        self.validate_among(&Disk)
    }

    /// The same with other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`validate`](Self::validate).
    pub fn validate_among(&self, files: &dyn Files) -> Result<EquilibriaAnalysis, Error> {
        self.steps.check()?;
        let OpenedModel { mut chosen, point, mut warnings } = self.model.open_among(files)?;
        warnings.extend(slowness(chosen.model.states().len()));
        let along = chosen.interval(&self.along)?;
        let active = chosen.along(&["along"], &along)?;
        warnings.extend(chosen.prepare_for_continuation(Some(active)));
        along.check_values(&self.at)?;
        if let Some(point) = &point {
            chosen.starts_within(&["along"], &along, &point.label)?;
        }
        let monitors = self
            .monitors
            .iter()
            .map(|asked| Ok((asked.clone(), asked.on_equilibria(&Vocabulary::of(&chosen.model))?)));
        Ok(EquilibriaAnalysis {
            monitors: monitors.collect::<Result<_, Error>>()?,
            active,
            name: chosen.model.parameters()[active].clone(),
            chosen,
            point,
            warnings,
            unchanged: !self.model.changes_anything(),
            along,
            at: self.at.clone(),
            steps: self.steps,
        })
    }
}

/// Numbers of states from which on a step takes a time worth telling before, and seconds for the cube of their number (eigenvalues,
/// on a processor of today).
const MANY_STATES: usize = 200;
const SECONDS: f64 = 1e-8;

/// What a model of so many states will take, where that is long.
fn slowness(states: usize) -> Option<String> {
    (states >= MANY_STATES).then(|| {
        let seconds = significant(SECONDS * (states as f64).powi(3), 1);
        format!("{states} states: a step takes about {seconds} s, most of it for eigenvalues (Ctrl-C keeps the branch up to there)")
    })
}

impl EquilibriaAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Follows the branch. Where the control stops it the result is the branch up to there.
    ///
    /// # Errors
    /// [`Error::Continuation`].
    pub fn run(&self, control: &Control<'_>) -> Result<EquilibriaResult, Error> {
        self.run_watched(control, &mut |_| {})
    }

    /// The same under the eyes of somebody who is told every point as it is found, in the order in which they are found.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_watched(
        &self,
        control: &Control<'_>,
        watcher: &mut dyn FnMut(FoundPoint<'_>),
    ) -> Result<EquilibriaResult, Error> {
        let (branch_point, mut origin) = match &self.point {
            Some(point) => {
                (self.branch_point(point), Origin::labelled(&point.label, "the branch through it"))
            }
            None => (None, Origin::initial_state()),
        };
        let chosen = &self.chosen;
        let field = chosen.field(&[self.active]);
        let name = &self.name;
        let mut equilibria = Equilibria::of(&field)
            .start(&chosen.start)
            .parameters(&chosen.parameters)
            .along(name, self.along.start..=self.along.end);
        if self.point.is_none() {
            let (sought, by) = equilibria.seek()?;
            (equilibria, origin) = (sought, Origin::sought(by));
        }
        let exact =
            matches!(&self.point, Some(point) if matches!(point.solution, LabelledSolution::Equilibrium(_)));
        let equilibria = match branch_point {
            Some(point) => equilibria.from_branch_point(point),
            None if exact && self.unchanged => equilibria.through(&chosen.start),
            None => equilibria,
        };
        let monitors = self.monitors.iter().map(|(asked, quantity)| {
            let value = |point: &EquilibriumPoint| {
                let mut parameters = chosen.parameters.clone();
                parameters[self.active] = point.value;
                Some(quantity.value(&point.state, &parameters, &[]))
            };
            Monitor::new(&asked.expression, value).at(&asked.at).until(&asked.until)
        });
        let mut branch = monitors
            .fold(equilibria, Equilibria::monitor)
            .at(&self.at)
            .settings(self.steps.settings(equilibrium_settings()))
            .observer(|point| {
                control.at(&format!("equilibria, {name} = {}", readable(point.value)));
                watcher(FoundPoint {
                    values: &[point.value],
                    max: &point.state,
                    min: &point.state,
                    stable: point.stability.is_stable(),
                    label: point.label,
                    orbit: None,
                });
                control.flow()
            })
            .run()?;
        // Whether branches cross there along this parameter too shows when they are followed.
        let start = branch.points.get(branch.start).and_then(|point| point.special.as_deref());
        if let (Some(point), Some(_), Some(SpecialPoint::BranchPoint(_))) = (&self.point, branch_point, start)
        {
            origin = Origin::labelled(&point.label, "the other branch through it");
        }
        branch.points.iter_mut().for_each(|point| field.restore_eigenvalues(&mut point.eigenvalues));
        let totals = field.totals().iter().map(|total| ConservedResult {
            total: total.text(chosen.model.states()),
            value: total.value(&chosen.start),
        });
        let result = EquilibriaResult::new(chosen, &self.along, origin, &self.names(), &branch);
        Ok(EquilibriaResult { conserved: totals.collect(), ..result })
    }

    fn names(&self) -> Vec<String> {
        self.monitors.iter().map(|(asked, _)| asked.expression.clone()).collect()
    }

    /// The branch point whose other branch is followed.
    fn branch_point<'a>(&self, point: &'a LabelledPoint) -> Option<&'a BranchPoint> {
        match &point.solution {
            LabelledSolution::Equilibrium(Some(SpecialPoint::BranchPoint(known))) if self.unchanged => {
                Some(known)
            }
            _ => None,
        }
    }
}
