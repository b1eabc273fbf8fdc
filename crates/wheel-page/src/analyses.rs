//! Analyses of a wheel, each with its picture.

use arclength_analysis::Control;
use arclength_page::{Answer, Asked, Events, Failure, PictureAnswer, Work, parse, saved};
use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use axum::routing::post;
use kingpin_analysis::chart::ChartRequest;
use kingpin_analysis::cycles::CyclesRequest;
use kingpin_analysis::simulate::SimulateRequest;
use kingpin_analysis::stability::{StabilityRequest, StabilityResult};
use kingpin_analysis::steady::{SteadyRequest, SteadyResult};
use kingpin_analysis::{Error, WheelRequest};
use kingpin_report::{NamedNumbers, Report};
use serde::{Deserialize, Serialize};

/// Most points of a chart that the page asks for.
const MOST_CHART_POINTS: usize = 250_000;
/// Longest time in s for which a motion is followed.
const LONGEST_MOTION: f64 = 600.0;

/// Routes of what can be asked of a wheel.
pub(crate) fn routes() -> Router<Work> {
    Router::new()
        .route("/api/wheel/verdict", post(verdict))
        .route("/api/wheel/chart", post(chart))
        .route("/api/wheel/cycles", post(cycles))
        .route("/api/wheel/simulate", post(simulate))
        .route("/api/wheel/save", post(save))
}

fn failure(error: Error) -> Failure {
    Failure::of_analysis(&error)
}

fn broken(message: String) -> Failure {
    Failure::new(StatusCode::INTERNAL_SERVER_ERROR, message)
}

/// That the wheel comes with the request, not from a file of the machine.
fn without_file(wheel: &WheelRequest) -> Result<(), Failure> {
    if wheel.wheel.is_none() {
        return Ok(());
    }
    Err(Failure::new(
        StatusCode::UNPROCESSABLE_ENTITY,
        "wheel: no files are read; allowed: set, a list of keys and values",
    ))
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
    swing_factor: Option<f64>,
    critical_speed_with_friction: Option<f64>,
    /// As the commands `steady` and `stability` print it.
    text: String,
}

fn table<R: Report>(result: &R) -> Result<String, Failure> {
    let mut text = Vec::new();
    result.write_table(&mut text).map_err(|error| broken(error.to_string()))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

async fn verdict(State(work): State<Work>, body: Bytes) -> Result<Answer<Verdict>, Failure> {
    let Asked { request: wheel, .. } = parse::<Asked<WheelRequest>>(&body)?;
    without_file(&wheel)?;
    work.answer(move |_| {
        let steady: SteadyResult = SteadyRequest { wheel: wheel.clone() }.run().map_err(failure)?;
        let stability: StabilityResult = StabilityRequest { wheel }.run().map_err(failure)?;
        let text = format!("{}\n{}", table(&steady)?, table(&stability)?);
        Ok(Answer(Verdict {
            state: steady.state,
            friction_force: steady.friction_force,
            normal_force: steady.normal_force,
            rolls: steady.rolls,
            eigenvalues: stability.eigenvalues,
            growth_rate: stability.growth_rate,
            stable: stability.stable,
            critical_speed: stability.critical_speed,
            critical_yaw_rate: stability.critical_yaw_rate,
            swing_factor: stability.swing_factor,
            critical_speed_with_friction: stability.critical_speed_with_friction,
            text,
        }))
    })
    .await
}

/// Tells the picture of a result, then the result.
fn show<R: Report>(events: &Events, result: &R) -> Result<(), Failure> {
    if let Some(figure) = result.figure().map_err(|error| broken(error.to_string()))? {
        events.tell_data("picture", &PictureAnswer::of(&figure)?);
    }
    events.warn_of(&result.parameters().remarks);
    events.result(result)
}

/// That a chart is one that the page waits for, and its wheel comes with it.
fn check_chart(request: &ChartRequest) -> Result<(), Failure> {
    without_file(&request.wheel)?;
    if request.x.count.saturating_mul(request.y.count) <= MOST_CHART_POINTS {
        return Ok(());
    }
    let message = format!("x and y: too many points for the page; allowed: {MOST_CHART_POINTS} in all");
    Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message))
}

/// That cycles start from Hopf points, not from a file of the machine.
fn check_cycles(request: &CyclesRequest) -> Result<(), Failure> {
    without_file(&request.wheel)?;
    if request.from.is_none() {
        return Ok(());
    }
    let message = "from: the page follows the cycles of all Hopf points; allowed: nothing";
    Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message))
}

/// That a motion is one that the page waits for.
fn check_motion(request: &SimulateRequest) -> Result<(), Failure> {
    without_file(&request.wheel)?;
    if request.duration <= LONGEST_MOTION {
        return Ok(());
    }
    let message =
        format!("duration {}: too long for the page; allowed: up to {LONGEST_MOTION} s", request.duration);
    Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message))
}

async fn chart(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, .. } = parse::<Asked<ChartRequest>>(&body)?;
    check_chart(&request)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            show(events, &analysis.run(control).map_err(failure)?)
        })
    })
    .await
}

async fn cycles(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, .. } = parse::<Asked<CyclesRequest>>(&body)?;
    check_cycles(&request)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(&analysis.warnings());
            show(events, &analysis.run(control).map_err(failure)?)
        })
    })
    .await
}

async fn simulate(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, .. } = parse::<Asked<SimulateRequest>>(&body)?;
    check_motion(&request)?;
    work.stream(move || {
        let analysis = request.validate().map_err(failure)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            show(events, &analysis.run(control).map_err(failure)?)
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
}

#[derive(Deserialize)]
#[serde(tag = "analysis", content = "request", rename_all = "lowercase")]
enum SavedAnalysis {
    Chart(ChartRequest),
    Cycles(CyclesRequest),
    Motion(SimulateRequest),
}

async fn save(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let SaveRequest { analysis, format } = parse(&body)?;
    work.answer(move |control| match analysis {
        SavedAnalysis::Chart(request) => {
            check_chart(&request)?;
            saved(&format, &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?)
        }
        SavedAnalysis::Cycles(request) => {
            check_cycles(&request)?;
            saved(&format, &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?)
        }
        SavedAnalysis::Motion(request) => {
            check_motion(&request)?;
            saved(&format, &request.validate().and_then(|analysis| analysis.run(control)).map_err(failure)?)
        }
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_request_names_a_file() {
        assert!(without_file(&WheelRequest::default()).is_ok());
        let named = WheelRequest { wheel: Some("/etc/hostname".into()), set: Vec::new() };
        assert!(without_file(&named).is_err());
    }
}
