//! Models whose authors guarded against 0/0: branches are those of the smooth field.

use crate::found_by_users::{folder, number, points};
use crate::labelled;

fn neuron(guard: f64) -> String {
    let rate = |name: &str, value: &str, factor: &str, place: &str| {
        format!(
            "{name}(v)=if(abs(v+{place})<{guard:e})then({value})else({factor}*(v+{place})/(1-exp(-(v+{place})/10)))\n"
        )
    };
    format!(
        "par i=10\n{}{}v'=i-120*m^3*h*(v-50)-36*n^4*(v+77)-.3*(v+54.4)\nm'=am(v)*(1-m)-4*exp(-(v+65)/18)*m\n\
         h'=.07*exp(-(v+65)/20)*(1-h)-h/(1+exp(-(v+35)/10))\nn'=an(v)*(1-n)-.125*exp(-(v+65)/80)*n\n\
         init v=-60,m=.1,h=.6,n=.3\ndone\n",
        rate("am", "1", ".1", "40"),
        rate("an", ".1", ".01", "55"),
    )
}

/// The guards of Hodgkin and Huxley's rates hold for a millionth of the period; taken literally they stop branches.
#[test]
fn guards_of_rates_do_not_stop_branches() {
    for guard in [1e-3, 1e-7] {
        let folder = folder(&neuron(guard));
        let told = folder.run("equilibria model.ode --along i=0:200 -o e.json");
        assert!(told.messages.contains("the guards against 0/0"), "{}", told.messages);
        let equilibria = folder.json("equilibria model.ode --along i=0:200");
        for (label, place) in [("HB1", 9.77933799539), ("HB2", 154.526333666)] {
            assert!((number(&labelled(&equilibria, label)["value"]) - place).abs() < 1e-8, "{guard} {label}");
        }
        folder.succeed("simulate model.ode --duration 200 -q -o h.json");
        let cycles = folder.json("cycles --from h.json:END --along i=0:30");
        for (label, place) in [("LPC1", 7.8462471202), ("PD1", 7.8492373978), ("LPC3", 6.2642212745)] {
            assert!((number(&labelled(&cycles, label)["value"]) - place).abs() < 1e-7, "{guard} {label}");
        }
    }
}

/// A kink in the parameter alone is passed like one in a state.
#[test]
fn kinks_in_the_parameter_are_passed() {
    let folder = folder("par p=-1\nx'=-x-5*p+10*max(p,0)\ndone\n");
    let equilibria = folder.json("equilibria model.ode --along p=-1:1");
    let points = points(&equilibria);
    assert_eq!(points.iter().filter(|point| point["label"].is_string()).count(), 2);
    for point in points {
        let (value, state) = (number(&point["value"]), number(&point["state"]["x"]));
        assert!((state - 5.0 * value.abs()).abs() < 1e-9, "{value}: {state}");
    }
}
