//! Colours, the palette of Okabe and Ito, and perceptually uniform colour maps.

/// A colour with opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color {
    /// Red, green and blue in sRGB.
    pub rgb: [u8; 3],
    /// From 0 (invisible) to 1.
    pub opacity: f64,
}

impl Color {
    /// An opaque colour from its sRGB components.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }

    /// The same colour with another opacity, kept between 0 and 1.
    pub fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity: if opacity.is_nan() { 1.0 } else { opacity.clamp(0.0, 1.0) }, ..self }
    }

    /// Mixed with white: 0 leaves the colour, 1 is white. Unlike opacity it hides what lies below.
    pub fn lightened(self, amount: f64) -> Self {
        let amount = amount.clamp(0.0, 1.0);
        let mix = |c: u8| (f64::from(c) + amount * (255.0 - f64::from(c))).round() as u8;
        Self { rgb: self.rgb.map(mix), ..self }
    }

    pub(crate) fn hex(self) -> String {
        let [r, g, b] = self.rgb;
        if [r, g, b].iter().all(|c| c >> 4 == c & 15) {
            format!("#{:x}{:x}{:x}", r & 15, g & 15, b & 15)
        } else {
            format!("#{r:02x}{g:02x}{b:02x}")
        }
    }
}

/// The colours of Okabe and Ito (2008), told apart with any colour vision, and a few greys.
pub mod palette {
    use super::Color;

    /// Black.
    pub const BLACK: Color = Color::rgb(0, 0, 0);
    /// White.
    pub const WHITE: Color = Color::rgb(255, 255, 255);
    /// Middle grey.
    pub const GREY: Color = Color::rgb(128, 128, 128);
    /// Light grey, for shading.
    pub const LIGHT_GREY: Color = Color::rgb(222, 222, 222);
    /// Blue.
    pub const BLUE: Color = Color::rgb(0, 114, 178);
    /// Vermilion.
    pub const VERMILION: Color = Color::rgb(213, 94, 0);
    /// Bluish green.
    pub const GREEN: Color = Color::rgb(0, 158, 115);
    /// Reddish purple.
    pub const PURPLE: Color = Color::rgb(204, 121, 167);
    /// Orange.
    pub const ORANGE: Color = Color::rgb(230, 159, 0);
    /// Sky blue.
    pub const SKY_BLUE: Color = Color::rgb(86, 180, 233);
    /// Yellow; too light for thin lines on white.
    pub const YELLOW: Color = Color::rgb(240, 228, 66);

    /// The order in which series without a colour of their own are coloured.
    pub const CYCLE: [Color; 7] = [BLACK, BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY_BLUE];
}

/// How the values of a heat map become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColorMap {
    /// Viridis (Smith and van der Walt, 2015): dark blue to yellow, evenly perceived.
    #[default]
    Viridis,
    /// Blue through white to red with zero in the middle (the anchors of ColorBrewer's RdBu, reversed): for signed
    /// values such as growth rates.
    Diverging,
}

/// Viridis at 17 equal steps; between them the colour is interpolated.
const VIRIDIS: [[u8; 3]; 17] = [
    [68, 1, 84],
    [72, 24, 106],
    [71, 45, 123],
    [66, 64, 134],
    [59, 82, 139],
    [51, 99, 141],
    [44, 114, 142],
    [38, 130, 142],
    [33, 145, 140],
    [31, 160, 136],
    [40, 174, 128],
    [63, 188, 115],
    [94, 201, 98],
    [132, 212, 75],
    [173, 220, 48],
    [216, 226, 25],
    [253, 231, 37],
];

const DIVERGING: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

impl ColorMap {
    /// Whether its colours are the same on any paper. Those about zero of a diverging map are those of the paper.
    pub(crate) fn has_own_paper(self) -> bool {
        self == Self::Viridis
    }

    /// The colour at a fraction of the scale from 0 to 1; values outside take the colour of the nearest end.
    pub fn at(self, fraction: f64) -> Color {
        let anchors: &[[u8; 3]] = match self {
            ColorMap::Viridis => &VIRIDIS,
            ColorMap::Diverging => &DIVERGING,
        };
        let position = fraction.clamp(0.0, 1.0) * (anchors.len() - 1) as f64;
        let index = (position as usize).min(anchors.len() - 2);
        let t = position - index as f64;
        let mut rgb = [0; 3];
        for (channel, value) in rgb.iter_mut().enumerate() {
            let (from, to) = (f64::from(anchors[index][channel]), f64::from(anchors[index + 1][channel]));
            *value = (from + t * (to - from)).round() as u8;
        }
        Color { rgb, opacity: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_of_viridis_grows_along_the_scale() {
        let luminance = |c: Color| {
            let linear = c.rgb.map(|v| (f64::from(v) / 255.0).powf(2.2));
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let values: Vec<f64> =
            (0..=64).map(|i| luminance(ColorMap::Viridis.at(f64::from(i) / 64.0))).collect();
        assert!(values.windows(2).all(|pair| pair[1] > pair[0]));
    }

    #[test]
    fn the_diverging_map_is_neutral_in_the_middle() {
        let middle = ColorMap::Diverging.at(0.5).rgb;
        assert!(middle.iter().all(|v| *v == middle[0]));
        assert!(ColorMap::Diverging.at(0.0).rgb[2] > ColorMap::Diverging.at(0.0).rgb[0]);
    }

    #[test]
    fn hex_is_as_short_as_it_can_be() {
        assert_eq!(palette::WHITE.hex(), "#fff");
        assert_eq!(palette::BLUE.hex(), "#0072b2");
    }
}
