//! What is refused: the place, what is said about it, and the nearest name.

use arclength_ode::{Model, OdeError};

fn refusal(source: &str) -> OdeError {
    match Model::parse(source) {
        Ok(_) => panic!("read without complaint: {source}"),
        Err(error) => error,
    }
}

#[track_caller]
fn refused(source: &str, line: usize, column: usize, words: &str) {
    let error = refusal(source);
    let place = error.place().expect("these errors have a place");
    assert_eq!((place.line, place.column), (line, column), "{}", error.snippet());
    assert!(error.to_string().contains(words), "{error}");
    assert_eq!(place.source_line, source.lines().nth(line - 1).unwrap_or_default());
}

#[test]
fn what_is_not_an_ordinary_differential_equation() {
    refused("x'=-delay(x,tau)\npar tau=1\n", 1, 5, "delays are not supported; approximate the delay");
    refused("m=2*k\nk=x-delay(x,1)\nx'=m\n", 2, 5, "delays are not supported");
    refused("f(x)=ran(1)\nx'=f(x)\n", 1, 6, "random numbers");
    refused("x'=y\n0=x+y^3\n", 2, 1, "algebraic equations");
    refused("x'=y\nsolve y=1\n", 2, 1, "algebraic");
    refused("wiener n\nx'=n\n", 1, 1, "noise");
    refused("x'=k\nk=2*n\nwiener m,n\n", 3, 1, "noise");
    refused("x'=1\nwiener n\nglobal 1 {x-n} {x=0}\n", 2, 1, "noise");
    refused("x'=ran(1)\n", 1, 4, "random numbers");
    refused("table w weights.tab\nx'=w(x)\n", 1, 1, "as a formula, w(x)=...");
    refused("x'=1\nbndry x-1\n", 2, 1, "boundary conditions are not supported; remove the lines");
    refused("x'=1\nb (x-1)\n", 2, 1, "boundary conditions");
    refused("x'=1\nboundry x'\n", 2, 1, "boundary conditions");
    refused("volt x=1+int{1#x}\n", 1, 1, "integral equation");
    refused("x(t)=int{exp(-t)#x}\n", 1, 1, "integral equations");
    refused("x'=-x+int{exp(-t)#x}\n", 1, 7, "integrals over the past");
    refused("x'=z\nmarkov z 2\n{0} {1}\n{1} {0}\n", 2, 1, "Markov");
    refused(
        "x'=a\npar a=1\nglobal 1 x-1 {x=0;a=2}\n",
        3,
        19,
        "the parameter `a` is not supported; make it a state",
    );
    refused("x'=1\nglobal 1 delay(x,1) {x=0}\n", 2, 10, "delays");
    refused("x'=1\nexport {x} {y}\n", 2, 1, "external library");
    refused("x(t+1)=x/2\n", 1, 1, "maps");
    refused("x'=x/2\n@ total=10,meth=discrete\n", 2, 17, "maps");
    refused("x'=k(0)\nspecial k=conv(even,3,1,w,x0)\n", 2, 1, "network operator");
    refused("#include other.ode\nx'=1\n", 1, 1, "paste the text");
    refused("x''=-x\n", 1, 1, "x'=xdot, xdot'=");
    refused("2\nv x=1,y=2\n", 1, 1, "before 1997");
    refused("x'=besseli(0,x)\n", 1, 4, "besseli");
}

#[test]
fn slips_of_the_pen() {
    refused("x' = -gama*x\npar gamma=1\n", 1, 7, "unknown name `gama`; did you mean `gamma`?");
    refused("x'=sni(x)\n", 1, 4, "unknown function `sni`; did you mean `sin`?");
    refused("x'=1\nglobal 2 x-1 {x=0}\n", 2, 8, "the sign of the passage");
    refused("x'=1\nglobal x-1 {x=0}\n", 2, 8, "the sign of the passage");
    refused("x'=1\nglobal 1 x-1\n", 2, 13, "assignments in braces");
    refused("x'=1\nglobal 1 {x-1} {}\n", 2, 16, "expected an assignment");
    refused("x'=1\nglobal 1 {} {x=0}\n", 2, 10, "expected a condition");
    refused("x'=1\nglobal 1 x-1 {x=0;z=1}\n", 2, 19, "unknown state `z`");
    refused("x'=1\nk=x\nglobal 1 x-1 {k=0}\n", 3, 15, "unknown state `k`");
    refused("voltage'=1\ninit votlage=2\n", 2, 6, "unknown state `votlage`; did you mean `voltage`?");
    refused("x'=2x\n", 1, 5, "products are written with *");
    refused("x'=20sin(x)\n", 1, 6, "products are written with *");
    refused("x'=1\npar 1e5=2\n", 2, 5, "`1e5` is a number, not a name");
    refused("table w % 1 0 1 t\nx'=w(x)\n", 1, 11, "two points or more");
    refused("table w % 5 1 0 t\nx'=w(x)\n", 1, 15, "above its lower end");
    refused("table w % 5 0 x t\nx'=w(x)\n", 1, 15, "expected the upper end");
    refused("table w % 5 0 1 t*x\nx'=w(x)\n", 1, 19, "depends on `x`");
    refused("table w % 5 0 1 w(t)\nx'=w(x)\n", 1, 17, "defined through itself");
    refused("table w % 5 0 1 t\nx'=w(x,1)\n", 2, 4, "takes 1 argument, not 2");
    refused("x'=(x+1\n", 1, 8, "expected ) to close the parenthesis, found the end of the line");
    refused("x'=x+1)\n", 1, 7, "never opened");
    refused("x'=x+\n", 1, 6, "ends where a number or name was expected");
    refused("x'=\n", 1, 4, "ends where");
    refused("x'=1.2.3\n", 1, 7, "expected an operator");
    refused("x'=x ? 1\n", 1, 6, "no meaning");
    refused("x'=sin x\n", 1, 8, "expected ( after the function `sin`");
    refused("x'=max(x)\n", 1, 4, "`max` takes 2 arguments, not 1");
    refused("f(a,b)=a+b\nx'=f(x)\n", 2, 4, "`f` takes 2 arguments, not 1");
    refused("x'=if(x>1)then(2)\n", 1, 18, "expected `else`");
    refused("x'=x=1\n", 1, 5, "equality is written ==");
    refused("x'=k\nk=k+1\n", 2, 3, "`k` is defined through itself");
    refused("f(x)=f(x-1)\ny'=f(y)\n", 1, 6, "`f` is defined through itself");
    refused("x'=1\npar a=2\nX'=2\n", 3, 1, "already a state (line 1)");
    refused("x'=1\npar sin=2\n", 2, 5, "already a word of the language");
    refused("!c=x+1\nx'=c\n", 1, 4, "depends on `x`");
    refused("x'=sum(0,n)of(i')\npar n=3\n", 1, 4, "declare what it depends on with `number`");
    refused("x'=i'\n", 1, 4, "only inside sum");
    refused("x0'=shift(x0,5)\n", 1, 5, "outside what is declared");
    refused("x[0..2]'=x[j-1]\n", 1, 11, "cannot be negative");
    refused("x'=[j]\n", 1, 4, "no meaning outside");
    refused("x[0..2]'=y[0..3]\n", 1, 11, "one array range only");
    refused("x'=1\npar a=one\n", 2, 7, "unknown name `one`");
    refused("x'=1\npar a=\n", 2, 6, "expected a value");
    refused("x'=1\n@ total=long\n", 2, 9, "takes a number");
    refused("x'=1\nv(0)=-60.00[-90,0]\n", 2, 12, "`[-90,0]` has no meaning behind a number");
    refused("x'=shift(x,n)\npar n=0\n", 1, 4, "`shift` must be a constant; declare what it depends on");
    assert_eq!(refusal("par a=1\n"), OdeError::NoEquations);
    assert_eq!(refusal(""), OdeError::NoEquations);
}

#[test]
fn signs_that_only_look_like_those_of_the_language() {
    refused("x'=1\ninit x=\u{2212}1.04\n", 2, 8, "`\\u{2212}` has no meaning in an expression; write -");
    refused("x'=2\u{d7}x\n", 1, 5, "; write *");
    refused("x'=x\u{b2}\n", 1, 5, "; write ^2");
    refused("x'=if(x\u{2265}1)then(0)else(1)\n", 1, 8, "; write >=");
    refused("x\u{2019}=1\n", 1, 2, "makes no derivative; write '");
    refused("x\u{2032} = 1\n", 1, 2, "makes no derivative; write '");
    refused("x'\u{ff1d}1\n", 1, 3, "expected =, found `\u{ff1d}`; write =");
}

#[test]
fn an_initial_value_that_follows_a_parameter_is_refused_with_what_works() {
    refused("x'=1\npar vl=-60\ninit x=vl\n", 3, 8, "write that number, or `x(0)=vl` for");
    assert_eq!(Model::parse("x'=1\npar vl=-60\nx(0)=vl\n").unwrap().initial_state(&[-60.0]), [-60.0]);
}

#[test]
fn a_parameter_that_follows_another_is_refused_with_both_readings() {
    refused("x'=b\npar a=3\npar b=2*a\n", 3, 7, "`2*a` is no constant, and XPPAUT reads only");
    refused("x'=b\npar a=3\npar b=2*a\n", 3, 7, "beginning, 2; write that number, or `!b=2*a`");
}

#[test]
fn places_survive_continuation_arrays_and_tabs() {
    refused("x'=1+\\\n  2*(3+oops)\n", 2, 8, "unknown name `oops`");
    refused("x[1..3]'=[j]*oops\n", 1, 14, "unknown name `oops`");
    refused("par a=1\r\nx'=b\r\n", 2, 4, "unknown name `b`");
    let error = refusal("x'=\ta*oops\npar a=1\n");
    assert!(error.snippet().ends_with("1 | x'= a*oops\n  |       ^^^^"), "{}", error.snippet());
}

#[test]
fn limits_stop_what_would_never_end() {
    let deep = format!("x'={}x{}\n", "(".repeat(100_000), ")".repeat(100_000));
    assert!(matches!(refusal(&deep), OdeError::TooLarge { .. }));
    let doubling: String = (1..60).map(|k| format!("f{k}(x)=f{}(x+1)+f{}(x*2)\n", k - 1, k - 1)).collect();
    assert!(matches!(refusal(&format!("f0(x)=x^2\n{doubling}x'=f59(x)\n")), OdeError::TooLarge { .. }));
    let long_sum = "x'=sum(0,1e15)of(x)\n";
    assert!(matches!(refusal(long_sum), OdeError::TooLarge { .. }));
    let nested_sums = "f(x)=sum(0,99999)of(x+i')\nx'=sum(0,99999)of(f(i'))\n";
    assert!(matches!(refusal(nested_sums), OdeError::TooLarge { .. }));
    assert!(matches!(refusal("x[0..2000000000]'=1\n"), OdeError::TooLarge { .. }));
    let minus = format!("x'={}x\n", "-".repeat(100_000));
    assert!(matches!(refusal(&minus), OdeError::TooLarge { .. }));
    // Long but flat is fine.
    let flat = format!("x'=x{}\n", "+x".repeat(20_000));
    assert!(Model::parse(&flat).is_ok());
    let chain: String = (1..2_000).map(|k| format!("k{k}=k{}+x\n", k - 1)).collect();
    assert!(Model::parse(&format!("k0=x\n{chain}x'=k1999\n")).is_ok());
}
