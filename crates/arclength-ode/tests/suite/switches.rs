//! The times at which a field switches, against those that can be told by hand.

use arclength_ode::Model;

/// All switches of `x' = right_hand_side` up to a time, each halfway between its sides.
#[track_caller]
fn switches(right_hand_side: &str, until: f64) -> Vec<f64> {
    let model = Model::parse(&format!("par a=200,w=2\nx'={right_hand_side}\n")).expect("a model");
    let parameters = model.default_parameters();
    let mut found = Vec::new();
    let mut from = 0.0;
    while let Some(switch) = model.next_switch(from, until, parameters).expect("an end of the search") {
        assert!(switch.after - switch.before < 1e-13 * until.max(1.0), "{right_hand_side}: {switch:?}");
        if switch.before > 0.0 {
            found.push(0.5 * (switch.before + switch.after));
        }
        from = switch.after;
    }
    // Rounding may make several of one.
    found.dedup_by(|later, earlier| *later - *earlier < 1e-13 * until);
    found
}

#[track_caller]
fn switches_at(right_hand_side: &str, until: f64, expected: &[f64]) {
    let found = switches(right_hand_side, until);
    let close =
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-13 * until.max(1.0));
    assert!(found.len() == expected.len() && close, "{right_hand_side}: {found:?}");
}

#[test]
fn pulses_of_any_width() {
    switches_at("heav(t-a)*heav(a+w-t)", 600.0, &[200.0, 202.0]);
    switches_at("heav(t-a)*heav(a+1e-9-t)-x", 1e3, &[200.0, 200.000000001]);
    switches_at("if(t>10&t<10.5)then(x)else(0)", 20.0, &[10.0, 10.5]);
    switches_at("if(t>=1)then(if(t<3)then(1)else(2))else(0)", 20.0, &[1.0, 3.0]);
    switches_at("sign(t-3)+abs(2*t-8)+max(t,5)+min(6,t/1)", 20.0, &[3.0, 4.0, 5.0, 6.0]);
    switches_at("3*(t>7)", 20.0, &[7.0]);
    switches_at("if(t<1e-3)then(5)else(0)", 1e9, &[1e-3]);
}

#[test]
fn trains_of_pulses() {
    switches_at(
        "heav(mod(t,20)-5)*heav(5.25-mod(t,20))",
        59.0,
        &[5.0, 5.25, 20.0, 25.0, 25.25, 40.0, 45.0, 45.25],
    );
    switches_at("flr(t/3)+ceil(t-0.5)", 3.2, &[0.5, 1.5, 2.5, 3.0]);
    let tenth: f64 = 0.1;
    let first = tenth.asin();
    let pi = std::f64::consts::PI;
    switches_at("heav(sin(t)-.1)", 8.0, &[first, pi - first, 2.0 * pi + first]);
    // A pulse near the top of a wave, 0.0028 wide in a period of 6.
    let narrow = (1.0 - 1e-6_f64).asin();
    switches_at("heav(sin(t)-.999999)", 6.0, &[narrow, pi - narrow]);
    assert_eq!(switches("heav(sin(w*pi*t)-.5)", 1000.0).len(), 2000);
    switches_at("heav(exp(-t)-.5)+heav(sqrt(t)-2)+heav(ln(t+1)-1)", 9.0, &[2f64.ln(), 1f64.exp() - 1.0, 4.0]);
}

#[test]
fn what_does_not_switch_in_time() {
    for right_hand_side in [
        "-x",
        "heav(x-1)",
        "heav(x-t)",
        "sin(t)*abs(x)",
        "abs(a)*t",
        "if(a>3)then(t)else(x)",
        "max(x,t)",
        "heav(t+1)",
        "t^3",
    ] {
        switches_at(right_hand_side, 100.0, &[]);
    }
    // A quantity that no equation uses.
    let model = Model::parse("k=heav(t-1)\nx'=-x\naux q=k\n").expect("a model");
    assert_eq!(model.next_switch(0.0, 10.0, &[]), Ok(None));
}
