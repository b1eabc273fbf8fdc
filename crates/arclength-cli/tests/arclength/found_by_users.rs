//! Models on which the program went wrong once: each test is the case as it was met.

use crate::{Folder, labelled};
use serde_json::Value;

/// A food chain. With `u2 = p3/p5 = 1/6` the top species may live, and then `u1 = 1 - p4/6 = 1/3`.
const FOOD_CHAIN: &str = "par p1=0,p2=.25,p3=.5,p4=4,p5=3,p6=5
u1'=u1*(1-u1)-p4*u1*u2
u2'=-p2*u2+p4*u1*u2-p5*u2*u3-p1*(1-exp(-p6*u2))
u3'=-p3*u3+p5*u2*u3
init u1=1 u2=0 u3=0
done
";

/// The circuit of Freire and others (1993), AUTO's `tor`, with an asymmetry.
const TORUS_CIRCUIT: &str = "\
par nu=-0.9,gamma=-0.6,r=0.6,a3=0.328578,b3=0.933578,beta=0.5,e=0
x'=(-(beta+nu)*x+beta*y-a3*x^3+b3*(y-x)^3)/r
y'=beta*x-(beta+gamma)*y-z-b3*(y-x)^3+e*x^2
z'=y
done
";

/// A circle of cycles over p; the third state vanishes at p = 0.
const ISOLA: &str = "\
par p=0,w=1,k=.4
rr=sqrt(x^2+y^2)
g=1-p^2-(rr-2)^2
x'=x*g-w*y*(1+.2*p)+.1*z*x
y'=y*g+w*x*(1+.2*p)+.1*z*y
z'=-z+k*p*x
init x=3,y=0,z=0
done
";

/// Two coupled cells with substrate inhibition.
const TWO_CELLS: &str = "par s0=0,mu=0,rho=100,kappa=1
f(s)=s/(1+s+kappa*s^2)
s1'=(s0-s1)+(s2-s1)-rho*f(s1)
s2'=(s0+mu-s2)+(s1-s2)-rho*f(s2)
done
";

/// The Oregonator with three variables.
const OREGONATOR: &str = "par f=1,q=.002,eps=.04,epsp=.0004
x'=(q*y-x*y+x*(1-x))/eps
y'=(-q*y-x*y+f*z)/epsp
z'=x-z
init x=.1,y=.1,z=.1
done
";

/// Two van der Pol oscillators that repel each other.
const TWO_OSCILLATORS: &str = "par k=.2, mu=.5, d=.1
x'=y
y'=mu*(1-x^2)*y-x+k*(u-x)+d*(v-y)
u'=v
v'=mu*(1-u^2)*v-u+k*(x-u)+d*(y-v)
init x=2,y=0,u=2,v=0
done
";

/// The neuron of Hindmarsh and Rose.
const SPIKING_NEURON: &str = "par I=3.6
x'=y-x^3+3*x^2-z+I
y'=1-5*x^2-y
z'=.005*(4*(x+1.6)-z)
init x=-1.6,y=-12,z=0
done
";

/// A cycle with two planes across it, which lose their stability at `mu = 0` and `mu = g`.
const TWO_TORI: &str = "par mu=-1,g=.005
a'=a-b-a*(a^2+b^2)
b'=a+b-b*(a^2+b^2)
x'=mu*x-.37*y-x*(x^2+y^2)
y'=mu*y+.37*x-y*(x^2+y^2)
u'=(mu-g)*u-.21*v-u*(u^2+v^2)
v'=(mu-g)*v+.21*u-v*(u^2+v^2)
init a=1
done
";

/// The nerve of Hodgkin and Huxley.
const NERVE: &str = "par iapp=0,gna=120,gk=36,gl=.3,vna=50,vk=-77,vl=-54.4,phi=1
exprel(x,y)=if(abs(x/y)<1e-6)then(y*(1+x/y/2))else(x/(1-exp(-x/y)))
am(v)=.1*exprel(v+40,10)
bm(v)=4*exp(-(v+65)/18)
ah(v)=.07*exp(-(v+65)/20)
bh(v)=1/(1+exp(-(v+35)/10))
an(v)=.01*exprel(v+55,10)
bn(v)=.125*exp(-(v+65)/80)
ina(v,m,h)=gna*m^3*h*(v-vna)
ik(v,n)=gk*n^4*(v-vk)
v'=iapp-ina(v,m,h)-ik(v,n)-gl*(v-vl)
m'=phi*(am(v)*(1-m)-bm(v)*m)
h'=phi*(ah(v)*(1-h)-bh(v)*h)
n'=phi*(an(v)*(1-n)-bn(v)*n)
aux i_na=ina(v,m,h)
init v=-65,m=.052,h=.596,n=.317
@ total=100,dt=.05,xhi=100,ylo=-90,yhi=50,bound=1000
done
";

/// Three equal cells that inhibit each other.
const THREE_CELLS: &str = "par i=0.5,g=0.05,ep=0.2
s(v)=1/(1+exp(-5*v))
v1'=v1-v1^3/3-w1+i-g*(s(v2)+s(v3))
w1'=ep*(v1+0.7-0.8*w1)
v2'=v2-v2^3/3-w2+i-g*(s(v1)+s(v3))
w2'=ep*(v2+0.7-0.8*w2)
v3'=v3-v3^3/3-w3+i-g*(s(v1)+s(v2))
w3'=ep*(v3+0.7-0.8*w3)
init v1=-1,w1=-0.5,v2=-1,w2=-0.5,v3=-1,w3=-0.5
done
";

pub(crate) fn folder(text: &str) -> Folder {
    let folder = Folder::with("lure.ode");
    std::fs::write(folder.0.path().join("model.ode"), text).unwrap();
    folder
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

pub(crate) fn points(result: &Value) -> &[Value] {
    result["points"].as_array().unwrap()
}

#[test]
fn an_almost_extinct_species_does_not_spoil_the_branch_point() {
    let folder = folder(FOOD_CHAIN);
    folder.succeed("equilibria model.ode --along p1=0:2 -q -o first.json");
    folder.succeed("equilibria --from first.json:BP1 --along p1=0:2 -q -o second.json");
    let third = folder.json("equilibria --from second.json:BP1 --along p1=0:2");
    assert!(points(&third).iter().all(|point| (number(&point["state"]["u1"]) - 1.0 / 3.0).abs() < 1e-9));
    // Where the eigenvalues that NumPy finds there cross the axis.
    assert!((number(&labelled(&third, "HB1")["value"]) - 0.229356976992).abs() < 1e-11);
}

#[test]
fn cycles_leave_a_branch_point_into_the_plane_without_the_third_species() {
    let folder = folder(FOOD_CHAIN);
    folder.succeed("equilibria model.ode -s p1=.2 --start u1=.33,u2=.17,u3=.2 --along p1=0:2 -q -o eq.json");
    folder.succeed("cycles --from eq.json:HB1 --along p1=0:1 -q -o po.json");
    let other = folder.json("cycles --from po.json:BPC1 --along p1=0:1");
    assert!(points(&other).len() > 5);
    assert!(points(&other).iter().all(|point| number(&point["max"]["u3"]).abs() < 1e-12));
    // There and back, and on along the branch on which the point was found.
    folder.succeed("cycles --from po.json:BPC1 --along p1=0:1 -q -o other.json");
    let back = folder.json("cycles --from other.json:BPC1 --along p1=0:1 -q");
    let stay = folder.json("cycles --from po.json:BPC1 --stay --along p1=0:1 -q");
    for branch in [&back, &stay] {
        assert_eq!(labels(branch).iter().filter(|label| label.starts_with("BPC")).count(), 1);
        assert!(points(branch).iter().any(|point| number(&point["max"]["u3"]) > 0.01));
    }
    assert!(
        (number(&labelled(&back, "BPC1")["value"]) - number(&labelled(&stay, "BPC1")["value"])).abs() < 1e-10
    );
}

#[test]
fn a_closed_branch_through_pitchforks_ends_after_one_lap() {
    let folder = folder(TWO_CELLS);
    folder.succeed("equilibria model.ode --along s0=0:70 -q -o eq.json");
    let lap = folder.json("equilibria --from eq.json:BP1 --along s0=0:70");
    let labels: Vec<&str> = points(&lap).iter().filter_map(|point| point["label"].as_str()).collect();
    let of = |kind: &str| labels.iter().filter(|label| label.starts_with(kind)).count();
    assert_eq!((of("BP"), of("LP")), (2, 4), "{labels:?}");
    assert!(lap["ends"][1]["cause"].as_str().unwrap().contains("closed"));
}

fn labels(result: &Value) -> Vec<&str> {
    points(result).iter().filter_map(|point| point["label"].as_str()).collect()
}

#[test]
fn cells_that_differ_a_little_have_no_branch_points() {
    let folder = folder(TWO_CELLS);
    for difference in ["1e-5", "1e-7", "1e-9"] {
        let branch = folder.json(&format!("equilibria model.ode -s mu={difference} --along s0=0:200"));
        let labels = labels(&branch);
        let of = |kind: &str| labels.iter().filter(|label| label.starts_with(kind)).count();
        assert_eq!((of("BP"), of("LP")), (0, 4), "{difference}: {labels:?}");
        assert_eq!(number(&points(&branch)[points(&branch).len() - 1]["value"]), 200.0);
    }
}

#[test]
fn a_circuit_that_is_nearly_symmetric_has_no_branch_point_of_cycles() {
    let folder = folder(TORUS_CIRCUIT);
    for asymmetry in ["0.1", "1e-3", "1e-5"] {
        folder.succeed(&format!("equilibria model.ode --along nu=-.9:-.2 -s e={asymmetry} -q -o eq.json"));
        let branch = folder.json("cycles --from eq.json:HB1 --along nu=-.65:-.5 -q");
        assert_eq!(labels(&branch), ["EP1", "LPC1", "NS1", "PD1", "EP2"], "{asymmetry}");
    }
    folder.succeed("equilibria model.ode --along nu=-.9:-.2 -s e=0 -q -o eq.json");
    let branch = folder.json("cycles --from eq.json:HB1 --along nu=-.65:-.5 -q");
    assert_eq!(labels(&branch), ["EP1", "LPC1", "BPC1", "EP2"]);
}

#[test]
fn an_isola_of_cycles_closes_where_a_state_vanishes() {
    let folder = folder(ISOLA);
    folder.succeed("simulate model.ode --duration 200 -q -o settled.json");
    let branch = folder.json("cycles --from settled.json:END --along p=-2:2 -q");
    assert_eq!(labels(&branch), ["EP1", "LPC1", "LPC2", "EP2"]);
    assert!(branch["ends"][1]["cause"].as_str().unwrap().contains("closed"));
}

#[test]
fn doubled_cycles_from_a_time_history_end_where_they_become_single() {
    let folder = Folder::with("lure.ode");
    folder.succeed("simulate lure.ode --duration 2000 -s alpha=.6 --start x=.5 -q -o settled.json");
    let branch = folder.json("cycles --from settled.json:END --along alpha=-1.5:1.5 -q");
    let mut special: Vec<&str> =
        labels(&branch).into_iter().filter(|label| !label.starts_with("EP")).collect();
    special.sort_unstable();
    assert_eq!(special, ["LPC1", "LPC2", "PD1", "PD2", "PD3", "PD4"]);
    for end in 0..2 {
        assert!(branch["ends"][end]["cause"].as_str().unwrap().contains("doubled cycles end"));
    }
}

#[test]
fn a_branch_of_cycles_ends_at_the_hopf_point_that_there_is() {
    let folder = folder(OREGONATOR);
    let equilibria = folder.json("equilibria model.ode --along f=0.2:3");
    let value = number(&labelled(&equilibria, "HB2")["value"]);
    folder.succeed("equilibria model.ode --along f=0.2:3 -q -o eq.json");
    let cycles = folder.json("cycles --from eq.json:HB1 --along f=0.2:3");
    let cause = cycles["ends"][1]["cause"].as_str().unwrap();
    assert!(cause.contains(&format!("Hopf point at f = {value:.7}")), "{cause}, not {value}");
}

#[test]
fn a_result_is_no_model() {
    let folder = folder(FOOD_CHAIN);
    folder.succeed("equilibria model.ode --along p1=0:2 -q -o eq.json");
    folder.fails("equilibria eq.json --along p1=0:2", 2, &["eq.json", "--from eq.json:LABEL"]);
}

#[test]
fn cycles_are_born_where_the_normal_form_holds_only_nearby() {
    let folder = folder(NERVE);
    folder.succeed("equilibria model.ode --along iapp=0:200 -q -o eq.json");
    // Over a wide interval the first cycle of the normal form is far too large.
    let cycles = folder.json("cycles --from eq.json:HB2 --along gk=20:50");
    let first = &points(&cycles)[0];
    assert!((number(&first["value"]) - 36.0).abs() < 0.1 && points(&cycles).len() > 3);
}

#[test]
fn a_closed_branch_of_cycles_that_starts_next_to_a_turning_point_ends_after_one_lap() {
    let folder = folder(TWO_OSCILLATORS);
    folder.succeed("simulate model.ode --duration 200 -q -o motion.json");
    folder.succeed("cycles --from motion.json:END --along d=-1:.5 -q -o cycles.json");
    for steps in ["", " --finer 3"] {
        let lap = folder.json(&format!("cycles --from cycles.json:BPC1 --along d=-1:.5{steps}"));
        assert!(lap["ends"][1]["cause"].as_str().unwrap().contains("closed"), "{}", lap["ends"]);
        let folds = points(&lap).iter().filter_map(|point| point["label"].as_str());
        assert_eq!(folds.filter(|label| label.starts_with("LPC")).count(), 2);
    }
}

#[test]
fn multipliers_at_rounding_do_not_hide_a_period_doubling() {
    let folder = folder(SPIKING_NEURON);
    folder.succeed("simulate model.ode --duration 10000 --points 20001 -q -o motion.json");
    let cycles = folder.json("cycles --from motion.json:END --along I=3.45:3.6");
    // SciPy (DOP853 with the variational equations, relative tolerance 1e-11) finds I = 3.4733911357, T = 33.113204094.
    let doubling = labelled(&cycles, "PD1");
    assert!((number(&doubling["value"]) - 3.4733911357).abs() < 1e-8, "{}", doubling["value"]);
    assert!((number(&doubling["period"]) - 33.113204094).abs() < 1e-6, "{}", doubling["period"]);
    assert!(points(&cycles).iter().filter(|point| point["stable"].is_null()).count() <= 1);
}

#[test]
fn two_torus_bifurcations_in_one_step() {
    let folder = folder(TWO_TORI);
    folder.succeed("simulate model.ode --duration 100 -q -o motion.json");
    let cycles = folder.json("cycles --from motion.json:END --along mu=-1:1");
    for (label, value) in [("NS1", 0.0), ("NS2", 0.005)] {
        assert!((number(&labelled(&cycles, label)["value"]) - value).abs() < 1e-10);
    }
}

/// Between them the torus is stable: one crosses the circle inwards, the other outwards, and the count is as before.
#[test]
fn two_torus_bifurcations_that_undo_each_other() {
    for (first, gap) in [(0.3, 1e-4), (0.57, 5e-4), (0.1104, 2e-4)] {
        let second = first + gap;
        let folder = folder(&format!(
            "par mu=-.1\ninit u=0,v=0,p=0,q=0\nr=u^2+v^2\ns=4*(mu-{first})*(mu-{second})-p^2-q^2\nu'=(mu-r)*u-5*v\n\
             v'=(mu-r)*v+5*u\np'=s*p-0.25*q\nq'=s*q+0.25*p\ndone\n"
        ));
        folder.succeed("equilibria model.ode --along mu=-.2:1.2 -q -o equilibria.json");
        let cycles = folder.json("cycles --from equilibria.json:HB1 --along mu=-.2:1.2");
        for (label, value) in [("NS1", first), ("NS2", second)] {
            assert!((number(&labelled(&cycles, label)["value"]) - value).abs() < 1e-8, "{first} {gap}");
        }
    }
}

/// Multipliers that symmetry makes double pass -1 and then 1 within one step: between .3833403 and .383381 the cycles are stable (by the
/// variational equation, SciPy). Neither place satisfies a defining system of one multiplier; both are told.
#[test]
fn double_multipliers_that_pass_the_circle_twice_in_a_step_are_told() {
    let folder = folder(THREE_CELLS);
    folder.succeed("equilibria model.ode --along i=0:2 -q -o equilibria.json");
    folder.succeed("cycles --from equilibria.json:HB2 --along i=0:2 -q -o cycles.json");
    let result: Value =
        serde_json::from_slice(&std::fs::read(folder.0.path().join("cycles.json")).unwrap()).unwrap();
    let told: Vec<f64> = result["unlocated"]
        .as_array()
        .unwrap()
        .iter()
        .map(|change| change["between"][0].as_f64().unwrap())
        .collect();
    for place in [0.3833403, 0.383381] {
        assert!(told.iter().any(|value| (value - place).abs() < 1e-6), "{place}: {told:?}");
    }
}
