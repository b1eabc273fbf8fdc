//! The edges of what the wheel returns from as a result, with the motions on both sides of the nearer one.

use crate::classification::{contact_in_words, end_of_the_model};
use crate::description;
use crate::disturbance::{Edge, nearest, reached};
use crate::margin::Found;
use crate::parameters::parameters_of;
use crate::wheel_request::WheelRequest;
use kingpin::basin::{ClassificationSettings, ContactModel, Disturbance, DisturbedMotion, Fate, SafeKick};
use kingpin::{Key, Tyre, Wheel};
use kingpin_figure::{Axis, Color, Figure, FigureError, Legend, Line, Note, Panel, palette};
use kingpin_report::history::drawn;
use kingpin_report::numbers::{readable, significant};
use kingpin_report::{Columns, Parameters, Report, Schema, Table};
use serde::Serialize;
use std::f64::consts::PI;
use std::io::{self, Write};

/// A motion in which the model ends is replayed for so much longer than until then.
const BEYOND_END: f64 = 1.01;
/// Digits of the time for which a motion is replayed.
const REPLAYED_DIGITS: usize = 4;

/// A motion after a disturbance.
#[derive(Debug, Serialize)]
pub struct DisturbedMotionResult {
    /// Magnitude of the disturbance.
    pub magnitude: f64,
    /// Times in s.
    pub t: Vec<f64>,
    /// Longitudinal displacement of the king pin in m, at every time.
    pub u: Vec<f64>,
    /// Lateral displacement of the king pin in m.
    pub q: Vec<f64>,
    /// Caster angle in rad.
    pub psi: Vec<f64>,
    /// Forward speed of the wheel in m/s.
    #[serde(rename = "V")]
    pub forward_speed: Vec<f64>,
    /// Yaw rate in rad/s.
    #[serde(rename = "Omega")]
    pub yaw_rate: Vec<f64>,
    /// Lateral speed of the wheel centre and speed of the rim, where the wheel may slide.
    #[serde(rename = "V2", skip_serializing_if = "Option::is_none")]
    pub lateral_speed: Option<Vec<f64>>,
    /// Speed of the rim in m/s.
    #[serde(rename = "W", skip_serializing_if = "Option::is_none")]
    pub rim_speed: Option<Vec<f64>>,
    /// Lateral deflection of the tyre in m, where there is one.
    #[serde(rename = "y_t", skip_serializing_if = "Option::is_none")]
    pub deflection: Option<Vec<f64>>,
    /// Speed of the contact point over the ground, where there is no tyre.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slip: Option<Vec<f64>>,
}

impl DisturbedMotionResult {
    fn new(magnitude: f64, motion: DisturbedMotion, model: ContactModel, tyre: Tyre) -> Self {
        let state = |index: usize| motion.states.iter().map(|state| state[index]).collect();
        let slides = model == ContactModel::Sliding;
        let has_tyre = tyre != Tyre::Rigid;
        let slip = || motion.states.iter().map(|state| (state[3] - state[6]).hypot(state[4])).collect();
        Self {
            magnitude,
            u: state(0),
            q: state(1),
            psi: state(2),
            forward_speed: state(3),
            yaw_rate: state(5),
            lateral_speed: (slides || has_tyre).then(|| state(4)),
            rim_speed: slides.then(|| state(6)),
            deflection: has_tyre.then(|| state(6)),
            slip: (!has_tyre).then(slip),
            t: motion.times,
        }
    }
}

/// The edges in both directions.
#[derive(Debug, Serialize)]
pub struct SafeKickResult {
    /// The wheel.
    #[serde(skip)]
    pub wheel: Wheel,
    /// The kind of disturbance.
    pub kind: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// `rolling` or `sliding`.
    pub contact: &'static str,
    /// Time in s for which motions are followed at most.
    pub duration: f64,
    /// Largest magnitude that was tried.
    pub largest: f64,
    /// What a blow of that size would change the speed of wheel and caster by, in m/s.
    pub largest_speed_change: Option<f64>,
    /// Distance of the magnitudes that were tried up to an edge, or to the largest: failures in a narrower range may lie below it.
    pub resolution: f64,
    /// The same just below an edge, as far as `resolution`.
    pub resolution_beside_edge: f64,
    /// The edge in the positive direction.
    pub positive: Option<Edge>,
    /// The edge in the negative direction.
    pub negative: Option<Edge>,
    /// The largest disturbance that returned, in the direction in which fewer do; nothing where it is undecided what lies
    /// beyond.
    pub safe: Option<f64>,
    /// The same of a wheel that may slide under its own weight, where neither the contact nor the load was said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sliding: Option<Found>,
    /// Options of `simulate` that replay the smallest disturbance that did not return; nothing where that is undecided.
    pub replay: Option<String>,
    /// The motion after the largest disturbance that returned; nothing where none is known to.
    pub returns: Option<DisturbedMotionResult>,
    /// The motion after the smallest that did not, or of which that is undecided.
    pub fails: Option<DisturbedMotionResult>,
}

/// What was found.
pub(super) struct Search {
    /// The edges in the positive and in the negative direction.
    pub edges: [Option<Edge>; 2],
    /// Those of a wheel that may slide, where they were sought besides.
    pub sliding: Option<Found>,
    /// The motions on both sides of the nearer edge.
    pub motions: Option<[DisturbedMotion; 2]>,
    /// How the wheel was asked for.
    pub asked: WheelRequest,
}

impl SafeKickResult {
    /// The result of what was found.
    pub(super) fn new(
        wheel: Wheel,
        kind: Disturbance,
        model: ContactModel,
        settings: ClassificationSettings,
        largest: f64,
        Search { edges: [positive, negative], sliding, motions, asked }: Search,
    ) -> Self {
        let edges = [positive, negative];
        let reached = reached(edges.into_iter().take(kind.directions()), largest);
        let smallest = nearest(edges);
        let replayed = motions.as_ref().map_or(settings.duration, |[_, fails]| {
            let last = fails.times.last().copied().unwrap_or(settings.duration);
            // Samples end before the model does.
            fails.model_ends_at.map_or(last, |end| last.max(BEYOND_END * end))
        });
        let (returns, fails) = match (smallest, motions) {
            (Some(edge), Some([returns, fails])) => {
                let result =
                    |magnitude, motion| DisturbedMotionResult::new(magnitude, motion, model, wheel.tyre());
                // The undisturbed motion is none that returned.
                let returns = (edge.returns != 0.0).then(|| result(edge.returns, returns));
                (returns, Some(result(edge.fails, fails)))
            }
            _ => (None, None),
        };
        let replay = smallest.filter(|edge| !edge.is_unstable() && edge.is_found()).and_then(|edge| {
            let disturbance = match kind {
                Disturbance::Impulse => format!("--blow {}", edge.fails),
                Disturbance::ReleaseAngle => format!("--perturb psi={}", edge.fails),
                Disturbance::Jolt | Disturbance::StepSteer => return None,
            };
            let (contact, duration) = (model.name(), rounded_up(replayed));
            Some(format!("{}{disturbance} --contact {contact} --duration {duration}", asked.options()))
        });
        Self {
            wheel,
            kind: kind.name(),
            unit: kind.unit(),
            contact: model.name(),
            duration: settings.duration,
            largest,
            largest_speed_change: (kind == Disturbance::Impulse).then(|| largest / wheel.mass()),
            resolution: SafeKick::resolution(reached),
            resolution_beside_edge: SafeKick::resolution_beside_edge(reached),
            positive,
            negative,
            safe: smallest.filter(|edge| !edge.is_undecided()).map(|edge| edge.returns),
            sliding,
            replay,
            returns,
            fails,
        }
    }

    /// Keys that the disturbance replaces.
    fn replaced(&self) -> &'static [Key] {
        if self.kind == Disturbance::StepSteer.name() { &[Key::TurningRadius] } else { &[] }
    }

    /// The edge that is nearest to the uniform motion.
    pub(crate) fn nearest(&self) -> Option<Edge> {
        nearest([self.positive, self.negative])
    }

    /// After which disturbances the motions are shown, in words.
    pub(crate) fn shown(&self) -> String {
        let kind = self.kind;
        match (&self.returns, self.nearest().is_some_and(|edge| edge.is_found())) {
            (Some(_), true) => format!("the largest {kind} that returns and the smallest that does not"),
            (Some(_), false) => format!("the largest {kind} that returns and one of which that is undecided"),
            (None, _) => format!("the smallest {kind} that was found not to return"),
        }
    }

    fn described(&self, wheel: impl Fn(&Wheel, &[Key]) -> String) -> String {
        let how = contact_in_words(&self.wheel, self.contact);
        format!("{how} at {}", wheel(&self.wheel, self.replaced()))
    }
}

impl SafeKickResult {
    /// Writes the table of the edges in the positive and in the negative direction.
    fn write_edges(&self, out: &mut dyn Write, [positive, negative]: [Option<Edge>; 2]) -> io::Result<()> {
        let unit = self.unit;
        let headings = [
            "direction".to_owned(),
            format!("returns ({unit})"),
            format!("does not ({unit})"),
            "ends in".to_owned(),
        ];
        let mut table = Table::new(headings);
        let both = self.kind != Disturbance::StepSteer.name();
        for (direction, edge) in
            [("positive", positive), ("negative", negative)].into_iter().take(1 + usize::from(both))
        {
            match edge {
                Some(edge) => table.row([
                    direction.into(),
                    if edge.smaller_are_undecided { "undecided".into() } else { edge.returns.into() },
                    if edge.is_unstable() || edge.is_found() {
                        edge.fails.into()
                    } else {
                        "undecided".into()
                    },
                    edge.ending().into(),
                ]),
                None => table.row([
                    direction.into(),
                    None::<f64>.into(),
                    None::<f64>.into(),
                    "all that were tried return".into(),
                ]),
            }
        }
        table.write(out)
    }

    /// The edges of either direction.
    fn edges(&self) -> impl Iterator<Item = Edge> {
        [self.positive, self.negative].into_iter().flatten()
    }

    /// How far apart magnitudes were tried, and so how narrow a range of failures may be that was not seen.
    fn what_was_tried(&self) -> Option<String> {
        let (unit, resolution) = (self.unit, readable(self.resolution));
        match self.nearest().filter(|edge| !edge.is_open()) {
            None => Some(format!(
                "magnitudes were tried {resolution} {unit} apart: failures in a narrower range may lie between"
            )),
            // However small, none returned: there is nothing below.
            Some(_) if self.resolution == 0.0 => None,
            Some(_) => Some(format!(
                "below what does not return magnitudes were tried {resolution} {unit} apart, just below an edge {}: failures in a narrower \
                 range may lie there",
                readable(self.resolution_beside_edge)
            )),
        }
    }

    /// What else is to be known, in sentences.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.edges().any(|edge| edge.none_returns()) {
            remarks.push(
                "from where 0 returns none does, however small: down to a billionth of the largest magnitude none was found to".to_owned(),
            );
        }
        let ends_in = |fate: Fate| self.edges().any(|edge| edge.fate.is_some_and(|ending| ending.0 == fate));
        if ends_in(Fate::Irregular) {
            remarks.push(format!(
                "irregular swinging lasted to the end, up to ten times {} s: whether for ever is undecided",
                readable(self.duration)
            ));
        }
        if ends_in(Fate::ModelEnds) {
            remarks.push(format!(
                "end of the model: {}, and what becomes of the motion is undecided",
                end_of_the_model(&self.wheel)
            ));
        }
        remarks.extend(self.undecided());
        if self.kind == Disturbance::StepSteer.name()
            && let Some(safe) = self.safe.filter(|safe| *safe > 0.0)
        {
            remarks.push(format!("smallest radius from which it returned: {} m", readable(safe.recip())));
        }
        remarks
    }

    /// What is undecided of small motions, or of those beyond what returned.
    fn undecided(&self) -> Option<String> {
        if self.edges().any(|edge| edge.smaller_are_undecided) {
            let ends_elsewhere = self.edges().filter(Edge::is_found).map(|edge| edge.fails.abs());
            let found = match ends_elsewhere.reduce(f64::min) {
                Some(smallest) => {
                    format!(
                        "from {} {} on a motion was found that ends elsewhere",
                        readable(smallest),
                        self.unit
                    )
                }
                None => "of those that were tried none was found that ends elsewhere".to_owned(),
            };
            return Some(format!(
                "undecided: on a circle at this speed it is not known whether small motions, which grow without M_f, die out with it; {found}"
            ));
        }
        self.edges().any(|edge| edge.is_undecided()).then(|| {
            format!(
                "undecided: beyond what returned the motion neither returns nor settles in ten times {} s; a longer --duration may tell",
                readable(self.duration)
            )
        })
    }
}

/// What the picture of a result without motions says.
const NONE_IS_SAFE: &str = "small disturbances grow: none is safe";

impl SafeKickResult {
    /// The picture where there are no motions on two sides of an edge: it says why.
    fn without_motions(&self) -> Figure {
        let tried = format!("{} up to {} {}", self.kind, readable(self.largest), self.unit);
        let [first, second] = match self.nearest() {
            Some(edge) if edge.is_unstable() => [NONE_IS_SAFE.to_owned(), String::new()],
            Some(_) => ["none was found to end elsewhere:".to_owned(), tried],
            None => ["all that were tried return:".to_owned(), tried],
        };
        let sentence = format!("{first} {second}");
        let description = format!("{}: {}", sentence.trim_end(), self.described(description::of));
        let mut panel = Panel::new(
            Axis::new("$t$ (s)").limits(0.0, self.duration),
            Axis::new("$\\psi$ (rad)").limits(-1.0, 1.0),
        )
        .note(Note::new((0.5 * self.duration, 0.1), first));
        if !second.is_empty() {
            panel = panel.note(Note::new((0.5 * self.duration, -0.1), second));
        }
        Figure::single_column().description(description).panel(panel)
    }
}

impl Report for SafeKickResult {
    fn schema(&self) -> Schema {
        Schema::first("kingpin.safe-kick")
    }

    fn parameters(&self) -> Parameters {
        parameters_of(&self.wheel, self.replaced())
    }

    fn write_table(&self, out: &mut dyn Write) -> io::Result<()> {
        let (kind, unit) = (self.kind, self.unit);
        writeln!(out, "{}", self.described(description::on_lines))?;
        let speed_change = self.largest_speed_change.map(|change| {
            format!(" (which changes the speed of wheel and caster by {} m/s)", readable(change))
        });
        writeln!(
            out,
            "{kind} up to {} {unit}{}, motions followed for {} s at most\n",
            readable(self.largest),
            speed_change.unwrap_or_default(),
            readable(self.duration)
        )?;
        self.write_edges(out, [self.positive, self.negative])?;
        let unstable = self.positive.is_some_and(|edge| edge.is_unstable());
        if unstable {
            writeln!(out, "\n{NONE_IS_SAFE}")?;
            return Ok(());
        }
        if let Some(sentence) = self.what_was_tried() {
            writeln!(out, "\n{sentence}")?;
        }
        match &self.sliding {
            Some(Found { problem: Some(problem), .. }) => {
                writeln!(
                    out,
                    "\na wheel that may slide under its own weight (no load F_Az is set): {problem}"
                )?;
            }
            Some(found) => {
                writeln!(out, "\na wheel that may slide under its own weight (no load F_Az is set):\n")?;
                self.write_edges(out, [found.positive, found.negative])?;
            }
            None => {}
        }
        if let Some(replay) = &self.replay {
            writeln!(out, "\nthe smallest that does not return: kingpin simulate {replay}")?;
        }
        self.remarks().iter().try_for_each(|remark| writeln!(out, "\n{remark}"))
    }

    fn columns(&self) -> Columns {
        let motions: Vec<(&str, &DisturbedMotionResult)> =
            [("returns", &self.returns), ("fails", &self.fails)]
                .into_iter()
                .filter_map(|(side, motion)| motion.as_ref().map(|motion| (side, motion)))
                .collect();
        let numbers = |values: fn(&DisturbedMotionResult) -> &Vec<f64>| -> Vec<f64> {
            motions.iter().flat_map(|(_, motion)| values(motion).iter().copied()).collect()
        };
        let sides =
            motions.iter().flat_map(|(side, motion)| motion.t.iter().map(|_| Some((*side).to_owned())));
        let magnitudes = motions.iter().flat_map(|(_, motion)| motion.t.iter().map(|_| motion.magnitude));
        let optional = |columns: Columns,
                        (name, unit): (&str, &str),
                        values: fn(&DisturbedMotionResult) -> &Option<Vec<f64>>| {
            let present = motions.iter().filter_map(|(_, motion)| values(motion).as_ref());
            let values: Vec<f64> = present.flatten().copied().collect();
            if values.is_empty() { columns } else { columns.numbers(name, values).unit(unit) }
        };
        let columns = Columns::new()
            .texts("side", sides)
            .numbers("magnitude", magnitudes)
            .unit(self.unit)
            .numbers("t", numbers(|motion| &motion.t))
            .unit("s")
            .numbers("u", numbers(|motion| &motion.u))
            .unit("m")
            .numbers("q", numbers(|motion| &motion.q))
            .unit("m")
            .numbers("psi", numbers(|motion| &motion.psi))
            .unit("rad")
            .numbers("V", numbers(|motion| &motion.forward_speed))
            .unit("m/s")
            .numbers("Omega", numbers(|motion| &motion.yaw_rate))
            .unit("rad/s");
        let columns = optional(columns, ("V2", "m/s"), |motion| &motion.lateral_speed);
        let columns = optional(columns, ("W", "m/s"), |motion| &motion.rim_speed);
        let columns = optional(columns, ("y_t", "m"), |motion| &motion.deflection);
        optional(columns, ("slip", "m/s"), |motion| &motion.slip)
    }

    fn figure(&self) -> Result<Option<Figure>, FigureError> {
        let Some(edge) = self.nearest().filter(|_| self.fails.is_some()) else {
            return Ok(Some(self.without_motions()));
        };
        let beyond = if edge.is_found() { "does not return" } else { "undecided" };
        let motions: Vec<(&DisturbedMotionResult, &str, Color)> =
            [(&self.fails, beyond, palette::VERMILION), (&self.returns, "returns", palette::BLUE)]
                .into_iter()
                .filter_map(|(motion, how, color)| Some((motion.as_ref()?, how, color)))
                .collect();
        let times = motions.iter().flat_map(|(motion, ..)| &motion.t);
        let end = times.copied().fold(0.0, f64::max);
        let angles = motions.iter().flat_map(|(motion, ..)| &motion.psi);
        let reach = angles.fold(0.0_f64, |reach, angle| reach.max(angle.abs()));
        let reach = (1.1 * reach).min(PI);
        let mut panel = Panel::new(
            Axis::new("$t$ (s)").limits(0.0, end),
            Axis::new("$\\psi$ (rad)").limits(-reach, reach),
        )
        .legend(Legend::Below);
        let text = |motion: &DisturbedMotionResult, how: &str| {
            format!("{} {}: {how}", readable(motion.magnitude), self.unit)
        };
        for (motion, how, color) in motions {
            let line = Line::new(drawn(&motion.t, &motion.psi)).color(color).width(0.6);
            panel = panel.curve(line.legend(text(motion, how)));
        }
        let description =
            format!("Caster angle over time after {}: {}", self.shown(), self.described(description::of));
        Ok(Some(Figure::single_column().description(description).panel(panel)))
    }
}

/// A duration with few digits that is not shorter.
fn rounded_up(duration: f64) -> String {
    let nearest = significant(duration, REPLAYED_DIGITS);
    if nearest.parse().is_ok_and(|nearest: f64| nearest >= duration) {
        return nearest;
    }
    let unit = 10_f64.powi(duration.log10().floor() as i32 + 1 - REPLAYED_DIGITS as i32);
    significant(duration + unit, REPLAYED_DIGITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn durations_are_rounded_up() {
        for step in -6000..6000 {
            let duration = 10.0_f64.powf(f64::from(step) * 2.001e-3);
            let rounded: f64 = rounded_up(duration).parse().unwrap();
            assert!((duration..duration * 1.0021).contains(&rounded), "{duration} {rounded}");
        }
    }

    #[test]
    fn durations_with_few_digits_stay() {
        for (duration, expected) in [(30.0, "30"), (2.0345, "2.035"), (2.0341, "2.035"), (0.99999, "1")] {
            assert_eq!(rounded_up(duration), expected);
        }
    }
}
