//! Why a route gives no result, as JSON that names the field, what was given and what is allowed.

use arclength_analysis::{AnalysisError, Error};
use arclength_ode::Place;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

/// Why a route gives no result.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub struct Failure(Box<Problem>);

/// What is wrong, in a box of its own: results that hold it are small.
#[derive(Clone, Debug, Serialize)]
struct Problem {
    #[serde(skip)]
    status: StatusCode,
    /// What is wrong, what is allowed, what to try.
    message: String,
    /// The fields of the request that are at fault.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fields: Vec<String>,
    /// What was given there.
    #[serde(skip_serializing_if = "Option::is_none")]
    given: Option<String>,
    /// What is allowed there.
    #[serde(skip_serializing_if = "Option::is_none")]
    allowed: Option<String>,
    /// Where it is in the text of a model.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<TextPlace>,
}

/// Where something is in a text: line and column count from 1, in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct TextPlace {
    line: usize,
    column: usize,
    length: usize,
}

impl From<&Place> for TextPlace {
    fn from(place: &Place) -> Self {
        Self { line: place.line, column: place.column, length: place.length }
    }
}

#[derive(Serialize)]
struct Body<'a> {
    error: &'a Failure,
}

impl Failure {
    /// A failure with the status of its answer.
    pub fn new(status: StatusCode, message: impl Into<String>) -> Self {
        let message = message.into();
        Self(Box::new(Problem {
            status,
            message,
            fields: Vec::new(),
            given: None,
            allowed: None,
            place: None,
        }))
    }

    /// A body or field that cannot be understood.
    pub fn bad_request(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, message)
    }

    /// The failure of an analysis. The server is not at fault, whether the request makes no sense or what it asks for cannot be computed.
    pub fn of_analysis<E: AnalysisError>(error: &E) -> Self {
        let mut message = error.message(&str::to_owned);
        let mut cause = error.source();
        while let Some(source) = cause {
            let text = source.to_string();
            if !message.contains(&text) {
                message = format!("{message}: {text}");
            }
            cause = source.source();
        }
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, message)
    }

    /// As the text of an event or of a body.
    pub fn json(&self) -> String {
        serde_json::to_string(&Body { error: self }).unwrap_or_default()
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let mut failure = Self::of_analysis(&error);
        let problem = &mut failure.0;
        match &error {
            Error::Invalid(field) => {
                problem.fields = field.fields.iter().map(|name| (*name).to_owned()).collect();
                problem.given = Some(field.given.clone());
                problem.allowed = Some(field.allowed.clone());
            }
            // The page shows the line itself.
            Error::Model { source, .. } => {
                problem.message = source.to_string();
                problem.place = source.place().map(TextPlace::from);
            }
            _ => {}
        }
        failure
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        (self.0.status, [(CONTENT_TYPE, "application/json")], self.json()).into_response()
    }
}
