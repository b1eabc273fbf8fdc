//! Whether something may hide between two solutions whose test functions have the signs that they should have: two points of one
//! kind in one step leave no trace in signs and counts.
//!
//! Every growth exponent is followed from one solution to the other by values and rates, and so are the parameter, which may turn
//! twice, and test functions that are not made of exponents. Where rates cost a solution of their own they are computed only if
//! a quantity comes close to zero compared with its changes from step to step.

use super::memory::Memory;
use super::node::Node;
use super::path::{Path, Suspicion, partners};
use crate::continuation::{Curve, Settings};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Exponents of multipliers below this at both ends are those of directions that die out in one period.
const DEAD: f64 = -20.0;
/// Exponents of multipliers below this are far inside the circle, and the angle in rad by which others turn in a step at most.
const INSIDE: f64 = -1.0;
const FARTHEST_TURN: f64 = 2.0;
/// A quantity that changes by less than this part of itself in a step does not pass zero unseen.
const PLAUSIBLE: f64 = 1.0;

/// The part of the step at which to look, if any. `most_crossings` are the largest numbers of exponents, real ones and members of
/// complex pairs, that the changes of sign let cross the axis.
pub(super) fn suspicious<C: Curve>(
    curve: &mut C,
    [before, after]: [&mut Node<C>; 2],
    length: f64,
    memory: &Memory,
    (most_crossings, settings): ([usize; 2], &Settings),
) -> Option<Suspicion> {
    turns_twice(curve, before, after, length).or_else(|| turns_around(before, after)).or_else(|| {
        let rates_cost_nothing = curve.exponent_rates(&before.solution).is_some();
        let (known, unknown): (Vec<usize>, Vec<usize>) =
            own_tests(curve).into_iter().partition(|&index| before.known_rate(curve, index).is_some());
        if !rates_cost_nothing && !plausible(before, after, &known, memory) {
            return tests_hide(curve, before, after, length, (&known, settings));
        }
        if !rates_cost_nothing || (!before.readings.is_empty() && !unknown.is_empty()) {
            // Both are computed before either is used, so that what is found does not depend on which is looked at first.
            before.rates(curve, length, settings)?;
            after.rates(curve, length, settings)?;
        }
        let own: Vec<usize> = own_tests(curve);
        exponents_hide(curve, before, after, length, (most_crossings, settings))
            .or_else(|| tests_hide(curve, before, after, length, (&own, settings)))
    })
}

/// Whether a multiplier turns so far around the circle that it is not known which became which: real ones of both signs have been a pair in
/// between, which may have been inside the circle.
fn turns_around<C: Curve>(before: &Node<C>, after: &Node<C>) -> Option<Suspicion> {
    let (one, other) = (&before.spectrum, &after.spectrum);
    if !one.is_periodic {
        return None;
    }
    let indices = partners(one, other, None);
    let turned = one.exponents.iter().zip(indices).any(|(here, partner)| {
        let there = other.exponents[partner];
        let turn = (there.im - here.im).rem_euclid(TAU);
        here.re.min(there.re) > INSIDE && turn.min(TAU - turn) > FARTHEST_TURN
    });
    turned.then(|| Suspicion::at(0.5))
}

/// Test functions that are not made of exponents.
fn own_tests<C: Curve>(curve: &C) -> Vec<usize> {
    let tests = curve.test_functions();
    (0..tests.len()).filter(|&index| !tests[index].of_spectrum && !tests[index].is_turn).collect()
}

/// Whether an exponent or a test function, but for those whose rates are `known`, comes close to zero compared with its changes.
fn plausible<C: Curve>(before: &Node<C>, after: &Node<C>, known: &[usize], memory: &Memory) -> bool {
    let indices = partners(&before.spectrum, &after.spectrum, None);
    let exponents =
        before.spectrum.exponents.iter().zip(indices).enumerate().map(|(index, (here, partner))| {
            let change = memory.change_of_exponent(&before.spectrum, index);
            (here.re, after.spectrum.exponents[partner].re, change)
        });
    let readings = before.readings.iter().zip(&after.readings).enumerate().filter_map(|(index, pair)| {
        let (Some(here), Some(there)) = pair else { return None };
        if known.contains(&index) {
            return None;
        }
        Some((here.value, there.value, memory.change_of_reading(index, here.value)))
    });
    exponents.filter(|(here, there, _)| *here > DEAD || *there > DEAD).chain(readings).any(
        |(here, there, change)| PLAUSIBLE * here.abs().min(there.abs()) < change.max((there - here).abs()),
    )
}

fn exponents_hide<C: Curve>(
    curve: &mut C,
    before: &mut Node<C>,
    after: &mut Node<C>,
    length: f64,
    (most_crossings, settings): ([usize; 2], &Settings),
) -> Option<Suspicion> {
    let noise = before.spectrum.noise.max(after.spectrum.noise);
    let per_step =
        |rates: &[Complex64]| -> Vec<Complex64> { rates.iter().map(|rate| rate * length).collect() };
    let ahead = per_step(&before.rates(curve, length, settings)?.exponents);
    let behind = per_step(&after.rates(curve, length, settings)?.exponents);
    let (one, other) = (&before.spectrum, &after.spectrum);
    let indices = partners(one, other, Some((&ahead, &behind)));
    let mut crossings = [0, 0];
    for (index, partner) in indices.into_iter().enumerate() {
        let (here, there) = (one.exponents[index], *other.exponents.get(partner)?);
        if here.re.max(there.re) < DEAD && one.is_periodic {
            continue;
        }
        if here.re.abs() <= noise || there.re.abs() <= noise {
            continue;
        }
        // Real ones that meet in between may be either.
        let is_real = [here, there].map(|exponent| one.is_real(exponent));
        if (here.re > 0.0) != (there.re > 0.0) && is_real[0] == is_real[1] {
            crossings[usize::from(!is_real[0])] += 1;
        }
        let path = Path::new([here.re, there.re], [ahead[index].re, behind[partner].re]);
        if let Some(suspicion) = path.suspicious() {
            return Some(suspicion);
        }
    }
    // Some cross in one direction and as many in the other.
    (crossings[0] > most_crossings[0] || crossings[1] > most_crossings[1]).then(|| Suspicion::at(0.5))
}

fn tests_hide<C: Curve>(
    curve: &mut C,
    before: &mut Node<C>,
    after: &mut Node<C>,
    length: f64,
    (indices, settings): (&[usize], &Settings),
) -> Option<Suspicion> {
    indices.iter().find_map(|&index| {
        let (here, there) = (before.readings[index]?, after.readings[index]?);
        let noise = here.noise.max(there.noise);
        if here.class != there.class || here.value.abs() <= noise || there.value.abs() <= noise {
            return None;
        }
        let mut rate = |node: &mut Node<C>| match node.known_rate(curve, index) {
            Some(rate) => Some(rate),
            None => node.rates(curve, length, settings)?.readings[index],
        };
        let [ahead, behind] = [length * rate(before)?, length * rate(after)?];
        Path::new([here.value, there.value], [ahead, behind]).suspicious()
    })
}

/// Where the parameter, a cubic of the arc length, may turn twice. Its rates at both ends are known.
fn turns_twice<C: Curve>(curve: &C, before: &Node<C>, after: &Node<C>, length: f64) -> Option<Suspicion> {
    let index = curve.test_functions().iter().position(|test| test.is_turn)?;
    let (here, there) = (before.readings[index]?, after.readings[index]?);
    if (here.value > 0.0) != (there.value > 0.0) {
        return None;
    }
    let parameter = before.solution.unknown.len() - 1;
    let rate = |node: &Node<C>| node.solution.tangent[parameter] / node.stretch(curve);
    let (one, other) = (rate(before), rate(after));
    let mean = (after.solution.unknown[parameter] - before.solution.unknown[parameter]) / length;
    // Derivative of the cubic: one + s (6 mean - 4 one - 2 other) + s^2 (3 one + 3 other - 6 mean).
    let (linear, quadratic) = (6.0 * mean - 4.0 * one - 2.0 * other, 3.0 * (one + other) - 6.0 * mean);
    let s = -0.5 * linear / quadratic;
    let extreme = one + s * (linear + s * quadratic);
    let near = extreme * one.signum() < super::path::SUSPICIOUS * one.abs().min(other.abs());
    (s > 0.0 && s < 1.0 && near).then(|| Suspicion::at(s))
}
