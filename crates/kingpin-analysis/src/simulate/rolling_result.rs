//! Time histories of a wheel that rolls as a result.

use super::loads::{ForcesFromAbove, largest_ratio, loads};
use super::phase::{self, Phase};
use crate::description;
use crate::parameters::parameters_of;
use kingpin::rolling::STATE_NAMES;
use kingpin::simulation::TimeHistory;
use kingpin::{Key, KingpinError, Wheel};
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use kingpin_report::history::{drawn, extremes, summary};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};

/// A time history: a list of the times, one per state, and two of forces.
#[derive(Debug, Serialize)]
pub struct RollingHistory {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// Time in s from which on rolling takes more than the static friction.
    pub rolling_lost_at: Option<f64>,
    /// Times in s.
    pub t: Vec<f64>,
    /// Longitudinal displacement of the king pin in m, at every time.
    pub u: Vec<f64>,
    /// Lateral displacement of the king pin in m.
    pub q: Vec<f64>,
    /// Caster angle in rad.
    pub psi: Vec<f64>,
    /// Forward speed of the wheel in m/s.
    #[serde(rename = "V")]
    pub forward_speed: Vec<f64>,
    /// Yaw rate in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: Vec<f64>,
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

impl RollingHistory {
    /// The result of a motion.
    ///
    /// # Errors
    /// Those of [`Wheel::rolling_loads`].
    pub(super) fn new(wheel: Wheel, history: &TimeHistory) -> Result<Self, KingpinError> {
        let state = |index: usize| history.states.iter().map(|state| state[index]).collect();
        let king_pin = |&time: &f64| history.king_pin_at(time).map_or("swinging", phase::king_pin);
        let dry = wheel.get(Key::MF) > 0.0;
        let moments = history.friction_moment.iter().copied().chain(std::iter::repeat(0.0));
        let loads = wheel.rolling_loads(history.states.iter().map(|state| &state[..]).zip(moments))?;
        let friction_force = history.friction_force();
        Ok(Self {
            wheel,
            friction_ratio_max: largest_ratio(&wheel, &friction_force),
            king_pin_force: loads.iter().map(|load| load.king_pin.force()).collect(),
            damper_power: loads.iter().map(|load| load.king_pin.damper_power).collect(),
            forces: ForcesFromAbove::of_rolling(&loads),
            rolling_lost_at: history.rolling_lost_at,
            t: history.times.clone(),
            u: state(0),
            q: state(1),
            psi: state(2),
            forward_speed: state(3),
            yaw_rate: state(4),
            friction_force,
            normal_force: history.normal_force(),
            king_pin: dry.then(|| history.times.iter().map(king_pin).collect()),
            friction_moment: dry.then(|| history.friction_moment.clone()),
            dry_friction_work: dry.then_some(history.dry_friction_work),
            phases: Phase::list(&wheel, &history.phases),
        })
    }

    /// What is worth knowing about it.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(time) = self.rolling_lost_at {
            warnings.push(format!(
                "rolling needs more than the static friction from t = {} s on; the history goes on as if it rolled",
                readable(time)
            ));
        }
        let turned_across = |angles: &[f64]| (angles[0].cos() < 0.0) != (angles[1].cos() < 0.0);
        if self.wheel.has_lateral_elasticity_only() && self.psi.windows(2).any(turned_across) {
            warnings.push(
                "the caster passes psi = pi/2, where V does not follow from q, psi and Omega: digits are lost there, \
                 compare with a large finite k_u"
                    .to_owned(),
            );
        }
        warnings
    }

    fn states(&self) -> [(&'static str, &Vec<f64>, &'static str, &'static str); 5] {
        let [u, q, psi, forward_speed, yaw_rate] = STATE_NAMES;
        [
            (u, &self.u, "m", "$u$ (m)"),
            (q, &self.q, "m", "$q$ (m)"),
            (psi, &self.psi, "rad", "$\\psi$ (rad)"),
            (forward_speed, &self.forward_speed, "m/s", "$V$ (m/s)"),
            (yaw_rate, &self.yaw_rate, "rad/s", "$\\Omega$ (rad/s)"),
        ]
    }
}

impl Report for RollingHistory {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.simulate")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let duration = self.t.last().copied().unwrap_or(0.0);
        writeln!(out, "motion at {}", description::on_lines(&self.wheel, &[]))?;
        writeln!(out, "{} samples over {} s\n", self.t.len(), readable(duration))?;
        let states = self.states().map(|(name, values, unit, _)| (name, values, unit));
        let force = ("friction_force", &self.friction_force, "N");
        let load = ("king_pin_force", &self.king_pin_force, "N");
        summary(states.into_iter().chain([force, load])).write(out)?;
        writeln!(out)?;
        match self.rolling_lost_at {
            Some(time) => {
                writeln!(out, "rolling needs more than the static friction first at {} s", readable(time))
            }
            None => writeln!(out, "the static friction suffices for rolling throughout"),
        }?;
        Phase::tell_swings(&self.phases, self.psi.last().copied(), self.dry_friction_work, out)
    }

    fn columns(&self) -> Columns {
        let times = Columns::new().numbers("t", self.t.iter().copied()).unit("s");
        let states = self.states().into_iter();
        let columns = states
            .fold(times, |columns, (name, values, unit, _)| {
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
        let limit = self.wheel.get(Key::MuS) * self.wheel.normal_force();
        let duration = self.t.last().copied().unwrap_or(0.0);
        let panel = |values: &[f64], label: &str, last: bool| {
            let time = Axis::new("$t$ (s)").limits(0.0, duration);
            let time = if last { time } else { time.without_labels() };
            let mut panel = Panel::new(time, Axis::new(label))
                .curve(Line::new(drawn(&self.t, values)).color(palette::BLUE));
            if let Some(lost) = self.rolling_lost_at.filter(|&time| time > 0.0) {
                let [low, high] = extremes(values);
                panel =
                    panel.curve(Line::new([(lost, low), (lost, high)]).dotted().color(palette::VERMILION));
            }
            panel
        };
        let states = self.states();
        // Column by column the panels read u, q, psi and V, Omega, force.
        let mut force = panel(&self.friction_force, "$|T|$ (N)", true);
        force = force.curve(
            Line::new([(0.0, limit), (duration, limit)])
                .dashed()
                .color(palette::VERMILION)
                .legend("static friction"),
        );
        let mut figure = Figure::double_column().columns(2).height_mm(120.0).description(format!(
            "Time histories of the states and of the friction force at {}",
            description::of(&self.wheel, &[])
        ));
        for row in 0..2 {
            for (_, values, _, label) in [states[row], states[row + 3]] {
                figure = figure.panel(panel(values, label, false));
            }
        }
        let (_, values, _, label) = states[2];
        Ok(Some(figure.panel(panel(values, label, true)).panel(force)))
    }
}
