//! Linear stability: the published digits, eigenvalues, Routh-Hurwitz, critical speeds.

use approx::assert_relative_eq;
use kingpin::characteristic::{characteristic_polynomial, roots};
use kingpin::{Key, UniformMotion, Wheel};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

fn wheel(settings: &[(Key, f64)]) -> Wheel {
    settings.iter().fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value).unwrap())
}

/// The Jacobian of the five-state model.
fn jacobian(motion: &UniformMotion) -> [[f64; 5]; 5] {
    let rows = motion.jacobian();
    std::array::from_fn(|row| std::array::from_fn(|column| rows[row][column]))
}

#[test]
fn critical_yaw_rate_to_all_known_digits() {
    for (l, known) in [
        (0.08, 8.43103697014),
        (0.05, 5.02582345133),
        (0.06, 7.58727737552),
        (0.1, 8.21277233215),
        (0.2, 6.41924311632),
        (0.080643749, 8.431435192850),
    ] {
        let critical = wheel(&[(Key::L, l)]).critical_yaw_rate().unwrap();
        assert!((critical - known).abs() < 0.6e-11, "{l}: {critical}");
    }
    assert_eq!(wheel(&[(Key::L, 0.04)]).critical_yaw_rate(), None);
    assert_eq!(wheel(&[(Key::CQ, 0.1)]).critical_yaw_rate(), None);
}

#[test]
fn critical_caster_length_of_rectilinear_towing() {
    let critical = Wheel::default().critical_caster_length().unwrap();
    assert!((critical - 0.0460319361277).abs() < 0.6e-13, "{critical}");
    for (l, stable) in [(critical * (1.0 - 1e-9), false), (critical * (1.0 + 1e-9), true)] {
        let straight = wheel(&[(Key::L, l), (Key::TurningRadius, f64::INFINITY)]);
        assert_eq!(straight.uniform_motion().unwrap().is_stable(), Some(stable));
        assert_eq!(straight.critical_speed(), None);
    }
}

/// The Hopf point of l = 0.08 m, r = 1 m, from the closed forms in 50-digit arithmetic.
#[test]
fn eigenvalues_at_the_hopf_point() {
    let critical = Wheel::default().critical_speed().unwrap();
    assert_relative_eq!(critical.speed, 8.431036970142928, max_relative = 1e-14);
    assert!(critical.residual < 1e-11, "{}", critical.residual);
    let eigenvalues = wheel(&[(Key::V, critical.speed)]).uniform_motion().unwrap().eigenvalues();
    assert_relative_eq!(eigenvalues[0].im, 43.25539211958626, max_relative = 1e-14);
    assert_eq!(eigenvalues[0].conj(), eigenvalues[1]);
}

/// 20,000 random (v, l, r): stable exactly when (v/r)^2 < w_crit^2(l), by four ways that share little.
#[test]
fn stable_exactly_below_the_critical_yaw_rate() {
    let mut runner = TestRunner::deterministic();
    let ranges = (0.05..12.0_f64, 0.02..0.3_f64, 0.3..6.0_f64);
    let (mut motions, mut stable) = (0, 0);
    while motions < 20_000 {
        let (v, l, r) = ranges.new_tree(&mut runner).unwrap().current();
        let wheel = wheel(&[(Key::V, v), (Key::L, l), (Key::TurningRadius, r)]);
        let Ok(motion) = wheel.uniform_motion() else { continue };
        motions += 1;
        let predicted = wheel.critical_yaw_rate().is_some_and(|critical| v / r < critical);
        stable += usize::from(predicted);
        assert_eq!(motion.is_stable(), Some(predicted), "{v} {l} {r}");
        assert_eq!(motion.growth_rate() < 0.0, predicted, "{v} {l} {r}");
        let from_jacobian = roots(&characteristic_polynomial(&jacobian(&motion)));
        assert_eq!(from_jacobian[0].re < 0.0, predicted, "{v} {l} {r}");
    }
    assert!(stable > 4_000 && stable < 17_000, "{stable}");
}

proptest! {
    /// The closed form of the coefficients against the Jacobian from automatic differentiation, at any plain wheel.
    #[test]
    fn closed_form_of_the_characteristic_polynomial(
        v in 0.1..10.0, l in 0.02..0.3, curvature in 0.0..2.0, k in 20.0..500.0, m_c in 0.01..0.5, l_c in -0.05..0.25,
    ) {
        let wheel = wheel(&[
            (Key::V, v), (Key::L, l), (Key::Curvature, curvature), (Key::K, k), (Key::MC, m_c), (Key::LC, l_c),
        ]);
        if let Ok(motion) = wheel.uniform_motion() {
            let closed = motion.characteristic_polynomial();
            let expanded = characteristic_polynomial(&jacobian(&motion));
            let size = motion.eigenvalues().iter().map(|root| root.norm()).fold(0.0, f64::max);
            for (index, (closed, expanded)) in closed.into_iter().zip(expanded).enumerate() {
                let error = (closed - expanded).abs() / size.powi(index as i32 + 1);
                prop_assert!(error < 1e-12, "c{}: {closed} {expanded}", index + 1);
            }
        }
    }

    /// The closed form of the Hopf condition against the sign of the Hurwitz determinant, at any plain wheel.
    #[test]
    fn critical_yaw_rate_of_any_plain_wheel(
        l in 0.02..0.3, k in 20.0..500.0, m_c in 0.01..0.5, m_w in 0.05..1.0, l_c in -0.05..0.25, j in 1e-6..1e-2,
    ) {
        let wheel = wheel(&[
            (Key::L, l), (Key::K, k), (Key::MC, m_c), (Key::MW, m_w), (Key::LC, l_c), (Key::JWzeta, j),
            (Key::TurningRadius, 1e3),
        ]);
        let critical = wheel.critical_yaw_rate();
        let stable = |yaw_rate: f64| {
            wheel.with(Key::V, 1e3 * yaw_rate).ok()?.uniform_motion().ok()?.is_stable()
        };
        match critical {
            Some(critical) if critical < 9.0 => {
                prop_assert!(stable(critical * (1.0 - 1e-6)) != stable(critical * (1.0 + 1e-6)));
            }
            Some(_) => {}
            None => {
                let all: Vec<bool> = (1..60).filter_map(|tenths| stable(0.15 * f64::from(tenths))).collect();
                prop_assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{all:?}");
            }
        }
    }

    /// At wheels of every kind the Hurwitz conditions and the eigenvalues say the same.
    #[test]
    fn hurwitz_and_eigenvalues_agree(
        v in 0.1..10.0, l in 0.02..0.3, curvature in 0.0..2.0, k_u in 10.0..1e3, c in 0.0..1.0, k_psi in 0.0..0.2,
        l_c in -0.05..0.25,
    ) {
        let wheel = wheel(&[
            (Key::V, v), (Key::L, l), (Key::Curvature, curvature), (Key::KU, k_u), (Key::CU, c), (Key::CQ, 0.3 * c),
            (Key::CPsi, 1e-3 * c), (Key::KPsi, k_psi), (Key::LC, l_c),
        ]);
        if let Ok(motion) = wheel.uniform_motion() {
            let growth_rate = motion.growth_rate();
            if growth_rate.abs() > 1e-7 {
                prop_assert_eq!(motion.is_stable(), Some(growth_rate < 0.0), "{}", growth_rate);
            }
        }
    }
}

/// In rectilinear towing the longitudinal oscillation is decoupled, and neutral without damping.
#[test]
fn rectilinear_towing_decouples() {
    let straight =
        wheel(&[(Key::TurningRadius, f64::INFINITY), (Key::KU, 60.0), (Key::CQ, 0.2), (Key::KPsi, 0.05)]);
    let motion = straight.uniform_motion().unwrap();
    let mass: f64 = 0.3519 + 0.0668 + 4.63e-5 / 0.0016;
    let neutral = motion.eigenvalues().into_iter().filter(|eigenvalue| eigenvalue.re == 0.0);
    for (eigenvalue, sign) in neutral.zip([1.0, -1.0]) {
        assert_relative_eq!(eigenvalue.im, sign * (60.0 / mass).sqrt(), max_relative = 1e-14);
    }
    assert!(motion.is_stable() == Some(true) && motion.growth_rate() < -0.1);
    let expanded = characteristic_polynomial(&jacobian(&motion));
    for (closed, expanded) in motion.characteristic_polynomial().into_iter().zip(expanded) {
        assert_relative_eq!(closed, expanded, max_relative = 1e-12);
    }
    // With longitudinal damping all five count.
    let damped = straight.with(Key::CU, 0.01).unwrap().uniform_motion().unwrap();
    assert_relative_eq!(damped.growth_rate(), -0.005 / mass, max_relative = 1e-9);
}

/// The trace of the Jacobian is the sum of the eigenvalues, the determinant their product.
#[test]
fn eigenvalues_of_a_damped_wheel() {
    let motion = wheel(&[(Key::CU, 0.2), (Key::CQ, 0.1), (Key::CPsi, 1e-3), (Key::KU, 250.0)])
        .uniform_motion()
        .unwrap();
    let jacobian = jacobian(&motion);
    let trace: f64 = (0..5).map(|index| jacobian[index][index]).sum();
    let sum: f64 = motion.eigenvalues().iter().map(|eigenvalue| eigenvalue.re).sum();
    assert_relative_eq!(sum, trace, max_relative = 1e-12);
    for eigenvalue in motion.eigenvalues() {
        // The smallest singular value of (A - s I) is bounded by its determinant over the product of row norms.
        let mut shifted = jacobian.map(|row| row.map(num_complex::Complex64::from));
        (0..5).for_each(|index| shifted[index][index] -= eigenvalue);
        assert!(relative_determinant(shifted) < 1e-12, "{eigenvalue}");
    }
}

/// |det A| over the product of the row norms, by elimination with partial pivoting.
fn relative_determinant(mut matrix: [[num_complex::Complex64; 5]; 5]) -> f64 {
    let mut determinant = 1.0;
    for row in &mut matrix {
        let norm = row.iter().map(|element| element.norm_sqr()).sum::<f64>().sqrt();
        row.iter_mut().for_each(|element| *element /= norm);
    }
    for column in 0..5 {
        let pivot = (column..5)
            .max_by(|&i, &j| matrix[i][column].norm().total_cmp(&matrix[j][column].norm()))
            .unwrap();
        matrix.swap(column, pivot);
        determinant *= matrix[column][column].norm();
        for row in column + 1..5 {
            let factor = matrix[row][column] / matrix[column][column];
            let above = matrix[column];
            matrix[row].iter_mut().zip(above).for_each(|(element, above)| *element -= factor * above);
        }
    }
    determinant
}

/// Damping that goes to zero leaves the closed form; the general search finds a zero of the growth rate.
/// At low speeds a circle is straight, and there the critical speed is proportional to a small lateral damper.
#[test]
fn a_weak_damper_has_a_critical_speed_below_a_millimetre_a_second() {
    let trolley = Wheel::from_toml(include_str!("../../examples/wheels/trolley.toml")).unwrap();
    let on_circle = trolley.with(Key::TurningRadius, 2.0).unwrap();
    let straight = |damper: f64| trolley.with(Key::CQ, damper).unwrap().critical_speed().unwrap().speed;
    for damper in [0.05, 0.005, 5e-6] {
        let found = on_circle.with(Key::CQ, damper).unwrap().critical_speed().unwrap().speed;
        assert_relative_eq!(found, straight(damper), max_relative = 1e-3);
    }
}

#[test]
fn critical_speed_of_damped_wheels() {
    let plain = Wheel::default().critical_speed().unwrap().speed;
    let nearly = wheel(&[(Key::CQ, 1e-9)]).critical_speed().unwrap();
    assert_relative_eq!(nearly.speed, plain, max_relative = 1e-7);
    assert_eq!(wheel(&[(Key::CU, 0.1), (Key::CQ, 0.1)]).critical_speed(), None);
    for c in [0.01, 0.05] {
        let damped = wheel(&[(Key::CU, c), (Key::CQ, c)]);
        let critical = damped.critical_speed().unwrap();
        assert!(critical.residual < 1e-10, "{critical:?}");
        assert_eq!(critical.yaw_rate, critical.speed);
        let stable = |factor: f64| {
            damped.with(Key::V, factor * critical.speed).unwrap().uniform_motion().unwrap().is_stable()
        };
        assert_ne!(stable(1.0 - 1e-6), stable(1.0 + 1e-6));
    }
}
