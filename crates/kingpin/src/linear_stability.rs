//! Linear stability of the uniform motion.
//!
//! For the plain wheel (equal stiffnesses, no dampers, no spring about the king pin) the characteristic polynomial and
//! the critical yaw rate are closed forms: stability is lost at `v = r w_crit(l)`, whatever the radius. For any other
//! wheel the polynomial is that of the Jacobian. Whether it is stable is said only beyond rounding errors.
//!
//! **Rectilinear towing.** At `omega = 0` the polynomial is the product of a quadratic, of the longitudinal oscillation
//! of wheel and king pin, and a cubic, of the lateral motion. Without longitudinal damping the former is neutral, at
//! every wheel and speed, and turning however slightly damps it or not; growth rate and stability are then those of the
//! lateral motion, on which shimmy depends. The eigenvalues show both.
//!
//! With lateral elasticity only, `k_u = inf`, there are three eigenvalues; in rectilinear towing they are those of the same
//! cubic.

use crate::arithmetic::Arithmetic;
use crate::body::Body;
use crate::characteristic::{characteristic_polynomial, largest_real_part_first, roots};
use crate::hurwitz::{determinants, hopf_condition, plain_characteristic_polynomial};
use crate::lateral::characteristic_cubic;
use crate::parameters::{Key, Tyre};
use crate::tyre::TyreLinearisation;
use crate::uniform_motion::{UniformMotion, jacobian};
use crate::wheel::Wheel;
use arclength::branch::Stability;
use num_complex::Complex64;

/// The characteristic polynomial at a uniform motion.
enum Characteristic {
    /// On a circle: `s^5 + c1 s^4 + ... + c5`.
    Circle([f64; 5]),
    /// In rectilinear towing: two factors.
    Straight { longitudinal: [f64; 2], lateral: [f64; 3] },
    /// With lateral elasticity only, on a circle or straight.
    Lateral([f64; 3]),
    /// With a tyre.
    Tyre(Box<TyreLinearisation>),
}

impl Characteristic {
    #[inline]
    fn at(wheel: &Wheel, state: &[f64; 5]) -> Self {
        let [_, q, psi, forward_speed, yaw_rate] = *state;
        let omega = wheel.towing_yaw_rate();
        if wheel.has_lateral_elasticity_only() {
            return Self::Lateral(if omega == 0.0 {
                lateral_cubic(&wheel.body(), forward_speed)
            } else {
                characteristic_cubic(&wheel.lateral_linearisation(&[q, psi, yaw_rate]).1)
            });
        }
        if omega == 0.0 {
            let body = wheel.body();
            let longitudinal = [body.longitudinal_damping, body.longitudinal_stiffness]
                .map(|coefficient| coefficient * body.inverse_rolling_mass);
            return Self::Straight { longitudinal, lateral: lateral_cubic(&body, forward_speed) };
        }
        if !wheel.is_plain() {
            return Self::Circle(characteristic_polynomial(&jacobian(wheel, state).1));
        }
        let [c1, c2, c3, c4, c5] = plain_characteristic_polynomial(&wheel.body(), omega * omega);
        Self::Circle([forward_speed * c1, c2, forward_speed * c3, c4, forward_speed * c5])
    }

    fn coefficients(&self) -> Vec<f64> {
        match *self {
            Self::Circle(coefficients) => coefficients.into(),
            Self::Straight { longitudinal, lateral } => product(longitudinal, lateral).into(),
            Self::Lateral(cubic) => cubic.into(),
            Self::Tyre(ref linearisation) => polynomial_of(&linearisation.eigenvalues()),
        }
    }

    fn eigenvalues(&self) -> Vec<Complex64> {
        match self {
            Self::Circle(coefficients) => roots(coefficients).into(),
            Self::Straight { longitudinal, lateral } => {
                let mut eigenvalues = [&roots(longitudinal)[..], &roots(lateral)].concat();
                eigenvalues.sort_unstable_by(largest_real_part_first);
                eigenvalues
            }
            Self::Lateral(cubic) => roots(cubic).into(),
            Self::Tyre(linearisation) => linearisation.eigenvalues(),
        }
    }

    #[inline]
    fn growth_rate(&self) -> f64 {
        match self {
            Self::Circle(coefficients) => roots(coefficients)[0].re,
            Self::Straight { longitudinal: [0.0, _], lateral } | Self::Lateral(lateral) => {
                roots(lateral)[0].re
            }
            Self::Straight { .. } => self.eigenvalues()[0].re,
            Self::Tyre(linearisation) => linearisation.eigenvalues_that_count()[0].re,
        }
    }

    /// The eigenvalues without those of an undamped longitudinal motion in rectilinear towing.
    fn eigenvalues_that_count(&self) -> Vec<Complex64> {
        match self {
            Self::Straight { longitudinal: [0.0, _], lateral } => roots(lateral).into(),
            Self::Tyre(linearisation) => linearisation.eigenvalues_that_count(),
            characteristic => characteristic.eigenvalues(),
        }
    }
}

/// The characteristic polynomial of the lateral motion in rectilinear towing.
pub(crate) fn lateral_cubic<T: Arithmetic>(body: &Body<T>, v: T) -> [T; 3] {
    let l = body.caster_length;
    let damping = body.static_moment * v + body.rotational_damping + body.lateral_damping * l * l;
    let stiffness = body.rotational_stiffness + l * body.lateral_damping * v + l * l * body.lateral_stiffness;
    [damping, stiffness, l * body.lateral_stiffness * v]
        .map(|coefficient| coefficient * body.inverse_yaw_inertia)
}

/// The product of a quadratic and a cubic.
fn product([a1, a2]: [f64; 2], [b1, b2, b3]: [f64; 3]) -> [f64; 5] {
    [a1 + b1, a2 + a1 * b1 + b2, a2 * b1 + a1 * b2 + b3, a2 * b2 + a1 * b3, a2 * b3]
}

/// The coefficients `c1 ... cn` of the polynomial with these roots, complex ones in pairs.
pub(crate) fn polynomial_of(roots: &[Complex64]) -> Vec<f64> {
    let mut coefficients = vec![Complex64::ONE];
    for root in roots {
        coefficients.push(Complex64::ZERO);
        for index in (1..coefficients.len()).rev() {
            let below = coefficients[index - 1];
            coefficients[index] -= root * below;
        }
    }
    coefficients[1..].iter().map(|coefficient| coefficient.re).collect()
}

impl UniformMotion {
    fn characteristic(&self) -> Characteristic {
        if let Some(state) = self.tyre_state() {
            return Characteristic::Tyre(Box::new(self.wheel().tyre_linearisation(&state)));
        }
        Characteristic::at(self.wheel(), &self.state())
    }

    /// The coefficients `c1 ... cn` of the characteristic polynomial `s^n + c1 s^(n-1) + ... + cn` for the number `n` of
    /// [free states](Wheel::free_states).
    pub fn characteristic_polynomial(&self) -> Vec<f64> {
        self.characteristic().coefficients()
    }

    /// The eigenvalues in 1/s, largest real part first.
    ///
    /// ```
    /// let motion = kingpin::Wheel::default().uniform_motion()?;
    /// assert!(motion.eigenvalues().iter().all(|eigenvalue| eigenvalue.re < 0.0));
    /// # Ok::<(), kingpin::KingpinError>(())
    /// ```
    pub fn eigenvalues(&self) -> Vec<Complex64> {
        self.characteristic().eigenvalues()
    }

    /// The eigenvalues on which the stability depends: without those of an undamped longitudinal motion in rectilinear towing.
    pub(crate) fn eigenvalues_that_count(&self) -> Vec<Complex64> {
        self.characteristic().eigenvalues_that_count()
    }

    /// The largest real part of the eigenvalues, in 1/s; in rectilinear towing without longitudinal damping that of the
    /// lateral motion.
    pub fn growth_rate(&self) -> f64 {
        self.characteristic().growth_rate()
    }

    /// Whether the uniform motion is linearly stable; in rectilinear towing without longitudinal damping whether the lateral motion
    /// is. Two witnesses have to agree: the Routh-Hurwitz conditions beyond the rounding errors of their terms, those of the
    /// parameters included, and the sign of the growth rate. It is undecided otherwise.
    pub fn stability(&self) -> Stability {
        self.stability_with(&self.eigenvalues_that_count())
    }

    /// The same from the eigenvalues that count, the first with the largest real part.
    fn stability_with(&self, eigenvalues: &[Complex64]) -> Stability {
        let growth_rate = eigenvalues.first().map_or(f64::NAN, |eigenvalue| eigenvalue.re);
        let unstable = || eigenvalues.iter().filter(|eigenvalue| eigenvalue.re > 0.0).count();
        match self.is_surely_stable() {
            Some(true) if growth_rate < 0.0 => Stability::Stable,
            Some(false) if growth_rate > 0.0 => Stability::Unstable { dimension: Some(unstable()) },
            _ => Stability::Undecided,
        }
    }

    /// Whether it is linearly stable, `None` where that is undecided: see [`stability`](Self::stability).
    pub fn is_stable(&self) -> Option<bool> {
        self.stability().is_stable()
    }
}

/// What a chart tells of one uniform motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChartPoint {
    /// Largest real part of the eigenvalues that count, in 1/s.
    pub growth_rate: f64,
    /// `None` where that is undecided.
    pub stable: Option<bool>,
    pub rolls: bool,
}

impl Wheel {
    /// Growth rate, stability and rolling of the uniform motion; `None` where there is no such motion.
    pub(crate) fn chart_point(&self) -> Option<ChartPoint> {
        let motion = self.uniform_motion().ok()?;
        let eigenvalues = motion.eigenvalues_that_count();
        Some(ChartPoint {
            growth_rate: eigenvalues.first()?.re,
            stable: motion.stability_with(&eigenvalues).is_stable(),
            rolls: motion.rolls(),
        })
    }

    /// A smooth function of the parameters, positive where the uniform motion is stable and zero at a Hopf point on the
    /// boundary of stability; `None` where there is no motion or another of the conditions for stability fails.
    pub(crate) fn flutter_margin(&self) -> Option<f64> {
        if self.tyre() != Tyre::Rigid {
            // Both boundaries are zeros of the growth rate.
            return Some(-self.uniform_motion().ok()?.growth_rate());
        }
        let state = self.uniform_state().ok()?;
        // In rectilinear towing `N` has a second factor, the sense in which turning will damp the longitudinal motion, which does not
        // count there.
        if self.is_plain() && self.towing_yaw_rate() != 0.0 {
            let (body, omega) = (self.body(), self.towing_yaw_rate());
            let [stiff, inertial] = hopf_condition(&body);
            let margin = -stiff - inertial * omega * omega;
            return beside_the_hopf_condition(&body, omega * omega).then_some(margin);
        }
        match Characteristic::at(self, &state) {
            Characteristic::Circle([c1, c2, c3, c4, c5]) => {
                let [second, fourth] = determinants([c1, c2, c3, c4, c5]);
                let mixed = c1 * c4 - c5;
                let scale = second * (c3 * c4 + c2 * c5) + mixed * mixed;
                let omega = self.towing_yaw_rate() * self.get(Key::L) / self.get(Key::V);
                // Without longitudinal damping the determinant vanishes with the yaw rate squared.
                let vanishing = if self.get(Key::CU) == 0.0 { omega * omega } else { 1.0 };
                let others = [c1, c3, c5, second].into_iter().all(|condition| condition > 0.0);
                others.then_some(fourth / (scale * vanishing))
            }
            Characteristic::Tyre(_) => None,
            Characteristic::Straight { lateral: [c1, c2, c3], .. }
            | Characteristic::Lateral([c1, c2, c3]) => {
                (c1 > 0.0 && c3 > 0.0).then_some((c1 * c2 - c3) / (c1 * c2 + c3))
            }
        }
    }

    /// As [`flutter_margin`](Self::flutter_margin), but zero where a real eigenvalue is.
    pub(crate) fn divergence_margin(&self) -> Option<f64> {
        if self.tyre() != Tyre::Rigid {
            return None;
        }
        let state = self.uniform_state().ok()?;
        let coefficients = match Characteristic::at(self, &state) {
            Characteristic::Circle(coefficients) => coefficients,
            Characteristic::Straight { longitudinal, lateral } => product(longitudinal, lateral),
            Characteristic::Tyre(_) => return None,
            Characteristic::Lateral([c1, c2, c3]) => {
                return (c1 > 0.0 && c1 * c2 > c3).then_some(c3 / (c1 * c2).abs());
            }
        };
        let [c1, _, c3, c4, c5] = coefficients;
        let [second, fourth] = determinants(coefficients);
        let others = [c1, c3, second, fourth].into_iter().all(|condition| condition > 0.0);
        others.then_some(c5 / (c1 * c4).abs())
    }

    /// The yaw rate `w_crit(l)` in rad/s at which a plain wheel changes its stability, at every radius the same; `None`
    /// where it does not, and for a wheel with dampers, different stiffnesses or a spring about the king pin.
    ///
    /// ```
    /// let critical = kingpin::Wheel::default().critical_yaw_rate().unwrap();
    /// assert!((critical - 8.43103697014).abs() < 1e-11);
    /// ```
    pub fn critical_yaw_rate(&self) -> Option<f64> {
        if !self.is_plain() {
            return None;
        }
        let body = self.body();
        let [stiff, inertial] = hopf_condition(&body);
        let squared = -stiff / inertial;
        (squared > 0.0 && squared.is_finite() && beside_the_hopf_condition(&body, squared))
            .then(|| squared.sqrt())
    }

    /// The caster length `l_crit = l_c + (J_Cz + J_wzeta)/(m_c l_c)` in m above which the plain wheel is stable in
    /// rectilinear towing at every speed; `None` where there is none, as for [`critical_yaw_rate`](Self::critical_yaw_rate).
    pub fn critical_caster_length(&self) -> Option<f64> {
        let arm = self.get(Key::LC);
        let inertia = self.get(Key::JCz) + self.get(Key::JWzeta);
        (self.is_plain() && arm > 0.0).then(|| arm + inertia / (self.get(Key::MC) * arm))
    }
}

/// Whether a plain wheel has a uniform motion on a circle wide enough, and the Hurwitz conditions other than
/// `N + D omega^2 < 0` hold.
fn beside_the_hopf_condition(body: &Body<f64>, yaw_rate_squared: f64) -> bool {
    let polynomial = plain_characteristic_polynomial(body, yaw_rate_squared);
    let [c1, _, c3, _, c5] = polynomial;
    let [second, _] = determinants(polynomial);
    let remaining = body.lateral_stiffness * body.caster_length - body.static_moment * yaw_rate_squared;
    [remaining, c1, c3, c5, second].into_iter().all(|condition| condition > 0.0)
}
