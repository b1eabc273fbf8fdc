//! The smallest dampers with which no shimmy is born up to a speed.

use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::{Key, SmallestDamper, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, NamedNumbers, Report, Schema, Table};
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
        let Assignment { key, value } = &self.up_to;
        let given = || format!("{key}={value}");
        if !matches!(key.parse(), Ok(Key::V)) {
            return Err(Error::invalid(&["up_to"], given(), "not a speed", "v=VALUE, in m/s"));
        }
        let mut fastest = wheel;
        fastest.set(key, value).map_err(|source| Error::Set { given: given(), source })?;
        let up_to = fastest.get(Key::V);
        if up_to <= 0.0 {
            return Err(Error::invalid(&["up_to"], given(), "no speed", "a speed above 0, in m/s"));
        }
        let alone = |key, part| wheel.smallest_damper(key, up_to, &control.part(part));
        let lateral = alone(Key::CQ, 0.0..0.1)?;
        let rotational = alone(Key::CPsi, 0.1..0.2)?;
        let mut front = Vec::new();
        if let Some(SmallestDamper { damping, .. }) = lateral {
            for index in 0..FRONT {
                let part = index as f64 / (FRONT - 1) as f64;
                let c_q = part * damping;
                let control = control.part(0.2 + 0.8 * part..(0.2 + 0.8 * (part + 0.1)).min(1.0));
                let c_psi = if index + 1 == FRONT {
                    Some(0.0)
                } else {
                    let damped = wheel.with(Key::CQ, c_q)?;
                    damped.smallest_damper(Key::CPsi, up_to, &control)?.map(|damper| damper.damping)
                };
                front.extend(c_psi.map(|c_psi| [c_q, c_psi]));
                if damping == 0.0 {
                    break;
                }
            }
        }
        Ok(DamperResult { wheel, up_to, lateral, rotational, front })
    }
}

/// The smallest dampers.
#[derive(Debug)]
pub struct DamperResult {
    /// The wheel without its dampers.
    pub wheel: Wheel,
    /// The speed in m/s up to which the uniform motion is to be stable.
    pub up_to: f64,
    /// The smallest lateral damper alone; nothing where none was found that is enough.
    pub lateral: Option<SmallestDamper>,
    /// The smallest damper about the king pin alone.
    pub rotational: Option<SmallestDamper>,
    /// Both together: `c_q` in N s/m and the least `c_psi` in N m s/rad beside it.
    pub front: Vec<[f64; 2]>,
}

/// What the dampers are for.
const REQUIREMENT: &str = "no shimmy is born: the uniform motion is stable at every speed";

impl Serialize for DamperResult {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Corner {
            c_q: Option<f64>,
            c_psi: Option<f64>,
        }
        #[derive(Serialize)]
        struct Front {
            c_q: Vec<f64>,
            c_psi: Vec<f64>,
        }
        #[derive(Serialize)]
        struct Fields {
            requirement: &'static str,
            up_to: f64,
            c_q: Option<f64>,
            c_psi: Option<f64>,
            corner: Corner,
            front: Front,
        }
        let damping = |damper: &Option<SmallestDamper>| damper.map(|damper| damper.damping);
        let speed = |damper: &Option<SmallestDamper>| damper.and_then(|damper| damper.speed);
        Fields {
            requirement: REQUIREMENT,
            up_to: self.up_to,
            c_q: damping(&self.lateral),
            c_psi: damping(&self.rotational),
            corner: Corner { c_q: speed(&self.lateral), c_psi: speed(&self.rotational) },
            front: Front {
                c_q: self.front.iter().map(|[c_q, _]| *c_q).collect(),
                c_psi: self.front.iter().map(|[_, c_psi]| *c_psi).collect(),
            },
        }
        .serialize(serializer)
    }
}

impl Report for DamperResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.damper")
    }

    fn parameters(&self) -> NamedNumbers {
        parameters_of(&self.wheel, &[Key::V, Key::CQ, Key::CPsi])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let wheel = description::of(&self.wheel, &[Key::V, Key::CQ, Key::CPsi]);
        writeln!(out, "dampers for stability up to v = {} m/s at {wheel}\n", readable(self.up_to))?;
        for (key, damper, name) in [
            (Key::CQ, self.lateral, "lateral damper"),
            (Key::CPsi, self.rotational, "damper about the king pin"),
        ] {
            match damper {
                None => writeln!(out, "{name} alone: none was found that is enough")?,
                Some(SmallestDamper { speed: None, .. }) => writeln!(out, "{name} alone: none is needed")?,
                Some(SmallestDamper { damping, speed: Some(speed) }) => writeln!(
                    out,
                    "{name} alone: {} at least; v = {} m/s decides",
                    description::quantity(key, damping),
                    readable(speed)
                )?,
            }
        }
        if self.front.len() > 1 {
            writeln!(out, "\nboth together:\n")?;
            let mut table = Table::new(["c_q (N s/m)", "c_psi (N m s/rad)"]);
            for [c_q, c_psi] in &self.front {
                table.row([(*c_q).into(), (*c_psi).into()]);
            }
            table.write(out)?;
        }
        writeln!(
            out,
            "\nsmall motions die out then; large cycles beside them (an isola) may take more and were not sought"
        )
    }

    fn columns(&self) -> Columns {
        Columns::new()
            .numbers("c_q", self.front.iter().map(|[c_q, _]| *c_q))
            .unit("N s/m")
            .numbers("c_psi", self.front.iter().map(|[_, c_psi]| *c_psi))
            .unit("N m s/rad")
    }
}
