//! How a time history that is asked for is computed, drawn and told.

use super::accuracy::Accuracy;
use super::motion::{Course, Ending, Motion};
use super::picture::DrawnPlot;
use super::plot::{Expressions, Plot, Variable, Windows};
use super::result::{HistoryResult, SectionResult};
use super::section::{Section, SectionRequest};
use super::smooth::finer_times;
use crate::error::Error;
use crate::model::ChosenModel;
use crate::phase_plane::PhasePlane;
use arclength::control::{Control, Interrupted};
use arclength::integration::IntegrationError;
use kingpin_report::numbers::readable;

/// The absolute tolerance of a state of size 1, in relative tolerances.
pub(super) const ABSOLUTE: f64 = 0.01;
/// Size of a state below which its absolute tolerance is measured by its size.
const SMALL: f64 = 0.01;
/// How often a motion is followed again with the tolerances that the sizes of its states ask for.
const REPETITIONS: usize = 3;
/// The absolute tolerance with which a motion that could not be followed is tried once more, and most steps of that.
const FINEST_ABSOLUTE: f64 = 1e-24;
const MOST_FINEST_STEPS: usize = 200_000;
/// How often samples are added where a curve that is drawn bends.
const SMOOTHINGS: usize = 6;

/// A request that makes sense, with its model.
#[derive(Clone, Debug)]
pub struct SimulateAnalysis {
    pub(super) chosen: ChosenModel,
    pub(super) warnings: Vec<String>,
    pub(super) start: f64,
    pub(super) times: Vec<f64>,
    pub(super) bound: f64,
    /// The largest absolute tolerance that is allowed of every state.
    pub(super) absolute: Vec<f64>,
    pub(super) accuracy: Accuracy,
    pub(super) plots: Vec<Plot>,
    pub(super) expressions: Expressions,
    pub(super) windows: Windows,
    pub(super) section: Option<(SectionRequest, Section)>,
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
