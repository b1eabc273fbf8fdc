//! What a curve of special points of a wheel is asked for by, and how it is computed.

use super::of_cycles::CycleLocusResult;
use super::of_motions::MotionLocusResult;
use super::result::LocusResult;
use crate::along::{ParameterPlane, along};
use crate::error::Error;
use crate::hopf::search::{same_value, search};
use crate::monitors::{names, on_cycles, on_motions};
use crate::start::{LabelledPoint, LabelledSolution};
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::Orbit;
use arclength::equilibrium::equilibrium_settings;
use arclength_analysis::labels::kind;
use arclength_analysis::{
    Control, Disk, Files, FoundPoint, Interval, Mesh, Monitored, Origin, PointReference, Steps,
};
use kingpin::branches::{Along, CurveOptions, HopfPoint, MotionMonitor, MotionOptions};
use kingpin::{KingpinError, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A curve of Hopf points of the uniform motion, or of folds (LPC), period doublings (PD) or torus bifurcations (NS) of cycles, in
/// two parameters, with its points of codimension two. With a quantity to be held, any uniform motions or cycles on which it keeps its
/// value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocusRequest {
    /// The labelled point, with its wheel.
    pub from: PointReference,
    /// The two parameters and their intervals; r may reach infinity.
    #[serde(rename = "in")]
    pub plane: [Interval; 2],
    /// Values of the first parameter at which points are wanted exactly.
    #[serde(default)]
    pub at: Vec<f64>,
    /// What keeps its value along a curve of any uniform motions or cycles: its first value, or the one where the curve starts.
    #[serde(default)]
    pub hold: Option<Monitored>,
    /// What is recorded along the curve, with values at which a point is wanted or the curve ends.
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
    label: String,
    wheel: Wheel,
    plane: ParameterPlane,
    start: Start,
    hold: Option<Monitored>,
    options: CurveOptions,
    steps: Steps,
}

/// The point at which the curve starts.
#[derive(Clone, Debug)]
enum Start {
    /// A Hopf point, with a parameter along which it was found.
    Hopf(Along),
    Cycle(SpecialKind, Box<Orbit>),
    /// Any cycle, with what keeps its value and that value.
    HeldCycle(MotionMonitor<Orbit>, f64, Box<Orbit>),
    /// A Hopf point as any uniform motion, with the parameter along which it was found and what keeps its value.
    HeldMotion(Along, MotionMonitor<[f64]>),
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
        let [first, second] = &self.plane;
        let plane = [along(first)?, along(second)?];
        first.check_values(&self.at)?;
        let LabelledPoint { wheel, solution } = LabelledPoint::read(&self.from, files)?;
        for axis in plane {
            let (key, value, (start, end)) = (axis.key(), wheel.get(axis.key()), axis.ends());
            if !axis.contains(value) {
                return Err(KingpinError::OutsideInterval { key, value, start, end }.into());
            }
        }
        let start = self.start(&wheel, solution)?;
        let mut options = CurveOptions::default().at(&self.at).resolution(self.mesh.resolution());
        for asked in &self.monitors {
            options = match start {
                Start::Hopf(_) | Start::HeldMotion(..) => options.motion_monitor(on_motions(asked, &wheel)?),
                Start::Cycle(..) | Start::HeldCycle(..) => options.cycle_monitor(on_cycles(asked, &wheel)?),
            };
        }
        Ok(LocusAnalysis {
            label: self.from.label.clone(),
            wheel,
            plane: ParameterPlane(plane),
            start,
            hold: self.hold.clone(),
            options,
            steps: self.steps,
        })
    }

    /// Where the curve starts, and what it consists of.
    fn start(&self, wheel: &Wheel, solution: LabelledSolution) -> Result<Start, Error> {
        let label = &self.from.label;
        let in_hold = |error: arclength_analysis::Error| error.in_fields(&["hold"]);
        let orbit = match (solution, &self.hold) {
            (LabelledSolution::Hopf(found), None) => return Ok(Start::Hopf(found)),
            (LabelledSolution::Hopf(found), Some(asked)) => {
                return Ok(Start::HeldMotion(found, on_motions(asked, wheel).map_err(in_hold)?));
            }
            (LabelledSolution::Cycle { orbit, .. }, _) => orbit,
        };
        LabelledPoint::check_orbit(&self.from, wheel, &orbit)?;
        if let Some(asked) = &self.hold {
            let held = on_cycles(asked, wheel).map_err(in_hold)?;
            let value = asked.value_to_hold(held.value(wheel, &orbit), label)?;
            return Ok(Start::HeldCycle(held, value, orbit));
        }
        let kind = match kind(label) {
            "LPC" => SpecialKind::FoldOfCycles,
            "PD" => SpecialKind::PeriodDoubling,
            "NS" => SpecialKind::Torus,
            _ => {
                return Err(self
                    .from
                    .failure(format!(
                        "no curve of special points starts at {label}; allowed: Hopf points (HB), folds (LPC), period doublings \
                         (PD) and torus bifurcations (NS) of cycles, any cycle with a quantity to be held"
                    ))
                    .into());
            }
        };
        Ok(Start::Cycle(kind, orbit))
    }
}

impl LocusAnalysis {
    /// Follows the curve. Where the control stops it the result is the curve up to there.
    ///
    /// # Errors
    /// [`Error::Wheel`]; [`Error::NothingFound`] where the point is no Hopf point.
    pub fn run(&self, control: &Control<'_>) -> Result<LocusResult, Error> {
        self.run_watched(control, &mut |_| {})
    }

    /// The same under the eyes of somebody who is told every point as it is found.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_watched(
        &self,
        control: &Control<'_>,
        watcher: &mut dyn FnMut(FoundPoint<'_>),
    ) -> Result<LocusResult, Error> {
        let mut observer = |values: [f64; 2]| {
            watcher(FoundPoint {
                values: &values,
                max: &[],
                min: &[],
                stable: None,
                label: None,
                orbit: None,
            });
            self.tell(control, values)
        };
        match &self.start {
            Start::Hopf(found) | Start::HeldMotion(found, _) => {
                let hopf = self.hopf_point(*found, control)?;
                self.of_motions(&hopf, &mut observer).map(LocusResult::Motions)
            }
            Start::Cycle(_, orbit) | Start::HeldCycle(.., orbit) => {
                self.of_cycles(orbit, &mut observer).map(LocusResult::Cycles)
            }
        }
    }

    /// The curve of uniform motions from a Hopf point on.
    fn of_motions(
        &self,
        hopf: &HopfPoint,
        observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<MotionLocusResult, Error> {
        let options = self.options.clone().settings(self.steps.settings(equilibrium_settings()));
        let origin = |how: &str| Origin::labelled(&self.label, how);
        let monitors = names(&options.motion_monitors);
        let result = |kind, origin, curve| {
            MotionLocusResult::new(self.wheel, self.plane, origin, (kind, &monitors), curve)
        };
        let (Start::HeldMotion(_, held), Some(asked)) = (&self.start, &self.hold) else {
            let curve = hopf.curve(self.plane.0, &options, observer)?;
            return Ok(result(Some(SpecialKind::Hopf), origin("the Hopf points through it"), &curve));
        };
        let value = asked.value_to_hold(held.value(&hopf.wheel, &hopf.state), &self.label)?;
        let curve =
            hopf.wheel.motion_curve_holding(held, value, &hopf.state, self.plane.0, &options, observer)?;
        let mut result = result(None, origin("the uniform motions through it"), &curve);
        result.curve = result.curve.holding(held.name(), value);
        Ok(result)
    }

    /// The curve of cycles from one of them on.
    fn of_cycles(
        &self,
        orbit: &Orbit,
        observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<CycleLocusResult, Error> {
        let options = self.options.clone().settings(self.steps.settings(Settings::default()));
        let monitors = names(&options.cycle_monitors);
        let result = |how: &str, curve| {
            let origin = Origin::labelled(&self.label, how);
            CycleLocusResult::new(self.wheel, self.plane, origin, &monitors, curve)
        };
        match &self.start {
            Start::HeldCycle(held, value, _) => {
                let curve =
                    self.wheel.cycle_curve_holding(held, *value, orbit, self.plane.0, &options, observer)?;
                let mut result = result("the cycles through it", curve);
                result.curve = result.curve.holding(held.name(), *value);
                Ok(result)
            }
            Start::Cycle(kind, _) => {
                let how = match kind {
                    SpecialKind::FoldOfCycles => "the folds of cycles through it",
                    SpecialKind::PeriodDoubling => "the period doublings through it",
                    _ => "the torus bifurcations through it",
                };
                let curve = self.wheel.cycle_curve(*kind, orbit, self.plane.0, &options, observer)?;
                Ok(result(how, curve))
            }
            Start::Hopf(_) | Start::HeldMotion(..) => {
                Err(Error::NothingFound(format!("{} is no cycle", self.label)))
            }
        }
    }

    /// The Hopf point, which is found again along the parameter along which it was found, on the way from one end: a search that
    /// starts at the point itself would not see the growth rate change its sign.
    fn hopf_point(&self, found: Along, control: &Control<'_>) -> Result<HopfPoint, Error> {
        let value = self.wheel.get(found.key());
        let wheel = self.wheel.with(found.key(), found.ends().0)?;
        let points = search(&wheel, found, &MotionOptions::default(), control)?.hopf_points;
        points.into_iter().find(|point| same_value(point.value, value)).ok_or_else(|| {
            let (label, key) = (&self.label, found.key());
            Error::NothingFound(format!("{label} is no Hopf point along {key}: the file was changed"))
        })
    }

    fn tell(&self, control: &Control<'_>, values: [f64; 2]) -> ControlFlow<()> {
        let [one, two] = values.map(readable);
        let [first, second] = self.plane.keys();
        control.at(&format!("curve, {first} = {one}, {second} = {two}"));
        control.flow()
    }
}
