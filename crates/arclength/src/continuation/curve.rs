//! The contract between a problem and the continuation that follows its solutions.

use crate::error::Error;

/// A curve of solutions `F(z) = 0`, `F: R^N -> R^(N-1)`, that [`follow`](super::follow) can trace.
pub trait Curve {
    /// What is known about a solution beyond its unknowns: test functions, stability.
    type Point: Clone;

    /// Number of unknowns `N`, one more than the equations. It may change in [`adapt`](Self::adapt).
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

    /// Everything that is to be known about a converged solution, called right after its Jacobian,
    /// bordered by the tangent, was factorised with determinant sign `orientation`.
    ///
    /// # Errors
    /// When a quantity cannot be computed; the run ends there and says why.
    fn inspect(&mut self, unknown: &[f64], tangent: &[f64], orientation: f64) -> Result<Self::Point, Error>;

    /// Whether the discretisation resolves what was found out about a solution. If not, [`adapt`](Self::adapt) makes it finer
    /// and the solution is found once more.
    fn resolves(&mut self, _point: &Self::Point) -> bool {
        true
    }

    /// Special points between two consecutive solutions, in any order.
    ///
    /// # Errors
    /// As [`inspect`](Self::inspect); [`Error::OtherBranch`] has the step made anew and shorter.
    fn special_points(
        &mut self,
        before: &Solution<Self::Point>,
        after: &Solution<Self::Point>,
    ) -> Result<Vec<Solution<Self::Point>>, Error>;

    /// Quantities, each with its size on the curve so far, that tell whether two solutions with the same first bounded parameter
    /// are the same; independent of discretisation and phase.
    fn signature(&self, unknown: &[f64]) -> Vec<(f64, f64)>;

    /// A reason, special to the problem, to end the curve between two consecutive solutions or at the second.
    fn ending(&mut self, _before: &Solution<Self::Point>, _after: &Solution<Self::Point>) -> Option<Ending> {
        None
    }
}

/// The end of a curve for a reason special to the problem.
#[derive(Debug)]
pub enum Ending {
    /// The curve ends between the two solutions; the second is not part of it.
    Between(super::Stop),
    /// The second solution is the last.
    After(super::Stop),
}

/// Whether [`Curve::adapt`] changed the discretisation, so that the solution has to be corrected again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptation {
    /// The discretisation stays.
    Unchanged,
    /// The discretisation is new and all vectors were carried over.
    Changed,
}

/// A converged solution on a curve.
#[derive(Clone, Debug)]
pub struct Solution<P> {
    /// The unknowns.
    pub unknown: Vec<f64>,
    /// The unit tangent in the curve's metric, pointing in the direction of travel.
    pub tangent: Vec<f64>,
    /// Sign of the determinant of the Jacobian bordered by the tangent.
    pub orientation: f64,
    /// What is known about it.
    pub point: P,
}
