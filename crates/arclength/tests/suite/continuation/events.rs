//! No special point is lost, invented or found twice, wherever it lies on a branch and however close to the next one.

use arclength::branch::{Labelled, SpecialKind};
use arclength::cycle::{CycleBranch, CyclePoint, CycleStart, Cycles, Orbit};
use arclength::equilibrium::Equilibria;
use arclength::{Scalar, VectorField};
use proptest::prelude::*;

// The unit circle with two Moebius directions: multipliers -exp(2 pi m) and -exp(2 pi (m - g)), period doublings at m = 0 and m = g.
field!(TwoDoublings, ["x", "y", "p", "q", "u", "w"], ["m", "g"], |s, k, d| {
    let (x, y) = (s[0], s[1]);
    let square = -(x * x + y * y) + 1.0;
    d[0] = square * x - y;
    d[1] = square * y + x;
    for (place, m) in [(2, k[0]), (4, k[0] - k[1])] {
        let (p, q) = (s[place], s[place + 1]);
        d[place] = (m - 1.0) * p * 0.5 + (m + 1.0) * (x * p + y * q) * 0.5 - q * 0.5 - p * (p * p + q * q);
        d[place + 1] =
            (m - 1.0) * q * 0.5 + (m + 1.0) * (y * p - x * q) * 0.5 + p * 0.5 - q * (p * p + q * q);
    }
});

/// The unit circle, beside which every other state rests at zero.
fn circle(dimension: usize) -> Orbit {
    Orbit::from_function(std::f64::consts::TAU, |time| {
        let mut state = vec![0.0; dimension];
        (state[0], state[1]) = (time.cos(), time.sin());
        state
    })
}

fn found(branch: &CycleBranch) -> Vec<(SpecialKind, f64)> {
    branch.special().map(|(kind, point)| (kind, point.values()[0])).collect()
}

#[test]
fn period_doublings_that_lie_close_together_are_both_found() {
    for gap in [0.05, 0.01, 0.003, 1e-3, 1e-4] {
        let branch = Cycles::of(&TwoDoublings, CycleStart::Orbit(circle(6)))
            .parameters(&[-0.5, gap])
            .along("m", -0.5..=0.5)
            .run()
            .unwrap();
        let found = found(&branch);
        let expected = [0.0, gap];
        assert!(
            found.len() == 2
                && found.iter().zip(expected).all(|((kind, value), place)| {
                    *kind == SpecialKind::PeriodDoubling && (value - place).abs() < 1e-9
                }),
            "{gap}: {found:?} {:?}",
            branch.unlocated
        );
        assert!(branch.unlocated.is_empty(), "{gap}: {:?}", branch.unlocated);
    }
}

// Chua's circuit with a smoothed piecewise-linear resistor.
field!(Chua, ["x", "y", "z"], ["alpha"], |s, k, d| {
    let (beta, steepness, a0, a1) = (14.3, 10.0, -1.0 / 7.0, 2.0 / 7.0);
    let (x, y, z) = (s[0], s[1], s[2]);
    let arm = |shifted: T| shifted * (shifted * steepness).atan() * (2.0 / std::f64::consts::PI);
    let current = x * a1 + (arm(x + 1.0) - arm(x - 1.0)) * (0.5 * (a0 - a1));
    d[0] = k[0] * (y - current);
    d[1] = x - y + z;
    d[2] = -(y * beta);
});

/// Folds along a branch alternate between maxima and minima of the parameter. Close to the homoclinic orbit they come with period
/// doublings at distances of 1e-12 of the range; one that is not located is named.
#[test]
fn folds_of_a_homoclinic_snake_alternate() {
    let along = |equilibria: Equilibria<'static>| equilibria.along("alpha", -1.0..=12.0).run().unwrap();
    let trivial = along(Equilibria::of(&Chua).parameters(&[-1.0]));
    let second = along(Equilibria::of(&Chua).from_branch_point(trivial.branch_points().next().unwrap()));
    let third = along(Equilibria::of(&Chua).from_branch_point(second.branch_points().next().unwrap()));
    let hopf = third.hopf_points().next().expect("a Hopf point");
    let cycles = Cycles::of(&Chua, CycleStart::from(hopf)).parameters(&hopf.parameters);
    let branch = cycles.along("alpha", -1.0..=12.0).run().unwrap();
    for p in &branch.points {
        eprintln!("{:?} {} {}", p.label, p.period, p.value);
    }
    eprintln!("{:?}", branch.stops);
    let folds: Vec<_> = branch.of_kind(SpecialKind::FoldOfCycles).collect();
    // Maxima at the periods 10.70, 13.12 and 15.54, and the minima between them.
    let truth = [
        (10.70, 11.07858841),
        (11.9112, 11.07835363),
        (13.12, 11.07841388),
        (14.3329, 11.078398422),
        (15.54, 11.07840239),
    ];
    for (period, value) in truth {
        let found =
            folds.iter().any(|fold| (fold.period - period).abs() < 4e-3 && (fold.value - value).abs() < 1e-8);
        let places: Vec<_> = folds.iter().map(|fold| (fold.period, fold.value)).collect();
        assert!(found, "no fold at the period {period}: {places:?}");
    }
    let named = |range: [f64; 2]| {
        branch.unlocated.iter().filter(|change| change.kind == Some(SpecialKind::FoldOfCycles)).any(
            |change| {
                let index = |value: f64| branch.points.iter().position(|point| point.value == value);
                let inside = |value: f64| (range[0].min(range[1])..=range[0].max(range[1])).contains(&value);
                change.between.iter().any(|values| index(values[0]).is_some() || inside(values[0]))
            },
        )
    };
    for pair in folds.windows(2) {
        let place =
            |fold: &CyclePoint| branch.points.iter().position(|point| point.period == fold.period).unwrap();
        let [one, other] = [place(pair[0]), place(pair[1])];
        // Away from both folds the parameter runs one way between them, or a fold between them is named.
        let turns = branch.points[one + 1..other]
            .windows(2)
            .map(|points| (points[1].value - points[0].value).signum())
            .collect::<Vec<_>>();
        let monotone = turns.windows(2).all(|signs| signs[0] == signs[1]);
        let alternate = branch.points[one].tests[0].1.is_finite() && monotone;
        assert!(
            alternate || named([pair[0].value, pair[1].value]),
            "{} to {}",
            pair[0].period,
            pair[1].period
        );
    }
}

// Arneodo, Coullet and Tresser's jerk equation, whose cycles snake to a homoclinic orbit of Shilnikov's.
field!(Jerk, ["x", "y", "z"], ["a"], |s, k, d| {
    d[0] = s[1];
    d[1] = s[2];
    d[2] = k[0] * s[0] - s[0] * s[0] - s[1] * 1.2 - s[2] * 0.6;
});

/// Folds by shooting (DOP853 at 3e-13 and Newton's method, extrema of `a` over the period), and none of them is a family for one value
/// of the parameter, though this hardly changes there.
#[test]
fn folds_beside_a_homoclinic_orbit_are_no_neutral_families() {
    let equilibria = Equilibria::of(&Jerk).parameters(&[0.3]).start(&[0.3, 0.0, 0.0]);
    let branch = equilibria.along("a", 0.3..=2.0).run().unwrap();
    let hopf = branch.hopf_points().next().expect("a Hopf point");
    let cycles = Cycles::of(&Jerk, CycleStart::from(hopf)).parameters(&hopf.parameters);
    let branch = cycles.along("a", 0.3..=6.0).run().unwrap();
    let folds: Vec<_> = branch.of_kind(SpecialKind::FoldOfCycles).collect();
    let truth = [
        (13.706459589, 2.3101764496252),
        (15.972365857, 2.3126372424223),
        (18.166640445, 2.3122155879297),
        (20.413962148, 2.3123000660324),
    ];
    for (period, value) in truth {
        let found =
            |fold: &&CyclePoint| (fold.period - period).abs() < 1e-6 && (fold.value - value).abs() < 1e-12;
        assert!(folds.iter().any(found), "no fold at the period {period}");
    }
    assert!(folds.len() >= 10 && folds.iter().all(|fold| !fold.neutral), "{}", folds.len());
}

// FitzHugh and Nagumo's model with two time scales: the explosion of its canards is far shorter than the last digit of the current.
field!(Nagumo, ["v", "w"], ["i", "e"], |s, k, d| {
    d[0] = s[0] - s[0].powi(3) / 3.0 - s[1] + k[0];
    d[1] = k[1] * (s[0] + 0.61474 - s[1] * 0.64755);
});

/// The multiplier of a planar cycle is the exponential of the integral of the divergence, and one at a fold.
#[test]
fn folds_on_the_explosion_of_a_canard_have_their_multiplier() {
    for e in [0.02, 0.030413, 0.05] {
        let equilibria = Equilibria::of(&Nagumo).parameters(&[-1.0, e]).start(&[-1.6, -1.0]);
        let branch = equilibria.along("i", -1.0..=1.3).run().unwrap();
        let hopf = branch.hopf_points().next().expect("a Hopf point");
        let cycles = Cycles::of(&Nagumo, CycleStart::from(hopf)).parameters(&hopf.parameters);
        let branch = cycles.along("i", -1.0..=1.3).run().unwrap();
        let folds: Vec<_> = branch.of_kind(SpecialKind::FoldOfCycles).collect();
        assert!(!folds.is_empty(), "{e}");
        for fold in folds {
            let integral = fold.period * fold.orbit.mean(|state| 1.0 - state[0] * state[0] - e * 0.64755);
            assert!(integral.abs() < 1e-4, "{e}: period {}, {integral:e}", fold.period);
        }
    }
}

/// What lies beside a branch: growth rates that are polynomials of the parameter with known zeros.
#[derive(Clone, Debug)]
struct Beside {
    /// Zeros of the growth rate of each direction.
    zeros: Vec<Vec<f64>>,
    /// Factors of the growth rates.
    factors: Vec<f64>,
}

impl Beside {
    fn growth<T: Scalar>(&self, index: usize, parameter: T) -> T {
        let zeros = self.zeros[index].iter();
        zeros.fold(T::from(self.factors[index]), |product, zero| product * (parameter - *zero))
    }

    /// All zeros with the kinds of their directions, in order.
    fn expected(&self, kinds: &[SpecialKind]) -> Vec<(SpecialKind, f64)> {
        let mut all: Vec<(SpecialKind, f64)> = self
            .zeros
            .iter()
            .zip(kinds)
            .flat_map(|(zeros, kind)| zeros.iter().map(|zero| (*kind, *zero)))
            .collect();
        all.sort_by(|one, other| one.1.total_cmp(&other.1));
        all
    }
}

/// Zeros anywhere between -1 and 1, in pairs down to 1e-4 of the interval apart, no two closer than that.
fn beside(directions: usize) -> impl Strategy<Value = Beside> {
    let zeros = prop::collection::vec((-0.97..0.97_f64, prop::bool::ANY, -4.0..-0.5_f64), directions);
    let factors = prop::collection::vec(prop_oneof![0.3..3.0_f64, -3.0..-0.3_f64], directions);
    (zeros, factors)
        .prop_map(|(zeros, factors)| Beside {
            zeros: zeros
                .into_iter()
                .map(
                    |(place, pair, gap)| {
                        if pair { vec![place, place + 2.0 * 10f64.powf(gap)] } else { vec![place] }
                    },
                )
                .map(|zeros| zeros.into_iter().filter(|zero| zero.abs() < 0.98).collect())
                .collect(),
            factors,
        })
        .prop_filter("zeros that coincide", |beside| {
            let all = beside.expected(&[SpecialKind::Hopf; 8]);
            all.windows(2).all(|pair| pair[1].1 - pair[0].1 > 1.9e-4)
        })
}

/// Oscillators and pitchforks that do not know each other.
struct Oscillators(Beside);

const OSCILLATORS: [SpecialKind; 4] =
    [SpecialKind::Hopf, SpecialKind::Hopf, SpecialKind::BranchPoint, SpecialKind::BranchPoint];

impl VectorField for Oscillators {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "p", "q", "u", "w"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["m".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], k: &[T], d: &mut [T]) {
        for (index, frequency) in [1.0, 3.7].into_iter().enumerate() {
            let (x, y) = (s[2 * index], s[2 * index + 1]);
            let growth = self.0.growth(index, k[0]) - (x * x + y * y);
            d[2 * index] = growth * x - y * frequency;
            d[2 * index + 1] = growth * y + x * frequency;
        }
        for index in 2..4 {
            let u = s[2 + index];
            d[2 + index] = (self.0.growth(index, k[0]) - u * u) * u;
        }
    }
}

/// The unit circle with a direction that comes back reversed, a pair that turns and one that comes back as it is.
struct Circle(Beside);

const CIRCLE: [SpecialKind; 3] =
    [SpecialKind::PeriodDoubling, SpecialKind::Torus, SpecialKind::BranchPointOfCycles];

impl VectorField for Circle {
    fn state_names(&self) -> Vec<String> {
        ["x", "y", "p", "q", "a", "b", "c"].map(String::from).to_vec()
    }
    fn parameter_names(&self) -> Vec<String> {
        vec!["m".into()]
    }
    fn evaluate<T: Scalar>(&self, s: &[T], k: &[T], d: &mut [T]) {
        let (x, y, p, q) = (s[0], s[1], s[2], s[3]);
        let square = -(x * x + y * y) + 1.0;
        d[0] = square * x - y;
        d[1] = square * y + x;
        let m = self.0.growth(0, k[0]);
        d[2] = (m - 1.0) * p * 0.5 + (m + 1.0) * (x * p + y * q) * 0.5 - q * 0.5 - p * (p * p + q * q);
        d[3] = (m - 1.0) * q * 0.5 + (m + 1.0) * (y * p - x * q) * 0.5 + p * 0.5 - q * (p * p + q * q);
        let growth = self.0.growth(1, k[0]) - (s[4] * s[4] + s[5] * s[5]);
        d[4] = growth * s[4] - s[5] * 0.3;
        d[5] = growth * s[5] + s[4] * 0.3;
        d[6] = (self.0.growth(2, k[0]) - s[6] * s[6]) * s[6];
    }
}

/// Whether what was found is what was expected, each once.
fn same(found: &[(SpecialKind, f64)], expected: &[(SpecialKind, f64)], tolerance: f64) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|((kind, value), (wanted, place))| kind == wanted && (value - place).abs() < tolerance)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(200)))]

    #[test]
    fn equilibria_lose_invent_and_double_no_special_point(beside in beside(4), start in -1.0..1.0_f64) {
        let field = Oscillators(beside);
        let branch = Equilibria::of(&field).parameters(&[start]).along("m", -1.0..=1.0).run().unwrap();
        let found: Vec<_> = branch
            .special()
            .map(|(kind, point)| (kind, point.value))
            .filter(|(kind, _)| *kind != SpecialKind::NeutralSaddle)
            .collect();
        let expected = field.0.expected(&OSCILLATORS);
        prop_assert!(same(&found, &expected, 1e-9), "{found:?}, expected {expected:?}; {:?}", branch.unlocated);
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(20)))]

    #[test]
    fn cycles_lose_invent_and_double_no_special_point(beside in beside(3)) {
        let field = Circle(beside);
        let branch = Cycles::of(&field, CycleStart::Orbit(circle(7)))
            .parameters(&[-1.0])
            .along("m", -1.0..=1.0)
            .run()
            .unwrap();
        let (found, expected) = (found(&branch), field.0.expected(&CIRCLE));
        prop_assert!(same(&found, &expected, 1e-8), "{found:?}, expected {expected:?}; {:?}", branch.unlocated);
        prop_assert!(branch.unlocated.is_empty(), "{:?}", branch.unlocated);
    }
}

#[test]
fn two_doublings_in_one_step_are_both_found() {
    // A step ends so close behind the first that Newton's method led back to it from there.
    let zeros = vec![vec![0.33940972329766694, 0.38517186374404966], vec![0.0], vec![0.20232405099982625]];
    let field = Circle(Beside { zeros, factors: vec![0.3; 3] });
    let branch = Cycles::of(&field, CycleStart::Orbit(circle(7)))
        .parameters(&[-1.0])
        .along("m", -1.0..=1.0)
        .run()
        .unwrap();
    let (found, expected) = (found(&branch), field.0.expected(&CIRCLE));
    assert!(same(&found, &expected, 1e-8), "{found:?}, expected {expected:?}");
}

/// Cases of a property test; `EVENT_CASES` asks for so many times as many.
fn cases(count: u32) -> u32 {
    let times = std::env::var("EVENT_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    count * times
}

// Two oscillators: the fast one is unstable for 0.060 < v < 0.068, the slow one below 0.19.
field!(HopfPair, ["x", "y", "p", "q"], ["v"], |s, k, d| {
    let (fast, slow) = ((k[0] - 0.06) * (-k[0] + 0.068) * 100.0, -k[0] + 0.19);
    d[0] = fast * s[0] - s[1] * 16.0;
    d[1] = s[0] * 16.0 + fast * s[1];
    d[2] = slow * s[2] - s[3] * 4.0;
    d[3] = s[2] * 4.0 + slow * s[3];
});

#[test]
fn what_is_found_does_not_depend_on_the_range() {
    for end in [0.3, 1.0, 10.0, 100.0] {
        let branch = Equilibria::of(&HopfPair).parameters(&[0.25]).along("v", 0.05..=end).run().unwrap();
        let found: Vec<_> = branch.special().map(|(kind, point)| (kind, point.value)).collect();
        let expected = [0.06, 0.068, 0.19].map(|place| (SpecialKind::Hopf, place));
        assert!(same(&found, &expected, 1e-10), "up to {end}: {found:?}");
    }
}
