//! Cycles that jump at events and cycles that slide along a switch, against closed forms and against motions that are put together here
//! of smooth pieces.

use arclength::branch::SpecialKind;
use arclength::continuation::Stop;
use arclength::cycle::{CycleBranch, CycleEnd, CyclePoint, CycleStart, Cycles, Grazed, Orbit};
use arclength::integration::{Event, Integrator, from_fn};
use arclength::{Direction, Scalar, Threshold, VectorField};
use std::f64::consts::PI;

/// `v' = i - v`, set back to `r` where `v` reaches 1.
struct IntegrateAndFire;

impl VectorField for IntegrateAndFire {
    fn state_names(&self) -> Vec<String> {
        vec!["v".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["i".into(), "r".into()]
    }
    fn evaluate<T: Scalar>(&self, v: &[T], p: &[T], slope: &mut [T]) {
        slope[0] = p[0] - v[0];
    }
    fn events(&self) -> Vec<Direction> {
        vec![Direction::Rising]
    }
    fn evaluate_event<T: Scalar>(&self, _event: usize, v: &[T], p: &[T], values: &mut [T]) {
        values[0] = v[0] - 1.0;
        if let Some(next) = values.get_mut(1) {
            *next = p[1];
        }
    }
}

/// `x'' + 2 z x' + x = cos(w t)` with a wall at `s`, at which `v` becomes `-r v`; `(c, q)` is `(cos, sin)` of `w t`.
struct Impacts;

impl VectorField for Impacts {
    fn state_names(&self) -> Vec<String> {
        ["x", "v", "c", "q"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        ["w", "z", "s", "r"].map(String::from).to_vec()
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], slope: &mut [T]) {
        let growth = -(x[2] * x[2] + x[3] * x[3]) + 1.0;
        slope[0] = x[1];
        slope[1] = x[2] - x[0] - p[1] * x[1] * 2.0;
        slope[2] = growth * x[2] - p[0] * x[3];
        slope[3] = growth * x[3] + p[0] * x[2];
    }
    fn events(&self) -> Vec<Direction> {
        vec![Direction::Rising]
    }
    fn evaluate_event<T: Scalar>(&self, _event: usize, x: &[T], p: &[T], values: &mut [T]) {
        values[0] = x[0] - p[2];
        if let [_, next @ ..] = values
            && !next.is_empty()
        {
            next.copy_from_slice(x);
            next[1] = -(p[3] * x[1]);
        }
    }
}

/// A block on a belt that moves at `b`: `x' = y`, `y' = -x - y/20 + F`, the friction `F` falling with the speed of slip.
struct Belt;

const DAMPING: f64 = 0.05;

impl VectorField for Belt {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["b".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], result: &mut [T]) {
        let slip = x[1] - p[0];
        let side = p.get(1).map_or(if slip.value() < 0.0 { -1.0 } else { 1.0 }, Scalar::value);
        result[0] = x[1];
        result[1] = -x[0] - x[1] * DAMPING - T::from(side) / (slip * side + 1.0);
        if let Some(switch) = result.get_mut(2) {
            *switch = slip;
        }
    }
    fn thresholds(&self) -> Vec<Threshold> {
        vec![Threshold::Zero]
    }
}

fn branch<F: VectorField>(
    field: &F,
    orbit: Orbit,
    parameters: &[f64],
    name: &str,
    range: [f64; 2],
    at: &[f64],
) -> CycleBranch {
    Cycles::of(field, CycleStart::Orbit(orbit))
        .parameters(parameters)
        .along(name, range[0]..=range[1])
        .at(at)
        .run()
        .unwrap()
}

/// An orbit that jumps or has kinks at some of the times, by its state at any other.
fn orbit(period: f64, breaks: &[f64], state: impl Fn(f64) -> Vec<f64>) -> Orbit {
    let mut times: Vec<f64> = (0..=400).map(|index| period * f64::from(index) / 400.0).collect();
    times.extend(breaks);
    times.sort_by(f64::total_cmp);
    let states: Vec<Vec<f64>> = times.iter().map(|time| state(*time)).collect();
    let at =
        |nodes: &[f64]| Ok::<_, std::convert::Infallible>(nodes.iter().map(|time| state(*time)).collect());
    let Ok(orbit) = Orbit::from_pieces(&times, &states, breaks, at);
    orbit
}

fn requested(branch: &CycleBranch, value: f64) -> &CyclePoint {
    branch.points.iter().find(|point| point.value == value).unwrap()
}

fn grazing(stop: &Option<Stop<CycleEnd>>) -> (Grazed, f64, bool) {
    match stop {
        Some(Stop::Problem(CycleEnd::Grazing { of, parameter, located, .. })) => (*of, *parameter, *located),
        other => panic!("{other:?}"),
    }
}

/// The time from the reset to the next one, and the voltage between.
fn spike(current: f64, reset: f64) -> f64 {
    ((current - reset) / (current - 1.0)).ln()
}

#[test]
fn an_integrate_and_fire_neuron_has_its_period_in_closed_form() {
    let (current, reset) = (1.5, 0.2);
    let period = spike(current, reset);
    let half = 0.5 * period;
    let start = orbit(period, &[half], |time| {
        let since = if time < half { time + half } else { time - half };
        vec![current + (reset - current) * (-since).exp()]
    });
    let found = branch(&IntegrateAndFire, start, &[current, reset], "i", [1.01, 4.0], &[1.1, 2.0, 3.0]);
    for value in [1.1, 2.0, 3.0] {
        let point = requested(&found, value);
        assert!((point.period / spike(value, reset) - 1.0).abs() < 1e-11, "{}", point.period);
        assert!((point.max[0] - 1.0).abs() < 1e-11 && (point.min[0] - reset).abs() < 1e-11);
        assert!((point.multipliers[0].re - 1.0).abs() < 1e-9 && point.stable == Some(true));
    }
    assert!(found.stops.iter().flatten().all(|stop| matches!(stop, Stop::RangeEnd { .. })));
}

/// The impact oscillator between its impacts: amplitudes of the forced motion, and the free one.
struct Linear {
    w: f64,
    z: f64,
    a: f64,
    b: f64,
}

impl Linear {
    fn new(w: f64, z: f64) -> Self {
        let square = (1.0 - w * w).powi(2) + (2.0 * z * w).powi(2);
        Self { w, z, a: (1.0 - w * w) / square, b: 2.0 * z * w / square }
    }

    fn forced(&self, time: f64) -> [f64; 2] {
        let (sine, cosine) = (self.w * time).sin_cos();
        [self.a * cosine + self.b * sine, self.w * (self.b * cosine - self.a * sine)]
    }

    /// The matrix that takes free motions a time further.
    fn free(&self, time: f64) -> [[f64; 2]; 2] {
        let frequency = (1.0 - self.z * self.z).sqrt();
        let (sine, cosine) = (frequency * time).sin_cos();
        let (decay, s) = ((-self.z * time).exp(), sine / frequency);
        [[decay * (cosine + self.z * s), decay * s], [-decay * s, decay * (cosine - self.z * s)]]
    }

    /// The state a time after an impact at the time `t` with the velocity `u`, at a wall at `s` with restitution `r`.
    fn after(&self, (t, u): (f64, f64), (s, r): (f64, f64), time: f64) -> [f64; 2] {
        let at = self.forced(t);
        let free = [s - at[0], -r * u - at[1]];
        let (matrix, there) = (self.free(time), self.forced(t + time));
        [0, 1].map(|row| matrix[row][0] * free[0] + matrix[row][1] * free[1] + there[row])
    }

    /// Time and velocity of the impact of the cycle that has one in each period, by Newton's method with differences.
    fn impact(&self, start: (f64, f64), wall: (f64, f64)) -> (f64, f64) {
        let period = 2.0 * PI / self.w;
        let defect = |(t, u): (f64, f64)| {
            let [x, v] = self.after((t, u), wall, period);
            [x - wall.0, v - u]
        };
        let (mut t, mut u) = start;
        for _ in 0..50 {
            let [f, g] = defect((t, u));
            let h = 1e-6;
            let [ft, gt] = [0, 1].map(|row| (defect((t + h, u))[row] - defect((t - h, u))[row]) / (2.0 * h));
            let [fu, gu] = [0, 1].map(|row| (defect((t, u + h))[row] - defect((t, u - h))[row]) / (2.0 * h));
            let determinant = ft * gu - fu * gt;
            t -= (f * gu - g * fu) / determinant;
            u -= (ft * g - gt * f) / determinant;
        }
        (t, u)
    }

    /// Trace and determinant of the linearised map from impact to impact: the saltation matrix times the free motion.
    fn map(&self, (t, u): (f64, f64), (s, r): (f64, f64)) -> [f64; 2] {
        let rate = |v: f64| -s - 2.0 * self.z * v + (self.w * t).cos();
        let saltation = [[-r, 0.0], [(rate(-r * u) + r * rate(u)) / u, -r]];
        let free = self.free(2.0 * PI / self.w);
        let entry = |row: usize, column: usize| {
            saltation[row][0] * free[0][column] + saltation[row][1] * free[1][column]
        };
        [entry(0, 0) + entry(1, 1), entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0)]
    }

    fn orbit(&self, impact: (f64, f64), wall: (f64, f64)) -> Orbit {
        let period = 2.0 * PI / self.w;
        let half = 0.5 * period;
        orbit(period, &[half], |time| {
            let since = if time < half { time + half } else { time - half };
            let [x, v] = self.after(impact, wall, since);
            let (sine, cosine) = (self.w * (impact.0 + since)).sin_cos();
            vec![x, v, cosine, sine]
        })
    }
}

#[test]
fn an_impact_oscillator_has_its_impacts_multipliers_and_period_doubling_in_closed_form() {
    let (z, wall) = (0.05, (0.1, 0.8));
    let linear = Linear::new(2.0, z);
    let impact = linear.impact((0.915, 3.697), wall);
    let start = linear.orbit(impact, wall);
    let found = branch(&Impacts, start, &[2.0, z, wall.0, wall.1], "w", [1.5, 3.0], &[1.5, 2.0, 2.8]);
    for (value, near) in [(1.5, (0.157, 1.66)), (2.0, (0.915, 3.697)), (2.8, (1.12, 0.1))] {
        let linear = Linear::new(value, z);
        let (t, u) = linear.impact(near, wall);
        let point = requested(&found, value);
        assert!(point.error_estimate < 1e-9, "{:e}", point.error_estimate);
        assert!((point.period - 2.0 * PI / value).abs() < 1e-9);
        assert!((point.max[0] - wall.0).abs() < 1e-9, "{}", point.max[0]);
        // The largest velocity is that before the impact, as long as none between is larger.
        let largest = (0..4000)
            .map(|index| linear.after((t, u), wall, 2.0 * PI / value * f64::from(index) / 4000.0)[1]);
        assert!((point.max[1] - largest.fold(u, f64::max)).abs() < 1e-5, "{} {u}", point.max[1]);
        let [trace, determinant] = linear.map((t, u), wall);
        // The oscillator that forces it has the multipliers 1 and exp(-2 T).
        let forcing = (-4.0 * PI / value).exp();
        for multiplier in &point.multipliers {
            let own = (multiplier * multiplier - multiplier * trace + determinant).norm();
            let others = (multiplier - 1.0).norm().min((multiplier - forcing).norm());
            assert!(own.min(others) < 1e-8 * trace.abs().max(1.0), "{multiplier} at {value}: {own:e}");
        }
    }
    // At -1 is a multiplier where 1 + trace + determinant = 0.
    let doubling = found
        .points
        .iter()
        .find(|point| point.label.is_some_and(|label| label.kind == SpecialKind::PeriodDoubling))
        .unwrap();
    let at = |value: f64| {
        let linear = Linear::new(value, z);
        let [trace, determinant] = linear.map(linear.impact((1.214, 0.36), wall), wall);
        1.0 + trace + determinant
    };
    let (mut low, mut high) = (2.4, 2.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if at(low) * at(middle) <= 0.0 { high = middle } else { low = middle }
    }
    assert!((doubling.value - low).abs() < 1e-8, "{} instead of {low}", doubling.value);
}

#[test]
fn a_forced_oscillator_grazes_a_wall_at_its_amplitude_from_both_sides() {
    let (w, z, r) = (3.0, 0.05, 0.8);
    let linear = Linear::new(w, z);
    let amplitude = linear.a.hypot(linear.b);
    let free = orbit(2.0 * PI / w, &[], |time| {
        let ([x, v], (sine, cosine)) = (linear.forced(time), (w * time).sin_cos());
        vec![x, v, cosine, sine]
    });
    let found = branch(&Impacts, free, &[w, z, 1.0, r], "s", [0.05, 1.2], &[]);
    let (of, value, located) = grazing(&found.stops[0]);
    assert!(of == Grazed::Event(1) && located && (value - amplitude).abs() < 1e-9, "{value} {amplitude}");
    // With impacts, from the other side.
    let w = 2.0;
    let linear = Linear::new(w, z);
    let amplitude = linear.a.hypot(linear.b);
    let impact = linear.impact((0.915, 3.697), (0.1, r));
    let found = branch(&Impacts, linear.orbit(impact, (0.1, r)), &[w, z, 0.1, r], "s", [0.0, 2.0], &[]);
    let (of, value, located) = grazing(&found.stops[1]);
    assert!(of == Grazed::Event(1) && located && (value - amplitude).abs() < 1e-6, "{value} {amplitude}");
}

/// The block from the end of a stick on: duration of the slip, position at its end and smallest position and velocity.
fn slip(belt: f64) -> (f64, f64, [f64; 2]) {
    let integrator = Integrator::with_tolerance(1e-13);
    let field = || {
        from_fn(2, move |_time, x: &[f64], slope: &mut [f64]| {
            slope[0] = x[1];
            slope[1] = -x[0] - DAMPING * x[1] + 1.0 / (1.0 + belt - x[1]);
        })
    };
    let start = [1.0 - DAMPING * belt, belt];
    let mut sticks =
        [Event::new(move |time, x: &[f64]| if time < 0.1 { -1.0 } else { x[1] - belt }).rising().terminal()];
    let end = integrator.with_events(field(), 0.0, &start, 100.0, &[], &mut sticks).unwrap();
    let mut turns = [
        Event::new(|_, x: &[f64]| x[1]).rising(),
        Event::new(move |_, x: &[f64]| -x[0] - DAMPING * x[1] + 1.0 / (1.0 + belt - x[1])).rising(),
    ];
    let way = integrator.with_events(field(), 0.0, &start, end.time, &[], &mut turns).unwrap();
    let lowest = |component: usize| {
        way.crossings.iter().map(|crossing| crossing.state[component]).fold(f64::INFINITY, f64::min)
    };
    (end.time, end.state[0], [lowest(0), lowest(1)])
}

fn stick_slip(belt: f64) -> (f64, Orbit) {
    let (duration, position, _) = slip(belt);
    let release = 1.0 - DAMPING * belt;
    let stick = (release - position) / belt;
    let period = duration + stick;
    // The unit time begins in the middle of the slip.
    let field = from_fn(2, move |_time, x: &[f64], slope: &mut [f64]| {
        slope[0] = x[1];
        slope[1] = -x[0] - DAMPING * x[1] + 1.0 / (1.0 + belt - x[1]);
    });
    let times: Vec<f64> = (0..=20000).map(|index| duration * f64::from(index) / 20000.0).collect();
    let way = Integrator::with_tolerance(1e-12).sample(field, &[release, belt], &times).unwrap();
    let states: Vec<Vec<f64>> = way.samples().map(|(_, state)| state.to_vec()).collect();
    let half = 0.5 * duration;
    let cycle = orbit(period, &[half, half + stick], move |time| {
        let since = time - half;
        if (0.0..stick).contains(&since) {
            return vec![position + belt * since, belt];
        }
        let slipping = if since < 0.0 { time + half } else { since - stick };
        let place = (slipping / duration * 20000.0).clamp(0.0, 19999.999);
        let (index, part) = (place as usize, place.fract());
        let pair = states[index].iter().zip(&states[index + 1]);
        pair.map(|(one, other)| one + part * (other - one)).collect()
    });
    (period, cycle)
}

#[test]
fn a_block_on_a_belt_sticks_and_slips() {
    let (_, start) = stick_slip(0.5);
    let found = branch(&Belt, start, &[0.5], "b", [0.1, 3.5], &[0.1, 0.5, 0.8, 2.0, 3.0]);
    let values: Vec<f64> = found.points.iter().map(|point| point.value).collect();
    assert!(values.is_sorted(), "{values:?}");
    for value in [0.1, 0.5, 0.8] {
        let point = requested(&found, value);
        let (period, _) = stick_slip(value);
        let (_, _, lowest) = slip(value);
        assert!((point.period / period - 1.0).abs() < 1e-9, "{} instead of {period}", point.period);
        assert!((point.max[1] - value).abs() < 1e-9);
        assert!((point.min[0] - lowest[0]).abs() < 1e-8 && (point.min[1] - lowest[1]).abs() < 1e-8);
        assert!(
            point.multipliers.iter().any(|multiplier| multiplier.norm() == 0.0),
            "{:?}",
            point.multipliers
        );
        assert_eq!(point.stable, Some(true));
    }
    // On fast belts the block overtakes the belt before it sticks: SciPy's DOP853 at 1e-12 with events and Filippov's field.
    for (value, period, fastest) in
        [(2.0, 6.449780706979948, 2.00255671), (3.0, 6.34877640678173, 3.00638222)]
    {
        let point = requested(&found, value);
        assert!((point.period / period - 1.0).abs() < 1e-9, "{} instead of {period}", point.period);
        assert!((point.max[1] - fastest).abs() < 1e-8, "{}", point.max[1]);
        assert!(
            point.multipliers.iter().any(|multiplier| multiplier.norm() == 0.0),
            "{:?}",
            point.multipliers
        );
    }
}

/// A drug that dies out with the rate .23 and of which .81 is given, and a hundredth is lost, whenever the clock has come to 1.39.
struct Doses;

impl VectorField for Doses {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "clock".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], slope: &mut [T]) {
        slope[0] = x[0] * -0.23;
        slope[1] = p[0];
    }
    fn events(&self) -> Vec<Direction> {
        vec![Direction::Rising]
    }
    fn evaluate_event<T: Scalar>(&self, _event: usize, x: &[T], _p: &[T], values: &mut [T]) {
        values[0] = x[1] - 1.39;
        if let [_, next @ ..] = values
            && !next.is_empty()
        {
            next[0] = x[0] * 0.99 + 0.81;
            next[1] = T::zero();
        }
    }
}

/// Wherever the unit time begins, and whatever cycles are asked for before.
#[test]
fn doses_have_their_closed_form_up_to_the_last_cycle() {
    let dosed = |p: f64| {
        let period = 1.39 / p;
        (period, 0.81 / (1.0 - 0.99 * (-0.23 * period).exp()))
    };
    let (period, most) = dosed(1.0);
    let asked = [&[][..], &[0.8, 1.1, 1.4, 1.7], &[1.9], &[1.95, 1.99]];
    // The unit time begins this long before a dose.
    for (at, left) in asked.into_iter().flat_map(|at| [0.12, 0.7, 1.3].map(|left| (at, left))) {
        let start = orbit(period, &[left], |time| {
            let since = if time < left { time + period - left } else { time - left };
            vec![most * (-0.23 * since).exp(), since]
        });
        let found = branch(&Doses, start, &[1.0], "p", [0.5, 2.0], at);
        let ends = [found.points.first().unwrap(), found.points.last().unwrap()];
        assert_eq!(ends.map(|point| point.value), [0.5, 2.0]);
        for point in at.iter().map(|value| requested(&found, *value)).chain(ends) {
            let (period, most) = dosed(point.value);
            assert!((point.period / period - 1.0).abs() < 1e-9, "{at:?} {} {}", point.value, point.period);
            assert!((point.max[0] / most - 1.0).abs() < 1e-7, "{at:?} {} {}", point.value, point.max[0]);
            assert_eq!(point.stable, Some(true));
        }
    }
}

/// Two cells, each of which gives the other .1 where it fires: `x' = 1.5 p - x`, `y' = 1.6 - y`, both reset at 1.
struct Pair;

impl VectorField for Pair {
    fn state_names(&self) -> Vec<String> {
        vec!["x".into(), "y".into()]
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, x: &[T], p: &[T], slope: &mut [T]) {
        slope[0] = p[0] * 1.5 - x[0];
        slope[1] = -x[1] + 1.6;
    }
    fn events(&self) -> Vec<Direction> {
        vec![Direction::Rising; 2]
    }
    fn evaluate_event<T: Scalar>(&self, event: usize, x: &[T], _p: &[T], values: &mut [T]) {
        values[0] = x[event] - 1.0;
        if let [_, next @ ..] = values
            && !next.is_empty()
        {
            next[event] = T::zero();
            next[1 - event] = x[1 - event] + 0.1;
        }
    }
}

/// The cells fire together as long as y is between .9 and 1 when x fires: nothing is touched at either end, and what is told last is
/// a cycle.
#[test]
fn two_events_that_part_end_a_branch_and_say_so() {
    let period = |p: f64| ((1.5 * p - 0.1) / (1.5 * p - 1.0)).ln();
    let p: f64 = 1.1;
    let half = 0.5 * period(p);
    let start = orbit(period(p), &[half], |time| {
        let since = if time < half { time + half } else { time - half };
        vec![1.5 * p + (0.1 - 1.5 * p) * (-since).exp(), 1.6 - 1.6 * (-since).exp()]
    });
    let found = branch(&Pair, start, &[p], "p", [0.7, 1.5], &[1.05, 1.1]);
    let ends = [found.points.first().unwrap(), found.points.last().unwrap()];
    let expected = [0.9625 / 0.9375, 0.95625 / 0.84375];
    for ((stop, point), expected) in found.stops.iter().zip(ends).zip(expected) {
        let (of, value, _) = grazing(stop);
        assert!(matches!(of, Grazed::Together(_)), "{of:?}");
        assert!((value - expected).abs() < 1e-5, "{value} instead of {expected}");
        assert!((point.value - expected).abs() < 1e-5, "{} instead of {expected}", point.value);
        assert!((point.period / period(point.value) - 1.0).abs() < 1e-7, "{}", point.period);
        assert!((point.max[0] - 1.0).abs() < 1e-7 && (point.min[0] - 0.1).abs() < 1e-7);
    }
}
