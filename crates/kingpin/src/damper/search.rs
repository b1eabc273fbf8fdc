//! The search for the smallest damper: wheels that need one are collected until what they take is enough for all.
//!
//! An exchange method for problems with infinitely many constraints (Hettich and Kortanek 1993): the least damper that makes some
//! wheels stable, all of whose critical dampings are known, is tried at all speeds and conditions; where the motion grows
//! there the wheels of fastest growth join the others. It converges quadratically where the growth rate has a smooth maximum.

use super::condition::SmallestDamper;
use super::critical_dampings::critical_dampings;
use super::growth::Conditions;
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use arclength::control::Control;

/// A damper is tried this part above a critical damping.
const ABOVE: f64 = 1e-9;
/// Most times that wheels join: quadratic convergence takes about five.
const ROUNDS: usize = 60;

/// A wheel that needs a damper.
struct Witness {
    wheel: Wheel,
    /// Dampings at which its motion gains or loses its stability.
    critical: Vec<f64>,
}

/// The smallest damper; `None` where none is found that is enough.
///
/// # Errors
/// [`Interrupted`](KingpinError::Interrupted).
pub(super) fn smallest(
    key: Key,
    conditions: &Conditions,
    control: &Control<'_>,
) -> Result<Option<SmallestDamper>, KingpinError> {
    let mut witnesses: Vec<Witness> = Vec::new();
    let mut found = SmallestDamper { damping: 0.0, speed: None, corner: None };
    for _ in 0..ROUNDS {
        let unstable = conditions.unstable((key, found.damping * (1.0 + ABOVE)), control)?;
        if unstable.is_empty() {
            return Ok(Some(found));
        }
        for wheel in unstable {
            let critical = critical_dampings(&wheel, key, unit(&wheel, key));
            witnesses.push(Witness { wheel, critical });
        }
        match least(key, &witnesses)? {
            Some(damper) => found = damper,
            None => return Ok(None),
        }
    }
    Ok(None)
}

/// The least damper beyond which all of the wheels are stable.
fn least(key: Key, witnesses: &[Witness]) -> Result<Option<SmallestDamper>, KingpinError> {
    let of_one = |witness: &Witness| {
        witness.critical.iter().map(|damping| (*damping, witness.wheel)).collect::<Vec<_>>()
    };
    let mut critical: Vec<(f64, Wheel)> = witnesses.iter().flat_map(of_one).collect();
    critical.sort_by(|one, other| one.0.total_cmp(&other.0));
    for (damping, wheel) in critical {
        let beyond = damping * (1.0 + ABOVE);
        if beyond > key.allowed().highest {
            break;
        }
        let grows = |other: &Witness| -> Result<bool, KingpinError> {
            Ok(other.wheel.with(key, beyond)?.uniform_motion()?.growth_rate() >= 0.0)
        };
        let mut is_enough = true;
        for witness in witnesses {
            is_enough = is_enough && !grows(witness)?;
        }
        if is_enough {
            let corner = wheel.with(key, damping)?;
            return Ok(Some(SmallestDamper {
                damping,
                speed: Some(corner.get(Key::V)),
                corner: Some(corner),
            }));
        }
    }
    Ok(None)
}

/// A damping that would take the lateral motion of a wheel about a period to die out.
fn unit(wheel: &Wheel, key: Key) -> f64 {
    let rotational = if wheel.tyre() == Tyre::Rigid {
        wheel.natural_rotational_damping()
    } else {
        let eigenvalues = wheel.uniform_motion().map(|motion| motion.eigenvalues()).unwrap_or_default();
        let frequency = eigenvalues.iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max);
        frequency / wheel.body().inverse_yaw_inertia
    };
    let arm = wheel.get(Key::L);
    if key == Key::CPsi { rotational } else { rotational / (arm * arm) }
}
