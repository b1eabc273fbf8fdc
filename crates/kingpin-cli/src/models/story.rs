//! The story of a run, `--explain`: where it started, why it ended, what it met on the way, how exact it is.

use super::branch::{End, stability};
use crate::labels::is_bifurcation;
use crate::numbers::readable;
use crate::table::Table;
use std::io::{self, Write};

/// A line of the story.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    subject: &'static str,
    text: String,
}

impl Part {
    /// What is said about a subject.
    pub fn new(subject: &'static str, text: String) -> Self {
        Self { subject, text }
    }
}

/// A point as the story knows it.
#[derive(Clone, Debug)]
pub struct Place<'a> {
    /// Value of the parameter.
    pub value: f64,
    /// Nothing where that is not decided.
    pub stable: Option<bool>,
    /// Its label.
    pub label: Option<&'a str>,
    /// What its normal form says.
    pub remark: Option<String>,
}

/// Writes the story under a table.
///
/// # Errors
/// Those of the writer.
pub fn write(parts: &[Part], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "\nstory of the run")?;
    let mut table = Table::new(["", ""]);
    let mut subject = "";
    for part in parts {
        let heading = if part.subject == subject { "" } else { part.subject };
        subject = part.subject;
        table.row([format!("  {heading}").into(), part.text.as_str().into()]);
    }
    table.write(out)
}

/// Why the branch ends.
pub fn ends(ends: &[End]) -> Vec<Part> {
    let subjects = ["first end", "last end"];
    let parts = ends.iter().zip(subjects).flat_map(|(end, subject)| {
        let last: Vec<String> =
            end.last.0.iter().map(|(name, value)| format!("{name} = {}", readable(*value))).collect();
        let mut parts = vec![
            Part::new(subject, end.cause.clone()),
            Part::new(subject, format!("last good point: {}", last.join(", "))),
        ];
        let remedy = end.remedy.as_deref().unwrap_or("nothing is left to do");
        parts.push(Part::new(subject, format!("remedy: {remedy}")));
        parts
    });
    parts.collect()
}

/// The way along the branch: stretches of equal stability between the special points, and the steps.
pub fn course(key: &str, places: &[Place<'_>]) -> Vec<Part> {
    let mut parts = Vec::new();
    // A stretch of equal stability reaches from one special point to the next.
    let mut stretch: Option<(f64, f64, Option<bool>)> = None;
    let tell = |(start, end, stable): (f64, f64, Option<bool>)| {
        let (start, end) = (readable(start), readable(end));
        Part::new("course", format!("{} from {key} = {start} to {end}", stability(stable, false)))
    };
    let mut special = None;
    for place in places {
        if is_bifurcation(place.label) || place.remark.is_some() {
            parts.extend(stretch.take().map(|(start, _, stable)| tell((start, place.value, stable))));
            let remark = place.remark.as_deref().filter(|text| !text.is_empty());
            let remark = remark.map(|text| format!(": {text}")).unwrap_or_default();
            let label = place.label.unwrap_or_default();
            parts.push(Part::new("course", format!("{label} at {key} = {}{remark}", readable(place.value))));
            special = Some(place.value);
            continue;
        }
        match &mut stretch {
            Some((_, end, stable)) if *stable == place.stable => *end = place.value,
            _ => {
                parts.extend(stretch.take().map(tell));
                stretch = Some((special.unwrap_or(place.value), place.value, place.stable));
            }
        }
        special = None;
    }
    parts.extend(stretch.take().map(tell));
    let steps = places.windows(2).map(|pair| (pair[1].value - pair[0].value).abs());
    let (smallest, largest) =
        steps.fold((f64::INFINITY, 0.0_f64), |(low, high), step| (low.min(step), high.max(step)));
    if places.len() > 1 {
        parts.push(Part::new(
            "steps",
            format!(
                "{} points; from one to the next {key} changes by {} to {}",
                places.len(),
                readable(smallest),
                readable(largest)
            ),
        ));
    }
    parts
}
