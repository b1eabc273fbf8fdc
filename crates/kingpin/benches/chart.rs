//! Charts of 600 x 400 points in the plane of figure 3, and a boundary in it.

use arclength::control::Control;
use divan::{Bencher, counter::ItemsCount};
use kingpin::{Axis, Key, Plane, Wheel};

fn main() {
    divan::main();
}

const POINTS: [usize; 2] = [600, 400];

fn plane() -> Plane {
    let v = Axis::new(Key::V, 0.0..=12.0).expect("allowed");
    let l = Axis::new(Key::L, 0.03..=0.25).expect("allowed");
    Plane::new(v, l).expect("independent")
}

fn on_threads(bencher: Bencher, threads: usize, chart: impl Fn() + Sync) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    bencher.counter(ItemsCount::new(POINTS[0] * POINTS[1])).bench_local(|| pool.install(&chart));
}

#[divan::bench(args = [1, 2], sample_count = 20)]
fn growth_rate(bencher: Bencher, threads: usize) {
    on_threads(bencher, threads, || {
        let chart = Wheel::default().growth_rate_chart(&plane(), POINTS, &Control::none());
        divan::black_box(chart.expect("computed"));
    });
}

#[divan::bench(args = [1, 2], sample_count = 20)]
fn growth_rate_with_damping(bencher: Bencher, threads: usize) {
    on_threads(bencher, threads, || {
        let wheel = Wheel::default().with(Key::CQ, 0.1).expect("allowed");
        let chart = wheel.growth_rate_chart(&plane(), POINTS, &Control::none());
        divan::black_box(chart.expect("computed"));
    });
}

#[divan::bench(args = [1, 2], sample_count = 50)]
fn stability(bencher: Bencher, threads: usize) {
    on_threads(bencher, threads, || {
        let chart = Wheel::default().stability_chart(&plane(), POINTS, &Control::none());
        divan::black_box(chart.expect("computed"));
    });
}

#[divan::bench(sample_count = 20)]
fn boundary(bencher: Bencher) {
    bencher.bench_local(|| Wheel::default().stability_boundary(&plane(), &Control::none()));
}
