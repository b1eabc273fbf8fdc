//! What a time history is asked for by.

use super::accuracy::Accuracy;
use super::analysis::{ABSOLUTE, SimulateAnalysis};
use super::plot::{Expressions, PlotRequest, Windows};
use super::section::SectionRequest;
use super::small_states::absolute_tolerances;
use crate::error::Error;
use crate::files::{Disk, Files};
use crate::interval::Interval;
use crate::model_request::{ModelRequest, OpenedModel};
use crate::start::LabelledSolution;
use arclength::integration::Method;
use arclength_ode::{NamedSet, Options};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Relative tolerance where none was given.
const TOLERANCE: f64 = 1e-10;
/// Most steps: some minutes.
const MOST_STEPS: usize = 20_000_000;
/// Sampling times in the largest step of a model that depends on the time, where nothing else is asked for: what is as wide as one of them
/// is seen by a stage.
const SAMPLES_IN_A_STEP: f64 = 5.0;

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
