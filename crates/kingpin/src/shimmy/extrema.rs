//! Extrema of the caster angle along a motion, from samples with first and second derivatives.

use super::passage::Passage;
use super::return_map::PSI;
use super::variation::STATES;
use crate::sliding::model::{Equations, SlipState};

/// Halvings of a bracket: enough for every bit of a double.
const BISECTIONS: usize = 60;

/// Time, and the caster angle with its first two derivatives.
pub(crate) type Node = (f64, [f64; 3]);

/// Smallest and largest caster angle: between neighbouring samples, which lie in one passage, the angle is the quintic
/// polynomial with the right values and derivatives at both ends.
pub(super) fn caster_angles(equations: &Equations<f64>, passages: &[Passage]) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut include = |angle: f64| range = [range[0].min(angle), range[1].max(angle)];
    for passage in passages {
        let equations = equations.under(passage.mode.friction_moment);
        let node = |(time, state): (f64, &SlipState)| {
            let mut rate = [0.0; STATES];
            passage.mode.regime.field(&equations, state, &mut rate);
            (time, [state[PSI], rate[PSI], -rate[5]])
        };
        let mut before: Option<Node> = None;
        for after in passage.nodes().map(node) {
            include(after.1[0]);
            if let Some(before) = before.filter(|before| before.1[1] * after.1[1] < 0.0) {
                include(extremum(before, after));
            }
            before = Some(after);
        }
    }
    range
}

/// The extremum between two nodes whose slopes have opposite signs.
pub(crate) fn extremum((start, [a0, a1, a2]): Node, (end, [b0, b1, b2]): Node) -> f64 {
    let h = end - start;
    let (a1, a2, b1, b2) = (a1 * h, a2 * h * h, b1 * h, b2 * h * h);
    let rise = b0 - a0;
    // Quintic Hermite interpolation in powers of the fraction.
    let c = [
        a0,
        a1,
        0.5 * a2,
        10.0 * rise - 6.0 * a1 - 4.0 * b1 - 1.5 * a2 + 0.5 * b2,
        -15.0 * rise + 8.0 * a1 + 7.0 * b1 + 1.5 * a2 - b2,
        6.0 * rise - 3.0 * (a1 + b1) - 0.5 * (a2 - b2),
    ];
    let value = |x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let slope = |x: f64| (1..6).rev().fold(0.0, |sum, k| sum * x + k as f64 * c[k]);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if slope(middle) * a1 > 0.0 { low = middle } else { high = middle }
    }
    value(0.5 * (low + high))
}
