//! Pages that need no other file: figures with captions, text, and the style of all reports.

use kingpin::Key;

/// A figure as it stands on a page.
pub(crate) struct PageFigure<'a> {
    pub number: u8,
    pub svg: &'a str,
    /// In HTML.
    pub caption: &'a str,
}

impl PageFigure<'_> {
    /// The figure with its caption, which names the files that it is in as well.
    pub(crate) fn html(&self) -> String {
        let Self { number, svg, caption } = self;
        format!(
            "<figure id=\"figure{number}\">\n<div class=\"picture\">{}</div>\n<figcaption><b>Figure {number}.</b> {caption} \
             <span class=\"files\">Files: figure{number}.svg, figure{number}.png, figure{number}.pdf, figure{number}.csv.</span></figcaption>\n</figure>\n",
            own_names(svg, *number)
        )
    }
}

/// The whole page with its body.
pub(crate) fn document(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <footer>Written by kingpin {}.</footer>\n</body>\n</html>\n",
        escaped(title),
        env!("CARGO_PKG_VERSION")
    )
}

const STYLE: &str = include_str!("page.css");

/// Text without what HTML would read as markup.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Plain text as HTML: keys as the paper's symbols, indices lowered, and no line break before a unit or beside an equals sign.
pub(crate) fn prose(text: &str) -> String {
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

/// `m_c` with its index lowered, `mu_s` and `c_psi` with their Greek letters.
fn with_indices(word: &str) -> String {
    let name = word.trim_matches(|character| matches!(character, '(' | ')' | ',' | '.' | ';' | ':'));
    let key = Key::ALL.into_iter().find(|key| key.name() == name && name.contains('_'));
    let symbols = key.map(|key| word.replacen(name, key.symbol(), 1));
    let mut parts = symbols.as_deref().unwrap_or(word).split('_');
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
