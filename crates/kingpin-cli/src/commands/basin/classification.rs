//! How motions are followed and told apart, an option of every command that asks where they end.

use crate::error::Error;
use clap::{Args, ValueEnum};
use kingpin::basin::{ClassificationSettings, ContactModel, Fate};
use kingpin::{KingpinError, Wheel};
use kingpin_figure::{Color, palette};
use kingpin_terminal::Output;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Whether the wheel may slide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Contact {
    /// Ideal rolling, as in the paper and in `cycles`: the ground supplies whatever force that takes
    #[default]
    Rolling,
    /// Coulomb friction: the wheel slides where rolling takes more than the static friction
    Sliding,
}

/// How motions are followed.
#[derive(Args, Clone, Debug)]
pub struct Classification {
    // Rolling is the default because there the uniform motion always exists: that of the paper's wheel takes more friction
    // than there is, so that a wheel that may slide has nothing to return to.
    /// Whether the wheel may slide
    #[arg(long, value_enum, default_value_t)]
    contact: Contact,

    /// Time in s for which motions are followed, up to ten times as long while they swing to and fro unsettled [default: 12 times the
    /// decay time of small disturbances, 30 to 300]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    duration: Option<f64>,
}

impl Classification {
    /// The model of the contact.
    pub fn model(&self) -> ContactModel {
        match self.contact {
            Contact::Rolling => ContactModel::Rolling,
            Contact::Sliding => ContactModel::Sliding,
        }
    }

    /// The settings for a wheel.
    ///
    /// # Errors
    /// No uniform motion, or a duration that is not positive.
    pub fn settings(&self, wheel: &Wheel) -> Result<ClassificationSettings, Error> {
        match self.duration {
            Some(duration) if duration > 0.0 && duration.is_finite() => {
                Ok(ClassificationSettings { duration })
            }
            Some(duration) => Err(Error::invalid(
                &["duration"],
                duration.to_string(),
                "no time to follow a motion".to_owned(),
                "positive and finite, in s".to_owned(),
            )),
            None => Ok(ClassificationSettings::for_wheel(wheel)?),
        }
    }

    /// The duration where it was given.
    pub fn duration(&self) -> Option<f64> {
        self.duration
    }

    /// Warns of what ideal rolling passes over, and of a uniform motion that nothing returns to.
    ///
    /// # Errors
    /// No uniform motion.
    pub fn warn(&self, wheel: &Wheel, output: &Output) -> Result<(), KingpinError> {
        let motion = wheel.uniform_motion()?;
        if self.contact == Contact::Rolling && !motion.rolls() {
            output.warn(
                "rolling takes more than the static friction even in uniform motion; it is assumed to roll",
            );
        }
        if motion.growth_rate() > 0.0 && !motion.is_stable() {
            output.warn("the uniform motion is unstable: see `kingpin stability`");
        }
        Ok(())
    }
}

/// A fate by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedFate(pub Fate);

impl Serialize for NamedFate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<'de> Deserialize<'de> for NamedFate {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let fate = Fate::ALL.into_iter().find(|fate| fate.name() == name);
        fate.map(Self).ok_or_else(|| D::Error::custom(format!("`{name}` is no fate")))
    }
}

/// The colour of a fate, told apart with any colour vision.
pub fn color(fate: Fate) -> Color {
    match fate {
        Fate::UniformMotion => palette::BLUE,
        Fate::Shimmy => palette::YELLOW,
        Fate::Tumbling => palette::VERMILION,
        Fate::Escape => palette::BLACK,
        Fate::Undecided => palette::LIGHT_GREY,
    }
}
