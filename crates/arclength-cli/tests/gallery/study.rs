//! A model of the gallery with the branches that were computed of it.

use crate::gallery;
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::{CycleBranch, CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::{Equilibria, EquilibriumBranch, equilibrium_settings};
use arclength::integration::{Integrator, autonomous};
use arclength::locus::{
    CodimensionTwoPoint, CycleLocus, CycleLocusBranch, EquilibriumLocus, EquilibriumLocusBranch,
};
use arclength_analysis::cycles::CyclesResult;
use arclength_analysis::diagram::diagram;
use arclength_analysis::equilibria::EquilibriaResult;
use arclength_analysis::locus::{CycleLocusResult, EquilibriumLocusResult};
use arclength_analysis::{ChosenModel, Interval, Origin, ResultFile, StoredModel};
use arclength_ode::Model;
use kingpin_figure::Figure;

/// Steps so short that polygons look like curves.
const FINE: f64 = 0.015;

/// A model and what is known of it.
pub(crate) struct Study {
    pub chosen: ChosenModel,
    branches: Vec<ResultFile>,
    curves: Vec<ResultFile>,
}

impl Study {
    /// Opens a model with some parameters set.
    pub(crate) fn open(name: &str, set: &[(&str, f64)]) -> Self {
        let source = std::fs::read_to_string(gallery().join(format!("models/{name}.ode"))).unwrap();
        let model = Model::parse(&source).unwrap_or_else(|error| panic!("{name}: {}", error.snippet()));
        assert!(model.warnings().is_empty(), "{:?}", model.warnings());
        let stored = StoredModel { name: format!("{name}.ode"), source, frozen_time: None };
        let mut chosen = ChosenModel::new(stored, model);
        for (key, value) in set {
            let index = chosen.model.parameter_index(key).expect("a parameter");
            chosen.parameters[index] = *value;
        }
        chosen.start = chosen.model.initial_state(&chosen.parameters);
        Self { chosen, branches: Vec::new(), curves: Vec::new() }
    }

    /// The same model with another parameter and nothing computed yet.
    pub(crate) fn with(&self, key: &str, value: f64) -> Self {
        let mut chosen = self.chosen.clone();
        let index = chosen.model.parameter_index(key).expect("a parameter");
        chosen.parameters[index] = value;
        chosen.start = chosen.model.initial_state(&chosen.parameters);
        Self { chosen, branches: Vec::new(), curves: Vec::new() }
    }

    /// With another initial state.
    pub(crate) fn starting_at(mut self, state: &[f64]) -> Self {
        self.chosen.start = state.to_vec();
        self
    }

    fn keep(&mut self, along: &Interval, branch: &EquilibriumBranch) {
        let report = EquilibriaResult::new(&self.chosen, along, Origin::initial_state(), &[], branch);
        self.branches.push(ResultFile::Equilibria(report));
    }

    /// Equilibria from the initial state.
    pub(crate) fn equilibria(&mut self, along: &str) -> EquilibriumBranch {
        let range: Interval = along.parse().unwrap();
        let branch = Equilibria::of(&self.chosen.model)
            .start(&self.chosen.start)
            .parameters(&self.chosen.parameters)
            .along(&range.key, range.start..=range.end)
            .run()
            .unwrap();
        self.keep(&range, &branch);
        branch
    }

    /// The other branch through a branch point.
    pub(crate) fn other_branch(
        &mut self,
        branch: &EquilibriumBranch,
        number: usize,
        along: &str,
    ) -> EquilibriumBranch {
        let range: Interval = along.parse().unwrap();
        let point = branch.branch_points().nth(number).expect("a branch point");
        let branch =
            point.other(&self.chosen.model).along(&range.key, range.start..=range.end).run().unwrap();
        self.keep(&range, &branch);
        branch
    }

    /// Cycles from a Hopf point of a branch.
    pub(crate) fn cycles_from(
        &mut self,
        branch: &EquilibriumBranch,
        hopf: usize,
        along: &str,
        at: &[f64],
    ) -> CycleBranch {
        let hopf = branch.hopf_points().nth(hopf).expect("a Hopf point");
        self.cycles(CycleStart::from(hopf), &hopf.parameters, along, at)
    }

    /// Cycles from any start.
    pub(crate) fn cycles(
        &mut self,
        start: CycleStart,
        parameters: &[f64],
        along: &str,
        at: &[f64],
    ) -> CycleBranch {
        let range: Interval = along.parse().unwrap();
        let active = self.chosen.model.parameter_index(&range.key).expect("a parameter");
        let branch = Cycles::of(&self.chosen.model, start)
            .parameters(parameters)
            .along(&range.key, range.start..=range.end)
            .at(at)
            .settings(Settings::default().largest_parameter_change(FINE))
            .run()
            .unwrap();
        let report =
            CyclesResult::new(&self.chosen, (active, &range), Origin::initial_state(), &[], branch.clone());
        self.branches.push(ResultFile::Cycles(report));
        branch
    }

    /// The doubled cycles that leave at a period doubling.
    pub(crate) fn doubled_from(&mut self, cycle: &CyclePoint, along: &str, at: &[f64]) -> CycleBranch {
        let branching = cycle.branching.clone().expect("a bifurcation");
        assert!(branching.doubled);
        self.cycles(CycleStart::Branching(branching), &cycle.parameters, along, at)
    }

    /// A curve of special cycles in two parameters, from one that was found along the first of them.
    pub(crate) fn cycle_locus(
        &mut self,
        kind: SpecialKind,
        cycle: &CyclePoint,
        plane: [&str; 2],
    ) -> CycleLocusBranch {
        let [first, second] = plane.map(|range| range.parse::<Interval>().unwrap());
        let run = || {
            CycleLocus::of(&self.chosen.model)
                .from_cycle(kind, &cycle.orbit, &cycle.parameters)
                .along(&first.key, first.start..=first.end)
                .and(&second.key, second.start..=second.end)
                .settings(Settings::default().largest_parameter_change(FINE))
                .run()
                .unwrap()
        };
        let branch = run();
        let report =
            CycleLocusResult::new(&self.chosen, [&first, &second], Origin::initial_state(), &[], run());
        self.curves.push(ResultFile::CycleLocus(report));
        branch
    }

    /// The cycle on which the motion settles from the initial state.
    pub(crate) fn settled(&self, duration: f64, longest_period: f64) -> Orbit {
        let (model, parameters) = (&self.chosen.model, &self.chosen.parameters);
        let field = autonomous(model, parameters);
        let end =
            Integrator::with_tolerance(1e-10).integrate(field, 0.0, &self.chosen.start, duration).unwrap();
        Orbit::from_time_history(model, parameters, &end.state, longest_period).unwrap()
    }

    /// A curve of special equilibria in two parameters.
    pub(crate) fn locus(
        &mut self,
        start: impl FnOnce(EquilibriumLocus<'_>) -> EquilibriumLocus<'_>,
        plane: [&str; 2],
    ) -> EquilibriumLocusBranch {
        let [first, second] = plane.map(|range| range.parse::<Interval>().unwrap());
        let branch = start(EquilibriumLocus::of(&self.chosen.model))
            .along(&first.key, first.start..=first.end)
            .and(&second.key, second.start..=second.end)
            .settings(equilibrium_settings().largest_parameter_change(FINE))
            .run()
            .unwrap();
        let report = EquilibriumLocusResult::new(
            &self.chosen,
            [&first, &second],
            Origin::initial_state(),
            &[],
            &branch,
        );
        self.curves.push(ResultFile::Locus(report));
        branch
    }

    /// The bifurcation diagram of all branches.
    pub(crate) fn diagram(&self) -> Figure {
        diagram(&self.branches).expect("branches over one parameter")
    }

    /// The curves in the plane of two parameters.
    pub(crate) fn plane(&self) -> Figure {
        diagram(&self.curves).expect("curves in one plane")
    }
}

/// The special cycles of a kind, in the order of the branch.
pub(crate) fn special(branch: &CycleBranch, wanted: impl Fn(SpecialKind) -> bool) -> Vec<&CyclePoint> {
    branch.special().filter(|(special, _)| wanted(*special)).map(|(_, point)| point).collect()
}

/// The cycle at a value that was asked for.
pub(crate) fn at(branch: &CycleBranch, value: f64) -> &CyclePoint {
    branch.points.iter().find(|point| point.value == value).expect("asked for")
}

/// The point of codimension two of a kind.
pub(crate) fn codimension_two(
    branch: &EquilibriumLocusBranch,
    kind: SpecialKind,
    number: usize,
) -> &CodimensionTwoPoint {
    branch.special_points().filter(|point| point.kind == kind).nth(number).expect("such a point")
}

/// A coefficient of a normal form by name.
pub(crate) fn coefficient(point: &CodimensionTwoPoint, name: &str) -> f64 {
    point.coefficients.iter().find(|(candidate, _)| candidate == name).expect("the coefficient").1
}
