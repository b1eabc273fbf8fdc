//! Every command in every format.

use crate::{Folder, read};
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;
use std::io::Read;
use std::process::{Command, Stdio};

const CHART: &str = "chart --x v=0:10:11 --y l=0.05:0.1:6";
const SIMULATE: &str = "simulate --duration 1 --perturb psi=0.1 --points 11";
const HOPF: &str = "hopf --along v=1:9";
const CYCLES: &str = "cycles --along v=6:9 --at 7";

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
}

/// Names of the columns, number of rows, and metadata.
fn parquet(path: &std::path::Path) -> (Vec<String>, usize, Vec<(String, String)>) {
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let file = reader.metadata().file_metadata();
    let columns = file.schema().get_fields().iter().map(|field| field.name().to_owned()).collect();
    let metadata = file.key_value_metadata().unwrap().iter();
    let metadata = metadata.map(|entry| (entry.key.clone(), entry.value.clone().unwrap())).collect();
    (columns, reader.get_row_iter(None).unwrap().map(Result::unwrap).count(), metadata)
}

#[test]
fn steady_has_the_fields_that_scripts_rely_on() {
    let result = Folder::new().json("steady -s v=5 -s r=inf");
    assert_eq!(result["schema"], serde_json::json!({"name": "kingpin.steady", "version": 1}));
    assert_eq!(result["parameters"]["r"], "inf");
    assert_eq!(result["parameters"]["v"], 5.0);
    assert_eq!(result["parameters"].as_object().unwrap().len(), 21);
    for key in ["u", "q", "psi", "V", "Omega", "residual", "friction_force", "normal_force"] {
        assert!(result[key].is_f64(), "{key}");
    }
    assert_eq!(result["rolls"], true);
    assert_eq!(result["V"], 5.0);
}

#[test]
fn stability_of_the_critical_speed() {
    let folder = Folder::new();
    let result = folder.json("stability");
    // w_crit(0.08 m), from the closed form.
    assert!((result["critical_yaw_rate"].as_f64().unwrap() - 8.43103697014).abs() < 1e-10);
    assert!((result["critical_speed"].as_f64().unwrap() - 8.43103697014).abs() < 1e-10);
    assert_eq!(result["stable"], true);
    let eigenvalues = result["eigenvalues"].as_array().unwrap();
    assert_eq!(eigenvalues.len(), 5);
    assert!(eigenvalues.iter().all(|pair| numbers(pair).len() == 2));
    assert_eq!(folder.json("stability -s v=9")["stable"], false);
    assert_eq!(folder.json("stability -s r=inf")["critical_speed"], Value::Null);
}

#[test]
fn chart_is_row_by_row_and_has_no_value_where_there_is_no_motion() {
    let result = Folder::new().json(CHART);
    assert_eq!(result["x"]["key"], "v");
    assert_eq!(numbers(&result["x"]["values"])[10], 10.0);
    assert_eq!(numbers(&result["y"]["values"]).len(), 6);
    let rates = result["growth_rate"].as_array().unwrap();
    assert_eq!(rates.len(), 66);
    assert_eq!(rates[0], Value::Null); // v = 0
    for (index, rate) in rates.iter().enumerate() {
        let stable = &result["stable"][index];
        assert_eq!(stable.as_bool().unwrap(), rate.as_f64().is_some_and(|rate| rate < 0.0));
    }
    // At l = 0.05 m the critical yaw rate is 5.02582345133 rad/s.
    assert_eq!([&result["stable"][5], &result["stable"][6]], [true, false]);
    for curve in result["stability_boundary"].as_array().unwrap() {
        assert!(curve.as_array().unwrap().len() > 10);
    }
    assert!(result["parameters"].get("v").is_none() && result["parameters"]["r"] == 1.0);
}

#[test]
fn simulate_has_a_list_per_state() {
    let result = Folder::new().json(SIMULATE);
    assert_eq!(numbers(&result["t"])[10], 1.0);
    for key in ["u", "q", "psi", "V", "Omega", "friction_force", "normal_force"] {
        assert_eq!(numbers(&result[key]).len(), 11, "{key}");
    }
    assert!(result["rolling_lost_at"].as_f64().unwrap() < 0.1);
}

#[test]
fn csv_and_parquet_have_the_same_columns() {
    for command in ["steady", "stability", CHART, SIMULATE, HOPF, CYCLES] {
        let folder = Folder::new();
        let run = folder.succeed(&format!("{command} --format csv -o result.parquet -o result.csv"));
        assert_eq!(run.output.as_bytes(), read(&folder.path("result.csv")));
        let mut lines = run.output.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let (columns, rows, metadata) = parquet(&folder.path("result.parquet"));
        assert_eq!(names, columns, "{command}");
        assert_eq!(rows, lines.clone().count(), "{command}");
        assert!(lines.all(|line| line.split(',').count() == names.len()));
        assert_eq!(metadata[0].0, "schema");
        assert!(metadata[1].1.contains("\"l_c\":0.012"), "{metadata:?}");
        let units: Value = serde_json::from_str(&metadata[2].1).unwrap();
        let first = if command == HOPF { "frequency" } else { names[usize::from(command == CYCLES) * 3] };
        assert!(units[first].is_string() && metadata[2].0 == "units", "{command}: {units}");
        assert_eq!(folder.files(), ["result.csv", "result.parquet"]);
    }
}

#[test]
fn files_of_data_and_pictures() {
    for command in [CHART, SIMULATE, CYCLES] {
        let folder = Folder::new();
        let run = folder.succeed(&format!("{command} -q -o a.svg -o a.PNG -o a.pdf -o a.json"));
        assert_eq!((run.output.as_str(), run.messages.as_str()), ("", ""));
        assert!(read(&folder.path("a.svg")).starts_with(b"<svg"));
        assert!(read(&folder.path("a.PNG")).starts_with(b"\x89PNG"));
        assert!(read(&folder.path("a.pdf")).starts_with(b"%PDF"));
        let json: Value = serde_json::from_slice(&read(&folder.path("a.json"))).unwrap();
        assert_eq!(json["schema"]["version"], 1);
        assert_eq!(folder.files().len(), 4);
    }
}

#[test]
fn the_same_bytes_at_any_number_of_threads() {
    let folder = Folder::new();
    let chart = "chart --x v=0.1:12:300 --y l=0.02:0.3:200 -q";
    folder.succeed(&format!("{chart} --threads 1 -o one.json -o one.parquet -o one.svg"));
    folder.succeed(&format!("{chart} --threads 2 -o two.json -o two.parquet -o two.svg"));
    for ending in ["json", "parquet", "svg"] {
        let [one, two] = ["one", "two"].map(|name| read(&folder.path(&format!("{name}.{ending}"))));
        assert!(one == two, "{ending}");
    }
}

#[test]
fn an_existing_file_is_replaced() {
    let folder = Folder::new();
    std::fs::write(folder.path("a.json"), "old").unwrap();
    folder.succeed("steady -o a.json");
    assert!(read(&folder.path("a.json")).starts_with(b"{\n  \"schema\""));
}

#[test]
fn a_reader_that_stops_reading_ends_the_program_quietly() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_kingpin"))
        .args(["chart", "--x", "v=0.1:12:400", "--y", "l=0.02:0.3:200", "--format", "csv"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut start = [0; 10];
    child.stdout.take().unwrap().read_exact(&mut start).unwrap(); // and closes it
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
}

#[test]
fn a_wheel_file_is_read_and_overridden() {
    let folder = Folder::new();
    std::fs::write(folder.path("wheel.toml"), "l = 0.1 # m\nk = 200\nr = inf\n").unwrap();
    let result = folder.json("steady --wheel wheel.toml -s l=0.2 -s k_u=300");
    let parameters = &result["parameters"];
    assert_eq!([&parameters["l"], &parameters["k_q"], &parameters["k_u"]], [0.2, 200.0, 300.0]);
    assert_eq!(parameters["r"], "inf");
}

#[test]
fn a_radius_that_reaches_infinity_varies_as_a_curvature() {
    let folder = Folder::new();
    let run = folder.succeed("chart --x r=0.5:inf:5 --y l=0.05:0.1:3 --format json");
    assert!(run.messages.contains("curvature = 1/r varies instead, from 0 to 2 1/m"), "{}", run.messages);
    let result: Value = serde_json::from_str(&run.output).unwrap();
    assert_eq!(result["x"]["key"], "curvature");
    assert_eq!(numbers(&result["x"]["values"]), [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert!(result["parameters"].get("r").is_none());
}

#[test]
fn histories_with_sliding_have_seven_states_and_phases() {
    let folder = Folder::new();
    let kicked =
        "simulate --contact sliding --duration 1 --points 201 --perturb psi=1.2 -s F_Az=-100 -s v=8.4";
    folder.succeed(&format!("{kicked} -q -o a.csv -o a.svg"));
    let history = folder.json(&format!("{kicked} -q"));
    let list = |name: &str| history[name].as_array().unwrap().clone();
    let number = |name: &str, index: usize| list(name)[index].as_f64().unwrap();
    for name in
        ["t", "u", "q", "psi", "V1", "V2", "Omega", "W", "slip", "friction_force", "normal_force", "phase"]
    {
        assert_eq!(list(name).len(), 201, "{name}");
    }
    let (normal, phases) = (number("normal_force", 0), list("phase"));
    assert!((normal - 104.107_447).abs() < 1e-6);
    for (index, phase) in phases.iter().enumerate() {
        let slip = (number("V1", index) - number("W", index)).hypot(number("V2", index));
        assert!((slip - number("slip", index)).abs() < 1e-12);
        if phase == "rolling" {
            assert!(slip < 1e-12 && number("friction_force", index) <= normal * (1.0 + 1e-9));
        } else if slip > 1e-3 {
            // Coulomb's law: mu_d N whatever the slip.
            assert!((number("friction_force", index) / (0.8 * normal) - 1.0).abs() < 1e-9);
        }
    }
    assert!(phases.contains(&"rolling".into()) && phases.contains(&"sliding".into()));
    let header = String::from_utf8(read(&folder.path("a.csv"))).unwrap();
    assert!(header.starts_with(
        "t,u,q,psi,V1,V2,Omega,W,slip,friction_force,normal_force,phase,king_pin_force,damper_power\n"
    ));
    // Without a kick and with friction enough it rolls as without the option.
    let gentle = "--duration 1 --points 11 --perturb psi=0.01 -s r=inf -s v=2";
    let rolls = folder.json(&format!("simulate {gentle} -q"));
    let holds = folder.json(&format!("simulate --contact sliding {gentle} -q"));
    for (one, other) in [("psi", "psi"), ("V", "V1"), ("V", "W"), ("Omega", "Omega")] {
        for index in 0..11 {
            let difference = rolls[one][index].as_f64().unwrap() - holds[other][index].as_f64().unwrap();
            assert!(difference.abs() < 1e-7, "{one} {index}: {difference}");
        }
    }
    let unknown = folder.run("simulate --contact sliding --duration 1 --perturb V3=1");
    assert!(unknown.exit_code == 2 && unknown.messages.contains("V1, V2, Omega, W, V"));
}
