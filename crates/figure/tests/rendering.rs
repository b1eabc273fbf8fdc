//! Whole figures: the three writers agree, bytes repeat, and no input leads to a broken file.

use kingpin_figure::{
    Axis, Branch, ColorMap, Figure, Grid, HeatMap, Legend, Line, Marker, Markers, Note, Panel, Panel3d,
    Point, PointLabel, Region, SvgOptions, Theme, Wall, palette,
};
use proptest::prelude::*;

fn wave(amplitude: f64) -> Vec<Point> {
    (0..200).map(|i| f64::from(i) / 20.0).map(|x| Point::new(x, amplitude * x.sin())).collect()
}

fn rich_figure() -> Figure {
    let nodes: Vec<f64> = (0..40).map(|i| f64::from(i) / 39.0).collect();
    let values: Vec<f64> = nodes.iter().flat_map(|y| nodes.iter().map(move |x| x - y * y)).collect();
    let map = HeatMap::new(Grid::new(nodes.clone(), nodes).unwrap(), values).unwrap();
    let zero = map.contour(0.0);
    let heat = Panel::new(Axis::new("$x$"), Axis::new("$y$"))
        .tag("(a)")
        .map(map.color_map(ColorMap::Diverging).label("$\\sigma$ (1/s)"))
        .curves(zero.into_iter().map(|line| Line::new(line).name("0")));
    let curves = Panel::new(Axis::new("$t$ (s)"), Axis::new("$\\psi$ (rad)"))
        .tag("(b)")
        .region(Region::new([(1.0, -0.5), (4.0, -0.5), (3.0, 0.8)]).fill(palette::SKY_BLUE.with_opacity(0.4)))
        .region(Region::new([(6.0, -0.5), (9.0, -0.5), (8.0, 0.8)]).hatched(palette::GREY, 30.0))
        .curve(Line::new(wave(1.0)).legend("one").name("$A=1$"))
        .curve(Branch::new(wave(0.5).into_iter().map(|p| (p, p.x < 5.0))).legend("two"))
        .curve(Line::new(wave(0.2)).dotted())
        .markers(Markers::new([(2.0, 0.0), (5.0, 0.5)], Marker::default().open()))
        .point(PointLabel::new((5.0, -0.48), "HB1"))
        .note(Note::new((8.0, -0.8), "a note"))
        .legend(Legend::Below);
    Figure::double_column().columns(2).description("a test").panel(heat).panel(curves)
}

/// The picture that an independent renderer makes of the SVG.
fn rendered_by_resvg(svg: &str, width: u32, height: u32) -> Vec<u8> {
    let tree = resvg::usvg::Tree::from_str(svg, &resvg::usvg::Options::default()).unwrap();
    let mut pixmap = resvg::tiny_skia::Pixmap::new(width, height).unwrap();
    let transform = resvg::tiny_skia::Transform::from_scale(
        width as f32 / tree.size().width(),
        height as f32 / tree.size().height(),
    );
    resvg::render(&tree, transform, &mut pixmap.as_mut());
    pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

#[test]
fn the_png_is_what_another_renderer_makes_of_the_svg() {
    let figure = rich_figure();
    let png = figure.to_png(150.0).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut ours = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut ours).unwrap();
    assert!((f64::from(info.width) - 174.0 / 25.4 * 150.0).abs() < 1.0);
    let theirs = rendered_by_resvg(&figure.to_svg().unwrap(), info.width, info.height);
    assert_eq!(ours.len(), theirs.len());
    // Rounded coordinates shift edges by a fraction of a pixel, so a few pixels may differ, but not a line or a letter.
    let different = ours
        .chunks(3)
        .zip(theirs.chunks(3))
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 64));
    let share = different.count() as f64 / f64::from(info.width * info.height);
    let dark =
        ours.chunks(3).filter(|pixel| pixel[0] < 64).count() as f64 / f64::from(info.width * info.height);
    assert!(share < 2e-3, "{share}");
    assert!(dark > 1e-2, "{dark}");
}

/// Entries of many widths, so that some rows are as wide as a row may be.
#[test]
fn a_legend_below_stays_in_the_picture() {
    for length in 1..30 {
        let entries = (1..=5).map(|number| format!("{number}{}", "m".repeat(length)));
        let panel = entries.fold(
            Panel::new(Axis::new("$v$").limits(0.0, 3.6), Axis::new("$l$").limits(0.0, 1.0)),
            |panel, entry| panel.curve(Line::new([(0.0, 0.0), (1.0, 1.0)]).legend(entry)),
        );
        let figure = Figure::single_column().panel(panel.legend(Legend::Below));
        let png = figure.to_png(100.0).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let column = |x: usize| pixels.chunks(3).skip(x).step_by(info.width as usize);
        for x in [0, info.width as usize - 1] {
            assert!(column(x).all(|pixel| pixel.iter().all(|part| *part > 200)), "{length} letters");
        }
    }
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    let (a, b) = (rich_figure(), rich_figure());
    assert_eq!(a.to_svg().unwrap(), b.to_svg().unwrap());
    assert_eq!(a.to_png(100.0).unwrap(), b.to_png(100.0).unwrap());
    assert_eq!(a.to_pdf(), b.to_pdf());
}

#[test]
fn unusable_resolutions_are_refused() {
    let figure = rich_figure();
    for dpi in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
        let message = figure.to_png(dpi).unwrap_err().to_string();
        assert!(message.contains("at least 10"), "{message}");
    }
}

#[test]
fn the_pdf_has_one_page_of_the_size_of_the_figure() {
    let pdf = Figure::with_width_mm(100.0).height_mm(50.0).to_pdf();
    let text = String::from_utf8_lossy(&pdf);
    assert!(text.starts_with("%PDF-") && text.trim_end().ends_with("%%EOF"));
    assert!(text.contains("/Count 1") && text.contains("[0 0 283.4645"), "{text}");
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -10.0..10.0_f64,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(0.0),
        1 => any::<f64>(),
    ]
}

fn any_points() -> impl Strategy<Value = Vec<(f64, f64)>> {
    proptest::collection::vec((any_number(), any_number()), 0..12)
}

fn check(svg: &str) -> Result<(), TestCaseError> {
    let drawing: String =
        svg.split("base64,").map(|part| part.split_once('"').map_or(part, |(_, after)| after)).collect();
    prop_assert!(!drawing.contains("NaN") && !drawing.contains("inf"));
    prop_assert!(resvg::usvg::Tree::from_str(svg, &resvg::usvg::Options::default()).is_ok());
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_data_give_a_sound_file(
        line in any_points(), branch in any_points(), region in any_points(), marks in any_points(),
        limits in proptest::option::of((any_number(), any_number())), logarithmic in any::<bool>(),
    ) {
        let mut x = Axis::new("$x$");
        if let Some((low, high)) = limits {
            x = x.limits(low, high);
        }
        let y = if logarithmic { Axis::new("y").logarithmic() } else { Axis::new("y") };
        let mut panel = Panel::new(x, y)
            .region(Region::new(region.clone()))
            .region(Region::new(region).hatched(palette::BLACK, 45.0))
            .curve(Line::new(line).name("name").legend("legend"))
            .curve(Branch::new(branch.clone().into_iter().map(|p| (p, p.0 > 0.0))))
            .curve(Branch::new(branch.into_iter().map(|p| (p, p.0 > 0.0))).smooth([true, false, true]));
        for at in &marks {
            panel = panel.point(PointLabel::new(at, "HB1")).note(Note::new(at, "note"));
        }
        let figure = Figure::single_column().panel(panel.markers(Markers::new(marks, Marker::default())));
        check(&figure.to_svg().unwrap())?;
        prop_assert!(figure.to_png(50.0).is_ok());
        prop_assert!(!figure.to_pdf().is_empty());
    }

    #[test]
    fn any_data_in_space_give_a_sound_file(curve in any_points(), ground in any_points(), at in any_number()) {
        let wall = Wall::at(at).curve(Line::new(curve.clone())).plumb_line(at, at).curves(Vec::<Line>::new());
        let panel = Panel3d::new(Axis::new("$x$"), Axis::new("$y$"), Axis::new("$z$"))
            .ground_region(Region::new(ground.clone()))
            .ground_curve(Line::new(ground))
            .wall(curve.iter().fold(wall, |wall, at| wall.point(PointLabel::new(at, "HB"))));
        check(&Figure::double_column().panel(panel).to_svg().unwrap())?;
    }

    #[test]
    fn any_map_gives_a_sound_file(values in proptest::collection::vec(any_number(), 12), low in any_number()) {
        let grid = Grid::new([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 2.0]).unwrap();
        let map = HeatMap::new(grid, values).unwrap().color_map(ColorMap::Diverging).limits(low, 3.0).label("$z$");
        let contours = map.contour(0.0).into_iter().map(Line::new);
        let panel = Panel::new(Axis::new("x").limits(low, 9.0), Axis::new("y")).curves(contours).map(map);
        check(&Figure::single_column().panel(panel).to_svg().unwrap())?;
    }
}

#[test]
fn a_figure_says_where_its_axes_stand() {
    let panel =
        || Panel::new(Axis::new("x").limits(-1.0, 3.0), Axis::new("y").limits(1.0, 100.0).logarithmic());
    let figure = Figure::single_column().columns(2).panel(panel()).panel(panel()).width_mm(120.0);
    let (width, height) = figure.size();
    let svg = figure.to_svg().unwrap();
    assert!(svg.contains("width=\"120mm\""), "{svg}");
    assert!((width - 120.0 * 72.0 / 25.4).abs() < 1e-9);
    let places: Vec<_> = figure.places().into_iter().flatten().collect();
    assert_eq!(places.len(), 2);
    for place in &places {
        assert_eq!((place.x.low, place.x.high, place.x.logarithmic), (-1.0, 3.0, false));
        assert_eq!((place.y.low, place.y.high, place.y.logarithmic), (1.0, 100.0, true));
        assert!(0.0 < place.left && place.left < place.right && place.right < width);
        assert!(0.0 < place.top && place.top < place.bottom && place.bottom < height);
        // The frame is drawn there.
        let corner = |value: f64| ((value * 100.0).round() / 100.0).to_string();
        assert!(svg.contains(&format!("m{} {} ", corner(place.left), corner(place.top))), "{place:?} {svg}");
    }
    assert!(places[0].right < places[1].left);
}

#[test]
fn labels_are_text_where_that_is_asked_for() {
    let panel =
        Panel::new(Axis::new("$v$ (m/s)"), Axis::new("angle")).point(PointLabel::new((1.0, 2.0), "HB1"));
    let figure = Figure::single_column().description("a curve").panel(panel);
    let outlines = figure.to_svg().unwrap();
    assert!(!outlines.contains("<text") && outlines.contains("width=\"84mm\""));
    assert!(outlines.contains("<title>a curve</title>") && outlines.contains("HB1 at (1, 2)"));
    let options = SvgOptions { text: true, fluid: true };
    let text = figure.to_svg_with(options).unwrap();
    assert!(
        text.contains(">HB1</text>")
            && text.contains(">angle</text>")
            && text.contains("font-style=\"italic\">v</text>")
            && !text.contains("<use")
    );
    assert!(!text.contains("mm\""));
}

#[test]
fn a_dark_figure_has_dark_paper_in_every_format_and_other_ends_of_its_axes_where_these_are_asked_for() {
    let panel = Panel::new(Axis::new("x"), Axis::new("y")).curve(Line::new([(0.0, 0.0), (1.0, 1.0)]));
    let figure = Figure::single_column().panel(panel);
    let dark = figure.clone().theme(Theme::Dark);
    assert!(
        figure.to_svg().unwrap().contains("fill=\"#fff\"")
            && dark.to_svg().unwrap().contains("fill=\"#16181a\"")
    );
    assert_ne!(figure.to_pdf(), dark.to_pdf());
    let part = figure.clone().window(0, Some((0.25, 0.5)), None);
    let (before, after) = (figure.places()[0].unwrap(), part.places()[0].unwrap());
    assert_eq!((after.x.low, after.x.high), (0.25, 0.5));
    assert_eq!(after.y, before.y);
}
