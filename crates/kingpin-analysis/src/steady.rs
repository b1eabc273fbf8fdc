//! The uniform motion at one parameter point.

use crate::blow_out_of_rest::BlowOutOfRestResult;
use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use crate::states::{self, named_state};
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use kingpin::{Key, UniformMotion, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Parameters, Report, Schema, Table};
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
            result.resting_angles = wheel.resting_angles()?;
            result.blow_out_of_rest = wheel.blow_out_of_rest(&Control::none())?.map(Into::into);
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
    /// The states: `u q psi V Omega`, with a tyre `u q psi V1 V2 Omega y_t`.
    #[serde(flatten)]
    pub state: NamedNumbers,
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
    /// With a tyre and dry friction about the king pin, the smallest and largest caster angle in rad at which it rests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting_angles: Option<[f64; 2]>,
    /// With dry friction about the king pin, the smallest blow after which the caster does not rest where its first swing ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blow_out_of_rest: Option<BlowOutOfRestResult>,
}

impl SteadyResult {
    pub(crate) fn of(motion: &UniformMotion) -> Self {
        let contact = motion.contact_force();
        Self {
            wheel: *motion.wheel(),
            state: named_state(&motion.states()),
            residual: motion.residual(),
            friction_force: contact.friction(),
            normal_force: contact.normal,
            rolls: contact.rolls(),
            resting_deflections: None,
            resting_angles: None,
            blow_out_of_rest: None,
        }
    }
}

impl Report for SteadyResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.steady")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "uniform motion at {}\n", description::on_lines(&self.wheel, &[]))?;
        let limit = self.wheel.get(Key::MuS) * self.normal_force;
        let rolling = if self.rolls {
            format!("yes: the ground can supply {} N", readable(limit))
        } else if self.normal_force <= 0.0 {
            "no: nothing presses the wheel on the ground".to_owned()
        } else {
            format!("no: the ground can supply only {} N", readable(limit))
        };
        let mut table = Table::new(["", "", "", ""]);
        let mut row = |name: &str, value: f64, unit: &str, meaning: &str| {
            table.row([name.into(), value.into(), unit.into(), meaning.into()]);
        };
        for (name, value) in &self.state.0 {
            row(name, *value, states::unit(name), states::meaning(name));
        }
        row("residual", self.residual, "", "of the equations of motion");
        row("friction_force", self.friction_force, "N", "between wheel and ground");
        row("normal_force", self.normal_force, "N", "between wheel and ground");
        table.write(out)?;
        writeln!(out, "rolls           {rolling}")?;
        let moment = self.wheel.get(Key::MF);
        if let Some([low, high]) = self.resting_angles {
            writeln!(
                out,
                "\ndry friction about the king pin, M_f = {} N m, lets it rest with any psi from {} to {} rad",
                readable(moment),
                readable(low),
                readable(high)
            )?;
            return self.write_blow(out);
        }
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
        }?;
        self.write_blow(out)
    }

    fn columns(&self) -> Columns {
        let states = self.state.0.iter().fold(Columns::new(), |columns, (name, value)| {
            columns.numbers(name.as_str(), [*value]).unit(states::unit(name))
        });
        states
            .numbers("residual", [self.residual])
            .numbers("friction_force", [self.friction_force])
            .unit("N")
            .numbers("normal_force", [self.normal_force])
            .unit("N")
            .booleans("rolls", [self.rolls])
    }
}

impl SteadyResult {
    /// What a blow does to the wheel at rest.
    fn write_blow(&self, out: &mut dyn Write) -> io::Result<()> {
        self.blow_out_of_rest.iter().try_for_each(|edge| writeln!(out, "{}", edge.while_rolling()))
    }
}
