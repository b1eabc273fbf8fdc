//! A limit cycle in a result, of any model.

use crate::branch::{certain_digits, pairs, tests};
use crate::model::ChosenModel;
use crate::monitor::named;
use crate::normal_form;
use arclength::cycle::{Branching, CyclePoint, Orbit};
use kingpin_report::NamedNumbers;
use serde::{Deserialize, Serialize};

/// What becomes of quantities along a cycle, by name, where they have a value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AlongCycle {
    /// Largest values.
    pub max: NamedNumbers,
    /// Smallest values.
    pub min: NamedNumbers,
    /// Means over the period.
    pub mean: NamedNumbers,
}

impl AlongCycle {
    /// Whether there are no quantities.
    pub fn is_empty(&self) -> bool {
        self.max.is_empty() && self.min.is_empty() && self.mean.is_empty()
    }

    /// The auxiliary quantities of a model along a cycle at these parameters.
    pub fn auxiliary(chosen: &ChosenModel, point: &CyclePoint, parameters: &[f64]) -> Self {
        let names = chosen.auxiliary_names();
        let time = chosen.stored.frozen_time.unwrap_or(f64::NAN);
        let quantity = |index: usize| move |state: &[f64]| chosen.auxiliary(time, state, parameters)[index];
        let all =
            |taken: &dyn Fn(usize) -> f64| named(&names, &(0..names.len()).map(taken).collect::<Vec<f64>>());
        let orbit = &point.orbit;
        if orbit.mesh.len() < 2 {
            // A Hopf point: the cycle is an equilibrium.
            let here = all(&|index| quantity(index)(&point.max));
            return Self { max: here.clone(), min: here.clone(), mean: here };
        }
        Self {
            max: all(&|index| orbit.maximum(quantity(index))),
            min: all(&|index| orbit.minimum(quantity(index))),
            mean: all(&|index| orbit.mean(quantity(index))),
        }
    }
}

/// A cycle in a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CycleResult {
    /// Value of the parameter.
    #[serde(with = "kingpin_report::number")]
    pub value: f64,
    /// Period.
    pub period: f64,
    /// Largest value of every state.
    pub max: NamedNumbers,
    /// Smallest value of every state.
    pub min: NamedNumbers,
    /// The auxiliary quantities of the model along the cycle.
    #[serde(default, skip_serializing_if = "AlongCycle::is_empty")]
    pub aux: AlongCycle,
    /// Floquet multipliers, the largest modulus first.
    pub multipliers: Vec<[Option<f64>; 2]>,
    /// Relative errors of the multipliers, measured on two meshes at cycles that were asked for and at the ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub multiplier_errors: Vec<Option<f64>>,
    /// How far the computed trivial multiplier is from 1.
    pub trivial_multiplier_error: f64,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Whether it is one of a family at one parameter value, as conserved quantities make them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub neutral: bool,
    /// Error of period and extremes, relative to the period and to the amplitudes.
    pub error_estimate: f64,
    /// Error of the parameter value of a special cycle that comes of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_error: Option<f64>,
    /// Mesh intervals; none at a Hopf point.
    #[serde(default)]
    pub intervals: usize,
    /// Of special points, of values asked for, of the ends.
    pub label: Option<String>,
    /// Test functions by the label of the cycle at which each changes its sign.
    #[serde(default)]
    pub tests: NamedNumbers,
    /// What was monitored, where it exists.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub monitors: NamedNumbers,
    /// The normal form of a special cycle, by name.
    #[serde(default, skip_serializing_if = "NamedNumbers::is_empty")]
    pub normal_form: NamedNumbers,
    /// The cycle itself, where a computation can start from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orbit: Option<Orbit>,
    /// The start of the branch that leaves there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub branching: Option<Branching>,
}

impl CycleResult {
    /// A cycle of a branch; `named` gives a state by name.
    pub fn new(point: CyclePoint, label: Option<String>, named: impl Fn(&[f64]) -> NamedNumbers) -> Self {
        let finite = point.normal_form.iter().filter(|(_, value)| value.is_finite());
        let normal_form = NamedNumbers(finite.map(|(name, value)| ((*name).to_owned(), *value)).collect());
        Self {
            value: point.value,
            period: point.period,
            max: named(&point.max),
            min: named(&point.min),
            aux: AlongCycle::default(),
            multipliers: pairs(&point.multipliers),
            // One without a finite error keeps its place.
            multiplier_errors: point
                .multiplier_errors
                .iter()
                .map(|error| Some(*error).filter(|error| error.is_finite()))
                .collect(),
            trivial_multiplier_error: point.trivial_multiplier_error,
            stable: point.stable,
            neutral: point.neutral,
            error_estimate: point.error_estimate,
            value_error: point.value_error.filter(|error| error.is_finite()),
            intervals: point.orbit.mesh.len().saturating_sub(1),
            tests: tests(point.tests.iter().map(|(name, value)| (name.as_ref(), *value))),
            monitors: NamedNumbers::default(),
            normal_form,
            branching: point.branching,
            orbit: label.as_ref().map(|_| point.orbit),
            label,
        }
    }

    /// Number of digits of the parameter value that hold.
    pub fn certain_digits(&self) -> usize {
        certain_digits(self.value, self.value_error.unwrap_or(0.0))
    }

    /// What its normal form says.
    pub fn remark(&self) -> String {
        normal_form::of_cycle(self.label.as_deref(), &self.normal_form)
    }
}
