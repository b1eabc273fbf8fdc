//! The uniform motion at one parameter point.

use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use kingpin::{Key, UniformMotion, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Report, Schema, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// The uniform motion of a wheel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SteadyRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
}

impl SteadyRequest {
    /// Computes it.
    ///
    /// # Errors
    /// What is wrong with the wheel; no uniform motion.
    pub fn run(&self) -> Result<SteadyResult, Error> {
        let wheel = self.wheel.read()?;
        let mut result = SteadyResult::of(&wheel.uniform_motion()?);
        if wheel.get(Key::MF) > 0.0 {
            result.resting_deflections = wheel.resting_deflections()?;
        }
        Ok(result)
    }
}

/// The uniform motion.
#[derive(Debug, Serialize)]
pub struct SteadyResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// Longitudinal displacement of the king pin in m.
    pub u: f64,
    /// Lateral displacement of the king pin in m.
    pub q: f64,
    /// Caster angle in rad.
    pub psi: f64,
    /// Forward speed of the wheel in m/s.
    #[serde(rename = "V")]
    pub forward_speed: f64,
    /// Yaw rate in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: f64,
    /// What is left of the equations of motion.
    pub residual: f64,
    /// Force of friction between wheel and ground in N.
    pub friction_force: f64,
    /// Force of the ground on the wheel in N.
    pub normal_force: f64,
    /// Whether the ground can supply the friction.
    pub rolls: bool,
    /// With dry friction about the king pin, the lowest and highest lateral deflection in m at which the wheel rests as well; nothing
    /// without, and on a circle with k_u other than k_q.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting_deflections: Option<[f64; 2]>,
}

impl SteadyResult {
    fn of(motion: &UniformMotion) -> Self {
        let contact = motion.contact_force();
        Self {
            wheel: *motion.wheel(),
            u: motion.u(),
            q: motion.q(),
            psi: motion.psi(),
            forward_speed: motion.forward_speed(),
            yaw_rate: motion.yaw_rate(),
            residual: motion.residual(),
            friction_force: contact.friction(),
            normal_force: contact.normal,
            rolls: contact.rolls(),
            resting_deflections: None,
        }
    }
}

impl Report for SteadyResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.steady")
    }

    fn parameters(&self) -> NamedNumbers {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "uniform motion at {}\n", description::of(&self.wheel, &[]))?;
        let limit = self.wheel.get(Key::MuS) * self.normal_force;
        let rolling = if self.rolls {
            format!("yes: the ground can supply {} N", readable(limit))
        } else {
            format!("no: the ground can supply only {} N", readable(limit.max(0.0)))
        };
        let mut table = Table::new(["", "", "", ""]);
        let mut row = |name: &str, value: f64, unit: &str, meaning: &str| {
            table.row([name.into(), value.into(), unit.into(), meaning.into()]);
        };
        row("u", self.u, "m", "longitudinal displacement of the king pin");
        row("q", self.q, "m", "lateral displacement of the king pin");
        row("psi", self.psi, "rad", "caster angle");
        row("V", self.forward_speed, "m/s", "forward speed of the wheel");
        row("Omega", self.yaw_rate, "rad/s", "yaw rate");
        row("residual", self.residual, "", "of the equations of motion");
        row("friction_force", self.friction_force, "N", "between wheel and ground");
        row("normal_force", self.normal_force, "N", "between wheel and ground");
        table.write(out)?;
        writeln!(out, "rolls           {rolling}")?;
        let moment = self.wheel.get(Key::MF);
        match self.resting_deflections {
            Some([low, high]) => writeln!(
                out,
                "\ndry friction about the king pin, M_f = {} N m, lets it rest with any q from {} to {} m",
                readable(moment),
                readable(low),
                readable(high)
            ),
            None if moment > 0.0 => writeln!(
                out,
                "\nwith M_f = {} N m it rests at others beside this one, of which none are told where k_u and k_q differ",
                readable(moment)
            ),
            None => Ok(()),
        }
    }

    fn columns(&self) -> Columns {
        Columns::new()
            .numbers("u", [self.u])
            .unit("m")
            .numbers("q", [self.q])
            .unit("m")
            .numbers("psi", [self.psi])
            .unit("rad")
            .numbers("V", [self.forward_speed])
            .unit("m/s")
            .numbers("Omega", [self.yaw_rate])
            .unit("rad/s")
            .numbers("residual", [self.residual])
            .numbers("friction_force", [self.friction_force])
            .unit("N")
            .numbers("normal_force", [self.normal_force])
            .unit("N")
            .booleans("rolls", [self.rolls])
    }
}
