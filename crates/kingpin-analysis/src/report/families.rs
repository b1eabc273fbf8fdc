//! Limit cycles over the speed for several caster lengths and on several circles, as figures 5 and 6 of the paper, on axes that fit the wheel:
//! how large they are, and how much of the friction they take.

use super::cycles::follow;
use super::finding::Finding;
use super::illustration::Illustration;
use crate::axis_label;
use crate::chart::COLORS;
use crate::cycles::{CyclePointResult, CyclesResult, needs_more_friction, stability};
use crate::error::Error;
use crate::wheel_request::WheelRequest;
use arclength_analysis::{Assignment, Control};
use kingpin::{Key, Wheel};
use kingpin_figure::{
    Axis, Branch, Dash, Figure, Legend, LegendEntry, Line, Marker, MarkerShape, Markers, Panel, palette,
};
use kingpin_report::Columns;
use kingpin_report::numbers::readable;

/// Caster lengths, as parts of that of the wheel.
const LENGTHS: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Radii of the circles in m, beside that of the wheel.
const RADII: [f64; 4] = [1.0, 2.0, 5.0, f64::INFINITY];
/// Friction that is drawn, as part of mu_s N.
const FRICTION: [f64; 2] = [1e-2, 1e3];

/// The cycles of the wheel with one value of a key.
struct Member {
    value: f64,
    /// Nothing where none is born.
    cycles: Option<CyclesResult>,
}

/// The cycles for several values of one key.
pub(super) struct Family {
    key: Key,
    fastest: f64,
    members: Vec<Member>,
    /// Why those of some values could not be followed.
    problems: Vec<String>,
}

impl Family {
    /// Cycles for several caster lengths.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(super) fn of_lengths(
        request: &WheelRequest,
        wheel: &Wheel,
        fastest: f64,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let own = wheel.get(Key::L);
        Self::follow(
            request,
            (Key::L, &LENGTHS.map(|part| part * own)),
            [wheel.get(Key::V), fastest],
            control,
        )
    }

    /// Cycles on several circles.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub(super) fn of_radii(
        request: &WheelRequest,
        wheel: &Wheel,
        fastest: f64,
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let own = wheel.get(Key::TurningRadius);
        let mut radii = RADII.to_vec();
        if !radii.contains(&own) {
            radii.push(own);
            radii.sort_by(f64::total_cmp);
        }
        Self::follow(request, (Key::TurningRadius, &radii), [wheel.get(Key::V), fastest], control)
    }

    fn follow(
        request: &WheelRequest,
        (key, values): (Key, &[f64]),
        [speed, fastest]: [f64; 2],
        control: &Control<'_>,
    ) -> Result<Self, Error> {
        let mut family = Self { key, fastest, members: Vec::new(), problems: Vec::new() };
        for &value in values {
            let mut request = request.clone();
            let given = if value.is_infinite() { "inf".to_owned() } else { value.to_string() };
            request.set.push(Assignment { key: key.name().to_owned(), value: given });
            match follow(&request, [speed, fastest], &control.quiet()) {
                Ok(cycles) => family.members.push(Member { value, cycles }),
                Err(Error::Stopped) => return Err(Error::Stopped),
                Err(error) => family.problems.push(format!("{}: {error}", family.named(value))),
            }
        }
        Ok(family)
    }

    /// A value with its unit.
    fn named(&self, value: f64) -> String {
        if value.is_infinite() {
            return format!("{} = inf", self.key.name());
        }
        format!("{} = {} {}", self.key.name(), readable(value), self.key.unit())
    }

    /// Those of which there are cycles, each with its colour.
    fn drawn(&self) -> impl Iterator<Item = (f64, &CyclesResult)> {
        self.members.iter().filter_map(|member| Some((member.value, member.cycles.as_ref()?)))
    }

    /// What is said of it.
    pub(super) fn finding(&self, subject: String) -> Finding {
        let born: Vec<String> = self.drawn().map(|(value, _)| self.named(value)).collect();
        let others = self.members.iter().filter(|member| member.cycles.is_none());
        let others: Vec<String> = others.map(|member| self.named(member.value)).collect();
        let fastest = readable(self.fastest);
        let mut said = Vec::new();
        if !born.is_empty() {
            said.push(format!(
                "Limit cycles are born of the uniform motion up to {fastest} m/s at {}",
                born.join(", ")
            ));
        }
        if !others.is_empty() {
            said.push(format!("None is born up to {fastest} m/s at {}", others.join(", ")));
        }
        said.extend(self.problems.iter().map(|problem| format!("Not followed at {problem}")));
        Finding::new(subject, said.join(". ") + ".", "").undecided_if(!self.problems.is_empty())
    }

    /// The cycles over the speed; nothing where there are none.
    pub(super) fn illustration(&self) -> Option<Illustration> {
        self.drawn().next()?;
        let speed = || Axis::new(axis_label::of(Key::V)).limits(0.0, self.fastest);
        let mut angles = Panel::new(speed().without_labels(), Axis::new("$\\psi_{\\mathrm{max}}$ (rad)"))
            .tag("(a)")
            .legend(Legend::None);
        let friction =
            Axis::new("$|T|_{\\mathrm{max}}/(\\mu_{\\mathrm{s}}N)$").limits(FRICTION[0], FRICTION[1]);
        let whole = Line::new([(0.0, 1.0), (self.fastest, 1.0)]).color(palette::GREY);
        let mut used =
            Panel::new(speed(), friction.logarithmic()).tag("(b)").legend(Legend::Below).curve(whole);
        for ((value, cycles), color) in self.drawn().zip(COLORS) {
            for branch in &cycles.branches {
                let points: Vec<&CyclePointResult> =
                    cycles.points.iter().filter(|point| point.branch == branch.branch).collect();
                let curve = |ordinate: &dyn Fn(&CyclePointResult) -> f64| {
                    let place = |point: &&CyclePointResult| (point.cycle.value, ordinate(point));
                    Branch::new(points.iter().map(|point| (place(point), stability(point))))
                        .dotted(points.iter().map(|point| needs_more_friction(point)))
                        .color(color)
                };
                angles = angles.curve(curve(&|point| point.psi_max));
                used = used.curve(curve(&|point| point.forces.friction_ratio_max.unwrap_or(f64::NAN)));
                let limits = points.iter().filter(|point| point.is_rolling_limit());
                let places: Vec<(f64, f64)> =
                    limits.map(|point| (point.cycle.value, point.psi_max)).collect();
                let marker = Marker::new(MarkerShape::Square).open().color(color);
                angles = angles.markers(Markers::new(places, marker));
            }
            used = used.legend_entry(LegendEntry::line(self.legend(value), color, Dash::Solid));
        }
        let figure = Figure::single_column()
            .height_mm(120.0)
            .description(format!(
                "Largest caster angle and friction of limit cycles over the speed for several values of {}",
                self.key.name()
            ))
            .panel(angles)
            .panel(used);
        Some(Illustration { figure, data: self.data(), caption: self.caption() })
    }

    /// A value in the legend.
    fn legend(&self, value: f64) -> String {
        let symbol = axis_label::symbol(self.key);
        if value.is_infinite() {
            return format!("{symbol} = $\\infty$");
        }
        format!("{symbol} = {} {}", readable(value), self.key.unit())
    }

    fn caption(&self) -> String {
        let of = if self.key == Key::L { "for several caster lengths" } else { "on several circles" };
        format!(
            "Limit cycles over the speed {of}: their largest caster angle, and the largest friction that they take; solid where stable, \
             dashed where unstable, dotted where that exceeds what there is, from the squares on. The grey line is all there is."
        )
    }

    fn data(&self) -> Columns {
        let points: Vec<(f64, &CyclePointResult)> = self
            .drawn()
            .flat_map(|(value, cycles)| cycles.points.iter().map(move |point| (value, point)))
            .collect();
        let numbers =
            |quantity: fn(&CyclePointResult) -> f64| points.iter().map(move |(_, point)| quantity(point));
        Columns::new()
            .numbers(self.key.name(), points.iter().map(|(value, _)| *value))
            .unit(self.key.unit())
            .counts("branch", points.iter().map(|(_, point)| point.branch))
            .texts("label", points.iter().map(|(_, point)| point.cycle.label.clone()))
            .numbers("v", numbers(|point| point.cycle.value))
            .unit("m/s")
            .numbers("period", numbers(|point| point.cycle.period))
            .unit("s")
            .numbers("psi_max", numbers(|point| point.psi_max))
            .unit("rad")
            .numbers("psi_min", numbers(|point| point.psi_min))
            .unit("rad")
            .optional_numbers(
                "friction_used",
                points.iter().map(|(_, point)| point.forces.friction_ratio_max),
            )
            .booleans("stable", points.iter().map(|(_, point)| point.cycle.stable))
            .booleans("rolls", points.iter().map(|(_, point)| point.forces.rolls))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's wheel at r = 1 m has the Hopf point at 8.431 m/s, from which the cycles reach 1 rad, and none in straight towing, where
    /// l = 0.08 m is longer than critical.
    #[test]
    fn the_cycles_of_the_paper_on_several_circles() {
        let wheel = Wheel::default();
        let family = Family::of_radii(&WheelRequest::default(), &wheel, 10.0, &Control::none()).unwrap();
        let values: Vec<f64> = family.drawn().map(|(value, _)| value).collect();
        assert!(values.contains(&1.0) && !values.contains(&f64::INFINITY), "{values:?}");
        let told = family.finding("limit cycles over r".to_owned());
        assert!(told.text.contains("at r = 1 m") && told.text.contains("r = inf"), "{}", told.text);
        let shown = family.illustration().unwrap();
        let mut csv = Vec::new();
        shown.data.write_csv(&mut csv).unwrap();
        let csv = String::from_utf8(csv).unwrap();
        assert!(csv.lines().next().unwrap().contains("friction_used"), "{csv}");
        assert!(csv.lines().any(|line| line.contains("HB1") && line.contains("8.431")), "{csv}");
    }
}
