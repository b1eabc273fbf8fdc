//! `report.html`: the figures and the statements on one page that needs no other file.

use super::claims::{Claim, Verdict};
use std::fmt::Write;

/// A figure as it stands on the page.
pub(super) struct PageFigure<'a> {
    pub number: u8,
    pub svg: &'a str,
    /// In HTML.
    pub caption: &'a str,
}

const STYLE: &str = include_str!("page.css");

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
    for PageFigure { number, svg, caption } in figures {
        body += &format!(
            "<figure id=\"figure{number}\">\n<div class=\"picture\">{}</div>\n<figcaption><b>Figure {number}.</b> {caption} \
             <span class=\"files\">Files: figure{number}.svg, figure{number}.png, figure{number}.csv.</span></figcaption>\n</figure>\n",
            own_names(svg, *number)
        );
    }
    body += "<h2 id=\"statements\">Statements</h2>\n<p>The statements are paraphrased. Verdicts and numbers were computed in \
             the run that wrote this page.</p>\n<ol class=\"statements\">\n";
    for claim in claims {
        body += &statement(claim);
    }
    body += "</ol>\n</main>\n";
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>The towed wheel in cornering</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <footer>Written by kingpin {}.</footer>\n</body>\n</html>\n",
        env!("CARGO_PKG_VERSION")
    )
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

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Plain text as HTML: indices lowered, and no line break before a unit or beside an equals sign.
fn prose(text: &str) -> String {
    const UNITS: [&str; 6] = ["m", "m/s", "rad", "rad/s", "N", "%"];
    let mut html = String::new();
    let mut before = "";
    for word in text.split(' ') {
        let unit = word.trim_end_matches([',', '.', ';', ':', ')']);
        let after_number = before.ends_with(|character: char| character.is_ascii_digit());
        if !html.is_empty() {
            let together = word == "=" || before == "=" || (after_number && UNITS.contains(&unit));
            html.push_str(if together { "&nbsp;" } else { " " });
        }
        html.push_str(&with_indices(&escaped(word)));
        before = word;
    }
    html
}

/// `m_c` with its index lowered.
fn with_indices(word: &str) -> String {
    let mut parts = word.split('_');
    let mut html = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|character: char| !character.is_alphabetic()).unwrap_or(part.len());
        let (index, rest) = part.split_at(end);
        html += &format!("<sub>{index}</sub>{rest}");
    }
    html
}

/// The names of glyphs are those of one picture; on a page with several each gets its own. The picture takes the width
/// that there is.
fn own_names(svg: &str, number: u8) -> String {
    svg.replace(" id=\"", &format!(" id=\"f{number}-"))
        .replace("xlink:href=\"#", &format!("xlink:href=\"#f{number}-"))
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
            evidence: "m_c = 1 N & (J_wξ/l_c)".into(),
        };
        let figures = [2, 3].map(|number| PageFigure { number, svg, caption: "" });
        let page = page(&figures, &[claim], "");
        let evidence = "m<sub>c</sub>&nbsp;=&nbsp;1&nbsp;N &amp; (J<sub>wξ</sub>/l<sub>c</sub>)";
        let summary = "1 <span class=\"verdict sharpened\">";
        for part in ["id=\"f2-t1\"", "#f3-t1", "a &lt; b", evidence, summary] {
            assert!(page.contains(part), "{part}");
        }
    }
}
