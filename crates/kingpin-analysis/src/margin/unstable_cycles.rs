//! The unstable limit cycles beside the safe disturbances along a parameter.

use crate::error::Error;
use arclength_analysis::Control;
use kingpin::branches::{Along, CycleOptions};
use kingpin::{Key, Wheel};
use kingpin_report::numbers::readable;

/// Cycles are followed to this part of the smallest value, so that it lies inside.
const BELOW: f64 = 0.99;
/// The Hopf point whose cycles are wanted is sought in intervals that reach so many times as far at either end, one after the
/// other: with the shortest in which there is one its branch is followed.
const SEARCHED: [f64; 4] = [2.0, 4.0, 8.0, 16.0];

/// The unstable limit cycles beside the safe disturbances.
#[derive(Clone, Debug, Default)]
pub(super) struct UnstableCycles {
    /// Half the range of the caster angle of the smallest one at each value, where there is one.
    pub amplitudes: Vec<Option<f64>>,
    /// Why there is none at some values.
    pub remarks: Vec<String>,
}

/// Finds them from the Hopf points in the interval, or, where it has none, in the nearest part beside it.
///
/// # Errors
/// A value that the parameter may not take.
pub(super) fn unstable_cycles(
    wheel: &Wheel,
    along: Along,
    values: &[f64],
    control: &Control<'_>,
) -> Result<UnstableCycles, Error> {
    control.at("unstable limit cycles");
    let mut found = UnstableCycles { amplitudes: vec![None; values.len()], remarks: Vec::new() };
    let key = along.key();
    let dry = "limit cycles are those without dry friction about the king pin, whatever M_f";
    if key == Key::MF {
        found.remarks.push(format!("no unstable limit cycle: {dry}"));
        return Ok(found);
    }
    let (start, end) = along.ends();
    // A search begins at the wheel's own value where that is inside.
    let wheel = wheel.with(key, 0.5 * (start + end))?;
    let mut searched = along;
    let mut hopf_points = Vec::new();
    for reach in SEARCHED {
        let allowed = key.allowed();
        let ends = [start / reach, end * reach].map(|end| end.clamp(allowed.lowest, allowed.highest));
        let wider = Along::new(key, ends[0].min(start), ends[1].max(end))?;
        match wheel.hopf_points(wider, &control.quiet()) {
            Ok(search) => (searched, hopf_points) = (wider, search.points),
            Err(error) => {
                found.remarks.push(format!("no Hopf points were sought: {error}"));
                break;
            }
        }
        if !hopf_points.is_empty() {
            break;
        }
    }
    if hopf_points.is_empty() {
        let (low, high) = searched.ends();
        found.remarks.push(format!(
            "no limit cycles: the uniform motion has no Hopf point in {key} = {}:{}",
            readable(low),
            readable(high)
        ));
    }
    let options = CycleOptions::default().at(values);
    for hopf in hopf_points.iter().take_while(|_| !control.is_stopped()) {
        let born = format!("the limit cycles from the Hopf point at {key} = {}", readable(hopf.value));
        // Only as far down as it is needed: slow cycles take long.
        let (lowest, highest) = searched.ends();
        let lowest = if hopf.value > start { lowest.max(BELOW * start) } else { lowest };
        let branch = match hopf.cycles(Along::new(key, lowest, highest)?, &options, |_| control.flow()) {
            Ok(branch) => branch,
            Err(error) => {
                found.remarks.push(format!("{born}: {error}"));
                continue;
            }
        };
        for cycle in branch.points.iter().filter(|cycle| cycle.unstable_multipliers > 0) {
            let amplitude = 0.5 * (cycle.max[2] - cycle.min[2]);
            let places = values.iter().zip(&mut found.amplitudes).filter(|(value, _)| **value == cycle.value);
            for (_, smallest) in places {
                *smallest = Some(smallest.map_or(amplitude, |other| other.min(amplitude)));
            }
        }
        let reached = branch.points.iter().map(|cycle| cycle.value);
        let [low, high] =
            reached.fold([hopf.value; 2], |[low, high], value| [f64::min(low, value), f64::max(high, value)]);
        if values.iter().any(|value| !(low..=high).contains(value)) {
            found.remarks.push(format!("{born} exist in {key} = {}:{}", readable(low), readable(high)));
        }
    }
    if found.amplitudes.iter().all(Option::is_some) {
        found.remarks.clear();
    }
    if wheel.get(Key::MF) > 0.0 {
        found.remarks.push(dry.to_owned());
    }
    Ok(found)
}
