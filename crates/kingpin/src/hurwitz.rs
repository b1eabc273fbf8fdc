//! The Routh-Hurwitz conditions of a quintic, and the characteristic polynomial of the uniform motion in closed form.
//!
//! Liénard and Chipart (1914; Gantmacher, *The Theory of Matrices* II, XV 13): all roots of
//! `s^5 + c1 s^4 + c2 s^3 + c3 s^2 + c4 s + c5` lie in the open left half-plane exactly when `c1, c3, c5` and the Hurwitz
//! determinants `D2 = c1 c2 - c3` and `D4 = D2 (c3 c4 - c2 c5) - (c1 c4 - c5)^2` are positive.
//!
//! At the uniform motion of the plain wheel (equal stiffnesses, no dampers, no spring about the king pin) the odd
//! coefficients are proportional to the forward speed `V0`, which the even ones do not contain: `V0` cancels from all
//! five conditions. `D4` is moreover a positive multiple of `-omega^2 (N + D omega^2)` with `N` and `D` functions of the
//! caster length, so that no root need be taken to decide stability and rectilinear towing is no special case.

use crate::arithmetic::Arithmetic;
use crate::body::Body;
use crate::bounded::Bounded;

/// The coefficients `c1 ... c5`.
pub(crate) type Quintic<T> = [T; 5];

/// The second and the fourth Hurwitz determinant.
#[inline(always)]
pub(crate) fn determinants<T: Arithmetic>([c1, c2, c3, c4, c5]: Quintic<T>) -> [T; 2] {
    let second = c1 * c2 - c3;
    let mixed = c1 * c4 - c5;
    [second, second * (c3 * c4 - c2 * c5) - mixed * mixed]
}

/// Whether all roots lie in the open left half-plane of a polynomial whose coefficients carry bounds on their errors; `None` where
/// these could decide it either way.
///
/// Every coefficient and every Hurwitz determinant of a stable polynomial is positive, so that one of them that is surely negative
/// suffices to refute it.
pub(crate) fn is_surely_stable(coefficients: &[Bounded]) -> Option<bool> {
    match *coefficients {
        [c1, c2, c3] => surely([c1, c3, c1 * c2 - c3], [c2]),
        [c1, c2, c3, c4, c5] => {
            let [second, fourth] = determinants([c1, c2, c3, c4, c5]);
            surely([c1, c3, c5, second, fourth], [c2, c4])
        }
        _ => is_surely_stable_by_routh(coefficients),
    }
}

/// The same by Routh's array (1877), whose first column is positive exactly where all roots lie in the open left half-plane.
fn is_surely_stable_by_routh(coefficients: &[Bounded]) -> Option<bool> {
    if coefficients.iter().any(|coefficient| coefficient.is_negative()) {
        return Some(false);
    }
    let all: Vec<Bounded> = std::iter::once(Bounded::from(1.0)).chain(coefficients.iter().copied()).collect();
    let every_second = |first: usize| all.iter().copied().skip(first).step_by(2).collect::<Vec<_>>();
    let (mut above, mut row) = (every_second(0), every_second(1));
    for _ in coefficients {
        let pivot = *row.first()?;
        if pivot.is_negative() {
            return Some(false);
        }
        if !pivot.is_positive() {
            return None;
        }
        let entry = |row: &[Bounded], index: usize| row.get(index).copied().unwrap_or(Bounded::from(0.0));
        let quotient = above[0] / pivot;
        let next =
            (1..above.len()).map(|index| entry(&above, index) - quotient * entry(&row, index)).collect();
        above = std::mem::replace(&mut row, next);
    }
    Some(true)
}

/// Whether conditions hold that are sufficient and necessary together; beside them others may fail, each of which is necessary.
pub(crate) fn surely<const S: usize, const N: usize>(
    sufficient: [Bounded; S],
    necessary: [Bounded; N],
) -> Option<bool> {
    if sufficient.iter().chain(&necessary).any(|condition| condition.is_negative()) {
        return Some(false);
    }
    sufficient.iter().all(|condition| condition.is_positive()).then_some(true)
}

/// The characteristic polynomial at the uniform motion of the plain wheel, the odd coefficients divided by `V0`.
///
/// `yaw_rate_squared` is `omega^2`; the stiffness is `k_q`.
#[inline(always)]
pub(crate) fn plain_characteristic_polynomial<T: Arithmetic>(
    body: &Body<T>,
    yaw_rate_squared: T,
) -> Quintic<T> {
    let (l, m, k, w2) = (body.caster_length, body.static_moment, body.lateral_stiffness, yaw_rate_squared);
    let (mass, inertia) = (body.rolling_mass, body.yaw_inertia);
    let inverse = body.inverse_rolling_mass * body.inverse_yaw_inertia;
    let inverse_l = inverse / l;
    let elastic = k * l;
    let inertial = m * w2;
    let remaining = elastic - inertial;
    let c1 = m * body.inverse_yaw_inertia;
    let c2 = (inertia * (mass * w2 + k) + mass * l * (elastic - inertial) + (m + m) * inertial) * inverse;
    let c3 = (mass * l + m) * (elastic + inertial) * inverse_l;
    let c4 = remaining * (mass * l * w2 + elastic - inertial - inertial) * inverse;
    let c5 = remaining * remaining * inverse_l;
    [c1, c2, c3, c4, c5]
}

/// `[N, D]` of the Hopf condition `N + D omega^2 = 0` of the plain wheel, both divided by
/// `k l (M l) (J + m l) (J + M l^2)`, which makes `N` a pure number of the order of one.
///
/// Where the other conditions hold the plain wheel is stable exactly if `N + D omega^2` is negative.
#[inline(always)]
pub(crate) fn hopf_condition<T: Arithmetic>(body: &Body<T>) -> [T; 2] {
    let (l, m, k) = (body.caster_length, body.static_moment, body.lateral_stiffness);
    let inertia = body.yaw_inertia;
    let ml = body.rolling_mass * l;
    let [two, three, five, six] = [2.0, 3.0, 5.0, 6.0].map(T::from);
    let (m2, ml2, mlm) = (m * m, ml * ml, ml * m);
    let moment = l * m;
    let stiff = inertia * (l * (ml2 + three * m2) - inertia * (ml + m)) - l * moment * (ml2 - mlm + two * m2);
    let inertial = m * inertia * (inertia * (ml + m) + l * (ml2 - five * m2))
        + moment * moment * (ml2 - five * mlm + six * m2);
    let scale = T::from(1.0) / (ml * (inertia + moment) * (inertia + ml * l));
    [stiff * scale, inertial * scale / (k * l)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stable_and_unstable_quintics() {
        // (s+1)(s+2)(s+3)(s^2 + 2 a s + 4) by hand for a = 1 and a = -0.01.
        let product = |a: f64| {
            let cubic = [1.0, 6.0, 11.0, 6.0];
            let quadratic = [1.0, 2.0 * a, 4.0];
            let mut coefficients = [0.0; 6];
            for (i, one) in cubic.iter().enumerate() {
                for (j, other) in quadratic.iter().enumerate() {
                    coefficients[i + j] += one * other;
                }
            }
            [1, 2, 3, 4, 5].map(|index: usize| coefficients[index])
        };
        let stable = |coefficients: [f64; 5]| is_surely_stable(&coefficients.map(Bounded::read));
        assert_eq!(stable(product(1.0)), Some(true));
        assert_eq!(stable(product(-0.01)), Some(false));
        assert!(determinants(product(0.0))[1].abs() < 1e-9);
        assert_eq!(stable([5.0, 10.0, 10.0, 5.0, -1.0]), Some(false));
        assert_eq!(stable(product(1e-16)), None);
    }
}
