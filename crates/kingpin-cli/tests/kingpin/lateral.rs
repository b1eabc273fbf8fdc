//! `-s k_u=inf`, lateral elasticity only: the model of Takács, Stépán and Hogan (2008), with its isola.

use crate::Folder;
use crate::branches::{close, labelled, number};
use serde_json::Value;

/// The wheel of the isola.
const SHORT: &str = "-s k_u=inf -s r=inf -s l=0.04";

fn points(result: &Value) -> &Vec<Value> {
    result["points"].as_array().unwrap()
}

/// Where the isola shrinks to a point, by the study of it: a polynomial through folds at exact speeds.
#[test]
fn the_damper_without_isola_is_that_at_which_the_isola_dies() {
    let result = Folder::new().json("damper --up-to v=3 -s l=0.04 -s r=inf -s k_u=inf -q");
    let found = &result["isola_free"]["c_q"];
    assert_eq!(found["decided_by_large_cycles"], true);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!((number(&found["damping"]) / 0.649059942 - 1.0).abs() < 1e-6, "{found}");
    assert!((number(&found["last_cycle"]["speed"]) / 0.883556972 - 1.0).abs() < 1e-4, "{found}");
    assert!((number(&found["last_cycle"]["psi_max"]) / 1.02609266 - 1.0).abs() < 1e-4, "{found}");
    assert!(number(&result["c_q"]) < 0.07);
}

/// The equations are singular there, and branches crept towards it for ever.
#[test]
fn a_branch_ends_where_the_caster_lies_across() {
    let result =
        Folder::new().json("cycles -s l=0.04 -s r=inf -s k_u=inf -s c_psi=0.0021 --along v=0.2:80 -q");
    let last = result["points"].as_array().unwrap().last().unwrap().clone();
    assert!((last["psi_max"].as_f64().unwrap().cos() - 1e-3).abs() < 1e-8, "{last}");
}

#[test]
fn the_isola_by_hand() {
    let folder = Folder::new();
    folder.succeed(&format!("cycles --along v=0.015:60 --at 10 {SHORT} -s c_q=0.05 -q -o attached.json"));
    // AUTO-07p's values (collocation, 150 x 4); a quadratic for the first two.
    let attached: Value = serde_json::from_slice(&crate::read(&folder.path("attached.json"))).unwrap();
    close(&labelled(&attached, "HB1")["value"], 0.788_629_146_247, 1e-10);
    close(&labelled(&attached, "HB2")["value"], 4.338_830_220_75, 1e-10);
    assert_eq!(attached["parameters"]["k_u"], "inf");
    let large: Vec<&Value> = points(&attached)
        .iter()
        .filter(|point| point["value"] == 10.0 && point["stable"] == true && number(&point["psi_max"]) > 0.5)
        .collect();
    let label = large[0]["label"].as_str().unwrap();
    folder.succeed(&format!(
        "cycles --from attached.json:{label} --along c_q=0.05:0.11 --at 0.1 -q -o damped.json -o damped.svg"
    ));
    let isola = folder.json("cycles --from damped.json:AT1 --along v=0.015:60");
    assert_eq!(isola["parameters"]["c_q"], 0.1);
    let mut folds: Vec<&Value> = points(&isola)
        .iter()
        .filter(|point| point["label"].as_str().is_some_and(|label| label.starts_with("LPC")))
        .collect();
    folds.sort_by(|a, b| number(&a["value"]).total_cmp(&number(&b["value"])));
    assert_eq!(folds.len(), 2);
    for (fold, [speed, period, angle]) in
        folds.into_iter().zip([[0.047780593, 0.354463728, 1.4021], [14.0025055, 0.217839059, 0.78470]])
    {
        close(&fold["value"], speed, 2e-7);
        close(&fold["period"], period, 2e-7);
        close(&fold["psi_max"], angle, 1e-4);
        assert_eq!(fold["multipliers"].as_array().unwrap().len(), 3);
    }
    assert!(isola["branches"][0]["ends"][1].as_str().unwrap().contains("closed"));
    // Straight running is stable at every speed.
    let run = folder.run(&format!("hopf --along v=0.1:20 {SHORT} -s c_q=0.1"));
    assert_eq!(run.exit_code, 1);
    assert!(run.messages.contains("stable at v = 0.1 m/s and stable at v = 20 m/s"), "{}", run.messages);
    assert!(!run.messages.contains("unstable") && !run.messages.contains("c_u"), "{}", run.messages);
}

#[test]
fn uniform_motion_and_stability_have_the_fields_of_any_wheel() {
    let folder = Folder::new();
    let [rigid, elastic] = ["inf", "1e9"].map(|k_u| folder.json(&format!("steady -s k_u={k_u} -s v=5")));
    let fields = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(fields(&rigid), fields(&elastic));
    for field in ["q", "psi", "V", "Omega", "friction_force", "normal_force"] {
        close(&rigid[field], number(&elastic[field]), 1e-12);
    }
    assert_eq!((&rigid["u"], &rigid["rolls"]), (&0.0.into(), &elastic["rolls"]));
    assert!(number(&rigid["residual"]) < 1e-10);
    let arguments = "-s l=0.04 -s c_q=0.05 -s v=1.5";
    let [rigid, elastic] =
        ["inf", "1e7 -s c_u=300"].map(|k_u| folder.json(&format!("stability {arguments} -s k_u={k_u}")));
    assert_eq!(fields(&rigid), fields(&elastic));
    assert_eq!(rigid["eigenvalues"].as_array().unwrap().len(), 3);
    assert_eq!((&rigid["stable"], &elastic["stable"]), (&false.into(), &false.into()));
    close(&rigid["growth_rate"], number(&elastic["growth_rate"]), 1e-3);
    close(&rigid["critical_speed"], number(&elastic["critical_speed"]), 1e-3);
    // J s^3 + (m v + l^2 c_q) s^2 + (l^2 k_q + l c_q v) s + l k_q v has the sum of its roots.
    let straight = folder.json(&format!("stability {arguments} -s k_u=inf -s r=inf"));
    let sum: f64 = straight["eigenvalues"].as_array().unwrap().iter().map(|root| number(&root[0])).sum();
    let (m, inertia) = (0.0668 * 0.028, 3.48e-6 + 2.38e-5 + 0.0668 * 0.028 * 0.028);
    assert!((sum + (m * 1.5 + 0.0016 * 0.05) / inertia).abs() < 1e-9 * sum.abs(), "{sum}");
}

#[test]
fn a_motion_on_a_cycle_returns_after_its_period() {
    let folder = Folder::new();
    let wheel = format!("{SHORT} -s r=1 -s c_q=0.05");
    let result = folder.json(&format!("cycles --along v=1:7 --at 6 {wheel}"));
    let cycle = labelled(&result, "AT1");
    assert_eq!(cycle["orbit"]["dimension"], 3);
    let start: Vec<f64> = (0..3).map(|index| number(&cycle["orbit"]["states"][index])).collect();
    let uniform = folder.json(&format!("steady {wheel} -s v=6"));
    let perturbations: Vec<String> = ["q", "psi", "Omega"]
        .iter()
        .zip(&start)
        .map(|(name, value)| format!("--perturb {name}={:e}", value - number(&uniform[*name])))
        .collect();
    let duration = number(&cycle["period"]);
    let history = folder.json(&format!(
        "simulate --duration {duration:e} --points 4001 {wheel} -s v=6 {}",
        perturbations.join(" ")
    ));
    for name in ["u", "q", "psi", "V", "Omega"] {
        let values: Vec<f64> = history[name].as_array().unwrap().iter().map(number).collect();
        let size = values.iter().fold(1e-3, |size: f64, value| size.max(value.abs()));
        assert!((values[0] - values[4000]).abs() < 1e-7 * size, "{name}");
        let largest = values.iter().fold(f64::NEG_INFINITY, |largest, &value| largest.max(value));
        let smallest = values.iter().fold(f64::INFINITY, |smallest, &value| smallest.min(value));
        assert!((largest - number(&cycle["max"][name])).abs() < 1e-5 * size, "{name}");
        assert!((smallest - number(&cycle["min"][name])).abs() < 1e-5 * size, "{name}");
    }
}

#[test]
fn tables() {
    let folder = Folder::new();
    std::fs::write(folder.path("wheel.toml"), "k_u = inf\nl = 0.04\nc_q = 0.05\n").unwrap();
    for command in [
        "stability --wheel wheel.toml",
        "chart --wheel wheel.toml --x v=0.2:3:15 --y c_q=0.04:0.06:3",
        "hopf --wheel wheel.toml --along v=0.1:20",
        "simulate --wheel wheel.toml --duration 1 --perturb psi=0.1",
    ] {
        let run = folder.succeed(command);
        insta::assert_snapshot!(run.output);
    }
}

#[test]
fn what_cannot_be_done_says_what_can() {
    let folder = Folder::new();
    let fails = |arguments: &str, words: &[&str]| {
        let run = folder.run(&format!("{arguments} -s k_u=inf"));
        assert_eq!(run.exit_code, 2, "{arguments}: {}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: {}", run.messages);
        }
    };
    let possible = ["k_u = inf", "finite k_u", "cycles and simulations"];
    fails("basin --x psi=-1:1:3 --y Omega=-1:1:3 --contact sliding", &possible);
    fails("safe-kick --contact sliding", &possible);
    fails("basin --x u=-1:1:3 --y Omega=-1:1:3", &["`u`", "q, psi, Omega"]);
    for state in ["u", "V"] {
        fails(
            &format!("simulate --duration 1 --perturb {state}=0.1"),
            &[state, "k_u = inf", "q, psi, Omega"],
        );
    }
    fails("hopf --along c_u=0:1", &["`c_u`", "vary another key"]);
    fails("hopf --along k_u=50:inf", &["a finite end"]);
    folder.succeed("cycles --along v=2:9 --at 4 -q -o five.json");
    fails("cycles --from five.json:AT1 --along v=2:9", &["5 states", "3 (q, psi, Omega)", "leave k_u"]);
}
