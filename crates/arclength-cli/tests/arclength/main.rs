//! The program `arclength` as others run it, with models of the gallery and their published values.

mod closed_branches;
mod files;
mod found_by_users;
mod guards;
mod held;
mod hybrid;
mod kinks;
mod monitors;
mod orbits;
mod piecewise_linear;
mod piecewise_linear_jumps;
mod readme;
mod restarts;
mod sections;
mod simulations;
mod starts;
mod switching;
mod witnesses;

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// An empty folder that goes when dropped, in which the program is run.
struct Folder(tempfile::TempDir);

/// What a run left.
struct Run {
    exit_code: i32,
    output: String,
    messages: String,
}

impl Folder {
    /// A folder with a model of the gallery.
    fn with(model: &str) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        let gallery = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../gallery/models");
        std::fs::copy(gallery.join(model), folder.0.path().join(model)).unwrap();
        folder
    }

    /// A folder with a model of this text.
    fn with_text(model: &str, text: &str) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write(model, text);
        folder
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    fn run(&self, arguments: &str) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_arclength"))
            .args(arguments.split_whitespace())
            .current_dir(&self.0)
            .env_remove("COLUMNS")
            .stdin(Stdio::null())
            .output()
            .unwrap();
        Run {
            exit_code: output.status.code().expect("ended by itself"),
            output: String::from_utf8(output.stdout).unwrap(),
            messages: String::from_utf8(output.stderr).unwrap(),
        }
    }

    fn succeed(&self, arguments: &str) -> String {
        let run = self.run(arguments);
        assert_eq!(run.exit_code, 0, "{arguments}: {}", run.messages);
        run.output
    }

    fn json(&self, arguments: &str) -> Value {
        serde_json::from_str(&self.succeed(&format!("{arguments} --format json"))).unwrap()
    }

    #[track_caller]
    fn fails(&self, arguments: &str, exit_code: i32, words: &[&str]) {
        let before = std::fs::read_dir(&self.0).unwrap().count();
        let run = self.run(arguments);
        assert_eq!(run.exit_code, exit_code, "{arguments}: {}", run.messages);
        assert!(run.output.is_empty() && run.messages.starts_with("error: "), "{}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: no `{word}` in {}", run.messages);
        }
        assert_eq!(std::fs::read_dir(&self.0).unwrap().count(), before);
    }
}

fn labelled<'a>(result: &'a Value, label: &str) -> &'a Value {
    let points = result["points"].as_array().unwrap();
    points.iter().find(|point| point["label"] == label).unwrap_or_else(|| panic!("no {label}"))
}

#[track_caller]
fn close(value: &Value, expected: f64, tolerance: f64) {
    let relative = (value.as_f64().unwrap() - expected).abs() / expected.abs();
    assert!(relative < tolerance, "{value}, not {expected}");
}

const EQUILIBRIA: &str = "equilibria pp2.ode --along p1=0:0.9 --start u1=0.33,u2=2";

#[test]
fn the_harvested_prey() {
    let folder = Folder::with("pp2.ode");
    let result = folder.json(EQUILIBRIA);
    assert_eq!(result["schema"], serde_json::json!({"name": "arclength.equilibria", "version": 1}));
    assert_eq!(result["parameters"], serde_json::json!({"p2": 3.0, "p3": 5.0, "p4": 3.0}));
    let hopf = labelled(&result, "HB1");
    // Published with the demo `pp2` of AUTO.
    close(&hopf["value"], 0.67159384747883, 1e-12);
    close(&hopf["special"]["frequency"], 0.6047822219, 1e-9);
    assert!(hopf["special"]["first_lyapunov"].as_f64().is_some());
    assert_eq!(hopf["eigenvalues"].as_array().unwrap().len(), 2);
}

#[test]
fn cycles_from_a_file_alone() {
    let folder = Folder::with("pp2.ode");
    folder.succeed(&format!("{EQUILIBRIA} -q -o equilibria.json"));
    // The result file holds the model.
    std::fs::remove_file(folder.0.path().join("pp2.ode")).unwrap();
    let arguments =
        "cycles --from equilibria.json:HB1 --along p1=0.6:0.71 --at p1=0.7 -o cycles.json -o cycles.svg";
    let result = folder.json(arguments);
    let cycle = labelled(&result, "AT1");
    close(&cycle["period"], 17.12989088, 1e-8);
    assert!(cycle["max"]["u1"].as_f64() > cycle["min"]["u1"].as_f64());
    let shown = folder.succeed("show cycles.json");
    assert!(shown.contains("AT1") && shown.contains("17.12989"), "{shown}");
    // From that cycle along another parameter.
    let result = folder.json("cycles --from cycles.json:AT1 --along p2=2.9:3.1");
    assert_eq!(result["parameters"]["p1"], 0.7);
    let start = result["points"].as_array().unwrap().iter().find(|point| point["value"] == 3.0).unwrap();
    close(&start["period"], 17.12989088, 1e-8);
}

#[test]
fn equilibria_in_every_format() {
    let folder = Folder::with("pp2.ode");
    let arguments = format!("{EQUILIBRIA} -q -o a.json -o a.csv -o a.parquet -o a.svg -o a.png -o a.pdf");
    assert_eq!(folder.succeed(&arguments), "");
    let csv = std::fs::read_to_string(folder.0.path().join("a.csv")).unwrap();
    assert!(csv.starts_with("label,value,stable,u1,u2,eigenvalue_1_real,"), "{csv}");
    let table = folder.succeed(EQUILIBRIA);
    assert!(table.contains("HB1") && table.contains("0.60478222"), "{table}");
}

#[test]
fn a_time_history() {
    let folder = Folder::with("vanderpol.ode");
    let result = folder.json("simulate vanderpol.ode --duration 20 --points 201 -o a.svg -o a.csv");
    let states = result["states"].as_object().unwrap();
    assert_eq!(result["t"].as_array().unwrap().len(), 201);
    assert!(states.values().all(|values| values.as_array().unwrap().len() == 201));
}

#[test]
fn models_that_make_no_sense() {
    let folder = Folder::with("pp2.ode");
    folder.fails("equilibria missing.ode --along p=0:1", 2, &["missing.ode", "cannot be read"]);
    std::fs::write(folder.0.path().join("typo.ode"), "x' = -gama*x\npar gamma=1\n").unwrap();
    folder.fails(
        "simulate typo.ode --duration 1",
        2,
        &["typo.ode: line 1, column 7", "did you mean `gamma`?", "x' = -gama*x", "^^^^"],
    );
    std::fs::write(folder.0.path().join("forced.ode"), "x' = -a*x + sin(t)\npar a=1\n").unwrap();
    folder.fails("equilibria forced.ode --along a=0:1", 2, &["forced.ode", "depends on the time", "^"]);
    folder.succeed("simulate forced.ode --duration 1");
}

#[test]
fn options_that_make_no_sense() {
    let folder = Folder::with("pp2.ode");
    folder.fails("equilibria pp2.ode --along p9=0:1", 2, &["--along p9", "nearest is `p", "p1, p2, p3, p4"]);
    folder.fails("equilibria pp2.ode --along p1=1:1", 2, &["empty interval"]);
    folder.fails("equilibria pp2.ode --along p1=0:inf", 2, &["p1", "infinite"]);
    folder.fails("equilibria pp2.ode --along p1=0:1 -s q=1", 2, &["--set q", "p1, p2, p3, p4"]);
    folder.fails("equilibria pp2.ode --along p1=0:1 -s p2=nan", 2, &["--set p2=nan", "finite"]);
    folder.fails("equilibria pp2.ode --along p1=0:1 --start z=1", 2, &["--start z", "u1, u2"]);
    folder.fails("equilibria pp2.ode --along p1=0:1 --at 2", 2, &["--at 2", "0 to 1"]);
    folder.fails("equilibria pp2.ode --along p1=0:1 -o a.txt", 2, &["a.txt", ".svg"]);
    folder.fails("simulate pp2.ode --duration 0", 2, &["--duration 0", "positive"]);
    folder.fails("show pp2.ode", 2, &["pp2.ode", "not a result file"]);
    folder.succeed(&format!("{EQUILIBRIA} -q -o equilibria.json"));
    folder.fails("cycles --from equilibria.json:LP1 --along p1=0:1", 2, &["equilibria.json", "HB1"]);
}
