//! The view of a space panel: from a box to the page, in perspective or with parallel rays.

use crate::geometry::{Point, Rect};

/// From where a [`crate::Panel3d`] is seen.
///
/// The x axis runs to the right, y into the depth and z upwards; the box between the limits is turned about its vertical
/// axis by the azimuth and then tilted towards the viewer by the elevation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    azimuth: f64,
    elevation: f64,
    distance: Option<f64>,
    proportions: [f64; 3],
}

impl Default for Projection {
    /// Seen from the left front and from above, in a weak perspective.
    fn default() -> Self {
        Self::axonometric(-28.0, 26.0).perspective(6.0)
    }
}

impl Projection {
    /// Parallel rays: `azimuth` in degrees, negative when the depth runs to the upper right, kept between -80 and 80;
    /// `elevation` in degrees above the ground, kept between 5 and 85.
    pub fn axonometric(azimuth: f64, elevation: f64) -> Self {
        let kept =
            |value: f64, low: f64, high: f64| if value.is_nan() { low } else { value.clamp(low, high) };
        Self {
            azimuth: kept(azimuth, -80.0, 80.0).to_radians(),
            elevation: kept(elevation, 5.0, 85.0).to_radians(),
            distance: None,
            proportions: [1.0, 1.0, 0.5],
        }
    }

    /// Seen from a distance in lengths of the longest side of the box, at least 2: the smaller, the stronger the
    /// perspective.
    pub fn perspective(self, distance: f64) -> Self {
        Self { distance: distance.is_finite().then(|| distance.max(2.0)), ..self }
    }

    /// Relative lengths of the sides of the box along x, y and z; 1, 1 and 0.5 unless given. Lengths that are not
    /// positive are passed over.
    pub fn proportions(mut self, x: f64, y: f64, z: f64) -> Self {
        for (side, length) in self.proportions.iter_mut().zip([x, y, z]) {
            if length.is_finite() && length > 0.0 {
                *side = length;
            }
        }
        self
    }

    /// Whether the y axis runs to the right as it recedes.
    pub(crate) fn recedes_right(&self) -> bool {
        self.azimuth < 0.0
    }

    /// The image of a point of the unit cube, y downwards, in arbitrary units.
    fn image(&self, [x, y, z]: [f64; 3]) -> Point {
        let longest = self.proportions.iter().copied().fold(0.0, f64::max);
        let side = |i: usize, value: f64| (value - 0.5) * self.proportions[i] / longest;
        let (x, y, z) = (side(0, x), side(1, y), side(2, z));
        let (sine, cosine) = self.azimuth.sin_cos();
        let (across, away) = (cosine * x - sine * y, sine * x + cosine * y);
        let (sine, cosine) = self.elevation.sin_cos();
        let (up, depth) = (sine * away + cosine * z, cosine * away - sine * z);
        let shrunk = self.distance.map_or(1.0, |distance| distance / (distance + depth));
        Point::new(across * shrunk, -up * shrunk)
    }

    /// The view that fits the cube into a rectangle on the page.
    pub(crate) fn fitted(&self, target: &Rect) -> View {
        let mut bounds = Rect::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
        for corner in 0..8 {
            let bit = |i: u32| f64::from(corner >> i & 1);
            let p = self.image([bit(0), bit(1), bit(2)]);
            bounds = Rect::new(
                bounds.left.min(p.x),
                bounds.top.min(p.y),
                bounds.right.max(p.x),
                bounds.bottom.max(p.y),
            );
        }
        let scale = (target.width() / bounds.width()).min(target.height() / bounds.height());
        let (from, to) = (bounds.center(), target.center());
        View { projection: *self, scale, shift: Point::new(to.x - scale * from.x, to.y - scale * from.y) }
    }
}

/// A projection fitted to the page.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    projection: Projection,
    scale: f64,
    shift: Point,
}

impl View {
    /// The page point of a point of the unit cube.
    pub(crate) fn point(&self, point: [f64; 3]) -> Point {
        let image = self.projection.image(point);
        self.shift.offset(self.scale * image.x, self.scale * image.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TARGET: Rect = Rect { left: 10.0, top: 20.0, right: 210.0, bottom: 140.0 };

    proptest! {
        #[test]
        fn the_cube_fits_and_upright_stays_upright(
            azimuth in -80.0..80.0_f64, elevation in 5.0..85.0_f64, x in 0.0..1.0_f64, y in 0.0..1.0_f64,
        ) {
            let parallel = Projection::axonometric(azimuth, elevation);
            for projection in [parallel, parallel.perspective(3.0)] {
                let view = projection.fitted(&TARGET);
                let (foot, head) = (view.point([x, y, 0.0]), view.point([x, y, 1.0]));
                prop_assert!(TARGET.expanded(1e-9).contains(foot) && TARGET.expanded(1e-9).contains(head));
            }
            let view = parallel.fitted(&TARGET);
            prop_assert!(view.point([x, y, 1.0]).y < view.point([x, y, 0.0]).y);
            prop_assert!((view.point([x, y, 0.0]).x - view.point([x, y, 1.0]).x).abs() < 1e-9);
        }

        #[test]
        fn lines_stay_straight_in_perspective(t in 0.0..1.0_f64) {
            let view = Projection::default().perspective(2.0).fitted(&TARGET);
            let (a, b) = (view.point([0.1, 0.2, 0.9]), view.point([0.9, 0.7, 0.0]));
            let p = view.point([0.1 + 0.8 * t, 0.2 + 0.5 * t, 0.9 - 0.9 * t]);
            prop_assert!(((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)).abs() < 1e-6);
        }
    }
}
