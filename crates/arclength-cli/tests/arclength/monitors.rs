//! Expressions that are recorded along a branch, and points and ends at their values.

use super::Folder;

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
