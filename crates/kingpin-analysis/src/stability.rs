//! Eigenvalues of the uniform motion and its critical speed.

use crate::blow_out_of_rest::BlowOutOfRestResult;
use crate::description;
use crate::error::Error;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use arclength_analysis::Control;
use arclength_analysis::branch::stability;
use kingpin::{Key, SpeedPart, Wheel};
use kingpin_report::numbers::readable;
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::io::{self, Write};

/// Linear stability of the uniform motion: eigenvalues and critical speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StabilityRequest {
    /// Which wheel.
    #[serde(flatten)]
    pub wheel: WheelRequest,
}

impl StabilityRequest {
    /// Computes it.
    ///
    /// # Errors
    /// What is wrong with the wheel; no uniform motion.
    pub fn run(&self) -> Result<StabilityResult, Error> {
        let wheel = self.wheel.read()?;
        let motion = wheel.uniform_motion()?;
        let over_speed = wheel.stability_over_speed(&Control::none())?;
        // A window that is narrower than the scan of the critical speed has changes all the same.
        let critical = wheel.critical_speed().map(|critical| critical.speed);
        let critical = critical.or(over_speed.changes.first().copied());
        let yaw_rate = |speed: f64| speed / wheel.get(Key::TurningRadius);
        Ok(StabilityResult {
            eigenvalues: motion
                .eigenvalues()
                .iter()
                .map(|eigenvalue| [eigenvalue.re, eigenvalue.im])
                .collect(),
            growth_rate: motion.growth_rate(),
            stable: motion.is_stable(),
            critical_speed: critical,
            critical_yaw_rate: critical.map(yaw_rate),
            searched: over_speed.searched,
            speeds: over_speed.parts.iter().map(StabilityPart::from).collect(),
            closed_form: over_speed.is_complete,
            not_followed: over_speed.not_followed,
            swing_factor: wheel.swing_factor(),
            critical_speed_with_friction: wheel.critical_speed_with_friction(),
            resting_angles: wheel.resting_angles()?,
            resting_deflections: if wheel.get(Key::MF) > 0.0 { wheel.resting_deflections()? } else { None },
            largest_resting_angle_while_sliding: wheel.largest_resting_angle_while_sliding(),
            blow_out_of_rest: wheel.blow_out_of_rest(&Control::none())?.map(Into::into),
            blow_out_of_rest_while_sliding: wheel
                .blow_out_of_rest_while_sliding(&Control::none())?
                .map(Into::into),
            wheel,
        })
    }
}

/// Speeds at which the uniform motion has one stability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StabilityPart {
    /// Lowest speed in m/s.
    pub from: f64,
    /// Highest speed in m/s.
    pub to: f64,
    /// Nothing where rounding of the parameters could decide it either way.
    pub stable: Option<bool>,
}

impl From<&SpeedPart> for StabilityPart {
    fn from(part: &SpeedPart) -> Self {
        Self { from: part.from, to: part.to, stable: part.stable }
    }
}

/// Linear stability of the uniform motion.
#[derive(Debug, Serialize)]
pub struct StabilityResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// Real and imaginary parts in 1/s and rad/s, by descending real part.
    pub eigenvalues: Vec<[f64; 2]>,
    /// Largest real part in 1/s of those that count.
    pub growth_rate: f64,
    /// Whether it is negative; nothing where rounding could decide that either way.
    pub stable: Option<bool>,
    /// Lowest speed in m/s at which a change of the stability was found.
    pub critical_speed: Option<f64>,
    /// Yaw rate in rad/s there.
    pub critical_yaw_rate: Option<f64>,
    /// Lowest and highest speed in m/s that was looked at.
    pub searched: [f64; 2],
    /// The stability over these speeds; where parts do not touch no uniform motion was found between them.
    pub speeds: Vec<StabilityPart>,
    /// Whether the speeds at which it changes are known in closed form, so that there are no others.
    pub closed_form: bool,
    /// Speeds in m/s between which the motion could not be followed: there changes close together may be missed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_followed: Vec<[f64; 2]>,
    /// Towed straight, the factor by which each swing multiplies the caster angle with dry friction about the king pin.
    pub swing_factor: Option<f64>,
    /// Towed straight, the speed in m/s beyond which small motions grow in spite of dry friction; it does not depend on how much
    /// there is.
    pub critical_speed_with_friction: Option<f64>,
    /// With dry friction about the king pin, the lowest and highest lateral deflection in m at which the rolling wheel rests; nothing
    /// without, and on a circle with k_u other than k_q.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting_deflections: Option<[f64; 2]>,
    /// With a tyre besides, the smallest and largest caster angle in rad at which it rests.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resting_angles: Option<[f64; 2]>,
    /// The largest caster angle in rad that dry friction about the king pin holds while the wheel slides sideways, towed straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_resting_angle_while_sliding: Option<f64>,
    /// With dry friction about the king pin, the smallest blow after which the caster of the rolling wheel does not rest where its first
    /// swing ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blow_out_of_rest: Option<BlowOutOfRestResult>,
    /// The same beyond the largest angle that dry friction holds while the wheel slides sideways.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blow_out_of_rest_while_sliding: Option<BlowOutOfRestResult>,
}

impl Report for StabilityResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.stability")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, &[])
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let verdict = stability(self.stable, false);
        writeln!(out, "uniform motion at {}: {verdict}\n", description::on_lines(&self.wheel, &[]))?;
        let mut table = Table::new(["eigenvalue", "real part (1/s)", "imaginary part (rad/s)"]);
        for (number, [real, imaginary]) in (1..).zip(&self.eigenvalues) {
            table.row([format!("{number}").into(), (*real).into(), (*imaginary).into()]);
        }
        table.write(out)?;
        writeln!(out)?;
        let straight = self.wheel.get(Key::TurningRadius).is_infinite();
        if straight && self.wheel.get(Key::CU) == 0.0 && !self.wheel.has_lateral_elasticity_only() {
            writeln!(out, "on a straight path without c_u, the undamped longitudinal motion does not count")?;
        }
        writeln!(out, "growth rate {} 1/s", readable(self.growth_rate))?;
        if self.stable.is_none() {
            writeln!(out, "undecided: rounding of the parameters could make it stable or unstable")?;
        }
        match (self.critical_speed, self.critical_yaw_rate) {
            (Some(speed), Some(yaw_rate)) => writeln!(
                out,
                "critical speed {} m/s, there the yaw rate is {} rad/s",
                readable(speed),
                readable(yaw_rate)
            ),
            _ if !self.closed_form => writeln!(out, "no critical speed was found"),
            _ if self.stable.is_none() => {
                writeln!(
                    out,
                    "no critical speed was found; whether it is stable at every speed or at none is undecided"
                )
            }
            _ => {
                let always = if self.stable == Some(true) { "stable" } else { "unstable" };
                let where_it_is = if straight { "" } else { " at which the motion exists" };
                writeln!(out, "no critical speed: {always} at every speed{where_it_is}")
            }
        }?;
        self.write_speeds(out)?;
        self.write_dry_friction(out)
    }

    fn columns(&self) -> Columns {
        Columns::new()
            .numbers("real_part", self.eigenvalues.iter().map(|[real, _]| *real))
            .unit("1/s")
            .numbers("imaginary_part", self.eigenvalues.iter().map(|[_, imaginary]| *imaginary))
            .unit("rad/s")
    }
}

impl StabilityResult {
    /// The stability over the speed, unless the critical speed tells it all.
    fn write_speeds(&self, out: &mut dyn Write) -> io::Result<()> {
        let changes_once = self.speeds.len() <= 2;
        if self.closed_form && changes_once {
            return Ok(());
        }
        let told = |part: &StabilityPart| {
            let word = match part.stable {
                Some(true) => "stable",
                Some(false) => "unstable",
                None => "undecided",
            };
            format!("{word} from {} to {} m/s", readable(part.from), readable(part.to))
        };
        let told: Vec<String> = self.speeds.iter().map(told).collect();
        let [low, high] = self.searched.map(readable);
        let is_everywhere = self.speeds.windows(2).all(|pair| pair[0].to == pair[1].from)
            && self.speeds.first().is_some_and(|part| part.from == self.searched[0])
            && self.speeds.last().is_some_and(|part| part.to == self.searched[1]);
        let elsewhere = if is_everywhere { "" } else { "; no uniform motion was found at other speeds" };
        writeln!(out, "looked at from {low} to {high} m/s: {}{elsewhere}", told.join(", "))?;
        for [low, high] in self.not_followed.iter().map(|speeds| speeds.map(readable)) {
            writeln!(
                out,
                "from {low} to {high} m/s the motion could not be followed: changes close together may be missed there"
            )?;
        }
        Ok(())
    }

    /// What dry friction about the king pin makes of small motions.
    fn write_dry_friction(&self, out: &mut dyn Write) -> io::Result<()> {
        let moment = self.wheel.get(Key::MF);
        if moment > 0.0 {
            writeln!(
                out,
                "\nall this without dry friction about the king pin, M_f = {} N m",
                readable(moment)
            )?;
            if let Some([low, high]) = self.resting_deflections {
                writeln!(
                    out,
                    "with it the rolling wheel rests with q from {} to {} m",
                    readable(low),
                    readable(high)
                )?;
            }
            if let Some([low, high]) = self.resting_angles {
                writeln!(
                    out,
                    "with it the wheel rests with psi from {} to {} rad, and motions near those inside return to rest",
                    readable(low),
                    readable(high)
                )?;
            }
            if let Some(edge) = &self.blow_out_of_rest {
                writeln!(out, "{}", edge.while_rolling())?;
            }
            if let Some(angle) = self.largest_resting_angle_while_sliding {
                let held = if angle < PI {
                    format!("angles up to {} rad", readable(angle))
                } else {
                    "any angle".to_owned()
                };
                writeln!(out, "while it slides sideways the caster is held at {held}")?;
                if let Some(edge) = &self.blow_out_of_rest_while_sliding {
                    writeln!(out, "{}", edge.while_sliding())?;
                }
            }
        }
        let Some(factor) = self.swing_factor else { return Ok(()) };
        writeln!(
            out,
            "\nwith dry friction about the king pin, however little, each swing multiplies small caster angles by {}",
            readable(factor)
        )?;
        match self.critical_speed_with_friction {
            Some(0.0) => writeln!(out, "small motions grow at every speed all the same"),
            Some(speed) => writeln!(out, "small motions die out up to {} m/s", readable(speed)),
            None => writeln!(out, "small motions die out at every speed"),
        }
    }
}
