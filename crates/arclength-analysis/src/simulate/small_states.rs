//! States of which the smallest values have digits: populations, infected, modes that grow from next to nothing.
//!
//! Where a state, or a few small ones together, stay zero once they are zero, their growth from the smallest value depends on its own
//! size only: an outbreak from one in a billion comes when its logarithm says, which an absolute tolerance of a thousandth of that
//! spoils.

use arclength_ode::Model;

/// Absolute tolerance of a state that stays zero by itself: below it double precision has no numbers before long.
pub(super) const SMALLEST: f64 = 1e-290;
/// Sets of small states that are looked at: beyond, none is.
const MOST_SETS: usize = 500;

/// For every state the absolute tolerance that its smallest values ask for, where a state of size one has `absolute`.
pub(super) fn absolute_tolerances(model: &Model, start: &[f64], absolute: f64) -> Vec<f64> {
    let n = start.len();
    let largest = start.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    // A motion that starts from small values may stay small.
    let absolute = if largest > 0.0 { absolute * largest.min(1.0) } else { absolute };
    let mut tolerances = vec![absolute; n];
    let Some(vanishing) = model.vanishing().filter(|_| n <= MOST_SETS) else { return tolerances };
    for (index, tolerance) in tolerances.iter_mut().enumerate() {
        if vanishing.stay_zero(&[index]) {
            *tolerance = SMALLEST.min(absolute);
        }
    }
    // Those that only stay zero together: the smallest ones first.
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|one, other| start[*one].abs().total_cmp(&start[*other].abs()));
    for count in 2..n {
        let (set, rest) = order.split_at(count);
        let size = start[set[count - 1]].abs();
        // Between states of one size nothing tells which are the small ones.
        let is_small = size > 0.0 && size < largest && size < start[rest[0]].abs();
        if is_small && vanishing.stay_zero(set) {
            for &index in set {
                tolerances[index] = tolerances[index].min(absolute * size / largest);
            }
        }
    }
    tolerances
}
