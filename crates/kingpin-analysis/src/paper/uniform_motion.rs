//! Figure 2: the uniform motion against the towing speed.
//!
//! The closed form is drawn; Newton's method on the equilibrium of the vector field, started away from it, is kept
//! beside it as the independent witness.

use super::data::Data;
use super::diagrams_in_space::stability_word;
use super::drawing::Drawing;
use super::numbers::number;
use super::wheel::paper_wheel;
use crate::error::Error;
use kingpin::{Key, UniformMotion};
use kingpin_figure::{Axis, Branch, Curve, Figure, Marker, MarkerShape, Markers, Panel, Stability, palette};

/// Caster length and turning radius of the figure, in m.
const CASTER_LENGTH: f64 = 0.08;
const RADIUS: f64 = 1.0;
/// Largest speed of the figure in m/s.
const FASTEST: f64 = 12.0;
/// Speeds at which the motion is computed.
const SPEEDS: usize = 240;
/// Newton's method starts at the closed form with every state shifted by this part of its scale.
const SHIFT: f64 = 0.02;

/// The uniform motion along the speeds of the figure.
pub(super) struct UniformMotions {
    /// The closed form.
    pub closed_form: Vec<UniformMotion>,
    /// The same by Newton's method, from a start away from it.
    pub newton: Vec<UniformMotion>,
    /// The critical speed in m/s.
    pub critical_speed: f64,
}

impl UniformMotions {
    pub(super) fn compute() -> Result<Self, Error> {
        let mut closed_form = Vec::with_capacity(SPEEDS);
        let mut newton = Vec::with_capacity(SPEEDS);
        for index in 1..=SPEEDS {
            let speed = FASTEST * index as f64 / SPEEDS as f64;
            let wheel = paper_wheel(speed, CASTER_LENGTH, RADIUS)?;
            let motion = wheel.uniform_motion()?;
            let scale = [CASTER_LENGTH, CASTER_LENGTH, 1.0, speed, speed / RADIUS];
            let mut start = motion.state();
            for (value, scale) in start.iter_mut().zip(scale) {
                *value += SHIFT * scale;
            }
            newton.push(wheel.uniform_motion_near(&start).ok_or_else(|| {
                Error::not_found("uniform motion by Newton's method", &format!("v = {speed} m/s"))
            })?);
            closed_form.push(motion);
        }
        let wheel = paper_wheel(FASTEST, CASTER_LENGTH, RADIUS)?;
        let critical = wheel
            .critical_speed()
            .ok_or_else(|| Error::not_found("critical speed", &format!("l = {CASTER_LENGTH} m")))?;
        Ok(Self { closed_form, newton, critical_speed: critical.speed })
    }

    pub(super) fn drawing(&self) -> Drawing {
        let speed = || Axis::new("$v$ (m/s)").limits(0.0, FASTEST);
        let newton =
            self.newton.iter().step_by(8).map(|motion| (speed_of(motion), 1e3 * beyond_rounding(motion.u())));
        let figure = Figure::single_column()
            .height_mm(112.0)
            .description(
                "Lateral displacement, longitudinal displacement and caster angle of the uniform motion \
                 against the towing speed",
            )
            .panel(
                Panel::new(speed().without_labels(), Axis::new("$q_0$ (mm)"))
                    .tag("(a)")
                    .curve(self.branch(0.0, |motion| 1e3 * motion.q())),
            )
            .panel(
                Panel::new(speed().without_labels(), Axis::new("$u_0$ (mm)").limits(-1.0, 1.0))
                    .tag("(b)")
                    .curve(self.branch(0.0, |motion| 1e3 * beyond_rounding(motion.u())))
                    .markers(
                        Markers::new(
                            newton,
                            Marker::new(MarkerShape::Circle).size(2.0).color(palette::VERMILION),
                        )
                        .legend("Newton's method"),
                    ),
            )
            .panel(
                Panel::new(speed(), Axis::new("$\\psi_0$ (rad)"))
                    .tag("(c)")
                    .curve(self.branch((CASTER_LENGTH / RADIUS).asin(), UniformMotion::psi)),
            );
        let mut data = Data::new(&[
            ("v", "m/s"),
            ("q0", "m"),
            ("u0", "m"),
            ("psi0", "rad"),
            ("V0", "m/s"),
            ("u0 by Newton's method", "m"),
            ("stability", ""),
        ]);
        for (motion, newton) in self.closed_form.iter().zip(&self.newton) {
            data.push([
                speed_of(motion).into(),
                motion.q().into(),
                beyond_rounding(motion.u()).into(),
                motion.psi().into(),
                motion.forward_speed().into(),
                beyond_rounding(newton.u()).into(),
                stability_word(motion.is_stable()).into(),
            ]);
        }
        let caption = format!(
            "Uniform motion at <i>l</i> = {CASTER_LENGTH} m, <i>r</i> = {RADIUS} m: lateral displacement <i>q</i><sub>0</sub>, \
             longitudinal displacement <i>u</i><sub>0</sub> and caster angle <i>ψ</i><sub>0</sub>, from the closed form; \
             dashed where unstable (beyond {:.4} m/s). In (b) it is zero exactly; the dots are what Newton's method finds, zero but \
             for rounding (at most {} m).",
            self.critical_speed,
            number(self.largest_longitudinal_displacement(), 2)
        );
        Drawing { number: 2, figure, data, caption }
    }

    /// Largest absolute value of `u0` that Newton's method finds, in m.
    pub(super) fn largest_longitudinal_displacement(&self) -> f64 {
        self.newton.iter().map(|motion| motion.u().abs()).fold(0.0, f64::max)
    }

    /// A quantity against the speed, from its limit at standstill on; dashed beyond the critical speed.
    fn branch(&self, at_standstill: f64, quantity: impl Fn(&UniformMotion) -> f64) -> Curve {
        let start = ((0.0, at_standstill), Stability::Stable);
        let points = self.closed_form.iter().map(|motion| {
            ((speed_of(motion), quantity(motion)), Stability::from(motion.is_stable() == Some(true)))
        });
        Branch::new(std::iter::once(start).chain(points)).color(palette::BLUE).into()
    }
}

/// A displacement in m without what rounding can make of zero, a unit in the last place of the caster length.
fn beyond_rounding(displacement: f64) -> f64 {
    if displacement.abs() <= f64::EPSILON * CASTER_LENGTH { 0.0 } else { displacement }
}

fn speed_of(motion: &UniformMotion) -> f64 {
    motion.wheel().get(Key::V)
}
