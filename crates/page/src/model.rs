//! The page for any `.ode` model: what a text means, and the analyses of it.

use crate::answer::Answer;
use crate::asset::Asset;
use crate::drawing::drawing_routes;
use crate::failure::{Failure, TextPlace};
use crate::openapi::described;
use crate::picture::picture_routes;
use crate::routes::Routes;
use crate::sent_files::{Asked, parse};
use crate::server::Site;
use crate::stream::Events;
use crate::work::Work;
use arclength_analysis::cycles::CyclesRequest;
use arclength_analysis::equilibria::EquilibriaRequest;
use arclength_analysis::locus::LocusRequest;
use arclength_analysis::simulate::SimulateRequest;
use arclength_analysis::{
    Along, ChosenModel, Control, Error, Interval, ModelRequest, ModelSource, OpenedModel, StoredModel,
};
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use kingpin_report::{NamedNumbers, Number};
use serde::Serialize;
use std::time::Duration;

/// Most samples of a motion.
const MOST_SAMPLES: u64 = 200_000;
/// Longest time for which a motion is computed.
const LONGEST: Duration = Duration::from_secs(120);

/// Models to begin with: name, title and text.
const GALLERY: &[(&str, &str, &str)] = &[
    ("lure.ode", "Feedback control of Lur'e type", include_str!("../../../gallery/models/lure.ode")),
    ("vanderpol.ode", "Van der Pol oscillator", include_str!("../../../gallery/models/vanderpol.ode")),
    (
        "fitzhugh_nagumo.ode",
        "FitzHugh-Nagumo nerve",
        include_str!("../../../gallery/models/fitzhugh_nagumo.ode"),
    ),
    (
        "hodgkin_huxley.ode",
        "Hodgkin-Huxley nerve",
        include_str!("../../../gallery/models/hodgkin_huxley.ode"),
    ),
    ("morris_lecar.ode", "Morris-Lecar fibre", include_str!("../../../gallery/models/morris_lecar.ode")),
    ("brusselator.ode", "Brusselator", include_str!("../../../gallery/models/brusselator.ode")),
    ("ab.ode", "A to B reaction", include_str!("../../../gallery/models/ab.ode")),
    ("bazykin.ode", "Bazykin's predator and prey", include_str!("../../../gallery/models/bazykin.ode")),
    ("pp2.ode", "Predator and prey with harvest", include_str!("../../../gallery/models/pp2.ode")),
    ("lorenz.ode", "Lorenz equations", include_str!("../../../gallery/models/lorenz.ode")),
    ("rossler.ode", "Rössler equations", include_str!("../../../gallery/models/rossler.ode")),
    ("langford.ode", "Langford's torus", include_str!("../../../gallery/models/langford.ode")),
    ("cusp.ode", "Cusp", include_str!("../../../gallery/models/cusp.ode")),
    ("bogdanov_takens.ode", "Bogdanov-Takens", include_str!("../../../gallery/models/bogdanov_takens.ode")),
    ("bautin.ode", "Bautin", include_str!("../../../gallery/models/bautin.ode")),
];

/// The files of the page.
const ASSETS: &[Asset] = &[
    Asset { path: "/", text: include_str!("../assets/model.html") },
    Asset { path: "/style.css", text: include_str!("../assets/style.css") },
    Asset { path: "/icon.svg", text: include_str!("../assets/icon.svg") },
    Asset { path: "/model.js", text: include_str!("../assets/model.js") },
    Asset { path: "/ask.js", text: include_str!("../assets/ask.js") },
    Asset { path: "/capture.js", text: include_str!("../assets/capture.js") },
    Asset { path: "/chain.js", text: include_str!("../assets/chain.js") },
    Asset { path: "/colors.js", text: include_str!("../assets/colors.js") },
    Asset { path: "/commands.js", text: include_str!("../assets/commands.js") },
    Asset { path: "/diagram.js", text: include_str!("../assets/diagram.js") },
    Asset { path: "/drawing.js", text: include_str!("../assets/drawing.js") },
    Asset { path: "/editor.js", text: include_str!("../assets/editor.js") },
    Asset { path: "/element.js", text: include_str!("../assets/element.js") },
    Asset { path: "/menu.js", text: include_str!("../assets/menu.js") },
    Asset { path: "/numbers.js", text: include_str!("../assets/numbers.js") },
    Asset { path: "/plot.js", text: include_str!("../assets/plot.js") },
    Asset { path: "/point.js", text: include_str!("../assets/point.js") },
    Asset { path: "/quantities.js", text: include_str!("../assets/quantities.js") },
    Asset { path: "/rows.js", text: include_str!("../assets/rows.js") },
    Asset { path: "/save.js", text: include_str!("../assets/save.js") },
    Asset { path: "/starts.js", text: include_str!("../assets/starts.js") },
    Asset { path: "/state.js", text: include_str!("../assets/state.js") },
    Asset { path: "/undo.js", text: include_str!("../assets/undo.js") },
    Asset { path: "/zoom.js", text: include_str!("../assets/zoom.js") },
];

/// The model that the page begins with.
#[derive(Clone, Debug, Serialize)]
pub struct StartModel {
    /// Name of its file.
    pub name: String,
    /// Its text.
    pub source: String,
}

/// The page for any model, beginning with one where one is given.
pub fn model_site(start: Option<StartModel>) -> Site {
    Site {
        assets: ASSETS.to_vec(),
        routes: routes(),
        start: serde_json::json!({ "model": start, "version": env!("CARGO_PKG_VERSION") }),
        description: described(include_str!("../openapi.json")),
    }
}

/// Routes of what can be asked of any model.
fn routes() -> Routes {
    Routes::new()
        .get("/api/gallery", gallery)
        .post("/api/model", model)
        .post("/api/equilibria", equilibria)
        .post("/api/cycles", cycles)
        .post("/api/locus", locus)
        .post("/api/simulate", simulate)
        .merge(picture_routes())
        .merge(drawing_routes())
}

#[derive(Serialize)]
struct GalleryModel {
    name: &'static str,
    title: &'static str,
    source: &'static str,
}

async fn gallery() -> Answer<Vec<GalleryModel>> {
    Answer(GALLERY.iter().map(|&(name, title, source)| GalleryModel { name, title, source }).collect())
}

/// What a text means.
#[derive(Serialize)]
#[serde(untagged)]
enum Meaning {
    Model(Box<ModelAnswer>),
    /// It is no model yet, as it is while somebody writes one: no failure of the request.
    Mistake {
        mistake: Failure,
    },
}

/// A model as the page has it.
#[derive(Serialize)]
struct ModelAnswer {
    /// States with their initial values.
    states: NamedNumbers,
    /// Parameters with their values.
    parameters: NamedNumbers,
    /// The parameter that the model means to vary first, with its interval, where it says so.
    along: Option<Interval>,
    /// Its sets of values.
    named_sets: Vec<NamedSet>,
    /// How long its motions are to be followed, where it says so.
    duration: Option<Number>,
    /// Where the right-hand side depends on the time.
    time: Option<TextPlace>,
    warnings: Vec<Warning>,
}

/// A set of values of a model: what differs from the model itself.
#[derive(Serialize)]
struct NamedSet {
    name: String,
    states: NamedNumbers,
    parameters: NamedNumbers,
}

impl NamedSet {
    fn of(set: &arclength_ode::NamedSet, chosen: &ChosenModel) -> Self {
        let named = |names: &[String], values: &[(usize, f64)]| {
            NamedNumbers(values.iter().map(|(index, value)| (names[*index].clone(), *value)).collect())
        };
        Self {
            name: set.name.clone(),
            states: named(chosen.model.states(), &set.states),
            parameters: named(chosen.model.parameters(), &set.parameters),
        }
    }
}

#[derive(Serialize)]
struct Warning {
    message: String,
    place: TextPlace,
}

async fn model(State(work): State<Work>, body: Bytes) -> Result<Answer<Meaning>, Failure> {
    let stored: StoredModel = parse(&body)?;
    work.answer(move |_| {
        let OpenedModel { chosen, .. } = match ModelRequest::new(ModelSource::Text(stored)).open() {
            Ok(opened) => opened,
            Err(mistake @ Error::Model { .. }) => {
                return Ok(Answer(Meaning::Mistake { mistake: mistake.into() }));
            }
            Err(error) => return Err(error.into()),
        };
        let first = chosen.model.parameters().first();
        let along = first.and_then(|key| chosen.interval(&Along::Parameter { key: key.clone() }).ok());
        let options = chosen.model.options();
        Ok(Answer(Meaning::Model(Box::new(ModelAnswer {
            states: chosen.named_state(&chosen.start),
            parameters: chosen.named_parameters(&[]),
            along: along.filter(|along| along.start.is_finite() && along.end.is_finite()),
            named_sets: chosen.model.sets().iter().map(|set| NamedSet::of(set, &chosen)).collect(),
            duration: options.total.filter(|total| *total > 0.0).map(Number),
            time: chosen.model.time_dependence().map(TextPlace::from),
            warnings: chosen
                .model
                .warnings()
                .iter()
                .map(|warning| Warning { message: warning.message.clone(), place: (&warning.place).into() })
                .collect(),
        }))))
    })
    .await
}

async fn equilibria(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<EquilibriaRequest>>(&body)?;
    work.stream(move || {
        let analysis = request.validate_among(&files)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            let result = analysis.run_watched(control, &mut |point| events.point(point))?;
            events.warn_of(&result.warnings());
            events.result(&result)
        })
    })
    .await
}

async fn cycles(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<CyclesRequest>>(&body)?;
    work.stream(move || {
        let analysis = request.validate_among(&files)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            let result = analysis.run_watched(control, &mut |point| events.point(point))?;
            events.warn_of(&result.warnings());
            events.result(&result)
        })
    })
    .await
}

async fn locus(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<LocusRequest>>(&body)?;
    work.stream(move || {
        let analysis = request.validate_among(&files)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            let result = analysis.run_watched(control, &mut |point| events.point(point))?;
            events.warn_of(&result.warnings());
            events.result(&result)
        })
    })
    .await
}

async fn simulate(State(work): State<Work>, body: Bytes) -> Result<Response, Failure> {
    let Asked { request, files } = parse::<Asked<SimulateRequest>>(&body)?;
    if let Some(points) = request.points.filter(|points| *points > MOST_SAMPLES) {
        let message = format!("points {points}: too many for the page; allowed: up to {MOST_SAMPLES}");
        return Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, message));
    }
    work.stream(move || {
        let analysis = request.validate_among(&files).map_err(Failure::from)?;
        Ok(move |control: &Control<'_>, events: &Events| {
            events.warn_of(analysis.warnings());
            let (result, is_late) = events.within(LONGEST, || analysis.run_under(control));
            let result = result.map_err(|error: Error| Failure::from(error))?;
            events.warn_of(&result.warnings);
            if is_late {
                let message = format!(
                    "it was stopped after {} s of computing; the command line has no limit",
                    LONGEST.as_secs()
                );
                events.tell("warning", &message);
            }
            events.result(&result)
        })
    })
    .await
}
