//! The uniform motion on a circle over the speed: where it rolls, and how much of the friction it uses.

use super::finding::Finding;
use super::illustration::Illustration;
use crate::axis_label;
use crate::error::Error;
use kingpin::{Key, UniformMotion, Wheel};
use kingpin_figure::{Axis, Branch, Curve, Dash, Figure, Line, Panel, Stability, palette};
use kingpin_report::Columns;
use kingpin_report::numbers::{readable, significant};

/// Speeds at which the motion is computed.
const SPEEDS: usize = 400;
/// Halvings between two of them.
const HALVINGS: usize = 60;

/// The uniform motions of a wheel over the speed.
pub(super) struct Motions {
    radius: f64,
    fastest: f64,
    motions: Vec<UniformMotion>,
    /// Speeds at which rolling begins or ends, with whether it rolls from there on.
    changes: Vec<(f64, bool)>,
}

/// Part of the static friction that a motion takes.
fn friction_used(motion: &UniformMotion) -> f64 {
    let contact = motion.contact_force();
    contact.friction() / contact.limit
}

impl Motions {
    /// Up to a speed, as far as there is one.
    ///
    /// # Errors
    /// There is none at any of the speeds.
    pub(super) fn compute(wheel: &Wheel, fastest: f64) -> Result<Self, Error> {
        let at =
            |speed: f64| -> Result<UniformMotion, Error> { Ok(wheel.with(Key::V, speed)?.uniform_motion()?) };
        let speed = |index: usize| fastest * index as f64 / SPEEDS as f64;
        let mut motions = vec![at(speed(1))?];
        for index in 2..=SPEEDS {
            match at(speed(index)) {
                Ok(motion) => motions.push(motion),
                Err(_) => break,
            }
        }
        let mut changes = Vec::new();
        for pair in motions.windows(2) {
            let [before, after] = [&pair[0], &pair[1]];
            if before.rolls() == after.rolls() {
                continue;
            }
            let [mut low, mut high] = [before, after].map(|motion| motion.wheel().get(Key::V));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if at(middle)?.rolls() == before.rolls() { low = middle } else { high = middle }
            }
            changes.push((0.5 * (low + high), after.rolls()));
        }
        Ok(Self { radius: wheel.get(Key::TurningRadius), fastest, motions, changes })
    }

    /// Where it rolls, in a few words.
    pub(super) fn in_short(&self) -> String {
        let circle = format!("at r = {} m", readable(self.radius));
        match (self.changes.as_slice(), self.motions[0].rolls()) {
            ([], true) => format!("it rolls at every speed {circle}"),
            ([], false) => format!("it slides at every speed {circle}"),
            (changes, _) => {
                let change = |(speed, rolls): &(f64, bool)| {
                    let what = if *rolls { "rolls" } else { "slides" };
                    format!("{what} from {} m/s on", significant(*speed, 4))
                };
                let said: Vec<String> = changes.iter().map(change).collect();
                format!("the wheel {} {circle}", said.join(" and "))
            }
        }
    }

    /// What is said of it.
    pub(super) fn finding(&self, subject: String) -> Finding {
        let reach = self.motions.last().map_or(self.fastest, |motion| motion.wheel().get(Key::V));
        let rolls_first = self.motions[0].rolls();
        let mut text = match (self.changes.as_slice(), rolls_first) {
            ([], true) => {
                format!("The uniform motion rolls at every speed up to {} m/s", readable(reach))
            }
            ([], false) => {
                "At every speed the uniform motion takes more friction than the ground can supply: it slides"
                    .to_owned()
            }
            (changes, _) => {
                let said = changes.iter().map(|(speed, rolls)| {
                    format!(
                        "{} from {} m/s on",
                        if *rolls { "rolls" } else { "slides" },
                        significant(*speed, 5)
                    )
                });
                format!("In uniform motion the wheel {}", said.collect::<Vec<_>>().join(" and "))
            }
        };
        if self.motions.len() < SPEEDS {
            text += &format!("; there is none beyond {} m/s", readable(reach));
        }
        let largest = self.motions.iter().map(|motion| motion.residual().abs()).fold(0.0, f64::max);
        let check = format!(
            "The friction of the motion, compared with mu_s N at {} speeds and halved between; the equations of motion are left with {} \
             at most.",
            self.motions.len(),
            significant(largest, 2)
        );
        Finding::new(subject, text + ".", check)
    }

    /// The motions over the speed.
    pub(super) fn illustration(&self) -> Illustration {
        let speed = || Axis::new(axis_label::of(Key::V)).limits(0.0, self.fastest);
        let whole = Line::new([(0.0, 1.0), (self.fastest, 1.0)]).color(palette::GREY).dash(Dash::Dotted);
        let figure = Figure::single_column()
            .height_mm(112.0)
            .description("Lateral displacement, caster angle and friction used by the uniform motion over the towing speed")
            .panel(
                Panel::new(speed().without_labels(), Axis::new("$q_0$ (mm)"))
                    .tag("(a)")
                    .curve(self.branch(|motion| 1e3 * motion.q())),
            )
            .panel(
                Panel::new(speed().without_labels(), Axis::new("$\\psi_0$ (rad)"))
                    .tag("(b)")
                    .curve(self.branch(UniformMotion::psi)),
            )
            .panel(
                Panel::new(speed(), Axis::new("$|T|/(\\mu_{\\mathrm{s}}N)$"))
                    .tag("(c)")
                    .curve(whole)
                    .curve(self.branch(friction_used)),
            );
        let numbers = |quantity: fn(&UniformMotion) -> f64| self.motions.iter().map(quantity);
        let data = Columns::new()
            .numbers("v", numbers(|motion| motion.wheel().get(Key::V)))
            .unit("m/s")
            .numbers("q", numbers(UniformMotion::q))
            .unit("m")
            .numbers("psi", numbers(UniformMotion::psi))
            .unit("rad")
            .numbers("friction_force", numbers(|motion| motion.contact_force().friction()))
            .unit("N")
            .numbers("friction_used", numbers(friction_used))
            .booleans("stable", self.motions.iter().map(UniformMotion::is_stable))
            .booleans("rolls", self.motions.iter().map(UniformMotion::rolls));
        let caption = format!(
            "Uniform motion at <i>r</i> = {} m: lateral displacement of the king pin, caster angle, and the part of the static friction that \
             rolling takes (above 1 it slides); solid where stable, dashed where it is not or that is undecided.",
            readable(self.radius)
        );
        Illustration { figure, data, caption }
    }

    fn branch(&self, quantity: impl Fn(&UniformMotion) -> f64) -> Curve {
        let points = self.motions.iter().map(|motion| {
            let place = (motion.wheel().get(Key::V), quantity(motion));
            (place, Stability::from(motion.is_stable() == Some(true)))
        });
        Branch::new(points).color(palette::BLUE).into()
    }
}
