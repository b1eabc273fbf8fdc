//! A nerve cell that fires: the equilibrium of the FitzHugh-Nagumo equations along the current, its Hopf points, and the cycles
//! that are born at the first of them.

use arclength::equilibrium::Equilibria;
use arclength::{Error, Scalar, VectorField};

struct FitzHughNagumo;

impl VectorField for FitzHughNagumo {
    fn state_names(&self) -> Vec<String> {
        vec!["voltage".into(), "recovery".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["current".into()]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let (voltage, recovery) = (state[0], state[1]);
        derivative[0] = voltage - voltage.powi(3) / 3.0 - recovery + parameters[0];
        derivative[1] = (voltage + 0.7 - recovery * 0.8) * 0.08;
    }
}

fn main() -> Result<(), Error> {
    let equilibria = Equilibria::of(&FitzHughNagumo).parameters(&[0.0]).along("current", 0.0..=2.0).run()?;
    for hopf in equilibria.hopf_points() {
        println!(
            "Hopf point at current {:.6}: angular frequency {:.6}, first Lyapunov coefficient {:.4}",
            hopf.value,
            hopf.frequency,
            hopf.first_lyapunov.unwrap_or(f64::NAN)
        );
    }
    let Some(hopf) = equilibria.hopf_points().next() else { return Ok(()) };
    let branch = hopf.cycles(&FitzHughNagumo).along("current", 0.0..=2.0).at(&[0.5, 1.0]).run()?;
    println!("\n current    period  voltage from to    stable");
    for cycle in &branch.points {
        let stable = cycle.stable.map_or("undecided", |stable| if stable { "yes" } else { "no" });
        println!(
            "{:8.5} {:9.5} {:8.4} {:8.4}  {stable}",
            cycle.value, cycle.period, cycle.min[0], cycle.max[0]
        );
    }
    for end in branch.explain_ends().into_iter().flatten() {
        println!("{}", end.cause);
    }
    Ok(())
}
