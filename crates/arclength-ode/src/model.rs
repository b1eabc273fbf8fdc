//! A model: what the text declares, ready to evaluate.

use crate::compile::{Lowering, Regions, Scope, Symbol};
use crate::declarations::{Declarations, InitialValue, SetDefinition};
use crate::error::{OdeError, Place, Warning};
use crate::event::Event;
use crate::expression::parse_number;
use crate::options::{OptionEntry, Options};
use crate::source::{decode, physical_lines};
use crate::switches::{GivenUp, Switch, TimeSwitches};
use crate::tape::{MAXIMUM_REGISTERS, Tape, schedule};
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
    /// Reads a model from text.
    ///
    /// # Errors
    ///
    /// [`OdeError`] where the text is not a model, or not one that is a smooth system of ordinary
    /// differential equations.
    pub fn parse(source: &str) -> Result<Self, OdeError> {
        let source = source.strip_prefix('\u{feff}').unwrap_or(source);
        let lines: Vec<&str> = physical_lines(source).collect();
        read(source, &lines).map_err(|error| error.with_source(&lines))
    }

    /// Reads a model from the bytes of a file, in UTF-8 or else in Latin-1.
    ///
    /// # Errors
    ///
    /// As [`Model::parse`].
    pub fn parse_bytes(bytes: &[u8]) -> Result<Self, OdeError> {
        Self::parse(&decode(bytes))
    }

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

fn read(source: &str, source_lines: &[&str]) -> Result<Model, OdeError> {
    let mut declarations = Declarations::read(source)?;
    if declarations.equations.is_empty() {
        return Err(OdeError::NoEquations);
    }
    let states = declarations.equations.len();
    let parameters = declarations.parameters.len();

    let mut lowering = Lowering::new(&declarations.symbols);
    // In the order of the text, so that a chain of quantities is no deep recursion.
    for index in 0..declarations.symbols.derived.len() {
        lowering.derived_parameter(index)?;
    }
    for index in 0..declarations.symbols.fixed.len() {
        lowering.fixed_quantity(index)?;
    }
    let field = declarations
        .equations
        .iter()
        .map(|equation| lowering.lower(equation, Scope::Field))
        .collect::<Result<Vec<_>, _>>()?;
    let field = lowering.graph.with_norms(field);
    let conditions = declarations
        .events
        .iter()
        .map(|event| lowering.lower(&event.condition, Scope::Field))
        .collect::<Result<Vec<_>, _>>()?;
    let mut actions = Vec::new();
    for event in &declarations.events {
        let mut list = Vec::new();
        for assignment in &event.assignments {
            let value = lowering.lower(&assignment.expression, Scope::Field)?;
            match declarations.action(&assignment.name)? {
                Some(action) => list.push((action, value)),
                None => lowering.warnings.push(Warning::new(
                    assignment.name.span,
                    format!("`{}` is ignored: events are located where they happen", assignment.name.text),
                )),
            }
        }
        actions.push(list);
    }
    let mut auxiliary = Vec::new();
    let mut auxiliaries = Vec::new();
    let mut left_out = Vec::new();
    for definition in &declarations.auxiliaries {
        let name = definition.name.text.clone();
        match lowering.output(definition)? {
            Ok(node) => {
                auxiliary.push(node);
                auxiliaries.push(name);
            }
            Err(error) => left_out.push((name, error)),
        }
    }
    let derivation = (0..declarations.symbols.derived.len())
        .map(|index| lowering.derived_parameter(index))
        .collect::<Result<Vec<_>, _>>()?;
    let mut initial = vec![lowering.graph.constant(0.0); states];
    for (name, value) in &declarations.initial {
        if declarations.is_refused(name) {
            continue;
        }
        initial[declarations.state(name)?] = match value {
            InitialValue::Number(value) => lowering.graph.constant(*value),
            InitialValue::Formula(expression) => lowering.lower(expression, Scope::Initial)?,
        };
    }

    let first = declarations.symbols.states[0].span;
    let too_large = || OdeError::TooLarge {
        place: first.into(),
        what: "the model needs too many registers".into(),
        limit: MAXIMUM_REGISTERS,
    };
    let compile = |results: &[u32], states: usize| {
        schedule(&lowering.graph, results, states, parameters).ok_or_else(too_large)
    };
    let regions = Regions::of(&lowering.graph, &field, parameters);
    let thresholds = regions.as_ref().map_or(Vec::new(), |regions| regions.thresholds.clone());
    let regions = regions
        .map(|Regions { graph, results, thresholds }| {
            schedule(&graph, &results, states, parameters + thresholds.len()).ok_or_else(too_large)
        })
        .transpose()?;
    let switches = TimeSwitches::of(&lowering.graph, &field, &conditions);
    let events = declarations.events.iter().zip(&conditions).zip(&actions);
    let events = events
        .map(|((definition, &condition), actions)| {
            Ok(Event {
                place: filled(definition.span.into(), source_lines),
                direction: definition.direction,
                condition: compile(&[condition], states)?,
                actions: actions
                    .iter()
                    .map(|&(action, value)| Ok((action, compile(&[value], states)?)))
                    .collect::<Result<_, OdeError>>()?,
            })
        })
        .collect::<Result<_, OdeError>>()?;
    let field = compile(&field, states)?;
    let time =
        if field.uses_time() { lowering.time.map(|span| filled(span.into(), source_lines)) } else { None };
    let auxiliary = compile(&auxiliary, states)?;
    let derivation = compile(&derivation, 0)?;
    let initial = compile(&initial, 0)?;

    let mut warnings = std::mem::take(&mut declarations.warnings);
    warnings.append(&mut lowering.warnings);
    drop(lowering);
    let sets = std::mem::take(&mut declarations.sets)
        .iter()
        .map(|set| named_set(set, &declarations, source_lines))
        .collect::<Result<_, _>>()?;
    let mut options = declarations.options;
    for entry in &mut options.entries {
        entry.place = filled(entry.place.clone(), source_lines);
    }
    let mut warnings: Vec<Warning> =
        warnings.into_iter().map(|warning| warning.with_source(source_lines)).collect();
    warnings.sort_by_key(|warning| (warning.place.line, warning.place.column));
    warnings.dedup();

    let symbols = declarations.symbols;
    let numbers = symbols
        .constants
        .iter()
        .filter_map(|(name, symbol)| match symbol {
            Symbol::Number(value) => Some((name.clone(), *value)),
            _ => None,
        })
        .collect();
    Ok(Model {
        source: source.to_owned(),
        states: symbols.states.into_iter().map(|name| name.text).collect(),
        defaults: declarations.parameters.iter().map(|parameter| parameter.value).collect(),
        parameter_places: declarations
            .parameters
            .iter()
            .map(|parameter| filled(parameter.name.span.into(), source_lines))
            .collect(),
        parameters: declarations.parameters.into_iter().map(|parameter| parameter.name.text).collect(),
        auxiliaries,
        left_out,
        derived: symbols.derived.into_iter().map(|definition| definition.name.text).collect(),
        functions: symbols.functions.iter().map(|function| function.signature()).collect(),
        numbers,
        sets,
        options,
        warnings,
        time,
        frozen: None,
        switches,
        field,
        regions,
        thresholds,
        events,
        auxiliary,
        derivation,
        initial,
    })
}

fn filled(mut place: Place, source_lines: &[&str]) -> Place {
    place.fill(source_lines);
    place
}

fn named_set(
    definition: &SetDefinition,
    declarations: &Declarations,
    source_lines: &[&str],
) -> Result<NamedSet, OdeError> {
    let mut set = NamedSet {
        name: definition.name.text.clone(),
        states: Vec::new(),
        parameters: Vec::new(),
        options: Vec::new(),
    };
    for (name, value, span) in &definition.entries {
        let number = || {
            parse_number(value)
                .ok_or_else(|| OdeError::syntax(*span, format!("expected a number, found `{value}`")))
        };
        match declarations.symbols.names.get(&name.key()) {
            Some(&Symbol::State(index)) => set.states.push((index, number()?)),
            Some(&Symbol::Parameter(index)) => set.parameters.push((index, number()?)),
            _ => set.options.push(OptionEntry {
                name: name.key(),
                value: value.clone(),
                place: filled(name.span.into(), source_lines),
            }),
        }
    }
    Ok(set)
}
