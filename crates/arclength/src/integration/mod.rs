//! Numerical integration of initial value problems `x' = f(t, x)`.
//!
//! An [`Integrator`] holds tolerances and limits and runs the explicit Runge-Kutta method of
//! Dormand and Prince of order 8(5,3) with dense output of order 7 and PI step control (Hairer,
//! Norsett and Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, 1993, sections
//! II.4 to II.6), or the implicit one Radau IIA of order 5 for stiff problems, or one or the other as the problem asks for
//! ([`Method`]). It integrates any [`System`]: a [`VectorField`](crate::VectorField) with its parameters
//! ([`autonomous`]), a closure ([`from_fn`], without the time [`from_rates`]), or the variational equations of a vector field
//! ([`VariationalEquations`], [`state_transition_matrix`]). Solutions can be sampled at given
//! times, and zeros of event functions ([`Event`]) are located to rounding.
//!
//! ```
//! use arclength::integration::{Event, Integrator, from_fn};
//!
//! let mut pendulum = from_fn(2, |_time, x, derivative| {
//!     derivative[0] = x[1];
//!     derivative[1] = -x[0].sin();
//! });
//! let mut lowest_point = [Event::new(|_time, x| x[0]).rising().terminal()];
//! let solution = Integrator::default().with_events(&mut pendulum, 0.0, &[1.0, 0.0], 100.0, &[], &mut lowest_point)?;
//! assert!((solution.time - 0.75 * 6.699_975_664_370).abs() < 1e-8);
//! # Ok::<(), arclength::integration::IntegrationError>(())
//! ```

mod chebyshev;
mod clock;
mod equal_steps;
mod error;
mod event;
mod integrator;
mod radau;
mod solution;
mod stepper;
mod stiffness;
mod system;
mod tableau;
mod variational;

#[cfg(test)]
mod tests;

pub use crate::direction::Direction;
pub(crate) use equal_steps::equal_steps;
pub use error::IntegrationError;
pub use event::{Crossing, Event, EventLocator};
pub use integrator::{Integrator, Method};
pub use solution::{ControlledIntegrator, Solution};
pub use stepper::{Statistics, Stepper};
pub use system::{
    Autonomous, AutonomousClosure, ClosureSystem, JacobianColumns, System, autonomous, exact_jacobian,
    from_fn, from_rates,
};
pub use variational::{StateTransition, VariationalEquations, state_transition_matrix};
