//! The story of a branch: why it ends, stretches of equal stability between special points, the steps.

use crate::branch::stability;
use crate::end::End;
use crate::labels::is_bifurcation;
use crate::varying_parameter::VaryingParameter;
use kingpin_report::Story;
use kingpin_report::numbers::readable;

/// A point as the story knows it.
#[derive(Clone, Debug)]
pub struct ToldPoint<'a> {
    /// Value of the parameter.
    pub value: f64,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Its label.
    pub label: Option<&'a str>,
    /// What its normal form says.
    pub remark: Option<String>,
}

/// Tells why the branch ends, at its first and at its last point.
pub fn tell_ends(story: &mut Story, ends: &[End; 2]) {
    for (end, subject) in ends.iter().zip(["first end", "last end"]) {
        let last: Vec<String> =
            end.last.0.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
        story.tell(subject, end.cause.as_str());
        story.tell(subject, format!("last good point: {}", last.join(", ")));
        let remedy = end.remedy.as_deref().unwrap_or("nothing is left to do");
        story.tell(subject, format!("remedy: {remedy}"));
    }
}

/// Tells the way along the branch: stretches of equal stability between the special points, and the steps.
pub fn tell_way(story: &mut Story, along: &VaryingParameter, places: &[ToldPoint<'_>]) {
    // A stretch of equal stability reaches from one special point to the next.
    let mut stretch: Option<(f64, f64, Option<bool>)> = None;
    let told = |(start, end, stable): (f64, f64, Option<bool>)| {
        format!("{} from {} to {}", stability(stable, false), along.at(start), along.quantity(end))
    };
    let mut special = None;
    for place in places {
        if is_bifurcation(place.label) || place.remark.is_some() {
            if let Some((start, _, stable)) = stretch.take() {
                story.tell("course", told((start, place.value, stable)));
            }
            let remark = place.remark.as_deref().filter(|text| !text.is_empty());
            let remark = remark.map(|text| format!(": {text}")).unwrap_or_default();
            let label = place.label.unwrap_or_default();
            story.tell("course", format!("{label} at {}{remark}", along.at(place.value)));
            special = Some(place.value);
            continue;
        }
        match &mut stretch {
            Some((_, end, stable)) if *stable == place.stable => *end = place.value,
            _ => {
                if let Some(before) = stretch.take() {
                    story.tell("course", told(before));
                }
                stretch = Some((special.unwrap_or(place.value), place.value, place.stable));
            }
        }
        special = None;
    }
    if let Some(last) = stretch {
        story.tell("course", told(last));
    }
    let steps = places.windows(2).map(|pair| (pair[1].value - pair[0].value).abs());
    let (smallest, largest) =
        steps.fold((f64::INFINITY, 0.0_f64), |(low, high), step| (low.min(step), high.max(step)));
    if places.len() > 1 {
        story.tell(
            "steps",
            format!(
                "{} points; from one to the next {} changes by {} to {}",
                places.len(),
                along.key,
                readable(smallest),
                along.quantity(largest)
            ),
        );
    }
}
