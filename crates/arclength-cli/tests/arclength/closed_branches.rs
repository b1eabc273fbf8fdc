//! Closed branches of cycles between pitchforks of two coupled oscillators: their labels depend neither on the mesh nor on the steps.
//!
//! The branch of cycles in which both oscillators move alike is left, where it loses its symmetry, by a branch that turns there.
//! Discretised, these pitchforks are perturbed, and a fold beside one that does not exist may satisfy its defining system.

use crate::found_by_users::{folder, number, points};
use serde_json::Value;

/// Two of the same oscillator `x' = y, y' = force`, coupled by a spring and by a damper that is negative for negative `d`.
fn coupled(mu: f64, spring: f64, force: &str) -> String {
    let one = force.replace('X', "x").replace('Y', "y");
    let other = force.replace('X', "u").replace('Y', "v");
    format!(
        "par k={spring}, mu={mu}, d=.1\nx'=y\ny'={one}+k*(u-x)+d*(v-y)\nu'=v\nv'={other}+k*(x-u)+d*(y-v)\n\
         init x=1.9,y=0,u=1.9,v=0\ndone\n"
    )
}

/// Labels of special cycles of a kind with the values of the parameter.
fn special<'a>(branch: &'a Value, kind: &str) -> Vec<&'a Value> {
    let has_kind = |label: &str| label.trim_end_matches(|digit: char| digit.is_ascii_digit()) == kind;
    points(branch).iter().filter(|point| point["label"].as_str().is_some_and(has_kind)).collect()
}

#[test]
fn labels_of_closed_branches_do_not_depend_on_mesh_and_steps() {
    const FORCES: [&str; 3] = ["mu*(1-X^2)*Y-X", "mu*(1-X^2)*Y-X-.1*X^3", "mu*(1-X^2)*Y-X-.15*X^2"];
    const CONTROLS: [&str; 4] = ["", " --finer 3", " --finer 5", " --tolerance 1e-7"];
    let mut laps = 0;
    for (index, force) in FORCES.into_iter().cycle().take(12).enumerate() {
        // From 0.5 to 0.57 and from 0.17 to 0.19.
        let (mu, spring) = (0.5 + 0.0064 * index as f64, 0.17 + 0.02 * (0.618 * index as f64).fract());
        let folder = folder(&coupled(mu, spring, force));
        folder.succeed("simulate model.ode --duration 200 -q -o motion.json");
        folder.succeed("cycles --from motion.json:END --along d=-1:.5 -q -o cycles.json");
        for start in ["BPC1", "BPC2"] {
            let mut known: Option<Vec<(String, f64)>> = None;
            for control in CONTROLS {
                let case = format!("{force}, mu = {mu}, k = {spring}, from {start}{control}");
                let lap = folder
                    .json(&format!("cycles --from cycles.json:{start} --along d=-1:.5 --steps 400{control}"));
                assert!(
                    lap["ends"][1]["cause"].as_str().unwrap().contains("closed"),
                    "{case}: {}",
                    lap["ends"]
                );
                assert!(
                    lap["unlocated"].as_array().is_none_or(Vec::is_empty),
                    "{case}: {}",
                    lap["unlocated"]
                );
                let pitchforks = special(&lap, "BPC");
                for fold in special(&lap, "LPC") {
                    let away = |point: &&&Value| {
                        let distance = |key: &str| (number(&point[key]) - number(&fold[key])).abs();
                        distance("value") > 1e-5 || distance("period") > 1e-5
                    };
                    assert!(
                        pitchforks.iter().all(|point| away(&point)),
                        "{case}: a fold at {}",
                        fold["value"]
                    );
                }
                let labels = ["BPC", "LPC", "PD", "NS"].map(|kind| {
                    special(&lap, kind)
                        .into_iter()
                        .map(move |point| (kind.to_owned(), number(&point["value"])))
                });
                let mut labels: Vec<(String, f64)> = labels.into_iter().flatten().collect();
                labels.sort_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
                let known = known.get_or_insert_with(|| labels.clone());
                assert_eq!(known.len(), labels.len(), "{case}: {known:?} and {labels:?}");
                for (one, other) in known.iter().zip(&labels) {
                    assert!(
                        one.0 == other.0 && (one.1 - other.1).abs() < 1e-5,
                        "{case}: {known:?} and {labels:?}"
                    );
                }
                laps += 1;
            }
        }
    }
    assert_eq!(laps, 96);
}
