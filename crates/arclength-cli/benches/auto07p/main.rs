//! Branches of limit cycles of the gallery's models, side by side with AUTO-07p, on one thread.
//!
//! Both programs start at the same Hopf point and follow the same branch over the same range; compared are two quantities of
//! the bifurcation diagram at the parameter values named. In the first table the period has to be right to 1e-6; in the
//! second it and the largest value of every state to 1e-5 of its amplitude (AUTO reports the largest value at a mesh point).
//! This program runs with the fastest of its tolerances that reach it, AUTO with the fewest mesh intervals from 10 on (of 4
//! collocation points) and with the largest step that gives about as many points. The time is that of the continuation of
//! cycles, with multipliers and bifurcations: the best of several runs. AUTO's right-hand sides are compiled Fortran, ours
//! the .ode files as they are.
//!
//! Names of models after `--` select those. Needs the Debian packages `auto-07p` and `gfortran`; says so and stops where they are missing.

use arclength::cycle::{CycleBranch, CycleStart, Cycles, Resolution};
use arclength::equilibrium::{Equilibria, HopfPoint, find_equilibrium};
use arclength_ode::Model;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const AUTO: &str = "/usr/lib/auto-07p/lib";
const RUNS: usize = 15;
/// To choose the tolerance.
const SHORT_RUNS: usize = 3;
/// A state with an amplitude below this part of its value rests; its value is then what the error is measured by.
const RESTING: f64 = 1e-3;

/// What is compared.
#[derive(Clone, Copy, PartialEq)]
enum Measure {
    Period,
    PeriodAndMaxima,
}

impl Measure {
    /// Relative error that both have to reach.
    fn accuracy(self) -> f64 {
        match self {
            Self::Period => 1e-6,
            Self::PeriodAndMaxima => 1e-5,
        }
    }
}

/// Period and largest values at one parameter value.
#[derive(Clone)]
struct Cycle {
    period: f64,
    max: Vec<f64>,
}

struct Case {
    model: &'static str,
    parameter: &'static str,
    set: &'static [(&'static str, f64)],
    /// Start of the search for the equilibrium, in place of the model's own.
    start: Option<&'static [f64]>,
    /// Range of the equilibria, which holds the Hopf point wanted, counted from zero.
    equilibria: (f64, f64),
    hopf: usize,
    /// Range of the cycles.
    cycles: (f64, f64),
    /// Values at which the period is compared.
    values: &'static [f64],
}

const CASES: [Case; 11] = [
    Case {
        model: "towed_wheel",
        parameter: "v",
        set: &[("l", 0.08), ("v", 9.0)],
        start: None,
        equilibria: (8.0, 9.0),
        hopf: 0,
        cycles: (0.2, 9.0),
        values: &[1.0, 2.0, 4.0, 6.0, 8.0],
    },
    Case {
        model: "lure",
        parameter: "alpha",
        set: &[],
        start: None,
        equilibria: (0.5, 2.0),
        hopf: 0,
        cycles: (-0.9, 1.1),
        values: &[0.8, 0.4, 0.0, -0.4],
    },
    Case {
        model: "ab",
        parameter: "D",
        set: &[],
        start: None,
        equilibria: (0.0, 0.4),
        hopf: 0,
        cycles: (0.1, 0.4),
        values: &[0.2, 0.25, 0.3],
    },
    Case {
        model: "pp2",
        parameter: "p1",
        set: &[("p1", 0.65)],
        start: Some(&[0.33, 0.42]),
        equilibria: (0.65, 0.8),
        hopf: 0,
        cycles: (0.6, 0.71),
        values: &[0.68, 0.70],
    },
    Case {
        model: "lorenz",
        parameter: "rho",
        set: &[("rho", 20.0)],
        start: Some(&[7.0, 7.0, 19.0]),
        equilibria: (15.0, 30.0),
        hopf: 0,
        cycles: (14.5, 26.0),
        values: &[23.0, 20.0, 17.0],
    },
    Case {
        model: "brusselator",
        parameter: "b",
        set: &[],
        start: None,
        equilibria: (1.0, 3.0),
        hopf: 0,
        cycles: (1.5, 5.0),
        values: &[2.5, 3.0, 4.0],
    },
    Case {
        model: "fitzhugh_nagumo",
        parameter: "i0",
        set: &[],
        start: None,
        equilibria: (0.0, 1.0),
        hopf: 0,
        cycles: (0.0, 1.2),
        values: &[0.5, 0.8, 1.1],
    },
    Case {
        model: "langford",
        parameter: "lambda",
        set: &[("lambda", 1.5)],
        start: Some(&[0.0, 0.0, 1.5]),
        equilibria: (1.0, 2.2),
        hopf: 0,
        cycles: (1.0, 2.2),
        values: &[1.8, 1.9],
    },
    Case {
        model: "hodgkin_huxley",
        parameter: "i0",
        set: &[],
        start: None,
        equilibria: (0.0, 20.0),
        hopf: 0,
        cycles: (0.0, 200.0),
        values: &[20.0, 60.0, 120.0],
    },
    Case {
        model: "morris_lecar",
        parameter: "iapp",
        set: &[],
        start: None,
        equilibria: (0.0, 120.0),
        hopf: 0,
        cycles: (50.0, 300.0),
        values: &[120.0, 160.0, 200.0],
    },
    Case {
        model: "bautin",
        parameter: "beta1",
        set: &[],
        start: None,
        equilibria: (-1.0, 1.0),
        hopf: 0,
        cycles: (-1.0, 1.0),
        values: &[0.2, 0.5, 0.8],
    },
];

fn main() {
    if !Path::new(AUTO).is_dir() || Command::new("gfortran").arg("--version").output().is_err() {
        println!("skipped: AUTO-07p or gfortran is not installed (Debian packages auto-07p, gfortran)");
        return;
    }
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for (title, measure) in
        [("period to 1e-6", Measure::Period), ("period and largest values to 1e-5", Measure::PeriodAndMaxima)]
    {
        println!("\n{title}");
        println!(
            "{:16} {:>9} {:>7} {:>9} {:>9} {:>7} {:>5} {:>9} {:>9} {:>7}",
            "model", "tolerance", "points", "error", "time/ms", "points", "NTST", "error", "AUTO/ms", "ratio"
        );
        for case in
            CASES.iter().filter(|case| wanted.is_empty() || wanted.iter().any(|name| name == case.model))
        {
            if let Err(problem) = compare(case, measure) {
                println!("{:16} {problem}", case.model);
            }
        }
    }
}

fn compare(case: &Case, measure: Measure) -> Result<(), String> {
    let path = format!("{}/../../gallery/models/{}.ode", env!("CARGO_MANIFEST_DIR"), case.model);
    let source = std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))?;
    let model = Model::parse(&source).map_err(|error| error.to_string())?;
    let mut parameters = model.default_parameters().to_vec();
    for (name, value) in case.set {
        parameters[model.parameter_index(name).ok_or("no such parameter")?] = *value;
    }
    let active = model.parameter_index(case.parameter).ok_or("no such parameter")?;
    let start = if (case.equilibria.0..=case.equilibria.1).contains(&parameters[active]) {
        parameters[active]
    } else {
        case.equilibria.0
    };
    parameters[active] = start;
    let branch = Equilibria::of(&model)
        .start(&case.start.map_or_else(|| model.initial_state(&parameters), <[f64]>::to_vec))
        .parameters(&parameters)
        .along(case.parameter, case.equilibria.0..=case.equilibria.1)
        .run()
        .map_err(|error| error.to_string())?;
    let hopf = branch.hopf_points().nth(case.hopf).ok_or("no Hopf point")?.clone();
    parameters[active] = hopf.value;

    let run = |tolerance: f64| follow(case, &model, &hopf, &parameters, tolerance);
    let reference = run(1e-10)?;
    let exact = cycles_at(case, &reference)?;
    let amplitudes: Vec<Vec<f64>> = case
        .values
        .iter()
        .filter_map(|value| reference.points.iter().find(|point| point.value == *value))
        .map(|point| {
            point
                .max
                .iter()
                .zip(&point.min)
                .map(|(max, min)| (0.5 * (max - min)).max(RESTING * max.abs()))
                .collect()
        })
        .collect();
    let worst = |found: &[Cycle]| {
        let mut worst = 0.0_f64;
        for ((cycle, exact), amplitudes) in found.iter().zip(&exact).zip(&amplitudes) {
            worst = worst.max((cycle.period / exact.period - 1.0).abs());
            if measure == Measure::PeriodAndMaxima {
                let maxima = cycle.max.iter().zip(&exact.max).zip(amplitudes);
                let errors = maxima.map(|((max, exact), amplitude)| (max - exact).abs() / amplitude);
                worst = errors.fold(worst, f64::max);
            }
        }
        worst
    };
    let mut ours: Option<(f64, usize, f64, Duration)> = None;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let mut time = Duration::MAX;
        let mut branch = run(tolerance)?;
        for _ in 0..SHORT_RUNS {
            let start = Instant::now();
            branch = run(tolerance)?;
            time = time.min(start.elapsed());
        }
        let error = worst(&cycles_at(case, &branch)?);
        if error <= measure.accuracy() && ours.is_none_or(|(_, _, _, fastest)| time < fastest) {
            ours = Some((tolerance, branch.points.len() - case.values.len(), error, time));
        }
    }
    let (tolerance, points, error, _) = ours.ok_or("no tolerance reaches the accuracy")?;

    // A little beside the Hopf point, so that AUTO's run along the equilibria passes it.
    let mut beside = parameters.clone();
    beside[active] -= 5e-3 * (case.equilibria.1 - case.equilibria.0);
    let equilibrium = find_equilibrium(&model, &hopf.state, &beside).map_err(|error| error.to_string())?;
    let directory = tempfile::tempdir().map_err(|error| error.to_string())?;
    let auto = Auto::build(directory.path(), case, &model, &source, &equilibrium, &beside, active)?;
    let most_points = 4 * points + 100;
    let (largest_step, _) = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .filter_map(|step| {
            let result = auto.run(50, step, most_points).ok()?;
            (result.cycles.len() == exact.len()).then_some((step, result.points.abs_diff(points)))
        })
        .min_by_key(|(_, difference)| *difference)
        .ok_or("AUTO does not reach the values")?;
    let mut theirs = None;
    let mut best = f64::INFINITY;
    for intervals in [10, 15, 20, 30, 50, 75, 100, 150, 200, 300, 500, 700, 1000] {
        let Ok(result) = auto.run(intervals, largest_step, most_points) else { continue };
        let error = if result.cycles.len() == exact.len() { worst(&result.cycles) } else { f64::INFINITY };
        best = best.min(error);
        if result.cycles.len() == exact.len() && error <= measure.accuracy() {
            theirs = Some((intervals, result.points, error));
            break;
        }
    }
    let (intervals, auto_points, auto_error) =
        theirs.ok_or_else(|| format!("AUTO does not come closer than {best:.1e}"))?;
    // By turns, so that both meet the same load of the machine.
    let (mut time, mut auto_time) = (Duration::MAX, Duration::MAX);
    for _ in 0..RUNS {
        let start = Instant::now();
        run(tolerance)?;
        time = time.min(start.elapsed());
        auto_time = auto_time.min(auto.run(intervals, largest_step, most_points)?.time);
    }
    println!(
        "{:16} {tolerance:9.0e} {points:7} {error:9.1e} {:9.2} {auto_points:7} {intervals:5} {auto_error:9.1e} {:9.2} {:7.1}",
        case.model,
        1e3 * time.as_secs_f64(),
        1e3 * auto_time.as_secs_f64(),
        auto_time.as_secs_f64() / time.as_secs_f64(),
    );
    Ok(())
}

fn follow(
    case: &Case,
    model: &Model,
    hopf: &HopfPoint,
    parameters: &[f64],
    tolerance: f64,
) -> Result<CycleBranch, String> {
    Cycles::of(model, CycleStart::from(hopf))
        .parameters(parameters)
        .along(case.parameter, case.cycles.0..=case.cycles.1)
        .at(case.values)
        .resolution(Resolution::with_tolerance(tolerance))
        .run()
        .map_err(|error| error.to_string())
}

/// The cycle at each value, at the first passage.
fn cycles_at(case: &Case, branch: &CycleBranch) -> Result<Vec<Cycle>, String> {
    case.values
        .iter()
        .map(|value| {
            let found = branch.points.iter().find(|point| point.value == *value);
            found
                .map(|point| Cycle { period: point.period, max: point.max.clone() })
                .ok_or_else(|| format!("no cycle at {value}: {:?}", branch.stops))
        })
        .collect()
}

/// AUTO with one model, in a directory of its own.
struct Auto<'a> {
    directory: &'a Path,
    case: &'a Case,
    dimension: usize,
    /// The result file of the run along the equilibria, and the label of the Hopf point.
    equilibria: Vec<u8>,
    label: usize,
}

struct AutoResult {
    points: usize,
    cycles: Vec<Cycle>,
    time: Duration,
}

impl<'a> Auto<'a> {
    fn build(
        directory: &'a Path,
        case: &'a Case,
        model: &Model,
        source: &str,
        equilibrium: &[f64],
        parameters: &[f64],
        active: usize,
    ) -> Result<Self, String> {
        let program = fortran(model, source, equilibrium, parameters, active);
        let write = |name: &str, text: &str| {
            std::fs::write(directory.join(name), text).map_err(|error| error.to_string())
        };
        write("model.f90", &program)?;
        let build = "gfortran -O3 -fopenmp -fdefault-real-8 -fdefault-double-8 -std=legacy -ffree-line-length-none \
                     model.f90 -o model -I /usr/include";
        let build = format!("{build} {AUTO}/*.o");
        let output = Command::new("sh").args(["-c", &build]).current_dir(directory).output();
        let output = output.map_err(|error| error.to_string())?;
        if !output.status.success() {
            return Err(format!("gfortran: {}", String::from_utf8_lossy(&output.stderr)));
        }
        let mut auto =
            Self { directory, case, dimension: model.states().len(), equilibria: Vec::new(), label: 0 };
        // Towards the Hopf point from a little beside it.
        let step = 2e-3 * (case.equilibria.1 - case.equilibria.0);
        let (low, high) = (parameters[active] - 10.0 * step, parameters[active] + 10.0 * step);
        auto.constants(&format!(
            "IPS=1, IRS=0, ICP=[1], NTST=50, NCOL=4, ISP=1, ILP=0, NMX=500, NPR=1000, EPSL=1e-10, EPSU=1e-10, EPSS=1e-8, \
             DS={step:e}, DSMIN={:e}, DSMAX={step:e}, IADS=1, UZSTOP={{1:[{low:e},{high:e}]}}",
            1e-3 * step
        ))?;
        auto.execute()?;
        auto.equilibria = std::fs::read(directory.join("fort.8")).map_err(|error| error.to_string())?;
        let branch = std::fs::read_to_string(directory.join("fort.7")).map_err(|error| error.to_string())?;
        auto.label = rows(&branch)
            .find(|row| row[2] == 3.0)
            .map(|row| row[3] as usize)
            .ok_or("AUTO found no Hopf point")?;
        Ok(auto)
    }

    fn constants(&self, text: &str) -> Result<(), String> {
        let common = "IAD=3, ISW=1, IPLT=0, NBC=0, NINT=0, MXBF=0, IID=0, ITMX=8, ITNW=7, NWTN=3, JAC=0, THL={}, THU={}";
        let constants = format!("NDIM={}, {common}\n{}\n", self.dimension, text.replace(", ", "\n"));
        let constants = constants.replace(", ", "\n");
        std::fs::write(self.directory.join("fort.2"), constants).map_err(|error| error.to_string())
    }

    /// Runs the program; the processor time is what it says itself.
    fn execute(&self) -> Result<Duration, String> {
        let start = Instant::now();
        let output = Command::new("./model")
            .current_dir(self.directory)
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .output()
            .map_err(|error| error.to_string())?;
        let elapsed = start.elapsed();
        if !output.status.success() {
            return Err("AUTO failed".into());
        }
        Ok(elapsed)
    }

    /// It goes round closed branches and back from Hopf points until `most_points`.
    fn run(&self, intervals: usize, largest_step: f64, most_points: usize) -> Result<AutoResult, String> {
        std::fs::write(self.directory.join("fort.3"), &self.equilibria).map_err(|error| error.to_string())?;
        let (low, high) = self.case.cycles;
        let values: Vec<String> = self.case.values.iter().map(|value| format!("{value:e}")).collect();
        self.constants(&format!(
            "IPS=2, IRS={}, ICP=[1,11], NTST={intervals}, NCOL=4, ISP=2, ILP=1, NMX={most_points}, NPR=100000, EPSL=1e-8, \
             EPSU=1e-8, EPSS=1e-6, DS={:e}, DSMIN=1e-8, DSMAX={largest_step:e}, IADS=1, UZR={{1:[{}]}}, \
             UZSTOP={{1:[{low:e},{high:e}]}}",
            self.label,
            0.1 * largest_step,
            values.join(",")
        ))?;
        let time = self.execute()?;
        let branch =
            std::fs::read_to_string(self.directory.join("fort.7")).map_err(|error| error.to_string())?;
        let all: Vec<Vec<f64>> = rows(&branch).collect();
        let cycles = self
            .case
            .values
            .iter()
            .filter_map(|value| {
                let near =
                    |row: &&Vec<f64>| row[2] == -4.0 && (row[4] - value).abs() < 1e-6 * (1.0 + value.abs());
                let row = all.iter().find(near)?;
                // PT, TY, LAB and so on, PAR(1), L2-NORM, then the largest values, and the period last.
                Some(Cycle { period: *row.last()?, max: row.get(6..6 + self.dimension)?.to_vec() })
            })
            .collect();
        Ok(AutoResult { points: all.len() - self.case.values.len(), cycles, time })
    }
}

/// Numbers of the rows of a branch file.
fn rows(text: &str) -> impl Iterator<Item = Vec<f64>> + '_ {
    text.lines().filter_map(|line| {
        let numbers: Option<Vec<f64>> =
            line.split_whitespace().map(|word| word.replace(['D', 'd'], "E").parse().ok()).collect();
        numbers.filter(|numbers| numbers.len() > 4 && numbers[0] != 0.0)
    })
}

/// The model as AUTO's equations file. The gallery's files use little of the language of .ode files.
fn fortran(model: &Model, source: &str, equilibrium: &[f64], parameters: &[f64], active: usize) -> String {
    let statements: Vec<String> = source
        .lines()
        .map(|line| line.replace('^', "**").replace("ln(", "log("))
        .filter(|line| line.contains('=') && !line.starts_with(['#', '@']))
        .filter(|line| !["par ", "init", "set ", "aux ", "number "].iter().any(|word| line.starts_with(word)))
        .filter(|line| !line.contains("(0)"))
        .collect();
    let mut functions = String::new();
    let mut body = String::new();
    let mut names: Vec<String> = model.parameters().to_vec();
    for line in &statements {
        let (left, right) = line.split_once('=').unwrap_or_default();
        let (left, right) = (left.trim().trim_start_matches('!'), right.trim());
        if let Some(state) = left.strip_suffix('\'') {
            let index = model.state_index(state).unwrap_or_default() + 1;
            let _ = writeln!(body, "  auto_f({index}) = {right}");
        } else if let Some((name, arguments)) = left.split_once('(') {
            names.push(name.to_owned());
            let _ = writeln!(functions, "  {name}({arguments} = {right}");
        } else {
            names.push(left.to_owned());
            let _ = writeln!(body, "  {left} = {right}");
        }
    }
    for line in source.lines().filter_map(|line| line.strip_prefix("number ")) {
        let (name, value) = line.split_once('=').unwrap_or_default();
        names.push(name.trim().to_owned());
        body.insert_str(0, &format!("  {} = {}\n", name.trim(), value.trim()));
    }
    let mut values = String::new();
    for (index, (name, value)) in model.parameters().iter().zip(parameters).enumerate() {
        if index == active {
            let _ = writeln!(values, "  {name} = auto_par(1)");
        } else {
            let _ = writeln!(values, "  {name} = {value:e}");
        }
    }
    let mut initial = String::new();
    for (index, name) in model.states().iter().enumerate() {
        let _ = writeln!(values, "  {name} = auto_u({})", index + 1);
        let _ = writeln!(initial, "  auto_u({}) = {:e}", index + 1, equilibrium[index]);
        names.push(name.clone());
    }
    let beside = parameters[active];
    names.sort();
    names.dedup();
    format!(
        "subroutine func(auto_n, auto_u, auto_icp, auto_par, auto_jac, auto_f, auto_fu, auto_fp)\n\
         \x20 implicit none\n  integer :: auto_n, auto_icp(*), auto_jac\n\
         \x20 real :: auto_u(auto_n), auto_par(*), auto_f(auto_n), auto_fu(auto_n, auto_n), auto_fp(auto_n, *)\n\
         \x20 real :: {}\n{functions}{values}{body}end subroutine\n\
         subroutine stpnt(auto_n, auto_u, auto_par, auto_t)\n  implicit none\n  integer :: auto_n\n\
         \x20 real :: auto_u(auto_n), auto_par(*), auto_t\n  auto_par(1) = {beside:e}\n{initial}end subroutine\n\
         subroutine bcnd\nend subroutine\nsubroutine icnd\nend subroutine\nsubroutine fopt\nend subroutine\n\
         subroutine pvls\nend subroutine\n",
        names.join(", ")
    )
}
