//! The search for the smallest damper: wheels that need one are collected until what they take is enough for all.
//!
//! An exchange method for problems with infinitely many constraints (Hettich and Kortanek 1993): the least damper that makes some
//! wheels stable, all of whose critical dampings are known, is tried at all speeds and conditions; where the motion grows
//! there the wheels of fastest growth join the others. It converges quadratically where the growth rate has a smooth maximum.

use super::condition::SmallestDamper;
use super::critical_dampings::critical_dampings;
use super::growth::{Conditions, is_unstable};
use crate::error::KingpinError;
use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use arclength::control::Control;

/// A damper is tried this part above a critical damping.
const ABOVE: f64 = 1e-9;
/// Part by which the damper may change where its corner is placed more exactly.
const SAME: f64 = 1e-6;
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
            return Ok(Some(placed(found, key, conditions)));
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

/// The same damper with the place of its corner to all digits.
fn placed(found: SmallestDamper, key: Key, conditions: &Conditions) -> SmallestDamper {
    let Some(corner) = found.corner else { return found };
    let place = || {
        let peak = conditions.peak_beside(&corner, (key, found.damping))?;
        let critical = critical_dampings(&peak, key, unit(&peak, key));
        let distance = |damping: &f64| (damping / found.damping - 1.0).abs();
        let damping = critical.into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        let corner = peak.with(key, damping).ok().filter(|_| distance(&damping) < SAME)?;
        Some(SmallestDamper { damping, speed: Some(corner.get(Key::V)), corner: Some(corner) })
    };
    place().unwrap_or(found)
}

/// The least damper beyond which none of the wheels is surely unstable.
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
        if !witnesses.iter().any(|other| is_unstable(&other.wheel, (key, beyond))) {
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
