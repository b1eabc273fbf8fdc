//! Asking for a branch: the same for equilibria, cycles and curves of their bifurcations.

use super::{LabelCounter, Monitor, SpecialKind, label_kind};
use crate::continuation::{Bound, Observer, Origin, Request, Settings, Solution, Target};
use crate::erased::ErasedField;
use crate::error::Error;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::ops::{ControlFlow, RangeInclusive};
use std::rc::Rc;

/// What a branch consists of and starts from.
pub trait Problem {
    /// What is told of a point of the branch.
    type Point;

    /// Settings that suit the problem.
    fn settings() -> Settings;
}

/// A branch to be followed, from a start `S` over ranges of one or two parameters.
///
/// See [`Equilibria`](crate::equilibrium::Equilibria), [`Cycles`](crate::cycle::Cycles),
/// [`EquilibriumLocus`](crate::locus::EquilibriumLocus) and [`CycleLocus`](crate::locus::CycleLocus).
pub struct Continuation<'a, S: Problem> {
    pub(crate) field: ErasedField<'a>,
    pub(crate) start: S,
    pub(crate) parameters: Option<Vec<f64>>,
    pub(crate) ranges: Vec<(String, RangeInclusive<f64>)>,
    pub(crate) at: Vec<f64>,
    pub(crate) monitors: Vec<Monitor<'a, S::Point>>,
    pub(crate) settings: Settings,
    pub(crate) observer: Option<Box<PointObserver<'a, S::Point>>>,
}

impl<'a, S: Problem> Continuation<'a, S> {
    pub(crate) fn of_erased(field: ErasedField<'a>, start: S) -> Self {
        Self {
            field,
            start,
            parameters: None,
            ranges: Vec::new(),
            at: Vec::new(),
            monitors: Vec::new(),
            settings: S::settings(),
            observer: None,
        }
    }

    /// Values of all parameters where the branch starts, in the field's order.
    pub fn parameters(mut self, values: &[f64]) -> Self {
        self.parameters = Some(values.to_vec());
        self
    }

    /// The parameter to vary, by name, and its range.
    pub fn along(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.ranges.insert(0, (parameter.to_owned(), range));
        self
    }

    /// The second parameter to vary and its range, of a curve in two parameters.
    pub fn and(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.ranges.push((parameter.to_owned(), range));
        self
    }

    /// Values of the first parameter at which points are wanted exactly.
    pub fn at(mut self, values: &[f64]) -> Self {
        self.at = values.to_vec();
        self
    }

    /// Records a quantity along the branch, and locates the points where it has given values.
    pub fn monitor(mut self, monitor: Monitor<'a, S::Point>) -> Self {
        self.monitors.push(monitor);
        self
    }

    /// Step control and tolerances.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Somebody to tell every point as it is found, special ones too, who may end the run. Labels are numbered in the order in
    /// which points are found; those of the finished branch in its order.
    pub fn observer(mut self, observer: impl FnMut(&S::Point) -> ControlFlow<()> + 'a) -> Self {
        self.observer = Some(Box::new(observer));
        self
    }

    /// Indices of the parameters that vary and their bounds; exactly `count` have to be given.
    pub(crate) fn active(&self, count: usize) -> Result<(Vec<usize>, Vec<Bound>), Error> {
        let names = self.field.parameter_names();
        if self.ranges.len() != count {
            let wanted =
                if count == 1 { "one parameter and its range" } else { "two parameters and their ranges" };
            return Err(invalid("along", &format!("{} parameters", self.ranges.len()), wanted));
        }
        let mut active = Vec::new();
        let mut bounds = Vec::new();
        for (place, (name, range)) in self.ranges.iter().enumerate() {
            let index = names.iter().position(|candidate| candidate == name);
            let index =
                index.ok_or_else(|| invalid("along", name, &format!("one of {}", names.join(", "))))?;
            if active.contains(&index) {
                return Err(invalid("along", name, "two different parameters"));
            }
            active.push(index);
            bounds.push(Bound { from_end: count - place, ..check_range(name, range)? });
        }
        let first = bounds[0];
        if let Some(value) = self.at.iter().find(|value| !(first.lower..=first.upper).contains(*value)) {
            return Err(invalid("at", &value.to_string(), &format!("{} to {}", first.lower, first.upper)));
        }
        Ok((active, bounds))
    }

    /// Values of all parameters at the start.
    pub(crate) fn checked_parameters(&self) -> Result<Vec<f64>, Error> {
        let parameters = self
            .parameters
            .clone()
            .ok_or_else(|| invalid("parameters", "nothing", "a value for each parameter"))?;
        let count = self.field.parameter_names().len();
        check_length("parameters", &parameters, count, "the number of parameters")?;
        Ok(parameters)
    }
}

/// Somebody who is told of points as they are found, and who may end the run.
pub(crate) type PointObserver<'o, P> = dyn FnMut(&P) -> ControlFlow<()> + 'o;

/// Turns a solution into a point of the branch.
pub(crate) type PointOf<'p, Q, P> = dyn Fn(&Solution<Q>, Option<super::Label>) -> P + 'p;

/// What a run of the continuation is asked for, with monitors as functions of solutions, which `bare` makes points without
/// monitors of.
pub(crate) fn request<'r, Q, P>(
    bounds: &[Bound],
    at: &[f64],
    monitors: &'r [Monitor<'_, P>],
    settings: Settings,
    bare: &'r dyn Fn(&Solution<Q>) -> P,
) -> Request<'r, Q> {
    let targets = monitors
        .iter()
        .enumerate()
        .flat_map(|(index, monitor)| {
            let last = LastReadings::default();
            monitor.values().iter().map(move |&(value, purpose)| Target {
                monitor: index,
                value,
                purpose,
                function: Box::new(remembering(last.clone(), |solution| monitor.value(&bare(solution)))),
            })
        })
        .collect();
    Request { bounds: bounds.to_vec(), values: at.to_vec(), targets, settings }
}

/// Unknowns and tangents at which a monitor was evaluated last, and its values there.
type LastReadings = Rc<RefCell<VecDeque<([Vec<f64>; 2], Option<f64>)>>>;
/// That many are remembered: of both ends of a step, of the solution before and of one between.
const REMEMBERED: usize = 4;

/// A function of solutions that is not evaluated again at the solutions of last time: a run asks at both ends of every step, for every
/// value of a monitor.
fn remembering<Q>(
    last: LastReadings,
    function: impl Fn(&Solution<Q>) -> Option<f64>,
) -> impl Fn(&Solution<Q>) -> Option<f64> {
    move |solution| {
        let is_here =
            |[unknown, tangent]: &[Vec<f64>; 2]| *unknown == solution.unknown && *tangent == solution.tangent;
        if let Some((_, value)) = last.borrow().iter().find(|(place, _)| is_here(place)) {
            return *value;
        }
        let value = function(solution);
        let mut last = last.borrow_mut();
        last.truncate(REMEMBERED - 1);
        last.push_front(([solution.unknown.clone(), solution.tangent.clone()], value));
        value
    }
}

/// The observer of solutions that tells an observer of points.
pub(crate) fn observer<'o, Q, P>(
    told: Option<&'o mut PointObserver<'o, P>>,
    point: &'o PointOf<'o, Q, P>,
) -> Box<Observer<'o, Q, SpecialKind>> {
    let mut labels = LabelCounter::default();
    match told {
        None => Box::new(|_, _| ControlFlow::Continue(())),
        Some(told) => Box::new(move |solution: &Solution<Q>, origin: Origin<SpecialKind>| {
            let label = label_kind(origin).map(|kind| labels.next(kind));
            told(&point(solution, label))
        }),
    }
}

impl<S: Problem + fmt::Debug> fmt::Debug for Continuation<'_, S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Continuation")
            .field("field", &self.field)
            .field("start", &self.start)
            .field("parameters", &self.parameters)
            .field("ranges", &self.ranges)
            .field("at", &self.at)
            .field("monitors", &self.monitors.len())
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// The range of a parameter as a bound of the last unknown.
pub(crate) fn check_range(name: &str, range: &RangeInclusive<f64>) -> Result<Bound, Error> {
    let (lower, upper) = (*range.start(), *range.end());
    if lower < upper && (upper - lower).is_finite() {
        Ok(Bound { from_end: 1, lower, upper })
    } else {
        let allowed = "two finite numbers, the smaller one first";
        Err(invalid(&format!("range of {name}"), &format!("{lower} to {upper}"), allowed))
    }
}

/// That a list has the length that it should have and finite entries.
pub(crate) fn check_length(name: &str, values: &[f64], length: usize, what: &str) -> Result<(), Error> {
    if values.len() != length {
        return Err(invalid(
            name,
            &format!("{} numbers", values.len()),
            &format!("{length} numbers, {what}"),
        ));
    }
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(invalid(name, &value.to_string(), "finite numbers")),
        None => Ok(()),
    }
}

/// An error about something asked for.
pub(crate) fn invalid(name: &str, value: &str, allowed: &str) -> Error {
    Error::Invalid { name: name.into(), value: value.into(), allowed: allowed.into() }
}
