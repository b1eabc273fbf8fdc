//! Branches of cycles that start from samples of an orbit.

use super::{Folder, labelled};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// A subcritical Hopf point at p = 0: unstable circles of radius sqrt(-p), passed once in 2 pi.
const UNSTABLE: &str = "x' = p*x - y + x*(x^2+y^2)\ny' = x + p*y + y*(x^2+y^2)\npar p=-0.25\n";

fn check_circles(cycles: &Value) {
    let points = cycles["points"].as_array().unwrap();
    assert!(points.len() > 5);
    for point in points {
        let radius = (-point["value"].as_f64().unwrap()).sqrt();
        let close = |value: &Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-8;
        assert!(close(&point["period"], TAU) && point["stable"] != Value::Bool(true), "{point}");
        for state in ["x", "y"] {
            assert!(close(&point["max"][state], radius) && close(&point["min"][state], -radius), "{point}");
        }
    }
}

/// Samples of a circle that is somewhat too large, the states in another order and one column too many.
fn circle(rows: usize, periods: f64) -> String {
    let mut text = "\u{feff}Y, remark ,T,X\n".to_owned();
    for row in 0..=rows {
        let time = TAU * periods * row as f64 / rows as f64;
        writeln!(text, "{},\"a, b\",{},{}", 0.51 * time.sin(), 3.0 + time, 0.51 * time.cos()).unwrap();
    }
    text
}

#[test]
fn an_unstable_cycle_is_followed_from_samples() {
    let folder = Folder::with_text("unstable.ode", UNSTABLE);
    folder.write("orbit.csv", &circle(60, 1.0));
    let cycles = folder.json("cycles unstable.ode --from orbit.csv --along p=-1:-0.05 --at -0.5");
    check_circles(&cycles);
    assert_eq!(labelled(&cycles, "AT1")["value"], -0.5);
    assert_eq!(cycles["from"]["how"], "the orbit in orbit.csv");
    // With another parameter in its place the cycle is found from further away.
    check_circles(&folder.json("cycles unstable.ode --from orbit.csv -s p=-0.3 --along p=-1:-0.05"));
}

#[test]
fn a_time_history_over_one_period_is_a_start() {
    let folder = Folder::with_text("unstable.ode", UNSTABLE);
    folder.succeed(&format!(
        "simulate unstable.ode --start x=0.5,y=0 --duration {TAU} --points 101 -q -o orbit.csv -o orbit.json"
    ));
    check_circles(&folder.json("cycles unstable.ode --from orbit.csv --along p=-1:-0.05"));
}

#[test]
fn samples_that_make_no_sense() {
    let folder = Folder::with_text("unstable.ode", UNSTABLE);
    folder.succeed("equilibria unstable.ode --along p=-1:1 --start x=0,y=0 -q -o e.json");
    let whole = circle(40, 1.0);
    let cut = |rows: usize| whole.lines().take(rows + 1).map(|line| format!("{line}\n")).collect::<String>();
    let equilibrium = "t,x,y\n".to_owned() + &(0..10).map(|row| format!("{row},0,0\n")).collect::<String>();
    for (text, words) in [
        ("t,x\n0,1\n".to_owned(), &["line 1, column y", "t, x"][..]),
        (String::new(), &["line 1, column t", "no such column"]),
        (whole.replacen("\n0,", "\nzero,", 1), &["line 2, column y", "`zero` is no finite number"]),
        ("t,x,y\n0,1\n".to_owned(), &["line 2, column y", "`` is no finite number"]),
        ("t,x,y\n0,1,nan\n".to_owned(), &["line 2, column y", "`nan`"]),
        ("t,x,y\n0,1,0\n0,1,1\n".to_owned(), &["line 3, column t", "0 does not come after 0"]),
        (cut(5), &["line 6", "5 rows; allowed: at least 8"]),
        (cut(30), &["line 31, column x", "does not close", "cut the file to exactly one period"]),
        (circle(120, 3.0), &["line 122", "3 periods", "cut the file to exactly one period"]),
        (equilibrium, &["line 11", "equilibrium"]),
    ] {
        folder.write("orbit.csv", &text);
        folder.fails(
            "cycles unstable.ode --from orbit.csv --along p=-1:-0.05",
            2,
            &[&["orbit.csv"], words].concat(),
        );
    }
    folder.write("orbit.csv", &whole);
    let along = "--along p=-1:-0.05";
    folder.fails(
        &format!("cycles --from orbit.csv {along}"),
        2,
        &["MODEL.ode", "orbit.csv", "have no model"],
    );
    folder.fails(
        &format!("cycles unstable.ode --from e.json:HB1 {along}"),
        2,
        &["MODEL.ode with e.json:HB1", "has its own model", "without a model"],
    );
    folder.fails(
        &format!("cycles unstable.ode --from missing.csv {along}"),
        2,
        &["missing.csv", "cannot be read"],
    );
    folder.fails(
        "cycles unstable.ode --from orbit.csv --along p=-1:-0.5",
        2,
        &["orbit.csv is outside the interval, p = -0.25 there"],
    );
    folder.fails(&format!("cycles --from orbit {along}"), 2, &["FILE.json:LABEL", "FILE.csv"]);
}
