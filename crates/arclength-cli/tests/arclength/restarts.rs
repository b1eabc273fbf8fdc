//! Computations that start from labelled points of earlier results, and what `show` makes of the files.

use crate::{EQUILIBRIA, Folder, close, labelled};

#[test]
fn the_other_branch_through_a_branch_point() {
    let folder = Folder::with("pp2.ode");
    folder.succeed("equilibria pp2.ode --along p1=0:0.9 -q -o trivial.json");
    std::fs::remove_file(folder.0.path().join("pp2.ode")).unwrap();
    let other = folder.json("equilibria --from trivial.json:BP1 --along p1=0.1:0.9 -o other.json");
    // Published with the demo `pp2` of AUTO.
    close(&labelled(&other, "BP1")["value"], 0.6, 1e-12);
    close(&labelled(&other, "LP1")["value"], 0.83292932223, 1e-10);
    // From the fold along another parameter: the same fold.
    let along = folder.json("equilibria --from other.json:LP1 --along p2=2:4");
    close(&labelled(&along, "LP1")["value"], 3.0, 1e-9);
    // The branch through the end of a branch.
    let through = folder.json("equilibria --from other.json:EP2 --along p1=0.1:0.9");
    close(&labelled(&through, "LP1")["value"], 0.83292932223, 1e-10);
}

#[test]
fn curves_of_hopf_points_and_folds() {
    let folder = Folder::with("ab.ode");
    folder.succeed("equilibria ab.ode --along D=0:0.4 -s B=18 -q -o equilibria.json");
    let folds =
        folder.json("locus --from equilibria.json:LP1 --in D=0:0.4,B=10:30 -o folds.json -o folds.csv");
    // The folds meet where u2 = 2, B = 4 (1 + beta): closed form.
    let cusp = labelled(&folds, "CP1");
    close(&cusp["values"][1], 16.0, 1e-9);
    let hopf = folder.json("locus --from equilibria.json:HB1 --in D=0:0.4,B=10:30 -o hopf.json --explain");
    let [first, second] = [&folds, &hopf].map(|result| labelled(result, "BT1"));
    close(&first["values"][0], second["values"][0].as_f64().unwrap(), 1e-9);
    close(&second["values"][1], 64.0 / 3.0, 1e-9);
    assert_eq!(hopf["in"][1], serde_json::json!({"key": "B", "start": 10.0, "end": 30.0}));
    assert_eq!(hopf["kind"], "HB");
    let csv = std::fs::read_to_string(folder.0.path().join("folds.csv")).unwrap();
    assert!(csv.starts_with("label,D,B,frequency,first_lyapunov,u1,u2,"), "{csv}");
    assert!(csv.lines().next().unwrap().contains(",test_CP,test_BT"), "{csv}");
    let shown = folder.succeed("show folds.json hopf.json -o plane.png");
    assert!(shown.contains("cusp, c = ") && shown.contains("Bogdanov-Takens point, a = "), "{shown}");
    assert!(folder.0.path().join("plane.png").exists());
    // From a point of codimension two along a parameter.
    folder.succeed("equilibria --from hopf.json:BT1 --along beta=2:4");
}

#[test]
fn a_cycle_from_a_time_history() {
    let folder = Folder::with("vanderpol.ode");
    folder.succeed("simulate vanderpol.ode --duration 60 -q -o history.json");
    let result = folder.json("cycles --from history.json:END --along mu=0.5:5 --at 1,5");
    // The period at mu = 1 is published to 12 digits.
    close(&labelled(&result, "AT1")["period"], 6.663286859323, 1e-9);
    close(&labelled(&result, "AT2")["period"], 11.612230668, 1e-9);
}

#[test]
fn the_story_of_a_run_is_told_again_from_its_file() {
    let folder = Folder::with("pp2.ode");
    folder.succeed(&format!("{EQUILIBRIA} -q -o equilibria.json"));
    let arguments = "cycles --from equilibria.json:HB1 --along p1=0.6:0.9 -o cycles.json --explain";
    let told = folder.succeed(arguments);
    for part in ["story of the run", "homoclinic", "last good point: p1 = 0.70807", "meshes", "errors"] {
        assert!(told.contains(part), "{told}");
    }
    assert_eq!(folder.succeed("show cycles.json --explain"), told);
    let shown = folder.succeed("show equilibria.json cycles.json -o both.svg");
    assert!(shown.contains("omega = 0.60478222194, l1 = "), "{shown}");
    folder.fails("show equilibria.json cycles.json -o both.json", 2, &["both.json", ".svg"]);
}

#[test]
fn test_functions_of_every_step_are_kept() {
    let folder = Folder::with("pp2.ode");
    let result = folder.json(&format!("{EQUILIBRIA} -o equilibria.json"));
    let points = result["points"].as_array().unwrap();
    assert!(points.iter().all(|point| point["tests"]["HB"].is_f64()));
    // The test for Hopf points changes its sign at the Hopf point.
    let place = points.iter().position(|point| point["label"] == "HB1").unwrap();
    let [before, after] = [place - 1, place + 1].map(|index| points[index]["tests"]["HB"].as_f64().unwrap());
    assert!(before * after < 0.0, "{before} {after}");
    let csv = folder.succeed("cycles --from equilibria.json:HB1 --along p1=0.6:0.7 --format csv");
    assert!(csv.lines().next().unwrap().ends_with("test_LPC,test_BPC,test_PD,test_NS"), "{csv}");
}

#[test]
fn files_that_cannot_be_started_from() {
    let folder = Folder::with("pp2.ode");
    folder.succeed(&format!("{EQUILIBRIA} -q -o equilibria.json"));
    let path = folder.0.path().join("equilibria.json");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(folder.0.path().join("short.json"), &text[..text.len() / 2]).unwrap();
    folder.fails("show short.json", 2, &["short.json", "not a result file", "line"]);
    folder.fails("cycles --from short.json:HB1 --along p1=0:1", 2, &["short.json", "not a result file"]);
    std::fs::write(folder.0.path().join("other.json"), text.replace("\"u2\"", "\"u3\"")).unwrap();
    folder.fails("equilibria --from other.json:HB1 --along p1=0:1", 2, &["other.json", "u1, u2"]);
    let newer = text.replacen("\"version\": 1", "\"version\": 9", 1);
    std::fs::write(folder.0.path().join("newer.json"), newer).unwrap();
    folder.fails("show newer.json", 2, &["newer.json", "version 9"]);
    folder.fails("cycles --from equilibria.json:BP1 --along p1=0:1", 2, &["no cycles start at BP1", "HB"]);
    folder.fails(
        "cycles --from equilibria.json:HB1 --along p1=0:0.5",
        2,
        &["--along p1=0:0.5", "HB1", "0.67159"],
    );
    folder.fails("locus --from equilibria.json:EP1 --in p1=0:1,p2=1:4", 2, &["EP1", "LP", "HB", "BP"]);
    folder.fails("locus --from equilibria.json:HB1 --in p1=0:1", 2, &["--in p1:", "this is one", "two"]);
    folder.fails(
        "locus --from equilibria.json:HB1 --in p1=0:1,p1=0:1",
        2,
        &["`p1` and `p1` cannot vary together"],
    );
    folder.fails("locus --from equilibria.json:HB1 --in p1=0:1,x=0:1", 2, &["--in x", "p1, p2, p3, p4"]);
    folder.fails("simulate --from equilibria.json:XX1 --duration 1", 2, &["XX1", "HB1"]);
    folder.fails(
        "equilibria --from equilibria.json:HB1 --along p1=0:1 --named-set a",
        2,
        &["--named-set a", "none"],
    );
}

#[test]
fn a_restart_from_its_own_label_finds_that_point_again() {
    let folder = Folder::with("ab.ode");
    folder.succeed("equilibria ab.ode --along D=0:0.4 -s B=18 -q -o equilibria.json");
    let first = folder.json("equilibria ab.ode --along D=0:0.4 -s B=18");
    for label in ["HB1", "LP1", "LP2", "HB2"] {
        let again = folder.json(&format!("equilibria --from equilibria.json:{label} --along D=0:0.4"));
        let places = |result: &serde_json::Value| -> Vec<f64> {
            let points = result["points"].as_array().unwrap().iter();
            let mut places: Vec<f64> = points
                .filter(|point| point["special"].is_object())
                .map(|p| p["value"].as_f64().unwrap())
                .collect();
            places.sort_by(f64::total_cmp);
            places
        };
        let (expected, found) = (places(&first), places(&again));
        assert_eq!(found.len(), expected.len(), "{label}: {found:?} {expected:?}");
        assert!(found.iter().zip(&expected).all(|(one, other)| (one - other).abs() < 1e-11), "{label}");
    }
}

#[test]
fn starts_on_singular_points_say_why_they_are_refused() {
    let folder = Folder::with("ab.ode");
    let model =
        "par m=0, p=0\nx' = m*x - y\ny' = m*y + x\nu' = m*u - v\nv' = m*v + u\nz' = p*z - z^3\ndone\n";
    std::fs::write(folder.0.path().join("singular.ode"), model).unwrap();
    folder.fails(
        "equilibria singular.ode --along p=-1:1 -s m=-1",
        2,
        &["branch point", "slightly different p"],
    );
    folder.succeed("equilibria singular.ode --along m=-1:1 -s p=-1 -q -o pairs.json");
    folder.fails("cycles --from pairs.json:HB1 --along m=-1:1", 2, &["HB1", "degenerate"]);
}
