//! The instructions and what they do.

use super::special::{bessel_j, bessel_y, complementary_error_function, error_function};
use crate::expression::{BinaryOperation, UnaryOperation};
use arclength::Scalar;

/// Index of a register.
pub(crate) type Register = u32;

/// One step. The last register named is the one that is written.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Instruction {
    Constant(f64, Register),
    Time(Register),
    Add(Register, Register, Register),
    Subtract(Register, Register, Register),
    Multiply(Register, Register, Register),
    Divide(Register, Register, Register),
    Negate(Register, Register),
    AddConstant(Register, f64, Register),
    MultiplyConstant(Register, f64, Register),
    DivideByConstant(Register, f64, Register),
    /// constant - operand
    SubtractFromConstant(Register, f64, Register),
    /// a b + c
    MultiplyAdd(Register, Register, Register, Register),
    /// a b - c
    MultiplySubtract(Register, Register, Register, Register),
    /// c - a b
    SubtractProduct(Register, Register, Register, Register),
    /// Sine and cosine of the first, in this order.
    SineCosine(Register, Register, Register),
    Unary(UnaryOperation, Register, Register),
    Binary(BinaryOperation, Register, Register, Register),
    WholePower(Register, i32, Register),
    /// The second if the first is not zero, else the third.
    Select(Register, Register, Register, Register),
}

/// Registers of known or of any number.
pub(super) trait Registers<T> {
    fn read(&self, register: Register) -> T;
    fn write(&mut self, register: Register, value: T);
}

impl<T: Copy, const N: usize> Registers<T> for [T; N] {
    #[inline(always)]
    fn read(&self, register: Register) -> T {
        // N is a power of two above every register, so the mask changes nothing and proves the bound.
        self[register as usize & (N - 1)]
    }
    #[inline(always)]
    fn write(&mut self, register: Register, value: T) {
        self[register as usize & (N - 1)] = value;
    }
}

impl<T: Copy> Registers<T> for [T] {
    #[inline(always)]
    fn read(&self, register: Register) -> T {
        self[register as usize]
    }
    #[inline(always)]
    fn write(&mut self, register: Register, value: T) {
        self[register as usize] = value;
    }
}

#[inline(always)]
pub(super) fn execute<T: Scalar>(
    instruction: &Instruction,
    time: T,
    registers: &mut (impl Registers<T> + ?Sized),
) {
    use Instruction as I;
    let r = registers;
    match *instruction {
        I::Constant(value, to) => r.write(to, T::from(value)),
        I::Time(to) => r.write(to, time),
        I::Add(a, b, to) => r.write(to, r.read(a) + r.read(b)),
        I::Subtract(a, b, to) => r.write(to, r.read(a) - r.read(b)),
        I::Multiply(a, b, to) => r.write(to, r.read(a) * r.read(b)),
        I::Divide(a, b, to) => r.write(to, r.read(a) / r.read(b)),
        I::Negate(a, to) => r.write(to, -r.read(a)),
        I::AddConstant(a, constant, to) => r.write(to, r.read(a) + constant),
        I::MultiplyConstant(a, constant, to) => r.write(to, r.read(a) * constant),
        I::DivideByConstant(a, constant, to) => r.write(to, r.read(a) / constant),
        I::SubtractFromConstant(a, constant, to) => r.write(to, -r.read(a) + constant),
        I::MultiplyAdd(a, b, c, to) => r.write(to, r.read(a) * r.read(b) + r.read(c)),
        I::MultiplySubtract(a, b, c, to) => r.write(to, r.read(a) * r.read(b) - r.read(c)),
        I::SubtractProduct(a, b, c, to) => r.write(to, r.read(c) - r.read(a) * r.read(b)),
        I::SineCosine(a, sine, cosine) => {
            let (s, c) = r.read(a).sin_cos();
            r.write(sine, s);
            r.write(cosine, c);
        }
        I::Unary(operation, a, to) => r.write(to, apply_unary(operation, r.read(a))),
        I::Binary(operation, a, b, to) => r.write(to, apply_binary(operation, r.read(a), r.read(b))),
        I::WholePower(a, exponent, to) => r.write(to, r.read(a).powi(exponent)),
        I::Select(condition, yes, no, to) => {
            let taken = if r.read(condition).value() != 0.0 { yes } else { no };
            r.write(to, r.read(taken));
        }
    }
}

/// The value of an operation of one operand.
#[inline(never)]
pub(crate) fn apply_unary<T: Scalar>(operation: UnaryOperation, x: T) -> T {
    use UnaryOperation as U;
    match operation {
        U::Negate => -x,
        U::Reciprocal => x.recip(),
        U::SquareRoot => x.sqrt(),
        U::Exponential => x.exp(),
        U::Logarithm => x.ln(),
        U::DecimalLogarithm => x.ln() / std::f64::consts::LN_10,
        U::BinaryLogarithm => x.ln() / std::f64::consts::LN_2,
        U::Sine => x.sin(),
        U::Cosine => x.cos(),
        U::Tangent => x.tan(),
        U::InverseSine => x.asin(),
        U::InverseCosine => x.acos(),
        U::InverseTangent => x.atan(),
        U::HyperbolicSine => x.sinh(),
        U::HyperbolicCosine => x.cosh(),
        U::HyperbolicTangent => x.tanh(),
        U::AbsoluteValue => x.abs(),
        U::Heaviside => truth(x.value() >= 0.0),
        U::Sign => x.signum(),
        U::Floor => x.floor(),
        U::Ceiling => -((-x).floor()),
        U::Not => truth(x.value() == 0.0),
        U::ErrorFunction => error_function(x),
        U::ComplementaryErrorFunction => complementary_error_function(x),
        U::BesselJ(order) => bessel_j(order, x),
        U::BesselY(order) => bessel_y(order, x),
    }
}

/// The value of an operation of two operands.
#[inline(never)]
pub(crate) fn apply_binary<T: Scalar>(operation: BinaryOperation, a: T, b: T) -> T {
    use BinaryOperation as B;
    match operation {
        B::Add => a + b,
        B::Subtract => a - b,
        B::Multiply => a * b,
        B::Divide => a / b,
        B::Power => a.powf(b),
        B::InverseTangent2 => a.atan2(b),
        B::Maximum => a.max(b),
        B::Minimum => a.min(b),
        B::Modulo => modulo(a, b),
        B::And => truth(a.value() != 0.0 && b.value() != 0.0),
        B::Or => truth(a.value() != 0.0 || b.value() != 0.0),
        B::Greater => truth(a.value() > b.value()),
        B::Less => truth(a.value() < b.value()),
        B::Equal => truth(a.value() == b.value()),
        B::GreaterOrEqual => truth(a.value() >= b.value()),
        B::LessOrEqual => truth(a.value() <= b.value()),
        B::NotEqual => truth(a.value() != b.value()),
    }
}

fn truth<T: Scalar>(value: bool) -> T {
    T::from(if value { 1.0 } else { 0.0 })
}

/// `a - n b` for the whole number `n` that XPPAUT's `mod` takes: the remainder, made positive by
/// adding `b` once.
fn modulo<T: Scalar>(a: T, b: T) -> T {
    let (dividend, divisor) = (a.value(), b.value());
    let remainder = dividend % divisor;
    let remainder = if remainder < 0.0 { remainder + divisor } else { remainder };
    let quotient = ((dividend - remainder) / divisor).round();
    // The derivatives are those of a - n b; the value is the exact remainder.
    let smooth = a - b * quotient;
    smooth + (remainder - smooth.value())
}
