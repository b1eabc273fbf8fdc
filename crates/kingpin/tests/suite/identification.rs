//! Identification judged by truth from outside: intervals over many records with noise, and records that another program integrated.

use arclength::control::Control;
use kingpin::identification::{Column, Identification, Identified, Record, Start};
use kingpin::{Key, Wheel};
use rayon::prelude::*;

/// Normal numbers: SplitMix64 (Steele, Lea and Flood 2014), turned by Box and Muller.
struct Noise(u64);

impl Noise {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((mixed ^ (mixed >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (-2.0 * self.unit().ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }
}

fn wheel(values: &[(&str, &str)]) -> Wheel {
    let mut wheel = Wheel::default();
    for (key, value) in values {
        wheel.set(key, value).unwrap();
    }
    wheel
}

/// The caster angle of a wheel that was released at rest.
fn released(truth: &Wheel, angle: f64, duration: f64, samples: usize) -> Record {
    let history = truth.simulate(duration, &[("psi", angle)], samples, &Control::none()).unwrap();
    let values = history.state("psi").unwrap();
    let columns = vec![Column { state: "psi".to_owned(), values }];
    Record { wheel: *truth, times: history.times, columns }
}

/// A record with noise of a standard deviation.
fn noisy(record: &Record, deviation: f64, seed: u64) -> Record {
    let mut noise = Noise(seed.wrapping_mul(0x1234_5678_9abc_def1));
    let mut record = record.clone();
    for column in &mut record.columns {
        column.values.iter_mut().for_each(|value| *value += deviation * noise.next());
    }
    record
}

fn identify(records: Vec<Record>, keys: &[Key]) -> Identified {
    Identification::new(records, keys).unwrap().run(&Control::none()).unwrap()
}

/// How many of the intervals of a parameter hold its truth.
fn covering(all: &[Identified], truth: &Wheel, key: Key) -> usize {
    let holds = |identified: &&Identified| {
        let estimate = identified.estimates.iter().find(|estimate| estimate.key == key).unwrap();
        let value = truth.get(key);
        let interval = estimate.interval;
        interval.lower.is_none_or(|lower| lower <= value) && interval.upper.is_none_or(|upper| value <= upper)
    };
    all.iter().filter(holds).count()
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    const REPETITIONS: usize = 200;
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("c_psi", "0.003")]);
    let exact = released(&truth, 0.2, 0.5, 41);
    let all: Vec<Identified> = (0..REPETITIONS)
        .into_par_iter()
        .map(|seed| identify(vec![noisy(&exact, 0.01, seed as u64)], &[Key::K, Key::CPsi]))
        .collect();
    for key in [Key::K, Key::CPsi] {
        let covering = covering(&all, &truth, key);
        println!("{key}: {covering} of {REPETITIONS}");
        // A binomial number with 200 trials of 0.95 is below 181 or above 198 once in 400 times (scipy.stats.binom).
        assert!((181..=198).contains(&covering), "{key}: {covering} of {REPETITIONS}");
    }
    // The standard errors are how far the estimates scatter.
    for (index, key) in [Key::K, Key::CPsi].into_iter().enumerate() {
        let values: Vec<f64> =
            all.iter().map(|identified| identified.estimates[index].value.unwrap()).collect();
        let mean = values.iter().sum::<f64>() / REPETITIONS as f64;
        let variance =
            values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (REPETITIONS - 1) as f64;
        let errors = all.iter().map(|identified| identified.estimates[index].standard_error.unwrap());
        let error = errors.sum::<f64>() / REPETITIONS as f64;
        println!("{key}: scatter {}, standard error {error}", variance.sqrt());
        assert!((variance.sqrt() / error - 1.0).abs() < 0.15, "{key}: {} {error}", variance.sqrt());
    }
    // Residuals of what the model explains are noise, in all but a hundredth of the records.
    let white = all.iter().filter(|identified| identified.records[0].columns[0].whiteness.is_white()).count();
    println!("noise: {white} of {REPETITIONS}");
    assert!(white >= 190, "{white}");
}

#[test]
fn intervals_hold_through_swings_and_rests() {
    const REPETITIONS: usize = 40;
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("M_f", "0.03")]);
    let exact = released(&truth, 0.3, 0.6, 61);
    let all: Vec<Identified> = (0..REPETITIONS)
        .into_par_iter()
        .map(|seed| {
            let record = noisy(&exact, 0.005, seed as u64);
            let identification = Identification::new(vec![record], &[Key::K, Key::MF]).unwrap();
            // It was released at rest.
            identification.start("Omega", Start::Uniform).unwrap().run(&Control::none()).unwrap()
        })
        .collect();
    for key in [Key::K, Key::MF] {
        let covering = covering(&all, &truth, key);
        println!("{key}: {covering} of {REPETITIONS}");
        // 40 trials of 0.95: below 34 once in 300 times.
        assert!((34..=40).contains(&covering), "{key}: {covering} of {REPETITIONS}");
    }
}

#[test]
fn an_interval_that_reaches_zero_is_one_sided_and_holds_the_truth() {
    const REPETITIONS: usize = 50;
    // There is no damper.
    let truth = wheel(&[("r", "inf"), ("v", "1")]);
    let exact = released(&truth, 0.2, 0.5, 41);
    let all: Vec<Identified> = (0..REPETITIONS)
        .into_par_iter()
        .map(|seed| identify(vec![noisy(&exact, 0.01, seed as u64)], &[Key::K, Key::CPsi]))
        .collect();
    let covering = covering(&all, &truth, Key::CPsi);
    let one_sided =
        all.iter().filter(|identified| identified.estimates[1].interval.reaches_lower_bound).count();
    println!("c_psi: {covering} of {REPETITIONS}, {one_sided} one-sided");
    // 50 trials of 0.95: below 43 once in 400 times.
    assert!(covering >= 43 && one_sided >= 43, "{covering} {one_sided}");
    assert!(all.iter().all(|identified| identified.estimates[1].value.unwrap() >= 0.0));
}

#[test]
fn records_at_two_speeds_tell_apart_what_one_does_not() {
    // Where the wheel stands and is hit, the dampers act as one of c_psi + l^2 c_q; where it is towed they do not.
    let truth = |speed: &str| wheel(&[("r", "inf"), ("v", speed), ("c_q", "0.3"), ("c_psi", "0.0015")]);
    let standing =
        truth("0").simulate_from(&[0.0, 0.0, 0.1, 0.0, -10.0], 1.0, 101, &Control::none()).unwrap();
    let columns = vec![Column { state: "psi".to_owned(), values: standing.state("psi").unwrap() }];
    let standing = Record { wheel: truth("0"), times: standing.times, columns };
    let standing = noisy(&standing, 0.002, 3);
    let towed = noisy(&released(&truth("1"), 0.4, 1.0, 101), 0.002, 4);
    let keys = [Key::K, Key::CQ, Key::CPsi];
    let of_dampers = |identified: &Identified| identified.correlations[1][2].unwrap();
    let one = identify(vec![standing.clone()], &keys);
    let two = identify(vec![standing, towed], &keys);
    println!("{} {}", of_dampers(&one), of_dampers(&two));
    assert!(of_dampers(&one) < -0.999, "{}", of_dampers(&one));
    assert!(one.not_separated.iter().any(|group| group.keys == [Key::CQ, Key::CPsi]));
    assert!(of_dampers(&two) > -0.99, "{}", of_dampers(&two));
    assert!(two.not_separated.iter().all(|group| group.keys != [Key::CQ, Key::CPsi]));
    let error = |identified: &Identified| identified.estimates[1].standard_error.unwrap();
    assert!(error(&two) < 0.3 * error(&one), "{} {}", error(&two), error(&one));
}

/// Reads columns of numbers under a line of names and comments.
fn columns(text: &str) -> Vec<Vec<f64>> {
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let rows: Vec<Vec<f64>> =
        rows.map(|row| row.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    (0..rows[0].len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect()
}

#[test]
fn a_record_of_another_program_gives_back_its_parameters() {
    // Integrated with SciPy's DOP853 from the equations of motion, with events of its own, at k = 100, c_q = 0.3, c_psi = 0.0015 and
    // M_f = 0.015; the second with noise of 0.002 rad.
    for (text, tolerance) in [
        (include_str!("../records/dry_friction.csv"), [1e-7; 4]),
        (include_str!("../records/dry_friction_noise.csv"), [0.05, 0.4, 0.5, 0.1]),
    ] {
        let [times, values] = columns(text).try_into().unwrap();
        let start = wheel(&[("r", "inf"), ("v", "1"), ("k", "150")]);
        let record =
            Record { wheel: start, times, columns: vec![Column { state: "psi".to_owned(), values }] };
        let found = identify(vec![record], &[Key::K, Key::CQ, Key::CPsi, Key::MF]);
        let truth = [100.0, 0.3, 0.0015, 0.015];
        for ((estimate, truth), tolerance) in found.estimates.iter().zip(truth).zip(tolerance) {
            let error = (estimate.value.unwrap() / truth - 1.0).abs();
            assert!(error < tolerance, "{}: {error}", estimate.key);
            let interval = estimate.interval;
            let width = (interval.upper.unwrap() - interval.lower.unwrap()) / truth;
            assert!(
                width < 2.0
                    && (tolerance < 1e-3
                        || (interval.lower.unwrap() < truth && truth < interval.upper.unwrap()))
            );
        }
    }
}

#[test]
fn an_unknown_zero_of_the_instrument_is_found() {
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("c_psi", "0.003")]);
    let mut record = noisy(&released(&truth, 0.2, 1.0, 101), 0.001, 5);
    record.columns[0].values.iter_mut().for_each(|value| *value += 0.05);
    let identification = Identification::new(vec![record], &[Key::K, Key::CPsi]).unwrap();
    let found = identification.clone().offset("psi").unwrap().run(&Control::none()).unwrap();
    assert!((found.records[0].columns[0].offset - 0.05).abs() < 1e-3);
    assert!(found.records[0].columns[0].whiteness.is_white());
    // Without it what is left over is no noise.
    let found = identification.run(&Control::none()).unwrap();
    assert!(!found.records[0].columns[0].whiteness.is_white());
}

#[test]
fn noise_that_is_known_is_judged() {
    let truth = wheel(&[("r", "inf"), ("v", "1"), ("c_psi", "0.003")]);
    let record = noisy(&released(&truth, 0.2, 1.0, 101), 0.002, 9);
    let identification = Identification::new(vec![record], &[Key::K, Key::CPsi]).unwrap();
    let identification = identification.start("Omega", Start::Uniform).unwrap();
    let with = |deviation: f64| {
        let identification = identification.clone().deviation("psi", deviation).unwrap();
        identification.run(&Control::none()).unwrap()
    };
    let right = with(0.002);
    assert!(right.chi_squared.unwrap().probability > 0.01);
    let too_small = with(0.001);
    assert!(too_small.chi_squared.unwrap().probability < 1e-6);
    // Intervals follow the noise that was given.
    let width = |found: &Identified| {
        found.estimates[0].interval.upper.unwrap() - found.estimates[0].interval.lower.unwrap()
    };
    assert!((width(&right) / width(&too_small) - 2.0).abs() < 0.01);
}

#[test]
fn intervals_hold_the_truth_where_a_bound_holds_another_parameter() {
    // Both dampers damp nearly the same: a record says little of each by itself, and one of them is often estimated as none.
    const REPETITIONS: usize = 24;
    let set = [
        ("l", "0.055"),
        ("r", "inf"),
        ("m_w", "0.5"),
        ("m_c", "0.25"),
        ("J_wxi", "0.002"),
        ("J_wzeta", "0.0011"),
        ("J_Cz", "0.0002"),
        ("R", "0.09"),
        ("l_c", "0.03"),
        ("v", "1.6"),
        ("k", "5200"),
        ("c_q", "8"),
        ("c_psi", "0.01"),
    ];
    let truth = wheel(&set);
    let exact = released(&truth, 0.1, 0.6, 161);
    let keys = [Key::K, Key::CQ, Key::CPsi];
    let of = |seed: usize| {
        let identification = Identification::new(vec![noisy(&exact, 0.003, seed as u64)], &keys).unwrap();
        identification.start("Omega", Start::Uniform).unwrap().run(&Control::none()).unwrap()
    };
    let all: Vec<Identified> = (0..REPETITIONS).into_par_iter().map(of).collect();
    let at_bound = all.iter().filter(|identified| identified.wheel.get(Key::CPsi) == 0.0).count();
    assert!(at_bound > 0, "no bound was reached");
    for key in keys {
        let covering = covering(&all, &truth, key);
        // A binomial number with 24 trials of 0.95 is below 19 once in 1000 times (scipy.stats.binom).
        assert!(covering >= 19, "{key}: {covering} of {REPETITIONS}");
    }
    // What follows goes with these intervals.
    let of = |(seed, identified): (usize, &Identified)| {
        let record = noisy(&exact, 0.003, seed as u64);
        let identification =
            Identification::new(vec![record], &keys).unwrap().start("Omega", Start::Uniform).unwrap();
        identification
            .interval_of(identified, &identified.wheel, &critical, &Control::none())
            .unwrap()
            .unwrap()
    };
    let speed = critical(&truth);
    let intervals: Vec<_> = all.par_iter().enumerate().map(of).collect();
    let covering =
        intervals.iter().filter(|interval| (interval.lower..=interval.upper).contains(&speed)).count();
    println!("critical speed: {covering} of {REPETITIONS}");
    assert!(covering >= 19, "critical speed: {covering} of {REPETITIONS}");
}

/// The critical speed; infinite where there is none.
fn critical(wheel: &Wheel) -> f64 {
    wheel.critical_speed().map_or(f64::INFINITY, |critical| critical.speed)
}

#[test]
fn the_interval_of_the_critical_speed_holds_the_truth_and_goes_with_those_of_the_parameters() {
    // A nose wheel on a circle: stiffness and dampers are correlated by 0.998 to 1, and the truth has one damper and the friction at
    // their bound.
    const REPETITIONS: usize = 40;
    let set = [
        ("l", "0.09"),
        ("r", "2"),
        ("m_w", "5"),
        ("m_c", "3"),
        ("J_wxi", "0.08"),
        ("J_wzeta", "0.045"),
        ("J_Cz", "0.02"),
        ("R", "0.17"),
        ("l_c", "0.03"),
        ("v", "18.447"),
        ("k", "6e4"),
        ("c_psi", "3"),
    ];
    let truth = wheel(&set);
    let speed = critical(&truth);
    let exact = released(&truth, 0.01, 0.12, 161);
    let keys = [Key::K, Key::CQ, Key::CPsi, Key::MF];
    let of = |seed: usize| {
        let record = noisy(&exact, 0.0005, seed as u64);
        let identification = Identification::new(vec![record], &keys).unwrap();
        let found = identification.run(&Control::none()).unwrap();
        let interval =
            identification.interval_of(&found, &found.wheel, &critical, &Control::none()).unwrap().unwrap();
        println!("{seed}: {:.4} {:.4} {:.4}", critical(&found.wheel), interval.lower, interval.upper);
        // Another value of c_psi that is likely is one of another critical speed.
        let of_c_psi = found.estimates[2].interval;
        (interval, [of_c_psi.lower, of_c_psi.upper].map(Option::unwrap), critical(&found.wheel))
    };
    let all: Vec<_> = (0..REPETITIONS).into_par_iter().map(of).collect();
    let covering =
        all.iter().filter(|(interval, ..)| (interval.lower..=interval.upper).contains(&speed)).count();
    println!("critical speed: {covering} of {REPETITIONS}");
    // A binomial number with 40 trials of 0.95 is below 34 once in 300 times.
    assert!(covering >= 34, "{covering} of {REPETITIONS}");
    // An estimate is no end of its interval where the ends for the parameters lie on both sides.
    let one_sided = |(interval, [lower, upper], estimate): &&([f64; 2], [f64; 2], f64)| {
        lower < upper && (interval[0] > 0.999 * estimate || interval[1] < 1.001 * estimate)
    };
    let ends: Vec<_> = all
        .iter()
        .map(|(interval, of_c_psi, estimate)| ([interval.lower, interval.upper], *of_c_psi, *estimate))
        .collect();
    let one_sided = ends.iter().filter(one_sided).count();
    assert_eq!(one_sided, 0, "{ends:?}");
}
