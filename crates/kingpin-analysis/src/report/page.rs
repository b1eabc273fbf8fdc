//! `report.html`: the findings, the figures and the wheel on one page that needs no other file.

use super::finding::Finding;
use crate::page::{PageFigure, document, escaped, prose};
use kingpin::Wheel;
use kingpin_report::numbers::readable;

/// The page.
pub(super) fn page(name: &str, wheel: &Wheel, findings: &[Finding], figures: &[PageFigure]) -> String {
    let open = findings.iter().filter(|finding| finding.undecided).count();
    let left_open = match open {
        0 => String::new(),
        1 => "<p>One question is left open; it is marked.</p>\n".to_owned(),
        open => format!("<p>{open} questions are left open; they are marked.</p>\n"),
    };
    // The verdict comes first.
    let (verdict, findings) = match findings {
        [verdict, findings @ ..] => (format!("<p><strong>{}</strong></p>\n", prose(&verdict.text)), findings),
        [] => (String::new(), findings),
    };
    let mut body = format!(
        "<header>\n<h1>Does it shimmy? {}</h1>\n{verdict}{left_open}</header>\n<main>\n<ol class=\"statements\">\n",
        escaped(name)
    );
    for Finding { subject, text, check, undecided } in findings {
        let mark = if *undecided { " <span class=\"verdict corrected\">undecided</span>" } else { "" };
        body += &format!(
            "<li class=\"{}\">\n<p class=\"statement\"><b>{}.</b> {}{mark}</p>\n",
            if *undecided { "corrected" } else { "confirmed" },
            prose(subject),
            prose(text)
        );
        if !check.is_empty() {
            body += &format!("<p class=\"evidence\">Checked: {}</p>\n", prose(check));
        }
        body += "</li>\n";
    }
    body += "</ol>\n";
    for figure in figures {
        body += &figure.html();
    }
    body += "<h2>The wheel</h2>\n<table class=\"wheel\">\n";
    for (key, value) in wheel.parameters() {
        let unit = if key.unit() == "1" { "" } else { key.unit() };
        body += &format!(
            "<tr><td>{}</td><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            prose(key.name()),
            key.name(),
            readable(value),
            unit.replace("^2", "²"),
            escaped(key.meaning())
        );
    }
    body += "</table>\n</main>\n";
    document(&format!("Does it shimmy? {name}"), &body)
}
