//! Several results of one wheel in one bifurcation diagram, or in one plane of two parameters.

use crate::cycles::{CyclePointResult, bifurcation_diagram};
use crate::description;
use crate::result_file::ResultFile;
use arclength_analysis::picture::{self, Curve, OwnColor};
use kingpin_figure::Figure;

/// Branches of cycles along one parameter in one diagram, or curves in one plane; the error says which result does not fit to the first
/// one. Ends of the axes are those of the first. Results may have colours of their own, in their order.
///
/// # Errors
/// No result, results over different parameters, and Hopf points alone, which are drawn by themselves.
pub fn diagram(results: &[ResultFile], colors: &[Option<OwnColor>]) -> Result<Figure, (usize, String)> {
    let own = |index: usize| colors.get(index).and_then(Option::as_ref);
    let keys = |result: &ResultFile| match result {
        ResultFile::Hopf(result) => vec![result.interval.key()],
        ResultFile::Cycles(result) => vec![result.interval.key()],
        ResultFile::MotionLocus(result) => result.plane.keys().to_vec(),
        ResultFile::CycleLocus(result) => result.plane.keys().to_vec(),
    };
    let problem = |index: usize, text: &str| Err((index, text.to_owned()));
    let Some(first) = results.first() else {
        return problem(0, "there is no result; allowed: one result or more");
    };
    if let Some(index) = results.iter().position(|result| keys(result) != keys(first)) {
        return problem(index, "it is over other parameters; allowed: results over the same ones");
    }
    let (wheel, plane) = match first {
        ResultFile::MotionLocus(one) => (&one.wheel, one.plane),
        ResultFile::CycleLocus(one) => (&one.wheel, one.plane),
        ResultFile::Cycles(one) => {
            let mut points: Vec<CyclePointResult> = Vec::new();
            let mut colors: Vec<(u64, Option<&OwnColor>)> = Vec::new();
            for (index, result) in results.iter().enumerate() {
                // Branches are numbered through all results.
                let before = points.last().map_or(0, |point| point.branch);
                let ResultFile::Cycles(result) = result else { continue };
                let of_all = |point: &CyclePointResult| CyclePointResult {
                    branch: before.saturating_add(point.branch),
                    ..point.clone()
                };
                points.extend(result.points.iter().map(of_all));
                colors.push((points.last().map_or(0, |point| point.branch), own(index)));
            }
            return Ok(bifurcation_diagram(&one.wheel, &one.interval, &points, &colors));
        }
        ResultFile::Hopf(_) => {
            return problem(0, "Hopf points alone are no branch; allowed: results of cycles and locus");
        }
    };
    let scales = plane.scales();
    let curve = |(index, result): (usize, &ResultFile)| match result {
        ResultFile::MotionLocus(result) => Some(result.curve.drawn_with(scales).in_color(own(index))),
        ResultFile::CycleLocus(result) => Some(result.curve.drawn_with(scales).in_color(own(index))),
        ResultFile::Hopf(_) | ResultFile::Cycles(_) => None,
    };
    let curves: Vec<Curve> = results.iter().enumerate().filter_map(curve).collect();
    let [one, two] = plane.keys();
    let [across, up] = plane.labels();
    let description = format!("Special points in {one} and {two} at {}", description::of(wheel, &[one, two]));
    Ok(picture::plane(&description, [&across, &up], &curves))
}
