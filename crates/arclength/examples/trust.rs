//! How often what is told is right: random systems whose equilibria and cycles are known in closed form, counted.
//!
//! `cargo run --release --example trust -- [COUNT [SEED]]` draws COUNT systems of every kind (8 by default) and prints a table. A count
//! under "wrong" is a promise that was broken; the program then ends with exit code 1.

use arclength::cycle::{CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::{Equilibria, EquilibriumBranch};
use arclength::{Error, Scalar, VectorField};
use std::f64::consts::TAU;
use std::process::ExitCode;

/// Pseudo-random numbers (Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014)).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Numbers in ascending order inside the interval from -1 to 1.
    fn places(&mut self, count: usize) -> Vec<f64> {
        let mut places: Vec<f64> = (0..count).map(|_| self.between(-0.9, 0.9)).collect();
        places.sort_by(f64::total_cmp);
        places
    }
}

/// A circle of radius `sqrt(p)` with the angular velocity `speed + shear p`, its coordinates stretched by `sinh(s .)/s`, beside a
/// state that dies out or grows at a constant rate.
struct Circle {
    speed: f64,
    shear: f64,
    contraction: f64,
    stretch: f64,
    rate: f64,
}

impl VectorField for Circle {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(str::to_owned).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        // u = asinh(s x)/s, and x' = sqrt(1 + (s x)^2) u'.
        let root = |x: T| (x * x * (self.stretch * self.stretch) + 1.0).sqrt();
        let coordinate = |x: T| (x * self.stretch + root(x)).ln() / self.stretch;
        let (u, v) = (coordinate(s[0]), coordinate(s[1]));
        let square = u * u + v * v;
        let growth = (p[0] - square) * self.contraction;
        let speed = square * self.shear + self.speed;
        d[0] = root(s[0]) * (growth * u - speed * v);
        d[1] = root(s[1]) * (growth * v + speed * u);
        d[2] = s[2] * self.rate + (s[0] * s[0] - s[1] * s[1]) * s[2];
    }
}

/// The circle of radius `size` in the logarithm of `x`: cycles on which `x` nearly vanishes.
struct Logarithm {
    contraction: f64,
}

impl VectorField for Logarithm {
    fn state_names(&self) -> Vec<String> {
        ["x", "v"].map(str::to_owned).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["size".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let u = s[0].ln();
        let growth = (p[0] * p[0] - u * u - s[1] * s[1]) * self.contraction / (p[0] * p[0]);
        d[0] = s[0] * (growth * u - s[1]);
        d[1] = growth * s[1] + u;
    }
}

/// A pair of eigenvalues whose real part is a polynomial of the parameter with known zeros, a state that follows the parameter
/// around known folds, and stiff company.
struct Known {
    hopf: Vec<f64>,
    speed: f64,
    stiff: f64,
}

impl VectorField for Known {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "z"].map(str::to_owned).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["p".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], p: &[T], d: &mut [T]) {
        let growth = self.hopf.iter().fold(T::from(1.0), |product, place| product * (p[0] - *place));
        let square = s[0] * s[0] + s[1] * s[1];
        d[0] = (growth - square) * s[0] - s[1] * self.speed;
        d[1] = (growth - square) * s[1] + s[0] * self.speed;
        d[2] = (p[0] - s[2]) * self.stiff;
    }
}

/// What became of the cases of one kind.
#[derive(Default)]
struct Counts {
    judged: usize,
    wrong: usize,
    undecided: usize,
    refused: usize,
    /// Ratios of the errors told to those that were made, where these are not rounding.
    ratios: Vec<f64>,
}

impl Counts {
    fn row(&mut self, kind: &str) {
        self.ratios.sort_by(f64::total_cmp);
        let at = |part: f64| self.ratios.get((part * self.ratios.len() as f64) as usize);
        let text = |ratio: Option<&f64>| ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.1}"));
        println!(
            "{kind:24} {:7} {:6} {:10} {:8} {:>8} {:>8}",
            self.judged,
            self.wrong,
            self.undecided,
            self.refused,
            text(at(0.5)),
            text(at(0.95))
        );
    }

    /// Judges one cycle by its period, the ranges of its first states and the logarithm of its largest nontrivial multiplier.
    fn cycle(&mut self, cycle: &CyclePoint, [period, exponent]: [f64; 2], ranges: [[f64; 2]; 2]) {
        self.judged += 1;
        let mut error = (cycle.period / period - 1.0).abs();
        for (state, [smallest, largest]) in ranges.into_iter().enumerate() {
            let amplitude = 0.5 * (largest - smallest);
            let off = (cycle.max[state] - largest).abs().max((cycle.min[state] - smallest).abs());
            error = error.max(off / amplitude);
        }
        let told = cycle.error_estimate;
        if told >= 1.0 || cycle.stable.is_none() {
            self.undecided += 1;
        }
        let is_stable_wrong = cycle.stable.is_some_and(|stable| stable != (exponent < 0.0));
        if error > (3.0 * told).max(1e-9) || is_stable_wrong {
            self.wrong += 1;
            let stable = cycle.stable;
            eprintln!(
                "at {}: error {error:e}, told {told:e}, stable {stable:?}, ln mu {exponent}",
                cycle.value
            );
        }
        if error > 1e-12 {
            self.ratios.push(told / error);
        }
    }
}

fn circles(random: &mut Random, count: usize) -> Counts {
    let mut counts = Counts::default();
    for _ in 0..count {
        let field = Circle {
            speed: random.between(0.5, 3.0),
            shear: random.between(-0.2, 2.0),
            contraction: 10_f64.powf(random.between(-1.5, 1.0)),
            stretch: random.between(0.1, 3.0),
            rate: random.between(-2.0, 0.5),
        };
        let stretched = |u: f64| (field.stretch * u).sinh() / field.stretch;
        let start = Orbit::from_function(TAU / (field.speed + field.shear), |time| {
            let angle = time * (field.speed + field.shear);
            vec![stretched(angle.cos()), stretched(angle.sin()), 0.0]
        });
        let run = Cycles::of(&field, CycleStart::Orbit(start)).parameters(&[1.0]).along("p", 0.5..=2.0).run();
        let Ok(branch) = run else {
            counts.refused += 1;
            continue;
        };
        for cycle in branch.points.iter().filter(|cycle| cycle.label.is_none()) {
            let p = cycle.value;
            let period = TAU / (field.speed + field.shear * p);
            let exponent = (-2.0 * field.contraction * p).max(field.rate) * period;
            let reach = stretched(p.sqrt());
            counts.cycle(cycle, [period, exponent], [[-reach, reach]; 2]);
        }
    }
    counts
}

fn logarithms(random: &mut Random, count: usize) -> Counts {
    let mut counts = Counts::default();
    for _ in 0..count {
        let field = Logarithm { contraction: random.between(-2.0, 2.0) };
        let start = Orbit::from_function(TAU, |time| vec![time.cos().exp(), time.sin()]);
        let largest = random.between(3.0, 9.0);
        let run = Cycles::of(&field, CycleStart::Orbit(start))
            .parameters(&[1.0])
            .along("size", 1.0..=largest)
            .run();
        let Ok(branch) = run else {
            counts.refused += 1;
            continue;
        };
        for cycle in branch.points.iter().filter(|cycle| cycle.label.is_none()) {
            let size = cycle.value;
            let ranges = [[(-size).exp(), size.exp()], [-size, size]];
            counts.cycle(cycle, [TAU, -2.0 * field.contraction * TAU], ranges);
        }
    }
    counts
}

fn hopf_points(random: &mut Random, count: usize) -> Counts {
    let mut counts = Counts::default();
    for _ in 0..count {
        let number = 1 + (random.unit() * 5.0) as usize;
        let field = Known {
            hopf: random.places(number),
            speed: random.between(0.2, 20.0),
            stiff: 10_f64.powf(random.between(-1.0, 10.0)),
        };
        let run: Result<EquilibriumBranch, Error> =
            Equilibria::of(&field).parameters(&[-1.0]).along("p", -1.0..=1.0).run();
        let Ok(branch) = run else {
            counts.refused += 1;
            continue;
        };
        counts.judged += 1;
        let found: Vec<f64> = branch.hopf_points().map(|point| point.value).collect();
        let right = found.len() == field.hopf.len()
            && found.iter().zip(&field.hopf).all(|(found, place)| (found - place).abs() < 1e-9);
        if !branch.unlocated.is_empty() {
            counts.undecided += 1;
        } else if !right {
            counts.wrong += 1;
            eprintln!("Hopf points {found:?}, right {:?}", field.hopf);
        }
    }
    counts
}

/// Draws so many systems of a kind and judges them.
type Judge = fn(&mut Random, usize) -> Counts;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let (Ok(count), Ok(seed)) = (arguments.next().unwrap_or(Ok(8)), arguments.next().unwrap_or(Ok(1))) else {
        eprintln!("two whole numbers are allowed: systems of every kind, and a seed");
        return ExitCode::from(2);
    };
    println!("{count} systems of every kind, seed {seed}");
    println!("kind                      judged  wrong  undecided  refused   median      95%");
    let mut random = Random(seed);
    let kinds: [(&str, Judge); 3] = [
        ("cycles, stretched circle", circles),
        ("cycles, state near zero", logarithms),
        ("branches with Hopf points", hopf_points),
    ];
    let mut wrong = 0;
    for (kind, judge) in kinds {
        let mut counts = judge(&mut random, count as usize);
        counts.row(kind);
        wrong += counts.wrong;
    }
    println!("median, 95%: error told over error made, where that is above 1e-12");
    if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
