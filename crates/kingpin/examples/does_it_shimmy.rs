//! Whether a wheel shimmies: `cargo run -p kingpin --example does_it_shimmy [FILE.toml]` (the paper's wheel without a file).

use kingpin::Wheel;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wheel = match std::env::args().nth(1) {
        Some(path) => Wheel::read(path)?,
        None => Wheel::default(),
    };
    let motion = wheel.uniform_motion()?;
    println!("caster angle {:.4} rad, yaw rate {:.3} rad/s", motion.psi(), motion.yaw_rate());
    for eigenvalue in motion.eigenvalues().iter().filter(|eigenvalue| eigenvalue.im >= 0.0) {
        let behaviour = if eigenvalue.re < 0.0 { "dies out" } else { "grows" };
        println!(
            "at {:6.2} Hz: {:+9.4} 1/s, {behaviour}",
            eigenvalue.im / std::f64::consts::TAU,
            eigenvalue.re
        );
    }
    let verdict = match motion.is_stable() {
        Some(true) => "a small disturbance dies out",
        Some(false) => "it shimmies by itself",
        None => "rounding could decide it either way",
    };
    println!("{verdict}");
    match wheel.critical_speed() {
        Some(critical) => println!("the limit is at v = {:.4} m/s", critical.speed),
        None => println!("there is no limit speed"),
    }
    let force = motion.contact_force();
    println!(
        "rolling takes {:.2} N of friction, the ground can supply {:.2} N: {}",
        force.friction(),
        force.limit,
        if force.rolls() { "it rolls" } else { "it would slide" }
    );
    Ok(())
}
