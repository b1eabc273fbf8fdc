//! Cycles of models with events and of models that slide, from a time history on: periods, extremes and multipliers by SciPy's DOP853 at
//! 1e-12 with events (and Filippov's field along a switch), multipliers by differences of the return map.

use crate::Folder;
use crate::found_by_users::{folder, number, points};
use serde_json::Value;

fn settled(model: &str, until: f64) -> Folder {
    let folder = folder(model);
    folder
        .succeed(&format!("simulate model.ode --duration {until} --transient {} -o h.json -q", 0.7 * until));
    folder
}

/// That a cycle has a period to nine digits and a multiplier to seven.
#[track_caller]
fn check(cycles: &Value, value: f64, period: f64, multiplier: f64) {
    let point = points(cycles).iter().find(|point| number(&point["value"]) == value).unwrap();
    assert!((number(&point["period"]) / period - 1.0).abs() < 1e-9, "{}", point["period"]);
    let multipliers = point["multipliers"].as_array().unwrap();
    let distance = |other: &Value| (number(&other[0]) - multiplier).hypot(number(&other[1]));
    let nearest = multipliers.iter().map(distance).fold(f64::INFINITY, f64::min);
    // What is taken to nothing is exactly zero.
    let allowed = if multiplier == 0.0 { 0.0 } else { 1e-7 };
    assert!(nearest <= allowed, "{multipliers:?}");
}

#[test]
fn an_adaptive_neuron_fires() {
    let folder = settled(
        "par I=2\nv'=-v+.2*exp((v-1)/.2)-u+I\nu'=(.5*v-u)/5\nglobal 1 v-3 {v=0;u=u+.3}\ndone\n",
        150.0,
    );
    let cycles = folder.json("cycles --from h.json:END --along I=1.5:4 --at 2,3");
    check(&cycles, 2.0, 2.8774725403588266, 0.3086842691450246);
    check(&cycles, 3.0, 1.474509636205281, 0.5603538881832256);
}

/// In the last millionth of its period it rises by a third of the way.
#[test]
fn a_neuron_with_an_exponential_fires() {
    let folder = settled(
        "par I=2\nv'=-v+.1*exp((v-1)/.1)+I-u\nu'=-u\nglobal 1 v-2.5 {v=0;u=u+.3}\ninit v=0,u=0\ndone\n",
        60.0,
    );
    let cycles = folder.json("cycles --from h.json:END --along I=1.98:2.02 --at 2");
    check(&cycles, 2.0, 1.14854111063144, 0.246535168241246);
}

/// Along any of its parameters the dose is given at other fractions of the unit time, round and round.
#[test]
fn doses_at_equal_times_are_told_exactly_all_along_a_branch() {
    let text = "par k=.3,dose=2,tau=5\nc'=-k*c\ns'=1\nglobal 1 {s-tau} {s=0;c=c+dose}\ninit c=1\ndone\n";
    let folder = settled(text, 203.0);
    for (name, range, [k, dose, tau]) in [
        ("tau", ".3:20", [0.3, 2.0, 5.0]),
        ("k", ".02:3", [0.3, 2.0, 5.0]),
        ("dose", ".1:10", [0.3, 2.0, 5.0]),
    ] {
        let cycles =
            folder.json(&format!("cycles --from h.json:END --along {name}={range} --monitor mean(c)"));
        for end in cycles["ends"].as_array().unwrap() {
            assert!(end["cause"].as_str().unwrap().starts_with("reached the end"), "{name}: {end}");
        }
        for point in points(&cycles) {
            let value = number(&point["value"]);
            let own = |place: &str, other: f64| if place == name { value } else { other };
            let (k, dose, tau) = (own("k", k), own("dose", dose), own("tau", tau));
            let largest = dose / (1.0 - (-k * tau).exp());
            let error = (3.0 * number(&point["error_estimate"])).max(1e-9);
            assert!((number(&point["max"]["c"]) / largest - 1.0).abs() <= error, "{name} = {value}");
            assert!(
                (number(&point["min"]["c"]) - (largest - dose)).abs() <= error * largest,
                "{name} = {value}"
            );
            assert!((number(&point["max"]["s"]) / tau - 1.0).abs() <= error, "{name} = {value}");
            let mean =
                number(point["monitors"].as_array().map_or(&point["monitors"]["mean(c)"], |all| &all[0]));
            assert!((mean / (dose / (k * tau)) - 1.0).abs() < 1e-6, "{name} = {value}: {mean}");
            assert_eq!(point["stable"], true);
        }
    }
}

#[test]
fn a_thermostat_has_a_mode_that_events_set() {
    let text = "par h=.2\nx'=-x+3*m\ny'=(x-y)/2\nm'=0\nglobal 1 y-1-h {m=0}\nglobal -1 y-1+h {m=1}\ninit y=.9,m=1\ndone\n";
    let folder = settled(text, 100.0);
    let cycles = folder.json("cycles --from h.json:END --along h=.05:.4 --at .2,.3");
    check(&cycles, 0.2, 3.9409468377326218, 0.0);
    check(&cycles, 0.3, 4.738652362151501, 0.0);
}

#[test]
fn a_block_sticks_to_a_belt_and_slips() {
    let friction = "if(y>vb)then(1/(1+(y-vb)))else(-1/(1+(vb-y)))";
    let folder = settled(&format!("par vb=.5\nx'=y\ny'=-x-.05*y-{friction}\ninit x=1\ndone\n"), 300.0);
    let cycles = folder.json("cycles --from h.json:END --along vb=.1:3.5 --at .5,2,3");
    check(&cycles, 0.5, 7.45377630413153, 0.0);
    check(&cycles, 2.0, 6.449780706979948, 0.0);
    check(&cycles, 3.0, 6.34877640678173, 0.0);
}

#[test]
fn a_grazing_ends_a_branch_and_is_told() {
    let text = "par s=1\nx'=v\nv'=-x-.1*v+c\nc'=c*(1-c^2-q^2)-3*q\nq'=q*(1-c^2-q^2)+3*c\nglobal 1 x-s {v=-.8*v}\ninit c=1\ndone\n";
    let folder = settled(text, 400.0);
    let story = folder.succeed("cycles --from h.json:END --along s=.05:1.2");
    // The amplitude of the forced motion without impacts, 1/sqrt(64.09).
    assert!(story.contains("grazing: at s = 0.1249122 ") && story.contains("event 1"), "{story}");
}

#[test]
fn a_ball_bounces_on_a_table_from_a_fold_on() {
    // Once in every period T = 1 of the table: v = g T/2 = r v + (1 + r) a w cos(phi), so that a is smallest where cos(phi) = 1.
    let text = "par a=.05\nx'=v\nv'=-1.962\nc'=c*(1-c^2-q^2)-2*pi*q\nq'=q*(1-c^2-q^2)+2*pi*c\n\
                global -1 x-a*q {v=-.6*v+1.6*a*2*pi*c}\ninit x=.0313,v=.98,c=.78,q=.625\ndone\n";
    let folder = settled(text, 450.0);
    let cycles = folder.json("cycles --from h.json:END --along a=.03:.08");
    let fold = points(&cycles).iter().find(|point| point["label"] == "LPC1").unwrap();
    let exact = 1.962 * 0.4 / (2.0 * 1.6) / (2.0 * std::f64::consts::PI);
    assert!((number(&fold["value"]) - exact).abs() < 1e-10, "{} instead of {exact}", fold["value"]);
}

#[test]
fn a_settled_motion_starts_cycles_wherever_it_was_stopped() {
    // With 300 the time of a sample is a multiple of the period, to a millionth.
    let text = "par I=2\nv'=-v+.2*exp((v-1)/.2)+I-w\nw'=(.2*v-w)/8\nglobal 1 v-3 {v=.2;w=w+.3}\ndone\n";
    let folder = folder(text);
    for duration in [100, 300, 301, 600] {
        folder.succeed(&format!("simulate model.ode --duration {duration} -o h.json -q"));
        let cycles = folder.json("cycles --from h.json:END --along I=1.6:4 --at 2 --steps 1");
        let point = points(&cycles).iter().find(|point| number(&point["value"]) == 2.0).unwrap();
        // The interval between spikes by SciPy with events, at 1e-10.
        assert!(
            (number(&point["period"]) / 3.030005505404 - 1.0).abs() < 1e-8,
            "{duration}: {}",
            point["period"]
        );
    }
}

/// The heater of a thermostat is set to 0 and to 1. Heated all the time the room comes to rest at the threshold 21 where
/// `kp = 0.1*16 + 0.1*(21 - 11.5/0.7) = 72/35`, by hand: the period grows there as a logarithm.
#[test]
fn what_events_set_to_zero_is_not_taken_for_a_state_that_double_precision_loses() {
    let folder = settled(
        "par kp=3\nx'=-.1*(x-5)-.1*(x-w)+kp*q\nw'=.05*(x-w)-.02*(w-5)\nq'=0\nglobal 1 {x-21} {q=0}\n\
         global -1 {x-19} {q=1}\ninit x=18,w=15,q=1\ndone\n",
        400.0,
    );
    let cycles = folder.json("cycles --from h.json:END --along kp=2:4");
    let end = cycles["ends"][0]["cause"].as_str().unwrap();
    assert!(!end.contains("near to zero"), "{end}");
    let first = number(&points(&cycles)[0]["value"]);
    assert!((first - 72.0 / 35.0).abs() < 1e-5, "{first}");
}

/// A leaky neuron fires with the period ln(i/(i - 1)) until its equilibrium v = i comes to lie on the threshold. A thermostat does the same
/// where its heater just reaches the upper temperature: .1 W + .1 (21 - 11.5/.7) with the wall at rest.
#[test]
fn periods_that_grow_without_bound_at_an_event() {
    let neuron = "par i=2\nv'=i-v\nglobal 1 v-1 {v=0}\ndone\n";
    let thermostat = "par kp=3\nx'=-.1*(x-5)-.1*(x-w)+kp*q\nw'=.05*(x-w)-.02*(w-5)\nq'=0\nglobal 1 {x-21} {q=0}\n\
                      global -1 {x-19} {q=1}\ninit x=18,w=15,q=1\ndone\n";
    let heater = 1.6 + 0.1 * (21.0 - 11.5 / 0.7);
    for (text, along, place) in [(neuron, "i=.5:3", 1.0), (thermostat, "kp=2:6", heater)] {
        let folder = folder(text);
        folder.succeed("simulate model.ode --duration 400 -q -o motion.json");
        let cycles = folder.json(&format!("cycles --from motion.json:END --along {along}"));
        let end = &cycles["ends"][0];
        let cause = end["cause"].as_str().unwrap();
        assert!(cause.contains("comes to lie on the condition of event 1"), "{cause}");
        let name = along.split_once('=').unwrap().0;
        assert!((number(&end["last"][name]) - place).abs() < 1e-5, "{end}");
        assert!(cycles.get("unlocated").is_none_or(|changes| changes.as_array().unwrap().is_empty()));
        if text == neuron {
            for point in points(&cycles) {
                let drive = number(&point["value"]);
                let error = number(&point["period"]) - (drive / (drive - 1.0)).ln();
                assert!(error.abs() < 1e-6 * number(&point["period"]), "{drive}: {error}");
            }
        }
    }
}
