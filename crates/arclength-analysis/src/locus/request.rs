//! What a curve of special points is asked for by, and how it is computed.

use super::of_cycles::CycleLocusResult;
use super::of_equilibria::EquilibriumLocusResult;
use super::result::LocusResult;
use crate::branch::Origin;
use crate::error::Error;
use crate::files::{Disk, Files};
use crate::found_point::FoundPoint;
use crate::interval::Interval;
use crate::labels::kind;
use crate::monitor::{CycleMonitor, Monitored};
use crate::point_reference::PointReference;
use crate::start::{LabelledPoint, LabelledSolution};
use crate::steps::{Mesh, Steps};
use crate::vocabulary::Vocabulary;
use arclength::branch::{Monitor, SpecialKind};
use arclength::continuation::Settings;
use arclength::control::Control;
use arclength::cycle::Orbit;
use arclength::equilibrium::{BranchPoint, FoldPoint, HopfPoint, SpecialPoint, equilibrium_settings};
use arclength::locus::{CycleLocus, CycleLocusPoint, EquilibriumLocus, Held, LocusPoint};
use arclength_ode::Quantity;
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A curve of special points in two parameters, with its points of codimension two.
///
/// Folds (LP), Hopf points (HB) and branch points (BP) of equilibria; folds (LPC), period doublings (PD) and torus bifurcations
/// (NS) of cycles. With a quantity to be held, any equilibria or cycles on which it keeps its value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocusRequest {
    /// The labelled point, with its model and parameters.
    pub from: PointReference,
    /// The two parameters and their intervals.
    #[serde(rename = "in")]
    pub plane: [Interval; 2],
    /// Values of the first parameter at which points are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// What keeps its value along a curve of any equilibria or cycles: its first value, or the one where the curve starts.
    #[serde(default)]
    pub hold: Option<Monitored>,
    /// What is recorded along the curve.
    #[serde(default)]
    pub monitors: Vec<Monitored>,
    /// How steps are taken.
    #[serde(flatten)]
    pub steps: Steps,
    /// How finely cycles are resolved.
    #[serde(flatten)]
    pub mesh: Mesh,
}

/// A request that makes sense, with the point at which the curve starts.
#[derive(Clone, Debug)]
pub struct LocusAnalysis {
    point: LabelledPoint,
    start: Start,
    /// Names of the parameters as the model writes them.
    names: [String; 2],
    active: [usize; 2],
    plane: [Interval; 2],
    at: Vec<f64>,
    monitors: Monitors,
    steps: Steps,
    mesh: Mesh,
}

/// What is recorded along the curve; one of the lists is empty.
#[derive(Clone, Debug, Default)]
struct Monitors {
    on_equilibria: Vec<(Monitored, Quantity)>,
    on_cycles: Vec<(Monitored, CycleMonitor)>,
}

/// What the curve consists of, and the point at which it starts.
#[derive(Clone, Debug)]
enum Start {
    Fold(FoldPoint),
    Hopf(HopfPoint),
    BranchPoint(BranchPoint),
    Cycle(SpecialKind, Orbit),
    HeldEquilibrium(Held<[f64]>),
    HeldCycle(Held, Orbit),
}

impl LocusRequest {
    /// A request with the default of everything else.
    pub fn new(from: PointReference, plane: [Interval; 2]) -> Self {
        Self {
            from,
            plane,
            at: Vec::new(),
            hold: None,
            monitors: Vec::new(),
            steps: Steps::default(),
            mesh: Mesh::default(),
        }
    }

    /// Reads the labelled point and checks every field.
    ///
    /// # Errors
    /// What is wrong with the point or a field.
    pub fn validate(&self) -> Result<LocusAnalysis, Error> {
        self.validate_among(&Disk)
    }

    /// The same with other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`validate`](Self::validate).
    pub fn validate_among(&self, files: &dyn Files) -> Result<LocusAnalysis, Error> {
        self.steps.check()?;
        self.mesh.check()?;
        let mut point = LabelledPoint::read(&self.from, files)?;
        // The branch on which the point was found has told of it.
        let _told = point.chosen.prepare_for_continuation(None);
        let chosen = &point.chosen;
        let [first, second] = &self.plane;
        let active = [chosen.along(&["in"], first)?, chosen.along(&["in"], second)?];
        if active[0] == active[1] {
            return Err(Error::invalid(
                &["in"],
                format!("{} twice", first.key),
                "both parameters are the same",
                "two different parameters",
            ));
        }
        for interval in &self.plane {
            chosen.starts_within(&["in"], interval, &point.label)?;
        }
        first.check_values(&self.at)?;
        let held = self.hold.as_ref().map(|asked| self.held(asked, &point)).transpose()?;
        let start = held.or_else(|| Start::at(&point)).ok_or_else(|| {
            self.from.failure(format!(
                "no curve of special points starts at {}; allowed: folds (LP), Hopf points (HB) and branch points (BP) of \
                 equilibria, folds (LPC), period doublings (PD) and torus bifurcations (NS) of cycles",
                point.label
            ))
        })?;
        let is_of_cycles = matches!(start, Start::Cycle(..) | Start::HeldCycle(..));
        let mut monitors = Monitors::default();
        let vocabulary = Vocabulary::of(&chosen.model);
        for asked in &self.monitors {
            if is_of_cycles {
                monitors.on_cycles.push((asked.clone(), asked.on_cycles(&vocabulary)?));
            } else {
                monitors.on_equilibria.push((asked.clone(), asked.on_equilibria(&vocabulary)?));
            }
        }
        Ok(LocusAnalysis {
            monitors,
            active,
            names: active.map(|index| chosen.model.parameters()[index].clone()),
            point,
            start,
            plane: self.plane.clone(),
            at: self.at.clone(),
            steps: self.steps,
            mesh: self.mesh,
        })
    }
}

impl LocusRequest {
    /// The start of a curve on which a quantity keeps its value.
    fn held(&self, asked: &Monitored, point: &LabelledPoint) -> Result<Start, Error> {
        let (name, parameters) = (&asked.expression, &point.chosen.parameters);
        let vocabulary = Vocabulary::of(&point.chosen.model);
        match &point.solution {
            LabelledSolution::Equilibrium(_) => {
                let quantity =
                    asked.on_equilibria(&vocabulary).map_err(|error| error.in_fields(&["hold"]))?;
                let held = Held::of_state(name, move |state, parameters| {
                    Some(quantity.value(state, parameters, &[]))
                });
                let here = held.of(&point.chosen.start, parameters);
                Ok(Start::HeldEquilibrium(held.at(asked.value_to_hold(here, &point.label)?)))
            }
            LabelledSolution::Cycle { orbit, .. } => {
                let monitor = asked.on_cycles(&vocabulary).map_err(|error| error.in_fields(&["hold"]))?;
                let held = Held::new(name, move |orbit, parameters| Some(monitor.value(orbit, parameters)));
                let here = held.of(orbit, parameters);
                let held = held.at(asked.value_to_hold(here, &point.label)?);
                Ok(Start::HeldCycle(held, orbit.clone()))
            }
            LabelledSolution::Motion { .. } => Err(self.from.failure(format!(
                "nothing can be held from {}; allowed: equilibria and cycles, special or not",
                point.label
            ))),
        }
    }
}

impl Start {
    /// The special point at which a curve can start.
    fn at(point: &LabelledPoint) -> Option<Self> {
        match &point.solution {
            LabelledSolution::Equilibrium(Some(SpecialPoint::Fold(fold))) => Some(Self::Fold(fold.clone())),
            LabelledSolution::Equilibrium(Some(SpecialPoint::Hopf(hopf))) => Some(Self::Hopf(hopf.clone())),
            LabelledSolution::Equilibrium(Some(SpecialPoint::BranchPoint(point))) => {
                Some(Self::BranchPoint(point.clone()))
            }
            LabelledSolution::Cycle { orbit, .. } => {
                let kind = match kind(&point.label) {
                    "LPC" => SpecialKind::FoldOfCycles,
                    "PD" => SpecialKind::PeriodDoubling,
                    "NS" => SpecialKind::Torus,
                    _ => return None,
                };
                Some(Self::Cycle(kind, orbit.clone()))
            }
            _ => None,
        }
    }
}

impl LocusAnalysis {
    /// Follows the curve. Where the control stops it the result is the curve up to there.
    ///
    /// # Errors
    /// [`Error::Continuation`].
    pub fn run(&self, control: &Control<'_>) -> Result<LocusResult, Error> {
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
    ) -> Result<LocusResult, Error> {
        let chosen = &self.point.chosen;
        let is_of_cycles = matches!(self.start, Start::Cycle(..) | Start::HeldCycle(..));
        let field =
            if is_of_cycles { chosen.field_of_cycles(&self.active) } else { chosen.field(&self.active) };
        let curve = EquilibriumLocus::of(&field);
        let (curve, how) = match &self.start {
            Start::Fold(fold) => (curve.from_fold(fold), "the folds through it"),
            Start::Hopf(hopf) => (curve.from_hopf(hopf), "the Hopf points through it"),
            Start::BranchPoint(point) => (curve.from_branch_point(point), "the branch points through it"),
            Start::Cycle(kind, orbit) => {
                let curve = CycleLocus::of(&field);
                let curve = curve.from_cycle(*kind, orbit, &self.point.chosen.parameters);
                let how = match kind {
                    SpecialKind::FoldOfCycles => "the folds of cycles through it",
                    SpecialKind::PeriodDoubling => "the period doublings through it",
                    _ => "the torus bifurcations through it",
                };
                return self.of_cycles(curve, how, control, watcher).map(LocusResult::Cycles);
            }
            Start::HeldEquilibrium(held) => {
                let chosen = &self.point.chosen;
                let curve = curve.from_held_equilibrium(held.clone(), &chosen.start, &chosen.parameters);
                (curve, "the equilibria through it")
            }
            Start::HeldCycle(held, orbit) => {
                let curve = CycleLocus::of(&field);
                let curve = curve.from_held_cycle(held.clone(), orbit, &self.point.chosen.parameters);
                let result = self.of_cycles(curve, "the cycles through it", control, watcher)?;
                return Ok(LocusResult::Cycles(
                    result.holding(held.name(), held.value().unwrap_or(f64::NAN)),
                ));
            }
        };
        let [first, second] = &self.plane;
        let monitors = self.monitors.on_equilibria.iter().map(|(asked, quantity)| {
            let value =
                |point: &LocusPoint| Some(quantity.value(&point.state, &self.parameters(point.values), &[]));
            Monitor::new(&asked.expression, value).at(&asked.at).until(&asked.until)
        });
        let branch = monitors
            .fold(curve, EquilibriumLocus::monitor)
            .along(&self.names[0], first.start..=first.end)
            .and(&self.names[1], second.start..=second.end)
            .at(&self.at)
            .settings(self.steps.settings(equilibrium_settings()))
            .observer(|point| {
                watcher(FoundPoint {
                    values: &point.values,
                    max: &point.state,
                    min: &point.state,
                    stable: None,
                    label: point.label,
                    orbit: None,
                });
                self.tell(control, point.values)
            })
            .run()?;
        let origin = Origin::labelled(&self.point.label, how);
        let curve = EquilibriumLocusResult::new(
            &self.point.chosen,
            [first, second],
            origin,
            &names(&self.monitors.on_equilibria),
            &branch,
        );
        Ok(LocusResult::Equilibria(match &self.start {
            Start::HeldEquilibrium(held) => curve.holding(held.name(), held.value().unwrap_or(f64::NAN)),
            _ => curve,
        }))
    }

    fn of_cycles(
        &self,
        curve: CycleLocus<'_>,
        how: &str,
        control: &Control<'_>,
        watcher: &mut dyn FnMut(FoundPoint<'_>),
    ) -> Result<CycleLocusResult, Error> {
        let [first, second] = &self.plane;
        let monitors = self.monitors.on_cycles.iter().map(|(asked, monitor)| {
            let value =
                |point: &CycleLocusPoint| Some(monitor.value(&point.orbit, &self.parameters(point.values)));
            Monitor::new(&asked.expression, value).at(&asked.at).until(&asked.until)
        });
        let branch = monitors
            .fold(curve, CycleLocus::monitor)
            .along(&self.names[0], first.start..=first.end)
            .and(&self.names[1], second.start..=second.end)
            .at(&self.at)
            .settings(self.steps.settings(Settings::default()))
            .resolution(self.mesh.resolution())
            .observer(|point| {
                watcher(FoundPoint {
                    values: &point.values,
                    max: &[],
                    min: &[],
                    stable: None,
                    label: point.label,
                    orbit: Some(&point.orbit),
                });
                self.tell(control, point.values)
            })
            .run()?;
        let origin = Origin::labelled(&self.point.label, how);
        let names = names(&self.monitors.on_cycles);
        Ok(CycleLocusResult::new(&self.point.chosen, [first, second], origin, &names, branch))
    }

    /// All parameters at a point of the curve.
    fn parameters(&self, values: [f64; 2]) -> Vec<f64> {
        let mut parameters = self.point.chosen.parameters.clone();
        self.active.iter().zip(values).for_each(|(index, value)| parameters[*index] = value);
        parameters
    }

    fn tell(&self, control: &Control<'_>, values: [f64; 2]) -> ControlFlow<()> {
        let [one, two] = values.map(readable);
        let [first, second] = &self.plane;
        control.at(&format!("curve, {} = {one}, {} = {two}", first.key, second.key));
        control.flow()
    }
}

fn names<M>(monitors: &[(Monitored, M)]) -> Vec<String> {
    monitors.iter().map(|(asked, _)| asked.expression.clone()).collect()
}
