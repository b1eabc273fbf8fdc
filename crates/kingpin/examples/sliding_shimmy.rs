//! Large shimmy of a wheel that rolls and slides in turn: found by letting it settle, refined by Newton's method on its
//! return map, with the Floquet multipliers of the motion with its phases.

use arclength::control::Control;
use kingpin::shimmy::SlidingMotionSearch;
use kingpin::{Key, Wheel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A short caster, towed straight on.
    let wheel = Wheel::default()
        .with(Key::L, 0.03)?
        .with(Key::V, 0.5)?
        .with(Key::Curvature, 0.0)?
        .with(Key::CU, 0.1)?
        .with(Key::CQ, 0.1)?;
    let start = wheel.perturbed_uniform_motion(&[("psi", 0.2)])?;
    let search = SlidingMotionSearch { settling_time: 10.0, ..SlidingMotionSearch::default() };
    let motion = wheel.sliding_motion(&start, &search, &Control::none())?;
    println!("period {:.8} s, error estimate {:.0e}", motion.period, motion.error_estimate);
    println!("caster angle {:+.6} to {:+.6} rad", motion.psi_min, motion.psi_max);
    for phase in &motion.phases {
        println!("{:.5} to {:.5} s: {:?}", phase.start, phase.end, phase.contact);
    }
    for multiplier in &motion.multipliers {
        println!("multiplier {:+.3e} {:+.3e} i", multiplier.re, multiplier.im);
    }
    println!("stable: {:?}", motion.stable);
    Ok(())
}
