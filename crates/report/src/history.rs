//! Time histories as they are summed up and drawn.

use crate::table::Table;

/// A curve of more samples than this is drawn through the smallest and largest of each of half as many groups.
const DRAWN_POINTS: usize = 4000;

/// The smallest and the largest value.
pub fn extremes(values: &[f64]) -> [f64; 2] {
    values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| [low.min(value), high.max(value)])
}

/// A table of what becomes of quantities, each with its name, values and unit.
pub fn summary<'a>(quantities: impl IntoIterator<Item = (&'a str, &'a Vec<f64>, &'a str)>) -> Table {
    let mut table = Table::new(["", "start", "end", "smallest", "largest", ""]);
    for (name, values, unit) in quantities {
        let [smallest, largest] = extremes(values);
        let [start, end] = [values.first(), values.last()].map(|end| end.copied().into());
        table.row([name.into(), start, end, smallest.into(), largest.into(), unit.into()]);
    }
    table
}

/// The points through which a curve is drawn: all, or the extremes of groups of neighbours.
pub fn drawn(times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let all = || times.iter().copied().zip(values.iter().copied());
    if values.len() <= DRAWN_POINTS {
        return all().collect();
    }
    let group = (2 * values.len()).div_ceil(DRAWN_POINTS);
    let points: Vec<(f64, f64)> = all().collect();
    let smaller = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    points
        .chunks(group)
        .flat_map(|neighbours| {
            let ends = [neighbours.iter().min_by(smaller), neighbours.iter().max_by(smaller)];
            let mut ends: Vec<(f64, f64)> = ends.into_iter().flatten().copied().collect();
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            ends
        })
        .collect()
}
