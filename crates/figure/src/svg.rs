//! Writes a scene as SVG: outlines only unless text is asked for, no fonts, no scripts, so it can stand alone or inside HTML.
//!
//! Coordinates are rounded to 0.01 pt (3.5 µm) and written relative to the point before. Each glyph is defined once and
//! used by reference; its name depends only on the glyph, so several figures in one HTML page do not disturb each other.

use std::collections::BTreeSet;
use std::fmt::Write;

use base64::Engine;

use crate::color::Color;
use crate::error::FigureError;
use crate::font::{Font, Glyph, UNITS_PER_EM};
use crate::geometry::Point;
use crate::path::{Path, Segment};
use crate::png::encode;
use crate::scene::{Item, Scene, Stroke};
use crate::text::{PlacedGlyph, TextLayout, upright};

/// Steps per point on the page.
const PAGE_STEPS: f64 = 100.0;
/// Points per millimetre.
pub(crate) const POINTS_PER_MM: f64 = 72.0 / 25.4;

/// Fonts of text that is no outline: those that look like the outlines, then any that a system has for print.
const FONTS: &str =
    "Latin Modern Roman, CMU Serif, STIX Two Text, STIX Two Math, Cambria Math, Times New Roman, serif";

/// How a figure is written as SVG.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SvgOptions {
    /// Labels are text, which can be searched and copied but looks as the fonts of the reader do; without, outlines of glyphs.
    pub text: bool,
    /// It has no size of its own and fills what it stands in; without, that of the figure in millimetres.
    pub fluid: bool,
}

/// Writes the scene as SVG text.
pub(crate) fn write(scene: &Scene, options: SvgOptions) -> Result<String, FigureError> {
    let mut body = String::new();
    let mut glyphs = BTreeSet::new();
    for item in &scene.items {
        match item {
            Item::Shape { path, fill, stroke } => shape(&mut body, path, *fill, *stroke),
            Item::Raster { frame, raster } => {
                let png = encode(raster.columns, raster.rows, raster.pixels.as_flattened(), None)?;
                let data = base64::engine::general_purpose::STANDARD.encode(png);
                push(
                    &mut body,
                    format_args!(
                        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
                         image-rendering=\"optimizeSpeed\" style=\"image-rendering:pixelated\" \
                         xlink:href=\"data:image/png;base64,{data}\"/>\n",
                        number(frame.left),
                        number(frame.top),
                        number(frame.width()),
                        number(frame.height()),
                    ),
                );
            }
            Item::Text { layout, at, degrees, color, halo } => {
                if !options.text {
                    glyphs.extend(layout.glyphs.iter().map(|placed| placed.glyph).filter(has_outline));
                }
                let runs = if options.text { texts } else { runs };
                let mut transform = format!("translate({} {})", number(at.x), number(at.y));
                if *degrees != 0.0 {
                    push(&mut transform, format_args!(" rotate({})", number(*degrees)));
                }
                push(&mut body, format_args!("<g transform=\"{transform}\"{}>", paint("fill", *color)));
                if let Some(halo) = halo {
                    body.push_str("<g stroke-linejoin=\"round\"");
                    body.push_str(&paint("fill", halo.color));
                    body.push_str(&paint("stroke", halo.color));
                    body.push('>');
                    runs(&mut body, layout, Some(halo.width));
                    body.push_str("</g>");
                }
                runs(&mut body, layout, None);
                body.push_str("</g>\n");
            }
        }
    }

    let mut text = String::with_capacity(body.len() + 400 * glyphs.len() + 500);
    let (width, height) = (scene.width, scene.height);
    let size = if options.fluid {
        String::new()
    } else {
        let (width, height) = (number(width / POINTS_PER_MM), number(height / POINTS_PER_MM));
        format!("width=\"{width}mm\" height=\"{height}mm\" ")
    };
    push(
        &mut text,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             {size}viewBox=\"0 0 {} {}\" role=\"img\">\n",
            number(width),
            number(height)
        ),
    );
    if !scene.description.is_empty() {
        push(&mut text, format_args!("<title>{}</title>\n", escape(&scene.description)));
    }
    if !scene.detail.is_empty() {
        push(&mut text, format_args!("<desc>{}</desc>\n", escape(&scene.detail)));
    }
    if !glyphs.is_empty() {
        text.push_str("<defs>\n");
        for glyph in glyphs {
            push(
                &mut text,
                format_args!("<path id=\"{}\" d=\"{}\"/>\n", name(glyph), path_data(&glyph.outline(), 1.0)),
            );
        }
        text.push_str("</defs>\n");
    }
    push(
        &mut text,
        format_args!(
            "<path d=\"M0 0h{}v{}H0z\" fill=\"{}\"/>\n",
            number(width),
            number(height),
            scene.paper.hex()
        ),
    );
    text.push_str(&body);
    text.push_str("</svg>\n");
    Ok(text)
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = text.write_fmt(arguments);
}

fn has_outline(glyph: &Glyph) -> bool {
    !glyph.outline().segments.is_empty()
}

fn name(glyph: Glyph) -> String {
    let font = match glyph.font {
        Font::Text => "t",
        Font::Bold => "b",
    };
    format!("{font}{}", glyph.index)
}

fn shape(body: &mut String, path: &Path, fill: Option<Color>, stroke: Option<Stroke>) {
    push(body, format_args!("<path d=\"{}\"", path_data(path, PAGE_STEPS)));
    match fill {
        Some(color) => body.push_str(&paint("fill", color)),
        None => body.push_str(" fill=\"none\""),
    }
    if let Some(Stroke { color, width, dash }) = stroke {
        body.push_str(&paint("stroke", color));
        push(body, format_args!(" stroke-width=\"{}\" stroke-linejoin=\"round\"", number(width)));
        let pattern = dash.pattern(width);
        if !pattern.is_empty() {
            let lengths: Vec<String> = pattern.iter().map(|length| number(*length)).collect();
            push(body, format_args!(" stroke-dasharray=\"{}\"", lengths.join(" ")));
        }
    }
    body.push_str("/>\n");
}

fn paint(attribute: &str, color: Color) -> String {
    let mut text = format!(" {attribute}=\"{}\"", color.hex());
    if color.opacity < 1.0 {
        push(&mut text, format_args!(" {attribute}-opacity=\"{}\"", number(color.opacity)));
    }
    text
}

/// Glyphs of equal size and height share one group, scaled from font units.
fn runs(body: &mut String, layout: &TextLayout, halo: Option<f64>) {
    let glyphs: Vec<_> = layout.glyphs.iter().filter(|placed| has_outline(&placed.glyph)).collect();
    for run in glyphs.chunk_by(|a, b| a.size == b.size && a.at.y == b.at.y) {
        let scale = run[0].size / UNITS_PER_EM;
        let shift =
            if run[0].at.y == 0.0 { String::new() } else { format!("translate(0 {}) ", number(run[0].at.y)) };
        push(body, format_args!("<g transform=\"{shift}scale({})\"", decimal(scale, 1e5)));
        if let Some(width) = halo {
            push(body, format_args!(" stroke-width=\"{}\"", decimal(2.0 * width / scale, 1.0)));
        }
        body.push('>');
        for placed in run {
            let x = decimal(placed.at.x / scale, 1.0);
            push(body, format_args!("<use xlink:href=\"#{}\"", name(placed.glyph)));
            if x != "0" {
                push(body, format_args!(" x=\"{x}\""));
            }
            body.push_str("/>");
        }
        body.push_str("</g>");
    }
}

/// The same as text: every character stands where its glyph would.
fn texts(body: &mut String, layout: &TextLayout, halo: Option<f64>) {
    let is_italic = |placed: &PlacedGlyph| upright(placed.character) != placed.character;
    let alike = |a: &PlacedGlyph, b: &PlacedGlyph| {
        a.size == b.size && a.at.y == b.at.y && is_italic(a) == is_italic(b)
    };
    for run in layout.glyphs.chunk_by(alike) {
        let places: Vec<String> = run.iter().map(|placed| number(placed.at.x)).collect();
        let characters: String = run.iter().map(|placed| upright(placed.character)).collect();
        push(
            body,
            format_args!(
                "<text font-family=\"{FONTS}\" font-size=\"{}\" y=\"{}\" x=\"{}\" xml:space=\"preserve\"",
                number(run[0].size),
                number(run[0].at.y),
                places.join(" ")
            ),
        );
        if is_italic(&run[0]) {
            body.push_str(" font-style=\"italic\"");
        }
        if let Some(width) = halo {
            // It is said once, by the text itself.
            push(body, format_args!(" stroke-width=\"{}\" aria-hidden=\"true\"", number(2.0 * width)));
        }
        push(body, format_args!(">{}</text>", escape(&characters)));
    }
}

/// A length on the page as text.
fn number(value: f64) -> String {
    decimal(value, PAGE_STEPS)
}

/// The value rounded to a multiple of 1/steps, a power of ten, without superfluous zeros.
fn decimal(value: f64, steps: f64) -> String {
    fixed((value * steps).round() as i64, steps)
}

fn fixed(steps_taken: i64, steps: f64) -> String {
    let digits = steps.log10().round() as usize;
    let divisor = 10_i64.pow(digits as u32);
    let sign = if steps_taken < 0 { "-" } else { "" };
    let magnitude = steps_taken.unsigned_abs();
    let (whole, fraction) = (magnitude / divisor.unsigned_abs(), magnitude % divisor.unsigned_abs());
    if fraction == 0 {
        return format!("{sign}{whole}");
    }
    let fraction = format!("{fraction:0digits$}");
    let whole = if whole == 0 { String::new() } else { whole.to_string() };
    format!("{sign}{whole}.{}", fraction.trim_end_matches('0'))
}

/// Path data with relative coordinates, counted in whole steps so that rounding does not add up.
fn path_data(path: &Path, steps: f64) -> String {
    let mut data = String::new();
    let mut at = (0, 0);
    let mut start = at;
    let mut last_command = ' ';
    let grid = |p: Point| ((p.x * steps).round() as i64, (p.y * steps).round() as i64);
    for segment in &path.segments {
        let (command, points): (char, &[Point]) = match segment {
            Segment::Move(p) => ('m', &[*p]),
            Segment::Line(p) => ('l', &[*p]),
            Segment::Quad(a, p) => ('q', &[*a, *p]),
            Segment::Cubic(a, b, p) => ('c', &[*a, *b, *p]),
            Segment::Close => ('z', &[]),
        };
        let target = points.last().map(|p| grid(*p));
        if command == 'l'
            && target == Some(at)
            && data.ends_with(|c: char| c.is_ascii_digit())
            && last_command == 'l'
        {
            continue;
        }
        // After a move, further pairs are lines.
        if !(command == last_command && command != 'm' || command == 'l' && last_command == 'm') {
            data.push(command);
        }
        last_command = command;
        for p in points {
            let (x, y) = grid(*p);
            for step in [x - at.0, y - at.1] {
                if step >= 0 && data.ends_with(|c: char| c.is_ascii_digit()) {
                    data.push(' ');
                }
                data.push_str(&fixed(step, steps));
            }
        }
        match (target, command) {
            (Some(target), 'm') => {
                at = target;
                start = target;
            }
            (Some(target), _) => at = target,
            (None, _) => at = start,
        }
    }
    data
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::palette;
    use crate::scene::Dash;

    #[test]
    fn numbers_are_short_and_never_exponents() {
        let cases =
            [(0.0, "0"), (-0.001, "0"), (0.5, ".5"), (-0.25, "-.25"), (12.0, "12"), (1234.567, "1234.57")];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn relative_paths_return_to_where_the_points_are() {
        let points = [(0.0, 0.0), (1.004, 2.0), (2.008, 4.0), (0.0, 0.0)].map(Point::from);
        assert_eq!(path_data(&Path::polyline(&points), 100.0), "m0 0 1 2 1.01 2-2.01-4");
        assert_eq!(path_data(&Path::polygon(&points[..2]), 100.0), "m0 0 1 2z");
    }

    #[test]
    fn a_small_scene_is_written_as_expected() {
        let mut scene = Scene::new(72.0, 36.0, "a < b".to_owned());
        let line = Path::polyline(&[Point::new(10.0, 10.0), Point::new(60.0, 20.0)]);
        scene.stroke(line, Stroke { color: palette::BLUE, width: 1.0, dash: Dash::Dashed });
        scene.fill(
            Path::rectangle(&crate::geometry::Rect::new(1.0, 1.0, 3.0, 4.0)),
            palette::BLACK.with_opacity(0.5),
        );
        let svg = write(&scene, SvgOptions::default()).unwrap();
        assert_eq!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"25.4mm\" \
             height=\"12.7mm\" viewBox=\"0 0 72 36\" role=\"img\">\n<title>a &lt; b</title>\n\
             <path d=\"M0 0h72v36H0z\" fill=\"#fff\"/>\n\
             <path d=\"m10 10 50 10\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1\" stroke-linejoin=\"round\" \
             stroke-dasharray=\"4 2.2\"/>\n\
             <path d=\"m1 1 2 0 0 3-2 0z\" fill=\"#000\" fill-opacity=\".5\"/>\n</svg>\n"
        );
    }
}
