//! How shimmy begins at a straight Hopf point under the brush law.
//!
//! The field is `x' = A x + g |s| s + ..` there, with a curvature that jumps at `s = 0`, so that a first Lyapunov coefficient does not
//! exist: the amplitude grows in proportion to the distance from the Hopf point, not to its root. Over a period the term `|s| s` of an
//! oscillation `s = S cos(omega t)` is worth `8/(3 pi) S s` (Krylov and Bogoliubov), which gives the amplitude to leading order:
//!
//! ```text
//! x = 2 Re(zeta q e^(i omega t))      Re lambda'(p) (p - p_H) + (16/(3 pi)) |q_s| Re(<p, g> q_s) |zeta| = 0
//! ```

use super::field::TyreWheel;
use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use arclength::branch::Criticality;
use arclength::equilibrium::HopfPoint;
use arclength::linear::eigenvectors::left_eigenvector;
use arclength::{Dual, VectorField};
use num_complex::Complex64;
use std::f64::consts::PI;

/// A rate of growth with the amplitude below this part of its terms counts as zero.
const DEGENERATE: f64 = 1e-8;

/// How the cycles that are born at a straight Hopf point grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Onset {
    /// Whether they are stable.
    pub criticality: Criticality,
    /// Slope of the largest caster angle in the parameter, in rad over its unit, negative where the cycles lie below the Hopf point;
    /// `None` where it is not known.
    pub psi_max_slope: Option<f64>,
    /// `(16/(3 pi)) |q_s| Re(<p, g> q_s)`: what an amplitude of one adds to the growth rate.
    rate: f64,
}

impl Onset {
    /// The cubic coefficient of the smooth field whose cycles are as large at a distance from the Hopf point in the parameter, at which
    /// the real part of the eigenvalue changes with `crossing_speed`.
    pub(crate) fn cubic_coefficient(&self, crossing_speed: f64, distance: f64) -> f64 {
        let amplitude = (crossing_speed * distance / self.rate).abs();
        self.rate / amplitude
    }
}

impl TyreWheel {
    /// How cycles grow at a Hopf point of this field, where no first Lyapunov coefficient exists: straight, under the brush law. `None`
    /// elsewhere.
    pub(crate) fn onset(&self, point: &HopfPoint) -> Option<Onset> {
        if !self.is_brush_towed_straight(&point.parameters) {
            return None;
        }
        let sigma = self.wheel_at(&point.parameters).ok()?.get(Key::Sigma);
        let unknown = Onset { criticality: Criticality::Degenerate, psi_max_slope: None, rate: 0.0 };
        Some(self.leading_order(point, sigma).unwrap_or(unknown))
    }

    /// Whether the law is that of the brush and the wheel is towed straight.
    pub(crate) fn is_brush_towed_straight(&self, parameters: &[f64]) -> bool {
        let straight = |wheel: Wheel| wheel.towing_yaw_rate() == 0.0;
        self.wheel().tyre() == Tyre::Brush && self.wheel_at(parameters).is_ok_and(straight)
    }

    fn leading_order(&self, point: &HopfPoint, sigma: f64) -> Option<Onset> {
        let n = self.free().len();
        let deflection = n - 1;
        let angle = self.free().iter().position(|&index| index == 2)?;
        let columns = self.jacobian_by_columns(point);
        let q = &point.eigenvector;
        let mut left = left_eigenvector(&columns, n, Complex64::new(0.0, point.frequency)).ok()?.vector;
        let product: Complex64 = left.iter().zip(q).map(|(p, q)| p.conj() * q).sum();
        left.iter_mut().for_each(|entry| *entry /= product.conj());

        let slip = q[deflection] / sigma;
        let curvature = self.curvature_in_the_deflection(point);
        let half = 0.5 * sigma * sigma;
        let terms: Vec<Complex64> =
            left.iter().zip(curvature).map(|(p, second)| p.conj() * half * second * slip).collect();
        let factor = 16.0 / (3.0 * PI) * slip.norm();
        let rate = factor * terms.iter().map(|term| term.re).sum::<f64>();
        let size = factor * terms.iter().map(|term| term.norm()).sum::<f64>();
        let criticality = if rate.abs() <= DEGENERATE * size || rate.is_nan() {
            Criticality::Degenerate
        } else if rate < 0.0 {
            Criticality::Supercritical
        } else {
            Criticality::Subcritical
        };
        let slope = point.crossing_speed.map(|speed| -2.0 * q[angle].norm() * speed / rate);
        let psi_max_slope = slope.filter(|slope| criticality != Criticality::Degenerate && slope.is_finite());
        Some(Onset { criticality, psi_max_slope, rate })
    }

    fn jacobian_by_columns(&self, point: &HopfPoint) -> Vec<f64> {
        let n = self.free().len();
        let parameters: Vec<Dual<f64, 1>> =
            point.parameters.iter().map(|&value| Dual::constant(value)).collect();
        let mut columns = Vec::with_capacity(n * n);
        for column in 0..n {
            let mut state: Vec<Dual<f64, 1>> =
                point.state.iter().map(|&value| Dual::constant(value)).collect();
            state[column] = Dual::variable(point.state[column], 0);
            let mut rates = vec![Dual::constant(0.0); n];
            self.evaluate(&state, &parameters, &mut rates);
            columns.extend(rates.iter().map(|rate| rate.derivatives[0]));
        }
        columns
    }

    /// The second derivative of the field in the deflection, on the side where that is positive.
    fn curvature_in_the_deflection(&self, point: &HopfPoint) -> Vec<f64> {
        type Twice = Dual<Dual<f64, 1>, 1>;
        let constant = |value: f64| Twice::constant(Dual::constant(value));
        let n = self.free().len();
        let parameters: Vec<Twice> = point.parameters.iter().map(|&value| constant(value)).collect();
        let mut state: Vec<Twice> = point.state.iter().map(|&value| constant(value)).collect();
        // Straight there is no deflection.
        state[n - 1] = Dual::variable(Dual::variable(0.0, 0), 0);
        let mut rates = vec![constant(0.0); n];
        self.evaluate(&state, &parameters, &mut rates);
        rates.iter().map(|rate| rate.derivatives[0].derivatives[0]).collect()
    }
}
