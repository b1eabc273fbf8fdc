//! One step of Taylor's method for as many trajectories as a SIMD register has lanes.
//!
//! The coefficients of the solution follow from recurrences in which a product becomes a convolution (Jorba and
//! Zou, Experimental Mathematics 14, 2005). Every lane has its own step size; no operation crosses lanes, so a
//! trajectory does not depend on its neighbours. Registers are named here, unlike in `arclength::lanes`, where the
//! compiler finds them: the steps that are proposed lane by lane made that 6 to 11 % slower.

use super::quadratic::{A, B, COSINE, QuadraticWheel, SINE, SPEED, STATES, YAW};
use pulp::Simd;

/// Order of the method. Work grows with its square, the step size at a fixed tolerance with its inverse root.
pub(super) const ORDER: usize = 18;

/// The step is this part of the one at which the last term of the series equals the tolerance.
const SAFETY: f64 = 0.9;

/// The equations with every coefficient in all lanes.
pub(super) struct TaylorMethod<S: Simd> {
    simd: S,
    minus_v: S::f64s,
    omega: S::f64s,
    length: S::f64s,
    centrifugal: S::f64s,
    minus_stiffness: S::f64s,
    minus_damping: S::f64s,
    minus_yaw_coupling: S::f64s,
    minus_yaw_stiffness: S::f64s,
    minus_yaw_damping: S::f64s,
    rotational_damping: S::f64s,
    rotational_stiffness: S::f64s,
    weights: [S::f64s; STATES],
    reciprocals: [S::f64s; ORDER + 1],
    logarithm_of_tolerance: f64,
    is_damped: bool,
}

/// Taylor coefficients of the states, order by order.
// Registers that straddle two cache lines would halve the speed.
#[repr(align(64))]
pub(super) struct Series<S: Simd> {
    orders: [[S::f64s; STATES]; ORDER + 1],
}

impl<S: Simd> Series<S> {
    pub(super) fn new(simd: S) -> Self {
        Self { orders: [[simd.splat_f64s(0.0); STATES]; ORDER + 1] }
    }
}

impl<S: Simd> TaylorMethod<S> {
    pub(super) fn new(simd: S, wheel: &QuadraticWheel, tolerance: f64) -> Self {
        let splat = |value: f64| simd.splat_f64s(value);
        let mut reciprocals = [splat(0.0); ORDER + 1];
        for (order, reciprocal) in reciprocals.iter_mut().enumerate().skip(1) {
            *reciprocal = splat(1.0 / order as f64);
        }
        Self {
            simd,
            minus_v: splat(-wheel.towing_speed),
            omega: splat(wheel.towing_yaw_rate),
            length: splat(wheel.caster_length),
            centrifugal: splat(wheel.centrifugal),
            minus_stiffness: splat(-wheel.stiffness),
            minus_damping: splat(-wheel.damping),
            minus_yaw_coupling: splat(-wheel.yaw_coupling),
            minus_yaw_stiffness: splat(-wheel.yaw_stiffness),
            minus_yaw_damping: splat(-wheel.yaw_damping),
            rotational_damping: splat(wheel.rotational_damping),
            rotational_stiffness: splat(wheel.rotational_stiffness),
            weights: wheel.weights.map(splat),
            reciprocals,
            logarithm_of_tolerance: tolerance.log2(),
            is_damped: wheel.damping != 0.0
                || wheel.rotational_damping != 0.0
                || wheel.rotational_stiffness != 0.0,
        }
    }

    /// Fills the coefficients of the solution through the states of order 0.
    #[inline(always)]
    pub(super) fn expand(&self, series: &mut Series<S>) {
        let simd = self.simd;
        let zero = simd.splat_f64s(0.0);
        for n in 0..ORDER {
            // Cauchy products of the yaw rate with every state, psi excepted.
            let mut products = [zero; STATES];
            for (left, right) in series.orders[..=n].iter().zip(series.orders[..=n].iter().rev()) {
                for i in [A, B, COSINE, SINE, SPEED, YAW] {
                    products[i] = simd.mul_add_e_f64s(left[YAW], right[i], products[i]);
                }
            }
            let [a, b, cosine, sine, psi, speed, yaw] = series.orders[n];
            // Rates of psi, C and S: W = omega - Omega, of which only order 0 has omega.
            let turning = if n == 0 { simd.sub_f64s(self.omega, yaw) } else { simd.sub_f64s(zero, yaw) };
            let turning_cosine = simd.sub_f64s(simd.mul_f64s(self.omega, cosine), products[COSINE]);
            let turning_sine = simd.sub_f64s(products[SINE], simd.mul_f64s(self.omega, sine));
            // Velocity of the king pin over the ground less that of the towing point, along and across the caster.
            let along = simd.mul_add_e_f64s(self.minus_v, cosine, speed);
            let across = simd.mul_add_e_f64s(self.minus_v, sine, simd.mul_f64s(self.length, yaw));
            let mut force = simd.mul_f64s(self.minus_stiffness, a);
            let mut moment = simd.mul_f64s(self.minus_yaw_stiffness, b);
            if self.is_damped {
                let relative_along = simd.mul_add_e_f64s(self.omega, b, along);
                let relative_across = simd.sub_f64s(across, simd.mul_f64s(self.omega, a));
                force = simd.mul_add_e_f64s(self.minus_damping, relative_along, force);
                moment = simd.mul_add_e_f64s(self.minus_yaw_damping, relative_across, moment);
                moment = simd.mul_add_e_f64s(self.rotational_damping, turning, moment);
                moment = simd.mul_add_e_f64s(self.rotational_stiffness, psi, moment);
            }
            force = simd.mul_add_e_f64s(self.centrifugal, products[YAW], force);
            moment = simd.mul_add_e_f64s(self.minus_yaw_coupling, products[SPEED], moment);
            let rates = [
                simd.add_f64s(along, products[B]),
                simd.sub_f64s(across, products[A]),
                turning_sine,
                turning_cosine,
                turning,
                force,
                moment,
            ];
            // A plain loop: a closure would not have the processor features of this function.
            for (coefficient, rate) in series.orders[n + 1].iter_mut().zip(rates) {
                *coefficient = simd.mul_f64s(self.reciprocals[n + 1], rate);
            }
        }
    }

    /// Largest weighted coefficient of an order in every lane.
    #[inline(always)]
    fn size(&self, series: &Series<S>, order: usize) -> S::f64s {
        let simd = self.simd;
        let zero = simd.splat_f64s(0.0);
        let (mut largest, mut smallest) = (zero, zero);
        for i in 0..STATES {
            let weighted = simd.mul_f64s(self.weights[i], series.orders[order][i]);
            largest = simd.max_f64s(largest, weighted);
            smallest = simd.min_f64s(smallest, weighted);
        }
        simd.max_f64s(largest, simd.sub_f64s(zero, smallest))
    }

    /// Logarithms of the step sizes at which the last two terms of the series meet the tolerance, relative to the
    /// size of the state; written into `steps` as step sizes.
    #[inline(always)]
    pub(super) fn propose_steps(&self, series: &Series<S>, steps: &mut S::f64s) {
        let simd = self.simd;
        let start = self.size(series, 0);
        let last = simd.div_f64s(self.size(series, ORDER), start);
        let before = simd.div_f64s(self.size(series, ORDER - 1), start);
        for ((step, &last), &before) in lanes_mut(steps).iter_mut().zip(lanes(&last)).zip(lanes(&before)) {
            let by_last = (self.logarithm_of_tolerance - binary_logarithm(last)) / ORDER as f64;
            let by_before = (self.logarithm_of_tolerance - binary_logarithm(before)) / (ORDER - 1) as f64;
            *step = SAFETY * binary_power(by_last.min(by_before));
        }
    }

    /// Sums the series at the step of every lane into the states of order 0.
    #[inline(always)]
    pub(super) fn advance(&self, series: &mut Series<S>, steps: S::f64s) {
        let mut sums = series.orders[ORDER];
        for coefficients in series.orders[..ORDER].iter().rev() {
            for i in 0..STATES {
                sums[i] = self.simd.mul_add_e_f64s(sums[i], steps, coefficients[i]);
            }
        }
        series.orders[0] = sums;
    }
}

impl<S: Simd> Series<S> {
    /// The state of one lane.
    #[inline(always)]
    pub(super) fn state(&self, lane: usize) -> [f64; STATES] {
        std::array::from_fn(|i| lanes(&self.orders[0][i])[lane])
    }

    /// Sets the state of one lane.
    #[inline(always)]
    pub(super) fn set_state(&mut self, lane: usize, state: &[f64; STATES]) {
        for (component, &value) in self.orders[0].iter_mut().zip(state) {
            lanes_mut(component)[lane] = value;
        }
    }
}

/// The lanes of a register as numbers.
#[inline(always)]
pub(super) fn lanes<T: pulp::bytemuck::Pod>(register: &T) -> &[f64] {
    pulp::bytemuck::cast_slice(std::slice::from_ref(register))
}

/// The lanes of a register as numbers that can be changed.
#[inline(always)]
pub(super) fn lanes_mut<T: pulp::bytemuck::Pod>(register: &mut T) -> &mut [f64] {
    pulp::bytemuck::cast_slice_mut(std::slice::from_mut(register))
}

/// Logarithm to base 2 of a positive number, low by at most 0.09: the mantissa is taken for its own logarithm.
#[inline(always)]
fn binary_logarithm(number: f64) -> f64 {
    // Bits as an integer are the biased exponent and the mantissa in units of 2^-52; zero gives -1023.
    (number.to_bits() as i64) as f64 * (1.0 / (1u64 << 52) as f64) - 1023.0
}

/// Inverse of [`binary_logarithm`]: a power of 2, high by at most 6 %.
#[inline(always)]
fn binary_power(exponent: f64) -> f64 {
    f64::from_bits(((exponent + 1023.0) * (1u64 << 52) as f64) as u64)
}
