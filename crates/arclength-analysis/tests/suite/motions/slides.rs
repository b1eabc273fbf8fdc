//! Motions that slide along switches and leave them, against closed forms.

use super::history::{History, close};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A block on a belt of the speed `v` is held until the spring is as strong as the friction. Then it moves on a circle that only
    /// touches the speed of the belt, once in every turn.
    #[test]
    fn a_block_leaves_its_belt(
        friction in 0.1_f64..2.0, speed in 0.05_f64..1.0, part in -0.9_f64..0.9, backwards: bool, duration in 1.0_f64..30.0
    ) {
        let way = if backwards { -1.0 } else { 1.0 };
        let (v, start) = (way * speed, part * friction);
        let text = format!("x'=y\ny'=-x-{friction}*sign(y-({v}))\ninit x={start},y={v}\n");
        let held = (friction - way * start) / speed;
        let right = if duration < held {
            [start + v * duration, v]
        } else {
            let (sine, cosine) = (duration - held).sin_cos();
            [way * friction + v * sine, v * cosine]
        };
        close(&History::of(&text, duration, 2).end()[1..], &right, 1e-8);
    }

    /// A relay holds `x` as long as the force is weaker than it; then `x` goes out and comes back.
    #[test]
    fn a_relay_lets_go(force in 1.05_f64..3.0, frequency in 0.3_f64..3.0, place in -2.0_f64..2.0) {
        let text = format!(
            "x'={force}*u-sign(x-({place}))\nu'={frequency}*w\nw'=-{frequency}*u\ninit x={place},u=0,w=1\n"
        );
        let strong = (1.0 / force).asin() / frequency;
        let until = FRAC_PI_2 / frequency;
        let out = force / frequency * (frequency * strong).cos() - (until - strong);
        close(&History::of(&text, until, 2).end()[1..2], &[place + out], 1e-8);
        close(&History::of(&text, 0.9 * strong, 2).end()[1..2], &[place], 1e-12);
    }

    /// A slide along a circle, which is not left by errors that pile up.
    #[test]
    fn slides_keep_to_a_curved_switch(radius in 0.5_f64..2.0, frequency in 0.5_f64..3.0) {
        let border = format!("sign(x^2+y^2-{})", radius * radius);
        let text = format!("x'=-{frequency}*y-x*{border}\ny'={frequency}*x-y*{border}\ninit x={}\n", 0.5 * radius);
        let end = History::of(&text, 200.0, 2).end();
        close(&[end[1].hypot(end[2])], &[radius], 1e-9);
        let angle = (end[2].atan2(end[1]) - 200.0 * frequency).rem_euclid(2.0 * PI);
        close(&[angle.min(2.0 * PI - angle)], &[0.0], 1e-7);
    }
}

#[test]
fn a_block_slips_back_after_it_was_held() {
    // Held from where it reaches the speed of the belt.
    let text = "par v=0.5\nx'=y\ny'=-x-sign(y-v)\ninit x=0,y=0\n";
    let reached = 1.0 - 0.75_f64.sqrt();
    let left = PI / 6.0 + (1.0 - reached) / 0.5;
    let (sine, cosine) = (10.0 - left).sin_cos();
    close(&History::of(text, 10.0, 11).end(), &[10.0, 1.0 + 0.5 * sine, 0.5 * cosine], 1e-9);
}
