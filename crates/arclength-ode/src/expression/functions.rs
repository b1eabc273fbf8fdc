//! The functions and operators of the language.

/// Operations of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum UnaryOperation {
    Negate,
    Reciprocal,
    SquareRoot,
    Exponential,
    Logarithm,
    DecimalLogarithm,
    BinaryLogarithm,
    Sine,
    Cosine,
    Tangent,
    InverseSine,
    InverseCosine,
    InverseTangent,
    HyperbolicSine,
    HyperbolicCosine,
    HyperbolicTangent,
    AbsoluteValue,
    Heaviside,
    Sign,
    Floor,
    Ceiling,
    Not,
    /// `(exp(x) - 1)/x`
    RelativeExponential,
    ErrorFunction,
    ComplementaryErrorFunction,
    /// Bessel function of the first kind, of the given order.
    BesselJ(i32),
    /// Bessel function of the second kind, of the given order.
    BesselY(i32),
}

/// Operations of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum BinaryOperation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    InverseTangent2,
    /// The root of the first, a sum of squares. A sum of its terms, the second, tells where it varies.
    Norm,
    Maximum,
    Minimum,
    Modulo,
    And,
    Or,
    Greater,
    Less,
    Equal,
    GreaterOrEqual,
    LessOrEqual,
    NotEqual,
}

impl BinaryOperation {
    pub(crate) fn is_comparison(self) -> bool {
        use BinaryOperation::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, NotEqual};
        matches!(self, Equal | Greater | GreaterOrEqual | Less | LessOrEqual | NotEqual)
    }

    pub(crate) fn is_arithmetic(self) -> bool {
        use BinaryOperation::{Add, Divide, Multiply, Power, Subtract};
        matches!(self, Add | Subtract | Multiply | Divide | Power)
    }
}

/// What a built-in name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Builtin {
    Unary(UnaryOperation),
    Binary(BinaryOperation),
    /// `besselj(n,x)`
    BesselJ,
    /// `bessely(n,x)`
    BesselY,
    /// Known to XPPAUT but not here: what it is, and what to do.
    Unsupported(&'static str, &'static str),
}

/// Names that a model cannot give to its own quantities, besides the built-in functions.
const KEYWORDS: [&str; 9] = ["t", "pi", "if", "then", "else", "sum", "of", "shift", "int"];

/// Whether XPPAUT reserves the name (in lower case).
pub(crate) fn reserved(name: &str) -> bool {
    KEYWORDS.contains(&name) || lookup_builtin(name).is_some()
}

/// The built-in function of that name (in lower case).
pub(crate) fn lookup_builtin(name: &str) -> Option<Builtin> {
    use BinaryOperation as B;
    use Builtin::{Binary, Unary, Unsupported};
    use UnaryOperation as U;
    Some(match name {
        "sin" => Unary(U::Sine),
        "cos" => Unary(U::Cosine),
        "tan" => Unary(U::Tangent),
        "asin" => Unary(U::InverseSine),
        "acos" => Unary(U::InverseCosine),
        "atan" => Unary(U::InverseTangent),
        "sinh" => Unary(U::HyperbolicSine),
        "cosh" => Unary(U::HyperbolicCosine),
        "tanh" => Unary(U::HyperbolicTangent),
        "abs" => Unary(U::AbsoluteValue),
        "exp" => Unary(U::Exponential),
        "ln" | "log" => Unary(U::Logarithm),
        "log10" => Unary(U::DecimalLogarithm),
        "log2" => Unary(U::BinaryLogarithm),
        "sqrt" => Unary(U::SquareRoot),
        "heav" => Unary(U::Heaviside),
        "sign" => Unary(U::Sign),
        "flr" => Unary(U::Floor),
        "ceil" => Unary(U::Ceiling),
        "not" => Unary(U::Not),
        "erf" => Unary(U::ErrorFunction),
        "erfc" => Unary(U::ComplementaryErrorFunction),
        "atan2" => Binary(B::InverseTangent2),
        "max" => Binary(B::Maximum),
        "min" => Binary(B::Minimum),
        "mod" => Binary(B::Modulo),
        "besselj" => Builtin::BesselJ,
        "bessely" => Builtin::BesselY,
        "besseli" => Unsupported("the modified Bessel function besseli is", "approximate it by a formula"),
        "lgamma" => Unsupported("the function lgamma is", "approximate it by a formula"),
        "ran" | "normal" | "poisson" => {
            Unsupported("random numbers are", "replace the random number by a parameter")
        }
        "delay" | "del_shft" => Unsupported(
            "delays are",
            "approximate the delay by a chain of differential equations (the linear chain trick)",
        ),
        "ishift" | "set" | "hom_bcs" => Unsupported("this function is", "only XPPAUT itself can evaluate it"),
        _ => return None,
    })
}

/// Names of all built-in functions, for suggestions.
pub(crate) const BUILTIN_NAMES: [&str; 26] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs", "exp", "ln", "log", "log10",
    "sqrt", "heav", "sign", "flr", "ceil", "not", "erf", "erfc", "atan2", "max", "min", "mod",
];
