//! The wheel with a tyre, against what does not come from its code: published Hopf points, the known limit of the straight-tangent
//! theory, the rolling wheel as the tyre grows stiff, and the bristles of the brush one by one.

use approx::assert_relative_eq;
use arclength::VectorField;
use arclength::branch::Criticality;
use arclength::continuation::Stop;
use arclength::control::Control;
use kingpin::branches::{Along, CycleOptions, SLOWEST_ON_CYCLES};
use kingpin::{Key, Tyre, Wheel};
use proptest::prelude::*;
use std::ops::ControlFlow;

use crate::tyres::wheel;

fn inertia_about_king_pin(wheel: &Wheel) -> f64 {
    let get = |key| wheel.get(key);
    get(Key::JCz)
        + get(Key::JWzeta)
        + get(Key::MW) * get(Key::L).powi(2)
        + get(Key::MC) * get(Key::LC).powi(2)
}

/// Of the size of the paper's wheel, towed straight.
fn caster(tyre: Tyre, more: &[(Key, f64)]) -> Wheel {
    let settings = [
        (Key::TurningRadius, f64::INFINITY),
        (Key::Sigma, 0.05),
        (Key::HalfContactLength, 0.02),
        (Key::CAlpha, 300.0),
        (Key::FAz, -20.0),
    ];
    wheel(tyre, &[&settings[..], more].concat())
}

/// Somieski's nose gear (Aerospace Science and Technology 1, 1997): 1 kg m^2 about the king pin, which is rigid.
fn nose_gear(damping: f64) -> Wheel {
    wheel(
        Tyre::Linear,
        &[
            (Key::L, 0.1),
            (Key::LC, 0.05),
            (Key::MW, 1.0),
            (Key::MC, 1.0),
            (Key::JWzeta, 0.9),
            (Key::JCz, 0.0875),
            (Key::KU, f64::INFINITY),
            (Key::KQ, f64::INFINITY),
            (Key::KPsi, 1e5),
            (Key::CPsi, damping),
            (Key::TurningRadius, f64::INFINITY),
            (Key::Sigma, 0.3),
            (Key::HalfContactLength, 0.1),
            (Key::CAlpha, 9000.0 * 20.0),
            (Key::TP, 0.1),
            (Key::Kappa, 270.0),
        ],
    )
}

#[test]
fn hopf_points_of_the_nose_gear_are_those_published() {
    let along = Along::new(Key::V, 1.0, 200.0).unwrap();
    for (damping, published) in [(0.0, vec![15.259_297_292]), (10.0, vec![20.511_049_179]), (50.0, vec![])] {
        // As many digits with longitudinal elasticity, which is decoupled in straight towing.
        for longitudinal in [f64::INFINITY, 1e4] {
            let gear = nose_gear(damping).with(Key::KU, longitudinal).unwrap();
            let found = gear.hopf_points(along, &Control::none()).unwrap().points;
            assert_eq!(found.len(), published.len());
            for (point, published) in found.iter().zip(&published) {
                assert!((point.value - published).abs() < 5e-10, "{} {published}", point.value);
            }
        }
    }
    let critical = nose_gear(10.0).critical_speed().unwrap().speed;
    assert!((critical - 20.511_049_179).abs() < 5e-10);
    assert!(nose_gear(50.0).critical_speed().is_none());
}

proptest! {
    /// Pacejka: with a rigid king pin, without damping and tread width, straight towing is stable exactly for `l > sigma + a`, whatever
    /// the pneumatic trail.
    #[test]
    fn a_rigid_king_pin_needs_a_long_caster(
        v in 0.1..50.0f64, sigma in 0.01..0.5f64, a in 0.0..0.2f64, trail in -0.001..0.1f64,
        stiffness in 1.0..6.0f64, part in 0.5..1.5f64, mass in -1.0..2.0f64, brush in any::<bool>(),
    ) {
        let l = part * (sigma + a);
        let tyre = if brush { Tyre::Brush } else { Tyre::Linear };
        let wheel = wheel(tyre, &[
            (Key::V, v), (Key::L, l), (Key::MW, 10_f64.powf(mass)), (Key::K, f64::INFINITY),
            (Key::TurningRadius, f64::INFINITY), (Key::Sigma, sigma), (Key::HalfContactLength, a),
            (Key::CAlpha, 10_f64.powf(stiffness)), (Key::TP, trail),
        ]);
        let motion = wheel.uniform_motion().unwrap();
        // A trail that lies ahead by more than the caster is long would turn the caster round.
        prop_assume!(l + trail > 1e-3 && (part - 1.0).abs() > 1e-6);
        prop_assert_eq!(motion.is_stable(), Some(part > 1.0), "{}", motion.growth_rate());
    }
}

/// With `a = t_p = kappa = 0` the eigenvalues tend to those of the rolling wheel as the cornering stiffness grows, with an error that
/// falls as its reciprocal.
#[test]
fn a_stiff_tyre_is_the_rolling_wheel() {
    let mut circles = 0;
    for (v, radius, longitudinal) in [
        (4.0, 1.0, 100.0),
        (8.0, 1.0, 100.0),
        (4.0, f64::INFINITY, 100.0),
        (8.0, f64::INFINITY, 100.0),
        (4.0, 1.0, f64::INFINITY),
        (8.0, f64::INFINITY, f64::INFINITY),
    ] {
        let rigid = Wheel::default()
            .with(Key::V, v)
            .and_then(|wheel| wheel.with(Key::TurningRadius, radius))
            .and_then(|wheel| wheel.with(Key::KU, longitudinal))
            .unwrap();
        let limit = rigid.uniform_motion().unwrap();
        let errors = |cornering: f64| {
            let mut wheel = rigid;
            wheel.set_tyre(Tyre::Linear);
            let wheel =
                wheel.with(Key::Sigma, 0.05).and_then(|wheel| wheel.with(Key::CAlpha, cornering)).unwrap();
            let motion = wheel.uniform_motion().unwrap();
            let found = motion.eigenvalues();
            let farthest = limit
                .eigenvalues()
                .iter()
                .map(|expected| {
                    let distances = found.iter().map(|eigenvalue| (eigenvalue - expected).norm());
                    distances.fold(f64::INFINITY, f64::min) / expected.norm()
                })
                .fold(0.0, f64::max);
            let state = (motion.psi() - limit.psi()).abs() + (motion.q() - limit.q()).abs() / 0.08;
            (farthest, state)
        };
        let ((first, first_state), (second, second_state)) = (errors(1e6), errors(1e7));
        assert!(first < 0.1 && (first / second - 10.0).abs() < 0.2, "{v} {radius}: {first:e} {second:e}");
        if radius.is_finite() {
            circles += 1;
            assert!((first_state / second_state - 10.0).abs() < 0.2, "{first_state:e} {second_state:e}");
        }
    }
    assert_eq!(circles, 3);
}

/// Force and moment of a row of bristles, each bent as far as its friction holds it under a parabola of pressure.
fn bristles(wheel: &Wheel, slip: f64) -> [f64; 2] {
    const COUNT: usize = 200_000;
    let get = |key| wheel.get(key);
    let (a, friction) = (get(Key::HalfContactLength), get(Key::MuS) * wheel.normal_force());
    let stiffness = get(Key::CAlpha) / (2.0 * a * a);
    let width = 2.0 * a / COUNT as f64;
    (0..COUNT).fold([0.0; 2], |[force, moment], index| {
        let place = (index as f64 + 0.5) * width;
        let limit = 0.75 * friction * place * (2.0 * a - place) / (a * a * a);
        let bent = (stiffness * slip.abs() * place).min(limit).copysign(slip);
        [force + width * bent, moment + width * bent * (a - place)]
    })
}

#[test]
fn the_brush_is_its_bristles() {
    let wheel = caster(Tyre::Brush, &[(Key::K, f64::INFINITY)]);
    let [sigma, l] = [Key::Sigma, Key::L].map(|key| wheel.get(key));
    let field = wheel.with_tyre(&[]).unwrap();
    let inertia = inertia_about_king_pin(&wheel);
    for slip in [1e-6, 0.01, -0.05, 0.1, 0.2, -0.24, 0.3, 2.0] {
        let mut rate = [0.0; 3];
        field.evaluate(&[0.0, 0.0, slip * sigma], &[], &mut rate);
        let [force, moment] = bristles(&wheel, slip);
        // Without pneumatic trail there is the force alone, on the same arm.
        let mut without = [0.0; 3];
        let other = wheel.with(Key::TP, 0.0).unwrap().with_tyre(&[]).unwrap();
        other.evaluate(&[0.0, 0.0, slip * sigma], &[], &mut without);
        assert_relative_eq!(without[1] * inertia, -l * force, max_relative = 1e-6);
        assert!(((rate[1] - without[1]) * inertia - moment).abs() < 1e-6 * (0.02 * force).abs());
    }
}

/// With the damper that is enough the wheel is stable at every speed, with a little less it is not at the one that decides.
#[test]
fn the_smallest_damper_is_at_the_edge() {
    let short = caster(Tyre::Linear, &[(Key::L, 0.05), (Key::Kappa, 1e-3)]);
    let rigid = short.with(Key::K, f64::INFINITY).unwrap();
    for (wheel, key) in [(short, Key::CPsi), (rigid, Key::CPsi), (nose_gear(0.0), Key::CPsi)] {
        let up_to = 8.0 * wheel.get(Key::V);
        let found = wheel.smallest_damper(key, up_to, &Control::none()).unwrap().unwrap();
        let speed = found.speed.unwrap();
        let stable = |damping: f64, v: f64| {
            let wheel = wheel.with(key, damping).and_then(|wheel| wheel.with(Key::V, v)).unwrap();
            wheel.uniform_motion().unwrap().is_stable()
        };
        assert_eq!(stable(0.9999 * found.damping, speed), Some(false));
        for index in 1..=1000 {
            let v = up_to * f64::from(index) / 1000.0;
            assert_ne!(stable(1.0001 * found.damping, v), Some(false), "{v}");
        }
    }
}

/// Under the brush law no first Lyapunov coefficient exists at a straight Hopf point: the amplitude grows in proportion to the distance
/// from it, as fast as the slope says.
#[test]
fn straight_brushes_have_a_slope_in_place_of_a_first_lyapunov_coefficient() {
    let brush = |gear: Wheel| {
        let mut brush = gear.with(Key::FAz, -9000.0).unwrap();
        brush.set_tyre(Tyre::Brush);
        brush
    };
    let elastic = nose_gear(10.0).with(Key::KU, 3e5).and_then(|gear| gear.with(Key::KQ, 1e7)).unwrap();
    for gear in [nose_gear(0.0), nose_gear(10.0), elastic] {
        let along = Along::new(Key::V, 5.0, 60.0).unwrap();
        let smooth = gear.hopf_points(along, &Control::none()).unwrap().points;
        let found = brush(gear).hopf_points(along, &Control::none()).unwrap().points;
        assert!(!found.is_empty() && smooth.len() == found.len());
        for (smooth, hopf) in smooth.iter().zip(&found) {
            // The linear parts of both laws are one.
            assert_relative_eq!(smooth.value, hopf.value, max_relative = 1e-9);
            assert!(smooth.first_lyapunov.is_some() && hopf.first_lyapunov.is_none());
            let slope = hopf.psi_max_slope.unwrap();
            // Cycles on the side on which the slope says they are.
            let near = [5e-3, 1e-2].map(|part| hopf.value * (1.0 + part * slope.signum()));
            let options = CycleOptions::default().at(&near);
            let cycles = hopf.cycles(along, &options, |_| ControlFlow::Continue(())).unwrap();
            let amplitude = |value: f64| {
                let cycle = cycles.points.iter().find(|cycle| (cycle.value - value).abs() < 1e-12 * value);
                cycle.unwrap_or_else(|| panic!("no cycle at {value}")).max[2]
            };
            // The next term of the amplitude is of second order.
            let [first, second] = near.map(|value| amplitude(value) / (value - hopf.value));
            let extrapolated = 2.0 * first - second;
            assert_relative_eq!(extrapolated, slope, max_relative = 1e-3);
            let stable =
                cycles.points.iter().find(|cycle| cycle.value == near[0]).and_then(|cycle| cycle.stable);
            assert_eq!(stable, Some(hopf.criticality == Criticality::Supercritical));
        }
    }
    // On a circle there is slip, and the coefficient exists.
    let turning = brush(elastic).with(Key::TurningRadius, 30.0).unwrap();
    let found = turning.hopf_points(Along::new(Key::V, 5.0, 40.0).unwrap(), &Control::none()).unwrap().points;
    assert!(!found.is_empty() && found.iter().all(|point| point.first_lyapunov.is_some()));
}

/// Cycles are followed as far as the wheel rolls forwards.
#[test]
fn branches_end_where_the_wheel_stops() {
    let along = Along::new(Key::V, 5.0, 60.0).unwrap();
    let hopf = nose_gear(0.0).hopf_points(along, &Control::none()).unwrap().points.remove(0);
    let cycles = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
    assert!(matches!(cycles.stops[1], Some(Stop::Monitor { .. })), "{:?}", cycles.stops[1]);
    let last = cycles.points.last().unwrap();
    assert_relative_eq!(last.min[3] / last.value, SLOWEST_ON_CYCLES, max_relative = 1e-6);
    assert!(cycles.points.iter().all(|cycle| cycle.min[3] > 0.0));
    // An end as any other, and not where the friction is used up.
    assert_eq!(last.label, None);
    assert!(!cycles.rolling_limits.contains(&(cycles.points.len() - 1)));
}

/// The front wheel of a pram in a curve, whose shimmy soon asks the ground for more than there is.
fn pram_wheel(tyre: Tyre) -> Wheel {
    wheel(
        tyre,
        &[
            (Key::L, 0.07),
            (Key::TurningRadius, 2.0),
            (Key::MW, 0.6),
            (Key::MC, 0.4),
            (Key::JWxi, 2e-3),
            (Key::JWzeta, 1.1e-3),
            (Key::JCz, 6e-4),
            (Key::LC, 0.03),
            (Key::K, 2.5e4),
            (Key::CQ, 5.0),
            (Key::FAz, -60.0),
            (Key::MuS, 0.7),
            (Key::MuD, 0.55),
            (Key::Sigma, 0.04),
            (Key::HalfContactLength, 0.012),
            (Key::CAlpha, 500.0),
            (Key::Kappa, 0.02),
        ],
    )
}

/// Under every law there is a cycle where the largest friction force passes `mu_s N`: the brush law bounds the lateral force alone, and what
/// keeps the wheel at its speed comes on top. That of the rigid wheel lies next to the Hopf point.
#[test]
fn the_rolling_limit_lies_on_the_branch_under_every_law() {
    for tyre in [Tyre::Rigid, Tyre::Linear, Tyre::Brush] {
        let along = Along::new(Key::V, 0.1, 3.0).unwrap();
        let hopf = pram_wheel(tyre).hopf_points(along, &Control::none()).unwrap().points.remove(0);
        let cycles = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
        let ratios: Vec<f64> = cycles
            .points
            .iter()
            .map(|cycle| {
                let wheel = cycles.wheel.with(Key::V, cycle.value).unwrap();
                wheel.cycle_forces(&cycle.orbit).unwrap().friction_ratio_max().unwrap()
            })
            .collect();
        let [limit] = cycles.rolling_limits[..] else { panic!("{tyre}: {:?}", cycles.rolling_limits) };
        assert_relative_eq!(ratios[limit], 1.0, max_relative = 1e-9);
        assert!(ratios[..limit].iter().all(|ratio| *ratio < 1.0), "{tyre}: {ratios:?}");
        assert!(ratios[limit + 1..].iter().all(|ratio| *ratio > 1.0), "{tyre}: {ratios:?}");
    }
}

/// A nose gear with seven states, whose cycles need ever finer meshes, under both laws: every branch is told to its end, and on no cycle
/// does the wheel stop.
#[test]
fn branches_of_seven_states_are_followed_to_their_ends() {
    for tyre in [Tyre::Linear, Tyre::Brush] {
        let gear = wheel(
            tyre,
            &[
                (Key::L, 0.09),
                (Key::TurningRadius, f64::INFINITY),
                (Key::MW, 5.0),
                (Key::MC, 3.0),
                (Key::JWxi, 0.08),
                (Key::JWzeta, 0.045),
                (Key::JCz, 0.02),
                (Key::WheelRadius, 0.17),
                (Key::LC, 0.03),
                (Key::K, 6e4),
                (Key::CPsi, 3.0),
                (Key::FAz, -1200.0),
                (Key::MuS, 0.8),
                (Key::Sigma, 0.1),
                (Key::HalfContactLength, 0.06),
                (Key::CAlpha, 2e4),
                (Key::Kappa, 5.0),
            ],
        );
        let along = Along::new(Key::V, 0.05, 40.0).unwrap();
        let found = gear.hopf_points(along, &Control::none()).unwrap().points;
        assert_eq!(found.len(), 2);
        for hopf in found {
            let cycles = hopf.cycles(along, &CycleOptions::default(), |_| ControlFlow::Continue(())).unwrap();
            assert!(cycles.points.len() > 3, "{:?}", cycles.stops);
            for cycle in &cycles.points {
                assert!(cycle.min[3] > 0.9 * SLOWEST_ON_CYCLES * cycle.value, "{}", cycle.min[3]);
            }
        }
    }
}

/// A stable caster comes back; one whose king pin decelerates the wheel to a stop ends there.
#[test]
fn a_motion_that_stops_ends_there() {
    let history =
        caster(Tyre::Brush, &[]).simulate_with_tyre(2.0, &[("psi", 1.4)], 2001, &Control::none()).unwrap();
    let thrown = caster(Tyre::Linear, &[(Key::K, f64::INFINITY), (Key::L, 0.06)]);
    let stopped =
        thrown.simulate_with_tyre(5.0, &[("psi", 1.2), ("Omega", -40.0)], 5001, &Control::none()).unwrap();
    let time = stopped.stopped_at.expect("a stop");
    assert!(stopped.times.iter().all(|&sample| sample <= time) && stopped.times.len() < 5001);
    assert!(stopped.states.iter().all(|state| state[3] > 0.0));
    assert!(history.states.iter().all(|state| state[3] > 0.0));
    let refused = thrown.simulate_with_tyre(1.0, &[("psi", 2.0)], 11, &Control::none()).unwrap_err();
    assert!(refused.to_string().contains("roll forwards"), "{refused}");
}

#[test]
fn what_a_tyre_needs_is_said() {
    let message = |text: &str| {
        let wheel = Wheel::from_toml(text).unwrap();
        wheel.uniform_motion().unwrap_err().to_string()
    };
    assert!(message("tyre = \"linear\"\nsigma = 0.1").contains("needs C_alpha"));
    assert!(message("tyre = \"brush\"\nC_alpha = 100").contains("needs sigma"));
    assert!(message("sigma = 0.1").contains("the wheel has none"));
    assert!(message("k_q = inf").contains("without a tyre"));
    let brush = "tyre = \"brush\"\nsigma = 0.1\nC_alpha = 100\n";
    assert!(message(&format!("{brush}F_Az = 100")).contains("needs friction"));
    assert!(message(&format!("{brush}mu_s = 0")).contains("needs friction"));
    let error = Wheel::from_toml("l = 0.1\ntyre = \"soft\"").unwrap_err().to_string();
    assert!(
        error.starts_with("line 2, column 8: tyre = soft") && error.contains("rigid, linear, brush"),
        "{error}"
    );
    assert!("tyre".parse::<Key>().unwrap_err().to_string().contains("cannot vary"));
    // Said to be rigid, a wheel may keep what its tyre had.
    let mut rigid = Wheel::from_toml(brush).unwrap();
    rigid.set("tyre", "rigid").unwrap();
    assert_eq!(rigid.uniform_motion().unwrap().state(), Wheel::default().uniform_motion().unwrap().state());
    assert!(rigid.rolling(&[Key::Sigma]).is_err() && rigid.with_tyre(&[]).is_err());
    // What takes no tyre says what does.
    let soft = caster(Tyre::Linear, &[]);
    for error in [soft.rolling(&[]).unwrap_err(), soft.lateral(&[]).unwrap_err()] {
        assert!(error.to_string().contains("with a tyre there are"), "{error}");
    }
    assert!(soft.sliding().is_err() && soft.simulate(1.0, &[], 2, &Control::none()).is_err());
    assert!(soft.swing_factor().is_none() && soft.critical_speed_with_friction().is_none());
    assert!(soft.critical_yaw_rate().is_none() && soft.critical_caster_length().is_none());
}

/// The pneumatic trail is a third of the half contact length until it is set, along branches too.
#[test]
fn the_pneumatic_trail_follows_the_contact_length() {
    let soft = caster(Tyre::Linear, &[]);
    assert_eq!(soft.get(Key::TP), 0.02 / 3.0);
    assert_eq!(
        soft.with(Key::TP, 0.004)
            .and_then(|wheel| wheel.with(Key::HalfContactLength, 0.03))
            .unwrap()
            .get(Key::TP),
        0.004
    );
    let field = soft.with_tyre(&[Key::HalfContactLength]).unwrap();
    let other = soft.with(Key::HalfContactLength, 0.03).unwrap();
    let state = [0.001, 0.002, 0.1, 4.0, 0.1, 2.0, 0.003];
    let (mut varied, mut fixed) = ([0.0; 7], [0.0; 7]);
    field.evaluate(&state, &[0.03], &mut varied);
    other.with_tyre(&[]).unwrap().evaluate(&state, &[], &mut fixed);
    for (varied, fixed) in varied.iter().zip(fixed) {
        assert_relative_eq!(*varied, fixed, max_relative = 1e-13);
    }
}
