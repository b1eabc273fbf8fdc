//! Curves in two parameters of the wheel: of Hopf points, of folds, period doublings and torus bifurcations of cycles, and of motions
//! on which a quantity keeps its value.

use super::{Along, HopfPoint, MotionMonitor};
use crate::{KingpinError, RollingModel, Wheel};
use arclength::branch::{Monitor, SpecialKind, Unlocated, WithParameters};
use arclength::continuation::{Settings, Stop};
use arclength::cycle::{Orbit, Resolution};
use arclength::equilibrium::equilibrium_settings;
use arclength::locus::{CycleLocus, CycleLocusEnd, CycleLocusPoint, EquilibriumLocus, LocusPoint};
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
    /// What is recorded along a curve of uniform motions.
    pub motion_monitors: Vec<MotionMonitor<[f64]>>,
    /// What is recorded along a curve of cycles.
    pub cycle_monitors: Vec<MotionMonitor<Orbit>>,
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

    /// The same with one more quantity that is recorded along a curve of uniform motions.
    pub fn motion_monitor(mut self, monitor: MotionMonitor<[f64]>) -> Self {
        self.motion_monitors.push(monitor);
        self
    }

    /// The same with one more quantity that is recorded along a curve of cycles.
    pub fn cycle_monitor(mut self, monitor: MotionMonitor<Orbit>) -> Self {
        self.cycle_monitors.push(monitor);
        self
    }
}

/// A curve of uniform motions: of Hopf points, or of those on which a quantity keeps its value.
#[derive(Debug)]
pub struct MotionCurve {
    /// The points: values are those of the two keys, states are [all](Wheel::states).
    pub points: Vec<LocusPoint>,
    /// Why the curve ends, at its first and at its last point, in values of the keys.
    pub stops: [Option<Stop<Infallible>>; 2],
    /// What was noticed and could not be located.
    pub unlocated: Vec<Unlocated>,
    /// Words for the monitors, in the order in which a [`Stop::Monitor`] counts them.
    pub monitors: Vec<String>,
}

/// A curve of cycles: of special ones, or of those on which a quantity keeps its value.
#[derive(Debug)]
pub struct CycleCurve {
    /// What it consists of; nothing where it consists of any cycles.
    pub kind: Option<SpecialKind>,
    /// The points: values are those of the two keys, extrema are as in [`WheelCycles`](super::WheelCycles).
    pub points: Vec<CycleLocusPoint>,
    /// Why the curve ends, at its first and at its last point, in values of the keys.
    pub stops: [Option<Stop<CycleLocusEnd>>; 2],
    /// Changes of test functions behind which no point of codimension two could be located.
    pub unlocated: Vec<Unlocated>,
    /// Words for the monitors, in the order in which a [`Stop::Monitor`] counts them.
    pub monitors: Vec<String>,
}

/// From where a curve of cycles is followed, and of what it consists.
#[derive(Clone, Debug)]
enum CycleStart<'a> {
    Special(SpecialKind, &'a Orbit),
    Holding(&'a MotionMonitor<Orbit>, f64, &'a Orbit),
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
    ) -> Result<MotionCurve, KingpinError> {
        let (model, values) = self.wheel.in_plane(plane)?;
        let start = arclength::equilibrium::HopfPoint { parameters: values.to_vec(), ..self.detail.clone() };
        motion_curve(start.curve(&model), &model, plane, options, &mut observer)
    }
}

impl Wheel {
    /// The curve of uniform motions through one of this wheel, in all states, on which a quantity keeps a value.
    ///
    /// `observer` is told both values at every point found and may end the run.
    ///
    /// # Errors
    /// As [`HopfPoint::curve`].
    ///
    /// ```
    /// use kingpin::{Key, Wheel, branches::{Along, CurveOptions, MotionMonitor}};
    /// use std::ops::ControlFlow;
    /// // Uniform motions with the caster at one angle.
    /// let wheel = Wheel::default();
    /// let motion = wheel.uniform_motion()?;
    /// let plane = [Along::new(Key::L, 0.05, 0.15)?, Along::new(Key::TurningRadius, 0.5, 2.0)?];
    /// let angle = MotionMonitor::new("psi", |_: &Wheel, state: &[f64]| Some(state[2]));
    /// let curve = wheel.motion_curve_holding(&angle, motion.psi(), &motion.states(), plane, &CurveOptions::default(), |_| {
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert!(curve.points.iter().all(|point| (point.state[2] - motion.psi()).abs() < 1e-9));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn motion_curve_holding(
        &self,
        held: &MotionMonitor<[f64]>,
        value: f64,
        state: &[f64],
        plane: [Along; 2],
        options: &CurveOptions,
        mut observer: impl FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<MotionCurve, KingpinError> {
        let (model, values) = self.in_plane(plane)?;
        let held = held.held(&model, value);
        let curve =
            EquilibriumLocus::of(&model).from_held_equilibrium(held, &model.free_state(state), &values);
        motion_curve(curve, &model, plane, options, &mut observer)
    }

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
        self.cycle_curve_from(&CycleStart::Special(kind, orbit), plane, options, &mut observer)
    }

    /// The curve of cycles through one of this wheel on which a quantity keeps a value.
    ///
    /// `observer` is told both values at every point found and may end the run.
    ///
    /// # Errors
    /// As [`HopfPoint::curve`].
    pub fn cycle_curve_holding(
        &self,
        held: &MotionMonitor<Orbit>,
        value: f64,
        orbit: &Orbit,
        plane: [Along; 2],
        options: &CurveOptions,
        mut observer: impl FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<CycleCurve, KingpinError> {
        self.cycle_curve_from(&CycleStart::Holding(held, value, orbit), plane, options, &mut observer)
    }

    /// A curve of cycles, compiled once and not for every observer.
    fn cycle_curve_from(
        &self,
        start: &CycleStart<'_>,
        plane: [Along; 2],
        options: &CurveOptions,
        observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
    ) -> Result<CycleCurve, KingpinError> {
        let (model, values) = self.in_plane(plane)?;
        let border = self.border_of_cycles();
        let (CycleStart::Special(_, orbit) | CycleStart::Holding(.., orbit)) = start;
        model.check_forwards(orbit, &values)?;
        let curve = CycleLocus::of(&model);
        let curve = match border {
            Some((words, end)) => {
                let to_border =
                    |point: &CycleLocusPoint| model.distance_from_border(&point.orbit, &point.values);
                curve.monitor(Monitor::new(words, to_border).until(&[end]))
            }
            None => curve,
        };
        let monitors = options.cycle_monitors.iter().map(|monitor| {
            monitor.on_cycles(&model, |point: &CycleLocusPoint| (&point.orbit, point.values.to_vec()))
        });
        let curve = monitors.fold(curve, CycleLocus::monitor);
        let curve = match start {
            CycleStart::Special(kind, orbit) => curve.from_cycle(*kind, orbit, &values),
            CycleStart::Holding(held, value, orbit) => {
                curve.from_held_cycle(held.held(&model, *value), orbit, &values)
            }
        };
        let branch = curve
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
            point.monitors.drain(..usize::from(border.is_some()).min(point.monitors.len()));
        }
        let asked_for = options.cycle_monitors.iter().map(MotionMonitor::name);
        let monitors = border.iter().map(|(words, _)| *words).chain(asked_for).map(str::to_owned).collect();
        Ok(CycleCurve {
            kind: match start {
                CycleStart::Special(kind, _) => Some(*kind),
                CycleStart::Holding(..) => None,
            },
            points,
            stops: branch.stops.map(|stop| stop.map(|stop| convert_stop(&plane, stop))),
            unlocated: convert_unlocated(&plane, branch.unlocated),
            monitors,
        })
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

/// A curve of uniform motions from its start on, in all states and in values of the keys.
fn motion_curve(
    curve: EquilibriumLocus<'_>,
    model: &RollingModel,
    plane: [Along; 2],
    options: &CurveOptions,
    observer: &mut dyn FnMut([f64; 2]) -> ControlFlow<()>,
) -> Result<MotionCurve, KingpinError> {
    let monitors = options
        .motion_monitors
        .iter()
        .map(|monitor| monitor.on_motions(model, |point: &LocusPoint| (&point.state, point.values.to_vec())));
    let branch = monitors
        .fold(curve, EquilibriumLocus::monitor)
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
    Ok(MotionCurve {
        points,
        stops: branch.stops.map(|stop| stop.map(|stop| convert_stop(&plane, stop))),
        unlocated: convert_unlocated(&plane, branch.unlocated),
        monitors: options.motion_monitors.iter().map(|monitor| monitor.name().to_owned()).collect(),
    })
}

fn convert(plane: &[Along; 2], values: [f64; 2]) -> [f64; 2] {
    [plane[0].told(values[0]), plane[1].told(values[1])]
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
