//! Where shimmy is born: the Hopf points along the speed, and the limit cycles that branch off there.

use arclength::control::Control;
use kingpin::branches::{Along, CycleOptions};
use kingpin::{Key, Wheel};
use std::ops::ControlFlow;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let along = Along::new(Key::V, 1.0, 12.0)?;
    let speeds = vec![2.0, 4.0, 6.0, 8.0];
    for hopf in Wheel::default().hopf_points(along, &Control::none())?.points {
        println!(
            "shimmy of {:.3} Hz is born at v = {:.6} m/s: {:?}",
            hopf.frequency / std::f64::consts::TAU,
            hopf.value,
            hopf.criticality
        );
        let options = CycleOptions::default().at(&speeds);
        let branch = hopf.cycles(along, &options, |_| ControlFlow::Continue(()))?;
        for cycle in branch.points.iter().filter(|cycle| speeds.contains(&cycle.value)) {
            println!(
                "v = {} m/s: caster angle {:+.4} to {:+.4} rad, period {:.6} s, {}",
                cycle.value,
                cycle.min[2],
                cycle.max[2],
                cycle.period,
                match cycle.stable {
                    Some(true) => "stable",
                    Some(false) => "unstable",
                    None => "stable or unstable, within the error",
                }
            );
        }
    }
    Ok(())
}
