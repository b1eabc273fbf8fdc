//! AUTO-07p with one model, compiled and run in a directory of its own.

use crate::cases::{Case, Curve, Kind};
use crate::fortran::fortran;
use crate::{Cycle, REPORTED_STATES};
use arclength_ode::Model;
use std::path::Path;
use std::process::{Command, Stdio};

/// Where the Debian package has the objects that every program is linked with.
pub(crate) const AUTO: &str = "/usr/lib/auto-07p/lib";

/// AUTO with one model.
pub(crate) struct Auto<'a> {
    directory: &'a Path,
    case: &'a Case,
    dimension: usize,
    /// Constants of the run along the equilibria.
    towards_hopf: String,
    /// The result file of that run, and the label of the Hopf point.
    equilibria: Vec<u8>,
    label: usize,
}

/// What a run along the cycles found.
pub(crate) struct Found {
    pub(crate) points: usize,
    pub(crate) cycles: Vec<Cycle>,
}

impl<'a> Auto<'a> {
    /// Compiles the model with some parameters active, and finds the Hopf point.
    ///
    /// # Errors
    /// What failed.
    pub(crate) fn build(
        directory: &'a Path,
        case: &'a Case,
        model: &Model,
        equilibrium: &[f64],
        parameters: &[f64],
        active: &[usize],
    ) -> Result<Self, String> {
        let program = fortran(model, &case.source, equilibrium, parameters, active);
        std::fs::write(directory.join("model.f90"), program).map_err(|error| error.to_string())?;
        let build = "gfortran -O3 -fopenmp -fdefault-real-8 -fdefault-double-8 -std=legacy -ffree-line-length-none \
                     model.f90 -o model -I /usr/include";
        let output =
            Command::new("sh").args(["-c", &format!("{build} {AUTO}/*.o")]).current_dir(directory).output();
        let output = output.map_err(|error| error.to_string())?;
        if !output.status.success() {
            return Err(format!("gfortran: {}", String::from_utf8_lossy(&output.stderr)));
        }
        // Towards the Hopf point from a little beside it.
        let step = 2e-3 * (case.equilibria.1 - case.equilibria.0);
        let start = parameters[active[0]];
        let (low, high) = (start - 10.0 * step, start + 10.0 * step);
        let towards_hopf = format!(
            "IPS=1, IRS=0, ICP=[1], NTST=50, NCOL=4, ISP=1, ILP=0, NMX=500, NPR=1000, EPSL=1e-10, EPSU=1e-10, EPSS=1e-8, \
             DS={step:e}, DSMIN={:e}, DSMAX={step:e}, IADS=1, UZSTOP={{1:[{low:e},{high:e}]}}",
            1e-3 * step
        );
        let dimension = model.states().len();
        let mut auto = Self { directory, case, dimension, towards_hopf, equilibria: Vec::new(), label: 0 };
        auto.run_equilibria()?;
        auto.equilibria = std::fs::read(directory.join("fort.8")).map_err(|error| error.to_string())?;
        auto.label = auto
            .rows()?
            .into_iter()
            .find(|row| row[2] == Kind::Hopf.code())
            .map(|row| row[3] as usize)
            .ok_or("AUTO found no Hopf point")?;
        Ok(auto)
    }

    fn constants(&self, switch: u8, text: &str) -> Result<(), String> {
        let common = format!(
            "NDIM={}, IAD=3, ISW={switch}, IPLT=0, NBC=0, NINT=0, MXBF=0, IID=0, ITMX=8, ITNW=7, NWTN=3, JAC=0, THL={{}}, THU={{}}, ",
            self.dimension
        );
        let constants = (common + text).replace(", ", "\n") + "\n";
        std::fs::write(self.directory.join("fort.2"), constants).map_err(|error| error.to_string())
    }

    fn execute(&self) -> Result<(), String> {
        let output = Command::new("./model")
            .current_dir(self.directory)
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .output()
            .map_err(|error| error.to_string())?;
        if output.status.success() { Ok(()) } else { Err("AUTO failed".into()) }
    }

    fn start_from(&self, solutions: &[u8]) -> Result<(), String> {
        std::fs::write(self.directory.join("fort.3"), solutions).map_err(|error| error.to_string())
    }

    fn solutions(&self) -> Result<Vec<u8>, String> {
        std::fs::read(self.directory.join("fort.8")).map_err(|error| error.to_string())
    }

    /// Numbers of the rows of the branch file.
    fn rows(&self) -> Result<Vec<Vec<f64>>, String> {
        let text =
            std::fs::read_to_string(self.directory.join("fort.7")).map_err(|error| error.to_string())?;
        let row = |line: &str| {
            let numbers: Option<Vec<f64>> =
                line.split_whitespace().map(|word| word.replace(['D', 'd'], "E").parse().ok()).collect();
            numbers.filter(|numbers| numbers.len() > 4 && numbers[0] != 0.0)
        };
        Ok(text.lines().filter_map(row).collect())
    }

    /// The run along the equilibria, with its files.
    ///
    /// # Errors
    /// What failed.
    pub(crate) fn run_equilibria(&self) -> Result<(), String> {
        self.constants(1, &self.towards_hopf)?;
        self.execute()
    }

    /// The run along the cycles from the Hopf point, with its files. It goes round closed branches and back from Hopf points until
    /// `most_points`.
    ///
    /// # Errors
    /// What failed.
    pub(crate) fn run_cycles(
        &self,
        intervals: usize,
        largest_step: f64,
        most_points: usize,
    ) -> Result<(), String> {
        self.start_from(&self.equilibria)?;
        let (low, high) = self.case.cycles;
        let values: Vec<String> = self.case.values.iter().map(|value| format!("{value:e}")).collect();
        self.constants(
            1,
            &format!(
                "IPS=2, IRS={}, ICP=[1,11], NTST={intervals}, NCOL=4, ISP=2, ILP=1, NMX={most_points}, NPR=100000, EPSL=1e-8, \
                 EPSU=1e-8, EPSS=1e-6, DS={:e}, DSMIN=1e-8, DSMAX={largest_step:e}, IADS=1, UZR={{1:[{}]}}, \
                 UZSTOP={{1:[{low:e},{high:e}]}}",
                self.label,
                0.1 * largest_step,
                values.join(",")
            ),
        )?;
        self.execute()
    }

    /// What the last run along the cycles found.
    ///
    /// # Errors
    /// That its file cannot be read.
    pub(crate) fn found(&self) -> Result<Found, String> {
        let all = self.rows()?;
        let reported = self.dimension.min(REPORTED_STATES);
        let cycles = self.case.values.iter().filter_map(|value| {
            let near =
                |row: &&Vec<f64>| row[2] == -4.0 && (row[4] - value).abs() < 1e-6 * (1.0 + value.abs());
            let row = all.iter().find(near)?;
            // PT, TY, LAB and so on, PAR(1), L2-NORM, then the largest values, and the period last.
            Some(Cycle { period: *row.last()?, max: row.get(6..6 + reported)?.to_vec() })
        });
        let cycles = cycles.collect();
        Ok(Found { points: all.len().saturating_sub(self.case.values.len()), cycles })
    }

    /// What a curve of bifurcations starts from: solutions, and a label in them.
    ///
    /// # Errors
    /// What failed.
    pub(crate) fn start_of_curve(&self, kind: Kind) -> Result<(Vec<u8>, usize), String> {
        if kind == Kind::Hopf {
            return Ok((self.equilibria.clone(), self.label));
        }
        self.run_cycles(50, 0.2, 500)?;
        let found = self.rows()?.into_iter().find(|row| row[2] == kind.code());
        let label = found.ok_or("AUTO found no bifurcation of cycles")?[3] as usize;
        Ok((self.solutions()?, label))
    }

    /// The curve of bifurcations both ways, with its files: of cycles a run that makes the start of it, and one in each direction.
    /// Returns the second parameter where the first has the values that are compared, and the number of all other points.
    ///
    /// # Errors
    /// What failed.
    pub(crate) fn run_curve(
        &self,
        curve: &Curve,
        start: &(Vec<u8>, usize),
        (intervals, largest_step): (usize, f64),
    ) -> Result<(Vec<f64>, usize), String> {
        let of_cycles = curve.kind != Kind::Hopf;
        let (mut solutions, mut label) = start.clone();
        let values: Vec<String> = curve.values.iter().map(|value| format!("{value:e}")).collect();
        let ((a, b), (_, (c, d))) = (curve.first, curve.second);
        let run = |solutions: &[u8], label: usize, step: f64, searching: bool| {
            self.start_from(solutions)?;
            let icp = if of_cycles { "[1,2,11]" } else { "[1,2]" };
            let at = if searching { format!(", UZR={{1:[{}]}}", values.join(",")) } else { String::new() };
            self.constants(
                2,
                &format!(
                    "IPS={}, IRS={label}, ICP={icp}, NTST={intervals}, NCOL=4, ISP=2, ILP=0, NMX=2000, NPR=100000, EPSL=1e-8, \
                     EPSU=1e-8, EPSS=1e-6, DS={step:e}, DSMIN=1e-8, DSMAX={largest_step:e}, IADS=1, \
                     UZSTOP={{1:[{a:e},{b:e}],2:[{c:e},{d:e}]}}{at}",
                    if of_cycles { 2 } else { 1 }
                ),
            )?;
            self.execute()?;
            self.rows()
        };
        if of_cycles {
            let rows = run(&solutions, label, 0.1 * largest_step, false)?;
            label = rows.last().ok_or("AUTO did not start the curve")?[3] as usize;
            solutions = self.solutions()?;
        }
        let (mut found, mut points) = (vec![None; curve.values.len()], 0);
        for sign in [1.0, -1.0] {
            let rows = run(&solutions, label, sign * 0.1 * largest_step, true)?;
            points += rows.len();
            for (value, found) in curve.values.iter().zip(&mut found) {
                let near = |row: &&Vec<f64>| {
                    row[2] % 10.0 == -4.0 && (row[4] - value).abs() < 1e-6 * (1.0 + value.abs())
                };
                let row = rows.iter().find(near);
                let second = row.map(|row| row[row.len() - if of_cycles { 2 } else { 1 }]);
                *found = found.or(second);
            }
        }
        let found: Option<Vec<f64>> = found.into_iter().collect();
        let found = found.ok_or("AUTO does not reach the values")?;
        Ok((found, points - curve.values.len()))
    }
}
