//! Periodic motions against long simulation, finite differences, other tolerances and each other.

use super::passage::passages;
use super::return_map::PSI;
use super::variation::STATES;
use super::*;
use crate::Key;
use crate::branches::Along;
use crate::sliding::{HybridState, as_slip_state};
use std::ops::ControlFlow;
use std::sync::OnceLock;

fn wheel(changes: &[(Key, f64)]) -> Wheel {
    changes.iter().try_fold(Wheel::default(), |wheel, &(key, value)| wheel.with(key, value)).unwrap()
}

/// A short caster towed straight: it shimmies by itself, with four phases in a period.
fn short_caster() -> Wheel {
    wheel(&[(Key::L, 0.03), (Key::V, 0.5), (Key::Curvature, 0.0), (Key::CU, 0.1), (Key::CQ, 0.1)])
}

/// The paper's caster under load, with dampers: stable uniform motion beside a large shimmy.
fn loaded(v: f64) -> Wheel {
    wheel(&[(Key::V, v), (Key::FAz, -50.0), (Key::CU, 0.5), (Key::CQ, 0.5)])
}

fn settled(wheel: &Wheel, kick: f64, search: &SlidingMotionSearch) -> PeriodicSliding {
    let start = wheel.perturbed_uniform_motion(&[("psi", kick)]).unwrap();
    wheel.sliding_motion(&start, search, &Control::none()).unwrap()
}

fn short_caster_motion() -> PeriodicSliding {
    static FOUND: OnceLock<PeriodicSliding> = OnceLock::new();
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    FOUND.get_or_init(|| settled(&short_caster(), 0.2, &search)).clone()
}

/// The short caster with dry friction about its king pin, which turns round where the caster does.
fn dry_motion() -> PeriodicSliding {
    static FOUND: OnceLock<PeriodicSliding> = OnceLock::new();
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    FOUND.get_or_init(|| settled(&short_caster().with(Key::MF, 5e-4).unwrap(), 1.0, &search)).clone()
}

fn loaded_motion() -> PeriodicSliding {
    static FOUND: OnceLock<PeriodicSliding> = OnceLock::new();
    FOUND.get_or_init(|| loaded_motion_at(7.0)).clone()
}

fn loaded_motion_at(v: f64) -> PeriodicSliding {
    let search = SlidingMotionSearch { settling_time: 12.0, ..SlidingMotionSearch::default() };
    settled(&loaded(v), 0.8, &search)
}

/// Locates grazings less sharply than the default, which saves most of the time.
fn quick() -> SlidingBranchOptions {
    let mut options = SlidingBranchOptions::default();
    options.settings.smallest_step = 1e-6;
    options
}

/// The motion with another start.
fn started_in(motion: &PeriodicSliding, contact: Contact) -> (ReturnMap, Start) {
    let (list, _) = motion.map.follow(&motion.start, &[], &Control::none()).unwrap();
    let inside = list[1..list.len() - 1]
        .iter()
        .filter(|passage| passage.mode.regime != Regime::Onset && passage.mode.regime.contact() == contact)
        .filter(|passage| passage.mode.king_pin() == KingPin::Swinging)
        .max_by(|a, b| a.duration().total_cmp(&b.duration()))
        .unwrap();
    let middle = 0.5 * (inside.start + inside.end);
    let start = motion.map.start_after(&motion.start, middle, &Control::none()).unwrap();
    let mut map = ReturnMap { expected: None, ..motion.map.clone() };
    map.set_reference(start.state).unwrap();
    let (start, _) = map.solve(&start, &Control::none()).unwrap();
    (map, start)
}

#[test]
fn long_simulation_settles_on_the_motion() {
    for (motion, kick) in [(short_caster_motion(), 0.2), (loaded_motion(), 0.8), (dry_motion(), 1.0)] {
        assert_eq!(motion.stable, Some(true));
        let start = motion.wheel.perturbed_uniform_motion(&[("psi", kick)]).unwrap();
        let settling = 20.0;
        let count = 400_000;
        let history = motion
            .wheel
            .sliding()
            .unwrap()
            .simulate(&start, settling + 2.0 * motion.period, count + 1, &Control::none())
            .unwrap();
        let last: Vec<f64> =
            (0..=count).filter(|&i| history.times[i] >= settling).map(|i| history.states[i][PSI]).collect();
        let largest = last.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let smallest = last.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        assert!((largest - motion.psi_max).abs() < 1e-5, "{largest} {}", motion.psi_max);
        assert!((smallest - motion.psi_min).abs() < 1e-5, "{smallest} {}", motion.psi_min);
        let phases = history.phases.iter().filter(|phase| {
            (history.times[count] - motion.period..history.times[count]).contains(&phase.start)
        });
        // The first and the last phase of a period are one.
        assert_eq!(phases.count(), motion.phases.len() - 1);
    }
}

#[test]
fn perturbations_decay_as_the_multipliers_say() {
    let motion = loaded_motion();
    let largest = motion.nontrivial().map(|multiplier| multiplier.norm()).fold(0.0, f64::max);
    let sliding = motion.wheel.sliding().unwrap().tolerance(1e-12);
    let mut perturbed = motion.start.state;
    perturbed.state[0] += 1e-4 * motion.map.scales[0];
    let periods = 12;
    // The perturbation ends on the orbit, a little earlier or later: its distance is measured across the flow.
    let distance = |periods: i32| {
        let (_, end) =
            passages(&sliding, perturbed, f64::from(periods) * motion.period, &[], &Control::none()).unwrap();
        let rate = sliding.rate(&motion.start.state);
        let scaled = |i: usize| (end.state[i] - motion.start.state.state[i]) / motion.map.scales[i];
        let flow = |i: usize| rate[i] / motion.map.scales[i];
        let free = motion.map.free();
        let square: f64 = free.iter().map(|&i| flow(i) * flow(i)).sum();
        let along: f64 = free.iter().map(|&i| scaled(i) * flow(i)).sum::<f64>() / square;
        free.iter().map(|&i| (scaled(i) - along * flow(i)).powi(2)).sum::<f64>().sqrt()
    };
    // A complex pair turns its direction, so the rate is a mean over many periods.
    let found = (distance(periods) / distance(2)).powf(1.0 / f64::from(periods - 2));
    assert!((found / largest).ln().abs() < 0.15, "{found} {largest}");
}

#[test]
fn derivatives_of_the_return_map_are_those_of_finite_differences() {
    for motion in [short_caster_motion(), loaded_motion(), dry_motion()] {
        for contact in [Contact::Rolling, Contact::Sliding] {
            let (mut map, start) = started_in(&motion, contact);
            map.parameter = Some((Key::V, 1.0));
            map.tolerance = 1e-12;
            let exact = map.evaluate(&start, true, &Control::none()).unwrap();
            let rows = exact.residual.len();
            let d = rows - 1;
            let step = 1e-6;
            let largest = exact.jacobian.iter().fold(1.0_f64, |most, entry| most.max(entry.abs()));
            for column in 0..d + 2 {
                let shifted = |sign: f64| {
                    let mut change = vec![0.0; d + 1];
                    let mut map = map.clone();
                    if column <= d {
                        change[column] = step;
                    } else {
                        let v = map.wheel.get(Key::V);
                        map.wheel = map.wheel.with(Key::V, v + sign * step).unwrap();
                    }
                    map.evaluate(&map.moved(&start, &change, sign), false, &Control::none()).unwrap().residual
                };
                for (row, (plus, minus)) in shifted(1.0).iter().zip(shifted(-1.0)).enumerate() {
                    let found = (plus - minus) / (2.0 * step);
                    let entry = exact.jacobian[column * rows + row];
                    assert!(
                        (found - entry).abs() < 1e-5 * largest,
                        "{contact:?} ({row}, {column}): {found} {entry}"
                    );
                }
            }
        }
    }
}

#[test]
fn multipliers_do_not_depend_on_the_start() {
    for motion in [short_caster_motion(), loaded_motion(), dry_motion()] {
        for contact in [Contact::Rolling, Contact::Sliding] {
            let (map, start) = started_in(&motion, contact);
            let other = PeriodicSliding::describe(
                &map,
                &start,
                &map.evaluate(&start, true, &Control::none()).unwrap(),
                &Control::none(),
            )
            .unwrap();
            assert_eq!(other.multipliers.len(), 5);
            for (a, b) in other.multipliers.iter().zip(&motion.multipliers) {
                assert!((a - b).norm() < 1e-6, "{:?} {:?}", other.multipliers, motion.multipliers);
            }
            assert!((other.psi_max - motion.psi_max).abs() < 1e-8);
            assert!((other.sliding_fraction() - motion.sliding_fraction()).abs() < 1e-8);
            assert!(other.trivial_multiplier_error < 1e-8);
        }
    }
}

#[test]
fn where_slip_vanishes_two_directions_are_lost() {
    let (map, start) = started_in(&short_caster_motion(), Contact::Sliding);
    let image = map.evaluate(&start, true, &Control::none()).unwrap();
    assert_eq!(map.free().len(), STATES);
    let mut monodromy = Vec::new();
    for (column, entries) in image.jacobian.chunks_exact(STATES + 1).take(STATES).enumerate() {
        monodromy.extend((0..STATES).map(|row| entries[row] + f64::from(row == column)));
    }
    let mut sizes: Vec<f64> =
        eigenvalues(&monodromy, STATES).unwrap().iter().map(|value| value.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    assert!(sizes[1] < 1e-6 && sizes[2] > 1e-3, "{sizes:?}");
}

#[test]
fn converges_with_the_tolerance_and_the_estimate_holds() {
    let wheel = short_caster();
    let at = |tolerance: f64| {
        let search = SlidingMotionSearch { settling_time: 6.0, tolerance, ..SlidingMotionSearch::default() };
        settled(&wheel, 0.2, &search)
    };
    let exact = at(1e-13);
    for tolerance in [1e-6, 1e-8, 1e-10] {
        let motion = at(tolerance);
        let error = (motion.period / exact.period - 1.0)
            .abs()
            .max((motion.psi_max - exact.psi_max).abs() / (exact.psi_max - exact.psi_min));
        assert!(
            error <= (3.0 * motion.error_estimate).max(1e-9),
            "{tolerance}: {error} {}",
            motion.error_estimate
        );
        assert!(error < 10.0 * tolerance, "{tolerance}: {error}");
    }
}

#[test]
fn branch_meets_motions_found_otherwise() {
    let along = Along::new(Key::V, 0.45, 0.5).unwrap();
    let options = SlidingBranchOptions::default().at(&[0.47]);
    let branch = short_caster_motion()
        .along(along, &options, &Control::none(), |_, _| ControlFlow::Continue(()))
        .unwrap();
    assert_eq!((branch.points[0].value, branch.points.last().unwrap().value), (0.45, 0.5));
    let asked = branch.points.iter().find(|point| point.role == SlidingRole::Requested).unwrap();
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    let found = settled(&short_caster().with(Key::V, 0.47).unwrap(), 0.2, &search);
    assert_eq!(asked.value, 0.47);
    assert!((asked.motion.period / found.period - 1.0).abs() < 1e-9);
    assert!((asked.motion.psi_max - found.psi_max).abs() < 1e-8);
    assert!((asked.motion.multipliers[1] - found.multipliers[1]).norm() < 1e-5);
}

#[test]
fn shimmy_with_dry_friction_is_smaller_and_its_branch_meets_motions_found_otherwise() {
    let motion = dry_motion();
    assert_eq!(motion.stable, Some(true));
    assert!(motion.psi_max < short_caster_motion().psi_max);
    // Sliding goes on where the caster turns round: that is the end of a phase.
    let slides_on = |pair: &[Phase]| pair.iter().all(|phase| phase.contact == Contact::Sliding);
    assert!(motion.phases.windows(2).any(slides_on), "{:?}", motion.phases);
    assert!(motion.trivial_multiplier_error < 1e-7, "{:?}", motion.multipliers);
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    for (key, ends, value) in [(Key::V, [0.49, 0.5], 0.495), (Key::MF, [5e-4, 5.2e-4], 5.1e-4)] {
        let along = Along::new(key, ends[0], ends[1]).unwrap();
        let options = SlidingBranchOptions::default().at(&[value]);
        let branch =
            motion.along(along, &options, &Control::none(), |_, _| ControlFlow::Continue(())).unwrap();
        let asked = branch.points.iter().find(|point| point.role == SlidingRole::Requested).unwrap();
        let found = settled(&motion.wheel.with(key, value).unwrap(), 1.0, &search);
        assert!((asked.motion.period / found.period - 1.0).abs() < 1e-9, "{key}");
        assert!((asked.motion.psi_max - found.psi_max).abs() < 1e-8, "{key}");
    }
}

#[test]
fn grazing_ends_the_branch_where_simulation_changes() {
    let along = Along::new(Key::V, 6.9, 7.1).unwrap();
    let motion = loaded_motion();
    let branch = motion
        .along(along, &SlidingBranchOptions::default(), &Control::none(), |_, _| ControlFlow::Continue(()))
        .unwrap();
    let SlidingBranchEnd::Grazing { change, value, located_within } = branch.ends[1] else {
        panic!("{:?}", branch.ends)
    };
    assert_eq!(change, Grazing::StaticLimitReached);
    assert!(located_within < 1e-6 && (value - 7.01014).abs() < 1e-4, "{value} {located_within}");
    // A simulation over one period has the old phases on one side and other ones on the other.
    let last = &branch.points.last().unwrap().motion;
    let over_a_period = |v: f64| {
        let sliding = last.wheel.with(Key::V, v).unwrap().sliding().unwrap();
        let list = passages(&sliding, last.start.state, last.period, &[], &Control::none()).unwrap().0;
        list.iter().map(|passage| passage.mode.regime).collect::<Vec<_>>()
    };
    assert_eq!(over_a_period(value - 1e-4), over_a_period(value));
    assert_eq!(over_a_period(value + 1e-4).len(), over_a_period(value).len() + 3);
    // The rolling phase that is about to break has hardly any reserve of friction left.
    let history = last.history(1.0, 20_001, &Control::none()).unwrap();
    let limit = history.normal_force * last.wheel.get(Key::MuS);
    let mut touches = 0;
    let reserve: Vec<f64> = history
        .times
        .iter()
        .zip(&history.friction)
        .map(|(time, force)| {
            let rolls = history
                .phases
                .iter()
                .any(|phase| phase.contact == Contact::Rolling && phase.start < *time && *time < phase.end);
            if rolls { 1.0 - force[0].hypot(force[1]) / limit } else { 1.0 }
        })
        .collect();
    for window in reserve.windows(3) {
        touches += i32::from(window[1] < window[0] && window[1] < window[2] && window[1] < 1e-6);
    }
    assert_eq!(touches, 1, "one local minimum of the reserve at zero");
}

#[test]
fn branch_goes_on_beyond_grazings() {
    let along = Along::new(Key::V, 7.0, 7.02).unwrap();
    let options = quick().through_grazings(true);
    let branch =
        loaded_motion().along(along, &options, &Control::none(), |_, _| ControlFlow::Continue(())).unwrap();
    let grazings = branch.points.iter().filter(|point| matches!(point.role, SlidingRole::Grazing(_)));
    assert!(grazings.count() >= 1);
    let last = branch.points.last().unwrap();
    assert_eq!(last.value, 7.02);
    let found = loaded_motion_at(7.02);
    assert!((last.motion.period / found.period - 1.0).abs() < 1e-8);
    assert_eq!(last.motion.phases.len(), found.phases.len());
    // Period and amplitude are continuous along the branch.
    for pair in branch.points.windows(2) {
        assert!((pair[0].motion.period / pair[1].motion.period - 1.0).abs() < 0.02);
        assert!((pair[0].motion.psi_max - pair[1].motion.psi_max).abs() < 0.02);
    }
}

#[test]
fn energy_is_balanced_along_every_passage() {
    let motion = loaded_motion();
    let equations = Equations::new(&motion.wheel).unwrap();
    let (list, _) = motion.map.follow(&motion.start, &[], &Control::none()).unwrap();
    assert!(list.len() > 6);
    for passage in &list {
        let count = 2000;
        let initial = HybridState { contact: passage.mode.regime.contact(), state: passage.initial };
        let times: Vec<f64> =
            (1..count).map(|i| passage.duration() * f64::from(i) / f64::from(count)).collect();
        let sliding = motion.wheel.sliding().unwrap().tolerance(1e-12);
        let mut inside: Vec<_> = Vec::new();
        if passage.mode.regime == Regime::Onset {
            // It is part of the sliding phase, and too short to count.
            let change = equations.energy(&passage.last) - equations.energy(&passage.initial);
            assert!(change.abs() < 1e-3 * equations.energy(&passage.initial));
            continue;
        }
        sliding
            .follow(initial, passage.duration(), &times, &Control::none(), |piece| {
                inside.extend(piece.solution.samples().map(|(_, state)| as_slip_state(state)));
                true
            })
            .unwrap();
        let end = passage.vanishing.map_or(passage.last, |(_, state)| state);
        let power = |state: &[f64; 7]| {
            let friction = match passage.mode.regime {
                Regime::Rolling => equations.holding_force(state),
                _ => equations.sliding_force(state),
            };
            let (towing, dissipated) = equations.power(state, friction);
            assert!(dissipated > -1e-9, "{dissipated}");
            towing - dissipated
        };
        // Simpson's rule.
        let mut work = power(&passage.initial) + power(&end);
        for (index, state) in inside.iter().enumerate() {
            work += power(state) * if index % 2 == 0 { 4.0 } else { 2.0 };
        }
        work *= passage.duration() / f64::from(count) / 3.0;
        let gained = equations.energy(&end) - equations.energy(&passage.initial);
        let turnover = equations.energy(&end).max(equations.energy(&passage.initial));
        assert!((work - gained).abs() < 1e-6 * turnover, "{:?}: {work} {gained}", passage.mode.regime);
    }
}

#[test]
fn refusals_say_why() {
    let message = |wheel: &Wheel, kick: f64, settling_time: f64| {
        let start = wheel.perturbed_uniform_motion(&[("psi", kick)]).unwrap();
        let search = SlidingMotionSearch { settling_time, ..SlidingMotionSearch::default() };
        wheel.sliding_motion(&start, &search, &Control::none()).unwrap_err().to_string()
    };
    let calm = wheel(&[(Key::FAz, -100.0), (Key::V, 2.0)]);
    assert!(message(&calm, 0.1, 40.0).contains("dies out"));
    assert!(message(&calm, 0.1, -1.0).contains("settling_time = -1"));
    // Without dampers the unloaded wheel slides irregularly.
    let wild = wheel(&[(Key::FAz, -50.0), (Key::V, 9.0)]);
    let message = message(&wild, 0.8, 3.0);
    assert!(message.contains("does not repeat itself") || message.contains("does not converge"), "{message}");
    let motion = short_caster_motion();
    let outside = motion.along(
        Along::new(Key::V, 1.0, 2.0).unwrap(),
        &SlidingBranchOptions::default(),
        &Control::none(),
        |_, _| ControlFlow::Continue(()),
    );
    assert!(outside.unwrap_err().to_string().contains("v = 0.5 is outside"));
}

#[test]
fn smoothed_friction_has_the_same_motion_in_the_limit() {
    use arclength::cycle::{CycleStart, Cycles, Orbit};
    use arclength::integration::{Integrator, autonomous};
    let wheel = short_caster().with(Key::MuS, 0.8).unwrap();
    let search = SlidingMotionSearch { settling_time: 6.0, ..SlidingMotionSearch::default() };
    let exact = settled(&wheel, 0.2, &search);
    let smoothed = |smoothing: f64| {
        let field = wheel.smoothed_sliding(&[Key::V], smoothing).unwrap();
        let parameters = field.parameters();
        let settled = Integrator::with_tolerance(1e-9)
            .integrate(autonomous(&field, &parameters), 0.0, &exact.state(), 3.0)
            .unwrap()
            .state;
        let orbit = Orbit::from_time_history(&field, &parameters, &settled, 1.2 * exact.period).unwrap();
        (field, orbit)
    };
    let errors: Vec<f64> = [4e-3, 2e-3, 1e-3, 5e-4]
        .into_iter()
        .map(|smoothing| (smoothed(smoothing).1.period / exact.period - 1.0).abs())
        .collect();
    // The orders tend to 4/5 from below.
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(orders.windows(2).all(|pair| pair[0] < pair[1]), "{orders:?}");
    assert!(orders.iter().all(|order| (0.7..0.82).contains(order)), "{orders:?}");
    assert!(errors[3] < 1e-3, "{errors:?}");
    // Collocation of the smooth field knows no events: its multipliers tend to those of the jumps.
    let distances = [4e-3, 1e-3].map(|smoothing| {
        let (field, orbit) = smoothed(smoothing);
        let branch = Cycles::of(&field, CycleStart::Orbit(orbit))
            .parameters(&field.parameters())
            .along("v", 0.49..=0.5)
            .run()
            .unwrap();
        let cycle = branch.points.iter().find(|cycle| cycle.value == 0.5).unwrap();
        assert_eq!(cycle.stable, exact.stable);
        let nearest = |multiplier: Complex64| {
            cycle.multipliers.iter().map(|other| (other - multiplier).norm()).fold(f64::INFINITY, f64::min)
        };
        exact.multipliers.iter().map(|multiplier| nearest(*multiplier)).fold(0.0, f64::max)
    });
    assert!(distances[1] < 0.04 && distances[1] < 0.5 * distances[0], "{distances:?}");
}

/// The paper's wheel at l = 0.08 m, r = 1 m under a load of 100 N, without dampers.
#[test]
fn large_shimmy_of_the_papers_wheel_beside_stable_uniform_motion() {
    let wheel = wheel(&[(Key::V, 8.4), (Key::FAz, -100.0)]);
    let uniform = wheel.uniform_motion().unwrap();
    assert!(uniform.is_stable() == Some(true) && uniform.rolls());
    let search = SlidingMotionSearch { settling_time: 25.0, ..SlidingMotionSearch::default() };
    let motion = settled(&wheel, 1.2, &search);
    assert_eq!((motion.stable, motion.turns), (Some(true), 0));
    assert!((motion.period - 0.299137986).abs() < 1e-8, "{}", motion.period);
    assert!((motion.psi_max - 0.430465).abs() < 1e-6 && (motion.psi_min + 2.805369).abs() < 1e-6);
    assert!((motion.sliding_fraction() - 0.4747).abs() < 1e-4);
    // It ends where the rolling phase is lost; there is no shimmy of this kind far below the boundary of stability.
    let along = Along::new(Key::V, 8.0, 8.5).unwrap();
    let branch = motion.along(along, &quick(), &Control::none(), |_, _| ControlFlow::Continue(())).unwrap();
    let [first, last] = &branch.ends;
    assert!(matches!(first, SlidingBranchEnd::Grazing { change: Grazing::SlipVanishes, value, .. }
        if (value - 8.160952).abs() < 1e-5));
    assert!(matches!(last, SlidingBranchEnd::Grazing { change: Grazing::StaticLimitReached, value, .. }
        if (value - 8.455932).abs() < 1e-5));
    assert!(branch.points.iter().all(|point| point.motion.stable == Some(true)));
}

#[test]
fn the_towing_gives_what_dampers_and_sliding_take() {
    for motion in [short_caster_motion(), loaded_motion(), dry_motion()] {
        let found = motion.forces(&Control::none()).unwrap();
        let taken = found.forces.damper_power + found.sliding_power + found.dry_friction_power;
        assert_eq!(found.dry_friction_power > 0.0, motion.wheel.get(Key::MF) > 0.0);
        assert!((found.towing_power / taken - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!(found.forces.friction_max, motion.wheel.static_limit());
        // Against a fine history: the powers as means, the king-pin force from springs and dampers.
        let count = 40_000;
        let history = motion.history(1.0, count + 1, &Control::none()).unwrap();
        let mean = |values: &[f64]| values[..count].iter().sum::<f64>() / count as f64;
        assert!((found.towing_power / mean(&history.towing_power) - 1.0).abs() < 1e-4);
        assert!((taken / mean(&history.dissipated_power) - 1.0).abs() < 1e-4);
        let get = |key| motion.wheel.get(key);
        let force = |[u, q, psi, forward, lateral, yaw, _]: &[f64; 7]| {
            let (sine, cosine) = psi.sin_cos();
            let across = lateral + get(Key::L) * yaw;
            let omega = motion.wheel.towing_yaw_rate();
            let u_rate = forward * cosine + across * sine - get(Key::V) + omega * q;
            let q_rate = across * cosine - forward * sine - omega * u;
            let longitudinal = get(Key::KU) * u + get(Key::CU) * u_rate;
            longitudinal.hypot(get(Key::KQ) * q + get(Key::CQ) * q_rate)
        };
        let largest = history.states.iter().map(force).fold(0.0, f64::max);
        // The history misses the largest value by the curvature over its interval at most.
        let difference = found.forces.king_pin_force_max / largest - 1.0;
        assert!((-1e-9..1e-6).contains(&difference), "{difference}");
    }
}

/// A fold at which no second multiplier is 1 is none: it was told where a step came close to a grazing, at v = 4.2589 m/s, with an error
/// of 5.3, and the branch turned back there.
#[test]
fn no_fold_is_told_that_its_multipliers_refute() {
    let office = Wheel::from_toml(include_str!("../../examples/wheels/office.toml")).unwrap();
    let wheel = office.with(Key::V, 2.75).unwrap();
    let motion = settled(&wheel, 1.2, &wheel.settling_search());
    let mut options = SlidingBranchOptions::default().through_grazings(true);
    options.settings.smallest_step = 3e-5;
    let along = Along::new(Key::V, 0.5, 5.0).unwrap();
    let go_on = |_: f64, _: &PeriodicSliding| ControlFlow::Continue(());
    let branch = motion.along(along, &options, &Control::none(), go_on).unwrap();
    for point in &branch.points {
        assert!(!matches!(point.role, SlidingRole::Bifurcation(_)), "{}: {:?}", point.value, point.role);
        assert!(point.motion.error_estimate <= SAME, "{}", point.value);
        assert_eq!(point.motion.stable, Some(true), "{}", point.value);
    }
}
