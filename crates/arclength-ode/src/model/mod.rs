//! A model: what the text declares, ready to evaluate.

mod reading;

use crate::error::{OdeError, Place, Warning};
use crate::event::Event;
use crate::options::{OptionEntry, Options};
use crate::switches::{GivenUp, Switch, TimeSwitches};
use crate::tape::Tape;
use arclength::{Direction, ErasedField, Scalar, Threshold, VectorField};

/// A model read from a `.ode` text.
///
/// Names keep their first spelling and are looked up without regard to case, as in XPPAUT.
#[derive(Clone, Debug)]
pub struct Model {
    source: String,
    states: Vec<String>,
    parameters: Vec<String>,
    defaults: Vec<f64>,
    parameter_places: Vec<Place>,
    auxiliaries: Vec<String>,
    /// Auxiliary quantities that are not supported, and why.
    left_out: Vec<(String, OdeError)>,
    derived: Vec<String>,
    functions: Vec<String>,
    numbers: Vec<(String, f64)>,
    sets: Vec<NamedSet>,
    options: Options,
    warnings: Vec<Warning>,
    time: Option<Place>,
    frozen: Option<f64>,
    switches: TimeSwitches,
    field: Tape,
    /// The field in a region, and the switch functions.
    regions: Option<Tape>,
    thresholds: Vec<Threshold>,
    /// Whether anything in the field switches.
    has_switches: bool,
    events: Vec<Event>,
    auxiliary: Tape,
    derivation: Tape,
    initial: Tape,
}

/// A named set of values, `set name {x=1,a=2,total=100}`.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSet {
    /// Name as written.
    pub name: String,
    /// Initial values: index of the state, value.
    pub states: Vec<(usize, f64)>,
    /// Parameter values: index of the parameter, value.
    pub parameters: Vec<(usize, f64)>,
    /// What is neither a state nor a parameter.
    pub options: Vec<OptionEntry>,
}

impl Model {
    /// The text from which the model was read; [`Model::parse`] of it gives the same model.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// What was read but deserves a look, in the order of the text.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Names of the states, borrowed; see also [`VectorField::state_names`].
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// Names of the parameters, borrowed; see also [`VectorField::parameter_names`].
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// Default values of the parameters, in their order.
    pub fn default_parameters(&self) -> &[f64] {
        &self.defaults
    }

    /// Where a parameter is declared, by its index.
    pub fn parameter_place(&self, index: usize) -> Option<&Place> {
        self.parameter_places.get(index)
    }

    /// Index of the state of that name, whatever its case.
    pub fn state_index(&self, name: &str) -> Option<usize> {
        position(&self.states, name)
    }

    /// Index of the parameter of that name, whatever its case.
    pub fn parameter_index(&self, name: &str) -> Option<usize> {
        position(&self.parameters, name)
    }

    /// Names and values of the constants declared with `number`.
    pub fn numbers(&self) -> &[(String, f64)] {
        &self.numbers
    }

    /// The functions, as they are called: `f(x,y)`.
    pub fn functions(&self) -> &[String] {
        &self.functions
    }

    /// The named sets.
    pub fn sets(&self) -> &[NamedSet] {
        &self.sets
    }

    /// The named set of that name, whatever its case.
    pub fn set(&self, name: &str) -> Option<&NamedSet> {
        self.sets.iter().find(|set| set.name.eq_ignore_ascii_case(name))
    }

    /// The options of the lines `@`.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The initial state at given parameters; states without an initial value start at 0.
    pub fn initial_state(&self, parameters: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.states.len()];
        self.initial.evaluate(0.0, &[], parameters, &mut state);
        state
    }

    /// Whether the field does not depend on the time, or the time is frozen.
    pub fn is_autonomous(&self) -> bool {
        self.time_dependence().is_none()
    }

    /// The first place where the field uses the time `t`, unless that is frozen.
    pub fn time_dependence(&self) -> Option<&Place> {
        self.time.as_ref().filter(|_| self.frozen.is_none())
    }

    /// Has [`VectorField::evaluate`] be the right-hand side at one time, so that it is a field of its own.
    pub fn freeze(&mut self, time: f64) {
        self.frozen = Some(time);
    }

    /// Writes the right-hand side at a time into `derivative`.
    ///
    /// [`VectorField::evaluate`] is this at the time that is [frozen](Self::freeze), by default 0. As there, it is that of a
    /// [region](VectorField::thresholds) where the parameters are followed by cells; what switches on the time alone does so there, too.
    pub fn evaluate_at<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], derivative: &mut [T]) {
        match &self.regions {
            Some(regions) if parameters.len() > self.parameters.len() => {
                regions.evaluate(time, state, parameters, derivative);
            }
            _ => self.field.evaluate(time, state, parameters, derivative),
        }
    }

    /// The events (`global`), in the order of the text.
    pub fn global_events(&self) -> &[Event] {
        &self.events
    }

    /// The first time in `from..=until` at which the right-hand side at these parameters, or the condition of an event, jumps or has
    /// a kink, or such a condition passes zero, because of something that depends on the time alone.
    ///
    /// # Errors
    /// [`GivenUp`] where the times cannot be told apart from others.
    pub fn next_switch(&self, from: f64, until: f64, parameters: &[f64]) -> Result<Option<Switch>, GivenUp> {
        self.switches.next(from, until, parameters)
    }

    /// Names of the auxiliary quantities (`aux`), without those that are not supported, of which a warning tells.
    pub fn auxiliary_names(&self) -> &[String] {
        &self.auxiliaries
    }

    /// Writes the auxiliary quantities into `values`, in the order of [`Model::auxiliary_names`].
    pub fn evaluate_auxiliary<T: Scalar>(&self, time: T, state: &[T], parameters: &[T], values: &mut [T]) {
        self.auxiliary.evaluate(time, state, parameters, values);
    }

    /// Why the auxiliary quantity of that name is left out, if it is.
    pub(crate) fn left_out(&self, name: &str) -> Option<&OdeError> {
        self.left_out.iter().find(|(left, _)| left == name).map(|(_, error)| error)
    }

    /// Names of the derived parameters (`!name=...`).
    pub fn derived_names(&self) -> &[String] {
        &self.derived
    }

    /// Writes the derived parameters into `values`, in the order of [`Model::derived_names`].
    pub fn evaluate_derived<T: Scalar>(&self, parameters: &[T], values: &mut [T]) {
        self.derivation.evaluate(T::zero(), &[], parameters, values);
    }

    /// Number of instructions that one evaluation of the field takes.
    pub fn instruction_count(&self) -> usize {
        self.field.instructions()
    }

    /// Number of registers that one evaluation of the field uses.
    pub fn register_count(&self) -> usize {
        self.field.registers()
    }
}

impl VectorField for Model {
    fn state_names(&self) -> Vec<String> {
        self.states.clone()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.parameters.clone()
    }

    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        self.evaluate_at(T::from(self.frozen.unwrap_or(0.0)), state, parameters, derivative);
    }

    fn thresholds(&self) -> Vec<Threshold> {
        self.thresholds.clone()
    }

    fn events(&self) -> Vec<Direction> {
        self.events.iter().map(Event::direction).collect()
    }

    fn evaluate_event<T: Scalar>(&self, event: usize, state: &[T], parameters: &[T], values: &mut [T]) {
        let time = T::from(self.frozen.unwrap_or(0.0));
        let Some((condition, next)) = values.split_first_mut() else { return };
        *condition = self.events[event].condition(time, state, parameters);
        if !next.is_empty() {
            next.copy_from_slice(state);
            self.events[event].apply(time, next, parameters);
        }
    }

    fn dimension(&self) -> usize {
        self.states.len()
    }

    // The interpreter is long, and there is one for each scalar.
    #[inline(never)]
    fn erased(&self) -> ErasedField<'_> {
        ErasedField::new(self)
    }
}

fn position(names: &[String], name: &str) -> Option<usize> {
    names.iter().position(|candidate| candidate.eq_ignore_ascii_case(name))
}
