//! Cost of one point of a branch of cycles against the number of mesh intervals and the dimension.
//!
//! The field is a ring of Stuart-Landau oscillators, of any even dimension, with a cycle known in closed form. Prints a table;
//! with the environment variable `SCALING_FIGURE` set to a path it draws it there.

use arclength::continuation::Settings;
use arclength::cycle::{CycleStart, Cycles, Resolution};
use arclength::{Scalar, VectorField};
use kingpin_figure::{Axis, Figure, Line, Panel};
use num_complex::Complex64;
use std::time::Instant;

const DIMENSIONS: [usize; 7] = [2, 4, 6, 10, 20, 30, 50];
const INTERVALS: [usize; 7] = [10, 20, 50, 100, 200, 500, 1000];
/// Where the other number is varied.
const FIXED_DIMENSION: usize = 6;
const FIXED_INTERVALS: usize = 20;
const RUNS: usize = 3;

/// `z_k' = (rho + i - |z_k|^2) z_k + (z_(k+1) - z_k) / 5`, all in phase: circles of radius `sqrt(rho)`.
struct Ring {
    oscillators: usize,
}

impl VectorField for Ring {
    fn state_names(&self) -> Vec<String> {
        (0..self.oscillators).flat_map(|index| [format!("x{index}"), format!("y{index}")]).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["rho".into()]
    }
    fn dimension(&self) -> usize {
        2 * self.oscillators
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        for index in 0..self.oscillators {
            let (x, y) = (state[2 * index], state[2 * index + 1]);
            let next = (index + 1) % self.oscillators;
            let growth = parameters[0] - x * x - y * y;
            derivative[2 * index] = growth * x - y + (state[2 * next] - x) * 0.2;
            derivative[2 * index + 1] = growth * y + x + (state[2 * next + 1] - y) * 0.2;
        }
    }
}

/// Seconds for one point.
fn seconds(dimension: usize, intervals: usize) -> f64 {
    let ring = Ring { oscillators: dimension / 2 };
    let size = (dimension as f64).sqrt().recip();
    let eigenvector: Vec<Complex64> =
        (0..dimension / 2).flat_map(|_| [Complex64::new(size, 0.0), Complex64::new(0.0, -size)]).collect();
    let start = CycleStart::Hopf {
        state: vec![0.0; dimension],
        frequency: 1.0,
        eigenvector,
        crossing_speed: 1.0,
        cubic_coefficient: -1.0,
    };
    let resolution = Resolution { tolerance: 1e-2, fewest_intervals: intervals, ..Resolution::default() };
    let run = |steps: usize| {
        let settings = Settings::default().most_steps(steps);
        let cycles = Cycles::of(&ring, start.clone()).parameters(&[0.0]).along("rho", 0.0..=1.0);
        let begin = Instant::now();
        let branch = cycles.resolution(resolution).settings(settings).run().expect("exists");
        let last = branch.points.last().expect("points");
        assert_eq!(last.orbit.mesh.len(), intervals + 1, "the mesh that was asked for");
        (begin.elapsed().as_secs_f64(), branch.points.len())
    };
    // The first points are made on coarser meshes.
    let (mut early, mut late) = ((f64::INFINITY, 0), (f64::INFINITY, 0));
    for _ in 0..RUNS {
        for (steps, best) in [(12, &mut early), (30, &mut late)] {
            let (time, points) = run(steps);
            *best = (best.0.min(time), points);
        }
    }
    (late.0 - early.0) / (late.1 - early.1) as f64
}

/// Slope of the last two points in doubly logarithmic axes.
fn order(points: &[(f64, f64)]) -> f64 {
    let [.., (a, t), (b, s)] = points else { return f64::NAN };
    (s / t).ln() / (b / a).ln()
}

fn main() {
    let by_intervals: Vec<(f64, f64)> =
        INTERVALS.iter().map(|&count| (count as f64, 1e3 * seconds(FIXED_DIMENSION, count))).collect();
    let by_dimension: Vec<(f64, f64)> = DIMENSIONS
        .iter()
        .map(|&dimension| (dimension as f64, 1e3 * seconds(dimension, FIXED_INTERVALS)))
        .collect();
    println!("n = {FIXED_DIMENSION}: intervals, ms for a point");
    by_intervals.iter().for_each(|(count, time)| println!("{count:6} {time:10.3}"));
    println!("order at the end: {:.2}", order(&by_intervals));
    println!("N = {FIXED_INTERVALS}: dimension, ms for a point");
    by_dimension.iter().for_each(|(dimension, time)| println!("{dimension:6} {time:10.3}"));
    println!("order at the end: {:.2}", order(&by_dimension));
    let Ok(path) = std::env::var("SCALING_FIGURE") else { return };
    let panel = |label: &str, points: &[(f64, f64)], power: i32| {
        let (end, time) = *points.last().expect("points");
        let reference = points.iter().map(|(x, _)| (*x, 1.5 * time * (x / end).powi(power)));
        Panel::new(Axis::new(label).logarithmic(), Axis::new("time per point (ms)").logarithmic())
            .curve(Line::new(points.to_vec()).legend("measured"))
            .curve(Line::new(reference.collect::<Vec<_>>()).dashed().legend(format!("order {power}")))
    };
    let saved = Figure::double_column()
        .columns(2)
        .panel(panel("mesh intervals $N$", &by_intervals, 1).tag("a"))
        .panel(panel("dimension $n$", &by_dimension, 3).tag("b"))
        .save(&path);
    match saved {
        Ok(()) => println!("wrote {path}"),
        Err(error) => println!("{path}: {error}"),
    }
}
