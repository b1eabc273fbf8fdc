//! Curves of Hopf points, and of folds, period doublings and torus bifurcations of cycles, in two parameters of the wheel.

use super::{Along, HopfPoint};
use crate::{KingpinError, RollingModel, Wheel};
use arclength::branch::{Monitor, SpecialKind, Unlocated, WithParameters};
use arclength::continuation::{Settings, Stop};
use arclength::cycle::{Orbit, Resolution};
use arclength::equilibrium::equilibrium_settings;
use arclength::locus::{CycleLocus, CycleLocusEnd, CycleLocusPoint, LocusPoint};
use std::convert::Infallible;
use std::ops::ControlFlow;

/// How a curve in two parameters is computed.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct CurveOptions {
    /// Values of the first parameter at which points are wanted exactly.
    pub at: Vec<f64>,
    /// Resolution of the cycles.
    pub resolution: Resolution,
    /// Settings of the continuation; those of the engine where there are none.
    pub settings: Option<Settings>,
}

impl CurveOptions {
    /// The same with values of the first parameter at which points are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// The same with another resolution of the cycles.
    pub fn resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }

    /// The same with settings of the continuation.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = Some(settings);
        self
    }
}

/// A curve of Hopf points of the uniform motion.
#[derive(Debug)]
pub struct HopfCurve {
    /// The points: values are those of the two keys, states are [all](Wheel::states).
    pub points: Vec<LocusPoint>,
    /// Why the curve ends, at its first and at its last point, in values of the keys.
    pub stops: [Option<Stop<Infallible>>; 2],
    /// What was noticed and could not be located.
    pub unlocated: Vec<Unlocated>,
}

/// A curve of special cycles.
#[derive(Debug)]
pub struct CycleCurve {
    /// What it consists of.
    pub kind: SpecialKind,
    /// The points: values are those of the two keys, extrema are as in [`WheelCycles`](super::WheelCycles).
    pub points: Vec<CycleLocusPoint>,
    /// Why the curve ends, at its first and at its last point, in values of the keys.
    pub stops: [Option<Stop<CycleLocusEnd>>; 2],
    /// Changes of test functions behind which no point of codimension two could be located.
    pub unlocated: Vec<Unlocated>,
}

impl HopfPoint {
    /// The curve of Hopf points through this one in two parameters.
    ///
    /// `observer` is told both values at every point found and may end the run.
    ///
    /// # Errors
    /// [`KingpinError::OutsideInterval`], keys that cannot vary together, [`KingpinError::Continuation`].
    ///
    /// ```
    /// use arclength::control::Control;
    /// use kingpin::{Key, Wheel, branches::{Along, CurveOptions}};
    /// use std::ops::ControlFlow;
    /// let speed = Along::new(Key::V, 1.0, 12.0)?;
    /// let length = Along::new(Key::L, 0.07, 0.09)?;
    /// let hopf = Wheel::default().hopf_points(speed, &Control::none())?.points.remove(0);
    /// let curve = hopf.curve([speed, length], &CurveOptions::default(), |_| ControlFlow::Continue(()))?;
    /// // The critical speed is known in closed form.
    /// for point in &curve.points {
    ///     let wheel = Wheel::default().with(Key::L, point.values[1])?;
    ///     let critical = wheel.critical_speed().expect("a critical speed").speed;
    ///     assert!((point.values[0] / critical - 1.0).abs() < 1e-9);
    /// }
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn curve(
        &self,
        plane: [Along; 2],
        options: &CurveOptions,
        mut observer: impl FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<HopfCurve, KingpinError> {
        self.curve_told_to(plane, options, &mut observer)
    }

    /// [`curve`](Self::curve), compiled once and not for every observer.
    fn curve_told_to(
        &self,
        plane: [Along; 2],
        options: &CurveOptions,
        observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<HopfCurve, KingpinError> {
        let (model, values) = self.wheel.in_plane(plane)?;
        let start = arclength::equilibrium::HopfPoint { parameters: values.to_vec(), ..self.detail.clone() };
        let branch = start
            .curve(&model)
            .along(plane[0].followed().name(), plane[0].range())
            .and(plane[1].followed().name(), plane[1].range())
            .at(&options.at.iter().map(|value| plane[0].convert(*value)).collect::<Vec<_>>())
            .settings(options.settings.unwrap_or_else(equilibrium_settings))
            .observer(|point| observer(convert(&plane, point.values)))
            .run()?;
        let mut points = branch.points;
        for point in &mut points {
            if model.has_no_first_lyapunov(&point.values) {
                point.first_lyapunov = None;
                if point.label.is_some_and(|label| label.kind == SpecialKind::GeneralizedHopf) {
                    (point.label, point.special) = (None, None);
                }
            }
            point.state = model.full_state(&point.state, &point.values);
            point.values = convert(&plane, point.values);
            if let Some(special) = &mut point.special {
                special.state.clone_from(&point.state);
                special.location_error = convert_errors(&plane, point.values, special.location_error);
                special.values = point.values;
                special.parameters = point.values.to_vec();
            }
        }
        let stops = branch.stops.map(|stop| stop.map(|stop| convert_stop(&plane, stop)));
        Ok(HopfCurve { points, stops, unlocated: convert_unlocated(&plane, branch.unlocated) })
    }
}

impl Wheel {
    /// The curve of special cycles through one of this wheel: folds, period doublings or torus bifurcations in two parameters.
    ///
    /// `observer` is told both values at every point found and may end the run.
    ///
    /// # Errors
    /// As [`HopfPoint::curve`].
    pub fn cycle_curve(
        &self,
        kind: SpecialKind,
        orbit: &Orbit,
        plane: [Along; 2],
        options: &CurveOptions,
        mut observer: impl FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<CycleCurve, KingpinError> {
        self.cycle_curve_told_to(kind, orbit, plane, options, &mut observer)
    }

    /// [`cycle_curve`](Self::cycle_curve), compiled once and not for every observer.
    fn cycle_curve_told_to(
        &self,
        kind: SpecialKind,
        orbit: &Orbit,
        plane: [Along; 2],
        options: &CurveOptions,
        observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<CycleCurve, KingpinError> {
        let (model, values) = self.in_plane(plane)?;
        model.check_forwards(orbit, &values)?;
        let curve = CycleLocus::of(&model);
        let curve = match self.border_of_cycles() {
            Some((words, end)) => {
                let to_border =
                    |point: &CycleLocusPoint| model.distance_from_border(&point.orbit, &point.values);
                curve.monitor(Monitor::new(words, to_border).until(&[end]))
            }
            None => curve,
        };
        let branch = curve
            .from_cycle(kind, orbit, &values)
            .along(plane[0].followed().name(), plane[0].range())
            .and(plane[1].followed().name(), plane[1].range())
            .at(&options.at.iter().map(|value| plane[0].convert(*value)).collect::<Vec<_>>())
            .resolution(options.resolution)
            .settings(options.settings.unwrap_or_default())
            .observer(|point| observer(convert(&plane, point.values)))
            .run()?;
        let mut points = branch.points;
        for point in &mut points {
            model.complete_extrema(&point.orbit, &mut point.max, &mut point.min, &point.values);
            point.values = convert(&plane, point.values);
            point.location_error =
                point.location_error.map(|errors| convert_errors(&plane, point.values, errors));
        }
        let stops = branch.stops.map(|stop| stop.map(|stop| convert_stop(&plane, stop)));
        Ok(CycleCurve { kind, points, stops, unlocated: convert_unlocated(&plane, branch.unlocated) })
    }

    /// The vector field with two parameters active, and the wheel's own values of those that are followed.
    fn in_plane(&self, plane: [Along; 2]) -> Result<(RollingModel, [f64; 2]), KingpinError> {
        for along in plane {
            let value = self.get(along.key());
            if !along.contains(value) {
                let (start, end) = along.ends();
                return Err(KingpinError::OutsideInterval { key: along.key(), value, start, end });
            }
        }
        let model = self.rolling_model(&plane.map(|along| along.followed()))?;
        Ok((model, plane.map(|along| along.convert(self.get(along.key())))))
    }
}

fn convert(plane: &[Along; 2], values: [f64; 2]) -> [f64; 2] {
    [plane[0].convert(values[0]), plane[1].convert(values[1])]
}

fn convert_errors(plane: &[Along; 2], values: [f64; 2], errors: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|index| plane[index].convert_error(values[index], errors[index]))
}

fn convert_stop<R: WithParameters>(plane: &[Along; 2], stop: Stop<R>) -> Stop<R> {
    stop.with_parameters(|index, value| plane[index.min(1)].convert(value))
}

fn convert_unlocated(plane: &[Along; 2], mut unlocated: Vec<Unlocated>) -> Vec<Unlocated> {
    for change in &mut unlocated {
        for values in &mut change.between {
            values.iter_mut().zip(plane).for_each(|(value, along)| *value = along.convert(*value));
        }
    }
    unlocated
}
