//! Motions of models with events (`global`), against closed forms and against integrations of SciPy.

use super::history::{History, close, model};
use arclength_analysis::simulate::SimulateRequest;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_leaky_neuron_fires_in_time(current in 1.01_f64..5.0, reset in -2.0_f64..0.9) {
        let text = format!("v'={current}-v\nglobal 1 {{v-1}} {{v={reset}}}\n");
        let first = (current / (current - 1.0)).ln();
        let period = ((current - reset) / (current - 1.0)).ln();
        let history = History::of(&text, 4.5 * period + first, 2);
        let jumps = history.jumps();
        prop_assert_eq!(jumps.len(), 5);
        for (k, [before, behind]) in jumps.iter().enumerate() {
            close(before, &[first + k as f64 * period, 1.0], 1e-8);
            prop_assert_eq!(&behind[1..], [reset]);
        }
        close(&history.end()[1..], &[current + (reset - current) * (-0.5 * period).exp()], 1e-8);
    }

    #[test]
    fn a_ball_bounces_until_it_cannot(height in 0.1_f64..10.0, restitution in 0.1_f64..0.9, floor in -3.0_f64..3.0) {
        let text = format!("x'=v\nv'=-1\ninit x={}\nglobal -1 x-{floor} {{v=-{restitution}*v}}\n", floor + height);
        let fall = (2.0 * height).sqrt();
        let rest = fall * (1.0 + restitution) / (1.0 - restitution);
        let history = History::of(&text, 2.0 * rest, 5);
        for (k, [before, behind]) in history.jumps().iter().take(8).enumerate() {
            let speed = fall * restitution.powi(k as i32);
            let time = rest - 2.0 * restitution * speed / (1.0 - restitution);
            close(before, &[time, floor, -speed], 1e-8);
            close(&behind[1..], &[floor, restitution * speed], 1e-8);
        }
        close(&history.end(), &[rest, floor, 0.0], 3e-6);
        prop_assert!(history.warnings.iter().any(|warning| warning.contains("event of line 4 happens again")));
    }

    /// Between impacts the motion is a cosine of frequency 1; the wall is at rest at `x = 0`.
    #[test]
    fn an_oscillator_hits_its_wall(start in 0.5_f64..3.0, restitution in 0.1_f64..1.0) {
        let text = format!("x'=v\nv'=-x\ninit x=-{start}\nglobal 1 x {{v=-{restitution}*v}}\n");
        let history = History::of(&text, 20.0, 3);
        let half = std::f64::consts::PI;
        for (k, [before, behind]) in history.jumps().iter().enumerate() {
            let speed = start * restitution.powi(k as i32);
            close(before, &[half / 2.0 + k as f64 * half, 0.0, speed], 1e-8);
            close(&behind[1..], &[0.0, -restitution * speed], 1e-8);
        }
        prop_assert_eq!(history.jumps().len(), 6);
        let (sine, cosine) = 20.0_f64.sin_cos();
        let amplitude = start * restitution.powi(6);
        close(&history.end()[1..], &[-amplitude * cosine.abs(), amplitude * sine * cosine.signum()], 1e-8);
    }

    /// Kicks at times, however close, between which the state dies out.
    #[test]
    fn events_at_times_are_not_stepped_over(period in 0.001_f64..0.5, width in 1e-9_f64..1e-3) {
        let text = format!(
            "x'=-x\np'=0\nglobal 1 mod(t,{period})-{period}/2 {{x=x+1}}\nglobal 1 heav(t-.7)*heav(.7+{width}-t)-.5 {{p=p+1}}\n"
        );
        let kicks = (1.0 / period + 0.5).floor();
        let decay = (-period).exp();
        let right = (-(1.0 - (kicks - 0.5) * period)).exp() * (1.0 - decay.powf(kicks)) / (1.0 - decay);
        close(&History::of(&text, 1.0, 2).end(), &[1.0, right, 1.0], 1e-8);
    }
}

#[test]
fn events_that_happen_together_follow_each_other_in_the_order_of_the_file() {
    let clock = "x'=1\ny'=0\nz'=0\n";
    // The second is passed at the same time, the third by what the first does, the fourth never.
    let text = format!(
        "{clock}global 1 x-1 {{x=0;y=y+1}}\nglobal -1 2-2*x {{z=z+10*y}}\nglobal 1 y-1.5 {{z=z+1}}\nglobal -1 x-3 {{z=100}}\n"
    );
    let history = History::of(&text, 2.5, 2);
    let jumps: Vec<Vec<f64>> = history.jumps().into_iter().map(|[_, behind]| behind).collect();
    close(&jumps.concat(), &[1.0, 0.0, 1.0, 10.0, 2.0, 0.0, 2.0, 31.0], 1e-12);
    let turned = format!("{clock}global -1 2-2*x {{z=z+10*y}}\nglobal 1 x-1 {{x=0;y=y+1}}\n");
    close(&History::of(&turned, 2.5, 2).end(), &[2.5, 0.5, 2.0, 10.0], 1e-12);
}

#[test]
fn an_event_waits_until_its_condition_has_come_back() {
    // The ball goes on through the floor with half its speed: it has passed once.
    let history = History::of("x'=v\nv'=-1\ninit x=.5\nglobal -1 x {v=.5*v}\n", 2.0, 2);
    assert_eq!(history.jumps().len(), 1);
    close(&history.end(), &[2.0, -1.0, -1.5], 1e-9);
    // Both directions; the reset leaves the condition where it is.
    let both = History::of("x'=y\ny'=-x\nz'=0\ninit y=1\nglobal 0 x {z=z+1}\n", 10.0, 2);
    close(&both.end()[3..], &[3.0], 0.0);
    // Without bounce the floor is met again at once.
    let plain = History::of("x'=v\nv'=-1\ninit x=.5\nglobal -1 x {v=0}\n", 2.0, 2);
    assert!(plain.warnings[0].contains("while no time passes"), "{:?}", plain.warnings);
    close(&plain.end()[1..], &[0.0, 0.0], 1e-7);
}

#[test]
fn motions_stop_and_are_put_out_where_the_model_says() {
    let history = History::of(
        "x'=1\nglobal 1 x-.5 {out_put=1}\nglobal 1 x-.7 {out_put=-1}\nglobal 1 x-2 {arret=1}\n",
        5.0,
        2,
    );
    close(&history.columns[0], &[0.0, 0.5, 2.0], 1e-12);
    close(&history.columns[1], &[0.0, 0.5, 2.0], 1e-12);
    assert!(history.warnings[0].contains("by the event of line 4"), "{:?}", history.warnings);
    let mut late = SimulateRequest::new(model("x'=1\nglobal 1 x-2 {arret=1}\n"), 5.0);
    late.transient = Some(3.0);
    let error = late.validate().unwrap().run().unwrap_err().to_string();
    assert!(error.contains("t = 2") && error.contains("before the first sample"), "{error}");
}

#[test]
fn events_meet_switches_and_slides() {
    // A relay that holds x at 0.5, and a clock that throws it off: x slides again 0.3 later.
    let relay = "x'=-sign(x-.5)\ny'=1\nc'=1\nglobal 1 c-1 {c=0;x=x+.3}\n";
    let history = History::of(relay, 3.2, 2);
    close(&history.end()[1..2], &[0.6], 1e-9);
    // The border of the field and the condition are the same place.
    let wall = "x'=v\nv'=-2-sign(x)\ninit x=1\nglobal -1 x {v=-.5*v}\n";
    let history = History::of(wall, 2.0, 2);
    let (fall, speed) = ((2.0_f64 / 3.0).sqrt(), 6.0_f64.sqrt());
    let times: Vec<f64> = history.jumps().iter().map(|jump| jump[0][0]).collect();
    close(&times[..2], &[fall, fall + speed / 3.0], 1e-8);
}

/// A neuron behind a filter of the rate `rate`, from slow to stiff: `w'=rate*(v-w)`, and both are reset where `w` reaches 1.
#[test]
fn events_are_located_where_the_model_is_stiff() {
    for rate in [3.0, 20.0, 100.0, 300.0, 1e4, 1e6, 1e9, 1e12] {
        let w = |t: f64| 1.5 - (1.5 * rate * (-t).exp() - 1.5 * (-rate * t).exp()) / (rate - 1.0);
        let [mut low, mut high] = [0.5, 5.0];
        while high - low > 1e-15 * high {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if w(middle) < 1.0 { low = middle } else { high = middle }
        }
        let text = format!("v'=1.5-v\nw'={rate}*(v-w)\nglobal 1 w-1 {{v=0;w=0}}\n");
        let history = History::of(&text, 6.5 * high, 2);
        let times: Vec<f64> = history.jumps().iter().map(|jump| jump[0][0]).collect();
        let right: Vec<f64> = (1..=6).map(|k| f64::from(k) * high).collect();
        close(&times, &right, 2e-9);
        close(&history.end()[2..], &[w(0.5 * high)], 2e-9);
    }
}
