//! One step at a time: the Runge-Kutta stages, the error estimate, step control and dense output; or an implicit step.

use super::clock::Clock;
use super::integrator::Method;
use super::radau::{Origin, Radau};
use super::stiffness::StiffnessWatch;
use super::tableau::{
    DENSE, DENSE_COEFFICIENTS, ERROR_FIFTH_ORDER, ERROR_THIRD_ORDER, MATRIX, NODES, Row, STAGES,
    STAGES_WITH_DENSE_OUTPUT,
};
use super::{IntegrationError, Integrator, System};

/// Safety factor of the step control.
const SAFETY: f64 = 0.9;
/// Smallest and largest factor between steps that follow each other.
const STEP_RATIO: (f64, f64) = (1.0 / 3.0, 6.0);
/// Weight of the previous error in the PI control (Gustafsson 1991; Hairer, Norsett and Wanner, IV.2).
const PI_WEIGHT: f64 = 0.04;
/// Exponent of the present error in the PI control: an error of order 8, less what the previous error takes.
const PI_EXPONENT: f64 = 1.0 / 8.0 - 0.2 * PI_WEIGHT;
/// Smallest previous error that the control remembers, so that one lucky step does not rule the next.
const SMALLEST_ERROR: f64 = 1e-4;
/// Factor on a step whose stages were not finite.
const NOT_FINITE_RATIO: f64 = 0.25;

/// Relative difference of two times, or of a step and the longest one, below which they are not told apart: four units in the last place.
const STEP_RESOLUTION: f64 = 4.0 * f64::EPSILON;

/// The first implicit step where explicit ones are too short to be told apart, in units of the shortest that can.
const FIRST_STEP: f64 = 100.0;

/// Work done by an integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Steps that were accepted.
    pub accepted_steps: usize,
    /// Steps that were repeated with a smaller size.
    pub rejected_steps: usize,
    /// Evaluations of the right-hand side.
    pub evaluations: usize,
}

/// An integration that is advanced step by step.
///
/// All memory is allocated on construction. [`Integrator`] has methods for the common tasks; this is
/// for callers with a loop of their own.
///
/// ```
/// use arclength::integration::{Integrator, Stepper, from_fn};
///
/// let decay = from_fn(1, |_time, x, derivative| derivative[0] = -x[0]);
/// let mut stepper = Stepper::new(decay, &Integrator::default(), 0.0, &[1.0], 2.0)?;
/// while !stepper.is_finished() {
///     stepper.advance()?;
/// }
/// assert!((stepper.state()[0] - (-2.0_f64).exp()).abs() < 1e-9);
/// # Ok::<(), arclength::integration::IntegrationError>(())
/// ```
#[derive(Debug)]
pub struct Stepper<S> {
    system: S,
    settings: Integrator,
    dimension: usize,
    clock: Clock,
    /// Present time and end, on the clock.
    time: f64,
    end: f64,
    state: Vec<f64>,
    previous_time: f64,
    previous_state: Vec<f64>,
    trial: Vec<f64>,
    /// Slopes at the stages, one after the other; stage 12 is the slope at the end of the step.
    stages: Vec<f64>,
    dense: Vec<f64>,
    dense_is_ready: bool,
    step: f64,
    /// The longest step since the start, or the first that was proposed.
    longest_step: f64,
    previous_error: f64,
    statistics: Statistics,
    implicit: Option<Box<Radau>>,
    is_implicit: bool,
    /// Whether the last step was an implicit one.
    last_is_implicit: bool,
    watch: StiffnessWatch,
}

impl<S: System> Stepper<S> {
    /// Starts at `state` and `time`; steps run towards `end`, forwards or backwards.
    ///
    /// # Errors
    /// If a setting is out of range, lengths disagree or the right-hand side is not finite at the start.
    pub fn new(
        system: S,
        settings: &Integrator,
        time: f64,
        state: &[f64],
        end: f64,
    ) -> Result<Self, IntegrationError> {
        let dimension = system.dimension();
        settings.check(dimension)?;
        let mut stepper = Self {
            clock: Clock::new(system.has_own_clock()),
            system,
            settings: settings.clone(),
            dimension,
            time,
            end,
            state: vec![0.0; dimension],
            previous_time: time,
            previous_state: vec![0.0; dimension],
            trial: vec![0.0; dimension],
            stages: vec![0.0; STAGES_WITH_DENSE_OUTPUT * dimension],
            dense: vec![0.0; DENSE_COEFFICIENTS * dimension],
            dense_is_ready: false,
            step: 0.0,
            longest_step: 0.0,
            previous_error: SMALLEST_ERROR,
            statistics: Statistics::default(),
            implicit: None,
            is_implicit: settings.method == Method::Implicit,
            last_is_implicit: false,
            watch: StiffnessWatch::new(),
        };
        stepper.restart(time, state, end)?;
        Ok(stepper)
    }

    /// Starts again from another state and time, for example after an event; the statistics go on.
    ///
    /// # Errors
    /// As for [`Stepper::new`].
    pub fn restart(&mut self, time: f64, state: &[f64], end: f64) -> Result<(), IntegrationError> {
        if state.len() != self.dimension {
            return Err(IntegrationError::WrongLength {
                name: "the initial state",
                found: state.len(),
                expected: self.dimension,
            });
        }
        for (name, value) in [("start", time), ("end", end)] {
            if !value.is_finite() {
                return Err(IntegrationError::BadSetting { name, value, allowed: "a finite time" });
            }
        }
        self.state.copy_from_slice(state);
        self.previous_state.copy_from_slice(state);
        self.time = self.clock.start(time, end);
        self.previous_time = self.time;
        self.end = self.clock.remaining();
        self.dense_is_ready = false;
        self.last_is_implicit = false;
        if let Some(radau) = &mut self.implicit {
            radau.restart();
        }
        self.previous_error = SMALLEST_ERROR;
        let last = (STAGES - 1) * self.dimension..STAGES * self.dimension;
        self.system.evaluate(time, &self.state, &mut self.stages[last.clone()]);
        self.statistics.evaluations += 1;
        if !self.state.iter().chain(&self.stages[last]).all(|x| x.is_finite()) {
            return Err(IntegrationError::NotFinite { time });
        }
        self.step = match self.settings.initial_step {
            Some(step) => step,
            None => self.initial_step(),
        };
        self.longest_step = self.step;
        Ok(())
    }

    /// Time that was reached.
    pub fn time(&self) -> f64 {
        self.absolute(self.time)
    }

    /// The time at a time on the clock.
    pub(super) fn absolute(&self, on_clock: f64) -> f64 {
        // The end is met to the last bit.
        if on_clock == self.end { self.clock.finish() } else { self.clock.absolute(on_clock) }
    }

    /// Start and end of the last step on the clock, and how fine times on it are told apart there at least.
    pub(super) fn last_step_on_clock(&self) -> ([f64; 2], f64) {
        let step = [self.previous_time, self.time];
        (step, if self.clock.begins_anew() { (step[1] - step[0]).abs() } else { 0.0 })
    }

    /// State at [`Stepper::time`].
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Derivative of the state at [`Stepper::time`].
    pub fn derivative(&self) -> &[f64] {
        self.stage(STAGES - 1)
    }

    /// Start of the last step.
    pub fn previous_time(&self) -> f64 {
        self.absolute(self.previous_time)
    }

    /// Whether the end was reached.
    pub fn is_finished(&self) -> bool {
        self.time == self.end
    }

    /// Whether the next step will be one of the implicit method.
    pub fn is_implicit(&self) -> bool {
        self.is_implicit
    }

    /// Work done so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The system that is integrated.
    pub fn system_mut(&mut self) -> &mut S {
        &mut self.system
    }

    /// Takes one step that meets the tolerances and does not pass the end; does nothing at the end.
    ///
    /// # Errors
    /// [`StepTooSmall`](IntegrationError::StepTooSmall), [`NotFinite`](IntegrationError::NotFinite) or
    /// [`TooManySteps`](IntegrationError::TooManySteps); the state is then that of the last good step.
    pub fn advance(&mut self) -> Result<(), IntegrationError> {
        if self.is_finished() {
            return Ok(());
        }
        if self.statistics.accepted_steps + self.statistics.rejected_steps >= self.settings.maximum_steps {
            return Err(IntegrationError::TooManySteps {
                time: self.time(),
                steps: self.statistics.accepted_steps,
            });
        }
        self.wind_clock();
        if self.is_implicit {
            self.advance_implicitly()?;
            if self.settings.method == Method::Automatic {
                self.leave_implicit_steps();
            }
            return Ok(());
        }
        match self.advance_explicitly() {
            Ok(()) => {
                if self.settings.method == Method::Automatic && self.watch.looks() {
                    let rate = self.fastest_rate_times_step();
                    if self.watch.is_stiff(rate) {
                        self.begin_implicit_steps();
                    }
                }
                Ok(())
            }
            // A problem may be too stiff for its first steps.
            Err(IntegrationError::StepTooSmall { .. }) if self.settings.method == Method::Automatic => {
                self.begin_implicit_steps();
                self.step = self.smallest_step() * FIRST_STEP;
                self.advance_implicitly()
            }
            Err(error) => Err(error),
        }
    }

    fn advance_explicitly(&mut self) -> Result<(), IntegrationError> {
        let direction = (self.end - self.time).signum();
        let remaining = (self.end - self.time).abs();
        // The slope at the end of the last step is the first stage of this one.
        self.stages.copy_within((STAGES - 1) * self.dimension..STAGES * self.dimension, 0);
        self.dense_is_ready = false;
        self.last_is_implicit = false;
        let mut was_finite = true;
        let mut was_rejected = false;
        let mut step = self.step.min(self.settings.maximum_step);
        loop {
            // A last step that would leave a sliver is lengthened a little instead.
            let is_last = step * (1.0 + 1e-10) >= remaining;
            if is_last {
                step = remaining;
            }
            if step <= self.smallest_step() && !is_last || step == 0.0 {
                self.restore_slope();
                return Err(if was_finite {
                    IntegrationError::StepTooSmall { time: self.time(), step }
                } else {
                    IntegrationError::NotFinite { time: self.time() }
                });
            }
            let end = if is_last { self.end } else { self.time + direction * step };
            let error = self.try_step(end - self.time);
            // The slope at the end is no part of the error, and the next step begins with it.
            was_finite = error.is_finite() && self.stage(STAGES - 1).iter().all(|slope| slope.is_finite());
            let factor = if was_finite {
                SAFETY * error.max(f64::MIN_POSITIVE).powf(-PI_EXPONENT) * self.previous_error.powf(PI_WEIGHT)
            } else {
                NOT_FINITE_RATIO
            };
            let factor = factor.clamp(STEP_RATIO.0.min(NOT_FINITE_RATIO), STEP_RATIO.1);
            if error <= 1.0 && was_finite {
                self.statistics.accepted_steps += 1;
                self.longest_step = self.longest_step.max(step);
                self.previous_time = self.time;
                self.time = end;
                std::mem::swap(&mut self.state, &mut self.previous_state);
                std::mem::swap(&mut self.state, &mut self.trial);
                self.previous_error = error.max(SMALLEST_ERROR);
                // After a rejection the step does not grow at once; a last step cut short says nothing about the next.
                let proposal = step * if was_rejected { factor.min(1.0) } else { factor };
                self.step = if is_last { proposal.max(self.step) } else { proposal };
                return Ok(());
            }
            self.statistics.rejected_steps += 1;
            was_rejected = true;
            step *= factor.min(SAFETY);
            self.step = step;
        }
    }

    /// The step that is too short to be told apart: from the time, or, where the time does not matter, from the longest step. The
    /// second does not depend on when a motion is looked at, nor on how long it has lasted.
    fn smallest_step(&self) -> f64 {
        STEP_RESOLUTION * if self.clock.begins_anew() { self.longest_step } else { self.time.abs() }
    }

    /// Lets the clock of a system that has its own begin anew at the present time.
    fn wind_clock(&mut self) {
        if self.clock.begins_anew() && self.time != 0.0 {
            let elapsed = self.time;
            self.clock.advance(elapsed);
            self.previous_time -= elapsed;
            if let Some(radau) = &mut self.implicit {
                radau.wind_clock(elapsed);
            }
            self.time = 0.0;
            self.end = self.clock.remaining();
        }
    }

    fn begin_implicit_steps(&mut self) {
        self.is_implicit = true;
        if let Some(radau) = &mut self.implicit {
            radau.restart();
        }
    }

    /// Goes back to explicit steps where these would do as well.
    fn leave_implicit_steps(&mut self) {
        let Some(radau) = &mut self.implicit else { return };
        let rate = radau.spectral_radius();
        if self.watch.is_over(rate * (self.time - self.previous_time).abs()) {
            self.is_implicit = false;
            self.step = self.step.min(1.0 / rate.max(f64::MIN_POSITIVE));
            self.previous_error = SMALLEST_ERROR;
        }
    }

    /// The fastest rate by which slopes differ at the end of an explicit step, times the step.
    fn fastest_rate_times_step(&self) -> f64 {
        let step = self.time - self.previous_time;
        let last = STAGES - 1;
        let (mut slopes, mut states) = (0.0, 0.0);
        for index in 0..self.dimension {
            let scale = self.settings.scale(index, self.state[index].abs());
            let slope =
                self.stages[last * self.dimension + index] - self.stages[(last - 1) * self.dimension + index];
            let way = self.combination(MATRIX[last], index) - self.combination(MATRIX[last - 1], index);
            slopes += (slope / scale).powi(2);
            states += (step * way / scale).powi(2);
        }
        if states > 0.0 { step.abs() * (slopes / states).sqrt() } else { 0.0 }
    }

    fn advance_implicitly(&mut self) -> Result<(), IntegrationError> {
        let n = self.dimension;
        let smallest = self.smallest_step();
        let radau = self.implicit.get_or_insert_with(|| Box::new(Radau::new(n)));
        let direction = (self.end - self.time).signum();
        let remaining = (self.end - self.time).abs();
        let last = (STAGES - 1) * n..STAGES * n;
        self.dense_is_ready = false;
        let (mut was_rejected, mut was_finite) = (false, true);
        let mut step = self.step.min(self.settings.maximum_step);
        loop {
            let is_last = step * (1.0 + 1e-10) >= remaining;
            if is_last {
                step = remaining;
            }
            if step <= smallest && !is_last || step == 0.0 {
                return Err(if was_finite {
                    IntegrationError::StepTooSmall { time: self.time(), step }
                } else {
                    IntegrationError::NotFinite { time: self.time() }
                });
            }
            let end = if is_last { self.end } else { self.time + direction * step };
            let (slope, behind) = self.stages.split_at_mut(n);
            let behind = &behind[..last.end - n];
            let origin = Origin {
                time: self.time,
                state: &self.state,
                slope: &behind[last.start - n..],
                step: end - self.time,
            };
            let trial =
                radau.try_step(&mut self.system, &self.settings, origin, was_rejected, &mut self.trial);
            self.statistics.evaluations += trial.evaluations;
            was_finite = trial.error.is_finite();
            if trial.error <= 1.0 {
                self.system.evaluate(end, &self.trial, slope);
                self.statistics.evaluations += 1;
                was_finite = slope.iter().all(|slope| slope.is_finite());
            }
            if trial.error <= 1.0 && was_finite {
                let factor = radau.accept(origin, trial);
                self.stages.copy_within(..n, last.start);
                self.statistics.accepted_steps += 1;
                self.longest_step = self.longest_step.max(step);
                self.previous_time = self.time;
                self.time = end;
                std::mem::swap(&mut self.state, &mut self.previous_state);
                std::mem::swap(&mut self.state, &mut self.trial);
                let proposal = step * if was_rejected { factor.min(1.0) } else { factor };
                self.step = if is_last { proposal.max(self.step) } else { proposal };
                self.last_is_implicit = true;
                self.dense_is_ready = true;
                return Ok(());
            }
            self.statistics.rejected_steps += 1;
            was_rejected = true;
            step *= if was_finite { trial.factor.min(SAFETY) } else { NOT_FINITE_RATIO };
            self.step = step;
        }
    }

    /// Puts the slope at the present state back in its place after a step that failed.
    fn restore_slope(&mut self) {
        self.stages.copy_within(0..self.dimension, (STAGES - 1) * self.dimension);
    }

    fn stage(&self, stage: usize) -> &[f64] {
        &self.stages[stage * self.dimension..(stage + 1) * self.dimension]
    }

    /// Evaluates stage `stage` of a step from `state`.
    #[inline]
    fn evaluate_stage(&mut self, stage: usize, time: f64, step: f64, from_previous: bool) {
        let n = self.dimension;
        let origin = if from_previous { &self.previous_state } else { &self.state };
        let (before, after) = self.stages.split_at_mut(stage * n);
        self.trial.fill(0.0);
        accumulate(MATRIX[stage], before, &mut self.trial);
        for (trial, &x) in self.trial.iter_mut().zip(origin) {
            *trial = x + step * *trial;
        }
        self.system.evaluate(time + NODES[stage] * step, &self.trial, &mut after[..n]);
        self.statistics.evaluations += 1;
    }

    /// Computes the state after `step` in `trial` and returns the error in units of the tolerance.
    fn try_step(&mut self, step: f64) -> f64 {
        for stage in 1..STAGES {
            self.evaluate_stage(stage, self.time, step, false);
        }
        let (mut fifth, mut third) = (0.0, 0.0);
        for i in 0..self.dimension {
            let scale = self.settings.scale(i, self.state[i].abs().max(self.trial[i].abs()));
            fifth += (self.combination(ERROR_FIFTH_ORDER, i) / scale).powi(2);
            third += (self.combination(ERROR_THIRD_ORDER, i) / scale).powi(2);
        }
        if fifth == 0.0 && third == 0.0 {
            return 0.0;
        }
        step.abs() * fifth / ((fifth + 0.01 * third) * self.dimension as f64).sqrt()
    }

    #[inline]
    fn combination(&self, row: Row, component: usize) -> f64 {
        row.iter()
            .map(|&(stage, coefficient)| coefficient * self.stages[stage * self.dimension + component])
            .sum()
    }

    /// First step: Hairer, Norsett and Wanner (1993), II.4, "starting step size".
    fn initial_step(&mut self) -> f64 {
        let n = self.dimension;
        let span = (self.end - self.time).abs();
        if span == 0.0 || n == 0 {
            return span;
        }
        let norm = |settings: &Integrator, state: &[f64], x: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..n).map(|i| (x(i) / settings.scale(i, state[i].abs())).powi(2)).sum();
            (sum / n as f64).sqrt()
        };
        let slope = &self.stages[(STAGES - 1) * n..STAGES * n];
        let size = norm(&self.settings, &self.state, &|i| self.state[i]);
        let speed = norm(&self.settings, &self.state, &|i| slope[i]);
        let guess = if size < 1e-5 || speed < 1e-5 { 1e-6 } else { 0.01 * size / speed };
        let guess = guess.min(span).min(self.settings.maximum_step);
        let signed = guess * (self.end - self.time).signum();
        for (trial, (x, slope)) in self.trial.iter_mut().zip(self.state.iter().zip(slope)) {
            *trial = x + signed * slope;
        }
        let (first, rest) = self.stages.split_at_mut(n);
        self.system.evaluate(self.time + signed, &self.trial, first);
        self.statistics.evaluations += 1;
        let slope = &rest[(STAGES - 2) * n..(STAGES - 1) * n];
        let bend = norm(&self.settings, &self.state, &|i| first[i] - slope[i]) / guess;
        let largest = speed.max(bend);
        let second =
            if largest <= 1e-15 { (guess * 1e-3).max(1e-6) } else { (0.01 / largest).powf(1.0 / 8.0) };
        if second.is_finite() { second.min(100.0 * guess).min(span) } else { guess }
    }

    /// Makes [`Stepper::interpolate`] ready for the last step; costs three evaluations, once for each step.
    pub fn prepare_dense_output(&mut self) {
        if self.dense_is_ready || self.time == self.previous_time {
            return;
        }
        let n = self.dimension;
        let step = self.time - self.previous_time;
        for stage in STAGES..STAGES_WITH_DENSE_OUTPUT {
            self.evaluate_stage(stage, self.previous_time, step, true);
        }
        for (i, (&x0, &x1)) in self.previous_state.iter().zip(&self.state).enumerate() {
            let difference = x1 - x0;
            let first = step * self.stages[i] - difference;
            self.dense[i] = difference;
            self.dense[n + i] = first;
            self.dense[2 * n + i] = difference - step * self.stages[(STAGES - 1) * n + i] - first;
            for (k, &row) in DENSE.iter().enumerate() {
                let combination: f64 =
                    row.iter().map(|&(stage, coefficient)| coefficient * self.stages[stage * n + i]).sum();
                self.dense[(k + 3) * n + i] = step * combination;
            }
        }
        self.dense_is_ready = true;
    }

    /// State at a time in the last step, of order 7, or 3 in an implicit step, after [`Stepper::prepare_dense_output`].
    ///
    /// `state` must have the dimension of the system. Before the first step it is the initial state.
    pub fn interpolate(&self, time: f64, state: &mut [f64]) {
        if !self.dense_is_ready {
            state.copy_from_slice(if time == self.previous_time() {
                &self.previous_state
            } else {
                &self.state
            });
            return;
        }
        let mut on_clock = self.clock.reading(time);
        if self.clock.begins_anew() {
            // A time is known to rounding only, which may be more than a whole step: there is nothing to extrapolate.
            let (first, last) = (self.previous_time.min(self.time), self.previous_time.max(self.time));
            let rounding = STEP_RESOLUTION * time.abs();
            if (first - rounding..=last + rounding).contains(&on_clock) {
                on_clock = on_clock.clamp(first, last);
            }
        }
        self.interpolate_on_clock(on_clock, state);
    }

    /// The same at a time on the clock, after [`Stepper::prepare_dense_output`].
    pub(super) fn interpolate_on_clock(&self, time: f64, state: &mut [f64]) {
        if !self.dense_is_ready {
            state.copy_from_slice(&self.state);
            return;
        }
        if let Some(radau) = self.implicit.as_ref().filter(|_| self.last_is_implicit) {
            radau.interpolate(time, state);
            return;
        }
        let x = (time - self.previous_time) / (self.time - self.previous_time);
        interpolate(&self.dense, &self.previous_state, x, state);
    }
}

/// Adds the combination `row` of `stages` to `sum`.
#[inline(always)]
fn accumulate(row: Row, stages: &[f64], sum: &mut [f64]) {
    let n = sum.len();
    for &(stage, coefficient) in row {
        for (total, &slope) in sum.iter_mut().zip(&stages[stage * n..(stage + 1) * n]) {
            *total += coefficient * slope;
        }
    }
}

/// Dense output at the fraction `x` of a step: Hairer, Norsett and Wanner (1993), II.6.
fn interpolate(dense: &[f64], origin: &[f64], x: f64, state: &mut [f64]) {
    let n = origin.len();
    for i in 0..n {
        let mut value = 0.0;
        for k in (0..DENSE_COEFFICIENTS).rev() {
            value = (value + dense[k * n + i]) * if k % 2 == 0 { x } else { 1.0 - x };
        }
        state[i] = origin[i] + value;
    }
}
