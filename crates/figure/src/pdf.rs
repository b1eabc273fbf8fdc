//! Writes a scene as PDF with vector outlines, one page the size of the figure.

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use crate::color::{Color, palette};
use crate::font::UNITS_PER_EM;
use crate::geometry::Point;
use crate::path::{Path, Segment};
use crate::scene::{Item, Raster, Scene};

/// Effort of the deflate compression, from 0 to 10.
const COMPRESSION: u8 = 6;

/// Writes the scene as PDF.
pub(crate) fn write(scene: &Scene) -> Vec<u8> {
    let mut page =
        Page { height: scene.height, content: Content::new(), opacities: Vec::new(), rasters: Vec::new() };
    // Paper is white by itself.
    if scene.paper != palette::WHITE {
        page.content.save_state();
        page.fill_color(scene.paper);
        page.content.rect(0.0, 0.0, scene.width as f32, scene.height as f32);
        page.content.fill_nonzero();
        page.content.restore_state();
    }
    for item in &scene.items {
        page.draw(item);
    }

    let mut pdf = Pdf::new();
    let mut next = 1;
    let mut reference = || {
        next += 1;
        Ref::new(next - 1)
    };
    let (catalog, pages, leaf, stream, info) =
        (reference(), reference(), reference(), reference(), reference());
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([leaf]).count(1);
    if !scene.description.is_empty() {
        pdf.document_info(info).title(TextStr(&scene.description));
    }
    let raster_references: Vec<(Ref, Ref)> =
        page.rasters.iter().map(|_| (reference(), reference())).collect();

    let mut leaf = pdf.page(leaf);
    leaf.media_box(Rect::new(0.0, 0.0, scene.width as f32, scene.height as f32));
    leaf.parent(pages);
    leaf.contents(stream);
    let mut resources = leaf.resources();
    let mut states = resources.ext_g_states();
    for (i, opacity) in page.opacities.iter().enumerate() {
        states
            .insert(Name(format!("G{i}").as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState<'_>>()
            .stroking_alpha(*opacity)
            .non_stroking_alpha(*opacity);
    }
    states.finish();
    let mut objects = resources.x_objects();
    for (i, (image, _)) in raster_references.iter().enumerate() {
        objects.pair(Name(format!("I{i}").as_bytes()), *image);
    }
    objects.finish();
    resources.finish();
    leaf.finish();

    for (raster, (image, mask)) in page.rasters.iter().zip(&raster_references) {
        write_raster(&mut pdf, raster, *image, *mask);
    }
    let content = deflate(&page.content.finish());
    pdf.stream(stream, &content).filter(Filter::FlateDecode);
    pdf.finish()
}

fn deflate(data: &[u8]) -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(data, COMPRESSION)
}

fn write_raster(pdf: &mut Pdf, raster: &Raster, image: Ref, mask: Ref) {
    let colors: Vec<u8> = raster.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let opacities: Vec<u8> = raster.pixels.iter().map(|pixel| pixel[3]).collect();
    let (width, height) = (raster.columns as i32, raster.rows as i32);
    let colors = deflate(&colors);
    let mut object = pdf.image_xobject(image, &colors);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8);
    object.color_space().device_rgb();
    object.s_mask(mask);
    object.finish();
    let opacities = deflate(&opacities);
    let mut object = pdf.image_xobject(mask, &opacities);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8);
    object.color_space().device_gray();
}

struct Page<'a> {
    height: f64,
    content: Content,
    /// Opacities in use; the graphics state `G0` sets the first, and so on.
    opacities: Vec<f32>,
    rasters: Vec<&'a Raster>,
}

impl<'a> Page<'a> {
    fn draw(&mut self, item: &'a Item) {
        self.content.save_state();
        match item {
            Item::Shape { path, fill, stroke } => {
                let height = self.height;
                let place = |p: Point| (p.x as f32, (height - p.y) as f32);
                if let Some(color) = fill {
                    self.fill_color(*color);
                    outline(&mut self.content, path, place);
                    self.content.fill_nonzero();
                }
                if let Some(stroke) = stroke {
                    self.stroke_color(stroke.color);
                    self.content.set_line_width(stroke.width as f32);
                    self.content.set_line_join(LineJoinStyle::RoundJoin);
                    self.content.set_line_cap(LineCapStyle::ButtCap);
                    let pattern = stroke.dash.pattern(stroke.width).iter().map(|length| *length as f32);
                    self.content.set_dash_pattern(pattern, 0.0);
                    outline(&mut self.content, path, place);
                    self.content.stroke();
                }
            }
            Item::Raster { frame, raster } => {
                let name = format!("I{}", self.rasters.len());
                self.rasters.push(raster);
                self.content.transform([
                    frame.width() as f32,
                    0.0,
                    0.0,
                    frame.height() as f32,
                    frame.left as f32,
                    (self.height - frame.bottom) as f32,
                ]);
                self.content.x_object(Name(name.as_bytes()));
            }
            Item::Text { layout, at, degrees, color, halo } => {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let height = self.height;
                for pass in [*halo, None].iter().skip(usize::from(halo.is_none())) {
                    if let Some(halo) = pass {
                        self.stroke_color(halo.color);
                        self.content.set_line_width(2.0 * halo.width as f32);
                        self.content.set_line_join(LineJoinStyle::RoundJoin);
                    } else {
                        self.fill_color(*color);
                    }
                    for placed in &layout.glyphs {
                        let scale = placed.size / UNITS_PER_EM;
                        let place = |p: Point| {
                            let (x, y) = (placed.at.x + scale * p.x, placed.at.y + scale * p.y);
                            let turned = at.offset(cosine * x - sine * y, sine * x + cosine * y);
                            (turned.x as f32, (height - turned.y) as f32)
                        };
                        let glyph = placed.glyph.outline();
                        if glyph.segments.is_empty() {
                            continue;
                        }
                        outline(&mut self.content, &glyph, place);
                        if pass.is_some() {
                            self.content.stroke();
                        } else {
                            self.content.fill_nonzero();
                        }
                    }
                }
            }
        }
        self.content.restore_state();
    }

    fn fill_color(&mut self, color: Color) {
        let [r, g, b] = color.rgb.map(|c| f32::from(c) / 255.0);
        self.content.set_fill_rgb(r, g, b);
        self.opacity(color);
    }

    fn stroke_color(&mut self, color: Color) {
        let [r, g, b] = color.rgb.map(|c| f32::from(c) / 255.0);
        self.content.set_stroke_rgb(r, g, b);
        self.opacity(color);
    }

    fn opacity(&mut self, color: Color) {
        if color.opacity >= 1.0 {
            return;
        }
        let opacity = color.opacity as f32;
        let index = self.opacities.iter().position(|known| *known == opacity).unwrap_or_else(|| {
            self.opacities.push(opacity);
            self.opacities.len() - 1
        });
        self.content.set_parameters(Name(format!("G{index}").as_bytes()));
    }
}

fn outline(content: &mut Content, path: &Path, place: impl Fn(Point) -> (f32, f32)) {
    // PDF has no quadratic curves; a cubic with its control points two thirds of the way is the same curve.
    let mut at = Point::new(0.0, 0.0);
    for segment in &path.segments {
        match *segment {
            Segment::Move(p) => {
                let (x, y) = place(p);
                content.move_to(x, y);
                at = p;
            }
            Segment::Line(p) => {
                let (x, y) = place(p);
                content.line_to(x, y);
                at = p;
            }
            Segment::Quad(a, p) => {
                cubic(content, &place, at.lerp(a, 2.0 / 3.0), p.lerp(a, 2.0 / 3.0), p);
                at = p;
            }
            Segment::Cubic(a, b, p) => {
                cubic(content, &place, a, b, p);
                at = p;
            }
            Segment::Close => {
                content.close_path();
            }
        }
    }
}

fn cubic(content: &mut Content, place: impl Fn(Point) -> (f32, f32), a: Point, b: Point, end: Point) {
    let ((ax, ay), (bx, by), (x, y)) = (place(a), place(b), place(end));
    content.cubic_to(ax, ay, bx, by, x, y);
}
