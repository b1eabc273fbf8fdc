//! Makes a model of its text.

use super::{Model, NamedSet};
use crate::compile::{Graph, Lowering, NodeId, Regions, Scope, Symbol, Unguarded};
use crate::declarations::{Declarations, EventDefinition, InitialValue, SetDefinition};
use crate::error::{OdeError, Place, Span, Warning};
use crate::event::{Action, Event};
use crate::expression::parse_number;
use crate::options::OptionEntry;
use crate::source::{decode, physical_lines};
use crate::switches::TimeSwitches;
use crate::tape::{MAXIMUM_REGISTERS, Tape, schedule};
use crate::vanishing::Vanishing;
use arclength::Threshold;

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

    /// Which states stay zero; `None` of a text that cannot be read once more.
    pub fn vanishing(&self) -> Option<Vanishing> {
        let declarations = Declarations::read(&self.source).ok()?;
        let mut lowering = Lowering::new(&declarations.symbols);
        let field = Lowered::of(&declarations, &mut lowering).ok()?.field;
        Some(Vanishing { graph: lowering.graph, field })
    }

    /// The model as its branches are followed at these parameters, and the largest relative change that makes; `None` where it is this one.
    ///
    /// Guards of removable `0/0`, as `if(abs(v)<1e-4)then(1)else(v/(1-exp(-v)))`, are left out, as the quotient is computed
    /// without them: the change is that of the quotient where the guard held, `None` where there is none. What switches on the parameter
    /// that varies, given by its number, is among the [switch functions](arclength::VectorField::thresholds), so that a branch along it passes a kink
    /// or a jump there as it passes those in states.
    ///
    /// ```
    /// use arclength::VectorField;
    /// let model = arclength_ode::Model::parse("par p=1\nx'=max(p,0)-x\ndone\n")?;
    /// assert!(model.thresholds().is_empty());
    /// assert_eq!(model.for_continuation(&[1.0], Some(0)).unwrap().0.thresholds().len(), 1);
    /// let model = arclength_ode::Model::parse("x'=1-if(abs(x)<1e-4)then(1)else(x/(1-exp(-x)))\ndone\n")?;
    /// let (smooth, change) = model.for_continuation(&[], None).unwrap();
    /// assert_eq!((model.thresholds().len(), smooth.thresholds().len()), (2, 0));
    /// assert!((change.unwrap() / 5e-5 - 1.0).abs() < 1e-4);
    /// # Ok::<(), arclength_ode::OdeError>(())
    /// ```
    pub fn for_continuation(
        &self,
        parameters: &[f64],
        varying: Option<usize>,
    ) -> Option<(Self, Option<f64>)> {
        if !self.has_switches {
            return None;
        }
        // The text has been read before; should that fail now, the field is followed as it is.
        let Continued { field, regions, thresholds, change } =
            Continued::read(&self.source, parameters, varying).ok()?;
        Some((Self { field, regions, thresholds, ..self.clone() }, change))
    }
}

/// What replaces the field of a model where a branch is followed.
struct Continued {
    field: Tape,
    regions: Option<Tape>,
    thresholds: Vec<Threshold>,
    /// The largest relative change of a quotient whose guard was left out.
    change: Option<f64>,
}

impl Continued {
    /// Of the model of a text at these parameters, with what switches on the parameter that varies.
    fn read(source: &str, parameters: &[f64], varying: Option<usize>) -> Result<Self, OdeError> {
        let declarations = Declarations::read(source)?;
        let mut lowering = Lowering::new(&declarations.symbols);
        let lowered = Lowered::of(&declarations, &mut lowering)?;
        let unguarded = Unguarded::of(&lowering.graph, &lowered.field, parameters);
        let (graph, nodes) = match &unguarded {
            Some(Unguarded { graph, field, .. }) => (graph, field),
            None => (&lowering.graph, &lowered.field),
        };
        let compiler = Compiler::of(&declarations, graph);
        let (regions, thresholds) = compiler.regions(nodes, varying)?;
        let change = unguarded.as_ref().map(|unguarded| unguarded.change);
        Ok(Self { field: compiler.of_motion(nodes)?, regions, thresholds, change })
    }
}

fn read(source: &str, source_lines: &[&str]) -> Result<Model, OdeError> {
    let mut declarations = Declarations::read(source)?;
    if declarations.equations.is_empty() {
        return Err(OdeError::NoEquations);
    }
    let mut lowering = Lowering::new(&declarations.symbols);
    let lowered = Lowered::of(&declarations, &mut lowering)?;
    let compiler = Compiler::of(&declarations, &lowering.graph);
    let (regions, thresholds) = compiler.regions(&lowered.field, None)?;
    let has_switches = lowering.graph.any_switches(&lowered.field);
    let switches = TimeSwitches::of(&lowering.graph, &lowered.field, &lowered.conditions);
    let events = compiler.events(&declarations.events, &lowered, source_lines)?;
    let field = compiler.of_motion(&lowered.field)?;
    let auxiliary = compiler.of_motion(&lowered.auxiliary)?;
    let derivation = compiler.of_parameters(&lowered.derivation)?;
    let initial = compiler.of_parameters(&lowered.initial)?;
    let time =
        if field.uses_time() { lowering.time.map(|span| filled(span.into(), source_lines)) } else { None };

    let mut warnings = std::mem::take(&mut declarations.warnings);
    warnings.append(&mut lowering.warnings);
    let sets = declarations
        .sets
        .iter()
        .map(|set| named_set(set, &declarations, source_lines))
        .collect::<Result<_, _>>()?;
    let mut options = declarations.options;
    for entry in &mut options.entries {
        entry.place = filled(entry.place.clone(), source_lines);
    }
    let symbols = declarations.symbols;
    let numbers = symbols.constants.iter().filter_map(|(name, symbol)| match symbol {
        Symbol::Number(value) => Some((name.clone(), *value)),
        _ => None,
    });
    let parameters = declarations.parameters;
    Ok(Model {
        source: source.to_owned(),
        numbers: numbers.collect(),
        states: symbols.states.into_iter().map(|name| name.text).collect(),
        defaults: parameters.iter().map(|parameter| parameter.value).collect(),
        parameter_places: parameters
            .iter()
            .map(|parameter| filled(parameter.name.span.into(), source_lines))
            .collect(),
        parameters: parameters.into_iter().map(|parameter| parameter.name.text).collect(),
        auxiliaries: lowered.auxiliaries,
        left_out: lowered.left_out,
        derived: symbols.derived.into_iter().map(|definition| definition.name.text).collect(),
        functions: symbols.functions.iter().map(|function| function.signature()).collect(),
        sets,
        options,
        warnings: in_order(warnings, source_lines),
        time,
        frozen: None,
        switches,
        field,
        regions,
        thresholds,
        has_switches,
        events,
        auxiliary,
        derivation,
        initial,
    })
}

/// What is declared, as nodes of one graph.
struct Lowered {
    field: Vec<NodeId>,
    /// Of the events.
    conditions: Vec<NodeId>,
    actions: Vec<Vec<(Action, NodeId)>>,
    auxiliary: Vec<NodeId>,
    auxiliaries: Vec<String>,
    /// Auxiliary quantities that are not supported, and why.
    left_out: Vec<(String, OdeError)>,
    /// The derived parameters.
    derivation: Vec<NodeId>,
    /// The initial state.
    initial: Vec<NodeId>,
}

impl Lowered {
    fn of(declarations: &Declarations, lowering: &mut Lowering<'_>) -> Result<Self, OdeError> {
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
        let mut lowered = Self {
            field: lowering.graph.with_norms(field),
            conditions: Vec::new(),
            actions: Vec::new(),
            auxiliary: Vec::new(),
            auxiliaries: Vec::new(),
            left_out: Vec::new(),
            derivation: Vec::new(),
            initial: Vec::new(),
        };
        lowered.lower_events(declarations, lowering)?;
        lowered.lower_auxiliaries(declarations, lowering)?;
        lowered.derivation = (0..declarations.symbols.derived.len())
            .map(|index| lowering.derived_parameter(index))
            .collect::<Result<_, _>>()?;
        lowered.lower_initial_state(declarations, lowering)?;
        Ok(lowered)
    }

    fn lower_events(
        &mut self,
        declarations: &Declarations,
        lowering: &mut Lowering<'_>,
    ) -> Result<(), OdeError> {
        for event in &declarations.events {
            self.conditions.push(lowering.lower(&event.condition, Scope::Field)?);
        }
        for event in &declarations.events {
            let mut list = Vec::new();
            for assignment in &event.assignments {
                let value = lowering.lower(&assignment.expression, Scope::Field)?;
                match declarations.action(&assignment.name)? {
                    Some(action) => list.push((action, value)),
                    None => lowering.warnings.push(Warning::new(
                        assignment.name.span,
                        format!(
                            "`{}` is ignored: events are located where they happen",
                            assignment.name.text
                        ),
                    )),
                }
            }
            self.actions.push(list);
        }
        Ok(())
    }

    fn lower_auxiliaries(
        &mut self,
        declarations: &Declarations,
        lowering: &mut Lowering<'_>,
    ) -> Result<(), OdeError> {
        for definition in &declarations.auxiliaries {
            let name = definition.name.text.clone();
            match lowering.output(definition)? {
                Ok(node) => {
                    self.auxiliary.push(node);
                    self.auxiliaries.push(name);
                }
                Err(error) => self.left_out.push((name, error)),
            }
        }
        Ok(())
    }

    fn lower_initial_state(
        &mut self,
        declarations: &Declarations,
        lowering: &mut Lowering<'_>,
    ) -> Result<(), OdeError> {
        self.initial = vec![lowering.graph.constant(0.0); declarations.equations.len()];
        for (name, value) in &declarations.initial {
            if declarations.is_refused(name) {
                continue;
            }
            self.initial[declarations.state(name)?] = match value {
                InitialValue::Number(value) => lowering.graph.constant(*value),
                InitialValue::Formula(expression) => lowering.lower(expression, Scope::Initial)?,
            };
        }
        Ok(())
    }
}

/// Makes tapes of nodes.
struct Compiler<'a> {
    graph: &'a Graph,
    /// Numbers of states and parameters.
    states: usize,
    parameters: usize,
    /// Where the first state is declared: what a message about the whole model points at.
    first: Span,
}

impl<'a> Compiler<'a> {
    fn of(declarations: &Declarations, graph: &'a Graph) -> Self {
        Self {
            graph,
            states: declarations.equations.len(),
            parameters: declarations.parameters.len(),
            first: declarations.symbols.states[0].span,
        }
    }

    /// Of what depends on time, state and parameters.
    fn of_motion(&self, results: &[NodeId]) -> Result<Tape, OdeError> {
        self.tape(self.graph, results, self.states, self.parameters)
    }

    /// Of what depends on the parameters only.
    fn of_parameters(&self, results: &[NodeId]) -> Result<Tape, OdeError> {
        self.tape(self.graph, results, 0, self.parameters)
    }

    fn tape(
        &self,
        graph: &Graph,
        results: &[NodeId],
        states: usize,
        parameters: usize,
    ) -> Result<Tape, OdeError> {
        schedule(graph, results, states, parameters).ok_or_else(|| OdeError::TooLarge {
            place: self.first.into(),
            what: "the model needs too many registers".into(),
            limit: MAXIMUM_REGISTERS,
        })
    }

    /// The field in a region, where something switches on a state, or on the parameter that varies, with what it switches on.
    fn regions(
        &self,
        field: &[NodeId],
        varying: Option<usize>,
    ) -> Result<(Option<Tape>, Vec<Threshold>), OdeError> {
        let regions = Regions::of(self.graph, field, self.parameters, varying);
        let Some(Regions { graph, results, thresholds }) = regions else {
            return Ok((None, Vec::new()));
        };
        let tape = self.tape(&graph, &results, self.states, self.parameters + thresholds.len())?;
        Ok((Some(tape), thresholds))
    }

    fn events(
        &self,
        definitions: &[EventDefinition],
        lowered: &Lowered,
        source_lines: &[&str],
    ) -> Result<Vec<Event>, OdeError> {
        let events = definitions.iter().zip(&lowered.conditions).zip(&lowered.actions);
        events
            .map(|((definition, &condition), actions)| {
                Ok(Event {
                    place: filled(definition.span.into(), source_lines),
                    direction: definition.direction,
                    condition: self.of_motion(&[condition])?,
                    actions: actions
                        .iter()
                        .map(|&(action, value)| Ok((action, self.of_motion(&[value])?)))
                        .collect::<Result<_, OdeError>>()?,
                })
            })
            .collect()
    }
}

/// Warnings in the order of the text, each once.
fn in_order(warnings: Vec<Warning>, source_lines: &[&str]) -> Vec<Warning> {
    let mut warnings: Vec<Warning> =
        warnings.into_iter().map(|warning| warning.with_source(source_lines)).collect();
    warnings.sort_by_key(|warning| (warning.place.line, warning.place.column));
    warnings.dedup();
    warnings
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
