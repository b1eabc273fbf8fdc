//! The picture of a motion, or of its crossings of a section, as it was asked for.

use super::plot::{Plot, Plotted, Variable, Windows};
use crate::model::ChosenModel;
use crate::phase_plane::PhasePlane;
use kingpin_figure::{Axis, Figure, Line, Marker, Markers, Panel, palette};
use kingpin_report::history::{drawn, extremes};

/// Width of the picture of time histories, and the heights of its panels and of the rest, in millimetres.
const HISTORIES_WIDTH: f64 = 130.0;
const HISTORY_HEIGHT: f64 = 30.0;
const REST_HEIGHT: f64 = 12.0;
/// Width of a single plane.
const PLANE_WIDTH: f64 = 120.0;
/// Part of the extent of a motion that the window of a phase plane has beyond it on every side.
const MARGIN: f64 = 0.15;
/// Most return maps.
const MOST_MAPS: usize = 4;
/// What varies less than this part of its size is constant.
const CONSTANT: f64 = 1e-8;
/// Size of the marker of a crossing, in points.
const CROSSING: f64 = 2.2;

/// What is drawn, with its points.
#[derive(Clone, Debug)]
pub(super) enum DrawnPlot {
    /// Each over the time.
    Histories(Vec<DrawnCurve>),
    /// One against another, in the phase plane where there is one.
    Plane(DrawnCurve, Option<Box<PhasePlane>>),
    /// One at a crossing against itself at the crossing before.
    ReturnMap(DrawnCurve),
}

/// The points of two quantities.
#[derive(Clone, Debug)]
pub(super) struct DrawnCurve {
    names: [String; 2],
    limits: [Option<[f64; 2]>; 2],
    points: Vec<[f64; 2]>,
    /// Whether it is a motion, not the crossings of a section.
    is_motion: bool,
}

impl DrawnPlot {
    /// What is drawn of samples, `value` being that of a quantity at a time and a state.
    pub(super) fn of(
        plot: &Plot,
        chosen: &ChosenModel,
        windows: &Windows,
        is_motion: bool,
        (times, states): (&[f64], &[Vec<f64>]),
        value: &dyn Fn(Variable, f64, &[f64]) -> f64,
    ) -> Self {
        let curve = |pair: [&Plotted; 2]| DrawnCurve {
            names: pair.map(|plotted| plotted.name.clone()),
            limits: windows.of(pair.map(|plotted| plotted.variable)),
            points: times
                .iter()
                .zip(states)
                .map(|(time, state)| pair.map(|plotted| value(plotted.variable, *time, state)))
                .collect(),
            is_motion,
        };
        match plot {
            Plot::Histories(listed) => {
                let time = Plotted { name: "t".to_owned(), variable: Variable::Time };
                Self::Histories(listed.iter().map(|plotted| curve([&time, plotted])).collect())
            }
            Plot::Against([x, y]) => {
                let mut curve = curve([x, y]);
                if is_motion {
                    curve.points = with_gaps(times, &curve.points);
                }
                let axes = match [x.variable, y.variable] {
                    [Variable::State(x), Variable::State(y)] => Some([x, y]),
                    _ => None,
                };
                let has_plane = chosen.model.states().len() == 2 && chosen.model.is_autonomous();
                let axes = axes.filter(|_| has_plane && is_motion);
                let plane = axes.map(|axes| Box::new(PhasePlane::of(chosen, axes, curve.window())));
                Self::Plane(curve, plane)
            }
        }
    }

    /// The return maps of the first quantities that vary from crossing to crossing, each with its values there and its size along the
    /// motion.
    pub(super) fn return_maps<'a>(quantities: impl Iterator<Item = (&'a str, Vec<f64>, f64)>) -> Vec<Self> {
        let varying = quantities.filter(|(_, values, size)| {
            let [low, high] = extremes(values);
            high - low > CONSTANT * size.max(low.abs()).max(high.abs())
        });
        let map = |(name, values, _): (&str, Vec<f64>, f64)| {
            Self::ReturnMap(DrawnCurve {
                names: [format!("{name} at a crossing"), format!("{name} at the next one")],
                limits: [None, None],
                points: values.windows(2).map(|pair| [pair[0], pair[1]]).collect(),
                is_motion: false,
            })
        };
        varying.take(MOST_MAPS).map(map).collect()
    }

    /// The phase plane, where there is one.
    pub(super) fn phase_plane(&self) -> Option<PhasePlane> {
        match self {
            Self::Plane(_, plane) => plane.as_deref().cloned(),
            Self::Histories(_) | Self::ReturnMap(_) => None,
        }
    }
}

impl DrawnCurve {
    /// Its own limits, or its extent with a margin.
    fn window(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            self.limits[axis].unwrap_or_else(|| {
                let values: Vec<f64> =
                    self.points.iter().map(|point| point[axis]).filter(|value| value.is_finite()).collect();
                let [low, high] = extremes(&values);
                let size = low.abs().max(high.abs());
                let margin = MARGIN * (high - low);
                if margin > CONSTANT * size {
                    [low - margin, high + margin]
                } else {
                    let half = if size > 0.0 && size.is_finite() { 0.5 * size } else { 1.0 };
                    let middle = if size.is_finite() { 0.5 * (low + high) } else { 0.0 };
                    [middle - half, middle + half]
                }
            })
        })
    }

    fn axis(&self, index: usize) -> Axis {
        let axis = Axis::new(self.names[index].as_str());
        match self.limits[index] {
            Some([low, high]) => axis.limits(low, high),
            None => axis,
        }
    }

    fn pairs(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().map(|[x, y]| (*x, *y))
    }

    /// The panel of a time history.
    fn history(&self, is_last: bool) -> Panel {
        let (times, values): (Vec<f64>, Vec<f64>) = self.pairs().unzip();
        let mut time = self.axis(0);
        if let (None, [Some(start), Some(end)]) = (self.limits[0], [times.first(), times.last()]) {
            time = time.limits(*start, *end);
        }
        let panel = Panel::new(if is_last { time } else { time.without_labels() }, self.axis(1));
        if self.is_motion {
            return panel.curve(Line::new(history(&times, &values)).color(palette::BLUE));
        }
        panel.markers(Markers::new(self.pairs(), crossing()))
    }

    /// The panel of a return map, with the line on which nothing changes.
    fn return_map(&self) -> Panel {
        let values: Vec<f64> = self.points.iter().flatten().copied().collect();
        let [low, high] = extremes(&values);
        let diagonal = Line::new([(low, low), (high, high)]).color(palette::GREY).width(0.6).dotted();
        self.plane().curve(diagonal)
    }

    /// The panel of one quantity against another.
    fn plane(&self) -> Panel {
        let panel = Panel::new(self.axis(0), self.axis(1));
        if self.is_motion {
            return panel.curve(Line::new(self.pairs()).color(palette::BLUE));
        }
        panel.markers(Markers::new(self.pairs(), crossing()))
    }
}

fn crossing() -> Marker {
    Marker::default().color(palette::BLUE).size(CROSSING)
}

/// The points of a motion, with a gap wherever it jumps: where two are at one time.
fn with_gaps(times: &[f64], points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut all = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        if index > 0 && times[index] == times[index - 1] {
            all.push([f64::NAN; 2]);
        }
        all.push(*point);
    }
    all
}

/// The points of a time history, with a gap wherever it jumps: where two values are at one time.
pub(super) fn history(times: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    let mut start = 0;
    for end in 1..=times.len() {
        if end == times.len() || times[end] == times[end - 1] {
            points.extend(drawn(&times[start..end], &values[start..end]));
            points.push((f64::NAN, f64::NAN));
            start = end;
        }
    }
    points.pop();
    points
}

/// The picture of plots: time histories below each other, planes side by side.
pub(super) fn figure(description: &str, plots: &[DrawnPlot]) -> Figure {
    let mut panels = Vec::new();
    let only_histories = plots.iter().all(|plot| matches!(plot, DrawnPlot::Histories(_)));
    for plot in plots {
        match plot {
            DrawnPlot::Histories(curves) => {
                let last = curves.len() - 1;
                let is_last = |index: usize| index == last || !only_histories;
                panels.extend(curves.iter().enumerate().map(|(index, curve)| curve.history(is_last(index))));
            }
            DrawnPlot::ReturnMap(curve) => panels.push(curve.return_map()),
            DrawnPlot::Plane(curve, None) => panels.push(curve.plane()),
            DrawnPlot::Plane(curve, Some(plane)) => panels.push(plane.panel(&curve.points)),
        }
    }
    let figure = if only_histories {
        let height = HISTORY_HEIGHT * panels.len() as f64 + REST_HEIGHT;
        Figure::with_width_mm(HISTORIES_WIDTH).height_mm(height)
    } else if panels.len() == 1 {
        Figure::with_width_mm(PLANE_WIDTH)
    } else {
        Figure::double_column().columns(2)
    };
    panels.into_iter().fold(figure.description(description), Figure::panel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_history_has_a_gap_where_it_jumps() {
        let points = history(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0]);
        assert_eq!(points.len(), 5);
        assert!(points[2].0.is_nan() && points[3] == (1.0, 5.0));
        assert_eq!(history(&[0.0, 1.0], &[2.0, 3.0]), [(0.0, 2.0), (1.0, 3.0)]);
        let plane = with_gaps(&[0.0, 1.0, 1.0], &[[0.0, 0.0], [1.0, 2.0], [5.0, 2.0]]);
        assert!(plane.len() == 4 && plane[2][0].is_nan() && plane[3] == [5.0, 2.0]);
    }
}
