//! The Bratu problem `u'' + lambda exp(u) = 0`, `u(0) = u(1) = 0`: from small solutions over the fold at
//! `lambda = 3.5138307191` to large ones.

use arclength::collocation::{BoundaryValueCurve, BoundaryValueProblem, Resolution};
use arclength::continuation::{Bound, FollowedCurve, Origin, Request, Settings, follow};
use arclength::{Error, Scalar};
use std::ops::ControlFlow;

/// The problem.
pub(crate) struct Bratu;

impl BoundaryValueProblem for Bratu {
    fn dimension(&self) -> usize {
        2
    }
    fn scalars(&self) -> usize {
        1
    }
    fn field<T: Scalar>(&self, _time: f64, state: &[T], scalars: &[T], derivative: &mut [T]) {
        derivative[0] = state[1];
        derivative[1] = -(scalars[0] * state[0].exp());
    }
    fn boundary_conditions<T: Scalar>(&self, start: &[T], end: &[T], _scalars: &[T], values: &mut [T]) {
        values[0] = start[0];
        values[1] = end[0];
    }
}

/// The branch, with solutions at some values of `lambda`.
pub(crate) fn branch(values: &[f64]) -> Result<FollowedCurve<BoundaryValueCurve<Bratu>>, Error> {
    let sizes = [1.0, 1.0, 4.0];
    let mut curve = BoundaryValueCurve::new(Bratu, &sizes, Resolution::with_tolerance(1e-10))?;
    let start = curve.start(|_| vec![0.0, 0.0], &[0.1]);
    let mut forward = vec![0.0; start.len()];
    forward[start.len() - 1] = 1.0;
    let range = Bound { from_end: 1, lower: 0.1, upper: 4.0 };
    let request = Request { values: values.to_vec(), ..Request::within(&[range], Settings::default()) };
    follow(&mut curve, start, forward, &request, &mut |_, _| ControlFlow::Continue(()))
}

#[allow(dead_code)] // A test uses the function above.
fn main() -> Result<(), Error> {
    let branch = branch(&[1.0, 2.0, 3.0])?;
    println!("    lambda        u(1/2)   error");
    for (solution, origin) in &branch.solutions {
        let point = &solution.point;
        let label = if let Origin::Special(kind) = origin { kind.label() } else { "" };
        let middle = point.components.at(0.5)[0];
        println!("{:12.10}  {middle:12.10}  {:.0e}  {label}", point.scalars[0], point.error_estimate);
    }
    println!("{}", branch.stop);
    Ok(())
}
