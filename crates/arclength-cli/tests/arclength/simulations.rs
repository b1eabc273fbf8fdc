//! Time histories: switches in time, samples, tolerances, the model's own settings, auxiliary quantities.
//!
//! Right values are closed forms, or of the classical method of order 4 with steps of 1e-3, piece by piece.

use super::Folder;
use serde_json::Value;

fn simulate(model: &str, options: &str) -> Value {
    Folder::with_text("model.ode", model).json(&format!("simulate model.ode {options} -q"))
}

#[track_caller]
fn list(history: &Value, kind: &str, name: &str) -> Vec<f64> {
    let list = history[kind][name].as_array().unwrap_or_else(|| panic!("no {kind} {name} in {history}"));
    list.iter().map(|value| value.as_f64().unwrap_or(f64::NAN)).collect()
}

#[track_caller]
fn close(found: f64, right: f64, error: f64) {
    assert!((found - right).abs() <= error, "{found}, right {right}");
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

const NEURON: &str = "w'=.08*(v+.7-.8*w)\ninit v=-1.19941,w=-.62426\nv'=v-v^3/3-w+4*";

#[test]
fn no_pulse_is_stepped_over() {
    let neuron = |pulse: &str| {
        let history = simulate(&format!("{NEURON}{pulse}\n"), "--duration 600 --points 6001");
        largest(&list(&history, "states", "v"))
    };
    close(neuron("heav(t-200)*heav(202-t)"), 2.770_114_063_069, 1e-8);
    close(neuron("heav(t-100)*heav(100.2-t)"), 1.768_189_260_711, 1e-8);
    let decay = |pulse: &str, at: &str| {
        let history = simulate(&format!("x'={pulse}-x\n"), &format!("--duration {at} --points 3"));
        *list(&history, "states", "x").last().unwrap()
    };
    // x after a pulse of this height and width.
    let after = |height: f64, width: f64, since: f64| height * -(-width).exp_m1() * (-since).exp();
    close(decay("10*heav(t-200)*heav(205-t)", "205"), after(10.0, 5.0, 0.0), 1e-9);
    close(decay("1e6*heav(t-200)*heav(200.000001-t)", "201"), after(1e6, 1e-6, 1.0 - 1e-6), 1e-8);
    close(decay("if(t>=300&t<300.5)then(2)else(0)", "301"), after(2.0, 0.5, 0.5), 1e-9);
    close(decay("max(0,min(1,1e4*(t-50)))*(t<51)", "52"), after(1.0, 1.0, 1.0), 3e-5);
    // A train of a hundred pulses; what is left of all.
    let train: f64 = (0..100).map(|k| after(5.0, 0.01, 20.0 * f64::from(k) + 14.99)).sum();
    close(decay("5*heav(mod(t,20)-5)*heav(5.01-mod(t,20))", "2000"), train, 1e-12);
    close(decay("sign(sin(pi*t))", "1001"), (1.0 - (-1.0_f64).exp()) / (1.0 + (-1.0_f64).exp()), 1e-9);
    close(decay("flr(t)", "3"), 2.0 - (-1.0_f64).exp() - (-2.0_f64).exp(), 1e-9);
}

/// The state at the end.
fn end(model: &str, duration: f64) -> Vec<f64> {
    let history = simulate(model, &format!("--duration {duration} --points 3"));
    let states = history["states"].as_object().unwrap().values();
    states.map(|values| values.as_array().unwrap().last().unwrap().as_f64().unwrap()).collect()
}

#[test]
fn what_switches_on_a_state_is_located() {
    // x rises to 1, then falls: a tent.
    let history = simulate("x'=if(s<1)then(1)else(-1)\ns'=1\n", "--duration 2 --points 201");
    for (t, x) in list(&history, "states", "s").iter().zip(list(&history, "states", "x")) {
        close(x, 1.0 - (t - 1.0).abs(), 1e-9);
    }
    // A pulse of width 1e-3, a stair, and an oscillator that is pushed away on the left.
    let pulse = 1e3 * -(-1e-3_f64).exp_m1() * (-0.999_f64).exp();
    close(end("s'=1\nx'=1000*(s>5&s<5.001)-x\n", 6.0)[1], pulse, 1e-9);
    close(end("s'=1\nx'=flr(s)-x\n", 3.0)[1], 2.0 - (-1.0_f64).exp() - (-2.0_f64).exp(), 1e-9);
    let left = 3_f64.sqrt() * (3.0 - std::f64::consts::FRAC_PI_2 / 3_f64.sqrt()).sinh();
    close(end("x'=y\ny'=-x-2*abs(x)\ninit x=1\n", 3.0)[0], -left, 1e-8);
}

#[test]
fn motions_slide_along_switches() {
    let history = simulate("x'=if(x<.5)then(5)else(-1)\n", "--duration 3 --points 301");
    for (t, x) in history["t"].as_array().unwrap().iter().zip(list(&history, "states", "x")) {
        close(x, (5.0 * t.as_f64().unwrap()).min(0.5), 1e-12);
    }
    // Two switches at the same place, and a kink on the way.
    let kinked = "x'=1-2*heav(x-.5)-3*heav(2*x-1)\ny'=min(x,.2)-y\n";
    let at_kink = 0.2 - 1.0 + (-0.2_f64).exp();
    close(end(kinked, 4.0)[1], 0.2 + (at_kink - 0.2) * (-3.8_f64).exp(), 1e-10);
    // A mass on a belt: from rest to the belt's speed, held by it until the spring is as strong as the friction, then a circle.
    let belt = "par v=.2,f=.5\nx'=y\ny'=-x-f*sign(y-v)\n";
    let (held, slips) = (0.4_f64.asin(), 0.4_f64.asin() + (0.5 - 0.5 * (1.0 - 0.84_f64.sqrt())) / 0.2);
    close(end(belt, held + 1.0)[1], 0.2, 1e-12);
    let turn = 5.0 - slips;
    close(end(belt, 5.0)[0], 0.5 + 0.2 * turn.sin(), 1e-9);
    close(end(belt, 5.0)[1], 0.2 * turn.cos(), 1e-9);
}

#[test]
fn motions_that_are_held_twice_end_with_a_reason() {
    let folder = Folder::with_text("model.ode", "x'=-sign(x)\ny'=-2*sign(y)\ninit x=1,y=1\n");
    folder.fails("simulate model.ode --duration 3", 1, &["again and again", "t = 1"]);
}

#[test]
fn no_sample_is_without_a_number() {
    let history = simulate("u'=heav(t-1)-u\nw'=sqrt(u)-w\n", "--duration 3 --points 61");
    let w = list(&history, "states", "w");
    assert_eq!((w[20], w.iter().any(|value| value.is_nan())), (0.0, false));
    let folder = Folder::with_text("model.ode", "x'=-1/(2*x)\ninit x=1\n");
    folder.fails("simulate model.ode --duration 2", 1, &["cannot be followed", "t = 0.99999"]);
}

#[test]
fn small_states_have_as_many_digits_as_large_ones() {
    for size in [1e-8, 1e-15, 1e3] {
        let model = format!("x'=y\ny'=-x\nz'=-z/10\ninit x={size},z=1\n");
        let end = |options: &str| {
            let history = simulate(&model, &format!("--duration 100 --points 3 {options}"));
            *list(&history, "states", "x").last().unwrap() / size
        };
        close(end(""), 100.0_f64.cos(), 1e-8);
        close(end("--tolerance 1e-13"), 100.0_f64.cos(), 1e-11);
        let coarse = (end("--tolerance 1e-5") - 100.0_f64.cos()).abs();
        assert!(coarse > 1e-9 && coarse < 1e-2, "{coarse}");
    }
    // A state that is zero but for rounding is no reason to fail.
    let history = simulate("x'=-x\ny'=sin(pi)-y*0\n", "--duration 10 --points 3");
    close(list(&history, "states", "y")[2], 10.0 * std::f64::consts::PI.sin(), 1e-17);
}

#[test]
fn the_settings_of_the_model_hold_where_nothing_else_is_said() {
    let model = "x'=t\naux q=2*x\n@ t0=3,total=2\n";
    let history = simulate(model, "");
    let t = history["t"].as_array().unwrap();
    assert_eq!((t[0].as_f64(), t.last().unwrap().as_f64(), t.len()), (Some(3.0), Some(5.0), 1001));
    close(*list(&history, "states", "x").last().unwrap(), 8.0, 1e-12);
    close(*list(&history, "aux", "q").last().unwrap(), 16.0, 1e-12);
    let history = simulate(model, "--t0 0 --duration 1");
    close(*list(&history, "states", "x").last().unwrap(), 0.5, 1e-12);

    let model =
        "x'=x\ninit x=1\nset long {total=3,dt=.5}\n@ total=2,dt=.1,nout=2,trans=1,bound=5,toler=1e-5\ndone\n";
    let history = simulate(model, "");
    let (t, x) = (history["t"].as_array().unwrap(), list(&history, "states", "x"));
    // Samples from 1 on at every second step, up to the bound.
    assert_eq!((t[0].as_f64(), t.len()), (Some(1.0), 4));
    close(x[3], 1.6_f64.exp(), 1e-8);
    assert!(history["warnings"][0].as_str().unwrap().contains("bound 5"));
    let history = simulate(model, "--bound inf --transient 0 --points 5 --named-set long");
    close(*list(&history, "states", "x").last().unwrap(), 3.0_f64.exp(), 1e-8);
    assert_eq!(history["t"].as_array().unwrap().len(), 5);
    // A transient longer than what is asked for.
    close(list(&simulate(model, "--duration 0.5"), "states", "x")[0], 1.0, 0.0);

    let folder = Folder::with_text("model.ode", "x'=1\n");
    folder.fails("simulate model.ode --duration 1 --transient 2", 2, &["--transient 2", "less than 1"]);
    folder.fails("simulate model.ode --duration 1 --tolerance 0", 2, &["--tolerance 0", "from 1e-14"]);
    folder.fails("simulate model.ode --duration 1 --max-step 0", 2, &["--max-step"]);
    folder.fails("simulate model.ode --duration 1 --max-step -1", 2, &["--max-step", "positive"]);
    folder.fails("simulate model.ode --duration 1 --points -1", 2, &["--points", "-1"]);
    folder.fails(
        "simulate model.ode --duration 9 --transient 8 --bound 1",
        2,
        &["--bound 1", "before the first sample"],
    );
}

#[test]
fn auxiliary_quantities_are_columns() {
    let model = "x'=-x\ninit x=1\naux double=2*x\naux x=x^2\naux late=ln(t-1)\naux noise=ran(1)\n";
    let folder = Folder::with_text("model.ode", model);
    let table = folder.succeed("simulate model.ode --duration 2 --points 3 -o a.svg -o a.json");
    assert!(table.contains("double") && table.contains("aux_x"), "{table}");
    let csv = folder.succeed("simulate model.ode --duration 2 --points 3 -q --format csv");
    assert_eq!(csv.lines().next(), Some("t,x,double,aux_x,late"));
    assert_eq!(csv.lines().nth(1), Some("0.0,1.0,2.0,1.0,"));
    assert_eq!(csv.lines().nth(3).and_then(|line| line.rsplit(',').next()), Some("0.0"));
    // A result with something that has no value is read back.
    folder.succeed("simulate --from a.json:END --duration 1");
    let run = folder.run("simulate model.ode --duration 2 --points 3");
    assert!(run.messages.contains("late is not finite first at t = 0"), "{}", run.messages);
    assert!(run.messages.contains("`noise` is left out: random numbers"), "{}", run.messages);
}

#[test]
fn auxiliary_quantities_along_branches() {
    // Cycles of radius sqrt(m) round the origin.
    let model = "par m=-1\nx'=m*x-y-x*(x^2+y^2)\ny'=x+m*y-y*(x^2+y^2)\naux square=x^2+y^2+m\naux third=x^3\naux time=t\n";
    let folder = Folder::with_text("model.ode", model);
    folder.succeed("equilibria model.ode --along m=-1:1 --at 0.5 -q -o eq.json");
    let branch: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.0.path().join("eq.json")).unwrap()).unwrap();
    for point in branch["points"].as_array().unwrap() {
        close(point["aux"]["square"].as_f64().unwrap(), point["value"].as_f64().unwrap(), 1e-12);
        assert!(point["aux"]["time"].is_null());
    }
    let csv = folder.succeed("equilibria model.ode --along m=-1:1 -q --format csv");
    assert!(csv.starts_with("label,value,stable,x,y,square,third,"), "{csv}");
    let branch = folder.json("cycles --from eq.json:HB1 --along m=-1:1 --at 0.25 -q");
    for point in branch["points"].as_array().unwrap() {
        let value = point["value"].as_f64().unwrap();
        for kind in ["max", "min", "mean"] {
            close(point["aux"][kind]["square"].as_f64().unwrap(), 2.0 * value, 1e-8);
        }
        close(point["aux"]["max"]["third"].as_f64().unwrap(), value.max(0.0).powf(1.5), 1e-7);
        close(point["aux"]["mean"]["third"].as_f64().unwrap(), 0.0, 1e-7);
    }
    let csv = folder.succeed("cycles --from eq.json:HB1 --along m=-1:1 -q --format csv");
    assert!(csv.lines().next().unwrap().contains("max_square,min_square,mean_square,max_third"), "{csv}");
}

#[test]
fn models_are_read_as_xppaut_reads_them() {
    let e = (-1.0_f64).exp();
    for (model, right) in [
        ("x'=-x\ninit x=1\n% a remark\n", e),
        ("x[1...2]'=-x[j]\ninit x[1..2]=1\n", e),
        ("x'=-x/k\npar k=inf\ninit x=1\n", 1.0),
        ("2b=3\nx'=-2b*x\ninit x=1\n", e.powi(3)),
        ("x'=-x\ncircular structure\ninit x=1\n", e),
        ("x'=-a*x\npar a=2*3\ninit x=1\n", e.powi(6)),
        ("x'=-k*x\nparm k=2\nini x=1\n", e.powi(2)),
        ("# the \\tau of the model\npar k=2\nx'=-k*x\ninit x=1\n", e.powi(2)),
    ] {
        let history = simulate(model, "--duration 1 --points 3");
        let state = if model.starts_with("x[") { "x2" } else { "x" };
        close(list(&history, "states", state)[2], right, 1e-9);
    }
    let folder = Folder::with_text("model.ode", "x'=1\nboundry x-1\n");
    folder.fails(
        "simulate model.ode --duration 1",
        2,
        &["line 2, column 1", "boundary conditions", "remove the lines"],
    );
}

/// Right values: SciPy's `solve_ivp`, method Radau, relative tolerance 1e-13, absolute 1e-16; those of the linear model are 1.
#[test]
fn stiff_models_are_followed() {
    let oregonator =
        "x'=77.27*(y-x*y+x-8.375e-6*x*x)\ny'=(-y-x*y+z)/77.27\nz'=.161*(x-z)\ninit x=1,y=1,z=1\n";
    let linear = "par p=1,k=1e12\ninit x=3,y=1\nx'=k*(p-x)\ny'=x-y\n";
    let van_der_pol = "par mu=1e6\nx'=y\ny'=((1-x^2)*y-x)*mu\ninit x=2\n";
    for method in ["", "--method implicit"] {
        let end = |model: &str, duration: &str, state: &str| {
            let history = simulate(model, &format!("--duration {duration} --points 101 {method}"));
            *list(&history, "states", state).last().unwrap()
        };
        close(end(oregonator, "360", "y") / 742.867_093_089_627_8, 1.0, 1e-7);
        close(end(linear, "100", "y"), 1.0, 1e-9);
        close(end(van_der_pol, "2", "x"), 1.706_167_732_170_435_6, 1e-8);
    }
}

/// Problem E5 of Enright, Hull and Lindberg (1975): its states are decades smaller than the tolerance of a state of size 1, and below
/// zero they run away. By hand `y2 = y3 + y4`, and once y1 is spent `y2' = -m c y2^2`: its reciprocal grows by `m c` in a unit of time.
/// The largest y2 is about 1e-10, and what the tolerance leaves of that, 1e-20 at most, is a tenth of the last values.
#[test]
fn a_stiff_problem_of_chemistry_is_followed_to_its_end() {
    let history = simulate(
        "par a=7.89e-10,b=1.1e7,c=1.13e3,m=1e6\ny1'=-a*y1-b*y1*y3\ny2'=a*y1-m*c*y2*y3\n\
         y3'=a*y1-b*y1*y3-m*c*y2*y3+c*y4\ny4'=b*y1*y3-c*y4\ninit y1=1.76e-3\ndone\n",
        "--duration 1e11",
    );
    let times = history["t"].as_array().unwrap();
    let last = times.len() - 1;
    let middle = times.iter().position(|time| time.as_f64().unwrap() >= 6e10).unwrap();
    let at = |name: &str, index: usize| list(&history, "states", name)[index];
    let passed = times[last].as_f64().unwrap() - times[middle].as_f64().unwrap();
    let grown = 1.0 / at("y2", last) - 1.0 / at("y2", middle);
    assert!((grown / (1.13e9 * passed) - 1.0).abs() < 0.2, "{grown}");
    for index in [middle, last] {
        let excess = at("y2", index) - at("y3", index) - at("y4", index);
        assert!(excess.abs() < 1e-20, "{excess}");
    }
}

/// Growth from next to nothing depends on the size of the state alone, and one that cannot pass zero never does.
#[test]
fn small_states_that_grow_keep_their_digits() {
    for start in [1e-9, 1e-15, 1e-30] {
        let history =
            simulate("x'=x*(1-x)\ndone\n", &format!("--start x={start:e} --duration 100 --points 51"));
        let times = history["t"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap());
        for (time, value) in times.zip(list(&history, "states", "x")) {
            let right = 1.0 / (1.0 + (1.0 / start - 1.0) * (-time).exp());
            close(value / right, 1.0, 1e-8);
        }
    }
    // Predators and prey that come as near to zero as 4e-38.
    let model = "x'=x*(1-x/8)-x*y/(.3+x)\ny'=y*(x/(.3+x)-.3)\ninit x=.5,y=.5\ndone\n";
    let history = simulate(model, "--duration 400");
    assert!(list(&history, "states", "x").iter().all(|value| *value > 0.0));
}

/// Exposed and infected that are few grow together, `e' = .5 i - .3 e`, `i' = .3 e - .2 i`, while nearly all are susceptible.
#[test]
fn small_states_that_grow_together_keep_their_digits() {
    let model = "s'=-.5*s*i\ne'=.5*s*i-.3*e\ni'=.3*e-.2*i\ninit s=1,e=0,i=1e-14\ndone\n";
    let history = simulate(model, "--duration 40 --points 2");
    let [sum, product]: [f64; 2] = [-0.5, 0.3 * 0.2 - 0.3 * 0.5];
    let root = (0.25 * sum * sum - product).sqrt();
    let [fast, slow] = [0.5 * sum + root, 0.5 * sum - root];
    // From the start (0, 1) the infected have the rate -.2.
    let weight = (-0.2 - slow) / (fast - slow);
    let right = 1e-14 * (weight * (fast * 40.0).exp() + (1.0 - weight) * (slow * 40.0).exp());
    close(list(&history, "states", "i")[1] / right, 1.0, 1e-8);
}
