//! Equilibria and cycles on which a quantity keeps its value, against closed forms.

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
fn equilibria_are_followed_on_which_a_quantity_keeps_its_value() {
    // 0 = a + b x - x^3, a fold where b = 3 x^2.
    let folder = folder("par a=0, b=-1\nx'=a+b*x-x^3\ninit x=0\n");
    folder.succeed("equilibria model.ode --along a=-2:2 --at 0.5 -q -o equilibria.json");
    let held = folder.json(
        "locus --from equilibria.json:AT1 --hold x=0.3 --in a=-2:2,b=-3:3 -o held.json -o held.svg -o held.csv",
    );
    assert!(held["kind"].is_null());
    assert_eq!(held["held"]["x"], 0.3);
    assert!(points(&held).len() > 5);
    for point in points(&held) {
        let [a, b] = [0, 1].map(|index| number(&point["values"][index]));
        assert!((number(&point["state"]["x"]) - 0.3).abs() < 1e-12);
        assert!((a + 0.3 * b - 0.027).abs() < 1e-12, "{a} {b}");
    }
    let ends = [0, points(&held).len() - 1].map(|index| number(&points(&held)[index]["values"][1]));
    assert_eq!(ends, [3.0, -3.0]);
    let folds: Vec<f64> = points(&held)
        .iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("LP")))
        .map(|point| number(&point["values"][1]))
        .collect();
    assert!(folds.len() == 1 && (folds[0] - 0.27).abs() < 1e-10, "{folds:?}");
    assert!(folder.succeed("show held.json").contains("equilibria with x = 0.3"));
    // Another equilibrium is a start, too, from the curve itself, and any expression can be held.
    let held = folder.json("locus --from held.json:LP1 --hold a*b --in a=-2:2,b=-3:3");
    let product = |point: &serde_json::Value| {
        let [a, b] = [0, 1].map(|index| number(&point["values"][index]));
        (a * b, a + b * number(&point["state"]["x"]) - number(&point["state"]["x"]).powi(3))
    };
    let (first, _) = product(&points(&held)[0]);
    for (held, residual) in points(&held).iter().map(product) {
        assert!((held - first).abs() < 1e-10 && residual.abs() < 1e-10, "{held} {first}");
    }
}

#[test]
fn hopf_points_lie_where_they_should_on_equilibria_with_a_held_state() {
    // The Brusselator: (a, b/a), Hopf points where b = 1 + a^2; b = 3 a where y = 3.
    let folder = folder("par a=1, b=1.5\nx'=a-(b+1)*x+x^2*y\ny'=b*x-x^2*y\ninit x=1,y=1.5\n");
    folder.succeed("equilibria model.ode --along b=0.5:4 -q -o equilibria.json");
    let held = folder.json("locus --from equilibria.json:HB1 --hold y=3 --in a=0.1:4,b=0.1:20");
    let hopf: Vec<f64> = points(&held)
        .iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("HB")))
        .map(|point| number(&point["values"][0]))
        .collect();
    let root = 5.0_f64.sqrt();
    assert_eq!(hopf.len(), 2, "{hopf:?}");
    for (found, exact) in hopf.iter().zip([0.5 * (3.0 - root), 0.5 * (3.0 + root)]) {
        assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    }
    for point in points(&held) {
        let [a, b] = [0, 1].map(|index| number(&point["values"][index]));
        assert!((b - 3.0 * a).abs() < 1e-10);
    }
}

#[test]
fn what_cannot_be_held_is_refused() {
    let folder = folder(CIRCLES);
    folder.succeed("equilibria model.ode --along a=-1:1 -q -o equilibria.json");
    folder.succeed("cycles --from equilibria.json:HB1 --along a=-1:1 --at 0.25 -q -o cycles.json");
    folder.succeed("simulate model.ode --duration 10 -q -o motion.json");
    for (from, hold, said) in [
        ("equilibria.json:HB1", "period", "period"),
        ("equilibria.json:HB1", "x=1,2", "several values"),
        ("equilibria.json:HB1", "log(x-1)", "no value at HB1"),
        ("equilibria.json:HB1", "x=0.3", "the quantity to be held"),
        ("motion.json:END", "x", "nothing can be held from END"),
        ("cycles.json:AT1", "x", "no single value on a cycle"),
        ("cycles.json:AT1", "period=3,4", "several values"),
        ("cycles.json:AT1", "max(x)=9", "the quantity to be held"),
    ] {
        let run = folder.run(&format!("locus --from {from} --hold {hold} --in a=0:1,b=-1:1"));
        assert!(run.messages.contains(said), "{hold}: {}", run.messages);
    }
}
