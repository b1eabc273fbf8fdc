//! `kingpin fit`: from a record to parameters, their intervals and what follows from them, and what is wrong with records.

use crate::Folder;
use serde_json::Value;

const RECORD: &str = include_str!("../../../kingpin/tests/records/dry_friction_noise.csv");

/// The truth of the record, and what is known of its wheel.
const TRUTH: [(&str, f64); 4] = [("k", 100.0), ("c_q", 0.3), ("c_psi", 0.0015), ("M_f", 0.015)];
const KNOWN: &str = "-s r=inf -s v=1 -s k=130 -s c_q=0.3";

fn with_record() -> Folder {
    let folder = Folder::new();
    std::fs::write(folder.path("decay.csv"), RECORD).unwrap();
    folder
}

#[test]
fn a_record_gives_parameters_with_intervals() {
    let folder = with_record();
    let result = folder.json(&format!("fit decay.csv {KNOWN} --estimate k,c_psi,M_f --no-blow -q"));
    assert_eq!(result["schema"]["name"], "kingpin.fit");
    // What is estimated is no parameter that was used.
    assert!(result["parameters"].get("k_q").is_none() && result["parameters"]["c_q"] == 0.3);
    for (estimate, (key, truth)) in
        result["estimates"].as_array().unwrap().iter().zip([TRUTH[0], TRUTH[2], TRUTH[3]])
    {
        assert_eq!(estimate["key"], key);
        let number = |name: &str| estimate[name].as_f64().unwrap();
        assert!(number("lower") < truth && truth < number("upper"), "{estimate}");
        assert!(number("standard_error") < 0.3 * truth, "{estimate}");
    }
    assert_eq!(result["correlations"]["matrix"][1][1], 1.0);
    assert_eq!(result["records"][0]["samples"], 101);
    let sigma = result["records"][0]["columns"][0]["sigma"].as_f64().unwrap();
    assert!(
        (sigma / 0.002 - 1.0).abs() < 0.2 && result["records"][0]["columns"][0]["noise"] == true,
        "{sigma}"
    );
}

#[test]
fn tables() {
    let folder = with_record();
    let fit = format!("fit decay.csv {KNOWN} --estimate k,c_psi --no-blow -q");
    insta::assert_snapshot!("fit", folder.succeed(&format!("{fit} -s M_f=0.015")).output);
    // An unstable wheel has a critical speed, which is as uncertain as its parameters.
    let standing = "# v = 0\n".to_owned()
        + &csv(
            &folder,
            "simulate --duration 1 --points 101 -s r=inf -s v=0.5 -s l=0.04 -s c_psi=2e-4 --perturb Omega=5",
        );
    std::fs::write(folder.path("moving.csv"), standing.replace("# v = 0\n", "")).unwrap();
    let fit = "fit moving.csv -s r=inf -s v=0.5 -s l=0.04 --estimate k,c_psi --states psi --sigma psi=0.003 -q --no-blow";
    let result = folder.json(fit);
    let speed = |result: &Value, end: &str| result["critical_speed"][end].as_f64().unwrap();
    assert!(
        speed(&result, "lower") < speed(&result, "value")
            && speed(&result, "value") < speed(&result, "upper")
    );
    let truth = folder.json("stability -s r=inf -s v=0.5 -s l=0.04 -s c_psi=2e-4");
    let truth = truth["critical_speed"].as_f64().unwrap();
    assert!((speed(&result, "value") / truth - 1.0).abs() < 1e-6, "{truth} {}", result["critical_speed"]);
}

fn csv(folder: &Folder, command: &str) -> String {
    folder.succeed(&format!("{command} --format csv -q")).output
}

#[test]
fn files_hold_the_fit_and_the_wheel() {
    let folder = with_record();
    let fit = format!("fit decay.csv {KNOWN} -s M_f=0.015 --estimate k,c_psi --no-blow -q");
    folder.succeed(&format!("{fit} -o fit.svg -o fit.csv -o fit.json --write-wheel fitted.toml"));
    assert_eq!(folder.files(), ["decay.csv", "fit.csv", "fit.json", "fit.svg", "fitted.toml"]);
    let rows = std::fs::read_to_string(folder.path("fit.csv")).unwrap();
    assert!(rows.starts_with("record,state,t,measured,fitted,residual\ndecay.csv,psi,0.0,"), "{rows}");
    assert_eq!(rows.lines().count(), 102);
    // The wheel that was written is the one that was found.
    let result: Value = serde_json::from_slice(&crate::read(&folder.path("fit.json"))).unwrap();
    let steady = folder.json("stability --wheel fitted.toml");
    for (index, key) in [(0, "k_q"), (1, "c_psi")] {
        assert_eq!(steady["parameters"][key], result["estimates"][index]["value"]);
    }
}

#[test]
fn several_records_have_speeds_of_their_own() {
    let folder = Folder::new();
    for (name, speed) in [("slow.csv", "0.5"), ("fast.csv", "2")] {
        let rows = csv(
            &folder,
            &format!(
                "simulate --duration 1 --points 101 -s r=inf -s v={speed} -s c_psi=0.002 -s c_q=0.2 --perturb psi=0.3"
            ),
        );
        std::fs::write(folder.path(name), rows).unwrap();
    }
    let fit =
        "fit slow.csv:v=0.5 fast.csv:v=2 -s r=inf -s k=140 --estimate k,c_q,c_psi --states psi --no-blow -q";
    let result = folder.json(fit);
    for (index, truth) in [100.0, 0.2, 0.002].into_iter().enumerate() {
        let value = result["estimates"][index]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-6, "{value} {truth}");
    }
    assert_eq!((&result["records"][0]["v"], &result["records"][1]["v"]), (&0.5.into(), &2.0.into()));
}

#[test]
fn remarks_that_are_not_understood_are_told_of() {
    let folder = with_record();
    std::fs::write(folder.path("remark.csv"), format!("# by hand\n# V = 1\n{RECORD}")).unwrap();
    let run = folder.succeed(&format!("fit remark.csv {KNOWN} -s M_f=0.015 --estimate c_psi --no-blow"));
    let told = "remark.csv: line 2: `V = 1` is not understood: unknown key `V`; the nearest known key is `v`";
    assert!(run.messages.contains(told), "{}", run.messages);
}

#[test]
fn what_is_wrong_with_a_record_is_told_with_its_place() {
    let folder = with_record();
    for (name, text) in [
        ("twice.csv", "t,psi\n0,0.3\n0.1,0.2\n0.1,0.1\n"),
        ("degrees.csv", "t,psi (deg)\n0,10\n"),
        ("nan.csv", "t,psi\n0,0.3\n0.1,NaN\n"),
        ("few.csv", "t,psi\n0,0.3\n0.1,0.2\n"),
        ("still.csv", "t,psi\n0,0.3\n0.1,0.3\n0.2,0.3\n0.3,0.3\n0.4,0.3\n0.5,0.3\n0.6,0.3\n"),
        // The mean of equal numbers is not always that number.
        ("same.csv", "t,psi\n0,0.1\n0.1,0.1\n0.2,0.1\n0.3,0.1\n0.4,0.1\n0.5,0.1\n0.6,0.1\n"),
        ("ms.csv", "t,psi\n0,0.3\n5,0.29\n10,0.2\n15,0.1\n20,0\n25,-0.1\n30,-0.15\n"),
        ("nothing.csv", "t,angle\n0,0.3\n"),
        ("wide.csv", "t,psi\n0,0.3\n0.003,0.30,7\n"),
        ("tyre.toml", "tyre = \"linear\"\nsigma = 0.05\na = 0.02\nC_alpha = 500\nr = inf\n"),
    ] {
        std::fs::write(folder.path(name), text).unwrap();
    }
    for (arguments, reason) in [
        ("twice.csv", "twice.csv: line 4, column t: 0.1 does not come after 0.1"),
        ("degrees.csv", "degrees.csv: line 1, column psi: its unit is deg; allowed: rad"),
        ("nan.csv", "nan.csv: line 3, column psi: `NaN` is no finite number"),
        ("few.csv", "few.csv: line 3: the file ends after 2 samples; allowed: at least 5"),
        ("still.csv --estimate k", "still.csv: psi is the same in all samples: nothing moves"),
        ("same.csv --estimate k", "same.csv: psi is the same in all samples: nothing moves"),
        ("ms.csv --estimate k", "ms.csv: samples are at least 5 s apart, and this wheel swings in "),
        (
            "nothing.csv",
            "nothing.csv: line 1: no column is a state; the columns are: t, angle; allowed: u, q, psi, V, Omega",
        ),
        ("absent.csv", "absent.csv: "),
        ("decay.csv --states q", "decay.csv: line 3, column q: there is no such column"),
        ("decay.csv --estimate stiffness", "--estimate stiffness: "),
        ("decay.csv --estimate mu_s", "mu_s cannot be estimated"),
        ("decay.csv:k=7", "decay.csv: k is estimated and cannot be 7 for one record"),
        ("decay.csv:v=fast", "decay.csv: v=fast: "),
        (
            "decay.csv --start psi=some",
            "--start psi=some: no start; allowed: a finite number, `uniform` or `free`",
        ),
        ("decay.csv --start phi=0", "`phi` is no state that can be given here; allowed: u, q, psi, V, Omega"),
        ("decay.csv --sigma psi=0", "psi: the standard deviation 0 is not allowed"),
        ("decay.csv --offset q", "`q` is no state that can be given here; allowed: psi"),
        (
            "decay.csv -s k_u=inf --estimate M_f",
            "M_f cannot be estimated: with k_u = inf there is no model of dry friction",
        ),
        (
            "decay.csv --wheel tyre.toml --estimate M_f",
            "M_f cannot be estimated: a fit of a wheel with a tyre takes no",
        ),
        (
            "decay.csv --wheel tyre.toml -s M_f=0.02 --estimate c_psi",
            "M_f = 0.02 N m: a fit of a wheel with a tyre with dry friction about the king pin is not computed; set M_f = 0",
        ),
        ("wide.csv", "wide.csv: line 3: `7` stands under no name; allowed: 2 values"),
    ] {
        let run = folder.run(&format!("fit {arguments} -q"));
        assert_eq!(run.exit_code, 2, "{arguments}: {}", run.messages);
        assert!(run.messages.contains(reason), "{arguments}: {}", run.messages);
    }
}
