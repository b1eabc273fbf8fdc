//! Analyses of a wheel, each with its picture.

use crate::limits::Limited;
use arclength_analysis::{Control, Files, FilesInMemory, FoundPoint};
use arclength_page::{
    Answer, Asked, Events, Failure, Look, OwnColors, PictureAnswer, Routes, Work, drawn, parse, saved,
};
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use kingpin_analysis::basin::{BasinRequest, BasinResult};
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::cycles::CyclesRequest;
use kingpin_analysis::diagram::diagram;
use kingpin_analysis::locus::LocusRequest;
use kingpin_analysis::report::ReportRequest;
use kingpin_analysis::shimmy::{DrawnShimmy, ShimmyRequest};
use kingpin_analysis::simulate::SimulateRequest;
use kingpin_analysis::stability::{StabilityPart, StabilityRequest, StabilityResult};
use kingpin_analysis::steady::{SteadyRequest, SteadyResult};
use kingpin_analysis::{Error, Journal, ResultFile, SeenFromAbove, WheelRequest};
use kingpin_report::{NamedNumbers, Report};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Samples of a period that is seen from above.
const PERIOD_SAMPLES: usize = 401;
/// The same of a cycle without a label, as every cycle of a branch is sent.
const FEW_SAMPLES: usize = 61;

/// Routes of what can be asked of a wheel.
pub(crate) fn routes() -> Routes {
    Routes::new()
        .post("/api/wheel/verdict", verdict)
        .post("/api/wheel/report", report)
        .post("/api/wheel/chart", chart)
        .post("/api/wheel/cycles", cycles)
        .post("/api/wheel/shimmy", shimmy)
        .post("/api/wheel/locus", locus)
        .post("/api/wheel/diagram", draw)
        .post("/api/wheel/simulate", simulate)
        .post("/api/wheel/basin", basin)
        .post("/api/wheel/save", save)
}

fn failure(error: Error) -> Failure {
    Failure::of_analysis(&error)
}

fn broken(message: String) -> Failure {
    Failure::new(StatusCode::INTERNAL_SERVER_ERROR, message)
}

/// Reads a request that the page waits for, with the results that it starts from.
fn limited_with_files<R: Limited + serde::de::DeserializeOwned>(
    body: &Bytes,
) -> Result<(R, FilesInMemory), Failure> {
    let Asked { request, files } = parse::<Asked<R>>(body)?;
    request.check()?;
    Ok((request, files))
}

/// A request whose picture is told, with the look of that.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Pictured<R> {
    request: R,
    #[serde(default)]
    look: Look,
}

/// Reads a request that the page waits for, with the look of its picture.
fn limited_with_look<R: Limited + serde::de::DeserializeOwned>(body: &Bytes) -> Result<(R, Look), Failure> {
    let Pictured { request, look } = parse::<Pictured<R>>(body)?;
    request.check()?;
    Ok((request, look))
}

/// Reads a request that the page waits for.
fn limited<R: Limited + serde::de::DeserializeOwned>(body: &Bytes) -> Result<R, Failure> {
    let Asked { request, .. } = parse::<Asked<R>>(body)?;
    request.check()?;
    Ok(request)
}

/// What is known of a wheel at once.
#[derive(Serialize)]
struct Verdict {
    /// The uniform motion.
    state: NamedNumbers,
    friction_force: f64,
    normal_force: f64,
    rolls: bool,
    eigenvalues: Vec<[f64; 2]>,
    growth_rate: f64,
    stable: Option<bool>,
    critical_speed: Option<f64>,
    critical_yaw_rate: Option<f64>,
    /// Speeds that were looked at, and the stability over them.
    searched: [f64; 2],
    speeds: Vec<StabilityPart>,
    /// Whether there can be no other changes.
    closed_form: bool,
    swing_factor: Option<f64>,
    critical_speed_with_friction: Option<f64>,
    /// As the commands `steady` and `stability` print it.
    text: String,
    /// The uniform motion as it is seen from above, with its forces.
    above: SeenFromAbove,
}

fn table<R: Report>(result: &R) -> Result<String, Failure> {
    let mut text = Vec::new();
    result.write_table(&mut text).map_err(|error| broken(error.to_string()))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

async fn verdict(State(work): State<Work>, body: Bytes) -> Result<Answer<Verdict>, Failure> {
    let wheel: WheelRequest = limited(&body)?;
    work.answer(move |_| {
        let steady: SteadyResult = SteadyRequest { wheel: wheel.clone() }.run().map_err(failure)?;
        let stability: StabilityResult = StabilityRequest { wheel }.run().map_err(failure)?;
        let text = format!("{}\n{}", table(&steady)?, table(&stability)?);
        Ok(Answer(Verdict {
            above: steady.seen_from_above().map_err(failure)?,
            state: steady.state,
            friction_force: steady.friction_force,
            normal_force: steady.normal_force,
            rolls: steady.rolls,
            eigenvalues: stability.eigenvalues,
            growth_rate: stability.growth_rate,
            stable: stability.stable,
            critical_speed: stability.critical_speed,
            critical_yaw_rate: stability.critical_yaw_rate,
            searched: stability.searched,
            speeds: stability.speeds,
            closed_form: stability.closed_form,
            swing_factor: stability.swing_factor,
            critical_speed_with_friction: stability.critical_speed_with_friction,
            text,
        }))
    })
    .await
}

async fn report(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let request: ReportRequest = limited(&body)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.result(&analysis.find(control).map_err(failure)?)
        })
    })
    .await
}

/// Tells the picture of a result, then the result.
fn show<R: Report>(events: &Events, look: Look, result: &R) -> Result<(), Failure> {
    if let Some(figure) = result.figure().map_err(|error| broken(error.to_string()))? {
        events.tell_data("picture", &PictureAnswer::of(&look.of(figure))?);
    }
    events.warn_of(&result.parameters().remarks);
    events.result(result)
}

async fn chart(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let (request, look) = limited_with_look::<ChartRequest>(&body)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            show(events, look, &analysis.run(control).map_err(failure)?)
        })
    })
    .await
}

/// A motion to be seen from above: of a point of a branch, or one that was let go.
#[derive(Serialize)]
struct Motion<'a> {
    label: Option<&'a str>,
    /// Of a cycle: the value of the parameter and the period, by which its point is known in the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 2]>,
    #[serde(flatten)]
    seen: SeenFromAbove,
}

async fn cycles(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let (request, files) = limited_with_files::<CyclesRequest>(&body)?;
    work.stream(move || {
        let analysis = request.validate_among(&files).map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(&analysis.warnings());
            let mut watcher = |point: FoundPoint<'_>| {
                events.point(FoundPoint { orbit: None, ..point });
                // What is seen of a cycle that cannot be seen is not missed: its point is there.
                let seen = point.orbit.and_then(|orbit| {
                    let at = [point.values[0], orbit.period];
                    let seen = analysis.seen_from_above(point.values[0], orbit, FEW_SAMPLES).ok()?;
                    Some(Motion { label: None, at: Some(at), seen })
                });
                if let Some(motion) = seen {
                    events.tell_data("motion", &motion);
                }
            };
            let result = analysis.run_watched(control, &mut watcher).map_err(failure)?;
            for point in &result.points {
                let label = point.cycle.label.as_deref();
                if let Some(seen) = result.seen_from_above(point, PERIOD_SAMPLES).map_err(failure)? {
                    let at = Some([point.cycle.value, point.cycle.period]);
                    events.tell_data("motion", &Motion { label, at, seen });
                }
            }
            events.warn_of(&result.warnings());
            events.warn_of(&result.parameters().remarks);
            events.result(&result)
        })
    })
    .await
}

async fn locus(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let (request, files) = limited_with_files::<LocusRequest>(&body)?;
    work.stream(move || {
        let analysis = request.validate_among(&files).map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            let result = analysis.run_watched(control, &mut |point| events.point(point)).map_err(failure)?;
            events.warn_of(&result.warnings());
            events.warn_of(&result.parameters().remarks);
            events.result(&result)
        })
    })
    .await
}

/// Asks for a picture, or a file, of results that belong together.
#[derive(Deserialize)]
struct DiagramRequest {
    /// The results, by name.
    results: Vec<PathBuf>,
    format: String,
    /// Colours of their own.
    #[serde(default)]
    colors: OwnColors,
    #[serde(flatten)]
    look: Look,
}

async fn draw(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<DiagramRequest>>(&body)?;
    work.answer(move |_| {
        let DiagramRequest { results: names, format, colors, look } = request;
        // Shimmy stands by itself: nothing starts from it.
        let is_table = ["csv", "text"].contains(&&*format);
        if let [one] = &names[..]
            && !is_table
            && let Some(shimmy) = files.read(one).ok().and_then(|text| DrawnShimmy::of(&text))
        {
            return drawn(&format, look, shimmy.figure().map_err(failure)?);
        }
        let wrong = |index: usize, problem: String| {
            let name = names.get(index).map_or_else(String::new, |name| format!("{}: ", name.display()));
            Failure::new(StatusCode::UNPROCESSABLE_ENTITY, format!("{name}{problem}"))
        };
        let read = |(index, name): (usize, &PathBuf)| {
            ResultFile::read_among(&files, name).map_err(|problem| wrong(index, problem))
        };
        let results: Vec<ResultFile> = names.iter().enumerate().map(read).collect::<Result<_, _>>()?;
        // A single result is saved as the command that computed it does.
        if let [one] = &results[..]
            && (colors.is_empty() || is_table)
        {
            return match one {
                ResultFile::Hopf(result) => saved(&format, look, result),
                ResultFile::Cycles(result) => saved(&format, look, result),
                ResultFile::MotionLocus(result) => saved(&format, look, result),
                ResultFile::CycleLocus(result) => saved(&format, look, result),
            };
        }
        let figure =
            diagram(&results, &colors.of(&names)).map_err(|(index, problem)| wrong(index, problem))?;
        drawn(&format, look, figure)
    })
    .await
}

async fn shimmy(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let (request, look) = limited_with_look::<ShimmyRequest>(&body)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            let result = analysis.run(control).map_err(failure)?;
            for point in result.points.iter().filter(|point| point.label.is_some()) {
                let seen = result.seen_from_above(point, PERIOD_SAMPLES, control).map_err(failure)?;
                events.tell_data("motion", &Motion { label: point.label.as_deref(), at: None, seen });
            }
            show(events, look, &result)
        })
    })
    .await
}

async fn simulate(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let request: SimulateRequest = limited(&body)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            let result = analysis.run(control).map_err(failure)?;
            events.warn_of(&result.warnings());
            let seen = result.seen_from_above();
            events.tell_data("motion", &Motion { label: None, at: None, seen });
            events.warn_of(&result.parameters().remarks);
            events.result(&result)
        })
    })
    .await
}

/// A fate as it is drawn.
#[derive(Serialize)]
struct DrawnFate {
    name: &'static str,
    /// Red, green, blue.
    color: [u8; 3],
}

/// A map of fates: one byte for every cell, row by row from the lowest.
#[derive(Serialize)]
struct Map<'a> {
    columns: usize,
    rows: usize,
    /// What each byte means, from `0` on.
    fates: Vec<DrawnFate>,
    /// The ends of both axes.
    ends: [[f64; 2]; 2],
    states: [&'a str; 2],
    cells: String,
}

impl<'a> Map<'a> {
    fn of(result: &'a BasinResult) -> Self {
        let mut fates: Vec<DrawnFate> = Vec::new();
        let mut cells = String::with_capacity(result.fates.len());
        for fate in &result.fates {
            let name = fate.0.name();
            let index = fates.iter().position(|known| known.name == name).unwrap_or_else(|| {
                fates.push(DrawnFate { name, color: fate.color().rgb });
                fates.len() - 1
            });
            // There are fewer fates than digits.
            cells.push(char::from(b'0' + index as u8));
        }
        Self {
            columns: result.x.values.len(),
            rows: result.y.values.len(),
            fates,
            ends: result.ends,
            states: [result.x.state, result.y.state],
            cells,
        }
    }
}

async fn basin(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let request: BasinRequest = limited(&body)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            let result = analysis.run(control, &Journal::none()).map_err(failure)?;
            events.tell_data("map", &Map::of(&result));
            events.result(&result)
        })
    })
    .await
}

/// Asks for a result in a format in which results are saved.
#[derive(Deserialize)]
struct SaveRequest {
    #[serde(flatten)]
    analysis: SavedAnalysis,
    format: String,
    #[serde(flatten)]
    look: Look,
}

#[derive(Deserialize)]
#[serde(tag = "analysis", content = "request", rename_all = "lowercase")]
enum SavedAnalysis {
    Chart(ChartRequest),
    Cycles(CyclesRequest),
    Shimmy(ShimmyRequest),
    Motion(SimulateRequest),
    Basin(BasinRequest),
}

async fn save(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let SaveRequest { analysis, format, look } = parse(&body)?;
    work.answer(move |control| match analysis {
        SavedAnalysis::Chart(request) => {
            request.check()?;
            saved(
                &format,
                look,
                &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?,
            )
        }
        SavedAnalysis::Cycles(request) => {
            request.check()?;
            saved(
                &format,
                look,
                &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?,
            )
        }
        SavedAnalysis::Shimmy(request) => {
            request.check()?;
            saved(
                &format,
                look,
                &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?,
            )
        }
        SavedAnalysis::Motion(request) => {
            request.check()?;
            saved(
                &format,
                look,
                &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?,
            )
        }
        SavedAnalysis::Basin(request) => {
            request.check()?;
            let analysis = request.validate().map_err(failure)?;
            saved(&format, look, &analysis.run(control, &Journal::none()).map_err(failure)?)
        }
    })
    .await
}
