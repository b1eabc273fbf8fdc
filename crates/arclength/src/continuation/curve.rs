//! The contract between a problem and the continuation that follows its solutions.

use super::events::{Event, Location, Reading, Spectrum, TestFunction};
use super::solution::Solution;
use super::stop::{Reason, Stop};
use crate::error::{CorrectionFailure, Error};
use num_complex::Complex64;
use std::borrow::Cow;

/// The equations of a curve, `F(z) = 0`, `F: R^N -> R^(N-1)`, with their linear algebra.
pub trait Equations {
    /// Number of unknowns `N`, one more than the equations. It may change in [`Curve::adapt`].
    fn unknowns(&self) -> usize;

    /// Writes `F(unknown)` into the first `N - 1` entries of `residual` (length `N`).
    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]);

    /// Factorises the Jacobian of `F` at `unknown` bordered below by the row `border`, and writes
    /// `F(unknown)` into the first `N - 1` entries of `residual`.
    ///
    /// Returns the sign of the determinant of the bordered matrix, zero if it is singular.
    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64;

    /// Solves with the matrix of the last [`factorize`](Self::factorize), in place; the last entry
    /// belongs to the border.
    fn solve(&mut self, right_hand_side: &mut [f64]);
}

/// A curve whose equations are those of a system that it owns.
pub trait Discretised {
    /// The system.
    type System: Equations;

    /// The system.
    fn system(&self) -> &Self::System;

    /// The system, to be evaluated and factorised.
    fn system_mut(&mut self) -> &mut Self::System;
}

impl<C: Discretised> Equations for C {
    fn unknowns(&self) -> usize {
        self.system().unknowns()
    }

    fn residual(&mut self, unknown: &[f64], residual: &mut [f64]) {
        self.system_mut().residual(unknown, residual);
    }

    fn factorize(&mut self, unknown: &[f64], border: &[f64], residual: &mut [f64]) -> f64 {
        self.system_mut().factorize(unknown, border, residual)
    }

    fn solve(&mut self, right_hand_side: &mut [f64]) {
        self.system_mut().solve(right_hand_side);
    }
}

/// A curve of solutions of [`Equations`] that [`follow`](super::follow) can trace.
pub trait Curve: Equations {
    /// What is known about a solution beyond its unknowns: test functions, stability.
    type Point: Clone;

    /// Kinds of special points.
    type Kind: Copy + PartialEq + std::fmt::Debug + 'static;

    /// Reasons of the problem's own for which a curve ends.
    type Reason: Reason;

    /// Writes `W vector` into `image`, where `W` is the positive definite matrix of the metric.
    fn apply_metric(&self, vector: &[f64], image: &mut [f64]);

    /// Adapts discretisation and metric to the solution `unknown`.
    ///
    /// `vectors` are unknowns and tangents in the old discretisation to be carried over to the new
    /// one, `unknown` itself excluded.
    ///
    /// # Errors
    /// When the solution cannot be resolved within the limits of the discretisation.
    fn adapt(&mut self, unknown: &mut Vec<f64>, vectors: &mut [&mut Vec<f64>]) -> Result<Adaptation, Error>;

    /// Takes over what belongs to the discretisation into what is known about a solution whose unknowns were carried over to it.
    fn carry_over(&self, _point: &mut Self::Point) {}

    /// Whether a solution loses what it is when it is carried over to the discretisation of the next: then it is kept, and
    /// [taken back](Self::take_back) where the step from it does not hold.
    fn keeps_solutions(&self) -> bool {
        false
    }

    /// Takes back the discretisation of a solution that was kept.
    fn take_back(&mut self, _solution: &Solution<Self::Point>) {}

    /// Everything that is to be known about a converged solution, called right after its Jacobian,
    /// bordered by the tangent, was factorised with determinant sign `orientation`.
    ///
    /// # Errors
    /// When a quantity cannot be computed; the run ends there and says why.
    fn inspect(&mut self, unknown: &[f64], tangent: &[f64], orientation: f64) -> Result<Self::Point, Error>;

    /// Whether updates of Newton's method that are measured to be rounding end a correction where they do not become smaller, as
    /// where the parameter hardly matters. A special point is not found that way.
    fn may_stagnate(&self) -> bool {
        true
    }

    /// Why the equations are not finite.
    fn why_not_finite(&self, _unknown: &[f64]) -> CorrectionFailure {
        CorrectionFailure::NotFinite
    }

    /// Measures the errors of a solution that becomes part of a run, called right after its Jacobian, bordered by the tangent
    /// or by a parameter, was factorised.
    fn measure(&mut self, _solution: &mut Solution<Self::Point>) {}

    /// Whether the discretisation resolves what was found out about a solution. If not, [`adapt`](Self::adapt) makes it finer
    /// and the solution is found once more.
    fn resolves(&mut self, _point: &Self::Point) -> bool {
        true
    }

    /// The test functions. Where several change their signs at one place their points are located in this order.
    fn test_functions(&self) -> Cow<'static, [TestFunction<Self::Kind>]> {
        Cow::Borrowed(&[])
    }

    /// The value of the test function for a kind at a solution; `None` where it is not defined.
    fn test(&self, _kind: Self::Kind, _solution: &Solution<Self::Point>) -> Option<Reading> {
        None
    }

    /// Growth exponents of a solution.
    fn spectrum(&self, _solution: &Solution<Self::Point>) -> Spectrum {
        Spectrum::default()
    }

    /// Rates of change of the growth exponents per length of the curve, in their order, where they are known without further
    /// solutions; otherwise they are computed by differences where they matter.
    fn exponent_rates(&self, _solution: &Solution<Self::Point>) -> Option<Vec<Complex64>> {
        None
    }

    /// Rate of change of a test function per length of the curve, where it is known without further solutions, in the metric in which
    /// the tangent has the length one.
    fn test_rate(&self, _kind: Self::Kind, _solution: &Solution<Self::Point>) -> Option<f64> {
        None
    }

    /// How many of the signs at a solution may be rounding error, as they are if it is a special point itself.
    fn undecided(&self, _solution: &Solution<Self::Point>) -> usize {
        0
    }

    /// Locates the point of a kind between two solutions at which its test function has different signs.
    ///
    /// # Errors
    /// As [`inspect`](Self::inspect); [`Error::OtherBranch`] has the step made anew and shorter.
    fn locate(
        &mut self,
        _kind: Self::Kind,
        _between: [&Solution<Self::Point>; 2],
    ) -> Result<Location<Self::Point>, Error> {
        Ok(Location::Missed)
    }

    /// Locates what crosses between two solutions that enclose one place, `near`, where the number of unstable directions
    /// changes by `change`; `half` is half of the length of the bracket.
    ///
    /// # Errors
    /// As [`locate`](Self::locate).
    fn locate_crossing(
        &mut self,
        _between: [&Solution<Self::Point>; 2],
        _near: Solution<Self::Point>,
        _change: usize,
        _half: f64,
    ) -> Result<Vec<EventOf<Self>>, Error> {
        Ok(Vec::new())
    }

    /// Whether two special points of one kind are one, though the solutions that they were located at are apart.
    fn are_same(&self, _one: &Self::Point, _other: &Self::Point) -> bool {
        false
    }

    /// Whether two special points of one kind at one place are two, such as Hopf points of different frequencies.
    fn are_distinct(&self, _one: &Self::Point, _other: &Self::Point) -> bool {
        false
    }

    /// Takes note that a point which was only bracketed may lie this far away, in the metric.
    fn widen(&self, _point: &mut Self::Point, _reach: f64) {}

    /// The kind of a located point, where it is not that of the test function that led to it.
    fn kind_at(&self, _point: &Self::Point) -> Option<Self::Kind> {
        None
    }

    /// By how much the number of unstable directions may change at a located point, where more is known than its kind.
    fn changes_at(&self, _point: &Self::Point) -> Option<&'static [usize]> {
        None
    }

    /// Whether the parameter turns at a located point that is no fold, as it does on the branch that leaves a pitchfork to one
    /// side; `None` where that is not known.
    fn turns_at(&self, _point: &Self::Point) -> Option<bool> {
        None
    }

    /// Quantities, each with its size on the curve so far, that tell whether two solutions with the same first bounded parameter
    /// are the same; independent of discretisation and phase.
    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)>;

    /// The border at which a curve that is smooth piece by piece leaves the piece of the first solution before it reaches the second.
    ///
    /// Within a piece the equations are those of the piece, beyond its borders too; [`enter`](Self::enter) has the curve go on in
    /// that of a solution.
    ///
    /// # Errors
    /// As [`inspect`](Self::inspect); [`Error::OtherBranch`] has the step made anew and shorter.
    fn passage(
        &mut self,
        _before: &Solution<Self::Point>,
        _after: &Solution<Self::Point>,
    ) -> Result<Option<PassageOf<Self>>, Error> {
        Ok(None)
    }

    /// Goes on in the piece of a solution that has become part of the curve.
    fn enter(&mut self, _solution: &Solution<Self::Point>) {}

    /// Gives up a piece whose equations make no sense beyond its border; whether there was one. The curve goes on with the equations
    /// as they are.
    fn give_up_piece(&mut self) -> bool {
        false
    }

    /// Whether unknowns that solve the equations without having been [adapted](Self::adapt) are a solution, where the equations may
    /// have others that mean nothing.
    fn holds(&self, _unknown: &[f64]) -> bool {
        true
    }

    /// What hinders a curve from getting on at a solution, where the problem knows.
    fn hindrance(&mut self, _solution: &Solution<Self::Point>) -> Option<Self::Reason> {
        None
    }

    /// A reason, special to the problem, to end the curve between two consecutive solutions or at the second.
    fn ending(
        &mut self,
        _before: &Solution<Self::Point>,
        _after: &Solution<Self::Point>,
    ) -> Option<Ending<Self::Reason>> {
        None
    }
}

/// A special point of a curve.
pub type EventOf<C> = Event<<C as Curve>::Kind, <C as Curve>::Point>;

/// How a curve comes to a border between two pieces and leaves it.
#[derive(Debug)]
pub struct Passage<P, K, R> {
    /// The solution on the border, as one of the piece before it.
    pub arrival: Solution<P>,
    /// What is special there.
    pub special: Vec<(K, Solution<P>)>,
    /// The same solution as one of the next piece, with the tangent that leads into that, or why the curve ends.
    pub onward: Result<Solution<P>, Stop<R>>,
}

/// A passage of a curve.
pub type PassageOf<C> = Passage<<C as Curve>::Point, <C as Curve>::Kind, <C as Curve>::Reason>;

/// The end of a curve for a reason special to the problem.
#[derive(Debug)]
#[non_exhaustive]
pub enum Ending<R> {
    /// The curve ends between the two solutions; the second is not part of it.
    Between(Stop<R>),
    /// The same; the solution closest before the end becomes part of the curve.
    Approached(Stop<R>),
    /// The second solution is the last.
    After(Stop<R>),
}

/// Whether [`Curve::adapt`] changed the discretisation, so that the solution has to be corrected again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Adaptation {
    /// The discretisation stays.
    Unchanged,
    /// The discretisation is new and all vectors were carried over.
    Changed,
    /// So is the normalisation of the unknowns, perhaps: solutions of before solve the equations only once they are corrected.
    Renormalised,
}
