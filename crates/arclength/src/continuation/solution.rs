//! Solutions on a curve, the range that bounds it, and the cubic between two neighbours.

/// A converged solution on a curve.
#[derive(Clone, Debug)]
pub struct Solution<P> {
    /// The unknowns.
    pub unknown: Vec<f64>,
    /// The unit tangent in the curve's metric, pointing in the direction of travel.
    pub tangent: Vec<f64>,
    /// Sign of the determinant of the Jacobian bordered by the tangent.
    pub orientation: f64,
    /// What is known about it.
    pub point: P,
}

impl<P> Solution<P> {
    /// The same solution for travel in the opposite direction.
    pub fn reversed(mut self) -> Self {
        self.tangent.iter_mut().for_each(|entry| *entry = -*entry);
        self.orientation = -self.orientation;
        self
    }

    /// The prediction at a distance along the tangent.
    pub fn ahead(&self, distance: f64) -> Vec<f64> {
        self.unknown.iter().zip(&self.tangent).map(|(value, slope)| value + distance * slope).collect()
    }
}

/// A range in which one of the unknowns has to stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Index from the end among the unknowns: 1 is the last. (The unknowns before a parameter can
    /// change in number when a mesh adapts.)
    pub from_end: usize,
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
}

/// Part of its range by which a parameter may lie outside by rounding: at a special point at the end of the range.
pub(crate) const START_ROUNDING: f64 = 1e-9;

impl Bound {
    /// The value of the bounded unknown.
    pub fn value(&self, unknown: &[f64]) -> f64 {
        unknown[unknown.len() - self.from_end]
    }

    /// Whether a value lies in the range, or outside by no more than this part of its width.
    pub(crate) fn holds(&self, value: f64, margin: f64) -> bool {
        let margin = margin * self.width();
        (self.lower - margin..=self.upper + margin).contains(&value)
    }

    /// Moves a solution that lies outside by rounding onto the end of the range.
    pub(crate) fn keep_within(&self, unknown: &mut [f64]) {
        let place = unknown.len() - self.from_end;
        if self.holds(unknown[place], START_ROUNDING) {
            unknown[place] = unknown[place].clamp(self.lower, self.upper);
        }
    }

    /// Length of the range.
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// The cubic through two neighbours with their tangents, at a fraction of the way; `length` is that of the way.
pub(crate) fn interpolate<P>(
    before: &Solution<P>,
    after: &Solution<P>,
    length: f64,
    fraction: f64,
) -> Vec<f64> {
    let s = fraction;
    let step = s * s * (3.0 - 2.0 * s);
    let (departure, arrival) = (s * (1.0 - s) * (1.0 - s) * length, s * s * (s - 1.0) * length);
    let ends = before.unknown.iter().zip(&after.unknown);
    let tangents = before.tangent.iter().zip(&after.tangent);
    ends.zip(tangents).map(|((a, b), (u, v))| a + step * (b - a) + departure * u + arrival * v).collect()
}
