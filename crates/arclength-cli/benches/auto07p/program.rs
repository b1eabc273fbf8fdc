//! The program `arclength` as a user runs it: commands that write result files.

use crate::cases::{Case, Curve, Kind};
use crate::{Cycle, REPORTED_STATES};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

/// The program with one model, in a directory of its own.
pub(crate) struct Program<'a> {
    pub(crate) directory: &'a Path,
    pub(crate) case: &'a Case,
    /// Names of the states.
    pub(crate) states: &'a [String],
}

impl Program<'_> {
    fn run(&self, arguments: &[String]) -> Result<(), String> {
        let output = Command::new(env!("CARGO_BIN_EXE_arclength"))
            .args(arguments)
            .current_dir(self.directory)
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .output()
            .map_err(|error| error.to_string())?;
        if output.status.success() {
            Ok(())
        } else {
            Err(String::from_utf8_lossy(&output.stderr).into_owned())
        }
    }

    fn read(&self, file: &str) -> Result<Value, String> {
        let text = std::fs::read_to_string(self.directory.join(file)).map_err(|error| error.to_string())?;
        serde_json::from_str(&text).map_err(|error| error.to_string())
    }

    /// The equilibria, from a file of the model.
    pub(crate) fn equilibria(&self) -> Result<(), String> {
        let case = self.case;
        std::fs::write(self.directory.join("model.ode"), &case.source).map_err(|error| error.to_string())?;
        let (low, high) = case.equilibria;
        let mut arguments = words(&["equilibria", "model.ode", "-q", "-o", "equilibria.json", "--along"]);
        arguments.push(format!("{}={low}:{high}", case.parameter));
        for (name, value) in case.set {
            arguments.extend(["--set".to_owned(), format!("{name}={value}")]);
        }
        if let Some(start) = case.start {
            let values = self.states.iter().zip(start).map(|(name, value)| format!("{name}={value}"));
            arguments.extend(["--start".to_owned(), values.collect::<Vec<_>>().join(",")]);
        }
        self.run(&arguments)
    }

    /// The cycles from the Hopf point of the equilibria.
    pub(crate) fn cycles(&self, tolerance: f64) -> Result<(), String> {
        let case = self.case;
        let (low, high) = case.cycles;
        let mut arguments = words(&["cycles", "-q", "-o", "cycles.json", "--from"]);
        arguments.push(format!("equilibria.json:HB{}", case.hopf + 1));
        arguments.extend(["--along".to_owned(), format!("{}={low}:{high}", case.parameter)]);
        arguments.push(format!("--at={}", list(case.values)));
        arguments.extend(["--tolerance".to_owned(), tolerance.to_string()]);
        self.run(&arguments)
    }

    /// The cycles that were asked for, in the result file, and the number of all others.
    pub(crate) fn found(&self) -> Result<(Vec<Cycle>, usize), String> {
        let result = self.read("cycles.json")?;
        let points = result["points"].as_array().ok_or("no points")?;
        let at = |value: &f64| {
            let point = points.iter().find(|point| point["value"].as_f64() == Some(*value));
            let point = point.ok_or_else(|| format!("no cycle at {value}"))?;
            Ok(Cycle {
                period: point["period"].as_f64().ok_or("no period")?,
                max: self
                    .states
                    .iter()
                    .take(REPORTED_STATES)
                    .filter_map(|name| point["max"][name].as_f64())
                    .collect(),
            })
        };
        let cycles = self.case.values.iter().map(at).collect::<Result<Vec<_>, String>>()?;
        Ok((cycles, points.len() - self.case.values.len()))
    }

    /// The curve of bifurcations, from the files of equilibria and cycles.
    pub(crate) fn curve(&self, curve: &Curve, tolerance: f64) -> Result<(), String> {
        let (name, (low, high)) = curve.second;
        let file = if curve.kind == Kind::Hopf { "equilibria.json" } else { "cycles.json" };
        let mut arguments = words(&["locus", "-q", "-o", "curve.json", "--from"]);
        arguments.push(format!("{file}:{}", curve.kind.label()));
        let first = format!("{}={}:{}", self.case.parameter, curve.first.0, curve.first.1);
        arguments.extend(["--in".to_owned(), format!("{first},{name}={low}:{high}")]);
        arguments.push(format!("--at={}", list(curve.values)));
        if curve.kind != Kind::Hopf {
            arguments.extend(["--tolerance".to_owned(), tolerance.to_string()]);
        }
        self.run(&arguments)
    }

    /// The second parameter where the first has the values that were asked for, and the number of all other points.
    pub(crate) fn second_parameters(&self, curve: &Curve) -> Result<(Vec<f64>, usize), String> {
        let result = self.read("curve.json")?;
        let points = result["points"].as_array().ok_or("no points")?;
        let at = |value: &f64| {
            let is_there = |point: &&Value| point["values"][0].as_f64() == Some(*value);
            let point = points.iter().find(is_there).ok_or_else(|| format!("no point at {value}"))?;
            point["values"][1].as_f64().ok_or_else(|| "no second parameter".to_owned())
        };
        let values = curve.values.iter().map(at).collect::<Result<Vec<_>, String>>()?;
        Ok((values, points.len() - curve.values.len()))
    }
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}
