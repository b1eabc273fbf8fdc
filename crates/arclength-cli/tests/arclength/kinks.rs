//! Cycles of models with kinks and jumps, as users found them wrong once: period and extremes, by SciPy's DOP853 at 1e-13 with events and
//! Newton's method on the return map.

use crate::found_by_users::{folder, number, points};
use crate::labelled;
use serde_json::Value;

/// That a labelled cycle has a period and a largest first state within three times its error, and at least to nine digits.
#[track_caller]
fn check(cycles: &Value, value: f64, [period, max]: [f64; 2]) {
    let point = points(cycles).iter().find(|point| number(&point["value"]) == value).unwrap();
    let allowed = (3.0 * number(&point["error_estimate"])).max(1e-9);
    assert!(allowed < 1e-7);
    assert!((number(&point["period"]) / period - 1.0).abs() < allowed, "{}", point["period"]);
    assert!((number(&point["max"]["x"]) - max).abs() < 2.0 * max * allowed, "{}", point["max"]);
    assert_eq!(point["stable"], true);
}

#[test]
fn a_kink_at_zero() {
    let folder = folder("par m=1\nx'=y\ny'=m*(1-abs(x))*y-x\ninit x=2,y=0\ndone\n");
    folder.succeed("simulate model.ode --duration 200 -o h.json -q");
    let cycles = folder.json("cycles --from h.json:END --along m=.3:6 --at .5,1,2,4");
    check(&cycles, 0.5, [6.319264073294581, 2.357703762573947]);
    check(&cycles, 1.0, [6.427085678657411, 2.362078437564076]);
    check(&cycles, 2.0, [6.847531630305399, 2.377167269532259]);
    check(&cycles, 4.0, [8.271674417925418, 2.4078523809987247]);
}

#[test]
fn a_relay() {
    let folder = folder("par m=1\nx'=y\ny'=-x-.2*y+if(y>-.1)then(m)else(0)\ninit x=1,y=1\ndone\n");
    folder.succeed("simulate model.ode --duration 200 -o h.json -q");
    let cycles = folder.json("cycles --from h.json:END --along m=.5:2 --at .7,1,1.5");
    check(&cycles, 0.7, [6.315103224115957, 2.5834525592325983]);
    check(&cycles, 1.0, [6.314968143512116, 3.692057825015984]);
    check(&cycles, 1.5, [6.314896247796387, 5.539215147804485]);
}

#[test]
fn saturations_that_a_growing_cycle_reaches() {
    // Somieski (1997): nose gear, its tyre's force and moment saturate.
    let folder = folder(
        "par V=20,iz=1,c=-100000,k=-10,e=0.1,a=0.1,fz=9000,cfa=20,cma=-2,kap=-270,delta=5,ag=10\n\
         number sig=0.3,deg=0.017453292519943295\ninit psi=0,om=0,y=0\nal=atan(y/sig)\n\
         fy=fz*cfa*(if(abs(al)<=(delta*deg))then(al)else(delta*deg*sign(al)))\n\
         mz=fz*cma*(if(abs(al)<=(ag*deg))then(ag*deg/pi*sin(pi*al/(ag*deg)))else(0))\npsi'=om\n\
         om'=(c*psi+k*om+mz-e*fy+kap/V*om)/iz\ny'=V*psi+(e-a)*om-V/sig*y\ndone\n",
    );
    folder.succeed("equilibria model.ode --along V=5:300 -o e.json -q");
    let cycles = folder.json("cycles --from e.json:HB1 --along V=5:300 --at 200");
    let cycle = labelled(&cycles, "AT1");
    assert!((number(&cycle["max"]["psi"]) - 0.263626087).abs() < 1e-9, "{}", cycle["max"]);
    folder.succeed("equilibria model.ode -s k=0 --along V=1:100 -o e.json -q");
    let cycles = folder.json("cycles --from e.json:HB1 --along V=1:100 --at 100");
    let cycle = labelled(&cycles, "AT1");
    assert!((number(&cycle["max"]["psi"]) / 1.6155481564 - 1.0).abs() < 1e-9, "{}", cycle["max"]);
    assert!((number(&cycle["period"]) / 0.0197804150 - 1.0).abs() < 1e-8);
}
