//! Speed of the ensemble integrator on one thread, beside heyoka where Python can import it.
//!
//! Ten seconds of the paper's wheel (v = 4 m/s, l = 0.08 m, r = 1 m) from states around the uniform motion: caster angle within
//! 0.3 rad, yaw rate within 10 rad/s. Times are processor times of the thread, the best of several, so that other work on the
//! machine counts as little as possible. Errors are those of the final states against the Runge-Kutta integrator
//! at a tolerance of 1e-13. `KINGPIN_PYTHON` names another interpreter than `python3`.

use arclength::control::Control;
use arclength::integration::{Integrator, autonomous};
use kingpin::ensemble::Ensemble;
use kingpin::{Key, Wheel};
use std::error::Error;
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::time::Instant;

const TRAJECTORIES: usize = 1024;
const WITH_KNOWN_ERROR: usize = 64;
const DURATION: f64 = 10.0;
const REPETITIONS: usize = 5;
const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/heyoka_ensemble.py");

struct Run {
    rate: f64,
    error: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let wheel = Wheel::default();
    let initial = initial_states(&wheel)?;
    let exact = exact_ends(&wheel, &initial[..WITH_KNOWN_ERROR])?;
    println!("{TRAJECTORIES} trajectories of {DURATION} s, one thread");
    println!("{:<10} {:>9} {:>15} {:>14}", "", "tolerance", "trajectories/s", "largest error");
    let report = |name: &str, tolerance: f64, run: &Run| {
        println!("{name:<10} {tolerance:>9.0e} {:>15.0} {:>14.1e}", run.rate, run.error);
    };
    let mut ours = Vec::new();
    for tolerance in [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13] {
        let run = run_ensemble(&wheel, tolerance, &initial, &exact)?;
        report("kingpin", tolerance, &run);
        ours.push(run);
    }
    for tolerance in [1e-10, 1e-12] {
        let Some(theirs) = run_heyoka(&wheel, tolerance, &initial, &exact)? else { return Ok(()) };
        report("heyoka", tolerance, &theirs);
        // The fastest run that is at least as accurate.
        let rates = ours.iter().filter(|run| run.error <= theirs.error).map(|run| run.rate);
        match rates.reduce(f64::max) {
            Some(rate) => println!("kingpin at no larger error: {:.1} times as fast", rate / theirs.rate),
            None => println!("kingpin was not run at so small an error"),
        }
    }
    Ok(())
}

fn initial_states(wheel: &Wheel) -> Result<Vec<[f64; 5]>, Box<dyn Error>> {
    let [u, q, psi, speed, yaw] = wheel.uniform_motion()?.state();
    // An additive recurrence of low discrepancy in two dimensions.
    let spread = |index: usize, step: f64| 2.0 * (index as f64 * step).fract() - 1.0;
    let state = |i| {
        [
            u,
            q,
            psi + 0.3 * spread(i, 0.754_877_666_246_693),
            speed,
            yaw + 10.0 * spread(i, 0.569_840_290_998_053),
        ]
    };
    Ok((1..=TRAJECTORIES).map(state).collect())
}

fn exact_ends(wheel: &Wheel, initial: &[[f64; 5]]) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let field = wheel.rolling(&[])?;
    let integrator = Integrator::with_tolerance(1e-13);
    let end =
        |start: &[f64; 5]| Ok(integrator.integrate(autonomous(&field, &[]), 0.0, start, DURATION)?.state);
    initial.iter().map(end).collect()
}

/// Largest difference in any state, in SI units.
fn largest_error<'a>(ends: impl Iterator<Item = &'a [f64]>, exact: &[Vec<f64>]) -> f64 {
    let differences =
        ends.zip(exact).flat_map(|(end, exact)| end.iter().zip(exact).map(|(a, b)| (a - b).abs()));
    differences.fold(0.0, f64::max)
}

fn run_ensemble(
    wheel: &Wheel,
    tolerance: f64,
    initial: &[[f64; 5]],
    exact: &[Vec<f64>],
) -> Result<Run, Box<dyn Error>> {
    let ensemble = Ensemble::new(wheel)?.tolerance(tolerance);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let (mut best, mut error) = (f64::INFINITY, 0.0);
    for _ in 0..REPETITIONS {
        let (ends, time) = pool.install(|| {
            let start = ThreadTime::now();
            let ends = ensemble.integrate(initial, DURATION, &Control::none());
            (ends, start.elapsed())
        });
        best = best.min(time);
        error = largest_error(ends?.iter().map(|end| end.state.as_slice()), exact);
    }
    Ok(Run { rate: TRAJECTORIES as f64 / best, error })
}

/// Runs the script; `None`, with a message, where heyoka cannot be imported.
fn run_heyoka(
    wheel: &Wheel,
    tolerance: f64,
    initial: &[[f64; 5]],
    exact: &[Vec<f64>],
) -> Result<Option<Run>, Box<dyn Error>> {
    let python = std::env::var("KINGPIN_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let probe = Command::new(&python).args(["-c", "import heyoka, numpy"]).stderr(Stdio::null()).status();
    if !probe.is_ok_and(|status| status.success()) {
        println!("heyoka is skipped: {python} cannot import it (KINGPIN_PYTHON names another interpreter)");
        return Ok(None);
    }
    let get = |key| wheel.get(key);
    let arm = get(Key::L) - get(Key::LC);
    let mass = get(Key::MW) + get(Key::MC) + get(Key::JWxi) / get(Key::WheelRadius).powi(2);
    let inertia = get(Key::JCz) + get(Key::JWzeta) + get(Key::MC) * arm * arm;
    let mut numbers = vec![TRAJECTORIES as f64, DURATION, tolerance, REPETITIONS as f64];
    numbers.extend([
        get(Key::V),
        wheel.towing_yaw_rate(),
        get(Key::L),
        get(Key::MC) * arm,
        mass,
        inertia,
        get(Key::KQ),
    ]);
    numbers.extend(initial.iter().flatten());
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let mut child = Command::new(&python).arg(SCRIPT).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    child.stdin.take().ok_or("no standard input")?.write_all(&bytes)?;
    let output = child.wait_with_output()?;
    if !output.status.success() {
        return Err("the heyoka script failed".into());
    }
    let numbers: Vec<f64> = output
        .stdout
        .chunks_exact(8)
        .map(|chunk| f64::from_le_bytes(std::array::from_fn(|i| chunk[i])))
        .collect();
    let (time, ends) = numbers.split_first().ok_or("the heyoka script wrote nothing")?;
    Ok(Some(Run { rate: TRAJECTORIES as f64 / time, error: largest_error(ends.chunks_exact(5), exact) }))
}

/// Processor time of this thread where the system tells it (Linux), elapsed time elsewhere.
struct ThreadTime {
    wall: Instant,
    processor: Option<f64>,
}

impl ThreadTime {
    fn now() -> Self {
        Self { wall: Instant::now(), processor: Self::processor() }
    }

    fn elapsed(&self) -> f64 {
        match (self.processor, Self::processor()) {
            (Some(start), Some(end)) => end - start,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }

    fn processor() -> Option<f64> {
        let mut text = String::new();
        std::fs::File::open("/proc/thread-self/schedstat").ok()?.read_to_string(&mut text).ok()?;
        let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
        Some(nanoseconds * 1e-9)
    }
}
