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

/// A number squeezed between minus one and one, its sign and its zeros kept.
fn bounded(value: f64) -> f64 {
    if value.is_finite() { value / (1.0 + value.abs()) } else { value.signum() }
}

/// Product over `values` of the distance to the real number `target`, pairs of complex numbers counting once.
fn distance(values: &[Complex64], target: f64) -> f64 {
    values
        .iter()
        .filter(|value| value.im >= 0.0)
        .map(
            |value| {
                if value.im > 0.0 { bounded((value - target).norm()) } else { bounded(value.re - target) }
            },
        )
        .product()
}

/// Changes sign where another multiplier reaches `target`, at which one of them is already: of the two nearest ones the sum
/// counts, which stays smooth where they collide.
fn second_at(multipliers: &[Complex64], target: f64) -> Option<f64> {
    let mut sorted = multipliers.to_vec();
    sorted.sort_by(|a, b| (a - target).norm().total_cmp(&(b - target).norm()));
    let [first, second, rest @ ..] = &sorted[..] else { return None };
    Some(bounded((first + second).re - 2.0 * target) * distance(rest, target))
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
            product *= if value.im.abs() > 1e-14 * value.norm() { 1.0 } else { bounded(value.re) };
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
            add(SpecialKind::CuspOfCycles, coefficient);
            add(SpecialKind::Resonance1, second_at(multipliers, 1.0));
            add(SpecialKind::FoldFlip, (!rest.is_empty()).then(|| distance(&rest, -1.0)));
            add(SpecialKind::FoldTorus, pair_product(&rest));
        }
        Kind::Doubling => {
            let rest = without(multipliers, &[-one]);
            add(SpecialKind::GeneralizedPeriodDoubling, coefficient);
            add(SpecialKind::Resonance2, second_at(multipliers, -1.0));
            add(SpecialKind::FoldFlip, (!rest.is_empty()).then(|| distance(&rest, 1.0)));
            add(SpecialKind::PeriodDoublingTorus, pair_product(&rest));
        }
        Kind::Torus => {
            let critical = Complex64::from_polar(1.0, angle);
            let rest = without(multipliers, &[critical, critical.conj()]);
            add(SpecialKind::Chenciner, coefficient);
            add(SpecialKind::Resonance3, Some(angle - 2.0 * PI / 3.0));
            add(SpecialKind::Resonance4, Some(angle - FRAC_PI_2));
            add(SpecialKind::FoldTorus, (!rest.is_empty()).then(|| distance(&rest, 1.0)));
            add(SpecialKind::PeriodDoublingTorus, (!rest.is_empty()).then(|| distance(&rest, -1.0)));
            add(SpecialKind::DoubleTorus, pair_product(&rest));
        }
        Kind::Cycle => {
            add(SpecialKind::FoldOfCycles, (!multipliers.is_empty()).then(|| distance(multipliers, 1.0)));
            add(SpecialKind::PeriodDoubling, (!multipliers.is_empty()).then(|| distance(multipliers, -1.0)));
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
        TestFunction::new(SpecialKind::Chenciner).changing(&[0]),
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

/// Logarithm of the modulus of a multiplier below which it is not decided on which side of the unit circle it is: next to another
/// bifurcation multipliers are known to the root of their error only.
const UNDECIDED: f64 = 1e-6;
/// Distance from the unit circle within which a located pair counts as on it.
const NEAR_CIRCLE: f64 = 1e-5;

#[cfg(test)]
mod unit {
    use super::*;

    #[test]
    fn the_second_multiplier_at_a_target_changes_the_sign_smoothly() {
        let real = |values: &[f64]| -> Vec<Complex64> { values.iter().map(|&value| value.into()).collect() };
        let before = second_at(&real(&[1.0, 0.99, 0.3]), 1.0).expect("two");
        let after = second_at(&real(&[1.0, 1.01, 0.3]), 1.0).expect("two");
        assert!(before * after < 0.0);
        // Which of two others is the nearer one does not matter.
        let one = second_at(&real(&[1.0, 0.5, 1.6]), 1.0).expect("two");
        let other = second_at(&real(&[1.0, 0.4, 1.5]), 1.0).expect("two");
        assert!(one * other > 0.0);
        assert!(second_at(&real(&[1.0]), 1.0).is_none());
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
