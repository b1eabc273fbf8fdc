//! What can be divided into shards, and how it stands in the plan of the folder: with the text of its wheel file, so that the folder is all
//! that is needed.

use crate::basin::BasinRequest;
use crate::chart::ChartRequest;
use crate::error::Error;
use crate::margin::MarginRequest;
use crate::wheel_request::WheelRequest;
use kingpin::{KingpinError, Wheel};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Name of this program in plans.
const PROGRAM: &str = "kingpin";

/// A request for an analysis that can be divided into shards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "command", rename_all = "kebab-case")]
pub enum ShardedRequest {
    /// A stability chart.
    Chart(ChartRequest),
    /// Where motions end.
    Basin(BasinRequest),
    /// Safe disturbances along a parameter.
    Margin(MarginRequest),
}

/// The file of a wheel as it was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WheelFile {
    name: String,
    text: String,
}

impl ShardedRequest {
    fn wheel(&mut self) -> &mut WheelRequest {
        match self {
            Self::Chart(request) => &mut request.wheel,
            Self::Basin(request) => &mut request.wheel,
            Self::Margin(request) => &mut request.wheel,
        }
    }

    /// What stands in a plan: texts only, of which Python and this program have the same hash.
    pub(super) fn function(&self, computation: &Value) -> Result<Value, Error> {
        let mut request = self.clone();
        let file = match request.wheel().wheel.take() {
            None => None,
            Some(path) => {
                let text = std::fs::read_to_string(&path)
                    .map_err(|source| KingpinError::Unreadable { path: path.clone(), source })?;
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                Some(WheelFile { name, text })
            }
        };
        let request = serde_json::to_string(&request).map_err(|error| unwritable(&error))?;
        Ok(json!({
            "program": PROGRAM,
            "computation": computation.to_string(),
            "request": request,
            "wheel": file,
        }))
    }

    /// The request that stands in a plan, with its wheel; nothing where there is none of this program.
    pub(super) fn of_function(function: &Value) -> Option<Result<(Self, Wheel), Error>> {
        if function["program"] != PROGRAM {
            return None;
        }
        let mut request: Self = serde_json::from_str(function["request"].as_str()?).ok()?;
        let file: Option<WheelFile> = serde_json::from_value(function["wheel"].clone()).ok()?;
        let wheel = match file {
            None => Ok(Wheel::default()),
            Some(file) => Wheel::from_toml(&file.text).map(|wheel| wheel.from_file(&file.name)),
        };
        let wheel = wheel.map_err(Error::from).and_then(|wheel| request.wheel().change(wheel));
        Some(wheel.map(|wheel| (request, wheel)))
    }
}

/// A request whose numbers cannot be written; those of a request that was checked can.
fn unwritable(error: &serde_json::Error) -> Error {
    Error::invalid(&["shard"], "", format!("the request cannot be kept: {error}"), "finite numbers")
}
