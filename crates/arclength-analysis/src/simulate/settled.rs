//! The cycle on which a motion has settled, of a model that switches on a state or has events: the motion is followed as in a time
//! history, with its jumps and slides, until it comes back.

use super::accuracy::Accuracy;
use super::motion::{Course, Motion};
use crate::error::Error;
use arclength::VectorField;
use arclength::control::Control;
use arclength::cycle::Orbit;
use arclength::integration::Method;
use arclength_ode::Model;

/// Tolerance of the motion.
const TOLERANCE: f64 = 1e-10;
/// Steps that may be taken.
const MOST_STEPS: usize = 10_000_000;
/// Times at which it is looked at, and those between two of them where it comes back.
const SAMPLES: usize = 40_000;
const FINER: usize = 1_000;
/// Samples of one period from which the mesh is made, at first; where a state changes by more than this part of its range from one
/// to the next they are divided into so many parts, again and again, but not more than so often: a neuron fires in a millionth of the period.
const MESH_SAMPLES: usize = 2_000;
const LARGEST_CHANGE: f64 = 0.02;
const PARTS: usize = 8;
const MOST_REFINEMENTS: usize = 10;
/// Largest distance from the start where it comes back, and one that is none, as part of the size of the motion.
const CLOSURE: f64 = 0.05;
const CLOSED: f64 = 1e-3;
/// It is back where it comes this many times closer to the start than at any other time.
const CLOSEST: f64 = 10.0;
/// Breaks closer together than this part of the period are one.
const SAME_BREAK: f64 = 1e-9;

/// A motion from a state on.
struct Settled<'a> {
    model: &'a Model,
    parameters: &'a [f64],
    start: &'a [f64],
    accuracy: Accuracy,
}

/// The orbit of the motion that starts at a state, which should have settled on a stable cycle with a period below `duration`.
///
/// # Errors
/// [`Error::Integration`]; a motion that does not come back in that time.
pub(crate) fn settled_orbit(
    model: &Model,
    parameters: &[f64],
    start: &[f64],
    duration: f64,
) -> Result<Orbit, Error> {
    let accuracy = Accuracy {
        relative: TOLERANCE,
        absolute: vec![TOLERANCE; start.len()],
        largest_step: f64::INFINITY,
        most_steps: MOST_STEPS,
        method: Method::Automatic,
    };
    let mut settled = Settled { model, parameters, start, accuracy };
    let times = even(0.0, duration, SAMPLES);
    let motion = settled.follow(&times)?;
    settled.accuracy.absolute = motion.sizes.iter().map(|size| TOLERANCE * size.max(TOLERANCE)).collect();
    let not_back =
        || Error::from(arclength::Error::no_return(duration, model.states(), &motion.samples.states));
    let between = settled.back(&motion).ok_or_else(not_back)?;
    // A little more on both sides: the passage may be at a sample.
    let margin = (between[1] - between[0]) / FINER as f64;
    let finer = even((between[0] - margin).max(0.0), between[1] + margin, FINER);
    let again = settled.follow(&finer)?;
    let period = settled.back_at(&again).ok_or_else(not_back)?;
    // The unit time begins in the middle of the longest time without a break.
    let breaks = distinct(&motion.breaks, period);
    let behind: Vec<f64> = breaks.iter().copied().filter(|time| *time < period).collect();
    let next = |index: usize| behind.get(index + 1).copied().unwrap_or(behind[0] + period);
    let longest =
        (0..behind.len()).max_by(|a, b| (next(*a) - behind[*a]).total_cmp(&(next(*b) - behind[*b])));
    let origin = longest.map_or(0.0, |index| 0.5 * (behind[index] + next(index)));
    let origin = if origin >= period { origin - period } else { origin };
    let mut times = even(origin, origin + period, MESH_SAMPLES);
    let mut refinements = 0;
    let whole = loop {
        let motion = settled.follow(&times)?;
        let added = quick_stretches(&motion, SAME_BREAK * period);
        if added.is_empty() || refinements == MOST_REFINEMENTS {
            break motion;
        }
        drop(motion);
        refinements += 1;
        times.extend(added);
        times.sort_by(f64::total_cmp);
    };
    let breaks: Vec<f64> = distinct(&whole.breaks, period)
        .into_iter()
        .filter(|time| origin < *time && *time < origin + period)
        .collect();
    let samples = whole.samples;
    Orbit::from_pieces(&samples.times, &samples.states, &breaks, |nodes| {
        let motion = settled.follow(nodes)?;
        let (times, states) = (&motion.samples.times, &motion.samples.states);
        // At a break the state behind it counts, however its time was rounded.
        let rounding = SAME_BREAK * period;
        let last = |time: f64, is_break: bool| {
            let until = if is_break { time + rounding } else { time };
            let index = times.partition_point(|sample| *sample <= until).saturating_sub(1);
            states[index].clone()
        };
        let is_break = |time: f64| breaks.iter().any(|other| (time - other).abs() <= rounding);
        Ok(nodes.iter().map(|time| last(*time, is_break(*time))).collect())
    })
}

impl Settled<'_> {
    fn follow<'t>(&self, times: &'t [f64]) -> Result<Motion<'t>, Error> {
        let course = Course {
            model: self.model,
            parameters: self.parameters,
            start_time: 0.0,
            start: self.start,
            end_time: times.last().copied().unwrap_or(0.0),
            bound: f64::INFINITY,
            section: None,
            control: Control::none(),
        };
        Ok(course.follow(&self.accuracy, times)?)
    }

    /// How far a state is in front of the plane through the start that is normal to the flow there.
    fn position(&self, state: &[f64]) -> f64 {
        let mut normal = vec![0.0; state.len()];
        self.model.evaluate(self.start, self.parameters, &mut normal);
        normal.iter().zip(state).zip(self.start).map(|((normal, x), x0)| normal * (x - x0)).sum()
    }

    /// Passages of samples through that plane in the direction of the flow: the numbers of the samples before, and the distances from
    /// the start there.
    fn passages(&self, motion: &Motion<'_>) -> Vec<(usize, f64)> {
        let (times, states) = (&motion.samples.times, &motion.samples.states);
        let positions: Vec<f64> = states.iter().map(|state| self.position(state)).collect();
        // At the start itself the position is zero.
        (0..states.len().saturating_sub(1))
            .filter(|&index| {
                times[index] < times[index + 1] && positions[index] < 0.0 && positions[index + 1] >= 0.0
            })
            .map(|index| {
                let part = positions[index] / (positions[index] - positions[index + 1]);
                let state = states[index].iter().zip(&states[index + 1]);
                let state: Vec<f64> = state.map(|(a, b)| a + part * (b - a)).collect();
                (index, self.distance(&state))
            })
            .collect()
    }

    fn distance(&self, state: &[f64]) -> f64 {
        state.iter().zip(self.start).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// Two times between which the motion comes back.
    fn back(&self, motion: &Motion<'_>) -> Option<[f64; 2]> {
        let (times, states) = (&motion.samples.times, &motion.samples.states);
        let size = states.iter().map(|state| self.distance(state)).fold(0.0, f64::max);
        let passages = self.passages(motion);
        let closest = passages.iter().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min);
        let allowed = (CLOSEST * closest).max(CLOSED * size).min(CLOSURE * size);
        let (index, _) = passages.iter().find(|(_, distance)| *distance < allowed)?;
        Some([times[*index], times[*index + 1]])
    }

    /// The time at which the motion comes back, from samples that are close together there.
    fn back_at(&self, motion: &Motion<'_>) -> Option<f64> {
        let (times, states) = (&motion.samples.times, &motion.samples.states);
        let (index, _) = *self.passages(motion).first()?;
        let [before, behind] = [index, index + 1].map(|index| self.position(&states[index]));
        Some(times[index] + (times[index + 1] - times[index]) * before / (before - behind))
    }
}

/// Times between samples from one to the next of which a state changes much; those next to a jump come as close to it as `shortest`.
fn quick_stretches(motion: &Motion<'_>, shortest: f64) -> Vec<f64> {
    let (times, states) = (&motion.samples.times, &motion.samples.states);
    let dimension = states.first().map_or(0, Vec::len);
    let range = |component: usize| {
        let values = states.iter().map(|state| state[component]);
        let [low, high] = values
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        high - low
    };
    let largest: Vec<f64> = (0..dimension).map(|component| LARGEST_CHANGE * range(component)).collect();
    let mut added = Vec::new();
    for (times, states) in times.windows(2).zip(states.windows(2)) {
        let is_quick =
            states[0].iter().zip(&states[1]).zip(&largest).any(|((a, b), most)| (b - a).abs() > *most);
        if is_quick && times[1] - times[0] > shortest {
            added.extend_from_slice(&even(times[0], times[1], PARTS)[1..PARTS]);
        }
    }
    added
}

fn even(from: f64, until: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|index| from + (until - from) * index as f64 / count as f64).collect()
}

/// Breaks without those that come right behind another one.
fn distinct(breaks: &[f64], period: f64) -> Vec<f64> {
    let mut distinct = breaks.to_vec();
    distinct.dedup_by(|later, earlier| *later - *earlier < SAME_BREAK * period);
    distinct
}
