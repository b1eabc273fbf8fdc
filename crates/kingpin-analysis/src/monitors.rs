//! What is monitored along branches of a wheel, or held along a curve: expressions in its states, its parameters and the forces of its
//! motions.
//!
//! A uniform motion has a value of all of them; on a cycle `max(..)`, `min(..)`, `mean(..)` and `at(.., PHASE)` of them have, the
//! parameters and the `period`. Capital letters count: `v` is the towing speed and `V` the speed of the wheel.

use arclength::cycle::Orbit;
use arclength_analysis::{Error, Monitored, Vocabulary};
use kingpin::branches::MotionMonitor;
use kingpin::{Key, RollingModel, Wheel};

/// Quantities of a motion beside its states: the friction force of the ground and the force on the king pin in N, what all dampers take
/// in W.
const FORCES: [&str; 3] = ["friction_force", "king_pin_force", "damper_power"];

/// How the names of an expression about motions of a wheel get their values.
struct Values {
    keys: Vec<Key>,
    /// Whether the expression names forces.
    has_forces: bool,
}

impl Values {
    /// The names that an expression may use, and how those of this one get their values.
    fn of(asked: &Monitored, wheel: &Wheel) -> Result<(Vocabulary<'static>, Self), Error> {
        let keys: Vec<Key> = wheel.parameters().map(|(key, _)| key).collect();
        let names: Vec<&str> = keys.iter().map(|key| key.name()).collect();
        let vocabulary = Vocabulary::named(wheel.states(), &names, &FORCES).map_err(|error| {
            Error::invalid(&["monitor"], asked.expression.clone(), error.to_string(), "other names")
        })?;
        let has_forces = FORCES.iter().any(|force| asked.expression.contains(force));
        Ok((vocabulary, Self { keys, has_forces }))
    }

    fn parameters(&self, wheel: &Wheel) -> Vec<f64> {
        self.keys.iter().map(|key| wheel.get(*key)).collect()
    }

    /// The forces at all states of a motion; not numbers where no expression names them.
    fn forces(&self, wheel: &Wheel, state: &[f64]) -> [f64; FORCES.len()] {
        let load = self.has_forces.then(|| wheel.rolling_loads([(state, 0.0)]).ok()?.pop()).flatten();
        load.map_or([f64::NAN; FORCES.len()], |load| {
            let [forwards, inwards] = load.ground;
            [forwards.hypot(inwards), load.king_pin.force(), load.king_pin.damper_power]
        })
    }
}

/// What is monitored, or held, on uniform motions.
///
/// # Errors
/// An expression that cannot be read.
pub(crate) fn on_motions(asked: &Monitored, wheel: &Wheel) -> Result<MotionMonitor<[f64]>, Error> {
    let (vocabulary, values) = Values::of(asked, wheel)?;
    let quantity = asked.on_equilibria(&vocabulary)?;
    let value = move |wheel: &Wheel, state: &[f64]| {
        Some(quantity.value(state, &values.parameters(wheel), &values.forces(wheel, state)))
    };
    Ok(MotionMonitor::new(&asked.expression, value).at(&asked.at).until(&asked.until))
}

/// What is monitored, or held, on cycles.
///
/// # Errors
/// An expression that cannot be read, or in which a state stands that has no value of its own on a cycle.
pub(crate) fn on_cycles(asked: &Monitored, wheel: &Wheel) -> Result<MotionMonitor<Orbit>, Error> {
    let (vocabulary, values) = Values::of(asked, wheel)?;
    let monitor = asked.on_cycles(&vocabulary)?;
    let value = move |wheel: &Wheel, orbit: &Orbit| {
        let model: RollingModel = wheel.rolling_model(&[]).ok()?;
        let parameters = values.parameters(wheel);
        Some(monitor.value_by(orbit, &parameters, &|quantity, free| {
            let state = model.full_state(free, &[]);
            quantity.value(&state, &parameters, &values.forces(wheel, &state))
        }))
    };
    Ok(MotionMonitor::new(&asked.expression, value).at(&asked.at).until(&asked.until))
}

/// Names of what is monitored.
pub(crate) fn names<M: ?Sized>(monitors: &[MotionMonitor<M>]) -> Vec<String> {
    monitors.iter().map(|monitor| monitor.name().to_owned()).collect()
}
