//! Expressions that are recorded along branches and curves, and points and ends at their values.

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

#[track_caller]
fn near(value: &serde_json::Value, expected: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() < 1e-8, "{value}, not {expected}");
}

#[test]
fn curves_of_equilibria_are_monitored() {
    // The folds are at q = 3 x^2, p = -2 x^3.
    let folder = Folder::with_text("cusp.ode", "x' = p + q*x - x^3\npar p=-0.5,q=0.3\ninit x=-1\n");
    folder.succeed("equilibria cusp.ode --along p=-1:1 -q -o e.json");
    let asked = "locus --from e.json:LP2 --in p=-3:1,q=0.1:4 --monitor x+q=1.25 --monitor p --until x=0.8";
    let curve = folder.json(asked);
    let point = labelled(&curve, "AT2");
    near(&point["values"][0], -0.25);
    near(&point["values"][1], 0.75);
    let points = curve["points"].as_array().unwrap();
    for point in points {
        let x = point["state"]["x"].as_f64().unwrap();
        near(&point["monitors"]["x+q"], x + 3.0 * x * x);
        near(&point["monitors"]["p"], -2.0 * x.powi(3));
    }
    let ends: Vec<&serde_json::Value> = (0..2)
        .map(|end| &curve["ends"][end])
        .filter(|end| end["cause"].as_str().unwrap().starts_with("x "))
        .collect();
    assert_eq!(ends.len(), 1, "{}", curve["ends"]);
    assert_eq!(ends[0]["cause"], "x reached the value 0.8 at which to stop");
    near(&ends[0]["last"]["q"], 1.92);

    let table = folder.succeed(&format!("{asked} -o curve.csv"));
    assert!(table.lines().any(|line| line.contains("label") && line.contains("x+q")), "{table}");
    let columns = std::fs::read_to_string(folder.0.path().join("curve.csv")).unwrap();
    assert!(columns.lines().next().unwrap().ends_with("monitor_x+q,monitor_p,monitor_x"), "{columns}");
    folder.fails("locus --from e.json:LP2 --in p=-3:1,q=0.1:4 --monitor max(x)", 2, &["takes 2 arguments"]);
}

#[test]
fn curves_of_cycles_are_monitored() {
    // Circles of radius r with p = r^4 - q r^2; their folds are at q = 2 r^2, p = -r^4.
    let folder = Folder::with_text(
        "bautin.ode",
        "R = x^2+y^2\nx' = x*(p + q*R - R^2) - y\ny' = y*(p + q*R - R^2) + x\npar p=-0.5,q=1\ninit x=0,y=0\n",
    );
    folder.succeed("equilibria bautin.ode --along p=-1:1 -q -o e.json");
    folder.succeed("cycles --from e.json:HB1 --along p=-1:1 -q -o c.json");
    let asked = "locus --from c.json:LPC1 --in p=-4:0,q=0.5:4 --monitor max(x)=0.9 --monitor at(y,0.25)-p*period \
                 --until mean(x^2)=0.6";
    let curve = folder.json(asked);
    let point = labelled(&curve, "AT2");
    near(&point["values"][0], -0.6561);
    near(&point["values"][1], 1.62);
    for point in curve["points"].as_array().unwrap() {
        let square = 0.5 * point["values"][1].as_f64().unwrap();
        near(&point["monitors"]["max(x)"], square.sqrt());
        near(&point["monitors"]["mean(x^2)"], 0.5 * square);
        near(
            &point["monitors"]["at(y,0.25)-p*period"],
            square.sqrt() + square * square * std::f64::consts::TAU,
        );
    }
    let causes = [0, 1].map(|end| curve["ends"][end]["cause"].as_str().unwrap());
    let stop = causes.iter().position(|cause| *cause == "mean(x^2) reached the value 0.6 at which to stop");
    near(&curve["ends"][stop.unwrap()]["last"]["p"], -1.44);
    let table = folder.succeed(&format!("{asked} -o curve.csv"));
    assert!(table.lines().any(|line| line.contains("label") && line.contains("mean(x^2)")), "{table}");
    let columns = std::fs::read_to_string(folder.0.path().join("curve.csv")).unwrap();
    assert!(columns.lines().next().unwrap().contains("monitor_max(x),"), "{columns}");
    folder.fails("locus --from c.json:LPC1 --in p=-4:0,q=0.5:4 --until x=1", 2, &["--until x", "max(x)"]);

    // Where r is held, p falls by r^2 as q grows by 1.
    let held = folder.json(
        "locus --from c.json:LPC1 --hold max(x) --in p=-4:1,q=0.5:4 --monitor p+q=1 --monitor at(y,0.25)",
    );
    let point = labelled(&held, "AT1");
    near(&point["values"][0], -0.5);
    near(&point["values"][1], 1.5);
    near(&point["monitors"]["at(y,0.25)"], 0.5_f64.sqrt());
}
