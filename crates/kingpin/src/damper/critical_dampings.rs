//! The dampings at which the uniform motion of one wheel gains or loses its stability.
//!
//! A damper does no work in the uniform motion, so that the motion does not depend on it and the characteristic polynomial is
//! `p + c q`, linear in its coefficient `c`. At an imaginary eigenvalue `i omega` the even and the odd part vanish together; `c`
//! eliminated, a polynomial in `omega^2` remains, whose positive roots give every `c` (D-decomposition, Neimark 1948). Each is
//! then narrowed down to where the growth rate changes its sign.

use crate::critical_speed::bisect;
use crate::linear_stability::polynomial_of;
use crate::parameters::Key;
use crate::wheel::Wheel;
use arclength::linear::eigenvalues::eigenvalues;

/// Roots with a smaller imaginary part than this, relative to the modulus, may be real but for rounding.
const NEAR_REAL_AXIS: f64 = 1e-4;
/// Relative distances within which, one after the other, the growth rate is looked at for a change of its sign beside a root, which may
/// be ill-conditioned.
const NEAR: [f64; 3] = [1e-6, 1e-4, 1e-2];

/// Two that are found in both ways agree to this part.
const SAME: f64 = 1e-9;
/// Samples of the growth rate to both sides of the unit of damping, and in a decade.
const SAMPLES: i32 = 60;
const SAMPLES_PER_DECADE: f64 = 10.0;

/// A polynomial by its coefficients, lowest power first.
type Polynomial = Vec<f64>;

/// The dampings of a key, in ascending order, at which the growth rate of a wheel passes through zero. They are sought with polynomials at
/// one and at two times a unit of damping that is neither far too weak nor far too strong.
pub(super) fn critical_dampings(wheel: &Wheel, key: Key, unit: f64) -> Vec<f64> {
    let damped = |damping: f64| wheel.with(key, damping).ok()?.uniform_motion().ok();
    let polynomial = |damping: f64| -> Option<Polynomial> {
        let mut coefficients = polynomial_of(&damped(damping)?.eigenvalues_that_count());
        coefficients.reverse();
        coefficients.push(1.0);
        Some(coefficients)
    };
    let (Some(once), Some(twice)) = (polynomial(unit), polynomial(2.0 * unit)) else { return Vec::new() };
    let slope: Polynomial = once.iter().zip(&twice).map(|(once, twice)| twice - once).collect();
    let start: Polynomial = once.iter().zip(&slope).map(|(once, slope)| once - slope).collect();
    let rate = |damping: f64| Some(damped(damping)?.growth_rate());
    let narrowed = |damping: f64| {
        NEAR.into_iter().find_map(|near| {
            let (low, high) = (damping * (1.0 - near), damping * (1.0 + near));
            let below = rate(low)?;
            if (rate(high)? < 0.0) == (below < 0.0) { None } else { bisect(low, below, high, rate) }
        })
    };
    let multiples = multiples_with_imaginary_roots(&start, &slope);
    let dampings = multiples.into_iter().map(|multiple| multiple * unit);
    let roots = dampings.filter(|damping| *damping > 0.0 && damping.is_finite()).filter_map(narrowed);
    // A root next to a motion that is nearly neutral for any damper may be lost in rounding: changes of the sign between samples are not.
    let sample = |index: i32| unit * 10.0_f64.powf(f64::from(index) / SAMPLES_PER_DECADE);
    let samples: Vec<(f64, f64)> =
        (-SAMPLES..=SAMPLES).filter_map(|index| Some((sample(index), rate(sample(index))?))).collect();
    let changes = samples.windows(2).filter(|pair| (pair[0].1 < 0.0) != (pair[1].1 < 0.0));
    let found = changes.filter_map(|pair| bisect(pair[0].0, pair[0].1, pair[1].0, rate));
    let mut dampings: Vec<f64> = roots.chain(found).collect();
    dampings.sort_by(f64::total_cmp);
    dampings.dedup_by(|next, before| *next - *before <= SAME * *next);
    dampings
}

/// The numbers `c` with which `start + c slope` has a root on the imaginary axis.
fn multiples_with_imaginary_roots(start: &[f64], slope: &[f64]) -> Vec<f64> {
    // Even and odd part at `i omega`, as polynomials in `omega^2`.
    let part = |polynomial: &[f64], first: usize| -> Polynomial {
        let powers = polynomial.iter().skip(first).step_by(2).enumerate();
        powers.map(|(power, coefficient)| if power % 2 == 0 { *coefficient } else { -coefficient }).collect()
    };
    let [even, odd] = [0, 1].map(|first| part(start, first));
    let [even_slope, odd_slope] = [0, 1].map(|first| part(slope, first));
    let mut eliminated = product(&even, &odd_slope);
    for (coefficient, other) in eliminated.iter_mut().zip(product(&even_slope, &odd)) {
        *coefficient -= other;
    }
    let at_rest = -start[0] / slope[0];
    let flutter = positive_roots(&eliminated).into_iter().map(|squared| {
        let [e, o, e_slope, o_slope] =
            [&even, &odd, &even_slope, &odd_slope].map(|part| evaluate(part, squared));
        -(e * e_slope + squared * o * o_slope) / (e_slope * e_slope + squared * o_slope * o_slope)
    });
    flutter.chain([at_rest]).collect()
}

fn product(one: &[f64], other: &[f64]) -> Polynomial {
    let mut product = vec![0.0; one.len() + other.len() - 1];
    for (index, factor) in one.iter().enumerate() {
        for (coefficient, other) in product[index..].iter_mut().zip(other) {
            *coefficient += factor * other;
        }
    }
    product
}

fn evaluate(polynomial: &[f64], at: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |value, coefficient| value * at + coefficient)
}

/// The positive roots, as eigenvalues of the companion matrix.
fn positive_roots(polynomial: &[f64]) -> Vec<f64> {
    let degree = polynomial.iter().rposition(|coefficient| *coefficient != 0.0).unwrap_or(0);
    let mut companion = vec![0.0; degree * degree];
    for index in 0..degree {
        companion[index * degree + degree - 1] = -polynomial[index] / polynomial[degree];
        if index > 0 {
            companion[index * degree + index - 1] = 1.0;
        }
    }
    let roots = eigenvalues(&companion, degree).unwrap_or_default();
    let is_positive = |root: &&num_complex::Complex64| {
        root.re > 0.0 && root.im >= 0.0 && root.im <= NEAR_REAL_AXIS * root.norm()
    };
    roots.iter().filter(is_positive).map(|root| root.re).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Between two of them the growth rate keeps its sign, and at each it changes it.
        #[test]
        fn they_are_all_changes_of_sign(
            l in 0.02..0.2_f64, v in 0.3..12.0_f64, curvature in prop_oneof![Just(0.0), 0.02..1.5_f64],
            others in prop::array::uniform2(prop_oneof![Just(0.0), 1e-3..1.0_f64]), c_psi: bool,
        ) {
            let mut wheel = Wheel::default().with(Key::L, l).unwrap().with(Key::V, v).unwrap();
            wheel = wheel.with(Key::Curvature, curvature).unwrap().with(Key::CU, others[0]).unwrap();
            let (key, other, unit) =
                if c_psi { (Key::CPsi, Key::CQ, 1e-3) } else { (Key::CQ, Key::CPsi, 1.0) };
            wheel = wheel.with(other, others[1] * if c_psi { 1.0 } else { 1e-3 }).unwrap();
            prop_assume!(wheel.uniform_motion().is_ok());
            let critical = critical_dampings(&wheel, key, unit);
            let stable = |damping: f64| wheel.with(key, damping).unwrap().uniform_motion().unwrap().is_stable();
            let mut before: Option<(f64, bool)> = None;
            for index in 0..400 {
                let damping = unit * 1e-6 * 1e10_f64.powf(f64::from(index) / 399.0);
                let Some(here) = stable(damping) else { continue };
                if let Some((earlier, was)) = before {
                    let between = critical.iter().filter(|other| (earlier..damping).contains(*other)).count();
                    prop_assert_eq!(was != here, between % 2 == 1, "{} {} {:?}", earlier, damping, critical);
                }
                before = Some((damping, here));
            }
        }
    }
}
