//! Wheels as the page has them: every parameter by key, with what is allowed; the wheels to begin with; files of wheels.

use arclength_page::{Answer, Failure, Routes, parse};
use axum::body::Bytes;
use kingpin::{Key, Tyre, Wheel};
use kingpin_report::{NamedNumbers, Number};
use serde::{Deserialize, Serialize};

/// Wheels to begin with: title and file.
const WHEELS: &[(&str, &str)] = &[
    ("Office chair", include_str!("../../kingpin/examples/wheels/office.toml")),
    ("Trolley", include_str!("../../kingpin/examples/wheels/trolley.toml")),
    ("Wheelchair", include_str!("../../kingpin/examples/wheels/wheelchair.toml")),
    ("Dolly", include_str!("../../kingpin/examples/wheels/dolly.toml")),
    ("Nose gear", include_str!("../../kingpin/examples/wheels/nosegear.toml")),
];

/// A wheel: its parameters by key.
#[derive(Debug, Serialize)]
pub(crate) struct WheelAnswer {
    parameters: NamedNumbers,
    tyre: &'static str,
}

impl WheelAnswer {
    pub(crate) fn of(wheel: &Wheel) -> Self {
        let own = Key::ALL.into_iter().filter(|key| key.sets() == [*key]);
        // What belongs to a tyre has no value without one.
        let known = own.filter(|key| wheel.tyre() != Tyre::Rigid || !key.is_of_the_tyre());
        let parameters = known.map(|key| (key.name().to_owned(), wheel.get(key))).collect();
        Self { parameters: NamedNumbers(parameters), tyre: wheel.tyre().name() }
    }
}

/// A parameter of a wheel.
#[derive(Serialize)]
struct KeyAnswer {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    meaning: &'static str,
    lowest: f64,
    highest: f64,
    infinite: bool,
    allowed: String,
    default: Number,
    of_the_tyre: bool,
}

#[derive(Serialize)]
struct NamedWheel {
    title: &'static str,
    wheel: WheelAnswer,
}

#[derive(Deserialize)]
struct WheelFile {
    text: String,
}

/// Routes of wheels.
pub(crate) fn routes() -> Routes {
    Routes::new().get("/api/keys", keys).get("/api/wheels", wheels).post("/api/wheel", wheel)
}

async fn keys() -> Answer<Vec<KeyAnswer>> {
    let own = Key::ALL.into_iter().filter(|key| key.sets() == [*key]);
    let answer = |key: Key| {
        let allowed = key.allowed();
        KeyAnswer {
            name: key.name(),
            symbol: key.symbol(),
            unit: key.unit(),
            meaning: key.meaning(),
            lowest: allowed.lowest,
            highest: allowed.highest,
            infinite: allowed.infinite,
            allowed: allowed.to_string(),
            default: Number(key.default_value()),
            of_the_tyre: key.is_of_the_tyre(),
        }
    };
    Answer(own.map(answer).collect())
}

fn read(text: &str) -> Result<WheelAnswer, Failure> {
    let wheel = Wheel::from_toml(text).map_err(|error| Failure::bad_request(error.to_string()))?;
    Ok(WheelAnswer::of(&wheel))
}

async fn wheels() -> Result<Answer<Vec<NamedWheel>>, Failure> {
    let named = |&(title, text): &(&'static str, &str)| Ok(NamedWheel { title, wheel: read(text)? });
    let others: Result<Vec<NamedWheel>, Failure> = WHEELS.iter().map(named).collect();
    let paper = NamedWheel { title: "The paper's wheel", wheel: WheelAnswer::of(&Wheel::default()) };
    Ok(Answer(std::iter::once(paper).chain(others?).collect()))
}

async fn wheel(body: Bytes) -> Result<Answer<WheelAnswer>, Failure> {
    let WheelFile { text } = parse(&body)?;
    Ok(Answer(read(&text)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_wheel_is_read_with_all_its_parameters() {
        let paper = WheelAnswer::of(&Wheel::default());
        assert_eq!(paper.parameters.named("v"), Some(4.0));
        for (title, text) in WHEELS {
            let Ok(wheel) = read(text) else { panic!("{title}") };
            assert_eq!(wheel.parameters.0.len(), paper.parameters.0.len(), "{title}");
            assert_eq!(wheel.parameters.named("r"), Some(f64::INFINITY), "{title}");
        }
        // What only sets others, and what belongs to a tyre, is no parameter of a rigid wheel.
        for key in ["k", "curvature", "C_alpha"] {
            assert_eq!(paper.parameters.named(key), None, "{key}");
        }
    }

    #[test]
    fn a_wheel_that_is_set_parameter_by_parameter_is_the_same() {
        let wheel = Wheel::from_toml(WHEELS[1].1).unwrap();
        let answer = WheelAnswer::of(&wheel);
        let mut again = Wheel::default();
        for (key, value) in &answer.parameters.0 {
            again.set(key, &value.to_string()).unwrap();
        }
        let rates = [&wheel, &again].map(|wheel| wheel.uniform_motion().unwrap().growth_rate());
        assert_eq!(rates[0], rates[1]);
    }
}
