//! A stability chart in the terminal: which caster lengths are stable at which speed, and where the wheel rolls.

use arclength::control::Control;
use kingpin::{Axis, Key, Plane, Wheel};

const POINTS: [usize; 2] = [64, 20];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plane = Plane::new(Axis::new(Key::V, 0.1..=25.0)?, Axis::new(Key::L, 0.02..=0.2)?)?;
    let wheel = Wheel::default().with(Key::TurningRadius, 2.0)?.with(Key::FAz, -20.0)?;
    let chart = wheel.stability_chart(&plane, POINTS, &Control::none())?;
    let rows = chart.stable.chunks(POINTS[0]).zip(chart.rolls.chunks(POINTS[0])).zip(&chart.y);
    for ((stable, rolls), length) in rows.rev() {
        let symbol = |(stable, rolls): (&bool, &bool)| match (stable, rolls) {
            (true, true) => '+',
            (true, false) => 's',
            (false, true) => '-',
            (false, false) => '.',
        };
        let row: String = stable.iter().zip(rolls).map(symbol).collect();
        println!("{length:6.3} m {row}");
    }
    println!("         v = {} to {} m/s at r = 2 m", chart.x[0], chart.x[POINTS[0] - 1]);
    println!("+ stable and rolls, s stable but slides, - unstable but rolls, . neither");
    Ok(())
}
