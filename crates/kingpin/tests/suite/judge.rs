//! An independent judge of uniform motions: equations and derivatives by hand, Routh-Hurwitz conditions in double-double numbers.

use kingpin::{Key, UniformMotion};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A condition smaller than this part of the sum of the moduli of its terms decides nothing, although numbers have 31 digits.
const DECIDED: f64 = 1e-25;
/// Newton's method doubles the digits of a motion that is right to a few.
const NEWTON_STEPS: usize = 6;

/// A number as the unevaluated sum of two (Dekker 1971), with the sum of the moduli of the terms that it was made of.
#[derive(Clone, Copy, Debug)]
struct Double {
    high: f64,
    low: f64,
    size: f64,
}

impl Double {
    fn new(high: f64, low: f64, size: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high), size }
    }
    fn of(value: f64) -> Self {
        Self { high: value, low: 0.0, size: value.abs() }
    }
    /// As it is, whatever it was made of.
    fn fresh(self) -> Self {
        Self { size: self.high.abs(), ..self }
    }
    fn sign(self) -> Option<f64> {
        (self.high.abs() > DECIDED * self.size).then(|| self.high.signum())
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = self.high + other.high;
        let part = sum - self.high;
        let error = (self.high - (sum - part)) + (other.high - part);
        Self::new(sum, error + self.low + other.low, self.size + other.size)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low, size: self.size }
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        Self::new(product, error + (self.high * other.low + self.low * other.high), self.size * other.size)
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Self::of(self.high / other.high);
        let rest = self - first * other;
        let second = Self::of(rest.high / other.high);
        let rest = rest - second * other;
        let quotient = first + second + Self::of(rest.high / other.high);
        Self { size: self.size / other.high.abs() * (other.size / other.high.abs()), ..quotient }
    }
}

/// Sine and cosine of an angle below a few radians: the series of a 64th of it, doubled six times.
fn sine_cosine(angle: Double) -> [Double; 2] {
    let small = angle / Double::of(64.0);
    let square = small * small;
    let (mut sine, mut versine, mut term) = (Double::of(0.0), Double::of(0.0), small);
    for order in 1..=14 {
        // term = small^(2 order - 1)/(2 order - 1)!
        let even = term * small / Double::of(f64::from(2 * order));
        if order % 2 == 1 {
            (sine, versine) = (sine + term, versine + even);
        } else {
            (sine, versine) = (sine - term, versine - even);
        }
        term = term * square / Double::of(f64::from(2 * order * (2 * order + 1)));
    }
    for _ in 0..6 {
        // With 1 - cos nothing cancels.
        let cosine = Double::of(1.0) - versine;
        (sine, versine) = (Double::of(2.0) * sine * cosine, Double::of(2.0) * sine * sine);
    }
    [sine.fresh(), (Double::of(1.0) - versine).fresh()]
}

/// What the judge says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judgement {
    /// Whether the motion is stable, that of the lateral motion in rectilinear towing without longitudinal damping; `None` where even
    /// the judge cannot tell.
    pub stable: Option<bool>,
    /// Largest distance of a state from the solution, relative to its natural size.
    pub state_error: f64,
}

type Vector = [Double; 5];

/// The field and its derivatives at a state, over `u q psi V Omega`.
fn linearise(parameter: impl Fn(Key) -> Double, state: &Vector) -> (Vector, [Vector; 5]) {
    let [zero, two] = [0.0, 2.0].map(Double::of);
    let [u, q, psi, speed, yaw] = *state;
    let [l, v, k_u, k_q] = [Key::L, Key::V, Key::KU, Key::KQ].map(&parameter);
    let [c_u, c_q, c_psi, k_psi] = [Key::CU, Key::CQ, Key::CPsi, Key::KPsi].map(&parameter);
    let radius = parameter(Key::TurningRadius);
    let omega = if radius.high.is_infinite() { zero } else { v / radius };
    let arm = l - parameter(Key::LC);
    let wheel_radius = parameter(Key::WheelRadius);
    let m = parameter(Key::MC) * arm;
    let mass = parameter(Key::MW) + parameter(Key::MC) + parameter(Key::JWxi) / (wheel_radius * wheel_radius);
    let inertia = parameter(Key::JCz) + parameter(Key::JWzeta) + m * arm;
    let [sine, cosine] = sine_cosine(psi);
    let side = l * yaw;
    let u_rate = speed * cosine + side * sine - v + omega * q;
    let q_rate = side * cosine - speed * sine - omega * u;
    let force_x = -(k_u * u) - c_u * u_rate;
    let force_y = -(k_q * q) - c_q * q_rate;
    let along = force_x * cosine - force_y * sine;
    let across = force_x * sine + force_y * cosine;
    let field = [
        u_rate,
        q_rate,
        omega - yaw,
        (m * yaw * yaw + along) / mass,
        (l * across - m * speed * yaw - c_psi * (yaw - omega) + k_psi * psi) / inertia,
    ];
    let of_u = [zero, omega, side * cosine - speed * sine, cosine, l * sine];
    let of_q = [-omega, zero, -(side * sine) - speed * cosine, -sine, l * cosine];
    let unit = |index: usize, value: Double| -> Vector {
        std::array::from_fn(|other| if other == index { value } else { zero })
    };
    let plus =
        |one: Vector, other: Vector| -> Vector { std::array::from_fn(|index| one[index] + other[index]) };
    let times = |factor: Double, vector: Vector| -> Vector { vector.map(|entry| factor * entry) };
    let of_force_x = plus(unit(0, -k_u), times(-c_u, of_u));
    let of_force_y = plus(unit(1, -k_q), times(-c_q, of_q));
    let of_along = plus(plus(times(cosine, of_force_x), times(-sine, of_force_y)), unit(2, -across));
    let of_across = plus(plus(times(sine, of_force_x), times(cosine, of_force_y)), unit(2, along));
    let of_speed = plus(unit(4, two * m * yaw), of_along);
    let gyroscopic = plus(unit(3, -(m * yaw)), unit(4, -(m * speed) - c_psi));
    let of_yaw = plus(plus(gyroscopic, unit(2, k_psi)), times(l, of_across));
    let over = |vector: Vector, divisor: Double| vector.map(|entry| entry / divisor);
    (field, [of_u, of_q, unit(4, Double::of(-1.0)), over(of_speed, mass), over(of_yaw, inertia)])
}

/// Judges a motion; `None` for lateral elasticity only, and where Newton's method does not settle.
pub(crate) fn of(motion: &UniformMotion) -> Option<Judgement> {
    let wheel = motion.wheel();
    if wheel.has_lateral_elasticity_only() {
        return None;
    }
    let parameter = |key: Key| Double::of(wheel.get(key));
    let mut state = motion.state().map(Double::of);
    for _ in 0..NEWTON_STEPS {
        let (field, jacobian) = linearise(parameter, &state);
        let step = solve(jacobian, field)?;
        state = std::array::from_fn(|index| (state[index] - step[index]).fresh());
    }
    let (_, jacobian) = linearise(parameter, &state);
    let jacobian =
        jacobian.map(|row| row.map(|entry| Double { size: entry.size.max(entry.high.abs()), ..entry }));
    let (v, l) = (wheel.get(Key::V), wheel.get(Key::L));
    let sizes = [l, l, 1.0, v, v / l];
    let distances = (0..5).map(|index| {
        let distance = (state[index] - Double::of(motion.state()[index])).high.abs();
        distance / (sizes[index] + state[index].high.abs())
    });
    let straight = wheel.get(Key::TurningRadius).is_infinite();
    let stable = if straight {
        // The quadratic of the longitudinal motion is stable where it is damped, and does not count where it is not.
        let lateral = [1, 2, 4];
        is_stable(&lateral.map(|row| lateral.map(|column| jacobian[row][column])))
    } else {
        is_stable(&jacobian)
    };
    Some(Judgement { stable, state_error: distances.fold(0.0, f64::max) })
}

/// By the Hurwitz conditions: all coefficients and determinants positive.
fn is_stable<const N: usize>(matrix: &[[Double; N]; N]) -> Option<bool> {
    let mut coefficients = [Double::of(0.0); N];
    for subset in 1_usize..1 << N {
        let members: Vec<usize> = (0..N).filter(|index| subset >> index & 1 == 1).collect();
        let minor = determinant(matrix, &members, &members);
        let sum = &mut coefficients[members.len() - 1];
        *sum = if members.len() % 2 == 1 { *sum - minor } else { *sum + minor };
    }
    let c = |index: usize| {
        if index == 0 {
            Double::of(1.0)
        } else {
            coefficients.get(index - 1).copied().unwrap_or(Double::of(0.0))
        }
    };
    // All leading minors of the Hurwitz matrix, with c(2 column - row + 1) in its places.
    let hurwitz: [[Double; N]; N] = std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let index = 2 * (column + 1);
            if index < row + 1 || index - row - 1 > N { Double::of(0.0) } else { c(index - row - 1) }
        })
    });
    let leading: Vec<Option<f64>> = (1..=N)
        .map(|order| {
            let places: Vec<usize> = (0..order).collect();
            determinant(&hurwitz, &places, &places).sign()
        })
        .collect();
    let signs = leading.into_iter().chain(coefficients.map(Double::sign));
    let signs: Vec<Option<f64>> = signs.collect();
    if signs.contains(&Some(-1.0)) {
        return Some(false);
    }
    signs.iter().all(|sign| *sign == Some(1.0)).then_some(true)
}

/// The determinant of some rows and columns by Laplace's expansion.
fn determinant<const N: usize>(matrix: &[[Double; N]; N], rows: &[usize], columns: &[usize]) -> Double {
    let Some((&row, rows)) = rows.split_first() else { return Double::of(1.0) };
    let mut sum = Double::of(0.0);
    for (place, &column) in columns.iter().enumerate() {
        let entry = matrix[row][column];
        if entry.high == 0.0 && entry.low == 0.0 && entry.size == 0.0 {
            continue;
        }
        let rest: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        let term = entry * determinant(matrix, rows, &rest);
        sum = if place % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

/// Gaussian elimination with scaled rows and partial pivoting; `None` where singular.
fn solve(mut matrix: [Vector; 5], mut right: Vector) -> Option<Vector> {
    for row in 0..5 {
        let size = matrix[row].iter().fold(0.0_f64, |size, entry| size.max(entry.high.abs()));
        matrix[row] = matrix[row].map(|entry| entry / Double::of(size));
        right[row] = right[row] / Double::of(size);
    }
    for column in 0..5 {
        let pivot = (column..5)
            .max_by(|&a, &b| matrix[a][column].high.abs().total_cmp(&matrix[b][column].high.abs()))?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let above = matrix[column];
        if above[column].high == 0.0 || !above[column].high.is_finite() {
            return None;
        }
        for row in column + 1..5 {
            let factor = matrix[row][column] / above[column];
            for (entry, above) in matrix[row].iter_mut().zip(above) {
                *entry = (*entry - factor * above).fresh();
            }
            right[row] = (right[row] - factor * right[column]).fresh();
        }
    }
    for row in (0..5).rev() {
        let mut rest = right[row];
        for column in row + 1..5 {
            rest = (rest - matrix[row][column] * right[column]).fresh();
        }
        right[row] = rest / matrix[row][row];
    }
    Some(right.map(Double::fresh))
}
