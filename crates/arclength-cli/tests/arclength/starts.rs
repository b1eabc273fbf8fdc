//! Starts that were refused once, and equilibria and families that were taken for something else.

use crate::found_by_users::{folder, number, points};
use crate::labelled;

fn states(model: &str, along: &str, rest: &str) -> serde_json::Value {
    folder(model).json(&format!("equilibria model.ode --along {along} {rest}"))
}

/// The points of one kind.
fn of_kind<'a>(result: &'a serde_json::Value, kind: &'a str) -> impl Iterator<Item = &'a serde_json::Value> {
    points(result)
        .iter()
        .filter(move |point| point["label"].as_str().is_some_and(|label| label.starts_with(kind)))
}

#[test]
fn a_stiff_equilibrium_is_no_branch_point() {
    let stiff = "par p=1,k=1e9\ninit x=1,y=1\nx'=k*(p-x)\ny'=x-y\ndone\n";
    for k in ["2e8", "1e9", "1e12"] {
        let found = states(stiff, "p=0.5:2", &format!("-s k={k}"));
        assert!(points(&found).iter().all(|point| point["stable"] == true), "k = {k}");
    }
}

/// A state that is zero all along the branch, driven by a product with the residual of another equation, has no size of its own.
#[test]
fn states_that_are_zero_but_for_rounding_are_no_degeneracy() {
    for (f, starts) in
        [("mu+x^2", ["x=-.5,z=0", "x=-.547723,z=1e-7"]), ("mu-x-x^3", ["x=-.3,z=0", "x=0,z=0"])]
    {
        let model = format!("par mu=-0.3\ninit x=0,z=0\nf={f}\nx'=f\nz'=-13*z+0.6*x*f\ndone\n");
        for start in starts {
            let found = states(&model, "mu=-1:1", &format!("--start {start}"));
            let folds: Vec<f64> = of_kind(&found, "LP").map(|point| number(&point["value"])).collect();
            assert_eq!(folds.len(), usize::from(f == "mu+x^2"), "{found}");
        }
    }
    // Linear in a state that starts at rest: no line of equilibria.
    let line = "par mu=0\ninit x=.001,y=0\nx'=mu-(x/10000+4*x/(1+x^2))\ny'=x-y\ndone\n";
    let found = states(line, "mu=-3:3", "");
    assert_eq!(of_kind(&found, "LP").count(), 4, "{found}");
}

/// Far from the start on one side, the other side is followed with the sizes of the start; and a branch that comes back from far away
/// finds what it would find else.
#[test]
fn large_states_do_not_coarsen_what_is_small() {
    let saturated = "par mu=0.1\ninit x=.02\nx'=mu-4*x/(1+x^2)\ndone\n";
    let found = states(saturated, "mu=-3:3", "");
    let folds: Vec<f64> = of_kind(&found, "LP").map(|point| number(&point["value"])).collect();
    assert!(folds.len() == 2 && (folds[0] + 2.0).abs() < 1e-9 && (folds[1] - 2.0).abs() < 1e-9, "{folds:?}");
    assert_eq!(of_kind(&found, "BP").count(), 0);
    let wavy = "par mu=0.0\ninit x=.5,y=.5\ns=(1-x/sqrt(1+x^2))/2\n\
                x'=mu-((x+sqrt(x^2+1))/1000+(sin(x)+x/40)*s)\ny'=-y+x\ndone\n";
    let found = states(wavy, "mu=-2:2", "");
    assert_eq!((of_kind(&found, "LP").count(), of_kind(&found, "BP").count()), (18, 0), "{found}");
    // Every point is an equilibrium.
    for point in found["points"].as_array().unwrap() {
        let [mu, x] = [number(&point["value"]), number(&point["state"]["x"])];
        let s = 0.5 * (1.0 - x / (1.0 + x * x).sqrt());
        let residual = mu - ((x + (x * x + 1.0).sqrt()) / 1000.0 + (x.sin() + x / 40.0) * s);
        assert!(residual.abs() < 1e-8, "{point}: {residual}");
    }
}

/// Each group of equations has its own time scale, and no other's.
#[test]
fn a_slow_state_beside_a_fast_one_has_its_fold() {
    for (slow, fast) in [(1e-6, "-z"), (1e-10, "1-z"), (1e-8, "x-z")] {
        let model = format!("par p=1\nx'={slow}*(p-x^2)\nz'={fast}\ninit x=1,z=1\ndone\n");
        let found = states(&model, "p=-2:2", "");
        let folds: Vec<f64> = of_kind(&found, "LP").map(|point| number(&point["value"])).collect();
        assert!(folds.len() == 1 && folds[0].abs() < 1e-12 && of_kind(&found, "BP").count() == 0, "{found}");
    }
    let isola = "par p=0.2\nx'=1-p*p-((x-5e6)/5e6)^2\ny'=-y+(x-5e6)*p\ninit x=9.9e6,y=9.8e5\ndone\n";
    let found = states(isola, "p=-2:2", "");
    assert_eq!((of_kind(&found, "LP").count(), of_kind(&found, "BP").count()), (2, 0), "{found}");
}

/// A value that is asked for may be that of a fold or a branch point.
#[test]
fn values_of_special_points_may_be_asked_for() {
    for (field, start, label) in [("p-x^2", "1", "LP1"), ("p*x-x^2", "0", "BP1"), ("p*x-x^3", "0", "BP1")] {
        let p = if label == "LP1" { 1 } else { -1 };
        let model = format!("par p={p}\nx'={field}\ninit x={start}\ndone\n");
        let found = states(&model, "p=-1:1", "--at 0");
        assert!(number(&labelled(&found, label)["value"]).abs() < 1e-12, "{found}");
        assert_eq!(labelled(&found, "EP2")["value"], 1.0);
    }
}

#[test]
fn fields_whose_derivatives_overflow_have_equilibria() {
    let step = "par p=1\ninit x=1,y=0\nx'=p-x\ny'=-y+1/(1+exp((x+60)/.05))\ndone\n";
    assert!(points(&states(step, "p=0:2", "")).iter().all(|point| point["stable"] == true));
    let power = "par n=2,p=.2\ninit x=.2,y=0\nx'=-x+p\ny'=-y+y^n/(1+y^n)\ndone\n";
    assert!(points(&states(power, "n=1.2:3", "")).iter().all(|point| point["stable"] == true));
}

#[test]
fn conserved_totals_are_named_and_kept() {
    let enzyme = "par k1=1,k2=1,k3=1,k4=0.5\ninit e=1,s=1,c=0,p=0\ne'=-k1*e*s+(k2+k3)*c\ns'=-k1*e*s+k2*c+k4*p\n\
                  c'=k1*e*s-(k2+k3)*c\np'=k3*c-k4*p\ndone\n";
    let found = states(enzyme, "k1=0.1:10", "--at 1");
    let totals: Vec<&str> =
        found["conserved"].as_array().unwrap().iter().map(|kept| kept["total"].as_str().unwrap()).collect();
    assert_eq!(totals, ["e + c", "s + c + p"]);
    let at = &labelled(&found, "AT1")["state"];
    let [e, s, c, p] = ["e", "s", "c", "p"].map(|name| number(&at[name]));
    assert!((e + c - 1.0).abs() < 1e-12 && (s + c + p - 1.0).abs() < 1e-12);
    assert!((e * s - 2.0 * c).abs() < 1e-12);
    assert_eq!(labelled(&found, "AT1")["stable"], true);
}

#[test]
fn the_flow_leads_to_an_equilibrium_that_newtons_method_misses() {
    let morris_lecar = "par i=80\nminf(v)=.5*(1+tanh((v+1.2)/18))\nwinf(v)=.5*(1+tanh((v-12)/17.4))\n\
                        v'=(i-2*(v+60)-8*w*(v+84)-4*minf(v)*(v-120))/20\n\
                        w'=.0666666667*cosh((v-12)/34.8)*(winf(v)-w)\ninit v=-24.22, w=.305\ndone\n";
    let found = states(morris_lecar, "i=0:200", "");
    assert!(found["from"]["how"].as_str().unwrap().contains("flow"), "{}", found["from"]);
    assert!((number(&labelled(&found, "HB1")["value"]) - 97.787888949).abs() < 1e-6);
}

#[test]
fn the_first_equilibrium_is_sought_inside_the_interval() {
    // There is none at p = -1, where the flow leads to infinity.
    let found = states("par p=-1\ninit x=1\nx'=p-x^2\ndone\n", "p=0.5:2", "");
    assert_eq!(found["from"]["how"], "the equilibrium near the initial state");
    assert!((number(&labelled(&found, "EP1")["state"]["x"]) - 0.5_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn the_time_can_be_frozen() {
    let forced = "par a=1,w=2\nx'=a-x+cos(w*t)\ndone\n";
    let folder = folder(forced);
    let refused = folder.run("equilibria model.ode --along a=0:2");
    assert!(refused.exit_code == 2 && refused.messages.contains("--freeze t=0"), "{}", refused.messages);
    folder.succeed("equilibria model.ode --along a=0:2 --freeze t=0 --at 1 -q -o frozen.json");
    let frozen = folder.json("equilibria --from frozen.json:AT1 --along a=0:2");
    // The frozen time is kept with the model: x = a + cos(0).
    assert!((number(&labelled(&frozen, "EP2")["state"]["x"]) - 3.0).abs() < 1e-12);
    let wrong = folder.run("equilibria model.ode --along a=0:2 --freeze a=0");
    assert!(wrong.exit_code == 2 && wrong.messages.contains("t=VALUE"), "{}", wrong.messages);
}

#[test]
fn a_quotient_that_is_no_singularity_has_no_folds() {
    let found = states("par p=0.5\ninit x=-1\nx'=p-x/(1-exp(-x))\ndone\n", "p=0.5:2", "-s p=1 --at 1");
    assert!(points(&found).iter().all(|point| {
        point["label"].as_str().is_none_or(|label| label.starts_with("EP") || label.starts_with("AT"))
    }));
    // x/(1 - exp(-x)) = 1 at x = 0, with slope 1/2.
    let at = labelled(&found, "AT1");
    assert!(number(&at["state"]["x"]).abs() < 1e-14);
    assert!((number(&at["eigenvalues"][0][0]) + 0.5).abs() < 1e-13);
}

#[test]
fn a_relaxation_oscillation_is_a_start() {
    let folder = folder("par mu=1\ninit x=2,y=0\nx'=y\ny'=mu*(1-x^2)*y-x\ndone\n");
    // Periods by SciPy's Radau method with tolerances of 1e-11.
    for (mu, period) in [(20.0, 34.682323311652), (50.0, 82.508333893232)] {
        folder.succeed(&format!("simulate model.ode -s mu={mu} --duration 1000 -q -o history.json"));
        let found = folder.json(&format!("cycles --from history.json:END --along mu=10:60 --at {mu}"));
        let error = (number(&labelled(&found, "AT1")["period"]) / period - 1.0).abs();
        assert!(error < 1e-9, "mu = {mu}: {error:e}");
        assert!(points(&found).iter().all(|point| point["stable"] == true));
    }
}

#[test]
fn a_conserved_quantity_makes_a_neutral_family() {
    let folder = folder("par L=0.1\ninit x=1,y=1\nx'=x*(1-y)-L*x*(x-1)\ny'=y*(x-1)\ndone\n");
    folder.succeed("equilibria model.ode --along L=-1:1 -q -o equilibria.json");
    let found = folder.json("cycles --from equilibria.json:HB1 --along L=-1:1 --steps 15");
    let cycles = points(&found);
    assert!(cycles.iter().all(|cycle| cycle["neutral"] == true && cycle["stable"].is_null()));
    assert!(cycles.iter().all(|cycle| number(&cycle["value"]).abs() < 1e-9));
    // Lotka and Volterra's invariant x + y - ln(x y) is the same at the largest and the smallest x, where y = 1.
    for cycle in cycles {
        let [largest, smallest] = ["max", "min"].map(|end| number(&cycle[end]["x"]));
        let [one, other] = [largest, smallest].map(|x| x - x.ln());
        assert!((one - other).abs() < 1e-6 * one, "{largest} {smallest}");
    }
}

#[test]
fn a_branch_that_stands_still_at_one_value_of_the_parameter_is_left_at_equilibria() {
    // Where a = 0 every x is an equilibrium; elsewhere 0, 1 and -1 are.
    let folder = folder("par a=-1, k=2\nx'=a*(y+x-x^3)\ny'=-k*y\ninit x=0,y=0\ndone\n");
    folder.succeed("equilibria model.ode --along a=-1:1 -q -o first.json");
    let vertical = folder.json("equilibria --from first.json:BP1 --along a=-1:1 -o vertical.json");
    assert!(vertical["conserved"].as_array().is_none_or(Vec::is_empty));
    for point in points(&vertical) {
        assert!(number(&point["value"]).abs() < 1e-12, "{}", point["value"]);
    }
    let crossings: Vec<f64> = points(&vertical)
        .iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("BP")))
        .map(|point| number(&point["state"]["x"]))
        .collect();
    assert!(crossings.iter().any(|x| (x - 1.0).abs() < 1e-9), "{crossings:?}");
    assert!(crossings.iter().any(|x| (x + 1.0).abs() < 1e-9), "{crossings:?}");
}

#[test]
fn cycles_start_at_a_hopf_point_at_the_end_of_the_interval_but_for_rounding() {
    // The Hopf point at l = 0 is located next to it, on either side; l1 and the cycles in closed form.
    let folder =
        folder("par l=.5,w=1\nr=sqrt(x^2+y^2)\nx'=x*(l-r^2)-w*y\ny'=y*(l-r^2)+w*x\ninit x=.2,y=.1\ndone\n");
    let equilibria = folder.json("equilibria model.ode --along l=-1:1 -o equilibria.json");
    let hopf = points(&equilibria).iter().find(|point| point["label"] == "HB1").unwrap();
    let place = number(&hopf["value"]);
    assert!(place.abs() < 1e-12, "{place}");
    for low in [0.0, place + 1e-11] {
        let cycles = folder.json(&format!("cycles --from equilibria.json:HB1 --along l={low:e}:1 --at 0.25"));
        let asked = points(&cycles).iter().find(|point| number(&point["value"]) == 0.25).unwrap();
        assert!((number(&asked["max"]["x"]) - 0.5).abs() < 1e-9);
    }
    folder.fails("cycles --from equilibria.json:HB1 --along l=0.1:1", 2, &["HB1 is outside the interval"]);
}

#[test]
fn newtons_method_does_not_end_where_a_root_has_no_derivatives() {
    // Prey in herds: from these starts Newton's method goes to (0, 0), where the root of x has none. By hand x = (d/a)^(1/e) and
    // y = x (1 - x)/x^e, of the exponents 1/2 and 3/4.
    for (law, exponent) in [("sqrt(x)", 0.5_f64), ("x^.75", 0.75), ("exp(.5*ln(x))", 0.5)] {
        let folder =
            folder(&format!("par d=.3\nu={law}\nx'=x*(1-x)-u*y\ny'=u*y-d*y\ninit x=.3,y=.3\ndone\n"));
        let equilibria = folder.json("equilibria model.ode --along d=0.1:0.9 --at 0.5");
        let point = points(&equilibria).iter().find(|point| number(&point["value"]) == 0.5).unwrap();
        let x = 0.5_f64.powf(1.0 / exponent);
        let y = x * (1.0 - x) / x.powf(exponent);
        let found = [number(&point["state"]["x"]), number(&point["state"]["y"])];
        assert!((found[0] - x).abs() < 1e-10 && (found[1] - y).abs() < 1e-10, "{law}: {found:?}");
    }
}

#[test]
fn a_field_that_is_linear_at_its_hopf_point_has_the_first_lyapunov_coefficient_zero() {
    // At mu = 0 all second and third derivatives vanish, by hand.
    for field in ["mu*(1-x^2)*y-x", "mu*y-x+mu*x^2", "mu*y-x+mu*x*y-mu^3*y^3"] {
        let folder = folder(&format!("par mu=-.1\nx'=y\ny'={field}\ninit x=0,y=0\ndone\n"));
        let equilibria = folder.json("equilibria model.ode --along mu=-1:1");
        let hopf = points(&equilibria).iter().find(|point| point["label"] == "HB1").unwrap();
        let form = &hopf["special"];
        let [value, error] = ["first_lyapunov", "first_lyapunov_error"].map(|name| number(&form[name]));
        assert!(value.abs() <= error && error < 1e-12, "{field}: {form}");
        assert_eq!(form["criticality"], "degenerate", "{field}");
    }
}

#[test]
fn where_several_pairs_cross_at_once_an_equilibrium_is_not_called_stable() {
    // Two uncoupled neurons: by hand v^2 = 1 - 0.064 at their Hopf points, and two pairs are on the axis there.
    let folder = folder(
        "par i=.2\nv'=v-v^3/3-w+i\nw'=.08*(v+.7-.8*w)\nx'=x-x^3/3-y+i\ny'=.08*(x+.7-.8*y)\n\
         init v=-1,w=-.4,x=-1,y=-.4\ndone\n",
    );
    let equilibria = folder.json("equilibria model.ode --along i=0:2");
    let hopf: Vec<_> = points(&equilibria)
        .iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("HB")))
        .collect();
    assert_eq!(hopf.len(), 2);
    for point in hopf {
        assert!((number(&point["state"]["v"]).abs() - 0.936_f64.sqrt()).abs() < 1e-10);
        assert!(point["stable"].is_null(), "{}", point["stable"]);
    }
}
