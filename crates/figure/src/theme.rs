//! Light and dark: what the colours of a figure become on a dark page.

use crate::color::{Color, palette};
use crate::scene::{Item, Scene};

/// On what a figure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// Dark on white, as in print.
    #[default]
    Light,
    /// Light on nearly black. Colours are told apart with any colour vision, as those of the light theme.
    Dark,
}

/// The paper of the dark theme.
const DARK_PAPER: Color = Color::rgb(22, 24, 26);

/// What becomes of the palette: the same hues, light enough for thin lines on dark paper.
const DARK: [(Color, Color); 9] = [
    (palette::BLACK, Color::rgb(230, 230, 227)),
    (palette::WHITE, DARK_PAPER),
    (palette::BLUE, Color::rgb(86, 180, 233)),
    (palette::VERMILION, Color::rgb(240, 144, 74)),
    (palette::GREEN, Color::rgb(53, 199, 155)),
    (palette::PURPLE, Color::rgb(217, 154, 191)),
    (palette::ORANGE, Color::rgb(240, 201, 90)),
    (palette::SKY_BLUE, Color::rgb(168, 215, 245)),
    (palette::YELLOW, palette::YELLOW),
];

/// Lightness (of Oklab) of what was black, and how it falls towards what was white.
const LIGHTEST: f64 = 0.92;
const FALL: f64 = 0.72;

impl Theme {
    /// The colour of the paper.
    pub(crate) fn paper(self) -> Color {
        match self {
            Self::Light => palette::WHITE,
            Self::Dark => DARK_PAPER,
        }
    }

    /// What a colour of the light theme is in this one.
    pub fn color(self, color: Color) -> Color {
        if self == Self::Light {
            return color;
        }
        let known = DARK.iter().find(|(light, _)| light.rgb == color.rgb);
        let rgb = known.map_or_else(|| darkened(color.rgb), |(_, dark)| dark.rgb);
        Color { rgb, ..color }
    }

    /// A scene in this theme. The colours of heat maps stay, but for those that begin with the colour of the paper.
    pub(crate) fn apply(self, scene: &mut Scene) {
        if self == Self::Light {
            return;
        }
        for item in &mut scene.items {
            match item {
                Item::Shape { fill, stroke, .. } => {
                    *fill = fill.map(|color| self.color(color));
                    *stroke = stroke
                        .map(|stroke| crate::scene::Stroke { color: self.color(stroke.color), ..stroke });
                }
                Item::Raster { raster, .. } if raster.is_scale => {}
                Item::Raster { raster, .. } => {
                    for [red, green, blue, _] in &mut raster.pixels {
                        [*red, *green, *blue] = self.color(Color::rgb(*red, *green, *blue)).rgb;
                    }
                }
                Item::Text { color, halo, .. } => {
                    *color = self.color(*color);
                    *halo = halo.map(|halo| crate::scene::Halo { color: self.color(halo.color), ..halo });
                }
            }
        }
    }
}

/// A colour of the same hue whose lightness is turned round (Ottosson's Oklab, 2020).
fn darkened(rgb: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = rgb.map(|c| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    });
    let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
    let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
    let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
    let lightness = 0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s;
    let a = 1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s;
    let b = 0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s;
    let lightness = LIGHTEST - FALL * lightness;
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
    .map(|c| {
        let c = c.clamp(0.0, 1.0);
        let c = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * c).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2).
    fn luminance(color: Color) -> f64 {
        let [r, g, b] = color.rgb.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    fn contrast(one: Color, other: Color) -> f64 {
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn every_colour_of_the_palette_can_be_seen_on_dark_paper() {
        for color in palette::CYCLE {
            let dark = Theme::Dark.color(color);
            assert!(contrast(dark, DARK_PAPER) > 4.5, "{dark:?}");
        }
        assert_eq!(Theme::Light.color(palette::BLUE), palette::BLUE);
    }

    /// What is told apart on white is told apart on dark paper, for dichromats too (matrices of Viénot, Brettel and Mollon, 1999).
    #[test]
    fn curves_of_two_colours_stay_two_on_dark_paper() {
        let seen = |color: Color, kind: usize| {
            let [r, g, b] = color.rgb.map(f64::from);
            let protan = [0.112 * r + 0.888 * g, 0.112 * r + 0.888 * g, 0.004 * r - 0.004 * g + b];
            let deutan = [0.293 * r + 0.707 * g, 0.293 * r + 0.707 * g, -0.022 * r + 0.022 * g + b];
            [[r, g, b], protan, deutan][kind]
        };
        for kind in 0..3 {
            for (index, one) in palette::CYCLE.iter().enumerate() {
                for other in &palette::CYCLE[..index] {
                    let [one, other] = [one, other].map(|color| seen(Theme::Dark.color(*color), kind));
                    let distance: f64 = (0..3).map(|c| (one[c] - other[c]).powi(2)).sum::<f64>().sqrt();
                    assert!(distance > 25.0, "{kind}: {one:?} {other:?} {distance}");
                }
            }
        }
    }

    #[test]
    fn greys_are_turned_round() {
        let [dark, light] =
            [palette::LIGHT_GREY, Color::rgb(40, 40, 40)].map(|grey| Theme::Dark.color(grey).rgb);
        assert!(dark[0] < 90 && light[0] > 150, "{dark:?} {light:?}");
        assert!(dark.iter().all(|c| c.abs_diff(dark[0]) < 3));
    }
}
