//! What dry friction about the king pin makes of small motions in rectilinear towing, however small its moment is.
//!
//! With a friction moment `M_f` the rolling wheel near rest sticks, drifts and swings by turns: while it sticks the king pin is
//! drawn sideways at the rate `-v psi`, until the moment of the lateral spring breaks it away; then it swings until its rate is
//! zero and sticks again. During a swing the friction moment is constant, so that it drops out of
//!
//! ```text
//! psi''' + c1 psi'' + c2 psi' + c3 psi = 0,    psi = 1, psi' = psi'' = 0 where the swing begins,
//! ```
//!
//! the characteristic cubic of the lateral motion. Each swing thus multiplies the caster angle by one factor, which contains no
//! `M_f`, and small motions die out exactly where its modulus is below one: real casters stand still at speeds at which the
//! wheel without friction is unstable.
//!
//! The cubic has a real root `lambda` and, where the swing ends, a pair `alpha +- i beta`; with `gamma = alpha - lambda`
//!
//! ```text
//! psi' = A [e^(lambda t) - e^(alpha t) (cos beta t - (gamma/beta) sin beta t)],    A = -c3/(gamma^2 + beta^2).
//! ```
//!
//! The second term over the first has the slope `-e^(gamma t) sin(beta t) (gamma^2 + beta^2)/beta`: it starts from one and comes
//! back to it once between `pi/beta` and `2 pi/beta` if `gamma` is positive, else never; then, and with three real roots, the
//! caster creeps back to rest in one swing.

use crate::characteristic::roots;
use crate::critical_speed::bisect;
use crate::error::KingpinError;
use crate::linear_stability::lateral_cubic;
use crate::parameters::{Key, Tyre};
use crate::wheel::Wheel;
use std::f64::consts::PI;

/// Speeds in m/s between which the critical one is sought, and how many of them, in geometric progression, are looked at.
const SLOWEST: f64 = 1e-3;
const SPEEDS: usize = 2000;

impl Wheel {
    /// The factor by which each swing of the caster multiplies its angle where dry friction, however small, acts about the king pin;
    /// zero where it creeps back to rest. `None` unless the wheel is towed straight and moves, and with a tyre.
    ///
    /// ```
    /// use kingpin::Wheel;
    /// let mut wheel = Wheel::default();
    /// for (key, value) in [("r", "inf"), ("l", "0.04"), ("v", "0.1")] {
    ///     wheel.set(key, value)?;
    /// }
    /// // Unstable at every speed without friction, but small motions die out with it.
    /// assert_eq!(wheel.uniform_motion()?.is_stable(), Some(false));
    /// assert!(wheel.swing_factor().unwrap().abs() < 1.0);
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn swing_factor(&self) -> Option<f64> {
        let speed = self.get(Key::V);
        (self.rolls_straight() && speed > 0.0).then(|| self.swing_at(speed).factor)
    }

    /// The largest caster angle in rad, if that is small, from which the next swing of the rolling wheel ends at rest about the king pin
    /// and does not turn back at once: `J |psi''| <= 2 M_f` there. Where the [factor](Self::swing_factor) of a swing is below one the
    /// caster returns from any angle up to it. `None` unless the wheel is towed straight and moves.
    pub fn largest_returning_angle(&self) -> Option<f64> {
        self.swing_factor()?;
        let swing = self.swing_at(self.get(Key::V));
        Some(2.0 * self.get(Key::MF) * self.body().inverse_yaw_inertia / swing.deceleration.abs())
    }

    /// The smallest speed in m/s beyond which small motions in rectilinear towing grow in spite of dry friction about the king pin;
    /// it does not depend on the moment of that. `None` where they die out at all speeds, on a circle and with a tyre.
    ///
    /// 2000 speeds from 1 mm/s on are looked at; the first change between two of them is found by bisection.
    pub fn critical_speed_with_friction(&self) -> Option<f64> {
        self.rolls_straight().then_some(())?;
        let ratio = (Key::V.allowed().highest / SLOWEST).powf(1.0 / (SPEEDS - 1) as f64);
        let speed = |index: usize| SLOWEST * ratio.powi(index as i32);
        let excess = |speed: f64| self.swing_at(speed).factor.abs() - 1.0;
        let first = (0..SPEEDS).find(|&index| excess(speed(index)) > 0.0)?;
        let Some(before) = first.checked_sub(1) else { return Some(0.0) };
        let slower = speed(before);
        bisect(slower, excess(slower), speed(first), |speed| Some(excess(speed)))
    }

    /// The lateral deflections `q` in m of the king pin, from lowest to highest, at which the rolling wheel rests with the caster along
    /// its path: there dry friction takes the moment of the spring, `|k l b + m omega V| <= M_f`. `None` where there is no closed
    /// form: on a circle with unequal stiffnesses, and with a tyre, where there are [resting angles](Self::resting_angles).
    ///
    /// Towed straight they are those up to `M_f/(k_q l)`. On a circle the caster rests at the angle of the uniform motion only; with
    /// `q` the speed and `u` vary, `u' = q' = V' = 0`.
    ///
    /// ```
    /// use kingpin::{Key, Wheel};
    /// let wheel = Wheel::default().with(Key::Curvature, 0.0)?.with(Key::MF, 0.02)?;
    /// assert_eq!(wheel.resting_deflections()?, Some([-0.0025, 0.0025]));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    ///
    /// # Errors
    /// No uniform motion.
    pub fn resting_deflections(&self) -> Result<Option<[f64; 2]>, KingpinError> {
        let motion = self.uniform_motion()?;
        let [_, q, psi, ..] = motion.state();
        let omega = self.towing_yaw_rate();
        if self.tyre() != Tyre::Rigid {
            return Ok(None);
        }
        if omega != 0.0 && self.get(Key::KU) != self.get(Key::KQ) {
            return Ok(None);
        }
        let body = self.body();
        let stiffness = body.lateral_stiffness * body.caster_length - body.static_moment * omega * omega;
        let half = self.get(Key::MF) * psi.cos() / stiffness;
        Ok(Some([q - half, q + half]))
    }

    /// The largest caster angle in rad that stays as it is while the wheel is towed straight and slides sideways: the friction about
    /// the king pin takes the moment of that of the ground, `mu_d N l + k_psi psi <= M_f`. `None` where it takes none of them, and
    /// on a circle; without `k_psi` it is any angle, up to a quarter turn and beyond.
    pub fn largest_resting_angle_while_sliding(&self) -> Option<f64> {
        self.rolls_straight().then_some(())?;
        let spare = self.get(Key::MF) - self.get(Key::MuD) * self.normal_force() * self.get(Key::L);
        let stiffness = self.get(Key::KPsi);
        (spare > 0.0).then(|| if stiffness > 0.0 { (spare / stiffness).min(PI) } else { PI })
    }

    fn rolls_straight(&self) -> bool {
        self.get(Key::TurningRadius).is_infinite() && self.tyre() == Tyre::Rigid
    }

    fn swing_at(&self, speed: f64) -> Swing {
        swing(lateral_cubic(&self.body(), speed))
    }
}

/// The end of a swing that begins at `psi = 1`.
#[derive(Clone, Copy, Debug)]
struct Swing {
    /// `psi`.
    factor: f64,
    /// `psi''`.
    deceleration: f64,
}

/// The swing of a motion with the characteristic cubic `s^3 + c1 s^2 + c2 s + c3`, whose coefficients are not negative.
fn swing([c1, c2, c3]: [f64; 3]) -> Swing {
    let creeps = Swing { factor: 0.0, deceleration: 0.0 };
    let roots = roots(&[c1, c2, c3]);
    let Some(pair) = roots.iter().find(|root| root.im > 0.0) else { return creeps };
    let Some(lambda) = roots.iter().find(|root| root.im == 0.0).map(|root| root.re) else { return creeps };
    let (alpha, beta) = (pair.re, pair.im);
    let gamma = alpha - lambda;
    if gamma <= 0.0 {
        return creeps;
    }
    // In units of 1/beta; the logarithm does not overflow where many swings would fit into the decay.
    let excess = |time: f64| {
        let wave = time.cos() - gamma / beta * time.sin();
        Some(if wave > 0.0 { gamma / beta * time + wave.ln() } else { f64::NEG_INFINITY })
    };
    let Some(end) = bisect(PI, f64::NEG_INFINITY, 2.0 * PI, excess) else { return creeps };
    let (sine, cosine) = end.sin_cos();
    let [real, oscillating] = [lambda, alpha].map(|rate| (rate * end / beta).exp());
    let amplitude = -c3 / (gamma * gamma + beta * beta);
    let slope = (alpha * gamma + beta * beta) / beta;
    let second = amplitude * (lambda * real - oscillating * (lambda * cosine - slope * sine));
    let third = amplitude
        * (lambda * lambda * real
            - oscillating
                * ((alpha * lambda - slope * beta) * cosine - (alpha * slope + lambda * beta) * sine));
    Swing { factor: -(third + c1 * second) / c3, deceleration: second }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn straight(values: &[(&str, f64)]) -> Wheel {
        let mut wheel = Wheel::default();
        wheel.set("r", "inf").unwrap();
        for (key, value) in values {
            wheel.set(key, &value.to_string()).unwrap();
        }
        wheel
    }

    /// Caster angles at which the linearised wheel with dry friction sticks, one after the other, from its equations of motion: the
    /// lateral deflection `q`, the angle and its rate, by steps of the classical Runge-Kutta method with the friction moment of
    /// the swing, and the drift while it sticks.
    fn angles(wheel: &Wheel, swings: usize) -> Vec<f64> {
        let get = |key: Key| wheel.get(key);
        let (v, l, k) = (get(Key::V), get(Key::L), get(Key::KQ));
        let (c_q, c_psi, k_psi) = (get(Key::CQ), get(Key::CPsi), get(Key::KPsi));
        let d = l - get(Key::LC);
        let inertia = get(Key::JCz) + get(Key::JWzeta) + get(Key::MC) * d * d;
        let m = get(Key::MC) * d;
        let friction = 1e-3;
        let moment = |[q, psi, rate]: [f64; 3]| {
            let q_rate = -v * psi - l * rate;
            // About the vertical, without friction; the yaw rate is the negative rate of the angle.
            m * v * rate - l * (k * q + c_q * q_rate) + c_psi * rate + k_psi * psi
        };
        let mut psi = 1.0;
        let mut q = 0.0;
        let mut angles = Vec::new();
        for _ in 0..swings {
            // While it sticks q grows against the angle, until the moment breaks it away.
            let sign = f64::signum(moment([q - psi, psi, 0.0]) - moment([q, psi, 0.0]));
            q = (sign * friction - k_psi * psi + l * c_q * (-v * psi)) / (-l * k);
            let slope = |[q, psi, rate]: [f64; 3]| {
                [-v * psi - l * rate, rate, -(moment([q, psi, rate]) - sign * friction) / inertia]
            };
            let mut state = [q, psi, 0.0];
            let step = 1e-3 / ((k * l * l / inertia).sqrt() + c_psi / inertia + v / l);
            let add = |state: [f64; 3], slope: [f64; 3], step: f64| {
                std::array::from_fn::<f64, 3, _>(|index| state[index] + step * slope[index])
            };
            let mut moved = false;
            for _ in 0..40_000_000_u64 {
                let a = slope(state);
                let b = slope(add(state, a, 0.5 * step));
                let c = slope(add(state, b, 0.5 * step));
                let e = slope(add(state, c, step));
                let next = std::array::from_fn(|index| {
                    state[index] + step / 6.0 * (a[index] + 2.0 * b[index] + 2.0 * c[index] + e[index])
                });
                let turns = moved && next[2] * state[2] <= 0.0;
                moved |= next[2].abs() > 1e-14;
                if turns {
                    let part = state[2] / (state[2] - next[2]);
                    q = state[0] + part * (next[0] - state[0]);
                    psi = state[1] + step * part * (0.5 * state[2]);
                    break;
                }
                state = next;
            }
            angles.push(psi);
        }
        angles
    }

    #[test]
    fn a_swing_is_that_of_the_equations_of_motion() {
        for values in [
            &[("l", 0.04), ("v", 0.3)][..],
            &[("l", 0.08), ("v", 2.0)],
            &[("l", 0.04), ("v", 2.0), ("c_psi", 2e-4), ("c_q", 0.3), ("k_psi", 0.05)],
        ] {
            let wheel = straight(values);
            let factor = wheel.swing_factor().unwrap();
            let angles = angles(&wheel, 2);
            let measured = [angles[0], angles[1] / angles[0]];
            for measured in measured {
                assert!((measured - factor).abs() < 1e-6, "{values:?}: {measured} and {factor}");
            }
        }
    }

    #[test]
    fn a_slow_wheel_stays_where_it_is_put() {
        let factor = straight(&[("l", 0.04), ("v", 1e-6)]).swing_factor().unwrap();
        assert!((factor - 1.0).abs() < 1e-3, "{factor}");
    }

    #[test]
    fn motions_grow_beyond_the_critical_speed_only() {
        let wheel = straight(&[("l", 0.04)]);
        let critical = wheel.critical_speed_with_friction().unwrap();
        let factor = |speed: f64| wheel.with(Key::V, speed).unwrap().swing_factor().unwrap();
        assert!((factor(critical) + 1.0).abs() < 1e-9);
        assert!(factor(0.999 * critical) > -1.0 && factor(1.001 * critical) < -1.0);
        assert_eq!(Wheel::default().critical_speed_with_friction(), None);
        assert_eq!(Wheel::default().swing_factor(), None);
    }

    proptest! {
        /// Where the wheel is stable without friction small motions die out with it, too, and the factor does not depend on units.
        #[test]
        fn friction_does_no_harm(
            c1 in 1e-3..10.0_f64, c2 in 1e-3..10.0_f64, part in 1e-3..0.999_f64, unit in 1e-3..1e3_f64,
        ) {
            let c3 = part * c1 * c2;
            let factor = swing([c1, c2, c3]).factor;
            prop_assert!(factor.abs() < 1.0, "{factor}");
            let scaled = swing([c1 * unit, c2 * unit.powi(2), c3 * unit.powi(3)]).factor;
            prop_assert!((factor - scaled).abs() < 1e-9, "{factor} {scaled}");
        }
    }
}
