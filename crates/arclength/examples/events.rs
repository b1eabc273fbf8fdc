//! A ball that bounces on a moving plate: flights end where the ball meets the plate, located to rounding.

use arclength::integration::{Event, IntegrationError, Integrator, from_fn};
use std::f64::consts::TAU;

/// Height and speed of the plate, in m and m/s.
fn plate(time: f64) -> [f64; 2] {
    let (sine, cosine) = (TAU * 5.0 * time).sin_cos();
    [0.03 * sine, 0.03 * TAU * 5.0 * cosine]
}

fn main() -> Result<(), IntegrationError> {
    let restitution = 0.8;
    let (mut time, mut state) = (0.0, vec![0.1, 0.0]);
    println!(" time (s)  height (m)  speed after the impact (m/s)");
    for _ in 0..12 {
        let flight = from_fn(2, |_time, state: &[f64], slope: &mut [f64]| {
            slope[0] = state[1];
            slope[1] = -9.81;
        });
        let mut meets = [Event::new(|time, state: &[f64]| state[0] - plate(time)[0]).falling().terminal()];
        let solution =
            Integrator::default().with_events(flight, time, &state, time + 10.0, &[], &mut meets)?;
        let [height, speed] = plate(solution.time);
        time = solution.time;
        state = vec![height, speed + restitution * (speed - solution.state[1])];
        println!("{time:9.5} {height:11.6} {:10.5}", state[1]);
    }
    Ok(())
}
