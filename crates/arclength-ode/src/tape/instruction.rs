//! The instructions and what they do.

use super::registers::Registers;
use super::special::{
    bessel_j, bessel_y, complementary_error_function, error_function, norm, relative_exponential,
};
use crate::expression::{BinaryOperation, UnaryOperation};
use arclength::Scalar;

/// One step over registers with indices of type `R`. The last register named is the one that is written.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Instruction<R> {
    Time(R),
    Add(R, R, R),
    Subtract(R, R, R),
    Multiply(R, R, R),
    Divide(R, R, R),
    Negate(R, R),
    AddConstant(R, f64, R),
    MultiplyConstant(R, f64, R),
    DivideByConstant(R, f64, R),
    /// constant - operand
    SubtractFromConstant(R, f64, R),
    /// a b + c
    MultiplyAdd(R, R, R, R),
    /// a b - c
    MultiplySubtract(R, R, R, R),
    /// c - a b
    SubtractProduct(R, R, R, R),
    /// a b + c d
    SumOfProducts([R; 4], R),
    /// a b - c d
    DifferenceOfProducts([R; 4], R),
    /// (a b + c) + d e
    MultiplyAddAddProduct([R; 5], R),
    /// (a b + c) - d e
    MultiplyAddSubtractProduct([R; 5], R),
    /// (a b - c) - d e
    MultiplySubtractSubtractProduct([R; 5], R),
    /// (c - a b) - d e
    SubtractTwoProducts([R; 5], R),
    /// (a + b) + c d
    SumAddProduct([R; 4], R),
    /// (a + b) - c d
    SumSubtractProduct([R; 4], R),
    /// (a - b) + c d
    DifferenceAddProduct([R; 4], R),
    /// (a - b) - c d
    DifferenceSubtractProduct([R; 4], R),
    /// (a b + c d) + e f
    SumOfProductsAddProduct([R; 6], R),
    /// (a b + c d) - e f
    SumOfProductsSubtractProduct([R; 6], R),
    /// (a b - c d) + e f
    DifferenceOfProductsAddProduct([R; 6], R),
    /// (a b - c d) - e f
    DifferenceOfProductsSubtractProduct([R; 6], R),
    /// a b c
    MultiplyMultiply(R, R, R, R),
    /// (a + b) c
    AddMultiply(R, R, R, R),
    /// (a - b) c
    SubtractMultiply(R, R, R, R),
    /// a b / c
    MultiplyDivide(R, R, R, R),
    /// a constant + b
    ScaleAdd(R, R, f64, R),
    /// a constant - b
    ScaleSubtract(R, R, f64, R),
    /// b - a constant
    SubtractScaled(R, R, f64, R),
    /// (a + constant) b
    AddConstantMultiply(R, R, f64, R),
    /// (constant - a) b
    SubtractFromConstantMultiply(R, R, f64, R),
    Reciprocal(R, R),
    Exponential(R, R),
    /// Sine and cosine of the first, in this order.
    SineCosine(R, R, R),
    Unary(UnaryOperation, R, R),
    Binary(BinaryOperation, R, R, R),
    WholePower(R, i32, R),
    /// The second if the first is not zero, else the third.
    Select(R, R, R, R),
}

const _: () = assert!(size_of::<Instruction<u16>>() == 16);

impl<R: Copy> Instruction<R> {
    /// The registers read and those written.
    pub(super) fn registers(&self) -> (Vec<R>, Vec<R>) {
        use Instruction as I;
        match *self {
            I::Time(to) => (vec![], vec![to]),
            I::Negate(a, to)
            | I::AddConstant(a, _, to)
            | I::MultiplyConstant(a, _, to)
            | I::DivideByConstant(a, _, to)
            | I::SubtractFromConstant(a, _, to)
            | I::Reciprocal(a, to)
            | I::Exponential(a, to)
            | I::Unary(_, a, to)
            | I::WholePower(a, _, to) => (vec![a], vec![to]),
            I::Add(a, b, to)
            | I::Subtract(a, b, to)
            | I::Multiply(a, b, to)
            | I::Divide(a, b, to)
            | I::ScaleAdd(a, b, _, to)
            | I::ScaleSubtract(a, b, _, to)
            | I::SubtractScaled(a, b, _, to)
            | I::AddConstantMultiply(a, b, _, to)
            | I::SubtractFromConstantMultiply(a, b, _, to)
            | I::Binary(_, a, b, to) => (vec![a, b], vec![to]),
            I::MultiplyAdd(a, b, c, to)
            | I::MultiplySubtract(a, b, c, to)
            | I::SubtractProduct(a, b, c, to)
            | I::MultiplyMultiply(a, b, c, to)
            | I::AddMultiply(a, b, c, to)
            | I::SubtractMultiply(a, b, c, to)
            | I::MultiplyDivide(a, b, c, to)
            | I::Select(a, b, c, to) => (vec![a, b, c], vec![to]),
            I::SumOfProducts(operands, to)
            | I::DifferenceOfProducts(operands, to)
            | I::SumAddProduct(operands, to)
            | I::SumSubtractProduct(operands, to)
            | I::DifferenceAddProduct(operands, to)
            | I::DifferenceSubtractProduct(operands, to) => (operands.to_vec(), vec![to]),
            I::SumOfProductsAddProduct(operands, to)
            | I::SumOfProductsSubtractProduct(operands, to)
            | I::DifferenceOfProductsAddProduct(operands, to)
            | I::DifferenceOfProductsSubtractProduct(operands, to) => (operands.to_vec(), vec![to]),
            I::MultiplyAddAddProduct(operands, to)
            | I::MultiplyAddSubtractProduct(operands, to)
            | I::MultiplySubtractSubtractProduct(operands, to)
            | I::SubtractTwoProducts(operands, to) => (operands.to_vec(), vec![to]),
            I::SineCosine(a, sine, cosine) => (vec![a], vec![sine, cosine]),
        }
    }
}

#[inline(always)]
pub(super) fn execute<T: Scalar, R: Copy>(
    instruction: &Instruction<R>,
    time: T,
    registers: &mut impl Registers<T, R>,
) {
    use Instruction as I;
    let r = registers;
    match *instruction {
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
        I::SumOfProducts([a, b, c, d], to) => r.write(to, r.read(a) * r.read(b) + r.read(c) * r.read(d)),
        I::DifferenceOfProducts([a, b, c, d], to) => {
            r.write(to, r.read(a) * r.read(b) - r.read(c) * r.read(d));
        }
        I::MultiplyAddAddProduct([a, b, c, d, e], to) => {
            r.write(to, r.read(a) * r.read(b) + r.read(c) + r.read(d) * r.read(e));
        }
        I::MultiplyAddSubtractProduct([a, b, c, d, e], to) => {
            r.write(to, r.read(a) * r.read(b) + r.read(c) - r.read(d) * r.read(e));
        }
        I::MultiplySubtractSubtractProduct([a, b, c, d, e], to) => {
            r.write(to, r.read(a) * r.read(b) - r.read(c) - r.read(d) * r.read(e));
        }
        I::SubtractTwoProducts([a, b, c, d, e], to) => {
            r.write(to, r.read(c) - r.read(a) * r.read(b) - r.read(d) * r.read(e));
        }
        I::SumAddProduct([a, b, c, d], to) => {
            r.write(to, r.read(a) + r.read(b) + r.read(c) * r.read(d));
        }
        I::SumSubtractProduct([a, b, c, d], to) => {
            r.write(to, r.read(a) + r.read(b) - r.read(c) * r.read(d));
        }
        I::DifferenceAddProduct([a, b, c, d], to) => {
            r.write(to, r.read(a) - r.read(b) + r.read(c) * r.read(d));
        }
        I::DifferenceSubtractProduct([a, b, c, d], to) => {
            r.write(to, r.read(a) - r.read(b) - r.read(c) * r.read(d));
        }
        I::SumOfProductsAddProduct([a, b, c, d, e, f], to) => {
            r.write(to, r.read(a) * r.read(b) + r.read(c) * r.read(d) + r.read(e) * r.read(f));
        }
        I::SumOfProductsSubtractProduct([a, b, c, d, e, f], to) => {
            r.write(to, r.read(a) * r.read(b) + r.read(c) * r.read(d) - r.read(e) * r.read(f));
        }
        I::DifferenceOfProductsAddProduct([a, b, c, d, e, f], to) => {
            r.write(to, r.read(a) * r.read(b) - r.read(c) * r.read(d) + r.read(e) * r.read(f));
        }
        I::DifferenceOfProductsSubtractProduct([a, b, c, d, e, f], to) => {
            r.write(to, r.read(a) * r.read(b) - r.read(c) * r.read(d) - r.read(e) * r.read(f));
        }
        I::MultiplyMultiply(a, b, c, to) => r.write(to, r.read(a) * r.read(b) * r.read(c)),
        I::AddMultiply(a, b, c, to) => r.write(to, (r.read(a) + r.read(b)) * r.read(c)),
        I::SubtractMultiply(a, b, c, to) => r.write(to, (r.read(a) - r.read(b)) * r.read(c)),
        I::MultiplyDivide(a, b, c, to) => r.write(to, r.read(a) * r.read(b) / r.read(c)),
        I::ScaleAdd(a, b, constant, to) => r.write(to, r.read(a) * constant + r.read(b)),
        I::ScaleSubtract(a, b, constant, to) => r.write(to, r.read(a) * constant - r.read(b)),
        I::SubtractScaled(a, b, constant, to) => r.write(to, r.read(b) - r.read(a) * constant),
        I::AddConstantMultiply(a, b, constant, to) => r.write(to, (r.read(a) + constant) * r.read(b)),
        I::SubtractFromConstantMultiply(a, b, constant, to) => {
            r.write(to, (-r.read(a) + constant) * r.read(b));
        }
        I::Reciprocal(a, to) => r.write(to, r.read(a).recip()),
        I::Exponential(a, to) => r.write(to, r.read(a).exp()),
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
        U::RelativeExponential => relative_exponential(x),
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
        B::Norm => norm(a, b),
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
