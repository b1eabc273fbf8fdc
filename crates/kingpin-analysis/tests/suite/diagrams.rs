//! Several results of a wheel in one diagram.

use arclength_analysis::picture::OwnColor;
use kingpin_analysis::ResultFile;
use kingpin_analysis::diagram::diagram;
use kingpin_figure::{SvgOptions, palette};
use std::path::Path;

fn cycles() -> ResultFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/version_1/cycles.json");
    ResultFile::read(&path).unwrap()
}

/// The diagram as SVG with its labels as text.
fn drawn(results: &[ResultFile], colors: &[Option<OwnColor>]) -> String {
    let options = SvgOptions { text: true, ..SvgOptions::default() };
    diagram(results, colors).unwrap().to_svg_with(options).unwrap()
}

#[test]
fn branches_that_lie_on_each_other_have_their_labels_once() {
    let count = |svg: &str, label: &str| svg.matches(&format!(">{label}<")).count();
    let (one, two) = (drawn(&[cycles()], &[]), drawn(&[cycles(), cycles()], &[]));
    for label in ["HB1", "AT1"] {
        assert_eq!(count(&one, label), 1, "{one}");
        assert_eq!(count(&two, label), 1, "{two}");
    }
}

#[test]
fn a_result_in_a_colour_of_its_own_has_an_entry_in_the_legend() {
    let own = OwnColor { color: palette::PURPLE, name: "cycles-2".to_owned() };
    let plain = drawn(&[cycles(), cycles()], &[]);
    let colored = drawn(&[cycles(), cycles()], &[None, Some(own)]);
    assert!(!plain.contains("#cc79a7") && !plain.contains("cycles-2"), "{plain}");
    assert!(colored.contains("#cc79a7") && colored.contains("cycles-2"), "{colored}");
    // The other one keeps the colour of its kind.
    assert!(colored.contains("#d55e00"), "{colored}");
}
