//! What the smallest dampers are asked for by, and how they are found.

use super::kicks::kick;
use super::large_cycles::LargeCycles;
use super::result::{Corner, DamperResult, Front, IsolaFree, REQUIREMENT, WithoutCycles};
use crate::error::Error;
use crate::neglected_dry_friction::NeglectedDryFriction;
use crate::up_to;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::{Key, SmallestDamper, Wheel};
use serde::{Deserialize, Serialize};

/// What the search for what small motions take is of the whole time, roughly.
const PART_OF_SMALL_MOTIONS: f64 = 0.1;
/// What the search for large cycles is of the whole time in which one damper is looked at.
const PART_OF_CYCLES: f64 = 0.3;
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
    /// Only what small motions take: no large cycles are sought.
    #[serde(default)]
    pub small_motions: bool,
}

impl DamperRequest {
    /// Computes them.
    ///
    /// # Errors
    /// What is wrong with the wheel or the speed; an interruption.
    pub fn run(&self, control: &Control<'_>) -> Result<DamperResult, Error> {
        let wheel = self.wheel.read()?.with(Key::CQ, 0.0)?.with(Key::CPsi, 0.0)?;
        let up_to = up_to::speed(&wheel, &self.up_to)?;
        let whole = control;
        let part = if self.small_motions { 1.0 } else { PART_OF_SMALL_MOTIONS };
        let control = &whole.part(0.0..part);
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
        let isola_free = match self.small_motions {
            true => None,
            false => {
                let middle = 0.5 * (PART_OF_SMALL_MOTIONS + 1.0);
                let part = |range| whole.part(range);
                Some(IsolaFree {
                    c_q: without_cycles(&wheel, Key::CQ, c_q, up_to, &part(PART_OF_SMALL_MOTIONS..middle))?,
                    c_psi: without_cycles(&wheel, Key::CPsi, c_psi, up_to, &part(middle..1.0))?,
                })
            }
        };
        Ok(DamperResult {
            wheel,
            requirement: REQUIREMENT,
            up_to,
            c_q,
            c_psi,
            corner,
            front,
            isola_free,
            dry_friction,
        })
    }
}

/// The damper alone with which no large cycle was found either; nothing where none is enough for small motions.
fn without_cycles(
    wheel: &Wheel,
    key: Key,
    needed: Option<f64>,
    up_to: f64,
    control: &Control<'_>,
) -> Result<Option<WithoutCycles>, Error> {
    let Some(needed) = needed else { return Ok(None) };
    let cycles = LargeCycles::seek(wheel, key, [needed, up_to], &control.part(0.0..PART_OF_CYCLES))?;
    let forces = match &cycles.last {
        Some(last) => Some(last.forces(wheel, key)?),
        None => None,
    };
    let last = cycles.last.as_ref().map_or(0.0, |last| last.damping);
    let by_continuation = (!cycles.at_every_damper).then(|| needed.max(last));
    let kicked = match by_continuation {
        Some(damping) => kick(wheel, key, [damping, up_to], &control.part(PART_OF_CYCLES..1.0))?,
        None => None,
    };
    let decisive = last > needed;
    Ok(Some(WithoutCycles::new(by_continuation, decisive, cycles, forces, kicked)))
}
