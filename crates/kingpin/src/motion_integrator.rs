//! How motions of the wheel are integrated: explicitly, and implicitly where a strong damper or a stiff tyre makes them stiff.

use arclength::integration::{Integrator, Method};

/// With a relative tolerance, and a hundredth of it absolute.
pub(crate) fn motion_integrator(tolerance: f64) -> Integrator {
    Integrator::with_tolerance(tolerance).method(Method::Automatic)
}
