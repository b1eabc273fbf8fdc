//! Draws a scene into pixels with `tiny-skia` and writes them as PNG.

use std::collections::BTreeMap;

use tiny_skia::{
    FillRule, FilterQuality, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, StrokeDash, Transform,
};

use crate::color::Color;
use crate::error::FigureError;
use crate::font::{Glyph, UNITS_PER_EM};
use crate::geometry::Rect;
use crate::path::{Path, Segment};
use crate::scene::{Item, Raster, Scene, Stroke};

/// Points per inch.
const POINTS_PER_INCH: f64 = 72.0;
/// The smallest resolution at which anything can be recognised.
const LOWEST_DPI: f64 = 10.0;
/// The largest picture that is drawn, in pixels: 64 million take 256 MB while drawing.
const MOST_PIXELS: f64 = 64e6;

/// Writes the scene as PNG at a resolution in dots per inch.
pub(crate) fn write(scene: &Scene, dpi: f64) -> Result<Vec<u8>, FigureError> {
    let highest = POINTS_PER_INCH * (MOST_PIXELS / (scene.width * scene.height)).sqrt();
    let unusable = || FigureError::Resolution { dpi, lowest: LOWEST_DPI, highest: highest.floor() };
    if !(LOWEST_DPI..=highest).contains(&dpi) {
        return Err(unusable());
    }
    let scale = dpi / POINTS_PER_INCH;
    let (width, height) = ((scene.width * scale).round() as u32, (scene.height * scale).round() as u32);
    let mut pixmap = Pixmap::new(width, height).ok_or_else(unusable)?;
    let [red, green, blue] = scene.paper.rgb;
    pixmap.fill(tiny_skia::Color::from_rgba8(red, green, blue, 255));
    let page = Transform::from_scale(
        (f64::from(width) / scene.width) as f32,
        (f64::from(height) / scene.height) as f32,
    );
    let mut outlines: BTreeMap<Glyph, Option<tiny_skia::Path>> = BTreeMap::new();
    for item in &scene.items {
        match item {
            Item::Shape { path, fill, stroke } => {
                let Some(path) = skia_path(path) else { continue };
                if let Some(color) = fill {
                    pixmap.fill_path(&path, &skia_paint(*color), FillRule::Winding, page, None);
                }
                if let Some(stroke) = stroke {
                    pixmap.stroke_path(&path, &skia_paint(stroke.color), &skia_stroke(stroke), page, None);
                }
            }
            Item::Raster { frame, raster } => draw_raster(&mut pixmap, frame, raster, page),
            Item::Text { layout, at, degrees, color, halo } => {
                let place = page
                    .pre_concat(Transform::from_translate(at.x as f32, at.y as f32))
                    .pre_concat(Transform::from_rotate(*degrees as f32));
                for pass in [*halo, None].iter().skip(usize::from(halo.is_none())) {
                    for placed in &layout.glyphs {
                        let outline = outlines
                            .entry(placed.glyph)
                            .or_insert_with(|| skia_path(&placed.glyph.outline()));
                        let Some(outline) = outline else { continue };
                        let size = (placed.size / UNITS_PER_EM) as f32;
                        let transform = place
                            .pre_concat(Transform::from_translate(placed.at.x as f32, placed.at.y as f32))
                            .pre_scale(size, size);
                        if let Some(halo) = pass {
                            let rim = tiny_skia::Stroke {
                                width: 2.0 * halo.width as f32 / size,
                                line_join: LineJoin::Round,
                                ..Default::default()
                            };
                            pixmap.stroke_path(outline, &skia_paint(halo.color), &rim, transform, None);
                        } else {
                            pixmap.fill_path(
                                outline,
                                &skia_paint(*color),
                                FillRule::Winding,
                                transform,
                                None,
                            );
                        }
                    }
                }
            }
        }
    }
    // The page is opaque, so premultiplied and plain components are the same and opacity need not be stored.
    let opaque: Vec<u8> =
        pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    encode(width as usize, height as usize, &opaque, Some(dpi))
}

/// Encodes 8-bit pixels, three bytes each when opaque, otherwise four, with the resolution when one is given.
pub(crate) fn encode(
    columns: usize,
    rows: usize,
    pixels: &[u8],
    dpi: Option<f64>,
) -> Result<Vec<u8>, FigureError> {
    let mut data = Vec::new();
    let mut encoder = png::Encoder::new(&mut data, columns as u32, rows as u32);
    let opaque = pixels.len() == 3 * columns * rows;
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    if let Some(dpi) = dpi {
        let per_metre = (dpi / 0.0254).round() as u32;
        encoder.set_pixel_dims(Some(png::PixelDimensions {
            xppu: per_metre,
            yppu: per_metre,
            unit: png::Unit::Meter,
        }));
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(data)
}

fn draw_raster(pixmap: &mut Pixmap, frame: &Rect, raster: &Raster, page: Transform) {
    let Some(mut source) = Pixmap::new(raster.columns as u32, raster.rows as u32) else { return };
    for (target, [r, g, b, a]) in source.pixels_mut().iter_mut().zip(&raster.pixels) {
        *target = tiny_skia::ColorU8::from_rgba(*r, *g, *b, *a).premultiply();
    }
    let transform =
        page.pre_concat(Transform::from_translate(frame.left as f32, frame.top as f32)).pre_scale(
            (frame.width() / raster.columns as f64) as f32,
            (frame.height() / raster.rows as f64) as f32,
        );
    let paint = PixmapPaint { quality: FilterQuality::Nearest, ..Default::default() };
    pixmap.draw_pixmap(0, 0, source.as_ref(), &paint, transform, None);
}

fn skia_paint(color: Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Default::default() };
    let [r, g, b] = color.rgb;
    paint.set_color_rgba8(r, g, b, (255.0 * color.opacity).round() as u8);
    paint
}

fn skia_stroke(stroke: &Stroke) -> tiny_skia::Stroke {
    let pattern = stroke.dash.pattern(stroke.width);
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_join: LineJoin::Round,
        dash: StrokeDash::new(pattern.iter().map(|length| *length as f32).collect(), 0.0),
        ..Default::default()
    }
}

fn skia_path(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for segment in &path.segments {
        match segment {
            Segment::Move(p) => builder.move_to(p.x as f32, p.y as f32),
            Segment::Line(p) => builder.line_to(p.x as f32, p.y as f32),
            Segment::Quad(a, p) => builder.quad_to(a.x as f32, a.y as f32, p.x as f32, p.y as f32),
            Segment::Cubic(a, b, p) => {
                builder.cubic_to(a.x as f32, a.y as f32, b.x as f32, b.y as f32, p.x as f32, p.y as f32);
            }
            Segment::Close => builder.close(),
        }
    }
    builder.finish()
}
