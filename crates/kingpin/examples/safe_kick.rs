//! The smallest sideways blow on the wheel from which it does not return, along the speed.

use arclength::control::Control;
use kingpin::basin::{ClassificationSettings, ContactModel, Disturbance, SafeKick};
use kingpin::{Key, Wheel};

/// Largest blow that is tried, in N s.
const LARGEST: f64 = 1.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{:>8} {:>14} {:>14}  ends in", "v (m/s)", "returns (N s)", "fails (N s)");
    for speed in [2.0, 4.0, 6.0, 8.0] {
        let wheel = Wheel::default().with(Key::V, speed)?;
        let settings = ClassificationSettings::for_wheel(&wheel)?;
        let control = Control::none();
        let search =
            SafeKick::find(&wheel, ContactModel::Rolling, settings, Disturbance::Impulse, LARGEST, &control);
        match search? {
            Some(kick) => {
                let fate = kick.fate.map_or("nothing known", |fate| fate.name());
                println!("{speed:8} {:14.6} {:14.6}  {fate}", kick.returns, kick.fails);
            }
            None => println!("{speed:8} returns from every blow up to {LARGEST} N s"),
        }
    }
    Ok(())
}
