//! Solutions on a curve and the geometry of its metric: lengths, positions along a tangent, points between two neighbours.

use super::corrector::{correct, inner, norm};
use super::curve::Curve;
use super::settings::Settings;
use crate::error::{CorrectionFailure, Error};

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

impl Bound {
    /// The value of the bounded unknown.
    pub fn value(&self, unknown: &[f64]) -> f64 {
        unknown[unknown.len() - self.from_end]
    }

    /// Length of the range.
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// `W vector`.
pub(crate) fn metric_image<C: Curve>(curve: &C, vector: &[f64]) -> Vec<f64> {
    let mut image = vec![0.0; vector.len()];
    curve.apply_metric(vector, &mut image);
    image
}

/// Position along the tangent at `origin`, in the metric of the curve.
pub(crate) fn along<C: Curve>(curve: &C, origin: &Solution<C::Point>, unknown: &[f64]) -> f64 {
    let image = metric_image(curve, &origin.tangent);
    let offset = unknown.iter().zip(&origin.unknown).map(|(there, here)| there - here);
    offset.zip(&image).map(|(offset, weight)| offset * weight).sum()
}

/// Distance between two solutions in the metric of the curve.
pub(crate) fn distance<C: Curve>(curve: &C, one: &[f64], other: &[f64]) -> f64 {
    let offset: Vec<f64> = one.iter().zip(other).map(|(a, b)| b - a).collect();
    norm(curve, &offset, &mut vec![0.0; offset.len()])
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

/// The solution with `unknown` up to a correction across the tangent of `origin`.
///
/// # Errors
/// [`Error::NotFound`] when the corrector fails.
pub(crate) fn across<C: Curve>(
    curve: &mut C,
    origin: &Solution<C::Point>,
    mut unknown: Vec<f64>,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let border = metric_image(curve, &origin.tangent);
    correct(curve, &mut unknown, &border, settings)
        .map_err(|cause| Error::NotFound { sought: "solution between two points", cause })?;
    finish(curve, unknown, &origin.tangent)
}

/// A solution between two neighbours, at a fraction of the way.
///
/// # Errors
/// [`Error::NotFound`] when the corrector fails.
pub(crate) fn between<C: Curve>(
    curve: &mut C,
    before: &Solution<C::Point>,
    after: &Solution<C::Point>,
    fraction: f64,
    settings: &Settings,
) -> Result<Solution<C::Point>, Error> {
    let length = along(curve, before, &after.unknown);
    across(curve, before, interpolate(before, after, length, fraction), settings)
}

/// Completes a corrected solution: tangent in the direction of `old_tangent`, orientation, point.
///
/// # Errors
/// When the bordered Jacobian is singular or the point cannot be inspected.
pub(crate) fn finish<C: Curve>(
    curve: &mut C,
    unknown: Vec<f64>,
    old_tangent: &[f64],
) -> Result<Solution<C::Point>, Error> {
    let border = metric_image(curve, old_tangent);
    let mut tangent = vec![0.0; unknown.len()];
    let singular = Error::NotFound { sought: "tangent", cause: CorrectionFailure::Singular };
    let sign = curve.factorize(&unknown, &border, &mut tangent);
    if sign == 0.0 {
        return Err(singular);
    }
    tangent.fill(0.0);
    if let Some(last) = tangent.last_mut() {
        *last = 1.0;
    }
    curve.solve(&mut tangent);
    let mut image = vec![0.0; tangent.len()];
    let length = norm(curve, &tangent, &mut image);
    if !(length.is_finite() && length > 0.0) {
        return Err(singular);
    }
    tangent.iter_mut().for_each(|entry| *entry /= length);
    let point = curve.inspect(&unknown, &tangent, sign)?;
    Ok(Solution { unknown, tangent, orientation: sign, point })
}

/// Cosine of the angle between a tangent and the way to another solution at a given distance.
pub(crate) fn cosine<C: Curve>(curve: &C, origin: &Solution<C::Point>, other: &[f64], distance: f64) -> f64 {
    let image = metric_image(curve, &origin.tangent);
    let size = inner(&origin.tangent, &image).max(0.0).sqrt();
    along(curve, origin, other).abs() / (size * distance)
}
