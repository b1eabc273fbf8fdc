//! Claims that a second computation has to confirm: models on which the cycle was resolved and what was said of it was not.

use crate::found_by_users::{folder, number, points};
use crate::{Folder, labelled};

/// A slow cycle beside a fast rotation whose amplitude grows. |mu| = exp(a T - integral of v^2 d) = 137.0 at i = 0.5.
const RINGING: &str = "\
# slow relaxation cycle (v, w) and a fast rotation (p, q) that it drives weakly; p and q grow at the rate g
par i=-0.5, a=0.25, b=1, f=300, c=0.1
vd = v - v^3/3 - w + i
g = a - b*vd^2
v' = vd
w' = 0.08*(v + 0.7 - 0.8*w)
p' = g*p + f*q + c*v
q' = -f*p + g*q
init v=-1.2, w=-0.6
done
";

/// Predator and prey: the flow depends on the logarithms of states that nearly vanish.
const PREDATOR: &str = "\
# predator and prey with a saturating response; for large k the prey nearly dies out between outbreaks
par k=0.3
x' = x*(1 - x/k) - 5*x*y/(1 + 4*x)
y' = 5*x*y/(1 + 4*x) - 0.3*y
init x=0.1, y=0.2
done
";

/// A van der Pol oscillator with the explosion of a canard.
const CANARD: &str = "\
# van der Pol with constant drive: canards near a=1
par a=1.1,eps=0.01
init x=1.1,y=-0.66
x'=(y-x^3/3+x)/eps
y'=a-x
done
";

/// Morris and Lecar's neuron.
const NEURON: &str = "\
# Morris-Lecar, published parameter values
par iapp=6
gl=.15
gca=.3
gk=.6
minf(v)=.5*(1+tanh((v-1)/14.5))
winf(v)=.5*(1+tanh((v-4)/15))
v'=-gl*(v+50)-gk*w*(v+70)-gca*minf(v)*(v-100)+iapp
w'=(winf(v)-w)/100
init v=-50
done
";

/// A Hopf point in units in which the cycles have radii of hundreds.
const LARGE_UNITS: &str = "\
par m=-.3
x'=m*x-.8*y/1000-x*(x^2+(y/1000)^2)/1e6
y'=1000*.8*x+m*y-y*(x^2+(y/1000)^2)/1e6
init x=0,y=0
done
";

/// Van der Pol's oscillator with a constant.
const CONSTANT: &str = "\
par mu=1.4
x'=y
y'=mu*(1-x^2)*y-x-.15
init x=2,y=0
done
";

/// A slow cycle of radius sqrt(mu) beside a fast linear oscillator that it does not touch.
const BESIDE: &str = "\
par mu=-0.5, w=20, s=0.01
r2 = x^2 + y^2
x' = mu*x - y - x*r2
y' = x + mu*y - y*r2
u' = s*u + w*v
v' = -w*u + s*v
done
";

fn cycles(folder: &Folder, along: &str, start: &str, rest: &str) -> serde_json::Value {
    folder.succeed(&format!("equilibria model.ode --along {along} -q -o equilibria.json"));
    folder.json(&format!("cycles --from equilibria.json:{start} --along {along} {rest}"))
}

fn labels(result: &serde_json::Value) -> Vec<&str> {
    points(result).iter().filter_map(|point| point["label"].as_str()).collect()
}

#[test]
fn the_mesh_resolves_the_variational_equation_too() {
    let found = cycles(&folder(RINGING), "i=-0.5:2", "HB1", "--at 0.5");
    let cycle = labelled(&found, "AT1");
    assert_eq!(cycle["stable"], false);
    let largest = &cycle["multipliers"][0];
    let modulus = number(&largest[0]).hypot(number(&largest[1]));
    // Nineteen hundred turns in one period, by a mesh or by exponentials. The logarithm is a T less the integral of vd^2, both integrated
    // to a unit of their last digit.
    let truth = 0.25 * 39.474415 - 4.948608;
    let (error, told) = ((modulus.ln() - truth).abs(), number(&cycle["multiplier_errors"][0]));
    assert!(error < 0.02 && error < told + 2e-6, "{modulus} {told}");
    let mut regular = points(&found).iter().filter(|cycle| !cycle["label"].to_string().contains("LPC"));
    assert!(regular.all(|cycle| cycle["stable"] == false));
    // There are no torus bifurcations.
    assert!(!found["unlocated"].to_string().contains("torus"), "{}", found["unlocated"]);
    assert!(labels(&found).iter().all(|label| !label.starts_with("NS")), "{:?}", labels(&found));
}

/// Periods from integrations of the logarithms.
#[test]
fn states_that_nearly_vanish() {
    let found = cycles(&folder(PREDATOR), "k=0.2:2.4", "HB1", "--at 1.6,2,2.4");
    for (label, period) in [("AT1", 42.15381695), ("AT2", 51.58411507), ("AT3", 61.08542959)] {
        let cycle = labelled(&found, label);
        let error = (number(&cycle["period"]) / period - 1.0).abs();
        let allowed = (3.0 * number(&cycle["error_estimate"])).max(1e-9);
        assert!(error < allowed, "{label}: {error:e}, {allowed:e}");
        assert!(number(&cycle["min"]["x"]) > 0.0);
    }
}

#[test]
fn the_explosion_of_a_canard_is_no_homoclinic_orbit() {
    let found = cycles(&folder(CANARD), "a=0.5:1.5", "HB1", "--at 0.99 --steps 2000");
    assert!(labels(&found).iter().all(|label| !label.starts_with("LPC")), "{:?}", labels(&found));
    let relaxation = labelled(&found, "AT1");
    assert!((number(&relaxation["period"]) - 3.4087).abs() < 1e-4);
    assert!(points(&found).iter().all(|point| point["stable"] != false));
    assert!(found["ends"][1]["cause"].as_str().unwrap().contains("end of the interval"));
}

#[test]
fn the_first_cycle_is_what_the_hopf_point_says() {
    let found = cycles(&folder(NEURON), "iapp=-5:40", "HB2", "");
    assert_eq!(points(&found)[0]["stable"], false);
    let fold = labelled(&found, "LPC1");
    assert!((number(&fold["value"]) - 18.294940373).abs() < 1e-7, "{}", fold["value"]);
}

#[test]
fn a_small_first_cycle_is_no_equilibrium() {
    let found = cycles(&folder(LARGE_UNITS), "m=-.5:.2", "HB1", "--at .01,.1");
    for (label, radius) in [("AT1", 100.0), ("AT2", 100_000_f64.sqrt())] {
        assert!((number(&labelled(&found, label)["max"]["x"]) / radius - 1.0).abs() < 1e-8);
    }
}

#[test]
fn the_same_mesh_is_not_the_same_error() {
    let folder = folder(CONSTANT);
    folder.succeed("simulate model.ode --duration 100 -q -o motion.json");
    let found = folder.json("cycles --from motion.json:END --along mu=.2:10 --at .3,.4,.5");
    let cycle = labelled(&found, "AT2");
    let error = (number(&cycle["min"]["y"]) + 2.2665403058).abs() / 4.3;
    assert!(error < (3.0 * number(&cycle["error_estimate"])).max(1e-9), "{error:e}");
}

/// What rounding leaves of the states of the fast oscillator is no size for the steps.
#[test]
fn states_that_stay_zero_do_not_stop_the_branch() {
    for fast in ["-s w=0.3 -s s=0.01", "-s w=10.3 -s s=-0.01", "-s w=20.3 -s s=-0.1"] {
        let folder = folder(BESIDE);
        folder.succeed(&format!("equilibria model.ode {fast} --along mu=-0.5:1 -q -o equilibria.json"));
        let found = folder.json("cycles --from equilibria.json:HB1 --along mu=-0.5:1 --at 0.25");
        assert!(found["ends"][1]["cause"].as_str().unwrap().contains("end of the interval"), "{fast}");
        assert!((number(&labelled(&found, "AT1")["max"]["x"]) - 0.5).abs() < 1e-9);
    }
}
