//! What a time history is asked for by, and how it is computed.

use super::accuracy::Accuracy;
use super::motion::{Course, Ending, Motion};
use super::picture::DrawnPlot;
use super::plot::{Expressions, Plot, PlotRequest, Variable, Windows};
use super::result::{HistoryResult, SectionResult};
use super::section::{Section, SectionRequest};
use super::small_states::absolute_tolerances;
use super::smooth::finer_times;
use crate::error::Error;
use crate::files::{Disk, Files};
use crate::interval::Interval;
use crate::model::ChosenModel;
use crate::model_request::{ModelRequest, OpenedModel};
use crate::phase_plane::PhasePlane;
use crate::start::LabelledSolution;
use arclength::control::{Control, Interrupted};
use arclength::integration::{IntegrationError, Method};
use arclength_ode::{NamedSet, Options};
use kingpin_report::numbers::readable;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Relative tolerance where none was given.
const TOLERANCE: f64 = 1e-10;
/// The absolute tolerance of a state of size 1, in relative tolerances.
const ABSOLUTE: f64 = 0.01;
/// Size of a state below which its absolute tolerance is measured by its size.
const SMALL: f64 = 0.01;
/// Most steps: some minutes.
const MOST_STEPS: usize = 20_000_000;
/// Sampling times in the largest step of a model that depends on the time, where nothing else is asked for: what is as wide as one of them
/// is seen by a stage.
const SAMPLES_IN_A_STEP: f64 = 5.0;
/// How often a motion is followed again with the tolerances that the sizes of its states ask for.
const REPETITIONS: usize = 3;
/// The absolute tolerance with which a motion that could not be followed is tried once more, and most steps of that.
const FINEST_ABSOLUTE: f64 = 1e-24;
const MOST_FINEST_STEPS: usize = 200_000;
/// How often samples are added where a curve that is drawn bends.
const SMOOTHINGS: usize = 6;

/// A time history from the initial state of the model. What is not given is as the model has it in its lines `@`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulateRequest {
    /// The model, or the labelled point.
    pub model: ModelRequest,
    /// How long it lasts, or the model's `total`, or [`default_duration`](Self::default_duration).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
    /// Number of samples, at equal distances to the end; or one for every `dt` and `nout` of the model and one at the end, or
    /// [`default_points`](Self::default_points).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<u64>,
    /// Time at which it starts; or, of a model that depends on the time, that at which the motion ended from whose end it goes on; or
    /// the model's `t0`, or 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub t0: Option<f64>,
    /// Time before which there are no samples, or the model's `trans`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transient: Option<f64>,
    /// Magnitude of a state at which it stops, or the model's `bound`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// Relative tolerance, or the model's `toler` where that is smaller than 1e-10.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Largest step of the integrator; where the model depends on the time, five sampling times (of at least 1001 over the whole) unless
    /// something else is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_step: Option<f64>,
    /// Method of integration.
    #[serde(default)]
    pub method: IntegrationMethod,
    /// What its picture shows; without, every state and auxiliary quantity over the time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<PlotRequest>,
    /// Limits of the axes of its picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub window: Vec<Interval>,
    /// The section at whose crossings there are samples, in place of equal distances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<SectionRequest>,
}

/// A method of integration by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum IntegrationMethod {
    /// The explicit one, and the implicit one where the model is stiff.
    #[default]
    Auto,
    /// The explicit method of Dormand and Prince, of order 8.
    Explicit,
    /// The implicit method Radau IIA, of order 5.
    Implicit,
}

impl From<IntegrationMethod> for Method {
    fn from(method: IntegrationMethod) -> Self {
        match method {
            IntegrationMethod::Auto => Self::Automatic,
            IntegrationMethod::Explicit => Self::Explicit,
            IntegrationMethod::Implicit => Self::Implicit,
        }
    }
}

/// A request that makes sense, with its model.
#[derive(Clone, Debug)]
pub struct SimulateAnalysis {
    chosen: ChosenModel,
    warnings: Vec<String>,
    start: f64,
    times: Vec<f64>,
    bound: f64,
    /// The largest absolute tolerance that is allowed of every state.
    absolute: Vec<f64>,
    accuracy: Accuracy,
    plots: Vec<Plot>,
    expressions: Expressions,
    windows: Windows,
    section: Option<(SectionRequest, Section)>,
}

impl SimulateRequest {
    /// Numbers of samples that are allowed.
    pub const POINTS: RangeInclusive<u64> = 2..=1_000_000;
    /// Relative tolerances that are allowed.
    pub const TOLERANCES: RangeInclusive<f64> = 1e-14..=0.1;

    /// Number of samples where neither the request nor the model gives one.
    pub const fn default_points() -> u64 {
        1001
    }

    /// How long the motion lasts where neither the request nor the model says: as long as in XPPAUT.
    pub const fn default_duration() -> f64 {
        20.0
    }

    /// A request with the default of everything else.
    pub fn new(model: ModelRequest, duration: f64) -> Self {
        Self { duration: Some(duration), ..Self::of(model) }
    }

    /// A request for what the model itself asks for.
    pub fn of(model: ModelRequest) -> Self {
        Self {
            model,
            duration: None,
            points: None,
            t0: None,
            transient: None,
            bound: None,
            tolerance: None,
            max_step: None,
            method: IntegrationMethod::Auto,
            plots: Vec::new(),
            window: Vec::new(),
            section: None,
        }
    }

    /// Reads the model and checks every field.
    ///
    /// # Errors
    /// What is wrong with the model or a field.
    pub fn validate(&self) -> Result<SimulateAnalysis, Error> {
        self.validate_among(&Disk)
    }

    /// The same with other files than those of this machine.
    ///
    /// # Errors
    /// Those of [`validate`](Self::validate).
    pub fn validate_among(&self, files: &dyn Files) -> Result<SimulateAnalysis, Error> {
        check(&["duration"], self.duration, "positive and finite", |value| value > 0.0 && value.is_finite())?;
        check(&["t0"], self.t0, "a finite time", f64::is_finite)?;
        check(&["bound"], self.bound, "a positive number", |value| value > 0.0)?;
        check(&["max_step"], self.max_step, "a positive number", |value| value > 0.0)?;
        check(&["tolerance"], self.tolerance, "from 1e-14 to 0.1", |value| {
            Self::TOLERANCES.contains(&value)
        })?;
        if let Some(points) = self.points.filter(|points| !Self::POINTS.contains(points)) {
            let allowed = format!("{} to {}", Self::POINTS.start(), Self::POINTS.end());
            return Err(Error::invalid(&["points"], points.to_string(), "too few or too many", allowed));
        }
        if let Some(points) = self.points.filter(|_| self.section.is_some()) {
            let problem = "samples are at the crossings of the section";
            return Err(Error::invalid(&["points"], points.to_string(), problem, "nothing with a section"));
        }
        let OpenedModel { chosen, mut warnings, point } = self.model.open_among(files)?;
        // A model that depends on the time goes on at the time at which the motion ended.
        let ended = match point.map(|point| point.solution) {
            Some(LabelledSolution::Motion { end, .. }) if !chosen.model.is_autonomous() => Some(end),
            _ => None,
        };
        let mut expressions = Expressions::default();
        let plots = self.plots.iter().map(|plot| plot.resolve(&chosen, &mut expressions));
        let plots = plots.collect::<Result<Vec<_>, _>>()?;
        let windows = Windows::new(&chosen, &self.window, &mut expressions)?;
        let section = self
            .section
            .as_ref()
            .map(|asked| Ok::<_, Error>((asked.clone(), asked.of(&chosen)?)))
            .transpose()?;
        let set = self.model.named_set.as_ref().map(|name| chosen.named_set(name)).transpose()?;
        let file = FileSettings { options: chosen.model.options(), set };

        let duration = self.duration.or_else(|| file.number("total")).unwrap_or(Self::default_duration());
        if !(duration > 0.0 && duration.is_finite()) {
            let problem = if duration == 0.0 { "that is the start alone" } else { "out of range" };
            return Err(Error::invalid(
                &["duration"],
                format!("(@ total={duration})"),
                problem,
                "a positive time",
            ));
        }
        if file.number("dt").is_some_and(|step| step < 0.0) {
            warnings.push("a negative @ dt, which in XPPAUT goes backwards in time, has no effect: the motion goes forwards".to_owned());
        }
        let of_file = || file.number("t0").filter(|time| time.is_finite());
        let start = self.t0.or(ended).or_else(of_file).unwrap_or(0.0);
        let end = start + duration;
        if end <= start {
            return Err(Error::invalid(
                &["duration"],
                duration.to_string(),
                "lost beside the start",
                "a longer one",
            ));
        }
        check(&["transient"], self.transient, &format!("less than {end}, where the motion ends"), |time| {
            time < end
        })?;
        let transient = self.transient.or_else(|| {
            let time = file.number("trans")?;
            if time < end {
                return Some(time);
            }
            warnings.push(format!("the model's transient of {time} is ignored: the motion ends at {end}"));
            None
        });
        let first = transient.map_or(start, |time| time.max(start));
        let of_file = file.points(end - first);
        let points = self.points.or(of_file).unwrap_or(Self::default_points());
        let last = (points - 1) as f64;
        let distance = file.distance().filter(|_| self.points.is_none() && of_file.is_some());
        // One for every distance, whose last is the shorter one that is left.
        let uneven = distance.filter(|distance| !is_whole((end - first) / distance));
        let time = |index: u64| match uneven {
            Some(distance) => first + distance * index as f64,
            None => first + (end - first) * (index as f64 / last),
        };
        let mut times: Vec<f64> = (0..points).map(time).collect();
        times[points as usize - 1] = end;

        let tighter = |name: &str, default: f64| {
            file.number(name).filter(|value| *value > 0.0).map_or(default, |value| value.min(default))
        };
        let relative =
            self.tolerance.unwrap_or_else(|| tighter("tol", TOLERANCE).max(*Self::TOLERANCES.start()));
        let absolute = tighter("atol", ABSOLUTE * relative);
        // What moves with the time alone no step knows of before it has seen it.
        let finest = points.max(of_file.unwrap_or(0)).max(Self::default_points()) - 1;
        let stimulus = SAMPLES_IN_A_STEP * (end - first).abs() / finest as f64;
        let by_model = if chosen.model.is_autonomous() { f64::INFINITY } else { stimulus };
        let largest_step = self.max_step.unwrap_or(by_model);
        let bound =
            self.bound.or_else(|| file.number("bound").filter(|bound| *bound > 0.0)).unwrap_or(f64::INFINITY);
        let absolute = absolute_tolerances(&chosen.model, &chosen.start, absolute);
        let accuracy = Accuracy {
            relative,
            absolute: absolute.clone(),
            largest_step,
            most_steps: MOST_STEPS,
            method: self.method.into(),
        };
        Ok(SimulateAnalysis {
            chosen,
            warnings,
            start,
            times,
            bound,
            absolute,
            accuracy,
            plots,
            expressions,
            windows,
            section,
        })
    }
}

/// Whether a number of sampling times in a motion is whole, but for its rounding and that of decimal fractions.
fn is_whole(number: f64) -> bool {
    /// Part of a sampling time that counts as none.
    const NONE: f64 = 1e-6;
    (number - number.round()).abs() <= NONE
}

/// Refuses a value that was given and is not as it has to be.
fn check(
    fields: &'static [&'static str],
    value: Option<f64>,
    allowed: &str,
    is_allowed: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    match value.filter(|value| !is_allowed(*value)) {
        Some(value) => Err(Error::invalid(fields, value.to_string(), "out of range", allowed)),
        None => Ok(()),
    }
}

/// What the text of a model says of its simulation, a named set before the lines `@`.
struct FileSettings<'a> {
    options: &'a Options,
    set: Option<&'a NamedSet>,
}

impl FileSettings<'_> {
    fn number(&self, name: &str) -> Option<f64> {
        let of_set =
            self.set.and_then(|set| set.options.iter().rev().find(|entry| entry.name.starts_with(name)));
        if let Some(number) = of_set.and_then(|entry| entry.value.parse().ok()) {
            return Some(number);
        }
        match name {
            "total" => self.options.total,
            "dt" => self.options.dt,
            "t0" => self.options.t0,
            "trans" => self.options.transient,
            "bound" => self.options.bound,
            "tol" => self.options.tolerance,
            "atol" => self.options.absolute_tolerance,
            other => self.options.get(other)?.parse().ok(),
        }
    }

    /// The distance of the samples that the step and the number of steps between outputs ask for.
    fn distance(&self) -> Option<f64> {
        let between = ["nout", "njmp"].iter().find_map(|name| self.number(name)).unwrap_or(1.0);
        Some((self.number("dt")? * between).abs())
    }

    /// The samples of a time that the step and the number of steps between outputs ask for.
    fn points(&self, time: f64) -> Option<u64> {
        let distances = time / self.distance()?;
        // What lasts less than half of one has as many as without it.
        let distances =
            if is_whole(distances) || distances < 0.5 { distances.round() } else { distances.ceil() };
        let points = distances + 1.0;
        let range = SimulateRequest::POINTS;
        (*range.start() as f64 <= points && points <= *range.end() as f64).then_some(points as u64)
    }
}

impl SimulateAnalysis {
    /// What is worth knowing before it runs.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Integrates the motion.
    ///
    /// # Errors
    /// [`Error::Integration`]; a motion that leaves the bound before its first sample.
    pub fn run(&self) -> Result<HistoryResult, Error> {
        self.run_under(&Control::none())
    }

    /// Integrates the motion. Where the control stops it the result is the motion up to there.
    ///
    /// # Errors
    /// As [`run`](Self::run); [`IntegrationError::Interrupted`] where there is no sample yet.
    pub fn run_under(&self, control: &Control<'_>) -> Result<HistoryResult, Error> {
        let chosen = &self.chosen;
        let mut warnings = Vec::new();
        let section = self.section.as_ref().map(|(_, section)| section);
        let motion = self.follow(&self.times, section, &mut warnings, control);
        let motion = motion.map_err(|error| self.explained(error))?;
        if let Some((time, ending)) = motion.ending {
            self.tell(time, ending, motion.samples.times.is_empty(), &mut warnings)?;
        }
        if let Some(time) = motion.unknown_switches {
            warnings.push(format!(
                "too many switches in time from t = {} on to find each: what is shorter than the steps may be missed (--max-step)",
                readable(time)
            ));
        }
        if let (Some((asked, _)), Some(watch)) = (&self.section, motion.section) {
            let first = self.times[0];
            let (times, states): (Vec<f64>, Vec<Vec<f64>>) =
                watch.crossings.into_iter().filter(|(time, _)| *time >= first).unzip();
            if times.is_empty() {
                warnings.push(format!("the motion does not cross the section {} = 0", asked.expression));
            }
            let mut plots = self.drawn(&times, &states);
            let result = HistoryResult::new(chosen, times, &states, warnings);
            if plots.is_empty() {
                let sizes = motion.sizes.iter().copied().chain(std::iter::repeat(0.0));
                let quantities = result.quantities().zip(sizes);
                plots = DrawnPlot::return_maps(
                    quantities.map(|((name, values), size)| (name.as_str(), values.clone(), size)),
                );
            }
            let section = SectionResult { expression: asked.expression.clone(), direction: asked.direction };
            return Ok(HistoryResult { section: Some(section), plots, ..result });
        }
        let (times, states) = (motion.samples.times, motion.samples.states);
        let plots = if self.plots.is_empty() {
            Vec::new()
        } else {
            let (times, states) = self.smooth(times.clone(), states.clone(), control)?;
            self.drawn(&times, &states)
        };
        let phase_planes: Vec<PhasePlane> = plots.iter().filter_map(DrawnPlot::phase_plane).collect();
        if phase_planes.iter().any(|plane| plane.equilibria.is_none()) {
            warnings.push("the equilibria in the window form lines: none is marked".to_owned());
        }
        let is_plane = |plot: &Plot| matches!(plot.pairs()[..], [[Variable::State(_), Variable::State(_)]]);
        if chosen.model.states().len() == 2
            && !chosen.model.is_autonomous()
            && self.plots.iter().any(is_plane)
        {
            let text =
                "the model depends on the time: its phase plane has no nullclines, directions and equilibria";
            warnings.push(text.to_owned());
        }
        let result = HistoryResult::new(chosen, times, &states, warnings);
        Ok(HistoryResult { plots, phase_planes, ..result })
    }

    /// An error of the integration, with what makes the right-hand side none where that happens at the start.
    fn explained(&self, error: IntegrationError) -> Error {
        let chosen = &self.chosen;
        let because = match error {
            IntegrationError::NotFinite { time } if time == self.start => {
                chosen.model.not_finite(time, &chosen.start, &chosen.parameters)
            }
            _ => None,
        };
        match because {
            Some(because) => Error::NotFiniteAtStart { time: self.start, because },
            None => error.into(),
        }
    }

    /// What is drawn of a motion.
    fn drawn(&self, times: &[f64], states: &[Vec<f64>]) -> Vec<DrawnPlot> {
        let value = |variable: Variable, time: f64, state: &[f64]| self.value(variable, time, state);
        let is_motion = self.section.is_none();
        let plots = self.plots.iter();
        plots
            .map(|plot| DrawnPlot::of(plot, &self.chosen, &self.windows, is_motion, (times, states), &value))
            .collect()
    }

    fn value(&self, variable: Variable, time: f64, state: &[f64]) -> f64 {
        match variable {
            Variable::Time => time,
            Variable::State(index) => state[index],
            Variable::Expression(index) => {
                self.expressions.value(index, time, state, &self.chosen.parameters)
            }
            Variable::Auxiliary(index) => self.chosen.auxiliary(time, state, &self.chosen.parameters)[index],
        }
    }

    /// Times and states, as close together as smooth curves need.
    fn smooth(
        &self,
        mut times: Vec<f64>,
        mut states: Vec<Vec<f64>>,
        control: &Control<'_>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), IntegrationError> {
        let pairs: Vec<[Variable; 2]> = self.plots.iter().flat_map(Plot::pairs).collect();
        for _ in 0..SMOOTHINGS {
            let curve = |pair: &[Variable; 2]| {
                let points = times.iter().zip(&states);
                points.map(|(time, state)| pair.map(|variable| self.value(variable, *time, state))).collect()
            };
            let Some(finer) = finer_times(&times, &pairs.iter().map(curve).collect::<Vec<_>>()) else {
                break;
            };
            let motion = self.follow(&finer, None, &mut Vec::new(), control)?;
            if control.is_stopped() {
                break;
            }
            let samples = motion.samples;
            (times, states) = (samples.times, samples.states);
        }
        Ok((times, states))
    }

    /// Says why the motion was not followed to the end.
    fn tell(
        &self,
        time: f64,
        ending: Ending,
        is_empty: bool,
        warnings: &mut Vec<String>,
    ) -> Result<(), Error> {
        let line = |event: usize| self.chosen.model.global_events()[event].place().line;
        let time = readable(time);
        let bound = readable(self.bound);
        let (fields, given, story, allowed): (&'static [&'static str], _, _, _) = match ending {
            Ending::LeftBound => (
                &["bound"],
                bound.clone(),
                format!("the motion leaves it at t = {time}"),
                "a larger one, or an earlier first sample",
            ),
            Ending::Stopped(event) => (
                &["transient"],
                readable(self.times[0]),
                format!("the motion ends at t = {time}, by the event of line {} (arret)", line(event)),
                "an earlier first sample",
            ),
            Ending::Accumulation(event) => (
                &["transient"],
                readable(self.times[0]),
                format!(
                    "the event of line {} happens again and again by t = {time} while no time passes",
                    line(event)
                ),
                "an earlier first sample",
            ),
            Ending::Interrupted if is_empty => return Err(IntegrationError::Interrupted(Interrupted).into()),
            Ending::Interrupted => {
                warnings.push(format!("interrupted at t = {time}: the motion is that up to there"));
                return Ok(());
            }
        };
        if is_empty {
            return Err(Error::invalid(fields, given, format!("{story}, before the first sample"), allowed));
        }
        warnings.push(match ending {
            Ending::LeftBound => format!(
                "the motion left the bound {bound} by t = {time} and was not followed further; a larger --bound does"
            ),
            Ending::Stopped(_) | Ending::Interrupted => story,
            Ending::Accumulation(_) => format!(
                "{story}: what the model does behind that is not said, and the motion ends there (Zeno); write what holds then \
                 into the equations"
            ),
        });
        Ok(())
    }

    /// Follows the motion, again where a state is so small that its absolute tolerance leaves it too few digits.
    fn follow<'t>(
        &self,
        times: &'t [f64],
        section: Option<&Section>,
        warnings: &mut Vec<String>,
        control: &Control<'_>,
    ) -> Result<Motion<'t>, IntegrationError> {
        let chosen = &self.chosen;
        let course = Course {
            model: &chosen.model,
            parameters: &chosen.parameters,
            start_time: self.start,
            start: &chosen.start,
            end_time: times.last().copied().unwrap_or(self.start),
            bound: self.bound,
            section,
            control: *control,
        };
        let mut accuracy = self.accuracy.clone();
        let mut motion = match course.follow(&accuracy, times) {
            Err(error @ (IntegrationError::NotFinite { .. } | IntegrationError::StepTooSmall { .. })) => {
                // States that are much smaller than the tolerance may have passed zero, and concentrations grow beyond it.
                for absolute in &mut accuracy.absolute {
                    *absolute = absolute.min(FINEST_ABSOLUTE);
                }
                accuracy.most_steps = accuracy.most_steps.min(MOST_FINEST_STEPS);
                course.follow(&accuracy, times).map_err(|_| error)?
            }
            followed => followed?,
        };
        for _ in 0..REPETITIONS {
            let needed = motion.sizes.iter().zip(&self.absolute);
            let needed: Vec<f64> =
                needed.map(|(size, largest)| self.absolute_tolerance(*size).min(*largest)).collect();
            let is_enough = needed.iter().zip(&accuracy.absolute).all(|(needed, has)| *needed >= 0.5 * has);
            if is_enough || control.is_stopped() {
                break;
            }
            accuracy.absolute = needed;
            accuracy.most_steps = 10_000 + 20 * motion.steps;
            match course.follow(&accuracy, times) {
                // Half of the second way is worth less than the whole first.
                Ok(_) if control.is_stopped() => break,
                Ok(finer) => motion = finer,
                Err(error) => {
                    warnings.push(format!(
                        "states smaller than {SMALL} are followed to absolute errors of about {} only: {error}",
                        readable(ABSOLUTE * self.accuracy.relative)
                    ));
                    break;
                }
            }
        }
        Ok(motion)
    }

    /// The absolute tolerance of a state of this size.
    fn absolute_tolerance(&self, size: f64) -> f64 {
        let size = if size > 0.0 && size < SMALL { size } else { 1.0 };
        ABSOLUTE * self.accuracy.relative * size
    }
}
