//! Expressions that are recorded along a branch, and points and ends at their values.

use super::{Folder, labelled};

#[test]
fn points_and_ends_are_given_at_values_of_monitors() {
    let folder = Folder::with("lure.ode");
    let equilibria =
        folder.json("equilibria lure.ode --along alpha=-1.5:1.5 -o e.json --monitor x+alpha=0.5");
    let points = equilibria["points"].as_array().unwrap();
    let asked = points.iter().find(|point| point["label"] == "AT1").unwrap();
    assert!((asked["value"].as_f64().unwrap() - 0.5).abs() < 1e-12);

    let cycles = folder.json(
        "cycles --from e.json:HB1 --along alpha=-1.5:1.5 --monitor max(x)-min(x)=0.5 --monitor mean(y) --until period=6.31",
    );
    let points = cycles["points"].as_array().unwrap();
    let asked = points.iter().find(|point| point["label"] == "AT1").unwrap();
    let amplitude = asked["max"]["x"].as_f64().unwrap() - asked["min"]["x"].as_f64().unwrap();
    assert!((amplitude - 0.5).abs() < 1e-9, "{amplitude}");
    // y is the rate of change of x: its mean over a cycle vanishes.
    assert!(points.iter().all(|point| point["monitors"]["mean(y)"].as_f64().unwrap().abs() < 1e-7));
    let last = points.last().unwrap();
    assert!((last["period"].as_f64().unwrap() - 6.31).abs() < 1e-9, "{}", last["period"]);
    assert_eq!(cycles["ends"][1]["cause"], "period reached the value 6.31 at which to stop");
}

#[test]
fn a_state_has_no_value_on_a_cycle() {
    let folder = Folder::with("lure.ode");
    folder.succeed("equilibria lure.ode --along alpha=-1.5:1.5 -o e.json");
    folder.fails(
        "cycles --from e.json:HB1 --along alpha=-1.5:1.5 --monitor x",
        2,
        &["--monitor x", "max(x)"],
    );
    folder.fails("equilibria lure.ode --along alpha=-1.5:1.5 --monitor max(x)", 2, &["takes 2 arguments"]);
    folder.fails("equilibria lure.ode --along alpha=-1.5:1.5 --until foo=1", 2, &["unknown name `foo`"]);
}

/// The cycles are circles of radius sqrt(p), passed once in 2 pi with x before y.
const CIRCLES: &str = "x' = p*x - y - x*(x^2+y^2)\ny' = x + p*y - y*(x^2+y^2)\npar p=-0.5\ninit x=0,y=0\n";

#[test]
fn the_value_at_a_phase_counts_from_the_largest_first_state() {
    let folder = Folder::with_text("circles.ode", CIRCLES);
    folder.succeed("equilibria circles.ode --along p=-1:1 -o e.json");
    let cycles = folder.json(
        "cycles --from e.json:HB1 --along p=-1:1 --monitor at(y,0.25)=0.5 --monitor at(x,1/4) --monitor AT(y*y,2^-3) \
         --until at(-y,3/4)=0.7",
    );
    let asked = labelled(&cycles, "AT1");
    assert!((asked["value"].as_f64().unwrap() - 0.25).abs() < 1e-8, "{}", asked["value"]);
    let points = cycles["points"].as_array().unwrap();
    let last = points.last().unwrap()["value"].as_f64().unwrap();
    assert!((last - 0.49).abs() < 1e-8, "{last}");
    for point in points {
        let (square, monitors) = (point["value"].as_f64().unwrap(), &point["monitors"]);
        let value = |name: &str| monitors[name].as_f64().unwrap();
        assert!((value("at(y,0.25)") - square.sqrt()).abs() < 1e-7, "{point}");
        assert!(value("at(x,1/4)").abs() < 1e-7, "{point}");
        assert!((value("AT(y*y,2^-3)") - 0.5 * square).abs() < 1e-7, "{point}");
    }
}

#[test]
fn what_is_no_phase_is_refused() {
    let folder = Folder::with_text("circles.ode", CIRCLES);
    folder.succeed("equilibria circles.ode --along p=-1:1 -o e.json");
    for (monitor, problem) in [
        ("at(x)", "does not have an expression and a phase"),
        ("at(x,y,0.5)", "does not have an expression and a phase"),
        ("at(x,1)", "the phase 1 is outside one period"),
        ("at(x,-0.25)", "outside one period"),
        ("at(x,p)", "the phase p is not constant"),
        ("at(x,0*y)", "is not constant"),
        ("at(x,quarter)", "unknown name `quarter`"),
    ] {
        folder.fails(
            &format!("cycles --from e.json:HB1 --along p=-1:1 --monitor {monitor}"),
            2,
            &["--monitor", problem, "at(x, 0.25)", "first state is largest"],
        );
    }
}

#[test]
fn a_function_of_the_model_comes_before_the_value_at_a_phase() {
    let folder = Folder::with_text("circles.ode", &format!("{CIRCLES}at(u,v)=u+v\n"));
    folder.succeed("equilibria circles.ode --along p=-1:1 -o e.json");
    let cycles = folder.json("cycles --from e.json:HB1 --along p=-1:0.5 --monitor at(p,1)");
    for point in cycles["points"].as_array().unwrap() {
        assert_eq!(point["monitors"]["at(p,1)"].as_f64().unwrap(), point["value"].as_f64().unwrap() + 1.0);
    }
}
