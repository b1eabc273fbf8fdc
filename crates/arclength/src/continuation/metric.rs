//! The geometry of a curve's metric: lengths, distances, positions along a tangent and angles.

use super::curve::Curve;
use super::solution::Solution;

/// `W vector`.
pub(crate) fn metric_image<C: Curve>(curve: &C, vector: &[f64]) -> Vec<f64> {
    let mut image = vec![0.0; vector.len()];
    curve.apply_metric(vector, &mut image);
    image
}

/// Length of a vector in the curve's metric; `image` is scratch memory.
pub(crate) fn norm<C: Curve>(curve: &C, vector: &[f64], image: &mut [f64]) -> f64 {
    curve.apply_metric(vector, image);
    let square = inner(vector, image);
    // Rounding may make it negative; a number that is not finite stays one.
    if square < 0.0 { 0.0 } else { square.sqrt() }
}

/// Sums that are formed side by side: one alone waits for every addition.
const SUMS: usize = 4;

/// Euclidean inner product.
pub(crate) fn inner(a: &[f64], b: &[f64]) -> f64 {
    let ((blocks, rest), (other_blocks, other_rest)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>());
    let mut sums = [0.0; SUMS];
    for (a, b) in blocks.iter().zip(other_blocks) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let last: f64 = rest.iter().zip(other_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + last
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

/// Cosine of the angle between a tangent and the way to another solution at a given distance.
pub(crate) fn cosine<C: Curve>(curve: &C, origin: &Solution<C::Point>, other: &[f64], distance: f64) -> f64 {
    let image = metric_image(curve, &origin.tangent);
    let size = inner(&origin.tangent, &image).max(0.0).sqrt();
    along(curve, origin, other).abs() / (size * distance)
}
