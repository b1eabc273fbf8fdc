//! States of which the smallest values have digits: populations, infected, modes that grow from next to nothing.
//!
//! Where a state, or a few small ones together, stay zero once they are zero, their growth from the smallest value depends on its own
//! size only: an outbreak from one in a billion comes when its logarithm says, which an absolute tolerance of a thousandth of that
//! spoils. Whether they stay zero the right-hand side tells, at any values of the other states.

use arclength_ode::Model;

/// Absolute tolerance of a state that stays zero by itself: below it double precision has no numbers before long.
const SMALLEST: f64 = 1e-100;
/// Sets of small states that are looked at: beyond, none is.
const MOST_SETS: usize = 500;
/// Values of the other states are looked at this many times.
const SAMPLES: usize = 3;
/// The fractional parts of multiples of the golden ratio fill an interval evenly.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// For every state the absolute tolerance that its smallest values ask for, where a state of size one has `absolute`.
pub(super) fn absolute_tolerances(
    model: &Model,
    parameters: &[f64],
    (time, start): (f64, &[f64]),
    absolute: f64,
) -> Vec<f64> {
    let n = start.len();
    let mut tolerances = vec![absolute; n];
    if n > MOST_SETS {
        return tolerances;
    }
    for (index, tolerance) in tolerances.iter_mut().enumerate() {
        if stay_zero(model, parameters, time, &[index], n) {
            *tolerance = SMALLEST.min(absolute);
        }
    }
    // Those that only stay zero together: the smallest ones first.
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|one, other| start[*one].abs().total_cmp(&start[*other].abs()));
    for count in 2..=n {
        let (set, rest) = order.split_at(count);
        let largest = start[set[count - 1]].abs();
        // Between states of one size nothing tells which are the small ones.
        let is_small =
            largest > 0.0 && largest < 1.0 && rest.first().is_none_or(|next| largest < start[*next].abs());
        if is_small && stay_zero(model, parameters, time, set, n) {
            for &index in set {
                tolerances[index] = tolerances[index].min(absolute * largest);
            }
        }
    }
    tolerances
}

/// Whether states that are zero do not move, whatever the others are.
fn stay_zero(model: &Model, parameters: &[f64], time: f64, set: &[usize], states: usize) -> bool {
    let mut rate = vec![0.0; states];
    (0..SAMPLES).all(|sample| {
        let place = |index: usize| ((sample * states + index + 1) as f64 * GOLDEN_RATIO).fract();
        let mut state: Vec<f64> = (0..states).map(|index| 0.1 + place(index)).collect();
        set.iter().for_each(|&index| state[index] = 0.0);
        model.evaluate_at(time + place(states), &state, parameters, &mut rate);
        set.iter().all(|&index| rate[index] == 0.0)
    })
}
