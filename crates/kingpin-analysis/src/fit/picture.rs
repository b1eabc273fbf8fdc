//! The picture of a fit: what was measured and what was fitted, and below it what is left over.

use super::fitted::{FittedColumnResult, FittedRecordResult, residuals};
use kingpin_figure::{Axis, Figure, Legend, Line, Marker, Markers, Panel, palette};
use kingpin_report::history::{drawn, extremes};
use kingpin_report::numbers::readable;

/// Height of the panels of a record in mm.
const HEIGHT_OF_ROW: f64 = 42.0;
/// Diameter of a measured point, in points.
const POINT: f64 = 1.6;
/// Standard deviations between which noise mostly lies.
const BAND: f64 = 2.0;
/// Most records side by side.
const MOST_COLUMNS: usize = 2;

/// The picture.
pub(super) fn figure(records: &[FittedRecordResult]) -> Figure {
    let all: Vec<(&FittedRecordResult, &FittedColumnResult)> =
        records.iter().flat_map(|record| record.columns.iter().map(move |column| (record, column))).collect();
    let side_by_side = all.len().clamp(1, MOST_COLUMNS);
    let rows = all.len().div_ceil(side_by_side);
    let figure = if side_by_side == 1 { Figure::single_column() } else { Figure::double_column() };
    let description =
        format!("Measured and fitted motions of {} records, and what is left over", records.len());
    let mut figure =
        figure.columns(side_by_side).height_mm(2.0 * HEIGHT_OF_ROW * rows as f64).description(description);
    for pair in all.chunks(side_by_side) {
        for (record, column) in pair {
            figure = figure.panel(motion(record, column));
        }
        for (record, column) in pair {
            figure = figure.panel(left_over(record, column));
        }
    }
    figure
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

fn motion(record: &FittedRecordResult, column: &FittedColumnResult) -> Panel {
    let measured = record.t.iter().copied().zip(column.measured.iter().copied());
    Panel::new(times(record).without_labels(), Axis::new(label(column)))
        .title(format!("{}, $v$ = {} m/s", record.file.replace('$', "\\$"), readable(record.v)))
        .legend(Legend::Below)
        .markers(
            Markers::new(measured, Marker::default().color(palette::GREY).size(POINT)).legend("measured"),
        )
        .curve(Line::new(drawn(&record.t, &column.fitted)).color(palette::BLUE).legend("fitted"))
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
