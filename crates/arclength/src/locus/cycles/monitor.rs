//! Test functions for points of codimension two on curves of special cycles.
//!
//! All are smooth where they vanish, also where multipliers collide there. Source of the list: Kuznetsov, *Elements of Applied
//! Bifurcation Theory*, 3rd edition (2004), chapter 9.

use crate::branch::SpecialKind;
use crate::continuation::events::{Spectrum, TestFunction};
use crate::cycle::defining::Kind;
use crate::cycle::floquet::Floquet;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Distance to its target within which a multiplier counts where all that matters is whether it is there.
const NARROW: f64 = 1e-2;
/// The same where a test function is to be smooth over long steps.
const WIDE: f64 = 1.0;

/// A number squeezed into the unit circle, its direction and its zeros kept; linear within `width` of zero.
fn squeezed(value: Complex64, width: f64) -> Complex64 {
    let size = value.norm();
    if size.is_finite() {
        value / (width + size)
    } else {
        // Numbers too large for their directions are real or pairs, whose directions cancel.
        Complex64::from(if value.im == 0.0 { value.re.signum() } else { 1.0 })
    }
}

/// Product over `values` of the distance to a real number. Conjugate pairs give positive factors; where two real ones become a pair
/// it stays smooth.
fn distance(values: &[Complex64], target: f64, width: f64) -> f64 {
    values.iter().map(|value| squeezed(value - target, width)).product::<Complex64>().re
}

/// The derivative of the polynomial that has the multipliers as zeros at one of them, `target`: it vanishes where another one arrives
/// there, and stays smooth where they collide.
fn second_at(multipliers: &[Complex64], target: f64, width: f64) -> Option<f64> {
    let sum: Complex64 = (0..multipliers.len())
        .map(|index| {
            let others = multipliers.iter().enumerate().filter(|(other, _)| *other != index);
            let weight = width / (width + (multipliers[index] - target).norm());
            others.map(|(_, value)| squeezed(value - target, width)).product::<Complex64>() * weight
        })
        .sum();
    (multipliers.len() > 1).then_some(sum.re)
}

/// The multipliers without the `count` that are nearest to `critical`.
fn without(multipliers: &[Complex64], critical: &[Complex64]) -> Vec<Complex64> {
    let mut rest = multipliers.to_vec();
    for target in critical {
        let nearest =
            (0..rest.len()).min_by(|&a, &b| (rest[a] - target).norm().total_cmp(&(rest[b] - target).norm()));
        if let Some(nearest) = nearest {
            rest.remove(nearest);
        }
    }
    rest
}

/// Changes sign where a pair of multipliers has the product one.
fn pair_product(multipliers: &[Complex64]) -> Option<f64> {
    if multipliers.len() < 2 {
        return None;
    }
    let mut product = 1.0;
    for (index, one) in multipliers.iter().enumerate() {
        for other in &multipliers[..index] {
            let value = Complex64::from(1.0) - one * other;
            // Conjugate pairs of factors together are positive; a factor of its own is real.
            product *=
                if value.im.abs() > 1e-14 * value.norm() { 1.0 } else { squeezed(value.re.into(), WIDE).re };
        }
    }
    Some(product)
}

/// The test functions at a special cycle with the nontrivial `multipliers` and the coefficient of its normal form; `angle` is
/// the argument of the critical multipliers of a torus bifurcation.
pub(super) fn tests(
    kind: Kind,
    multipliers: &[Complex64],
    coefficient: Option<f64>,
    angle: f64,
) -> Vec<(SpecialKind, f64)> {
    let mut tests = Vec::new();
    let mut add = |kind: SpecialKind, value: Option<f64>| {
        tests.extend(value.filter(|value| value.is_finite()).map(|value| (kind, value)));
    };
    let one = Complex64::from(1.0);
    match kind {
        Kind::Fold => {
            let rest = without(multipliers, &[one]);
            // The coefficient goes through infinity at a 1:1 resonance, its product with what vanishes there does not.
            let regular = second_at(multipliers, 1.0, NARROW).unwrap_or(1.0);
            add(SpecialKind::CuspOfCycles, coefficient.map(|value| value * regular));
            add(SpecialKind::Resonance1, second_at(multipliers, 1.0, WIDE));
            add(SpecialKind::FoldFlip, (!rest.is_empty()).then(|| distance(&rest, -1.0, WIDE)));
            add(SpecialKind::FoldTorus, pair_product(&rest));
        }
        Kind::Doubling => {
            let rest = without(multipliers, &[-one]);
            // Here at a 1:2 resonance and at a fold.
            let regular = second_at(multipliers, -1.0, NARROW).unwrap_or(1.0) * distance(&rest, 1.0, NARROW);
            add(SpecialKind::GeneralizedPeriodDoubling, coefficient.map(|value| value * regular));
            add(SpecialKind::Resonance2, second_at(multipliers, -1.0, WIDE));
            add(SpecialKind::FoldFlip, (!rest.is_empty()).then(|| distance(&rest, 1.0, WIDE)));
            add(SpecialKind::PeriodDoublingTorus, pair_product(&rest));
        }
        Kind::Torus => {
            let critical = Complex64::from_polar(1.0, angle);
            let rest = without(multipliers, &[critical, critical.conj()]);
            // And here at a fold. Next to a strong resonance rounding is all that is left of it.
            let regular = distance(&rest, 1.0, NARROW);
            let known = coefficient.filter(|_| angle.sin() > NEXT_TO);
            add(SpecialKind::Chenciner, known.map(|value| value * regular));
            add(SpecialKind::Resonance3, Some(angle - 2.0 * PI / 3.0));
            add(SpecialKind::Resonance4, Some(angle - FRAC_PI_2));
            add(SpecialKind::FoldTorus, (!rest.is_empty()).then(|| distance(&rest, 1.0, WIDE)));
            add(SpecialKind::PeriodDoublingTorus, (!rest.is_empty()).then(|| distance(&rest, -1.0, WIDE)));
            add(SpecialKind::DoubleTorus, pair_product(&rest));
        }
        Kind::Cycle => {
            add(
                SpecialKind::FoldOfCycles,
                (!multipliers.is_empty()).then(|| distance(multipliers, 1.0, WIDE)),
            );
            add(
                SpecialKind::PeriodDoubling,
                (!multipliers.is_empty()).then(|| distance(multipliers, -1.0, WIDE)),
            );
            add(SpecialKind::Torus, pair_product(multipliers));
        }
        Kind::BranchPoint => {}
    }
    tests
}

/// The test functions on a curve of a kind; the directions counted are those of the multipliers that are not critical.
pub(super) fn test_functions(kind: Kind) -> &'static [TestFunction<SpecialKind>] {
    const FOLD: &[TestFunction<SpecialKind>] = &[
        TestFunction::new(SpecialKind::CuspOfCycles).changing(&[0]),
        TestFunction::new(SpecialKind::Resonance1).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::FoldFlip).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::FoldTorus).changing(&[0, 2]).of_spectrum(),
    ];
    const DOUBLING: &[TestFunction<SpecialKind>] = &[
        TestFunction::new(SpecialKind::GeneralizedPeriodDoubling).changing(&[0]),
        TestFunction::new(SpecialKind::Resonance2).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::FoldFlip).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::PeriodDoublingTorus).changing(&[0, 2]).of_spectrum(),
    ];
    const TORUS: &[TestFunction<SpecialKind>] = &[
        TestFunction::new(SpecialKind::Chenciner).changing(&[0]).partial(),
        TestFunction::new(SpecialKind::Resonance3).changing(&[0]),
        TestFunction::new(SpecialKind::Resonance4).changing(&[0]),
        TestFunction::new(SpecialKind::FoldTorus).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::PeriodDoublingTorus).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::DoubleTorus).changing(&[0, 2]).of_spectrum(),
    ];
    const CYCLE: &[TestFunction<SpecialKind>] = &[
        TestFunction::new(SpecialKind::FoldOfCycles).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::PeriodDoubling).changing(&[1]).of_spectrum(),
        TestFunction::new(SpecialKind::Torus).changing(&[0, 2]).of_spectrum(),
    ];
    match kind {
        Kind::Cycle => CYCLE,
        Kind::Fold => FOLD,
        Kind::Doubling => DOUBLING,
        Kind::Torus => TORUS,
        Kind::BranchPoint => &[],
    }
}

/// Growth exponents of the multipliers that are not critical; `angle` is that of a torus bifurcation.
pub(super) fn growth(kind: Kind, floquet: &Floquet, angle: f64) -> Spectrum {
    let critical: &[Complex64] = match kind {
        Kind::Fold => &[Complex64::ZERO],
        Kind::Doubling => &[Complex64::new(0.0, PI)],
        Kind::Torus => &[Complex64::new(0.0, angle), Complex64::new(0.0, -angle)],
        Kind::BranchPoint | Kind::Cycle => &[],
    };
    let mut spectrum = floquet.growth();
    spectrum.exponents = without(&spectrum.exponents, critical);
    spectrum.noise = UNDECIDED.max(spectrum.noise);
    spectrum.unstable = spectrum.exponents.iter().filter(|exponent| exponent.re > 0.0).count();
    spectrum.decided = !floquet.is_contradictory()
        && spectrum.exponents.iter().all(|exponent| exponent.re.abs() > spectrum.noise);
    spectrum
}

/// Whether the test function is a coefficient of the normal form, of any size, and not one made of multipliers.
pub(super) fn is_coefficient(kind: SpecialKind) -> bool {
    matches!(
        kind,
        SpecialKind::CuspOfCycles | SpecialKind::GeneralizedPeriodDoubling | SpecialKind::Chenciner
    )
}

/// Whether a zero of the test function is what it is called: pairs with the product one have to be complex.
pub(super) fn is_genuine(sought: SpecialKind, kind: Kind, multipliers: &[Complex64]) -> bool {
    let by_pair = match sought {
        SpecialKind::FoldTorus | SpecialKind::PeriodDoublingTorus => kind != Kind::Torus,
        SpecialKind::DoubleTorus | SpecialKind::Torus => true,
        _ => false,
    };
    if !by_pair {
        return true;
    }
    let on_circle =
        multipliers.iter().filter(|value| value.im > 0.0 && value.norm().ln().abs() < NEAR_CIRCLE);
    on_circle.count() > usize::from(kind == Kind::Torus)
}

/// Whether one of the multipliers that are not trivial is the one that the curve is about: next to a homoclinic orbit the equations of a
/// curve may be solved, within their tolerance, by cycles that are none of its.
pub(super) fn is_critical(kind: Kind, multipliers: &[Complex64], trivial_error: f64) -> bool {
    let target = match kind {
        Kind::Fold => 1.0,
        Kind::Doubling => -1.0,
        Kind::Torus | Kind::BranchPoint | Kind::Cycle => return true,
    };
    let nearest = multipliers.iter().map(|value| (value - target).norm()).fold(f64::INFINITY, f64::min);
    let tolerance = if multipliers.len() > 1 { CRITICAL_BESIDE_OTHERS } else { CRITICAL };
    nearest < tolerance.max(trivial_error.sqrt())
}

/// Distance from its target within which a multiplier is the critical one, where it is the only one that is not trivial, and where others
/// may come near to it: of three that meet each is known to the third root of its error.
const CRITICAL: f64 = 1e-3;
const CRITICAL_BESIDE_OTHERS: f64 = 1e-2;
/// Distance of the argument from that of a strong resonance within which a point counts as next to it.
pub(super) const NEXT_TO: f64 = 1e-2;
/// Logarithm of the modulus of a multiplier below which it is not decided on which side of the unit circle it is: next to another
/// bifurcation multipliers are known to the root of their error only.
const UNDECIDED: f64 = 1e-6;
/// Distance from the unit circle within which a located pair counts as on it.
const NEAR_CIRCLE: f64 = 1e-5;

#[cfg(test)]
mod unit {
    use super::*;

    fn real(values: &[f64]) -> Vec<Complex64> {
        values.iter().map(|&value| value.into()).collect()
    }

    #[test]
    fn the_second_multiplier_at_a_target_changes_the_sign() {
        let test = |values: &[Complex64]| second_at(values, 1.0, WIDE).expect("two");
        assert!(test(&real(&[1.0, 0.99, 0.3])) * test(&real(&[1.0, 1.01, 0.3])) < 0.0);
        // Which of two others is the nearer one does not matter.
        assert!(test(&real(&[1.0, 0.5, 1.6])) * test(&real(&[1.0, 0.4, 1.5])) > 0.0);
        // Rounding makes a pair of two that are there.
        let pair = [Complex64::new(1.0 - 1e-9, 1e-5), Complex64::new(1.0 - 1e-9, -1e-5)];
        assert!((test(&pair) - test(&real(&[1.0, 1.0 - 2e-9]))).abs() < 1e-9);
        assert!(second_at(&real(&[1.0]), 1.0, WIDE).is_none());
    }

    #[test]
    fn a_pair_elsewhere_does_not_count_as_a_second_multiplier() {
        // The real part passes 1.
        let pair = |re: f64| {
            let mut all = real(&[1.0]);
            all.extend([Complex64::new(re, 1.5), Complex64::new(re, -1.5)]);
            second_at(&all, 1.0, WIDE).expect("two")
        };
        assert!(pair(0.9) * pair(1.1) > 0.0);
        // Two real ones become a pair.
        let [before, after] = [
            real(&[1.0, -0.95, -0.96]),
            vec![1.0.into(), Complex64::new(-0.95, 0.1), Complex64::new(-0.95, -0.1)],
        ];
        assert!(
            (second_at(&before, 1.0, WIDE).expect("two") - second_at(&after, 1.0, WIDE).expect("two")).abs()
                < 0.01
        );
        // One of a pair that rounding made, its partner taken for the critical one, is real.
        assert!(distance(&[Complex64::new(-1.0, -1e-8)], 1.0, WIDE) < 0.0);
        assert!(distance(&[Complex64::new(-1.0, 1e-8)], 1.0, WIDE) < 0.0);
    }

    #[test]
    fn a_pair_on_the_circle_changes_the_sign_of_the_product() {
        let pair = |modulus: f64| {
            let value = Complex64::from_polar(modulus, 1.0);
            vec![value, value.conj(), Complex64::from(0.2)]
        };
        assert!(pair_product(&pair(0.9)).expect("pairs") * pair_product(&pair(1.1)).expect("pairs") < 0.0);
    }
}
