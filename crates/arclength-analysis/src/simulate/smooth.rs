//! Times at which a motion has to be known for its curves to look smooth.

/// Sine of the angle between neighbouring pieces of a curve that looks smooth.
const SMOOTH: f64 = 0.04;
/// Pieces shorter than this part of the picture are not divided.
const SHORT: f64 = 0.004;
/// Pieces longer than this part of the picture are.
const LONG: f64 = 0.1;
/// Into how many a piece is divided at once.
const PARTS: usize = 4;
/// Most times.
const MOST_TIMES: usize = 40_000;

/// The times with others between them where one of the curves, given by its points at these times, bends or leaps; nothing where all look
/// smooth.
pub(super) fn finer_times(times: &[f64], curves: &[Vec<[f64; 2]>]) -> Option<Vec<f64>> {
    let pieces = times.len().checked_sub(1).filter(|_| times.len() <= MOST_TIMES)?;
    let mut divided = vec![false; pieces];
    for curve in curves {
        let steps = steps(curve);
        let length = |[x, y]: [f64; 2]| x.hypot(y);
        for (index, step) in steps.iter().enumerate() {
            divided[index] |= length(*step) > LONG;
        }
        for (index, pair) in steps.windows(2).enumerate() {
            let [[a, b], [c, d]] = [pair[0], pair[1]];
            let lengths = [length(pair[0]), length(pair[1])];
            let bends = (a * d - b * c).abs() > SMOOTH * lengths[0] * lengths[1] || a * c + b * d < 0.0;
            for side in 0..2 {
                divided[index + side] |= bends && lengths[side] > SHORT;
            }
        }
    }
    if !divided.contains(&true) {
        return None;
    }
    let mut finer = Vec::with_capacity(2 * times.len());
    for (pair, divided) in times.windows(2).zip(divided) {
        let parts = if divided { PARTS } else { 1 };
        finer.extend((0..parts).map(|part| pair[0] + (pair[1] - pair[0]) * part as f64 / parts as f64));
    }
    finer.extend(times.last());
    finer.dedup();
    Some(finer)
}

/// The steps from point to point, in parts of the extent of the curve.
fn steps(curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let extent = |axis: usize| {
        let values = curve.iter().map(|point| point[axis]).filter(|value| value.is_finite());
        let [low, high] = values
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        if high > low { high - low } else { 1.0 }
    };
    let extents = [extent(0), extent(1)];
    curve.windows(2).map(|pair| [0, 1].map(|axis| (pair[1][axis] - pair[0][axis]) / extents[axis])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_circle_becomes_smooth_and_a_line_stays_as_it_is() {
        let circle = |times: &[f64]| vec![times.iter().map(|t| [t.cos(), t.sin()]).collect::<Vec<_>>()];
        let mut times: Vec<f64> = (0..=10).map(f64::from).collect();
        for _ in 0..6 {
            let Some(finer) = finer_times(&times, &circle(&times)) else { break };
            times = finer;
        }
        assert!(finer_times(&times, &circle(&times)).is_none());
        assert!((100..2000).contains(&times.len()), "{}", times.len());
        let line: Vec<f64> = (0..=20).map(f64::from).collect();
        assert!(finer_times(&line, &[line.iter().map(|t| [*t, 2.0 * t]).collect()]).is_none());
    }
}
