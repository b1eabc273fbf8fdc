//! The language, statement by statement.

use arclength::VectorField;
use arclength_ode::Model;
use std::f64::consts::{E, PI};

fn read(source: &str) -> Model {
    Model::parse(source).unwrap_or_else(|error| panic!("{}", error.snippet()))
}

/// The value of an expression at x = 0.1, a = 2, b = 3, t = 0.
fn value(expression: &str) -> f64 {
    let model = read(&format!("x'=0\npar a=2,b=3\ninit x=.1\naux k={expression}\n"));
    let mut values = [f64::NAN];
    model.evaluate_auxiliary(0.0, &[0.1], &[2.0, 3.0], &mut values);
    values[0]
}

fn field(model: &Model) -> Vec<f64> {
    let parameters = model.default_parameters();
    let mut derivative = vec![f64::NAN; model.dimension()];
    model.evaluate(&model.initial_state(parameters), parameters, &mut derivative);
    derivative
}

#[test]
fn operators_have_the_precedence_of_xppaut() {
    // What XPPAUT 6.11 prints for these.
    for (expression, expected) in [
        ("2^3^2", 64.0),
        ("2**3", 8.0),
        ("-2^2", -4.0),
        ("-a*b^2", -18.0),
        ("-a^2*b", -12.0),
        ("8/2/2", 2.0),
        ("2-3-4", -5.0),
        ("a+b>3", 2.0),
        ("a*b>3", 0.0),
        ("-a>1", -1.0),
        ("a>1&b<4", 1.0),
        ("a>1|b>4", 1.0),
        ("a>b>3", 0.0),
        ("not(a>3)", 1.0),
        ("a&b", 1.0),
        ("a==2", 1.0),
        ("if(a+b>3)then(1)else(2)", 1.0),
        ("if(x>1)then(2)else(3)+1", 4.0),
        ("sum(1,3)of(i'*i')", 14.0),
        ("mod(-1,3)", 2.0),
        ("heav(0)", 1.0),
        ("flr(-1.5)", -2.0),
        ("sign(-3)", -1.0),
        ("1e-3+.5+2.", 2.501),
        ("-(-1)", 1.0),
        ("sin (x)", 0.1_f64.sin()),
    ] {
        assert!((value(expression) - expected).abs() < 1e-12, "{expression} is {}", value(expression));
    }
}

#[test]
fn what_xppaut_cannot_read_is_read_as_it_is_meant() {
    for (expression, expected) in [
        ("a*-1", -2.0),
        ("x>-1", 1.0),
        ("2^-1", 0.5),
        ("2*-a^2", -8.0),
        ("--1", 1.0),
        ("+1", 1.0),
        ("a != 3 && b <> 4", 1.0),
        ("ceil(1.5)", 2.0),
        ("log2(8)", 3.0),
    ] {
        assert!((value(expression) - expected).abs() < 1e-12, "{expression} is {}", value(expression));
    }
}

#[test]
fn functions() {
    for (expression, expected) in [
        ("exp(1)", E),
        ("ln(b)+log(b)", 2.0 * 3.0_f64.ln()),
        ("log10(1000)", 3.0),
        ("sqrt(a)", 2.0_f64.sqrt()),
        ("tan(x)+sinh(x)+cosh(x)+tanh(x)", 0.1_f64.tan() + 0.1_f64.exp() + 0.1_f64.tanh()),
        ("asin(x)+acos(x)", PI / 2.0),
        ("atan2(a,-b)", 2.0_f64.atan2(-3.0)),
        ("abs(a-b)+max(a,b)+min(a,b)", 6.0),
        ("erf(x)+erfc(x)", 1.0),
        ("besselj(0,1)", 0.765_197_686_557_966_6),
        ("cos(pi)+t", -1.0),
        ("a^x*(-a)^3", -8.0 * 2.0_f64.powf(0.1)),
        ("mod(7.5,b)", 1.5),
    ] {
        assert!((value(expression) - expected).abs() < 1e-12, "{expression} is {}", value(expression));
    }
}

#[test]
fn equations_in_all_spellings() {
    let model = read("x'=1\ndy/dt = 2\n  z ' = 3\nDW/DT=4\n");
    assert_eq!(model.states(), ["x", "y", "z", "W"]);
    assert_eq!(field(&model), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn initial_data_in_all_spellings() {
    let model = read(
        "x'=0\ny'=0\nz'=0\nw'=0\nu'=0\nv'=0\npar a=3\ninit x=1, y = -2\ni z=.5 w=1e-3\nu(0)=a^2\nv (0) = -4\n",
    );
    assert_eq!(model.initial_state(&[3.0]), [1.0, -2.0, 0.5, 1e-3, 9.0, -4.0]);
    assert_eq!(model.initial_state(&[1.0])[4], 1.0);
}

#[test]
fn parameters_in_all_spellings() {
    let model = read("x'=k\npar a=1,b=2 c=3\nparam d = 4 , e=-5.\nP f=1e3\nparams g=2;h=3\nnumber k=7\n");
    assert_eq!(model.parameters(), ["a", "b", "c", "d", "e", "f", "g", "h"]);
    assert_eq!(model.default_parameters(), [1.0, 2.0, 3.0, 4.0, -5.0, 1e3, 2.0, 3.0]);
    assert_eq!(model.numbers(), [("k".to_owned(), 7.0)]);
    assert_eq!(field(&model), [7.0]);
}

#[test]
fn a_formula_as_a_value_is_computed_with_a_warning() {
    let model = read("x'=a+b\npar a=1/4, b\n");
    assert_eq!(model.default_parameters(), [0.25, 0.0]);
    assert_eq!(model.warnings().len(), 2);
    assert_eq!((model.warnings()[0].place.line, model.warnings()[0].place.column), (2, 7));
}

#[test]
fn an_initial_formula_that_begins_with_a_number_warns() {
    // Seen in XPPAUT 6.11: it starts at 2, 0.5 and -2.
    for (formula, value) in [("2*3", 6.0), (".5+a", 1.5), (" -2*3", -6.0)] {
        let model = read(&format!("x'=a\npar a=1\nx(0)={formula}\n"));
        assert_eq!(model.initial_state(&[1.0]), [value]);
        let warning = model.warnings()[0].to_string();
        assert!(warning.contains("line 3") && warning.contains("only the number"), "{warning}");
    }
    for formula in ["(2)*3", "a*2", "-a", "-5", " .5 ", "1e-3"] {
        assert!(read(&format!("x'=a\npar a=1\nx(0)={formula}\n")).warnings().is_empty(), "{formula}");
    }
}

#[test]
fn names_do_not_tell_upper_from_lower_case() {
    let model = read("V' = -GK*n + Phi(v)\nN'=0\npar gK=2\nphi(U)=u^2\ninit V=3,N=1\n");
    assert_eq!(field(&model)[0], -2.0 + 9.0);
    assert_eq!(model.states(), ["V", "N"]);
    assert_eq!(model.state_index("n"), Some(1));
    assert_eq!(model.parameter_index("GK"), Some(0));
}

#[test]
fn functions_see_parameters_quantities_and_their_arguments_first() {
    let model = read("x'=f(2,x)\nf(a,y)=a*y+k*g(y)\ng(z)=z+b\nk=10*b\npar a=100,b=3\ninit x=1\n");
    assert_eq!(field(&model), [2.0 + 30.0 * 4.0]);
    assert_eq!(model.functions(), ["f(a,y)", "g(z)"]);
}

#[test]
fn derived_parameters_follow_the_parameters() {
    let model = read("x'=c*x\npar a=2\n!b=a^2\n!c=b+1\ninit x=1\n");
    assert_eq!(model.derived_names(), ["b", "c"]);
    let mut derivative = [0.0];
    model.evaluate(&[1.0], &[3.0], &mut derivative);
    assert_eq!(derivative, [10.0]);
    let mut values = [0.0; 2];
    model.evaluate_derived(&[3.0], &mut values);
    assert_eq!(values, [9.0, 10.0]);
}

#[test]
fn quantities_used_before_their_definition_earn_a_warning() {
    let ordered = read("b=2*x\na=b+1\nx'=a\ninit x=5\n");
    let reversed = read("a=b+1\nb=2*x\nx'=a\ninit x=5\n");
    assert_eq!(field(&ordered), [11.0]);
    assert_eq!(field(&reversed), [11.0]);
    assert!(ordered.warnings().is_empty());
    assert_eq!((reversed.warnings()[0].place.line, reversed.warnings()[0].place.column), (1, 3));
}

#[test]
fn arrays_expand_as_text() {
    let model = read(
        "x0'=0\nx[1..3]'=-x[j]+[j]*k[j]+x[j-1]\npar k[1..3]=.5\ninit x[0..3]=[j]\ny[3..1]'=[j*2]\naux s[1..2]=x[j+1]\n",
    );
    assert_eq!(model.states(), ["x0", "x1", "x2", "x3", "y3", "y2", "y1"]);
    assert_eq!(model.parameters(), ["k1", "k2", "k3"]);
    assert_eq!(field(&model), [0.0, -0.5, 0.0, 0.5, 6.0, 4.0, 2.0]);
    assert_eq!(model.auxiliary_names(), ["s1", "s2"]);
}

#[test]
fn blocks_expand_line_by_line() {
    let model = read("%[1..2]\nx[j]'=y[j]\ny[j]'=-[j]*x[j]\nx[j](0)=[j]\n%\nz'=x[2]\n");
    assert_eq!(model.states(), ["x1", "y1", "x2", "y2", "z"]);
    assert_eq!(field(&model), [0.0, -1.0, 0.0, -4.0, 2.0]);
}

#[test]
fn sums_and_shifts_are_unrolled() {
    let model = read(
        "u[0..4]'=sum(0,4)of(shift(u0,i')*([j]+1))-shift(p0,[j])\npar p[0..4]=[j]\ninit u[0..4]=[j]\n\
         v'=sum(0,3)of(if(i'<3)then(shift(u2,i'))else(100))\n",
    );
    assert_eq!(field(&model), [10.0, 19.0, 28.0, 37.0, 46.0, 2.0 + 3.0 + 4.0 + 100.0]);
}

#[test]
fn named_sets_and_options() {
    let model = read(
        "x'=a\npar a=1\nset fast {a=3, x = 2, total=50}\n@ total=100,dt=.1 DSMAX=.5, parmin=-1 xplot=x\n\
         @ meth=cvode,ntst=60,maxstor=10000,autoxmin=0 wibble=3\ndone\n",
    );
    let set = model.set("FAST").expect("declared");
    assert_eq!((set.parameters.as_slice(), set.states.as_slice()), (&[(0, 3.0)][..], &[(0, 2.0)][..]));
    assert_eq!((set.options[0].name.as_str(), set.options[0].value.as_str()), ("total", "50"));
    let options = model.options();
    assert_eq!(
        (options.total, options.dt, options.dsmax, options.parmin),
        (Some(100.0), Some(0.1), Some(0.5), Some(-1.0))
    );
    assert_eq!((options.ntst, options.autoxmin), (Some(60.0), Some(0.0)));
    assert_eq!((options.xp.as_deref(), options.method.as_deref()), (Some("x"), Some("cvode")));
    assert_eq!(options.get("MaxStor"), Some("10000"));
    assert_eq!(model.warnings().len(), 1, "{:?}", model.warnings());
    assert!(model.warnings()[0].message.contains("wibble"));
}

#[test]
fn time_makes_a_model_nonautonomous_only_where_it_matters() {
    let forced = read("x'=-x+a*cos(w*t)\npar a=1,w=2\n");
    assert!(!forced.is_autonomous());
    let place = forced.time_dependence().expect("t is used");
    assert_eq!((place.line, place.column), (1, 15));
    let mut derivative = [0.0];
    forced.evaluate_at(0.5, &[0.25], &[1.0, 2.0], &mut derivative);
    assert_eq!(derivative, [-0.25 + 1.0_f64.cos()]);
    forced.evaluate(&[0.25], &[1.0, 2.0], &mut derivative);
    assert_eq!(derivative, [0.75]);
    // A function that names its argument t, and a quantity that only an output uses.
    assert!(read("f(t)=t^2\ns=sin(t)\nx'=-f(x)\naux s=s\n").is_autonomous());
}

#[test]
fn text_of_any_origin() {
    let plain = "par a=2\nx'=-a*x+\\\n  y\ny'=1\ndone\nanything ' at all\n";
    let expected = field(&read(plain));
    assert_eq!(field(&read(&plain.replace('\n', "\r\n"))), expected);
    assert_eq!(field(&read(&plain.replace('\n', "\r"))), expected);
    assert_eq!(field(&read(&plain.replace(' ', "\t"))), expected);
    assert_eq!(field(&read(&format!("\u{feff}{plain}"))), expected);
    let latin = [b"# mod\xe8le d'Erment\xdfrout\n".as_slice(), plain.as_bytes()].concat();
    let model = Model::parse_bytes(&latin).expect("Latin-1 is read");
    assert_eq!(field(&model), expected);
    assert_eq!(field(&read(model.source())), expected);
}

#[test]
fn what_has_no_meaning_here_is_ignored_with_a_warning() {
    let model = read("x'=y # a remark\ny'=-x\n\" {x=1} a note\nonly x\noption file\nd\n");
    assert_eq!(model.states(), ["x", "y"]);
    assert_eq!(model.warnings().len(), 2, "{:?}", model.warnings());
}

#[test]
fn remarks_of_every_kind() {
    let model = read("x'=-x\n% a remark, x'=3\n%x'=4\n  %\n\" y'=1\n# z'=[1\npar a=1 # x[0..9\n");
    assert_eq!((model.states().len(), model.parameters().len()), (1, 1));
    assert!(model.warnings().is_empty(), "{:?}", model.warnings());
}

#[test]
fn a_backslash_in_a_remark() {
    // XPPAUT reads the first line as it is, and joins every other one.
    let model = read("# the \\tau of the model\npar k=2\nx'=-k*x\ninit x=1\n");
    assert_eq!((field(&model), model.warnings().len()), (vec![-2.0], 0));
    let model = read("x'=-x\n# the \\tau of the model\npar k=2\ninit x=1\n");
    assert_eq!((model.parameters().len(), model.warnings().len()), (0, 1));
    assert_eq!((model.warnings()[0].place.line, model.warnings()[0].place.column), (2, 7));
}

#[test]
fn arrays_with_more_points_than_two() {
    assert_eq!(read("x[1...5]'=-x[j]\n").states(), ["x1", "x2", "x3", "x4", "x5"]);
    assert_eq!(read("%[1....2]\nx[j]'=1\n%\n").states(), ["x1", "x2"]);
}

#[test]
fn infinity_is_a_value() {
    let model = read("x'=1-x/k\npar k=inf,b=-Inf\nnumber c=infinity\ninit x=1\nset s {k=inf}\n");
    assert_eq!(model.default_parameters(), [f64::INFINITY, f64::NEG_INFINITY]);
    assert_eq!(model.numbers(), [("c".to_owned(), f64::INFINITY)]);
    assert_eq!(field(&model), [1.0]);
    assert!(model.warnings().is_empty());
}

#[test]
fn directives_are_known_by_their_first_letters() {
    let model = read("x'=-k*x+b\nparm k=2\nini x=1\nnbr b=3\nauxil q=2*x\nsetting s {k=1}\nonlyplot x\n");
    assert_eq!((model.parameters(), field(&model)), (&["k".to_owned()][..], vec![1.0]));
    assert_eq!((model.auxiliary_names(), model.sets().len()), (&["q".to_owned()][..], 1));
    // A word in d ends the model, which is said when it may not have been meant.
    let model = read("x'=1\ndendrite of the cell\ny'=1\n");
    assert_eq!((model.states().len(), model.warnings().len()), (1, 1));
    assert!(read("x'=1\ndone here y\ny'=1\n").warnings().is_empty());
    assert_eq!(read("dk[1..2]=[j]\ndx/dt=dk1+dk2\n").states(), ["x"]);
}

#[test]
fn what_begins_no_statement_is_left_out_with_a_warning() {
    for line in [
        "circular structure",
        "------",
        "*** currents ***",
        "x: the voltage",
        "Hodgkin (1952)",
        "total 100",
        "3: c",
    ] {
        let model = read(&format!("x'=1\n{line}\npar a=1\n"));
        assert_eq!((model.states().len(), model.parameters().len()), (1, 1), "{line}");
        assert_eq!(model.warnings().len(), 1, "{line}: {:?}", model.warnings());
        assert_eq!(model.warnings()[0].place.line, 2);
    }
    assert!(read("x'=1\nuax q=1\n").warnings()[0].message.contains("did you mean `aux`"));
}

#[test]
fn names_may_begin_with_a_digit() {
    let model = read("2b=3\n5ht'=-2b*5ht+3k-1e3+2e1*1e+1\npar 3k=4\n1f(x)=2*x\nd7x/dt=1f(3)\ninit 5ht=1\n");
    assert_eq!(model.states(), ["5ht", "7x"]);
    assert_eq!(field(&model), [-3.0 + 4.0 - 1e3 + 200.0, 6.0]);
}

#[test]
fn a_formula_as_a_value_says_both_readings() {
    let message = |value: &str| read(&format!("x'=a\npar a={value}\n")).warnings()[0].message.clone();
    for (value, ours, theirs) in
        [("2*3", "6", "2"), ("1e1/4", "2.5", "10"), ("-(3)", "-3", "0"), (".5+.25", "0.75", "0.5")]
    {
        let message = message(value);
        assert!(message.contains(&format!("taken as {ours}, ")), "{message}");
        assert!(message.contains(&format!("beginning, {theirs};")), "{message}");
    }
    assert!(message("2*1").contains("as XPPAUT reads it"));
}

#[test]
fn tables_of_a_formula_are_functions() {
    let model = read("x'=w(x)\ny'=w(y)\nz'=w(a)\ntable w % 11 0 2 a*t^2\npar a=3\ninit x=0.3,y=4,z=-1\n");
    // Inside the formula; beyond the ends the lines through the last two points, as in XPPAUT.
    let slope = (3.0 * 4.0 - 3.0 * 1.8 * 1.8) / 0.2;
    let values = field(&model);
    assert!((values[0] - 0.27).abs() < 1e-15);
    assert!((values[1] - (12.0 + 2.0 * slope)).abs() < 1e-12);
    assert!((values[2] - (12.0 + slope)).abs() < 1e-12);
    let mut derivative = [0.0; 3];
    model.evaluate(&[0.3, 4.0, 1.0], &[-1.0], &mut derivative);
    assert!((derivative[2] - 0.2).abs() < 1e-15, "{derivative:?}");
    assert!(model.warnings()[0].message.contains("11 points"));
    assert!(model.is_autonomous());
}

#[test]
fn comparisons_inside_arithmetic_earn_a_warning() {
    assert!(read("x'=if(x>1&x<2)then(x)else((x>1)*2)\n").warnings().is_empty());
    assert_eq!(read("x'=if(x+1>2)then(1)else(0)\n").warnings().len(), 1);
    assert_eq!(read("x'=-x>1\n").warnings().len(), 1);
}

#[test]
fn large_models_run_from_the_heap() {
    let source = "u[0..299]'=-u[j]+sum(0,299)of(shift(u0,i')*cos(i'*[j]))\ninit u[0..299]=1\n";
    let model = read(source);
    assert!(model.register_count() > 256);
    let expected: f64 = (0..300).map(|i| (f64::from(i) * 7.0).cos()).sum();
    assert!((field(&model)[7] - (expected - 1.0)).abs() < 1e-9);
}

#[test]
fn what_no_equation_depends_on_is_left_out_where_it_is_not_supported() {
    let model = read(
        "x'=-f(x)\nm=(x-delay(x,tau))/tau\nn=2*m\nf(x)=x\ng(x)=ran(x)\npar tau=1\naux a=2*x\naux b=n+1\naux c=g(x)\n\
         aux d=ran(1)\naux e=f(x)\ninit x=3\nset a pair {tau=2}\n",
    );
    assert_eq!((model.auxiliary_names(), field(&model)), (&["a".to_owned(), "e".to_owned()][..], vec![-3.0]));
    let mut values = [0.0; 2];
    model.evaluate_auxiliary(0.0, &[3.0], &[1.0], &mut values);
    assert_eq!(values, [6.0, 3.0]);
    let lines: Vec<usize> = model.warnings().iter().map(|warning| warning.place.line).collect();
    assert_eq!(lines, [8, 9, 10]);
    assert!(model.warnings()[0].message.contains("`b` is left out: delays are not supported; approximate"));
    assert!(model.set("a pair").is_some());
    assert!(model.quantity("x+ran(1)", &[]).is_err_and(|error| error.to_string().contains("random numbers")));
    assert_eq!(model.quantity("x+a", &["a"]).map(|quantity| quantity.value(&[1.0], &[1.0], &[5.0])), Ok(6.0));
}

#[test]
fn the_last_initial_value_counts() {
    let start = |text: &str| read(&format!("x'=-x\npar a=3\n{text}")).initial_state(&[3.0]);
    assert_eq!(start("x(0)=2\ninit x=5\n"), [5.0]);
    assert_eq!(start("init x=5\nx(0)=2\n"), [2.0]);
    assert_eq!(start("x(0)=a\ninit x=5\n"), [5.0]);
    assert_eq!(start("init x=5\nx(0)=a\ninit x=7\nX(0)=a+1\n"), [4.0]);
}

#[test]
fn what_is_not_supported_and_not_used_is_left_out_with_a_warning() {
    for (line, name) in [
        ("wiener w", "w"),
        ("markov z 2\n{0} {x+1}\n{1} {0}\ninit z=1", "z"),
        ("special k=conv(even,3,1,w,x0)", "k"),
        ("table f weights.tab", "f"),
    ] {
        let model = read(&format!("{line}\nx'=2-x\n"));
        assert_eq!((field(&model), model.states().len()), (vec![2.0], 1), "{line}");
        let message = &model.warnings()[0].message;
        assert_eq!((model.warnings().len(), model.warnings()[0].place.line), (1, 1), "{line}");
        assert!(message.starts_with(&format!("`{name}` is left out")), "{message}");
        assert!(message.ends_with("not supported, and no equation depends on it"), "{message}");
    }
    // What only a quantity without use, or an output, depends on.
    let model = read("wiener v,w\nx'=2-x\nunused=3*v\naux noise=w\n");
    assert!(model.auxiliary_names().is_empty());
    assert_eq!(model.warnings().len(), 3, "{:?}", model.warnings());
}

#[test]
fn a_right_hand_side_that_is_not_finite_is_told_with_its_cause() {
    let told = |text: &str| {
        let model = read(text);
        let state = model.initial_state(model.default_parameters());
        model.not_finite(0.0, &state, model.default_parameters()).map(|found| found.to_string())
    };
    let of = |text: &str| told(text).unwrap();
    assert_eq!(told("x'=1/(x+1)\n"), None);
    assert_eq!(of("x'=1/x\n"), "the right-hand side of x is not finite: a division by zero (line 1)");
    assert_eq!(
        of("par a=0\nx'=-x\nq=3*x\nk=exp(x)+1/a\nm=2*k\ny'=m-y\n"),
        "the right-hand side of y is not finite: a division by zero in k (line 4)"
    );
    // 0 times an infinite phase.
    assert_eq!(
        of("p'=0\ndbs(t)=sin(6.28*t/p)\nx'=0*dbs(t)+x*dbs(t+1)\n"),
        "the right-hand side of x is not finite: a division by zero (line 3)"
    );
    assert!(of("x'=ln(x)\n").contains("the logarithm of a number that is not positive"));
    assert!(of("x'=sqrt(x-1)\n").contains("the root of a negative number"));
    assert!(of("x'=(x-1)^1.5\n").contains("a power of a negative number"));
    assert!(of("x'=exp(1000+x)\n").contains("a number too large"));
    assert!(of("par a=inf\nx'=a*x\n").contains("a parameter is infinite"));
}
