//! Poincaré sections and pictures of motions.
//!
//! Right values are closed forms, or of SciPy's DOP853 at a relative tolerance of 1e-13.

use super::Folder;
use serde_json::Value;

fn section(model: &str, options: &str) -> (Vec<f64>, Value) {
    let result = Folder::with_text("model.ode", model).json(&format!("simulate model.ode {options} -q"));
    let times = result["t"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    (times, result)
}

fn states(result: &Value, name: &str) -> Vec<f64> {
    result["states"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[track_caller]
fn all_close(found: &[f64], right: &[f64], error: f64) {
    assert_eq!(found.len(), right.len(), "{found:?}, right {right:?}");
    for (found, right) in found.iter().zip(right) {
        assert!((found - right).abs() <= error, "{found}, right {right}");
    }
}

const PI: f64 = std::f64::consts::PI;
const OSCILLATOR: &str = "x'=y\ny'=-x\ninit x=1\naux energy=(x^2+y^2)/2\n";

#[test]
fn crossings_of_a_harmonic_oscillator() {
    let quarters = |from: u32, step: usize| -> Vec<f64> {
        (from..64).step_by(step).map(|k| f64::from(k) * PI / 2.0).collect()
    };
    let (times, result) = section(OSCILLATOR, "--duration 100 --section x=0");
    all_close(&times, &quarters(1, 2), 1e-9);
    assert!(states(&result, "x").iter().all(|x| x.abs() < 1e-11));
    assert_eq!(result["section"], serde_json::json!({"expression": "x-(0)", "direction": "both"}));
    assert_eq!(result["aux"]["energy"].as_array().unwrap().len(), times.len());
    let (times, result) = section(OSCILLATOR, "--duration 100 --section x=0:+");
    all_close(&times, &quarters(3, 4), 1e-9);
    all_close(&states(&result, "y"), &vec![1.0; times.len()], 1e-8);
    all_close(&section(OSCILLATOR, "--duration 100 --section x=0:-").0, &quarters(1, 4), 1e-9);
    // On the section at the start; that does not count.
    all_close(&section(OSCILLATOR, "--duration 100 --section y").0, &quarters(2, 2), 1e-9);
    // Where the motion turns back at the section, to rounding, nothing is crossed twice.
    let (times, _) = section(OSCILLATOR, "--duration 100 --section x-0.99999999");
    assert!(times.len() == 31 && times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
    let (times, _) = section(OSCILLATOR, "--duration 100 --transient 50 --section x=0");
    assert!(times.iter().all(|time| *time >= 50.0) && times.len() == 16);
    let (times, _) = section(OSCILLATOR, "--duration 10 --section x=2");
    assert!(times.is_empty());
}

#[test]
fn sections_in_time() {
    let duffing = "x'=y\ny'=x-x^3-.25*y+.3*cos(t)\ninit x=.5\n";
    let (times, result) = section(duffing, "--duration 19 --section sin(t/2)=0");
    all_close(&times, &[2.0 * PI, 4.0 * PI, 6.0 * PI], 1e-12);
    all_close(&states(&result, "x"), &[0.2061860050720, -0.5748030566252, -0.8257486080631], 1e-8);
    all_close(&states(&result, "y"), &[0.2768502659292, -0.3532201121533, 0.1882485923901], 1e-8);
    // A function that jumps over zero does not cross it.
    all_close(&section("x'=1\n", "--duration 3 --section mod(t,1)=0.5").0, &[0.5, 1.5, 2.5], 1e-12);
}

#[test]
fn section_of_a_strange_attractor() {
    let rossler = "x'=-y-z\ny'=x+.2*y\nz'=.2+z*(x-5.7)\ninit x=1,y=1\n";
    let (times, result) = section(rossler, "--duration 35 --section y=0:-");
    let right = [
        2.3857148269287,
        8.7064260323316,
        15.0181761741209,
        21.1341825791644,
        26.2236578031826,
        32.5371416171704,
    ];
    all_close(&times, &right, 1e-8);
    let x = [
        -1.9028969356387,
        -3.5058148368056,
        -6.3727680922177,
        -8.7735107268915,
        -3.2687988335705,
        -5.9609894115026,
    ];
    all_close(&states(&result, "x"), &x, 1e-7);
}

#[test]
fn a_section_at_a_switch() {
    // Half a turn with the frequency 2, half a turn with the frequency 1; the section is where the field switches.
    let bilinear = "x'=y\ny'=-x*(if(x>0)then(4)else(1))\ninit x=1\n";
    let half_turns = |first: f64| -> Vec<f64> {
        let lengths = [PI, PI / 2.0].into_iter().cycle();
        std::iter::once(first)
            .chain(lengths.scan(first, |time, length| {
                *time += length;
                Some(*time)
            }))
            .take_while(|time| *time < 50.0)
            .collect()
    };
    for name in ["x", "2*x", "-x", "x^3+x"] {
        let (times, _) = section(bilinear, &format!("--duration 50 --section {name}=0"));
        all_close(&times, &half_turns(PI / 4.0), 1e-8);
    }
}

#[test]
fn what_is_wrong_with_a_section_or_a_plot_is_said() {
    let folder = Folder::with_text("model.ode", OSCILLATOR);
    folder.fails("simulate model.ode --duration 1 --section z=0", 2, &["--section", "z", "allowed"]);
    folder.fails("simulate model.ode --duration 1 --section x=0:up", 2, &["--section", ":+"]);
    folder.fails("simulate model.ode --duration 1 --section x --points 5", 2, &["--section", "--points"]);
    folder.fails("simulate model.ode --duration 1 --plot x,z -o p.svg", 2, &["--plot z", "t, x, y, energy"]);
    folder.fails("simulate model.ode --duration 1 --plot x:y:t -o p.svg", 2, &["--plot", "x:y"]);
    folder.fails("simulate model.ode --duration 1 --plot x:x -o p.svg", 2, &["--plot", "two different"]);
    folder.fails("simulate model.ode --duration 1 --plot t -o p.svg", 2, &["--plot", "other quantities"]);
    folder.fails("simulate model.ode --duration 1 --plot x,y --window z=0:1 -o p.svg", 2, &["--window", "z"]);
    folder.fails("simulate model.ode --duration 1 --plot x,y", 2, &["--plot", "--out"]);
    let run = folder.run("simulate model.ode --duration 1 --section x=2");
    assert!(run.exit_code == 0 && run.messages.contains("does not cross"), "{}", run.messages);
}

/// The phase plane of the only plot.
fn phase_plane(model: &str, options: &str) -> Value {
    section(model, options).1["phase_planes"][0].clone()
}

#[test]
fn the_phase_plane_of_a_bistable_oscillator() {
    let plane = phase_plane("x'=y\ny'=x-x^3-.2*y\ninit x=-.2,y=1.1\n", "--duration 60 --plot x,y");
    let equilibria = plane["equilibria"].as_array().unwrap();
    let found: Vec<(f64, &str)> = equilibria
        .iter()
        .map(|point| ((point["x"].as_f64().unwrap() * 1e9).round() / 1e9, point["kind"].as_str().unwrap()))
        .collect();
    for right in [(-1.0, "stable_focus"), (0.0, "saddle"), (1.0, "stable_focus")] {
        assert!(found.contains(&right), "{found:?}");
    }
    assert_eq!(found.len(), 3);
    let points = |curves: &Value| -> Vec<[f64; 2]> {
        let curves = curves.as_array().unwrap().iter();
        curves.flat_map(|curve| serde_json::from_value::<Vec<[f64; 2]>>(curve.clone()).unwrap()).collect()
    };
    assert!(points(&plane["x_nullclines"]).iter().all(|[_, y]| y.abs() < 1e-12));
    assert!(points(&plane["y_nullclines"]).iter().all(|[x, y]| (x - x.powi(3) - 0.2 * y).abs() < 1e-11));
    // Both unstable curves of the saddle end in the stable equilibria.
    let curves = plane["manifolds"].as_array().unwrap();
    let ends: Vec<f64> = curves
        .iter()
        .filter(|curve| curve["stable"] == false)
        .map(|curve| curve["points"].as_array().unwrap().last().unwrap()[0].as_f64().unwrap())
        .collect();
    assert!(curves.len() == 4 && ends.len() == 2, "{ends:?}");
    assert!(ends.iter().any(|x| (x - 1.0).abs() < 1e-6) && ends.iter().any(|x| (x + 1.0).abs() < 1e-6));
}

#[test]
fn the_separatrices_of_a_pendulum_are_level_curves() {
    let pendulum = "th'=om\nom'=-sin(th)\ninit th=-3,om=1.5\n";
    let plane = phase_plane(pendulum, "--duration 20 --plot th,om --window th=-7:7,om=-3:3");
    let mut count = 0;
    for curve in plane["manifolds"].as_array().unwrap() {
        for point in serde_json::from_value::<Vec<[f64; 2]>>(curve["points"].clone()).unwrap() {
            // The energy of the upright position.
            assert!((point[1].powi(2) / 2.0 - point[0].cos() - 1.0).abs() < 1e-6, "{point:?}");
            count += 1;
        }
    }
    assert!(count > 1000, "{count}");
    assert_eq!(plane["window"], serde_json::json!([[-7.0, 7.0], [-3.0, 3.0]]));
    let kinds: Vec<&str> =
        plane["equilibria"].as_array().unwrap().iter().map(|point| point["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds.iter().filter(|kind| **kind == "centre").count(), 3, "{kinds:?}");
    assert_eq!(kinds.iter().filter(|kind| **kind == "saddle").count(), 2, "{kinds:?}");
}

#[test]
fn a_model_says_the_window_of_its_picture() {
    let model = "x'=y\ny'=-x\ninit x=1\n@ xp=x,yp=y,xlo=-2,xhi=3,ylo=-4,yhi=5\n";
    let plane = phase_plane(model, "--duration 5 --plot y,x");
    assert_eq!(plane["window"], serde_json::json!([[-4.0, 5.0], [-2.0, 3.0]]));
    assert_eq!((&plane["x"], &plane["y"]), (&"y".into(), &"x".into()));
}

#[test]
fn pictures_are_drawn_of_every_kind() {
    let folder = Folder::with_text("model.ode", OSCILLATOR);
    for options in [
        "--plot x,y",
        "--plot energy,x",
        "--plot t,x,y",
        "--plot x:energy --plot x",
        "--plot 2*x:x^2+y^2 --plot y,-x --window 2*x=-3:3",
        "--section x=0",
        "--section x=0 --plot x,y",
        "--section x=0 --plot y",
    ] {
        folder.succeed(&format!("simulate model.ode --duration 20 {options} -q -o picture.svg"));
        let picture = std::fs::read_to_string(folder.0.path().join("picture.svg")).unwrap();
        assert!(picture.starts_with("<svg") && picture.len() > 3000, "{options}");
    }
    let run =
        Folder::with_text("model.ode", "x'=y\ny'=-x+cos(t)\n").run("simulate model.ode --plot x,y -o p.svg");
    assert!(run.messages.contains("depends on the time"), "{}", run.messages);
    let run = Folder::with_text("model.ode", "x'=x*(1-x-y)\ny'=-y*(1-x-y)\ninit x=.1,y=.2\n")
        .run("simulate model.ode --plot x,y -o p.svg");
    assert!(run.messages.contains("form lines"), "{}", run.messages);
    // Nothing of a model of three states, or of one that depends on the time, is a phase plane.
    for model in ["x'=y\ny'=-x\nz'=-z\ninit x=1\n", "x'=y\ny'=-x+cos(t)\ninit x=1\n"] {
        assert_eq!(section(model, "--duration 5 --plot x,y").1.get("phase_planes"), None);
    }
}

#[test]
fn a_model_says_the_interval_of_its_branches() {
    let model = "x'=a*x-y-x*(x^2+y^2)\ny'=x+a*y-y*(x^2+y^2)\npar a=-.5\n@ parmin=-1,parmax=2,autoxmin=-9,autoxmax=9\n";
    let folder = Folder::with_text("model.ode", model);
    folder.succeed("equilibria model.ode --along a -q -o equilibria.json");
    let result = folder.json("equilibria model.ode --along a -q");
    assert_eq!(result["along"], serde_json::json!({"key": "a", "start": -1.0, "end": 2.0}));
    let result = folder.json("cycles --from equilibria.json:HB1 --along a -q");
    assert_eq!(result["along"], serde_json::json!({"key": "a", "start": -1.0, "end": 2.0}));
    let result = folder.json("equilibria model.ode --along a=-2:3 -q");
    assert_eq!(result["along"], serde_json::json!({"key": "a", "start": -2.0, "end": 3.0}));
    let folder = Folder::with_text("model.ode", "x'=a-x\npar a=1\n");
    folder.fails("equilibria model.ode --along a", 2, &["--along a", "parmin", "a=A:B"]);
    folder.fails("equilibria model.ode --along b", 2, &["--along b"]);
}

#[test]
fn without_a_duration_a_motion_lasts_as_long_as_in_xppaut() {
    let (times, _) = section("x'=1\n", "");
    assert_eq!(times.last(), Some(&20.0));
    let folder = Folder::with_text("model.ode", "x'=1\n@ total=0\n");
    folder.fails("simulate model.ode", 2, &["--duration", "total=0"]);
}

#[test]
fn a_motion_that_depends_on_the_time_goes_on_when_it_ended() {
    let folder = Folder::with_text("model.ode", "x'=cos(t)\n");
    folder.succeed("simulate model.ode --duration 1 -q -o first.json");
    let run = folder.run("simulate --from first.json:END --duration 1");
    assert!(run.exit_code == 0 && run.messages.is_empty(), "{}", run.messages);
    assert!(run.output.contains(&format!("{:.6}", 2.0_f64.sin())), "{}", run.output);
    // At another time if one is told.
    let run = folder.run("simulate --from first.json:END --duration 1 --t0 0");
    assert!(run.output.contains(&format!("{:.6}", 2.0 * 1.0_f64.sin())), "{}", run.output);
}
