//! What the tape computes, against a direct evaluation of the same expression, for values and
//! derivatives.

use approx::assert_relative_eq;
use arclength::{Dual, Scalar, VectorField};
use arclength_ode::Model;
use proptest::prelude::*;

/// An expression in the names x, y (states) and a, b (parameters).
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Name(usize),
    Negate(Box<Tree>),
    Call(&'static str, Box<Tree>),
    Operator(&'static str, Box<Tree>, Box<Tree>),
    Power(Box<Tree>, i32),
    If(Box<Tree>, Box<Tree>, Box<Tree>),
}

impl Tree {
    fn text(&self) -> String {
        match self {
            Self::Number(value) => format!("{value}"),
            Self::Name(index) => ["x", "y", "a", "b"][*index].to_owned(),
            Self::Negate(inner) => format!("(-{})", inner.text()),
            Self::Call(function, inner) => format!("{function}({})", inner.text()),
            Self::Operator(operator, a, b) => format!("({}{operator}{})", a.text(), b.text()),
            Self::Power(base, exponent) => format!("({}^{exponent})", base.text()),
            Self::If(condition, yes, no) => {
                format!("if({}>0)then({})else({})", condition.text(), yes.text(), no.text())
            }
        }
    }

    /// `None` where rounding, or the sign of a zero, may decide: then the two need not agree.
    fn evaluate(&self, names: &[Gradient; 4]) -> Option<Gradient> {
        let value = match self {
            Self::Number(value) => Gradient::from(*value),
            Self::Name(index) => names[*index],
            Self::Negate(inner) => -inner.evaluate(names)?,
            Self::Call(function, inner) => {
                let x = inner.evaluate(names)?;
                match *function {
                    "sin" => x.sin(),
                    "cos" => x.cos(),
                    "exp" => x.exp(),
                    "tanh" => x.tanh(),
                    _ => x.atan(),
                }
            }
            Self::Operator(operator, a, b) => {
                let (a, b) = (a.evaluate(names)?, b.evaluate(names)?);
                match *operator {
                    "+" => a + b,
                    "-" => a - b,
                    "*" => a * b,
                    _ if b.value.abs() < UNDECIDED => return None,
                    _ => a / b,
                }
            }
            Self::Power(base, exponent) => base.evaluate(names)?.powi(*exponent),
            Self::If(condition, yes, no) => {
                let condition = condition.evaluate(names)?.value;
                if condition.abs() < UNDECIDED {
                    return None;
                }
                if condition > 0.0 { yes.evaluate(names)? } else { no.evaluate(names)? }
            }
        };
        tame(&value).then_some(value)
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        3 => (0..4_usize).prop_map(Tree::Name),
        1 => prop_oneof![Just(0.0), Just(1.0), Just(2.0), Just(0.5), 0.1..3.0].prop_map(Tree::Number),
    ];
    leaf.prop_recursive(6, 40, 3, |inner| {
        let function = prop_oneof![Just("sin"), Just("cos"), Just("exp"), Just("tanh"), Just("atan")];
        let operator = prop_oneof![Just("+"), Just("-"), Just("*"), Just("/")];
        prop_oneof![
            1 => inner.clone().prop_map(|a| Tree::Negate(a.into())),
            2 => (function, inner.clone()).prop_map(|(name, a)| Tree::Call(name, a.into())),
            6 => (operator, inner.clone(), inner.clone()).prop_map(|(o, a, b)| Tree::Operator(o, a.into(), b.into())),
            1 => (inner.clone(), -3..6_i32).prop_map(|(a, exponent)| Tree::Power(a.into(), exponent)),
            1 => (inner.clone(), inner.clone(), inner).prop_map(|(a, b, c)| Tree::If(a.into(), b.into(), c.into())),
        ]
    })
}

type Gradient = Dual<f64, 4>;

/// Divisors and conditions smaller than this may be nothing but rounding.
const UNDECIDED: f64 = 1e-6;

/// Whether the rounding of a result may be compared: all its numbers are finite and not large.
fn tame(number: &Gradient) -> bool {
    number.derivatives.iter().chain([&number.value]).all(|x| x.abs() < 1e4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn tape_agrees_with_the_tree(first in tree(), second in tree(), x in -2.0..2.0, y in -2.0..2.0,
                                 a in 0.1..2.0, b in -2.0..-0.1) {
        // Both equations share subexpressions, so that elimination and fusion have work to do.
        let source = format!(
            "par a=1,b=1\nq={}\nx'=q+{}\ny'=q*{}-sin(q)*cos(q)\n", first.text(), second.text(), second.text()
        );
        let model = Model::parse(&source).map_err(|error| TestCaseError::fail(error.snippet()))?;
        let names = [x, y, a, b];
        let names: [Gradient; 4] = std::array::from_fn(|index| Dual::variable(names[index], index));
        let trees = first.evaluate(&names).zip(second.evaluate(&names));
        let mut found = [Gradient::zero(); 2];
        model.evaluate(&names[..2], &names[2..], &mut found);
        let mut values = [0.0; 2];
        model.evaluate(&[x, y], &[a, b], &mut values);
        if let Some((q, s)) = trees {
            let expected = [q + s, q * s - q.sin() * q.cos()];
            for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
                // Rewriting powers as products moves the last digits, which sums may then cancel.
                let scale = 1.0 + q.value.abs() + s.value.abs() + (q.value * s.value).abs();
                prop_assert!((found.value - expected.value).abs() <= 1e-9 * scale, "{source}{found:?} {expected:?}");
                prop_assert!((values[index] - found.value).abs() <= 1e-12 * scale);
                for (f, e) in found.derivatives.iter().zip(&expected.derivatives) {
                    prop_assert!((f - e).abs() <= 1e-6 * (1.0 + e.abs()), "{source}{found:?} {expected:?}");
                }
            }
        }
    }
}

#[test]
fn jacobian_of_the_towed_wheel_has_the_closed_characteristic_polynomial() {
    let model = Model::parse(include_str!("../../../../gallery/models/towed_wheel.ode")).expect("reads");
    let mut parameters = model.default_parameters().to_vec();
    let speed = model.parameter_index("v").expect("declared");
    parameters[speed] = 8.0;
    let state = model.initial_state(&parameters);
    let seeded: Vec<Dual<f64, 5>> =
        state.iter().enumerate().map(|(index, &x)| Dual::variable(x, index)).collect();
    let constants: Vec<Dual<f64, 5>> = parameters.iter().map(|&p| Dual::constant(p)).collect();
    let mut derivative = [Dual::<f64, 5>::zero(); 5];
    model.evaluate(&seeded, &constants, &mut derivative);
    assert!(derivative.iter().all(|f| f.value.abs() < 1e-10), "the initial state is the uniform motion");

    // Coefficients of the characteristic polynomial of the uniform motion in closed form, from the
    // linearised equations; by Newton's identities from the traces of the powers of the Jacobian.
    let jacobian = derivative.map(|f| f.derivatives);
    let multiply = |a: &[[f64; 5]; 5], b: &[[f64; 5]; 5]| -> [[f64; 5]; 5] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..5).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let mut power = jacobian;
    let mut traces = [0.0; 5];
    for trace in &mut traces {
        *trace = (0..5).map(|i| power[i][i]).sum();
        power = multiply(&power, &jacobian);
    }
    let mut coefficients = [1.0; 6];
    for k in 1..=5 {
        let sum: f64 = (1..=k).map(|i| coefficients[k - i] * traces[i - 1]).sum();
        coefficients[k] = -sum / k as f64;
    }
    let value = |name: &str| parameters[model.parameter_index(name).expect("declared")];
    let (l, k, w) = (value("l"), value("k"), value("v") / value("r"));
    let d = l - value("l_c");
    let m = value("m_c") * d;
    let mass = value("m_w") + value("m_c") + value("J_wxi") / value("R_w").powi(2);
    let inertia = value("J_Cz") + value("J_wzeta") + value("m_c") * d * d;
    let v0 = state[3];
    let (w2, l2) = (w * w, l * l);
    let expected = [
        v0 * m / inertia,
        (inertia * mass * w2 + inertia * k + mass * k * l2 - mass * l * m * w2 + 2.0 * m * m * w2)
            / (inertia * mass),
        v0 * (mass * l + m) * (k * l + m * w2) / (inertia * mass * l),
        (k * l - m * w2) * (mass * l * w2 + k * l - 2.0 * m * w2) / (inertia * mass),
        v0 * (k * l - m * w2).powi(2) / (inertia * mass * l),
    ];
    for (found, expected) in coefficients[1..].iter().zip(expected) {
        assert_relative_eq!(*found, expected, max_relative = 1e-9);
    }
}

#[test]
fn a_field_of_lorenz_to_the_last_bit() {
    let model = Model::parse(include_str!("../../../../gallery/models/lorenz.ode")).expect("reads");
    let (x, y, z, rho, sigma) = (1.3, -2.7, 21.9, 28.0, 10.0);
    let mut derivative = [0.0; 3];
    model.evaluate(&[x, y, z], &[rho, sigma], &mut derivative);
    assert_eq!(derivative, [sigma * (y - x), rho * x - y - x * z, x * y - 8.0 / 3.0 * z]);
}

#[test]
fn common_subexpressions_and_dead_code_cost_nothing() {
    let count =
        |source: &str| Model::parse(source).map(|model| model.instruction_count()).unwrap_or(usize::MAX);
    let once = count("x'=exp(x*y)\ny'=exp(x*y)\n");
    assert_eq!(once, count("x'=exp(x*y)\ny'=exp(y*x)\n"));
    assert_eq!(once, count("unused=sin(x)^3\nx'=exp(x*y)+0\ny'=1*exp(x*y)\naux k=cosh(x)\n"));
    assert_eq!(count("x'=sin(x)\ny'=cos(x)\n"), 1);
    assert_eq!(count("number k=2\nx'=if(k>1)then(x*x)else(exp(x))\n"), 1);
}

#[test]
fn whole_powers_of_negative_numbers_have_derivatives() {
    let model = Model::parse("x'=x^3+x^-2+x**5\n").expect("reads");
    let mut derivative = [Dual::<f64, 1>::zero()];
    model.evaluate(&[Dual::variable(-2.0, 0)], &[], &mut derivative);
    assert_relative_eq!(derivative[0].value, -8.0 + 0.25 - 32.0, max_relative = 1e-14);
    assert_relative_eq!(derivative[0].derivatives[0], 12.0 + 0.25 + 80.0, max_relative = 1e-14);
}

/// Value and slope of a right-hand side in its state `v`.
fn value_and_slope(right_hand_side: &str, v: f64) -> (f64, f64) {
    let text = format!("par a=10,k=3\nvtrap(x,y)=x/(exp(x/y)-1)\nv'={right_hand_side}\n");
    let model = Model::parse(&text).unwrap();
    let mut image = [Dual::<f64, 1>::from(0.0)];
    let parameters = [Dual::from(10.0), Dual::from(3.0)];
    model.evaluate(&[Dual::variable(v, 0)], &parameters, &mut image);
    (image[0].value, image[0].derivatives[0])
}

#[test]
fn a_removable_quotient_has_its_limit_and_its_slope() {
    // Each is c B(x), B(x) = x/(exp(x) - 1) = 1 - x/2 + x^2/12, in x = s (v - v0): limit c, slope -c s/2; or 1/B.
    let cases = [
        ("v/(1-exp(-v))", 0.0, 1.0, 0.5),
        ("v/(exp(v)-1)", 0.0, 1.0, -0.5),
        ("0.1*(v+40)/(1-exp(-(v+40)/10))", -40.0, 1.0, 0.05),
        (".01*(v+55)/(1-exp(-0.1*(v+55)))", -55.0, 0.1, 0.005),
        ("(25-v)/(10*(exp((25-v)/10)-1))", 25.0, 1.0, 0.05),
        ("-0.32*(v+54)/(exp(-(v+54)/4)-1)", -54.0, 1.28, 0.16),
        ("0.32*(v+54)/(1-exp(-0.25*v-13.5))", -54.0, 1.28, 0.16),
        ("a*vtrap(-(v+35),k)", -35.0, 30.0, 5.0),
        ("(1-exp(-v*2))/v", 0.0, 2.0, -2.0),
        ("k*(v-a)/(-1+exp((v-a)/k))", 10.0, 9.0, -1.5),
    ];
    for (text, at, value, slope) in cases {
        for offset in [0.0, 1e-9, -1e-7] {
            let (found, rate) = value_and_slope(text, at + offset);
            assert_relative_eq!(found, value + slope * offset, max_relative = 1e-13);
            assert_relative_eq!(rate, slope, max_relative = 1e-6);
        }
    }
}

#[test]
fn other_quotients_are_left_alone() {
    // Not 0/0 where the exponential is one: they have no limit there.
    for text in ["(v+1)/(1-exp(-v))", "1/(exp(v)-1)", "v*v/(exp(v)-2)", "(v+40)/(1-exp(-(v+41)/10))"] {
        let (value, slope) = value_and_slope(text, 3.0);
        let (above, _) = value_and_slope(text, 3.0 + 1e-6);
        assert_relative_eq!(slope, (above - value) / 1e-6, max_relative = 1e-5);
    }
    assert!(!value_and_slope("(v+1)/(1-exp(-v))", 0.0).0.is_finite());
}

/// Derivatives along two directions one after the other, and their product.
type Second = Dual<Dual<f64, 3>, 3>;

/// The fields of x and y at the origin with the parameter `l`: Jacobian, rows one after another, and mixed second derivatives by
/// the first of them, with l as the third.
fn at_the_origin(right_hand_sides: &str) -> ([[f64; 2]; 2], [[[f64; 3]; 3]; 2]) {
    let model = Model::parse(&format!("par l=.5\nr=sqrt(x^2+y^2)\n{right_hand_sides}")).unwrap();
    let seed = |value: f64, index: usize| Second::variable(Dual::variable(value, index), index);
    let mut image = [Second::from(0.0); 2];
    model.evaluate(&[seed(0.0, 0), seed(0.0, 1)], &[seed(0.5, 2)], &mut image);
    assert_eq!(image.map(|f| f.value.value), [0.0, 0.0], "the origin is an equilibrium");
    let jacobian = image.map(|f| [f.derivatives[0].value, f.derivatives[1].value]);
    (jacobian, image.map(|f| f.derivatives.map(|row| row.derivatives)))
}

#[test]
fn squares_of_a_radius_are_the_sum_itself() {
    let plain = at_the_origin("x'=x*(l-(x^2+y^2))-y\ny'=y*(l-(x^2+y^2))+x\n");
    for text in [
        "x'=x*(l-r^2)-y\ny'=y*(l-r^2)+x\n",
        "x'=x*(l-r*r)-y\ny'=y*(l-r**2)+x\n",
        "q=(x^2+y^2)^.5\nx'=x*(l-q^2)-y\ny'=l*y-y*q*q+x\n",
        "x'=x*(l-r^4/(x^2+y^2+1))-y\ny'=y*(l-r^6)+x\n",
    ] {
        let found = at_the_origin(text);
        assert_eq!(found.0, plain.0, "{text}");
        assert_eq!(found.1, plain.1, "{text}");
    }
    let count = |text: &str| Model::parse(text).unwrap().instruction_count();
    assert_eq!(count("r=sqrt(x^2+y^2)\nx'=x*r^2\ny'=y*r^2\n"), count("r=x^2+y^2\nx'=x*r\ny'=y*r\n"));
}

#[test]
fn a_radius_in_a_product_that_vanishes_with_it_leaves_the_jacobian() {
    for text in [
        "x'=x*(l-r)-y\ny'=y*(l-r)+x\n",
        "x'=l*x-y-x*r\ny'=x+l*y-y*r\n",
        "q=(x^2+y^2)^.5\nx'=x*(l-q)-y\ny'=y*(l-q)+x\n",
        "x'=x*(l-r^3)-y\ny'=y*(l-(x^2+y^2)^1.5)+x\n",
        "x'=l*x-y+2*x*cos(1+r)-2*x*cos(1)\ny'=l*y+x\n",
    ] {
        let (jacobian, second) = at_the_origin(text);
        assert_eq!(jacobian, [[0.5, -1.0], [1.0, 0.5]], "{text}");
        // By the state and the parameter they exist.
        assert_eq!([second[0][0][2], second[1][1][2], second[0][1][2]], [1.0, 1.0, 0.0], "{text}");
    }
    // Those by the state twice do not, along no two directions.
    let (_, second) = at_the_origin("x'=x*(l-r)-y\ny'=y*(l-r)+x\n");
    for row in second {
        assert!(row[..2].iter().all(|row| row[..2].iter().all(|second| second.is_nan())), "{row:?}");
    }
}

#[test]
fn a_radius_with_a_kink_has_no_derivatives_there() {
    for text in ["x'=-x+3*r\ny'=-y\n", "x'=x*(l-r)-r\ny'=y*(l-r)\n", "x'=y*sqrt(x^2)+sqrt(r)\ny'=-y\n"] {
        let (jacobian, _) = at_the_origin(text);
        assert!(jacobian[0].iter().any(|entry| !entry.is_finite()), "{text}{jacobian:?}");
    }
}

#[test]
fn roots_of_squares() {
    let slopes = |text: &str, x: f64| {
        let model = Model::parse(&format!("x'={text}\n")).unwrap();
        let mut image = [Dual::<f64, 1>::zero()];
        model.evaluate(&[Dual::variable(x, 0)], &[], &mut image);
        (image[0].value, image[0].derivatives[0])
    };
    // Of what is negative nowhere it is that itself.
    assert_eq!(slopes("(x^4)^.5", 0.0), (0.0, 0.0));
    assert_eq!(slopes("sqrt(exp(x)^2)", 0.0), (1.0, 1.0));
    // With a kink in a product that has none.
    assert_eq!(slopes("2*x-x*(x^2)^.5", 0.0), (0.0, 2.0));
    assert_eq!(slopes("x*sqrt(x^2)", -1.5), (-2.25, 3.0));
    assert!(!slopes("2*x-sqrt(x^2)", 0.0).1.is_finite());
    assert!(slopes("sqrt(x)^2", -1.0).0.is_nan(), "a root of a negative number stays none");
}
