//! The uniform motion in diagrams of the caster angle over a parameter.

use crate::along::drawn_as;
use kingpin::Wheel;
use kingpin::branches::Along;
use kingpin_figure::{Branch, Dash, LegendEntry, Stability, palette};

/// Values of the parameter at which the uniform motion is drawn.
const UNIFORM_MOTIONS: usize = 400;

/// A point of the curve with its stability, and whether the wheel does not roll there.
pub(crate) type UniformPoint = ((f64, f64), Stability, bool);

/// What is dashed and dotted in a diagram.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dashes {
    /// Whether anything is dashed, which means that it is not stable.
    pub unstable: bool,
    /// Whether anything is dotted, which means that the wheel cannot roll like this.
    pub slides: bool,
}

impl Dashes {
    /// Those of two parts of a diagram.
    pub(crate) fn and(self, unstable: bool, slides: bool) -> Self {
        Self { unstable: self.unstable || unstable, slides: self.slides || slides }
    }

    /// What they mean.
    pub(crate) fn legend(self) -> impl Iterator<Item = LegendEntry> {
        let entries = [
            (self.unstable, "unstable", Dash::Dashed),
            (self.slides, "needs more than $\\mu_s N$", Dash::Dotted),
        ];
        let drawn = entries.into_iter().filter(|(is_drawn, ..)| *is_drawn);
        drawn.map(|(_, name, dash)| LegendEntry::line(name, palette::BLACK, dash))
    }
}

/// The uniform motion where it exists, its stability changing exactly at the points given, dotted where it does not roll; and what of it
/// is dashed and dotted.
pub(crate) fn uniform_motion(
    wheel: &Wheel,
    along: &Along,
    mut points: Vec<UniformPoint>,
) -> (Branch, Dashes) {
    let (key, abscissa) = drawn_as(along);
    let (start, end) = along.ends();
    let (start, end) = (abscissa(start), abscissa(end));
    let (low, high) = (start.min(end), start.max(end));
    for index in 0..=UNIFORM_MOTIONS {
        let value = low + (high - low) * index as f64 / UNIFORM_MOTIONS as f64;
        let motion = wheel.with(key, value).and_then(|wheel| wheel.uniform_motion());
        // Outside its range there is nothing to draw.
        if let Ok(motion) = motion {
            let stability = Stability::from(motion.is_stable() == Some(true));
            points.push(((value, motion.psi()), stability, !motion.rolls()));
        }
    }
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let dotted: Vec<bool> = points.iter().map(|(_, _, slides)| *slides).collect();
    let dashes = Dashes {
        unstable: points.iter().any(|(_, stability, slides)| *stability == Stability::Unstable && !slides),
        slides: dotted.contains(&true),
    };
    let branch = Branch::new(points.into_iter().map(|(place, stability, _)| (place, stability)));
    (branch.dotted(dotted), dashes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kingpin::Key;

    #[test]
    fn legends_list_only_what_is_drawn() {
        for (load, fastest, expected) in
            [(0.0, 5.0, [false, true]), (-1e3, 5.0, [false, false]), (-1e3, 10.0, [true, false])]
        {
            let wheel = Wheel::default().with(Key::FAz, load).unwrap();
            let (_, dashes) = uniform_motion(&wheel, &Along::new(Key::V, 3.0, fastest).unwrap(), Vec::new());
            assert_eq!([dashes.unstable, dashes.slides], expected, "{load} {fastest}");
            assert_eq!(dashes.legend().count(), expected.into_iter().filter(|drawn| *drawn).count());
        }
    }
}
