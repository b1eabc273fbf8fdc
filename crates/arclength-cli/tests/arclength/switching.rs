//! Other branches at special cycles, and curves of special cycles in two parameters.

use crate::{Folder, close, labelled};

const LURE: &str = "equilibria lure.ode --along alpha=-1.5:1.5 -q -o equilibria.json";
const CYCLES: &str = "cycles --from equilibria.json:HB1 --along alpha=-1.5:1.5 -o cycles.json";

#[test]
fn doubled_cycles_from_a_period_doubling() {
    let folder = Folder::with("lure.ode");
    folder.succeed(LURE);
    let cycles = folder.json(CYCLES);
    let doubling = labelled(&cycles, "PD1");
    // Published with MatCont's testrun `adaptx`.
    close(&doubling["value"], 0.6303020062, 1e-9);
    assert!(doubling["normal_form"]["cubic_coefficient"].as_f64().unwrap() < 0.0);
    let doubled = folder.json("cycles --from cycles.json:PD1 --along alpha=-1.5:1.5 -o doubled.json");
    close(&labelled(&doubled, "LPC1")["value"], -0.0449491239, 1e-8);
    close(&labelled(&doubled, "PD2")["value"], -0.0447196616, 1e-8);
    close(&labelled(&doubled, "PD2")["period"], 11.062836564, 1e-9);
    let shown = folder.succeed("show equilibria.json cycles.json doubled.json -o all.svg");
    assert!(shown.contains("the doubled cycles end at a period doubling at alpha = -0.630302"), "{shown}");
    // The branch of the cycle itself.
    let stayed = folder.json("cycles --from cycles.json:PD1 --along alpha=0.5:1.5 --stay");
    close(&stayed["points"][0]["period"], labelled(&stayed, "EP1")["period"].as_f64().unwrap(), 1e-15);
    assert!(stayed["points"].as_array().unwrap().iter().all(|point| point["period"].as_f64() < Some(7.0)));
}

#[test]
fn a_closed_curve_of_period_doublings() {
    let folder = Folder::with("lure.ode");
    folder.succeed(LURE);
    folder.succeed(&format!("{CYCLES} -q"));
    let arguments = "locus --from cycles.json:PD1 --in alpha=-2:2,beta=0.2:2";
    let curve = folder.json(&format!("{arguments} -o curve.json -o curve.csv -o curve.svg"));
    assert_eq!(curve["schema"]["name"], "arclength.cycle_locus");
    assert_eq!(curve["kind"], "PD");
    assert_eq!(labelled(&curve, "R22")["values"].as_array().unwrap().len(), 2);
    let told = folder.succeed("show curve.json --explain");
    assert!(told.contains("the branch is closed") && told.contains("1:2 resonance"), "{told}");
    // A cycle of the curve along a parameter.
    folder.succeed("cycles --from curve.json:R22 --along alpha=-0.1:0.1");
    folder.fails("locus --from cycles.json:EP1 --in alpha=-2:2,beta=0.2:2", 2, &["EP1", "LPC", "PD", "NS"]);
}

#[test]
fn the_symmetric_cycle_through_a_branch_point() {
    let folder = Folder::with("lorenz.ode");
    folder
        .succeed("simulate lorenz.ode -s rho=300 --start x=10,y=10,z=200 --duration 100 -q -o history.json");
    let broken = folder.json("cycles --from history.json:END --along rho=290:320 -o broken.json");
    let point = labelled(&broken, "BPC1");
    let other = folder.json("cycles --from broken.json:BPC1 --along rho=290:320");
    // Lorenz's equations do not change when x and y change their signs: the other branch has this symmetry.
    for cycle in other["points"].as_array().unwrap() {
        let [largest, smallest] = ["max", "min"].map(|end| cycle[end]["x"].as_f64().unwrap());
        assert!((largest + smallest).abs() < 1e-5 * largest, "{largest} {smallest}");
    }
    assert!(point["value"].as_f64().unwrap() > 310.0);
}

#[test]
fn folds_of_cycles_in_closed_form() {
    let folder = Folder::with("bautin.ode");
    folder.succeed("equilibria bautin.ode --along beta1=-1:1 -q -o equilibria.json");
    let cycles = folder.json("cycles --from equilibria.json:HB1 --along beta1=-1:1 -o cycles.json");
    close(&labelled(&cycles, "LPC1")["value"], -0.25, 1e-9);
    let folds = folder.json("locus --from cycles.json:LPC1 --in beta1=-1:1,beta2=0.2:1.5");
    for point in folds["points"].as_array().unwrap() {
        let [one, two] = [0, 1].map(|index| point["values"][index].as_f64().unwrap());
        assert!((one + 0.25 * two * two).abs() < 1e-7, "{one} {two}");
    }
}
