//! One evaluation of a field: compiled from text, and the same field written in Rust.
//!
//! `cargo bench -p arclength-ode` prints both; the ratio of neighbouring lines is the price of the
//! text.

use arclength::{Dual, Scalar, VectorField};
use arclength_ode::Model;
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

const WHEEL: &str = include_str!("../../../gallery/models/towed_wheel.ode");
const LORENZ: &str = include_str!("../../../gallery/models/lorenz.ode");
const HODGKIN_HUXLEY: &str = include_str!("../../../gallery/models/hodgkin_huxley.ode");

/// The field of `lorenz.ode` in Rust.
struct Lorenz;

impl VectorField for Lorenz {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(String::from).into()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["rho", "sigma"].map(String::from).into()
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let (x, y, z) = (state[0], state[1], state[2]);
        let (rho, sigma) = (parameters[0], parameters[1]);
        derivative[0] = sigma * (y - x);
        derivative[1] = rho * x - y - x * z;
        derivative[2] = x * y - z * (8.0 / 3.0);
    }
}

/// The field of `towed_wheel.ode` in Rust.
struct Wheel;

impl VectorField for Wheel {
    fn state_names(&self) -> Vec<String> {
        ["u", "q", "psi", "speed", "yaw"].map(String::from).into()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["v", "l", "r", "k", "m_w", "m_c", "J_wxi", "J_wzeta", "J_Cz", "R_w", "l_c"].map(String::from).into()
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let &[u, q, psi, speed, yaw] = state else { return };
        let &[v, l, r, k, m_w, m_c, j_wxi, j_wzeta, j_cz, r_w, l_c] = parameters else { return };
        let omega = v / r;
        let d = l - l_c;
        let moment = m_c * d;
        let mass = m_w + m_c + j_wxi / (r_w * r_w);
        let inertia = j_cz + j_wzeta + moment * d;
        let (sine, cosine) = psi.sin_cos();
        let along = -(k * (u * cosine - q * sine));
        let across = -(k * (u * sine + q * cosine));
        derivative[0] = speed * cosine + l * yaw * sine - v + omega * q;
        derivative[1] = l * yaw * cosine - speed * sine - omega * u;
        derivative[2] = omega - yaw;
        derivative[3] = (moment * yaw * yaw + along) / mass;
        derivative[4] = (l * across - moment * speed * yaw) / inertia;
    }
}

/// The field of `hodgkin_huxley.ode` in Rust.
struct HodgkinHuxley;

impl VectorField for HodgkinHuxley {
    fn state_names(&self) -> Vec<String> {
        ["v", "m", "h", "n"].map(String::from).into()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["i0", "gna", "gk", "gl", "ena", "ek", "el", "c"].map(String::from).into()
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let &[v, m, h, n] = state else { return };
        let &[i0, gna, gk, gl, ena, ek, el, c] = parameters else { return };
        let am = (-v + 25.0) * 0.1 / (((-v + 25.0) / 10.0).exp() - 1.0);
        let bm = (-v / 18.0).exp() * 4.0;
        let ah = (-v / 20.0).exp() * 0.07;
        let bh = (((-v + 30.0) / 10.0).exp() + 1.0).recip();
        let an = (-v + 10.0) * 0.01 / (((-v + 10.0) / 10.0).exp() - 1.0);
        let bn = (-v / 80.0).exp() * 0.125;
        let n2 = n * n;
        derivative[0] =
            (i0 - gna * (m * m * m) * h * (v - ena) - gk * (n2 * n2) * (v - ek) - gl * (v - el)) / c;
        derivative[1] = am * (-m + 1.0) - bm * m;
        derivative[2] = ah * (-h + 1.0) - bh * h;
        derivative[3] = an * (-n + 1.0) - bn * n;
    }
}

fn model(source: &str) -> Model {
    Model::parse(source).unwrap_or_else(|error| panic!("{}", error.snippet()))
}

/// State and parameters with `T`'s derivatives in the directions of the first states.
fn point<T>(model: &Model, variable: impl Fn(f64, usize) -> T) -> (Vec<T>, Vec<T>) {
    let parameters = model.default_parameters();
    let state = model.initial_state(parameters);
    // Away from the initial state, which for some models is a singular point of the formulas.
    let state = state.iter().enumerate().map(|(index, &x)| variable(x + 0.3, index)).collect();
    let parameters = parameters.iter().map(|&p| variable(p, usize::MAX)).collect();
    (state, parameters)
}

fn run<T: Scalar>(bencher: Bencher, field: &impl VectorField, (state, parameters): (Vec<T>, Vec<T>)) {
    let mut derivative = vec![T::zero(); state.len()];
    bencher.bench_local(|| {
        field.evaluate(black_box(&state), black_box(&parameters), black_box(&mut derivative));
    });
}

macro_rules! compare {
    ($module:ident, $source:ident, $native:expr) => {
        #[divan::bench_group(sample_size = 2000, sample_count = 200)]
        mod $module {
            use super::*;

            #[divan::bench]
            fn f64_rust(bencher: Bencher) {
                run(bencher, &$native, point(&model($source), |x, _| x));
            }
            #[divan::bench]
            fn f64_text(bencher: Bencher) {
                let model = model($source);
                run(bencher, &model, point(&model, |x, _| x));
            }
            #[divan::bench]
            fn jacobian_rust(bencher: Bencher) {
                run(bencher, &$native, point(&model($source), Dual::<f64, 8>::variable));
            }
            #[divan::bench]
            fn jacobian_text(bencher: Bencher) {
                let model = model($source);
                run(bencher, &model, point(&model, Dual::<f64, 8>::variable));
            }
        }
    };
}

compare!(lorenz, LORENZ, Lorenz);
compare!(towed_wheel, WHEEL, Wheel);
compare!(hodgkin_huxley, HODGKIN_HUXLEY, HodgkinHuxley);
