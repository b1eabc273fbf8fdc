//! Systems with a known cycle beside which something is known, and what a curve has found of it.

use arclength::branch::SpecialKind;
use arclength::cycle::{CycleBranch, CycleStart, Cycles, Orbit};
use arclength::locus::CycleLocusBranch;
use arclength::{Scalar, VectorField};

macro_rules! names {
    ($($name:literal),*) => { vec![$($name.into()),*] };
}

/// The unit circle with the rotation speed one, and beside it states of their own with the right-hand sides `rest`.
macro_rules! beside_a_circle {
    ($name:ident, [$($state:literal),*], [$($parameter:literal),*], |$s:ident, $p:ident, $d:ident| $rest:block) => {
        struct $name;

        impl VectorField for $name {
            fn state_names(&self) -> Vec<String> {
                names!["u", "v", $($state),*]
            }
            fn parameter_names(&self) -> Vec<String> {
                names![$($parameter),*]
            }
            fn evaluate<T: Scalar>(&self, $s: &[T], $p: &[T], $d: &mut [T]) {
                let growth = T::one() - $s[0] * $s[0] - $s[1] * $s[1];
                $d[0] = growth * $s[0] - $s[1];
                $d[1] = growth * $s[1] + $s[0];
                $rest
            }
        }
    };
}

/// A revolution with `xi' = eta`, `eta' = mu + nu eta - xi^2 - xi eta / 2` beside it: folds at `mu = 0`; torus bifurcations at
/// `nu = sqrt(mu) / 2`, `xi = sqrt(mu)` with the angle `2 pi sqrt(2 sqrt(mu))`; both meet in a 1:1 resonance.
pub(crate) struct Resonances;

impl VectorField for Resonances {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "p", "q"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "nu"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y] = [state[0], state[1]];
        let (xi, eta) = (state[2] - x * 0.3, state[3] - x * y * 0.2);
        let growth = -(x * x + y * y) + 1.0;
        let (dx, dy) = (growth * x - y, growth * y + x);
        let curved = parameters[0] + parameters[1] * eta - xi * xi - xi * eta * 0.5;
        derivative[0] = dx;
        derivative[1] = dy;
        derivative[2] = eta + dx * 0.3;
        derivative[3] = curved + (dx * y + dy * x) * 0.2;
    }
}

/// The turning frame of a Moebius band with `xi' = eta + k xi`, `eta' = mu xi + (nu - k) eta + c xi^3 - xi^5`: period
/// doublings where the determinant `-mu + k (nu - k)` vanishes.
pub(crate) struct DoublingBand;

impl VectorField for DoublingBand {
    fn state_names(&self) -> Vec<String> {
        names!["x", "y", "z"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["mu", "nu", "c"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [x, y, z] = [state[0], state[1], state[2]];
        let [mu, nu, c] = [parameters[0], parameters[1], parameters[2]];
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = (x / r, y / r);
        let a = r - 1.0;
        // xi e^(i phi/2) and eta e^(i phi/2); the latter is -i times the part of w against the turning axis.
        let p = [(a + a * cos + z * sin) * 0.5, (z + a * sin - z * cos) * 0.5];
        let q = [z - p[1], -(a - p[0])];
        let square = p[0] * p[0] + p[1] * p[1];
        let stiffness = mu + c * square - square * square;
        let first = q;
        let second = [stiffness * p[0] + nu * q[0], stiffness * p[1] + nu * q[1]];
        // w' = (xi' + i eta') e^(i phi/2) + (i/2) w
        let radial = first[0] - second[1] - z * 0.5;
        let vertical = first[1] + second[0] + a * 0.5;
        derivative[0] = radial * cos - y;
        derivative[1] = radial * sin + x;
        derivative[2] = vertical;
    }
}

/// Circles of radius `exp(x / 2)` that turn with a speed `1 + 0.1 y`, where `(x, y)` are at rest: `x' = g_0`, `y' = g_1` with
/// `g = c_0 p + c_1 q + (c_2 + c_3 p + c_4 q) x + (c_5 + c_6 p + c_7 q) y + c_8 x^2 + c_9 x y + c_10 y^2 - c_11 (x^2 + y^2) (x or y)`.
/// Folds and torus bifurcations are folds and Hopf points of the plane, 1:1 resonances its Bogdanov-Takens points.
pub(crate) struct CirclesOfPlane(pub [[f64; 12]; 2]);

impl VectorField for CirclesOfPlane {
    fn state_names(&self) -> Vec<String> {
        names!["u", "v", "y"]
    }
    fn parameter_names(&self) -> Vec<String> {
        names!["p", "q"]
    }
    fn evaluate<T: Scalar>(&self, state: &[T], parameters: &[T], derivative: &mut [T]) {
        let [u, v, y] = [state[0], state[1], state[2]];
        let [p, q] = [parameters[0], parameters[1]];
        let x = (u * u + v * v).ln();
        let square = x * x + y * y;
        let rate = |c: &[f64; 12], own: T| {
            p * c[0]
                + q * c[1]
                + (p * c[3] + q * c[4] + c[2]) * x
                + (p * c[6] + q * c[7] + c[5]) * y
                + x * x * c[8]
                + x * y * c[9]
                + y * y * c[10]
                - own * square * c[11]
        };
        let growth = rate(&self.0[0], x) * 0.5;
        let speed = y * 0.1 + 1.0;
        derivative[0] = growth * u - speed * v;
        derivative[1] = growth * v + speed * u;
        derivative[2] = rate(&self.0[1], y);
    }
}

/// A branch along `p` from the unit circle, at rest where both parameters are zero.
pub(crate) fn along_p(field: &CirclesOfPlane) -> CycleBranch {
    let orbit = Orbit::from_time_history(field, &[0.0, 0.0], &[1.0, 0.0, 0.0], 7.0);
    Cycles::of(field, CycleStart::Orbit(orbit.expect("a cycle")))
        .parameters(&[0.0, 0.0])
        .along("p", -2.0..=2.0)
        .run()
        .expect("exists")
}

pub(crate) fn found(branch: &CycleLocusBranch) -> Vec<(SpecialKind, [f64; 2])> {
    branch.special().map(|(kind, point)| (kind, point.values)).collect()
}

pub(crate) fn assert_at(branch: &CycleLocusBranch, kind: SpecialKind, exact: [f64; 2], tolerance: f64) {
    let points = found(branch);
    let near = points
        .iter()
        .any(|(other, values)| *other == kind && (0..2).all(|k| (values[k] - exact[k]).abs() < tolerance));
    assert!(near, "{kind:?} at {exact:?} among {points:?}");
}
