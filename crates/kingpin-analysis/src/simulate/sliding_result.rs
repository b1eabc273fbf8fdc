//! Time histories of a wheel that rolls or slides as a result.

use super::loads::{ForcesFromAbove, largest_ratio, loads};
use super::phase::{self, Phase};
use crate::description;
use crate::parameters::parameters_of;
use kingpin::sliding::{Contact, SLIDING_STATE_NAMES};
use kingpin::{Key, KingPinLoad, Wheel, in_towing_frame};
use kingpin_figure::{Axis, Figure, FigureError, Line, Panel, palette};
use kingpin_report::history::{drawn, summary};
use kingpin_report::numbers::{counted, readable};
use kingpin_report::{Columns, Parameters, Report, Schema};
use serde::Serialize;
use std::io::{self, Write};

/// Units of the states.
const UNITS: [&str; 7] = ["m", "m", "rad", "m/s", "m/s", "rad/s", "m/s"];

/// A list of the times, one per state, of the slip speed, of the forces, and of what the wheel does.
#[derive(Debug, Serialize)]
pub struct SlidingHistory {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// Times in s.
    pub t: Vec<f64>,
    /// Longitudinal displacement of the king pin in m, at every time.
    pub u: Vec<f64>,
    /// Lateral displacement of the king pin in m.
    pub q: Vec<f64>,
    /// Caster angle in rad.
    pub psi: Vec<f64>,
    /// Forward speed of the wheel in m/s.
    #[serde(rename = "V1")]
    pub forward_speed: Vec<f64>,
    /// Lateral speed of the wheel centre in m/s.
    #[serde(rename = "V2")]
    pub lateral_speed: Vec<f64>,
    /// Yaw rate in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: Vec<f64>,
    /// Speed of the rim in m/s.
    #[serde(rename = "W")]
    pub rim_speed: Vec<f64>,
    /// Speed of the contact point over the ground.
    pub slip: Vec<f64>,
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
    /// What the wheel does at every time, `rolling` or `sliding`.
    pub phase: Vec<&'static str>,
    /// What the caster does at every time, `swinging` or `sticking`, where dry friction acts about the king pin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub king_pin: Option<Vec<&'static str>>,
    /// Moment of dry friction about the king pin in N m, at every time, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_moment: Option<Vec<f64>>,
    /// Work in J that it took, where there is any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction_work: Option<f64>,
    /// The stretches of time in which it does the same.
    pub phases: Vec<Phase>,
    /// Part of the time in which it slides.
    pub sliding_fraction: f64,
}

impl SlidingHistory {
    /// The result of a motion.
    pub(crate) fn new(wheel: Wheel, history: kingpin::sliding::SlidingHistory) -> Self {
        let state = |index: usize| history.states.iter().map(|state| state[index]).collect();
        let friction_force: Vec<f64> =
            history.friction.iter().map(|[along, across]| along.hypot(*across)).collect();
        let contact = |&time: &f64| history.contact_at(time).map_or("rolling", phase::contact);
        let king_pin = |&time: &f64| history.king_pin_at(time).map_or("swinging", phase::king_pin);
        let dry = wheel.get(Key::MF) > 0.0;
        let ground = history.states.iter().zip(&history.friction);
        let forces = ForcesFromAbove {
            king_pin: history.king_pin_loads.iter().map(|load| load.components).collect(),
            ground: ground.map(|(state, friction)| in_towing_frame(state[2], *friction)).collect(),
        };
        Self {
            wheel,
            u: state(0),
            q: state(1),
            psi: state(2),
            forward_speed: state(3),
            lateral_speed: state(4),
            yaw_rate: state(5),
            rim_speed: state(6),
            slip: history.slip(),
            normal_force: vec![history.normal_force; friction_force.len()],
            friction_ratio_max: largest_ratio(&wheel, &friction_force),
            king_pin_force: history.king_pin_loads.iter().map(KingPinLoad::force).collect(),
            damper_power: history.king_pin_loads.iter().map(|load| load.damper_power).collect(),
            friction_force,
            forces,
            phase: history.times.iter().map(contact).collect(),
            king_pin: dry.then(|| history.times.iter().map(king_pin).collect()),
            friction_moment: dry.then_some(history.friction_moment.clone()),
            dry_friction_work: dry.then_some(history.dry_friction_work),
            phases: Phase::list(&wheel, &history.phases),
            sliding_fraction: history.sliding_fraction(),
            t: history.times,
        }
    }

    fn states(&self) -> [(&'static str, &Vec<f64>, &'static str); 7] {
        let values = [
            &self.u,
            &self.q,
            &self.psi,
            &self.forward_speed,
            &self.lateral_speed,
            &self.yaw_rate,
            &self.rim_speed,
        ];
        std::array::from_fn(|index| (SLIDING_STATE_NAMES[index], values[index], UNITS[index]))
    }
}

impl Report for SlidingHistory {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.simulate")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let duration = self.t.last().copied().unwrap_or(0.0);
        writeln!(out, "motion with rolling and sliding at {}", description::on_lines(&self.wheel, &[]))?;
        writeln!(out, "{} samples over {} s\n", self.t.len(), readable(duration))?;
        let more = [
            ("slip", &self.slip, "m/s"),
            ("friction_force", &self.friction_force, "N"),
            ("king_pin_force", &self.king_pin_force, "N"),
        ];
        summary(self.states().into_iter().chain(more)).write(out)?;
        let slides: Vec<&Phase> =
            self.phases.iter().filter(|phase| phase.contact == phase::contact(Contact::Sliding)).collect();
        writeln!(out)?;
        match slides.first() {
            Some(first) => writeln!(
                out,
                "it slides first at {} s, in {}, for {:.1} % of the time",
                readable(first.start),
                counted(slides.len(), "phase", "phases"),
                100.0 * self.sliding_fraction
            ),
            None => writeln!(out, "it rolls throughout"),
        }?;
        Phase::tell_swings(&self.phases, self.psi.last().copied(), self.dry_friction_work, out)
    }

    fn columns(&self) -> Columns {
        let times = Columns::new().numbers("t", self.t.iter().copied()).unit("s");
        let states = self.states().into_iter();
        let columns = states
            .fold(times, |columns, (name, values, unit)| {
                columns.numbers(name, values.iter().copied()).unit(unit)
            })
            .numbers("slip", self.slip.iter().copied())
            .unit("m/s")
            .numbers("friction_force", self.friction_force.iter().copied())
            .unit("N")
            .numbers("normal_force", self.normal_force.iter().copied())
            .unit("N")
            .texts("phase", self.phase.iter().map(|phase| Some((*phase).to_owned())));
        let columns = loads(columns, &self.king_pin_force, &self.damper_power);
        phase::columns(columns, self.friction_moment.as_deref(), self.king_pin.as_deref())
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let normal = self.wheel.normal_force();
        let duration = self.t.last().copied().unwrap_or(0.0);
        let panel = |label: &str, last: bool| {
            let time = Axis::new("$t$ (s)").limits(0.0, duration);
            Panel::new(if last { time } else { time.without_labels() }, Axis::new(label))
        };
        let curve = |values: &[f64]| Line::new(drawn(&self.t, values)).color(palette::BLUE);
        let level = |value: f64| Line::new([(0.0, value), (duration, value)]).color(palette::VERMILION);
        let speeds = panel("$V_1$, $W$ (m/s)", false)
            .curve(curve(&self.forward_speed).legend("$V_1$"))
            .curve(curve(&self.rim_speed).color(palette::VERMILION).dashed().legend("$W$"));
        let force = panel("$|T|$ (N)", true)
            .curve(curve(&self.friction_force))
            .curve(level(self.wheel.get(Key::MuS) * normal).dashed().legend("static limit"))
            .curve(level(self.wheel.get(Key::MuD) * normal).dotted().legend("sliding friction"));
        let single = |values: &[f64], label: &str| panel(label, false).curve(curve(values));
        let figure = Figure::double_column().columns(2).height_mm(150.0).description(format!(
            "Time histories of the states, the slip speed and the friction force of a wheel that rolls and slides at {}",
            description::of(&self.wheel, &[])
        ));
        Ok(Some(
            figure
                .panel(single(&self.u, "$u$ (m)"))
                .panel(speeds)
                .panel(single(&self.q, "$q$ (m)"))
                .panel(single(&self.lateral_speed, "$V_2$ (m/s)"))
                .panel(single(&self.psi, "$\\psi$ (rad)"))
                .panel(single(&self.yaw_rate, "$\\Omega$ (rad/s)"))
                .panel(panel("slip (m/s)", true).curve(curve(&self.slip)))
                .panel(force),
        ))
    }
}
