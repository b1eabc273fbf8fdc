//! Period doublings of the logistic map `x -> a x (1 - x)`: of its fixed point at `a = 3`, of its points of period two at
//! `1 + sqrt(6)`.

use arclength::algebraic::{AlgebraicCurve, AlgebraicProblem, solve_square};
use arclength::branch::SpecialKind;
use arclength::continuation::events::TestFunction;
use arclength::continuation::{Bound, Origin, Request, Settings, follow};
use arclength::{Dual, Error, Scalar};
use std::ops::ControlFlow;

fn iterate<T: Scalar>(period: usize, x: T, a: T) -> T {
    (0..period).fold(x, |x, _| a * x * (-x + 1.0))
}

/// Points of a period: `f(x, a) - x = 0`, `f` being the map that many times.
struct PeriodicPoints(usize);

impl AlgebraicProblem for PeriodicPoints {
    fn unknowns(&self) -> usize {
        2
    }
    fn equations(&self) -> usize {
        1
    }
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        residual[0] = iterate(self.0, unknown[0], unknown[1]) - unknown[0];
    }
}

/// Their period doublings: `f(x, a) - x = 0`, `f_x(x, a) + 1 = 0`.
struct PeriodDoubling(usize);

impl AlgebraicProblem for PeriodDoubling {
    fn unknowns(&self) -> usize {
        2
    }
    fn equations(&self) -> usize {
        2
    }
    fn evaluate<T: Scalar>(&self, unknown: &[T], residual: &mut [T]) {
        let image = iterate(self.0, Dual::<T, 1>::variable(unknown[0], 0), Dual::constant(unknown[1]));
        residual[0] = image.value - unknown[0];
        residual[1] = image.derivatives[0] + 1.0;
    }
}

/// The points `[x, a]` at which the period doubles, on the branch of points of a period through `start`, up to `a = 3.6`.
pub(crate) fn period_doublings(period: usize, start: [f64; 2]) -> Result<Vec<[f64; 2]>, Error> {
    let scales = [1.0, 1.0];
    let mut curve = AlgebraicCurve::new(PeriodicPoints(period), &scales)?.test_function(
        TestFunction::new(SpecialKind::PeriodDoubling),
        // The Jacobian is that of f(x) - x.
        |solution| solution.point.jacobian[0] + 2.0,
        |near| Ok(solve_square(&PeriodDoubling(period), &near.unknown, &scales)?.unknown),
    );
    let request = Request::within(&[Bound { from_end: 1, lower: 2.0, upper: 3.6 }], Settings::default());
    let goes_on = &mut |_: &_, _| ControlFlow::Continue(());
    let branch = follow(&mut curve, start.to_vec(), vec![0.0, 1.0], &request, goes_on)?;
    let doublings =
        branch.solutions.iter().filter(|(_, origin)| *origin == Origin::Special(SpecialKind::PeriodDoubling));
    Ok(doublings.map(|(solution, _)| [solution.unknown[0], solution.unknown[1]]).collect())
}

#[allow(dead_code)] // A test uses the function above.
fn main() -> Result<(), Error> {
    // A stable point of each period, from iterating the map.
    for (period, a) in [(1, 2.5), (2, 3.2), (4, 3.5)] {
        let start = iterate(1000 * period, 0.4, a);
        for [x, a] in period_doublings(period, [start, a])? {
            println!("period {period} doubles at a = {a:.15}, x = {x:.15}");
        }
    }
    Ok(())
}
