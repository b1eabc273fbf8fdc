//! Motions of fields that switch on sums of waves in time, on a state that jumps itself, or where they start, against closed forms and
//! sums over the time.

use super::history::{History, close};
use proptest::prelude::*;

/// The end of `x` under a right-hand side, with a clock `s`.
fn end(right_hand_side: &str, duration: f64) -> f64 {
    let text = format!("x'={right_hand_side}\ns'=1\ninit x=0,s=0\n");
    History::of(&text, duration, 2).end()[1]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Switches on a sum of two waves: every one is met, as it is where the clock is a state.
    #[test]
    fn sums_of_waves(
        frequencies in prop::array::uniform2(0.3_f64..3.0), phase in 0.0_f64..6.0, weight in 0.2_f64..2.0, kind in 0_usize..5
    ) {
        let wave = |clock: &str| {
            let sum = format!("sin({}*{clock})+{weight}*sin({}*{clock}+{phase})", frequencies[0], frequencies[1]);
            let one = format!("sin({}*{clock})", frequencies[0]);
            match kind {
                0 => format!("heav({sum})"),
                1 => format!("abs({sum})"),
                2 => format!("if({sum}>0)then(1)else(-2)"),
                3 => format!("flr(2*({sum}))"),
                _ => format!("min({one},{weight}-cos({}*{clock}))", frequencies[1]),
            }
        };
        let [by_time, by_clock] = ["t", "s"].map(|clock| end(&wave(clock), 20.0));
        prop_assert!((by_time - by_clock).abs() < 1e-8, "{} {by_time} {by_clock}", wave("t"));
    }
}

#[test]
fn sums_of_waves_from_a_common_zero() {
    close(&[end("heav(sin(t)-sin(2*t))", 3.0)], &[3.0 - std::f64::consts::FRAC_PI_3], 1e-10);
    // Zeros at 1 and at 11/3.
    close(&[end("heav(exp(-(t-3)^2)-exp(-(t-5)^2/4))", 20.0)], &[8.0 / 3.0], 1e-9);
}

#[test]
fn a_jump_of_a_state_takes_others_along() {
    for (right_hand_side, duration, right) in [
        ("heav(mod(s,10)-5)", 95.0, 45.0),
        ("heav(mod(s,10)-9.999)", 95.0, 0.009),
        ("if(mod(s,2)<.5)then(1)else(0)", 95.0, 24.0),
        ("abs(mod(s,2)-1)", 95.0, 47.5),
        ("max(mod(s,2)-1,0)", 95.0, 23.5),
        ("sign(mod(s,2)-1)", 95.0, -1.0),
        ("mod(flr(s),2)", 95.0, 47.0),
        ("flr(mod(s,3))", 20.0, 19.0),
        ("heav(s-10*flr(s/10)-9.5)", 95.0, 4.5),
        ("heav(mod(s,5)-2)*heav(4-mod(s,5))", 20.0, 8.0),
        ("heav(abs(mod(s,2)-1)-.3)", 20.0, 14.0),
    ] {
        let found = end(right_hand_side, duration);
        assert!((found - right).abs() < 1e-8, "{right_hand_side}: {found}, not {right}");
    }
}

#[test]
fn events_on_a_jump_happen_once() {
    for (direction, right) in [(-1, 9.0), (0, 18.0), (1, 9.0)] {
        let text = format!("s'=1\nn'=0\ninit s=0,n=0\nglobal {direction} mod(s,10)-5 {{n=n+1}}\n");
        close(&History::of(&text, 94.0, 2).end()[2..], &[right], 1e-12);
    }
}

#[test]
fn switches_that_complement_each_other() {
    let text = "v'=300*heav(t-5)\ng'=-g/(heav(-v)*12+heav(v)*5)\ninit v=-85.2,g=1\n";
    let right = (-5.284_f64 / 12.0 - 9.716 / 5.0).exp();
    close(&History::of(text, 15.0, 2).end()[2..], &[right], 1e-8);
}

#[test]
fn a_start_on_a_switch_has_the_field_that_is_written_there() {
    for (right_hand_side, right) in [
        ("if(x>0)then(1)else(-1)", -4.0),
        ("if(x<=0)then(-1)else(1)", -4.0),
        ("if(x>=0)then(1)else(-1)", 4.0),
        ("2*heav(x)-1", 4.0),
        ("1-2*heav(-x)", -4.0),
    ] {
        let found = end(right_hand_side, 4.0);
        assert!((found - right).abs() < 1e-9, "{right_hand_side}: {found}");
    }
}

#[test]
fn a_stimulus_of_some_samples_is_not_stepped_over() {
    for width in [0.5, 1.0, 4.0] {
        let text = format!("x'=exp(-((t-500)/{width})^2)/{width}/sqrt(pi)\ninit x=0\n");
        close(&History::of(&text, 1000.0, 2001).end()[1..], &[1.0], 1e-8);
    }
}

#[test]
fn stiff_fields_whose_derivatives_overflow() {
    let text = "x'=-1e4*x+y/(1+exp((y-5)/.001))\ny'=1\ninit x=0,y=0\n";
    close(&History::of(text, 8.0, 2).end()[1..2], &[0.0], 1e-8);
    let text = "x'=-1e6*(x-sqrt(y)-sin(t))\ny'=0\ninit x=0,y=0\n";
    close(&History::of(text, 3.0, 2).end()[1..2], &[3.0_f64.sin() - 3.0_f64.cos() * 1e-6], 1e-8);
}

/// A motion that slides along a switch is left where that jumps away, and comes back to it later.
#[test]
fn a_slide_ends_where_its_switch_jumps_away() {
    let at = |text: &str, duration: f64, state: usize| History::of(text, duration, 2).end()[state];
    let step = "x'=1\nz'=if(z>heav(x))then(-1)else(1)\ninit x=-1,z=.3\n";
    close(&[at(step, 1.5, 2), at(step, 3.0, 2)], &[0.5, 1.0], 1e-9);
    // The surface falls from 1 to 0 and rises with the slope 1, the motion falls with the slope 3.
    let saw = "x'=1\nz'=-sign(z-mod(x,1))*3\ninit x=-1.5,z=-.8\n";
    close(&[at(saw, 2.75, 1), at(saw, 2.75, 2), at(saw, 2.6, 2)], &[1.25, 0.25, 0.7], 1e-9);
    let stairs = "x'=1\nz'=heav(flr(x)-z)-heav(z-flr(x))\ninit x=-.5,z=.2\n";
    close(&[at(stairs, 2.0, 2)], &[0.5], 1e-9);
}

/// A ramp against a state, as in a converter with pulse width modulation, with a period that is no binary fraction.
#[test]
fn ramps_of_any_period_against_a_state() {
    for period in [0.4, 0.1, 0.7, 4e-4] {
        let text = |ramp: &str| format!("x'=-x+heav({ramp}-x)\ninit x=.5\n");
        let [by_remainder, by_quotient] = [format!("mod(t,{period})/{period}"), format!("mod(t/{period},1)")]
            .map(|ramp| History::of(&text(&ramp), 100.0 * period, 2).end()[1]);
        assert!((by_remainder - by_quotient).abs() < 1e-9, "{period}: {by_remainder} {by_quotient}");
    }
}
