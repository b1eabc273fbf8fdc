//! The uniform motion of a wheel with a tyre, and its linearisation.
//!
//! Straight the wheel follows without slip. On a circle the motion is followed by Newton's method from the straight path, the curvature
//! growing to that of the circle; what is left of the equations is the witness.

use super::equations::TyreBody;
use crate::bounded::{Bounded, characteristic_polynomial};
use crate::certain_jacobian::certain_jacobian;
use crate::characteristic::largest_real_part_first;
use crate::error::NoUniformMotion;
use crate::hurwitz::is_surely_stable;
use crate::parameters::Key;
use crate::uniform_motion::solve;
use crate::wheel::Wheel;
use arclength::linear::eigenvalues::eigenvalues;
use arclength::{Dual, Scalar};
use num_complex::Complex64;

/// Most free states.
const STATES: usize = 7;
/// Index of `Omega` among all states.
const YAW: usize = 5;
/// Newton's method stops when the step is below this, relative to the scale of each state.
const NEWTON_TOLERANCE: f64 = 1e-14;
/// Newton's method gives up after this many steps; from a near start it needs four or five.
const NEWTON_STEPS: usize = 20;
/// The way to the circle ends when its step, as a part of the way, falls below this.
const SHORTEST_STEP: f64 = 1e-6;
/// Where the king pin is so many caster lengths aside the way goes on without end, towards `psi = +-pi/2`, and to no circle.
const FARTHEST: f64 = 1e3;
/// Largest change of the caster angle in rad in a step.
const LARGEST_TURN: f64 = 0.2;

/// Free states, filled up with zeros.
pub(super) type Padded<T> = [T; STATES];

/// The vector field at free states and its Jacobian over any scalar, from the parameters as such; under the moment about the king pin
/// that holds the caster, if it is held. Rows behind the free states are those of the unit matrix.
fn linearise<T: Scalar>(
    wheel: &Wheel,
    parameter: impl Fn(Key) -> T,
    is_held: bool,
    free: &Padded<T>,
) -> (Padded<T>, [Padded<T>; STATES]) {
    let kind = wheel.tyre_kind();
    let constant = |key| Dual::<T, STATES>::constant(parameter(key));
    let body = TyreBody::new(constant);
    let v = constant(Key::V);
    let towing = (v, v * constant(Key::Curvature));
    let variables: [_; STATES] = std::array::from_fn(|index| Dual::variable(free[index], index));
    let state = kind.full_state(&body, towing, &variables);
    let under = |moment: f64| kind.motion(&body, towing, None, Dual::constant(T::from(moment)), &state).rates;
    let mut rates = under(0.0);
    if is_held {
        // The moment, in which the rates are linear, takes the yaw acceleration away.
        let with_one = under(1.0);
        let moment = -rates[YAW] / (with_one[YAW] - rates[YAW]);
        rates = std::array::from_fn(|index| rates[index] + (with_one[index] - rates[index]) * moment);
    }
    let mut values = [T::zero(); STATES];
    let mut jacobian: [Padded<T>; STATES] =
        std::array::from_fn(|row| std::array::from_fn(|column| T::from(f64::from(u8::from(row == column)))));
    for (row, &index) in kind.king_pin.free().iter().enumerate() {
        values[row] = rates[index].value;
        jacobian[row] = rates[index].derivatives;
    }
    (values, jacobian)
}

/// The linearised motion: its matrix over the free states, and which of them belong to the motion that counts.
pub(crate) struct TyreLinearisation {
    matrix: [Padded<f64>; STATES],
    /// Positions of the states of the lateral motion, of all where that is not decoupled.
    lateral: Vec<usize>,
    /// Coefficients of the quadratic of the longitudinal motion where it is decoupled: in straight towing.
    longitudinal: Option<[f64; 2]>,
}

impl TyreLinearisation {
    /// The Jacobian over the free states, row by row.
    pub(crate) fn jacobian(&self) -> Vec<Vec<f64>> {
        let count = self.lateral.len() + if self.longitudinal.is_some() { 2 } else { 0 };
        self.matrix[..count].iter().map(|row| row[..count].to_vec()).collect()
    }

    fn lateral_eigenvalues(&self) -> Vec<Complex64> {
        let n = self.lateral.len();
        let columns = self.lateral.iter().flat_map(|&j| self.lateral.iter().map(move |&i| (i, j)));
        let matrix: Vec<f64> = columns.map(|(i, j)| self.matrix[i][j]).collect();
        // A matrix that is not finite has no eigenvalues.
        let mut values =
            eigenvalues(&matrix, n).unwrap_or_else(|_| vec![Complex64::new(f64::NAN, f64::NAN); n]);
        values.sort_by(largest_real_part_first);
        values
    }

    /// The eigenvalues in 1/s, largest real part first.
    pub(crate) fn eigenvalues(&self) -> Vec<Complex64> {
        let mut values = self.lateral_eigenvalues();
        if let Some([damping, stiffness]) = self.longitudinal {
            let half = -0.5 * damping;
            let root = Complex64::from(half * half - stiffness).sqrt();
            values.extend([half + root, half - root]);
        }
        values.sort_by(largest_real_part_first);
        values
    }

    /// Those that count: without longitudinal damping those of the lateral motion in straight towing.
    pub(crate) fn eigenvalues_that_count(&self) -> Vec<Complex64> {
        match self.longitudinal {
            Some([0.0, _]) => self.lateral_eigenvalues(),
            _ => self.eigenvalues(),
        }
    }
}

impl Wheel {
    /// Positions among the free states of those of the lateral motion, all on a circle.
    fn lateral_positions(&self) -> Vec<usize> {
        const LONGITUDINAL: [usize; 2] = [0, 3];
        let straight = self.towing_yaw_rate() == 0.0;
        let free = self.tyre_kind().king_pin.free();
        let decouples = straight && LONGITUDINAL.iter().all(|index| free.contains(index));
        let counts = |index: &usize| !(decouples && LONGITUDINAL.contains(index));
        free.iter().enumerate().filter(|(_, index)| counts(index)).map(|(position, _)| position).collect()
    }

    /// The motion of a wheel with a tyre, linearised at a state `(u, q, psi, V1, V2, Omega, y_t)`.
    pub(crate) fn tyre_linearisation(&self, state: &[f64; STATES]) -> TyreLinearisation {
        let (_, matrix) = linearise(self, |key| self.get(key), false, &self.padded(state));
        let lateral = self.lateral_positions();
        let decouples = lateral.len() < self.tyre_kind().king_pin.free().len();
        let longitudinal = decouples.then(|| {
            let body = self.body();
            [body.longitudinal_damping, body.longitudinal_stiffness]
                .map(|coefficient| coefficient * body.inverse_rolling_mass)
        });
        TyreLinearisation { matrix, lateral, longitudinal }
    }

    fn padded(&self, state: &[f64; STATES]) -> Padded<f64> {
        let mut free = [0.0; STATES];
        for (value, &index) in free.iter_mut().zip(self.tyre_kind().king_pin.free()) {
            *value = state[index];
        }
        free
    }

    /// Largest rate of a free state at a state `(u, q, psi, V1, V2, Omega, y_t)`.
    pub(crate) fn tyre_residual(&self, state: &[f64; STATES]) -> f64 {
        largest(&linearise(self, |key| self.get(key), false, &self.padded(state)).0)
    }

    /// The uniform motion `(u, q, psi, V1, V2, Omega, y_t)` of a wheel with a tyre.
    pub(crate) fn tyre_uniform_state(&self) -> Result<[f64; STATES], NoUniformMotion> {
        let v = self.get(Key::V);
        if v == 0.0 {
            return Err(NoUniformMotion::Standstill);
        }
        let straight = [0.0, 0.0, 0.0, v, 0.0, 0.0, 0.0];
        let target = self.get(Key::Curvature);
        let mut free = self.padded(&straight);
        let (mut part, mut step) = (0.0, 1.0);
        let mut slope = [0.0; STATES];
        while part < 1.0 && target != 0.0 {
            let next = f64::min(part + step, 1.0);
            let predicted = std::array::from_fn(|index| free[index] + (next - part) * slope[index]);
            let angle = |free: &Padded<f64>| self.tyre_state(free, next * target)[2];
            let curvature = next * target;
            // A long way to the next motion leads to another one, with the caster turned round.
            let near = |found: Padded<f64>| {
                let is_near = (angle(&found) - angle(&free)).abs() < LARGEST_TURN;
                let [u, q, _, forward, ..] = self.tyre_state(&found, curvature);
                let is_bounded = u.hypot(q) < FARTHEST * self.get(Key::L);
                if is_near && is_bounded && forward > 0.0 { Ok(found) } else { Err(f64::INFINITY) }
            };
            match self.newton_with_tyre(&predicted, curvature, None).and_then(near) {
                Ok(found) => {
                    slope = std::array::from_fn(|index| (found[index] - free[index]) / (next - part));
                    (free, part, step) = (found, next, 2.0 * step);
                }
                Err(residual) if step < SHORTEST_STEP => {
                    return Err(NoUniformMotion::LostOnTheCircle { curvature: part * target, residual });
                }
                Err(_) => step *= 0.5,
            }
        }
        Ok(self.tyre_state(&free, target))
    }

    /// All states from the free ones on a path of a curvature.
    fn tyre_state(&self, free: &Padded<f64>, curvature: f64) -> [f64; STATES] {
        let body = TyreBody::new(|key| self.get(key));
        let v = self.get(Key::V);
        self.tyre_kind().full_state(&body, (v, v * curvature), free)
    }

    /// Newton's method for the uniform motion on a path of a curvature, of a caster that is held at an angle where there is one; the error
    /// is the residual where it gave up.
    pub(super) fn newton_with_tyre(
        &self,
        start: &Padded<f64>,
        curvature: f64,
        held: Option<f64>,
    ) -> Result<Padded<f64>, f64> {
        let parameter = |key| if key == Key::Curvature { curvature } else { self.get(key) };
        let (v, l) = (self.get(Key::V), self.get(Key::L));
        let scale = self.padded(&[l, l, 1.0, v, v, v / l, l]);
        let states = self.tyre_kind().king_pin.free();
        let mut free = *start;
        let (mut residual, mut last) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..NEWTON_STEPS {
            let (mut values, mut jacobian) = linearise(self, parameter, held.is_some(), &free);
            if let Some(psi) = held {
                // In place of the balance of the moments about the king pin.
                let [angle, yaw] = [2, YAW].map(|state| states.iter().position(|free| *free == state));
                let (Some(angle), Some(yaw)) = (angle, yaw) else { break };
                values[yaw] = free[angle] - psi;
                jacobian[yaw] = std::array::from_fn(|column| f64::from(u8::from(column == angle)));
            }
            residual = largest(&values);
            let Some(step) = solve(jacobian, values) else { break };
            let mut size: f64 = 0.0;
            for ((value, step), scale) in
                free.iter_mut().zip(step).zip(scale).take_while(|(_, scale)| *scale > 0.0)
            {
                *value -= step;
                size = size.max((step / scale).abs());
            }
            // Steps that no longer shrink, at the level of rounding, are as good as it gets.
            if size < NEWTON_TOLERANCE || (size < NEWTON_TOLERANCE.sqrt() && size >= 0.5 * last) {
                return Ok(free);
            }
            // From a near start every step is much shorter than the one before; where they grow there is nothing to find.
            if !size.is_finite() || size > last {
                break;
            }
            last = size;
        }
        Err(residual)
    }

    /// Whether a uniform motion of a wheel with a tyre is stable in spite of rounding, and of the longitudinal motion where that is
    /// decoupled and not damped.
    pub(crate) fn tyre_is_surely_stable(&self, state: &[f64; STATES]) -> Option<bool> {
        let parameter = |key| Bounded::read(self.get(key));
        let jacobian = certain_jacobian(self.padded(state), |free| linearise(self, parameter, false, free))?;
        let lateral = self.lateral_positions();
        let coefficients = match lateral.len() {
            3 => characteristic_polynomial(&submatrix::<3>(&jacobian, &lateral)).to_vec(),
            5 => characteristic_polynomial(&submatrix::<5>(&jacobian, &lateral)).to_vec(),
            _ => characteristic_polynomial(&jacobian).to_vec(),
        };
        is_surely_stable(&coefficients)
    }
}

/// The rows and columns of a matrix at some positions.
fn submatrix<const N: usize>(matrix: &[[Bounded; STATES]; STATES], positions: &[usize]) -> [[Bounded; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[positions[i]][positions[j]]))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}
