//! Where a field has three equilibria instead of one: folds of `x' = b1 + b2 x - x^3` in the plane of both parameters, which
//! meet in a cusp.

use arclength::equilibrium::Equilibria;
use arclength::{Error, Scalar, VectorField};

struct Cusp;

impl VectorField for Cusp {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["b1".into(), "b2".into()]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        derivative[0] = parameters[0] + parameters[1] * state[0] - state[0].powi(3);
    }
}

fn main() -> Result<(), Error> {
    // Folds of the branch at b2 = 1, then the curve of folds through one of them.
    let branch =
        Equilibria::of(&Cusp).start(&[-2.0]).parameters(&[-2.0, 1.0]).along("b1", -2.0..=2.0).run()?;
    let Some(fold) = branch.folds().next() else { return Ok(()) };
    let folds = fold.curve(&Cusp).along("b1", -1.0..=1.0).and("b2", -0.5..=1.5).run()?;
    println!("       b1        b2         x");
    for point in &folds.points {
        let label = point.label.map_or(String::new(), |label| label.to_string());
        println!("{:9.5} {:9.5} {:9.5}  {label}", point.values[0], point.values[1], point.state[0]);
    }
    for point in folds.special_points() {
        let [b1, b2] = point.values;
        println!("{} at b1 = {b1:.1e}, b2 = {b2:.1e}: {:?}", point.kind.name(), point.coefficients);
    }
    Ok(())
}
