//! What a curve of special points of a wheel is asked for by, and how it is computed.

use super::of_cycles::CycleLocusResult;
use super::of_hopf_points::HopfLocusResult;
use super::result::LocusResult;
use crate::along::{ParameterPlane, along};
use crate::error::Error;
use crate::hopf::search::{same_value, search};
use crate::start::{LabelledPoint, LabelledSolution};
use arclength::branch::SpecialKind;
use arclength::continuation::Settings;
use arclength::cycle::Orbit;
use arclength::equilibrium::equilibrium_settings;
use arclength_analysis::labels::kind;
use arclength_analysis::{Control, Disk, Files, FoundPoint, Interval, Mesh, Origin, PointReference, Steps};
use kingpin::branches::{Along, CurveOptions, HopfPoint};
use kingpin::{KingpinError, Wheel};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A curve of Hopf points of the uniform motion, or of folds (LPC), period doublings (PD) or torus bifurcations (NS) of cycles, in
/// two parameters, with its points of codimension two.
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
    at: Vec<f64>,
    steps: Steps,
    mesh: Mesh,
}

/// The point at which the curve starts.
#[derive(Clone, Debug)]
enum Start {
    /// A Hopf point, with a parameter along which it was found.
    Hopf(Along),
    Cycle(SpecialKind, Box<Orbit>),
}

impl LocusRequest {
    /// A request with the default of everything else.
    pub fn new(from: PointReference, plane: [Interval; 2]) -> Self {
        Self { from, plane, at: Vec::new(), steps: Steps::default(), mesh: Mesh::default() }
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
        let label = self.from.label.clone();
        let start = match (solution, kind(&label)) {
            (LabelledSolution::Hopf(found), _) => Some(Start::Hopf(found)),
            (LabelledSolution::Cycle { orbit, .. }, kind) => {
                LabelledPoint::check_orbit(&self.from, &wheel, &orbit)?;
                let kind = match kind {
                    "LPC" => Some(SpecialKind::FoldOfCycles),
                    "PD" => Some(SpecialKind::PeriodDoubling),
                    "NS" => Some(SpecialKind::Torus),
                    _ => None,
                };
                kind.map(|kind| Start::Cycle(kind, orbit))
            }
        };
        let start = start.ok_or_else(|| {
            self.from.failure(format!(
                "no curve of special points starts at {label}; allowed: Hopf points (HB), folds (LPC), period doublings (PD) \
                 and torus bifurcations (NS) of cycles"
            ))
        })?;
        Ok(LocusAnalysis {
            label,
            wheel,
            plane: ParameterPlane(plane),
            start,
            at: self.at.clone(),
            steps: self.steps,
            mesh: self.mesh,
        })
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
        let options = |settings: Settings| {
            CurveOptions::default()
                .at(&self.at)
                .resolution(self.mesh.resolution())
                .settings(self.steps.settings(settings))
        };
        let observer = |values: [f64; 2]| {
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
        let origin = |how: &str| Origin::labelled(&self.label, how);
        match &self.start {
            Start::Hopf(found) => {
                let hopf = self.hopf_point(*found, control)?;
                let curve = hopf.curve(self.plane.0, &options(equilibrium_settings()), observer)?;
                let origin = origin("the Hopf points through it");
                Ok(LocusResult::HopfPoints(HopfLocusResult::new(self.wheel, self.plane, origin, &curve)))
            }
            Start::Cycle(kind, orbit) => {
                let how = match kind {
                    SpecialKind::FoldOfCycles => "the folds of cycles through it",
                    SpecialKind::PeriodDoubling => "the period doublings through it",
                    _ => "the torus bifurcations through it",
                };
                let options = options(Settings::default());
                let curve = self.wheel.cycle_curve(*kind, orbit, self.plane.0, &options, observer)?;
                let origin = origin(how);
                Ok(LocusResult::Cycles(CycleLocusResult::new(self.wheel, self.plane, origin, curve)))
            }
        }
    }

    /// The Hopf point, which is found again along the parameter along which it was found, on the way from one end: a search that
    /// starts at the point itself would not see the growth rate change its sign.
    fn hopf_point(&self, found: Along, control: &Control<'_>) -> Result<HopfPoint, Error> {
        let value = self.wheel.get(found.key());
        let wheel = self.wheel.with(found.key(), found.ends().0)?;
        let points = search(&wheel, found, equilibrium_settings(), control)?.hopf_points;
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
