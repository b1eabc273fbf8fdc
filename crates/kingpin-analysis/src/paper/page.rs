//! `report.html`: the figures and the statements on one page that needs no other file.

use super::claims::{Claim, Verdict};
use crate::page::{PageFigure, document, prose};
use std::fmt::Write;

/// The page.
pub(super) fn page(figures: &[PageFigure], claims: &[Claim], parameters: &str) -> String {
    let count = |verdict: Verdict| claims.iter().filter(|claim| claim.verdict == verdict).count();
    let mut summary: Vec<String> = Vec::new();
    for verdict in [Verdict::Confirmed, Verdict::Sharpened, Verdict::Corrected, Verdict::Contradicted] {
        if count(verdict) > 0 {
            summary.push(format!("{} {}", count(verdict), badge(verdict)));
        }
    }
    let mut body = format!(
        "<header>\n<h1>The towed wheel in cornering</h1>\n\
         <p>Figures 2 to 6 of <cite>Stability of towed wheels in cornering manoeuvre</cite>, computed again, and every \
         statement of its text beside what was computed: {}.</p>\n<p class=\"parameters\">{parameters}</p>\n</header>\n<main>\n",
        summary.join(", ")
    );
    for figure in figures {
        body += &figure.html();
    }
    body += "<h2 id=\"statements\">Statements</h2>\n<p>The statements are paraphrased. Verdicts and numbers were computed in \
             the run that wrote this page.</p>\n<ol class=\"statements\">\n";
    for claim in claims {
        body += &statement(claim);
    }
    body += "</ol>\n</main>\n";
    document("The towed wheel in cornering", &body)
}

fn statement(claim: &Claim) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<li class=\"{}\">\n<p class=\"statement\">{} {} <span class=\"place\">{}</span></p>\n\
         <p class=\"evidence\">{}</p>\n</li>\n",
        claim.verdict.word(),
        badge(claim.verdict),
        prose(&claim.statement),
        prose(claim.place),
        prose(&claim.evidence)
    );
    text
}

fn badge(verdict: Verdict) -> String {
    format!("<span class=\"verdict {0}\">{0}</span>", verdict.word())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_pictures_do_not_clash_and_text_is_escaped() {
        let svg = "<svg><path id=\"t1\"/><use xlink:href=\"#t1\"/></svg>";
        let claim = Claim {
            place: "section 3",
            statement: "a < b".into(),
            verdict: Verdict::Sharpened,
            evidence: "m_c = 1 N & (J_wξ/l_c), c_psi, mu_s.".into(),
        };
        let figures = [2, 3].map(|number| PageFigure { number, svg, caption: "" });
        let page = page(&figures, &[claim], "");
        let evidence = "m<sub>c</sub>&nbsp;=&nbsp;1&nbsp;N &amp; (J<sub>wξ</sub>/l<sub>c</sub>), c<sub>ψ</sub>, μ<sub>s</sub>.";
        let summary = "1 <span class=\"verdict sharpened\">";
        for part in ["id=\"f2-t1\"", "#f3-t1", "a &lt; b", evidence, summary] {
            assert!(page.contains(part), "{part}");
        }
    }
}
