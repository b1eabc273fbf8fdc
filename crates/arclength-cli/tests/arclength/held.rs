//! Cycles on which a quantity keeps its value, against closed forms.

use crate::found_by_users::{folder, number, points};

/// Circles of radius s with a + b s^2 - s^4 = 0 and the angular frequency 1 + c s^2.
const CIRCLES: &str = "par a=0.2, b=0, c=0.5
x'=(a+b*(x^2+y^2)-(x^2+y^2)^2)*x-(1+c*(x^2+y^2))*y
y'=(1+c*(x^2+y^2))*x+(a+b*(x^2+y^2)-(x^2+y^2)^2)*y
init x=0.6
";

#[test]
fn cycles_are_followed_on_which_a_quantity_keeps_its_value() {
    let folder = folder(CIRCLES);
    folder.succeed("simulate model.ode --duration 100 -q -o motion.json");
    folder.succeed("cycles --from motion.json:END --along a=0.05:0.8 --at 0.25 -q -o cycles.json");
    let held = folder
        .json("locus --from cycles.json:AT1 --hold period=4 --in a=0.01:1,c=0.01:3 -o held.json -o held.svg");
    assert!(held["kind"].is_null());
    assert_eq!(held["held"]["period"], 4.0);
    assert!(points(&held).len() > 10);
    for point in points(&held) {
        let [a, c] = [0, 1].map(|index| number(&point["values"][index]));
        assert!((number(&point["period"]) - 4.0).abs() < 1e-12);
        assert!((1.0 + c * a.sqrt() - std::f64::consts::TAU / 4.0).abs() < 1e-8, "{a} {c}");
    }
    assert!(folder.succeed("show held.json").contains("cycles with period = 4"));
    // The largest value at the start, where none is given.
    let held = folder.json("locus --from cycles.json:AT1 --hold max(x) --in a=0.01:1,b=-1:1");
    for point in points(&held) {
        let [a, b] = [0, 1].map(|index| number(&point["values"][index]));
        assert!((a + 0.5 * b - 0.25).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn what_cannot_be_held_is_refused() {
    let folder = folder(CIRCLES);
    folder.succeed("equilibria model.ode --along a=-1:1 -q -o equilibria.json");
    folder.succeed("cycles --from equilibria.json:HB1 --along a=-1:1 --at 0.25 -q -o cycles.json");
    for (from, hold, said) in [
        ("equilibria.json:HB1", "period", "nothing can be held from HB1"),
        ("cycles.json:AT1", "x", "no single value on a cycle"),
        ("cycles.json:AT1", "period=3,4", "several values"),
        ("cycles.json:AT1", "max(x)=9", "the quantity to be held"),
    ] {
        let run = folder.run(&format!("locus --from {from} --hold {hold} --in a=0:1,b=-1:1"));
        assert!(run.messages.contains(said), "{hold}: {}", run.messages);
    }
}
