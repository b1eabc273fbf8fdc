//! Time histories of a wheel with a tyre as a result.

use super::loads::{ForcesFromAbove, largest_ratio, loads};
use super::phase::{self, Phase};
use crate::description;
use crate::parameters::parameters_of;
use crate::states;
use kingpin::tyre::{TYRE_STATE_NAMES, TyreHistory};
use kingpin::{ContactForce, Key, KingpinError, Tyre, Wheel};
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use kingpin_report::history::{drawn, extremes, summary};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};

/// Labels of the states on axes.
const LABELS: [&str; 7] =
    ["$u$ (m)", "$q$ (m)", "$\\psi$ (rad)", "$V_1$ (m/s)", "$V_2$ (m/s)", "$\\Omega$ (rad/s)", "$y_t$ (m)"];

/// A time history: a list of the times, one per state, and two of forces.
#[derive(Debug, Serialize)]
pub struct TyreHistoryResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// Time in s that was asked for.
    #[serde(skip)]
    pub duration: f64,
    /// Time in s from which on the force on the wheel exceeds the static friction.
    pub friction_exceeded_at: Option<f64>,
    /// Time in s at which the wheel stopped rolling forwards, where the history ends.
    pub stopped_at: Option<f64>,
    /// Times in s.
    pub t: Vec<f64>,
    /// Longitudinal displacement of the king pin in m, at every time.
    pub u: Vec<f64>,
    /// Lateral displacement of the king pin in m.
    pub q: Vec<f64>,
    /// Caster angle in rad.
    pub psi: Vec<f64>,
    /// Forward speed of the wheel centre in m/s.
    #[serde(rename = "V1")]
    pub forward_speed: Vec<f64>,
    /// Lateral speed of the wheel centre in m/s.
    #[serde(rename = "V2")]
    pub lateral_speed: Vec<f64>,
    /// Yaw rate in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: Vec<f64>,
    /// Lateral deflection of the tyre in m.
    #[serde(rename = "y_t")]
    pub deflection: Vec<f64>,
    /// Force of friction in N, at every time.
    pub friction_force: Vec<f64>,
    /// Force of the ground on the wheel in N.
    pub normal_force: Vec<f64>,
    /// Largest friction force over mu_s N; nothing where nothing presses the wheel down.
    pub friction_ratio_max: Option<f64>,
    /// Force on the king pin in N, at every time.
    pub king_pin_force: Vec<f64>,
    /// What the dampers take in W, at every time.
    pub damper_power: Vec<f64>,
    /// The forces as vectors, to be drawn.
    #[serde(skip)]
    pub forces: ForcesFromAbove,
    /// What the caster does at every time, `swinging` or `sticking`, where dry friction acts about the king pin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub king_pin: Option<Vec<&'static str>>,
    /// Moment of dry friction about the king pin in N m, at every time, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_moment: Option<Vec<f64>>,
    /// Work in J that it took, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction_work: Option<f64>,
    /// The stretches of time in which the caster only swings or only sticks, where dry friction acts about the king pin.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub phases: Vec<Phase>,
}

impl TyreHistoryResult {
    /// The result of a motion.
    ///
    /// # Errors
    /// Those of [`Wheel::rolling_loads`].
    pub(super) fn new(wheel: Wheel, duration: f64, history: TyreHistory) -> Result<Self, KingpinError> {
        let state = |index: usize| history.states.iter().map(|state| state[index]).collect();
        let moments = history.friction_moment.iter().copied().chain(std::iter::repeat(0.0));
        let loads = wheel.rolling_loads(history.states.iter().map(|state| &state[..]).zip(moments))?;
        let king_pin = |&time: &f64| history.king_pin_at(time).map_or("swinging", phase::king_pin);
        let dry = wheel.get(Key::MF) > 0.0;
        let friction_force: Vec<f64> = history.contact_forces.iter().map(ContactForce::friction).collect();
        Ok(Self {
            wheel,
            duration,
            friction_ratio_max: largest_ratio(&wheel, &friction_force),
            king_pin_force: loads.iter().map(|load| load.king_pin.force()).collect(),
            damper_power: loads.iter().map(|load| load.king_pin.damper_power).collect(),
            forces: ForcesFromAbove::of_rolling(&loads),
            friction_exceeded_at: history.friction_exceeded_at,
            stopped_at: history.stopped_at,
            u: state(0),
            q: state(1),
            psi: state(2),
            forward_speed: state(3),
            lateral_speed: state(4),
            yaw_rate: state(5),
            deflection: state(6),
            friction_force,
            normal_force: history.contact_forces.iter().map(|force| force.normal).collect(),
            king_pin: dry.then(|| history.times.iter().map(king_pin).collect()),
            friction_moment: dry.then(|| history.friction_moment.clone()),
            dry_friction_work: dry.then_some(history.dry_friction_work),
            phases: Phase::list(&wheel, &history.phases),
            t: history.times,
        })
    }

    /// What is worth knowing about it.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(time) = self.friction_exceeded_at {
            let goes_on = match self.wheel.tyre() {
                Tyre::Brush => "the law of the tyre limits its lateral part only",
                _ => "the linear law goes on; compare with tyre = brush",
            };
            warnings.push(format!(
                "the force on the wheel exceeds the static friction from t = {} s on: {goes_on}",
                readable(time)
            ));
        }
        if let Some(time) = self.stopped_at {
            warnings.push(format!(
                "the wheel stops rolling forwards (V1 = 0) at t = {} s, where the model of the tyre ends: what becomes of this motion \
                 is undecided",
                readable(time)
            ));
        }
        warnings
    }

    fn states(&self) -> [(&'static str, &Vec<f64>, &'static str); 7] {
        let values = [
            &self.u,
            &self.q,
            &self.psi,
            &self.forward_speed,
            &self.lateral_speed,
            &self.yaw_rate,
            &self.deflection,
        ];
        std::array::from_fn(|index| {
            let name = TYRE_STATE_NAMES[index];
            (name, values[index], states::unit(name))
        })
    }
}

impl Report for TyreHistoryResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.simulate")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "motion at {}", description::on_lines(&self.wheel, &[]))?;
        let reached = self.stopped_at.unwrap_or(self.duration);
        writeln!(out, "{} samples over {} s\n", self.t.len(), readable(reached))?;
        let force = ("friction_force", &self.friction_force, "N");
        let load = ("king_pin_force", &self.king_pin_force, "N");
        summary(self.states().into_iter().chain([force, load])).write(out)?;
        writeln!(out)?;
        if let Some(time) = self.stopped_at {
            writeln!(out, "the wheel stops rolling forwards at {} s: undecided from there", readable(time))?;
        }
        Phase::tell_swings(&self.phases, self.psi.last().copied(), self.dry_friction_work, out)?;
        match self.friction_exceeded_at {
            Some(time) => {
                writeln!(out, "the force exceeds the static friction first at {} s", readable(time))
            }
            None => writeln!(out, "the force stays below the static friction throughout"),
        }
    }

    fn columns(&self) -> Columns {
        let times = Columns::new().numbers("t", self.t.iter().copied()).unit("s");
        let states = self.states().into_iter();
        let columns = states
            .fold(times, |columns, (name, values, unit)| {
                columns.numbers(name, values.iter().copied()).unit(unit)
            })
            .numbers("friction_force", self.friction_force.iter().copied())
            .unit("N")
            .numbers("normal_force", self.normal_force.iter().copied())
            .unit("N");
        let columns = loads(columns, &self.king_pin_force, &self.damper_power);
        phase::columns(columns, self.friction_moment.as_deref(), self.king_pin.as_deref())
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let panel = |values: &[f64], label: &str, last: bool| {
            let time = Axis::new("$t$ (s)").limits(0.0, self.duration);
            let time = if last { time } else { time.without_labels() };
            let mut panel = Panel::new(time, Axis::new(label))
                .curve(Line::new(drawn(&self.t, values)).color(palette::BLUE));
            if let Some(stopped) = self.stopped_at {
                let [low, high] = extremes(values);
                let stop = Line::new([(stopped, low), (stopped, high)]);
                panel = panel.curve(stop.dotted().color(palette::VERMILION));
            }
            panel
        };
        let limit = self.wheel.get(Key::MuS) * self.wheel.normal_force();
        let force = panel(&self.friction_force, "$|T|$ (N)", true).curve(
            Line::new([(0.0, limit), (self.duration, limit)])
                .dashed()
                .color(palette::VERMILION)
                .legend("static friction"),
        );
        let mut figure = Figure::double_column().columns(2).height_mm(150.0).description(format!(
            "Time histories of the states and of the friction force at {}",
            description::of(&self.wheel, &[])
        ));
        let states = self.states();
        // Column by column the panels read u, q, psi, y_t and V1, V2, Omega, force.
        for (left, right) in [(0, 3), (1, 4), (2, 5)] {
            for index in [left, right] {
                figure = figure.panel(panel(states[index].1, LABELS[index], false));
            }
        }
        Ok(Some(figure.panel(panel(&self.deflection, LABELS[6], true)).panel(force)))
    }
}
