//! The studies: numbers against references from elsewhere, and the files that are written.

use crate::{Folder, read};

fn value(findings: &serde_json::Value, start: &str) -> f64 {
    let list = findings["findings"].as_array().unwrap();
    let found = list.iter().find(|finding| finding["quantity"].as_str().unwrap().starts_with(start));
    found.unwrap_or_else(|| panic!("{start} among {list:?}"))["value"].as_f64().unwrap()
}

/// Folds from AUTO-07p (collocation, 150 x 4).
#[test]
fn the_isola_has_the_folds_of_the_reference() {
    let folder = Folder::new();
    let findings = folder.json("study isola --quiet");
    let near = |start: &str, reference: f64| {
        let found = value(&findings, start);
        assert!((found / reference - 1.0).abs() < 1e-7, "{start}: {found}, not {reference}");
    };
    near("lower fold of the isola at c_q = 0.1", 0.047780593);
    near("upper fold of the isola at c_q = 0.1", 14.0025055);
    // A root of m c_q v^2 + (m l k + l^2 c_q^2 - J k) v + l^3 c_q k, which the Hurwitz condition gives.
    near("Hopf point at c_q = 0.05", 0.788629146229695);
    let birth = value(&findings, "the last Hopf points meet");
    assert!(birth > 0.05 && birth < 0.1);
    let death = value(&findings, "the isola shrinks to a point");
    assert!(death > 0.5);
    for ending in ["svg", "png", "csv"] {
        assert!(read(&folder.path(&format!("studies/figure7.{ending}"))).len() > 1000);
    }
}

/// Twice as long, as heavy and four times as stiff: time runs twice as fast, and dampers are twice as strong.
#[test]
fn the_isola_of_a_similar_wheel_is_similar() {
    let folder = Folder::new();
    let similar = "l = 0.08\nl_c = 0.024\nR = 0.08\nm_w = 0.3519\nm_c = 0.0668\nJ_wxi = 1.852e-4\nJ_wzeta = 9.52e-5\n\
                   J_Cz = 1.392e-5\nk = 400\nr = inf\n";
    std::fs::write(folder.path("similar.toml"), similar).unwrap();
    let findings = folder.json("study isola --quiet --wheel similar.toml");
    let near = |start: &str, reference: f64| {
        let found = value(&findings, start);
        assert!((found / reference - 1.0).abs() < 1e-7, "{start}: {found}, not {reference}");
    };
    near("lower fold of the isola at c_q = 0.2", 4.0 * 0.047780593);
    near("upper fold of the isola at c_q = 0.2", 4.0 * 14.0025055);
    near("Hopf point at c_q = 0.1", 4.0 * 0.788629146229695);
    assert_eq!(findings["parameters"]["k_q"], 400.0);
}

#[test]
fn where_there_is_no_isola_that_is_said_with_what_was_searched() {
    let folder = Folder::new();
    // Longer than critical: no damper is needed, nothing can be detached.
    let run = folder.succeed("study isola --quiet -s l=0.08 -s r=inf -s k_u=inf");
    assert!(
        run.output.contains("no isola") && run.output.contains("stable at every speed"),
        "{}",
        run.output
    );
    assert!(!run.output.contains("replaces"), "{}", run.output);
    // The cycles of the trolley end where its Hopf points meet.
    let wheels = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
    let command = format!("study isola --quiet --wheel {wheels}/trolley.toml -s r=2");
    let output = folder.succeed(&command).output;
    for words in [
        "no isola was found",
        "from c_q = 5",
        "Searched were the branches from the Hopf points at c_q = 39",
        "a Hopf point at c_q = 5",
        "it replaces r = 2 m by r = inf, k_u = 30000 N/m by k_u = inf",
    ] {
        assert!(output.contains(words), "{words}: {output}");
    }
    assert!(!output.contains("the parameter"), "{output}");
    let result = folder.json(&command);
    assert_eq!(result["findings"].as_array().unwrap().len(), 0);
    assert!(result["notes"][0]["text"].as_str().unwrap().starts_with("no isola was found"), "{result}");
    assert!(!folder.path("studies").join("figure7.svg").exists());
}

/// Unstable at every speed: it shimmies, rolling and sliding in turn, and nothing else is stable beside it.
#[test]
fn the_sliding_study_of_a_trolley_ends_in_symmetric_shimmy() {
    let folder = Folder::new();
    let wheels = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
    let findings = folder.json(&format!("study sliding --quiet --wheel {wheels}/trolley.toml"));
    let start = "c_u = c_q = 0 N s/m: shimmy at v = 1.493 m/s, period";
    let period = value(&findings, start);
    let [largest, smallest] = ["  largest psi", "  smallest psi"].map(|name| value(&findings, name));
    assert!((largest + smallest).abs() < 1e-6 * largest, "{largest} {smallest}");
    let quantities: Vec<&str> = findings["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["quantity"].as_str().unwrap())
        .collect();
    assert!(quantities.contains(&"  stable shimmy from v"));
    assert!(
        !quantities.iter().any(|quantity| quantity.contains("both shimmy and uniform motion")),
        "{quantities:?}"
    );
    assert_eq!(value(&findings, "  stable shimmy from v"), 0.75);
    // The same motion by a time history: a period later the caster angle is back.
    let animation = String::from_utf8(read(&folder.path("studies/animation.svg"))).unwrap();
    assert!(animation.contains("straight, load 150 N") && !animation.contains("NaN"));
    let history = folder.json(&format!(
        "simulate --wheel {wheels}/trolley.toml -s v=1.493 --contact sliding --perturb psi=0.3 --duration {} --points 2001 -q",
        100.0 * period
    ));
    let angles: Vec<f64> =
        history["psi"].as_array().unwrap().iter().map(|angle| angle.as_f64().unwrap()).collect();
    let [last, before] = [2000, 1980].map(|index| angles[index]);
    assert!((last - before).abs() < 0.02 * largest, "{last} {before}");
    let swing = angles[1900..].iter().copied().fold(0.0, f64::max);
    assert!((swing / largest - 1.0).abs() < 0.02, "{swing} {largest}");
}

/// The dolly on a circle does not shimmy at the speed at which the study begins.
#[test]
fn where_no_sliding_shimmy_is_found_it_is_said_where_it_was_sought() {
    let wheels = concat!(env!("CARGO_MANIFEST_DIR"), "/../kingpin/examples/wheels");
    let run = Folder::new().run(&format!("study sliding --quiet --wheel {wheels}/dolly.toml -s r=2"));
    assert_eq!(run.exit_code, 1);
    for words in [
        "no shimmy with sliding phases was found",
        "at v = 1.128 m/s, 0.995 of the critical speed, where this study begins",
        "`kingpin shimmy` seeks it over all speeds",
    ] {
        assert!(run.messages.contains(words), "{words}: {}", run.messages);
    }
    assert!(!run.messages.contains("1.6787554630915"), "{}", run.messages);
}

#[test]
fn studies_of_the_papers_wheel_take_no_other() {
    for study in ["basin", "damping", "step-steer", "all"] {
        let run = Folder::new().run(&format!("study {study} -q -s l=0.1"));
        assert_eq!(run.exit_code, 2, "{study}: {}", run.messages);
        assert!(run.messages.contains("a wheel with `isola` or `sliding`"), "{}", run.messages);
    }
}

#[test]
fn unknown_studies_are_refused() {
    let run = Folder::new().run("study isolas");
    assert_eq!(run.exit_code, 2);
    assert!(run.messages.contains("isola"), "{}", run.messages);
}
