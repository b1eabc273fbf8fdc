//! Models and starts that the tests of cycles share.

pub(crate) mod wheel;

use arclength::cycle::CycleStart;
use arclength::linear::{eigenvalues::eigenvalues, eigenvectors::right_eigenvector};
use arclength::{Dual, Scalar, VectorField};

/// Start at a known Hopf point; the normal form is given only roughly, as it sets the first amplitude alone.
pub(crate) fn hopf_start<F: VectorField>(field: &F, state: &[f64], parameters: &[f64]) -> CycleStart {
    let n = state.len();
    let mut jacobian = vec![0.0; n * n];
    for column in 0..n {
        let duals: Vec<Dual<f64, 1>> =
            (0..n).map(|index| Dual::variable(state[index], usize::from(index != column))).collect();
        let parameters: Vec<Dual<f64, 1>> = parameters.iter().map(|value| Dual::constant(*value)).collect();
        let mut derivative = vec![Dual::constant(0.0); n];
        field.evaluate(&duals, &parameters, &mut derivative);
        for row in 0..n {
            jacobian[row + n * column] = derivative[row].derivatives[0];
        }
    }
    let critical = eigenvalues(&jacobian, n)
        .expect("finite")
        .into_iter()
        .filter(|value| value.im > 0.0)
        .min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))
        .expect("a Hopf point has a pair of complex eigenvalues");
    assert!(critical.re.abs() < 1e-5, "{critical} is not on the imaginary axis");
    let eigenvector = right_eigenvector(&jacobian, n, critical).expect("finite").vector;
    CycleStart::Hopf {
        state: state.to_vec(),
        frequency: critical.im,
        eigenvector,
        crossing_speed: 0.01,
        cubic_coefficient: 1.0,
    }
}

macro_rules! model {
    ($name:ident, [$($state:ident),*], [$($parameter:ident),*], [$($equation:expr),*]) => {
        pub(crate) struct $name;
        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                vec![$(stringify!($state).into()),*]
            }
            fn parameter_names(&self) -> Vec<String> {
                vec![$(stringify!($parameter).into()),*]
            }
            fn dimension(&self) -> usize {
                [$(stringify!($state)),*].len()
            }
            #[inline(always)]
            fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
                let [$($state),*] = *state else { return };
                let [$($parameter),*] = *parameters else { return };
                let equations = [$($equation),*];
                derivative.copy_from_slice(&equations);
            }
        }
    };
}

model!(VanDerPol, [x, y], [mu], [y, mu * (-(x * x) + 1.0) * y - x]);
model!(Lorenz, [x, y, z], [rho], [(y - x) * 10.0, x * (rho - z) - y, x * y - z * (8.0 / 3.0)]);
model!(Lure, [x, y, z], [alpha, beta], [y, z, -(alpha * z) - beta * y - x + x * x]);
model!(RadialCycle, [x, y], [rho], [x * (rho - (x * x + y * y)) - y, y * (rho - (x * x + y * y)) + x]);
model!(Brusselator, [x, y], [a, b], [a - (b + 1.0) * x + x * x * y, b * x - x * x * y]);
