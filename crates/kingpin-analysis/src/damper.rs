//! The smallest dampers with which no shimmy is born up to a speed.

use crate::description;
use crate::error::Error;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::parameters::parameters_of;
use crate::up_to;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::{Key, SmallestDamper, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};

/// Dampers on the front between the lateral and the rotational one.
const FRONT: usize = 9;

/// The smallest dampers with which no shimmy is born up to a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DamperRequest {
    /// Which wheel; its own `c_q` and `c_psi` do not count.
    #[serde(flatten)]
    pub wheel: WheelRequest,
    /// The speed, `v=3`.
    pub up_to: Assignment,
}

impl DamperRequest {
    /// Computes them.
    ///
    /// # Errors
    /// What is wrong with the wheel or the speed; an interruption.
    pub fn run(&self, control: &Control<'_>) -> Result<DamperResult, Error> {
        let wheel = self.wheel.read()?.with(Key::CQ, 0.0)?.with(Key::CPsi, 0.0)?;
        let up_to = up_to::speed(&wheel, &self.up_to)?;
        let alone = |key, part| wheel.smallest_damper(key, up_to, &control.part(part));
        let lateral = alone(Key::CQ, 0.0..0.1)?;
        let rotational = alone(Key::CPsi, 0.1..0.2)?;
        let mut front = Front::default();
        if let Some(SmallestDamper { damping, .. }) = lateral {
            let count = if damping > 0.0 { FRONT } else { 1 };
            for index in 0..count {
                let part = index as f64 / (FRONT - 1) as f64;
                let damped = wheel.with(Key::CQ, part * damping)?;
                let control = control.part(0.2 + 0.8 * part..(0.2 + 0.8 * (part + 0.1)).min(1.0));
                let beside = if index + 1 == FRONT {
                    Some(0.0)
                } else {
                    damped.smallest_damper(Key::CPsi, up_to, &control)?.map(|damper| damper.damping)
                };
                if let Some(beside) = beside {
                    front.c_q.push(part * damping);
                    front.c_psi.push(beside);
                }
            }
        }
        let [c_q, c_psi] = [lateral, rotational].map(|damper| damper.map(|damper| damper.damping));
        let speed = |damper: Option<SmallestDamper>| damper.and_then(|damper| damper.speed);
        let corner = Corner { c_q: speed(lateral), c_psi: speed(rotational) };
        let dry_friction = NeglectedDryFriction::of(&wheel, &[Key::V]);
        Ok(DamperResult { wheel, requirement: REQUIREMENT, up_to, c_q, c_psi, corner, front, dry_friction })
    }
}

/// The smallest dampers.
#[derive(Debug, Serialize)]
pub struct DamperResult {
    /// The wheel without its dampers.
    #[serde(skip)]
    pub wheel: Wheel,
    /// What the dampers are for.
    pub requirement: &'static str,
    /// The speed in m/s up to which the uniform motion is to be stable.
    pub up_to: f64,
    /// The smallest lateral damper alone, in N s/m; nothing where none was found that is enough.
    pub c_q: Option<f64>,
    /// The smallest damper about the king pin alone, in N m s/rad.
    pub c_psi: Option<f64>,
    /// The speeds that decide.
    pub corner: Corner,
    /// Both dampers together.
    pub front: Front,
    /// Dry friction about the king pin that was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dry_friction: Option<NeglectedDryFriction>,
}

/// Speeds in m/s at which the motion is unstable with a weaker damper; nothing where none is needed.
#[derive(Debug, Serialize)]
pub struct Corner {
    /// Of the lateral damper.
    pub c_q: Option<f64>,
    /// Of the one about the king pin.
    pub c_psi: Option<f64>,
}

/// Pairs of dampers of which neither may be weaker.
#[derive(Debug, Default, Serialize)]
pub struct Front {
    /// Lateral ones, in N s/m.
    pub c_q: Vec<f64>,
    /// The least beside each about the king pin, in N m s/rad.
    pub c_psi: Vec<f64>,
}

/// What the dampers are for.
const REQUIREMENT: &str = "no shimmy is born: the uniform motion is stable at every speed";

impl Report for DamperResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.damper")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[Key::V, Key::CQ, Key::CPsi])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let wheel = description::of(&self.wheel, &[Key::V, Key::CQ, Key::CPsi]);
        writeln!(out, "dampers for stability up to v = {} m/s at {wheel}\n", readable(self.up_to))?;
        for (key, name, damping, speed) in [
            (Key::CQ, "lateral damper", self.c_q, self.corner.c_q),
            (Key::CPsi, "damper about the king pin", self.c_psi, self.corner.c_psi),
        ] {
            match (damping, speed) {
                (None, _) => writeln!(out, "{name} alone: none was found that is enough")?,
                (Some(_), None) => writeln!(out, "{name} alone: none is needed")?,
                (Some(damping), Some(speed)) => writeln!(
                    out,
                    "{name} alone: {} at least; v = {} m/s decides",
                    description::quantity(key, damping),
                    readable(speed)
                )?,
            }
        }
        if self.front.c_q.len() > 1 {
            writeln!(out, "\nboth together:\n")?;
            let mut table = Table::new(["c_q (N s/m)", "c_psi (N m s/rad)"]);
            for (c_q, c_psi) in self.front.c_q.iter().zip(&self.front.c_psi) {
                table.row([(*c_q).into(), (*c_psi).into()]);
            }
            table.write(out)?;
        }
        writeln!(
            out,
            "\nsmall motions die out then; large cycles beside them (an isola) may take more and were not sought"
        )?;
        NeglectedDryFriction::tell(self.dry_friction.as_ref(), out)
    }

    fn columns(&self) -> Columns {
        Columns::new()
            .numbers("c_q", self.front.c_q.iter().copied())
            .unit("N s/m")
            .numbers("c_psi", self.front.c_psi.iter().copied())
            .unit("N m s/rad")
    }
}
