//! What the paper does not ask of its cycles: whether the wheel can roll on them.

use super::claim::{Claim, Verdict};
use crate::error::Error;
use crate::paper::branches::{Branch, Branches, COMPARED_SPEEDS, FIGURE_5_RADIUS, FIGURE_6_LENGTH};
use crate::paper::numbers::{number, per_cent};
use crate::paper::rolling_limit::HEAVIEST;
use kingpin::Key;

pub(in crate::paper) fn claims(branches: &Branches) -> Result<Vec<Claim>, Error> {
    let missing = || Error::not_found("branch", &format!("l = {FIGURE_6_LENGTH} m, r = {FIGURE_5_RADIUS} m"));
    let branch = branches.branch(FIGURE_6_LENGTH, FIGURE_5_RADIUS).ok_or_else(missing)?;
    let mut parts = Vec::new();
    for speed in COMPARED_SPEEDS {
        if let Some((_, forces)) = branch.cycle_at(speed) {
            parts.push(format!("{} N at {speed} m/s", number(forces.friction_max, 4)));
        }
    }
    let (mut beyond, mut all) = (0, 0);
    for branch in branches.iter() {
        beyond += branch.beyond_rolling.iter().filter(|beyond| **beyond).count();
        all += branch.cycles.len();
    }
    let limit = branch.wheel(1.0)?.with(Key::FAz, HEAVIEST)?.static_limit();
    let rolling_up_to = rolls_up_to(branch);
    let until =
        rolling_up_to.map_or_else(String::new, |speed| format!(" It rolls up to {} m/s.", number(speed, 5)));
    Ok(vec![Claim {
        place: "section 4, figures 5 and 6",
        statement: "The limit cycles are those of a wheel that rolls without slip.".into(),
        verdict: if beyond == 0 { Verdict::Confirmed } else { Verdict::Sharpened },
        evidence: format!(
            "The equations hold while the ground supplies the friction, which the paper tests for the uniform motion only. At l = \
             {FIGURE_6_LENGTH} m, r = {FIGURE_5_RADIUS} m the unstable cycle asks for {} at its worst moment; under the largest load of figure 4, \
             {} N, there are {} N.{until} Of the cycles of both figures {} cannot be rolled under that load: there the wheel slides, and the \
             branch is one of ideal rolling only.",
            parts.join(", "),
            HEAVIEST.abs(),
            number(limit, 4),
            per_cent(beyond as f64 / all as f64)
        ),
    }])
}

/// The largest speed of the cycles that are rolled, where others are not.
fn rolls_up_to(branch: &Branch) -> Option<f64> {
    let beyond = &branch.beyond_rolling;
    if !beyond.contains(&true) {
        return None;
    }
    let cycles = beyond.iter().skip(usize::from(branch.hopf.is_some())).zip(&branch.cycles);
    let rolled = cycles.filter(|(beyond, _)| !**beyond).map(|(_, cycle)| cycle.value);
    rolled.reduce(f64::max)
}
