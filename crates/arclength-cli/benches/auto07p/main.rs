//! Branches of limit cycles and curves of their bifurcations side by side with AUTO-07p, on one thread: whole commands, and the
//! continuation alone inside a process.
//!
//! Both programs start at the same Hopf point and follow the same branch over the same range; compared are two quantities of
//! the bifurcation diagram at the parameter values named. In the first table the period has to be right to 1e-6; in the
//! second it and the largest values of the first states to 1e-5 of their amplitudes (AUTO reports the largest value at a mesh
//! point); of a curve of bifurcations the second parameter to 1e-6. Both are measured against a tight run of this program.
//! This program runs with the fastest of its tolerances that reach it, AUTO with the fewest mesh intervals from 10 on (of 4
//! collocation points) and with the largest step that gives about as many points. AUTO's right-hand sides are compiled Fortran,
//! ours the .ode files as they are.
//!
//! *Commands* are `arclength equilibria` and `arclength cycles`, each with a result file, beside AUTO's own two runs with their
//! files, of curves `arclength locus` beside AUTO's run for the start and one run each way. *In process* is the continuation of
//! cycles alone, beside AUTO's run along the cycles, which has no other form. All times are processor times of user and system, medians
//! of seven rounds in which the programs take turns.
//!
//! Names of models after `--` select those (`chain` and `curve` all of these). Needs the Debian packages `auto-07p` and `gfortran`; says so and
//! stops where they are missing.

mod auto;
mod cases;
mod fortran;
mod processor_time;
mod program;

use arclength::cycle::{CycleBranch, Resolution};
use arclength::equilibrium::{Equilibria, HopfPoint, find_equilibrium};
use arclength_ode::Model;
use auto::{AUTO, Auto};
use cases::{Case, Curve};
use processor_time::{Of, median};
use program::Program;
use std::path::Path;
use std::process::Command;

/// Rounds in which both programs take turns.
const ROUNDS: usize = 7;
/// Runs to choose the tolerance.
const SHORT_RUNS: usize = 3;
/// A state with an amplitude below this part of its value rests; its value is then what the error is measured by.
const RESTING: f64 = 1e-3;
/// States of which AUTO's branch file has the largest values.
const REPORTED_STATES: usize = 5;
/// Tolerance of what errors are measured against.
const TIGHT: f64 = 1e-10;
/// Tolerances and numbers of mesh intervals that are tried.
const TOLERANCES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
const INTERVALS: [usize; 13] = [10, 15, 20, 30, 50, 75, 100, 150, 200, 300, 500, 700, 1000];
/// Largest steps of AUTO that are tried.
const LARGEST_STEPS: [f64; 8] = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
/// Relative error of the second parameter on a curve of bifurcations.
const CURVE_ACCURACY: f64 = 1e-6;
/// Numbers of states of the chains.
const CHAINS: [usize; 5] = [4, 10, 20, 40, 80];

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

/// What cycles are measured against.
struct Exact {
    cycles: Vec<Cycle>,
    amplitudes: Vec<Vec<f64>>,
}

impl Exact {
    fn of(case: &Case, branch: &CycleBranch) -> Result<Self, String> {
        let amplitudes = |value: &f64| {
            let point = branch.points.iter().find(|point| point.value == *value)?;
            let extremes = point.max.iter().zip(&point.min);
            Some(extremes.map(|(max, min)| (0.5 * (max - min)).max(RESTING * max.abs())).collect())
        };
        let amplitudes = case.values.iter().filter_map(amplitudes).collect();
        Ok(Self { cycles: cycles_at(case, branch)?, amplitudes })
    }

    /// The largest relative error of some cycles; infinite where some are missing.
    fn error(&self, measure: Measure, found: &[Cycle]) -> f64 {
        if found.len() != self.cycles.len() {
            return f64::INFINITY;
        }
        let mut worst = 0.0_f64;
        for ((cycle, exact), amplitudes) in found.iter().zip(&self.cycles).zip(&self.amplitudes) {
            worst = worst.max((cycle.period / exact.period - 1.0).abs());
            if measure == Measure::PeriodAndMaxima {
                let maxima = cycle.max.iter().zip(&exact.max).zip(amplitudes);
                let errors = maxima.map(|((max, exact), amplitude)| (max - exact).abs() / amplitude);
                worst = errors.fold(worst, f64::max);
            }
        }
        worst
    }
}

fn main() {
    if !Path::new(AUTO).is_dir() || Command::new("gfortran").arg("--version").output().is_err() {
        println!("skipped: AUTO-07p or gfortran is not installed (Debian packages auto-07p, gfortran)");
        return;
    }
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted =
        |names: &[&str]| wanted.is_empty() || wanted.iter().any(|word| names.contains(&word.as_str()));
    let gallery = match cases::gallery() {
        Ok(gallery) => gallery,
        Err(problem) => return println!("{problem}"),
    };
    let chains: Vec<Case> = CHAINS.into_iter().map(cases::chain).collect();
    for (title, measure) in
        [("period to 1e-6", Measure::Period), ("period and largest values to 1e-5", Measure::PeriodAndMaxima)]
    {
        println!("\n{title}");
        heading();
        for case in gallery.iter().filter(|case| is_wanted(&[&case.model])) {
            tell(&format!("{}/{}", case.model, case.parameter), compare(case, measure));
        }
        for case in chains.iter().filter(|case| is_wanted(&[&case.model, "chain"])) {
            tell(&case.model, compare(case, measure));
        }
    }
    println!("\ncurves of bifurcations, second parameter to 1e-6");
    heading();
    match cases::curves() {
        Ok(curves) => {
            for curve in curves.iter().filter(|curve| is_wanted(&[&curve.case.model, "curve"])) {
                let name = format!("{} {}", curve.case.model, curve.kind.label());
                tell(&name, compare_curves(curve));
            }
        }
        Err(problem) => println!("{problem}"),
    }
}

/// What a comparison found: settings, points, errors and times in seconds of both.
struct Compared {
    tolerance: f64,
    points: usize,
    error: f64,
    intervals: usize,
    auto_points: usize,
    auto_error: f64,
    /// Of whole commands.
    commands: [f64; 2],
    /// Of the continuation alone.
    in_process: Option<[f64; 2]>,
}

fn heading() {
    println!(
        "{:18} {:>9} {:>6} {:>8} {:>5} {:>6} {:>8} | {:>21} {:>6} | {:>21} {:>6}",
        "branch",
        "tolerance",
        "points",
        "error",
        "NTST",
        "points",
        "error",
        "commands: AUTO / ours",
        "ratio",
        "alone: AUTO / ours",
        "ratio"
    );
}

fn tell(name: &str, compared: Result<Compared, String>) {
    let compared = match compared {
        Ok(compared) => compared,
        Err(problem) => return println!("{name:18} {problem}"),
    };
    let Compared { tolerance, points, error, intervals, auto_points, auto_error, commands, in_process } =
        compared;
    let times =
        |[ours, auto]: [f64; 2]| format!("{:>9.2} / {:>6.2} ms {:>6.1}", 1e3 * auto, 1e3 * ours, auto / ours);
    println!(
        "{name:18} {tolerance:9.0e} {points:6} {error:8.1e} {intervals:5} {auto_points:6} {auto_error:8.1e} | {} | {}",
        times(commands),
        in_process.map_or_else(String::new, times)
    );
}

/// A model, and the Hopf point of a case.
struct Prepared {
    model: Model,
    active: usize,
    hopf: HopfPoint,
    /// An equilibrium a little beside the Hopf point, so that AUTO's run along the equilibria passes it, and its parameters.
    equilibrium: Vec<f64>,
    beside: Vec<f64>,
}

fn prepare(case: &Case) -> Result<Prepared, String> {
    let model = Model::parse(&case.source).map_err(|error| error.to_string())?;
    let mut parameters = model.default_parameters().to_vec();
    for (name, value) in case.set {
        parameters[model.parameter_index(name).ok_or("no such parameter")?] = *value;
    }
    let active = model.parameter_index(case.parameter).ok_or("no such parameter")?;
    if !(case.equilibria.0..=case.equilibria.1).contains(&parameters[active]) {
        parameters[active] = case.equilibria.0;
    }
    let branch = Equilibria::of(&model)
        .start(&case.start.map_or_else(|| model.initial_state(&parameters), <[f64]>::to_vec))
        .parameters(&parameters)
        .along(case.parameter, case.equilibria.0..=case.equilibria.1)
        .run()
        .map_err(|error| error.to_string())?;
    let hopf = branch.hopf_points().nth(case.hopf).ok_or("no Hopf point")?.clone();
    let mut beside = hopf.parameters.clone();
    beside[active] -= 5e-3 * (case.equilibria.1 - case.equilibria.0);
    let equilibrium = find_equilibrium(&model, &hopf.state, &beside).map_err(|error| error.to_string())?;
    Ok(Prepared { model, active, hopf, equilibrium, beside })
}

fn compare(case: &Case, measure: Measure) -> Result<Compared, String> {
    let prepared = prepare(case)?;
    let run = |tolerance: f64| follow(case, &prepared, tolerance);
    let exact = Exact::of(case, &run(TIGHT)?)?;
    let mut ours: Option<(f64, f64)> = None;
    for tolerance in TOLERANCES {
        let mut time = f64::INFINITY;
        let mut error = f64::INFINITY;
        for _ in 0..SHORT_RUNS {
            let (branch, taken) = processor_time::of(Of::ThisProcess, || run(tolerance))?;
            error = exact.error(measure, &cycles_at(case, &branch)?);
            time = time.min(taken);
        }
        if error <= measure.accuracy() && ours.is_none_or(|(_, fastest)| time < fastest) {
            ours = Some((tolerance, time));
        }
    }
    let (tolerance, _) = ours.ok_or("no tolerance reaches the accuracy")?;
    let directory = tempfile::tempdir().map_err(|error| error.to_string())?;
    let program = Program { directory: directory.path(), case, states: prepared.model.states() };
    program.equilibria()?;
    program.cycles(tolerance)?;
    let (found, points) = program.found()?;
    let error = exact.error(measure, &found);

    let Prepared { model, equilibrium, beside, active, .. } = &prepared;
    let auto = Auto::build(directory.path(), case, model, equilibrium, beside, &[*active])?;
    let most_points = 4 * points + 100;
    let found = |intervals: usize, step: f64| {
        auto.run_cycles(intervals, step, most_points)?;
        auto.found()
    };
    let (largest_step, _) = LARGEST_STEPS
        .into_iter()
        .filter_map(|step| {
            let result = found(50, step).ok()?;
            (result.cycles.len() == exact.cycles.len()).then_some((step, result.points.abs_diff(points)))
        })
        .min_by_key(|(_, difference)| *difference)
        .ok_or("AUTO does not reach the values")?;
    let mut theirs = None;
    let mut best = f64::INFINITY;
    for intervals in INTERVALS {
        let Ok(result) = found(intervals, largest_step) else { continue };
        let error = exact.error(measure, &result.cycles);
        best = best.min(error);
        if error <= measure.accuracy() {
            theirs = Some((intervals, result.points, error));
            break;
        }
    }
    let (intervals, auto_points, auto_error) =
        theirs.ok_or_else(|| format!("AUTO does not come closer than {best:.1e}"))?;
    let mut times: [Vec<f64>; 4] = Default::default();
    for _ in 0..ROUNDS {
        let (_, first) = processor_time::of(Of::Children, || program.equilibria())?;
        let (_, second) = processor_time::of(Of::Children, || program.cycles(tolerance))?;
        let (_, auto_first) = processor_time::of(Of::Children, || auto.run_equilibria())?;
        let (_, auto_second) =
            processor_time::of(Of::Children, || auto.run_cycles(intervals, largest_step, most_points))?;
        let (_, alone) = processor_time::of(Of::ThisProcess, || run(tolerance))?;
        for (list, time) in
            times.iter_mut().zip([first + second, auto_first + auto_second, alone, auto_second])
        {
            list.push(time);
        }
    }
    let [ours, auto, alone, auto_alone] = times.map(median);
    Ok(Compared {
        tolerance,
        points,
        error,
        intervals,
        auto_points,
        auto_error,
        commands: [ours, auto],
        in_process: Some([alone, auto_alone]),
    })
}

fn compare_curves(curve: &Curve) -> Result<Compared, String> {
    let case = &curve.case;
    let prepared = prepare(case)?;
    let directory = tempfile::tempdir().map_err(|error| error.to_string())?;
    let program = Program { directory: directory.path(), case, states: prepared.model.states() };
    program.equilibria()?;
    program.cycles(TIGHT)?;
    program.curve(curve, TIGHT)?;
    let (exact, _) = program.second_parameters(curve)?;
    let error = |found: &[f64]| {
        found.iter().zip(&exact).map(|(value, exact)| (value / exact - 1.0).abs()).fold(0.0, f64::max)
    };
    let mut ours: Option<(f64, f64)> = None;
    for tolerance in TOLERANCES {
        // The start is known as well as the curve is to be.
        program.cycles(tolerance)?;
        let mut time = f64::INFINITY;
        for _ in 0..SHORT_RUNS {
            let (_, taken) = processor_time::of(Of::Children, || program.curve(curve, tolerance))?;
            time = time.min(taken);
        }
        let reached = error(&program.second_parameters(curve)?.0) <= CURVE_ACCURACY;
        if reached && ours.is_none_or(|(_, fastest)| time < fastest) {
            ours = Some((tolerance, time));
        }
    }
    let (tolerance, _) = ours.ok_or("no tolerance reaches the accuracy")?;
    program.cycles(tolerance)?;
    program.curve(curve, tolerance)?;
    let (found, points) = program.second_parameters(curve)?;
    let our_error = error(&found);

    let second = prepared.model.parameter_index(curve.second.0).ok_or("no such parameter")?;
    let Prepared { model, equilibrium, beside, active, .. } = &prepared;
    let auto = Auto::build(directory.path(), case, model, equilibrium, beside, &[*active, second])?;
    let start = auto.start_of_curve(curve.kind)?;
    let (largest_step, _) = LARGEST_STEPS
        .into_iter()
        .filter_map(|step| {
            let (_, found) = auto.run_curve(curve, &start, (50, step)).ok()?;
            Some((step, found.abs_diff(points)))
        })
        .min_by_key(|(_, difference)| *difference)
        .ok_or("AUTO does not reach the values")?;
    let mut theirs = None;
    let mut best = f64::INFINITY;
    for intervals in INTERVALS {
        let Ok((found, points)) = auto.run_curve(curve, &start, (intervals, largest_step)) else { continue };
        let error = error(&found);
        best = best.min(error);
        if error <= CURVE_ACCURACY {
            theirs = Some((intervals, points, error));
            break;
        }
    }
    let (intervals, auto_points, auto_error) =
        theirs.ok_or_else(|| format!("AUTO does not come closer than {best:.1e}"))?;
    let mut times: [Vec<f64>; 2] = Default::default();
    for _ in 0..ROUNDS {
        let (_, ours) = processor_time::of(Of::Children, || program.curve(curve, tolerance))?;
        let settings = (intervals, largest_step);
        let (_, auto) = processor_time::of(Of::Children, || auto.run_curve(curve, &start, settings))?;
        times[0].push(ours);
        times[1].push(auto);
    }
    Ok(Compared {
        tolerance,
        points,
        error: our_error,
        intervals,
        auto_points,
        auto_error,
        commands: times.map(median),
        in_process: None,
    })
}

fn follow(case: &Case, prepared: &Prepared, tolerance: f64) -> Result<CycleBranch, String> {
    prepared
        .hopf
        .cycles(&prepared.model)
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
            let found = found.ok_or_else(|| format!("no cycle at {value}: {:?}", branch.stops))?;
            let max = found.max.iter().copied().take(REPORTED_STATES).collect();
            Ok(Cycle { period: found.period, max })
        })
        .collect()
}
