//! What branches of every kind have in common: how they are asked for, their points with labels, why they end.
//!
//! A [`Continuation`] asks for a branch: along which parameters, at which values, with which monitors. A [`Branch`] is the
//! answer, plain data.

mod kind;
mod monitor;
mod request;
mod stability;

pub use kind::{Label, LabelCounter, SpecialKind};
pub use monitor::Monitor;
pub use request::{Continuation, Problem};
pub(crate) use request::{check_length, invalid, observer, request};
pub use stability::{Criticality, Stability};

use crate::continuation::{BothWays, Explanation, Origin, Reason, Solution, Stop, Wording, events};

/// A change of sign of a test function, or of the number of unstable directions, behind which no special point could be
/// located: look there with shorter steps.
pub type Unlocated = events::Unlocated<SpecialKind>;

/// A point of a branch.
pub trait Labelled {
    /// Its label, if it is special, was asked for or is an end.
    fn label(&self) -> Option<Label>;

    /// Values of the parameters that vary.
    fn values(&self) -> Vec<f64>;

    /// What is special about it; `None` for a step, a point that was asked for or an end.
    fn special_kind(&self) -> Option<SpecialKind> {
        self.label().map(|label| label.kind).filter(|kind| *kind != SpecialKind::Requested)
    }
}

/// A reason to end that tells values of the parameters.
pub trait WithParameters {
    /// The same with the values told in other units, such as a radius for a curvature; `convert` is given the index of the
    /// parameter among those that vary, and a value.
    fn with_parameters(self, convert: impl Fn(usize, f64) -> f64) -> Self;
}

impl WithParameters for std::convert::Infallible {
    fn with_parameters(self, _convert: impl Fn(usize, f64) -> f64) -> Self {
        self
    }
}

impl<R: WithParameters> WithParameters for Stop<R> {
    fn with_parameters(self, convert: impl Fn(usize, f64) -> f64) -> Self {
        match self {
            Self::RangeEnd { bound, value } => Self::RangeEnd { bound, value: convert(bound, value) },
            Self::Problem(end) => Self::Problem(end.with_parameters(convert)),
            other => other,
        }
    }
}

/// A branch: points in the order of the curve, and why it ends on both sides.
#[derive(Clone, Debug)]
pub struct Branch<P, R> {
    /// What the points are, on a curve of special points.
    pub kind: Option<SpecialKind>,
    /// Names of the states.
    pub state_names: Vec<String>,
    /// Names of the parameters.
    pub parameter_names: Vec<String>,
    /// Values of all parameters; those that vary have the values at which the branch was started.
    pub parameters: Vec<f64>,
    /// Indices of the parameters that vary.
    pub active: Vec<usize>,
    /// The points.
    pub points: Vec<P>,
    /// Index of the point at which the branch was started.
    pub start: usize,
    /// Why the branch ends at its first and at its last point; `None` where it starts at a point of another branch, such as a
    /// Hopf point.
    pub stops: [Option<Stop<R>>; 2],
    /// What was noticed and could not be located.
    pub unlocated: Vec<Unlocated>,
}

impl<P, R> Branch<P, R> {
    /// Names of the parameters that vary.
    pub fn keys(&self) -> Vec<&str> {
        self.active.iter().filter_map(|&index| self.parameter_names.get(index)).map(String::as_str).collect()
    }

    /// Why the branch ends at its first and at its last point, in words; `None` where it starts at a point of another branch.
    pub fn explain_ends(&self) -> [Option<Explanation>; 2]
    where
        R: Reason,
    {
        let wording = Wording::of_names(&self.keys());
        [0, 1].map(|side| self.stops[side].as_ref().map(|stop| stop.explain(&wording)))
    }
}

impl<P: Labelled, R> Branch<P, R> {
    /// All parameters at a point of the branch.
    pub fn parameters_at(&self, point: &P) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        for (&index, value) in self.active.iter().zip(point.values()) {
            if let Some(entry) = parameters.get_mut(index) {
                *entry = value;
            }
        }
        parameters
    }

    /// The point with a label.
    pub fn labelled(&self, label: Label) -> Option<&P> {
        self.points.iter().find(|point| point.label() == Some(label))
    }

    /// Points with a label of a kind, in the order of the branch.
    pub fn of_kind(&self, kind: SpecialKind) -> impl Iterator<Item = &P> {
        self.points.iter().filter(move |point| point.label().is_some_and(|label| label.kind == kind))
    }

    /// Special points, in the order of the branch.
    pub fn special(&self) -> impl Iterator<Item = (SpecialKind, &P)> {
        self.points.iter().filter_map(|point| Some((point.special_kind()?, point)))
    }
}

/// The kind of the label that a solution gets.
pub(crate) fn label_kind(origin: Origin<SpecialKind>) -> Option<SpecialKind> {
    match origin {
        Origin::Special(kind) => Some(kind),
        Origin::Requested | Origin::Target(_) => Some(SpecialKind::Requested),
        Origin::Step | Origin::End => None,
    }
}

impl<P, R> Branch<P, R> {
    /// The branch of what was followed: numbers the labels and turns every solution into a point.
    pub(crate) fn assemble<Q>(
        field: &crate::erased::ErasedField<'_>,
        (parameters, active): (&[f64], &[usize]),
        followed: BothWays<Q, SpecialKind, R>,
        mut point: impl FnMut(Solution<Q>, Option<Label>) -> P,
    ) -> Self {
        let BothWays { solutions, start, stops, unlocated } = followed;
        let mut labels = LabelCounter::default();
        let points = solutions
            .into_iter()
            .map(|(solution, origin)| {
                let label = label_kind(origin).map(|kind| labels.next(kind));
                point(solution, label)
            })
            .collect();
        Self {
            kind: None,
            state_names: field.state_names(),
            parameter_names: field.parameter_names(),
            parameters: parameters.to_vec(),
            active: active.to_vec(),
            points,
            start,
            stops,
            unlocated,
        }
    }
}
