//! The uniform motion: the equilibrium in the towing frame.
//!
//! In the body frame, with `omega = v/r` and `rho = m omega^2/(k l)`, the equilibrium of the isotropic wheel
//! (`k_u = k_q = k`) is explicit, the spring about the king pin included:
//!
//! ```text
//! sin psi0 = (l - a0)/r       a0 = m omega^2/k
//! V0 = (v cos psi0 - omega k_psi psi0/(k l))/(1 - rho)
//! b0 = (k_psi psi0 - m omega V0)/(k l)
//! ```
//!
//! The dampers do not enter, for nothing moves. Without `k_psi` the longitudinal displacement `u0` is exactly zero, since
//! the power of the forces at the king pin, `k_u v u0 - (k_u - k_q) omega u0 q0`, must vanish; then `k_u` does not enter
//! either and the formulas hold for every `k_u` with `k = k_q`. With both `k_psi` and `k_u != k_q` Newton's method follows
//! the motion from the isotropic wheel. With `k_u = inf` the motion is that of the [`lateral`](crate::lateral) model.

use crate::body::Body;
use crate::contact::ContactForce;
use crate::error::{KingpinError, NoUniformMotion};
use crate::parameters::{Key, Tyre};
use crate::rolling::right_hand_side;
use crate::wheel::Wheel;
use arclength::{Dual, Scalar};

/// Newton's method stops when the step is below this, relative to the scale of each state.
const NEWTON_TOLERANCE: f64 = 1e-14;
/// Newton's method gives up after this many steps; from a near start it needs four or five.
const NEWTON_STEPS: usize = 20;
/// The homotopy in `k_u` gives up when its step, as a part of the way, falls below this.
const SHORTEST_HOMOTOPY_STEP: f64 = 1e-6;

/// Largest change of the caster angle in rad in a step of the homotopy.
const LARGEST_TURN: f64 = 0.2;

/// The uniform motion of a wheel, and what follows from it.
///
/// ```
/// use kingpin::{Key, Wheel};
/// let motion = Wheel::default().with(Key::V, 5.0)?.uniform_motion()?;
/// assert!((motion.psi().sin() - (0.08 - motion.spring_deflection_along_caster())).abs() < 1e-15);
/// assert!(motion.residual() < 1e-12);
/// # Ok::<(), kingpin::KingpinError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformMotion {
    wheel: Wheel,
    state: [f64; 5],
    /// With a tyre: lateral speed of the wheel centre in m/s and deflection of the tyre in m.
    tyre: Option<[f64; 2]>,
    residual: f64,
}

impl UniformMotion {
    /// The wheel that moves.
    pub fn wheel(&self) -> &Wheel {
        &self.wheel
    }
    /// The state `(u, q, psi, V, Omega)`; with a tyre `V` is `V1`, and there are [more](Self::states).
    pub fn state(&self) -> [f64; 5] {
        self.state
    }
    /// All states, in the order of [`Wheel::states`].
    pub fn states(&self) -> Vec<f64> {
        self.tyre_state().map_or_else(|| self.state.to_vec(), |state| state.to_vec())
    }
    /// The state `(u, q, psi, V1, V2, Omega, y_t)` of a wheel with a tyre.
    pub(crate) fn tyre_state(&self) -> Option<[f64; 7]> {
        let [u, q, psi, forward, yaw_rate] = self.state;
        self.tyre.map(|[lateral, deflection]| [u, q, psi, forward, lateral, yaw_rate, deflection])
    }
    /// Lateral speed of the wheel centre in m/s, zero without a tyre.
    pub fn lateral_speed(&self) -> f64 {
        self.tyre.map_or(0.0, |[lateral, _]| lateral)
    }
    /// Lateral deflection of the leading contact point of the tyre in m, `None` without a tyre.
    pub fn tyre_deflection(&self) -> Option<f64> {
        self.tyre.map(|[_, deflection]| deflection)
    }
    /// Longitudinal displacement of the king pin in m.
    pub fn u(&self) -> f64 {
        self.state[0]
    }
    /// Lateral displacement of the king pin in m.
    pub fn q(&self) -> f64 {
        self.state[1]
    }
    /// Caster angle in rad.
    pub fn psi(&self) -> f64 {
        self.state[2]
    }
    /// Forward speed of the wheel in m/s.
    pub fn forward_speed(&self) -> f64 {
        self.state[3]
    }
    /// Yaw rate in rad/s.
    pub fn yaw_rate(&self) -> f64 {
        self.state[4]
    }
    /// `a0 = u0 cos psi0 - q0 sin psi0` in m.
    pub fn spring_deflection_along_caster(&self) -> f64 {
        self.u() * self.psi().cos() - self.q() * self.psi().sin()
    }
    /// Largest component of the vector field at the state, each in its SI unit; zero but for rounding.
    pub fn residual(&self) -> f64 {
        self.residual
    }
    /// The force of the ground on the wheel.
    pub fn contact_force(&self) -> ContactForce {
        match self.tyre_state() {
            Some(state) => self.wheel.tyre_contact_force(&state),
            None => self.wheel.contact_force(&self.state),
        }
    }
    /// Whether the ground can hold the wheel in this motion.
    pub fn rolls(&self) -> bool {
        self.contact_force().rolls()
    }
    /// The Jacobian of the vector field over the [free states](Wheel::free_states), row by row.
    pub fn jacobian(&self) -> Vec<Vec<f64>> {
        if let Some(state) = self.tyre_state() {
            return self.wheel.tyre_linearisation(&state).jacobian();
        }
        if self.wheel.has_lateral_elasticity_only() {
            let [_, q, psi, _, yaw_rate] = self.state;
            return self.wheel.lateral_linearisation(&[q, psi, yaw_rate]).1.map(Vec::from).into();
        }
        jacobian(&self.wheel, &self.state).1.map(Vec::from).into()
    }
}

impl Wheel {
    /// The uniform motion.
    ///
    /// # Errors
    /// [`NoUniformMotion`](KingpinError::NoUniformMotion) with the condition that fails; those of
    /// [`check_tyre`](Self::check_tyre).
    pub fn uniform_motion(&self) -> Result<UniformMotion, KingpinError> {
        self.check_tyre()?;
        if self.tyre() != Tyre::Rigid {
            let state = self.tyre_uniform_state().map_err(|reason| self.no_uniform_motion(reason))?;
            return Ok(self.tyre_motion_at(state));
        }
        let state = self.uniform_state().map_err(|reason| self.no_uniform_motion(reason))?;
        Ok(self.motion_at(state))
    }

    /// The uniform motion by Newton's method from a state near it; `None` where the method does not converge, where
    /// `k_u = inf` and with a tyre.
    pub fn uniform_motion_near(&self, start: &[f64; 5]) -> Option<UniformMotion> {
        self.check_elastic().ok()?;
        newton(self, start).ok().map(|state| self.motion_at(state))
    }

    /// The motion at [all states](Self::states), of which nothing changes.
    pub(crate) fn motion_in(&self, states: &[f64]) -> UniformMotion {
        if self.tyre() == Tyre::Rigid {
            self.motion_at(std::array::from_fn(|index| states[index]))
        } else {
            self.tyre_motion_at(std::array::from_fn(|index| states[index]))
        }
    }

    /// The motion at a state in which nothing changes.
    fn motion_at(&self, state: [f64; 5]) -> UniformMotion {
        let residual = if self.has_lateral_elasticity_only() {
            let [_, q, psi, _, yaw_rate] = state;
            largest(&self.lateral_linearisation(&[q, psi, yaw_rate]).0)
        } else {
            largest(&derivative(self, &state))
        };
        UniformMotion { wheel: *self, state, tyre: None, residual }
    }

    /// The motion of a wheel with a tyre at a state `(u, q, psi, V1, V2, Omega, y_t)` in which nothing changes.
    fn tyre_motion_at(&self, state: [f64; 7]) -> UniformMotion {
        let [u, q, psi, forward, lateral, yaw_rate, deflection] = state;
        UniformMotion {
            wheel: *self,
            state: [u, q, psi, forward, yaw_rate],
            tyre: Some([lateral, deflection]),
            residual: self.tyre_residual(&state),
        }
    }

    pub(crate) fn no_uniform_motion(&self, reason: NoUniformMotion) -> KingpinError {
        let [v, l, r] = [Key::V, Key::L, Key::TurningRadius].map(|key| self.get(key));
        KingpinError::NoUniformMotion { v, l, r, reason }
    }

    /// The states `(u, q, psi, V, Omega)` of the uniform motion.
    pub(crate) fn uniform_state(&self) -> Result<[f64; 5], NoUniformMotion> {
        if self.has_lateral_elasticity_only() {
            return self.lateral_uniform_state();
        }
        let closed_form = self.isotropic_uniform_state(&self.body())?;
        let target = self.get(Key::KU);
        let lateral = self.get(Key::KQ);
        if self.get(Key::KPsi) == 0.0 || target == lateral {
            return Ok(closed_form);
        }
        let stiffness_at = |part: f64| lateral * (target / lateral).powf(part);
        let (mut state, mut part, mut step) = (closed_form, 0.0, 1.0);
        while part < 1.0 {
            let next = f64::min(part + step, 1.0);
            let mut wheel = *self;
            wheel.set_value(Key::KU, if next < 1.0 { stiffness_at(next) } else { target }).ok();
            // A long way to the next motion leads to another one, with the caster turned round or with many turns of its spring.
            let near = |found: [f64; 5]| {
                let is_near = (found[2] - state[2]).abs() < LARGEST_TURN;
                if is_near { Ok(found) } else { Err(largest(&derivative(&wheel, &state))) }
            };
            match newton(&wheel, &state).and_then(near) {
                Ok(found) => (state, part, step) = (found, next, 2.0 * step),
                Err(residual) if step < SHORTEST_HOMOTOPY_STEP => {
                    let longitudinal_stiffness = stiffness_at(part);
                    return Err(NoUniformMotion::LostOnTheWay { longitudinal_stiffness, residual });
                }
                Err(_) => step *= 0.5,
            }
        }
        Ok(state)
    }

    /// The closed form, for the wheel in which `k_u` is replaced by `k_q`.
    pub(crate) fn isotropic_uniform_state(&self, body: &Body<f64>) -> Result<[f64; 5], NoUniformMotion> {
        let v = self.get(Key::V);
        if v == 0.0 {
            return Err(NoUniformMotion::Standstill);
        }
        let (curvature, omega) = (self.get(Key::Curvature), self.towing_yaw_rate());
        let (l, m, k) = (body.caster_length, body.static_moment, body.lateral_stiffness);
        let inertial = m * omega * omega;
        if inertial >= k * l {
            return Err(NoUniformMotion::SpringTooSoft { inertial, elastic: k * l });
        }
        let effective_length = l - inertial / k;
        let sine = effective_length * curvature;
        if sine.abs() >= 1.0 {
            return Err(NoUniformMotion::CircleTooSmall {
                effective_length: effective_length.abs(),
                radius: self.get(Key::TurningRadius),
            });
        }
        let remaining = effective_length / l;
        let cosine = (1.0 - sine * sine).sqrt();
        let psi = sine.asin();
        let rotational = body.rotational_stiffness * psi / (k * l);
        let forward_speed = (v * cosine - omega * rotational) / remaining;
        if body.rotational_stiffness == 0.0 {
            let q = -m * omega * v / (k * l * remaining);
            return Ok([0.0, q, psi, forward_speed, omega]);
        }
        let along = inertial / k;
        let across = rotational - m * omega * forward_speed / (k * l);
        Ok([along * cosine + across * sine, across * cosine - along * sine, psi, forward_speed, omega])
    }
}

/// The vector field of the wheel at a state.
fn derivative(wheel: &Wheel, state: &[f64; 5]) -> [f64; 5] {
    let mut derivative = [0.0; 5];
    let towing = (wheel.get(Key::V), wheel.towing_yaw_rate());
    right_hand_side(&wheel.body(), true, true, towing, state, &mut derivative);
    derivative
}

/// The vector field of the wheel at a state, and its Jacobian.
pub(crate) fn jacobian(wheel: &Wheel, state: &[f64; 5]) -> ([f64; 5], [[f64; 5]; 5]) {
    type Gradient = Dual<f64, 5>;
    let mut derivative = [Gradient::constant(0.0); 5];
    let mut direction = 0;
    let state = state.map(|value| {
        direction += 1;
        Gradient::variable(value, direction - 1)
    });
    let towing = (Gradient::constant(wheel.get(Key::V)), Gradient::constant(wheel.towing_yaw_rate()));
    right_hand_side(&wheel.body(), wheel.is_damped(), true, towing, &state, &mut derivative);
    (derivative.map(|component| component.value), derivative.map(|component| component.derivatives))
}

/// The vector field and its Jacobian over any scalar, from the parameters as such.
pub(crate) fn jacobian_over<T: Scalar>(
    parameter: impl Fn(Key) -> T,
    state: &[T; 5],
) -> ([T; 5], [[T; 5]; 5]) {
    let constant = |key| Dual::<T, 5>::constant(parameter(key));
    let body = Body::new(constant);
    let state: [Dual<T, 5>; 5] = std::array::from_fn(|index| Dual::variable(state[index], index));
    let v = constant(Key::V);
    let mut derivative = [Dual::constant(T::zero()); 5];
    right_hand_side(&body, true, true, (v, v * constant(Key::Curvature)), &state, &mut derivative);
    (derivative.map(|component| component.value), derivative.map(|component| component.derivatives))
}

/// Newton's method for the equilibrium; the error is the residual where it gave up.
fn newton(wheel: &Wheel, start: &[f64; 5]) -> Result<[f64; 5], f64> {
    let v = wheel.get(Key::V);
    let l = wheel.get(Key::L);
    let scale = [l, l, 1.0, v, v / l];
    let mut state = *start;
    let mut residual = f64::INFINITY;
    let mut last = f64::INFINITY;
    for _ in 0..NEWTON_STEPS {
        let (derivative, jacobian) = jacobian(wheel, &state);
        residual = largest(&derivative);
        let Some(step) = solve(jacobian, derivative) else { break };
        for (value, step) in state.iter_mut().zip(step) {
            *value -= step;
        }
        let size =
            step.iter().zip(scale).fold(0.0, |size: f64, (step, scale)| size.max((step / scale).abs()));
        // Steps that no longer shrink, at the level of rounding, are as good as it gets.
        if size < NEWTON_TOLERANCE || (size < NEWTON_TOLERANCE.sqrt() && size >= 0.5 * last) {
            return Ok(state);
        }
        if !size.is_finite() {
            break;
        }
        last = size;
    }
    Err(residual)
}

/// Gaussian elimination with partial pivoting, rows scaled by their largest element; `None` where singular.
pub(crate) fn solve<const N: usize>(mut matrix: [[f64; N]; N], mut right: [f64; N]) -> Option<[f64; N]> {
    for row in 0..N {
        let size = largest(&matrix[row]);
        matrix[row] = matrix[row].map(|element| element / size);
        right[row] /= size;
    }
    for column in 0..N {
        let pivot =
            (column..N).max_by(|&i, &j| matrix[i][column].abs().total_cmp(&matrix[j][column].abs()))?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let pivot_row = matrix[column];
        if pivot_row[column] == 0.0 || !pivot_row[column].is_finite() {
            return None;
        }
        for row in column + 1..N {
            let factor = matrix[row][column] / pivot_row[column];
            for (element, above) in matrix[row].iter_mut().zip(pivot_row) {
                *element -= factor * above;
            }
            right[row] -= factor * right[column];
        }
    }
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    Some(right)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}
