//! Curves of special points in two parameters, what branches tell of themselves, and values of `r` where `1/r` is followed.

use crate::Folder;
use crate::branches::{close, number};
use serde_json::Value;

fn points(result: &Value) -> &Vec<Value> {
    result["points"].as_array().unwrap()
}

#[test]
fn the_curve_of_hopf_points_is_the_stability_boundary() {
    let folder = Folder::new();
    folder.succeed("hopf --along v=1:12 -q -o hopf.json");
    let curve = folder
        .json("locus --from hopf.json:HB1 --in v=1:12,l=0.05:0.2 -o curve.json -o curve.svg -o curve.csv");
    assert_eq!(curve["schema"]["name"], "kingpin.locus");
    assert_eq!(curve["in"][1], serde_json::json!({"key": "l", "unit": "m", "start": 0.05, "end": 0.2}));
    let chosen: Vec<&Value> = points(&curve).iter().step_by(points(&curve).len() / 4).collect();
    assert!(chosen.len() > 3);
    for point in chosen {
        let [speed, length] = [0, 1].map(|index| number(&point["values"][index]));
        let closed_form = folder.json(&format!("stability -s l={length:e}"));
        close(&closed_form["critical_speed"], speed, 1e-9);
        assert!(number(&point["frequency"]) > 0.0);
    }
    // The result is the start of a branch of cycles.
    let cycles = folder.json("cycles --from curve.json:EP1 --along v=1:12 --steps 20");
    assert!(points(&cycles).len() > 10);
}

#[test]
fn the_curve_of_folds_of_cycles_passes_through_both_folds_of_the_isola() {
    let folder = Folder::new();
    let wheel = "-s k_u=inf -s r=inf -s l=0.04";
    folder.succeed(&format!("cycles --along v=0.015:60 {wheel} -s c_q=0.05 -q -o attached.json"));
    let curve =
        folder.json("locus --from attached.json:LPC1 --in c_q=0.05:1,v=0.01:60 --at 0.1 --tolerance 1e-9");
    assert_eq!(curve["schema"]["name"], "kingpin.cycle_locus");
    assert_eq!(curve["kind"], "LPC");
    // AUTO-07p's folds at c_q = 0.1 (collocation, 150 x 4).
    let mut folds: Vec<&Value> = points(&curve).iter().filter(|point| point["values"][0] == 0.1).collect();
    folds.sort_by(|a, b| number(&a["values"][1]).total_cmp(&number(&b["values"][1])));
    assert_eq!(folds.len(), 2);
    for (fold, [speed, period]) in
        folds.into_iter().zip([[0.047780593, 0.354463728], [14.0025055, 0.217839059]])
    {
        close(&fold["values"][1], speed, 2e-7);
        close(&fold["period"], period, 2e-7);
    }
    // Meshes follow the local estimate; what is told knows how the model multiplies it.
    assert!(points(&curve).iter().all(|point| number(&point["error_estimate"]) < 3e-9));
}

#[test]
fn radii_are_told_as_radii() {
    let folder = Folder::new();
    let wheel = "-s l=0.08 -s r=0.4 -s c_q=0.1";
    folder.succeed(&format!("cycles --along v=0.2:20 {wheel} -q -o k.json"));
    let doubled = folder.json("cycles --from k.json:PD2 --along r=0.2:1");
    let end = doubled["branches"][0]["ends"][1].as_str().unwrap();
    assert!(end.contains("period doubling at r = 0.31723652 m"), "{end}");
    let curve = folder.json("locus --from k.json:PD2 --in r=0.2:1,v=0.5:9 --steps 4");
    for point in points(&curve) {
        assert!((0.2..=1.0).contains(&number(&point["values"][0])), "{}", point["values"]);
    }
    folder.succeed("hopf --along v=1:12 -q -o hopf.json");
    let straight = folder.json("locus --from hopf.json:HB1 --in r=0.5:inf,v=1:12 -o r.svg");
    let last = straight["ends"].as_array().unwrap().iter().map(|end| end["cause"].as_str().unwrap());
    assert!(last.clone().any(|cause| cause == "reached the end of the interval, r = 0.5 m"), "{last:?}");
    // The critical yaw rate v/r does not depend on the radius.
    for point in points(&straight) {
        close(&(number(&point["values"][1]) / number(&point["values"][0])).into(), 8.43103697014, 1e-9);
    }
}

#[test]
fn branches_tell_their_story_in_units() {
    let folder = Folder::new();
    let hopf = folder.succeed("hopf --along v=1:12 --explain --finer 2").output;
    for line in [
        "story of the run",
        "stable from v = 1 m/s to 8.431037 m/s",
        "HB1 at v = 8.431037 m/s: omega = 43.25539212",
    ] {
        assert!(hopf.contains(line), "{line}: {hopf}");
    }
    let cycles =
        folder.succeed("cycles --along v=7:9 --at 8 --explain --tolerance 1e-5 --intervals 50").output;
    // Next to the Hopf point so coarse a mesh does not decide.
    for line in [
        "branch     1 from HB1",
        "unstable from v = 8.431037 m/s to",
        "m/s to 7 m/s",
        "polynomials of degree",
    ] {
        assert!(cycles.contains(line), "{line}: {cycles}");
    }
}

#[test]
fn steps_and_meshes_are_as_asked_for() {
    let folder = Folder::new();
    let count = |options: &str| points(&folder.json(&format!("cycles --along v=7:9 {options}"))).len();
    let plain = count("");
    assert!(count("--finer 4") > 2 * plain);
    assert_eq!(count("--steps 5"), 7); // the Hopf point, the first cycle and five steps
    let coarse = folder.json("cycles --along v=7:9 --tolerance 1e-4");
    let fine = folder.json("cycles --along v=7:9 --tolerance 1e-9");
    // Along the branch; cycles that are shown are confirmed on finer meshes.
    let fewest = |result: &Value| {
        let steps = points(result).iter().filter(|point| point["multiplier_errors"].is_null());
        steps.map(|point| point["intervals"].as_u64().unwrap()).filter(|count| *count > 0).min().unwrap()
    };
    assert!(fewest(&coarse) < fewest(&fine) && fewest(&coarse) >= 4);
    for point in points(&fine).iter().filter(|point| !point["orbit"].is_null()) {
        assert!(number(&point["error_estimate"]) < 1e-9);
        assert!(number(&point["tests"]["PD"]).is_finite());
    }
    let stopped = folder.json("cycles --along v=1:9 --intervals 4");
    assert!(
        stopped["branches"][0]["remedies"][1].as_str().unwrap().contains("--intervals"),
        "{}",
        stopped["branches"]
    );
}

#[test]
fn curves_that_make_no_sense() {
    let folder = Folder::new();
    folder.succeed("hopf --along v=1:12 -q -o hopf.json");
    folder.succeed("cycles --along v=7:9 --at 8 -q -o cycles.json");
    for (arguments, words) in [
        ("hopf.json:HB1 --in v=1:12", vec!["--in v:", "this is one", "two parameters"]),
        ("hopf.json:HB1 --in v=1:12,v=2:9", vec!["`v`", "cannot vary together"]),
        ("hopf.json:HB1 --in v=1:12,v=0:1", vec!["--in v,v", "`v`", "cannot vary together"]),
        ("hopf.json:HB1 --in v=1:12,l=0.1:0.2", vec!["l = 0.08", "outside 0.1:0.2"]),
        ("hopf.json:HB2 --in v=1:12,l=0.05:0.2", vec!["`HB2`", "the labels are: HB1"]),
        ("cycles.json:AT1 --in v=1:12,l=0.05:0.2", vec!["no curve of special points starts at AT1", "LPC"]),
        ("hopf.json:HB1 --in v=1:12,l=0.05:0.2 --at 20", vec!["--at 20", "1 to 12"]),
        ("hopf.json:HB1 --in v=1:12,l=0.05:0.2 --at l=0.1", vec!["--at l", "values of v"]),
    ] {
        let run = folder.run(&format!("locus --from {arguments}"));
        assert_eq!(run.exit_code, 2, "{arguments}: {}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: no `{word}` in {}", run.messages);
        }
    }
}
