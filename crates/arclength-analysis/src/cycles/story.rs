//! The story of a branch of cycles.

use super::cycle::CycleResult;
use crate::course::{self, ToldPoint};
use crate::end::End;
use crate::labels::is_bifurcation;
use crate::unlocated::UnlocatedResult;
use crate::varying_parameter::VaryingParameter;
use kingpin_report::Story;

/// Tells why the branch ends, what was met on the way, what was not located, how fine the meshes are and how exact the cycles.
pub fn tell(
    story: &mut Story,
    along: &VaryingParameter,
    ends: &[End; 2],
    unlocated: &[UnlocatedResult],
    cycles: &[&CycleResult],
) {
    let places: Vec<ToldPoint<'_>> = cycles
        .iter()
        .map(|cycle| ToldPoint {
            value: cycle.value,
            stable: cycle.stable,
            label: cycle.label.as_deref(),
            remark: is_bifurcation(cycle.label.as_deref()).then(|| cycle.remark()),
        })
        .collect();
    course::tell_ends(story, ends);
    course::tell_way(story, along, &places);
    unlocated.iter().for_each(|change| story.tell("not located", change.text(along)));
    // A Hopf point at which a branch begins or ends has no mesh.
    let meshes = cycles.iter().map(|cycle| cycle.intervals).filter(|intervals| *intervals > 0);
    if let (Some(fewest), Some(most)) = (meshes.clone().min(), meshes.max()) {
        let degree = cycles.iter().find_map(|cycle| cycle.orbit.as_ref()).map(|orbit| orbit.degree);
        let degree = degree.map_or(String::new(), |degree| format!(", polynomials of degree {degree}"));
        story.tell("meshes", format!("{fewest} to {most} intervals{degree}"));
    }
    let largest =
        |values: fn(&CycleResult) -> f64| cycles.iter().map(|cycle| values(cycle)).fold(0.0, f64::max);
    story.tell(
        "errors",
        format!(
            "at most {:.1e} of the amplitudes, trivial multiplier at most {:.1e} from 1",
            largest(|cycle| cycle.error_estimate),
            largest(|cycle| cycle.trivial_multiplier_error)
        ),
    );
}
