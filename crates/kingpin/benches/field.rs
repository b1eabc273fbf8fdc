//! Evaluation of the vector field, alone and with derivatives.

use arclength::{Dual, VectorField};
use divan::{Bencher, black_box};
use kingpin::{Key, Wheel};

fn main() {
    divan::main();
}

const STATE: [f64; 5] = [0.01, -0.05, 0.2, 4.5, 3.0];

#[divan::bench(sample_count = 200, sample_size = 1000)]
fn value(bencher: Bencher) {
    let field = Wheel::default().rolling(&[Key::V]).expect("the default wheel rolls");
    bencher.bench_local(|| {
        let mut derivative = [0.0; 5];
        field.evaluate(black_box(&STATE), black_box(&[4.0]), &mut derivative);
        derivative
    });
}

fn directions<const N: usize>(bencher: Bencher, active: &[Key]) {
    let field = Wheel::default().rolling(active).expect("the default wheel rolls");
    let state: [Dual<f64, N>; 5] = std::array::from_fn(|index| Dual::variable(STATE[index], index));
    let parameters: Vec<Dual<f64, N>> = field
        .parameters()
        .iter()
        .enumerate()
        .map(|(index, &value)| Dual::variable(value, 5 + index))
        .collect();
    bencher.bench_local(|| {
        let mut derivative = [Dual::constant(0.0); 5];
        field.evaluate(black_box(&state), black_box(&parameters), &mut derivative);
        derivative
    });
}

#[divan::bench(sample_count = 200, sample_size = 1000)]
fn six_directions(bencher: Bencher) {
    directions::<6>(bencher, &[Key::V]);
}

#[divan::bench(sample_count = 200, sample_size = 1000)]
fn eight_directions(bencher: Bencher) {
    directions::<8>(bencher, &[Key::V]);
}

#[divan::bench(sample_count = 200, sample_size = 1000)]
fn eight_directions_with_caster_length(bencher: Bencher) {
    directions::<8>(bencher, &[Key::V, Key::L]);
}
