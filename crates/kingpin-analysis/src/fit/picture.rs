//! The picture of a fit: what was measured and what was fitted, and below it what is left over.

use super::fitted::{FittedColumnResult, FittedRecordResult, residuals};
use kingpin_figure::{Axis, Figure, Legend, Line, Marker, Markers, Panel, palette};
use kingpin_report::history::{drawn, extremes};
use kingpin_report::numbers::readable;

/// Height of the panels of a record in mm.
const HEIGHT_OF_ROW: f64 = 44.0;
/// Diameter of a measured point, in points.
const POINT: f64 = 1.0;
/// Width of a fitted curve, in points: it is seen around the measured ones.
const WIDTH: f64 = 1.8;
/// Standard deviations between which noise mostly lies.
const BAND: f64 = 2.0;
/// The picture.
pub(super) fn figure(records: &[FittedRecordResult]) -> Figure {
    let all: Vec<(&FittedRecordResult, &FittedColumnResult)> =
        records.iter().flat_map(|record| record.columns.iter().map(move |column| (record, column))).collect();
    let description =
        format!("Measured and fitted motions of {} records, and what is left over", records.len());
    // One motion stands above what is left of it, several each beside it.
    let is_one = all.len() == 1;
    let figure = if is_one { Figure::single_column() } else { Figure::double_column() };
    let (columns, rows) = if is_one { (1, 2) } else { (2, all.len()) };
    let figure = figure.columns(columns).height_mm(HEIGHT_OF_ROW * rows as f64).description(description);
    all.into_iter().fold(figure, |figure, (record, column)| {
        figure.panel(motion(record, column, is_one)).panel(left_over(record, column))
    })
}

fn label(column: &FittedColumnResult) -> String {
    let symbol = match column.state.as_str() {
        "psi" => "\\psi",
        "Omega" => "\\Omega",
        "V1" => "V_1",
        "V2" => "V_2",
        other => other,
    };
    format!("${symbol}$ ({})", column.unit)
}

fn times(record: &FittedRecordResult) -> Axis {
    let end = record.t[record.t.len() - 1];
    Axis::new("$t$ (s)").limits(record.t[0], end)
}

fn motion(record: &FittedRecordResult, column: &FittedColumnResult, is_above: bool) -> Panel {
    let time = if is_above { times(record).without_labels() } else { times(record) };
    let measured = record.t.iter().copied().zip(column.measured.iter().copied());
    Panel::new(time, Axis::new(label(column)))
        .title(format!("{}, $v$ = {} m/s", record.file.replace('$', "\\$"), readable(record.v)))
        .legend(Legend::Below)
        .markers(
            Markers::new(measured, Marker::default().color(palette::GREY).size(POINT)).legend("measured"),
        )
        .curve(Line::new(drawn(&record.t, &column.fitted)).color(palette::BLUE).width(WIDTH).legend("fitted"))
}

fn left_over(record: &FittedRecordResult, column: &FittedColumnResult) -> Panel {
    let residuals = residuals(column);
    let [first, last] = [record.t[0], record.t[record.t.len() - 1]];
    let band = BAND * column.sigma;
    let [low, high] = extremes(&residuals);
    let reach = 1.1 * high.max(-low).max(band);
    let points = record.t.iter().copied().zip(residuals);
    let line = |value: f64| Line::new([(first, value), (last, value)]).width(0.6).color(palette::BLACK);
    Panel::new(times(record), Axis::new(format!("residual ({})", column.unit)).limits(-reach, reach))
        .curve(line(0.0))
        .curve(line(band).dashed())
        .curve(line(-band).dashed())
        .markers(Markers::new(points, Marker::default().color(palette::GREY).size(POINT)))
}
