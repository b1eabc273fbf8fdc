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

#[test]
fn unknown_studies_are_refused() {
    let run = Folder::new().run("study isolas");
    assert_eq!(run.exit_code, 2);
    assert!(run.messages.contains("isola"), "{}", run.messages);
}
