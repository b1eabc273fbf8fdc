//! The branch of limit cycles of the towed wheel (l = 0.08 m, r = 1 m) from its Hopf point at 8.43 m/s down to
//! 0.2 m/s, on one thread.
//!
//! The peer: AUTO-07p with NTST = 50, NCOL = 4 and tolerances 1e-8 takes 121 steps and 0.26 s on one thread of a
//! two-core virtual machine of 2.5 GHz, the kind on which this benchmark is run too.

#[path = "../tests/suite/common/mod.rs"]
#[allow(dead_code)] // The tests have more models and starts in common.
mod common;

use arclength::cycle::{CycleBranch, Cycles, Resolution};
use common::wheel::{Wheel, wheel_start};

fn main() {
    divan::main();
}

fn branch(tolerance: f64, degree: usize) -> CycleBranch {
    let (start, v) = wheel_start();
    Cycles::of(&Wheel, start)
        .parameters(&[v])
        .along("v", 0.2..=9.0)
        .resolution(Resolution { tolerance, degree, ..Resolution::default() })
        .run()
        .expect("the branch exists")
}

#[divan::bench(args = [1e-6, 1e-8, 1e-10])]
fn to_tolerance(bencher: divan::Bencher, tolerance: f64) {
    bencher.bench(|| branch(tolerance, Resolution::default().degree));
}

#[divan::bench(args = [4, 5, 6, 7, 8])]
fn of_degree_to_1e_minus_6(bencher: divan::Bencher, degree: usize) {
    let found = branch(1e-6, degree);
    let intervals = found.points.iter().map(|cycle| cycle.orbit.mesh.len() - 1).max().unwrap_or(0);
    println!("degree {degree}: {} points, at most {intervals} intervals", found.points.len());
    bencher.bench(|| branch(1e-6, degree));
}
